//! The words of NC programs: G codes, M codes, and the letters and names beside them.

mod g_codes;
mod m_codes;
mod names;

use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::LazyLock;

use super::super::table::{Row, by_word};
use super::super::tokens::Word;

/// The tables of the words, in the order in which pages show them.
pub const TABLES: &[(&str, &[Row])] =
    &[("G codes", g_codes::G_CODES), ("M codes", m_codes::M_CODES), ("other words", names::NAMES)];

static ROWS: LazyLock<HashMap<&'static str, &'static Row>> =
    LazyLock::new(|| by_word(&[g_codes::G_CODES, m_codes::M_CODES, names::NAMES]));

/// The row of a word by its name in the tables.
pub fn row_of(name: &str) -> Option<&'static Row> {
    ROWS.get(name).copied()
}

/// The name of a word in the tables: `G43.4` for a code, `X` for a letter with a number, `CYCLE832` or
/// `TRAORI` for other words.
pub fn name_of<'a>(word: &'a Word<'_>) -> Cow<'a, str> {
    let value = match (word.name.as_ref(), word.value) {
        ("G" | "M", Some(value)) => value,
        (name, Some(value)) if name.len() > 1 => value,
        (name, _) => return Cow::Borrowed(name),
    };
    let full = format!("{}{value}", word.name);
    if word.name.len() == 1 || ROWS.contains_key(full.as_str()) {
        Cow::Owned(full)
    } else {
        Cow::Borrowed(&word.name)
    }
}
