//! Writes blocks as lines of text, in the syntax of the dialect. A modal word is written only where it
//! changes the mode.

mod deckel;
mod iso;
mod klartext;
mod lines;
mod remarks;

pub use lines::Written;

use super::dialect::Syntax;
use super::sequence::Part;
use super::{ProgramJob, Unjoinable, WriteError};

/// Returns the text of a whole program of at least one operation.
///
/// # Errors
/// When a word of the frame cannot be written, a number has more digits or a line more characters than the
/// control takes.
pub fn text(parts: &[Part]) -> Result<Written, WriteError> {
    let [first, later @ ..] = parts else { return Err(Unjoinable::Nothing.into()) };
    let job = &first.operation.job;
    match &job.dialect.syntax {
        Syntax::Iso(iso) | Syntax::Siemens(iso) => iso::text(first, later, iso),
        Syntax::Klartext => klartext::text(first, later),
        Syntax::Deckel => deckel::text(&first.lowered.blocks, job),
    }
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
