//! The text of Klartext programs as blocks, with the places to which calls and jumps lead.
//!
//! # Method
//! 1. A block is a line, or several that end in `~`. Its number, its comment and blanks around it are no part
//!    of it. Letters count as capitals, but between quotation marks. A comment that ends in `~` goes on in
//!    the next line, except between the parameters of a cycle.
//! 2. A program lies between BEGIN PGM and END PGM. A text may hold several; the first one runs.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use toolpathd_core::budget::{Budget, Stopped};

use super::cursor::Cursor;
use crate::block::Line;
use crate::control::Language;
use crate::fault::{Fault, Refusal};
use crate::source::Source;

/// Blocks between two checks of the budget.
const BLOCKS_BETWEEN_CHECKS: usize = 1024;

/// Most programs of a text. Further ones are refused.
const MAX_PROGRAMS: usize = 10_000;

/// Most labels of a program, more than controls take. Further ones are not found.
const MAX_LABELS: usize = 100_000;

/// A text as blocks.
pub struct Script<'a> {
    source: Source<'a>,
    /// The first line of each block, and the line behind its last.
    blocks: Vec<[u32; 2]>,
    pub programs: Vec<Program>,
    /// The index of each program by its name, in capitals, without folders and without `.H`; and whether
    /// the name stands there twice.
    names: HashMap<String, (usize, bool)>,
    /// The first block of each part of the text that lies in no program.
    pub strays: Vec<usize>,
}

/// A program of the text.
#[derive(Debug)]
pub struct Program {
    /// The index of its first block, and the index behind its last.
    pub begin: usize,
    pub end: usize,
    /// The block of each label, and whether it stands there twice.
    labels: HashMap<String, (usize, bool)>,
}

/// A block as it runs.
#[derive(Debug, Clone)]
pub struct Block<'a> {
    /// Without number, comment and marks of continuation.
    pub text: Vec<u8>,
    pieces: Vec<TextPart<'a>>,
    /// The block stands behind a slash.
    pub is_optional: bool,
    /// The length of its lines, with comments.
    pub n_bytes: usize,
}

/// A part of a block that lies in one line.
#[derive(Debug, Clone, Copy)]
struct TextPart<'a> {
    /// Its first byte in the block.
    from: usize,
    line: Line<'a>,
    /// Its first byte in the line.
    column: usize,
}

/// What a line contributes to its block.
struct Content {
    start: usize,
    end: usize,
    continues: bool,
    /// A tilde ends its comment.
    comment_continues: bool,
}

impl<'a> Script<'a> {
    /// Divides a text.
    ///
    /// # Errors
    /// When the budget ends.
    pub fn new(text: &'a [u8], budget: &Budget) -> Result<Self, Stopped> {
        let source = Source::new(text, Language::None);
        let mut script = Self {
            source,
            blocks: Vec::new(),
            programs: Vec::new(),
            names: HashMap::new(),
            strays: Vec::new(),
        };
        script.find_blocks();
        script.find_programs(budget)?;
        Ok(script)
    }

    pub fn n_lines(&self) -> usize {
        self.source.len()
    }

    /// The number of blocks.
    pub fn len(&self) -> usize {
        self.blocks.len()
    }

    fn find_blocks(&mut self) {
        let mut index = 0;
        while index < self.source.len() {
            let first = index;
            let is_cycle = self.begins_cycle(first);
            while content(self.source.line(index), index == first).continues && index + 1 < self.source.len()
            {
                index += 1;
            }
            index += 1;
            // Some texts lack the tilde between the parameters of a cycle, which then have no numbers.
            while is_cycle && index < self.source.len() && is_parameter(self.source.line(index)) {
                index += 1;
            }
            self.blocks.push([first as u32, index as u32]);
        }
    }

    /// Whether a line with a block number begins the definition of a cycle.
    fn begins_cycle(&self, index: usize) -> bool {
        let line = self.source.line(index).trim_ascii_start();
        let (_, start) = header(line);
        let rest = line[start..].to_ascii_uppercase();
        start > 0 && rest.starts_with(b"CYCL DEF")
    }

    fn find_programs(&mut self, budget: &Budget) -> Result<(), Stopped> {
        let (mut is_open, mut is_stray) = (false, false);
        for index in 0..self.len() {
            if index.is_multiple_of(BLOCKS_BETWEEN_CHECKS) {
                budget.check()?;
            }
            let block = self.block(index);
            let mut cursor = Cursor::new(&block.text);
            if cursor.phrase("BEGIN PGM") && self.programs.len() < MAX_PROGRAMS {
                (is_open, is_stray) = (true, false);
                self.begin_program(program_name(cursor.name().unwrap_or_default()), index);
            } else if !is_open {
                if !block.text.is_empty() && !is_stray {
                    is_stray = true;
                    self.strays.push(index);
                }
            } else if cursor.phrase("END PGM") {
                is_open = false;
            } else if cursor.phrase("LBL")
                && let Some(label) = cursor.name().filter(|label| label != "0")
                && let Some(program) = self.programs.last_mut()
            {
                let has_room = program.labels.len() < MAX_LABELS;
                match program.labels.entry(label) {
                    Entry::Occupied(mut entry) => entry.get_mut().1 = true,
                    Entry::Vacant(entry) if has_room => drop(entry.insert((index, false))),
                    Entry::Vacant(_) => {}
                }
            }
        }
        Ok(())
    }

