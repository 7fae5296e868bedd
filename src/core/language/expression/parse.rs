//! The parser: turns a text into a tape, the list of operations in the order of their computation.
//!
//! # Method
//! The parser is Pratt's operator precedence parser. It appends the operations of the operands to the tape
//! first, and then the operator that combines them. So it builds no tree.
//!
//! # Reference
//! V. R. Pratt, "Top Down Operator Precedence", POPL, 1973.

use winnow::ascii::{digit0, digit1, multispace0};
use winnow::combinator::{Infix, Prefix, alt, expression, opt};
use winnow::error::{ErrMode, ParserError};
use winnow::prelude::*;
use winnow::stream::{LocatingSlice, Location, Stateful, Stream};
use winnow::token::{any, one_of, take_while};

use super::fault::{ExpressionError, Fault};
use super::function::{Meaning, NAMES, Pairing};
use super::tape::{Operation, Step, Tape};
use super::{DEEPEST_NESTING, LONGEST_TEXT, enclose, evaluate};

/// Most characters of an unknown name that an error repeats.
const LONGEST_NAME_TOLD: usize = 40;

/// Binding powers: an operator with a larger number binds tighter.
const SUM: i64 = 10;
const PRODUCT: i64 = 20;
const SIGN: i64 = 30;
const POWER: i64 = 40;

/// The largest exponent that counts as a whole number. With a larger exponent, the power of almost any base
/// is zero or infinite.
const LARGEST_WHOLE: f64 = (1u32 << 30) as f64;

/// The state of the parser: the text, the steps so far, and the depth of nesting.
#[derive(Debug)]
struct Draft<'t> {
    text: &'t str,
    steps: Vec<Step>,
    depth: usize,
}

type Source<'t> = Stateful<LocatingSlice<&'t str>, Draft<'t>>;

type Parsed<T> = Result<T, ErrMode<ExpressionError>>;

/// An operand: its bytes in the text, from `start` to `end`, and its steps on the tape, from `first` on.
#[derive(Debug, Clone, Copy)]
struct Operand {
    start: usize,
    end: usize,
    first: usize,
    holds_x: bool,
}

impl ParserError<Source<'_>> for ExpressionError {
    type Inner = Self;

    fn from_input(input: &Source<'_>) -> Self {
        Self { at: input.current_token_start(), fault: Fault::MissingOperand }
    }

    fn into_inner(self) -> Result<Self, Self> {
        Ok(self)
    }
}

/// Reads a whole text.
///
/// # Errors
/// The fault of the text, and its place.
pub fn tape(text: &str) -> Result<Tape, ExpressionError> {
    if text.len() > LONGEST_TEXT {
        return Err(ExpressionError { at: LONGEST_TEXT, fault: Fault::TooLong });
    }
    if text.trim().is_empty() {
        return Err(ExpressionError { at: 0, fault: Fault::Empty });
    }
    let mut source =
        Source { input: LocatingSlice::new(text), state: Draft { text, steps: Vec::new(), depth: 0 } };
    let whole = |source: &mut Source<'_>| {
        sum(source)?;
        match peek(source) {
            None => Ok(()),
            Some(')') => stop(source, Fault::UnopenedParenthesis),
            Some(other) => stop(source, Fault::UnexpectedCharacter(other)),
        }
    };
    match whole(&mut source) {
        Ok(()) => Ok(Tape::new(source.state.steps)),
        Err(ErrMode::Backtrack(error) | ErrMode::Cut(error)) => Err(error),
        // Parsers return this only for streams that arrive in pieces.
        Err(ErrMode::Incomplete(_)) => Err(ExpressionError { at: text.len(), fault: Fault::MissingOperand }),
    }
}

/// Reads an expression up to the end, a comma or a closing parenthesis.
fn sum(source: &mut Source<'_>) -> Parsed<Operand> {
    expression(operand).prefix(sign).infix(operator).parse_next(source)
}

/// Reads a number, a name with its arguments, or a parenthesis.
fn operand(source: &mut Source<'_>) -> Parsed<Operand> {
    match peek(source) {
        Some('0'..='9' | '.') => number(source),
        Some('(') => group(source),
        Some('a'..='z' | 'A'..='Z' | '_') => name(source),
        _ => Err(ErrMode::from_input(source)),
    }
}

