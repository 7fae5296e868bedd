//! The post-processor: writes a toolpath as the text of an NC program in a dialect.
//!
//! # Method
//! 1. `abilities` refuses what the dialect has no words for. `lower` turns the toolpath into blocks.
//!    [`toolpathd_core::toolpath::quantize`] rounds their coordinates to the decimals of the program.
//! 2. `header` collects the comments for people that stand before the first block.
//!    Where the tool leans, `posed` turns poses into blocks.
//!    A program may have several operations; `sequence` tells what changes between them.
//! 3. `write` writes the blocks as lines of text, between the first and the last lines that the dialect
//!    prescribes.
//! 4. `check` reads the text back with [`read`]. It compares each motion and each dwell of the text with the
//!    block from which it was written, and tool, spindle, coolant, offsets and moves to the machine's end of
//!    Z with the job.
//!
//! [`rewrite`] is separate: it shortens programs of any origin.
//!
//! # Guarantees
//! * A program is returned only if `check` finds no difference.
//! * The Frechet distance between the feed moves of the toolpath and those of the program is at most 1.5
//!   units of the last decimal. Errors do not accumulate, because each end of a move is an absolute
//!   coordinate, rounded on its own.
//! * The program turns the rotary axes, and moves to the start of the toolpath first in X and Y and then
//!   in Z. Where it states vectors, the axes turn on the way. After the last move it retracts to the
//!   clearance plane. If the job asks for it, the tool also moves to the machine's end of Z.
//! * A rapid that moves Z together with X or Y becomes two blocks, one for Z and one for X and Y. Upward, the
//!   block for Z comes first; downward, it comes last.
//! * User text appears only in comments.
//!
//! # Cost
//! O(n) for n moves, in time and memory: about 1.5 microseconds for each move (`benches/programs.rs`).

pub mod dialect;
pub mod dialects;
pub mod path_text;
pub mod read;
pub mod rewrite;

mod abilities;
mod blank;
mod block;
mod check;
mod coarse;
mod custom;
mod cycles;
mod header;
mod helix;
mod lower;
mod nc;
mod posed;
mod rails;
mod sequence;
mod smoothing;
mod words;
mod write;

pub use abilities::{Missing, missing};
pub use coarse::{CoarseFeeds, coarse_feeds};
pub use custom::{CustomFault, CustomPart, MAX_LINES, OwnWorkOffset, Refused, own_work_offset, refused};
pub use dialect::{AxisOutput, Dialect};
pub use dialects::{DIALECTS, dialect};
pub use header::clock;
pub use posed::{FiveAxes, Slowed};
pub use sequence::Unjoinable;
pub use smoothing::{OwnSmoothing, own_smoothing};

use nalgebra::Point3;
use sequence::Part;
use write::Written;

use toolpathd_core::budget::{Budget, Stopped};
use toolpathd_core::machine::FollowError;
use toolpathd_core::toolpath::Toolpath;
use toolpathd_core::toolpath::cutting::Cutting;
use toolpathd_core::toolpath::program::Program;
use toolpathd_core::toolpath::quantize::QuantizeError;
use toolpathd_core::toolpath::tool::{DEFAULT_NUMBER, Tool};

/// Most blocks of one program. Two million blocks with their text take some 200 MB. A few arcs of kilometre
/// radius, written as chords, reach this limit.
pub const MAX_BLOCKS: usize = 2_000_000;

/// Blocks between two checks of the budget. More blocks delay a cancellation; fewer cost time.
const BLOCKS_BETWEEN_CHECKS: usize = 1024;

/// A remark that stands before a pass, as a comment.
#[derive(Debug, Clone, PartialEq)]
pub struct PassNote {
    /// The index of the pass in the toolpath.
    pub pass: usize,
    /// The fixed label of the comment.
    pub label: &'static str,
    /// Any characters. The height of the pass stands behind the text, in the units of the program.
    pub text: String,
    /// The height of the pass, mm.
    pub z_mm: f64,
}