    /// A program begins, and the one before it ends.
    fn begin_program(&mut self, name: String, index: usize) {
        if let Some(program) = self.programs.last_mut() {
            program.end = index;
        }
        let own = (self.programs.len(), false);
        self.names.entry(name).and_modify(|(_, twice)| *twice = true).or_insert(own);
        self.programs.push(Program { begin: index, end: self.len(), labels: HashMap::new() });
    }

    /// The block with this index.
    pub fn block(&self, index: usize) -> Block<'a> {
        let [first, end] = self.blocks.get(index).copied().unwrap_or_default().map(|line| line as usize);
        let mut block = Block { text: Vec::new(), pieces: Vec::new(), is_optional: false, n_bytes: 0 };
        let mut in_comment = false;
        for index in first..end.max(first + 1) {
            let text = self.source.line(index);
            let line = Line { number: index + 1, text };
            block.n_bytes += text.len();
            if index == first {
                block.is_optional = header(text).0;
            }
            if in_comment && text.first().is_none_or(u8::is_ascii_whitespace) {
                continue;
            }
            let Content { start, end, comment_continues, .. } = content(text, index == first);
            if in_comment {
                // Its tilde may be a mistake, and the line may be a block: the control indents comments.
                block.text.push(b'~');
                in_comment = false;
            } else {
                in_comment = comment_continues && !takes_parameters(&block.text, &text[start..end]);
            }
            if !block.text.is_empty() {
                block.text.push(b' ');
            }
            block.pieces.push(TextPart { from: block.text.len(), line, column: start });
            block.text.extend_from_slice(&text[start..end]);
        }
        capitalize(&mut block.text);
        block
    }

    /// The program with this name.
    ///
    /// # Errors
    /// When there is none, or more than one.
    pub fn program(&self, name: &str) -> Result<usize, Fault> {
        match self.names.get(&program_name(name.to_owned())) {
            None => Err(Fault::NoProgram),
            Some((_, true)) => Err(Fault::DoubleLabel),
            Some((index, false)) => Ok(*index),
        }
    }

    /// The block of a label in the program with this index.
    ///
    /// # Errors
    /// When there is none, or more than one.
    pub fn label(&self, program: usize, label: &str) -> Result<usize, Fault> {
        match self.programs.get(program).and_then(|program| program.labels.get(label)) {
            None => Err(Fault::NoLabel),
            Some((_, true)) => Err(Fault::DoubleLabel),
            Some((index, false)) => Ok(*index),
        }
    }
}

impl<'a> Block<'a> {
    /// The first line of the block.
    pub fn line(&self) -> Line<'a> {
        self.pieces.first().map_or(Line { number: 1, text: &[] }, |piece| piece.line)
    }

    /// The line of a byte of the block, and the bytes `start..end` in it.
    pub fn place(&self, start: usize, end: usize) -> (Line<'a>, [usize; 2]) {
        let piece = self.pieces.iter().rev().find(|piece| piece.from <= start).or(self.pieces.first());
        let Some(piece) = piece else { return (self.line(), [0, 0]) };
        let in_line = |at: usize| (at.saturating_sub(piece.from) + piece.column).min(piece.line.text.len());
        (piece.line, [in_line(start), in_line(end)])
    }

    /// The refusal of the bytes `start..end` of the block.
    pub fn refusal(&self, start: usize, end: usize, fault: Fault) -> Refusal {
        let (line, [start, end]) = self.place(start, end);
        line.refusal(start, end, fault)
    }

    /// The refusal of the whole block, which its first line names.
    pub fn refused(&self, fault: Fault) -> Refusal {
        let (line, [start, _]) = self.place(0, 0);
        let Content { end, .. } = content(line.text, true);
        line.refusal(start, end, fault)
    }
}

/// Whether a slash stands at the start of a line, and the first byte of the text of its block.
fn header(line: &[u8]) -> (bool, usize) {
    let (mut at, mut is_optional, mut has_number) = (0, false, false);
    loop {
        match line.get(at) {
            Some(b' ' | b'\t') => at += 1,
            Some(b'/') if !is_optional => {
                is_optional = true;
                at += 1;
            }
            // Some CAM systems number blocks as in other languages.
            Some(b'N' | b'n') if !has_number && line.get(at + 1).is_some_and(u8::is_ascii_digit) => at += 1,
            Some(b'0'..=b'9') if !has_number => {
                has_number = true;
                while line.get(at).is_some_and(u8::is_ascii_digit) {
                    at += 1;
                }
            }
            _ => return (is_optional, at),
        }
    }
}

