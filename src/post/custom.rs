//! A shop's own lines in a program: what they may hold.
//!
//! A line must not end, leave or skip a part of the program, must not change what later coordinates mean
//! where the program does not restate it, and moves nothing but to places of the machine. Calls of the shop's
//! own programs and macros are allowed; what those do is the shop's.
//!
//! The program restates its modes behind such lines, and the reader that checks the program takes every mode
//! and the position for unknown behind them.

use std::ops::Range;

use super::dialect::{Dialect, Syntax};
use super::nc::{Effect, Function, Lexer, Place, Token, effect, function};
use crate::toolpath::program::Custom;

/// Most lines of one place.
pub const MAX_LINES: usize = 50;

/// Room for a block number beside a line.
const NUMBER_LENGTH: usize = 12;

/// G28, G30, G53 and G65, in tenths: a move to a place of the machine, or the call of a macro with values.
const WITH_AXIS_WORDS: [i32; 4] = [280, 300, 530, 650];

/// Codes after which lines of other programs run, and then the next line of this one.
const CALLS: [i32; 2] = [980, 1980];

/// What other controls take for a command in a comment.
const ACTIVE_COMMENTS: [&str; 6] = ["LOG", "DEBUG", "PROBEOPEN", "PROBECLOSE", "PRINT", "MSG"];

/// Where a line stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CustomPart {
    Header,
    ToolChange,
    Footer,
}

/// Why a line is refused.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CustomFault {
    #[error("the line is empty; leave it out")]
    Empty,
    #[error("the line has {found} characters; send at most {most}")]
    TooLong { found: usize, most: usize },
    #[error("the line holds {0:?}, which has no place in a program; send printable ASCII without `%`")]
    Character(char),
    #[error(
        "the line cannot be read from {0:?} on; send words of a letter and a number, or a comment in parentheses"
    )]
    Unreadable(String),
    #[error(
        "{0:?} has no place in a line of your own: it would end or leave the program, or change what later blocks mean"
    )]
    Forbidden(String),
    #[error("the line moves an axis; lines of your own may move only with G28, G30 or G53, or with M91")]
    Moves,
    #[error("the dialect has no place for lines of your own; leave `custom` out, or choose another dialect")]
    NoPlace,
}

/// A line that is refused, by its place and its index.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Refused {
    pub part: CustomPart,
    pub index: usize,
    pub fault: CustomFault,
}

/// All lines that are refused.
pub fn refused(dialect: &Dialect, custom: &Custom) -> Vec<Refused> {
    let parts = [
        (CustomPart::Header, &custom.header),
        (CustomPart::ToolChange, &custom.tool_change),
        (CustomPart::Footer, &custom.footer),
    ];
    let of_part = |(part, lines): (CustomPart, &Vec<String>)| {
        let faults = lines.iter().enumerate().filter_map(move |(index, line)| {
            check(dialect, line).err().map(|fault| Refused { part, index, fault })
        });
        faults.collect::<Vec<_>>()
    };
    parts.into_iter().flat_map(of_part).collect()
}

fn check(dialect: &Dialect, line: &str) -> Result<(), CustomFault> {
    let most = dialect.max_line_length - NUMBER_LENGTH;
    if line.trim().is_empty() {
        return Err(CustomFault::Empty);
    }
    if line.chars().count() > most {
        return Err(CustomFault::TooLong { found: line.chars().count(), most });
    }
    if let Some(c) = line.chars().find(|c| !(' '..='~').contains(c) || *c == '%') {
        return Err(CustomFault::Character(c));
    }
    match dialect.syntax {
        Syntax::Iso(_) => check_words(line),
        Syntax::Siemens(_) => check_siemens(line),
        Syntax::Klartext => check_klartext(line),
        Syntax::Deckel => Err(CustomFault::NoPlace),
    }
}

