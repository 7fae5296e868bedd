//! The words of a block that moves: coordinates, polar coordinates, radius, sense, compensation, feed and M.

use toolpathd_core::geometry::curve::Direction;

use super::Execution;
use super::cursor::{Broken, Cursor};
use super::script::Block;
use crate::codes::FeedMode;
use crate::fault::Fault;
use crate::machine::Side;
use crate::placement::Coordinate;

/// Sorts of words that only some blocks take.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sort {
    Axis,
    PolarRadius,
    PolarAngle,
    Radius,
    Turn,
    Side,
    Feed,
    Function,
    /// LEN of APPR and DEP.
    Length,
    /// CCA of APPR and DEP.
    CenterAngle,
}

/// The words of a block.
#[derive(Debug, Default)]
pub struct Words {
    /// In mm.
    pub axes: [Option<Coordinate>; 3],
    /// In mm.
    pub polar_radius: Option<Coordinate>,
    /// In degrees.
    pub polar_angle: Option<Coordinate>,
    /// In mm, with its bytes.
    pub radius: Option<(f64, [usize; 2])>,
    /// LEN, mm, and CCA, degrees.
    pub length: Option<f64>,
    pub center_angle: Option<f64>,
    pub turn: Option<Direction>,
    pub side: Option<(Option<Side>, [usize; 2])>,
    pub feed: Option<Feed>,
    /// Numbers of M words with their bytes.
    pub functions: Vec<(u32, [usize; 2])>,
    /// M140 goes to the end of the tool axis.
    pub retracts: bool,
    /// A word has been refused, or has no value.
    pub is_broken: bool,
}

impl Words {
    /// Whether a word states a place.
    pub fn moves(&self) -> bool {
        self.axes != [None; 3] || self.polar_radius.is_some() || self.polar_angle.is_some()
    }
}

/// The feed that a block states.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Feed {
    /// FMAX: the block is a rapid.
    Rapid,
    Cut(FeedMode, f64),
    /// A number alone: per turn under M136, else as given here in mm/min.
    Plain {
        per_minute: f64,
        value: f64,
    },
}

/// M functions that take the words behind them.
const WITH_WORDS: [u32; 7] = [103, 112, 118, 120, 124, 128, 140];

