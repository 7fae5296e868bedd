//! Blocks as lines of words, with modal words left out where they hold already.

use super::dialect::{CommentStyle, Frame};
use super::lower::Block;
use super::words::{self, FeedWord};
use super::{ProgramJob, WriteError};
use crate::geometry::curve::Direction;
use crate::geometry::plane::Plane;
use crate::toolpath::program::Units;
use crate::toolpath::tool::Coolant;

/// The letters of the axes and of the centre's offsets along them.
const AXES: [char; 3] = ['X', 'Y', 'Z'];
const OFFSETS: [char; 3] = ['I', 'J', 'K'];

/// The text of a whole program.
///
/// # Errors
/// When a word of the frame cannot be written, or a line is longer than its control takes.
pub fn text(blocks: &[Block], job: &ProgramJob) -> Result<String, WriteError> {
    let mut writer = Writer {
        job,
        text: String::with_capacity(32 * (blocks.len() + 16)),
        line: String::new(),
        block_number: 0,
        motion: None,
        // The safety line selects it.
        plane: Plane::Xy,
        at: [None; 3],
        feed: None,
    };
    for frame in job.dialect.start {
        writer.frame(*frame)?;
    }
    for block in blocks {
        writer.block(block)?;
    }
    for frame in job.dialect.end {
        writer.frame(*frame)?;
    }
    Ok(writer.text)
}

struct Writer<'a> {
    job: &'a ProgramJob<'a>,
    text: String,
    line: String,
    block_number: u32,
    motion: Option<&'static str>,
    plane: Plane,
    /// Where the control is, as last written.
    at: [Option<i64>; 3],
    feed: Option<FeedWord>,
}

