//! The lines before the first point: names of columns, and the unit.

use crate::unit::Unit;

/// The most lines of headers that are kept.
const MOST_LINES: usize = 1000;

/// Most characters of a line that are looked at.
const MOST_CHARACTERS: usize = 1000;

/// The lines before the first point.
#[derive(Debug, Default)]
pub struct Header {
    lines: Vec<String>,
}

/// Units that contradict each other.
#[derive(Debug, PartialEq, Eq)]
pub struct UnitsDiffer;

impl Header {
    pub fn add(&mut self, line: &str) {
        if !line.trim().is_empty() && self.lines.len() < MOST_LINES {
            self.lines.push(line.chars().take(MOST_CHARACTERS).collect());
        }
    }

    /// The name of a column.
    pub fn name(&self, column: usize, n_columns: usize) -> Option<&str> {
        let names = self.lines.iter().rev().map(|line| words(line)).find(|names| names.len() == n_columns)?;
        names.get(column).copied()
    }

    /// The columns of x, y and z by their names, in the last line that names each of `n_columns` columns.
    pub fn columns(&self, n_columns: usize) -> Option<[Option<usize>; 3]> {
        let of_line = |line: &String| {
            let names = words(line);
            let of = |axis: &str| names.iter().position(|name| axis_of(name) == axis);
            let found = ["x", "y", "z"].map(of);
            (names.len() == n_columns && found[0].is_some() && found[1].is_some()).then_some(found)
        };
        self.lines.iter().rev().find_map(of_line)
    }

    /// The unit that the lines state: as all that stands in brackets, behind `_` at the end of a name, or
    /// behind the word `unit`.
    ///
    /// # Errors
    /// When two units are stated.
    pub fn unit(&self) -> Result<Option<Unit>, UnitsDiffer> {
        let mut all = self.lines.iter().flat_map(|line| units_of(line));
        let Some(first) = all.next() else { return Ok(None) };
        if all.all(|unit| unit == first) { Ok(Some(first)) } else { Err(UnitsDiffer) }
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

/// The units that stand in a line.
fn units_of(line: &str) -> Vec<Unit> {
    let line = line.to_lowercase();
    let in_brackets = line.split(['[', '(']).skip(1).filter_map(|rest| rest.split([']', ')']).next());
    let in_brackets = in_brackets.filter_map(|text| named(text.trim().trim_start_matches("in ").trim()));
    let ends = |c: char| c.is_whitespace() || [';', ',', '"'].contains(&c);
    let behind_names = line.split(ends).filter_map(|word| named(word.rsplit_once('_')?.1));
    in_brackets.chain(behind_names).chain(behind_unit(&line)).collect()
}

/// The unit behind the word `unit`, `units` or `einheit`, such as `unit: mm`, `all units in mm`.
fn behind_unit(line: &str) -> Option<Unit> {
    let rest =
        ["units", "unit", "einheiten", "einheit"].iter().find_map(|word| Some(line.split_once(word)?.1))?;
    let rest = rest.trim_start_matches([' ', '\t', ':', '=', ';', ',', '[', '(', '"']);
    let mut rest = rest.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    let word = rest.next()?;
    // `in` stands before another unit, or is the unit itself.
    match rest.next().and_then(named) {
        Some(unit) if word == "in" || word == "are" || word == "is" => Some(unit),
        _ => named(word),
    }
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
