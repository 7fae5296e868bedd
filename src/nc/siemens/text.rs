//! The text of SINUMERIK programs as lines, with programs, labels and the ends of branches and loops.
//!
//! # Method
//! 1. A text holds one program, or several, each behind a header such as `%_N_PART_MPF` or with its own PROC.
//! 2. Labels and block numbers are found once, those of one program apart from those of others.
//! 3. IF, WHILE, FOR, LOOP and REPEAT are paired with their ends once, so that a loop needs no stack.

use std::collections::HashMap;
use std::ops::Range;

/// The keyword with which a line of a branch or a loop begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Keyword {
    If,
    Else,
    EndIf,
    While,
    EndWhile,
    For,
    EndFor,
    Loop,
    EndLoop,
    Repeat,
    Until,
}

/// A place to which a jump leads.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Label {
    Name(String),
    Number(u32),
}

/// One program of the text.
#[derive(Debug, Clone)]
struct Program {
    name: String,
    lines: Range<usize>,
    is_main: bool,
}

/// What stands before the words of a line.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Front {
    pub is_optional: bool,
    pub number: Option<u32>,
    pub label: Option<String>,
    /// The byte where the words begin.
    pub end: usize,
}

/// A text as lines.
pub struct Text<'a> {
    lines: Vec<&'a [u8]>,
    programs: Vec<Program>,
    /// The index of each program by its name.
    names: HashMap<String, usize>,
    /// The lines of each label, in order.
    labels: HashMap<Label, Vec<usize>>,
    /// The line that belongs to a line of a branch or a loop: of IF its ELSE or ENDIF, of the others the
    /// other end.
    partners: HashMap<usize, usize>,
    /// Whether any block changes the tool by M6.
    pub has_m6: bool,
}

impl<'a> Text<'a> {
    pub fn new(text: &'a [u8]) -> Self {
        let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
        let mut lines: Vec<&[u8]> = Vec::new();
        let mut rest = text;
        while !rest.is_empty() {
            let end = rest.iter().position(|c| matches!(c, b'\n' | b'\r')).unwrap_or(rest.len());
            lines.push(rest[..end].trim_ascii_end());
            let ends_twice = rest[end..].starts_with(b"\r\n");
            rest = rest.get(end + if ends_twice { 2 } else { 1 }..).unwrap_or_default();
        }
        let programs = programs(&lines);
        let mut names = HashMap::new();
        for (index, program) in programs.iter().enumerate() {
            names.entry(program.name.clone()).or_insert(index);
        }
        let mut text =
            Self { lines, programs, names, labels: HashMap::new(), partners: HashMap::new(), has_m6: false };
        text.find_places();
        text
    }

    pub fn len(&self) -> usize {
        self.lines.len()
    }

    /// The line with this index, without its end.
    pub fn line(&self, index: usize) -> &'a [u8] {
        self.lines.get(index).copied().unwrap_or_default()
    }

    /// The lines of the main program: the first that is called so, else the first.
    pub fn main(&self) -> Range<usize> {
        let main = self.programs.iter().find(|program| program.is_main).or(self.programs.first());
        main.map_or(0..0, |program| program.lines.clone())
    }

    /// The lines of the program with this name, in upper case.
    pub fn program(&self, name: &str) -> Option<Range<usize>> {
        let short = name.strip_suffix("_SPF").or(name.strip_suffix("_MPF")).unwrap_or(name);
        let short = short.strip_prefix("_N_").unwrap_or(short);
        self.names.get(short).map(|index| self.programs[*index].lines.clone())
    }

    /// The lines of this label in `within`.
    pub fn labeled(&self, label: &Label, within: &Range<usize>) -> &[usize] {
        let lines = self.labels.get(label).map_or(&[][..], Vec::as_slice);
        let start = lines.partition_point(|line| *line < within.start);
        let end = lines.partition_point(|line| *line < within.end);
        &lines[start..end]
    }

    /// The line that belongs to the branch or the loop of a line.
    pub fn partner(&self, index: usize) -> Option<usize> {
        self.partners.get(&index).copied()
    }

    fn find_places(&mut self) {
        for program in self.programs.clone() {
            let mut open: Vec<(Keyword, usize)> = Vec::new();
            for index in program.lines {
                let line = self.lines[index];
                let front = front(line);
                if let Some(label) = front.label {
                    self.labels.entry(Label::Name(label)).or_default().push(index);
                }
                if let Some(number) = front.number {
                    self.labels.entry(Label::Number(number)).or_default().push(index);
                }
                let words = &line[front.end..comment_start(line).max(front.end)];
                self.has_m6 |= has_m6(words);
                if let Some(keyword) = keyword(words) {
                    self.pair(&mut open, keyword, index);
                }
            }
        }
    }

    fn pair(&mut self, open: &mut Vec<(Keyword, usize)>, keyword: Keyword, index: usize) {
        use Keyword::*;
        let begins: &[Keyword] = match keyword {
            If | While | For | Loop | Repeat => return open.push((keyword, index)),
            Else => &[If],
            EndIf => &[If, Else],
            EndWhile => &[While],
            EndFor => &[For],
            EndLoop => &[Loop],
            Until => &[Repeat],
        };
        let Some((_, start)) = open.pop_if(|(own, _)| begins.contains(own)) else { return };
        self.partners.insert(start, index);
        match keyword {
            Else => open.push((Else, index)),
            _ => {
                self.partners.insert(index, start);
            }
        }
    }
}

