//! The characters that go over the line for a program: leader, program with its line ends and `%`, trailer.

use std::ops::Range;

use super::settings::{Ends, Flow, Marks, Settings};

pub const XON: u8 = 0x11;
pub const XOFF: u8 = 0x13;

/// Why a program cannot be sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum TapeError {
    #[error("the program has no block to send")]
    Empty,
    #[error(
        "line {line} holds the byte 0x{byte:02X}, which 7 data bits cannot carry: write ASCII only, or set \
         `format` to `8n1` if the control reads 8 bits"
    )]
    NotCarried { line: usize, byte: u8 },
    #[error(
        "line {line} holds the byte 0x{byte:02X}, which is XON or XOFF: remove it, or use another `flow` \
         than `xon-xoff`"
    )]
    Handshake { line: usize, byte: u8 },
    #[error(
        "line {line} has {length} characters; GRBL reads at most {most} in a line, without blanks and comments: shorten the block"
    )]
    LineTooLong { line: usize, length: usize, most: usize },
    #[error(
        "line {line} holds the byte 0x{byte:02X}, which GRBL would obey at once instead of reading it as \
         text: remove it"
    )]
    Realtime { line: usize, byte: u8 },
}

/// A program as it goes over the line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Tape {
    bytes: Vec<u8>,
    /// The part of `bytes` that is neither leader nor trailer.
    body: Range<usize>,
    /// 1 where a line `%` was put before the first line of the program.
    n_lines_before: usize,
    n_lines: usize,
    has_end_mark: bool,
    /// The line end and the end mark, for a sending that is cancelled.
    end_mark: &'static [u8],
}

impl Tape {
    /// # Errors
    /// When the program is empty, or the line cannot carry it. The error names the first line at fault.
    pub fn new(program: &[u8], settings: &Settings) -> Result<Self, TapeError> {
        if program.iter().all(u8::is_ascii_whitespace) {
            return Err(TapeError::Empty);
        }
        check(program, settings)?;
        let end: &'static [u8] = match settings.ends {
            Ends::Lf => b"\n",
            Ends::CrLf => b"\r\n",
            Ends::AsIs => first_end(program),
        };
        let mut bytes = vec![0; settings.leader() as usize];
        // Line ends may grow by a byte in each line.
        bytes.reserve(program.len() + program.len() / 8 + settings.trailer as usize + 16);
        let start = bytes.len();
        let (first, last) = (is_mark(lines(program).next()), is_mark(last_line(program)));
        let n_lines_before = usize::from(settings.marks == Marks::Add && !first);
        if n_lines_before > 0 {
            bytes.push(b'%');
            bytes.extend_from_slice(end);
        }
        let mut n_lines = 0;
        for line in lines(program) {
            n_lines += 1;
            let (text, own_end) = split_end(line);
            bytes.extend_from_slice(text);
            // A control runs a block at its end, so the last line gets an end too.
            let is_kept = settings.ends == Ends::AsIs && !own_end.is_empty();
            bytes.extend_from_slice(if is_kept { own_end } else { end });
        }
        if settings.marks == Marks::Add && !last {
            bytes.push(b'%');
            bytes.extend_from_slice(end);
        }
        let body = start..bytes.len();
        bytes.resize(bytes.len() + settings.trailer as usize, 0);
        let has_end_mark = settings.marks == Marks::Add || last;
        let end_mark: &'static [u8] = match end {
            b"\r\n" => b"%\r\n",
            b"\r" => b"%\r",
            _ => b"%\n",
        };
        Ok(Self { bytes, body, n_lines_before, n_lines, has_end_mark, end_mark })
    }

    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Number of lines of the program, without those that were added.
    pub fn n_lines(&self) -> usize {
        self.n_lines
    }

    /// Characters that end the reading of the control after the end of a block. Empty where the program has
    /// no end mark, so that the control does not expect one.
    pub fn end_mark(&self) -> &'static [u8] {
        if self.has_end_mark { self.end_mark } else { b"" }
    }

    /// Whether the character at `at` begins a block, or is past the last one.
    pub fn is_block_start(&self, at: usize) -> bool {
        at <= self.body.start || at >= self.body.end || is_end(&self.bytes, at - 1)
    }

    /// Whether no character of the program lies before `at`.
    pub fn is_before_program(&self, at: usize) -> bool {
        at <= self.body.start
    }

    /// Whether the whole program lies before `at`.
    pub fn is_after_program(&self, at: usize) -> bool {
        at >= self.body.end
    }

    /// The end of the block that holds the character at `at`.
    pub fn block_end(&self, at: usize) -> usize {
        if self.is_block_start(at) {
            return at;
        }
        (at..self.body.end).find(|k| is_end(&self.bytes, *k)).map_or(self.body.end, |k| k + 1)
    }

    /// Number of line ends in a part of the tape.
    fn n_ends(&self, part: Range<usize>) -> usize {
        part.filter(|at| is_end(&self.bytes, *at)).count()
    }
}