impl<'a> Execution<'a, '_> {
    /// Reads the words up to the end of a block. Words of other sorts than `allowed` are refused.
    pub(super) fn scan(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>, allowed: &[Sort]) -> Words {
        let mut words = Words::default();
        while !cursor.is_done() && !self.machine.is_full() {
            let start = cursor.at;
            let found = self.word(block, cursor, &mut words);
            if cursor.at == start {
                cursor.at = cursor.word_end().max(start + 1);
            }
            let span = [start, cursor.at];
            match found {
                Ok(sort) if allowed.contains(&sort) => {}
                Ok(_) => {
                    self.refuse(block, span, Fault::UnusedWord);
                    words.is_broken = true;
                }
                Err(broken) => {
                    self.refuse_broken(block, Broken { start, end: broken.end.max(span[1]), ..broken });
                    words.is_broken = true;
                    cursor.at = cursor.at.max(broken.end);
                }
            }
        }
        words
    }

    fn word(
        &mut self,
        block: &Block<'a>,
        cursor: &mut Cursor<'_>,
        words: &mut Words,
    ) -> Result<Sort, Broken> {
        let start = cursor.at;
        let broken =
            |cursor: &Cursor<'_>, fault| Broken { fault: Some(fault), start, end: cursor.word_end() };
        if cursor.letters("DR") {
            let direction = match (cursor.take(b'+'), cursor.take(b'-')) {
                (true, false) => Direction::Ccw,
                (false, true) => Direction::Cw,
                _ => return Err(broken(cursor, Fault::NoWord)),
            };
            return once(&mut words.turn, direction, start, cursor).map(|()| Sort::Turn);
        }
        if let Some(name) = ["IPR", "IPA", "PR", "PA"].into_iter().find(|name| cursor.letters(name)) {
            return self.polar_word(cursor, words, name, start);
        }
        if cursor.letters("LEN") {
            let mm = cursor.value(&self.parameters)? * self.machine.unit_mm();
            return once(&mut words.length, mm, start, cursor).map(|()| Sort::Length);
        }
        if cursor.letters("CCA") {
            let degrees = cursor.value(&self.parameters)?;
            return once(&mut words.center_angle, degrees, start, cursor).map(|()| Sort::CenterAngle);
        }
        if let Some(side) = side_word(cursor) {
            return once(&mut words.side, (side, [start, cursor.at]), start, cursor).map(|()| Sort::Side);
        }
        match cursor.peek() {
            Some(b'R') => {
                cursor.at += 1;
                let mm = cursor.value(&self.parameters)? * self.machine.unit_mm();
                once(&mut words.radius, (mm, [start, cursor.at]), start, cursor).map(|()| Sort::Radius)
            }
            Some(b'F') => {
                cursor.at += 1;
                let feed = self.feed_word(cursor, start)?;
                once(&mut words.feed, feed, start, cursor).map(|()| Sort::Feed)
            }
            Some(b'S') if cursor.text.get(cursor.at + 1).is_some_and(|c| !c.is_ascii_alphabetic()) => {
                cursor.at += 1;
                self.machine.speed = Some(cursor.value(&self.parameters)?).filter(|speed| *speed >= 0.0);
                self.machine.left.add("S", block.line().number);
                Ok(Sort::Function)
            }
            Some(b'M') => self.function_word(block, cursor, words, start),
            Some(b'I' | b'X' | b'Y' | b'Z' | b'A' | b'B' | b'C' | b'U' | b'V' | b'W') => {
                self.axis_word(block, cursor, words, start)
            }
            _ => Err(broken(cursor, Fault::NoWord)),
        }
    }

    fn polar_word(
        &self,
        cursor: &mut Cursor<'_>,
        words: &mut Words,
        name: &str,
        start: usize,
    ) -> Result<Sort, Broken> {
        let value = cursor.value(&self.parameters)?;
        let is_radius = name.ends_with('R');
        let value = if is_radius { value * self.machine.unit_mm() } else { value };
        let coordinate =
            if name.starts_with('I') { Coordinate::Relative(value) } else { Coordinate::Absolute(value) };
        let (slot, sort) = if is_radius {
            (&mut words.polar_radius, Sort::PolarRadius)
        } else {
            (&mut words.polar_angle, Sort::PolarAngle)
        };
        once(slot, coordinate, start, cursor).map(|()| sort)
    }

    fn axis_word(
        &mut self,
        block: &Block<'a>,
        cursor: &mut Cursor<'_>,
        words: &mut Words,
        start: usize,
    ) -> Result<Sort, Broken> {
        let is_relative = cursor.letters("I");
        let letter = cursor.peek().unwrap_or_default();
        let axis = b"XYZABCUVW".iter().position(|own| *own == letter);
        let Some(axis) = axis else {
            return Err(Broken { fault: Some(Fault::NoWord), start, end: cursor.word_end() });
        };
        cursor.at += 1;
        let value = cursor.value(&self.parameters)?;
        let Some(slot) = words.axes.get_mut(axis) else {
            if value != 0.0 || axis > 5 {
                return Err(Broken { fault: Some(Fault::OtherAxis), start, end: cursor.at });
            }
            self.machine.left.add(&format!("{}0", char::from(letter)), block.line().number);
            return Ok(Sort::Function);
        };
        let mm = value * self.machine.unit_mm();
        let coordinate = if is_relative { Coordinate::Relative(mm) } else { Coordinate::Absolute(mm) };
        once(slot, coordinate, start, cursor).map(|()| Sort::Axis)
    }

    /// What stands behind the F of a feed.
    pub(super) fn feed_word(&self, cursor: &mut Cursor<'_>, start: usize) -> Result<Feed, Broken> {
        cursor.skip_blanks();
        if cursor.phrase("MAX") {
            return Ok(Feed::Rapid);
        }
        if cursor.phrase("AUTO") {
            let fault = Fault::NoFeed;
            let feed = self.auto_feed.ok_or(Broken { fault: Some(fault), start, end: cursor.at })?;
            return Ok(Feed::Cut(FeedMode::PerMinute, feed));
        }
        let is_inch = self.machine.in_inches();
        let is_per_turn = cursor.letters("U");
        if matches!(cursor.peek(), Some(b'Z' | b'T' | b'M')) || is_per_turn && is_inch {
            return Err(Broken { fault: Some(Fault::NotRead), start, end: cursor.word_end() });
        }
        let value = cursor.value(&self.parameters)?;
        if value < 0.0 {
            return Err(Broken { fault: Some(Fault::OutOfRange(value)), start, end: cursor.at });
        }
        if is_per_turn {
            return Ok(Feed::Cut(FeedMode::PerTurn, value));
        }
        // In inches F counts tenths of an inch.
        Ok(Feed::Plain { per_minute: if is_inch { value * 2.54 } else { value }, value })
    }

    /// The mode and the value of a feed, under the M functions in force; `None` for a rapid.
    pub(super) fn rate_of(&self, feed: Option<Feed>) -> Option<(FeedMode, f64)> {
        match feed? {
            Feed::Rapid => None,
            Feed::Cut(mode, value) => Some((mode, value)),
            Feed::Plain { value, .. } if self.is_per_turn => Some((FeedMode::PerTurn, value)),
            Feed::Plain { per_minute, .. } => Some((FeedMode::PerMinute, per_minute)),
        }
    }

    fn function_word(
        &mut self,
        block: &Block<'a>,
        cursor: &mut Cursor<'_>,
        words: &mut Words,
        start: usize,
    ) -> Result<Sort, Broken> {
        cursor.at += 1;
        cursor.skip_blanks();
        let Some(number) = cursor.whole() else {
            return Err(Broken { fault: Some(Fault::NoNumber), start, end: cursor.word_end() });
        };
        words.functions.push((number, [start, cursor.at]));
        if WITH_WORDS.contains(&number) {
            if number == 140 {
                words.retracts = cursor.phrase("MB MAX");
            } else if number != 103 && !cursor.is_done() {
                self.machine.left.add(&format!("words of M{number}"), block.line().number);
                cursor.at = cursor.text.len();
            }
        }
        Ok(Sort::Function)
    }
}

/// Puts a word into its place, unless one stands there.
fn once<T>(slot: &mut Option<T>, value: T, start: usize, cursor: &Cursor<'_>) -> Result<(), Broken> {
    if slot.is_some() {
        return Err(Broken { fault: Some(Fault::Twice), start, end: cursor.at });
    }
    *slot = Some(value);
    Ok(())
}

/// R0, RL or RR. A digit or a point behind R0 makes a radius of it.
fn side_word(cursor: &mut Cursor<'_>) -> Option<Option<Side>> {
    for (name, side) in [("RL", Some(Side::Left)), ("RR", Some(Side::Right)), ("R0", None)] {
        let mut probe = *cursor;
        let is_number = |c: u8| c.is_ascii_digit() || matches!(c, b'.' | b',');
        if probe.letters(name) && !probe.peek().is_some_and(is_number) {
            *cursor = probe;
            return Some(side);
        }
    }
    None
}
