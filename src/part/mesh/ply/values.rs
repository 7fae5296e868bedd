//! The values of elements, row after row.

use super::header::{Header, Kind, Number, Table};
use crate::fault::{Place, Unreadable};
use crate::mesh::bytes::Bytes;
use crate::mesh::words::Words;

/// The values behind a header.
#[derive(Clone)]
pub enum Values<'a> {
    Text(Words<'a>),
    Binary(Bytes<'a>),
}

impl<'a> Values<'a> {
    pub fn new(bytes: &'a [u8], header: &Header) -> Self {
        match header.order {
            None => Self::Text(Words::new(&bytes[header.end..], header.end_line)),
            Some(order) => Self::Binary(Bytes::new(bytes, header.end, order)),
        }
    }

    /// Reads one element, and gives each value to `take` with the number of its property and its place. The
    /// number of values of a list is not given. Returns the place of the element.
    ///
    /// # Errors
    /// When the values are broken, or the file ends; the errors of `take`.
    pub fn row(
        &mut self,
        element: &Table,
        mut take: impl FnMut(usize, f64, Place) -> Result<(), Unreadable>,
    ) -> Result<Place, Unreadable> {
        let mut row = Row { place: self.place(), is_begun: false, values: self };
        for (k, property) in element.properties.iter().enumerate() {
            match property.kind {
                Kind::Scalar(number) => {
                    let value = row.value(number)?;
                    take(k, value, row.values.place())?;
                }
                Kind::List(count, number) => {
                    for _ in 0..row.length(count)? {
                        let value = row.value(number)?;
                        take(k, value, row.values.place())?;
                    }
                }
            }
        }
        let place = row.place;
        self.end_row(element)?;
        Ok(place)
    }

    fn place(&self) -> Place {
        match self {
            Self::Text(words) => words.place(),
            Self::Binary(bytes) => bytes.place(),
        }
    }

    /// An element of a text has a line of its own.
    fn end_row(&self, element: &Table) -> Result<(), Unreadable> {
        match self {
            Self::Text(words) if !words.is_at_end_of_line() && !element.properties.is_empty() => {
                let detail = format!("the line has more values than the element {}", element.name);
                Err(Unreadable::at(words.place(), detail))
            }
            _ => Ok(()),
        }
    }

    /// The bytes that are left, and where they begin; `None` where only blanks are left.
    pub fn behind(&self) -> Option<(usize, Place)> {
        match self {
            Self::Text(words) => {
                let mut words = words.clone();
                let word = words.next()?;
                Some((word.len() + words.n_left(), words.place()))
            }
            Self::Binary(bytes) => (bytes.n_left() > 0).then(|| (bytes.n_left(), bytes.place())),
        }
    }
}

/// An element that is being read.
struct Row<'r, 'a> {
    /// The place of its first value.
    place: Place,
    is_begun: bool,
    values: &'r mut Values<'a>,
}

impl Row<'_, '_> {
    fn value(&mut self, number: Number) -> Result<f64, Unreadable> {
        let words = match self.values {
            Values::Text(words) => words,
            Values::Binary(bytes) => return binary(bytes, number),
        };
        let value = words.number()?;
        if !self.is_begun {
            self.is_begun = true;
            self.place = words.place();
        } else if words.place() != self.place {
            return Err(Unreadable::at(self.place, "the line has fewer values than its element"));
        }
        Ok(value)
    }

    /// The number of values of a list.
    fn length(&mut self, number: Number) -> Result<u64, Unreadable> {
        let length = self.value(number)?;
        if length >= 0.0 && length.fract() == 0.0 {
            return Ok(length as u64);
        }
        Err(Unreadable::at(self.values.place(), format!("a list cannot have {length} values")))
    }
}

fn binary(bytes: &mut Bytes, number: Number) -> Result<f64, Unreadable> {
    Ok(match number {
        Number::I8 => i8::from_le_bytes(bytes.little()?).into(),
        Number::U8 => u8::from_le_bytes(bytes.little()?).into(),
        Number::I16 => i16::from_le_bytes(bytes.little()?).into(),
        Number::U16 => bytes.u16()?.into(),
        Number::I32 => i32::from_le_bytes(bytes.little()?).into(),
        Number::U32 => bytes.u32()?.into(),
        Number::F32 => f32::from_le_bytes(bytes.little()?).into(),
        Number::F64 => f64::from_le_bytes(bytes.little()?),
    })
}
