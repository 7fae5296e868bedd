//! The post-processor: a toolpath becomes the text of an NC program in a dialect.
//!
//! # Method
//! 1. `lower`: the toolpath becomes blocks of integers, units of the last decimal, with the approach before
//!    and the retract behind it; curves are rounded by [`crate::toolpath::quantize`]. A parabola that the dialect cannot
//!    say becomes lines.
//! 2. `header`: what people should know about the program before it runs.
//! 3. `write`: the blocks become lines of words between the dialect's start and end; modal words are left out
//!    where they would repeat what holds.
//! 4. `check`: the text is read back by a reader of its own and compared with the blocks.
//!
//! Programs of others' making are shortened by [`rewrite`], which shares the dialects and the numbers.
//!
//! # Guarantees
//! * What is returned has been read back: kinds, ends, senses, feeds, centres and control points are those of the blocks, and
//!   no two radii of an arc differ by more than 1.5 units of the last decimal.
//! * Every cutting point of the text lies within 1.5 units of the last decimal of the toolpath, and vice
//!   versa, in order. Nothing accumulates: ends are absolute and rounded on their own.
//! * No motion is added but the approach to the start (Z to the clearance plane, then X and Y, then down) and
//!   the retract to the clearance plane. A rapid that moves Z and X or Y is split: up first, down last.
//! * User text is only ever part of a comment behind a fixed label.
//!
//! # Cost
//! O(n) in the moves, and as much memory. Half arcs, half lines take 1.5 microseconds a move, for any number from 2,000
//! to 200,000 (`benches/programs.rs`).

pub mod dialect;
pub mod dialects;
pub mod read;
pub mod rewrite;

mod check;
mod header;
mod lower;
mod words;
mod write;

pub use dialect::{DIALECTS, Dialect, dialect};
pub use header::clock;

use crate::budget::{Budget, Stopped};
use crate::toolpath::Toolpath;
use crate::toolpath::cutting::Cutting;
use crate::toolpath::program::Program;
use crate::toolpath::quantize::{Grid, QuantizeError};
use crate::toolpath::tool::Tool;

/// The largest number of blocks of one program: with their text they take some 200 MB. A few arcs of kilometre radius,
/// written as chords, come to as many.
pub const MAX_BLOCKS: usize = 2_000_000;

/// Blocks between two looks at the budget.
const BLOCKS_BETWEEN_CHECKS: usize = 1024;

/// What a program is written from beside its toolpath.
#[derive(Debug, Clone, Copy)]
pub struct ProgramJob<'a> {
    pub program: &'a Program,
    /// Without one the program calls tool 1 with length offset 1 and says nothing about its form.
    pub tool: Option<&'a Tool>,
    pub cutting: &'a Cutting,
    pub dialect: &'a Dialect,
    /// User text, one comment each; any characters.
    pub comments: &'a [String],
    /// What somebody should look at before it is cut, one warning each; any characters.
    pub warnings: &'a [String],
}

/// A written program.
#[derive(Debug, Clone, PartialEq)]
pub struct NcProgram {
    pub text: String,
    /// Upper bound for the distance between the feed moves and whatever a control may run for them, mm, both ways.
    pub max_displacement_mm: f64,
    /// The largest difference of the two radii of an arc block, mm.
    pub max_radius_mismatch_mm: f64,
    /// Blocks of motion and dwell.
    pub blocks: usize,
}

/// Why a program is not written.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum WriteError {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    #[error(transparent)]
    Quantize(#[from] QuantizeError),
    #[error("{decimals} decimals cannot be written; 1 to {max} can")]
    Decimals { decimals: u8, max: u8 },
    #[error("the program number {number} is outside 1..={max}")]
    ProgramNumber { number: u32, max: u32 },
    #[error("a number of the program has more than the {limit} digits its control reads")]
    TooManyDigits { limit: u32 },
    #[error("there is no work offset G{number}; G54 to G59 are")]
    WorkOffset { number: u8 },
    #[error("a spindle speed of {rpm} rpm cannot be written")]
    SpindleSpeed { rpm: f64 },
    #[error("a move has no feed")]
    FeedMissing,
    #[error("a feed of {mm_per_min} mm/min cannot be written")]
    Feed { mm_per_min: f64 },
    #[error("a dwell of {seconds} s cannot be written")]
    Dwell { seconds: f64 },
    #[error("the program needs more than {limit} blocks")]
    TooManyBlocks { limit: usize },
    #[error("a line of the program is longer than the {limit} characters its control takes")]
    LineTooLong { limit: usize },
    #[error("the written program does not read back: {0}")]
    Unreadable(#[from] read::ReadError),
    #[error("line {line} of the written program reads back with another {what}")]
    Differs { line: usize, what: &'static str },
}

/// Writes `toolpath` as a program.
///
/// # Errors
/// One of [`WriteError`]; a program that does not read back as its toolpath is never returned.
pub fn write(toolpath: &Toolpath, job: &ProgramJob, budget: &Budget) -> Result<NcProgram, WriteError> {
    let resolution = job.program.resolution;
    let max = job.dialect.max_decimals;
    if !(1..=max).contains(&resolution.decimals) {
        return Err(WriteError::Decimals { decimals: resolution.decimals, max });
    }
    let grid = Grid::new(resolution);
    let lowered = lower::lower(toolpath, job, budget)?;
    let remarks = header::remarks(toolpath, &lowered, job)?;
    let blocks = &lowered.blocks;
    let text = write::text(blocks, &remarks, job)?;
    let max_radius_mismatch_mm = check::read_back(&text, blocks, job.dialect, &grid, budget)?;
    let max_displacement_mm = lowered.displacement_mm;
    Ok(NcProgram { text, max_displacement_mm, max_radius_mismatch_mm, blocks: blocks.len() })
}

#[cfg(test)]
mod tests;
