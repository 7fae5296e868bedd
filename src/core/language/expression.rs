//! Expressions in x: the text that a user writes for y(x).
//!
//! # Method
//! 1. [`parse`](Expression::parse) turns the text into a list of operations, in the order of their
//!    computation.
//! 2. The list is computed at one x with floating-point numbers; the result is the value and the derivative.
//!    Over a range of x it is computed with intervals; the result encloses the value and the first two
//!    derivatives. All derivatives come from automatic differentiation in forward mode.
//! 3. [`examine`](Expression::examine) proves that the expression is defined over a domain.
//!
//! # Grammar
//! The operators from the one that binds least to the one that binds most: `+` and `-` between operands; `*`
//! and `/`; `+` and `-` as signs; `^`. So -x^2 is -(x^2). Powers associate to the right: 2^3^x is 2^(3^x).
//! The exponent can have a sign, as in 2^-x. A product needs its `*`. [`function`] lists the names.
//!
//! # Guarantees
//! * Numbers, `pi`, `e` and exponents without x are rounded to floating-point numbers. The intervals contain
//!   the exact results for these rounded numbers.
//! * A text longer than [`LONGEST_TEXT`] bytes, or nested deeper than [`DEEPEST_NESTING`] levels, is an
//!   error.
//!
//! # Cost
//! Parsing a text of n bytes takes O(n), and so does each computation of its expression.
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

/// The longest text, bytes. Expressions are typed by hand, or come from a fit with some dozens of terms. The
/// time of each computation grows with the length.
pub const LONGEST_TEXT: usize = 10_000;

/// The deepest nesting: parentheses, arguments, signs and powers of powers all count. The parser recurses. At
/// this depth its stack takes less than a quarter of the 2 MB of a thread.
pub const DEEPEST_NESTING: usize = 200;

/// A function of x.
///
/// # Example
/// ```
/// use toolpathd_core::budget::Budget;
/// use toolpathd_core::language::expression::Expression;
///
/// let parabola = Expression::parse("x^2 - 2*x").unwrap();
/// assert_eq!(parabola.value_and_derivative(3.0), [3.0, 4.0]);
/// let bounds = parabola.examine([0.0, 3.0], &Budget::unlimited()).unwrap();
/// assert!(bounds.contains(-1.0) && bounds.contains(3.0) && bounds.width() < 4.01);
///
/// // A product needs its sign, and a logarithm has no value at zero.
/// assert!(Expression::parse("2x").is_err());
/// assert!(Expression::parse("ln(x)").unwrap().examine([0.0, 1.0], &Budget::unlimited()).is_err());
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Expression {
    tape: Tape,
}

impl Expression {
    /// Reads an expression in x.
    ///
    /// # Errors
    /// The fault of the text, and the byte where it is.
    pub fn parse(text: &str) -> Result<Self, ExpressionError> {
        Ok(Self { tape: parse::tape(text)? })
    }

    /// How long a value takes, in sums and products, roughly.
    pub fn operations(&self) -> u64 {
        self.tape.steps().iter().map(|step| step.operation.weight()).sum()
    }

    /// The value at `x`, to rounding; NaN or infinite where the expression is not defined.
    pub fn value(&self, x: f64) -> f64 {
        evaluate::value(&self.tape, x)
    }

    /// The value and the derivative at `x`, to rounding. Where the derivative jumps, it is the derivative to
    /// the right. Where it does not exist otherwise, it is NaN or infinite.
    pub fn value_and_derivative(&self, x: f64) -> [f64; 2] {
        evaluate::value_and_derivative(&self.tape, x)
    }

    /// Encloses the value and the first two derivatives over `x`. A derivative that does not exist or has no
    /// bound is the whole line. The first derivatives of `abs`, `min`, `max` and `hypot` have bounds even
    /// where they jump.
    ///
    /// Where an operand is outside the domain of its operation, the value is enclosed as if the operand were
    /// moved to the nearest legal number; [`examine`](Self::examine) finds such operands.
    ///
    /// The functions of the standard library must be as accurate as
    /// [`elementary`](crate::geometry::interval::elementary) assumes.
    pub fn enclose(&self, x: Interval) -> [Interval; 3] {
        enclose::enclose(&self.tape, x)
    }

    /// Proves that the expression is defined, finite and continuous over the closed `domain`, and encloses
    /// its values there. The bounds exceed the values by about 1e-4 of the largest value; by more if ten
    /// thousand cells are not enough.
    ///
    /// # Errors
    /// The place where the expression is not defined, or where the proof fails; or the budget is spent.
    pub fn examine(&self, domain: [f64; 2], budget: &Budget) -> Result<Interval, Undefined> {
        examine::examine(&self.tape, domain, budget)
    }
}
