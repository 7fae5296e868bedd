//! Offences: operations that are not defined for their operand, or whose result is too large.

/// The operation and the kind of operand that it is not defined for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Offence {
    #[error("division by zero")]
    DivisionByZero,
    #[error("log of a number that is not positive")]
    Logarithm,
    #[error("sqrt of a negative number")]
    SquareRoot,
    #[error("{0} of a number outside [-1, 1]")]
    Inverse(&'static str),
    #[error("a negative number to a power that is not a constant whole number (for cube roots use cbrt)")]
    PowerOfNegative,
    #[error("zero to the power of zero or of a negative number")]
    PowerOfZero,
    #[error("a pole of tan")]
    Pole,
    #[error("a value that is too large")]
    Overflow,
}

impl Offence {
    /// Whether the domain of the operation includes its limits, so that the operation can be extended past
    /// them continuously.
    pub(super) fn is_past_a_closed_end(self) -> bool {
        matches!(self, Self::SquareRoot | Self::Inverse(_) | Self::PowerOfNegative)
    }
}

/// Whether every member of an interval offends, or only some members may.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Certainty {
    Possible,
    Certain,
}

/// The offence of an operation on intervals; `None` if no member can offend.
pub(super) type Verdict = Option<(Offence, Certainty)>;

/// An offence, and the byte of the text of the operation that commits it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Finding {
    pub offence: Offence,
    pub certainty: Certainty,
    pub at: usize,
}

impl Finding {
    /// Orders findings: a certain offence is graver than a possible one. Of two equally certain offences, one
    /// that no small move of the operand makes legal is graver.
    pub fn is_graver_than(&self, other: &Self) -> bool {
        let gravity = |of: &Self| (of.certainty, !of.offence.is_past_a_closed_end());
        gravity(self) > gravity(other)
    }
}