fn sign<'t>(source: &mut Source<'t>) -> Parsed<Prefix<Source<'t>, Operand, ErrMode<ExpressionError>>> {
    let fold: fn(&mut Source<'t>, Operand) -> Parsed<Operand> = match peek(source) {
        Some('-') => |source, part| {
            leave(source);
            negated(source, part)
        },
        Some('+') => |source, part| {
            leave(source);
            Ok(part)
        },
        None | Some(')' | ',' | '*' | '/' | '^') => return stop(source, Fault::MissingOperand),
        Some(other) => return stop(source, Fault::UnexpectedCharacter(other)),
    };
    enter(source)?;
    any.parse_next(source)?;
    Ok(Prefix(SIGN, fold))
}

fn operator<'t>(source: &mut Source<'t>) -> Parsed<Infix<Source<'t>, Operand, ErrMode<ExpressionError>>> {
    let infix = match peek(source) {
        Some('+') => Infix::Left(SUM, |source, a, b| Ok(paired(source, Pairing::Add, a, b))),
        Some('-') => Infix::Left(SUM, |source, a, b| Ok(paired(source, Pairing::Subtract, a, b))),
        Some('*') => Infix::Left(PRODUCT, |source, a, b| Ok(paired(source, Pairing::Multiply, a, b))),
        Some('/') => Infix::Left(PRODUCT, |source, a, b| Ok(paired(source, Pairing::Divide, a, b))),
        Some('^') => {
            // A power binds tightest, so it is applied as soon as its exponent is read. Then the depth is
            // left again.
            enter(source)?;
            Infix::Right(POWER, |source, a, b| {
                leave(source);
                Ok(paired(source, Pairing::Power, a, b))
            })
        }
        None | Some(')' | ',') => return Err(ErrMode::from_input(source)),
        Some('0'..='9' | '.' | '(' | 'a'..='z' | 'A'..='Z' | '_') => {
            return stop(source, Fault::MissingOperator);
        }
        Some(other) => return stop(source, Fault::UnexpectedCharacter(other)),
    };
    any.parse_next(source)?;
    Ok(infix)
}

fn number(source: &mut Source<'_>) -> Parsed<Operand> {
    let start = source.current_token_start();
    let digits = alt(((digit1, opt(('.', digit0))).void(), ('.', digit1).void()));
    let exponent = (one_of(['e', 'E']), opt(one_of(['+', '-'])), digit1);
    let text = (digits, opt(exponent)).take().parse_next(source)?;
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(leaf(source, start, Operation::Constant(value))),
        _ => refuse(start, Fault::NumberTooLarge),
    }
}

fn group(source: &mut Source<'_>) -> Parsed<Operand> {
    let open = source.current_token_start();
    enter(source)?;
    any.parse_next(source)?;
    let part = sum(source)?;
    match peek(source) {
        Some(')') => any.parse_next(source)?,
        None => return refuse(open, Fault::UnclosedParenthesis),
        Some(other) => return stop(source, Fault::UnexpectedCharacter(other)),
    };
    leave(source);
    Ok(Operand { start: open, end: source.current_token_start(), ..part })
}

fn name(source: &mut Source<'_>) -> Parsed<Operand> {
    let start = source.current_token_start();
    let written: &str = take_while(1.., ('a'..='z', 'A'..='Z', '0'..='9', '_')).parse_next(source)?;
    let Some(&(known, meaning)) = NAMES.iter().find(|(name, _)| *name == written) else {
        let told = written.chars().take(LONGEST_NAME_TOLD).collect();
        return refuse(start, Fault::UnknownName(told));
    };
    let takes = match meaning {
        Meaning::Variable => return Ok(leaf(source, start, Operation::Variable)),
        Meaning::Constant(value) => return Ok(leaf(source, start, Operation::Constant(value))),
        Meaning::Function(_) => 1,
        Meaning::Pairing(_) => 2,
    };
    let arguments = arguments(source, known)?;
    let end = source.current_token_start();
    match (meaning, arguments.as_slice()) {
        (Meaning::Function(function), &[a]) => {
            push(source, Operation::Call(function), start);
            Ok(Operand { start, end, ..a })
        }
        (Meaning::Pairing(pairing), &[a, b]) => {
            Ok(Operand { start, end, ..applied(source, pairing, a, b, start) })
        }
        (_, given) => refuse(start, Fault::WrongNumberOfArguments { name: known, takes, given: given.len() }),
    }
}

