//! Sets that contain every value of a polynomial over a patch: a ball if the values are vectors, an interval
//! if they are numbers.

use nalgebra::Vector3;

/// Every vector within `radius` of `center`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VectorBall {
    pub center: Vector3<f64>,
    pub radius: f64,
}

/// Every number within `radius` of `center`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CenteredInterval {
    pub center: f64,
    pub radius: f64,
}

impl CenteredInterval {
    /// The interval from the least to the largest of `values`, widened by `rounding` on both sides.
    pub fn around(values: impl Iterator<Item = f64>, rounding: f64) -> Self {
        let (low, high) =
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        Self { center: 0.5 * (low + high), radius: 0.5 * (high - low) + rounding }
    }

    /// The interval of the quotients 1 / x, for an interval above zero.
    pub fn inverse(self) -> Self {
        let (low, high) = (1.0 / (self.center + self.radius), 1.0 / (self.center - self.radius));
        Self { center: 0.5 * (low + high), radius: 0.5 * (high - low) }
    }
}

impl VectorBall {
    pub const ZERO: VectorBall = VectorBall { center: Vector3::new(0.0, 0.0, 0.0), radius: 0.0 };

    /// A ball about the mean of `vectors` that contains them all. There is at least one vector. `rounding` is
    /// the rounding error of the vectors and widens the ball.
    pub fn around(vectors: impl Iterator<Item = Vector3<f64>> + Clone, rounding: f64) -> Self {
        let (sum, count) = vectors.clone().fold((Vector3::zeros(), 0.0), |(sum, n), v| (sum + v, n + 1.0));
        let center: Vector3<f64> = sum / count;
        let squared = vectors.map(|v| (v - center).norm_squared()).fold(0.0, f64::max);
        Self { center, radius: squared.sqrt() + rounding }
    }

    pub fn scaled(self, factor: f64) -> Self {
        Self { center: self.center * factor, radius: self.radius * factor.abs() }
    }

    pub fn plus(self, other: VectorBall) -> Self {
        Self { center: self.center + other.center, radius: self.radius + other.radius }
    }

    pub fn minus(self, other: VectorBall) -> Self {
        self.plus(other.scaled(-1.0))
    }

    /// A ball that contains every product of a vector of this ball and a number of `factor`.
    pub fn times(self, factor: CenteredInterval) -> Self {
        let radius = self.radius * factor.center.abs() + self.reach() * factor.radius;
        Self { center: self.center * factor.center, radius }
    }

    /// The largest length of a vector in the ball.
    pub fn reach(self) -> f64 {
        self.center.norm() + self.radius
    }

    pub fn cross(self, other: VectorBall) -> Self {
        let radius = self.center.norm() * other.radius + self.radius * other.reach();
        Self { center: self.center.cross(&other.center), radius }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn the_result_of_an_operation_contains_the_results_for_all_members(
            c in prop::array::uniform6(-3.0f64..3.0),
            d in prop::array::uniform6(-0.5f64..0.5),
            r in prop::array::uniform3(0.0f64..2.0),
            s in -1.0f64..1.0,
        ) {
            let v = |k: usize| Vector3::new(c[k], c[k + 1], c[k + 2]);
            let unit = |k: usize| Vector3::new(d[k], d[k + 1], d[k + 2]);
            let (a, b) = (VectorBall { center: v(0), radius: r[0] }, VectorBall { center: v(3), radius: r[1] });
            let (x, y) = (a.center + unit(0) * r[0], b.center + unit(3) * r[1]);
            let number = CenteredInterval { center: 3.0 + c[0], radius: 0.4 * (3.0 + c[0]) * r[2] / 2.0 };
            let t = number.center + s * number.radius;
            let holds = |ball: VectorBall, x: Vector3<f64>| (x - ball.center).norm() <= ball.radius + 1e-12;
            prop_assert!(holds(a.plus(b), x + y));
            prop_assert!(holds(a.minus(b), x - y));
            prop_assert!(holds(a.cross(b), x.cross(&y)));
            prop_assert!(holds(a.times(number), x * t));
            prop_assert!(holds(a.scaled(s), x * s));
            prop_assert!((number.inverse().center - 1.0 / t).abs() <= number.inverse().radius + 1e-12 / t);
        }
    }
}
