//! Numbers that are known but for an error: all numbers at most a radius from a centre.
//!
//! # Method
//! Each operation computes the centre of its result in floating point. The radius of the result is a bound of
//! two errors: what the radii of the operands can change in the result, and the rounding of the centre.
//!
//! # Guarantees
//! The ball of a result contains the exact result for all numbers in the balls of the operands. Only the
//! rounding of the radius itself is not counted: a part of 1e-15 of the radius.
//!
//! # Degenerate input
//! A division by a ball that contains zero, the root of a ball that reaches zero, and the angle of a vector
//! whose ball contains zero have an infinite radius.
//!
//! # Reference
//! J. van der Hoeven, "Ball arithmetic", Logical Approaches to Barriers in Computing and Complexity, 2009.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::scalar::Scalar;

/// The error of a sum, product, quotient or root, as a part of its result; and of a sine, a cosine or an
/// angle, which the standard library computes less accurately.
const ROUNDING: f64 = f64::EPSILON;
const ELEMENTARY: f64 = 4.0 * f64::EPSILON;

/// All numbers at most `radius` from `center`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ball {
    pub center: f64,
    pub radius: f64,
}

impl Ball {
    pub fn new(center: f64, radius: f64) -> Self {
        Self { center, radius }
    }

    /// The largest absolute value.
    pub fn most(self) -> f64 {
        self.center.abs() + self.radius
    }

    /// A ball whose center was rounded.
    fn rounded(center: f64, radius: f64) -> Self {
        Self { center, radius: radius + ROUNDING * center.abs() }
    }
}

impl Add for Ball {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::rounded(self.center + other.center, self.radius + other.radius)
    }
}

impl Sub for Ball {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self::rounded(self.center - other.center, self.radius + other.radius)
    }
}

impl Neg for Ball {
    type Output = Self;

    fn neg(self) -> Self {
        Self { center: -self.center, radius: self.radius }
    }
}

impl Mul for Ball {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let radius = self.most() * other.radius + self.radius * other.center.abs();
        Self::rounded(self.center * other.center, radius)
    }
}

impl Div for Ball {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let by = other.center.abs();
        let least = by - other.radius;
        if least <= 0.0 {
            return Self::new(0.0, f64::INFINITY);
        }
        let center = self.center / other.center;
        Self::rounded(center, (self.radius + center.abs() * other.radius) / least)
    }
}

impl Scalar for Ball {
    fn constant(value: f64) -> Self {
        Self::new(value, 0.0)
    }

    fn value(self) -> f64 {
        self.center
    }

    fn sqrt(self) -> Self {
        let least = self.center - self.radius;
        if least <= 0.0 {
            return Self::new(0.0, f64::INFINITY);
        }
        let center = self.center.sqrt();
        Self::rounded(center, self.radius / (center + least.sqrt()))
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.center.sin_cos();
        // The slope at the centre, and the most that it changes.
        let radius = |slope: f64| (self.radius * (slope.abs() + 0.5 * self.radius)).min(2.0) + ELEMENTARY;
        (Self::new(sin, radius(cos)), Self::new(cos, radius(sin)))
    }

    fn atan2(self, x: Self) -> Self {
        let center = self.center.atan2(x.center);
        // The sine of the largest angle to the vector of the centres.
        let sine = self.radius.hypot(x.radius) / self.center.hypot(x.center);
        let radius = if sine < 1.0 { sine / (1.0 - sine * sine).sqrt() } else { f64::INFINITY };
        Self::new(center, radius + ELEMENTARY * center.abs())
    }

    fn scale(self, factor: f64) -> Self {
        Self::rounded(self.center * factor, self.radius * factor.abs())
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn ball() -> impl Strategy<Value = (Ball, [f64; 3])> {
        let part = -1.0..=1.0f64;
        (-10.0..10.0f64, 0.0..2.0f64, [part.clone(), part.clone(), part]).prop_map(
            |(center, radius, parts)| (Ball::new(center, radius), parts.map(|part| center + part * radius)),
        )
    }

    fn contains(ball: Ball, value: f64) -> bool {
        // A result that does not exist must not be promised.
        if value.is_nan() { ball.radius == f64::INFINITY } else { (value - ball.center).abs() <= ball.radius }
    }

    proptest! {
        #[test]
        fn results_contain_the_results_of_all_members((a, of_a) in ball(), (b, of_b) in ball()) {
            let (sin, cos) = a.sin_cos();
            for (x, y) in of_a.into_iter().zip(of_b) {
                prop_assert!(contains(a + b, x + y));
                prop_assert!(contains(a - b, x - y));
                prop_assert!(contains(a * b, x * y));
                prop_assert!(contains(a / b, x / y));
                prop_assert!(contains(a.sqrt(), x.sqrt()));
                prop_assert!(contains(sin, x.sin()) && contains(cos, x.cos()));
                prop_assert!(contains(a.scale(-0.3), x * -0.3));
                // An angle may be a full turn away.
                let turn = std::f64::consts::TAU;
                let angle = x.atan2(y);
                prop_assert!([-turn, 0.0, turn].iter().any(|turn| contains(a.atan2(b), angle + turn)));
            }
        }
    }

    #[test]
    fn numbers_that_are_known_exactly_have_the_radius_of_their_rounding() {
        let third = Ball::constant(1.0) / Ball::constant(3.0);
        assert!(third.radius > 0.0 && third.radius < 1e-16);
        assert_eq!(Ball::constant(0.0).scale(5.0), Ball::constant(0.0));
    }
}
