//! Writes blocks as lines of words. A modal word is written only where it changes the mode.

mod posed;

use super::block::{AxisWords, Block};
use super::dialect::{Comment, Dialect, Dwell, Frame, Point, ProgramNumber};
use super::header::{self, Remark};
use super::words::{self, AXES, FeedWord, OFFSETS};
use super::{ProgramJob, WriteError};
use crate::geometry::plane::Plane;
use crate::toolpath::cutting::Coolant;
use crate::toolpath::program::{SafeHome, Units};
use crate::toolpath::tool::{DEFAULT_NUMBER, Tool};

/// Most characters of a remark. A longer line would be hard to read on a control's screen.
const MAX_REMARK_LENGTH: usize = 100;

/// Most characters of a program's name. Controls show no more in their lists of programs.
const MAX_PROGRAM_NAME_LENGTH: usize = 32;

/// Most characters of a warning. The rest of a longer warning is left out.
const MAX_WARNING_LENGTH: usize = 600;

/// Returns the text of a whole program.
///
/// # Errors
/// When a word of the frame cannot be written, a number has more digits or a line more characters than the
/// control takes.
pub fn text(blocks: &[Block], remarks: &[Remark], job: &ProgramJob) -> Result<String, WriteError> {
    let mut writer = Writer {
        job,
        remarks,
        text: String::with_capacity(32 * (blocks.len() + 16)),
        line: String::new(),
        block_number: 0,
        owes_length_offset: false,
        motion: None,
        // The safety line selects it.
        plane: Plane::Xy,
        at: [None; 3],
        angles: [None; 2],
        feed: None,
        is_inverse_time: false,
        has_tip_control: false,
        has_long_number: false,
    };
    writer.tape_mark()?;
    writer.program_number()?;
    for frame in job.dialect.start {
        writer.frame(*frame)?;
    }
    for block in blocks {
        writer.block(block)?;
    }
    for frame in job.dialect.end {
        writer.frame(*frame)?;
    }
    writer.tape_mark()?;
    Ok(writer.text)
}

struct Writer<'a> {
    job: &'a ProgramJob<'a>,
    remarks: &'a [Remark],
    text: String,
    line: String,
    block_number: u32,
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
    has_tip_control: bool,
    /// Some number has more digits than the control reads.
    has_long_number: bool,
}

