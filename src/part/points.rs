//! Texts of points: one point a line, with or without headers, in the ways of writing that instruments and
//! spreadsheets have.
//!
//! # Method
//! The first line of numbers decides how the whole text is written: what separates the numbers, whether they
//! have a decimal comma, and how many there are. Lines before it are headers, which may name columns and the
//! unit. A line that is written otherwise is a fault with its number.
//!
//! # Cost
//! O(n) in the characters.

pub mod grid;
mod header;
mod neighbours;
mod writing;

use toolpathd_core::budget::Budget;

use super::fault::{Place, Unreadable};
use super::left_out::{LeftOut, LeftOuts};
use super::unit::Unit;
use header::Header;
pub use writing::Writing;

/// Lines between two looks at the budget.
const LINES_PER_CHECK: u32 = 4096;

/// The largest coordinate that counts as one, in any unit.
const LARGEST: f64 = 1e9;

/// The most columns.
const MOST_COLUMNS: usize = 64;

/// Points that were read, in the unit of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct PointText {
    /// x, y and z in `unit`, or in an unknown unit. z is 0 in a text of two columns.
    pub points: Vec<[f64; 3]>,
    /// The line of each point, from 1 on.
    pub lines: Vec<u32>,
    /// The unit that the headers state.
    pub unit: Option<Unit>,
    /// How the numbers are written.
    pub writing: Writing,
    /// How many columns the text has.
    pub n_columns: usize,
    /// The columns of x, y and z, from 0 on; z is absent in a text of two columns.
    pub columns: [Option<usize>; 3],
    /// Columns and points that were left out.
    pub left_out: Vec<LeftOut>,
}

/// Reads a text of at most `limit` points.
///
/// # Errors
/// The first line that is not a point, a text without points, or with too many; the budget's stop.
pub fn read(bytes: &[u8], limit: usize, budget: &Budget) -> Result<PointText, Unreadable> {
    let text = String::from_utf8_lossy(bytes);
    let mut lines = text.trim_start_matches('\u{feff}').lines().zip(1_u32..);
    let mut header = Header::default();
    let (first, number) = loop {
        let Some((line, number)) = lines.next() else {
            return Err(Unreadable::at(Place::File, "there is no line of numbers in it"));
        };
        if Writing::of(line).is_some() {
            break (line, number);
        }
        if writing::is_broken_point(line) {
            let detail = "some of its numbers are missing or broken: leave the line out";
            return Err(Unreadable::at(Place::Line(number.into()), detail));
        }
        header.add(line);
        if number.is_multiple_of(LINES_PER_CHECK) {
            budget.check()?;
        }
    };
    let writing = Writing::of(first).unwrap_or(Writing::BLANKS);
    let numbers = writing.numbers(first).unwrap_or_default();
    let n_columns = numbers.len();
    if !(2..=MOST_COLUMNS).contains(&n_columns) {
        let detail = format!("there are {n_columns} numbers; a point has two or three");
        return Err(Unreadable::at(Place::Line(number.into()), detail));
    }
    let mut rows =
        Rows { writing, is_decided: false, n_columns, values: Vec::new(), lines: Vec::new(), limit };
    rows.add(first, number)?;
    for (line, number) in lines {
        rows.add(line, number)?;
        if number.is_multiple_of(LINES_PER_CHECK) {
            budget.check()?;
        }
    }
    rows.points(&header)
}

/// The rows of numbers of a text.
struct Rows {
    writing: Writing,
    /// Whether a number has shown what a decimal sign is.
    is_decided: bool,
    n_columns: usize,
    /// All numbers, row after row.
    values: Vec<f64>,
    lines: Vec<u32>,
    limit: usize,
}

