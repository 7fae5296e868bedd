//! Writes the text that replaces blocks of a run, and the words that restore the modes of the source program
//! behind a run.

use super::block::is_bare;
use super::lines::{line_end, split};
use super::modes::{Modes, MotionNeed, Needs};
use super::run::{OpenRun, Placed, Style, step};
use super::stretches::Stretch;
use crate::dialect::{Dialect, Point};
use crate::nc::{Distance, FeedMode, Lexer, Token};
use crate::words::{self, AXES, OFFSETS, push_fixed};
use toolpathd_core::geometry::curve::Curve;
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::quantize::{Form, Written};

/// Digits of a feed in inverse time. Seven digits keep the time to a millionth of itself.
const RATE_DIGITS: i32 = 7;

/// Most decimals of a feed in inverse time, however small the feed is.
const MAX_RATE_DECIMALS: i32 = 8;

/// The difference between the modal state after the output and the modal state after the input.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Output {
    /// The output is in G2 or G3 where the program is in G1.
    pub is_arc: bool,
    /// The plane of the output, if it is another than the program's.
    pub plane: Option<Plane>,
    /// The last feed in inverse time.
    pub rate: f64,
}

impl Output {
    /// Appends the block that has to stand before a line with these needs, and returns whether the line
    /// itself needs a G1.
    pub fn settle(
        &mut self,
        needs: &Needs,
        modes: &Modes,
        dialect: &Dialect,
        line_end: &[u8],
        out: &mut Vec<u8>,
    ) -> bool {
        let owes_plane = self.plane.is_some() && needs.plane && !needs.says_plane;
        let owes_motion = self.is_arc && !needs.says_motion;
        let plane = modes.plane.filter(|_| owes_plane).map_or("", words::plane);
        let is_own = owes_motion && needs.motion == MotionNeed::Mode;
        out.extend_from_slice(plane.as_bytes());
        if is_own {
            let mut line = String::from(if plane.is_empty() { "G1" } else { " G1" });
            if modes.feed_mode == Some(FeedMode::InverseTime) {
                line.push(' ');
                push_rate(&mut line, self.rate, dialect);
            }
            out.extend_from_slice(line.as_bytes());
        }
        if is_own || !plane.is_empty() {
            out.extend_from_slice(line_end);
        }
        self.plane = self.plane.filter(|_| !owes_plane && !needs.says_plane);
        self.is_arc = owes_motion && needs.motion == MotionNeed::Nothing;
        owes_motion && needs.motion == MotionNeed::Word
    }

    /// Appends the blocks of `run` from `from` to before `end` as they are. The first gets a G1 where it
    /// needs one; the others rely on it.
    pub fn keep(&mut self, run: &OpenRun, from: usize, end: usize, out: &mut Vec<u8>) -> Tally {
        let (first, last) = (&run.blocks[from], &run.blocks[end - 1]);
        let text = &run.text[first.text.start..last.text.end];
        if self.is_arc && !first.has_g1 {
            push_with_g1(out, text, first.first, run.is_spaced);
        } else {
            out.extend_from_slice(text);
        }
        self.is_arc = false;
        self.rate = last.rate;
        Tally { lines: (end - from) as u64, ..Tally::default() }
    }
}

/// Counts of the curves written for blocks of a run.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Tally {
    pub arcs: u64,
    pub lines: u64,
    /// Upper bound for the distance between the curves and the lines they replace, mm.
    pub deviation_mm: f64,
}

/// Appends `line` with a G1 before its first word.
pub fn push_with_g1(out: &mut Vec<u8>, line: &[u8], first: usize, is_spaced: bool) {
    let (before, behind) = line.split_at(first);
    out.extend_from_slice(before);
    out.extend_from_slice(if is_spaced { b"G1 " } else { b"G1" });
    out.extend_from_slice(behind);
}

