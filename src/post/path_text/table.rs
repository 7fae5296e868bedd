//! The table of the words of a language: which are read, which are left alone, and which are refused.
//!
//! A reader looks up every word of its text in such a table, and takes no word that the table lacks. A page
//! of the documentation shows the same tables, and a test runs the example of each row.

use std::collections::HashMap;

/// What a reader makes of a word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Treatment {
    Read,
    /// The word changes nothing of the poses, and the caller is told of it.
    LeftAlone,
    Refused,
}

impl Treatment {
    /// As pages of the documentation show it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Read => "read",
            Self::LeftAlone => "left alone",
            Self::Refused => "refused",
        }
    }
}

/// The words of one meaning.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Row {
    /// The words, divided by commas.
    pub words: &'static str,
    pub treatment: Treatment,
    /// Words beside it that belong to it, divided by blanks. A test of the table needs no more of them.
    pub takes: &'static str,
    /// A line with the first of the words.
    pub example: &'static str,
    /// What the reader does with the word, or what the caller has to do about it.
    pub says: &'static str,
}

impl Row {
    /// The words one by one.
    pub fn each(&self) -> impl Iterator<Item = &'static str> {
        self.words.split(", ")
    }

    /// Whether a word beside it belongs to it.
    pub fn takes(&self, word: &str) -> bool {
        self.takes.split(' ').any(|own| own == word)
    }
}

pub const fn read(
    words: &'static str,
    takes: &'static str,
    example: &'static str,
    says: &'static str,
) -> Row {
    Row { words, treatment: Treatment::Read, takes, example, says }
}

pub const fn left(
    words: &'static str,
    takes: &'static str,
    example: &'static str,
    says: &'static str,
) -> Row {
    Row { words, treatment: Treatment::LeftAlone, takes, example, says }
}

pub const fn refused(words: &'static str, example: &'static str, says: &'static str) -> Row {
    Row { words, treatment: Treatment::Refused, takes: "", example, says }
}

/// The rows of a table by their words.
pub fn by_word(tables: &[&'static [Row]]) -> HashMap<&'static str, &'static Row> {
    let rows = tables.iter().flat_map(|rows| rows.iter());
    rows.flat_map(|row| row.each().map(move |word| (word, row))).collect()
}
