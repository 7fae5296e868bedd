//! A compiled expression: operations in the order in which they are computed.

use super::function::{Function, Pairing};

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Operation {
    /// Pushes x.
    Variable,
    /// Pushes a finite number.
    Constant(f64),
    Negate,
    Call(Function),
    /// To a constant whole exponent.
    WholePower(i32),
    /// To another constant exponent, finite.
    FixedPower(f64),
    /// On the last two.
    Pair(Pairing),
}

/// An operation and the byte of the text it comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    pub operation: Operation,
    pub at: usize,
}

/// Steps that leave one value, and find their operands, when they are computed with a stack.
#[derive(Debug, Clone, PartialEq)]
pub struct Tape {
    steps: Vec<Step>,
    height: usize,
}

impl Tape {
    pub fn new(steps: Vec<Step>) -> Self {
        let (mut now, mut height) = (0usize, 0);
        for step in &steps {
            match step.operation {
                Operation::Variable | Operation::Constant(_) => now += 1,
                Operation::Pair(_) => now -= 1,
                _ => {}
            }
            height = height.max(now);
        }
        Self { steps, height }
    }

    pub fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// A stack that takes every value but the last without growing.
    pub fn stack<T>(&self) -> Vec<T> {
        Vec::with_capacity(self.height)
    }
}
