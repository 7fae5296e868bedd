//! Elementary functions of intervals: sine, logarithm, powers and so on.
//!
//! # Guarantees
//! The result contains the value of the function at every number of the operand. This holds if the error of
//! the standard library is at most `ULPS` (4) units in the last place of a floating-point number.
//!
//! # Degenerate input
//! No function reports an operand outside its domain; the caller checks the operand.
//! * The logarithm ignores the numbers that are not positive. If no number is positive, the result is the
//!   whole line.
//! * The tangent is the whole line if a pole lies in the operand, or if rounding hides whether one does.
//! * In other functions, a number outside the domain counts as the nearest number of the domain: the inverse
//!   sine of 2 is that of 1.
//! * The sine and cosine are [-1, 1] if an angle in the operand is larger than 1e8 rad in size.

use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, PI};

use super::Interval;

/// How far each end moves outward, in units in the last place. For these functions on this kind of machine
/// the C libraries in use document an error of at most 2, and one of them 4 for the cube root.
const ULPS: i64 = 4;

/// Sine and cosine of a larger angle (rad) are enclosed by [-1, 1] only. The count of half turns would lose
/// the digits that place the ends within a turn. No sensible part turns that often.
const FARTHEST_TURN: f64 = 1e8;

/// Relative error of a count of half turns. 1/pi, the product with it and the difference to 1/2 each err by
/// half a unit in the last place. The constant is more than twice the sum of these errors.
const COUNT_ERROR: f64 = 4.0 * f64::EPSILON;

impl Interval {
    pub fn sin(self) -> Self {
        self.wave(f64::sin, 0.5)
    }

    pub fn cos(self) -> Self {
        self.wave(f64::cos, 0.0)
    }

    /// The tangents; the whole line if a pole may lie between the ends.
    pub fn tan(self) -> Self {
        if self.hi - self.lo >= PI || self.cos().contains(0.0) {
            return Self::ENTIRE;
        }
        widened(self.lo.tan(), self.hi.tan())
    }

    /// The inverse sines, rad.
    pub fn asin(self) -> Self {
        let inside = self.within(-1.0, 1.0);
        widened(inside.lo.asin(), inside.hi.asin()).within(-FRAC_PI_2.next_up(), FRAC_PI_2.next_up())
    }

    /// The inverse cosines, rad.
    pub fn acos(self) -> Self {
        let inside = self.within(-1.0, 1.0);
        widened(inside.hi.acos(), inside.lo.acos()).within(0.0, PI.next_up())
    }

    /// The inverse tangents, rad.
    pub fn atan(self) -> Self {
        widened(self.lo.atan(), self.hi.atan()).within(-FRAC_PI_2.next_up(), FRAC_PI_2.next_up())
    }

    pub fn sinh(self) -> Self {
        widened(self.lo.sinh(), self.hi.sinh())
    }

    pub fn cosh(self) -> Self {
        widened(self.mig().cosh(), self.mag().cosh()).within(1.0, f64::INFINITY)
    }

    pub fn tanh(self) -> Self {
        widened(self.lo.tanh(), self.hi.tanh()).within(-1.0, 1.0)
    }

    pub fn exp(self) -> Self {
        widened(self.lo.exp(), self.hi.exp()).within(0.0, f64::INFINITY)
    }

    /// The natural logarithms of the positive members; the whole line if there are none.
    pub fn ln(self) -> Self {
        self.logarithm(f64::ln)
    }

    pub fn log10(self) -> Self {
        self.logarithm(f64::log10)
    }

    pub fn log2(self) -> Self {
        self.logarithm(f64::log2)
    }

    pub fn cbrt(self) -> Self {
        widened(self.lo.cbrt(), self.hi.cbrt())
    }

