//! A line as words with their values.

use super::control::Language;
use super::expression::{Reader, Variable};
use super::fault::{Fault, Refusal};
use super::variables::{Value, Variables};

/// A line that is scanned.
#[derive(Debug, Clone, Copy)]
pub struct Line<'a> {
    /// Counted from 1.
    pub number: usize,
    pub text: &'a [u8],
}

impl Line<'_> {
    /// The refusal of the bytes `start..end`.
    pub fn refusal(&self, start: usize, end: usize, fault: Fault) -> Refusal {
        let word = self.text.get(start..end.min(self.text.len())).unwrap_or_default();
        let word = String::from_utf8_lossy(&word[..word.len().min(40)]).trim_end().to_owned();
        Refusal { line: self.number, column: start + 1, word, fault }
    }

    /// The refusal of the whole line.
    pub fn refused(&self, fault: Fault) -> Refusal {
        let start = self.text.iter().position(|c| !c.is_ascii_whitespace()).unwrap_or(0);
        self.refusal(start, self.text.len(), fault)
    }
}

/// The value of a word and the bytes that the word takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WordValue {
    pub value: f64,
    pub start: usize,
    pub end: usize,
    pub lacks_point: bool,
}

/// A G or M word: ten times its number, and its bytes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Code {
    pub tenths: i32,
    pub start: usize,
    pub end: usize,
}

/// The words of one line.
#[derive(Debug, Clone, Default)]
pub struct Block {
    pub g: Vec<Code>,
    pub m: Vec<Code>,
    slots: [Option<WordValue>; 26],
    /// The letters whose words have been used.
    used: u32,
    /// LinuxCNC: the radius after `@` and the angle after `^`.
    pub polar: [Option<WordValue>; 2],
    pub assignments: Vec<(Variable, Value, [usize; 2])>,
    /// The block stands behind a slash.
    pub is_optional: bool,
    pub has_tape_mark: bool,
}

impl Block {
    pub fn clear(&mut self) {
        let Self { g, m, slots, used, polar, assignments, is_optional, has_tape_mark } = self;
        g.clear();
        m.clear();
        *slots = [None; 26];
        *used = 0;
        *polar = [None; 2];
        assignments.clear();
        (*is_optional, *has_tape_mark) = (false, false);
    }

    /// Scans the line from byte `from`. What cannot be read goes to `refuse`.
    pub fn scan(
        &mut self,
        line: Line<'_>,
        from: usize,
        (variables, language): (&Variables, Language),
        refuse: &mut dyn FnMut(Refusal),
    ) {
        let mut reader = Reader { line: line.text, at: from, variables, language };
        loop {
            reader.skip_blanks();
            let start = reader.at;
            let Some(byte) = line.text.get(start).copied() else { return };
            let result = match byte {
                b'(' => match line.text[start..].iter().position(|c| *c == b')') {
                    Some(end) => {
                        reader.at = start + end + 1;
                        Ok(())
                    }
                    None => {
                        reader.at = line.text.len();
                        Err(Fault::OpenComment)
                    }
                },
                b';' => return,
                b'%' => {
                    reader.at += 1;
                    self.has_tape_mark = true;
                    Ok(())
                }
                b'/' => {
                    reader.at += 1;
                    while line.text.get(reader.at).is_some_and(u8::is_ascii_digit) {
                        reader.at += 1;
                    }
                    self.is_optional = true;
                    Ok(())
                }
                b'#' if language != Language::None => self.assignment(&mut reader, start),
                b'@' | b'^' if language == Language::LinuxCnc => {
                    reader.at += 1;
                    self.polar_word(usize::from(byte == b'^'), &mut reader, start)
                }
                letter if letter.is_ascii_alphabetic() => {
                    reader.at += 1;
                    self.word(letter.to_ascii_uppercase(), &mut reader, start)
                }
                _ => Err(Fault::NoWord),
            };
            if let Err(fault) = result {
                let rest = &line.text[start..];
                let end = rest.iter().skip(1).position(|c| c.is_ascii_whitespace() || *c == b'(');
                let end = end.map_or(line.text.len(), |end| start + 1 + end).max(reader.at);
                refuse(line.refusal(start, end, fault));
                reader.at = end;
            }
        }
    }

    fn assignment(&mut self, reader: &mut Reader<'_>, start: usize) -> Result<(), Fault> {
        let variable = reader.variable(0)?;
        if !reader.take(b'=') {
            return Err(Fault::BadExpression);
        }
        let value = reader.assigned()?;
        self.assignments.push((variable, value, [start, reader.at]));
        Ok(())
    }