/// The input from which a program is written, without its toolpath.
#[derive(Debug, Clone, Copy)]
pub struct ProgramJob<'a> {
    pub program: &'a Program,
    /// Without a tool the program calls the tool `called`, and its header says nothing about the tool.
    pub tool: Option<&'a Tool>,
    pub cutting: &'a Cutting,
    pub dialect: &'a Dialect,
    /// User text, one comment each; any characters.
    pub comments: &'a [String],
    /// Remarks before passes of an upright tool, in the order of the passes.
    pub pass_notes: &'a [PassNote],
    /// Warnings to people at the machine; each becomes one comment or several. Any characters.
    pub warnings: &'a [String],
    /// How the axis of a leaning tool is written. `None` for a toolpath whose axis is straight up.
    pub five_axes: Option<FiveAxes<'a>>,
    /// The number of the tool that is called where no tool is described. Default: 1.
    pub called: Option<u32>,
}

impl<'a> ProgramJob<'a> {
    /// A job of an upright tool that the program does not describe, without comments and warnings.
    pub const fn plain(program: &'a Program, cutting: &'a Cutting, dialect: &'a Dialect) -> Self {
        Self {
            program,
            tool: None,
            cutting,
            dialect,
            comments: &[],
            pass_notes: &[],
            warnings: &[],
            five_axes: None,
            called: None,
        }
    }

    /// The numbers of the tool and of its length offset.
    fn tool_numbers(&self) -> (u32, u32) {
        if let Some(tool) = self.tool {
            return (tool.places().0, self.dialect.length_offset_of(tool));
        }
        // A text that calls a tool by its number describes no cutter, and tool 1 would be another one.
        let number = self.called.unwrap_or(DEFAULT_NUMBER);
        let usual = self.dialect.abilities.length_offsets.and_then(|offsets| offsets.usual);
        (number, usual.unwrap_or(number))
    }

    /// The rotary axes in the order of their letters: each letter, and the place of its angle in a block.
    fn rotary_words(&self) -> [(char, usize); 2] {
        let [first, second] = self.rotary_names();
        if second < first { [(second, 1), (first, 0)] } else { [(first, 0), (second, 1)] }
    }

    /// The letters of the rotary axes. A job whose angles are written has a machine.
    fn rotary_names(&self) -> [char; 2] {
        let machine = self.five_axes.and_then(|five| five.machine);
        machine.map_or(['A', 'C'], |machine| [0, 1].map(|k| machine.rotary()[k].name))
    }
}

/// One operation of a program. All operations of a program have the same dialect, and the same program but
/// for the work offset.
#[derive(Debug, Clone, Copy)]
pub struct Operation<'a> {
    /// What people call the operation; any characters.
    pub name: Option<&'a str>,
    pub toolpath: &'a Toolpath,
    pub job: ProgramJob<'a>,
}

/// A written program.
#[derive(Debug, Clone, PartialEq)]
pub struct NcProgram {
    pub text: String,
    /// For each move of each operation the line that ends it, counted from 1. A move that needs no block
    /// has the line of the move before.
    pub move_lines: Vec<Vec<u32>>,
    /// Upper bound for the distance between the feed moves and any path that a control may run for them, mm,
    /// both ways.
    pub max_displacement_mm: f64,
    /// Upper bound for the angle between the tool axis of the program and the tool axis of the toolpath,
    /// radians.
    pub max_displacement_axis: f64,
    /// The largest difference of the two radii of an arc block, mm.
    pub max_radius_mismatch_mm: f64,
    /// Blocks of motion and dwell.
    pub blocks: usize,
    pub slowed: Slowed,
}