/// The programs of the lines, in order; at least one.
fn programs(lines: &[&[u8]]) -> Vec<Program> {
    let mut programs = vec![Program { name: String::new(), lines: 0..lines.len(), is_main: false }];
    // Whether the program so far has a block that runs.
    let mut has_blocks = false;
    for (index, line) in lines.iter().enumerate() {
        let found = header(line).map(|(name, is_main)| (name, is_main, index + 1));
        let found = found.or_else(|| proc_name(line).map(|name| (name, false, index)));
        let Some((name, is_main, start)) = found else {
            let front = front(line).end;
            has_blocks |= comment_start(line) > front && !is_tape_mark(line);
            continue;
        };
        let is_header = start == index + 1;
        if let Some(last) = programs.last_mut() {
            if !is_header && !has_blocks && !last.name.is_empty() {
                // The PROC of the program whose header stands before.
                has_blocks = true;
                continue;
            }
            last.lines.end = index;
        }
        if !has_blocks && programs.len() == 1 {
            programs.clear();
        }
        programs.push(Program { name, lines: start..lines.len(), is_main });
        has_blocks = !is_header;
    }
    programs
}

/// The name in `%_N_NAME_MPF`, and whether it is that of a main program. `%` with a plain name counts too.
fn header(line: &[u8]) -> Option<(String, bool)> {
    let name = line.trim_ascii().strip_prefix(b"%")?;
    let name: String = name.iter().map(|c| c.to_ascii_uppercase() as char).collect();
    let name = name.split([' ', ';', '\t']).next().filter(|name| !name.is_empty())?;
    let name = name.strip_prefix("_N_").unwrap_or(name);
    let is_main = name.ends_with("_MPF");
    let name = name.strip_suffix("_MPF").or(name.strip_suffix("_SPF")).unwrap_or(name);
    Some((name.to_owned(), is_main))
}

/// Whether a line is a percent sign alone, as serial lines had it at both ends of a program.
pub fn is_tape_mark(line: &[u8]) -> bool {
    line.trim_ascii() == b"%"
}

/// The name behind PROC.
fn proc_name(line: &[u8]) -> Option<String> {
    let front = front(line);
    let (word, end) = name_at(line, front.end)?;
    if word != "PROC" {
        return None;
    }
    name_at(line, blanks(line, end)).map(|(name, _)| name)
}

/// Whether words change the tool. Texts in quotes are no words.
fn has_m6(words: &[u8]) -> bool {
    let is_end = |at: usize| !words.get(at).is_some_and(u8::is_ascii_alphanumeric);
    let begins = |at: usize| at == 0 || !words[at - 1].is_ascii_alphabetic() && words[at - 1] != b'_';
    let mut is_quoted = false;
    (0..words.len()).any(|at| {
        is_quoted ^= words[at] == b'"';
        let length = match &words[at..] {
            [b'M' | b'm', b'6', ..] => 2,
            [b'M' | b'm', b'0', b'6', ..] => 3,
            _ => return false,
        };
        !is_quoted && begins(at) && is_end(at + length)
    })
}

/// What stands before the words of a line.
pub fn front(line: &[u8]) -> Front {
    let mut front = Front::default();
    let mut at = blanks(line, 0);
    if line.get(at) == Some(&b'/') {
        front.is_optional = true;
        at += 1;
        at += usize::from(line.get(at).is_some_and(u8::is_ascii_digit));
        at = blanks(line, at);
    }
    if matches!(line.get(at), Some(b'N' | b'n' | b':')) {
        let digits = line[at + 1..].iter().take_while(|c| c.is_ascii_digit()).count();
        let text = std::str::from_utf8(&line[at + 1..at + 1 + digits]).unwrap_or_default();
        if digits > 0 {
            front.number = text.parse().ok();
            at = blanks(line, at + 1 + digits);
        }
    }
    if line.get(at) == Some(&b'/') && !front.is_optional {
        front.is_optional = true;
        at += 1;
        at += usize::from(line.get(at).is_some_and(u8::is_ascii_digit));
        at = blanks(line, at);
    }
    if let Some((name, end)) = name_at(line, at) {
        let colon = blanks(line, end);
        if line.get(colon) == Some(&b':') && line.get(colon + 1) != Some(&b'=') {
            front.label = Some(name);
            at = blanks(line, colon + 1);
        }
    }
    front.end = at;
    front
}

