//! Writes blocks as lines of text, in the syntax of the dialect. A modal word is written only where it
//! changes the mode.

mod deckel;
mod iso;
mod klartext;
mod lines;
mod remarks;

pub use lines::Written;

use super::dialect::Syntax;
use super::header::Remark;
use super::lower::Lowered;
use super::{ProgramJob, WriteError};
use toolpathd_core::toolpath::tool::DEFAULT_NUMBER;

/// Returns the text of a whole program.
///
/// # Errors
/// When a word of the frame cannot be written, a number has more digits or a line more characters than the
/// control takes.
pub fn text(lowered: &Lowered, remarks: &[Remark], job: &ProgramJob) -> Result<Written, WriteError> {
    let blocks = &lowered.blocks;
    match &job.dialect.syntax {
        Syntax::Iso(iso) | Syntax::Siemens(iso) => iso::text(lowered, remarks, job, iso),
        Syntax::Klartext => klartext::text(blocks, remarks, job),
        Syntax::Deckel => deckel::text(blocks, job),
    }
}

/// The numbers of the tool and of its length offset.
pub fn tool_of(job: &ProgramJob) -> (u32, u32) {
    if let Some(tool) = job.tool {
        return (tool.places().0, job.dialect.length_offset_of(tool));
    }
    // A text that calls a tool by its number describes no cutter, and tool 1 would be another one.
    let number = job.called.unwrap_or(DEFAULT_NUMBER);
    let usual = job.dialect.abilities.length_offsets.and_then(|offsets| offsets.usual);
    (number, usual.unwrap_or(number))
}

/// The number of the program, where the dialect has one.
pub fn program_number(job: &ProgramJob) -> Result<Option<u32>, WriteError> {
    let Some(max) = job.dialect.max_program_number else { return Ok(None) };
    let number = job.program.number;
    if (1..=max).contains(&number) {
        Ok(Some(number))
    } else {
        Err(WriteError::ProgramNumber { number, max })
    }
}
