//! Writes programs of ISO words.

mod cycles;
mod operations;
mod posed;
mod rails;
mod smoothing;

use super::lines::{Lines, Numbering, Written};
use super::{program_number, remarks};
use crate::block::{AxisWords, Block};
use crate::dialect::{BlockNumbers, Comment, Dwell, Frame, Iso, Point, SmoothingForm};
use crate::sequence::Part;
use crate::smoothing::in_force;
use crate::words::{self, AXES, FeedWord, OFFSETS};
use crate::{ProgramJob, WriteError};
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::cutting::Coolant;
use toolpathd_core::toolpath::program::{SafeHome, Units};

/// Most characters of a program's name. Controls show no more in their lists of programs.
const MAX_PROGRAM_NAME_LENGTH: usize = 32;

/// The text of a whole program; see [`super::text`].
pub fn text(first: &Part, later: &[Part], iso: &Iso) -> Result<Written, WriteError> {
    let job = &first.operation.job;
    let BlockNumbers { step, max } = iso.block_numbers;
    let numbering = Numbering { prefix: "N", first: step, step, max };
    let numbering = job.program.block_numbers.then_some(numbering);
    let mut writer = Writer {
        job,
        iso,
        part: first,
        lines: Lines::new(job.dialect, numbering, first.lowered.blocks.len()),
        owes_length_offset: false,
        motion: None,
        // The safety line selects it.
        plane: Plane::Xy,
        at: [None; 3],
        angles: [None; 2],
        feed: None,
        is_inverse_time: false,
        tip_control_off: None,
        cycle: None,
    };
    writer.tape_mark()?;
    writer.program_number()?;
    for frame in iso.start {
        writer.frame(*frame)?;
    }
    writer.blocks()?;
    for part in later {
        writer.operation(part)?;
        writer.blocks()?;
    }
    let (last, end) = split_end(iso);
    for frame in end {
        writer.frame(*frame)?;
    }
    writer.lines.custom(&job.program.custom.footer)?;
    if let Some(last) = last {
        writer.frame(*last)?;
    }
    writer.tape_mark()?;
    Ok(writer.lines.finish())
}

/// The frame that ends the program, and the frames before it.
fn split_end(iso: &Iso) -> (Option<&Frame>, &[Frame]) {
    iso.end.split_last().map_or((None, iso.end), |(last, end)| (Some(last), end))
}

struct Writer<'a> {
    job: &'a ProgramJob<'a>,
    iso: &'a Iso,
    /// The operation that is being written.
    part: &'a Part<'a>,
    lines: Lines<'a>,
    /// The next motion along Z has to take the length offset.
    owes_length_offset: bool,
    motion: Option<&'static str>,
    plane: Plane,
    /// The position as last written.
    at: [Option<i64>; 3],
    angles: [Option<i64>; 2],
    feed: Option<FeedWord>,
    /// G93 is in force instead of G94.
    is_inverse_time: bool,
    /// The words that end tip control, while it is in force.
    tip_control_off: Option<&'static str>,
    /// The canned cycle whose words are in force.
    cycle: Option<u32>,
}

impl<'a> Writer<'a> {
    fn blocks(&mut self) -> Result<(), WriteError> {
        let part = self.part;
        let mut notes = remarks::Notes::new(part);
        self.lines.begin_blocks();
        for (k, block) in part.lowered.blocks.iter().enumerate() {
            notes.write_before(k, &mut self.lines, &self.iso.comment)?;
            self.block(block)?;
            self.lines.end_block();
        }
        Ok(())
    }

    fn remarks(&mut self) -> Result<(), WriteError> {
        let (lines, comment, job) = (&mut self.lines, &self.iso.comment, self.job);
        self.part.remarks.iter().try_for_each(|remark| remarks::write(lines, job.dialect, comment, remark))
    }

    /// Sets the modes of the start again: a tool change may leave others.
    fn modes(&mut self) -> Result<(), WriteError> {
        self.motion = None;
        let again = |frame: &&Frame| {
            matches!(
                frame,
                Frame::Text(_) | Frame::ByUnits { .. } | Frame::Blending { .. } | Frame::WorkOffset
            )
        };
        self.iso.start.iter().filter(again).try_for_each(|frame| self.frame(*frame))
    }

