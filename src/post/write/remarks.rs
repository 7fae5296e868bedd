//! Remarks as comments, at the head of an operation and between its blocks.

use std::iter::{Peekable, Zip};
use std::slice::Iter;

use super::lines::Lines;
use crate::dialect::{Comment, Dialect};
use crate::header::{Remark, of_pass};
use crate::sequence::Part;
use crate::words;
use crate::{PassNote, ProgramJob, WriteError};

/// Most characters of a remark. A longer line would be hard to read on a control's screen.
const MAX_REMARK_LENGTH: usize = 100;

/// Most characters of a remark of several lines. The rest of a longer remark is left out.
const MAX_LONG_LENGTH: usize = 600;

/// The labels of texts of users. Each has one line.
const USERS: [&str; 3] = ["PROGRAM", "NOTE", "OPERATION"];

/// Writes a text of a user as one comment line, and any other remark that is too long for one as several. No
/// number is divided. A text without any character that a
/// comment may hold writes no line.
pub fn write(
    lines: &mut Lines,
    dialect: &Dialect,
    comment: &Comment,
    Remark { label, text }: &Remark,
) -> Result<(), WriteError> {
    let Comment { open, separator, close } = comment;
    // Room for a block number beside the label and its punctuation.
    let used = 12 + open.len() + label.len() + separator.len() + close.len();
    let limit = dialect.max_line_length.saturating_sub(used).min(MAX_REMARK_LENGTH);
    let texts = if USERS.contains(label) {
        vec![words::shortened(text, limit)]
    } else {
        words::lines(&words::shortened(text, MAX_LONG_LENGTH), limit)
    };
    for text in texts.iter().filter(|text| !text.is_empty()) {
        lines.line(&format!("{open}{label}{separator}{text}{close}"))?;
    }
    Ok(())
}

/// The notes of a job that stand before passes, each with the index of the block before which it stands.
pub struct Notes<'a> {
    job: &'a ProgramJob<'a>,
    left: Peekable<Zip<Iter<'a, usize>, Iter<'a, PassNote>>>,
}

impl<'a> Notes<'a> {
    pub fn new(part: &'a Part<'a>) -> Self {
        let job = &part.operation.job;
        Self { job, left: part.lowered.notes_at.iter().zip(job.pass_notes).peekable() }
    }

    /// Writes the notes that stand before block `k`.
    pub fn write_before(&mut self, k: usize, lines: &mut Lines, comment: &Comment) -> Result<(), WriteError> {
        while let Some((_, note)) = self.left.next_if(|(at, _)| **at <= k) {
            write(lines, self.job.dialect, comment, &of_pass(note, self.job))?;
        }
        Ok(())
    }
}