/// The name at a byte, in upper case, and the byte behind it. A name begins with two letters or underscores.
pub fn name_at(line: &[u8], at: usize) -> Option<(String, usize)> {
    let is_letter = |at: usize| line.get(at).is_some_and(|c| c.is_ascii_alphabetic() || *c == b'_');
    if !is_letter(at) || !is_letter(at + 1) {
        return None;
    }
    let length = line[at..].iter().take_while(|c| c.is_ascii_alphanumeric() || **c == b'_').count();
    let name = line[at..at + length].iter().map(|c| c.to_ascii_uppercase() as char).collect();
    Some((name, at + length))
}

/// The byte where the comment of a line begins; the end of the line without one.
pub fn comment_start(line: &[u8]) -> usize {
    let mut is_in_string = false;
    for (at, byte) in line.iter().enumerate() {
        match byte {
            b'"' => is_in_string = !is_in_string,
            b';' if !is_in_string => return line[..at].trim_ascii_end().len(),
            _ => {}
        }
    }
    line.trim_ascii_end().len()
}

/// The byte behind the blanks at `at`.
pub fn blanks(line: &[u8], at: usize) -> usize {
    let rest = line.get(at..).unwrap_or_default();
    rest.iter().position(|c| !matches!(c, b' ' | b'\t')).map_or(line.len(), |gap| at + gap)
}

/// The keyword of a branch or a loop with which words begin. IF with a jump and REPEAT with a label are none.
pub fn keyword(words: &[u8]) -> Option<Keyword> {
    let (name, end) = name_at(words, 0)?;
    Some(match name.as_str() {
        "IF" if !has_jump(&words[end..]) => Keyword::If,
        "ELSE" => Keyword::Else,
        "ENDIF" => Keyword::EndIf,
        "WHILE" => Keyword::While,
        "ENDWHILE" => Keyword::EndWhile,
        "FOR" => Keyword::For,
        "ENDFOR" => Keyword::EndFor,
        "LOOP" => Keyword::Loop,
        "ENDLOOP" => Keyword::EndLoop,
        "REPEAT" if blanks(words, end) == words.len() => Keyword::Repeat,
        "UNTIL" => Keyword::Until,
        _ => return None,
    })
}

/// Whether a name that begins with GOTO stands among words.
fn has_jump(words: &[u8]) -> bool {
    let upper = words.to_ascii_uppercase();
    let is_name = |c: u8| c.is_ascii_alphanumeric() || c == b'_';
    (0..upper.len()).any(|at| upper[at..].starts_with(b"GOTO") && (at == 0 || !is_name(upper[at - 1])))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn programs_begin_with_headers_or_with_proc() {
        let text =
            b"%_N_SUB_SPF\r\n;$PATH=/_N_SPF_DIR\r\nPROC SUB(REAL A)\r\nM17\r\n%_N_MAIN_MPF\r\nG0\r\nM30";
        let text = Text::new(text);
        assert_eq!((text.main(), text.program("SUB")), (5..7, Some(1..4)));
        let text = Text::new(b"G0\nM30\nPROC ONE\nRET\nPROC TWO\nRET");
        assert_eq!((text.main(), text.program("ONE"), text.program("TWO")), (0..2, Some(2..4), Some(4..6)));
        assert_eq!(Text::new(b"").main(), 0..0);
    }

    #[test]
    fn fronts_hold_block_delete_number_and_label() {
        let of = |line: &str| front(line.as_bytes());
        assert_eq!(of("/1 N10 G0"), Front { is_optional: true, number: Some(10), label: None, end: 7 });
        let labeled = of("N10 END_1: G0");
        assert_eq!((labeled.label.as_deref(), labeled.end), (Some("END_1"), 11));
        assert_eq!((of(":20G1").number, of("X10").end, of("").end), (Some(20), 0, 0));
    }

    #[test]
    fn loops_are_paired_with_their_ends() {
        let text = Text::new(b"IF R1==1\nELSE\nENDIF\nFOR R1=1 TO 3\nIF R1 GOTOF AB\nENDFOR\nENDLOOP");
        let partners: Vec<_> = (0..7).map(|k| text.partner(k)).collect();
        assert_eq!(partners, [Some(1), Some(2), Some(1), Some(5), None, Some(3), None]);
    }
}
