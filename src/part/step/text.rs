//! The text of ISO 10303-21: values of one instance, from its bytes.
//!
//! # Guarantees
//! A list is nested at most [`DEEPEST`] deep, and an instance has at most [`MOST_VALUES`] values. A number
//! that is not finite is a fault.

use super::string::decode;

/// The deepest nesting of lists and typed values. Schemas of products nest 4 deep; a reader without a limit
/// would run out of stack.
pub const DEEPEST: usize = 16;

/// The most values of one instance. A net of 1000 by 1000 control points has half of these.
pub const MOST_VALUES: usize = 2_000_000;

/// A value of an attribute.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// `$`: no value.
    Unset,
    /// `*`: the value follows from others.
    Derived,
    Integer(i64),
    Real(f64),
    Text(String),
    /// A word between dots, without the dots.
    Enumeration(String),
    /// `"0FF"`: bits, which no attribute of a shape has.
    Binary,
    Reference(u32),
    /// A value with the name of its type, such as `LENGTH_MEASURE(1.)`.
    Typed(String, Vec<Value>),
    List(Vec<Value>),
}

/// A part of an instance: the name of an entity with the values of its attributes.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    pub name: String,
    pub values: Vec<Value>,
}

/// A fault in a text: the offset of the byte and what is wrong there.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    pub offset: usize,
    pub detail: String,
}

/// A place in the bytes of a file.
pub struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    n_values: usize,
}

impl<'a> Cursor<'a> {
    pub fn new(bytes: &'a [u8], at: usize) -> Self {
        Self { bytes, at, n_values: 0 }
    }

    /// The parts of the instance at the cursor: one, or several between brackets.
    ///
    /// # Errors
    /// A [`Fault`] where the text breaks the grammar.
    pub fn parts(&mut self) -> Result<Vec<Part>, Fault> {
        self.skip_blank()?;
        if self.peek() != Some(b'(') {
            return Ok(vec![self.part()?]);
        }
        self.at += 1;
        let mut parts = Vec::new();
        loop {
            self.skip_blank()?;
            if self.peek() == Some(b')') {
                self.at += 1;
                return Ok(parts);
            }
            parts.push(self.part()?);
        }
    }

    /// A name with its values.
    fn part(&mut self) -> Result<Part, Fault> {
        let name = self.word()?;
        self.skip_blank()?;
        self.expect(b'(')?;
        Ok(Part { name, values: self.list(1)? })
    }

    /// The values up to the closing bracket, after the opening bracket.
    fn list(&mut self, depth: usize) -> Result<Vec<Value>, Fault> {
        if depth > DEEPEST {
            return Err(self.fault(format!("lists are nested more than {DEEPEST} deep")));
        }
        let mut values = Vec::new();
        self.skip_blank()?;
        if self.peek() == Some(b')') {
            self.at += 1;
            return Ok(values);
        }
        loop {
            self.n_values += 1;
            if self.n_values > MOST_VALUES {
                return Err(self.fault(format!("the instance has more than {MOST_VALUES} values")));
            }
            values.push(self.value(depth)?);
            self.skip_blank()?;
            match self.next() {
                Some(b',') => self.skip_blank()?,
                Some(b')') => return Ok(values),
                _ => return Err(self.fault("a comma or a closing bracket is missing")),
            }
        }
    }

    fn value(&mut self, depth: usize) -> Result<Value, Fault> {
        match self.peek() {
            Some(b'$') => {
                self.at += 1;
                Ok(Value::Unset)
            }
            Some(b'*') => {
                self.at += 1;
                Ok(Value::Derived)
            }
            Some(b'#') => {
                self.at += 1;
                Ok(Value::Reference(self.instance_number()?))
            }
            Some(b'(') => {
                self.at += 1;
                Ok(Value::List(self.list(depth + 1)?))
            }
            Some(b'\'') => self.text(),
            Some(b'"') => self.binary(),
            // Some writers leave out the digit before the point.
            Some(b'.') if !self.bytes.get(self.at + 1).is_some_and(u8::is_ascii_digit) => self.enumeration(),
            Some(b'0'..=b'9' | b'+' | b'-' | b'.') => self.number(),
            Some(byte) if byte.is_ascii_alphabetic() || byte == b'_' || byte == b'!' => {
                let Part { name, values } = self.typed(depth)?;
                Ok(Value::Typed(name, values))
            }
            _ => Err(self.fault("a value is missing")),
        }
    }

    fn typed(&mut self, depth: usize) -> Result<Part, Fault> {
        let name = self.word()?;
        self.skip_blank()?;
        self.expect(b'(')?;
        Ok(Part { name, values: self.list(depth + 1)? })
    }