/// The part of a line that belongs to its block.
fn content(line: &[u8], is_first: bool) -> Content {
    let start = if is_first { header(line).1 } else { line.len() - line.trim_ascii_start().len() };
    let mut is_quoted = false;
    // A structure block is a comment, too.
    let is_structure = is_first && line.get(start) == Some(&b'*');
    let comment = line[start..].iter().position(|c| {
        is_quoted ^= *c == b'"';
        *c == b';' && !is_quoted || is_structure
    });
    let mut end = comment.map_or(line.len(), |at| start + at);
    let trimmed = |end: usize| start + line[start..end].trim_ascii_end().len();
    end = trimmed(end);
    let mut continues = line.ends_with(b"~");
    let comment_continues = continues && comment.is_some();
    if end > start && line[end - 1] == b'~' {
        continues = true;
        end = trimmed(end - 1);
    }
    Content { start, end, continues, comment_continues }
}

/// Whether a line without a block number states a parameter of a cycle.
fn is_parameter(line: &[u8]) -> bool {
    let line = line.trim_ascii_start();
    let digits = line.get(1..).map_or(0, |rest| rest.iter().take_while(|c| c.is_ascii_digit()).count());
    let is_named = matches!(line.first(), Some(b'Q' | b'q')) && digits >= 3;
    is_named && line[1 + digits..].trim_ascii_start().first() == Some(&b'=')
}

/// Whether comments stand between the words of a block that begins like this. In other blocks a comment goes
/// on behind a tilde.
fn takes_parameters(text: &[u8], line: &[u8]) -> bool {
    let mut cursor = Cursor::new(if text.is_empty() { line } else { text });
    let keyword = cursor.keyword().to_ascii_uppercase();
    matches!(keyword.as_slice(), b"CYCL" | b"TCH" | b"PATTERN" | b"CONTOUR" | b"SEL")
}

fn capitalize(text: &mut [u8]) {
    let mut is_quoted = false;
    for byte in text {
        is_quoted ^= *byte == b'"';
        if !is_quoted {
            byte.make_ascii_uppercase();
        }
    }
}

/// The name of a program without folders and without the ending of Klartext files.
fn program_name(name: String) -> String {
    let name = name.to_ascii_uppercase();
    let name = name.rsplit(['\\', '/', ':']).next().unwrap_or_default();
    name.strip_suffix(".H").unwrap_or(name).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &[u8]) -> Script<'_> {
        Script::new(text, &Budget::unlimited()).unwrap()
    }

    #[test]
    fn lines_with_a_tilde_are_one_block_and_comments_are_none() {
        let text = b"0 BEGIN PGM a.h MM\n1 cycl def 200 Bohren ~\n Q200=2 ;Weg ~\n Q201=-3 ;Tiefe\n/ 2 l x+1,5 ; \"\n3 LBL \"aB\"\n4 ;text~\n";
        let script = of(text);
        let texts: Vec<_> =
            (0..script.len()).map(|k| String::from_utf8(script.block(k).text).unwrap()).collect();
        let expected =
            ["BEGIN PGM A.H MM", "CYCL DEF 200 BOHREN Q200=2 Q201=-3", "L X+1,5", "LBL \"aB\"", ""];
        assert_eq!(texts, expected);
        let comments = of(b"1 * - one ~\n two ~\n three\n2 Q1 = 5 ; one ~\n two\n3 L X1 ;a ~\nY5\n");
        let texts: Vec<_> =
            (0..comments.len()).map(|k| String::from_utf8(comments.block(k).text).unwrap()).collect();
        assert_eq!(texts, ["", "Q1 = 5", "L X1~ Y5"]);
        assert!(script.block(2).is_optional);
        let refusal = script.block(1).refusal(27, 34, Fault::NoWord);
        assert_eq!((refusal.line, refusal.column, refusal.word.as_str()), (4, 2, "Q201=-3"));
        assert_eq!((script.program("TNC:\\x\\A.H"), script.label(0, "aB")), (Ok(0), Ok(3)));
    }

    #[test]
    fn parameters_without_numbers_belong_to_the_cycle_before_them() {
        let script = of(b"1 CYCL DEF 200 X\nQ200=2\nQ201=-3\n2 L X1");
        assert_eq!(
            (script.len(), script.block(0).text.as_slice()),
            (2, b"CYCL DEF 200 X Q200=2 Q201=-3".as_slice())
        );
    }
}