/// A line of ISO words and comments in parentheses.
fn check_words(line: &str) -> Result<(), CustomFault> {
    let (mut has_axis, mut may_move) = (false, false);
    for (place, token) in Lexer::new(line.as_bytes()) {
        let text = &line[place.clone()];
        match token {
            Token::Word { letter, number, .. } => {
                let number = std::str::from_utf8(number).unwrap_or_default();
                let (axis, home) = check_word(letter, number, &line[place])?;
                has_axis |= axis;
                may_move |= home;
            }
            Token::Comment { is_closed: true } if is_plain_comment(text) => {}
            Token::Comment { .. } | Token::BlockDelete | Token::TapeMark | Token::Unknown => {
                return Err(CustomFault::Unreadable(line[place.start..].to_owned()));
            }
        }
    }
    if has_axis && !may_move { Err(CustomFault::Moves) } else { Ok(()) }
}

/// Whether a comment is in parentheses, and no control acts on it.
fn is_plain_comment(text: &str) -> bool {
    let Some(inside) = text.strip_prefix('(').and_then(|rest| rest.strip_suffix(')')) else { return false };
    let word = inside.trim_start().to_ascii_uppercase();
    let is_allowed = |c: char| c.is_ascii_alphanumeric() || " ._-/+,='*".contains(c);
    inside.chars().all(is_allowed) && !ACTIVE_COMMENTS.iter().any(|active| word.starts_with(active))
}

/// Whether a word moves an axis, and whether it allows its line to do so.
fn check_word(letter: u8, number: &str, text: &str) -> Result<(bool, bool), CustomFault> {
    let value: f64 = number.parse().map_err(|_| CustomFault::Unreadable(text.to_owned()))?;
    let tenths = (value * 10.0).round() as i32;
    let forbidden = || Err(CustomFault::Forbidden(text.to_owned()));
    match letter {
        b'G' => match effect(tenths) {
            _ if WITH_AXIS_WORDS.contains(&tenths) => Ok((false, true)),
            Effect::Begins(..) | Effect::Units(_) | Effect::Centers(_) => forbidden(),
            Effect::Place(Place::Taken | Place::Elsewhere) => forbidden(),
            _ => Ok((false, false)),
        },
        b'M' => match function(tenths) {
            Function::Ends | Function::Restores => forbidden(),
            Function::Leaves if !CALLS.contains(&tenths) => forbidden(),
            _ => Ok((false, false)),
        },
        b'N' | b'O' => forbidden(),
        b'A' | b'B' | b'C' | b'I' | b'J' | b'K' | b'U' | b'V' | b'W' | b'X' | b'Y' | b'Z' => {
            Ok((true, false))
        }
        _ => Ok((false, false)),
    }
}

/// Names that a line of a Siemens program may hold besides words.
const SIEMENS_NAMES: [&str; 12] = [
    "SUPA", "CYCLE800", "CYCLE832", "COMPCAD", "COMPCURV", "COMPOF", "FFWON", "FFWOF", "SOFT", "BRISK",
    "STOPRE", "MSG",
];

/// A line of words and of [`SIEMENS_NAMES`], some of them with arguments, and a comment behind a semicolon.
fn check_siemens(line: &str) -> Result<(), CustomFault> {
    let code = line.split(';').next().unwrap_or_default();
    let (mut has_axis, mut may_move) = (false, false);
    let mut rest = code.trim_start();
    while !rest.is_empty() {
        let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let name = &rest[..rest.find(|c| !is_name(c)).unwrap_or(rest.len())];
        if let Some(known) = SIEMENS_NAMES.iter().find(|known| name.eq_ignore_ascii_case(known)) {
            may_move |= *known == "SUPA";
            rest = arguments(rest[name.len()..].trim_start())?;
        } else if let Some(after) = rest.strip_prefix("T=") {
            rest = quoted(after)?;
        } else {
            let Some((place, Token::Word { letter, number, .. })) = Lexer::new(rest.as_bytes()).next() else {
                return Err(CustomFault::Unreadable(rest.to_owned()));
            };
            let number = std::str::from_utf8(number).unwrap_or_default();
            let text = &rest[place.clone()];
            if letter == b'M' && number == "17" {
                return Err(CustomFault::Forbidden(text.to_owned()));
            }
            // L calls a program; it is a word like others.
            let (axis, home) = check_word(letter, number, text)?;
            has_axis |= axis;
            may_move |= home;
            rest = &rest[place.end..];
            if rest.starts_with(is_name) && !rest.starts_with(|c: char| c.is_ascii_alphabetic()) {
                return Err(CustomFault::Unreadable(rest.to_owned()));
            }
        }
        rest = rest.trim_start();
    }
    if has_axis && !may_move { Err(CustomFault::Moves) } else { Ok(()) }
}

