//! Reads programs of the kind that this crate writes, in the way in which a control reads them.
//!
//! The reader exists to check the writer. So the two share the data of the dialect, but no code.
//!
//! # Method
//! For each line, `words` collects the words. Then the words take effect in the order in which a control
//! applies them: units, plane, feed, motion.
//!
//! # Guarantees
//! A word, code or combination of words that the reader does not know is an error. Nothing is skipped. A feed
//! move from a position that is not known is an error, too.
//!
//! # Cost
//! O(n) for n characters. Only one line is in memory at a time.

mod posed;
mod words;

use nalgebra::{Point3, Vector3};

use self::posed::Leaning;
pub use self::posed::{Pace, Posed, ROTARY, TipMode};
use self::words::Words;
use super::dialect::{Dialect, Dwell, Parabolas, Point};
pub use super::nc::Fault;
use super::nc::{Distance, FeedMode, Modal, Motion, effect, modal_group};
use crate::geometry::curve::{Arc, Curve, Line, Parabola};
use crate::geometry::plane::Plane;
use crate::toolpath::units::FeedRate;

/// G codes that the reader knows, in tenths. In a dialect that writes parabolas, the reader also knows G5.1.
const KNOWN_G: &[i32] = &[
    0, 10, 20, 30, 40, 170, 180, 190, 200, 210, 280, 400, 430, 490, 530, 540, 550, 560, 570, 580, 590, 610,
    640, 800, 900, 910, 930, 940,
];
const DWELL: i32 = 40;
const PARABOLA: i32 = 51;
const HOME: i32 = 280;
const MACHINE_COORDINATES: i32 = 530;
/// The codes of length offsets, of which the last two also control the tip.
const LENGTH_OFFSETS: [i32; 3] = [430, posed::ANGLES, posed::VECTORS];
const INVERSE_TIME: i32 = 930;
const PER_MINUTE: i32 = 940;
const BLENDING: i32 = 640;

/// M codes that the reader knows, in tenths, and those of them that end a program.
const KNOWN_M: &[i32] = &[20, 30, 50, 60, 70, 80, 90, 300];
const ENDS: [i32; 2] = [20, 300];

/// The modal group of G0 to G3, G5.1 and G80.
const MOTION_GROUP: i32 = 1;

/// The effect of one block.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Step {
    /// Coordinates in mm, where they are known. A rapid may start where a coordinate is not known yet.
    Rapid {
        from: [Option<f64>; 3],
        to: [Option<f64>; 3],
    },
    /// Along the exact curve nearest to the written curve.
    Feed {
        along: Curve,
        rate: FeedRate,
        radius_mismatch_mm: f64,
        center: Option<Point3<f64>>,
    },
    /// A motion with the tool axis.
    Posed(Posed),
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
    expects: Expected,
    mismatch_limit_mm: f64,
    line: usize,
    is_over: bool,
    /// Position in mm.
    modal: Modal<f64, FeedRate>,
    leaning: Leaning,
}

/// The kind of line that has to come next.
#[derive(Clone, Copy, PartialEq)]
enum Expected {
    TapeMark,
    ProgramNumber,
    Block,
}

impl<'a> Reader<'a> {
    /// Arcs whose radii differ by more than `mismatch_limit_mm` are refused.
    pub fn new(text: &'a str, dialect: &'a Dialect, mismatch_limit_mm: f64) -> Self {
        let has_mark = dialect.tape_mark.is_some();
        Self {
            lines: text.lines().enumerate(),
            dialect,
            expects: if has_mark { Expected::TapeMark } else { Expected::ProgramNumber },
            mismatch_limit_mm,
            line: 0,
            is_over: false,
            modal: Modal::START,
            leaning: Leaning::default(),
        }
    }

    /// Takes the next line.
    fn line(&mut self, text: &str) -> Result<Option<Step>, Fault> {
        match self.expects {
            Expected::TapeMark => {
                self.expects = Expected::ProgramNumber;
                if Some(text.trim()) == self.dialect.tape_mark { Ok(None) } else { Err(Fault::TapeMark) }
            }
            Expected::ProgramNumber => {
                self.expects = Expected::Block;
                let Some(number) = self.dialect.program_number else { return self.line(text) };
                // The program's name may stand beside the number.
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
                let is_legal = read.is_some_and(|read| (1..=number.max).contains(&read));
                if is_legal { Ok(None) } else { Err(Fault::ProgramNumber) }
            }
            Expected::Block => {
                let words = Words::of(text)?;
                self.check_points(&words)?;
                let step = self.block(&words)?;
                if self.is_over { self.check_end() } else { Ok(()) }.map(|()| step)
            }
        }
    }

    /// In a dialect where a decimal point decides the value, measured numbers need a point and counted
    /// numbers must not have one.
    fn check_points(&self, words: &Words) -> Result<(), Fault> {
        if self.dialect.numbers.point == Point::WhereNeeded {
            return Ok(());
        }
        let missing = words.first_written("XYZABCIJKF", false).map(Fault::MissingPoint);
        let unexpected = || words.first_written("NHSTP", true).map(Fault::UnexpectedPoint);
        missing.or_else(unexpected).map_or(Ok(()), Err)
    }

