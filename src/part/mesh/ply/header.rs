//! The header of a PLY file.

use crate::fault::{Place, Unreadable};
use crate::mesh::bytes::Order;
use crate::mesh::words::shown;

/// Most elements with their properties in a header.
const MOST_LINES: usize = 1000;

/// The header of a PLY file.
pub struct Header {
    /// The order of bytes; `None` in a text.
    pub order: Option<Order>,
    pub elements: Vec<Table>,
    /// The byte behind the header.
    pub end: usize,
    /// The line behind the header, counted from 1.
    pub end_line: u64,
}

/// Elements of one kind, such as vertices; each has one row of values.
pub struct Table {
    pub name: String,
    /// How many the header states.
    pub count: u64,
    pub properties: Vec<Property>,
    pub place: Place,
}

/// What each element of a kind holds.
pub struct Property {
    pub name: String,
    pub kind: Kind,
    pub place: Place,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Scalar(Number),
    /// The number of values, and the values.
    List(Number, Number),
}

/// A kind of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Header {
    /// # Errors
    /// When the file begins with no header of PLY.
    pub fn of(bytes: &[u8]) -> Result<Self, Unreadable> {
        let mut lines = Lines::new(bytes);
        let (first, place) = lines.next()?;
        if first != b"ply" {
            return Err(Unreadable::at(place, "a PLY file begins with a line \"ply\""));
        }
        let mut order = None;
        let mut elements: Vec<Table> = Vec::new();
        let mut n_lines = 0;
        loop {
            let (line, place) = lines.next()?;
            let text = String::from_utf8_lossy(line);
            let words: Vec<&str> = text.split_ascii_whitespace().collect();
            match words[..] {
                [] | ["comment" | "obj_info", ..] => continue,
                ["format", name, "1.0"] => order = Some(order_of(name, place)?),
                ["element", name, count] => elements.push(element(name, count, &elements, place)?),
                ["property", ..] => {
                    let fault = || Unreadable::at(place, "a property stands before the first element");
                    let property = property(&words, place)?;
                    elements.last_mut().ok_or_else(fault)?.properties.push(property);
                }
                ["end_header"] => break,
                _ => {
                    let detail = format!("{} is no line of a header of PLY 1.0", shown(line));
                    return Err(Unreadable::at(place, detail));
                }
            }
            n_lines += 1;
            if n_lines > MOST_LINES {
                return Err(Unreadable::at(place, format!("the header has more than {MOST_LINES} lines")));
            }
        }
        let order = order.ok_or_else(|| Unreadable::at(Place::File, "its header states no format"))?;
        Ok(Self { order, elements, end: lines.at, end_line: lines.line + 1 })
    }
}

/// The lines of a header. They end as the first does: with LF, CR LF or CR.
struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
    line: u64,
    end: &'static [u8],
}

impl<'a> Lines<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        let first = bytes.iter().position(|byte| [b'\n', b'\r'].contains(byte)).unwrap_or(bytes.len());
        let ends: [&[u8]; 3] = [b"\r\n", b"\r", b"\n"];
        let end = ends.into_iter().find(|end| bytes[first..].starts_with(end)).unwrap_or(b"\n");
        Self { bytes, at: 0, line: 0, end }
    }

    fn next(&mut self) -> Result<(&'a [u8], Place), Unreadable> {
        self.line += 1;
        let place = Place::Line(self.line);
        let rest = &self.bytes[self.at..];
        let end = rest.windows(self.end.len()).position(|bytes| bytes == self.end);
        let end = end.ok_or_else(|| Unreadable::at(place, "the file ends within its header"))?;
        self.at += end + self.end.len();
        Ok((rest[..end].trim_ascii(), place))
    }
}

/// The order of bytes of a format; `None` of a text.
fn order_of(name: &str, place: Place) -> Result<Option<Order>, Unreadable> {
    match name {
        "ascii" => Ok(None),
        "binary_little_endian" => Ok(Some(Order::LittleEndian)),
        "binary_big_endian" => Ok(Some(Order::BigEndian)),
        name => Err(Unreadable::at(place, format!("{} is no format of PLY", shown(name.as_bytes())))),
    }
}

fn element(name: &str, count: &str, before: &[Table], place: Place) -> Result<Table, Unreadable> {
    if before.iter().any(|element| element.name == name) {
        return Err(Unreadable::at(place, format!("the element {} stands twice", shown(name.as_bytes()))));
    }
    let count = count.parse().map_err(|_| {
        Unreadable::at(place, format!("{} is no number of elements", shown(count.as_bytes())))
    })?;
    Ok(Table { name: name.to_owned(), count, properties: Vec::new(), place })
}

fn property(words: &[&str], place: Place) -> Result<Property, Unreadable> {
    let number = |name: &str| {
        number(name)
            .ok_or_else(|| Unreadable::at(place, format!("{} is no type of PLY", shown(name.as_bytes()))))
    };
    let (kind, name) = match words[1..] {
        ["list", count, values, name] => (Kind::List(number(count)?, number(values)?), name),
        [kind, name] => (Kind::Scalar(number(kind)?), name),
        _ => return Err(Unreadable::at(place, "a property has a type and a name")),
    };
    Ok(Property { name: name.to_owned(), kind, place })
}

fn number(name: &str) -> Option<Number> {
    Some(match name {
        "char" | "int8" => Number::I8,
        "uchar" | "uint8" => Number::U8,
        "short" | "int16" => Number::I16,
        "ushort" | "uint16" => Number::U16,
        "int" | "int32" => Number::I32,
        "uint" | "uint32" => Number::U32,
        "float" | "float32" => Number::F32,
        "double" | "float64" => Number::F64,
        _ => return None,
    })
}

impl Table {
    /// The place of a property with one value.
    pub fn scalar(&self, name: &str) -> Result<usize, Unreadable> {
        let is = |property: &Property| property.name == name && matches!(property.kind, Kind::Scalar(_));
        self.properties.iter().position(is).ok_or_else(|| self.lacks(name))
    }

    /// The place of a list with one of these names.
    pub fn list(&self, names: &[&str]) -> Result<usize, Unreadable> {
        let is = |property: &Property| {
            names.contains(&property.name.as_str()) && matches!(property.kind, Kind::List(..))
        };
        self.properties.iter().position(is).ok_or_else(|| self.lacks(names[0]))
    }

    fn lacks(&self, name: &str) -> Unreadable {
        Unreadable::at(self.place, format!("the element {} has no property {name}", self.name))
    }
}
