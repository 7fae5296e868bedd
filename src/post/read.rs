//! Reads programs of the kind that this crate writes, in the way in which a control reads them.
//!
//! The reader exists to check the writer. So the two share no code and no words: of the dialect, a reader
//! takes the syntax, limits of numbers and lines, the rules for arcs, and the steps of block numbers. Each
//! syntax has a reader of its own.
//!
//! # Guarantees
//! A word, code or combination of words that the reader does not know is an error. Nothing is
//! skipped but comments and the lines given to [`Reader::passing`]. A feed move from a position that is not
//! known is an error, too.
//!
//! # Cost
//! O(n) for n characters. Only one line is in memory at a time.

mod cut;
mod deckel;
mod hole;
mod iso;
mod klartext;
mod number;
mod posed;
mod siemens;
mod state;

use std::ops::Range;

use nalgebra::Point3;

pub use self::hole::{Cycle, Hole};
pub use self::posed::{Posed, PosedFeed, ROTARY, RailStep, TipMode};
pub use self::state::{Calls, MachineState, Spindle};
use super::dialect::{Dialect, Syntax};
pub use super::nc::Fault;
use toolpathd_core::geometry::curve::Curve;
use toolpathd_core::toolpath::program::Smoothing;
use toolpathd_core::toolpath::units::FeedRate;

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
    /// A motion of the tip and of a second point of the tool, both along polynomials.
    Rail(RailStep),
    /// A hole of a canned cycle, with the way to it and back.
    Hole(Hole),
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
    language: Box<dyn Language + 'a>,
    /// Lines that are not read, by their indices.
    passed: &'a [Range<usize>],
    line: usize,
    is_over: bool,
}

/// The rules of a syntax, with the modal state at the place where they are applied.
trait Language {
    /// Takes the next line.
    fn line(&mut self, text: &str) -> Result<Option<Step>, Fault>;

    /// Takes a line that is not read. It may set every mode and move anywhere.
    fn pass(&mut self);

    /// Takes no mode for granted at the start of the program.
    fn assume_nothing(&mut self) {}

    fn calls(&self) -> Calls;

    fn state(&self) -> MachineState;

    /// The number of the program. None where the program has stated none.
    fn program(&self) -> Option<u32> {
        None
    }

    /// The smoothing in force. None where no word has chosen one that is read.
    fn smoothing(&self) -> Option<Smoothing> {
        None
    }

    /// The lowest and the highest corner of the raw part, mm. None where the program has stated none.
    fn blank(&self) -> Option<[Point3<f64>; 2]> {
        None
    }

    /// Whether the text may end here.
    fn end(&self) -> Result<(), Fault>;
}

impl<'a> Reader<'a> {
    /// Arcs that break a rule of the control are refused, and arcs whose radii differ by more than
    /// `mismatch_limit_mm`.
    pub fn new(text: &'a str, dialect: &'a Dialect, mismatch_limit_mm: f64) -> Self {
        let arcs = dialect.curves.accepts.capped(mismatch_limit_mm);
        let language: Box<dyn Language> = match &dialect.syntax {
            Syntax::Iso(_) => Box::new(iso::Reader::new(dialect.name, arcs)),
            Syntax::Siemens(_) => Box::new(siemens::Reader::new(dialect, arcs)),
            Syntax::Klartext => Box::new(klartext::Reader::new(dialect, arcs)),
            Syntax::Deckel => Box::new(deckel::Reader::new(dialect)),
        };
        Self { lines: text.lines().enumerate(), language, passed: &[], line: 0, is_over: false }
    }

    /// Takes no mode for granted at the start of the program: each has to be stated before it counts.
    pub fn assuming_nothing(mut self) -> Self {
        self.language.assume_nothing();
        self
    }

    /// The number of the line that was read last, from 1; 0 before the first.
    pub fn line(&self) -> usize {
        self.line
    }

    /// What programs of this control can ask for.
    pub fn calls(&self) -> Calls {
        self.language.calls()
    }

    /// What the program has asked of the machine before or in the block of the last step.
    pub fn state(&self) -> MachineState {
        self.language.state()
    }

    /// The number of the program. None where the control knows a program by its file.
    pub fn program(&self) -> Option<u32> {
        self.language.program()
    }

    /// The smoothing of the control at the last step. None where no word has chosen one that is read.
    pub fn smoothing(&self) -> Option<Smoothing> {
        self.language.smoothing()
    }

    /// The lowest and the highest corner of the raw part, mm. None where no line has stated them.
    pub fn blank(&self) -> Option<[Point3<f64>; 2]> {
        self.language.blank()
    }

    /// Does not read the lines at these places.
    pub fn passing(self, passed: &'a [Range<usize>]) -> Self {
        Self { passed, ..self }
    }
}

impl Iterator for Reader<'_> {
    type Item = Result<Placed, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        while !self.is_over {
            let read = match self.lines.next() {
                Some((index, text)) => {
                    self.line = index + 1;
                    if self.passed.iter().any(|passed| passed.contains(&index)) {
                        self.language.pass();
                        continue;
                    }
                    self.language.line(text)
                }
                None => {
                    self.is_over = true;
                    self.language.end().map(|()| None)
                }
            };
            match read {
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
