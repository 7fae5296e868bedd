//! Reads programs in Heidenhain Klartext.
//!
//! # Method
//! 1. Each line is a block: its number, a blank and its text. The first word of the text, or all of it, tells
//!    the kind of block.
//! 2. `words` reads the words of a block in the order in which the control writes them.
//! 3. `motion` makes a step of the words and of the modal state: position, circle centre, feed, tip control.
//!
//! # Guarantees
//! * `BEGIN PGM` and `END PGM` state the same name and unit, M30 stands before `END PGM`, and block numbers
//!   count from 0 in steps of 1.
//! * DR+ is G3 and DR- is G2 in all three planes. An arc whose end equals its start is a full circle.
//! * In a program in inches, F counts tenths of an inch per minute. For a turn of the axis about a resting
//!   tip, F counts degrees per minute. An F of one of these two units is no feed for a motion of the other.
//! * A tool call loses Z, because the length of the tool changes. Switching tip control on or off loses X, Y
//!   and Z, because the coordinates are those of another point.
//! * A motion with a vector leaves the rotary axes at angles that are not known. No cut without tip control
//!   may follow until a block states the angles.
//! * Without tip control, a feed block may not turn the axis: the manuals do not say what its F counts.
//!
//! A helix of more than one turn is refused, because a step is one curve and turns once at most.
//!
//! # Reference
//! HEIDENHAIN user's manuals: TNC 407 pp. 118-119, 137 (planes, DR, CC, helix); TNC 426/430 p. 154 (`CP IPA
//! IZ`); iTNC 530 (340 49x-04) p. 254 (arcs outside of the working plane) and p. 457 (`FUNCTION TCPM`); TNC
//! 620 (2015) p. 455 (`LN` with TX TY TZ); TNC 640 (34059x-01) p. 400 (normalized vectors, order of the words
//! of LN) and (34059x-05) pp. 115, 631 (names, dwell). Tenths of an inch: the post-processor of Autodesk,
//! `heidenhain.cps`, 2023.

mod blank;
mod cycle;
mod motion;
mod smoothing;
mod tool;
mod words;

use nalgebra::Point3;

use self::words::{Functions, Limits, Words};
use super::hole::Cycle;
use super::number::Number;
use super::state::{Calls, FIRST_WORK_OFFSET, MachineState};
use super::{Language, Step, TipMode};
use crate::dialect::Dialect;
use crate::nc::{Fault, WordFault};
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::arc_rule::ArcRule;
use toolpathd_core::toolpath::program::{Smoothing, Units};
use toolpathd_core::toolpath::units::FeedRate;

/// The last row of the table of presets.
const MAX_PRESET: u32 = 65_535;

/// The longest dwell of one block, s, and its decimals.
const MAX_DWELL_S: f64 = 3600.0;
const DWELL_DECIMALS: u8 = 3;

/// The form of the first and of the last line.
const BEGIN: &str = "0 BEGIN PGM name MM";
const END: &str = "n END PGM name MM";
const PRESET: &str = "  Q339=+1 ; DATUM NUMBER";
const DWELL: &str = "n CYCL DEF 9.1 DWELL seconds";

/// The kind of line that has to come next.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Expected {
    Begin,
    Block,
    /// The second block of the cycle for a dwell.
    DwellTime,
    /// The second block of the cycle for smoothing.
    Tolerance,
    /// The second block of the raw part.
    HighCorner,
    /// The second line of the block that activates a preset. It has no number.
    Preset,
    /// The next line of the definition of a canned cycle. It has no number.
    Parameter,
    /// The last block, after M30.
    End,
    /// Nothing but blank lines.
    Blank,
}

/// The modal feed.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Feed {
    /// Of the tip along its way.
    Along(FeedRate),
    /// Of the axis about a resting tip, degrees per minute.
    Turning(f64),
}

