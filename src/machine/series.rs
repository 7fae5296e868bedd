//! Numbers with three derivatives, as truncated Taylor series.
//!
//! # Method
//! A function of the path parameter is stored as its first four Taylor coefficients. Each operation computes
//! the coefficients of its result from those of its operands by the usual recurrences (Griewank and Walther,
//! table 13.1 and 13.2).
//!
//! # Guarantees
//! Coefficients are exact except for rounding. No step size is involved.
//!
//! # Degenerate input
//! A division by zero, the square root of zero and the angle of the zero vector give coefficients that are
//! infinite or NaN.
//!
//! # Cost
//! Constant for each operation: at most ten products for a product of two series.
//!
//! # Reference
//! A. Griewank, A. Walther, *Evaluating Derivatives*, second edition, SIAM, 2008, chapter 13.

use std::array::from_fn;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::scalar::Scalar;

/// Value and derivatives: the number of coefficients.
const TERMS: usize = 4;

/// Factorials of the orders: derivative = factorial times coefficient.
const FACTORIALS: [f64; TERMS] = [1.0, 1.0, 2.0, 6.0];

/// The Taylor coefficients of orders 0 to 3.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Series([f64; TERMS]);

impl Series {
    /// The series of a function with the given value and first three derivatives.
    pub fn from_derivatives(derivatives: [f64; TERMS]) -> Self {
        Self(from_fn(|k| derivatives[k] / FACTORIALS[k]))
    }

    /// The value and the first three derivatives.
    pub fn derivatives(self) -> [f64; TERMS] {
        from_fn(|k| self.0[k] * FACTORIALS[k])
    }

    /// The derivative as a series. Its last coefficient is not known and stands as zero.
    fn derivative(self) -> Self {
        Self([self.0[1], 2.0 * self.0[2], 3.0 * self.0[3], 0.0])
    }
}

impl Add for Series {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(from_fn(|k| self.0[k] + other.0[k]))
    }
}

impl Sub for Series {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self(from_fn(|k| self.0[k] - other.0[k]))
    }
}

impl Neg for Series {
    type Output = Self;

    fn neg(self) -> Self {
        Self(self.0.map(|c| -c))
    }
}

impl Mul for Series {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self(from_fn(|k| (0..=k).map(|i| self.0[i] * other.0[k - i]).sum()))
    }
}

impl Div for Series {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let mut quotient = [0.0; TERMS];
        for k in 0..TERMS {
            let known: f64 = (1..=k).map(|i| other.0[i] * quotient[k - i]).sum();
            quotient[k] = (self.0[k] - known) / other.0[0];
        }
        Self(quotient)
    }
}

impl Scalar for Series {
    fn constant(value: f64) -> Self {
        Self([value, 0.0, 0.0, 0.0])
    }

    fn value(self) -> f64 {
        self.0[0]
    }

    fn sqrt(self) -> Self {
        let mut root = [self.0[0].sqrt(), 0.0, 0.0, 0.0];
        for k in 1..TERMS {
            let known: f64 = (1..k).map(|i| root[i] * root[k - i]).sum();
            root[k] = (self.0[k] - known) / (2.0 * root[0]);
        }
        Self(root)
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.0[0].sin_cos();
        let (mut sin, mut cos) = ([sin, 0.0, 0.0, 0.0], [cos, 0.0, 0.0, 0.0]);
        for k in 1..TERMS {
            let rate = |of: &[f64; TERMS]| -> f64 { (1..=k).map(|i| i as f64 * self.0[i] * of[k - i]).sum() };
            let (up, down) = (rate(&cos), rate(&sin));
            sin[k] = up / k as f64;
            cos[k] = -down / k as f64;
        }
        (Self(sin), Self(cos))
    }

    fn atan2(self, x: Self) -> Self {
        let rate = (x * self.derivative() - self * x.derivative()) / (x * x + self * self);
        Self([self.0[0].atan2(x.0[0]), rate.0[0], rate.0[1] / 2.0, rate.0[2] / 3.0])
    }

    fn scale(self, factor: f64) -> Self {
        Self(self.0.map(|c| c * factor))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const T: Series = Series([0.7, 1.0, 0.0, 0.0]);

    fn assert_near(series: Series, expected: [f64; 4]) {
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