/// Why a program is not written.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum WriteError {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    #[error(transparent)]
    Quantize(#[from] QuantizeError),
    #[error("a program cannot have {decimals} decimals; choose 1 to {max}")]
    Decimals { decimals: u8, max: u8 },
    #[error("the program number {number} is out of range; choose 1 to {max}")]
    ProgramNumber { number: u32, max: u32 },
    #[error(
        "a number of the program needs more than the {limit} digits that the control reads; choose fewer decimals"
    )]
    TooManyDigits { limit: u32 },
    #[error(
        "a coordinate or a feed of the program has more than the {limit} digits before the point that the control reads; move the part nearer to the origin, lower the feed, or choose another dialect"
    )]
    TooManyWholeDigits { limit: u32 },
    #[error(transparent)]
    Missing(#[from] Missing),
    #[error(transparent)]
    Custom(#[from] Refused),
    #[error(transparent)]
    SmoothedTwice(#[from] OwnSmoothing),
    #[error(
        "the tolerance {tolerance} of the smoothing is zero in the decimals of the control; choose a larger one"
    )]
    SmallTolerance { tolerance: f64 },
    #[error("the dialect has no word for a dwell; leave dwells out, or choose another dialect")]
    NoDwells,
    #[error("the control does not read a spindle speed of {rpm} rpm; choose another speed")]
    SpindleSpeed { rpm: f64 },
    #[error(transparent)]
    Unjoinable(#[from] Unjoinable),
    /// A fault of a further operation, by its index among all operations.
    #[error("operation {}: {error}", index + 1)]
    InOperation { index: usize, error: Box<Self> },
    #[error("a cutting move of the toolpath has no feed; give every cutting move a feed")]
    FeedMissing,
    #[error(
        "a feed of {mm_per_min} mm/min is below the smallest number that the control reads, or too large; choose another feed"
    )]
    Feed { mm_per_min: f64 },
    #[error("a dwell of {seconds} s is longer than the {most_s} s that the control reads; divide the dwell")]
    Dwell { seconds: f64, most_s: f64 },
    #[error(
        "rounded to the decimals of the program, nothing is left between the heights of a canned cycle: the retract plane at {retract_z_mm} mm, the material at {top_z_mm} mm, the bottom at {bottom_z_mm} mm; choose more decimals, or heights farther apart"
    )]
    CycleHeights { top_z_mm: f64, retract_z_mm: f64, bottom_z_mm: f64 },
    #[error("the toolpath leans or turns the tool, and no machine is given")]
    MachineMissing,
    #[error("the dialect cannot write the tool axis in this way; choose another way or another dialect")]
    AxisOutput,
    #[error("the second point of a rail is too near the tip for the decimals of the program")]
    SecondPointTooNear,
    #[error("near {at} {}", error.told())]
    NotFollowed { error: FollowError, at: Point3<f64> },
    #[error(
        "near {at} the tool axis passes the pole of the machine, where a rotary axis would have to turn at once; lean the axis there, or turn the part"
    )]
    NearPole { at: Point3<f64> },
    #[error("a motion of {seconds} s is too long for a feed by inverse time; divide it")]
    InverseTime { seconds: f64 },
    #[error("the program needs more than {limit} blocks; split the toolpath")]
    TooManyBlocks { limit: usize },
    #[error(
        "a line of the program is longer than the {limit} characters that the control reads; choose fewer decimals, or no block numbers"
    )]
    LineTooLong { limit: usize },
    #[error("the check of the written program failed: {0}")]
    Unreadable(#[from] read::ReadError),
    #[error("the check of the written program failed: line {line} has another {what} than the toolpath")]
    Differs { line: usize, what: &'static str },
}

impl WriteError {
    /// Wraps the error of an operation in [`Self::InOperation`] with the operation's index, counted from 0.
    /// An error of the first operation stays as it is, and so does [`Self::Stopped`].
    fn of_operation(self, index: usize) -> Self {
        match self {
            Self::Stopped(_) => self,
            error if index == 0 => error,
            error => Self::InOperation { index, error: Box::new(error) },
        }
    }
}

/// Writes `toolpath` as a program.
///
/// # Errors
/// One of [`WriteError`]. A program that does not read back as its toolpath is never returned.
pub fn write(toolpath: &Toolpath, job: &ProgramJob, budget: &Budget) -> Result<NcProgram, WriteError> {
    write_all(&[Operation { name: None, toolpath, job: *job }], budget)
}

/// Writes operations, one after the other, as one program. Between two operations of different tools the
/// control changes the tool.
///
/// # Errors
/// One of [`WriteError`]. A program that does not read back as its toolpaths is never returned.
pub fn write_all(operations: &[Operation], budget: &Budget) -> Result<NcProgram, WriteError> {
    let parts = parts(operations, budget)?;
    let Written { text, custom, block_ends } = write::text(&parts)?;
    let max_radius_mismatch_mm = check::read_back(&text, &custom, &parts, budget)?;
    let largest =
        |of: fn(&lower::Lowered) -> f64| parts.iter().map(|part| of(&part.lowered)).fold(0.0, f64::max);
    Ok(NcProgram {
        text,
        move_lines: parts.iter().zip(&block_ends).map(|(part, ends)| move_lines(part, ends)).collect(),
        max_displacement_mm: largest(|lowered| lowered.displacement_mm),
        max_displacement_axis: largest(|lowered| lowered.displacement_axis),
        max_radius_mismatch_mm,
        blocks: parts
            .iter()
            .map(|part| part.lowered.blocks.iter().filter(|block| block.acts()).count())
            .sum(),
        slowed: parts.iter().map(|part| part.lowered.slowed).sum(),
    })
}

/// For each move of an operation the line that ends it. `block_ends` has the lines of the operation's blocks.
fn move_lines(part: &Part, block_ends: &[u32]) -> Vec<u32> {
    let line = |n_blocks: &u32| {
        let last = (*n_blocks as usize).checked_sub(1).and_then(|k| block_ends.get(k));
        last.copied().unwrap_or(0)
    };
    part.lowered.move_ends.iter().map(line).collect()
}

/// The operations as blocks with remarks, and what changes between them.
fn parts<'a>(operations: &'a [Operation<'a>], budget: &Budget) -> Result<Vec<Part<'a>>, WriteError> {
    for (k, operation) in operations.iter().enumerate() {
        check_job(&operation.job).map_err(|error| error.of_operation(k))?;
    }
    let changes = sequence::changes(operations)?;
    let mut lowered: Vec<lower::Lowered> = Vec::with_capacity(operations.len());
    for (k, (operation, change)) in operations.iter().zip(&changes).enumerate() {
        let from = lowered.last().and_then(|before| before.end).filter(|_| !change.leaves());
        let blocks = lower::lower(operation.toolpath, &operation.job, from, budget);
        lowered.push(blocks.map_err(|error| error.of_operation(k))?);
        if lowered.iter().map(|one| one.blocks.len()).sum::<usize>() > MAX_BLOCKS {
            return Err(WriteError::TooManyBlocks { limit: MAX_BLOCKS });
        }
    }
    let remarks = header::remarks(operations, &lowered)?;
    Ok(operations
        .iter()
        .zip(changes)
        .zip(lowered)
        .zip(remarks)
        .map(|(((operation, change), lowered), remarks)| Part { operation, change, lowered, remarks })
        .collect())
}

/// Refuses what the dialect has no words for.
fn check_job(job: &ProgramJob) -> Result<(), WriteError> {
    let resolution = job.program.resolution;
    let max = job.dialect.max_decimals;
    if !(1..=max).contains(&resolution.decimals) {
        return Err(WriteError::Decimals { decimals: resolution.decimals, max });
    }
    if let Some(first) = missing(job.dialect, job.program, job.cutting.coolant, job.tool).first() {
        return Err((*first).into());
    }
    if let Some(rpm) = job.cutting.spindle_rpm {
        words::spindle(rpm, &job.dialect.numbers)?;
    }
    if let Some(first) = refused(job.dialect, &job.program.custom).into_iter().next() {
        return Err(first.into());
    }
    if let Some(own) = own_smoothing(job.dialect, &job.program.custom)
        && job.program.smoothing.is_some()
    {
        return Err(own.into());
    }
    Ok(())
}

#[cfg(test)]
mod tests;