impl Writer<'_> {
    fn frame(&mut self, frame: Frame) -> Result<(), WriteError> {
        let job = self.job;
        match frame {
            Frame::Header => return self.remarks.iter().try_for_each(|remark| self.remark(remark)),
            Frame::Text(text) => self.word(text),
            Frame::ByUnits { mm, inch } => self.word(match job.program.resolution.units {
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
            Frame::ToolChange => self.word(&format!("T{} M6", self.tool().0)),
            Frame::SpindleOn => {
                if let Some(rpm) = job.cutting.spindle_rpm {
                    let speed = words::spindle(rpm, &job.dialect.numbers)?;
                    self.number("S", speed.digits, speed.decimals);
                    self.word("M3");
                }
            }
            Frame::CoolantOn => match job.cutting.coolant {
                Coolant::Off => {}
                Coolant::Mist => self.word("M7"),
                Coolant::Flood => self.word("M8"),
            },
            Frame::LengthOffset => self.word(&format!("G43 H{}", self.tool().1)),
            Frame::LengthOffsetInFirstMotionAlongZ => self.owes_length_offset = true,
            Frame::SafeHome => return self.safe_home(),
        }
        self.end_line()
    }

    /// Moves up to the machine's end of Z, from any position.
    fn safe_home(&mut self) -> Result<(), WriteError> {
        match self.job.program.safe_home {
            SafeHome::None => return Ok(()),
            SafeHome::G28 => {
                self.word("G91 G28");
                self.coordinate('Z', 0);
                self.end_line()?;
                self.word("G90");
            }
            SafeHome::G53 => {
                self.word("G53 G0");
                self.coordinate('Z', 0);
                self.motion = Some("G0");
            }
        }
        self.at[2] = None;
        self.end_line()
    }

    /// The numbers of the tool and of its length offset.
    fn tool(&self) -> (u32, u32) {
        self.job.tool.map_or((DEFAULT_NUMBER, DEFAULT_NUMBER), Tool::places)
    }

    fn tape_mark(&mut self) -> Result<(), WriteError> {
        let Some(mark) = self.job.dialect.tape_mark else { return Ok(()) };
        self.word(mark);
        self.end_line_unnumbered()
    }

    fn program_number(&mut self) -> Result<(), WriteError> {
        let job = self.job;
        let Some(ProgramNumber { letter, digits, max }) = job.dialect.program_number else {
            return Ok(());
        };
        let number = job.program.number;
        if !(1..=max).contains(&number) {
            return Err(WriteError::ProgramNumber { number, max });
        }
        self.word(&format!("{letter}{number:0digits$}"));
        // Controls take the name in their lists of programs from here. A comma could turn its first word into
        // a command.
        let name = job.program.name.as_deref().unwrap_or_default().replace(',', " ");
        let name = words::cleaned(&name, MAX_PROGRAM_NAME_LENGTH);
        if !name.is_empty() {
            let Comment { open, close, .. } = job.dialect.comment;
            self.word(&format!("{open}{name}{close}"));
        }
        self.end_line_unnumbered()
    }

    /// Writes a remark as one comment line, and a long warning as several. A text without any character that
    /// a comment may hold writes no line.
    fn remark(&mut self, Remark { label, text }: &Remark) -> Result<(), WriteError> {
        let Comment { open, separator, close } = self.job.dialect.comment;
        // Room for a block number beside the label and its punctuation.
        let used = 12 + open.len() + label.len() + separator.len() + close.len();
        let limit = self.job.dialect.max_line_length.saturating_sub(used).min(MAX_REMARK_LENGTH);
        let lines = match *label {
            header::WARNING => words::lines(&words::cleaned(text, MAX_WARNING_LENGTH), limit),
            _ => vec![words::cleaned(text, limit)],
        };
        for line in lines.iter().filter(|line| !line.is_empty()) {
            self.word(&format!("{open}{label}{separator}{line}{close}"));
            self.end_line()?;
        }
        Ok(())
    }

    fn block(&mut self, block: &Block) -> Result<(), WriteError> {
        match *block {
            Block::Rapid { to } => {
                self.motion("G0");
                if to[2].is_some() && std::mem::take(&mut self.owes_length_offset) {
                    self.word(&format!("G43 H{}", self.tool().1));
                }
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
            Block::Parabola { to, control, feed } => {
                self.plane(Plane::Xy);
                // G5.1 is not modal and ends the mode of motion.
                self.word("G5.1");
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
                self.word("G4");
                let digits = i64::try_from(milliseconds).unwrap_or(i64::MAX);
                match self.job.dialect.dwell {
                    Dwell::Seconds => self.number("P", digits, 3),
                    Dwell::Milliseconds => self.number("P", digits, 0),
                }
            }
            Block::Rotate { angles } => {
                self.motion("G0");
                self.axis_words(AxisWords::Angles(angles));
            }
            Block::BeginTipControl { to, axis } => {
                self.begin_tip_control(axis)?;
                self.place(to, axis);
            }
            Block::Posed { to, axis, feed } => self.posed(to, axis, feed),
            Block::EndPosed => self.end_posed(),
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
            self.word(words::plane(plane));
            self.plane = plane;
        }
    }

    fn feed(&mut self, feed: FeedWord) {
        if self.feed != Some(feed) {
            self.number("F", feed.digits, feed.decimals);
            if feed.decimals == 0 && self.job.dialect.numbers.point == Point::Always {
                self.line.push('.');
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
        self.number(letter.encode_utf8(&mut [0; 4]), units, self.job.program.resolution.decimals);
    }

    fn number(&mut self, word: &str, digits: i64, decimals: u8) {
        self.word(word);
        words::push_fixed(&mut self.line, digits, decimals);
        let limit = 10u64.saturating_pow(self.job.dialect.numbers.max_digits);
        self.has_long_number |= digits.unsigned_abs() >= limit;
    }

    fn word(&mut self, word: &str) {
        if !self.line.is_empty() {
            self.line.push(' ');
        }
        self.line.push_str(word);
    }

    /// Ends the line, with a block number in front where the job asks for block numbers. An empty line writes
    /// nothing.
    fn end_line(&mut self) -> Result<(), WriteError> {
        if self.job.program.block_numbers && !self.line.is_empty() {
            let numbers = self.job.dialect.block_numbers;
            self.block_number += numbers.step;
            if self.block_number > numbers.max {
                self.block_number = numbers.step;
            }
            self.line.insert_str(0, &format!("N{} ", self.block_number));
        }
        self.end_line_unnumbered()
    }

    fn end_line_unnumbered(&mut self) -> Result<(), WriteError> {
        if self.line.is_empty() {
            return Ok(());
        }
        let Dialect { max_line_length, line_end, numbers, .. } = *self.job.dialect;
        if self.has_long_number {
            return Err(WriteError::TooManyDigits { limit: numbers.max_digits });
        }
        if self.line.len() > max_line_length {
            return Err(WriteError::LineTooLong { limit: max_line_length });
        }
        self.text.push_str(&self.line);
        self.text.push_str(line_end);
        self.line.clear();
        Ok(())
    }
}