/// Writes stretches of a run.
pub struct Writer<'a> {
    pub run: &'a OpenRun,
    pub modes: &'a Modes,
    pub dialect: &'a Dialect,
    pub style: Style,
    pub output: Output,
    /// The line end of lines that get one.
    pub line_end: &'static [u8],
    pub text: &'a mut Vec<u8>,
    /// The block that is being written.
    pub line: &'a mut String,
    pub tally: Tally,
    /// A number or a block of the stretch is longer than the dialect reads.
    pub is_refused: bool,
}

impl Writer<'_> {
    /// Writes the curves of `stretch` in place of the blocks from `from` to its end. Keeps the blocks where
    /// their text is no longer, or where a number or block of the curves is longer than the dialect reads.
    pub fn stretch(&mut self, from: usize, stretch: &Stretch) {
        let blocks = &self.run.blocks[from..stretch.end];
        let bytes = blocks[blocks.len() - 1].text.end - blocks[0].text.start;
        let (start, output, tally) = (self.text.len(), self.output, self.tally);
        if !stretch.curves.is_empty() {
            self.is_refused = false;
            self.comments(blocks);
            self.curves(from, stretch, blocks);
            let last = &blocks[blocks.len() - 1];
            self.text.extend_from_slice(self.run.remarks(last));
            if !self.is_refused && self.text.len() - start < bytes {
                self.tally.deviation_mm = tally.deviation_mm.max(stretch.deviation_mm);
                return;
            }
        }
        self.text.truncate(start);
        (self.output, self.tally) = (output, tally);
        self.tally.lines += self.output.keep(self.run, from, stretch.end, self.text).lines;
    }

    /// Writes the comments of blocks, and those between the blocks, as lines of their own.
    fn comments(&mut self, blocks: &[Placed]) {
        for (k, block) in blocks.iter().enumerate() {
            let line = self.run.line(block);
            for (place, token) in Lexer::new(line).filter(|_| block.has_comment) {
                let comment = line[place].trim_ascii_end();
                if matches!(token, Token::Comment { .. }) && !is_bare(comment) {
                    self.text.extend_from_slice(comment);
                    self.text.extend_from_slice(self.line_end);
                }
            }
            let between = if k + 1 < blocks.len() { self.run.remarks(block) } else { b"" };
            let remarks = split(between).filter(|line| !is_blank(line));
            remarks.for_each(|line| self.text.extend_from_slice(line));
        }
    }

    fn curves(&mut self, from: usize, stretch: &Stretch, blocks: &[Placed]) {
        let length: f64 = stretch.curves.iter().map(|written| written.curve.length()).sum();
        let minutes: f64 = blocks.iter().map(|block| 1.0 / block.rate).sum();
        let mut start = self.run.units[from].map(|at| at / step(self.style.resolution.decimals));
        let last = stretch.curves.len() - 1;
        for (k, written) in stretch.curves.iter().enumerate() {
            self.curve(start, written, &blocks[k]);
            if self.modes.feed_mode == Some(FeedMode::InverseTime) {
                self.output.rate = length / (written.curve.length() * minutes);
                self.separate();
                push_rate(self.line, self.output.rate, self.dialect);
            } else if k == 0 && from == 0 {
                self.verbatim(&blocks[0], &blocks[0].feed);
            }
            self.end_line(if k == last { &blocks[blocks.len() - 1] } else { &blocks[0] });
            start = written.end_units;
        }
    }

    /// Writes a block without its feed, with the number of `block`.
    fn curve(&mut self, start: [i64; 3], written: &Written, block: &Placed) {
        self.verbatim(block, &block.number);
        let end = written.end_units;
        match (written.form, &written.curve) {
            (Form::Arc { center }, Curve::Arc(arc)) => {
                self.plane(arc.plane());
                self.word(words::arc(arc.direction()));
                let [_, _, normal] = arc.plane().axes();
                self.ends(start, end, |axis| axis != normal);
                let is_absolute = self.modes.centers == Some(Distance::Absolute);
                for (axis, offset) in words::center_offsets(arc.plane(), center) {
                    self.number(OFFSETS[axis], if is_absolute { start[axis] + offset } else { offset });
                }
                self.output.is_arc = true;
                self.tally.arcs += 1;
            }
            _ => {
                if self.output.is_arc || block.has_g1 {
                    self.word("G1");
                }
                self.ends(start, end, |_| false);
                self.output.is_arc = false;
                self.tally.lines += 1;
            }
        }
    }

    fn plane(&mut self, plane: Plane) {
        if self.output.plane.or(self.modes.plane) != Some(plane) {
            self.word(words::plane(plane));
            self.output.plane = Some(plane).filter(|plane| self.modes.plane != Some(*plane));
        }
    }

    /// The words of an end: for the axes that must have a word, and for the axes that move.
    fn ends(&mut self, start: [i64; 3], end: [i64; 3], must: impl Fn(usize) -> bool) {
        let is_incremental = self.modes.distance == Some(Distance::Incremental);
        for axis in 0..3 {
            if must(axis) || start[axis] != end[axis] {
                self.number(AXES[axis], if is_incremental { end[axis] - start[axis] } else { end[axis] });
            }
        }
    }

    fn number(&mut self, letter: char, units: i64) {
        self.separate();
        self.line.push(letter);
        let from = self.line.len();
        push_fixed(self.line, units, self.style.resolution.decimals);
        if !self.style.is_padded {
            trim(self.line, from, self.dialect);
        }
        self.is_refused |= units.unsigned_abs() >= 10u64.pow(self.dialect.numbers.max_digits);
    }

    fn word(&mut self, word: &str) {
        self.separate();
        self.line.push_str(word);
    }

    /// Copies a word of a block of the run; nothing where the place is empty.
    fn verbatim(&mut self, block: &Placed, place: &std::ops::Range<usize>) {
        if !place.is_empty() {
            self.separate();
            let text = self.run.line(block);
            self.line.extend(text[place.clone()].iter().copied().map(char::from));
        }
    }

    fn separate(&mut self) {
        if self.run.is_spaced && !self.line.is_empty() {
            self.line.push(' ');
        }
    }

    /// Ends the line with the line end of `block`.
    fn end_line(&mut self, block: &Placed) {
        self.is_refused |= self.line.len() > self.dialect.max_line_length;
        let line = self.run.line(block);
        let end = line_end(line);
        self.text.extend_from_slice(self.line.as_bytes());
        if ends_with_bare_semicolon(&line[..line.len() - end.len()]) {
            self.text.push(b';');
        }
        self.text.extend_from_slice(end);
        self.line.clear();
    }
}

