//! Ways to and from a wall, on circles that touch it.

use nalgebra::{Point2, Vector2};

use crate::geometry::segment::Segment;

/// The turn of the arc on which the cutter comes to a wall after a lift, radians. The arc begins an eighth of
/// its radius away from the wall. A larger turn takes longer through the air, and a path has hundreds of
/// these arcs.
pub const LEAD_TURN: f64 = std::f64::consts::FRAC_PI_6;

/// The arc to the left about a centre that ends at a place.
pub fn lead_to(end: Point2<f64>, center: Point2<f64>) -> Segment {
    let spoke = end - center;
    let (sin, cos) = LEAD_TURN.sin_cos();
    let start = center + Vector2::new(spoke.x * cos + spoke.y * sin, spoke.y * cos - spoke.x * sin);
    Segment::about(center, spoke.norm(), [start, end], LEAD_TURN)
}

/// The arc to the left about a centre that begins at a place.
pub fn lead_from(start: Point2<f64>, center: Point2<f64>) -> Segment {
    let spoke = start - center;
    let (sin, cos) = LEAD_TURN.sin_cos();
    let end = center + Vector2::new(spoke.x * cos - spoke.y * sin, spoke.y * cos + spoke.x * sin);
    Segment::about(center, spoke.norm(), [start, end], LEAD_TURN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leads_touch_the_motion_beside_the_wall_and_turn_to_the_left() {
        let (place, center) = (Point2::new(3.0, 0.0), Point2::new(3.0, 2.0));
        let [lead, out] = [lead_to(place, center), lead_from(place, center)];
        assert_eq!([lead.end(), out.start()], [place, place]);
        for along in [lead.direction(1.0), out.direction(0.0)] {
            assert!((along - Vector2::x()).norm() < 1e-12, "{along}");
        }
        for away in [lead.start(), out.end()] {
            assert!((away.y - 2.0 * (1.0 - LEAD_TURN.cos())).abs() < 1e-12, "{away}");
        }
        assert!(lead.start().x < 3.0 && out.end().x > 3.0);
    }
}
