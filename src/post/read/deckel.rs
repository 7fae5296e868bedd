//! Reads programs for Deckel FP-2, in the form that one paper prints.
//!
//! # Method
//! 1. Four lines without a number come first: the program number, the row of the tool, `Z`, and the program
//!    number in parentheses.
//! 2. Numbered blocks follow: the start, the tool, the first rapid, the spindle speed, the motions, and the
//!    three blocks of the end.
//! 3. The line `?` ends the text.
//!
//! # Guarantees
//! * Each line is what the print shows at its place. Each number is written as in the print: no plus sign, no
//!   zero before the point or at the end, at most three decimals.
//! * Three blocks alone write signs always: `X+0 Y+0 Z+100`. They go to the place where the machine rests.
//!
//! # Differences from the paper
//! The print has `X 23.90` once, in block N13 of program 503. All its other coordinates end without a zero,
//! so the reader takes this zero for a misprint, and refuses it. `O` and `C` in numbers of the
//! print are zeros.
//!
//! # Reference
//! Y.-H. Koo, D.-J. Lee, S. Namgung, M.-S. Kang, *A Study on the Construction of CAD/CAM System for Machining
//! of Sculptured Surface of Die*, work supported in 1989, Fig. 4-4.

mod words;

use self::words::{Signs, Words, count, number, position};
use super::cut::Cut;
use super::state::{Calls, MachineState, Spindle};
use super::{Language, Step};
use crate::dialect::Dialect;
use crate::nc::{Fault, Motion, WordFault};
use toolpathd_core::toolpath::units::FeedRate;

/// The least height at which the machine rests between programs, mm.
const LEAST_REST_MM: f64 = 100.0;

/// The form of the row of the tool, and of the lines that a fault names.
const TOOL_ROW: &str = "T 1 R 5 L0.000 S A A ( )";
const START: &str = "G0 X+0 Y+0 Z+100";
const TOOL: &str = "G17 T 1";
const FIRST_RAPID: &str = "G0 X-15 Y 0 Z 45";
const NO_TOOL: &str = "T 0";
const UP: &str = "G0 Z+100";
const END: &str = "G0 X+0 Y+0 M30";
const MARK: &str = "?";

/// The line that has to come next.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Expected {
    Number,
    ToolRow,
    Z,
    NumberAgain,
    Start,
    Tool,
    FirstRapid,
    /// The spindle speed, or the first motion.
    Speed,
    Motion,
    Up,
    End,
    Mark,
    Nothing,
}

/// The rules of the language, with the modal state.
pub struct Reader<'a> {
    dialect: &'a Dialect,
    expects: Expected,
    program: u32,
    tool: u32,
    rest_mm: f64,
    /// The number of the last block.
    block: u32,
    motion: Motion,
    feed: Option<FeedRate>,
    /// Position in mm.
    at: [Option<f64>; 3],
    state: MachineState,
}

impl Language for Reader<'_> {
    fn line(&mut self, text: &str) -> Result<Option<Step>, Fault> {
        let limit = self.dialect.max_line_length;
        if text.chars().count() > limit {
            return Err(Fault::LongLine { limit });
        }
        match self.expects {
            Expected::Number => self.program_number(text)?,
            Expected::ToolRow => self.tool_row(text).ok_or(Fault::Frame(TOOL_ROW))?,
            Expected::Z if text == "Z" => self.expects = Expected::NumberAgain,
            Expected::Z => return Err(Fault::Frame("Z")),
            Expected::NumberAgain => {
                if text != format!("(&X{})", self.program) {
                    return Err(Fault::ProgramNumber);
                }
                self.expects = Expected::Start;
            }
            Expected::Mark if text == MARK => self.expects = Expected::Nothing,
            Expected::Mark => return Err(Fault::Frame(MARK)),
            Expected::Nothing => return Err(Fault::AfterEnd),
            _ => return self.block(text),
        }
        Ok(None)
    }

    // No dialect of this syntax has places for lines of a shop's own.
    fn pass(&mut self) {}

    fn calls(&self) -> Calls {
        Calls { tools: true, length_offsets: false }
    }

    fn state(&self) -> MachineState {
        self.state
    }

    fn program(&self) -> Option<u32> {
        Some(self.program)
    }

    fn end(&self) -> Result<(), Fault> {
        match self.expects {
            Expected::Nothing => Ok(()),
            Expected::Mark => Err(Fault::Frame(MARK)),
            _ => Err(Fault::NoEnd),
        }
    }
}

impl<'a> Reader<'a> {
    /// No program has arcs, so the largest difference of radii does not count.
    pub fn new(dialect: &'a Dialect) -> Self {
        Self {
            dialect,
            expects: Expected::Number,
            program: 0,
            tool: 0,
            rest_mm: 0.0,
            block: 0,
            motion: Motion::Rapid,
            feed: None,
            at: [None; 3],
            state: MachineState::default(),
        }
    }

    fn program_number(&mut self, text: &str) -> Result<(), Fault> {
        let max = self.dialect.max_program_number.unwrap_or(u32::MAX);
        let read = text.strip_prefix("&X").and_then(count).filter(|read| (1..=max).contains(read));
        self.program = read.ok_or(Fault::ProgramNumber)?;
        self.expects = Expected::ToolRow;
        Ok(())
    }

