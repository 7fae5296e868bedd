//! Profiles that tests use.

use nalgebra::{Point, SVector};

use super::{Piece, Profile, Shape};
use crate::geometry::spline::{EndCondition, derivatives};

/// A profile of shapes in order; the place of each is its index.
pub fn chain<const D: usize>(shapes: impl IntoIterator<Item = Shape<D>>) -> Profile<D> {
    Profile::new(shapes.into_iter().enumerate().map(|(place, shape)| Piece { shape, place }))
}

/// A profile of lines through points.
pub fn polyline<const D: usize>(points: impl AsRef<[[f64; D]]>) -> Profile<D> {
    chain(points.as_ref().windows(2).map(|pair| Shape::Line([pair[0].into(), pair[1].into()])))
}

/// A quarter of a circle; the middle control point is the corner of its tangents.
pub fn quarter<const D: usize>(points: [[f64; D]; 3]) -> Shape<D> {
    Shape::Arc { points: points.map(Point::from), weight: 0.5f64.sqrt() }
}

/// A smooth profile through points.
pub fn smooth<const D: usize>(points: &[[f64; D]]) -> Profile<D> {
    let values: Vec<SVector<f64, D>> = points.iter().map(|p| SVector::from(*p)).collect();
    let slopes = derivatives(&values, EndCondition::Natural);
    let spans = (1..values.len()).map(|k| {
        let [from, to] = [values[k - 1], values[k]];
        let points = [from, from + slopes[k - 1] / 3.0, to - slopes[k] / 3.0, to];
        Piece { shape: Shape::Cubic(points.map(Point::from)), place: 0 }
    });
    Profile::new(spans)
}