    /// After the last block only the tape mark may follow, in a dialect with a tape mark.
    fn check_end(&mut self) -> Result<(), Fault> {
        let Some(mark) = self.dialect.tape_mark else { return Ok(()) };
        let mut rest = self.lines.by_ref().map(|(_, text)| text.trim());
        let is_closed = rest.next() == Some(mark) && rest.all(str::is_empty);
        if is_closed { Ok(()) } else { Err(Fault::TapeMark) }
    }

    fn block(&mut self, words: &Words) -> Result<Option<Step>, Fault> {
        self.check_codes(words)?;
        let g = &words.g;
        for &code in g.all() {
            self.modal.apply(effect(code));
            if code == PARABOLA {
                // A block without a G word behind it would be run as the last G0 to G3 says, even as a rapid.
                self.modal.motion = None;
            }
            self.leaning.apply(code);
        }
        if g.has(INVERSE_TIME) || g.has(PER_MINUTE) {
            // A feed of the other mode means something else.
            self.modal.feed = None;
        }
        if g.has(HOME) || g.has(MACHINE_COORDINATES) {
            return self.home(words);
        }
        let (is_dwell, is_blending) = (g.has(DWELL), g.has(BLENDING));
        for (letter, is_used) in [('Q', is_blending), ('P', is_blending || is_dwell)] {
            if words.has(letter) && !is_used {
                return Err(Fault::Unused(letter));
            }
        }
        if let Some(feed) = words.get('F') {
            let unit = if self.modal.feed_mode == Some(FeedMode::InverseTime) { 1.0 } else { self.unit_mm() };
            let rate = FeedRate::from_mm_per_min(feed * unit);
            self.modal.feed = Some(rate.ok_or(Fault::BadNumber('F'))?);
        }
        self.is_over = ENDS.iter().any(|&code| words.m.has(code));
        if is_dwell {
            return self.dwell(words);
        }
        if g.has(PARABOLA) { self.parabola(words) } else { self.motion(words) }
    }

    /// # Errors
    /// When a code is unknown, two codes exclude each other, or G43 and H do not stand together.
    fn check_codes(&self, words: &Words) -> Result<(), Fault> {
        let Words { g, m, .. } = words;
        let has_parabolas = self.dialect.parabolas == Parabolas::InXy;
        let tip_control = self.dialect.tip_control;
        let is_known = |code: &i32| match *code {
            PARABOLA => has_parabolas,
            posed::ANGLES => tip_control.angles.is_some(),
            posed::VECTORS => tip_control.vectors.is_some(),
            code => KNOWN_G.contains(&code),
        };
        let number = |code: &i32| f64::from(*code) / 10.0;
        if let Some(code) = g.all().iter().find(|code| !is_known(code)) {
            return Err(Fault::UnknownG(number(code)));
        }
        if let Some(code) = m.all().iter().find(|code| !KNOWN_M.contains(code)) {
            return Err(Fault::UnknownM(number(code)));
        }
        let mut groups = g.all().iter().map(|&code| modal_group(code)).enumerate();
        let is_twice = groups.any(|(k, group)| g.all()[..k].iter().any(|&other| modal_group(other) == group));
        if is_twice || g.has(BLENDING) && g.has(DWELL) {
            return Err(Fault::Conflict);
        }
        match (LENGTH_OFFSETS.iter().any(|&code| g.has(code)), words.has('H')) {
            (true, false) => Err(Fault::Missing('H')),
            (false, true) => Err(Fault::Unused('H')),
            _ => Ok(()),
        }
    }

    /// The move to the machine's end of Z: by G28 as a step of no length, or as a rapid to zero of the
    /// machine's coordinates.
    fn home(&mut self, words: &Words) -> Result<Option<Step>, Fault> {
        let is_relative = self.modal.distance == Some(Distance::Incremental);
        let is_rapid = self.modal.motion == Some(Motion::Rapid);
        // The last of the two codes counts.
        let last = words.g.all().iter().rfind(|code| [HOME, MACHINE_COORDINATES].contains(code));
        let is_known = if last == Some(&HOME) { is_relative } else { !is_relative && is_rapid };
        if !is_known || words.get('Z') != Some(0.0) || words.first_of("XYIJKABC").is_some() {
            return Err(Fault::Conflict);
        }
        self.modal.at[2] = None;
        Ok(None)
    }

    fn dwell(&self, words: &Words) -> Result<Option<Step>, Fault> {
        let count = words.get('P').ok_or(Fault::Missing('P'))?;
        let seconds = match self.dialect.dwell {
            Dwell::Seconds => count,
            Dwell::Milliseconds => count / 1000.0,
        };
        let has_motion = words.g.all().iter().any(|&code| modal_group(code) == MOTION_GROUP);
        if has_motion || words.first_of("XYZIJKABC").is_some() || seconds < 0.0 {
            return Err(Fault::Conflict);
        }
        Ok(Some(Step::Dwell { seconds }))
    }

