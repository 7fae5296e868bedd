//! The differences between the NC languages of different controls, as data.
//!
//! A [`Dialect`] says what a control can do, and in which [`Syntax`] its programs are written. Each syntax
//! has its own reader. ISO words and Siemens share one writer. No reader shares code with a writer.

mod five_axes;

pub use self::five_axes::{AxisOutput, FiveAxisWords, TipControl, Turns};
pub use toolpathd_core::toolpath::arc_rule::ArcRule;
pub use toolpathd_core::toolpath::quantize::{Arcs, Curves, Parabolas};

use toolpathd_core::toolpath::cutting::Coolant;
use toolpathd_core::toolpath::cycle::CycleKind;
use toolpathd_core::toolpath::program::{SafeHome, SmoothingMode, Units};
use toolpathd_core::toolpath::tool::Tool;

/// How a program for one control is written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dialect {
    pub name: &'static str,
    pub description: &'static str,
    pub verification: Verification,
    /// The extension without the dot.
    pub file_extension: &'static str,
    pub line_end: &'static str,
    /// Most characters of a line, without the line end.
    pub max_line_length: usize,
    /// The largest number of a program; none where the control knows a program by its file.
    pub max_program_number: Option<u32>,
    pub default_decimals_mm: u8,
    pub default_decimals_inch: u8,
    pub max_decimals: u8,
    pub numbers: Numbers,
    /// The curves that the control runs. All others become lines.
    pub curves: Curves,
    pub abilities: Abilities,
    /// The place where the machine rests between programs, mm. Programs go there first and last. None where a
    /// program may begin anywhere.
    pub rests_at_mm: Option<[f64; 3]>,
    /// None where the control has no word for smoothing.
    pub smoothing: Option<SmoothingWords>,
    pub five_axes: FiveAxisWords,
    pub syntax: Syntax,
}

/// The words for a control's own smoothing, and the values that they take.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SmoothingWords {
    pub form: SmoothingForm,
    pub takes_tolerance: bool,
    pub needs_tolerance: bool,
    pub takes_degrees: bool,
    pub modes: &'static [SmoothingMode],
    /// The mode of a program that asks for none, where the word needs one.
    pub usual_mode: Option<SmoothingMode>,
    /// The codes, in tenths, by which a shop's own lines choose how closely the control keeps the path.
    pub own: &'static [i32],
}

/// The word for smoothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SmoothingForm {
    /// LinuxCNC: `G64 P`.
    Blending,
    /// Siemens: `CYCLE832`.
    Cycle832,
    /// Fanuc: `G5.1 Q1`.
    ContourControl,
    /// Haas: `G187`.
    G187,
    /// Heidenhain: cycle 32.
    Cycle32,
}

/// What has read programs of a dialect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, utoipa::ToSchema), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "wire", schema(as = VerifiedBy))]
pub enum Verification {
    /// The interpreter of the control itself.
    Interpreter,
    /// The interpreter of another control, after words that it reads differently were translated.
    RelatedInterpreter,
    /// A reader that was written from published descriptions, apart from the writer, and that checks each
    /// program. No control was at hand.
    Reader,
    /// Nothing: the words are those of the family, as they are commonly described.
    Unverified,
}

/// What a control can do, apart from motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Abilities {
    pub units: &'static [Units],
    /// The numbers of G54 to G59 that programs may ask for.
    pub work_offsets: &'static [u8],
    pub safe_homes: &'static [SafeHome],
    pub coolants: &'static [Coolant],
    /// None where the offset of a tool has no number of its own.
    pub length_offsets: Option<LengthOffsets>,
    /// Whether programs state the radius of the tool.
    pub needs_tool: bool,
    pub has_dwells: bool,
    /// The canned cycles that programs have. The moves of all others are written.
    pub cycles: &'static [CycleKind],
    /// The longest pause of one block, s.
    pub max_dwell_s: f64,
    pub has_comments: bool,
    /// The largest number of a tool.
    pub max_tool: u32,
}

impl Abilities {
    /// What most controls can do.
    pub const USUAL: Self = Self {
        units: &[Units::Mm, Units::Inch],
        work_offsets: &[54, 55, 56, 57, 58, 59],
        safe_homes: &[SafeHome::None, SafeHome::G28, SafeHome::G53],
        coolants: &[Coolant::Off, Coolant::Flood, Coolant::Mist],
        length_offsets: Some(LengthOffsets { letter: 'H', usual: None, most: 99_999_999 }),
        needs_tool: false,
        has_dwells: true,
        cycles: &CycleKind::ALL,
        max_dwell_s: 1e6,
        has_comments: true,
        max_tool: 99_999_999,
    };
}

/// The numbers of length offsets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LengthOffsets {
    pub letter: char,
    /// The offset of a tool without `length_offset`. None: the offset has the number of the tool.
    pub usual: Option<u32>,
    pub most: u32,
}

/// The numbers that a control reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Numbers {
    /// Whether whole coordinates and feeds need a decimal point.
    pub point: Point,
    /// Most digits of one number, before and after the point together.
    pub max_digits: u32,
    /// Most digits before the point.
    pub max_whole_digits: u32,
    /// Most decimals of F as it stands in the program.
    pub max_feed_decimals: u8,
    /// Whether F counts tenths of an inch in a program in inches.
    pub feeds_in_tenths_of_inch: bool,
    pub spindle_decimals: u8,
    pub max_spindle_rpm: u32,
}