/// Whether a line has nothing but a line end.
fn is_blank(line: &[u8]) -> bool {
    line.trim_ascii().is_empty() || is_bare(line.trim_ascii())
}

/// Whether a block ends with a semicolon, without text behind.
fn ends_with_bare_semicolon(line: &[u8]) -> bool {
    line.trim_ascii_end().ends_with(b";")
        && Lexer::new(line).last().is_some_and(|(place, _)| is_bare(&line[place]))
}

/// An F word in inverse minutes.
fn push_rate(line: &mut String, rate: f64, dialect: &Dialect) {
    let decimals = (RATE_DIGITS - 1 - rate.log10().floor() as i32).clamp(0, MAX_RATE_DECIMALS);
    line.push('F');
    let from = line.len();
    push_fixed(line, (rate * 10f64.powi(decimals)).round() as i64, decimals as u8);
    if decimals > 0 {
        trim(line, from, dialect);
    }
}

/// Removes the zeros at the end of the number that starts at `from`, and the point where the dialect allows
/// that.
fn trim(line: &mut String, from: usize, dialect: &Dialect) {
    let number = line[from..].trim_end_matches('0');
    let kept = match dialect.numbers.point {
        Point::Always => number.len(),
        Point::WhereNeeded => number.trim_end_matches('.').len(),
    };
    line.truncate(from + kept);
}