/// What follows arguments in parentheses, or the text itself without them. Arguments are numbers and strings.
fn arguments(text: &str) -> Result<&str, CustomFault> {
    let Some(mut rest) = text.strip_prefix('(') else { return Ok(text) };
    loop {
        match rest.chars().next() {
            Some(')') => return Ok(&rest[1..]),
            Some('"') => rest = quoted(rest)?,
            Some(c) if c.is_ascii_digit() || " ,.-+".contains(c) => rest = &rest[1..],
            _ => return Err(CustomFault::Unreadable(text.to_owned())),
        }
    }
}

/// What follows a string in quotes.
fn quoted(text: &str) -> Result<&str, CustomFault> {
    let end = text.strip_prefix('"').and_then(|inside| inside.find('"'));
    end.map(|end| &text[end + 2..]).ok_or_else(|| CustomFault::Unreadable(text.to_owned()))
}

/// Beginnings of Klartext blocks that a line may be.
const KLARTEXT_BLOCKS: [&str; 7] =
    [";", "STOP", "TOOL CALL ", "TOOL DEF ", "CALL PGM ", "CYCL DEF 32.", "CYCL DEF 247 "];

/// The end of a program, the calls of cycles, and moves to places of the machine.
const FORBIDDEN_M: [f64; 7] = [2.0, 30.0, 89.0, 91.0, 92.0, 98.0, 99.0];

/// A Klartext block that calls, comments, or moves to a place of the machine.
fn check_klartext(line: &str) -> Result<(), CustomFault> {
    let line = line.trim();
    if let Some(at) = line.find('~') {
        return Err(CustomFault::Unreadable(line[at..].to_owned()));
    }
    if KLARTEXT_BLOCKS.iter().any(|block| line.starts_with(block)) {
        return Ok(());
    }
    let mut words = line.split_ascii_whitespace();
    let first = words.next().unwrap_or_default();
    let is_move = first == "L";
    let mut is_of_machine = false;
    let rest = if is_move { "" } else { first };
    for word in std::iter::once(rest).chain(words).filter(|word| !word.is_empty()) {
        let number = |prefix: char| word.strip_prefix(prefix).and_then(|number| number.parse::<f64>().ok());
        match word {
            "R0" | "FMAX" if is_move => {}
            "M91" | "M92" if is_move => is_of_machine = true,
            _ if word.contains('.') && word.starts_with('M') => {
                return Err(CustomFault::Unreadable(word.to_owned()));
            }
            _ if number('M').is_some_and(|m| FORBIDDEN_M.contains(&m)) => {
                return Err(CustomFault::Forbidden(word.to_owned()));
            }
            _ if number('M').is_some_and(|m| m.is_finite() && m >= 0.0) => {}
            _ if is_move && ['X', 'Y', 'Z'].iter().any(|&axis| number(axis).is_some()) => {}
            _ => return Err(CustomFault::Unreadable(word.to_owned())),
        }
    }
    if is_move && !is_of_machine { Err(CustomFault::Moves) } else { Ok(()) }
}

/// Whether the lines of a text at `places` are the lines of `custom`, in order; block numbers aside.
pub fn stand_at(text: &str, places: &[Range<usize>], custom: &Custom) -> bool {
    let lines: Vec<&str> = text.lines().collect();
    let found = places.iter().flat_map(|place| place.clone()).map(|at| lines.get(at).copied());
    let wanted = [&custom.header, &custom.tool_change, &custom.footer].into_iter().flatten();
    let is_same = |(found, wanted): (Option<&str>, &String)| {
        found.is_some_and(|found| {
            let number = found.strip_suffix(wanted.as_str()).unwrap_or("?");
            number.trim_start_matches('N').trim_end().bytes().all(|c| c.is_ascii_digit())
        })
    };
    let count = places.iter().map(ExactSizeIterator::len).sum::<usize>();
    count == custom.len() && found.zip(wanted).all(is_same)
}
