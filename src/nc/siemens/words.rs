//! A line as words with their values. Assignments take effect as they are read.
//!
//! # Method
//! A letter that no second letter follows is an address, whose number or expression follows. Two letters
//! begin a name: a word of the language, a variable, or a program.

use super::block::{Block, From, Given, Tool};
use super::codes::{Meaning, VALUES, code, is_left_value, word};
use super::expression::Reader;
use super::text::{blanks, comment_start, name_at};
use super::values::{Value, Variable, Variables};
use crate::block::Line;
use crate::fault::Fault;
use crate::notes::LeftAlone;

/// Reads the words of one line.
pub struct Scanner<'a, 'x> {
    pub line: Line<'a>,
    text: &'a [u8],
    pub at: usize,
    variables: &'x mut Variables,
    left: &'x mut LeftAlone,
    block: Block,
}

type Scanned = Result<(), Fault>;

/// The words of a line from byte `at` on.
pub fn scan<'a>(line: Line<'a>, at: usize, variables: &mut Variables, left: &mut LeftAlone) -> Block {
    let text = &line.text[..comment_start(line.text).max(at)];
    let mut scanner = Scanner { line, text, at, variables, left, block: Block::default() };
    scanner.run();
    scanner.block
}

impl Scanner<'_, '_> {
    fn run(&mut self) {
        loop {
            self.at = blanks(self.text, self.at);
            if self.at >= self.text.len() {
                return;
            }
            let start = self.at;
            if let Err(fault) = self.word() {
                // What follows a word that cannot be read is not told apart from the word.
                let end = self.at.max(start + 1);
                self.block.is_void = true;
                if self.variables.has_met_lost() {
                    // The variable has been refused where it was set.
                    return;
                }
                self.block.refusals.push(self.line.refusal(start, end, fault));
                return;
            }
        }
    }

    fn refuse(&mut self, start: usize, fault: Fault) {
        self.block.is_void = true;
        self.block.refusals.push(self.line.refusal(start, self.at, fault));
    }

    fn word(&mut self) -> Scanned {
        match self.text[self.at] {
            b'$' => Err(Fault::AtMachine),
            _ => match name_at(self.text, self.at) {
                Some((name, end)) => self.name(name, end),
                None => self.letter(),
            },
        }
    }

    fn reader(&self) -> Reader<'_, '_> {
        Reader { text: self.text, at: self.at, variables: self.variables }
    }

    /// Reads by `read` from here on.
    fn read<T>(&mut self, read: impl FnOnce(&mut Reader<'_, '_>) -> Result<T, Fault>) -> Result<T, Fault> {
        let mut reader = self.reader();
        let result = read(&mut reader);
        self.at = reader.at.min(self.text.len());
        result
    }

    /// Takes an equals sign, which no second one follows.
    fn take_equals(&mut self) -> bool {
        let at = blanks(self.text, self.at);
        let found = self.text.get(at) == Some(&b'=') && self.text.get(at + 1) != Some(&b'=');
        self.at = if found { at + 1 } else { self.at };
        found
    }

    fn assign(&mut self, variable: &Variable, kind_is_text: bool) -> Scanned {
        if !self.take_equals() {
            return Err(Fault::BadExpression);
        }
        let value = self.read(|reader| reader.value()).and_then(|value| match value {
            Value::Text(_) if !kind_is_text => Err(Fault::BadExpression),
            value => Ok(value),
        });
        let set = value.and_then(|value| self.variables.set(variable, value));
        if set.is_err() {
            self.variables.lose(variable);
        }
        set
    }