    /// Reads the number and the radius of the tool. `None` where the line has another form.
    fn tool_row(&mut self, text: &str) -> Option<()> {
        let (tool, rest) = text.strip_prefix("T ")?.split_once(" R ")?;
        let radius = rest.strip_suffix(" L0.000 S A A ( )")?;
        self.tool = count(tool).filter(|&tool| tool > 0)?;
        let radius_mm = number(radius, self.dialect).filter(|&radius_mm| radius_mm > 0.0);
        self.state.tool_radius_mm = Some(radius_mm?);
        self.expects = Expected::Z;
        Some(())
    }

    /// A line that begins with the number of its block.
    fn block(&mut self, line: &str) -> Result<Option<Step>, Fault> {
        self.block += 1;
        let expected = self.block;
        let text = line
            .strip_prefix(&format!("N{expected}"))
            .and_then(|text| text.strip_prefix(' '))
            .ok_or(Fault::BlockNumber { expected })?;
        match self.expects {
            Expected::Start => {
                let rest = text.strip_prefix("G0 X+0 Y+0 Z").ok_or(Fault::Frame(START))?;
                self.rest_mm = self.resting_height(rest).ok_or(Fault::Frame(START))?;
                self.expects = Expected::Tool;
                Ok(Some(self.rapid([Some(0.0), Some(0.0), Some(self.rest_mm)])))
            }
            Expected::Tool => {
                if text != format!("G17 T {}", self.tool) {
                    return Err(Fault::Frame(TOOL));
                }
                self.expects = Expected::FirstRapid;
                self.state.tool = Some(self.tool);
                Ok(None)
            }
            Expected::FirstRapid => {
                let words = Words::of(text, self.dialect)?;
                let is_whole = words.position.iter().all(Option::is_some);
                if words.motion != Some(Motion::Rapid) || !is_whole || words.feed.is_some() {
                    return Err(Fault::Frame(FIRST_RAPID));
                }
                self.expects = Expected::Speed;
                Ok(Some(self.rapid(words.position)))
            }
            Expected::Speed if text.starts_with('S') => {
                self.expects = Expected::Motion;
                self.speed(text)
            }
            Expected::Up => {
                let height = text.strip_prefix("G0 Z").and_then(|rest| self.resting_height(rest));
                let height = height.filter(|&height| height == self.rest_mm).ok_or(Fault::Frame(UP))?;
                self.expects = Expected::End;
                Ok(Some(self.rapid([None, None, Some(height)])))
            }
            Expected::End => {
                if text != END {
                    return Err(Fault::Frame(END));
                }
                self.expects = Expected::Mark;
                self.state.spindle = Spindle::Off;
                Ok(Some(self.rapid([Some(0.0), Some(0.0), None])))
            }
            _ if text == NO_TOOL => {
                self.expects = Expected::Up;
                Ok(None)
            }
            _ => {
                self.expects = Expected::Motion;
                self.motion(text)
            }
        }
    }

    /// The height in a block that writes signs always.
    fn resting_height(&self, text: &str) -> Option<f64> {
        position(text, Signs::Always, self.dialect).filter(|&height| height >= LEAST_REST_MM)
    }

    /// The speed, at which the spindle turns from this block on.
    fn speed(&mut self, text: &str) -> Result<Option<Step>, Fault> {
        let rpm = text.strip_prefix("S ").and_then(count).ok_or(Fault::Word("S", WordFault::Form))?;
        let is_legal = (1..=self.dialect.numbers.max_spindle_rpm).contains(&rpm);
        if !is_legal {
            return Err(Fault::Word("S", WordFault::Range));
        }
        (self.state.spindle, self.state.speed_rpm) = (Spindle::Clockwise, Some(f64::from(rpm)));
        Ok(None)
    }

    fn motion(&mut self, text: &str) -> Result<Option<Step>, Fault> {
        let words = Words::of(text, self.dialect)?;
        if words.position.iter().all(Option::is_none) {
            return Err(Fault::Word("X", WordFault::Missing));
        }
        self.motion = words.motion.unwrap_or(self.motion);
        if self.motion == Motion::Rapid {
            return match words.feed {
                Some(_) => Err(Fault::Word("F", WordFault::Unused)),
                None => Ok(Some(self.rapid(words.position))),
            };
        }
        self.feed = words.feed.or(self.feed);
        let from = self.moved(words.position);
        Ok(Some(Cut::between(from, self.at, self.feed.ok_or(Fault::NoFeed)?)?.line()))
    }

    /// Goes to the coordinates of a block, and returns where the block starts.
    fn moved(&mut self, to: [Option<f64>; 3]) -> [Option<f64>; 3] {
        let from = self.at;
        self.at = [0, 1, 2].map(|axis| to[axis].or(from[axis]));
        from
    }

    fn rapid(&mut self, to: [Option<f64>; 3]) -> Step {
        let from = self.moved(to);
        Step::Rapid { from, to: self.at }
    }
}

#[cfg(test)]
mod tests;