    fn frame(&mut self, frame: Frame) -> Result<(), WriteError> {
        let job = self.job;
        match frame {
            Frame::Header => {
                self.remarks()?;
                return self.lines.custom(&job.program.custom.header);
            }
            Frame::Text(text) => self.lines.word(text),
            Frame::ByUnits { mm, inch } => self.lines.word(match job.program.resolution.units {
                Units::Mm => mm,
                Units::Inch => inch,
            }),
            Frame::Blending { before, after } => match job.program.smoothing {
                _ if in_force(job).is_none() => {}
                Some(_) => self.smoothing(after)?,
                None => {
                    self.lines.number(before, 1, job.program.resolution.decimals);
                    self.lines.glue(after);
                }
            },
            Frame::Smoothing => self.smoothing("")?,
            Frame::SmoothingOff if job.program.smoothing.is_some() => {
                match job.dialect.smoothing.map(|words| words.form) {
                    Some(SmoothingForm::ContourControl) => self.lines.word("G5.1 Q0"),
                    Some(SmoothingForm::Cycle832) => self.lines.word("CYCLE832()"),
                    // The end of the program ends it.
                    Some(SmoothingForm::Blending | SmoothingForm::G187 | SmoothingForm::Cycle32) | None => {}
                }
            }
            Frame::SmoothingOff => {}
            Frame::WorkOffset => self.work_offset()?,
            Frame::ToolChange if !job.program.custom.tool_change.is_empty() => return self.own_tool_change(),
            Frame::ToolChange => {
                // A tool change may run a program of its own, which leaves other modes.
                self.motion = None;
                self.template(self.iso.tool_change);
            }
            Frame::SpindleOn => {
                if let Some(rpm) = job.cutting.spindle_rpm {
                    self.speed(rpm)?;
                    self.lines.word("M3");
                }
            }
            Frame::CoolantOn => match job.cutting.coolant {
                Coolant::Off => {}
                Coolant::Mist => self.lines.word("M7"),
                Coolant::Flood => self.lines.word("M8"),
            },
            Frame::LengthOffset => self.template(self.iso.length_offset),
            Frame::LengthOffsetInFirstMotionAlongZ => self.owes_length_offset = true,
            Frame::SafeHome => return self.safe_home(),
        }
        self.lines.end()
    }

    /// A shop's own lines change the tool.
    fn own_tool_change(&mut self) -> Result<(), WriteError> {
        self.lines.custom(&self.job.program.custom.tool_change)?;
        self.modes()
    }

    fn speed(&mut self, rpm: f64) -> Result<(), WriteError> {
        let speed = words::spindle(rpm, &self.job.dialect.numbers)?;
        self.lines.number("S", speed.digits, speed.decimals);
        Ok(())
    }

    fn work_offset(&mut self) -> Result<(), WriteError> {
        let Some(number) = self.job.program.work_offset else { return Ok(()) };
        let word = self.iso.work_offset;
        // Where the offset is the number of another word, it counts from 1.
        let shown = if word == "G" { number } else { number.saturating_sub(53) };
        self.lines.word(&format!("{word}{shown}"));
        Ok(())
    }

    /// Moves up to the machine's end of Z, from any position.
    fn safe_home(&mut self) -> Result<(), WriteError> {
        let texts = match self.job.program.safe_home {
            SafeHome::None => return Ok(()),
            SafeHome::G28 => self.iso.reference_point,
            SafeHome::G53 => {
                self.motion = Some("G0");
                self.iso.machine_zero
            }
        };
        for text in texts {
            self.template(text);
            self.lines.end()?;
        }
        self.at[2] = None;
        Ok(())
    }

    /// Adds words, with numbers for `{tool}`, `{offset}` and `{Z0}`.
    fn template(&mut self, text: &str) {
        let (tool, offset) = self.job.tool_numbers();
        let zero = words::fixed(0, self.job.program.resolution.decimals);
        let filled = text
            .replace("{tool}", &tool.to_string())
            .replace("{offset}", &offset.to_string())
            .replace("{Z0}", &format!("Z{zero}"));
        self.lines.word(&filled);
    }

    fn tape_mark(&mut self) -> Result<(), WriteError> {
        let Some(mark) = self.iso.tape_mark else { return Ok(()) };
        self.lines.word(mark);
        self.lines.end_unnumbered()
    }

