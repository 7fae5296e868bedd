//! The words of a line of any kind, as far as they are understood.

use super::block;
use super::number::{Number, blanks};

/// A line has at most this many G words, and as many M words; one with more is not understood.
const MAX_CODES: usize = 16;

/// Letters of axes that no arc is fitted along.
const OTHER_AXES: &[u8] = b"ABCUVW";

/// Letters whose words have no meaning but for a G or M word, or none that matters here.
const PARAMETERS: &[u8] = b"DIJKLPQRS";

/// What a line says.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Line {
    pub g: Codes,
    pub m: Codes,
    pub axes: [Option<Number>; 3],
    pub feed: Option<Number>,
    /// Which letters it has; see [`Line::has`].
    letters: u32,
    pub is_numbered: bool,
    /// It is run, or not, as a switch of the machine says.
    pub is_optional: bool,
    /// It has a percent sign, which begins and ends programs.
    pub is_mark: bool,
    /// It has the name of a program.
    pub is_named: bool,
    /// Something in it is not understood: an expression, a variable, an unknown word, two of one kind.
    pub is_unclear: bool,
    /// It is not understood, but gives a variable a value and says nothing that could change a mode.
    pub is_assignment: bool,
    /// It says where to go on in words.
    pub jumps: bool,
    /// Where the first word behind the N word begins, and whether a blank stands between words.
    pub first: usize,
    pub is_spaced: bool,
}

/// The numbers of G or M words, in tenths.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Codes {
    tenths: [i32; MAX_CODES],
    count: usize,
}

impl Codes {
    pub fn all(&self) -> &[i32] {
        &self.tenths[..self.count]
    }

    pub fn has(&self, tenths: i32) -> bool {
        self.all().contains(&tenths)
    }

    fn push(&mut self, tenths: i32) -> Option<()> {
        *self.tenths.get_mut(self.count)? = tenths;
        self.count += 1;
        Some(())
    }
}

impl Line {
    /// Reads `text`, a line without its end.
    pub fn read(text: &[u8]) -> Self {
        let mut line = Self::default();
        let mut at = blanks(text);
        if text.get(at) == Some(&b'/') {
            line.is_optional = true;
            at += 1;
            at += text[at..].iter().take_while(|c| c.is_ascii_digit()).count();
        }
        let number = block::number(&text[at..]);
        line.is_numbered = !number.is_empty();
        at += number.end;
        line.first = at + blanks(&text[at..]);
        line.is_spaced = line.is_numbered && line.first > at;
        if line.words(text).is_none() {
            line.is_unclear = true;
            line.is_assignment = is_assignment(&text[line.first..]);
            line.jumps = text.windows(4).any(|word| word.eq_ignore_ascii_case(b"GOTO"));
        }
        line
    }

    pub fn has(&self, letters: &[u8]) -> bool {
        letters.iter().any(|letter| self.letters & bit(*letter) != 0)
    }

    /// Whether it says where some axis is to go, or how far.
    pub fn has_axes(&self) -> bool {
        self.axes.iter().any(Option::is_some) || self.has(OTHER_AXES)
    }

    pub fn has_other_axes(&self) -> bool {
        self.has(OTHER_AXES)
    }

    fn words(&mut self, text: &[u8]) -> Option<()> {
        let mut at = self.first;
        while let Some(&c) = text.get(at) {
            at += 1;
            match c {
                b' ' | b'\t' => self.is_spaced |= at > self.first && at < text.len(),
                b';' => break,
                b'(' => at += text[at..].iter().position(|&c| c == b')')? + 1,
                b'%' => self.is_mark = true,
                b'A'..=b'Z' | b'a'..=b'z' => {
                    let (number, length) = Number::read(&text[at..])?;
                    self.word(c.to_ascii_uppercase(), number)?;
                    at += length;
                }
                _ => return None,
            }
        }
        Some(())
    }

    fn word(&mut self, letter: u8, number: Number) -> Option<()> {
        let is_repeated = self.letters & bit(letter) != 0;
        self.letters |= bit(letter);
        match letter {
            b'G' => return self.g.push(number.tenths()?),
            b'M' => return self.m.push(number.tenths()?),
            b'X' | b'Y' | b'Z' => self.axes[usize::from(letter - b'X')] = Some(number),
            b'F' => self.feed = Some(number),
            b'O' => self.is_named = true,
            b'T' | b'H' => {}
            _ if OTHER_AXES.contains(&letter) || PARAMETERS.contains(&letter) => {}
            _ => return None,
        }
        (!is_repeated).then_some(())
    }
}

/// Whether `code` begins with a variable and has no letter of a word that changes a mode.
fn is_assignment(code: &[u8]) -> bool {
    let end = code.iter().position(|c| matches!(c, b'(' | b';')).unwrap_or(code.len());
    let code = &code[..end];
    code.first() == Some(&b'#') && code.contains(&b'=') && !code.iter().any(|c| b"GMOgmo".contains(c))
}

fn bit(letter: u8) -> u32 {
    1 << (letter - b'A')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_and_numbers_are_no_words() {
        let line = Line::read(b"N5 G0 (X1 #2) X 2.5 ;Y3 [");
        assert!(line.is_numbered && line.is_spaced && !line.is_unclear);
        assert_eq!((line.g.all(), line.first), ([0].as_slice(), 3));
        assert!(line.axes[0].is_some() && line.axes[1].is_none());
        assert!(Line::read(b"(\xff\xfe)").g.all().is_empty());
        assert!(!Line::read(b" ").is_unclear);
    }

    #[test]
    fn what_is_not_understood_is_said_so() {
        for text in
            ["#1=5", "X[1]", "X#1", "(open", "IF [1] GOTO 5", "X1 X2", "\u{e9}", "G0 E5", "G", "O100 sub"]
        {
            assert!(Line::read(text.as_bytes()).is_unclear, "{text}");
        }
        assert!(Line::read(b"if [1] goto 5").jumps && !Line::read(b"#1=5").jumps);
        assert!(Line::read(b"N5 #1=[#2*SIN[3]] (GO)").is_assignment);
        assert!(!Line::read(b"#1=5 G91").is_assignment && !Line::read(b"X#1").is_assignment);
        let optional = Line::read(b"/2 N10 X1");
        assert!(optional.is_optional && optional.is_numbered && !optional.is_unclear);
        assert!(Line::read(b"O0501").is_named && Line::read(b"%").is_mark);
    }
}
