//! A toolpath as points alone, for callers that draw no arcs.
//!
//! # Guarantees
//! * Each point of a move lies within the stated chord of the lines between the points.
//! * The caller says how many points are allowed. Only a toolpath with very many moves has more: then about
//!   four for each move.
//!
//! # Cost
//! O(n + p) for n moves and p points.

use nalgebra::Point3;

use super::Toolpath;
use super::path::Move;
use crate::geometry::curve::Curve;
use crate::geometry::flatten::{flatten, n_chords};

/// The chord is made this much wider where there are too many points.
const WIDER: f64 = 4.0;

/// A chord that no curve of a toolpath needs, mm: then each one has as few chords as it can.
const WIDEST_MM: f64 = 1e7;

/// The places of the tip along the whole toolpath, mm.
#[derive(Debug, Clone, PartialEq)]
pub struct Points {
    pub points: Vec<Point3<f64>>,
    /// How far the lines between the points may be from the moves, mm.
    pub chord_mm: f64,
}

impl Points {
    /// The points of a toolpath within the chord that [`chord`] makes of `chord_mm`, above zero.
    pub fn of(toolpath: &Toolpath, chord_mm: f64, most: usize) -> Self {
        let chord_mm = chord(toolpath, chord_mm, most);
        let mut points = vec![toolpath.start()];
        for pass in toolpath.passes() {
            points.extend(pass.start());
            for step in pass.moves() {
                match step {
                    Move::Rapid { line } => points.push(line.end),
                    Move::Feed { along, .. } => points.extend(flat(along, chord_mm).into_iter().skip(1)),
                    Move::Turn { .. } | Move::Dwell { .. } => {}
                }
            }
        }
        Self { points, chord_mm }
    }
}

/// The chord within which the curves of a toolpath have at most `most` chords: `chord_mm`, above zero, or a
/// wider one. Where there are more moves than that, each curve has as few chords as it can.
pub fn chord(toolpath: &Toolpath, chord_mm: f64, most: usize) -> f64 {
    let mut chord_mm = chord_mm;
    let count = |chord_mm: f64| -> f64 {
        let of =
            |step: &Move| if let Move::Feed { along, .. } = step { n_chords(along, chord_mm) } else { 1.0 };
        toolpath.moves().map(of).sum()
    };
    while chord_mm < WIDEST_MM && count(chord_mm) > most as f64 {
        chord_mm *= WIDER;
    }
    chord_mm
}

/// The points of a curve within a chord of [`chord`], which bounds their number.
pub fn flat(along: &Curve, chord_mm: f64) -> Vec<Point3<f64>> {
    flatten(along, chord_mm, usize::MAX).unwrap_or_else(|_| vec![along.start(), along.end()])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::curve::Direction;
    use crate::geometry::plane::Plane;
    use crate::toolpath::path::Role;
    use crate::toolpath::units::FeedRate;

    /// Full circles with a radius of 10 mm, after a rapid.
    fn circles(count: usize) -> Toolpath {
        let feed = FeedRate::from_mm_per_min(600.0);
        let mut path = Toolpath::builder(Point3::new(0.0, 0.0, 5.0));
        path.rapid(Point3::origin()).unwrap();
        for _ in 0..count {
            let center = Point3::new(10.0, 0.0, 0.0);
            path.arc(Point3::origin(), center, (Plane::Xy, Direction::Ccw), feed, Role::Cut).unwrap();
        }
        path.finish().unwrap()
    }

    #[test]
    fn chords_stay_within_their_distance_and_moves_are_in_order() {
        let Points { points, chord_mm } = Points::of(&circles(1), 0.01, 1_000_000);
        assert_eq!((points[0], points[1]), (Point3::new(0.0, 0.0, 5.0), Point3::origin()));
        assert_eq!((points[points.len() - 1], chord_mm), (Point3::origin(), 0.01));
        let center = Point3::new(10.0, 0.0, 0.0);
        for pair in points[1..].windows(2) {
            let middle = nalgebra::center(&pair[0], &pair[1]);
            assert!((10.0 - (middle - center).norm()).abs() <= 0.01, "{middle}");
        }
    }

    #[test]
    fn too_many_points_make_the_chord_wider_and_each_curve_keeps_a_few() {
        for (count, most) in [(20, 3000), (20, 10), (1, 10), (5000, 20_000)] {
            let Points { points, chord_mm } = Points::of(&circles(count), 1e-4, most);
            assert!(
                chord_mm > 1e-4 && points.len() <= (most + 2).max(4 * count + 2),
                "{count}: {}",
                points.len()
            );
            assert!(points.len() > 3 * count, "{count}: {}", points.len());
        }
    }
}
