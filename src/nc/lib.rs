//! Reads NC programs of any origin: what a control would do with the text, as a toolpath.
//!
//! # Method
//! 1. `source` divides the text into lines and finds programs, subroutines and block numbers.
//! 2. A reader for each language runs the program block by block: `siemens` for SINUMERIK, `klartext` for
//!    Heidenhain, `flow` for all other controls. In `flow`, `statement` tells what a line is, `block` and
//!    `expression` read its words, `variables` holds what the program computes.
//! 3. `machine` holds the modal state. `codes` and [`control`] say how controls differ. `frames` holds work
//!    offsets and shifts.
//! 4. `record` holds the moves.
//!
//! # Guarantees
//! * Nothing is dropped: a word is used, left alone and counted, or refused with its line and column.
//! * A place that is not known is never guessed. A rapid from or to such a place is no move of the toolpath;
//!   a cut is refused.
//! * Every run ends, by limits on blocks, moves, calls and pecks.
//!
//! # Cost
//! O(n) in the executed blocks: about half a microsecond each.

pub mod codes;
pub mod control;
pub mod fault;
pub mod frames;
pub mod machine;
pub mod notes;
pub mod record;
pub mod trace;

mod block;
mod expression;
mod flow;
mod klartext;
mod offset_curve;
mod placement;
mod siemens;
mod source;
mod statement;
mod variables;

use toolpathd_core::budget::{Budget, Stopped};
use toolpathd_core::toolpath::Toolpath;

use control::{Control, Family, WithoutPoint};
use fault::Refusal;
use machine::{At, Correction, Machine, Setting};
use notes::{LeftWord, Note};
use record::{FeedUse, ToolUse};
use trace::TracedBlock;

/// A program to read, with what its text does not say.
#[derive(Debug, Clone)]
pub struct ReadJob<'a> {
    pub text: &'a [u8],
    pub control: &'a Control,
    /// Whether lengths before the first G20 or G21 are in inches.
    pub in_inches: bool,
    /// What lengths without a point mean; the control's own way if absent.
    pub without_point: Option<WithoutPoint>,
    /// Where the tool stands before the first block, mm.
    pub start: At,
    /// Zeros of work offsets in coordinates of the machine, mm.
    pub offsets: &'a [(u32, [f64; 3])],
    /// Blocks behind a slash do not run.
    pub skips_optional: bool,
    pub correction: Correction<'a>,
    pub most_moves: usize,
    /// Blocks whose modal state is recorded.
    pub most_traced: usize,
}

impl<'a> ReadJob<'a> {
    /// A program of which nothing is known but its control.
    pub fn plain(text: &'a [u8], control: &'a Control) -> Self {
        Self {
            text,
            control,
            in_inches: false,
            without_point: None,
            start: [None; 3],
            offsets: &[],
            skips_optional: false,
            correction: Correction::Refused,
            most_moves: usize::MAX,
            most_traced: 0,
        }
    }
}

/// What a program does.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadProgram {
    pub toolpath: Toolpath,
    pub tools: Vec<ToolUse>,
    pub feeds: Vec<FeedUse>,
    /// The line of each move of the toolpath, counted from 1; 0 for pauses before the first move.
    pub lines: Vec<u32>,
    /// Where the tool stands at the end, as far as that is known, mm.
    pub end: At,
    /// The number of the work offset in force at the end.
    pub work_offset: u32,
    pub n_lines: usize,
    /// Blocks that have run.
    pub n_blocks: usize,
    pub n_rapids_not_counted: usize,
    pub left_alone: Vec<LeftWord>,
    pub n_left_alone: usize,
    pub notes: Vec<Note>,
    /// The state behind each block that has run, up to the asked number of blocks.
    pub trace: Vec<TracedBlock>,
}

/// How much of a text has run.
struct Ran {
    n_lines: usize,
    /// Blocks, each as often as it has run.
    n_blocks: usize,
}

/// Why a program is not read.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ReadError {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// At least one.
    #[error("{} words or blocks are refused; the first: {}", .0.len(), .0[0])]
    Refused(Vec<Refusal>),
    #[error("no move of the program is known from its start to its end")]
    NoMotion,
}

/// Reads a program.
///
/// # Errors
/// One of [`ReadError`].
pub fn read(job: &ReadJob<'_>, budget: &Budget) -> Result<ReadProgram, ReadError> {
    let setting = Setting {
        control: job.control,
        in_inches: job.in_inches,
        without_point: job.without_point.unwrap_or(job.control.without_point),
        start: job.start,
        offsets: job.offsets,
        correction: job.correction,
        most_moves: job.most_moves,
        most_traced: job.most_traced,
    };
    let mut machine = Machine::new(&setting);
    let Ran { n_lines, n_blocks } = match job.control.family {
        Family::Siemens => siemens::run(&mut machine, job.text, job.skips_optional, budget)?,
        Family::Klartext => klartext::run(&mut machine, job.text, job.skips_optional, budget)?,
        _ => flow::run(&mut machine, job.text, job.skips_optional, budget)?,
    };
    machine.finish();
    let Machine { record, refusals, left, notes, at, frames, traced, .. } = machine;
    if !refusals.is_empty() {
        return Err(ReadError::Refused(refusals));
    }
    let n_rapids_not_counted = record.n_rapids_not_counted;
    let Some((toolpath, tools, feeds, lines)) = record.finish() else { return Err(ReadError::NoMotion) };
    let n_left_alone = left.total;
    Ok(ReadProgram {
        toolpath,
        tools,
        feeds,
        lines,
        end: at,
        work_offset: frames.active(),
        n_lines,
        n_blocks,
        n_rapids_not_counted,
        left_alone: left.into_words(),
        n_left_alone,
        notes,
        trace: traced,
    })
}

#[cfg(test)]
mod tests;
