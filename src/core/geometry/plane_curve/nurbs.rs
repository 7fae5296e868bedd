//! NURBS curves in the plane, as chains of Bezier pieces. Each knot span of a length above zero becomes one
//! piece.
//!
//! # Guarantees
//! The pieces equal the curve, up to rounding. Each end of the curve may be clamped or not. An end is clamped
//! if its knot occurs p + 1 times, where p is the degree. A curve without weights passes exactly through its
//! first control point if its start is clamped, and through its last if its end is clamped.
//!
//! # Degenerate input
//! A knot inside the domain may occur p + 1 times. The curve can then have a gap at this knot; a curve with a
//! gap is refused.
//!
//! A control point without effect on the curve is refused: one whose knots lie outside the domain, and one
//! whose share in the curve is below [`LEAST_SHARE`].
//!
//! # Cost
//! O(n p^4) for n control points.

use nalgebra::{Point2, Vector3};

use super::LARGEST;
use super::piecewise::{Bezier, BezierError, Piecewise, PiecewiseError};
use super::weights::{WeightError, check_weights};
use crate::geometry::bspline::{KnotError, KnotRules, LEAST_SHARE, MAX_DEGREE, Span, check_knots, spans};

/// The shortest knot span, as a part of the domain. A shorter span is two knots that should be equal. A curve
/// through a million points has spans of 1e-6, so the limit is far below that.
pub const SHORTEST_SPAN: f64 = 1e-9;

/// Control points in the plane (not multiplied by the weights), mm. The full knot vector has n + degree + 1
/// knots.
///
/// # Example
/// A quarter of a circle of radius 10 mm.
///
/// ```
/// use std::f64::consts::FRAC_1_SQRT_2;
/// use nalgebra::Point2;
/// use toolpathd_core::geometry::plane_curve::{PlaneCurve, nurbs::Nurbs};
///
/// let quarter = Nurbs {
///     degree: 2,
///     knots: vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0],
///     control_points: [[10.0, 0.0], [10.0, 10.0], [0.0, 10.0]].map(Point2::from).to_vec(),
///     weights: Some(vec![1.0, FRAC_1_SQRT_2, 1.0]),
/// };
/// let curve = quarter.curve().unwrap();
/// for t in [0.0, 0.2, 0.5, 0.9, 1.0] {
///     assert!((curve.point(t).coords.norm() - 10.0).abs() < 1e-12);
/// }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Nurbs {
    pub degree: usize,
    pub knots: Vec<f64>,
    pub control_points: Vec<Point2<f64>>,
    /// `None` makes all weights 1.
    pub weights: Option<Vec<f64>>,
}

/// Why the data make no curve.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum NurbsError {
    #[error("the degree is {degree}; degrees from 1 to {MAX_DEGREE} are supported")]
    Degree { degree: usize },
    #[error("the curve has {points} control points; degree {degree} needs at least {}", degree + 1)]
    TooFewPoints { points: usize, degree: usize },
    #[error("control point {index} has a coordinate that is not finite, or larger than {LARGEST:e} mm")]
    Point { index: usize },
    #[error(transparent)]
    Knots(KnotError),
    #[error(transparent)]
    Weights(WeightError),
    #[error(
        "the curve has a gap of {gap_mm} mm at parameter {parameter}; give the two parts as two curves, or close the gap"
    )]
    Gap { parameter: f64, gap_mm: f64 },
    #[error(
        "control point {index} has no effect: its share in the curve is below {LEAST_SHARE:e}; leave it out, move the knots outside the domain nearer to the domain, or send weights that are nearer to each other"
    )]
    NoEffect { index: usize },
    /// A fault that no rule above excludes: parameters too large or too close together, or too many pieces.
    #[error("{0}")]
    Chain(PiecewiseError),
    #[error("{0}")]
    Piece(BezierError),
}