    fn program_number(&mut self) -> Result<(), WriteError> {
        let job = self.job;
        let Some((form, number)) = self.iso.program_number.zip(program_number(job)?) else { return Ok(()) };
        let digits = form.digits;
        self.lines.word(&format!("{}{number:0digits$}", form.letter));
        // Controls take the name in their lists of programs from here. A comma could turn its first word into
        // a command; a name that begins like a command stands behind a label.
        let name = job.program.name.as_deref().unwrap_or_default().replace(',', " ");
        let mut name = words::shortened(&name, MAX_PROGRAM_NAME_LENGTH);
        if words::begins_like_a_command(&name) {
            name = words::shortened(&format!("PROGRAM {name}"), MAX_PROGRAM_NAME_LENGTH);
        }
        if !name.is_empty() {
            let Comment { open, close, .. } = self.iso.comment;
            self.lines.word(&format!("{open}{name}{close}"));
        }
        self.lines.end_unnumbered()
    }

    fn block(&mut self, block: &Block) -> Result<(), WriteError> {
        match *block {
            Block::Rapid { to } | Block::Park { to } => {
                self.motion("G0");
                if to[2].is_some() && std::mem::take(&mut self.owes_length_offset) {
                    self.template(self.iso.length_offset);
                }
                for (axis, to) in to.into_iter().enumerate() {
                    if let Some(to) = to {
                        self.axis(axis, to);
                    }
                }
            }
            Block::Line { to, feed, .. } => {
                self.motion("G1");
                for (axis, to) in to.into_iter().enumerate() {
                    self.axis_if_changed(axis, to);
                }
                self.feed(feed);
            }
            Block::Arc { plane, direction, to, center, feed } => {
                self.plane(plane);
                self.motion(words::arc(direction));
                let [_, _, normal] = plane.axes();
                for (axis, to) in to.into_iter().enumerate() {
                    if axis == normal { self.axis_if_changed(axis, to) } else { self.axis(axis, to) }
                }
                for (axis, offset) in words::center_offsets(plane, center) {
                    self.coordinate(OFFSETS[axis], offset);
                }
                self.feed(feed);
            }
            // No dialect of ISO words has such a block.
            Block::Helix { .. } => return Err(WriteError::Differs { line: 0, what: "kind" }),
            Block::Parabola { to, control, feed } => {
                self.plane(Plane::Xy);
                // G5.1 is not modal and ends the mode of motion.
                self.lines.word("G5.1");
                self.motion = None;
                for (axis, to) in to.into_iter().enumerate() {
                    self.axis(axis, to);
                }
                for (letter, offset) in OFFSETS.into_iter().zip(control) {
                    self.coordinate(letter, offset);
                }
                self.feed(feed);
            }
            Block::Dwell { milliseconds } => {
                self.lines.word("G4");
                let digits = i64::try_from(milliseconds).unwrap_or(i64::MAX);
                match self.iso.dwell {
                    Dwell::Seconds => self.lines.number("P", digits, 3),
                    Dwell::Milliseconds => self.lines.number("P", digits, 0),
                    Dwell::FeedWord => {
                        self.lines.number("F", digits, 3);
                        // Whether the feed survives is not certain.
                        self.feed = None;
                    }
                }
            }
            Block::BeginCycle { index } => self.begin_cycle(index)?,
            Block::Hole { to, index } => self.hole(to, index)?,
            Block::EndCycle => self.end_cycle(),
            Block::Rotate { angles } => {
                self.motion("G0");
                self.axis_words(AxisWords::Angles(angles));
            }
            Block::BeginTipControl { to, axis } => {
                self.begin_tip_control(axis)?;
                for (axis, to) in to.into_iter().enumerate() {
                    if let Some(to) = to {
                        self.axis(axis, to);
                    }
                }
                self.axis_words(axis);
            }
            Block::Posed { to, axis, feed } => self.posed(to, axis, feed)?,
            Block::BeginRails { second, feed } => self.begin_rails(second, feed)?,
            Block::Rail { index } => self.rail(index as usize),
            Block::EndRails => {
                self.lines.word("ORIVECT");
                self.motion = None;
            }
            Block::EndPosed => self.end_posed()?,
        }
        self.lines.end()
    }

    fn motion(&mut self, word: &'static str) {
        if self.motion != Some(word) {
            self.lines.word(word);
            self.motion = Some(word);
        }
    }

    fn plane(&mut self, plane: Plane) {
        if self.plane != plane {
            self.lines.word(words::plane(plane));
            self.plane = plane;
        }
    }

    fn feed(&mut self, feed: FeedWord) {
        if self.feed != Some(feed) {
            self.lines.number("F", feed.digits, feed.decimals);
            if feed.decimals == 0 && self.job.dialect.numbers.point == Point::Always {
                self.lines.glue(".");
            }
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
        self.lines.number(letter.encode_utf8(&mut [0; 4]), units, self.job.program.resolution.decimals);
    }
}
