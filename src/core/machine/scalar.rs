//! The numbers that the inverse kinematics calculates with: plain numbers, balls, or numbers with
//! derivatives.

use std::ops::{Add, Div, Mul, Neg, Sub};

use nalgebra::Vector3;

/// A number with the functions that the inverse kinematics needs.
///
/// # Guarantees
/// [`Scalar::value`] of a result equals the result of the same calculation with plain numbers, but for
/// rounding.
pub trait Scalar:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// A number that does not change along the path.
    fn constant(value: f64) -> Self;

    /// The number without its derivatives; the centre of a ball.
    fn value(self) -> f64;

    fn sqrt(self) -> Self;

    /// The sine and the cosine of an angle in radians.
    fn sin_cos(self) -> (Self, Self);

    /// The angle of the vector (`x`, `self`), radians, in (-pi, pi].
    fn atan2(self, x: Self) -> Self;

    /// The number times a constant.
    fn scale(self, factor: f64) -> Self;
}

impl Scalar for f64 {
    fn constant(value: f64) -> Self {
        value
    }

    fn value(self) -> f64 {
        self
    }

    fn sqrt(self) -> Self {
        self.sqrt()
    }

    fn sin_cos(self) -> (Self, Self) {
        self.sin_cos()
    }

    fn atan2(self, x: Self) -> Self {
        self.atan2(x)
    }

    fn scale(self, factor: f64) -> Self {
        self * factor
    }
}

/// A vector with constant coordinates.
pub fn constant<S: Scalar>(v: &Vector3<f64>) -> [S; 3] {
    [v.x, v.y, v.z].map(S::constant)
}

/// The scalar product of a vector and a constant vector.
pub fn dot<S: Scalar>(a: [S; 3], b: &Vector3<f64>) -> S {
    a[0].scale(b.x) + a[1].scale(b.y) + a[2].scale(b.z)
}

pub fn add<S: Scalar>(a: [S; 3], b: [S; 3]) -> [S; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub fn subtract<S: Scalar>(a: [S; 3], b: [S; 3]) -> [S; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The vector turned by `angle` (radians, right-handed) about the constant unit vector `about`.
pub fn rotate<S: Scalar>(about: &Vector3<f64>, angle: S, v: [S; 3]) -> [S; 3] {
    let (sin, cos) = angle.sin_cos();
    let along = dot(v, about) * (S::constant(1.0) - cos);
    let across = [
        v[2].scale(about.y) - v[1].scale(about.z),
        v[0].scale(about.z) - v[2].scale(about.x),
        v[1].scale(about.x) - v[0].scale(about.y),
    ];
    [0, 1, 2].map(|k| v[k] * cos + across[k] * sin + along.scale(about[k]))
}
