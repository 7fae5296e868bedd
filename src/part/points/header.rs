//! The lines before the first point: names of columns, and the unit.

use crate::unit::Unit;

/// The most lines of headers that are kept.
const MOST_LINES: usize = 100;

/// The lines before the first point.
#[derive(Debug, Default)]
pub struct Header {
    lines: Vec<String>,
}

impl Header {
    pub fn add(&mut self, line: &str) {
        if !line.trim().is_empty() && self.lines.len() < MOST_LINES {
            self.lines.push(line.chars().take(500).collect());
        }
    }

    /// The name of a column.
    pub fn name(&self, column: usize) -> Option<&str> {
        words(self.lines.last()?).get(column).copied()
    }

    /// The columns of x, y and z by their names, where the last line names each column of `n_columns`.
    pub fn columns(&self, n_columns: usize) -> Option<[Option<usize>; 3]> {
        let names = words(self.lines.last()?);
        let of = |axis: &str| names.iter().position(|name| axis_of(name) == axis);
        let found = ["x", "y", "z"].map(of);
        (names.len() == n_columns && found[0].is_some() && found[1].is_some()).then_some(found)
    }

    /// The unit that a line states: in brackets behind a name, or behind the word `unit`.
    pub fn unit(&self) -> Option<Unit> {
        self.lines.iter().find_map(|line| unit_of(line))
    }
}

/// The names of a line of names.
fn words(line: &str) -> Vec<&str> {
    let line = line.trim().trim_start_matches(['#', '%', '!', '/']).trim();
    let separator = [';', '\t', ','].into_iter().find(|separator| line.contains(*separator));
    match separator {
        Some(separator) => line.split(separator).map(|word| word.trim().trim_matches('"')).collect(),
        None => line.split_whitespace().filter(|word| !word.starts_with(['[', '('])).collect(),
    }
}

/// A name without its unit, in lower case: `X [mm]` and `x_mm` are `x`.
fn axis_of(name: &str) -> String {
    let name = name.to_lowercase();
    let end = name.find(['[', '(', ' ', '_', '/']).unwrap_or(name.len());
    name[..end].to_owned()
}

/// The unit that stands in a line.
fn unit_of(line: &str) -> Option<Unit> {
    let line = line.to_lowercase();
    let is_in_word = |c: char| c.is_alphanumeric();
    let speaks_of_unit = line.contains("unit") || line.contains("einheit");
    let mut rest = line.as_str();
    while let Some(start) = rest.find(is_in_word) {
        let before = rest[..start].chars().next_back();
        let word = &rest[start..];
        let (word, behind) = word.split_at(word.find(|c| !is_in_word(c)).unwrap_or(word.len()));
        let is_marked = before.is_some_and(|before| speaks_of_unit || "[(_/=".contains(before));
        if let Some(unit) = named(word).filter(|_| is_marked) {
            return Some(unit);
        }
        rest = behind;
    }
    None
}

fn named(word: &str) -> Option<Unit> {
    Some(match word {
        "µm" | "μm" | "um" | "micron" | "microns" | "micrometer" | "micrometre" => Unit::Micrometre,
        "mm" | "millimeter" | "millimetre" | "millimeters" | "millimetres" => Unit::Millimetre,
        "cm" | "centimeter" | "centimetre" => Unit::Centimetre,
        "m" | "meter" | "metre" | "meters" | "metres" => Unit::Metre,
        "in" | "inch" | "inches" => Unit::Inch,
        "ft" | "foot" | "feet" => Unit::Foot,
        _ => return None,
    })
}
