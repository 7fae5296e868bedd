//! Operations on intervals with two derivatives.
//!
//! # Method
//! A *jet* is three intervals. Over a range of x, they enclose a value, its first derivative by x, and its
//! second derivative by x. An operation takes jets and returns a jet and a verdict. The verdict says whether
//! the operand lies outside the domain of the operation: certainly, possibly, or never.
//!
//! # Guarantees
//! A number outside the domain of the operation counts as the nearest number of the domain. A derivative that
//! does not exist, or for which no bound is found, becomes the interval from minus infinity to infinity.

pub mod power;

use std::f64::consts::{LN_2, LN_10};

use super::function::{Function, Pairing};
use super::offence::{Certainty, Offence, Verdict};
use crate::geometry::interval::Interval;

pub type Jet = [Interval; 3];

pub const ONE: Interval = Interval::ONE;

/// How far an operand may leave a closed domain, as a part of the magnitude of its terms: some thousand
/// roundings. So sqrt(0.1 + 0.2 - x) is legal at 0.3.
const SLACK: f64 = 1e-12;

/// How far an operand may leave a closed domain in any case. Outward rounding turns zero into tiny negative
/// numbers.
const LEAST_SLACK: f64 = 1e-300;

/// A jet, and a scale: the least magnitude, over the range of x, of the terms that the value was summed from.
/// Rounding errors are small compared with the scale, even where the terms cancel.
#[derive(Debug, Clone, Copy)]
pub struct Node {
    pub jet: Jet,
    pub scale: f64,
}

impl Node {
    pub fn variable(x: Interval) -> Self {
        Self { jet: [x, ONE, Interval::ZERO], scale: x.mig() }
    }

    pub fn constant(c: f64) -> Self {
        Self { jet: [Interval::point(c), Interval::ZERO, Interval::ZERO], scale: c.abs() }
    }

    pub fn negated(self) -> Self {
        Self { jet: self.jet.map(|of| -of), scale: self.scale }
    }

    /// How far rounding may have moved the value.
    pub fn slack(self) -> f64 {
        SLACK * self.scale + LEAST_SLACK
    }

    /// The jet of f(a) by the chain rule, from the enclosures of f, f' and f'' over the range of a.
    pub fn chain(self, [f, f1, f2]: Jet) -> Self {
        let [_, a1, a2] = self.jet;
        let scale = f.mig().max(f1.mig() * self.scale);
        Self::told([f, f1 * a1, f2 * a1.sqr() + f1 * a2], scale)
    }

    /// A node of this jet. A derivative with a bound on one side only becomes the whole line.
    pub fn told([value, first, second]: Jet, scale: f64) -> Self {
        let known = |of: Interval| if of.is_bounded() { of } else { Interval::ENTIRE };
        let scale = if scale.is_finite() { scale } else { 0.0 };
        Self { jet: [value, known(first), known(second)], scale }
    }
}

pub fn call(function: Function, a: Node) -> (Node, Verdict) {
    let x = a.jet[0];
    match function {
        Function::Sin => {
            let (sin, cos) = (x.sin(), x.cos());
            (a.chain([sin, cos, -sin]), None)
        }
        Function::Cos => {
            let (sin, cos) = (x.sin(), x.cos());
            (a.chain([cos, -sin, -cos]), None)
        }
        Function::Tan => tangent(a),
        Function::Asin => {
            let (outer, verdict) = inverse(a, "asin");
            (a.chain([x.asin(), outer[0], outer[1]]), verdict)
        }
        Function::Acos => {
            let (outer, verdict) = inverse(a, "acos");
            (a.chain([x.acos(), -outer[0], -outer[1]]), verdict)
        }
        Function::Atan => {
            let first = ONE.div(ONE + x.sqr());
            (a.chain([x.atan(), first, x * first.sqr() * -2.0]), None)
        }
        Function::Sinh => {
            let (sinh, cosh) = (x.sinh(), x.cosh());
            (a.chain([sinh, cosh, sinh]), None)
        }
        Function::Cosh => {
            let (sinh, cosh) = (x.sinh(), x.cosh());
            (a.chain([cosh, sinh, cosh]), None)
        }
        Function::Tanh => {
            let value = x.tanh();
            let first = ((ONE - value) * (ONE + value)).within(0.0, 1.0);
            (a.chain([value, first, value * first * -2.0]), None)
        }
        Function::Exp => {
            let value = x.exp();
            (a.chain([value; 3]), None)
        }
        Function::Ln => logarithm(a, x.ln(), ONE),
        Function::Log10 => logarithm(a, x.log10(), around(LN_10)),
        Function::Log2 => logarithm(a, x.log2(), around(LN_2)),
        Function::Sqrt => square_root(a),
        Function::Cbrt => {
            let value = x.cbrt();
            let first = ONE.div(value.sqr() * 3.0);
            (a.chain([value, first, first.div(x * 3.0) * -2.0]), None)
        }
        Function::Abs => (magnitude(a), None),
    }
}