    /// The powers; the whole line if the exponent is negative and the interval contains zero.
    pub fn powi(self, exponent: i32) -> Self {
        let n = f64::from(exponent);
        match exponent {
            0 => Self::point(1.0),
            1 => self,
            2 => self.sqr(),
            _ if exponent < 0 && self.contains(0.0) => Self::ENTIRE,
            _ if exponent % 2 != 0 => {
                let (a, b) = (self.lo.powf(n), self.hi.powf(n));
                widened(a.min(b), a.max(b))
            }
            _ => {
                let (a, b) = (self.mig().powf(n), self.mag().powf(n));
                widened(a.min(b), a.max(b)).within(0.0, f64::INFINITY)
            }
        }
    }

    /// The powers of the members that are not negative.
    pub fn powf(self, exponent: f64) -> Self {
        let base = self.within(0.0, f64::INFINITY);
        let (a, b) = (base.lo.powf(exponent), base.hi.powf(exponent));
        widened(a.min(b), a.max(b)).within(0.0, f64::INFINITY)
    }

    /// The powers of the positive members. Zero counts as a member if every exponent is positive.
    ///
    /// The logarithm of the power is a product, so the extremes are at ends of both intervals.
    pub fn pow(self, exponent: Self) -> Self {
        let base = self.within(0.0, f64::INFINITY);
        if exponent.lo == exponent.hi {
            return base.powf(exponent.lo);
        }
        if base.lo == 0.0 && exponent.lo <= 0.0 {
            return Self { lo: 0.0, hi: f64::INFINITY };
        }
        let corners = [
            base.lo.powf(exponent.lo),
            base.lo.powf(exponent.hi),
            base.hi.powf(exponent.lo),
            base.hi.powf(exponent.hi),
        ];
        if corners.iter().any(|x| x.is_nan()) {
            return Self::ENTIRE;
        }
        let [a, b, c, d] = corners;
        widened(a.min(b).min(c).min(d), a.max(b).max(c).max(d)).within(0.0, f64::INFINITY)
    }

    /// The square roots of the sums of two squares.
    pub fn hypot(self, other: Self) -> Self {
        widened(self.mig().hypot(other.mig()), self.mag().hypot(other.mag())).within(0.0, f64::INFINITY)
    }

    /// The smaller member of each pair.
    pub fn min(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.min(other.hi) }
    }

    /// The larger member of each pair.
    pub fn max(self, other: Self) -> Self {
        Self { lo: self.lo.max(other.lo), hi: self.hi.max(other.hi) }
    }

    /// Replaces members below `least` by `least` and members above `most` by `most`.
    pub fn within(self, least: f64, most: f64) -> Self {
        Self { lo: self.lo.max(least).min(most), hi: self.hi.min(most).max(least) }
    }

    /// The values of cosine or sine, rad. `shift` is 0 for cosine and 0.5 for sine: the extremes are at whole
    /// numbers of half turns plus `shift`. The value is 1 at even numbers and -1 at odd numbers.
    fn wave(self, function: fn(f64) -> f64, shift: f64) -> Self {
        let whole = Self { lo: -1.0, hi: 1.0 };
        if self.mag() > FARTHEST_TURN || self.hi - self.lo >= 2.0 * PI {
            return whole;
        }
        let (from, to) = (self.lo * FRAC_1_PI - shift, self.hi * FRAC_1_PI - shift);
        let first = (from - COUNT_ERROR * (from.abs() + 1.0)).ceil();
        let last = (to + COUNT_ERROR * (to.abs() + 1.0)).floor();
        let (a, b) = (function(self.lo), function(self.hi));
        let mut values = widened(a.min(b), a.max(b)).within(-1.0, 1.0);
        if last > first {
            return whole;
        }
        if last == first {
            let extreme = if first % 2.0 == 0.0 { 1.0 } else { -1.0 };
            values = values.hull(Self::point(extreme));
        }
        values
    }

    fn logarithm(self, function: fn(f64) -> f64) -> Self {
        if self.hi <= 0.0 {
            return Self::ENTIRE;
        }
        widened(function(self.lo.max(0.0)), function(self.hi))
    }
}

