//! The smooth curve through given points: a cubic spline with two continuous derivatives.
//!
//! # Method
//! The parameter of a point is the sum of the chord lengths from the first point to this point. A cubic
//! Bezier piece joins each pair of neighbouring points. The first two pieces are parts of one cubic, and so
//! are the last two pieces (not-a-knot ends).
//!
//! # Guarantees
//! The curve passes through the points exactly. Two points make a line, and three points a parabola. If the
//! last point equals the first, the curve is closed, but usually has a kink at this point.
//!
//! # Degenerate input
//! Two neighbouring points are refused if they coincide, or if they are so close together that rounding gives
//! both the same parameter.
//!
//! # Reference
//! C. de Boor, *A Practical Guide to Splines*, Springer, 1978, chapter IV.

use nalgebra::{Point2, Vector2};

use super::LARGEST;
use super::piecewise::{Bezier, BezierError, Piecewise, PiecewiseError};
use crate::geometry::spline::{EndCondition, derivatives_over};

/// Why points make no curve.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum InterpolantError {
    #[error("the curve has {points} points; at least 2 are needed")]
    TooFewPoints { points: usize },
    #[error("point {index} has a coordinate that is not finite, or larger than {LARGEST:e} mm")]
    Point { index: usize },
    #[error("point {index} coincides with the point before it; leave one of them out")]
    Coincident { index: usize },
    /// Derivatives too large to compute with, from very uneven distances.
    #[error("{0}")]
    Piece(BezierError),
    /// Too many points.
    #[error("{0}")]
    Chain(PiecewiseError),
}