impl Rows {
    fn add(&mut self, line: &str, number: u32) -> Result<(), Unreadable> {
        let at = Place::Line(number.into());
        if line.trim().is_empty() || is_comment(line) {
            return Ok(());
        }
        let numbers = self.numbers(line).map_err(|detail| Unreadable::at(at, detail))?;
        if let Some(far) = numbers.iter().find(|value| value.abs() > LARGEST) {
            return Err(Unreadable::at(at, format!("{far:e} is no coordinate")));
        }
        if numbers.len() != self.n_columns {
            let detail =
                format!("there are {} numbers; the lines before have {}", numbers.len(), self.n_columns);
            return Err(Unreadable::at(at, detail));
        }
        if self.lines.len() == self.limit {
            return Err(Unreadable::at(at, format!("there are more than {} points", self.limit)));
        }
        self.values.extend(numbers);
        self.lines.push(number);
        Ok(())
    }

    /// The numbers of a line. As long as all numbers were whole, the decimal sign may still turn out to be a
    /// comma.
    fn numbers(&mut self, line: &str) -> Result<Vec<f64>, String> {
        let numbers = self.writing.numbers(line).or_else(|fault| {
            let with_comma = Writing { has_decimal_comma: true, ..self.writing };
            if self.is_decided || self.writing.separator == ',' {
                return Err(fault);
            }
            let numbers = with_comma.numbers(line).map_err(|_| fault)?;
            self.writing = with_comma;
            Ok(numbers)
        })?;
        self.is_decided |= line.contains(['.', ',']);
        Ok(numbers)
    }

    fn points(self, header: &Header) -> Result<PointText, Unreadable> {
        let Self { writing, n_columns, values, lines, .. } = self;
        let columns = header.columns(n_columns).unwrap_or_else(|| usual_columns(&values, n_columns));
        let of_row = |row: &[f64]| columns.map(|column| column.map_or(0.0, |column| row[column]));
        let points: Vec<[f64; 3]> = values.chunks_exact(n_columns).map(of_row).collect();
        let mut left_out = LeftOuts::default();
        for column in (0..n_columns).filter(|column| !columns.contains(&Some(*column))) {
            let name = header
                .name(column, n_columns)
                .map_or_else(|| format!("column {}", column + 1), str::to_owned);
            left_out.add(
                &name,
                "it is no coordinate",
                Place::Line(lines.first().copied().unwrap_or(1).into()),
            );
        }
        let unit = header.unit().map_err(|header::UnitsDiffer| {
            let detail = "its headers state several units of length; bring the columns to one";
            Unreadable::at(Place::File, detail)
        })?;
        let (points, lines) = without_doubles(points, lines, &mut left_out);
        Ok(PointText { points, lines, unit, writing, n_columns, columns, left_out: left_out.list() })
    }
}

/// Leaves out points that repeat the point before them.
fn without_doubles(
    points: Vec<[f64; 3]>,
    lines: Vec<u32>,
    left_out: &mut LeftOuts,
) -> (Vec<[f64; 3]>, Vec<u32>) {
    let (mut kept, mut kept_lines) = (Vec::with_capacity(points.len()), Vec::with_capacity(lines.len()));
    for (point, line) in points.into_iter().zip(lines) {
        if kept.last() == Some(&point) {
            left_out.add("point", "it repeats the point before it", Place::Line(line.into()));
        } else {
            kept.push(point);
            kept_lines.push(line);
        }
    }
    (kept, kept_lines)
}

/// Whether a line is a remark.
fn is_comment(line: &str) -> bool {
    let line = line.trim_start();
    ["#", "//", "!", "%"].iter().any(|mark| line.starts_with(mark))
}

/// The columns of a text without names: the first two or three, behind a column that counts the points.
fn usual_columns(values: &[f64], n_columns: usize) -> [Option<usize>; 3] {
    let is_counter = n_columns > 3 && values.len() > n_columns && {
        let mut column = values.chunks_exact(n_columns).map(|row| row[0]);
        let first = column.next().unwrap_or_default();
        column.zip(1..).all(|(value, k)| value == first + f64::from(k))
    };
    let first = usize::from(is_counter);
    [Some(first), Some(first + 1), (first + 2 < n_columns).then_some(first + 2)]
}

#[cfg(test)]
mod tests;
