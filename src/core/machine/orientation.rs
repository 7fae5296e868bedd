//! The two rotary angles that bring a tool axis to the spindle direction, in closed form.
//!
//! # Method
//! The equation is R(p, alpha) R(q, beta) u = z. Here u is the tool axis in the workpiece frame, z is the
//! machine's +Z, q is the rotary axis nearer to the workpiece and p is the rotary axis nearer to the tool.
//! 1. Let v = R(q, beta) u = R(p, -alpha) z. Then v has the component c = u.q along q and the component p.z
//!    along p.
//! 2. The part of v across q has the length h = |u - c q|, because rotations keep lengths. Its component m
//!    along the part of p across q follows from step 1. Its component along q x p is n or -n, where
//!    n^2 = h^2 - m^2. These two signs are the two solutions.
//! 3. beta is the angle about q from u to v. alpha is the angle about p from v to z.
//!
//! # Guarantees
//! * The vector v is accurate to rounding divided by the sine of the angle between p and q, also near the
//!   pole: components across q come from scalar products and never from 1 - c^2.
//! * Along a path through the pole, what vanishes there is divided out
//!   ([`RotaryPair::solve_through`]): angles and derivatives are as accurate as elsewhere.
//! * Branch 0 has +n and branch 1 has -n. Along a continuous path a branch can only pass into the other one
//!   at the pole and where n vanishes.
//!
//! # Degenerate input
//! * u parallel to q: beta is free ([`Orientation::Pole`]).
//! * h = |m|: the two solutions coincide ([`Orientation::Touch`]).
//! * h < |m|: no angles reach the tool axis. A vector whose length is zero or not finite is not reached
//!   either.
//!
//! # Cost
//! Constant: one square root for the length of u, two for h and n, four angles.
//!
//! # Differences from the paper
//! The textbook form writes v in the oblique basis p, q, p x q and divides by (p.q)^2 - 1. The basis here is
//! orthogonal, which keeps accuracy near the pole.
//!
//! # Reference
//! R. M. Murray, Z. Li, S. S. Sastry, *A Mathematical Introduction to Robotic Manipulation*, CRC Press, 1994,
//! chapter 3, section 3.2, Paden-Kahan subproblem 2.

use std::f64::consts::{PI, TAU};

use nalgebra::Vector3;

use super::scalar::{Scalar, dot};

/// Largest angle (radians) between tool axis and rotary axis that counts as parallel. Leaving the axis out
/// makes an error of this size, which must be below the 1e-10 that the inverse promises. Rounding of a unit
/// vector is 1e-16, and programs give seven decimals at most: 1e-11 lies between.
const POLE: f64 = 1e-11;

/// Largest distance (of unit vectors) by which a tool axis may lie beyond reach and still count as reached.
/// The answer is off by this distance, over the least sine that machines may have. A horizontal tool on a
/// 45 degree nutating table is exactly at the end of reach, and rounding of 1e-16 must not refuse it. A value
/// above 1e-11 breaks the promise of 1e-10.
const REACH: f64 = 1e-12;

/// The solutions for the two angles. Each array holds alpha and then beta, both in (-pi, pi].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Orientation<S> {
    /// The two solutions: branches 0 and 1.
    Two([[S; 2]; 2]),
    /// The tool axis is at the end of reach: the two solutions are this one.
    Touch([S; 2]),
    /// The tool axis is parallel to q: beta is free.
    Pole { alpha: S },
    /// No angles reach the tool axis.
    Unreachable,
}

/// Two rotary axes, with what the solution needs of them.
#[derive(Debug, Clone, PartialEq)]
pub struct RotaryPair {
    q: Vector3<f64>,
    /// Unit vectors across q: the direction of p across q, and q x p.
    across_q: [Vector3<f64>; 2],
    /// Unit vectors across p: the direction of z across p, and p x z.
    across_p: [Vector3<f64>; 2],
    /// p.q and the sine of the angle between p and q.
    cos: f64,
    sin: f64,
    /// p.z
    height: f64,
}

impl RotaryPair {
    /// The pair of the unit vectors `p`, nearer to the tool, and `q`, nearer to the workpiece. `p` must not
    /// be parallel to `q` or to Z.
    pub fn new(p: Vector3<f64>, q: Vector3<f64>) -> Self {
        let basis = |about: Vector3<f64>, toward: Vector3<f64>| {
            let second = about.cross(&toward).normalize();
            [second.cross(&about), second]
        };
        Self {
            q,
            across_q: basis(q, p),
            across_p: basis(p, Vector3::z()),
            cos: p.dot(&q),
            sin: p.cross(&q).norm(),
            height: p.z,
        }
    }

    /// The angles for a tool axis of any length.
    pub fn solve<S: Scalar>(&self, axis: [S; 3]) -> Orientation<S> {
        self.solve_from(axis, 0.0)
    }

