//! The words of one line of any NC program, as far as they can be understood.

use std::ops::Range;

use crate::dialect::Dialect;
use crate::nc::{Codes, Decimal, Lexer, Token};
use crate::words::begins_like_a_command;

/// Longest line that may stand in a run, bytes. Bounds the memory of a window of such lines.
pub const MAX_RUN_BLOCK_LENGTH: usize = 256;

/// Letters of axes beside X, Y and Z. No arc is fitted along them.
const OTHER_AXES: &[u8] = b"ABCUVW";

/// Other letters that may carry a value: parameters of G and M words, and O, T, H and S.
const PARAMETERS: &[u8] = b"DHIJKLOPQRST";

/// The code, in tenths, beside which E is a parameter: the smoothing of Haas.
const SMOOTHING: i32 = 1870;

/// The only letters that a block of a run may have.
const RUN_LETTERS: &[u8] = b"GXYZFS";

/// Letters whose numbers may have more decimals than are kept.
const LENGTHS: &[u8] = b"XYZABCUVWIJKRF";

/// A mark of the order of bytes at the start of a text in UTF-8.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// The content of a line. Places are byte ranges in the line.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Block {
    pub g: Codes,
    pub m: Codes,
    pub axes: [Option<Decimal>; 3],
    pub feed: Option<(Decimal, Range<usize>)>,
    pub speed: Option<Decimal>,
    /// A number has more than six decimals, and is rounded.
    pub is_rounded: bool,
    /// A bit for every letter of the line; see [`Block::has`].
    letters: u32,
    /// Of the N word at the start; empty where there is none.
    pub number: Range<usize>,
    /// Where the first word after the N word begins.
    pub first: usize,
    /// Where the last word or comment ends.
    pub end: usize,
    /// Blanks stand between words.
    pub is_spaced: bool,
    /// The line begins with a block delete: a switch of the machine decides whether the line is run.
    pub is_optional: bool,
    pub has_comment: bool,
    /// The line has a comment that a control may obey.
    pub has_active_comment: bool,
    /// Text stands behind a semicolon.
    pub has_line_comment: bool,
    /// The line has a percent sign, which begins and ends programs.
    pub has_tape_mark: bool,
    /// The line has an expression, a variable, an unknown word, or two words of one letter.
    pub is_unclear: bool,
    /// The line is unclear, but only gives a variable a value: it has no letter of a word that could change a
    /// mode.
    pub is_assignment: bool,
    /// The line is unclear and has a GOTO.
    pub jumps: bool,
    /// The line is unclear, but only jumps to a number, perhaps under a condition: no mode changes.
    pub is_plain_jump: bool,
}

impl Block {
    /// Reads `line`, a line without its end.
    pub fn read(line: &[u8]) -> Self {
        let mut block = Self::default();
        if block.tokens(line).is_none() {
            block.is_unclear = true;
            block.is_assignment = is_assignment(&line[block.first..]);
            block.jumps = line.windows(4).any(|word| word.eq_ignore_ascii_case(b"GOTO"));
            block.is_plain_jump = block.jumps && is_plain_jump(&line[block.first..]);
        }
        block
    }

    /// Reads the first line of a text, before which a mark of the order of bytes may stand.
    pub fn read_first(line: &[u8]) -> Self {
        let Some(rest) = line.strip_prefix(BYTE_ORDER_MARK) else { return Self::read(line) };
        let mut block = Self::read(rest);
        let shift = BYTE_ORDER_MARK.len();
        block.number = block.number.start + shift..block.number.end + shift;
        (block.first, block.end) = (block.first + shift, block.end + shift);
        if let Some((_, place)) = &mut block.feed {
            *place = place.start + shift..place.end + shift;
        }
        block
    }

    /// The line as a control reads it. Where a semicolon ends blocks, text behind one may be the next block.
    pub fn on(mut self, dialect: &Dialect) -> Self {
        self.is_unclear |= self.has_line_comment && dialect.ends_blocks_with_semicolons();
        self
    }

    /// Whether the line gives only the end of a G1 block, and at most its feed, its speed and comments for
    /// people.
    pub fn may_be_in_run(&self) -> bool {
        let is_marked = self.is_optional || self.has_active_comment || self.has_tape_mark;
        let is_plain = !(self.is_unclear || self.is_rounded || is_marked);
        let others = self.letters & !bits(RUN_LETTERS);
        is_plain && others == 0 && matches!(self.g.all(), [] | [10]) && self.axes.iter().any(Option::is_some)
    }

    /// Whether the line has nothing but comments for people.
    pub fn is_remark(&self) -> bool {
        let has_marks = self.is_optional || self.has_active_comment || self.has_tape_mark;
        !(self.is_unclear || has_marks) && self.letters == 0 && self.number.is_empty()
    }

    pub fn has(&self, letters: &[u8]) -> bool {
        self.letters & bits(letters) != 0
    }