    /// A name of letters, digits and underscores, in capitals.
    pub fn word(&mut self) -> Result<String, Fault> {
        let start = self.at;
        while self.peek().is_some_and(|byte| byte.is_ascii_alphanumeric() || b"_!-".contains(&byte)) {
            self.at += 1;
        }
        if start == self.at {
            return Err(self.fault("a name is missing"));
        }
        Ok(String::from_utf8_lossy(&self.bytes[start..self.at]).to_ascii_uppercase())
    }

    /// The digits after `#`.
    pub fn instance_number(&mut self) -> Result<u32, Fault> {
        let start = self.at;
        let mut number = Some(0u32);
        while let Some(byte @ b'0'..=b'9') = self.peek() {
            number = number.and_then(|n| n.checked_mul(10)?.checked_add(u32::from(byte - b'0')));
            self.at += 1;
        }
        match number {
            Some(number) if self.at > start => Ok(number),
            Some(_) => Err(self.fault("the number of an instance is missing")),
            None => Err(self.fault(format!("the number of an instance is above {}", u32::MAX))),
        }
    }

    fn number(&mut self) -> Result<Value, Fault> {
        let start = self.at;
        self.at += 1;
        while self.peek().is_some_and(|byte| byte.is_ascii_digit() || b"+-.eE".contains(&byte)) {
            self.at += 1;
        }
        let text = std::str::from_utf8(&self.bytes[start..self.at]).unwrap_or_default();
        if let Ok(integer) = text.parse::<i64>() {
            return Ok(Value::Integer(integer));
        }
        match text.parse::<f64>() {
            Ok(real) if real.is_finite() => Ok(Value::Real(real)),
            _ => Err(Fault { offset: start, detail: "a number is not readable or not finite".to_owned() }),
        }
    }

    fn text(&mut self) -> Result<Value, Fault> {
        let start = self.at + 1;
        let end = end_of_quotes(self.bytes, self.at).ok_or_else(|| self.fault("a text has no end"))?;
        self.at = end;
        Ok(Value::Text(decode(&self.bytes[start..end - 1])))
    }

    fn binary(&mut self) -> Result<Value, Fault> {
        self.at = end_of_quotes(self.bytes, self.at).ok_or_else(|| self.fault("a binary has no end"))?;
        Ok(Value::Binary)
    }

    fn enumeration(&mut self) -> Result<Value, Fault> {
        self.at += 1;
        let word = self.word()?;
        self.expect(b'.')?;
        Ok(Value::Enumeration(word))
    }

    /// Skips blanks and comments.
    pub fn skip_blank(&mut self) -> Result<(), Fault> {
        self.at = end_of_blank(self.bytes, self.at).ok_or_else(|| self.fault("a comment has no end"))?;
        Ok(())
    }

    pub fn expect(&mut self, byte: u8) -> Result<(), Fault> {
        if self.peek() == Some(byte) {
            self.at += 1;
            return Ok(());
        }
        Err(self.fault(format!("{:?} is missing", char::from(byte))))
    }

    pub fn at(&self) -> usize {
        self.at
    }

    fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    fn next(&mut self) -> Option<u8> {
        let byte = self.peek();
        self.at += 1;
        byte
    }

    fn fault(&self, detail: impl Into<String>) -> Fault {
        Fault { offset: self.at.min(self.bytes.len()), detail: detail.into() }
    }
}

/// The place after blanks and comments from `at` on. `None` if a comment has no end.
pub fn end_of_blank(bytes: &[u8], mut at: usize) -> Option<usize> {
    loop {
        while bytes.get(at).is_some_and(|byte| byte.is_ascii_whitespace() || *byte == 0) {
            at += 1;
        }
        if bytes.get(at..at + 2) != Some(b"/*") {
            return Some(at);
        }
        at = end_of_comment(bytes, at)?;
    }
}

/// The place after the comment that begins at `at`.
pub fn end_of_comment(bytes: &[u8], at: usize) -> Option<usize> {
    let inner = bytes.get(at + 2..)?;
    Some(at + 4 + inner.windows(2).position(|pair| pair == b"*/")?)
}

/// The place after the text between quotes that begins at `at`. Two quotes in a text stand for one.
pub fn end_of_quotes(bytes: &[u8], at: usize) -> Option<usize> {
    let quote = bytes[at];
    let mut at = at + 1;
    loop {
        at += bytes.get(at..)?.iter().position(|byte| *byte == quote)? + 1;
        if bytes.get(at) != Some(&quote) {
            return Some(at);
        }
        at += 1;
    }
}
