//! The differences between the NC languages of different controls, as data.

pub use crate::toolpath::quantize::Parabolas;

/// How a program for one control is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Dialect {
    pub name: &'static str,
    pub description: &'static str,
    /// The extension without the dot.
    pub file_extension: &'static str,
    pub comment: Comment,
    pub line_end: &'static str,
    /// Most characters of a line, without the line end.
    pub max_line_length: usize,
    /// The first and the last line of every program; none where the control needs no tape mark.
    pub tape_mark: Option<&'static str>,
    /// The line with the program number; none where the control knows a program by its file.
    pub program_number: Option<ProgramNumber>,
    pub default_decimals_mm: u8,
    pub default_decimals_inch: u8,
    pub max_decimals: u8,
    pub numbers: Numbers,
    pub block_numbers: BlockNumbers,
    pub dwell: Dwell,
    pub parabolas: Parabolas,
    /// Decimals of a written angle, in degrees.
    pub angle_decimals: u8,
    pub tip_control: TipControl,
    /// The lines before the first motion and after the last.
    pub start: &'static [Frame],
    pub end: &'static [Frame],
}

/// The codes that switch tip control on. Under tip control X, Y and Z state the place of the tool tip, also
/// while the tool leans. `None` where the control has no such code.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct TipControl {
    /// With the angles of the rotary axes in the blocks.
    pub angles: Option<&'static str>,
    /// With the vector of the tool axis as I, J and K in the blocks.
    pub vectors: Option<&'static str>,
}

/// The form of a comment: `open`, a label, `separator`, the text, `close`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Comment {
    pub open: &'static str,
    pub separator: &'static str,
    pub close: &'static str,
}

/// The form of a program number: a letter and at least `digits` digits, from 1 to `max`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ProgramNumber {
    pub letter: char,
    pub digits: usize,
    pub max: u32,
}

/// The numbers that a control reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Numbers {
    /// Whether whole coordinates and feeds need a decimal point.
    pub point: Point,
    /// Most digits of one number, before and after the point together.
    pub max_digits: u32,
    pub spindle_decimals: u8,
    pub max_spindle_rpm: u32,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Point {
    /// A number means the same with and without a point.
    WhereNeeded,
    /// A number without a point counts least increments.
    Always,
}

/// The N words of a program: `step`, twice `step` and so on up to `max`, then again from `step`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BlockNumbers {
    pub step: u32,
    pub max: u32,
}

/// The unit of P in a G4 block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dwell {
    /// Seconds with three decimals.
    Seconds,
    /// Whole milliseconds.
    Milliseconds,
}

/// One part of a program's start or end. A part that the job does not ask for writes no line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Frame {
    /// Comments for people: name, notes, tool, figures, warnings.
    Header,
    Text(&'static str),
    /// A text for each of the units.
    ByUnits {
        mm: &'static str,
        inch: &'static str,
    },
    /// The words before and after a distance of one unit of the last decimal.
    Blending {
        before: &'static str,
        after: &'static str,
    },
    WorkOffset,
    /// The move to the machine's end of Z, by the code that the job asks for.
    SafeHome,
    ToolChange,
    SpindleOn,
    CoolantOn,
    /// The length offset in a block of its own.
    LengthOffset,
    /// The length offset in the block of the first motion along Z, which is a rapid.
    LengthOffsetInFirstMotionAlongZ,
}
