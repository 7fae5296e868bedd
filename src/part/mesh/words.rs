//! Words of a text, with their lines.

use crate::fault::{Place, Unreadable};

/// Most characters of a word that an error repeats.
const MOST_SHOWN: usize = 40;

/// The words of a text: what stands between blanks, tabs and ends of lines. Lines end with LF, CR LF or CR.
#[derive(Clone)]
pub struct Words<'a> {
    rest: &'a [u8],
    line: u64,
}

impl<'a> Words<'a> {
    /// The words of a text whose first line has the number `line`.
    pub fn new(text: &'a [u8], line: u64) -> Self {
        Self { rest: text, line }
    }

    /// The line of the last word, or of the end of the text.
    pub fn place(&self) -> Place {
        Place::Line(self.line)
    }

    /// The next word.
    pub fn next(&mut self) -> Option<&'a [u8]> {
        while let Some((&first, rest)) = self.rest.split_first() {
            if !first.is_ascii_whitespace() {
                break;
            }
            self.line += u64::from(ends_line(first, rest));
            self.rest = rest;
        }
        let end = self.rest.iter().position(u8::is_ascii_whitespace).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        (!word.is_empty()).then_some(word)
    }

    /// Leaves the rest of the line out.
    pub fn skip_line(&mut self) {
        let end = self.rest.iter().position(|byte| [b'\n', b'\r'].contains(byte));
        self.rest = &self.rest[end.unwrap_or(self.rest.len())..];
    }

    /// Whether the line ends, or blanks alone are left in it.
    pub fn is_at_end_of_line(&self) -> bool {
        let next = self.rest.iter().find(|byte| !byte.is_ascii_whitespace() || [b'\n', b'\r'].contains(byte));
        next.is_none_or(u8::is_ascii_whitespace)
    }

    /// How many bytes are left.
    pub fn n_left(&self) -> usize {
        self.rest.len()
    }

    /// Takes a word that must come next, in any case.
    ///
    /// # Errors
    /// When another word comes, or none.
    pub fn expect(&mut self, wanted: &str) -> Result<(), Unreadable> {
        match self.next() {
            Some(word) if word.eq_ignore_ascii_case(wanted.as_bytes()) => Ok(()),
            found => Err(self.fault(found, wanted)),
        }
    }

    /// Takes a number that must come next. It may be `nan` or infinite.
    ///
    /// # Errors
    /// When no number comes.
    pub fn number(&mut self) -> Result<f64, Unreadable> {
        let word = self.next();
        word.and_then(number).ok_or_else(|| self.fault(word, "a number"))
    }

    /// The fault of a word in the place of what was wanted.
    pub fn fault(&self, found: Option<&[u8]>, wanted: &str) -> Unreadable {
        let detail = match found {
            Some(word) => format!("{} stands in the place of {wanted}", shown(word)),
            None => format!("the text ends in the place of {wanted}"),
        };
        Unreadable::at(self.place(), detail)
    }
}

/// Whether a line ends with this byte: CR LF ends one line, not two.
fn ends_line(byte: u8, rest: &[u8]) -> bool {
    byte == b'\n' || byte == b'\r' && rest.first() != Some(&b'\n')
}

/// The number that a word is.
pub fn number(word: &[u8]) -> Option<f64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// A word for people: its beginning, without signs that control a terminal.
pub fn shown(word: &[u8]) -> String {
    let text = String::from_utf8_lossy(word);
    let start: String = text.chars().filter(|c| !c.is_control()).take(MOST_SHOWN).collect();
    if text.chars().count() > MOST_SHOWN { format!("\"{start}...\"") } else { format!("\"{start}\"") }
}