/// The interval with its ends moved outward by `ULPS`; the whole line if an end is NaN.
fn widened(lo: f64, hi: f64) -> Interval {
    if lo <= hi { Interval { lo: moved(lo, -ULPS), hi: moved(hi, ULPS) } } else { Interval::ENTIRE }
}

/// The floating-point number `steps` places after `x`, which is not NaN. The result never goes past infinity.
fn moved(x: f64, steps: i64) -> f64 {
    const INFINITE: i64 = f64::INFINITY.to_bits() as i64;
    let bits = x.to_bits() as i64;
    let rank = if bits < 0 { i64::MIN - bits } else { bits };
    let rank = (rank + steps).clamp(-INFINITE, INFINITE);
    f64::from_bits((if rank < 0 { i64::MIN - rank } else { rank }) as u64)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use proptest::prelude::*;

    use super::*;

    type Functions = (&'static str, fn(Interval) -> Interval, fn(f64) -> f64);

    #[rustfmt::skip]
    const FUNCTIONS: &[Functions] = &[
        ("sin", Interval::sin, f64::sin), ("cos", Interval::cos, f64::cos), ("tan", Interval::tan, f64::tan),
        ("asin", Interval::asin, f64::asin), ("acos", Interval::acos, f64::acos), ("atan", Interval::atan, f64::atan),
        ("sinh", Interval::sinh, f64::sinh), ("cosh", Interval::cosh, f64::cosh), ("tanh", Interval::tanh, f64::tanh),
        ("exp", Interval::exp, f64::exp), ("ln", Interval::ln, f64::ln), ("log10", Interval::log10, f64::log10),
        ("log2", Interval::log2, f64::log2), ("cbrt", Interval::cbrt, f64::cbrt),
        ("sqrt", Interval::sqrt, f64::sqrt),
    ];

    /// Ends of both signs and of many magnitudes, and special values.
    fn end() -> impl Strategy<Value = f64> {
        let special =
            prop::sample::select(vec![0.0, -0.0, 1.0, -1.0, FRAC_PI_2, PI, -PI, TAU, 1e-300, 5e-324]);
        prop_oneof![
            4 => -10.0..10.0f64,
            2 => -1.0..1.0f64,
            1 => -1e4..1e4f64,
            1 => -1e9..1e9f64,
            1 => special,
        ]
    }

    fn width() -> impl Strategy<Value = f64> {
        prop_oneof![Just(0.0), 0.0..1e-9f64, 0.0..0.1f64, 0.0..10.0f64, 0.0..1e3f64]
    }

    fn samples(of: Interval) -> impl Iterator<Item = f64> {
        (0..=100).map(move |k| (of.lo + f64::from(k) / 100.0 * (of.hi - of.lo)).clamp(of.lo, of.hi))
    }

    proptest! {
        #[test]
        fn results_contain_the_values_of_the_function(lo in end(), width in width()) {
            let operand = Interval::between(lo, lo + width);
            for (name, enclose, value) in FUNCTIONS {
                let values = enclose(operand);
                prop_assert!(values.lo <= values.hi, "{name} {operand:?} {values:?}");
                for x in samples(operand) {
                    let y = value(x);
                    prop_assert!(y.is_nan() || values.contains(y), "{name} of {x}: {y} not in {values:?}");
                }
            }
        }

        #[test]
        fn results_contain_the_powers(lo in end(), width in width(), n in -9..9i32, c in -4.0..4.0f64, d in 0.0..2.0f64) {
            let operand = Interval::between(lo, lo + width);
            let (whole, fixed) = (operand.powi(n), operand.powf(c));
            let free = operand.pow(Interval::between(c, c + d));
            for x in samples(operand) {
                prop_assert!(whole.contains(x.powf(f64::from(n))), "{x}^{n} not in {whole:?}");
                if x >= 0.0 {
                    prop_assert!(fixed.contains(x.powf(c)), "{x}^{c} not in {fixed:?}");
                }
                if x > 0.0 {
                    for e in samples(Interval::between(c, c + d)) {
                        prop_assert!(free.contains(x.powf(e)), "{x}^{e} not in {free:?}");
                    }
                }
            }
        }

        #[test]
        fn results_contain_the_values_for_all_pairs(a in end(), b in end(), v in width(), w in width()) {
            let (p, q) = (Interval::between(a, a + v), Interval::between(b, b + w));
            for x in samples(p).step_by(10) {
                for y in samples(q).step_by(10) {
                    prop_assert!(p.hypot(q).contains(x.hypot(y)));
                    prop_assert!(p.min(q).contains(x.min(y)));
                    prop_assert!(p.max(q).contains(x.max(y)));
                }
            }
        }

        #[test]
        fn points_give_narrow_results(x in 0.01..0.99f64) {
            for (name, enclose, value) in FUNCTIONS {
                let (values, y) = (enclose(Interval::point(x)), value(x));
                prop_assert!(values.width() <= 20.0 * f64::EPSILON * y.abs(), "{name} of {x}: {values:?}");
            }
        }
    }

    #[test]
    fn extremes_between_the_ends_are_found() {
        assert_eq!(Interval::between(1.5, 1.6).sin().hi, 1.0);
        assert_eq!(Interval::between(-1.6, -1.5).sin().lo, -1.0);
        assert_eq!(Interval::between(-0.1, 0.1).cos().hi, 1.0);
        assert_eq!(Interval::between(3.1, 3.2).cos().lo, -1.0);
        let million_turns = 1e6 * TAU;
        assert_eq!(Interval::between(million_turns - 0.1, million_turns + 0.1).cos().hi, 1.0);
        assert!(Interval::between(million_turns + 0.1, million_turns + 0.2).cos().hi < 0.996);
    }

    #[test]
    fn unknown_results_are_the_whole_range() {
        assert_eq!(Interval::between(1e9, 1e9).sin(), Interval::between(-1.0, 1.0));
        assert_eq!(Interval::between(1.0, 2.0).tan(), Interval::ENTIRE);
        assert_eq!(Interval::between(0.0, PI).tan(), Interval::ENTIRE);
        assert_eq!(Interval::between(-1.0, 1.0).powi(-2), Interval::ENTIRE);
        assert_eq!(Interval::between(-2.0, -1.0).ln(), Interval::ENTIRE);
        assert_eq!(Interval::between(-2.0, 1.0).ln().lo, f64::NEG_INFINITY);
    }

    #[test]
    fn results_stay_in_the_range_of_the_function() {
        assert_eq!(Interval::point(FRAC_PI_2).sin().hi, 1.0);
        assert_eq!(Interval::between(-40.0, 40.0).tanh(), Interval::between(-1.0, 1.0));
        assert_eq!(Interval::point(-800.0).exp().lo, 0.0);
        assert_eq!(Interval::point(0.0).cosh().lo, 1.0);
        assert_eq!(Interval::between(0.5, 2.0).acos().lo, 0.0);
        assert_eq!(Interval::point(0.0).powf(0.5).lo, 0.0);
        assert_eq!(Interval::ENTIRE.exp(), Interval::between(0.0, f64::INFINITY));
    }

    #[test]
    fn a_number_moves_by_steps_of_neighbouring_numbers() {
        assert_eq!(moved(0.0, 1), 5e-324);
        assert_eq!(moved(-0.0, -2), -1e-323);
        assert_eq!(moved(1.0, 1), 1.0f64.next_up());
        assert_eq!(moved(-1.0, 2), (-1.0f64).next_up().next_up());
        assert_eq!(moved(f64::MAX, 4), f64::INFINITY);
        assert_eq!(moved(f64::INFINITY, -1), f64::MAX);
    }
}
