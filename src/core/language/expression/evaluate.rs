//! Computes the value and the derivative of an expression at one x with floating-point numbers. Rounding
//! errors are not bounded.

use super::function::{Function, Pairing};
use super::tape::{Operation, Tape};

pub fn value(tape: &Tape, x: f64) -> f64 {
    let mut stack = tape.stack();
    let mut last = x;
    for step in tape.steps() {
        match step.operation {
            Operation::Variable => stack.push(std::mem::replace(&mut last, x)),
            Operation::Constant(c) => stack.push(std::mem::replace(&mut last, c)),
            Operation::Negate => last = -last,
            Operation::Call(function) => last = call(function, last),
            Operation::WholePower(2) => last *= last,
            Operation::WholePower(n) => last = last.powf(f64::from(n)),
            Operation::FixedPower(c) => last = last.powf(c),
            Operation::Pair(pairing) => {
                // The tape is well formed, so there is always a value below the last one.
                let Some(left) = stack.pop() else { return f64::NAN };
                last = pair(pairing, left, last);
            }
        }
    }
    last
}

/// The value as in [`value`], and the derivative by x.
pub fn value_and_derivative(tape: &Tape, x: f64) -> [f64; 2] {
    let mut stack = tape.stack();
    let mut last = [x, 1.0];
    for step in tape.steps() {
        match step.operation {
            Operation::Variable => stack.push(std::mem::replace(&mut last, [x, 1.0])),
            Operation::Constant(c) => stack.push(std::mem::replace(&mut last, [c, 0.0])),
            Operation::Negate => last = last.map(|v| -v),
            Operation::Call(Function::Abs) => last = magnitude(last),
            Operation::Call(function) => {
                let value = call(function, last[0]);
                last = [value, slope(function, last[0], value) * last[1]];
            }
            Operation::WholePower(2) => last = [last[0] * last[0], 2.0 * last[0] * last[1]],
            Operation::WholePower(n) => last = fixed_power(last, f64::from(n)),
            Operation::FixedPower(c) => last = fixed_power(last, c),
            Operation::Pair(pairing) => {
                let Some(left) = stack.pop() else { return [f64::NAN; 2] };
                last = [pair(pairing, left[0], last[0]), pair_slope(pairing, left, last)];
            }
        }
    }
    last
}

fn call(function: Function, a: f64) -> f64 {
    match function {
        Function::Sin => a.sin(),
        Function::Cos => a.cos(),
        Function::Tan => a.tan(),
        Function::Asin => a.asin(),
        Function::Acos => a.acos(),
        Function::Atan => a.atan(),
        Function::Sinh => a.sinh(),
        Function::Cosh => a.cosh(),
        Function::Tanh => a.tanh(),
        Function::Exp => a.exp(),
        Function::Ln => a.ln(),
        Function::Log10 => a.log10(),
        Function::Log2 => a.log2(),
        Function::Sqrt => a.sqrt(),
        Function::Cbrt => a.cbrt(),
        Function::Abs => a.abs(),
    }
}

/// The derivative of the function by its argument `a`; `value` is the value of the function there.
fn slope(function: Function, a: f64, value: f64) -> f64 {
    use std::f64::consts::{LOG2_E, LOG10_E};
    match function {
        Function::Sin => a.cos(),
        Function::Cos => -a.sin(),
        Function::Tan => 1.0 + value * value,
        Function::Asin => 1.0 / ((1.0 - a) * (1.0 + a)).sqrt(),
        Function::Acos => -1.0 / ((1.0 - a) * (1.0 + a)).sqrt(),
        Function::Atan => 1.0 / (1.0 + a * a),
        Function::Sinh => a.cosh(),
        Function::Cosh => a.sinh(),
        // 1 - value^2 would be lost in rounding where tanh is nearly one.
        Function::Tanh => 1.0 / a.cosh().powi(2),
        Function::Exp => value,
        Function::Ln => 1.0 / a,
        Function::Log10 => LOG10_E / a,
        Function::Log2 => LOG2_E / a,
        Function::Sqrt => 0.5 / value,
        Function::Cbrt => 1.0 / (3.0 * value * value),
        Function::Abs => a.signum(),
    }
}

/// The absolute value. At a zero, the derivative is the one to the right.
fn magnitude([a, slope]: [f64; 2]) -> [f64; 2] {
    if a == 0.0 {
        return [0.0, slope.abs()];
    }
    [a.abs(), a.signum() * slope]
}

fn fixed_power([a, slope]: [f64; 2], exponent: f64) -> [f64; 2] {
    let factor = if exponent == 0.0 { 0.0 } else { exponent * a.powf(exponent - 1.0) };
    [a.powf(exponent), factor * slope]
}

fn pair(pairing: Pairing, a: f64, b: f64) -> f64 {
    match pairing {
        Pairing::Add => a + b,
        Pairing::Subtract => a - b,
        Pairing::Multiply => a * b,
        Pairing::Divide => a / b,
        Pairing::Power => a.powf(b),
        Pairing::Min => a.min(b),
        Pairing::Max => a.max(b),
        Pairing::Hypot => a.hypot(b),
    }
}

fn pair_slope(pairing: Pairing, [a, a1]: [f64; 2], [b, b1]: [f64; 2]) -> f64 {
    match pairing {
        Pairing::Add => a1 + b1,
        Pairing::Subtract => a1 - b1,
        Pairing::Multiply => a1 * b + a * b1,
        Pairing::Divide => (a1 - a / b * b1) / b,
        Pairing::Power if a == 0.0 => b * a.powf(b - 1.0) * a1,
        Pairing::Power => a.powf(b) * (b1 * a.ln() + b * a1 / a),
        // Where both are equal, the derivative to the right is the smaller one for min, the larger for max.
        Pairing::Min if a == b => a1.min(b1),
        Pairing::Max if a == b => a1.max(b1),
        Pairing::Min => {
            if a < b {
                a1
            } else {
                b1
            }
        }
        Pairing::Max => {
            if a > b {
                a1
            } else {
                b1
            }
        }
        Pairing::Hypot => (a * a1 + b * b1) / a.hypot(b),
    }
}
