//! The text of a program as lines, with the places to which calls and jumps lead.

use std::collections::HashMap;
use std::ops::Range;

use super::control::Language;

/// A text as lines.
pub struct Source<'a> {
    text: &'a [u8],
    /// The start of each line, and the end of the text.
    starts: Vec<usize>,
    /// The lines of program numbers (O or a colon) in the language of Fanuc, in order.
    programs: Vec<(u32, usize)>,
    /// The line of `sub` of each label in the language of LinuxCNC.
    subs: HashMap<String, usize>,
    /// The lines of each block number, made when a jump needs them.
    numbers: Option<HashMap<u32, Vec<usize>>>,
}

impl<'a> Source<'a> {
    pub fn new(text: &'a [u8], language: Language) -> Self {
        let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
        let mut starts = vec![0];
        let mut at = 0;
        while at < text.len() {
            let rest = &text[at..];
            at += match rest.iter().position(|c| matches!(c, b'\n' | b'\r')) {
                Some(end) if rest[end..].starts_with(b"\r\n") => end + 2,
                Some(end) => end + 1,
                None => rest.len(),
            };
            starts.push(at);
        }
        let mut source = Self { text, starts, programs: Vec::new(), subs: HashMap::new(), numbers: None };
        source.find_programs(language);
        source
    }

    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// The line with this index, without its end.
    pub fn line(&self, index: usize) -> &'a [u8] {
        let Some([start, end]) = self.starts.get(index..index + 2).map(|ends| [ends[0], ends[1]]) else {
            return &[];
        };
        self.text[start..end].trim_ascii_end()
    }

    fn find_programs(&mut self, language: Language) {
        for index in 0..self.len() {
            let line = self.line(index);
            let (_, at) = block_number(line);
            let rest = &line[at..];
            match rest.first() {
                Some(b'O' | b'o' | b':') if language != Language::LinuxCnc => {
                    if let Some(number) = whole(&rest[1..]).0 {
                        self.programs.push((number, index));
                    }
                }
                Some(b'O' | b'o') => {
                    if let Some((label, end)) = label(&rest[1..])
                        && starts_with_word(&rest[1 + end..], "sub")
                    {
                        self.subs.entry(label).or_insert(index);
                    } else if let Some(number) = whole(&rest[1..]).0 {
                        // `O100` alone begins a program that `M98` calls.
                        self.programs.push((number, index));
                    }
                }
                _ => {}
            }
        }
    }

    /// The line of the program with this number.
    pub fn program(&self, number: u32) -> Option<usize> {
        self.programs.iter().find(|(own, _)| *own == number).map(|(_, line)| *line)
    }

    /// The line of `sub` with this label.
    pub fn sub(&self, label: &str) -> Option<usize> {
        self.subs.get(label).copied()
    }

    /// The lines of the program in which `index` lies.
    fn extent(&self, index: usize) -> Range<usize> {
        let next = self.programs.partition_point(|(_, line)| *line <= index);
        let start = next.checked_sub(1).map_or(0, |k| self.programs[k].1);
        start..self.programs.get(next).map_or(self.len(), |(_, line)| *line)
    }

    /// The line of block `number` in the program of line `from`: the next such line, else the first.
    pub fn numbered(&mut self, number: u32, from: usize) -> Option<usize> {
        let extent = self.extent(from);
        if self.numbers.is_none() {
            let mut numbers: HashMap<u32, Vec<usize>> = HashMap::new();
            for index in 0..self.len() {
                if let (Some(own), _) = block_number(self.line(index)) {
                    numbers.entry(own).or_default().push(index);
                }
            }
            self.numbers = Some(numbers);
        }
        let lines = self.numbers.as_ref()?.get(&number)?;
        let lines = &lines[lines.partition_point(|line| *line < extent.start)..];
        let lines = &lines[..lines.partition_point(|line| *line < extent.end)];
        lines.get(lines.partition_point(|line| *line <= from)).or(lines.first()).copied()
    }
}

/// The block number of a line, and the byte behind block delete and number.
pub fn block_number(line: &[u8]) -> (Option<u32>, usize) {
    let mut at = blanks(line, 0);
    if line.get(at) == Some(&b'/') {
        at += 1;
        while line.get(at).is_some_and(u8::is_ascii_digit) {
            at += 1;
        }
        at = blanks(line, at);
    }
    if matches!(line.get(at), Some(b'N' | b'n')) {
        let digits = blanks(line, at + 1);
        let (number, length) = whole(&line[digits..]);
        if number.is_some() {
            return (number, blanks(line, digits + length));
        }
    }
    (None, at)
}

/// The whole number at the start, and the length of its text.
pub fn whole(text: &[u8]) -> (Option<u32>, usize) {
    let length = text.iter().position(|c| !c.is_ascii_digit()).unwrap_or(text.len());
    let number = std::str::from_utf8(&text[..length]).ok().and_then(|digits| digits.parse().ok());
    (number, length)
}

/// The label of an O word: digits, or a name between `<` and `>`; and the length of its text.
pub fn label(text: &[u8]) -> Option<(String, usize)> {
    if text.first() == Some(&b'<') {
        let end = text.iter().position(|c| *c == b'>')?;
        let letters = text[1..end].iter().filter(|c| !c.is_ascii_whitespace());
        return Some((letters.map(|c| c.to_ascii_lowercase() as char).collect(), end + 1));
    }
    let (number, length) = whole(text);
    number.map(|number| (number.to_string(), length))
}

/// Whether a keyword stands at the start, after blanks.
pub fn starts_with_word(text: &[u8], word: &str) -> bool {
    let rest = &text[blanks(text, 0)..];
    let is_found = rest.get(..word.len()).is_some_and(|text| text.eq_ignore_ascii_case(word.as_bytes()));
    is_found && !rest.get(word.len()).is_some_and(u8::is_ascii_alphabetic)
}

/// The byte behind the blanks at `at`.
pub fn blanks(line: &[u8], at: usize) -> usize {
    line[at..].iter().position(|c| !matches!(c, b' ' | b'\t')).map_or(line.len(), |gap| at + gap)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_in_every_way_and_a_mark_of_order_is_no_text() {
        let source = Source::new(b"\xef\xbb\xbfG0\r\nG1\rG2\n\nG3", Language::Fanuc);
        let lines: Vec<_> = (0..source.len()).map(|k| source.line(k)).collect();
        assert_eq!(lines, [b"G0".as_slice(), b"G1", b"G2", b"", b"G3"]);
    }

    #[test]
    fn a_jump_leads_to_the_next_block_of_its_program() {
        let text = b"O1\nN10 G0\nN20\nN10\nM99\nO2\nN10\n/N 30 G0";
        let mut source = Source::new(text, Language::Fanuc);
        assert_eq!((source.numbered(10, 0), source.numbered(10, 1)), (Some(1), Some(3)));
        assert_eq!((source.numbered(10, 3), source.numbered(10, 5)), (Some(1), Some(6)));
        assert_eq!((source.numbered(20, 6), source.numbered(30, 5)), (None, Some(7)));
        assert_eq!(source.program(2), Some(5));
    }

    #[test]
    fn subs_are_found_by_name_or_number() {
        let source = Source::new(b"o100 sub\no100 endsub\nO<A b>SUB\n", Language::LinuxCnc);
        assert_eq!((source.sub("100"), source.sub("ab"), source.sub("x")), (Some(0), Some(2), None));
    }
}