    /// Whether the line gives a coordinate or a distance of an axis.
    pub fn has_axes(&self) -> bool {
        self.has(b"XYZ") || self.has_other_axes()
    }

    pub fn has_other_axes(&self) -> bool {
        self.has(OTHER_AXES)
    }

    /// Takes tokens up to the first one that is not understood; that one returns `None`.
    fn tokens(&mut self, line: &[u8]) -> Option<()> {
        let mut beginning = Beginning::Line;
        for (place, token) in Lexer::new(line) {
            if beginning != Beginning::Over {
                if beginning == Beginning::Line && token == Token::BlockDelete {
                    self.is_optional = true;
                    beginning = Beginning::Number;
                    continue;
                }
                if beginning != Beginning::Words && is_block_number(&token) {
                    (self.number, self.end) = (place.clone(), place.end);
                    beginning = Beginning::Words;
                    continue;
                }
                beginning = Beginning::Over;
                self.first = place.start;
            }
            let is_comment = matches!(token, Token::Comment { .. });
            self.is_spaced |= self.end > 0 && place.start > self.end && !is_comment;
            self.end = place.end;
            match token {
                Token::Word { letter, number, value } => {
                    let value = match value {
                        Some(value) => value,
                        None => {
                            self.is_rounded = true;
                            rounded(letter, number)?
                        }
                    };
                    self.word(letter, value, place)?;
                }
                Token::Comment { is_closed: true } => self.comment(&line[place]),
                Token::TapeMark => self.has_tape_mark = true,
                Token::Comment { is_closed: false } | Token::BlockDelete | Token::Unknown => return None,
            }
        }
        if beginning != Beginning::Over {
            self.first = line.len();
        }
        // Elsewhere E may be an axis.
        (!self.has(b"E") || self.g.has(SMOOTHING)).then_some(())
    }

    fn comment(&mut self, comment: &[u8]) {
        self.has_comment = true;
        self.has_line_comment |= comment.starts_with(b";") && !is_bare(comment);
        let inside: Vec<u8> = comment[1..].iter().filter(|c| !c.is_ascii_whitespace()).copied().collect();
        let inside = String::from_utf8_lossy(&inside).to_uppercase();
        self.has_active_comment |= begins_like_a_command(&inside);
    }

    #[inline]
    fn word(&mut self, letter: u8, number: Decimal, place: Range<usize>) -> Option<()> {
        let is_repeated = self.has(&[letter]);
        self.letters |= bits(&[letter]);
        match letter {
            b'G' => return self.g.push(number.tenths()?),
            b'M' => return self.m.push(number.tenths()?),
            b'X' | b'Y' | b'Z' => self.axes[usize::from(letter - b'X')] = Some(number),
            b'F' => self.feed = Some((number, place)),
            b'S' => self.speed = Some(number),
            b'E' => {}
            _ if OTHER_AXES.contains(&letter) || PARAMETERS.contains(&letter) => {}
            _ => return None,
        }
        (!is_repeated).then_some(())
    }
}

/// Whether a comment is a semicolon alone, which may stand for the end of a block.
pub fn is_bare(comment: &[u8]) -> bool {
    comment.starts_with(b";") && comment[1..].trim_ascii().is_empty()
}

/// What may come next at the beginning of a line.
#[derive(Clone, Copy, PartialEq)]
enum Beginning {
    /// Block delete, a block number or words.
    Line,
    /// A block number or words.
    Number,
    /// Words.
    Words,
    /// The beginning is over.
    Over,
}

/// The number of a length with more than six decimals, to the nearest millionth.
fn rounded(letter: u8, number: &[u8]) -> Option<Decimal> {
    let value: f64 = std::str::from_utf8(number).ok()?.parse().ok()?;
    let is_legal = LENGTHS.contains(&letter) && value.abs() < 1e6;
    is_legal.then(|| Decimal { millionths: (value * 1e6).round() as i64, decimals: 6, has_point: true })
}

/// Whether the token is N with digits alone.
fn is_block_number(token: &Token) -> bool {
    let Token::Word { letter: b'N', number, .. } = token else { return false };
    !number.is_empty() && number.iter().all(u8::is_ascii_digit)
}

/// Whether `code` begins with a variable and has no letter of a word that changes a mode.
fn is_assignment(code: &[u8]) -> bool {
    let end = code.iter().position(|c| matches!(c, b'(' | b';')).unwrap_or(code.len());
    let code = &code[..end];
    code.first() == Some(&b'#') && code.contains(&b'=') && !code.iter().any(|c| b"GMOgmo".contains(c))
}

