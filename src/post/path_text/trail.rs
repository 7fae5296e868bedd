//! What both readers collect: the path, what the text states for the program of the answer, and what was left
//! alone.
//!
//! A request has one tool, one spindle speed and no place where the motion stops. So what would need more is
//! refused with the line of the word as soon as a motion follows it.

use super::{Fault, LeftWord, PathFault, PathText, Said, TextSpindle};
use toolpathd_core::toolpath::cutting::Coolant;
use toolpathd_core::toolpath::pose::{Pace, Waypoint};

/// The most comments that are kept: as many as the header of a program shows.
const MAX_COMMENTS: usize = 40;

/// The longest comment that is kept, characters.
const MAX_COMMENT: usize = 200;

/// A path while it is being read.
#[derive(Debug, Default)]
pub struct Trail {
    /// The line that is being read, from 1.
    pub line: usize,
    limit: usize,
    read: PathText,
    /// Why no motion may follow, with the line of the word.
    barrier: Option<(usize, PathFault)>,
    tool: Option<Said<u32>>,
    offset: Option<u32>,
    spindle: TextSpindle,
    spindle_line: usize,
    coolant: Coolant,
    coolant_word: &'static str,
    coolant_line: usize,
    /// Tool, spindle and coolant of the first cut.
    first_cut: Option<(Option<u32>, TextSpindle, Coolant)>,
}

impl Trail {
    pub fn new(limit: usize) -> Self {
        Self { limit, ..Self::default() }
    }

    pub fn last(&self) -> Option<&Waypoint> {
        self.read.path.last()
    }

    /// Appends a pose.
    pub fn push(&mut self, waypoint: Waypoint) -> Result<(), Fault> {
        if let Some((line, fault)) = self.barrier.take() {
            return Err(Fault { line: Some(line), fault });
        }
        self.check_tool()?;
        if waypoint.pace != Pace::Rapid && self.last().is_some() {
            self.check_cut()?;
        }
        if self.read.path.len() >= self.limit {
            return Err(PathFault::TooMany(self.limit).into());
        }
        self.read.path.push(waypoint);
        Ok(())
    }

    fn check_tool(&self) -> Result<(), Fault> {
        let number = self.tool.map(|tool| tool.value);
        match (self.first_cut, self.tool) {
            (Some((first, ..)), Some(own)) if first != number => {
                let fault = PathFault::SecondTool { first, second: own.value };
                Err(Fault { line: Some(own.line), fault })
            }
            _ => Ok(()),
        }
    }

    fn check_cut(&mut self) -> Result<(), Fault> {
        let number = self.tool.map(|tool| tool.value);
        let Some((_, spindle, coolant)) = self.first_cut else {
            self.first_cut = Some((number, self.spindle, self.coolant));
            self.read.tool = self.tool;
            self.read.spindle_rpm = self.spindle.rpm().map(|value| Said { value, line: self.spindle_line });
            self.take_coolant();
            return Ok(());
        };
        if spindle != self.spindle {
            return Err(Fault { line: Some(self.spindle_line), fault: PathFault::SpindleChanges });
        }
        if coolant != self.coolant {
            // The answer's program has the coolant on from its start to its end.
            self.left_alone_at(self.coolant_word, self.coolant_line);
            self.first_cut = Some((number, spindle, self.coolant));
            self.take_coolant();
        }
        Ok(())
    }

    fn take_coolant(&mut self) {
        if self.read.coolant.is_none() && self.coolant != Coolant::Off {
            self.read.coolant = Some(Said { value: self.coolant, line: self.coolant_line });
        }
    }

    /// Whether a pose has been read.
    pub fn is_empty(&self) -> bool {
        self.read.path.is_empty()
    }

    /// No pose may follow, once there is one.
    pub fn bar(&mut self, fault: PathFault) {
        if !self.is_empty() && self.barrier.is_none() {
            self.barrier = Some((self.line, fault));
        }
    }

    pub fn tool(&mut self, number: u32) {
        self.tool = Some(Said { value: number, line: self.line });
    }

    pub fn spindle(&mut self, spindle: TextSpindle) {
        if spindle != self.spindle {
            (self.spindle, self.spindle_line) = (spindle, self.line);
        }
    }

    pub fn coolant(&mut self, coolant: Coolant, word: &'static str) {
        if coolant != self.coolant {
            (self.coolant, self.coolant_word, self.coolant_line) = (coolant, word, self.line);
        }
    }

    pub fn has_tool(&self, number: u32) -> bool {
        self.tool.is_some_and(|tool| tool.value == number)
    }

    pub fn has_spindle(&self) -> bool {
        self.spindle != TextSpindle::Off || self.read.spindle_rpm.is_some()
    }

    /// Selects a work offset, and tells whether it is another one. Those from 54 to 59 are G54 to G59.
    pub fn work_offset(&mut self, number: u32) -> Result<bool, PathFault> {
        if self.offset == Some(number) {
            return Ok(false);
        }
        if !self.is_empty() {
            return Err(PathFault::OffsetChanges);
        }
        self.offset = Some(number);
        self.read.work_offset = u8::try_from(number).ok().filter(|number| (54..=59).contains(number));
        Ok(true)
    }

    /// Keeps the first name.
    pub fn name(&mut self, name: &str) {
        if self.read.name.is_none() && !name.trim().is_empty() {
            self.read.name = Some(name.trim().chars().take(MAX_COMMENT).collect());
        }
    }

    /// A text for people. The header of a program holds those before the first motion.
    pub fn comment(&mut self, text: &str) {
        let text = text.trim();
        if text.is_empty() {
            return;
        }
        if self.is_empty() && self.read.comments.len() < MAX_COMMENTS {
            self.read.comments.push(text.chars().take(MAX_COMMENT).collect());
        } else {
            self.left_alone("comment");
        }
    }

    pub fn left_alone(&mut self, word: &str) {
        self.left_alone_at(word, self.line);
    }

    pub fn left_alone_at(&mut self, word: &str, line: usize) {
        match self.read.left_alone.iter_mut().find(|own| own.word == word) {
            Some(own) => own.count += 1,
            None => self.read.left_alone.push(LeftWord { word: word.to_owned(), count: 1, line }),
        }
    }

    /// What was read.
    pub fn finish(mut self) -> PathText {
        if self.first_cut.is_none() {
            self.read.tool = self.tool;
        }
        // Tool 0 is no tool.
        self.read.tool = self.read.tool.filter(|tool| tool.value > 0);
        self.read
    }
}
