//! Expressions in x: what a user writes for y(x).
//!
//! # Method
//! 1. [`parse`](Expression::parse) turns the text into a tape: operations in the order in which they are
//!    computed, each with the byte of the text it comes from.
//! 2. The tape is computed with a stack, never by recursion: in numbers, in numbers with a derivative, or in
//!    intervals with two derivatives (automatic differentiation, forward).
//! 3. [`examine`](Expression::examine) proves by subdivision that the expression is defined over a domain.
//!
//! # Grammar
//! From loose to tight: `+ -`; `* /`; the signs; `^`, which binds right: -x^2 is -(x^2), 2^-x is legal.
//! Products are written out. Numbers are decimal, with `.5`, `5.` and `1e-3`; they, `pi` and `e` are the
//! nearest floating-point numbers. Names are in lower case: see [`function`]. Spaces, tabs and line ends
//! separate.
//!
//! An exponent without x is a constant, rounded to the nearest number: x^(6/2) is x^3 and takes negative x.
//!
//! # Guarantees
//! Enclosures are proved up to the accuracy of the standard library's functions: see
//! [`elementary`](crate::geometry::interval::elementary). Any text ends in bounded time and stack.
//!
//! # Cost
//! O(n) for n bytes of text, each time.
//!
//! # Reference
//! A. Griewank, A. Walther, *Evaluating Derivatives*, SIAM, 2008, sections 3.1 and 13.2.

mod enclose;
mod evaluate;
mod examine;
pub mod fault;
pub mod function;
mod jet;
mod offence;
mod parse;
mod tape;
#[cfg(test)]
mod tests;

use crate::budget::Budget;
use crate::geometry::interval::Interval;

pub use examine::Undefined;
pub use fault::{ExpressionError, Fault};
pub use offence::Offence;

use tape::Tape;

/// Longer texts are refused, bytes. Expressions come by hand or from a fit with some dozens of terms; each
/// computation takes time in proportion.
pub const LONGEST_TEXT: usize = 10_000;

/// Deeper nesting is refused: parentheses, arguments, signs and powers of powers all count. The parser
/// recurses, and at this depth it takes less than an eighth of the 2 MB that a thread has.
pub const DEEPEST_NESTING: usize = 200;

/// A function of x.
#[derive(Debug, Clone, PartialEq)]
pub struct Expression {
    tape: Tape,
}

impl Expression {
    /// Reads an expression in x.
    ///
    /// # Errors
    /// What is wrong with the text, and the byte where.
    pub fn parse(text: &str) -> Result<Self, ExpressionError> {
        Ok(Self { tape: parse::tape(text)? })
    }

    /// The value at `x`, to rounding; no number, or an infinite one, where it is not defined.
    pub fn value(&self, x: f64) -> f64 {
        evaluate::value(&self.tape, x)
    }

    /// The value and the derivative at `x`, to rounding. Where the derivative jumps it is the one to the
    /// right; where it does not exist otherwise it is no number, or an infinite one.
    pub fn value_and_derivative(&self, x: f64) -> [f64; 2] {
        evaluate::value_and_derivative(&self.tape, x)
    }

    /// Encloses the value and the first two derivatives over `x`. A derivative that does not exist or is not
    /// bounded is the whole line; only that of `abs`, `min`, `max` and `hypot` is bounded where it jumps.
    ///
    /// Where the expression is not defined, the value is enclosed as if arguments were moved to the nearest
    /// legal one; [`examine`](Self::examine) tells whether that matters.
    pub fn enclose(&self, x: Interval) -> [Interval; 3] {
        enclose::enclose(&self.tape, x)
    }

    /// Proves that the expression is defined, finite and continuous over the closed `domain`, and encloses
    /// its values there, to about one part in ten thousand of the largest; less tightly where ten thousand
    /// cells do not suffice.
    ///
    /// # Errors
    /// Where it is not defined, or cannot be proved to be; or that the budget is spent.
    pub fn examine(&self, domain: [f64; 2], budget: &Budget) -> Result<Interval, Undefined> {
        examine::examine(&self.tape, domain, budget)
    }
}
