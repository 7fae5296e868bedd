//! Remarks as comments of one line each.

use super::lines::Lines;
use crate::WriteError;
use crate::dialect::{Comment, Dialect};
use crate::header::{self, Remark};
use crate::words;

/// Most characters of a remark. A longer line would be hard to read on a control's screen.
const MAX_REMARK_LENGTH: usize = 100;

/// Most characters of a warning. The rest of a longer warning is left out.
const MAX_WARNING_LENGTH: usize = 600;

/// Writes a remark as one comment line, and a long warning as several. A text without any character that a
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
    let texts = match *label {
        header::WARNING => words::lines(&words::cleaned(text, MAX_WARNING_LENGTH), limit),
        _ => vec![words::cleaned(text, limit)],
    };
    for text in texts.iter().filter(|text| !text.is_empty()) {
        lines.line(&format!("{open}{label}{separator}{text}{close}"))?;
    }
    Ok(())
}
