//! One line of NC text as tokens, each with its place in the line.

use std::ops::Range;

use super::decimal::Decimal;

/// The smallest piece of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Token<'a> {
    /// An address letter in upper case, with the text and the value of its number ([`Decimal::at_start`]).
    /// The text is empty where no number follows the letter.
    Word { letter: u8, number: &'a [u8], value: Option<Decimal> },
    /// Text in parentheses, or from a semicolon to the end of the line.
    Comment { is_closed: bool },
    /// A slash, and the digits of its switch.
    BlockDelete,
    /// The percent sign, which stands before and after a program.
    TapeMark,
    /// A byte that begins no token.
    Unknown,
}

/// The tokens of one line, without its line end. Blanks between tokens are skipped.
#[derive(Debug, Clone)]
pub struct Lexer<'a> {
    line: &'a [u8],
    at: usize,
}

impl<'a> Lexer<'a> {
    pub fn new(line: &'a [u8]) -> Self {
        Self { line, at: 0 }
    }
}

impl<'a> Iterator for Lexer<'a> {
    type Item = (Range<usize>, Token<'a>);

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        let start = self.at + blanks(&self.line[self.at..]);
        let first = *self.line.get(start)?;
        let rest = &self.line[start + 1..];
        let (token, length) = match first {
            b'A'..=b'Z' | b'a'..=b'z' => {
                let gap = blanks(rest);
                let (length, value) = Decimal::at_start(&rest[gap..]);
                let number = &rest[gap..gap + length];
                (Token::Word { letter: first.to_ascii_uppercase(), number, value }, gap + length)
            }
            b'(' => match rest.iter().position(|&c| c == b')') {
                Some(inside) => (Token::Comment { is_closed: true }, inside + 1),
                None => (Token::Comment { is_closed: false }, rest.len()),
            },
            b';' => (Token::Comment { is_closed: true }, rest.len()),
            b'/' => (Token::BlockDelete, digits(rest)),
            b'%' => (Token::TapeMark, 0),
            _ => (Token::Unknown, 0),
        };
        self.at = start + 1 + length;
        Some((start..self.at, token))
    }
}

/// How many bytes at the start of `bytes` are blanks.
#[inline]
fn blanks(bytes: &[u8]) -> usize {
    bytes.iter().position(|c| !matches!(c, b' ' | b'\t')).unwrap_or(bytes.len())
}

/// How many bytes at the start of `bytes` are digits.
#[inline]
fn digits(bytes: &[u8]) -> usize {
    bytes.iter().position(|c| !c.is_ascii_digit()).unwrap_or(bytes.len())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn tokens(line: &str) -> Vec<(&str, Token<'_>)> {
        Lexer::new(line.as_bytes()).map(|(place, token)| (&line[place], token)).collect()
    }

    #[test]
    fn a_line_is_words_comments_and_marks_where_they_stand() {
        let word = |letter, number: &'static str| {
            let number = number.as_bytes();
            Token::Word { letter, number, value: Decimal::at_start(number).1 }
        };
        let closed = Token::Comment { is_closed: true };
        assert_eq!(
            tokens("/2 g01X\t-.5 (a;b) #Y ;c"),
            [
                ("/2", Token::BlockDelete),
                ("g01", word(b'G', "01")),
                ("X\t-.5", word(b'X', "-.5")),
                ("(a;b)", closed),
                ("#", Token::Unknown),
                ("Y ", word(b'Y', "")),
                (";c", closed)
            ]
        );
        assert_eq!(tokens("%(a"), [("%", Token::TapeMark), ("(a", Token::Comment { is_closed: false })]);
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn tokens_and_the_blanks_between_them_are_the_whole_line(line in "([GXYN%(); \t./+-]|[0-9]|.){0,60}") {
            let mut end = 0;
            let is_blank = |bytes: &[u8]| bytes.iter().all(|c| b" \t".contains(c));
            for (place, _) in Lexer::new(line.as_bytes()) {
                prop_assert!(is_blank(&line.as_bytes()[end..place.start]) && place.start < place.end);
                end = place.end;
            }
            prop_assert!(is_blank(&line.as_bytes()[end..]));
        }
    }
}
