//! Interval arithmetic with outward rounding. An operation takes intervals and returns an interval.
//!
//! # Guarantees
//! The interval of the result contains the exact result for all numbers in the intervals of the operands. For
//! sums, differences, products, quotients and square roots, the processor rounds the exact value to the
//! nearest floating-point number. So it is enough to move each end of the result outward to the next
//! floating-point number. The standard library computes the functions of [`elementary`] less accurately. For
//! these functions, each end moves outward by several floating-point numbers.
//!
//! # Degenerate input
//! If an end of the result would be NaN, the result is the whole line, from minus to plus infinity. A
//! quotient is the whole line if the divisor contains zero.
//!
//! # Reference
//! R. E. Moore, R. B. Kearfott, M. J. Cloud, *Introduction to Interval Analysis*, SIAM, 2009.

pub mod elementary;

use std::ops::{Add, Mul, Neg, Sub};

/// All numbers from `lo` to `hi`; the ends may be infinite.
///
/// # Example
/// ```
/// use toolpathd_core::geometry::interval::Interval;
///
/// // Ten times the number nearest to 0.1 is not 1, but an interval around 1/10 keeps the exact sum.
/// let tenth = Interval::ONE.div(Interval::point(10.0));
/// let sum = (0..10).fold(Interval::ZERO, |sum, _| sum + tenth);
/// assert!(sum.contains(1.0) && sum.width() < 1e-14);
/// assert_ne!((0..10).map(|_| 0.1).sum::<f64>(), 1.0);
///
/// // x * x does not know that both factors are the same number; `sqr` does.
/// let x = Interval::between(-1.0, 2.0);
/// assert!((x * x).contains(-2.0) && !x.sqr().contains(-0.1));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    lo: f64,
    hi: f64,
}

impl Interval {
    /// The whole line.
    pub const ENTIRE: Interval = Interval { lo: f64::NEG_INFINITY, hi: f64::INFINITY };
    pub const ZERO: Interval = Interval { lo: 0.0, hi: 0.0 };
    pub const ONE: Interval = Interval { lo: 1.0, hi: 1.0 };

    /// The numbers between two numbers in any order; the whole line if either is NaN.
    pub fn between(a: f64, b: f64) -> Self {
        if a <= b {
            Self { lo: a, hi: b }
        } else if b <= a {
            Self { lo: b, hi: a }
        } else {
            Self::ENTIRE
        }
    }

    /// One number.
    pub fn point(x: f64) -> Self {
        Self::between(x, x)
    }

    /// The numbers at most `radius` away from `center`, which must not be negative.
    pub fn around(center: f64, radius: f64) -> Self {
        outward(center - radius, center + radius)
    }

    pub fn lo(self) -> f64 {
        self.lo
    }

    pub fn hi(self) -> f64 {
        self.hi
    }

    /// A number near the middle; for an unbounded interval a finite member.
    pub fn mid(self) -> f64 {
        let mid = 0.5 * self.lo + 0.5 * self.hi;
        if mid.is_finite() { mid } else { 0.0f64.clamp(self.lo.max(f64::MIN), self.hi.min(f64::MAX)) }
    }

    pub fn width(self) -> f64 {
        (self.hi - self.lo).next_up()
    }

    /// The largest absolute value of a member.
    pub fn mag(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    /// The least absolute value of a member.
    pub fn mig(self) -> f64 {
        if self.contains(0.0) { 0.0 } else { self.lo.abs().min(self.hi.abs()) }
    }

    pub fn contains(self, x: f64) -> bool {
        self.lo <= x && x <= self.hi
    }

    pub fn is_bounded(self) -> bool {
        self.lo.is_finite() && self.hi.is_finite()
    }

    /// The least interval that contains both intervals.
    pub fn hull(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// The intersection of two enclosures of the same number; `self` if they do not meet and so enclose none.
    pub fn meet(self, other: Self) -> Self {
        let (lo, hi) = (self.lo.max(other.lo), self.hi.min(other.hi));
        if lo <= hi { Self { lo, hi } } else { self }
    }

    pub fn sqr(self) -> Self {
        let (least, most) = (self.mig(), self.mag());
        let square = outward(least * least, most * most);
        Self { lo: square.lo.max(0.0), hi: square.hi }
    }

    /// The square roots of the members that are not negative; zero if all members are negative.
    pub fn sqrt(self) -> Self {
        if self.hi <= 0.0 {
            return Self::ZERO;
        }
        let root = outward(self.lo.max(0.0).sqrt(), self.hi.sqrt());
        Self { lo: root.lo.max(0.0), hi: root.hi }
    }

    /// The quotients; the whole line if the divisor contains zero.
    #[expect(clippy::should_implement_trait, reason = "no sign hides that it may say nothing")]
    pub fn div(self, divisor: Self) -> Self {
        if divisor.contains(0.0) {
            return Self::ENTIRE;
        }
        if self == Self::ZERO {
            return self;
        }
        of_corners([self.lo / divisor.lo, self.lo / divisor.hi, self.hi / divisor.lo, self.hi / divisor.hi])
    }

    pub fn abs(self) -> Self {
        Self { lo: self.mig(), hi: self.mag() }
    }
}

/// The interval with its ends moved outward to the next number; the whole line if an end is NaN.
pub(crate) fn outward(lo: f64, hi: f64) -> Interval {
    if lo <= hi { Interval { lo: lo.next_down(), hi: hi.next_up() } } else { Interval::ENTIRE }
}

/// An interval whose ends are sums, moved outward to the next number. A sum that comes out as zero is exactly
/// zero and stays. This also avoids subnormal numbers, which are slow on many processors.
fn of_sums(lo: f64, hi: f64) -> Interval {
    let sums = outward(lo, hi);
    Interval { lo: if lo == 0.0 { 0.0 } else { sums.lo }, hi: if hi == 0.0 { 0.0 } else { sums.hi } }
}

/// The hull of four products or quotients; the whole line if one of them is NaN, as zero times infinity is.
fn of_corners([a, b, c, d]: [f64; 4]) -> Interval {
    // The sum is NaN if one term is NaN, or if both infinities are among the terms.
    if (a + b + c + d).is_nan() {
        return Interval::ENTIRE;
    }
    // Faster than `f64::min` and `f64::max`, which check for NaN; the innermost loops run this.
    let least = |x, y| if x < y { x } else { y };
    let most = |x, y| if x > y { x } else { y };
    outward(least(least(a, b), least(c, d)), most(most(a, b), most(c, d)))
}

impl Add for Interval {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        of_sums(self.lo + other.lo, self.hi + other.hi)
    }
}

impl Sub for Interval {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        of_sums(self.lo - other.hi, self.hi - other.lo)
    }
}

impl Neg for Interval {
    type Output = Self;

    fn neg(self) -> Self {
        Self { lo: -self.hi, hi: -self.lo }
    }
}

impl Mul for Interval {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        if (self == Self::ZERO && other.is_bounded()) || (other == Self::ZERO && self.is_bounded()) {
            return Self::ZERO;
        }
        of_corners([self.lo * other.lo, self.lo * other.hi, self.hi * other.lo, self.hi * other.hi])
    }
}

impl Mul<f64> for Interval {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        if self == Self::ZERO && factor.is_finite() {
            return self;
        }
        let (a, b) = (self.lo * factor, self.hi * factor);
        outward(a.min(b), a.max(b))
    }
}