/// Reads the arguments in parentheses after the name of a function.
fn arguments(source: &mut Source<'_>, name: &'static str) -> Parsed<Vec<Operand>> {
    if peek(source) != Some('(') {
        return stop(source, Fault::MissingArguments(name));
    }
    let open = source.current_token_start();
    enter(source)?;
    any.parse_next(source)?;
    let mut parts = Vec::new();
    if peek(source) != Some(')') {
        parts.push(sum(source)?);
        while peek(source) == Some(',') {
            any.parse_next(source)?;
            parts.push(sum(source)?);
        }
    }
    // A sum ends only before a comma, before a closing parenthesis, or at the end of the text.
    if peek(source).is_none() {
        return refuse(open, Fault::UnclosedParenthesis);
    }
    any.parse_next(source)?;
    leave(source);
    Ok(parts)
}

/// Skips separators and returns the next character.
fn peek(source: &mut Source<'_>) -> Option<char> {
    let separators: Parsed<&str> = multispace0.parse_next(source);
    // `multispace0` accepts any number of separators, even none.
    debug_assert!(separators.is_ok());
    source.peek_token()
}

/// Ends the parsing with a fault at the current place.
fn stop<T>(source: &Source<'_>, fault: Fault) -> Parsed<T> {
    refuse(source.current_token_start(), fault)
}

fn refuse<T>(at: usize, fault: Fault) -> Parsed<T> {
    Err(ErrMode::Cut(ExpressionError { at, fault }))
}

/// Enters one level of nesting, where the parser recurses. An error if the nesting is too deep.
fn enter(source: &mut Source<'_>) -> Parsed<()> {
    source.state.depth += 1;
    if source.state.depth > DEEPEST_NESTING { stop(source, Fault::TooDeep) } else { Ok(()) }
}

fn leave(source: &mut Source<'_>) {
    source.state.depth -= 1;
}

fn push(source: &mut Source<'_>, operation: Operation, at: usize) {
    source.state.steps.push(Step { operation, at });
}

/// The text from `start` to the current place as an operand of one step.
fn leaf(source: &mut Source<'_>, start: usize, operation: Operation) -> Operand {
    let first = source.state.steps.len();
    push(source, operation, start);
    Operand { start, end: source.current_token_start(), first, holds_x: operation == Operation::Variable }
}

/// The operand with a minus sign before it. A constant takes up the sign; other operands get a step.
fn negated(source: &mut Source<'_>, part: Operand) -> Parsed<Operand> {
    let before = source.state.text.get(..part.start).unwrap_or("").trim_end();
    let start = before.len().saturating_sub(1);
    match source.state.steps.get_mut(part.first..) {
        Some([Step { operation: Operation::Constant(value), .. }]) => *value = -*value,
        _ => push(source, Operation::Negate, start),
    }
    Ok(Operand { start, ..part })
}

/// The result of an operator between two operands.
fn paired(source: &mut Source<'_>, pairing: Pairing, a: Operand, b: Operand) -> Operand {
    let after = source.state.text.get(a.end..).unwrap_or("");
    let at = a.end + (after.len() - after.trim_start().len());
    applied(source, pairing, a, b, at)
}

/// Appends an operation on two operands. `at` is the byte of the text of the operation. An exponent without x
/// is computed here. So x^(6/2) is x^3, and x may be negative.
fn applied(source: &mut Source<'_>, pairing: Pairing, a: Operand, b: Operand, at: usize) -> Operand {
    let whole = Operand { start: a.start, end: b.end, first: a.first, holds_x: a.holds_x || b.holds_x };
    let constant = if pairing == Pairing::Power && !b.holds_x { constant(source, b) } else { None };
    let operation = match constant {
        Some(exponent) if exponent.fract() == 0.0 && exponent.abs() <= LARGEST_WHOLE => {
            Operation::WholePower(exponent as i32)
        }
        Some(exponent) => Operation::FixedPower(exponent),
        None => Operation::Pair(pairing),
    };
    if constant.is_some() {
        source.state.steps.truncate(b.first);
    }
    push(source, operation, at);
    whole
}

/// The value of the last operand, which does not contain x; `None` if it is not defined or not finite.
fn constant(source: &Source<'_>, part: Operand) -> Option<f64> {
    let steps = source.state.steps.get(part.first..)?;
    let tape = Tape::new(steps.to_vec());
    let anywhere = 0.0;
    let value = evaluate::value(&tape, anywhere);
    let is_defined = enclose::at(&tape, anywhere).finding.is_none();
    (is_defined && value.is_finite()).then_some(value)
}
