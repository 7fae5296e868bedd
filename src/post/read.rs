//! Reads programs of the kind this crate writes: the control's own view of a text.
//!
//! # Method
//! Line by line: the words of a block are collected (`block`), then take effect in the control's order:
//! units, plane, feed, motion. The reader shares no code with the writer, only the data of the dialect.
//!
//! # Guarantees
//! A word, code or combination that is not understood is an error, never skipped.
//!
//! # Degenerate input
//! A rapid whose start is not known on every axis is reported with what is known; a feed move from such a
//! place is an error.
//!
//! # Cost
//! O(n) in the characters; one line is held at a time.

mod block;
mod fault;

use nalgebra::{Point3, Vector3};

use self::block::Words;
pub use self::fault::Fault;
use super::dialect::{Dialect, Dwell, Parabolas, Point};
use crate::geometry::curve::{Arc, Curve, Direction, Line, Parabola};
use crate::geometry::plane::Plane;
use crate::toolpath::units::FeedRate;

/// What one block moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Step {
    /// Coordinates in mm, where they are known.
    Rapid {
        from: [Option<f64>; 3],
        to: [Option<f64>; 3],
    },
    /// Along the exact curve nearest to the written one.
    Feed {
        along: Curve,
        rate: FeedRate,
        radius_mismatch_mm: f64,
        center: Option<Point3<f64>>,
    },
    Dwell {
        seconds: f64,
    },
}

/// A step and the number of its line, from 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placed {
    pub line: usize,
    pub step: Step,
}

/// A line that a control would refuse, or that this reader does not know.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("line {line}: {fault}")]
pub struct ReadError {
    /// From 1.
    pub line: usize,
    pub fault: Fault,
}

/// Reads a program step by step; after an error it yields nothing more.
pub struct Reader<'a> {
    lines: std::iter::Enumerate<std::str::Lines<'a>>,
    dialect: &'a Dialect,
    part: Part,
    mismatch_limit_mm: f64,
    line: usize,
    is_over: bool,
    unit_mm: f64,
    plane: Plane,
    motion: Option<Motion>,
    feed: Option<FeedRate>,
    at: [Option<f64>; 3],
    /// Whether coordinates count from where the tool is.
    is_relative: bool,
}

#[derive(Clone, Copy, PartialEq)]
enum Motion {
    Rapid,
    Line,
    Arc(Direction),
    /// In this block alone.
    Parabola,
}

/// Where in a program the reader is.
#[derive(Clone, Copy, PartialEq)]
enum Part {
    TapeMark,
    ProgramNumber,
    Blocks,
}

impl<'a> Reader<'a> {
    /// Arcs whose radii differ by more than `mismatch_limit_mm` are refused.
    pub fn new(text: &'a str, dialect: &'a Dialect, mismatch_limit_mm: f64) -> Self {
        Self {
            lines: text.lines().enumerate(),
            dialect,
            part: if dialect.tape_mark.is_some() { Part::TapeMark } else { Part::ProgramNumber },
            mismatch_limit_mm,
            line: 0,
            is_over: false,
            unit_mm: 1.0,
            plane: Plane::Xy,
            motion: None,
            feed: None,
            at: [None; 3],
            is_relative: false,
        }
    }

    /// Takes the next line.
    fn line(&mut self, text: &str) -> Result<Option<Step>, Fault> {
        match self.part {
            Part::TapeMark => {
                self.part = Part::ProgramNumber;
                if Some(text.trim()) == self.dialect.tape_mark { Ok(None) } else { Err(Fault::TapeMark) }
            }
            Part::ProgramNumber => {
                self.part = Part::Blocks;
                let Some(number) = self.dialect.program_number else { return self.line(text) };
                // The program's name may stand beside it.
                let line = match text.split_once(" (") {
                    Some((line, name))
                        if name.ends_with(')') && !name[..name.len() - 1].contains(['(', ')']) =>
                    {
                        line
                    }
                    _ => text,
                };
                let digits = line.trim().strip_prefix(number.letter).filter(|digits| {
                    digits.len() >= number.digits && digits.bytes().all(|c| c.is_ascii_digit())
                });
                let read = digits.and_then(|digits| digits.parse().ok());
                if read.is_some_and(|read| (1..=number.max).contains(&read)) {
                    Ok(None)
                } else {
                    Err(Fault::ProgramNumber)
                }
            }
            Part::Blocks => {
                let words = Words::of(text)?;
                self.check_points(&words)?;
                let step = self.block(&words)?;
                if self.is_over { self.check_end() } else { Ok(()) }.map(|()| step)
            }
        }
    }

