//! The faults for which the reader refuses a line.

use crate::geometry::curve::ArcError;

/// Why a line is not understood.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Fault {
    #[error("the character {0:?} begins no word")]
    UnknownWord(char),
    #[error("the number after {0} cannot be read")]
    BadNumber(char),
    #[error("a comment is not closed")]
    OpenComment,
    #[error("G{0} is not known")]
    UnknownG(f64),
    #[error("M{0} is not known")]
    UnknownM(f64),
    #[error("{0} is written twice")]
    Twice(char),
    #[error("{0} has no meaning in this block")]
    Unused(char),
    #[error("{0} is missing")]
    Missing(char),
    #[error("two words of this block exclude each other")]
    Conflict,
    #[error("coordinates stand without G0, G1, G2 or G3")]
    NoMotion,
    #[error("coordinates stand under G91")]
    Relative,
    #[error("a cutting block has no feed")]
    NoFeed,
    #[error("a cutting block starts at an unknown place")]
    UnknownStart,
    #[error("an arc has no centre")]
    MissingCenter,
    #[error("a parabola stands outside of the XY plane")]
    ParabolaPlane,
    #[error("a coordinate of a parabola is too large")]
    ParabolaSize,
    #[error("the radii at an arc's ends differ by {mismatch_mm} mm")]
    RadiusMismatch { mismatch_mm: f64 },
    #[error(transparent)]
    Arc(ArcError),
    #[error("the program has no end")]
    NoEnd,
    #[error("the mark at the program's start or end is missing, or something stands outside of it")]
    TapeMark,
    #[error("the program does not begin with its number")]
    ProgramNumber,
    #[error("the number after {0} has no decimal point")]
    MissingPoint(char),
    #[error("the number after {0} has a decimal point")]
    UnexpectedPoint(char),
}
