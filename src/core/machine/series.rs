//! Numbers with derivatives, as truncated Taylor series.
//!
//! # Method
//! A function of the path parameter is stored as its first N Taylor coefficients. An operation takes the
//! coefficients of its operands and computes the coefficients of its result, by the recurrences of Griewank
//! and Walther, tables 13.1 and 13.2. Coefficients are plain numbers, or balls (`ball`).
//!
//! # Guarantees
//! * Coefficients are exact except for rounding. No step size is involved.
//! * Where balls enclose the coefficients of the operands at all places of a range, the balls of the result
//!   enclose its coefficients at all these places.
//!
//! # Degenerate input
//! A division by zero, the square root of zero and the angle of the zero vector give coefficients that are
//! infinite or NaN.
//!
//! # Cost
//! Constant for each operation: ten products of coefficients for a product of two series with four of them.
//!
//! # Reference
//! A. Griewank, A. Walther, *Evaluating Derivatives*, second edition, SIAM, 2008, chapter 13.

use std::array::from_fn;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::scalar::Scalar;

/// The Taylor coefficients of orders 0 to N - 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Series<C, const N: usize>(pub [C; N]);

impl<C: Scalar, const N: usize> Series<C, N> {
    /// The derivative as a series. Its last coefficient is not known and stands as zero.
    fn derivative(self) -> Self {
        let order = |k: usize| {
            self.0.get(k + 1).map_or(C::constant(0.0), |coefficient| coefficient.scale((k + 1) as f64))
        };
        Self(from_fn(order))
    }
}

impl<const N: usize> Series<f64, N> {
    /// The series of a function with the given value and first derivatives.
    pub fn from_derivatives(derivatives: [f64; N]) -> Self {
        Self(from_fn(|k| derivatives[k] / factorial(k)))
    }

    /// The value and the first derivatives.
    pub fn derivatives(self) -> [f64; N] {
        from_fn(|k| self.0[k] * factorial(k))
    }
}

/// The derivative of order k is this times the coefficient.
pub fn factorial(k: usize) -> f64 {
    (1..=k).map(|i| i as f64).product()
}

/// The sum of `term` from 1 to `last`.
fn sum<C: Scalar>(last: usize, term: impl Fn(usize) -> C) -> C {
    (1..=last).fold(C::constant(0.0), |sum, k| sum + term(k))
}

impl<C: Scalar, const N: usize> Add for Series<C, N> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(from_fn(|k| self.0[k] + other.0[k]))
    }
}

impl<C: Scalar, const N: usize> Sub for Series<C, N> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self(from_fn(|k| self.0[k] - other.0[k]))
    }
}

impl<C: Scalar, const N: usize> Neg for Series<C, N> {
    type Output = Self;

    fn neg(self) -> Self {
        Self(self.0.map(|c| -c))
    }
}

impl<C: Scalar, const N: usize> Mul for Series<C, N> {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self(from_fn(|k| (1..=k).fold(self.0[0] * other.0[k], |sum, i| sum + self.0[i] * other.0[k - i])))
    }
}

impl<C: Scalar, const N: usize> Div for Series<C, N> {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let mut quotient = [C::constant(0.0); N];
        for k in 0..N {
            let known = sum(k, |i| other.0[i] * quotient[k - i]);
            quotient[k] = (self.0[k] - known) / other.0[0];
        }
        Self(quotient)
    }
}

impl<C: Scalar, const N: usize> Scalar for Series<C, N> {
    fn constant(value: f64) -> Self {
        Self(from_fn(|k| C::constant(if k == 0 { value } else { 0.0 })))
    }

    fn value(self) -> f64 {
        self.0[0].value()
    }

    fn sqrt(self) -> Self {
        let mut root = [C::constant(0.0); N];
        root[0] = self.0[0].sqrt();
        for k in 1..N {
            let known = sum(k - 1, |i| root[i] * root[k - i]);
            root[k] = (self.0[k] - known) / root[0].scale(2.0);
        }
        Self(root)
    }

    fn sin_cos(self) -> (Self, Self) {
        let (mut sin, mut cos) = ([C::constant(0.0); N], [C::constant(0.0); N]);
        (sin[0], cos[0]) = self.0[0].sin_cos();
        for k in 1..N {
            let rate = |of: &[C; N]| sum(k, |i| (self.0[i] * of[k - i]).scale(i as f64 / k as f64));
            (sin[k], cos[k]) = (rate(&cos), -rate(&sin));
        }
        (Self(sin), Self(cos))
    }

    fn atan2(self, x: Self) -> Self {
        let rate = (x * self.derivative() - self * x.derivative()) / (x * x + self * self);
        let angle = self.0[0].atan2(x.0[0]);
        Self(from_fn(|k| if k == 0 { angle } else { rate.0[k - 1].scale(1.0 / k as f64) }))
    }

    fn scale(self, factor: f64) -> Self {
        Self(self.0.map(|c| c.scale(factor)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const T: Series<f64, 4> = Series([0.7, 1.0, 0.0, 0.0]);

    fn assert_near(series: Series<f64, 4>, expected: [f64; 4]) {
        for (got, want) in series.derivatives().into_iter().zip(expected) {
            assert!((got - want).abs() < 1e-13 * want.abs().max(1.0), "{series:?} {expected:?}");
        }
    }

    #[test]
    fn elementary_functions_have_their_known_derivatives() {
        let (sin, cos) = T.sin_cos();
        let (s, c) = 0.7f64.sin_cos();
        assert_near(sin, [s, c, -s, -c]);
        assert_near(cos, [c, -s, -c, s]);
        let root = 0.7f64.sqrt();
        assert_near(T.sqrt(), [root, 0.5 / root, -0.25 / root.powi(3), 0.375 / root.powi(5)]);
        let one = Series::constant(1.0);
        assert_near(one / T, [1.0 / 0.7, -1.0 / 0.49, 2.0 / 0.7f64.powi(3), -6.0 / 0.7f64.powi(4)]);
        let d = 1.0 + 0.49;
        let second = (6.0 * 0.49 - 2.0) / (d * d * d);
        assert_near(T.atan2(one), [0.7f64.atan(), 1.0 / d, -1.4 / (d * d), second]);
    }

    #[test]
    fn the_angle_of_a_turning_vector_is_the_angle_it_turned_by() {
        for start in [-3.0, -1.0, 0.5, 2.5] {
            let angle = Series::from_derivatives([start, 0.3, -2.0, 1.5]);
            let (sin, cos) = angle.sin_cos();
            let length = Series::from_derivatives([2.0, 5.0, -1.0, 3.0]);
            assert_near((length * sin).atan2(length * cos), angle.derivatives());
        }
    }

    #[test]
    fn products_undo_quotients_and_squares_undo_roots() {
        let (a, b) = (Series([2.0, -1.0, 0.5, 3.0]), Series([1.5, 0.25, -2.0, 1.0]));
        assert_near(a / b * b, a.derivatives());
        assert_near(a.sqrt() * a.sqrt(), a.derivatives());
        assert_near(a - b + -a, (-b).derivatives());
    }
}
