//! Lines that steer a program: IF, WHILE, GOTO and END of Fanuc, and the O words of LinuxCNC.

use super::control::Language;
use super::source::{blanks, block_number, label, starts_with_word, whole};

/// What a line is, by its first words. Numbers are places in the line where the rest begins.
#[derive(Debug, Clone, PartialEq)]
pub enum Statement {
    /// A block of words that begins there.
    Words(usize),
    /// A program number.
    ProgramNumber,
    /// `IF`: the condition begins there.
    If(usize),
    /// `WHILE` or a plain `DO`; the condition begins there.
    While(Option<usize>),
    /// `END` with its number.
    End(u32),
    /// `GOTO`: the number begins there.
    Goto(usize),
    /// A word of LinuxCNC with its label; the rest begins there.
    Oword(String, Keyword, usize),
    /// An O word whose label or keyword is unknown, from there on.
    UnknownO(usize),
}

/// The keywords behind a label of LinuxCNC.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Keyword {
    Sub,
    EndSub,
    Call,
    Return,
    Do,
    While,
    EndWhile,
    Repeat,
    EndRepeat,
    Break,
    Continue,
    If,
    ElseIf,
    Else,
    EndIf,
}

/// Longer keywords stand before those that begin them.
const KEYWORDS: [(&str, Keyword); 15] = [
    ("sub", Keyword::Sub),
    ("endsub", Keyword::EndSub),
    ("call", Keyword::Call),
    ("return", Keyword::Return),
    ("do", Keyword::Do),
    ("while", Keyword::While),
    ("endwhile", Keyword::EndWhile),
    ("repeat", Keyword::Repeat),
    ("endrepeat", Keyword::EndRepeat),
    ("break", Keyword::Break),
    ("continue", Keyword::Continue),
    ("if", Keyword::If),
    ("elseif", Keyword::ElseIf),
    ("else", Keyword::Else),
    ("endif", Keyword::EndIf),
];

/// What this line is.
pub fn statement(line: &[u8], language: Language) -> Statement {
    let (_, at) = block_number(line);
    let Some(first) = line.get(at) else { return Statement::Words(0) };
    match first.to_ascii_uppercase() {
        b'O' | b':' if language != Language::LinuxCnc => match whole(&line[at + 1..]) {
            (Some(_), _) => Statement::ProgramNumber,
            _ => Statement::UnknownO(at),
        },
        b'O' => {
            let start = blanks(line, at + 1);
            let Some((name, end)) = label(&line[start..]) else { return Statement::UnknownO(at) };
            let rest = blanks(line, start + end);
            let keyword = KEYWORDS.iter().find(|(word, _)| starts_with_word(&line[rest..], word));
            match keyword {
                Some((word, keyword)) => Statement::Oword(name, *keyword, rest + word.len()),
                None if is_bare(&line[rest..]) && name.bytes().all(|c| c.is_ascii_digit()) => {
                    Statement::ProgramNumber
                }
                None => Statement::UnknownO(at),
            }
        }
        b'I' | b'W' | b'D' | b'E' | b'G' if language == Language::Fanuc => {
            let rest = &line[at..];
            let number_of_end = || whole(&line[blanks(line, at + "END".len())..]).0;
            if starts_with_word(rest, "IF") {
                Statement::If(at + 2)
            } else if starts_with_word(rest, "WHILE") {
                Statement::While(Some(at + 5))
            } else if starts_with_word(rest, "GOTO") {
                Statement::Goto(at + 4)
            } else if starts_with_word(rest, "DO") {
                Statement::While(None)
            } else if let Some(number) = starts_with_word(rest, "END").then(number_of_end).flatten() {
                Statement::End(number)
            } else {
                Statement::Words(0)
            }
        }
        _ => Statement::Words(0),
    }
}

/// The number behind DO in a line.
pub fn number_of_do(line: &[u8], from: usize) -> Option<u32> {
    let at = (from..line.len()).find(|at| starts_with_word(&line[*at..], "DO"))?;
    let at = blanks(line, blanks(line, at) + 2);
    whole(&line[at..]).0
}

/// Whether nothing but blanks and comments stands there.
pub fn is_bare(rest: &[u8]) -> bool {
    let rest = rest.trim_ascii();
    rest.is_empty() || rest[0] == b'(' || rest[0] == b';'
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_words_tell_what_a_line_is() {
        let fanuc = |text: &str| statement(text.as_bytes(), Language::Fanuc);
        assert_eq!(fanuc("N10 IF[#1 GT 2]GOTO 5"), Statement::If(6));
        assert_eq!(fanuc("WHILE [#1 LT 2] DO 1"), Statement::While(Some(5)));
        assert_eq!((fanuc("END 1"), fanuc("END1")), (Statement::End(1), Statement::End(1)));
        assert_eq!((fanuc("G0 X1"), fanuc("O0012 (A)")), (Statement::Words(0), Statement::ProgramNumber));
        assert_eq!(number_of_do(b"WHILE [#1 LT 2] DO 3", 5), Some(3));
        let linuxcnc = |text: &str| statement(text.as_bytes(), Language::LinuxCnc);
        assert_eq!(linuxcnc("o100 while [1]"), Statement::Oword("100".into(), Keyword::While, 10));
        assert_eq!(linuxcnc("O<A> call [1]"), Statement::Oword("a".into(), Keyword::Call, 9));
        assert_eq!(linuxcnc("o#1 call"), Statement::UnknownO(0));
        assert_eq!(linuxcnc("O5 (a)"), Statement::ProgramNumber);
    }
}
