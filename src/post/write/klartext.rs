//! Writes programs in Heidenhain Klartext.
//!
//! Every block is numbered, and every coordinate has a sign. CC states the centre of the arcs behind it. F is
//! modal, FMAX (a rapid) holds for its block only.
//!
//! # Source
//! HEIDENHAIN, *User's Manual iTNC 530 Conversational Programming* and *TNC 640 Klartext Programming*.

mod cycles;
mod smoothing;

use super::lines::{Lines, Numbering, Written};
use super::{program_number, remarks};
use crate::block::{AxisWords, Block, BlockFeed};
use crate::dialect::{Comment, TipControl};
use crate::header::Remark;
use crate::posed::VECTOR_DECIMALS;
use crate::sequence::Part;
use crate::words::{self, AXES, FeedWord};
use crate::{ProgramJob, WriteError, blank};
use toolpathd_core::geometry::curve::Direction;
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::cutting::{Coolant, Cutting};
use toolpathd_core::toolpath::program::{SafeHome, Units};

const COMMENT: Comment = Comment { open: "; ", separator: " = ", close: "" };

/// Decimals of the angle of a helix, in degrees.
const HELIX_DECIMALS: u8 = 4;

const NUMBERING: Numbering = Numbering { prefix: "", first: 0, step: 1, max: u32::MAX };

/// The text of a whole program; see [`super::text`].
pub fn text(first: &Part, later: &[Part]) -> Result<Written, WriteError> {
    let job = &first.operation.job;
    let mut writer = Writer {
        job,
        part: first,
        lines: Lines::new(job.dialect, Some(NUMBERING), first.lowered.blocks.len()),
        at: [None; 3],
        is_off_grid: [false; 3],
        center: None,
        angles: [None; 2],
        feed: None,
        tip_control_off: None,
    };
    writer.begin(&first.remarks)?;
    writer.blocks()?;
    for part in later {
        writer.operation(part)?;
        writer.blocks()?;
    }
    writer.end()
}

struct Writer<'a> {
    job: &'a ProgramJob<'a>,
    /// The operation that is being written.
    part: &'a Part<'a>,
    lines: Lines<'a>,
    /// The position as last written.
    at: [Option<i64>; 3],
    /// Whether a helix has left an axis at or beside its position as last written.
    is_off_grid: [bool; 3],
    /// The centre as last written, with its axes.
    center: Option<[(usize, i64); 2]>,
    angles: [Option<i64>; 2],
    feed: Option<Feed>,
    /// The words that end tip control, while it is in force.
    tip_control_off: Option<&'static str>,
}

/// A feed as last written.
#[derive(Clone, Copy, PartialEq)]
enum Feed {
    OfTip(FeedWord),
    OfTurns(FeedWord),
}

impl<'a> Writer<'a> {
    /// The blocks of the operation, with the remarks between them.
    fn blocks(&mut self) -> Result<(), WriteError> {
        let part = self.part;
        let mut notes = remarks::Notes::new(part);
        self.lines.begin_blocks();
        for (k, block) in part.lowered.blocks.iter().enumerate() {
            notes.write_before(k, &mut self.lines, &COMMENT)?;
            self.block(block)?;
            self.lines.end_block();
        }
        Ok(())
    }

    fn name(&self) -> Result<String, WriteError> {
        let units = match self.job.program.resolution.units {
            Units::Mm => "MM",
            Units::Inch => "INCH",
        };
        Ok(format!("{} {units}", program_number(self.job)?.unwrap_or(1)))
    }

    fn begin(&mut self, remarks: &[Remark]) -> Result<(), WriteError> {
        let job = self.job;
        let name = self.name()?;
        self.lines.line(&format!("BEGIN PGM {name}"))?;
        for remark in remarks {
            remarks::write(&mut self.lines, job.dialect, &COMMENT, remark)?;
        }
        self.blank()?;
        let custom = &job.program.custom;
        self.lines.custom(&custom.header)?;
        self.preset()?;
        self.safe_home()?;
        self.lines.custom(&custom.tool_change)?;
        self.tool_call(custom.tool_change.is_empty())?;
        if job.cutting.coolant == Coolant::Flood {
            self.lines.line("M8")?;
        }
        self.smoothing()
    }

