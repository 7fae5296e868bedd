//! Bounds of the use of the limits over a range of the parameter, from bounds of the derivatives of the path.
//!
//! # Method
//! 1. Over the range, each derivative of a coordinate is a polynomial about the middle and a remainder: the
//!    fourth derivative is a number with an error.
//! 2. The square of the speed of u is a parabola b. The squares of speed, acceleration and jerk of a
//!    coordinate q are q'^2 b, (q'' b + q' b'/2)^2 and b (q''' b + 3/2 q'' b' + 1/2 q' b'')^2: polynomials.
//!    The squares of the coordinates of a vector are added.
//! 3. The quadratic part of a polynomial has its largest value in closed form. The coefficients of higher
//!    orders are added.
//! 4. In the first and last interval speed, acceleration and jerk of u are monotonic. There ranges are
//!    multiplied and added.
//!
//! # Guarantees
//! But for rounding, no limit is exceeded in the range after [`Schedule::slowed`] by the bound. The bound
//! approaches the true use with the square of the length of the range; in the first and last interval in
//! proportion to it.

use super::profile::{Part, Ranges, Schedule};
use super::station::{Limits, TipLimits};

/// One coordinate over a range of the parameter.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Expansion {
    /// The Taylor coefficients of orders 1 to 4 in the middle: the derivative of order k divided by k!.
    pub middle: [f64; 4],
    /// How far the coefficient of order 4 differs from this anywhere in the range, at most.
    pub error: f64,
}

/// A path over a range of the parameter, and what limits the motion along it.
#[derive(Debug, Clone, Copy)]
pub struct Course<'a> {
    pub range: [f64; 2],
    pub coordinates: &'a [Expansion],
    /// One for each coordinate.
    pub limits: &'a [Limits],
    /// Of the vector of the first three coordinates.
    pub tip: Option<&'a TipLimits>,
    /// The point that moves at the feed at most, and the feed.
    pub paced: &'a [Expansion; 3],
    pub feed: f64,
}

/// The factor by which the motion has to be slowed to keep all limits; below 1, limits are left to spare.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slowdown {
    /// In the middle of the range.
    pub at_middle: f64,
    /// Anywhere in the range, at most.
    pub bound: f64,
}

impl Slowdown {
    /// Of the use of a limit that grows with the speed to the power of `order`: in the middle, and its bound.
    fn new(uses: [f64; 2], limit: f64, order: usize) -> Self {
        let [at_middle, bound] = uses.map(|used| {
            let part = used / limit;
            [part, part.sqrt(), part.cbrt()][order - 1]
        });
        Self { at_middle, bound }
    }

    fn max(self, other: Self) -> Self {
        Self { at_middle: self.at_middle.max(other.at_middle), bound: self.bound.max(other.bound) }
    }
}

impl Schedule {
    /// What the limits need over a range inside the interval `k` of [`Schedule::intervals`].
    pub fn slowdown_for(&self, k: usize, course: &Course) -> Slowdown {
        let w = 0.5 * (course.range[1] - course.range[0]);
        let part = self.part(k, course.range);
        let uses = |expansion: &Expansion| match &part {
            Part::Rest(ranges) => Uses::of_ranges(expansion, ranges, w),
            Part::Moving(parabola) => Uses::of_parabola(expansion, parabola, w),
        };
        let paced = course.paced.iter().map(uses).fold(Uses::default(), Uses::beside);
        let mut all = Slowdown::new(paced.largest(1), course.feed, 1);
        let mut tip = Uses::default();
        for (k, (expansion, limits)) in course.coordinates.iter().zip(course.limits).enumerate() {
            let own = uses(expansion);
            for (order, limit) in [(1, limits.speed), (2, limits.acceleration), (3, limits.jerk)] {
                all = all.max(Slowdown::new(own.largest(order), limit, order));
            }
            if k < 3 {
                tip = tip.beside(own);
            }
        }
        if let Some(limits) = course.tip {
            for (order, limit) in [(2, limits.acceleration), (3, limits.jerk)] {
                all = all.max(Slowdown::new(tip.largest(order), limit, order));
            }
        }
        all
    }
}

/// A polynomial of the place in the range, which goes from -1 to 1.
type Polynomial = [f64; 9];

/// Speed, acceleration and jerk of a coordinate or of a vector.
#[derive(Debug, Clone, Copy, Default)]
struct Uses {
    /// Squares of approximations.
    squares: [Polynomial; 3],
    /// The most by which the exact value differs from the approximation.
    errors: [f64; 3],
}

