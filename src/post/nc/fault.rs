//! The faults for which a reader refuses a line.

use crate::geometry::curve::ArcError;

/// What is wrong with a line.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Fault {
    #[error("the character {0:?} begins no word")]
    UnknownWord(char),
    #[error("no number can be read after {0}")]
    BadNumber(char),
    #[error("a comment has no closing parenthesis")]
    OpenComment,
    #[error("G{0} is unknown")]
    UnknownG(f64),
    #[error("M{0} is unknown")]
    UnknownM(f64),
    #[error("{0} is written twice")]
    Twice(char),
    #[error("{0} has no meaning in this block")]
    Unused(char),
    #[error("{0} is missing")]
    Missing(char),
    #[error("two words of this block exclude each other")]
    Conflict,
    #[error("the block has coordinates, but no G0, G1, G2 or G3 is in force")]
    NoMotion,
    #[error("the block has coordinates while G91 is in force")]
    Relative,
    #[error("the block cuts, but no feed is in force")]
    NoFeed,
    #[error("the block cuts from an unknown position")]
    UnknownStart,
    #[error("the arc has no centre")]
    MissingCenter,
    #[error("G5.1 needs the plane G17; another plane is active")]
    ParabolaPlane,
    #[error("a coordinate of the parabola is too large")]
    ParabolaSize,
    #[error("the radii at the ends of the arc differ by {mismatch_mm} mm")]
    RadiusMismatch { mismatch_mm: f64 },
    #[error(transparent)]
    Arc(ArcError),
    #[error("the program has no M2 or M30")]
    NoEnd,
    #[error(
        "the % line at the start or at the end of the program is missing, or text stands before the first or after the last %"
    )]
    TapeMark,
    #[error("the program does not begin with a legal program number")]
    ProgramNumber,
    #[error("the number after {0} needs a decimal point")]
    MissingPoint(char),
    #[error("the number after {0} must not have a decimal point")]
    UnexpectedPoint(char),
}