    /// Where a point decides the value, numbers that are measured have one and numbers that are counted have none.
    fn check_points(&self, words: &Words) -> Result<(), Fault> {
        if self.dialect.numbers.point == Point::WhereNeeded {
            return Ok(());
        }
        let (with, without) = (words.pointed("XYZIJKF"), words.pointed("NHSTP"));
        with.1.map_or(Ok(()), |letter| Err(Fault::MissingPoint(letter)))?;
        without.0.map_or(Ok(()), |letter| Err(Fault::UnexpectedPoint(letter)))
    }

    /// Behind the last block stands the mark and nothing else, where there must be one.
    fn check_end(&mut self) -> Result<(), Fault> {
        let Some(mark) = self.dialect.tape_mark else { return Ok(()) };
        let mut rest = self.lines.by_ref().map(|(_, text)| text.trim());
        let is_closed = rest.next() == Some(mark) && rest.all(str::is_empty);
        if is_closed { Ok(()) } else { Err(Fault::TapeMark) }
    }

    fn block(&mut self, words: &Words) -> Result<Option<Step>, Fault> {
        let mut motions = 0;
        let mut is_dwell = false;
        let (mut takes_length, mut takes_blending) = (false, false);
        let mut home = None;
        for &tenths in words.g() {
            match tenths {
                0 | 10 | 20 | 30 => {
                    motions += 1;
                    self.motion = Some(match tenths {
                        0 => Motion::Rapid,
                        10 => Motion::Line,
                        20 => Motion::Arc(Direction::Cw),
                        _ => Motion::Arc(Direction::Ccw),
                    });
                }
                51 if self.dialect.parabolas == Parabolas::InXy => {
                    motions += 1;
                    self.motion = Some(Motion::Parabola);
                }
                40 => is_dwell = true,
                170 => self.plane = Plane::Xy,
                180 => self.plane = Plane::Zx,
                190 => self.plane = Plane::Yz,
                200 => self.unit_mm = 25.4,
                210 => self.unit_mm = 1.0,
                280 | 530 => home = Some(tenths),
                430 => takes_length = true,
                640 => takes_blending = true,
                800 => {
                    motions += 1;
                    self.motion = None;
                }
                900 => self.is_relative = false,
                910 => self.is_relative = true,
                400 | 490 | 540 | 550 | 560 | 570 | 580 | 590 | 610 | 940 => {}
                _ => return Err(Fault::UnknownG(f64::from(tenths) / 10.0)),
            }
        }
        let mut ends = false;
        for &tenths in words.m() {
            match tenths {
                20 | 300 => ends = true,
                30 | 50 | 60 | 70 | 80 | 90 => {}
                _ => return Err(Fault::UnknownM(f64::from(tenths) / 10.0)),
            }
        }
        if motions > 1 || words.has_conflict() || (takes_blending && is_dwell) {
            return Err(Fault::Conflict);
        }
        if takes_length != words.get('H').is_some() {
            return Err(if takes_length { Fault::Missing('H') } else { Fault::Unused('H') });
        }
        if let Some(home) = home {
            // One step by no distance, or a rapid to zero of the machine's coordinates, and up alone.
            let is_known =
                self.is_relative == (home == 280) && (home == 280 || self.motion == Some(Motion::Rapid));
            if !is_known || words.get('Z') != Some(0.0) || words.first_of("XYIJK").is_some() {
                return Err(Fault::Conflict);
            }
            self.at[2] = None;
            return Ok(None);
        }
        if words.get('Q').is_some() && !takes_blending {
            return Err(Fault::Unused('Q'));
        }
        if words.get('P').is_some() && !takes_blending && !is_dwell {
            return Err(Fault::Unused('P'));
        }
        if let Some(feed) = words.get('F') {
            self.feed = Some(FeedRate::from_mm_per_min(feed * self.unit_mm).ok_or(Fault::BadNumber('F'))?);
        }
        self.is_over |= ends;
        if is_dwell {
            let count = words.get('P').ok_or(Fault::Missing('P'))?;
            let seconds = match self.dialect.dwell {
                Dwell::Seconds => count,
                Dwell::Milliseconds => count / 1000.0,
            };
            if motions > 0 || words.first_of("XYZIJK").is_some() || seconds < 0.0 {
                return Err(Fault::Conflict);
            }
            return Ok(Some(Step::Dwell { seconds }));
        }
        self.motion_of(words)
    }

