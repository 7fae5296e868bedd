//! Lines and circles beside the elements of a path, and where two of them cross.

use nalgebra::Vector2;

/// Centres of circles that are nearer count as one, mm.
const SAME_CENTER_MM: f64 = 1e-9;

/// A line or a circle in a plane.
#[derive(Debug, Clone, Copy)]
pub enum OffsetCurve {
    Line {
        at: Vector2<f64>,
        /// Of length 1.
        along: Vector2<f64>,
    },
    /// A radius of zero or less is that of no circle.
    Circle { center: Vector2<f64>, radius_mm: f64 },
}

impl OffsetCurve {
    /// The places where two curves cross, at most two. A chord that misses a circle by less than the part
    /// `slack` of the square of the radius touches the circle.
    pub fn crossings(self, other: Self, slack: f64) -> Vec<Vector2<f64>> {
        match (self, other) {
            (Self::Line { at: p, along: u }, Self::Line { at: q, along: v }) => {
                let along = (q - p).perp(&v) / u.perp(&v);
                if along.is_finite() { vec![p + u * along] } else { Vec::new() }
            }
            (Self::Line { at, along }, Self::Circle { center, radius_mm })
            | (Self::Circle { center, radius_mm }, Self::Line { at, along }) => {
                let foot = at + along * (center - at).dot(&along);
                chord(foot, along, (foot - center).norm(), radius_mm, slack)
            }
            (Self::Circle { center: p, radius_mm: r }, Self::Circle { center: q, radius_mm: s }) => {
                let apart = (q - p).norm();
                if apart <= SAME_CENTER_MM || s <= 0.0 {
                    return Vec::new();
                }
                let way = (q - p) / apart;
                let along = (apart + (r - s) * (r + s) / apart) / 2.0;
                chord(p + way * along, left_of(way), along.abs(), r, slack)
            }
        }
    }
}

/// A direction turned to the left by a right angle.
pub fn left_of(direction: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-direction.y, direction.x)
}

/// The ends of the chord of a circle whose middle is `foot`, at a distance from the centre.
fn chord(
    foot: Vector2<f64>,
    along: Vector2<f64>,
    distance: f64,
    radius_mm: f64,
    slack: f64,
) -> Vec<Vector2<f64>> {
    let square = (radius_mm - distance) * (radius_mm + distance);
    if radius_mm <= 0.0 || square < -slack * radius_mm * radius_mm {
        return Vec::new();
    }
    let half = along * square.max(0.0).sqrt();
    vec![foot + half, foot - half]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_circles_cross_where_closed_forms_say() {
        let line = |at: [f64; 2], along: [f64; 2]| OffsetCurve::Line { at: at.into(), along: along.into() };
        let circle = |x: f64, radius_mm| OffsetCurve::Circle { center: Vector2::new(x, 0.0), radius_mm };
        let found = line([0.0, 3.0], [1.0, 0.0]).crossings(circle(0.0, 5.0), 0.0);
        assert_eq!(found, [Vector2::new(4.0, 3.0), Vector2::new(-4.0, 3.0)]);
        let found = circle(0.0, 5.0).crossings(circle(8.0, 5.0), 0.0);
        assert_eq!(found, [Vector2::new(4.0, 3.0), Vector2::new(4.0, -3.0)]);
        let found = line([0.0, 3.0], [1.0, 0.0]).crossings(line([7.0, 0.0], [0.0, 1.0]), 0.0);
        assert_eq!(found, [Vector2::new(7.0, 3.0)]);
        let none = |a: OffsetCurve, b| a.crossings(b, 1e-12).is_empty();
        assert!(none(line([0.0, 3.0], [1.0, 0.0]), line([0.0, 0.0], [1.0, 0.0])));
        assert!(none(line([0.0, 5.1], [1.0, 0.0]), circle(0.0, 5.0)));
        assert!(none(circle(0.0, 5.0), circle(0.0, 4.0)) && none(circle(0.0, 5.0), circle(3.0, 0.0)));
        assert!(!none(line([0.0, 5.0 + 1e-13], [1.0, 0.0]), circle(0.0, 5.0)));
    }
}
