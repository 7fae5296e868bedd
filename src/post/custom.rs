//! A shop's own lines in a program: what they may hold.
//!
//! A line must not end, leave or skip a part of the program, must not change what later coordinates mean
//! where the program does not state it again, and moves nothing but to places of the machine. The program
//! selects its work offset between `header` and `tool_change`. A line of `tool_change` that selects a work
//! offset is therefore refused. Calls of the shop's own programs and macros are allowed; what those do is the
//! shop's.
//!
//! The program states its modes again behind such lines. The reader that checks the program skips them, and
//! takes units, plane, distance mode, feed and position for unknown behind them.

use std::fmt;
use std::ops::{Range, RangeInclusive};

use super::dialect::{Dialect, Frame, Syntax};
use super::nc::{Effect, Function, Lexer, PositionEffect, Token, effect, function};
use super::words::begins_like_a_command;
use toolpathd_core::toolpath::program::Custom;

/// Most lines of one place.
pub const MAX_LINES: usize = 50;

/// Room for a block number beside a line.
const NUMBER_LENGTH: usize = 12;

/// G28, G30, G53 and G65, in tenths: a move to a place of the machine, or the call of a macro with values.
const PLACES: [i32; 4] = [280, 300, 530, 650];

/// The codes that select a work offset, in tenths: G54 to G59, Haas's G110 to G129 and G154, Okuma's G15,
/// Siemens's G500 to G599.
const WORK_OFFSETS: [RangeInclusive<i32>; 5] = [540..=599, 1100..=1299, 1540..=1549, 150..=159, 5000..=5999];

/// Codes after which lines of other programs run, and then the next line of this one.
const CALLS: [i32; 2] = [980, 1980];

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
    #[error("the line has {found} characters; at most {most} are allowed")]
    TooLong { found: usize, most: usize },
    #[error("the line holds {0:?}, which has no place in a program; write printable ASCII without %")]
    Character(char),
    #[error("the line cannot be read from {text:?} on; write {form}")]
    Unreadable { text: String, form: &'static str },
    #[error("{0:?} ends the program, leaves it, or changes what later blocks mean; leave it out")]
    Forbidden(String),
    #[error("{0:?} stands where a block number would; leave it out")]
    BlockNumber(String),
    #[error("{0:?} is a program number; leave it out")]
    ProgramNumber(String),
    #[error("{0:?} selects another work offset behind that of the program")]
    WorkOffset(String),
    #[error("the line moves an axis; {0}, or leave the axis words out")]
    Moves(&'static str),
    #[error("the dialect has no tool change")]
    NoToolChange,
    #[error("the dialect has no place for lines of a shop")]
    NoPlace,
}

/// Why a part of a line is refused, before the language of the line is known.
enum Fault {
    Unreadable(String),
    Is(CustomFault),
}

impl Fault {
    fn forbidden(text: &str) -> Self {
        Self::Is(CustomFault::Forbidden(text.to_owned()))
    }

    fn unreadable(text: &str) -> Self {
        Self::Unreadable(text.to_owned())
    }
}

impl fmt::Display for CustomPart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Header => "header",
            Self::ToolChange => "tool change",
            Self::Footer => "footer",
        })
    }
}

/// A line that is refused, by its place and its index.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("line {} of the {part} is refused: {fault}", index + 1)]
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
            check(dialect, part, line).err().map(|fault| Refused { part, index, fault })
        });
        faults.collect::<Vec<_>>()
    };
    parts.into_iter().flat_map(of_part).collect()
}

/// A word of the shop's own that selects a work offset at the start of the program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OwnWorkOffset {
    /// The index of its line in the header.
    pub index: usize,
    pub word: String,
}

/// The first word of the header's own lines that selects a work offset. Lines that are refused have none.
pub fn own_work_offset(dialect: &Dialect, custom: &Custom) -> Option<OwnWorkOffset> {
    custom.header.iter().enumerate().find_map(|(index, line)| {
        check(dialect, CustomPart::Header, line).ok()?;
        let word = read_line(dialect, line).ok()?.0.ok()?.work_offset?;
        Some(OwnWorkOffset { index, word })
    })
}

fn check(dialect: &Dialect, part: CustomPart, line: &str) -> Result<(), CustomFault> {
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
    if let Syntax::Iso(iso) = dialect.syntax
        && part == CustomPart::ToolChange
        && !iso.start.contains(&Frame::ToolChange)
    {
        return Err(CustomFault::NoToolChange);
    }
    let (checked, form, to_move) = read_line(dialect, line)?;
    let found = checked.map_err(|fault| match fault {
        Fault::Unreadable(text) => CustomFault::Unreadable { text, form },
        Fault::Is(fault) => fault,
    })?;
    match found.work_offset {
        Some(text) if part == CustomPart::ToolChange => Err(CustomFault::WorkOffset(text)),
        _ if found.has_axis && !found.may_move => Err(CustomFault::Moves(to_move)),
        _ => Ok(()),
    }
}

