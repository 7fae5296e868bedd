//! The groups of a DXF file: a code, and a value whose type follows from the code. A file is a text with two
//! lines for each group, or binary.
//!
//! # Guarantees
//! Each group tells its line, or its byte in a binary file. Blanks around codes and numbers, and both ends of
//! lines, LF and CRLF, are accepted. A number has to be finite.

use std::str::from_utf8;

use crate::fault::{Place, Unreadable};

/// What a binary file starts with.
const SENTINEL: &[u8] = b"AutoCAD Binary DXF\r\n\x1a\0";

/// The byte before a code of two bytes, in binary files whose codes have one byte.
const LONG_CODE: u8 = 255;

/// The code of comments.
const COMMENT: i32 = 999;

/// The most characters of a value that an error quotes.
const QUOTED: usize = 24;

/// One group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Group<'a> {
    pub code: i32,
    pub value: Value<'a>,
    pub place: Place,
}

/// A value, as the file has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Value<'a> {
    /// A text, and every value of a file that is a text.
    Text(&'a [u8]),
    Real(f64),
    Integer(i64),
}

impl<'a> Group<'a> {
    /// # Errors
    /// When the value is not a finite number.
    pub fn real(&self) -> Result<f64, Unreadable> {
        let number = match self.value {
            Value::Real(number) => Some(number),
            Value::Integer(number) => Some(number as f64),
            Value::Text(text) => from_utf8(text).ok().and_then(|text| text.trim().parse().ok()),
        };
        number.filter(|number: &f64| number.is_finite()).ok_or_else(|| self.fault("a number"))
    }

    /// # Errors
    /// When the value is not a whole number.
    pub fn integer(&self) -> Result<i64, Unreadable> {
        if let Value::Integer(number) = self.value {
            return Ok(number);
        }
        if let Value::Text(text) = self.value
            && let Some(number) = from_utf8(text).ok().and_then(|text| text.trim().parse().ok())
        {
            return Ok(number);
        }
        let number = self.real()?;
        let is_whole = number.fract() == 0.0 && number.abs() < 1e15;
        if is_whole { Ok(number as i64) } else { Err(self.fault("a whole number")) }
    }

    /// The bytes of a text without blanks around it; empty for a number of a binary file.
    pub fn text(&self) -> &'a [u8] {
        if let Value::Text(text) = self.value { text.trim_ascii() } else { b"" }
    }

    /// Whether the group is this code with this text.
    pub fn is(&self, code: i32, text: &str) -> bool {
        self.code == code && self.text().eq_ignore_ascii_case(text.as_bytes())
    }

    fn fault(&self, expected: &str) -> Unreadable {
        let found = match self.value {
            Value::Text(text) => quoted(text),
            Value::Real(number) => number.to_string(),
            Value::Integer(number) => number.to_string(),
        };
        Unreadable::at(self.place, format!("group {} is \"{found}\" instead of {expected}", self.code))
    }
}

/// The first characters of a value, for an error.
fn quoted(text: &[u8]) -> String {
    String::from_utf8_lossy(text.trim_ascii()).chars().take(QUOTED).collect()
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    Text,
    /// With codes of one byte, until release 12.
    ShortCodes,
    /// With codes of two bytes.
    LongCodes,
}

/// Reads one group after the other.
#[derive(Debug, Clone)]
pub struct Groups<'a> {
    bytes: &'a [u8],
    at: usize,
    /// The number of lines before `at`.
    line: u64,
    form: Form,
}

