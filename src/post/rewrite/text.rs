//! The text of what is written for a part of a run, and of what sets modes right behind it.

use super::modes::{Distance, FeedMode, Modes, MotionNeed, Needs};
use super::pieces::Stretch;
use super::run::{Placed, Run, Style, step};
use crate::geometry::curve::{Curve, Direction};
use crate::geometry::plane::Plane;
use crate::post::dialect::{Dialect, Point};
use crate::post::words::push_fixed;
use crate::toolpath::quantize::{Form, Written};

const AXES: [char; 3] = ['X', 'Y', 'Z'];
const OFFSETS: [char; 3] = ['I', 'J', 'K'];

/// A feed in inverse time has this many digits: time is kept to a millionth.
const RATE_DIGITS: i32 = 7;
const MAX_RATE_DECIMALS: i32 = 8;

/// The modes of who reads the output, where they are not those of who reads the program.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Output {
    /// The mode is G2 or G3, where the program's is G1.
    pub is_arc: bool,
    pub plane: Option<Plane>,
    /// The last feed in inverse time.
    pub rate: f64,
}

impl Output {
    /// Appends what has to stand before a line with these needs, and says whether a G1 has to stand in it.
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
        let plane = modes.plane.filter(|_| owes_plane).map_or("", plane_word);
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

    /// Appends the blocks of `run` from `from` to before `end` as they are: the first says G1 where it has to, and the
    /// others rely on it.
    pub fn keep(&mut self, run: &Run, from: usize, end: usize, out: &mut Vec<u8>) -> Tally {
        let (first, last) = (&run.blocks[from], &run.blocks[end - 1]);
        let text = &run.text[first.text.start..last.text.end];
        if self.is_arc && !first.has_g1 {
            push_with_g1(out, text, first.first - first.text.start, run.is_spaced);
        } else {
            out.extend_from_slice(text);
        }
        self.is_arc = false;
        self.rate = last.rate;
        Tally { lines: (end - from) as u64, ..Tally::default() }
    }
}

/// What has been written for blocks of a run.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Tally {
    pub arcs: u64,
    pub lines: u64,
    /// Upper bound for its distance from the lines it stands for, mm.
    pub deviation_mm: f64,
}

/// Appends `line` with a G1 before its first word.
pub fn push_with_g1(out: &mut Vec<u8>, line: &[u8], first: usize, is_spaced: bool) {
    let (before, behind) = line.split_at(first);
    out.extend_from_slice(before);
    out.extend_from_slice(if is_spaced { b"G1 " } else { b"G1" });
    out.extend_from_slice(behind);
}

/// The line end of `line`: none, LF, or CR and LF.
pub fn line_end(line: &[u8]) -> &'static [u8] {
    match line {
        [.., b'\r', b'\n'] => b"\r\n",
        [.., b'\n'] => b"\n",
        _ => b"",
    }
}

/// Writes stretches of a run.
pub struct Writer<'a> {
    pub run: &'a Run,
    pub modes: &'a Modes,
    pub dialect: &'a Dialect,
    pub style: Style,
    pub output: Output,
    pub text: &'a mut Vec<u8>,
    /// The block that is being written.
    pub line: &'a mut String,
    pub tally: Tally,
    /// Something of the stretch is longer than the dialect reads.
    pub is_refused: bool,
}

impl Writer<'_> {
    /// Writes what stands for the blocks from `from` to the end of `stretch`: its curves, or the blocks themselves where
    /// these are no longer, or the curves are longer than the dialect reads.
    pub fn stretch(&mut self, from: usize, stretch: &Stretch) {
        let blocks = &self.run.blocks[from..stretch.end];
        let bytes = blocks[blocks.len() - 1].text.end - blocks[0].text.start;
        let (start, output, tally) = (self.text.len(), self.output, self.tally);
        if !stretch.curves.is_empty() {
            self.is_refused = false;
            self.curves(from, stretch, blocks);
            if !self.is_refused && self.text.len() - start < bytes {
                self.tally.deviation_mm = tally.deviation_mm.max(stretch.deviation_mm);
                return;
            }
        }
        self.text.truncate(start);
        (self.output, self.tally) = (output, tally);
        self.tally.lines += self.output.keep(self.run, from, stretch.end, self.text).lines;
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
                self.verbatim(&blocks[0].feed);
            }
            self.end_line(if k == last { &blocks[blocks.len() - 1] } else { &blocks[0] });
            start = written.end_units;
        }
    }

    /// A block without its feed; `block` is the one whose number it has.
    fn curve(&mut self, start: [i64; 3], written: &Written, block: &Placed) {
        self.verbatim(&block.number);
        let end = written.end_units;
        match (written.form, &written.curve) {
            (Form::Arc { center }, Curve::Arc(arc)) => {
                self.plane(arc.plane());
                self.word(match arc.direction() {
                    Direction::Cw => "G2",
                    Direction::Ccw => "G3",
                });
                let [a, b, n] = arc.plane().axes();
                self.ends(start, end, |axis| axis != n);
                let mut offsets = [(a, center[0]), (b, center[1])];
                offsets.sort_unstable();
                for (axis, offset) in offsets {
                    let is_absolute = self.modes.centers == Some(Distance::Absolute);
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
            self.word(plane_word(plane));
            self.output.plane = Some(plane).filter(|plane| self.modes.plane != Some(*plane));
        }
    }

    /// The words of an end: of the axes that must have one, and of those that move.
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

    /// A word of the run as it stands there, if there is one.
    fn verbatim(&mut self, place: &std::ops::Range<usize>) {
        if !place.is_empty() {
            self.separate();
            self.line.extend(self.run.text[place.clone()].iter().copied().map(char::from));
        }
    }

    fn separate(&mut self) {
        if self.run.is_spaced && !self.line.is_empty() {
            self.line.push(' ');
        }
    }

    /// Ends the block as `block` ends.
    fn end_line(&mut self, block: &Placed) {
        self.is_refused |= self.line.len() > self.dialect.max_line_length;
        self.text.extend_from_slice(self.line.as_bytes());
        self.text.extend_from_slice(line_end(&self.run.text[block.text.clone()]));
        self.line.clear();
    }
}

fn plane_word(plane: Plane) -> &'static str {
    match plane {
        Plane::Xy => "G17",
        Plane::Zx => "G18",
        Plane::Yz => "G19",
    }
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

/// Takes the zeros away that end the number from `from` on, behind its point, and the point where it may be missing.
fn trim(line: &mut String, from: usize, dialect: &Dialect) {
    let number = line[from..].trim_end_matches('0');
    let kept = match dialect.numbers.point {
        Point::Always => number.len(),
        Point::WhereNeeded => number.trim_end_matches('.').len(),
    };
    line.truncate(from + kept);
}
