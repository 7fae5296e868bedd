//! Where the instances of a file are: one pass over the bytes, which parses no values.
//!
//! # Cost
//! 8 bytes for each instance, and the numbers of the instances that shapes begin with.

use toolpathd_core::budget::Budget;

use super::text::{Cursor, Fault, end_of_blank, end_of_comment, end_of_quotes};
use crate::fault::{Place, Unreadable};

/// The most instances of a file. A file of 200 MB has 4 million.
const MOST_INSTANCES: usize = 50_000_000;

/// How many statements lie between two checks of the budget.
const STATEMENTS_BETWEEN_CHECKS: usize = 4096;

/// The instances of a file.
#[derive(Debug, Default)]
pub struct Index {
    /// Number and offset of the text behind the equals sign, by growing number.
    instances: Vec<(u32, u32)>,
    /// Instances with several parts that are representations or relate them.
    pub complex: Vec<u32>,
    /// Instances with one part that [`is_root`] tells of, by the order in the file, with its name.
    pub roots: Vec<(u32, String)>,
    /// The name of the schema that the header states.
    pub schema: String,
}

impl Index {
    /// The offset of the text of an instance.
    pub fn offset(&self, number: u32) -> Option<usize> {
        let k = self.instances.binary_search_by_key(&number, |(number, _)| *number).ok()?;
        Some(self.instances[k].1 as usize)
    }

    /// # Errors
    /// The file is no STEP file, is cut off, or breaks the grammar.
    pub fn of(bytes: &[u8], budget: &Budget) -> Result<Self, Unreadable> {
        if bytes.len() >= u32::MAX as usize {
            return Err(Unreadable::at(Place::File, "the file is larger than 4 GB"));
        }
        let start = if bytes.starts_with(b"\xEF\xBB\xBF") { 3 } else { 0 };
        let start = end_of_blank(bytes, start).unwrap_or(start);
        if !bytes[start..].starts_with(b"ISO-10303-21") {
            let detail = "the file does not begin with ISO-10303-21, so it is no STEP file";
            return Err(Unreadable::at(Place::Line(1), detail));
        }
        let mut index = Self::default();
        index.scan(bytes, start, budget)?;
        index.order()?;
        Ok(index)
    }

    /// Reads statements until the end of the file.
    fn scan(&mut self, bytes: &[u8], start: usize, budget: &Budget) -> Result<(), Unreadable> {
        let mut at = start;
        let mut is_data = false;
        let mut n_statements = 0usize;
        loop {
            n_statements += 1;
            if n_statements.is_multiple_of(STATEMENTS_BETWEEN_CHECKS) {
                budget.check()?;
            }
            at = end_of_blank(bytes, at).ok_or_else(|| fault_at(bytes, at, "a comment has no end"))?;
            let rest = bytes.get(at..).unwrap_or_default();
            if rest.is_empty() {
                return Err(fault_at(bytes, at, "the file ends before END-ISO-10303-21: it is cut off"));
            }
            if is_data && rest[0] == b'#' {
                at = self.instance(bytes, at)?;
                continue;
            }
            if rest.starts_with(b"END-ISO-10303-21") {
                return Ok(());
            }
            if rest.starts_with(b"DATA") {
                is_data = true;
            } else if rest.starts_with(b"ENDSEC") {
                is_data = false;
            } else if is_data {
                return Err(fault_at(bytes, at, "an instance such as #1=... is missing"));
            } else if rest.starts_with(b"FILE_SCHEMA") {
                self.schema = first_text(bytes, at);
            }
            at = end_of_statement(bytes, at)
                .ok_or_else(|| fault_at(bytes, at, "a statement has no end: the file is cut off"))?;
        }
    }