    /// Calls the tool, if it is to be called, and starts the spindle.
    fn tool_call(&mut self, with_tool: bool) -> Result<(), WriteError> {
        let job = self.job;
        if with_tool {
            self.lines.word(&format!("TOOL CALL {} Z", job.tool_numbers().0));
        }
        if let Some(rpm) = job.cutting.spindle_rpm {
            let speed = words::spindle(rpm, &job.dialect.numbers)?;
            if !with_tool {
                // The speed alone.
                self.lines.word("TOOL CALL Z");
            }
            self.lines.number("S", speed.digits, speed.decimals);
            self.lines.end()?;
            self.lines.word("M3");
        }
        self.lines.end()
    }

    /// Ends an operation and begins the next one.
    fn operation(&mut self, part: &'a Part<'a>) -> Result<(), WriteError> {
        let (change, before) = (part.change, self.job.cutting);
        if change.leaves() {
            self.safe_home()?;
            (self.at, self.is_off_grid) = ([None; 3], [false; 3]);
            (self.center, self.feed) = (None, None);
        }
        if change.tool {
            self.lines.line("M5")?;
            self.lines.line("M9")?;
        }
        (self.part, self.job) = (part, &part.operation.job);
        for remark in &part.remarks {
            remarks::write(&mut self.lines, self.job.dialect, &COMMENT, remark)?;
        }
        if change.work_offset {
            self.preset()?;
        }
        let Cutting { spindle_rpm, coolant, .. } = *self.job.cutting;
        if change.tool || spindle_rpm != before.spindle_rpm && spindle_rpm.is_some() {
            self.tool_call(change.tool)?;
        } else if spindle_rpm != before.spindle_rpm {
            self.lines.line("M5")?;
        }
        let is_on = !change.tool && before.coolant == Coolant::Flood;
        match (is_on, coolant == Coolant::Flood) {
            (false, true) => self.lines.line("M8"),
            (true, false) => self.lines.line("M9"),
            _ => Ok(()),
        }
    }

    /// The lowest and the highest corner of the raw part.
    fn blank(&mut self) -> Result<(), WriteError> {
        let Some(corners) = blank::corners(self.job)? else { return Ok(()) };
        for (head, corner) in ["BLK FORM 0.1 Z", "BLK FORM 0.2"].into_iter().zip(corners) {
            self.lines.word(head);
            for (letter, units) in AXES.into_iter().zip(corner) {
                self.coordinate(letter, units);
            }
            self.lines.end()?;
        }
        Ok(())
    }

    fn end(mut self) -> Result<Written, WriteError> {
        self.safe_home()?;
        self.lines.line("M5")?;
        self.lines.line("M9")?;
        self.lines.custom(&self.job.program.custom.footer)?;
        self.lines.line("M30")?;
        let name = self.name()?;
        self.lines.line(&format!("END PGM {name}"))?;
        Ok(self.lines.finish())
    }

    /// Activates a row of the table of presets: 1 for G54. The second line belongs to the block of the first.
    fn preset(&mut self) -> Result<(), WriteError> {
        let Some(number) = self.job.program.work_offset else { return Ok(()) };
        self.lines.line("CYCL DEF 247 DATUM SETTING ~")?;
        self.lines.word(&format!("  Q339=+{} ; DATUM NUMBER", number.saturating_sub(53)));
        self.lines.end_unnumbered()
    }

    /// Moves up to zero of the machine's coordinates.
    fn safe_home(&mut self) -> Result<(), WriteError> {
        if self.job.program.safe_home == SafeHome::None {
            return Ok(());
        }
        self.lines.word("L");
        self.coordinate('Z', 0);
        self.at[2] = None;
        self.lines.line("R0 FMAX M91")
    }

