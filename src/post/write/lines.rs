//! The lines of a program: words into lines, lines into a text, within what the control reads.

use std::ops::Range;

use crate::WriteError;
use crate::dialect::Dialect;
use crate::words;

/// A text, with the places of a shop's own lines by their indices.
pub struct Written {
    pub text: String,
    pub custom: Vec<Range<usize>>,
    /// For each block of each operation the number of lines up to its end.
    pub block_ends: Vec<Vec<u32>>,
}

/// A text under way, and the line that is being written.
pub struct Lines<'a> {
    dialect: &'a Dialect,
    numbering: Option<Numbering>,
    /// The number of the last numbered line.
    block_number: Option<u32>,
    text: String,
    n_lines: usize,
    /// Where a shop's own lines stand.
    custom: Vec<Range<usize>>,
    block_ends: Vec<Vec<u32>>,
    line: String,
    /// Some number has more digits than the control reads.
    long_number: Option<WriteError>,
}

/// The numbers of blocks: `first`, then in steps up to `max`, then again from `first`.
#[derive(Debug, Clone, Copy)]
pub struct Numbering {
    pub prefix: &'static str,
    pub first: u32,
    pub step: u32,
    pub max: u32,
}

impl<'a> Lines<'a> {
    /// An empty text with room for `lines` lines.
    pub fn new(dialect: &'a Dialect, numbering: Option<Numbering>, lines: usize) -> Self {
        Self {
            dialect,
            numbering,
            block_number: None,
            text: String::with_capacity(32 * (lines + 16)),
            n_lines: 0,
            custom: Vec::new(),
            block_ends: Vec::new(),
            line: String::new(),
            long_number: None,
        }
    }

    /// Adds a word, behind a blank unless it is the first.
    pub fn word(&mut self, word: &str) {
        if !self.line.is_empty() {
            self.line.push(' ');
        }
        self.line.push_str(word);
    }

    /// Adds text right behind the last word.
    pub fn glue(&mut self, text: &str) {
        self.line.push_str(text);
    }

    /// Adds a word and its number: `digits` times ten to the power of minus `decimals`.
    pub fn number(&mut self, word: &str, digits: i64, decimals: u8) {
        self.word(word);
        words::push_fixed(&mut self.line, digits, decimals);
        self.check_digits(digits, decimals);
    }

    /// Notes a number that has too many digits; the end of its line fails.
    pub fn check_digits(&mut self, digits: i64, decimals: u8) {
        let numbers = &self.dialect.numbers;
        let exceeds = |limit: u32| digits.unsigned_abs() >= 10u64.saturating_pow(limit);
        if exceeds(numbers.max_whole_digits + u32::from(decimals)) {
            let limit = numbers.max_whole_digits;
            self.long_number.get_or_insert(WriteError::TooManyWholeDigits { limit });
        }
        if exceeds(numbers.max_digits) {
            self.long_number.get_or_insert(WriteError::TooManyDigits { limit: numbers.max_digits });
        }
    }

    /// Ends the line, with a block number in front where blocks are numbered. An empty line writes nothing.
    pub fn end(&mut self) -> Result<(), WriteError> {
        if let Some(numbering) = self.numbering.filter(|_| !self.line.is_empty()) {
            let Numbering { prefix, first, step, max } = numbering;
            let next = self.block_number.map_or(first, |number| number + step);
            let next = if next > max { first } else { next };
            self.block_number = Some(next);
            self.line.insert_str(0, &format!("{prefix}{next} "));
        }
        self.end_unnumbered()
    }

    /// Ends the line as it is. An empty line writes nothing.
    pub fn end_unnumbered(&mut self) -> Result<(), WriteError> {
        if self.line.is_empty() {
            return Ok(());
        }
        let Dialect { max_line_length, line_end, .. } = *self.dialect;
        if let Some(error) = self.long_number.take() {
            return Err(error);
        }
        if self.line.len() > max_line_length {
            return Err(WriteError::LineTooLong { limit: max_line_length });
        }
        self.text.push_str(&self.line);
        self.text.push_str(line_end);
        self.n_lines += 1;
        self.line.clear();
        Ok(())
    }

    /// A line of one text, with a block number.
    pub fn line(&mut self, text: &str) -> Result<(), WriteError> {
        self.word(text);
        self.end()
    }

    /// A shop's own lines.
    pub fn custom(&mut self, lines: &[String]) -> Result<(), WriteError> {
        let from = self.n_lines;
        for line in lines {
            self.line(line)?;
        }
        self.custom.push(from..self.n_lines);
        Ok(())
    }

    /// The blocks of an operation come next.
    pub fn begin_blocks(&mut self) {
        self.block_ends.push(Vec::new());
    }

    /// A block of the operation has ended.
    pub fn end_block(&mut self) {
        let n_lines = u32::try_from(self.n_lines).unwrap_or(u32::MAX);
        if let Some(ends) = self.block_ends.last_mut() {
            ends.push(n_lines);
        }
    }

    pub fn finish(self) -> Written {
        Written { text: self.text, custom: self.custom, block_ends: self.block_ends }
    }
}