impl Writer<'_> {
    fn frame(&mut self, frame: Frame) -> Result<(), WriteError> {
        let job = self.job;
        match frame {
            Frame::Header => return self.header(),
            Frame::Text(text) => self.word(text),
            Frame::Safety { mm, inch } => self.word(match job.program.resolution.units {
                Units::Mm => mm,
                Units::Inch => inch,
            }),
            Frame::Blending { before, after } => {
                self.number(before, 1, job.program.resolution.decimals);
                self.line.push_str(after);
            }
            Frame::WorkOffset => match job.program.work_offset {
                None => {}
                Some(number @ 54..=59) => self.word(&format!("G{number}")),
                Some(number) => return Err(WriteError::WorkOffset { number }),
            },
            Frame::ToolChange => self.word(&format!("T{} M6", job.tool.number)),
            Frame::LengthOffset => self.word(&format!("G43 H{}", job.tool.length_offset)),
            Frame::SpindleOn => {
                if let Some(rpm) = job.cutting.spindle_rpm {
                    let speed = words::spindle(rpm)?;
                    self.number("S", speed.digits, speed.decimals);
                    self.word("M3");
                }
            }
            Frame::CoolantOn => match job.cutting.coolant {
                Coolant::Off => {}
                Coolant::Mist => self.word("M7"),
                Coolant::Flood => self.word("M8"),
            },
        }
        self.end_line()
    }

    fn header(&mut self) -> Result<(), WriteError> {
        let job = self.job;
        if let Some(name) = &job.program.name {
            self.comment("PROGRAM", name)?;
        }
        let mut diameter = String::new();
        let micrometres = (2000.0 * job.tool.radius_mm).round();
        words::push_fixed(&mut diameter, micrometres as i64, 3);
        self.comment("TOOL", &format!("T{} BALL DIAMETER {diameter} MM", job.tool.number))?;
        for text in job.comments {
            self.comment("NOTE", text)?;
        }
        if job.cutting.spindle_rpm.is_none() {
            self.comment("WARNING", "NO SPINDLE SPEED WAS GIVEN - THIS PROGRAM STARTS NO SPINDLE")?;
        }
        Ok(())
    }

    /// A comment line; text of which nothing is left after cleaning gives none.
    fn comment(&mut self, label: &str, text: &str) -> Result<(), WriteError> {
        let (open, close) = match self.job.dialect.comment {
            CommentStyle::Parentheses => ("(", ")"),
        };
        // Room for a block number and the label with its punctuation.
        let used = 16 + label.len();
        let clean = words::cleaned(text, self.job.dialect.max_line_length.saturating_sub(used));
        if clean.is_empty() {
            return Ok(());
        }
        self.word(&format!("{open}{label}: {clean}{close}"));
        self.end_line()
    }

    fn block(&mut self, block: &Block) -> Result<(), WriteError> {
        match *block {
            Block::Rapid { to } => {
                self.motion("G0");
                for (axis, to) in to.into_iter().enumerate() {
                    if let Some(to) = to {
                        self.axis(axis, to);
                    }
                }
            }
            Block::Line { to, feed } => {
                self.motion("G1");
                for (axis, to) in to.into_iter().enumerate() {
                    self.axis_if_changed(axis, to);
                }
                self.feed(feed);
            }
            Block::Arc { plane, direction, to, center, feed } => {
                self.plane(plane);
                self.motion(match direction {
                    Direction::Cw => "G2",
                    Direction::Ccw => "G3",
                });
                let [first, second, normal] = plane.axes();
                for (axis, to) in to.into_iter().enumerate() {
                    if axis == normal { self.axis_if_changed(axis, to) } else { self.axis(axis, to) }
                }
                let mut offsets = [(first, center[0]), (second, center[1])];
                offsets.sort_unstable();
                for (axis, offset) in offsets {
                    self.coordinate(OFFSETS[axis], offset);
                }
                self.feed(feed);
            }
            Block::Dwell { milliseconds } => {
                self.word("G4");
                self.number("P", i64::try_from(milliseconds).unwrap_or(i64::MAX), 3);
            }
        }
        self.end_line()
    }

    fn motion(&mut self, word: &'static str) {
        if self.motion != Some(word) {
            self.word(word);
            self.motion = Some(word);
        }
    }

    fn plane(&mut self, plane: Plane) {
        if self.plane != plane {
            self.word(match plane {
                Plane::Xy => "G17",
                Plane::Zx => "G18",
                Plane::Yz => "G19",
            });
            self.plane = plane;
        }
    }

    fn feed(&mut self, feed: FeedWord) {
        if self.feed != Some(feed) {
            self.number("F", feed.digits, feed.decimals);
            self.feed = Some(feed);
        }
    }

    fn axis_if_changed(&mut self, axis: usize, to: i64) {
        if self.at[axis] != Some(to) {
            self.axis(axis, to);
        }
    }

    fn axis(&mut self, axis: usize, to: i64) {
        self.coordinate(AXES[axis], to);
        self.at[axis] = Some(to);
    }

    fn coordinate(&mut self, letter: char, units: i64) {
        self.number(letter.encode_utf8(&mut [0; 4]), units, self.job.program.resolution.decimals);
    }

    fn number(&mut self, word: &str, digits: i64, decimals: u8) {
        self.word(word);
        words::push_fixed(&mut self.line, digits, decimals);
    }

    fn word(&mut self, word: &str) {
        if !self.line.is_empty() {
            self.line.push(' ');
        }
        self.line.push_str(word);
    }

    /// Ends the line, with its number in front; an empty one leaves nothing.
    fn end_line(&mut self) -> Result<(), WriteError> {
        if self.line.is_empty() {
            return Ok(());
        }
        let dialect = self.job.dialect;
        let before = self.text.len();
        if self.job.program.block_numbers {
            let numbers = dialect.block_numbers;
            self.block_number += numbers.step;
            if self.block_number > numbers.max {
                self.block_number = numbers.step;
            }
            self.text.push_str(&format!("N{} ", self.block_number));
        }
        self.text.push_str(&self.line);
        self.line.clear();
        if self.text.len() - before > dialect.max_line_length {
            return Err(WriteError::LineTooLong { limit: dialect.max_line_length });
        }
        self.text.push_str(dialect.line_end);
        Ok(())
    }
}
