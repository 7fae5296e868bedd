//! Ways to and from a wall, on circles that touch it.

use nalgebra::{Point2, Vector2};

use super::chain::ROUNDING_MM;
use crate::geometry::segment::{Segment, left};

/// The turn of the arc on which the cutter comes to a wall after a lift, radians. The arc begins an eighth of
/// its radius away from the wall. A larger turn takes longer through the air, and a path has hundreds of
/// these arcs.
const LEAD_TURN: f64 = std::f64::consts::FRAC_PI_6;

/// The way from one place to another on circles to the left about two centres and the line that touches both;
/// empty if no line does, because one circle lies in the other.
pub fn belt([from, to]: [Point2<f64>; 2], [first, second]: [Point2<f64>; 2]) -> Vec<Segment> {
    let Some(along) = (second - first).try_normalize(ROUNDING_MM) else { return Vec::new() };
    let (out, back) = ((from - first).norm(), (to - second).norm());
    // For equal radii the line runs parallel to that between the centres.
    let aside = (out - back) / (second - first).norm();
    if aside.abs() > 1.0 {
        return Vec::new();
    }
    let spoke = -left(along) * (1.0 - aside * aside).sqrt() + along * aside;
    let (leave, meet) = (first + spoke * out, second + spoke * back);
    let arc = |start: Point2<f64>, end: Point2<f64>, center: Point2<f64>, radius: f64| {
        let (a, b) = (start - center, end - center);
        let turn = a.perp(&b).atan2(a.dot(&b)).rem_euclid(std::f64::consts::TAU);
        Segment::about(center, radius, [start, end], turn)
    };
    vec![arc(from, leave, first, out), Segment::Line { start: leave, end: meet }, arc(meet, to, second, back)]
        .into_iter()
        .filter(|element| element.length() > ROUNDING_MM)
        .collect()
}

/// The arc to the left about a centre that ends at a place.
pub fn lead_to(end: Point2<f64>, center: Point2<f64>) -> Segment {
    let spoke = end - center;
    let (sin, cos) = LEAD_TURN.sin_cos();
    let start = center + Vector2::new(spoke.x * cos + spoke.y * sin, spoke.y * cos - spoke.x * sin);
    Segment::about(center, spoke.norm(), [start, end], LEAD_TURN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_belt_runs_smoothly_around_two_circles_and_none_runs_around_nested_ones() {
        let [from, to] = [[0.0, 2.0], [6.0, 0.0]].map(Point2::from);
        let way = belt([from, to], [Point2::origin(), Point2::new(5.0, 0.0)]);
        assert_eq!([way[0].start(), way[way.len() - 1].end()], [from, to]);
        for pair in way.windows(2) {
            assert_eq!(pair[0].end(), pair[1].start());
            assert!((pair[0].direction(1.0) - pair[1].direction(0.0)).norm() < 1e-12, "{pair:?}");
        }
        assert_eq!(belt([from, to], [Point2::origin(), Point2::new(5.5, 0.0)]).len(), 3);
        assert_eq!(belt([Point2::new(0.0, 9.0), to], [Point2::origin(), Point2::new(5.0, 0.0)]), []);
    }
}