impl Uses {
    /// Where the square of the speed of u has these coefficients about the middle.
    fn of_parabola(expansion: &Expansion, [b0, b1, b2]: &[f64; 3], w: f64) -> Self {
        let Expansion { middle: [c1, c2, c3, c4], error } = *expansion;
        let b = [*b0, b1 * w, b2 * w * w];
        let slope = [*b1, 2.0 * b2 * w];
        let first = [c1, 2.0 * c2 * w, 3.0 * c3 * w * w, 4.0 * c4 * w * w * w];
        let second = [2.0 * c2, 6.0 * c3 * w, 12.0 * c4 * w * w];
        let third = [6.0 * c3, 24.0 * c4 * w];
        let errors = [4.0 * error * w * w * w, 12.0 * error * w * w, 24.0 * error * w];
        let (most, steepest) = (most(&b).max(0.0), slope[0].abs() + slope[1].abs());

        let acceleration = add(&product(&second, &b), &product(&first, &slope.map(|c| 0.5 * c)));
        let turning = add(&product(&second, &slope.map(|c| 1.5 * c)), &product(&first, &[*b2]));
        let jerk = add(&product(&third, &b), &turning);
        Self {
            squares: [
                product(&product(&first, &first)[..7], &b),
                product(&acceleration[..5], &acceleration[..5]),
                product(&product(&jerk[..4], &jerk[..4])[..7], &b),
            ],
            errors: [
                errors[0] * most.sqrt(),
                errors[1] * most + 0.5 * errors[0] * steepest,
                (errors[2] * most + 1.5 * errors[1] * steepest + errors[0] * b2.abs()) * most.sqrt(),
            ],
        }
    }

    /// In the first or last interval: the middles of ranges, and half of their lengths.
    fn of_ranges(expansion: &Expansion, motion: &Ranges, w: f64) -> Self {
        let Expansion { middle: [c1, c2, c3, c4], error } = *expansion;
        let fourth = c4.abs() + error;
        let around = |middle: f64, by: f64| [middle - by, middle + by];
        let first = around(c1, w * (2.0 * c2.abs() + w * (3.0 * c3.abs() + 4.0 * w * fourth)));
        let second = around(2.0 * c2, w * (6.0 * c3.abs() + 12.0 * w * fourth));
        let third = around(6.0 * c3, 24.0 * w * fourth);

        let Ranges { speed, acceleration, jerk } = *motion;
        let square = [speed[0] * speed[0], speed[1] * speed[1]];
        let cube = [square[0] * speed[0], square[1] * speed[1]];
        let mixed = times(speed, acceleration).map(|end| 3.0 * end);
        let ranges = [
            times(first, speed),
            plus(times(second, square), times(first, acceleration)),
            plus(plus(times(third, cube), times(second, mixed)), times(first, jerk)),
        ];
        let square_of_middle = |[low, high]: [f64; 2]| {
            let mut constant = Polynomial::default();
            constant[0] = 0.25 * (low + high) * (low + high);
            constant
        };
        Self { squares: ranges.map(square_of_middle), errors: ranges.map(|[low, high]| 0.5 * (high - low)) }
    }

    /// The vector of this and another coordinate.
    fn beside(self, other: Self) -> Self {
        Self {
            squares: [0, 1, 2].map(|k| add(&self.squares[k], &other.squares[k])),
            errors: [0, 1, 2].map(|k| self.errors[k].hypot(other.errors[k])),
        }
    }

    /// The value in the middle, and the bound: of speed, acceleration or jerk, by order.
    fn largest(&self, order: usize) -> [f64; 2] {
        let square = &self.squares[order - 1];
        [square[0].max(0.0).sqrt(), most(square).max(0.0).sqrt() + self.errors[order - 1]]
    }
}

/// An upper bound of the values of a polynomial from -1 to 1.
fn most(polynomial: &[f64]) -> f64 {
    let [c0, c1, c2] = [polynomial[0], polynomial[1], polynomial[2]];
    let has_top_inside = c2 < -0.5 * c1.abs();
    let quadratic = if has_top_inside { c0 - 0.25 * c1 * c1 / c2 } else { c0 + c1.abs() + c2 };
    quadratic + polynomial[3..].iter().map(|c| c.abs()).sum::<f64>()
}

fn product(a: &[f64], b: &[f64]) -> Polynomial {
    let mut product = Polynomial::default();
    for (i, a) in a.iter().enumerate() {
        for (k, b) in b.iter().enumerate() {
            product[i + k] += a * b;
        }
    }
    product
}

fn add(a: &Polynomial, b: &Polynomial) -> Polynomial {
    std::array::from_fn(|k| a[k] + b[k])
}

/// The product of two ranges.
fn times([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    let all = [a * c, a * d, b * c, b * d];
    [all.iter().copied().fold(f64::INFINITY, f64::min), all.iter().copied().fold(f64::NEG_INFINITY, f64::max)]
}

fn plus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] + b[0], a[1] + b[1]]
}