/// Counts the lines of the program while its tape goes out. Takes time in proportion to what is new.
#[derive(Debug, Clone, Default)]
pub struct LineCounter {
    at: usize,
    n_ends: usize,
}

impl LineCounter {
    /// Number of whole lines of the program before the character at `at`. `at` must not decrease.
    pub fn whole_lines(&mut self, tape: &Tape, at: usize) -> usize {
        self.n_ends += tape.n_ends(self.at..at.max(self.at));
        self.at = self.at.max(at);
        self.n_ends.saturating_sub(tape.n_lines_before).min(tape.n_lines)
    }
}

/// Whether a line ends after the character at `at`: after LF, and after CR without LF.
fn is_end(bytes: &[u8], at: usize) -> bool {
    bytes[at] == b'\n' || bytes[at] == b'\r' && bytes.get(at + 1) != Some(&b'\n')
}

/// The lines of a program with their ends: LF, CR LF or CR.
pub fn lines(program: &[u8]) -> impl Iterator<Item = &[u8]> {
    let mut rest = program;
    std::iter::from_fn(move || {
        let end = (0..rest.len()).find(|at| is_end(rest, *at)).map_or(rest.len(), |at| at + 1);
        let (line, after) = rest.split_at(end);
        rest = after;
        (!line.is_empty()).then_some(line)
    })
}

/// The last line that is not blank.
fn last_line(program: &[u8]) -> Option<&[u8]> {
    let program = program.trim_ascii_end();
    let start = program.iter().rposition(|byte| b"\r\n".contains(byte)).map_or(0, |at| at + 1);
    Some(&program[start..])
}

fn is_mark(line: Option<&[u8]>) -> bool {
    line.is_some_and(|line| line.trim_ascii_start().starts_with(b"%"))
}

/// A line without its end, and the end.
fn split_end(line: &[u8]) -> (&[u8], &[u8]) {
    let length = line.iter().rposition(|byte| !b"\r\n".contains(byte)).map_or(0, |at| at + 1);
    line.split_at(length)
}

/// The end of the first line, or LF.
fn first_end(program: &[u8]) -> &'static [u8] {
    match lines(program).next().map(split_end) {
        Some((_, b"\r\n")) => b"\r\n",
        Some((_, b"\r")) => b"\r",
        _ => b"\n",
    }
}

