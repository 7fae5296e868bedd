//! Encloses the values of an expression, and of its first two derivatives, over a range of x.
//!
//! # Method
//! 1. The expression is computed at the middle of the range. For each of its operations, the value and the
//!    first derivative of the result are kept.
//! 2. The expression is computed over the whole range by interval arithmetic. For each operation, this gives
//!    intervals that contain the value and the first two derivatives of the result.
//! 3. During step 2, the mean value theorem gives a second interval for the value of each operation, from its
//!    value at the middle and the interval of its first derivative. The intersection of this interval and the
//!    interval of step 2 is kept, and the next operations use it.
//! 4. Step 3 is done for the first derivative as well, with the interval of the second derivative.
//!
//! Over short ranges the interval of step 3 is the narrower one. Interval arithmetic takes the two x in x -
//! x^2 for independent numbers, so the interval of step 2 is too wide.
//!
//! # Reference
//! R. E. Moore, R. B. Kearfott, M. J. Cloud, *Introduction to Interval Analysis*, SIAM, 2009, section 6.3.

use super::jet::power;
use super::jet::{self, Jet, Node};
use super::offence::{Certainty, Finding, Offence};
use super::tape::{Operation, Tape};
use crate::geometry::interval::Interval;

/// An expression computed at one x.
pub struct Middle {
    x: f64,
    /// Value and first derivative after each step of the tape.
    on_the_way: Vec<[Interval; 2]>,
    pub value: Interval,
    pub finding: Option<Finding>,
}

pub fn enclose(tape: &Tape, x: Interval) -> Jet {
    if x.lo() == x.hi() {
        return sweep(tape, x, |_, _| ()).0;
    }
    over(tape, x, &at(tape, x.mid())).0
}

/// Computes the expression at `x`.
pub fn at(tape: &Tape, x: f64) -> Middle {
    let mut on_the_way = Vec::with_capacity(tape.steps().len());
    let keep = |_, jet: &mut Jet| on_the_way.push([jet[0], jet[1]]);
    let ([value, ..], finding) = sweep(tape, Interval::point(x), keep);
    Middle { x, on_the_way, value, finding }
}

/// The jet of the expression over `x`, which contains the middle, and the gravest offence over `x`.
///
/// For each operation with the value f, and for the middle m of the range X, both f(X) and
/// f(m) + f'(X) (X - m) enclose the values. In the same way, f'(m) + f''(X) (X - m) encloses f'.
pub fn over(tape: &Tape, x: Interval, middle: &Middle) -> (Jet, Option<Finding>) {
    let around = x - Interval::point(middle.x);
    sweep(tape, x, |k, jet| {
        let Some(&[value, first]) = middle.on_the_way.get(k) else { return };
        if jet[1] == Interval::ZERO {
            // A constant has its value at the middle everywhere.
            jet[0] = jet[0].meet(value);
            return;
        }
        if jet[2].is_bounded() {
            jet[1] = jet[1].meet(first + jet[2] * around);
        }
        if jet[1].is_bounded() {
            jet[0] = jet[0].meet(value + jet[1] * around);
        }
    })
}

/// Computes the tape over `x`. After each step, `visit` gets the number of the step and its jet, which it may
/// narrow.
fn sweep(tape: &Tape, x: Interval, mut visit: impl FnMut(usize, &mut Jet)) -> (Jet, Option<Finding>) {
    let mut stack = tape.stack();
    let variable = Node::variable(x);
    let mut last = variable;
    let mut finding: Option<Finding> = None;
    for (k, step) in tape.steps().iter().enumerate() {
        let (node, verdict) = match step.operation {
            Operation::Variable => {
                stack.push(last);
                (variable, None)
            }
            Operation::Constant(c) => {
                stack.push(last);
                (Node::constant(c), None)
            }
            Operation::Negate => (last.negated(), None),
            Operation::Call(function) => jet::call(function, last),
            Operation::WholePower(n) => power::whole(last, n),
            Operation::FixedPower(c) => power::fixed(last, c),
            Operation::Pair(pairing) => {
                // The tape is well formed, so there is always a value below the last one.
                let Some(left) = stack.pop() else { return ([Interval::ENTIRE; 3], finding) };
                jet::pair(pairing, left, last)
            }
        };
        last = node;
        visit(k, &mut last.jet);
        if let Some((offence, certainty)) = verdict.or_else(|| overflow(last.jet[0])) {
            let found = Finding { offence, certainty, at: step.at };
            if finding.is_none_or(|known| found.is_graver_than(&known)) {
                finding = Some(found);
            }
        }
    }
    (last.jet, finding)
}

/// The verdict on a value that may be infinite although its operands are legal.
fn overflow(value: Interval) -> Option<(Offence, Certainty)> {
    if value.is_bounded() {
        return None;
    }
    jet::unless(false, Offence::Overflow, value.lo() >= f64::MAX || value.hi() <= f64::MIN)
}
