//! The words of one line of an NC program of any control: a name and a number.
//!
//! `X1.5`, `TX+0.2` and `A3=0.2` are a name with a number; `TRAORI` and `LN` are names alone. What begins no
//! name, such as `#`, is a word of one character, and the line is not read behind it.

use std::borrow::Cow;
use std::ops::Range;

use super::PathFault;
use crate::nc::{Lexer, Token};

/// Names and numbers with more characters are refused.
const MAX_LENGTH: usize = 40;

/// A word with its name in capital letters.
#[derive(Debug, Clone, PartialEq)]
pub struct Word<'a> {
    pub name: Cow<'a, str>,
    pub value: Option<f64>,
    pub point: Point,
    /// Where the word stands in its line.
    pub place: Range<usize>,
}

/// The decimal point of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Point {
    None,
    Inside,
    /// Behind the last digit.
    AtEnd,
}

/// The content of a line.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Block<'a> {
    pub words: Vec<Word<'a>>,
    pub comments: Vec<&'a str>,
    /// A switch of the machine decides whether the line is run.
    pub is_optional: bool,
    pub has_tape_mark: bool,
    /// The parameters of the line go on in the next line.
    pub continues: bool,
}

/// Reads a line. `has_numbers` tells that numbers of blocks have no letter, as in Klartext.
///
/// # Errors
/// When a number or the end of a comment cannot be read.
pub fn block(line: &str, has_numbers: bool) -> Result<Block<'_>, PathFault> {
    let bytes = line.as_bytes();
    let mut block = Block::default();
    let mut at = 0;
    if has_numbers {
        at = run(bytes, |c| c == b' ' || c == b'\t');
        at += run(&bytes[at..], |c| c.is_ascii_digit());
        at += run(&bytes[at..], |c| c == b' ');
        // A heading of the structure of a program.
        if bytes.get(at) == Some(&b'*') {
            block.comments.push(&line[at + 1..]);
            return Ok(block);
        }
    }
    while let Some((place, token)) = Lexer::new(&bytes[at..]).next() {
        let start = at + place.start;
        match token {
            Token::Word { .. } => {
                let (word, end) = word(line, start)?;
                block.words.push(word);
                at = end;
                continue;
            }
            Token::Comment { is_closed: false } => return Err(PathFault::OpenComment),
            Token::Comment { .. } => {
                let inner = &line[start + 1..at + place.end];
                block.comments.push(if bytes[start] == b'(' { &inner[..inner.len() - 1] } else { inner });
            }
            Token::BlockDelete if block.words.is_empty() => block.is_optional = true,
            Token::TapeMark => {
                block.has_tape_mark = true;
                // The name of the tape.
                block.comments.push(&line[start + 1..]);
                return Ok(block);
            }
            Token::Unknown if bytes[start] == b'~' => {
                block.continues = true;
                return Ok(block);
            }
            Token::Unknown if bytes[start] == b'_' => {
                let (word, end) = word(line, start)?;
                block.words.push(word);
                at = end;
                continue;
            }
            Token::BlockDelete | Token::Unknown => {
                let first = line[start..].chars().next().unwrap_or_default();
                let name = first.to_string().into();
                let place = start..start + first.len_utf8();
                block.words.push(Word { name, value: None, point: Point::None, place });
                return Ok(block);
            }
        }
        at += place.end;
    }
    Ok(block)
}

/// The word that begins at `start` with a letter, and where the next may begin.
fn word(line: &str, start: usize) -> Result<(Word<'_>, usize), PathFault> {
    let bytes = line.as_bytes();
    let is_letter = |c: u8| c.is_ascii_alphabetic() || c == b'_';
    let letters = start + run(&bytes[start..], is_letter);
    // Digits before an equals sign belong to the name.
    // HSC-MODE is one name.
    let is_joined = letters > start + 1
        && bytes.get(letters) == Some(&b'-')
        && bytes.get(letters + 1).is_some_and(u8::is_ascii_alphabetic);
    let letters = if is_joined { letters + 1 + run(&bytes[letters + 1..], is_letter) } else { letters };
    let digits = run(&bytes[letters..], |c| c.is_ascii_digit());
    let equals = bytes[letters + digits..].first() == Some(&b'=');
    let end = if equals { letters + digits } else { letters };
    let gap = end + usize::from(equals);
    let gap = gap + run(&bytes[gap..], |c| c == b' ' || c == b'\t');
    let length = run(&bytes[gap..], |c| c.is_ascii_digit() || b"+-.".contains(&c));
    let name = &line[start..end];
    if name.len() > MAX_LENGTH || length > MAX_LENGTH {
        return Err(PathFault::BadNumber(line[start..].chars().take(MAX_LENGTH).collect()));
    }
    let text = &line[gap..gap + length];
    let value = match length {
        0 => None,
        _ => Some(text.parse().map_err(|_| PathFault::BadNumber(text.to_owned()))?),
    };
    let point = match text.find('.') {
        None => Point::None,
        Some(k) if k + 1 == text.len() => Point::AtEnd,
        Some(_) => Point::Inside,
    };
    let is_capital = !name.bytes().any(|c| c.is_ascii_lowercase());
    let name = if is_capital { Cow::Borrowed(name) } else { Cow::Owned(name.to_ascii_uppercase()) };
    // Arguments and texts belong to the word.
    let mut next = if length > 0 { gap + length } else { end + usize::from(equals) };
    match bytes.get(next) {
        Some(b'"') if equals => next = behind_text(line, next)?,
        Some(b'(') if name.len() > 1 => next = behind_arguments(line, next)?,
        // A value that is no number, such as R1 or AC(5).
        Some(_) if equals && length == 0 => {
            let word = Word { name: "=".into(), value: None, point, place: start..next };
            return Ok((word, line.len()));
        }
        _ => {}
    }
    Ok((Word { name, value, point, place: start..next }, next))
}

