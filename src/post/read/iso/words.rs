//! Reads the words of one line strictly: a character that begins no word, and an incomplete number or
//! comment, are faults.

use crate::nc::{Codes, Fault, Lexer, Token};

/// Characters of a number, more than any control reads. A longer number is a fault.
const MAX_NUMBER_LENGTH: usize = 40;

/// Letters that carry a value, at most once a line.
const VALUES: &str = "ABCEFHIJKNPQRSTXYZ";

/// The text of every value by its letter, and the G and M codes in tenths.
pub struct Words<'a> {
    values: [&'a str; 26],
    pub g: Codes,
    pub m: Codes,
}

impl<'a> Words<'a> {
    /// # Errors
    /// When a character begins no word, a number cannot be read or a word stands twice.
    pub fn of(line: &'a str) -> Result<Self, Fault> {
        let line = line.trim();
        let mut words = Self { values: [""; 26], g: Codes::default(), m: Codes::default() };
        for (place, token) in Lexer::new(line.as_bytes()) {
            match token {
                Token::Word { letter, number, .. } => {
                    let number = &line[place.end - number.len()..place.end];
                    words.take(letter.into(), number, &line[place.end..])?;
                }
                Token::Comment { is_closed: true } => {}
                Token::Comment { is_closed: false } => return Err(Fault::OpenComment),
                Token::TapeMark if line == "%" => {}
                Token::BlockDelete | Token::TapeMark | Token::Unknown => {
                    return Err(Fault::UnknownWord(line[place.start..].chars().next().unwrap_or_default()));
                }
            }
        }
        Ok(words)
    }

    /// Takes a word with the text of its number and the rest of the line.
    fn take(&mut self, letter: char, number: &'a str, rest: &str) -> Result<(), Fault> {
        let is_code = letter == 'G' || letter == 'M';
        if !is_code && !VALUES.contains(letter) {
            return Err(Fault::UnknownWord(letter));
        }
        let is_cut_short = rest.starts_with(['+', '-', '.']);
        if number.is_empty() || number.len() > MAX_NUMBER_LENGTH || is_cut_short {
            return Err(Fault::BadNumber(letter));
        }
        if is_code {
            let value: f64 = number.parse().map_err(|_| Fault::BadNumber(letter))?;
            let tenths = value * 10.0;
            if tenths != tenths.round() || !(0.0..10_000.0).contains(&tenths) {
                return Err(if letter == 'G' { Fault::UnknownG(value) } else { Fault::UnknownM(value) });
            }
            let codes = if letter == 'G' { &mut self.g } else { &mut self.m };
            return codes.push(tenths as i32).ok_or(Fault::Conflict);
        }
        let is_first = self.values[index(letter)].is_empty();
        self.values[index(letter)] = number;
        is_first.then_some(()).ok_or(Fault::Twice(letter))
    }

    pub fn has(&self, letter: char) -> bool {
        !self.values[index(letter)].is_empty()
    }

    pub fn get(&self, letter: char) -> Option<f64> {
        self.values[index(letter)].parse().ok()
    }

    /// The first of `letters` that the line has.
    pub fn first_of(&self, letters: &str) -> Option<char> {
        letters.chars().find(|&letter| self.has(letter))
    }

    /// The first of `letters` whose number has a decimal point (`has_point`) or has none (not `has_point`).
    pub fn first_written(&self, letters: &str, has_point: bool) -> Option<char> {
        let is_so = |letter: &char| self.values[index(*letter)].contains('.') == has_point;
        letters.chars().filter(|&letter| self.has(letter)).find(is_so)
    }
}

/// The slot of a capital letter.
fn index(letter: char) -> usize {
    letter as usize - 'A' as usize
}
