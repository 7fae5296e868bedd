//! Profiles: chains of lines, arcs and cubics, in the plane or in space. Swept and ruled surfaces are made
//! from profiles.

#[cfg(test)]
pub mod drawn;
mod shape;

use nalgebra::Point;
pub use shape::{ControlPoint, Shape};

/// The shortest length of a line, mm. Shorter lines are left out: rounding makes them where the tangents of
/// two arcs meet, and they have no direction.
const SHORTEST_MM: f64 = 1e-9;

/// A piece of a profile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece<const D: usize> {
    pub shape: Shape<D>,
    /// The index of the piece's data, or of the data of the point where it ends, in the input of the
    /// profile's maker.
    pub place: usize,
}

/// A chain of pieces without gaps; mm.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Profile<const D: usize> {
    pieces: Vec<Piece<D>>,
}

impl<const D: usize> Profile<D> {
    /// The chain of `pieces`; each has to start where the one before it ends.
    pub fn new(pieces: impl IntoIterator<Item = Piece<D>>) -> Self {
        let mut kept: Vec<Piece<D>> = Vec::new();
        let mut left_out_from = None;
        for mut piece in pieces {
            let from = left_out_from.take().unwrap_or(piece.shape.start());
            if matches!(piece.shape, Shape::Line(_)) && (piece.shape.end() - from).norm() < SHORTEST_MM {
                left_out_from = Some(from);
                continue;
            }
            piece.shape.begin_at(from);
            kept.push(piece);
        }
        Self { pieces: kept }
    }

    pub fn pieces(&self) -> &[Piece<D>] {
        &self.pieces
    }

    /// The first point; `None` if the profile is empty.
    pub fn start(&self) -> Option<Point<f64, D>> {
        self.pieces.first().map(|piece| piece.shape.start())
    }

    /// Whether the profile ends where it starts.
    pub fn is_closed(&self) -> bool {
        match (self.pieces.first(), self.pieces.last()) {
            (Some(first), Some(last)) => (last.shape.end() - first.shape.start()).norm() < SHORTEST_MM,
            _ => false,
        }
    }

    /// The joints at which tangents may differ, by the number of pieces before each. An arc is always tangent
    /// to the lines and arcs next to it, and cubics of the same place are smooth.
    pub fn loose_joints(&self) -> Vec<usize> {
        let is_smooth = |pair: &[Piece<D>]| match (&pair[0].shape, &pair[1].shape) {
            (Shape::Arc { .. }, Shape::Arc { .. } | Shape::Line(_)) | (Shape::Line(_), Shape::Arc { .. }) => {
                true
            }
            (Shape::Cubic(_), Shape::Cubic(_)) => pair[0].place == pair[1].place,
            _ => false,
        };
        let joints = self.pieces.windows(2).zip(1..);
        joints.filter(|(pair, _)| !is_smooth(pair)).map(|(_, joint)| joint).collect()
    }

    /// The lowest and the highest corner of the box around the control points; of an empty profile, infinite
    /// and the wrong way round.
    pub fn bounds(&self) -> [Point<f64, D>; 2] {
        let empty = [f64::INFINITY, f64::NEG_INFINITY].map(|x| Point::from([x; D]));
        let points = self.pieces.iter().flat_map(|piece| piece.shape.control_points());
        points.fold(empty, |[low, high], (p, _)| [low.inf(&p), high.sup(&p)])
    }

    /// The least and the largest value of a coordinate along the profile.
    pub fn range(&self, coordinate: usize) -> [f64; 2] {
        let ranges = self.pieces.iter().map(|piece| piece.shape.range(coordinate));
        ranges.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], [a, b]| [low.min(a), high.max(b)])
    }

    /// The profile with each control point mapped by the affine map `map`.
    pub fn mapped<const E: usize>(&self, map: impl Fn(Point<f64, D>) -> Point<f64, E>) -> Profile<E> {
        let mapped = |piece: &Piece<D>| Piece { shape: piece.shape.mapped(&map), place: piece.place };
        Profile { pieces: self.pieces.iter().map(mapped).collect() }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Point2;

    use super::drawn::{chain, polyline, quarter};
    use super::*;

    #[test]
    fn lines_that_rounding_made_are_left_out() {
        let line = |from: [f64; 2], to: [f64; 2]| Shape::Line([from.into(), to.into()]);
        let profile = chain([
            line([-5.0, 0.0], [0.0, 0.0]),
            quarter([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0]]),
            line([10.0, 10.0], [10.0, 10.0 + 1e-10]),
            line([10.0, 10.0 + 1e-10], [10.0, 20.0]),
        ]);
        assert_eq!(profile.pieces().len(), 3);
        assert_eq!(profile.pieces()[2].shape.start(), Point2::new(10.0, 10.0));
        assert!(profile.loose_joints().is_empty() && !profile.is_closed());
    }

    #[test]
    fn corners_are_loose_and_loops_closed() {
        let profile = polyline([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 0.0]]);
        assert_eq!((profile.loose_joints(), profile.is_closed()), (vec![1, 2], true));
        assert_eq!(profile.bounds(), [Point2::new(0.0, 0.0), Point2::new(4.0, 4.0)]);
        let empty = Profile::<2>::default();
        assert!(empty.start().is_none() && !empty.is_closed() && empty.loose_joints().is_empty());
    }

    #[test]
    fn ranges_are_those_of_the_curve_and_not_of_its_control_points() {
        // An arc from -45 to 45 degrees about the x axis, on a circle of radius 10.
        let h = 10.0 * 0.5f64.sqrt();
        let points = [[h, -h], [2.0 * h, 0.0], [h, h]].map(Point2::from);
        let arc = Shape::Arc { points, weight: 0.5f64.sqrt() };
        let [low, high] = arc.range(0);
        assert!((low - h).abs() < 1e-14 && (high - 10.0).abs() < 1e-14, "{low} {high}");
        // The cubic (3 t (1 - t), t).
        let points = [[0.0, 0.0], [1.0, 1.0 / 3.0], [1.0, 2.0 / 3.0], [0.0, 1.0]].map(Point2::from);
        let [low, high] = Shape::Cubic(points).range(0);
        assert!(low == 0.0 && (high - 0.75).abs() < 1e-15, "{low} {high}");
        assert_eq!(Shape::Line([Point2::new(3.0, 0.0), Point2::new(1.0, 0.0)]).range(0), [1.0, 3.0]);
    }
}
