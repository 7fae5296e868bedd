//! Instances by number, and their attributes by place and type.

use super::index::{Index, fault_at};
use super::text::{Cursor, Part, Value};
use crate::fault::{Place, Unreadable};

/// The bytes of a file with the places of its instances.
pub struct Source<'a> {
    pub bytes: &'a [u8],
    pub index: Index,
}

/// An instance with its values.
#[derive(Debug, Clone, PartialEq)]
pub struct Instance {
    pub number: u32,
    parts: Vec<Part>,
}

/// The attributes of an instance, or of one part of it.
#[derive(Debug, Clone, Copy)]
pub struct Attributes<'a> {
    number: u32,
    values: &'a [Value],
}

impl Source<'_> {
    /// # Errors
    /// There is no such instance, or its text breaks the grammar.
    pub fn get(&self, number: u32) -> Result<Instance, Unreadable> {
        let place = Place::Entity(u64::from(number));
        let Some(offset) = self.index.offset(number) else {
            return Err(Unreadable::at(place, "the file refers to this instance, but does not have it"));
        };
        let mut cursor = Cursor::new(self.bytes, offset);
        let parts = cursor
            .parts()
            .and_then(|parts| {
                cursor.skip_blank()?;
                cursor.expect(b';')?;
                Ok(parts)
            })
            .map_err(|fault| match fault_at(self.bytes, fault.offset, "") {
                Unreadable::Broken { place: line, .. } => {
                    Unreadable::at(place, format!("{} ({line})", fault.detail))
                }
                stopped @ Unreadable::Stopped(_) => stopped,
            })?;
        if parts.is_empty() {
            return Err(Unreadable::at(place, "the instance has no part"));
        }
        Ok(Instance { number, parts })
    }
}

impl Instance {
    pub fn place(&self) -> u64 {
        u64::from(self.number)
    }

    /// The name of the entity; of several parts, the names with spaces between.
    pub fn name(&self) -> String {
        self.parts.iter().map(|part| part.name.as_str()).collect::<Vec<_>>().join(" ")
    }

    /// The name of the first part.
    pub fn kind(&self) -> &str {
        &self.parts[0].name
    }

    pub fn is_complex(&self) -> bool {
        self.parts.len() > 1
    }

    pub fn has(&self, name: &str) -> bool {
        self.parts.iter().any(|part| part.name == name)
    }

    /// The attributes of the first part.
    pub fn attributes(&self) -> Attributes<'_> {
        Attributes { number: self.number, values: &self.parts[0].values }
    }

    /// The attributes of a part by its name.
    ///
    /// # Errors
    /// The instance has no such part.
    pub fn part(&self, name: &str) -> Result<Attributes<'_>, Unreadable> {
        match self.parts.iter().find(|part| part.name == name) {
            Some(part) => Ok(Attributes { number: self.number, values: &part.values }),
            None => Err(self.fault(format!("{name} is expected here, not {}", self.name()))),
        }
    }

    pub fn fault(&self, detail: impl Into<String>) -> Unreadable {
        Unreadable::at(Place::Entity(self.place()), detail)
    }
}