    /// The direction across q of a tool axis, radians.
    pub fn direction(&self, axis: &Vector3<f64>) -> f64 {
        let [a, b] = self.across_q.map(|along| along.dot(axis));
        b.atan2(a)
    }

    /// The angles for a tool axis of any length. Directions across q count from `start` on, radians: balls
    /// around the angles are narrowest for the direction of the axis itself, above all beside the pole.
    pub fn solve_from<S: Scalar>(&self, axis: [S; 3], start: f64) -> Orientation<S> {
        let length = (axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]).sqrt();
        if !length.value().is_finite() {
            return Orientation::Unreachable;
        }
        let axis = axis.map(|x| x / length);
        let c = dot(axis, &self.q);
        let [a, b] = turned_back([0, 1].map(|k| dot(axis, &self.across_q[k])), start);
        let h = a.value().hypot(b.value());
        let m = (S::constant(self.height) - c.scale(self.cos)).scale(1.0 / self.sin);
        let excess = m.value().abs() - h;
        // A value that is not a number must not pass for reached.
        if excess.is_nan() || excess > REACH {
            return Orientation::Unreachable;
        }
        if h <= POLE {
            let zero = S::constant(0.0);
            return Orientation::Pole { alpha: self.alpha(c, [zero, zero]) };
        }
        let beta = |n: S| less((a * n - b * m).atan2(a * m + b * n), start);
        if excess >= 0.0 {
            let n = S::constant(0.0);
            return Orientation::Touch([self.alpha(c, [m, n]), beta(n)]);
        }
        let across = (a * a + b * b).sqrt();
        let n = ((across - m) * (across + m)).sqrt();
        Orientation::Two([n, -n].map(|n| [self.alpha(c, [m, n]), beta(n)]))
    }

    /// The angles along a path through the pole, where the equations of [`RotaryPair::solve`] are zero by
    /// zero. `across` is the part of the tool axis across q, divided by `way`: a signed way from the pole,
    /// which vanishes on it. Both solutions pass the pole without a turn of q: there the path of the tool
    /// axis goes straight on, and the angle about p changes its sign. Directions across q count from `start`
    /// on. `None` where the machine does not reach the pole.
    pub fn solve_through<S: Scalar>(
        &self,
        axis: [S; 3],
        (across, way): ([S; 3], S),
        start: f64,
    ) -> Option<[[S; 2]; 2]> {
        let length = (axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]).sqrt();
        if !length.value().is_finite() {
            return None;
        }
        let c = dot(axis, &self.q) / length;
        let pole = c.value().signum();
        if (self.height - pole * self.cos).abs() > REACH * self.sin {
            return None;
        }
        let [a, b] = turned_back([0, 1].map(|k| dot(across, &self.across_q[k]) / length), start);
        // The same equations, with h, m and n divided by the way.
        let square = a * a + b * b;
        let m = (way * square / (S::constant(1.0) + c.scale(pole))).scale(pole * self.cos / self.sin);
        let n = (square - m * m).sqrt();
        let beta = |n: S| less((a * n - b * m).atan2(a * m + b * n), start);
        let alpha = |n: S| self.alpha(c, [way * m, way * n]);
        Some([n, -n].map(|n| [alpha(n), beta(n)]))
    }

    /// The tool axes on the pole that the machine reaches.
    pub fn poles(&self) -> impl Iterator<Item = Vector3<f64>> + use<> {
        let reached = [1.0, -1.0].map(|pole| (self.height - pole * self.cos).abs() <= REACH * self.sin);
        let q = self.q;
        [q, -q].into_iter().zip(reached).filter_map(|(axis, is_reached)| is_reached.then_some(axis))
    }

    /// The angle about p from v to z. `c` is the component of v along q, `across` are those across q.
    fn alpha<S: Scalar>(&self, c: S, across: [S; 2]) -> S {
        let component = |along: &Vector3<f64>| {
            c.scale(self.q.dot(along))
                + across[0].scale(self.across_q[0].dot(along))
                + across[1].scale(self.across_q[1].dot(along))
        };
        (-component(&self.across_p[1])).atan2(component(&self.across_p[0]))
    }
}

/// A vector of the plane, turned back by an angle, radians.
fn turned_back<S: Scalar>([a, b]: [S; 2], angle: f64) -> [S; 2] {
    if angle == 0.0 {
        return [a, b];
    }
    let (sin, cos) = angle.sin_cos();
    [a.scale(cos) + b.scale(sin), b.scale(cos) - a.scale(sin)]
}

/// An angle less another, both in (-pi, pi], and so is the result.
fn less<S: Scalar>(angle: S, other: f64) -> S {
    if other == 0.0 {
        return angle;
    }
    let less = angle - S::constant(other);
    let turn = match less.value() {
        value if value > PI => TAU,
        value if value <= -PI => -TAU,
        _ => return less,
    };
    less - S::constant(turn)
}