/// What the words of a line do, the form of such lines, and what to add to a line that moves.
type ReadLine = (Result<Found, Fault>, &'static str, &'static str);

fn read_line(dialect: &Dialect, line: &str) -> Result<ReadLine, CustomFault> {
    match dialect.syntax {
        Syntax::Iso(_) => Ok((check_words(line), ISO_FORM, "add G28, G30 or G53")),
        Syntax::Siemens(_) => Ok((check_siemens(line), SIEMENS_FORM, "add SUPA")),
        Syntax::Klartext => Ok((check_klartext(line), KLARTEXT_FORM, "add M91 or M92")),
        Syntax::Deckel => Err(CustomFault::NoPlace),
    }
}

const ISO_FORM: &str = "words of a letter and a number, or a comment in parentheses that no control obeys";
const SIEMENS_FORM: &str = "words of a letter and a number, SUPA, CYCLE800(), CYCLE832, COMPCAD, COMPCURV, COMPOF, FFWON, FFWOF, SOFT, BRISK, STOPRE, MSG, or a comment behind a semicolon";
const KLARTEXT_FORM: &str = "TOOL CALL, TOOL DEF, CALL PGM, CYCL DEF 32, CYCL DEF 247, STOP, M words, L with M91 or M92, or a comment behind a semicolon";

/// What the words of a line do.
#[derive(Default)]
struct Found {
    has_axis: bool,
    /// The axis words are places of the machine.
    may_move: bool,
    /// The word that selects a work offset.
    work_offset: Option<String>,
}

impl Found {
    fn add(&mut self, other: Self) {
        self.has_axis |= other.has_axis;
        self.may_move |= other.may_move;
        self.work_offset = self.work_offset.take().or(other.work_offset);
    }
}

/// A line of ISO words and comments in parentheses.
fn check_words(line: &str) -> Result<Found, Fault> {
    let mut found = Found::default();
    for (place, token) in Lexer::new(line.as_bytes()) {
        let text = &line[place.clone()];
        match token {
            Token::Word { letter, number, .. } => {
                let number = std::str::from_utf8(number).unwrap_or_default();
                found.add(check_word(letter, number, &line[place], &PLACES)?);
            }
            Token::Comment { is_closed: true } if is_plain_comment(text) => {}
            Token::Comment { .. } | Token::BlockDelete | Token::TapeMark | Token::Unknown => {
                return Err(Fault::unreadable(&line[place.start..]));
            }
        }
    }
    Ok(found)
}

/// Whether a comment is in parentheses, and no control acts on it.
fn is_plain_comment(text: &str) -> bool {
    let Some(inside) = text.strip_prefix('(').and_then(|rest| rest.strip_suffix(')')) else { return false };
    let word = inside.trim_start().to_ascii_uppercase();
    let is_allowed = |c: char| c.is_ascii_alphanumeric() || " ._-/+,='*".contains(c);
    inside.chars().all(is_allowed) && !begins_like_a_command(&word)
}

/// What a word does. `places` are the codes, in tenths, whose axis words are places of the machine.
fn check_word(letter: u8, number: &str, text: &str, places: &[i32]) -> Result<Found, Fault> {
    let value: f64 = number.parse().map_err(|_| Fault::unreadable(text))?;
    let tenths = (value * 10.0).round() as i32;
    let found = Found::default();
    match letter {
        b'G' if places.contains(&tenths) => Ok(Found { may_move: true, ..found }),
        b'G' if WORK_OFFSETS.iter().any(|codes| codes.contains(&tenths)) => {
            Ok(Found { work_offset: Some(text.to_owned()), ..found })
        }
        b'G' => match effect(tenths) {
            Effect::Begins(..) | Effect::Units(_) | Effect::Centers(_) => Err(Fault::forbidden(text)),
            Effect::Position(PositionEffect::Taken | PositionEffect::Elsewhere) => {
                Err(Fault::forbidden(text))
            }
            _ => Ok(found),
        },
        b'M' => match function(tenths) {
            Function::Ends | Function::Restores => Err(Fault::forbidden(text)),
            Function::Leaves if !CALLS.contains(&tenths) => Err(Fault::forbidden(text)),
            _ => Ok(found),
        },
        b'N' => Err(Fault::Is(CustomFault::BlockNumber(text.to_owned()))),
        b'O' => Err(Fault::Is(CustomFault::ProgramNumber(text.to_owned()))),
        b'A' | b'B' | b'C' | b'I' | b'J' | b'K' | b'U' | b'V' | b'W' | b'X' | b'Y' | b'Z' => {
            Ok(Found { has_axis: true, ..found })
        }
        _ => Ok(found),
    }
}

