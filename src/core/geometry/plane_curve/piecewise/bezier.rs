//! One Bezier curve in the plane: the building block of chains.

use nalgebra::Point2;

use crate::geometry::bspline::MAX_DEGREE;
use crate::geometry::plane_curve::LARGEST;
use crate::geometry::plane_curve::weights::{WeightError, check_weights};

const SIZE: usize = MAX_DEGREE + 1;

/// Why control points make no Bezier curve.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum BezierError {
    #[error("the curve has {points} control points; 2 to {SIZE} are supported")]
    Degree { points: usize },
    #[error("control point {index} has a coordinate that is not finite, or larger than {LARGEST:e} mm")]
    Point { index: usize },
    #[error(transparent)]
    Weights(WeightError),
}

/// A polynomial or rational Bezier curve of degree 1 to 7; mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bezier {
    degree: usize,
    points: [Point2<f64>; SIZE],
    weights: Option<[f64; SIZE]>,
}

impl Bezier {
    /// The polynomial curve with these control points. Their number is the degree plus one.
    ///
    /// # Errors
    /// When there are too few or too many control points, or one is not finite or larger than [`LARGEST`].
    pub fn polynomial(points: &[Point2<f64>]) -> Result<Self, BezierError> {
        if !(2..=SIZE).contains(&points.len()) {
            return Err(BezierError::Degree { points: points.len() });
        }
        if let Some(index) = points.iter().position(|p| !p.iter().all(|x| x.abs() <= LARGEST)) {
            return Err(BezierError::Point { index });
        }
        let mut room = [Point2::origin(); SIZE];
        room[..points.len()].copy_from_slice(points);
        Ok(Self { degree: points.len() - 1, points: room, weights: None })
    }

    /// The rational curve with these control points, not multiplied by their weights. Equal weights make the
    /// curve polynomial.
    ///
    /// # Errors
    /// Those of [`Bezier::polynomial`]. Also when the weights differ in number from the control points, are
    /// not above zero, or are too far apart.
    pub fn rational(points: &[Point2<f64>], weights: &[f64]) -> Result<Self, BezierError> {
        let polynomial = Self::polynomial(points)?;
        check_weights(weights, points.len()).map_err(BezierError::Weights)?;
        if weights.iter().all(|weight| *weight == weights[0]) {
            return Ok(polynomial);
        }
        let mut room = [0.0; SIZE];
        room[..weights.len()].copy_from_slice(weights);
        Ok(Self { weights: Some(room), ..polynomial })
    }

    /// The curve of control points and weights that come from an earlier [`Bezier`], and so need no check.
    pub(super) fn stored(points: &[[f64; 2]], weights: Option<&[f64]>) -> Self {
        let mut bezier = Self { degree: points.len() - 1, points: [Point2::origin(); SIZE], weights: None };
        for (place, p) in bezier.points.iter_mut().zip(points) {
            *place = Point2::from(*p);
        }
        bezier.weights = weights.map(|weights| {
            let mut room = [0.0; SIZE];
            room[..weights.len()].copy_from_slice(weights);
            room
        });
        bezier
    }

    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The control points, not multiplied by their weights.
    pub fn points(&self) -> &[Point2<f64>] {
        &self.points[..=self.degree]
    }

    /// The weights; `None` for a polynomial curve.
    pub fn weights(&self) -> Option<&[f64]> {
        self.weights.as_ref().map(|weights| &weights[..=self.degree])
    }
}
