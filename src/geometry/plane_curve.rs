//! Plane curves as they are designed, with proved enclosures: what interpolation starts from.

pub mod interpolant;
pub mod nurbs;
pub mod piecewise;
pub mod weights;

use nalgebra::{Point2, Vector2};

use super::interval::Interval;

/// The largest coordinate or parameter of designed curves, and one over the least step of the parameter: far
/// beyond any part, and such that no second derivative overflows.
pub const LARGEST: f64 = 1e60;

/// Where a curve and its first two derivatives by the parameter are, over a range of parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Enclosure {
    /// x and y, mm.
    pub point: [Interval; 2],
    /// The whole line where the derivative does not exist or is not bounded, as with `second`.
    pub first: [Interval; 2],
    pub second: [Interval; 2],
}

/// A continuous curve in the plane over an interval of parameters, mm.
pub trait PlaneCurve: Sync {
    /// The first and the last parameter, rising.
    fn domain(&self) -> [f64; 2];

    /// The parameters inside the domain, rising, at which derivatives may jump.
    fn breaks(&self) -> &[f64];

    /// Whether x is the parameter itself, so that the curve is the graph of a function.
    fn is_graph(&self) -> bool {
        false
    }

    /// The point at `t`, to rounding.
    fn point(&self, t: f64) -> Point2<f64>;

    /// The derivative by the parameter at `t`, to rounding; at a break the one after it, at the end the one
    /// before.
    fn derivative(&self, t: f64) -> Vector2<f64>;

    /// Encloses the curve over `[from, to]`, which lies in the domain and has no break inside. The ends may
    /// be equal; then the point is enclosed to a few units of rounding.
    fn enclose(&self, from: f64, to: f64) -> Enclosure;

    /// Whether the tangent jumps at the break `t` by more than an angle of this sine: a right angle and more
    /// are such, as is a derivative of zero.
    fn has_corner(&self, t: f64, sine: f64) -> bool {
        let (before, after) = (self.derivative(t.next_down()), self.derivative(t));
        before.dot(&after) <= 0.0 || before.perp(&after).abs() > sine * before.norm() * after.norm()
    }
}
