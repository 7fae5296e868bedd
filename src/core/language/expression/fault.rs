//! The faults that the text of an expression may have.

use super::{DEEPEST_NESTING, LONGEST_TEXT};

/// A text that is not an expression.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{fault} (byte {at})")]
pub struct ExpressionError {
    /// The byte of the text, from zero; the length of the text where something is missing at its end.
    pub at: usize,
    pub fault: Fault,
}

#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Fault {
    #[error("the expression is empty")]
    Empty,
    #[error("the expression is longer than {LONGEST_TEXT} bytes")]
    TooLong,
    #[error("parentheses, signs or powers are nested deeper than {DEEPEST_NESTING}")]
    TooDeep,
    #[error("unexpected character {0:?}")]
    UnexpectedCharacter(char),
    #[error("a number, a name or a parenthesis is missing")]
    MissingOperand,
    #[error("an operator is missing; a product is written with *, as in 2*x")]
    MissingOperator,
    #[error("the parenthesis is not closed")]
    UnclosedParenthesis,
    #[error("the closing parenthesis has no opening one")]
    UnopenedParenthesis,
    #[error(
        "{0:?} is not known; known are the variable x, the constants and the functions of the documentation"
    )]
    UnknownName(String),
    #[error("the arguments of {0} must be in parentheses")]
    MissingArguments(&'static str),
    #[error("{name} takes {takes} argument(s), not {given}")]
    WrongNumberOfArguments { name: &'static str, takes: usize, given: usize },
    #[error("the number is too large")]
    NumberTooLarge,
}