    fn motion(&mut self, words: &Words) -> Result<Option<Step>, Fault> {
        if words.first_of("XYZIJKABC").is_none() {
            return Ok(None);
        }
        let motion = self.modal.motion.ok_or(Fault::NoMotion)?;
        if self.modal.distance == Some(Distance::Incremental) {
            return Err(Fault::Relative);
        }
        let from = self.moved(words);
        if self.leaning.is_in_force(words) {
            return self.posed(words, motion, from).map(Some);
        }
        if self.modal.feed_mode == Some(FeedMode::InverseTime) && motion != Motion::Rapid {
            return Err(Fault::Conflict);
        }
        if let (Motion::Rapid | Motion::Line, Some(letter)) = (motion, words.first_of("IJK")) {
            return Err(Fault::Unused(letter));
        }
        if motion == Motion::Rapid {
            return Ok(Some(Step::Rapid { from, to: self.modal.at }));
        }
        let (rate, start, end) = self.cut_from(from)?;
        let Motion::Arc(direction) = motion else {
            let along = Curve::Line(Line { start, end });
            return Ok(Some(Step::Feed { along, rate, radius_mismatch_mm: 0.0, center: None }));
        };
        let (plane, center) = (self.plane(), self.center(words, &start)?);
        let [s, e, c] = [start, end, center].map(|p| plane.to_local(&p).xy());
        let radius_mismatch_mm = ((s - c).norm() - (e - c).norm()).abs();
        if radius_mismatch_mm > self.mismatch_limit_mm {
            return Err(Fault::RadiusMismatch { mismatch_mm: radius_mismatch_mm });
        }
        let arc = Arc::with_center_near(plane, direction, start, end, center).map_err(Fault::Arc)?;
        Ok(Some(Step::Feed { along: Curve::Arc(arc), rate, radius_mismatch_mm, center: Some(center) }))
    }

    /// The parabola of a block. Both offsets of its control point have to be written, and it has no Z word.
    fn parabola(&mut self, words: &Words) -> Result<Option<Step>, Fault> {
        if self.plane() != Plane::Xy {
            return Err(Fault::ParabolaPlane);
        }
        if let Some(letter) = words.first_of("ZKABC") {
            return Err(Fault::Unused(letter));
        }
        if words.first_of("XY").is_none() {
            return Err(Fault::Missing('X'));
        }
        let offset = |letter| words.get(letter).ok_or(Fault::Missing(letter));
        let offset = Vector3::new(offset('I')? * self.unit_mm(), offset('J')? * self.unit_mm(), 0.0);
        let from = self.moved(words);
        let (rate, start, end) = self.cut_from(from)?;
        let parabola = Parabola::new(start, start + offset, end).map_err(|_| Fault::ParabolaSize)?;
        let along = Curve::Parabola(parabola);
        Ok(Some(Step::Feed { along, rate, radius_mismatch_mm: 0.0, center: None }))
    }

    /// Goes to the coordinates of a block, and returns where the block starts.
    fn moved(&mut self, words: &Words) -> [Option<f64>; 3] {
        let from = self.modal.at;
        for (axis, letter) in ['X', 'Y', 'Z'].into_iter().enumerate() {
            if let Some(value) = words.get(letter) {
                self.modal.at[axis] = Some(value * self.unit_mm());
            }
        }
        from
    }

    /// Feed, start and end of a cutting block that has moved the position.
    fn cut_from(&self, from: [Option<f64>; 3]) -> Result<(FeedRate, Point3<f64>, Point3<f64>), Fault> {
        let known = |at: [Option<f64>; 3]| match at {
            [Some(x), Some(y), Some(z)] => Ok(Point3::new(x, y, z)),
            _ => Err(Fault::UnknownStart),
        };
        Ok((self.modal.feed.ok_or(Fault::NoFeed)?, known(from)?, known(self.modal.at)?))
    }

    /// The written centre: offsets from the start, of which one may be missing.
    fn center(&self, words: &Words, start: &Point3<f64>) -> Result<Point3<f64>, Fault> {
        const OFFSETS: [char; 3] = ['I', 'J', 'K'];
        let [a, b, n] = self.plane().axes();
        if words.has(OFFSETS[n]) {
            return Err(Fault::Unused(OFFSETS[n]));
        }
        let mut center = *start;
        let offsets = [a, b].map(|axis| (axis, words.get(OFFSETS[axis])));
        if offsets.iter().all(|(_, offset)| offset.is_none()) {
            return Err(Fault::MissingCenter);
        }
        for (axis, offset) in offsets {
            center[axis] += offset.unwrap_or(0.0) * self.unit_mm();
        }
        Ok(center)
    }

    /// The reader never forgets a mode that [`Modal::START`] knows, so neither fallback is ever taken.
    fn unit_mm(&self) -> f64 {
        self.modal.units.unwrap_or_default().mm()
    }

    fn plane(&self) -> Plane {
        self.modal.plane.unwrap_or(Plane::Xy)
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
                Ok(None) => {}
                Ok(Some(step)) => return Some(Ok(Placed { line: self.line, step })),
                Err(fault) => {
                    self.is_over = true;
                    return Some(Err(ReadError { line: self.line, fault }));
                }
            }
        }
        None
    }
}

#[cfg(test)]
mod tests;