    fn name(&mut self, name: String, end: usize) -> Scanned {
        let start = self.at;
        self.at = end;
        if self.variables.is_defined(&name) {
            let variable = self.read(|reader| reader.variable(name, 0))?;
            return self.assign(&variable, true);
        }
        if let Some(known) = VALUES.iter().find(|known| **known == name) {
            return self.named_value(known, start);
        }
        if is_left_value(&name) {
            if self.text.get(self.at) == Some(&b'[') {
                self.skip_nested(b'[', b']')?;
            }
            self.coordinate()?;
            self.left.add(&name, self.line.number);
            return Ok(());
        }
        let Some(meaning) = word(&name) else {
            let at = blanks(self.text, self.at);
            let is_program = !matches!(self.text.get(at), Some(b'=' | b'['));
            return Err(if is_program { Fault::NoProgram } else { Fault::UnknownCode });
        };
        match meaning {
            Meaning::LeftAlone => {
                if self.text.get(blanks(self.text, self.at)) == Some(&b'(') {
                    self.at = blanks(self.text, self.at);
                    self.skip_nested(b'(', b')')?;
                }
                self.left.add(&name, self.line.number);
            }
            Meaning::TransformationEnd => self.left.add(&name, self.line.number),
            Meaning::NotRead if name.starts_with("ORI") && self.is_bare() => {
                self.block.others.push([start, end]);
                return Ok(());
            }
            Meaning::NotRead => return Err(Fault::NotRead),
            Meaning::Transformation => {
                self.refuse(start, Fault::NotRead);
                // Its parameters name a set of data.
                if self.text.get(blanks(self.text, self.at)) == Some(&b'(') {
                    self.at = blanks(self.text, self.at);
                    self.skip_nested(b'(', b')')?;
                }
            }
            _ => {}
        }
        self.block.codes.push((meaning, [start, end]));
        Ok(())
    }

    /// Whether neither a value nor parameters follow.
    fn is_bare(&self) -> bool {
        !matches!(self.text.get(blanks(self.text, self.at)), Some(b'=' | b'[' | b'('))
    }

    fn named_value(&mut self, name: &'static str, start: usize) -> Scanned {
        let given = self.coordinate()?;
        let given = Given { start, end: self.at, ..given };
        if self.block.values.insert(name, given).is_some() {
            self.refuse(start, Fault::Twice);
        }
        Ok(())
    }

    /// Skips what stands between two signs, which may be nested and hold texts.
    fn skip_nested(&mut self, open: u8, close: u8) -> Scanned {
        let (mut depth, mut is_in_string) = (0usize, false);
        for at in self.at..self.text.len() {
            match self.text[at] {
                b'"' => is_in_string = !is_in_string,
                _ if is_in_string => {}
                byte if byte == open => depth += 1,
                byte if byte == close => {
                    depth -= 1;
                    if depth == 0 {
                        self.at = at + 1;
                        return Ok(());
                    }
                }
                _ => {}
            }
        }
        Err(Fault::BadExpression)
    }

    /// A value behind an equals sign: an expression, or AC and its kind.
    fn coordinate(&mut self) -> Result<Given, Fault> {
        if !self.take_equals() {
            return Err(Fault::NoNumber);
        }
        let (from, value) = self.read(|reader| {
            reader.skip_blanks();
            let found = name_at(reader.text, reader.at).and_then(|(name, end)| {
                let from = match name.as_str() {
                    "AC" => From::Zero,
                    "IC" => From::Tool,
                    "DC" | "ACP" | "ACN" => From::Circle,
                    _ => return None,
                };
                (reader.text.get(blanks(reader.text, end)) == Some(&b'(')).then_some((from, end))
            });
            if let Some((from, end)) = found {
                // The parentheses read as those of an expression.
                reader.at = end;
                reader.take(b'(');
                let value = reader.number()?;
                return if reader.take(b')') { Ok((from, value)) } else { Err(Fault::BadExpression) };
            }
            Ok((From::Mode, reader.number()?))
        })?;
        Ok(Given { value, from, start: 0, end: 0 })
    }

    fn letter(&mut self) -> Scanned {
        let start = self.at;
        let letter = self.text[start].to_ascii_uppercase();
        if !letter.is_ascii_alphabetic() {
            return Err(Fault::NoWord);
        }
        if letter == b'R' {
            let variable = self.read(|reader| reader.parameter(0))?;
            return self.assign(&variable, false);
        }
        self.at += 1;
        let digits = self.text[self.at..].iter().take_while(|c| c.is_ascii_digit()).count();
        let behind = blanks(self.text, self.at + digits);
        let is_extended =
            digits > 0 && self.text.get(behind) == Some(&b'=') && self.text.get(behind + 1) != Some(&b'=');
        if is_extended {
            let extension = String::from_utf8_lossy(&self.text[self.at..self.at + digits]).into_owned();
            self.at += digits;
            return self.extended(letter, &extension, start);
        }
        if letter == b'T' {
            return self.tool(start);
        }
        let given = if self.text.get(blanks(self.text, self.at)) == Some(&b'=') {
            self.coordinate()?
        } else {
            let value = self.read(|reader| reader.literal())?;
            Given { value, from: From::Mode, start, end: 0 }
        };
        self.take_letter(letter, Given { start, end: self.at, ..given })
    }