/// The rules of Klartext, with the modal state.
pub struct Reader<'a> {
    dialect: &'a Dialect,
    /// What the control demands of an arc.
    arcs: ArcRule,
    expects: Expected,
    /// The number of the next block.
    number: u32,
    name: String,
    units: Units,
    /// Position in mm.
    at: [Option<f64>; 3],
    /// The centre in mm; its coordinate along the normal of the plane is zero.
    center: Option<(Plane, Point3<f64>)>,
    feed: Option<Feed>,
    has_tool: bool,
    mode: TipMode,
    angles: [Option<f64>; 3],
    vector: Option<[f64; 3]>,
    /// Whether the last motion with a vector has left the rotary axes at unknown angles.
    has_lost_axis: bool,
    smoothing: Option<Smoothing>,
    /// Whether the last block stated the tolerance of the path, so that the next may state its mode.
    has_open_tolerance: bool,
    /// The lowest and the highest corner of the raw part, mm.
    low_corner: Option<Point3<f64>>,
    high_corner: Option<Point3<f64>>,
    /// A canned cycle whose definition is under way.
    definition: Option<cycle::Definition>,
    cycle: Option<Cycle>,
    state: MachineState,
    /// Neither position nor feed is taken for granted behind a change from one tool to another.
    is_strict: bool,
}

impl Language for Reader<'_> {
    fn line(&mut self, text: &str) -> Result<Option<Step>, Fault> {
        if self.expects == Expected::Blank {
            return if text.trim().is_empty() { Ok(None) } else { Err(Fault::AfterEnd) };
        }
        let limit = self.dialect.max_line_length;
        if text.chars().count() > limit {
            return Err(Fault::LongLine { limit });
        }
        match self.expects {
            Expected::Preset => return self.preset(text).map(|()| None),
            Expected::Parameter => return self.parameter(text).map(|()| None),
            _ => {}
        }
        let block = self.numbered(text)?;
        match self.expects {
            Expected::Begin => self.begin(block).ok_or(Fault::Frame(BEGIN)).map(|()| None),
            Expected::DwellTime => self.dwell(block).map(Some),
            Expected::Tolerance => self.tolerance(block).map(|()| None),
            Expected::HighCorner => self.high_corner(block).map(|()| None),
            Expected::End => self.finish(block).map(|()| None),
            Expected::Block | Expected::Preset | Expected::Parameter | Expected::Blank => self.block(block),
        }
    }

    fn pass(&mut self) {
        self.number += 1;
        (self.at, self.center, self.feed) = ([None; 3], None, None);
        (self.mode, self.angles, self.vector) = (TipMode::Off, [None; 3], None);
        // The line may have called a tool; if it has not, the program runs with the tool that is in place.
        self.has_tool = true;
        (self.smoothing, self.cycle) = (None, None);
        self.state = self.state.behind_own_lines();
    }

    fn assume_nothing(&mut self) {
        self.is_strict = true;
    }

    fn calls(&self) -> Calls {
        Calls { tools: true, length_offsets: false }
    }

    fn state(&self) -> MachineState {
        self.state
    }

    fn program(&self) -> Option<u32> {
        self.name.parse().ok()
    }

    fn smoothing(&self) -> Option<Smoothing> {
        self.smoothing
    }

    fn blank(&self) -> Option<[Point3<f64>; 2]> {
        Some([self.low_corner?, self.high_corner?])
    }

    fn end(&self) -> Result<(), Fault> {
        match self.expects {
            Expected::HighCorner => Err(Fault::Frame(blank::HIGH)),
            Expected::Begin => Err(Fault::Frame(BEGIN)),
            Expected::Block => Err(Fault::NoEnd),
            Expected::DwellTime => Err(Fault::Frame(DWELL)),
            Expected::Tolerance => Err(Fault::Frame(smoothing::TOLERANCE)),
            Expected::Preset => Err(Fault::Frame(PRESET)),
            Expected::Parameter => Err(Fault::Frame(cycle::PARAMETER)),
            Expected::End => Err(Fault::Frame(END)),
            Expected::Blank => Ok(()),
        }
    }
}