    /// Enters the instance at `at`, and returns the place after it.
    fn instance(&mut self, bytes: &[u8], at: usize) -> Result<usize, Unreadable> {
        let mut cursor = Cursor::new(bytes, at + 1);
        let mut head = || -> Result<u32, Fault> {
            let number = cursor.instance_number()?;
            cursor.skip_blank()?;
            cursor.expect(b'=')?;
            cursor.skip_blank()?;
            Ok(number)
        };
        let number = head().map_err(|fault| fault_at(bytes, fault.offset, &fault.detail))?;
        let body = cursor.at();
        if self.instances.len() == MOST_INSTANCES {
            return Err(fault_at(bytes, at, &format!("there are more than {MOST_INSTANCES} instances")));
        }
        self.instances.push((number, body as u32));
        let end = end_of_statement(bytes, body).ok_or_else(|| {
            let detail = "the instance has no end: the file is cut off";
            Unreadable::at(Place::Entity(u64::from(number)), detail)
        })?;
        let statement = &bytes[body..end];
        if statement[0] == b'(' {
            if relates(statement) {
                self.complex.push(number);
            }
        } else {
            let length = statement.iter().take_while(|b| b.is_ascii_alphanumeric() || **b == b'_').count();
            let name = &statement[..length];
            if is_root(name) {
                self.roots.push((number, String::from_utf8_lossy(name).into_owned()));
            }
        }
        Ok(end)
    }

    /// Puts the instances in the order of their numbers.
    fn order(&mut self) -> Result<(), Unreadable> {
        if !self.instances.is_sorted() {
            self.instances.sort_unstable();
        }
        match self.instances.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            Some(pair) => {
                let place = Place::Entity(u64::from(pair[0].0));
                Err(Unreadable::at(place, "two instances have this number"))
            }
            None => Ok(()),
        }
    }
}

/// Whether instances of this name are where the reading of shapes begins.
fn is_root(name: &[u8]) -> bool {
    name.ends_with(b"SHAPE_REPRESENTATION")
        || matches!(
            name,
            b"SHAPE_DEFINITION_REPRESENTATION"
                | b"SHAPE_REPRESENTATION_WITH_PARAMETERS"
                | b"SHAPE_REPRESENTATION_RELATIONSHIP"
                | b"REPRESENTATION_RELATIONSHIP"
                | b"REPRESENTATION"
                | b"NEXT_ASSEMBLY_USAGE_OCCURRENCE"
                | b"MANIFOLD_SOLID_BREP"
                | b"BREP_WITH_VOIDS"
                | b"FACETED_BREP"
                | b"SHELL_BASED_SURFACE_MODEL"
                | b"FACE_BASED_SURFACE_MODEL"
        )
}

/// Whether an instance of several parts is a representation of a shape, or relates representations.
fn relates(statement: &[u8]) -> bool {
    let words = statement.split(|byte| !byte.is_ascii_alphanumeric() && *byte != b'_');
    let mut words = words.filter(|word| word.first().is_some_and(u8::is_ascii_alphabetic));
    words.any(|word| word == b"SHAPE_REPRESENTATION" || word == b"REPRESENTATION_RELATIONSHIP")
}

/// A fault at a byte, told by its line.
pub fn fault_at(bytes: &[u8], offset: usize, detail: &str) -> Unreadable {
    let before = &bytes[..offset.min(bytes.len())];
    let line = 1 + before.iter().filter(|byte| **byte == b'\n').count() as u64;
    Unreadable::at(Place::Line(line), detail)
}

/// The place after the semicolon that ends the statement at `at`.
fn end_of_statement(bytes: &[u8], mut at: usize) -> Option<usize> {
    loop {
        at += bytes.get(at..)?.iter().position(|byte| matches!(byte, b';' | b'\'' | b'"' | b'/'))?;
        at = match bytes[at] {
            b';' => return Some(at + 1),
            b'/' if bytes.get(at + 1) == Some(&b'*') => end_of_comment(bytes, at)?,
            b'/' => at + 1,
            _ => end_of_quotes(bytes, at)?,
        };
    }
}

/// The first text between quotes in the statement at `at`.
fn first_text(bytes: &[u8], at: usize) -> String {
    let end = end_of_statement(bytes, at).unwrap_or(at);
    let statement = &bytes[at..end];
    let Some(start) = statement.iter().position(|byte| *byte == b'\'') else { return String::new() };
    let end = end_of_quotes(statement, start).unwrap_or(statement.len());
    super::string::decode(&statement[start + 1..end - 1])
}