impl Nurbs {
    /// The curve, with the knots inside the domain as breaks. Its domain runs from the knot with the index
    /// `degree` to the knot with the index n.
    ///
    /// # Errors
    /// One of [`NurbsError`].
    pub fn curve(&self) -> Result<Piecewise, NurbsError> {
        let (degree, points) = (self.degree, self.control_points.len());
        if !(1..=MAX_DEGREE).contains(&degree) {
            return Err(NurbsError::Degree { degree });
        }
        if points <= degree {
            return Err(NurbsError::TooFewPoints { points, degree });
        }
        let is_wrong = |p: &Point2<f64>| !p.iter().all(|x| x.abs() <= LARGEST);
        if let Some(index) = self.control_points.iter().position(is_wrong) {
            return Err(NurbsError::Point { index });
        }
        let rules = KnotRules { multiplicity: degree + 1, shortest_span: SHORTEST_SPAN };
        check_knots(&self.knots, degree, points, rules).map_err(NurbsError::Knots)?;
        if let Some(weights) = &self.weights {
            check_weights(weights, points).map_err(NurbsError::Weights)?;
        }
        let is_rational = !self.has_equal_weights();
        let mut starts = Vec::new();
        let mut pieces = Vec::new();
        let mut shares = vec![0.0; points];
        for span in spans(&self.knots, degree, points) {
            self.raise_shares(&span, &mut shares);
            let bezier = if is_rational { self.rational(&span) } else { self.polynomial(&span) };
            pieces.push((bezier.map_err(NurbsError::Piece)?, span.ends[1]));
            starts.push(span.ends[0]);
        }
        if let Some(index) = shares.iter().position(|share| *share < LEAST_SHARE) {
            return Err(NurbsError::NoEffect { index });
        }
        Piecewise::new(self.knots[degree], pieces).map_err(|error| match error {
            PiecewiseError::Gap { index, gap_mm } => {
                NurbsError::Gap { parameter: starts.get(index).copied().unwrap_or_default(), gap_mm }
            }
            other => NurbsError::Chain(other),
        })
    }

    /// Raises each control point's share to its largest share in a Bezier control point of the span. A
    /// control point has nowhere on the span a larger share.
    fn raise_shares(&self, span: &Span, shares: &mut [f64]) {
        let width = self.degree + 1;
        for row in 0..width {
            let part = |column: usize| self.weight(span.first + column) * span.extraction[(row, column)];
            let sum: f64 = (0..width).map(part).sum();
            for (column, share) in shares[span.first..span.first + width].iter_mut().enumerate() {
                *share = f64::max(*share, part(column) / sum);
            }
        }
    }

    fn weight(&self, index: usize) -> f64 {
        self.weights.as_ref().map_or(1.0, |weights| weights[index])
    }

    fn polynomial(&self, span: &Span) -> Result<Bezier, BezierError> {
        let mut points = [Point2::origin(); MAX_DEGREE + 1];
        for (row, point) in points.iter_mut().enumerate().take(self.degree + 1) {
            for column in 0..=self.degree {
                point.coords +=
                    self.control_points[span.first + column].coords * span.extraction[(row, column)];
            }
        }
        Bezier::polynomial(&points[..=self.degree])
    }

    fn rational(&self, span: &Span) -> Result<Bezier, BezierError> {
        let mut points = [Point2::origin(); MAX_DEGREE + 1];
        let mut weights = [0.0; MAX_DEGREE + 1];
        for row in 0..=self.degree {
            let mut sum = Vector3::zeros();
            for column in 0..=self.degree {
                let at = span.first + column;
                let weight = self.weight(at);
                let homogeneous = (self.control_points[at].coords * weight).push(weight);
                sum += homogeneous * span.extraction[(row, column)];
            }
            points[row] = Point2::from(sum.xy() / sum.z);
            weights[row] = sum.z;
        }
        Bezier::rational(&points[..=self.degree], &weights[..=self.degree])
    }

    fn has_equal_weights(&self) -> bool {
        let mut weights = self.weights.iter().flatten();
        let first = weights.next();
        weights.all(|weight| Some(weight) == first)
    }
}

#[cfg(test)]
mod tests;
