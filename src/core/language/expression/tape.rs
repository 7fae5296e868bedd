//! The tape: the list of operations of an expression. An operation comes after the operations that compute
//! its operands.

use super::function::{Function, Pairing};

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Operation {
    /// Pushes x.
    Variable,
    /// Pushes a finite number.
    Constant(f64),
    Negate,
    Call(Function),
    /// The power with a constant whole exponent.
    WholePower(i32),
    /// The power with another constant, finite exponent.
    FixedPower(f64),
    /// An operation on the last two values.
    Pair(Pairing),
}

impl Operation {
    /// How long the operation takes with intervals, in sums and products.
    pub fn weight(self) -> u64 {
        match self {
            Self::Variable | Self::Constant(_) | Self::Negate => 1,
            Self::Pair(_) | Self::WholePower(_) => 2,
            Self::Call(_) | Self::FixedPower(_) => 8,
        }
    }
}

/// An operation, and the byte of the text that it comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    pub operation: Operation,
    pub at: usize,
}

/// Steps for a stack. Every step finds its operands there, and the last step leaves one value.
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

    /// An empty stack with room for every value but the last.
    pub fn stack<T>(&self) -> Vec<T> {
        Vec::with_capacity(self.height)
    }
}
