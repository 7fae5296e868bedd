//! The faults for which a reader refuses a line.

use toolpathd_core::geometry::curve::ArcError;

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
    #[error("the canned cycle does not drill down from its retract plane, or starts below that plane")]
    Cycle,
    #[error("the arc has no centre")]
    MissingCenter,
    #[error("G5.1 needs the plane G17; another plane is active")]
    ParabolaPlane,
    #[error("a coordinate of the parabola is too large")]
    ParabolaSize,
    #[error("the radii at the ends of the arc differ by {mismatch_mm} mm")]
    RadiusMismatch { mismatch_mm: f64 },
    #[error("the centre of the arc is nearer to its start than half of the way to its end")]
    NoOwnCenter,
    #[error(
        "seen from the start of the arc, the centre that the control computes is {degrees} degrees beside the written one"
    )]
    TurnedCenter { degrees: f64 },
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
    #[error("{0} {1}")]
    Word(&'static str, WordFault),
    #[error("the line has more than {limit} characters")]
    LongLine { limit: usize },
    #[error("the block number must be {expected}")]
    BlockNumber { expected: u32 },
    #[error("this line must have the form {0:?}")]
    Frame(&'static str),
    #[error("the block is of no kind that is known")]
    UnknownBlock,
    #[error("text stands after the end of the program")]
    AfterEnd,
    #[error("the block needs {0}, which no block has selected")]
    NoMode(&'static str),
    #[error("the helix turns more than once; write a block for each turn")]
    ManyTurns,
    #[error("tip control is switched on before a tool is called")]
    NoTool,
    #[error("the block moves along Z, but no cutting edge of a tool is selected; D1 selects the first")]
    NoEdge,
    #[error("the block is not allowed under tip control")]
    UnderTipControl,
    #[error("the block states the tool axis as a vector, but tip control with vectors is off")]
    NoTipControl,
}

/// What is wrong with a word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum WordFault {
    #[error("is missing")]
    Missing,
    #[error("is written twice")]
    Twice,
    #[error("has no meaning in this block")]
    Unused,
    #[error("stands in the wrong place of the block")]
    Order,
    #[error("has no number that can be read")]
    Number,
    #[error("has a number that is not written as the control writes it")]
    Form,
    #[error("has a number that is not allowed here")]
    Range,
}