fn behind_text(line: &str, at: usize) -> Result<usize, PathFault> {
    let inner = line[at + 1..].find('"').ok_or(PathFault::OpenComment)?;
    Ok(at + inner + 2)
}

fn behind_arguments(line: &str, from: usize) -> Result<usize, PathFault> {
    let bytes = line.as_bytes();
    let (mut at, mut depth) = (from, 0);
    loop {
        match bytes.get(at).ok_or(PathFault::OpenComment)? {
            b'"' => {
                at = behind_text(line, at)?;
                continue;
            }
            b'(' => depth += 1,
            b')' => depth -= 1,
            _ => {}
        }
        at += 1;
        if depth == 0 {
            return Ok(at);
        }
    }
}

fn run(bytes: &[u8], is: impl Fn(u8) -> bool) -> usize {
    bytes.iter().position(|c| !is(*c)).unwrap_or(bytes.len())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn shown(line: &str) -> String {
        let text = |word: &Word| match word.value {
            Some(value) => format!("{}:{value}", word.name),
            None => word.name.to_string(),
        };
        block(line, false).unwrap().words.iter().map(text).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn the_words_of_every_family_are_read() {
        assert_eq!(shown("n10 g43.4H1 X-1.5Y.5 (Z9) A 3."), "N:10 G:43.4 H:1 X:-1.5 Y:0.5 A:3");
        assert_eq!(shown("LN X+1 Y-2 TX+0.6 TZ+0.8 FMAX M128 ; x"), "LN X:1 Y:-2 TX:0.6 TZ:0.8 FMAX M:128");
        assert_eq!(shown("G1 X=1 A3=0.6 B3=0 C3=.8"), "G:1 X:1 A3:0.6 B3:0 C3:0.8");
        assert_eq!(shown("TRAORI(1) X1"), "TRAORI X:1");
        assert_eq!(shown("T=\"MILL 6\" D1 _CAMTOL=0.01"), "T D:1 _CAMTOL:0.01");
        assert_eq!(shown("MSG(\"X1)\")Y2"), "MSG Y:2");
        assert_eq!(shown("CYCLE832(0.01,1)"), "CYCLE:832");
        assert_eq!(shown("G1X5"), "G:1 X:5");
        assert_eq!(shown("HSC-MODE:0 TA0.1"), "HSC-MODE :");
        assert_eq!(shown("M1=3 S1=500"), "M1:3 S1:500");
        assert!(matches!(block("X1.2.3", false), Err(PathFault::BadNumber(_))));
        assert_eq!(block("X1 (a", false), Err(PathFault::OpenComment));
    }

    #[test]
    fn what_begins_no_name_is_a_word_that_ends_the_line() {
        for (line, words) in [
            ("X#1 Y2", "X #"),
            ("IF [#1 GT 2] GOTO 5", "IF ["),
            ("X=R1", "="),
            ("G1 X5 ,R2", "G:1 X:5 ,"),
            ("X1 2", "X:1 2"),
            ("o<sub> call", "O <"),
        ] {
            assert_eq!(shown(line), words, "{line}");
        }
    }

    #[test]
    fn marks_and_comments_stand_beside_the_words() {
        let own = block("/ N5 X1 ( a ) ; b", false).unwrap();
        assert!(own.is_optional);
        assert_eq!(own.comments, [" a ", " b"]);
        assert!(block("%PM", false).unwrap().has_tape_mark);
        assert!(block("12 CYCL DEF 247 ~", true).unwrap().continues);
        assert_eq!(block("12 * - Roughing", true).unwrap().comments, [" - Roughing"]);
    }

    proptest! {
        #[test]
        fn no_line_panics(line in "(?s).{0,80}", has_numbers in any::<bool>()) {
            let _ = block(&line, has_numbers);
        }
    }
}
