//! The grammar of section curves: turns a text into items, each with its place in the text.
//!
//! `curve = item (space item)*`, `item = ("l" | "r") row | "b" rows | "b" "(" rows ")"`,
//! `rows = row ("," row)*`, `row = "(" number ("," number)* ")"`.
//!
//! The paper prints `b` without the outer parentheses. After the first parenthesis of a `b`, another
//! parenthesis or a number tells which of the two forms is written.
//!
//! White space may stand before and after every letter, parenthesis, comma and number. The parser reads the
//! text once from start to end, and does not recurse, because items do not nest.

use winnow::ascii::{digit0, digit1, multispace0, multispace1};
use winnow::combinator::{alt, opt};
use winnow::error::{AddContext, ErrMode, ModalResult, ParserError};
use winnow::prelude::*;
use winnow::stream::{LocatingSlice, Location, Stream};
use winnow::token::one_of;

use super::{Fault, LARGEST_NUMBER, POINT_LIMIT, SectionCurveError, TEXT_LIMIT};

type Text<'t> = LocatingSlice<&'t str>;
type Read<T> = ModalResult<T, SectionCurveError>;

/// The numbers of a point or corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Row {
    pub(super) at: usize,
    pub(super) numbers: [f64; 4],
    pub(super) count: usize,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Point,
    Corner,
    Smooth,
}

/// An item of the text. Points and corners have one row, smooth curves one or more.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Written {
    pub(super) at: usize,
    pub(super) kind: Kind,
    pub(super) rows: Vec<Row>,
}

/// Reads the items of a text, at least one.
pub(super) fn items(text: &str) -> Result<Vec<Written>, SectionCurveError> {
    if text.len() > TEXT_LIMIT {
        return Err(SectionCurveError { at: TEXT_LIMIT, fault: Fault::TextTooLong });
    }
    curve(&mut LocatingSlice::new(text)).map_err(|error| match error {
        ErrMode::Backtrack(error) | ErrMode::Cut(error) => error,
        // Does not happen, because the whole text is available.
        ErrMode::Incomplete(_) => syntax(text.len(), "more text"),
    })
}

fn curve(text: &mut Text<'_>) -> Read<Vec<Written>> {
    multispace0(text)?;
    let mut items = Vec::new();
    let mut room = POINT_LIMIT;
    loop {
        let item = item(text, room)?;
        room -= item.rows.len();
        items.push(item);
        if text.is_empty() {
            return Ok(items);
        }
        multispace1.context("white space before the next item").parse_next(text)?;
        if text.is_empty() {
            return Ok(items);
        }
    }
}

/// Reads the next item, with at most `room` points.
fn item(text: &mut Text<'_>, room: usize) -> Read<Written> {
    let at = text.current_token_start();
    let kind = one_of(['l', 'r', 'b']).context("an item: l(...), r(...) or b(...)").parse_next(text)?;
    multispace0(text)?;
    let (kind, rows) = match kind {
        'l' => (Kind::Point, vec![row(text)?]),
        'r' => (Kind::Corner, vec![row(text)?]),
        _ => (Kind::Smooth, rows(text, room)?),
    };
    if rows.len() > room {
        return Err(ErrMode::Cut(SectionCurveError { at, fault: Fault::TooManyPoints }));
    }
    Ok(Written { at, kind, rows })
}

/// Reads the points of a `b`, at least one. Stops after one point more than `room`.
fn rows(text: &mut Text<'_>, room: usize) -> Read<Vec<Row>> {
    let start = text.checkpoint();
    '('.context("an opening parenthesis").parse_next(text)?;
    multispace0(text)?;
    let is_enclosed = !text.starts_with(|sign: char| sign.is_ascii_digit() || "+-.".contains(sign));
    if !is_enclosed {
        text.reset(&start);
    }
    let mut rows = Vec::new();
    loop {
        multispace0(text)?;
        rows.push(row(text)?);
        let is_last = if is_enclosed { is_last(text)? } else { !goes_on(text)? };
        if is_last || rows.len() > room {
            return Ok(rows);
        }
    }
}

/// Reads a comma, if the text goes on with one after white space. Without a comma, the white space stays.
fn goes_on(text: &mut Text<'_>) -> Read<bool> {
    Ok(opt((multispace0, ',')).parse_next(text)?.is_some())
}

fn row(text: &mut Text<'_>) -> Read<Row> {
    let mut row = Row { at: text.current_token_start(), numbers: [0.0; 4], count: 0 };
    '('.context("an opening parenthesis").parse_next(text)?;
    loop {
        multispace0(text)?;
        let at = text.current_token_start();
        let number = number(text)?;
        let Some(place) = row.numbers.get_mut(row.count) else {
            return Err(ErrMode::Cut(SectionCurveError { at, fault: Fault::NumberCount { found: 5 } }));
        };
        *place = number;
        row.count += 1;
        if is_last(text)? {
            return Ok(row);
        }
    }
}

/// Reads a comma or a closing parenthesis; `true` for the parenthesis.
fn is_last(text: &mut Text<'_>) -> Read<bool> {
    multispace0(text)?;
    let sign = one_of([',', ')']).context("a comma or a closing parenthesis").parse_next(text)?;
    Ok(sign == ')')
}

fn number(text: &mut Text<'_>) -> Read<f64> {
    let at = text.current_token_start();
    let sign = || opt(one_of(['+', '-']));
    let mantissa = alt(((digit1, opt(('.', digit0))).void(), ('.', digit1).void()));
    let exponent = opt((one_of(['e', 'E']), sign(), digit1));
    let number = (sign(), mantissa, exponent).take().context("a number").parse_next(text)?;
    match number.parse::<f64>() {
        Ok(number) if number.abs() <= LARGEST_NUMBER => Ok(number),
        Ok(_) => Err(ErrMode::Cut(SectionCurveError { at, fault: Fault::NumberTooLarge })),
        Err(_) => Err(ErrMode::Cut(syntax(at, "a number"))),
    }
}

fn syntax(at: usize, expected: &'static str) -> SectionCurveError {
    SectionCurveError { at, fault: Fault::Syntax { expected } }
}

impl ParserError<Text<'_>> for SectionCurveError {
    type Inner = Self;

    fn from_input(text: &Text<'_>) -> Self {
        syntax(text.current_token_start(), "")
    }

    fn into_inner(self) -> Result<Self, Self> {
        Ok(self)
    }
}

impl AddContext<Text<'_>, &'static str> for SectionCurveError {
    fn add_context(self, _: &Text<'_>, _: &<Text<'_> as Stream>::Checkpoint, expected: &'static str) -> Self {
        match self.fault {
            Fault::Syntax { expected: "" } => syntax(self.at, expected),
            _ => self,
        }
    }
}
