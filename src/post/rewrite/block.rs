//! Blocks that may stand in a run: a number, G1, coordinates and a feed, and nothing else.

use std::ops::Range;

use super::number::{Number, blanks};

/// Longer lines are in no run, so that a window of them is bounded.
pub const MAX_BLOCK_LENGTH: usize = 256;

/// The words of such a block; places are those of bytes in its line.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// Of the N word; empty where there is none.
    pub number: Range<usize>,
    pub has_g1: bool,
    pub axes: [Option<Number>; 3],
    pub feed: Option<(Number, Range<usize>)>,
    /// Where the first word behind the N word begins.
    pub first: usize,
    /// Whether blanks stand between its words.
    pub is_spaced: bool,
}

impl Block {
    /// The block that `line`, without its end, is; none where it says anything else, twice or nothing of where to go.
    pub fn read(line: &[u8]) -> Option<Self> {
        if line.len() > MAX_BLOCK_LENGTH {
            return None;
        }
        let number = number(line);
        let first = number.end + blanks(&line[number.end..]);
        let is_spaced = first > number.end && !number.is_empty();
        let mut block = Self { number, has_g1: false, axes: [None; 3], feed: None, first, is_spaced };
        let mut at = first;
        while let Some(letter) = line.get(at) {
            let (value, length) = Number::read(&line[at + 1..])?;
            let end = at + 1 + length;
            block.take(letter.to_ascii_uppercase(), value, at..end)?;
            at = end + blanks(&line[end..]);
            block.is_spaced |= at > end && at < line.len();
        }
        block.axes.iter().any(Option::is_some).then_some(block)
    }

    fn take(&mut self, letter: u8, value: Number, place: Range<usize>) -> Option<()> {
        match letter {
            b'X' | b'Y' | b'Z' => {
                let axis = &mut self.axes[usize::from(letter - b'X')];
                axis.replace(value).is_none().then_some(())
            }
            b'F' => self.feed.replace((value, place)).is_none().then_some(()),
            b'G' => {
                let is_first = !std::mem::replace(&mut self.has_g1, true);
                (is_first && value.tenths() == Some(10)).then_some(())
            }
            _ => None,
        }
    }
}

/// Where the N word at the start of a line stands; empty, at the start, where there is none.
pub fn number(line: &[u8]) -> Range<usize> {
    let start = blanks(line);
    if !matches!(line.get(start), Some(b'N' | b'n')) {
        return start..start;
    }
    let digits = start + 1 + blanks(&line[start + 1..]);
    let count = line[digits..].iter().take_while(|c| c.is_ascii_digit()).count();
    if count == 0 { start..start } else { start..digits + count }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_of_a_run_are_told_from_others() {
        for line in ["X1", "n10 g01 x.5 Y -3 F100", "  Z+3.", "G1X1Y2Z3F4", "N 7X-0", "X1 G1"] {
            assert!(Block::read(line.as_bytes()).is_some(), "{line}");
        }
        let others = [
            "", " ", "N10", "G1", "F100", "G1 F100", "X1 X2", "G1 G1 X1", "G0 X1", "G2 X1", "X1 (a)", "X1;",
            "/X1", "X#1", "X[1]", "A1", "X1 M8", "%", "X1 0", "X1.2.3", "X", "N X1", "X1 S5", "G1.5 X1",
            "X1e5",
        ];
        for line in others {
            assert_eq!(Block::read(line.as_bytes()), None, "{line}");
        }
        assert_eq!(Block::read(&[b'X'; MAX_BLOCK_LENGTH + 1]), None);
    }

    #[test]
    fn words_are_found_where_they_stand() {
        let line = b" N 10  X5 F200";
        let block = Block::read(line).unwrap();
        assert_eq!(&line[block.number.clone()], b"N 10");
        assert_eq!(block.first, 7);
        assert_eq!(&line[block.feed.unwrap().1], b"F200");
        assert!(block.is_spaced);
        assert!(!Block::read(b"N10X5F200 ").unwrap().is_spaced);
    }
}
