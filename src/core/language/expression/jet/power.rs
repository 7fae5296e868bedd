//! Powers a^b of intervals with two derivatives.
//!
//! # Degenerate input
//! Which bases a are legal depends on the exponent b:
//! * b is a constant whole number: every a is legal, except zero if b is negative.
//! * b is another constant: a must be at least zero; if b is negative, a must be above zero.
//! * b contains x: a must be at least zero; where b is zero or negative, a must be above zero.

use super::{Jet, Node, ONE, unless};
use crate::geometry::interval::Interval;
use crate::language::expression::offence::{Certainty, Offence, Verdict};

pub fn whole(a: Node, n: i32) -> (Node, Verdict) {
    let x = a.jet[0];
    let times = |n: i32| Interval::point(f64::from(n));
    let outer = match n {
        0 => [ONE, Interval::ZERO, Interval::ZERO],
        1 => return (a, None),
        2 => [x.sqr(), x * 2.0, times(2)],
        _ => [x.powi(n), x.powi(n - 1) * times(n), x.powi(n - 2) * times(n) * times(n - 1)],
    };
    let verdict = unless(n >= 0 || !x.contains(0.0), Offence::PowerOfZero, x == Interval::ZERO);
    (a.chain(outer), verdict)
}

pub fn fixed(a: Node, c: f64) -> (Node, Verdict) {
    let (x, exponent) = (a.jet[0], Interval::point(c));
    let (once, twice) = (less(c, 1.0), less(c, 2.0));
    let outer = [x.powf(c), x.pow(once) * c, x.pow(twice) * exponent * once];
    (a.chain(outer), verdict(a, exponent))
}

/// The power whose exponent contains x. For a positive base, the derivatives are those of exp(b ln a). If the
/// base may be zero, they have no bounds.
pub fn free(a: Node, b: Node) -> (Node, Verdict) {
    let ([x, x1, x2], [y, y1, y2]) = (a.jet, b.jet);
    let value = x.pow(y);
    let verdict = verdict(a, y);
    if x.lo() <= 0.0 {
        return (Node::told([value, Interval::ENTIRE, Interval::ENTIRE], value.mig()), verdict);
    }
    let (ln, rate) = (x.ln(), x1.div(x));
    let log1 = y1 * ln + y * rate;
    let log2 = y2 * ln + y1 * rate * 2.0 + y * (x2.div(x) - rate.sqr());
    let jet: Jet = [value, value * log1, value * (log1.sqr() + log2)];
    (Node::told(jet, value.mig()), verdict)
}

/// The verdict on the base of a power whose exponent is not a constant whole number.
fn verdict(a: Node, exponent: Interval) -> Verdict {
    let (base, slack) = (a.jet[0], a.slack());
    if base.hi() < -slack {
        Some((Offence::PowerOfNegative, Certainty::Certain))
    } else if base.lo() <= 0.0 && exponent.lo() <= 0.0 {
        unless(false, Offence::PowerOfZero, base.hi() <= 0.0 && exponent.hi() <= 0.0)
    } else {
        unless(base.lo() >= -slack, Offence::PowerOfNegative, false)
    }
}

/// The difference `c - by`. An exact difference becomes an interval of length zero, which makes the power
/// cheaper to compute.
fn less(c: f64, by: f64) -> Interval {
    let difference = c - by;
    // Knuth's sum of two numbers gives the rounding error, and gives it exactly.
    let part = difference - c;
    let error = (c - (difference - part)) - (by + part);
    if error == 0.0 { Interval::point(difference) } else { Interval::point(c) - Interval::point(by) }
}