    fn block(&mut self, block: &Block) -> Result<(), WriteError> {
        match *block {
            Block::Rapid { to } | Block::Park { to } => {
                self.lines.word("L");
                for (axis, to) in to.into_iter().enumerate() {
                    if let Some(to) = to {
                        self.axis(axis, to);
                    }
                }
                self.lines.word("R0 FMAX");
            }
            Block::Line { to, feed, .. } => {
                self.lines.word("L");
                self.changed(to);
                self.lines.word("R0");
                self.feed(Feed::OfTip(feed));
            }
            Block::Arc { plane, direction, to, center, feed } => {
                self.circle_center(plane, center)?;
                self.lines.word("C");
                for (axis, _) in words::center_offsets(plane, center) {
                    self.axis(axis, to[axis]);
                }
                self.turn(direction, feed);
            }
            Block::Helix { direction, to, center, angle, feed } => {
                self.circle_center(Plane::Xy, center)?;
                self.lines.word("CP");
                let angle = if direction == Direction::Ccw { angle } else { -angle };
                self.signed("IPA", angle, HELIX_DECIMALS);
                let rise = to[2] - self.at[2].unwrap_or(0);
                self.signed("IZ", rise, self.job.program.resolution.decimals);
                self.turn(direction, feed);
                (self.at, self.is_off_grid) = (to.map(Some), [true; 3]);
            }
            // The control has no such blocks, and none are made for it.
            Block::Parabola { .. } | Block::BeginRails { .. } | Block::Rail { .. } | Block::EndRails => {
                return Err(WriteError::Differs { line: 0, what: "kind" });
            }
            Block::BeginCycle { index } => self.define(&self.part.lowered.cycles[index as usize])?,
            Block::Hole { to: [x, y], index } => {
                self.lines.word("L");
                self.axis(0, x);
                self.axis(1, y);
                self.lines.word("R0 FMAX M99");
                let returns = self.part.lowered.cycles[index as usize].returns;
                (self.at[2], self.is_off_grid[2]) = (Some(returns), false);
            }
            // A definition runs only where M99 stands.
            Block::EndCycle => self.feed = None,
            Block::Dwell { milliseconds } => {
                self.lines.line("CYCL DEF 9.0 DWELL TIME")?;
                let digits = i64::try_from(milliseconds).unwrap_or(i64::MAX);
                self.lines.word("CYCL DEF 9.1");
                self.lines.number("DWELL ", digits, 3);
            }
            Block::Rotate { angles } => {
                self.lines.word("L");
                self.angles(angles);
                self.lines.word("R0 FMAX");
            }
            Block::BeginTipControl { to, axis } => {
                let words = self.job.dialect.five_axes;
                let control = match axis {
                    AxisWords::Angles(_) => words.angles,
                    AxisWords::Vector(_) => words.vectors,
                };
                let TipControl { before, off, .. } = control.ok_or(WriteError::AxisOutput)?;
                for text in before {
                    self.lines.line(text)?;
                }
                self.tip_control_off = Some(off);
                self.at = [None; 3];
                match (to, axis) {
                    // LN states all coordinates, so the way across has no vector: the axis turns on the
                    // way down.
                    ([x, y, None], AxisWords::Vector(_)) => {
                        self.lines.word("L");
                        for (axis, to) in [x, y].into_iter().enumerate() {
                            if let Some(to) = to {
                                self.axis(axis, to);
                            }
                        }
                    }
                    (to, axis) => self.place(to.map(Option::unwrap_or_default), axis),
                }
                self.lines.word("R0 FMAX");
            }
            Block::Posed { to, axis, feed } => {
                self.place(to, axis);
                self.lines.word("R0");
                match feed {
                    BlockFeed::Rapid => self.lines.word("FMAX"),
                    BlockFeed::PerMinute(feed) => self.feed(Feed::OfTip(feed)),
                    BlockFeed::DegreesPerMinute(feed) => self.feed(Feed::OfTurns(feed)),
                    BlockFeed::InverseTime(_) => return Err(WriteError::AxisOutput),
                }
            }
            Block::EndPosed => {
                if let Some(off) = self.tip_control_off.take() {
                    self.lines.word(off);
                }
            }
        }
        self.lines.end()
    }

