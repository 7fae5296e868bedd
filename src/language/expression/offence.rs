//! Operations outside of their domain.

/// What an operation was asked for that it does not have.
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
    /// Whether the legal arguments include their limits, so that the operation extends past them
    /// continuously.
    pub(super) fn is_past_a_closed_end(self) -> bool {
        matches!(self, Self::SquareRoot | Self::Inverse(_) | Self::PowerOfNegative)
    }
}

/// Whether all members of an interval offend, or some may.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Certainty {
    Possible,
    Certain,
}

/// What an operation on intervals reports.
pub(super) type Verdict = Option<(Offence, Certainty)>;

/// An offence with the byte of the text whose operation commits it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Finding {
    pub offence: Offence,
    pub certainty: Certainty,
    pub at: usize,
}

impl Finding {
    /// What is certain comes before what may be, and what is never legal before what is when the operand is
    /// moved a little.
    pub fn is_graver_than(&self, other: &Self) -> bool {
        let gravity = |of: &Self| (of.certainty, !of.offence.is_past_a_closed_end());
        gravity(self) > gravity(other)
    }
}
