//! The lines of a program as GRBL takes them: without comments, without `%`, without blank lines.

use super::BUFFER;
use crate::dnc::tape::{TapeError, lines};

/// Most characters of a block, without blanks. GRBL reads a line into 80 bytes with a zero at the end
/// (LINE_BUFFER_SIZE in its protocol.h), and answers a longer one with error 11.
const LINE: usize = 79;

/// A block of the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Block {
    /// The end of the block in the text, behind its line end.
    pub end: usize,
    /// The number of its line in the program.
    pub line: usize,
    /// Whether the block may write to the EEPROM.
    pub is_alone: bool,
    /// Whether the block may make the machine dwell (G4).
    pub dwells: bool,
}

/// A program for GRBL.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Program {
    text: Vec<u8>,
    blocks: Vec<Block>,
    n_lines: usize,
}

impl Program {
    pub fn text(&self) -> &[u8] {
        &self.text
    }

    pub fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    /// Number of lines of the program, with blank lines and comments.
    pub fn n_lines(&self) -> usize {
        self.n_lines
    }
}

/// Makes the blocks of a program. Comments are left out, because a `!` or `?` in a comment would act as a
/// command. Every block ends with LF: GRBL would take CR LF for two lines.
///
/// # Errors
/// When there is no block, a block is longer than GRBL reads, or holds a byte that GRBL obeys at
/// once. The error names the first line at fault.
pub fn program(bytes: &[u8]) -> Result<Program, TapeError> {
    let mut program = Program { text: Vec::with_capacity(bytes.len()), blocks: Vec::new(), n_lines: 0 };
    for raw in lines(bytes) {
        program.n_lines += 1;
        let line = program.n_lines;
        let start = program.text.len();
        push_without_comments(raw, &mut program.text);
        let block = &program.text[start..];
        if block.is_empty() || block.starts_with(b"%") {
            program.text.truncate(start);
            continue;
        }
        let is_command = |byte: &u8| b"?!~\x18".contains(byte) || *byte >= 0x80;
        if let Some(byte) = block.iter().copied().find(|byte| is_command(byte)) {
            return Err(TapeError::Realtime { line, byte });
        }
        let plain = plain(block);
        let (is_alone, dwells) = (may_write_eeprom(&plain), has_dwell(&plain));
        program.text.push(b'\n');
        let end = program.text.len();
        let length = text_length(&program.text[start..]);
        if length > LINE {
            return Err(TapeError::LineTooLong { line, length, most: LINE });
        }
        if end - start >= BUFFER {
            return Err(TapeError::LineTooLong { line, length: end - start - 1, most: BUFFER - 2 });
        }
        program.blocks.push(Block { end, line, is_alone, dwells });
    }
    if program.blocks.is_empty() { Err(TapeError::Empty) } else { Ok(program) }
}

/// The characters of a block that GRBL keeps.
fn text_length(block: &[u8]) -> usize {
    block.iter().filter(|byte| **byte > b' ').count()
}

/// Appends a line without comments and without white space at its ends.
fn push_without_comments(line: &[u8], text: &mut Vec<u8>) {
    let start = text.len();
    let mut is_comment = false;
    for byte in line.trim_ascii() {
        match byte {
            b';' if !is_comment => break,
            b'(' => is_comment = true,
            b')' if is_comment => is_comment = false,
            _ if is_comment => {}
            b' ' | b'\t' if text.len() == start => {}
            byte => text.push(*byte),
        }
    }
    let kept = text[start..].trim_ascii_end().len();
    text.truncate(start + kept);
}

/// A block in upper case without blanks.
fn plain(block: &[u8]) -> Vec<u8> {
    block.iter().filter(|byte| !byte.is_ascii_whitespace()).map(u8::to_ascii_uppercase).collect()
}

/// Whether a block holds G4, also as G04 or G4.0, and not G40.
fn has_dwell(plain: &[u8]) -> bool {
    plain.split(|byte| *byte == b'G').skip(1).any(|rest| {
        let number =
            rest.iter().position(|byte| !byte.is_ascii_digit() && *byte != b'.').unwrap_or(rest.len());
        std::str::from_utf8(&rest[..number]).is_ok_and(|number| number.parse() == Ok(4.0))
    })
}

/// Whether a block may write to the EEPROM: a setting, G10, G28.1 or G30.1.
fn may_write_eeprom(plain: &[u8]) -> bool {
    let holds = |word: &[u8]| plain.windows(word.len()).any(|part| part == word);
    plain.starts_with(b"$") || holds(b"G10") || holds(b"G28.1") || holds(b"G30.1")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_marks_and_blank_lines_are_left_out_and_lines_keep_their_numbers() {
        let text = "%\r\nO1 (WHAT? !)\r\n\r\n G0 X1 ; rapid\r\n(only)\r\nG1(a)X2 ( open\nM30";
        let program = program(text.as_bytes()).expect("a program");
        assert_eq!(std::str::from_utf8(program.text()), Ok("O1\nG0 X1\nG1X2\nM30\n"));
        let lines: Vec<usize> = program.blocks().iter().map(|block| block.line).collect();
        assert_eq!((lines, program.n_lines()), (vec![2, 4, 6, 7], 7));
    }

    #[test]
    fn a_block_that_grbl_would_misread_is_refused_with_its_line() {
        let refused = |text: &str| program(text.as_bytes()).expect_err("refused");
        assert_eq!(refused("G0\nG1 X1 ! Y2"), TapeError::Realtime { line: 2, byte: b'!' });
        assert_eq!(refused("G0\u{e9}"), TapeError::Realtime { line: 1, byte: 0xc3 });
        assert_eq!(refused("(nothing)\n%"), TapeError::Empty);
        let long = format!("G0\n{}\n", "X".repeat(80));
        assert_eq!(refused(&long), TapeError::LineTooLong { line: 2, length: 80, most: 79 });
        assert!(program(format!("{} (seen)", "X ".repeat(63)).as_bytes()).is_ok());
        let blank = format!("G0{}X1\n", " ".repeat(140));
        assert_eq!(refused(&blank), TapeError::LineTooLong { line: 1, length: 144, most: 126 });
    }

    #[test]
    fn a_dwell_is_g4_alone() {
        let program = program(b"G4 P900\nG04P1\ng 4.0 p2\nG40\nG43.1 Z4\nX4 G1").expect("a program");
        let dwells: Vec<bool> = program.blocks().iter().map(|block| block.dwells).collect();
        assert_eq!(dwells, [true, true, true, false, false, false]);
    }

    #[test]
    fn blocks_that_write_to_the_eeprom_travel_alone() {
        let program = program(b"$130=200\nG 10 L2 P1\ng28.1\nG28\nG1 X10\nG100\n").expect("a program");
        let alone: Vec<bool> = program.blocks().iter().map(|block| block.is_alone).collect();
        // G100 is no word of GRBL, so it does no harm alone.
        assert_eq!(alone, [true, true, true, false, false, true]);
    }
}