    /// States the centre of the arcs behind it, unless it is the centre already.
    fn circle_center(&mut self, plane: Plane, center: [i64; 2]) -> Result<(), WriteError> {
        let offsets = words::center_offsets(plane, center);
        let center = offsets.map(|(axis, offset)| (axis, self.at[axis].unwrap_or(0) + offset));
        if self.center == Some(center) {
            return Ok(());
        }
        self.lines.word("CC");
        for (axis, at) in center {
            self.coordinate(AXES[axis], at);
        }
        self.center = Some(center);
        self.lines.end()
    }

    fn turn(&mut self, direction: Direction, feed: FeedWord) {
        self.lines.word(match direction {
            Direction::Cw => "DR-",
            Direction::Ccw => "DR+",
        });
        self.lines.word("R0");
        self.feed(Feed::OfTip(feed));
    }

    /// The place of the tip with the tool axis. A block of vectors states all of them.
    fn place(&mut self, to: [i64; 3], axis: AxisWords) {
        match axis {
            AxisWords::Angles(angles) => {
                self.lines.word("L");
                self.changed(to);
                self.angles(angles);
            }
            AxisWords::Vector(parts) => {
                self.lines.word("LN");
                for (axis, to) in to.into_iter().enumerate() {
                    self.axis(axis, to);
                }
                for (word, part) in ["TX", "TY", "TZ"].into_iter().zip(parts) {
                    self.signed(word, part, VECTOR_DECIMALS);
                }
            }
        }
    }

    /// The angles that differ from those last written, in the order of their letters.
    fn angles(&mut self, angles: [i64; 2]) {
        for (letter, k) in self.job.rotary_words() {
            if self.angles[k] != Some(angles[k]) {
                let decimals = self.job.dialect.five_axes.angle_decimals;
                self.signed(letter.encode_utf8(&mut [0; 4]), angles[k], decimals);
                self.angles[k] = Some(angles[k]);
            }
        }
    }

    /// The coordinates that differ from those last written.
    fn changed(&mut self, to: [i64; 3]) {
        for (axis, to) in to.into_iter().enumerate() {
            if self.at[axis] != Some(to) || self.is_off_grid[axis] {
                self.axis(axis, to);
            }
        }
    }

    fn axis(&mut self, axis: usize, to: i64) {
        self.coordinate(AXES[axis], to);
        (self.at[axis], self.is_off_grid[axis]) = (Some(to), false);
    }

    fn coordinate(&mut self, letter: char, units: i64) {
        self.signed(letter.encode_utf8(&mut [0; 4]), units, self.job.program.resolution.decimals);
    }

    fn signed(&mut self, word: &str, digits: i64, decimals: u8) {
        let sign = if digits < 0 { "" } else { "+" };
        self.lines.number(&format!("{word}{sign}"), digits, decimals);
    }

    /// In a program in inches, the feed of the tip counts tenths of an inch.
    fn feed(&mut self, feed: Feed) {
        if self.feed == Some(feed) {
            return;
        }
        self.feed = Some(feed);
        let is_inch = self.job.program.resolution.units == Units::Inch;
        let (digits, decimals) = match feed {
            Feed::OfTip(FeedWord { digits, decimals: 0 }) if is_inch => (10 * digits, 0),
            Feed::OfTip(FeedWord { digits, decimals }) if is_inch => (digits, decimals - 1),
            Feed::OfTip(FeedWord { digits, decimals }) | Feed::OfTurns(FeedWord { digits, decimals }) => {
                (digits, decimals)
            }
        };
        self.lines.number("F", digits, decimals);
    }
}