pub fn pair(pairing: Pairing, a: Node, b: Node) -> (Node, Verdict) {
    let ([x, x1, x2], [y, y1, y2]) = (a.jet, b.jet);
    match pairing {
        Pairing::Add => (Node::told([x + y, x1 + y1, x2 + y2], a.scale.max(b.scale)), None),
        Pairing::Subtract => (Node::told([x - y, x1 - y1, x2 - y2], a.scale.max(b.scale)), None),
        Pairing::Multiply => {
            let jet = [x * y, x1 * y + x * y1, x2 * y + x1 * y1 * 2.0 + x * y2];
            (Node::told(jet, a.scale * b.scale), None)
        }
        Pairing::Divide => {
            let value = x.div(y);
            let first = (x1 - value * y1).div(y);
            let second = (x2 - first * y1 * 2.0 - value * y2).div(y);
            let verdict = unless(!y.contains(0.0), Offence::DivisionByZero, y == Interval::ZERO);
            (Node::told([value, first, second], a.scale / y.mag()), verdict)
        }
        Pairing::Power => power::free(a, b),
        Pairing::Min if x.hi() <= y.lo() => (a, None),
        Pairing::Min if y.hi() <= x.lo() => (b, None),
        Pairing::Min => (kink(x.min(y), x1, y1), None),
        Pairing::Max if x.lo() >= y.hi() => (a, None),
        Pairing::Max if y.lo() >= x.hi() => (b, None),
        Pairing::Max => (kink(x.max(y), x1, y1), None),
        Pairing::Hypot => (hypotenuse(a.jet, b.jet), None),
    }
}

/// The verdict on an operation: `None` if the operand is legal, otherwise a certain or a possible offence.
pub fn unless(legal: bool, offence: Offence, certain: bool) -> Verdict {
    match (legal, certain) {
        (true, _) => None,
        (false, false) => Some((offence, Certainty::Possible)),
        (false, true) => Some((offence, Certainty::Certain)),
    }
}

/// The verdict on an operation whose operand must be at least `least`; the operand may be less by `slack`.
fn at_least(least: f64, x: Interval, slack: f64, offence: Offence) -> Verdict {
    unless(x.lo() >= least - slack, offence, x.hi() < least - slack)
}

fn tangent(a: Node) -> (Node, Verdict) {
    let value = a.jet[0].tan();
    let first = ONE + value.sqr();
    (a.chain([value, first, value * first * 2.0]), unless(value.is_bounded(), Offence::Pole, false))
}

/// The first two derivatives of the inverse sine, and the verdict on the operand.
fn inverse(a: Node, name: &'static str) -> ([Interval; 2], Verdict) {
    let (x, slack) = (a.jet[0], a.slack().max(SLACK));
    let offence = Offence::Inverse(name);
    let verdict = at_least(-1.0, x, slack, offence).or(at_least(-1.0, -x, slack, offence));
    let below = (ONE - x) * (ONE + x);
    if below.lo() <= 0.0 {
        return ([Interval::ENTIRE; 2], verdict);
    }
    let first = ONE.div(below.sqrt());
    ([first, x.div(below) * first], verdict)
}

/// The logarithm to a base. `value` encloses the logarithm, `ln_base` the natural logarithm of the base.
fn logarithm(a: Node, value: Interval, ln_base: Interval) -> (Node, Verdict) {
    let x = a.jet[0];
    let verdict = unless(x.lo() > 0.0, Offence::Logarithm, x.hi() <= 0.0);
    let first = ONE.div(x * ln_base);
    (a.chain([value, first, -first.div(x)]), verdict)
}

fn square_root(a: Node) -> (Node, Verdict) {
    let x = a.jet[0];
    let verdict = at_least(0.0, x, a.slack(), Offence::SquareRoot);
    let value = x.sqrt();
    if x.lo() <= 0.0 {
        return (a.chain([value, Interval::ENTIRE, Interval::ENTIRE]), verdict);
    }
    let first = Interval::point(0.5).div(value);
    (a.chain([value, first, first.div(x) * -0.5]), verdict)
}

fn magnitude(a: Node) -> Node {
    let [x, x1, _] = a.jet;
    if x.lo() >= 0.0 {
        a
    } else if x.hi() <= 0.0 {
        a.negated()
    } else {
        kink(x.abs(), x1, -x1)
    }
}

/// A value that follows one of two functions at each place. Its slopes lie in the hull of the slopes of both
/// functions. That hull is Clarke's generalised gradient, for which the mean value theorem holds.
fn kink(value: Interval, one: Interval, other: Interval) -> Node {
    Node::told([value, one.hull(other), Interval::ENTIRE], value.mig())
}

fn hypotenuse([x, x1, x2]: Jet, [y, y1, y2]: Jet) -> Node {
    let value = x.hypot(y);
    let steepest = x1.hypot(y1).hi();
    let steep = Interval::between(-steepest, steepest);
    if value.lo() <= 0.0 {
        return Node::told([value, steep, Interval::ENTIRE], 0.0);
    }
    let first = (x * x1 + y * y1).div(value).meet(steep);
    let second = (x1.sqr() + x * x2 + y1.sqr() + y * y2 - first.sqr()).div(value);
    Node::told([value, first, second], value.mig())
}

/// An interval that contains the exact number of a rounded constant.
fn around(constant: f64) -> Interval {
    Interval::between(constant.next_down(), constant.next_up())
}
