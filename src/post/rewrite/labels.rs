//! The blocks to which a program may jump.
//!
//! # Method
//! GOTO, M96 P, M97 P, M98 Q, M99 P, and P and Q of G70 to G76 name blocks by their numbers. A jump to a
//! computed number may lead to every numbered block.

use std::collections::BTreeSet;
use std::ops::RangeInclusive;

use super::block::Block;
use super::lines::{line_end, split};
use crate::dialect::Dialect;
use crate::nc::{Lexer, Token};

/// Labels that are told apart. A program with more has every numbered block as a label.
const MAX_LABELS: usize = 100_000;

/// Series of replaced block numbers that are told apart; further ones are joined.
const MAX_SERIES: usize = 10_000;

/// Block numbers to which lines jump.
#[derive(Debug, Clone, Default)]
pub struct Labels {
    numbers: BTreeSet<u64>,
    /// Every numbered block may be a label.
    are_all: bool,
    /// Numbers of blocks that were replaced, of which some are gone.
    replaced: Vec<RangeInclusive<u64>>,
}

impl Labels {
    /// Takes the jumps of a text.
    pub fn find(&mut self, text: &[u8], dialect: &Dialect) {
        for line in split(text) {
            let line = &line[..line.len() - line_end(line).len()];
            self.meet(&Jumps::of(line, &Block::read(line).on(dialect)));
        }
    }

    /// Takes the jumps of a line. False where a jump may lead to a block that was replaced.
    pub fn meet(&mut self, jumps: &Jumps) -> bool {
        let Jumps { targets, are_clear } = jumps;
        let was_found = targets.iter().any(|target| self.replaced.iter().any(|own| own.contains(target)));
        let is_lost = was_found || !are_clear && !self.replaced.is_empty();
        self.numbers.extend(targets);
        self.are_all |= !are_clear || self.numbers.len() > MAX_LABELS;
        !is_lost
    }

    /// Whether there are labels, and each of them is named by its jumps.
    pub fn are_known(&self) -> bool {
        !self.are_all && !self.numbers.is_empty()
    }

    /// The number of the label with this N word; `None` where no jump names the block.
    pub fn label(&self, word: &[u8]) -> Option<u64> {
        number(word).filter(|number| self.numbers.contains(number))
    }

    /// Whether the program may jump to the block with this N word; an empty word is no label.
    pub fn hold(&self, word: &[u8]) -> bool {
        // Few programs jump, and every block is asked.
        if self.are_all { !word.is_empty() } else { !self.numbers.is_empty() && self.label(word).is_some() }
    }

    /// Remembers that blocks with these N words were replaced.
    pub fn replace<'w>(&mut self, words: impl Iterator<Item = &'w [u8]>) {
        let numbers = words.filter_map(number);
        let series = numbers.fold(None, |series: Option<[u64; 2]>, number| {
            let [least, most] = series.unwrap_or([number; 2]);
            Some([least.min(number), most.max(number)])
        });
        let Some([least, most]) = series else { return };
        if self.replaced.len() < MAX_SERIES {
            self.replaced.push(least..=most);
        } else if let Some(last) = self.replaced.last_mut() {
            *last = *last.start().min(&least)..=*last.end().max(&most);
        }
    }
}

/// The blocks to which a line jumps.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Jumps {
    pub targets: Vec<u64>,
    /// No jump is computed.
    pub are_clear: bool,
}

impl Jumps {
    /// The jumps of a line without its end.
    pub fn of(line: &[u8], block: &Block) -> Self {
        let mut targets = Vec::new();
        let are_clear = if block.is_unclear {
            unclear(line, block, &mut targets)
        } else {
            let has_range = block.g.all().iter().any(|code| (700..=760).contains(code));
            let letters: &[u8] = match () {
                () if [960, 970, 990].iter().any(|code| block.m.has(*code)) => b"P",
                // M98 Q calls a part of the program that begins at a block; on some controls, H does.
                () if block.m.has(980) => b"QH",
                () if has_range => b"PQ",
                () => b"",
            };
            letters.is_empty() || words(line, letters, &mut targets)
        };
        Self { targets, are_clear }
    }
}

