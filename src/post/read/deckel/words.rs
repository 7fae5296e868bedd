//! The words of one motion, in the form of the print.

use super::super::number::Number;
use crate::dialect::Dialect;
use crate::nc::{Fault, Motion, WordFault};
use toolpathd_core::toolpath::units::FeedRate;

/// The words of a motion, in their order.
const NAMES: [&str; 5] = ["G", "X", "Y", "Z", "F"];

/// The words of a motion. Coordinates in mm.
#[derive(Debug, Default)]
pub struct Words {
    pub motion: Option<Motion>,
    pub position: [Option<f64>; 3],
    pub feed: Option<FeedRate>,
}

/// How a coordinate shows its sign.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Signs {
    /// A plus or a minus stands right behind the letter.
    Always,
    /// A blank stands in place of a plus. A blank may stand before a minus.
    MinusOnly,
}

impl Words {
    /// # Errors
    /// When a word is unknown, stands twice or in the wrong place, or its number has another form than in the
    /// print.
    pub fn of(text: &str, dialect: &Dialect) -> Result<Self, Fault> {
        let mut words = Self::default();
        let (mut rest, mut last) = (text, None);
        loop {
            let Some(letter) = rest.chars().next() else { return Err(Fault::UnknownBlock) };
            let Some(place) = NAMES.iter().position(|name| name.starts_with(letter)) else {
                return Err(Fault::UnknownWord(letter));
            };
            if last == Some(place) {
                return Err(Fault::Word(NAMES[place], WordFault::Twice));
            }
            if last > Some(place) {
                return Err(Fault::Word(NAMES[place], WordFault::Order));
            }
            last = Some(place);
            // A blank may stand between a letter and its number, and one stands before the next letter.
            let value = &rest[1..];
            let next = value.find(|c: char| !matches!(c, ' ' | '+' | '-' | '.' | '0'..='9'));
            let value = match next {
                Some(next) => value[..next].strip_suffix(' '),
                None => Some(value),
            };
            words.take(place, value.ok_or(Fault::Word(NAMES[place], WordFault::Number))?, dialect)?;
            match next {
                Some(next) => rest = &rest[1 + next..],
                None => return Ok(words),
            }
        }
    }

    fn take(&mut self, place: usize, text: &str, dialect: &Dialect) -> Result<(), Fault> {
        let name = NAMES[place];
        match name {
            "G" => {
                let code = count(text).ok_or(Fault::Word(name, WordFault::Form))?;
                self.motion = match code {
                    0 => Some(Motion::Rapid),
                    1 => Some(Motion::Line),
                    _ => return Err(Fault::UnknownG(f64::from(code))),
                };
            }
            "F" => {
                let feed = text.strip_prefix(' ').and_then(|text| number(text, dialect));
                let feed = feed.ok_or(Fault::Word(name, WordFault::Form))?;
                let rate = FeedRate::from_mm_per_min(feed);
                self.feed = Some(rate.ok_or(Fault::Word(name, WordFault::Range))?);
            }
            _ => {
                let value = position(text, Signs::MinusOnly, dialect);
                self.position[place - 1] = Some(value.ok_or(Fault::Word(name, WordFault::Form))?);
            }
        }
        Ok(())
    }
}

/// A whole number that is nothing but digits, without a zero before them.
pub fn count(text: &str) -> Option<u32> {
    let is_short = text == "0" || !text.starts_with('0');
    Number::whole_of(text).filter(|_| is_short)?.count()
}

/// A number that is not negative.
pub fn number(text: &str, dialect: &Dialect) -> Option<f64> {
    let number = Number::whole_of(text).filter(|number| number.sign.is_none())?;
    is_short(number, dialect).then_some(number.value)
}

/// The coordinate behind a letter, with the blank that may stand before it.
pub fn position(text: &str, signs: Signs, dialect: &Dialect) -> Option<f64> {
    let digits = match signs {
        Signs::Always => text.strip_prefix(['+', '-']),
        Signs::MinusOnly => {
            let bare = text.strip_prefix(' ').unwrap_or(text);
            bare.strip_prefix('-').or_else(|| text.strip_prefix(' '))
        }
    }?;
    let value = number(digits, dialect)?;
    let is_negative = text.contains('-');
    if is_negative && value == 0.0 {
        return None;
    }
    Some(if is_negative { -value } else { value })
}

/// Whether no zero stands before the point or at the end, and no digit too much.
fn is_short(number: Number, dialect: &Dialect) -> bool {
    let Number { whole, fraction, .. } = number;
    let digits = whole.len() + number.decimals();
    let is_whole_short =
        if fraction.is_none() { whole == "0" || !whole.starts_with('0') } else { !whole.starts_with('0') };
    let is_fraction_short = fraction.is_none_or(|digits| !digits.is_empty() && !digits.ends_with('0'));
    is_whole_short
        && is_fraction_short
        && digits <= dialect.numbers.max_digits as usize
        && number.decimals() <= usize::from(dialect.max_decimals)
}
