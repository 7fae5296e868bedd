//! Interval arithmetic with outward rounding.
//!
//! # Guarantees
//! The result of an operation holds every value that the operation has on members of its operands. Each end
//! is computed to the nearest number and moved one number outward, which is enough where the operation itself
//! is correctly rounded.
//!
//! # Degenerate input
//! A result that cannot be told, because an end would be no number, is the whole line.
//!
//! # Reference
//! R. E. Moore, R. B. Kearfott, M. J. Cloud, *Introduction to Interval Analysis*, SIAM, 2009.

pub mod elementary;

use std::ops::{Add, Mul, Neg, Sub};

/// All numbers from `lo` to `hi`; the ends may be infinite.
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

    /// The numbers between two, in any order; the whole line when one is no number.
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

    /// A number near the middle; of an unbounded interval some finite member.
    pub fn mid(self) -> f64 {
        let mid = 0.5 * self.lo + 0.5 * self.hi;
        if mid.is_finite() { mid } else { 0.0f64.clamp(self.lo.max(f64::MIN), self.hi.min(f64::MAX)) }
    }

    pub fn width(self) -> f64 {
        (self.hi - self.lo).next_up()
    }

    /// The largest absolute value.
    pub fn mag(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    /// The least absolute value.
    pub fn mig(self) -> f64 {
        if self.contains(0.0) { 0.0 } else { self.lo.abs().min(self.hi.abs()) }
    }

    pub fn contains(self, x: f64) -> bool {
        self.lo <= x && x <= self.hi
    }

    pub fn is_bounded(self) -> bool {
        self.lo.is_finite() && self.hi.is_finite()
    }

    /// The least interval that holds both.
    pub fn hull(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// What two enclosures of the same number leave; `self` where they do not meet, which they only do in
    /// vain.
    pub fn meet(self, other: Self) -> Self {
        let (lo, hi) = (self.lo.max(other.lo), self.hi.min(other.hi));
        if lo <= hi { Self { lo, hi } } else { self }
    }

    pub fn sqr(self) -> Self {
        let (least, most) = (self.mig(), self.mag());
        let square = outward(least * least, most * most);
        Self { lo: square.lo.max(0.0), hi: square.hi }
    }

    /// The square roots of what is not negative in it; zero where nothing is.
    pub fn sqrt(self) -> Self {
        if self.hi <= 0.0 {
            return Self::ZERO;
        }
        let root = outward(self.lo.max(0.0).sqrt(), self.hi.sqrt());
        Self { lo: root.lo.max(0.0), hi: root.hi }
    }

    /// The quotients; the whole line where the divisor may be zero.
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

/// Ends one number outward; the whole line when one is no number.
pub(crate) fn outward(lo: f64, hi: f64) -> Interval {
    if lo <= hi { Interval { lo: lo.next_down(), hi: hi.next_up() } } else { Interval::ENTIRE }
}

/// Ends of sums, one number outward. A sum that comes out as zero is zero; left as it is it keeps operations
/// away from the least numbers, with which processors are slow.
fn of_sums(lo: f64, hi: f64) -> Interval {
    let sums = outward(lo, hi);
    Interval { lo: if lo == 0.0 { 0.0 } else { sums.lo }, hi: if hi == 0.0 { 0.0 } else { sums.hi } }
}

/// The hull of four products or quotients. One of zero and infinity is no number: then nothing is known.
fn of_corners([a, b, c, d]: [f64; 4]) -> Interval {
    // The sum is no number if one of them is none, or if both infinities are among them.
    if (a + b + c + d).is_nan() {
        return Interval::ENTIRE;
    }
    // Without the care for what is no number that `f64::min` takes: these are in the innermost loops.
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
