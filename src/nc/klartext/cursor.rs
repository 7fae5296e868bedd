//! Reads words, names and values from the text of a block.

use super::parameters::{Key, Kind, Parameters};
use crate::fault::Fault;

/// Longest name of a label, a tool or a program, bytes.
const MAX_NAME: usize = 255;

/// A place in the text of a block.
#[derive(Debug, Clone, Copy)]
pub struct Cursor<'t> {
    pub text: &'t [u8],
    pub at: usize,
}

/// Why a value cannot be had, and the bytes of the block that state it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Broken {
    /// `None` where it only follows from an earlier refusal.
    pub fault: Option<Fault>,
    pub start: usize,
    pub end: usize,
}

impl<'t> Cursor<'t> {
    pub fn new(text: &'t [u8]) -> Self {
        Self { text, at: 0 }
    }

    pub fn skip_blanks(&mut self) {
        while matches!(self.text.get(self.at), Some(b' ' | b'\t')) {
            self.at += 1;
        }
    }

    pub fn peek(&self) -> Option<u8> {
        self.text.get(self.at).copied()
    }

    /// Whether only blanks follow.
    pub fn is_done(&mut self) -> bool {
        self.skip_blanks();
        self.at >= self.text.len()
    }

    /// Takes `byte`, after blanks.
    pub fn take(&mut self, byte: u8) -> bool {
        self.skip_blanks();
        let is_found = self.peek() == Some(byte);
        self.at += usize::from(is_found);
        is_found
    }

    /// Takes these letters, whatever follows them.
    pub fn letters(&mut self, letters: &str) -> bool {
        let is_found = self.text[self.at..].starts_with(letters.as_bytes());
        self.at += if is_found { letters.len() } else { 0 };
        is_found
    }

    /// Takes these words, which blanks part, unless a letter follows.
    pub fn phrase(&mut self, words: &str) -> bool {
        let mut probe = *self;
        for word in words.split(' ') {
            probe.skip_blanks();
            if !probe.letters(word) || probe.peek().is_some_and(|c| c.is_ascii_alphabetic()) {
                return false;
            }
        }
        *self = probe;
        true
    }

    /// The letters that stand here, after blanks.
    pub fn keyword(&mut self) -> &'t [u8] {
        self.skip_blanks();
        let rest = &self.text[self.at..];
        let end = rest.iter().position(|c| !c.is_ascii_alphabetic()).unwrap_or(rest.len());
        &rest[..end]
    }

    /// The byte behind the word that stands here: blanks end it, and so does the length of the longest name.
    pub fn word_end(&self) -> usize {
        let rest = &self.text[self.at..];
        let rest = &rest[..rest.len().min(MAX_NAME + 1)];
        self.at + rest.iter().position(|c| matches!(c, b' ' | b'\t')).unwrap_or(rest.len())
    }

    /// A name: between quotation marks, or up to a blank.
    pub fn name(&mut self) -> Option<String> {
        let (start, end, next) = if self.take(b'"') {
            let length = self.text[self.at..].iter().position(|c| *c == b'"')?;
            (self.at, self.at + length, self.at + length + 1)
        } else {
            let end = self.word_end();
            (self.at, end, end)
        };
        self.at = next;
        let is_legal = end > start && end - start <= MAX_NAME;
        is_legal.then(|| String::from_utf8_lossy(&self.text[start..end]).into_owned())
    }

    /// A number without a sign; a comma counts as a point.
    pub fn number(&mut self) -> Option<f64> {
        let rest = &self.text[self.at..];
        let mut points = 0;
        let length = rest
            .iter()
            .position(|c| {
                points += usize::from(matches!(c, b'.' | b','));
                !(c.is_ascii_digit() || matches!(c, b'.' | b',') && points == 1)
            })
            .unwrap_or(rest.len());
        let text: String =
            rest[..length].iter().map(|c| char::from(if *c == b',' { b'.' } else { *c })).collect();
        let value = text.parse::<f64>().ok().filter(|value| value.is_finite())?;
        self.at += length;
        Some(value)
    }

    /// A whole number.
    pub fn whole(&mut self) -> Option<u32> {
        let rest = &self.text[self.at..];
        let length = rest.iter().position(|c| !c.is_ascii_digit()).unwrap_or(rest.len());
        let value = std::str::from_utf8(&rest[..length]).ok()?.parse().ok()?;
        self.at += length;
        Some(value)
    }

    /// A parameter: Q, QL or QR with a number.
    pub fn parameter(&mut self) -> Option<Key> {
        let mut probe = *self;
        probe.skip_blanks();
        if !probe.letters("Q") {
            return None;
        }
        let kind = match probe.peek() {
            Some(b'L') => Kind::Local,
            Some(b'R') => Kind::Kept,
            _ => Kind::Plain,
        };
        probe.at += usize::from(kind != Kind::Plain);
        let number = probe.whole()?;
        *self = probe;
        Some(Key { kind, number })
    }

    /// The value of a word: a number or a parameter, with a sign.
    pub fn value(&mut self, parameters: &Parameters) -> Result<f64, Broken> {
        let start = self.at;
        self.skip_blanks();
        let sign = match self.peek() {
            Some(b'-') => -1.0,
            _ => 1.0,
        };
        self.at += usize::from(matches!(self.peek(), Some(b'-' | b'+')));
        self.skip_blanks();
        if let Some(key) = self.parameter() {
            let value = parameters.get(key).map_err(|fault| Broken { fault, start, end: self.at })?;
            return Ok(sign * value);
        }
        match self.number() {
            Some(value) => Ok(sign * value),
            None => Err(Broken { fault: Some(Fault::NoNumber), start, end: self.word_end() }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_have_signs_points_commas_and_parameters() {
        let mut parameters = Parameters::default();
        let set = |text: &str, parameters: &mut Parameters, value| {
            parameters.set(Cursor::new(text.as_bytes()).parameter().unwrap(), Ok(value)).unwrap();
        };
        set("Q5", &mut parameters, 7.0);
        set("QL5", &mut parameters, 8.0);
        for (text, value) in [
            ("+10", 10.0),
            ("-2,5", -2.5),
            (" .5", 0.5),
            ("5.", 5.0),
            ("-Q5", -7.0),
            ("+QL5", 8.0),
            ("Q 5", 0.0),
        ] {
            let found = Cursor::new(text.as_bytes()).value(&parameters).ok();
            assert_eq!(found, Some(value).filter(|value| *value != 0.0), "{text}");
        }
        let fault = |text: &str| Cursor::new(text.as_bytes()).value(&parameters).unwrap_err().fault;
        assert_eq!(
            (fault("+-5"), fault("Q6"), fault("")),
            (Some(Fault::NoNumber), Some(Fault::AtMachine), Some(Fault::NoNumber))
        );
    }
}