    fn motion_of(&mut self, words: &Words) -> Result<Option<Step>, Fault> {
        if self.motion == Some(Motion::Parabola) {
            // What the control does without a G word after it is what it did before, even a rapid.
            self.motion = None;
            return self.parabola_of(words);
        }
        if words.first_of("XYZIJK").is_none() {
            return Ok(None);
        }
        let motion = self.motion.ok_or(Fault::NoMotion)?;
        if self.is_relative {
            return Err(Fault::Relative);
        }
        let from = self.moved(words);
        if let (Motion::Rapid | Motion::Line, Some(letter)) = (motion, words.first_of("IJK")) {
            return Err(Fault::Unused(letter));
        }
        if motion == Motion::Rapid {
            return Ok(Some(Step::Rapid { from, to: self.at }));
        }
        let rate = self.feed.ok_or(Fault::NoFeed)?;
        let start = known(from).ok_or(Fault::UnknownStart)?;
        let end = known(self.at).ok_or(Fault::UnknownStart)?;
        let Motion::Arc(direction) = motion else {
            let along = Curve::Line(Line { start, end });
            return Ok(Some(Step::Feed { along, rate, radius_mismatch_mm: 0.0, center: None }));
        };
        let center = self.center(words, &start)?;
        let [s, e, c] = [start, end, center].map(|p| self.plane.to_local(&p).xy());
        let radius_mismatch_mm = ((s - c).norm() - (e - c).norm()).abs();
        if radius_mismatch_mm > self.mismatch_limit_mm {
            return Err(Fault::RadiusMismatch { mismatch_mm: radius_mismatch_mm });
        }
        let arc = Arc::with_center_near(self.plane, direction, start, end, center).map_err(Fault::Arc)?;
        Ok(Some(Step::Feed { along: Curve::Arc(arc), rate, radius_mismatch_mm, center: Some(center) }))
    }

    /// The parabola of a block: the offsets of its control point are both written, and it stays at its height.
    fn parabola_of(&mut self, words: &Words) -> Result<Option<Step>, Fault> {
        if self.plane != Plane::Xy {
            return Err(Fault::ParabolaPlane);
        }
        if let Some(letter) = words.first_of("ZK") {
            return Err(Fault::Unused(letter));
        }
        if words.first_of("XY").is_none() {
            return Err(Fault::Missing('X'));
        }
        let offset =
            |letter| words.get(letter).map(|value| value * self.unit_mm).ok_or(Fault::Missing(letter));
        let offset = Vector3::new(offset('I')?, offset('J')?, 0.0);
        let from = self.moved(words);
        let rate = self.feed.ok_or(Fault::NoFeed)?;
        let start = known(from).ok_or(Fault::UnknownStart)?;
        let end = known(self.at).ok_or(Fault::UnknownStart)?;
        let parabola = Parabola::new(start, start + offset, end).map_err(|_| Fault::ParabolaSize)?;
        let along = Curve::Parabola(parabola);
        Ok(Some(Step::Feed { along, rate, radius_mismatch_mm: 0.0, center: None }))
    }

    /// Goes to the coordinates of a block, and returns where it starts.
    fn moved(&mut self, words: &Words) -> [Option<f64>; 3] {
        let from = self.at;
        for (axis, letter) in ['X', 'Y', 'Z'].into_iter().enumerate() {
            if let Some(value) = words.get(letter) {
                self.at[axis] = Some(value * self.unit_mm);
            }
        }
        from
    }

    /// The written centre: offsets from the start, of which one may be missing.
    fn center(&self, words: &Words, start: &Point3<f64>) -> Result<Point3<f64>, Fault> {
        const OFFSETS: [char; 3] = ['I', 'J', 'K'];
        let [a, b, n] = self.plane.axes();
        if words.get(OFFSETS[n]).is_some() {
            return Err(Fault::Unused(OFFSETS[n]));
        }
        let offsets = [a, b].map(|axis| words.get(OFFSETS[axis]));
        if offsets == [None; 2] {
            return Err(Fault::MissingCenter);
        }
        let mut center = *start;
        center[a] += offsets[0].unwrap_or(0.0) * self.unit_mm;
        center[b] += offsets[1].unwrap_or(0.0) * self.unit_mm;
        Ok(center)
    }
}

impl Iterator for Reader<'_> {
    type Item = Result<Placed, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        while !self.is_over {
            let Some((index, text)) = self.lines.next() else {
                self.is_over = true;
                return Some(Err(ReadError { line: self.line, fault: Fault::NoEnd }));
            };
            self.line = index + 1;
            match self.line(text) {
                Ok(Some(step)) => return Some(Ok(Placed { line: self.line, step })),
                Ok(None) => {}
                Err(fault) => {
                    self.is_over = true;
                    return Some(Err(ReadError { line: self.line, fault }));
                }
            }
        }
        None
    }
}

fn known(at: [Option<f64>; 3]) -> Option<Point3<f64>> {
    Some(Point3::new(at[0]?, at[1]?, at[2]?))
}

#[cfg(test)]
mod tests;