impl<'a> Attributes<'a> {
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// # Errors
    /// There are fewer attributes. The errors of the methods below: the attribute has another type.
    pub fn value(&self, k: usize) -> Result<&'a Value, Unreadable> {
        self.values.get(k).ok_or_else(|| {
            let detail = format!("attribute {} is missing: there are {}", k + 1, self.values.len());
            Unreadable::at(Place::Entity(u64::from(self.number)), detail)
        })
    }

    pub fn is_unset(&self, k: usize) -> bool {
        matches!(self.values.get(k), None | Some(Value::Unset | Value::Derived))
    }

    pub fn reference(&self, k: usize) -> Result<u32, Unreadable> {
        match self.value(k)? {
            Value::Reference(number) => Ok(*number),
            _ => Err(self.wrong(k, "a reference such as #1")),
        }
    }

    /// A reference, or `None` for `$` and `*`.
    pub fn optional_reference(&self, k: usize) -> Result<Option<u32>, Unreadable> {
        if self.is_unset(k) { Ok(None) } else { self.reference(k).map(Some) }
    }

    pub fn real(&self, k: usize) -> Result<f64, Unreadable> {
        real(self.value(k)?).ok_or_else(|| self.wrong(k, "a number"))
    }

    pub fn integer(&self, k: usize) -> Result<i64, Unreadable> {
        match self.value(k)? {
            Value::Integer(integer) => Ok(*integer),
            _ => Err(self.wrong(k, "an integer")),
        }
    }

    /// The truth of `.T.` and `.F.`.
    pub fn truth(&self, k: usize) -> Result<bool, Unreadable> {
        match self.value(k)? {
            Value::Enumeration(word) if word == "T" => Ok(true),
            Value::Enumeration(word) if word == "F" => Ok(false),
            _ => Err(self.wrong(k, ".T. or .F.")),
        }
    }

    /// A text; empty for `$` and for what is no text.
    pub fn text(&self, k: usize) -> String {
        match self.values.get(k) {
            Some(Value::Text(text)) => text.clone(),
            _ => String::new(),
        }
    }

    pub fn enumeration(&self, k: usize) -> Option<&'a str> {
        match self.values.get(k) {
            Some(Value::Enumeration(word)) => Some(word),
            _ => None,
        }
    }

    pub fn list(&self, k: usize) -> Result<&'a [Value], Unreadable> {
        match self.value(k)? {
            Value::List(values) => Ok(values),
            _ => Err(self.wrong(k, "a list")),
        }
    }

    pub fn references(&self, k: usize) -> Result<Vec<u32>, Unreadable> {
        self.numbers_of(k, self.list(k)?)
    }

    /// The rows of a list of lists of references.
    pub fn rows_of_references(&self, k: usize) -> Result<Vec<Vec<u32>>, Unreadable> {
        self.rows(k)?.into_iter().map(|row| self.numbers_of(k, row)).collect()
    }

    pub fn reals(&self, k: usize) -> Result<Vec<f64>, Unreadable> {
        self.reals_of(k, self.list(k)?)
    }

    pub fn rows_of_reals(&self, k: usize) -> Result<Vec<Vec<f64>>, Unreadable> {
        self.rows(k)?.into_iter().map(|row| self.reals_of(k, row)).collect()
    }

    pub fn integers(&self, k: usize) -> Result<Vec<i64>, Unreadable> {
        let integer = |value: &Value| match value {
            Value::Integer(integer) => Ok(*integer),
            _ => Err(self.wrong(k, "a list of integers")),
        };
        self.list(k)?.iter().map(integer).collect()
    }

    fn rows(&self, k: usize) -> Result<Vec<&'a [Value]>, Unreadable> {
        let row = |value: &'a Value| match value {
            Value::List(values) => Ok(values.as_slice()),
            _ => Err(self.wrong(k, "a list of lists")),
        };
        self.list(k)?.iter().map(row).collect()
    }

    fn numbers_of(&self, k: usize, values: &[Value]) -> Result<Vec<u32>, Unreadable> {
        let number = |value: &Value| match value {
            Value::Reference(number) => Ok(*number),
            _ => Err(self.wrong(k, "a list of references")),
        };
        values.iter().map(number).collect()
    }

    fn reals_of(&self, k: usize, values: &[Value]) -> Result<Vec<f64>, Unreadable> {
        values.iter().map(|value| real(value).ok_or_else(|| self.wrong(k, "a list of numbers"))).collect()
    }

    fn wrong(&self, k: usize, expected: &str) -> Unreadable {
        let detail = format!("attribute {} is not {expected}", k + 1);
        Unreadable::at(Place::Entity(u64::from(self.number)), detail)
    }
}

/// A number, with or without the name of its type.
fn real(value: &Value) -> Option<f64> {
    match value {
        Value::Real(real) => Some(*real),
        Value::Integer(integer) => Some(*integer as f64),
        Value::Typed(_, values) if values.len() == 1 => real(&values[0]),
        _ => None,
    }
}
