//! Curves in the plane that are to be interpolated. Each curve gives the point and the derivative at a
//! parameter. Over a range of parameters, it gives proved bounds of its points and of its first two
//! derivatives.

pub mod interpolant;
pub mod nurbs;
pub mod piecewise;
pub mod weights;

use nalgebra::{Point2, Vector2};

use super::interval::Interval;

/// The largest absolute coordinate (mm) and parameter of a designed curve; 1 / `LARGEST` is the least step of
/// the parameter. The value is far beyond any part, and small enough that no second derivative overflows.
pub const LARGEST: f64 = 1e60;

/// Boxes that contain a curve and its first two derivatives by the parameter over a range of parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Enclosure {
    /// x and y, mm.
    pub point: [Interval; 2],
    /// The first derivative; the whole line where it does not exist or has no bound. So is `second`.
    pub first: [Interval; 2],
    pub second: [Interval; 2],
}

/// A continuous curve in the plane over an interval of parameters, mm.
pub trait PlaneCurve: Sync {
    /// The first and the last parameter, rising.
    fn domain(&self) -> [f64; 2];

    /// The parameters inside the domain, rising, where derivatives may jump.
    fn breaks(&self) -> &[f64];

    /// Whether x is the parameter itself, so that the curve is the graph of a function.
    fn is_graph(&self) -> bool {
        false
    }

    /// The point at `t`, to rounding.
    fn point(&self, t: f64) -> Point2<f64>;

    /// The derivative by the parameter at `t`, to rounding. At a break it is the derivative after the break,
    /// at the end of the domain the derivative before the end.
    fn derivative(&self, t: f64) -> Vector2<f64>;

    /// Encloses the curve over `[from, to]`, which lies in the domain and has no break inside. If `from`
    /// equals `to`, the enclosure of the point is a few units of rounding wide.
    fn enclose(&self, from: f64, to: f64) -> Enclosure;

    /// How long a point takes, in arithmetic operations, roughly.
    fn operations(&self) -> u64 {
        1
    }

    /// Whether no more values of the curve are wanted. A search then ends without a proof.
    fn is_spent(&self) -> bool {
        false
    }

    /// Whether the tangent turns at the break `t` by more than the angle with this sine. A turn of 90 degrees
    /// or more is a corner, and so is a derivative of zero.
    fn has_corner(&self, t: f64, sine: f64) -> bool {
        let (before, after) = (self.derivative(t.next_down()), self.derivative(t));
        before.dot(&after) <= 0.0 || before.perp(&after).abs() > sine * before.norm() * after.norm()
    }
}