impl Numbers {
    /// Most decimals of a feed in units of the program per minute.
    pub fn feed_decimals(&self, units: Units) -> u8 {
        self.max_feed_decimals + u8::from(self.feeds_in_tenths_of_inch && units == Units::Inch)
    }
}

/// The largest F under G93 of Fanuc and of controls that follow it: the manuals give 9999.999
/// (B-62764EN, 5.3). The number is whole, so that its word is exact.
pub const FANUC_INVERSE_TIME: u32 = 9_999;

/// The syntax of a family of controls.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Syntax {
    /// Words of a letter and a number (ISO 6983).
    Iso(Iso),
    /// The same, with the words that Siemens adds.
    Siemens(Iso),
    /// Heidenhain Klartext.
    Klartext,
    /// Deckel FP-2, as printed in a paper.
    Deckel,
}

/// The data of programs of ISO words.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Iso {
    pub comment: Comment,
    /// The first and the last line of every program; none where the control needs no tape mark.
    pub tape_mark: Option<&'static str>,
    /// The line with the program number; none where the control knows a program by its file.
    pub program_number: Option<ProgramNumber>,
    pub block_numbers: BlockNumbers,
    pub dwell: Dwell,
    /// The word that selects a work offset, before its number.
    pub work_offset: &'static str,
    /// The words that change the tool, and the words that select its length offset. `{tool}` and `{offset}`
    /// stand for their numbers.
    pub tool_change: &'static str,
    pub length_offset: &'static str,
    /// The lines that move up to the machine's end of Z. `{Z0}` stands for a Z word of zero.
    pub reference_point: &'static [&'static str],
    pub machine_zero: &'static [&'static str],
    /// G codes that programs of this dialect have besides those of all dialects, in tenths.
    pub further_g: &'static [i32],
    /// The lines before the first motion and after the last.
    pub start: &'static [Frame],
    pub end: &'static [Frame],
}

impl Dialect {
    /// The number of the length offset that programs select for a tool.
    pub fn length_offset_of(&self, tool: &Tool) -> u32 {
        let usual = self.abilities.length_offsets.and_then(|offsets| offsets.usual);
        tool.length_offset.or(usual).unwrap_or(tool.places().0)
    }

    /// Whether programs state the raw part, of which the control draws a picture.
    pub const fn states_blank(&self) -> bool {
        matches!(self.syntax, Syntax::Klartext)
    }

    /// Whether a program can have several tools.
    pub fn changes_tools(&self) -> bool {
        match self.syntax {
            Syntax::Iso(iso) | Syntax::Siemens(iso) => iso.start.contains(&Frame::ToolChange),
            Syntax::Klartext => true,
            Syntax::Deckel => false,
        }
    }

    /// Whether the name of a program stands beside its number.
    pub fn names_programs_at_their_number(&self) -> bool {
        matches!(self.syntax, Syntax::Iso(iso) | Syntax::Siemens(iso) if iso.program_number.is_some())
    }

    /// Whether a semicolon ends a block, so that words may stand behind it: on Fanuc and controls that follow
    /// it. Elsewhere a comment stands there.
    pub fn ends_blocks_with_semicolons(&self) -> bool {
        self.names_programs_at_their_number()
    }

    /// Whether the text of a program begins with the name that its file must have: `BEGIN PGM 501 MM`.
    pub fn names_files_in_their_text(&self) -> bool {
        matches!(self.syntax, Syntax::Klartext)
    }

    /// Whether programs are words of a letter and a number and nothing else, so that a program of any origin
    /// can be read word by word.
    pub fn has_plain_words(&self) -> bool {
        matches!(self.syntax, Syntax::Iso(iso) if iso.dwell != Dwell::FeedWord)
    }
}

impl Iso {
    /// The words that most dialects share.
    pub const USUAL: Self = Self {
        comment: Comment { open: "(", separator: " = ", close: ")" },
        tape_mark: None,
        program_number: None,
        block_numbers: BlockNumbers { step: 10, max: 99_990 },
        dwell: Dwell::Seconds,
        work_offset: "G",
        tool_change: "T{tool} M6",
        length_offset: "G43 H{offset}",
        reference_point: &["G91 G28 {Z0}", "G90"],
        machine_zero: &["G53 G0 {Z0}"],
        further_g: &[],
        start: &[],
        end: &[
            Frame::SmoothingOff,
            Frame::SafeHome,
            Frame::Text("M5"),
            Frame::Text("M9"),
            Frame::Text("M30"),
        ],
    };
}

/// The form of a comment: `open`, a label, `separator`, the text, `close`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Comment {
    pub open: &'static str,
    pub separator: &'static str,
    pub close: &'static str,
}

/// The form of a program number: a letter and at least `digits` digits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ProgramNumber {
    pub letter: char,
    pub digits: usize,
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

/// The time of a G4 block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dwell {
    /// P counts seconds, with three decimals.
    Seconds,
    /// P counts whole milliseconds.
    Milliseconds,
    /// F counts seconds, with three decimals.
    FeedWord,
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
    /// The words before and after a distance of one unit of the last decimal, or the smoothing that the job
    /// asks for.
    Blending {
        before: &'static str,
        after: &'static str,
    },
    /// The smoothing that the job asks for, in a block of its own.
    Smoothing,
    /// The end of that smoothing.
    SmoothingOff,
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