/// Checks that the line carries every byte of the program as text.
fn check(program: &[u8], settings: &Settings) -> Result<(), TapeError> {
    let format = settings.format();
    let is_handshake = |byte: u8| settings.flow == Flow::XonXoff && [XON, XOFF].contains(&format.data(byte));
    let Some(at) = program.iter().position(|byte| !format.carries(*byte) || is_handshake(*byte)) else {
        return Ok(());
    };
    let (byte, line) = (program[at], 1 + (0..at).filter(|at| is_end(program, *at)).count());
    Err(if format.carries(byte) {
        TapeError::Handshake { line, byte }
    } else {
        TapeError::NotCarried { line, byte }
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn settings(list: &str) -> Settings {
        let mut settings = Settings::default();
        for pair in list.split_whitespace() {
            let (name, value) = pair.split_once('=').expect("a pair");
            settings.set(name, value).expect("a legal value");
        }
        settings
    }

    fn bytes(program: &str, list: &str) -> String {
        let tape = Tape::new(program.as_bytes(), &settings(list)).expect("a tape");
        String::from_utf8(tape.bytes).expect("text")
    }

    #[test]
    fn a_tape_has_a_leader_marks_and_line_ends_as_asked() {
        assert_eq!(bytes("G0 X1\nM30", "leader=2 trailer=1"), "\0\0%\nG0 X1\nM30\n%\n\0");
        assert_eq!(bytes("G0 X1\nM30", "leader=0 ends=crlf"), "%\r\nG0 X1\r\nM30\r\n%\r\n");
        assert_eq!(bytes("%\r\nG0\r\n\r\nM30\r\n%\r\n", "leader=0 ends=lf"), "%\nG0\n\nM30\n%\n");
        assert_eq!(bytes("G0\rM30\r", "leader=0"), "%\rG0\rM30\r%\r");
        assert_eq!(bytes("G0\rM30", "leader=0 ends=crlf marks=as-is"), "G0\r\nM30\r\n");
        assert_eq!(bytes("G0\r\nM30", "leader=0 marks=as-is"), "G0\r\nM30\r\n");
        assert_eq!(bytes("% O1\nM30\n%", "leader=0"), "% O1\nM30\n%\n");
    }

    #[test]
    fn a_program_that_the_line_cannot_carry_is_refused_with_its_line() {
        let refused = |program: &[u8], list: &str| Tape::new(program, &settings(list)).expect_err("refused");
        let umlaut = "G0\r\nX1\r\n(\u{fc})\r\n".as_bytes();
        assert_eq!(refused(umlaut, ""), TapeError::NotCarried { line: 3, byte: 0xc3 });
        assert!(Tape::new(umlaut, &settings("format=8n1")).is_ok());
        assert_eq!(refused(b"G0\n\x13", ""), TapeError::Handshake { line: 2, byte: 0x13 });
        assert!(Tape::new(b"G0\n\x13", &settings("flow=none")).is_ok());
        assert_eq!(refused(b" \n", ""), TapeError::Empty);
    }

    #[test]
    fn blocks_end_after_their_line_end() {
        let tape = Tape::new(b"G0\r\nX1\r\n", &settings("leader=2 trailer=2")).expect("a tape");
        assert_eq!(&tape.bytes[..], b"\0\0%\r\nG0\r\nX1\r\n%\r\n\0\0");
        let starts: Vec<usize> = (0..=18).filter(|at| tape.is_block_start(*at)).collect();
        assert_eq!(starts, [0, 1, 2, 5, 9, 13, 16, 17, 18]);
        assert_eq!(
            (tape.block_end(6), tape.block_end(8), tape.block_end(9), tape.block_end(17)),
            (9, 9, 9, 17)
        );
        let mut counter = LineCounter::default();
        let lines: Vec<usize> = (0..=18).map(|at| counter.whole_lines(&tape, at)).collect();
        assert_eq!(lines, [0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 2, 2]);
    }

    proptest! {
        /// The lines of a program stay the same, whatever is done with their ends.
        #[test]
        fn no_line_is_lost(lines in prop::collection::vec("[A-Z0-9. ]{0,12}", 1..30), end in "\n|\r\n|\r", ends in "as-is|lf|crlf") {
            let program = lines.iter().map(|line| format!("{line}{end}")).collect::<String>();
            prop_assume!(!program.trim().is_empty());
            let settings = settings(&format!("leader=3 ends={ends}"));
            let tape = Tape::new(program.as_bytes(), &settings).expect("a tape");
            let sent: Vec<&[u8]> = super::lines(&tape.bytes[tape.body.clone()]).map(|line| split_end(line).0).collect();
            let mut expected = vec!["%"];
            expected.extend(lines.iter().map(String::as_str));
            expected.push("%");
            prop_assert_eq!(sent, expected.iter().map(|line| line.as_bytes()).collect::<Vec<_>>());
            prop_assert_eq!(tape.n_lines(), lines.len());
            prop_assert_eq!(LineCounter::default().whole_lines(&tape, tape.bytes.len()), lines.len());
        }
    }
}