/// Whether `code` is `GOTO 10` or `IF [...] GOTO 10`, perhaps with comments behind.
fn is_plain_jump(code: &[u8]) -> bool {
    let end = code.iter().position(|c| matches!(c, b'(' | b';')).unwrap_or(code.len());
    let packed: Vec<u8> = code[..end].iter().filter(|c| !c.is_ascii_whitespace()).copied().collect();
    let packed = packed.to_ascii_uppercase();
    let behind_condition = match packed.strip_prefix(b"IF") {
        Some(rest) => match closing_bracket(rest) {
            Some(end) => &rest[end..],
            None => return false,
        },
        None => &packed[..],
    };
    let Some(target) = behind_condition.strip_prefix(b"GOTO") else { return false };
    let target = target.strip_prefix(b"N").unwrap_or(target);
    !target.is_empty() && target.iter().all(u8::is_ascii_digit)
}

/// The place behind the bracket that closes the one at the start of `text`.
fn closing_bracket(text: &[u8]) -> Option<usize> {
    let mut depth = 0u32;
    for (at, c) in text.iter().enumerate() {
        match c {
            b'[' => depth += 1,
            b']' => depth = depth.checked_sub(1)?,
            _ if depth == 0 => return None,
            _ => {}
        }
        if depth == 0 {
            return Some(at + 1);
        }
    }
    None
}

/// A bit for each capital letter.
fn bits(letters: &[u8]) -> u32 {
    letters.iter().fold(0, |bits, letter| bits | 1 << (letter - b'A'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_of_a_run_has_a_number_g1_coordinates_and_a_feed_only() {
        for line in [
            "X1",
            "X1 S5",
            "X1 (a)",
            "(a) X1 ; b",
            "X1;",
            "n10 g01 x.5 Y -3 F100",
            "  Z+3.",
            "G1X1Y2Z3F4",
            "N 7X-0",
            "X1 G1",
        ] {
            assert!(Block::read(line.as_bytes()).may_be_in_run(), "{line}");
        }
        let others = [
            "",
            " ",
            "N10",
            "G1",
            "F100",
            "G1 F100",
            "X1 X2",
            "G1 G1 X1",
            "G0 X1",
            "G2 X1",
            "X1 (MSG, a)",
            "X1 ;log,a",
            "X1 (a",
            "X1 E5",
            "/X1",
            "X#1",
            "X[1]",
            "A1",
            "X1 M8",
            "%",
            "X1 0",
            "X1.2.3",
            "X",
            "N X1",
            "X1 T5",
            "G1.5 X1",
            "X1e5",
            "X1 %",
            "X1 O5",
            "X1.0000000000001",
        ];
        for line in others {
            assert!(!Block::read(line.as_bytes()).may_be_in_run(), "{line}");
        }
    }

    #[test]
    fn words_are_found_where_they_stand() {
        let line = b" N 10  X5 F200";
        let block = Block::read(line);
        assert_eq!(&line[block.number.clone()], b"N 10");
        assert_eq!(block.first, 7);
        assert_eq!(&line[block.feed.unwrap().1], b"F200");
        assert!(block.is_spaced);
        assert!(!Block::read(b"N10X5F200 ").is_spaced);
    }

    #[test]
    fn comments_and_numbers_are_no_words() {
        let block = Block::read(b"N5 G0 (X1 #2) X 2.5 ;Y3 [");
        assert!(!block.number.is_empty() && block.is_spaced && !block.is_unclear);
        assert_eq!((block.g.all(), block.first), ([0].as_slice(), 3));
        assert!(block.axes[0].is_some() && block.axes[1].is_none());
        assert!(Block::read(b"(\xff\xfe)").g.all().is_empty());
        assert!(!Block::read(b" ").is_unclear);
    }

    #[test]
    fn unknown_text_makes_a_line_unclear() {
        for text in
            ["#1=5", "X[1]", "X#1", "(open", "IF [1] GOTO 5", "X1 X2", "\u{e9}", "G0 E5", "G", "O100 sub"]
        {
            assert!(Block::read(text.as_bytes()).is_unclear, "{text}");
        }
        for text in ["GOTO 5", "N5 IF [#1 EQ [2]] GOTO N10 (back)", "if[#1 gt 2]goto10"] {
            assert!(Block::read(text.as_bytes()).is_plain_jump, "{text}");
        }
        for text in ["GOTO #1", "GOTO 5 G91", "IF [#1] X5 GOTO 10", "IF #1 GOTO 5", "IF [1 GOTO 5", "GOTO"] {
            assert!(!Block::read(text.as_bytes()).is_plain_jump, "{text}");
        }
        assert!(!Block::read(b"G187 P2 E0.1").is_unclear && Block::read(b"G64 E1").is_unclear);
        assert!(Block::read(b"if [1] goto 5").jumps && !Block::read(b"#1=5").jumps);
        assert!(Block::read(b"N5 #1=[#2*SIN[3]] (GO)").is_assignment);
        assert!(!Block::read(b"#1=5 G91").is_assignment && !Block::read(b"X#1").is_assignment);
        let optional = Block::read(b"/2 N10 X1");
        assert!(optional.is_optional && !optional.number.is_empty() && !optional.is_unclear);
        assert!(Block::read(b"O0501").has(b"O") && Block::read(b"%").has_tape_mark);
    }
}