    fn word(&mut self, letter: u8, reader: &mut Reader<'_>, start: usize) -> Result<(), Fault> {
        let read = reader.value()?;
        // A word with a vacant value counts as absent.
        let Some(value) = read.value else { return Ok(()) };
        let end = reader.at;
        if let b'G' | b'M' = letter {
            let tenths = value * 10.0;
            if !(0.0..=100_000.0).contains(&tenths) || (tenths - tenths.round()).abs() > 1e-3 {
                return Err(Fault::UnknownCode);
            }
            let codes = if letter == b'G' { &mut self.g } else { &mut self.m };
            codes.push(Code { tenths: tenths.round() as i32, start, end });
            return Ok(());
        }
        let slot = &mut self.slots[usize::from(letter - b'A')];
        if slot.is_some() {
            return Err(Fault::Twice);
        }
        *slot = Some(WordValue { value, start, end, lacks_point: read.lacks_point });
        Ok(())
    }

    fn polar_word(&mut self, k: usize, reader: &mut Reader<'_>, start: usize) -> Result<(), Fault> {
        let value = reader.value()?.value.ok_or(Fault::NoNumber)?;
        if self.polar[k].is_some() {
            return Err(Fault::Twice);
        }
        self.polar[k] = Some(WordValue { value, start, end: reader.at, lacks_point: false });
        Ok(())
    }

    /// The word of a letter, without using it.
    pub fn peek(&self, letter: u8) -> Option<WordValue> {
        self.slots[usize::from(letter - b'A')]
    }

    pub fn has(&self, letters: &[u8]) -> bool {
        letters.iter().any(|letter| self.peek(*letter).is_some())
    }

    /// The word of a letter, which counts as used.
    pub fn take(&mut self, letter: u8) -> Option<WordValue> {
        self.used |= 1 << (letter - b'A');
        self.peek(letter)
    }

    /// Uses the words of these letters.
    pub fn use_up(&mut self, letters: &[u8]) {
        for letter in letters {
            self.used |= 1 << (letter - b'A');
        }
    }

    /// The words that nothing has used, in the order of their letters.
    pub fn unused(&self) -> impl Iterator<Item = (u8, WordValue)> + '_ {
        let letters = b'A'..=b'Z';
        letters.zip(&self.slots).filter_map(|(letter, slot)| {
            let is_used = self.used & (1 << (letter - b'A')) != 0;
            slot.filter(|_| !is_used).map(|slot| (letter, slot))
        })
    }

    pub fn has_g(&self, tenths: i32) -> bool {
        self.g.iter().any(|code| code.tenths == tenths)
    }

    pub fn has_m(&self, tenths: i32) -> bool {
        self.m.iter().any(|code| code.tenths == tenths)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scan(text: &str) -> (Block, Vec<Refusal>) {
        let variables = Variables::new(Language::Fanuc);
        let (mut block, mut refusals) = (Block::default(), Vec::new());
        let line = Line { number: 7, text: text.as_bytes() };
        block.scan(line, 0, (&variables, Language::Fanuc), &mut |refusal| refusals.push(refusal));
        (block, refusals)
    }

    #[test]
    fn words_have_values_and_places() {
        let (block, refusals) = scan("/2 N10 g01 X-.5 (Y3) y[1+2]M08 ; Z");
        assert!(refusals.is_empty() && block.is_optional && !block.has(b"Z"));
        assert_eq!((block.g[0].tenths, block.m[0].tenths), (10, 80));
        let x = block.peek(b'X').unwrap();
        assert_eq!((x.value, x.start, x.end, x.lacks_point), (-0.5, 11, 15, false));
        assert_eq!(block.peek(b'Y').unwrap().value, 3.0);
    }

    #[test]
    fn all_faults_of_a_line_are_told_with_their_columns() {
        let (_, refusals) = scan("G1 X Y2 Y3 ? (open");
        let told: Vec<_> = refusals.iter().map(|r| (r.column, r.word.as_str(), r.fault)).collect();
        assert_eq!(
            told,
            [
                (4, "X", Fault::NoNumber),
                (9, "Y3", Fault::Twice),
                (12, "?", Fault::NoWord),
                (14, "(open", Fault::OpenComment)
            ]
        );
    }

    #[test]
    fn a_vacant_value_leaves_its_word_out() {
        let (block, refusals) = scan("G1 X#5 Y1.");
        assert!(refusals.is_empty() && !block.has(b"X") && block.has(b"Y"));
    }
}