impl<'a> Reader<'a> {
    pub fn new(dialect: &'a Dialect, arcs: ArcRule) -> Self {
        Self {
            dialect,
            arcs,
            expects: Expected::Begin,
            number: 0,
            name: String::new(),
            units: Units::Mm,
            at: [None; 3],
            center: None,
            feed: None,
            has_tool: false,
            mode: TipMode::Off,
            angles: [None; 3],
            vector: None,
            has_lost_axis: false,
            smoothing: None,
            has_open_tolerance: false,
            low_corner: None,
            high_corner: None,
            definition: None,
            cycle: None,
            state: MachineState::default(),
            is_strict: false,
        }
    }

    /// The text of a block behind its number.
    fn numbered<'t>(&mut self, line: &'t str) -> Result<&'t str, Fault> {
        let expected = self.number;
        self.number += 1;
        let text = line.strip_prefix(&expected.to_string()).and_then(|text| text.strip_prefix(' '));
        text.map(str::trim_end).ok_or(Fault::BlockNumber { expected })
    }

    /// Reads the first block. `None` where it has another form.
    fn begin(&mut self, block: &str) -> Option<()> {
        let (name, units) = block.strip_prefix("BEGIN PGM ")?.split_once(' ')?;
        self.units = match units {
            "MM" => Units::Mm,
            "INCH" => Units::Inch,
            _ => return None,
        };
        let is_legal = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '_' | '-');
        let is_number = name.bytes().all(|c| c.is_ascii_digit());
        let max = self.dialect.max_program_number.unwrap_or(u32::MAX);
        let is_too_large = is_number && name.parse().map_or(true, |number: u32| number > max);
        if name.is_empty() || is_too_large || !name.chars().all(is_legal) {
            return None;
        }
        self.name = name.to_owned();
        self.expects = Expected::Block;
        Some(())
    }

    /// Reads the last block.
    fn finish(&mut self, block: &str) -> Result<(), Fault> {
        let units = match self.units {
            Units::Mm => "MM",
            Units::Inch => "INCH",
        };
        if block != format!("END PGM {} {units}", self.name) {
            return Err(if block.starts_with("END") { Fault::Frame(END) } else { Fault::AfterEnd });
        }
        self.expects = Expected::Blank;
        Ok(())
    }

    fn block(&mut self, block: &str) -> Result<Option<Step>, Fault> {
        let may_state_mode = std::mem::take(&mut self.has_open_tolerance);
        match block {
            "FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS" => return self.begin_tip_control(TipMode::Angles),
            "FUNCTION TCPM F TCP AXIS SPAT PATHCTRL VECTOR" => {
                return self.begin_tip_control(TipMode::Vectors);
            }
            "FUNCTION RESET TCPM" => {
                self.switch(TipMode::Off);
                return Ok(None);
            }
            "CYCL DEF 247 DATUM SETTING ~" => {
                if self.mode != TipMode::Off {
                    return Err(Fault::UnderTipControl);
                }
                self.expects = Expected::Preset;
                self.at = [None; 3];
                return Ok(None);
            }
            "CYCL DEF 200 DRILLING ~" => {
                self.define(cycle::DRILLING);
                return Ok(None);
            }
            "CYCL DEF 201 REAMING ~" => {
                self.define(cycle::REAMING);
                return Ok(None);
            }
            "CYCL DEF 32.0 TOLERANCE" => {
                self.expects = Expected::Tolerance;
                return Ok(None);
            }
            _ if may_state_mode && block.starts_with("CYCL DEF 32.2 ") => {
                return self.smoothing_mode(block).map(|()| None);
            }
            "CYCL DEF 9.0 DWELL TIME" => {
                self.expects = Expected::DwellTime;
                return Ok(None);
            }
            _ => {}
        }
        let (head, tail) = block.split_once(' ').unwrap_or((block, ""));
        match head {
            "L" => self.straight(tail),
            "LN" => self.vector(tail).map(Some),
            "CC" => self.circle_center(tail),
            "C" => self.arc(tail).map(Some),
            "BLK" => self.low_corner(block).map(|()| None),
            "CP" => self.helix(tail).map(Some),
            "TOOL" => self.tool_call(tail),
            "END" => Err(Fault::NoEnd),
            // The control joins a line that ends with a tilde and the line behind it.
            _ if block.starts_with(';') && !block.ends_with('~') => Ok(None),
            _ if is_function(head) => {
                let words = Words::of(block, words::FUNCTIONS, &self.limits())?;
                self.functions(&words.functions)?;
                Ok(None)
            }
            _ => Err(Fault::UnknownBlock),
        }
    }

    /// The row of the table of presets.
    fn preset(&mut self, line: &str) -> Result<(), Fault> {
        let row = line.strip_prefix("  Q339=+").and_then(|rest| rest.strip_suffix(" ; DATUM NUMBER"));
        let row = row.and_then(Number::whole_of).and_then(Number::count).ok_or(Fault::Frame(PRESET))?;
        if row > MAX_PRESET {
            return Err(Fault::Word("Q339", WordFault::Range));
        }
        self.expects = Expected::Block;
        self.state.work_offset = Some(row + FIRST_WORK_OFFSET - 1).filter(|_| row > 0);
        Ok(())
    }

    fn begin_tip_control(&mut self, mode: TipMode) -> Result<Option<Step>, Fault> {
        if !self.has_tool {
            return Err(Fault::NoTool);
        }
        if self.mode != TipMode::Off {
            return Err(Fault::UnderTipControl);
        }
        self.switch(mode);
        Ok(None)
    }

    fn switch(&mut self, mode: TipMode) {
        if self.mode != mode {
            self.at = [None; 3];
            self.vector = None;
        }
        self.mode = mode;
    }

    fn dwell(&mut self, block: &str) -> Result<Step, Fault> {
        let text = block.strip_prefix("CYCL DEF 9.1 DWELL ").ok_or(Fault::Frame(DWELL))?;
        let number = Number::whole_of(text).ok_or(Fault::Word("DWELL", WordFault::Number))?;
        if number.sign.is_some() || !number.fits(4, DWELL_DECIMALS) {
            return Err(Fault::Word("DWELL", WordFault::Form));
        }
        if number.value > MAX_DWELL_S {
            return Err(Fault::Word("DWELL", WordFault::Range));
        }
        self.expects = Expected::Block;
        Ok(Step::Dwell { seconds: number.value })
    }

    /// Lets the M words of a block take effect, but for M91 and M99.
    ///
    /// # Errors
    /// When M91 or M99 stands in a block where it is not read, or the program ends under tip control.
    fn functions(&mut self, functions: &Functions) -> Result<(), Fault> {
        if functions.has_machine_zero || functions.has_call {
            return Err(Fault::Conflict);
        }
        self.state.spindle = functions.spindle.unwrap_or(self.state.spindle);
        self.state.coolant = functions.coolant.unwrap_or(self.state.coolant);
        if functions.has_end {
            if self.mode != TipMode::Off {
                return Err(Fault::UnderTipControl);
            }
            self.expects = Expected::End;
        }
        Ok(())
    }

    fn limits(&self) -> Limits {
        Limits {
            decimals: self.dialect.max_decimals,
            angle_decimals: self.dialect.five_axes.angle_decimals,
            feed_decimals: self.dialect.numbers.max_feed_decimals,
        }
    }
}

/// Whether a word is an M and a number.
fn is_function(word: &str) -> bool {
    word.strip_prefix('M').is_some_and(|digits| digits.starts_with(|c: char| c.is_ascii_digit()))
}

#[cfg(test)]
mod tests;