impl<'a> Groups<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        let Some(groups) = bytes.strip_prefix(SENTINEL) else {
            let mark = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
            return Self { bytes, at: mark, line: 0, form: Form::Text };
        };
        // The first group is 0, the start of a section, or a comment. The second byte of a code of two bytes
        // is at most 3.
        let is_long = matches!(groups, [first, 0..=3, ..] if *first != LONG_CODE);
        let form = if is_long { Form::LongCodes } else { Form::ShortCodes };
        Self { bytes, at: SENTINEL.len(), line: 0, form }
    }

    /// The next group that is no comment; `None` at the end of the file.
    ///
    /// # Errors
    /// When the file ends within a group, or a code is not a number or has no type.
    pub fn next(&mut self) -> Result<Option<Group<'a>>, Unreadable> {
        loop {
            let group = if self.form == Form::Text { self.next_of_text()? } else { self.next_of_binary()? };
            if group.is_none_or(|group| group.code != COMMENT) {
                return Ok(group);
            }
        }
    }

    /// Where the next group is.
    pub fn place(&self) -> Place {
        match self.form {
            Form::Text => Place::Line(self.line + 1),
            _ => Place::Byte(self.at as u64),
        }
    }

    /// The bytes that are not read.
    pub fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }

    fn next_of_text(&mut self) -> Result<Option<Group<'a>>, Unreadable> {
        let place = self.place();
        let Some(code) = self.take_line() else { return Ok(None) };
        if is_blank(code) && is_blank(self.rest()) {
            return Ok(None);
        }
        let number = from_utf8(code).ok().and_then(|code| code.trim().parse::<i32>().ok());
        let Some(code) = number else {
            let detail = format!("\"{}\" stands where a group code is expected", quoted(code));
            return Err(Unreadable::at(place, detail));
        };
        let place = self.place();
        match self.take_line() {
            Some(value) => Ok(Some(Group { code, value: Value::Text(value), place })),
            None => Err(Unreadable::at(place, format!("the file ends after the group code {code}"))),
        }
    }

    fn take_line(&mut self) -> Option<&'a [u8]> {
        let rest = self.rest();
        if rest.is_empty() {
            return None;
        }
        let end = rest.iter().position(|byte| *byte == b'\n').unwrap_or(rest.len());
        self.at += (end + 1).min(rest.len());
        self.line += 1;
        let line = &rest[..end];
        Some(line.strip_suffix(b"\r").unwrap_or(line))
    }

    fn next_of_binary(&mut self) -> Result<Option<Group<'a>>, Unreadable> {
        let start = self.at;
        if self.rest().is_empty() {
            return Ok(None);
        }
        let is_short = self.form == Form::ShortCodes && self.rest()[0] != LONG_CODE;
        let code = if is_short {
            i32::from(self.take::<1>()?[0])
        } else {
            if self.form == Form::ShortCodes {
                self.at += 1;
            }
            i32::from(u16::from_le_bytes(self.take()?))
        };
        let value = match kind_of(code) {
            Some(Kind::Text) => Value::Text(self.take_text()?),
            Some(Kind::Real) => Value::Real(f64::from_le_bytes(self.take()?)),
            Some(Kind::Byte) => Value::Integer(i64::from(self.take::<1>()?[0])),
            Some(Kind::Short) => Value::Integer(i64::from(i16::from_le_bytes(self.take()?))),
            Some(Kind::Long) => Value::Integer(i64::from(i32::from_le_bytes(self.take()?))),
            Some(Kind::Wide) => Value::Integer(i64::from_le_bytes(self.take()?)),
            Some(Kind::Bytes) => {
                let count = self.take::<1>()?[0];
                self.skip(usize::from(count))?;
                Value::Text(b"")
            }
            None => {
                let detail = format!("there is no group code {code}");
                return Err(Unreadable::at(Place::Byte(start as u64), detail));
            }
        };
        Ok(Some(Group { code, value, place: Place::Byte(start as u64) }))
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], Unreadable> {
        let bytes = self.rest().first_chunk::<N>().copied().ok_or_else(|| self.cut_off())?;
        self.at += N;
        Ok(bytes)
    }

    fn skip(&mut self, count: usize) -> Result<(), Unreadable> {
        if self.rest().len() < count {
            return Err(self.cut_off());
        }
        self.at += count;
        Ok(())
    }

    fn take_text(&mut self) -> Result<&'a [u8], Unreadable> {
        let rest = self.rest();
        let end = rest.iter().position(|byte| *byte == 0).ok_or_else(|| self.cut_off())?;
        self.at += end + 1;
        Ok(&rest[..end])
    }

    fn cut_off(&self) -> Unreadable {
        Unreadable::at(Place::Byte(self.at as u64), "the file ends within a group")
    }
}

/// Whether bytes hold nothing but blanks, zeros and the mark of the end of old files.
pub fn is_blank(bytes: &[u8]) -> bool {
    bytes.iter().all(|byte| byte.is_ascii_whitespace() || matches!(byte, 0 | 0x1a))
}

/// The types of values in binary files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Ends with a zero.
    Text,
    Real,
    Byte,
    Short,
    Long,
    Wide,
    /// Their number, and the bytes.
    Bytes,
}

/// The type of the values of a code; `None` if no value has this code.
fn kind_of(code: i32) -> Option<Kind> {
    Some(match code {
        0..=9 | 100..=109 | 300..=309 | 320..=369 | 390..=399 | 410..=419 | 430..=439 | 470..=481 => {
            Kind::Text
        }
        999 | 1000..=1003 | 1005..=1009 => Kind::Text,
        10..=59 | 110..=149 | 210..=239 | 460..=469 | 1010..=1059 => Kind::Real,
        60..=79 | 170..=179 | 270..=289 | 370..=389 | 400..=409 | 1060..=1070 => Kind::Short,
        90..=99 | 420..=429 | 440..=459 | 1071 => Kind::Long,
        160..=169 => Kind::Wide,
        290..=299 => Kind::Byte,
        310..=319 | 1004 => Kind::Bytes,
        _ => return None,
    })
}
