//! Why a word of a program is refused, and where it stands.

use toolpathd_core::geometry::curve::ArcError;

/// Most refusals of one reading. The reading ends there: what follows is seldom worth more words.
pub const MAX_REFUSALS: usize = 100;

/// What is wrong with a word, or with the block in which it stands.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Fault {
    #[error("no word begins here")]
    NoWord,
    #[error("no number can be read here")]
    NoNumber,
    #[error("the comment has no end")]
    OpenComment,
    #[error("the control does not know this code")]
    UnknownCode,
    #[error("the control does not know this word here")]
    UnusedWord,
    #[error("this version does not read this code")]
    NotRead,
    #[error("this version reads no rotary and no second linear axes")]
    OtherAxis,
    #[error("the letter stands twice in the block")]
    Twice,
    #[error("it excludes another word of the block")]
    Conflict,
    #[error("the word {0} is missing")]
    Missing(char),
    #[error("it needs {0}, which is missing")]
    Lacks(&'static str),
    #[error("it needs the parameter Q{0}, which is missing")]
    LacksParameter(u16),
    #[error("with this value of Q{0} the path of the cycle is not certain")]
    UnsureParameter(u16),
    #[error("the unit of this feed is not certain in a program in inches")]
    UnsureFeed,
    #[error("a parameter of the cycle has changed since its definition")]
    ChangedCycle,
    #[error("the code needs X, Y or Z")]
    NoAxis,
    #[error("coordinates, but no G0, G1, G2, G3 or cycle is in force")]
    NoMotion,
    #[error("the block cuts, but no feed is in force")]
    NoFeed,
    #[error(
        "behind a cycle the manuals do not say whether the feed of the cycle or the feed before it is in force: write F"
    )]
    FeedBehindCycle,
    #[error("a feed per turn needs a spindle speed")]
    NoSpindleSpeed,
    #[error("under G93 every block that cuts needs an F")]
    NoInverseTime,
    #[error("the block cuts from a place that is not known in {0}")]
    UnknownStart(char),
    #[error("the block cuts to a place that is not known in {0}")]
    UnknownEnd(char),
    #[error("the arc has no centre and no radius")]
    NoCenter,
    #[error("the distance of the centre may be incremental or absolute, and both fit: write G91.1 or G90.1")]
    UnsureCenter,
    #[error("{0}")]
    Arc(#[from] ArcError),
    #[error(
        "the ends of the arc are {chord_mm:.4} mm apart, which a radius of {radius_mm:.4} mm cannot span"
    )]
    SmallRadius { chord_mm: f64, radius_mm: f64 },
    #[error("the axes of the plane are scaled by different factors, which makes an ellipse of the arc")]
    Ellipse,
    #[error("a radius cannot say a full circle: write the distance of the centre")]
    ClosedRadius,
    #[error("the number {0} is out of range here")]
    OutOfRange(f64),
    #[error("the cutter does not fit between this block and a neighbour, or into this arc")]
    CutterTooLarge,
    #[error("the radius of the cutter is not given")]
    UnknownRadius,
    #[error("the centre and the radius have to be absolute: write G90")]
    IncrementalCenter,
    #[error("cutter compensation has to begin with a straight move")]
    CompensationByArc,
    #[error("the first move after cutter compensation has to be straight")]
    ArcAfterCompensation,
    #[error(
        "a rounding or a chamfer stands between two sides of the contour: write R0, RL and RR apart from it"
    )]
    CornerBetweenSides,
    #[error("the program changes the length or the radius of the tool by {0} mm")]
    ChangesTool(f64),
    #[error("cutter compensation is in force: end it first (G40, R0)")]
    InCompensation,
    #[error("cutter compensation changes the path by the tool of the machine")]
    Compensation,
    #[error("a corner word needs two cuts in one plane, one right after the other, on which the corner fits")]
    NoCorner,
    #[error("the pole, the polar angle or the polar radius is not known")]
    NoPole,
    #[error("the direction of the path before the arc is not known, or the arc has none")]
    NoTangent,
    #[error("this version reads arcs in planes of two axes only")]
    TiltedArc,
    #[error(
        "a turn leads the normal of the plane away from its axis, and this version reads cycles along an axis only"
    )]
    TiltedCycle,
    #[error(
        "where an incremental way leads after a turn or a scaling depends on the control: write an absolute place"
    )]
    IncrementOfNewZero,
    #[error("the parameter {0} of the cycle is missing, contradicts another, or is not read")]
    CycleParameter(&'static str),
    #[error("the block has more than {0} characters")]
    LongBlock(usize),
    #[error("the same block sets the variable that it reads")]
    SetInBlock,
    #[error("Z of the cycle lies above its R")]
    CycleUpward,
    #[error("a work offset that is turned and a shift by G52, G92 or G10 L20 are not read together")]
    ShiftInTurn,
    #[error("the program tilts the plane, or has tilted it: this version reads upright tools alone")]
    Tilted,
    #[error("nothing has been saved at this level by M70 or M73")]
    NothingSaved,
    #[error(
        "controls differ in how APPR and DEP move along the tool axis: write the height in a block of its own"
    )]
    HeightInLead,
    #[error("the work offset is not known")]
    UnknownOffset,
    #[error("the value is only known at the machine")]
    AtMachine,
    #[error("the expression cannot be read")]
    BadExpression,
    #[error("the expression has no value: {0}")]
    NoValue(&'static str),
    #[error("the expression is nested too deeply")]
    TooDeep,
    #[error("a number without a point is ambiguous here: write a point")]
    NoPoint,
    #[error(
        "whether the modal program (MCALL) runs behind the moves of a program that is called is not certain"
    )]
    ModalInCall,
    #[error("the program raises an alarm of its own")]
    Alarm,
    #[error("the program to call is not in the text")]
    NoProgram,
    #[error("the block to go to is not in the program")]
    NoLabel,
    #[error("the name of the label or the program stands twice")]
    DoubleLabel,
    #[error("the loop or the branch has no beginning or no end")]
    OpenLoop,
    #[error("the program that is called has no end (M99)")]
    OpenCall,
    #[error("calls are nested more than {0} deep")]
    DeepCalls(usize),
    #[error("the program has no end: write M2, M30 or a percent sign at its end")]
    NoEnd,
    #[error("the program runs more than {0} blocks, or without an end")]
    Endless(usize),
    #[error("the toolpath has more than {0} moves, the most that are allowed")]
    TooManyMoves(usize),
    #[error("a coordinate is not finite, or too large")]
    NotFinite,
}

/// A word that is refused.
#[derive(Debug, Clone, PartialEq)]
pub struct Refusal {
    /// Line of the text, counted from 1.
    pub line: usize,
    /// Byte of the line, counted from 1.
    pub column: usize,
    /// The word as it is written, or the start of it.
    pub word: String,
    pub fault: Fault,
}

impl std::fmt::Display for Refusal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { line, column, word, fault } = self;
        if word.is_empty() {
            write!(f, "line {line}: {fault}")
        } else {
            write!(f, "line {line}, column {column}, {word}: {fault}")
        }
    }
}