    fn tool(&mut self, start: usize) -> Scanned {
        let value = if self.take_equals() {
            self.read(|reader| reader.value())?
        } else {
            Value::Number(self.read(|reader| reader.literal())?)
        };
        let tool = match value {
            Value::Text(name) if !name.trim().is_empty() => Tool::Name(name.trim().to_owned()),
            Value::Number(number) if number.fract() == 0.0 && (0.0..=99_999_999.0).contains(&number) => {
                Tool::Number(number as u32)
            }
            Value::Number(number) => return Err(Fault::OutOfRange(number)),
            Value::Text(_) => return Err(Fault::NoNumber),
        };
        if self.block.tool.replace(tool).is_some() {
            self.refuse(start, Fault::Twice);
        }
        Ok(())
    }

    /// A letter with a number and an equals sign.
    fn extended(&mut self, letter: u8, extension: &str, start: usize) -> Scanned {
        let given = self.coordinate()?;
        let given = Given { start, end: self.at, ..given };
        let slot = match (letter, extension) {
            (b'I' | b'J' | b'K', "1") => &mut self.block.middles[usize::from(letter - b'I')],
            (b'X' | b'Y' | b'Z', "1") => &mut self.block.machine_axes[usize::from(letter - b'X')],
            (b'S', "1") | (b'M', "1") => return self.take_letter(letter, given),
            // Other spindles.
            (b'S' | b'M' | b'H', _) => {
                self.left.add(&format!("{}{extension}", char::from(letter)), self.line.number);
                return Ok(());
            }
            (b'A' | b'B' | b'C', _) => {
                self.block.others.push([start, self.at]);
                return Ok(());
            }
            (b'X' | b'Y' | b'Z' | b'U' | b'V' | b'W', _) => return Err(Fault::OtherAxis),
            _ => return Err(Fault::UnusedWord),
        };
        if slot.replace(given).is_some() {
            self.refuse(start, Fault::Twice);
        }
        Ok(())
    }

    fn take_letter(&mut self, letter: u8, given: Given) -> Scanned {
        let span = [given.start, given.end];
        let is_plain = given.from == From::Mode;
        let slot = match letter {
            b'X' | b'Y' | b'Z' if given.from != From::Circle => {
                &mut self.block.axes[usize::from(letter - b'X')]
            }
            b'I' | b'J' | b'K' if given.from != From::Circle => {
                &mut self.block.centers[usize::from(letter - b'I')]
            }
            b'G' | b'M' if is_plain => {
                let number = whole(given.value)?;
                if letter == b'M' {
                    self.block.functions.push((number, span));
                } else {
                    self.take_code(number, span);
                }
                return Ok(());
            }
            b'F' | b'S' | b'D' | b'P' if is_plain => {
                if self.block.letters.insert(letter, given).is_some() {
                    self.refuse(given.start, Fault::Twice);
                }
                return Ok(());
            }
            b'H' if is_plain => {
                self.left.add("H", self.line.number);
                return Ok(());
            }
            b'A' | b'B' | b'C' if given.value == 0.0 => {
                self.left.add(&format!("{}0", char::from(letter)), self.line.number);
                return Ok(());
            }
            b'A' | b'B' | b'C' | b'U' | b'V' | b'W' => {
                self.block.others.push(span);
                return Ok(());
            }
            _ => return Err(Fault::UnusedWord),
        };
        if slot.replace(given).is_some() {
            self.refuse(given.start, Fault::Twice);
        }
        Ok(())
    }

    fn take_code(&mut self, number: u32, span: [usize; 2]) {
        let meaning = code(number);
        match meaning {
            Meaning::NotRead => self.refuse(span[0], Fault::NotRead),
            Meaning::Unknown => self.refuse(span[0], Fault::UnknownCode),
            Meaning::LeftAlone => self.left.add(&format!("G{number}"), self.line.number),
            _ => {}
        }
        self.block.codes.push((meaning, span));
    }
}

fn whole(value: f64) -> Result<u32, Fault> {
    if value.fract() == 0.0 && (0.0..=99_999.0).contains(&value) {
        Ok(value as u32)
    } else {
        Err(Fault::OutOfRange(value))
    }
}