/// The number of an N word.
pub fn number(word: &[u8]) -> Option<u64> {
    let mut digits = word.iter().filter(|c| c.is_ascii_digit()).map(|c| u64::from(c - b'0')).peekable();
    digits.peek()?;
    digits.try_fold(0u64, |number, digit| number.checked_mul(10)?.checked_add(digit))
}

/// The values of the words with these letters. False where one is no whole number.
fn words(line: &[u8], letters: &[u8], targets: &mut Vec<u64>) -> bool {
    let mut is_clear = true;
    for (_, token) in Lexer::new(line) {
        let Token::Word { letter, value, .. } = token else { continue };
        if letters.contains(&letter) {
            match value.filter(|value| value.millionths >= 0 && value.millionths % 1_000_000 == 0) {
                Some(value) => targets.push((value.millionths / 1_000_000) as u64),
                None => is_clear = false,
            }
        }
    }
    is_clear
}

/// The jumps of a line with expressions. False where one is computed.
fn unclear(line: &[u8], block: &Block, targets: &mut Vec<u64>) -> bool {
    let mut is_clear = true;
    let text = line.to_ascii_uppercase();
    if block.jumps {
        for at in (0..text.len()).filter(|at| text[*at..].starts_with(b"GOTO")) {
            let rest = text[at + 4..].trim_ascii_start();
            let rest = rest.strip_prefix(b"N").unwrap_or(rest);
            let end = rest.iter().position(|c| !c.is_ascii_digit()).unwrap_or(rest.len());
            let is_number = end > 0 && !matches!(rest.get(end), Some(b'.' | b'[' | b'#' | b'*' | b'/'));
            match number(&rest[..end]).filter(|_| is_number) {
                Some(target) => targets.push(target),
                None => is_clear = false,
            }
        }
    }
    let packed: Vec<u8> = text.iter().copied().filter(|c| !c.is_ascii_whitespace()).collect();
    let has = |word: &[u8]| packed.windows(word.len()).any(|part| part == word);
    let names = |letters: &[u8]| letters.iter().any(|letter| packed.contains(letter));
    let by_p = [b"M96", b"M97", b"M99"].iter().any(|word| has(*word)) && names(b"P");
    let by_part = has(b"M98") && names(b"QH");
    let is_range = (b'0'..=b'6').any(|digit| has(&[b'G', b'7', digit])) && names(b"PQ");
    if by_p || by_part || is_range {
        is_clear = false;
    }
    is_clear
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(lines: &[&str]) -> Labels {
        let mut labels = Labels::default();
        for line in lines {
            labels.meet(&Jumps::of(line.as_bytes(), &Block::read(line.as_bytes())));
        }
        labels
    }

    #[test]
    fn jumps_name_their_blocks_or_all() {
        let found = labels(&[
            "IF [#1 LT 3] GOTO 200",
            "N5 GOTO 10",
            "M99 P30",
            "M97 P40 L2",
            "G70 P50 Q60",
            "G65 P70",
            "M98 P80 Q90",
            "M96 P100 Q8",
        ]);
        for (word, is_label) in [
            ("N200", true),
            ("N 10", true),
            ("N0030", true),
            ("N40", true),
            ("N60", true),
            ("N70", false),
            ("N80", false),
            ("N90", true),
            ("N100", true),
            ("", false),
        ] {
            assert_eq!(found.hold(word.as_bytes()), is_label, "{word}");
        }
        for line in ["GOTO #5", "GOTO[#1+10]", "M99 P#3", "GOTO 5[1]", "M98 P1 Q60 L#1", "G71 P60 Q100 U#1"] {
            assert!(labels(&[line]).hold(b"N1") && !labels(&[line]).hold(b""), "{line}");
        }
    }

    #[test]
    fn a_jump_to_a_replaced_block_is_told() {
        let mut labels = Labels::default();
        labels.replace([b"N10".as_slice(), b"N20", b""].into_iter());
        let meets = |labels: &mut Labels, line: &str| {
            labels.meet(&Jumps::of(line.as_bytes(), &Block::read(line.as_bytes())))
        };
        assert!(
            meets(&mut labels, "GOTO 30") && !meets(&mut labels, "GOTO 15") && !meets(&mut labels, "GOTO #1")
        );
    }
}