/// Names that a line of a Siemens program may hold besides words.
const SIEMENS_NAMES: [&str; 12] = [
    "SUPA", "CYCLE800", "CYCLE832", "COMPCAD", "COMPCURV", "COMPOF", "FFWON", "FFWOF", "SOFT", "BRISK",
    "STOPRE", "MSG",
];

/// A line of words and of [`SIEMENS_NAMES`], some of them with arguments, and a comment behind a semicolon.
fn check_siemens(line: &str) -> Result<Found, Fault> {
    let code = line.split(';').next().unwrap_or_default();
    let mut found = Found::default();
    let mut rest = code.trim_start();
    while !rest.is_empty() {
        let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let name = &rest[..rest.find(|c| !is_name(c)).unwrap_or(rest.len())];
        if let Some(known) = SIEMENS_NAMES.iter().find(|known| name.eq_ignore_ascii_case(known)) {
            found.may_move |= *known == "SUPA";
            let after = arguments(rest[name.len()..].trim_start())?;
            if *known == "CYCLE800" && !rest[name.len()..].trim_start().starts_with("()") {
                // It tilts the plane.
                return Err(Fault::forbidden(&rest[..rest.len() - after.len()]));
            }
            rest = after;
        } else if let Some(after) = rest.strip_prefix("T=") {
            rest = quoted(after)?;
        } else {
            let Some((place, Token::Word { letter, number, .. })) = Lexer::new(rest.as_bytes()).next() else {
                return Err(Fault::unreadable(rest));
            };
            let number = std::str::from_utf8(number).unwrap_or_default();
            let text = &rest[place.clone()];
            if letter == b'M' && number == "17" {
                return Err(Fault::forbidden(text));
            }
            // L calls a program; it is a word like others.
            found.add(check_word(letter, number, text, &[])?);
            rest = &rest[place.end..];
            if rest.starts_with(is_name) && !rest.starts_with(|c: char| c.is_ascii_alphabetic()) {
                return Err(Fault::unreadable(rest));
            }
        }
        rest = rest.trim_start();
    }
    Ok(found)
}

/// What follows arguments in parentheses, or the text itself without them. Arguments are numbers,
/// strings, and names that begin with an underscore.
fn arguments(text: &str) -> Result<&str, Fault> {
    let Some(mut rest) = text.strip_prefix('(') else { return Ok(text) };
    loop {
        match rest.chars().next() {
            Some(')') => return Ok(&rest[1..]),
            Some('"') => rest = quoted(rest)?,
            Some(c) if c.is_ascii_digit() || " ,.-+".contains(c) => rest = &rest[1..],
            // A mode of CYCLE832 by its name.
            Some('_') => rest = rest[1..].trim_start_matches(|c: char| c.is_ascii_uppercase() || c == '_'),
            _ => return Err(Fault::unreadable(text)),
        }
    }
}

/// What follows a string in quotes.
fn quoted(text: &str) -> Result<&str, Fault> {
    let end = text.strip_prefix('"').and_then(|inside| inside.find('"'));
    end.map(|end| &text[end + 2..]).ok_or_else(|| Fault::unreadable(text))
}

/// Beginnings of Klartext blocks that a line may be.
const KLARTEXT_BLOCKS: [&str; 7] =
    [";", "STOP", "TOOL CALL ", "TOOL DEF ", "CALL PGM ", "CYCL DEF 32.", "CYCL DEF 247 "];

/// The end of a program, and M89 to M149 and M197, which call cycles or change how paths are run.
fn is_forbidden_m(number: f64) -> bool {
    [2.0, 30.0, 197.0].contains(&number) || (89.0..150.0).contains(&number)
}

/// A Klartext block that calls, comments, or moves to a place of the machine.
fn check_klartext(line: &str) -> Result<Found, Fault> {
    let line = line.trim();
    if let Some(at) = line.find('~') {
        return Err(Fault::unreadable(&line[at..]));
    }
    let found = Found::default();
    if KLARTEXT_BLOCKS.iter().any(|block| line.starts_with(block)) {
        let work_offset = line.starts_with("CYCL DEF 247").then(|| line.to_owned());
        return Ok(Found { work_offset, ..found });
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
                return Err(Fault::unreadable(word));
            }
            _ if number('M').is_some_and(is_forbidden_m) => {
                return Err(Fault::forbidden(word));
            }
            _ if number('M').is_some_and(|m| m.is_finite() && m >= 0.0) => {}
            _ if is_move && ['X', 'Y', 'Z'].iter().any(|&axis| number(axis).is_some()) => {}
            _ => return Err(Fault::unreadable(word)),
        }
    }
    Ok(Found { has_axis: is_move, may_move: is_of_machine, ..found })
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
