//! A toolpath as points alone, for callers that draw no arcs.

use nalgebra::Point3;

use super::Toolpath;
use super::path::Move;
use crate::geometry::curve::Curve;
use crate::geometry::flatten::flatten;

/// The chord is made this much wider where there are too many points.
const WIDER: f64 = 4.0;

/// The widest chord, mm: wider ones save few points.
const WIDEST_MM: f64 = 1.0;

/// The places of the tip along the whole toolpath, mm.
#[derive(Debug, Clone, PartialEq)]
pub struct Points {
    pub points: Vec<Point3<f64>>,
    /// How far the lines between the points may be from the moves, mm.
    pub chord_mm: f64,
}

impl Points {
    /// The points of a toolpath within `chord_mm`, above zero, or within a wider chord where there would be
    /// more than `most` points. A chord of a millimetre is kept, however many points it needs; then there is
    /// about one point for each move. Cost O(n) for n points.
    pub fn of(toolpath: &Toolpath, chord_mm: f64, most: usize) -> Self {
        let mut chord_mm = chord_mm;
        loop {
            let most = if chord_mm < WIDEST_MM { most } else { usize::MAX };
            match within(toolpath, chord_mm, most) {
                Some(points) => return Self { points, chord_mm },
                None => chord_mm *= WIDER,
            }
        }
    }
}

/// The points within a chord; none where there are more than `most` of them.
fn within(toolpath: &Toolpath, chord_mm: f64, most: usize) -> Option<Vec<Point3<f64>>> {
    let mut points = vec![toolpath.start()];
    for pass in toolpath.passes() {
        points.extend(pass.start());
        for step in pass.moves() {
            match step {
                Move::Rapid { line } => points.push(line.end),
                Move::Feed { along, .. } => points.extend(flat(along, chord_mm, most).into_iter().skip(1)),
                Move::Turn { .. } | Move::Dwell { .. } => {}
            }
            if points.len() > most {
                return None;
            }
        }
    }
    Some(points)
}

/// The points of a curve, or its ends where it needs too many.
fn flat(along: &Curve, chord_mm: f64, most: usize) -> Vec<Point3<f64>> {
    flatten(along, chord_mm, most).unwrap_or_else(|_| vec![along.start(), along.end()])
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
    fn too_many_points_make_the_chord_wider_and_the_widest_one_is_kept() {
        let Points { points, chord_mm } = Points::of(&circles(20), 1e-4, 3000);
        assert!(chord_mm > 1e-4 && points.len() <= 3000, "{chord_mm} {}", points.len());
        let Points { points, chord_mm } = Points::of(&circles(20), 1e-4, 10);
        assert!(chord_mm >= WIDEST_MM && points.len() > 10);
    }
}