/// The curve through `points` (mm) in their order. Its parameter starts at 0 and grows by the chord lengths.
/// If the points are samples of a smooth curve, the distance from this curve falls with the fourth power of
/// the distance between the points.
///
/// # Errors
/// When there are fewer than two points or too many, a point is not finite, or a point coincides with the
/// point before it.
///
/// # Example
/// ```
/// use nalgebra::Point2;
/// use toolpathd_core::geometry::plane_curve::{PlaneCurve, interpolant::through};
///
/// let curve = through(&[[0.0, 0.0], [3.0, 4.0], [3.0, 6.0]].map(Point2::from)).unwrap();
/// // The chords are 5 and 2 mm long.
/// assert_eq!(curve.domain(), [0.0, 7.0]);
/// assert_eq!(curve.breaks(), [5.0]);
/// assert_eq!(curve.point(5.0), Point2::new(3.0, 4.0));
/// ```
pub fn through(points: &[Point2<f64>]) -> Result<Piecewise, InterpolantError> {
    if points.len() < 2 {
        return Err(InterpolantError::TooFewPoints { points: points.len() });
    }
    if let Some(index) = points.iter().position(|p| !p.iter().all(|x| x.abs() <= LARGEST)) {
        return Err(InterpolantError::Point { index });
    }
    let mut parameters = vec![0.0];
    let mut at = 0.0;
    for (k, ends) in points.windows(2).enumerate() {
        let next = at + (ends[1] - ends[0]).norm();
        if next - at < 1.0 / LARGEST {
            return Err(InterpolantError::Coincident { index: k + 1 });
        }
        parameters.push(next);
        at = next;
    }
    let steps: Vec<f64> = parameters.windows(2).map(|t| t[1] - t[0]).collect();
    let values: Vec<Vector2<f64>> = points.iter().map(|p| p.coords).collect();
    let slopes = derivatives_over(&steps, &values, EndCondition::NotAKnot);
    let mut pieces = Vec::with_capacity(steps.len());
    for (k, step) in steps.iter().enumerate() {
        let (from, to) = (points[k], points[k + 1]);
        let third = step / 3.0;
        let bezier = Bezier::polynomial(&[from, from + slopes[k] * third, to - slopes[k + 1] * third, to]);
        pieces.push((bezier.map_err(InterpolantError::Piece)?, parameters[k + 1]));
    }
    Piecewise::new(0.0, pieces).map_err(InterpolantError::Chain)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::plane_curve::PlaneCurve;

    #[test]
    fn the_curve_passes_the_points_with_two_continuous_derivatives() {
        let points: Vec<_> = (0..40)
            .map(|k| {
                let t = f64::from(k) + 0.3 * f64::from(k * k % 7);
                Point2::new(t, 5.0 * (0.4 * t).sin())
            })
            .collect();
        let curve = through(&points).unwrap();
        let [start, end] = curve.domain();
        let at: Vec<f64> = [&[start], curve.breaks(), &[end]].concat();
        for (k, t) in at.iter().enumerate() {
            assert_eq!(curve.point(*t), points[k]);
        }
        for (k, t) in curve.breaks().iter().enumerate() {
            let (before, after) = (curve.enclose(t.next_down(), *t), curve.enclose(*t, t.next_up()));
            // Not-a-knot ends make the third derivative continuous at the breaks next to the ends.
            for c in 0..2 {
                assert!((before.first[c].mid() - after.first[c].mid()).abs() < 1e-12);
                assert!((before.second[c].mid() - after.second[c].mid()).abs() < 1e-11);
            }
            if k == 0 || k == curve.breaks().len() - 1 {
                let h = 0.1;
                let second = |t: f64| curve.enclose(t, t).second.map(|x| x.mid());
                let [middle, below, above] = [second(*t), second(t - h), second(t + h)];
                assert!((0..2).all(|c| (below[c] + above[c] - 2.0 * middle[c]).abs() < 1e-11));
            }
        }
    }

    /// Of all polynomial curves, only a line has its chord lengths as parameters.
    #[test]
    fn points_on_a_line_make_the_line() {
        let points: Vec<_> = [0.0, 0.5, 3.0, 3.25, 9.0].map(|t| Point2::new(3.0 * t, 4.0 * t)).to_vec();
        let curve = through(&points).unwrap();
        for k in 0..=450 {
            let t = f64::from(k) / 10.0;
            assert!((curve.point(t) - Point2::new(0.6 * t, 0.8 * t)).norm() < 1e-14 * 50.0);
        }
    }

    #[test]
    fn two_points_make_a_line_and_three_a_parabola() {
        let curve = through(&[Point2::new(1.0, 2.0), Point2::new(4.0, 6.0)]).unwrap();
        assert_eq!(curve.domain(), [0.0, 5.0]);
        assert!((curve.point(2.0) - Point2::new(2.2, 3.6)).norm() < 1e-15);
        let curve = through(&[Point2::new(0.0, 0.0), Point2::new(3.0, 4.0), Point2::new(3.0, 6.0)]).unwrap();
        // The parabola with x(0) = 0, x(5) = 3, x(7) = 3, y(0) = 0, y(5) = 4, y(7) = 6.
        let lagrange = |t: f64, b: f64, c: f64| b * t * (7.0 - t) / 10.0 + c * t * (t - 5.0) / 14.0;
        for k in 0..=70 {
            let t = f64::from(k) / 10.0;
            let expected = Point2::new(lagrange(t, 3.0, 3.0), lagrange(t, 4.0, 6.0));
            assert!((curve.point(t) - expected).norm() < 1e-14, "{t}");
        }
    }

    #[test]
    fn the_error_falls_with_the_fourth_power() {
        let error = |n: usize| {
            let points: Vec<_> = (0..=n).map(|k| 6.0 * k as f64 / n as f64).collect();
            let points: Vec<_> = points.iter().map(|x| Point2::new(*x, x.sin())).collect();
            let curve = through(&points).unwrap();
            let end = curve.domain()[1];
            let samples = (0..=3000).map(|k| curve.point(end * f64::from(k) / 3000.0));
            samples.map(|p| (p.y - p.x.sin()).abs()).fold(0.0, f64::max)
        };
        let errors = [error(20), error(40), error(80), error(160)];
        assert!(errors[3] < 1e-7, "{errors:?}");
        assert!(errors.windows(2).all(|e| e[0] / e[1] > 12.0), "{errors:?}");
    }

    #[test]
    fn closed_points_make_a_closed_curve() {
        let corner = |k: i32| Point2::new((f64::from(k) * 0.1).cos(), (f64::from(k) * 0.1).sin());
        let mut points: Vec<_> = (0..60).map(corner).collect();
        points.push(points[0]);
        let curve = through(&points).unwrap();
        let [start, end] = curve.domain();
        assert_eq!(curve.point(start), curve.point(end));
    }

    #[test]
    fn broken_points_are_refused_with_their_index() {
        let p = |x: f64| Point2::new(x, 1.0);
        assert_eq!(through(&[]), Err(InterpolantError::TooFewPoints { points: 0 }));
        assert_eq!(through(&[p(1.0)]), Err(InterpolantError::TooFewPoints { points: 1 }));
        assert_eq!(through(&[p(1.0), p(f64::NAN)]), Err(InterpolantError::Point { index: 1 }));
        assert_eq!(through(&[p(1.0), p(2.0), p(2.0)]), Err(InterpolantError::Coincident { index: 2 }));
        let close = through(&[p(0.0), p(1e9), p(1e9f64.next_up())]);
        assert!(close.is_ok() || close == Err(InterpolantError::Coincident { index: 2 }));
    }

    /// A curve with steps of 1e-6 mm beside steps of a metre still passes through every point.
    #[test]
    fn the_curve_passes_through_unevenly_spaced_points() {
        let points: Vec<_> = [0.0, 1e-6, 1000.0, 1000.0 + 1e-6, 1003.0, 1003.1]
            .map(|x: f64| Point2::new(x, (3.0 * x).sin()))
            .to_vec();
        let curve = through(&points).unwrap();
        let at: Vec<f64> = [&[0.0], curve.breaks(), &[curve.domain()[1]]].concat();
        assert!(at.iter().zip(&points).all(|(t, p)| curve.point(*t) == *p));
    }
}
