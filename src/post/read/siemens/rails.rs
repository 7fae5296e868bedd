//! Blocks under ORICURVE: the tip and a second point of the tool, on a line or on polynomials.
//!
//! A block of polynomials states the end of each coordinate and the coefficients of the powers from 2 on, of
//! a parameter from 0 to PL. The coefficient of the first power follows from the ends.

use super::super::number::Number;
use super::super::posed::RailStep;
use super::Reader;
use crate::nc::{Fault, FeedMode, WordFault};
use toolpathd_core::toolpath::units::FeedRate;

const TIP: [&str; 3] = ["X", "Y", "Z"];
const SECOND: [&str; 3] = ["XH", "YH", "ZH"];

/// Decimals of coefficients and of the second point, at most.
const FINE_DECIMALS: u8 = 9;

/// Whether a line states a second point (XH=) or a polynomial (PO[).
pub fn is_rail(text: &str) -> bool {
    text.contains("XH=") || text.contains("PO[")
}

/// The words of one block.
#[derive(Default)]
struct Words {
    has_line: bool,
    has_polynomial: bool,
    /// The ends of the coordinates, and the coefficients of the powers 2 to 5.
    ends: [[Option<f64>; 3]; 2],
    powers: [[[f64; 3]; 4]; 2],
    length: Option<f64>,
    feed: Option<f64>,
}

impl Reader<'_> {
    /// The motion of a block under ORICURVE.
    pub(super) fn rail(&mut self, text: &str) -> Result<RailStep, Fault> {
        let words = self.words(text)?;
        let unit_mm = self.unit_mm()?;
        let known = |ends: [Option<f64>; 3], names: [&'static str; 3]| {
            let mut all = [0.0; 3];
            for (k, end) in ends.into_iter().enumerate() {
                all[k] = end.ok_or(Fault::Word(names[k], WordFault::Missing))? * unit_mm;
            }
            Ok::<_, Fault>(all)
        };
        let (to, second) = (known(words.ends[0], TIP)?, known(words.ends[1], SECOND)?);
        let from = match self.modal.at {
            [Some(x), Some(y), Some(z)] => [x, y, z],
            _ => return Err(Fault::UnknownStart),
        };
        if self.edge == 0 {
            return Err(Fault::NoEdge);
        }
        if self.modal.feed_mode != Some(FeedMode::PerMinute) {
            return Err(Fault::NoMode("G94"));
        }
        if let Some(feed) = words.feed {
            self.modal.feed = FeedRate::from_mm_per_min(feed * unit_mm);
        }
        let rate = self.modal.feed.ok_or(Fault::NoFeed)?;
        self.is_polynomial = words.has_polynomial || self.is_polynomial && !words.has_line;
        if self.is_polynomial {
            if !self.has_polynomials {
                return Err(Fault::NoMode("POLYPATH"));
            }
            if words.length != Some(1.0) {
                return Err(Fault::Word("PL", WordFault::Range));
            }
        } else if words.length.is_some() || from != to {
            // A line of two points is no rail of this service.
            return Err(Fault::Conflict);
        }
        let second_from = match self.second {
            Some(second) => second,
            None if !self.is_polynomial => second,
            None => return Err(Fault::UnknownStart),
        };
        let powers = words.powers.map(|points| points.map(|p| p.map(|x| x * unit_mm)));
        self.modal.motion = None;
        self.modal.at = to.map(Some);
        self.second = Some(second);
        self.vector = Some([0, 1, 2].map(|k| second[k] - to[k]));
        (self.angles, self.has_lost_axis) = ([None; 3], true);
        Ok(RailStep { from, to, second_from, second, powers, rate })
    }

    fn words(&mut self, text: &str) -> Result<Words, Fault> {
        let mut words = Words::default();
        let text = text.split(';').next().unwrap_or_default();
        for (k, word) in text.split_ascii_whitespace().enumerate() {
            match word {
                "G1" => words.has_line = true,
                "POLY" => words.has_polynomial = true,
                "G94" => self.apply(94),
                _ if k == 0 && word.starts_with('N') => {
                    let number = Number::whole_of(&word[1..]).and_then(Number::count);
                    self.check_number(Some(number.ok_or(Fault::Word("N", WordFault::Form))?))?;
                }
                _ => words.take(word, self.dialect.max_decimals)?,
            }
        }
        if words.has_line && words.has_polynomial {
            return Err(Fault::Conflict);
        }
        Ok(words)
    }
}

impl Words {
    fn take(&mut self, word: &str, decimals: u8) -> Result<(), Fault> {
        if let Some(feed) = word.strip_prefix('F') {
            return set(&mut self.feed, "F", number(feed, "F", decimals)?);
        }
        if let Some(length) = word.strip_prefix("PL=") {
            return set(&mut self.length, "PL", number(length, "PL", 0)?);
        }
        for (point, names) in [SECOND, TIP].into_iter().enumerate() {
            // XH also begins with X, so the names of the second point are tried first. In `Words` the tip
            // comes first.
            let place = 1 - point;
            let decimals = if place == 0 { decimals } else { FINE_DECIMALS };
            for (axis, name) in names.into_iter().enumerate() {
                let inside = word.strip_prefix("PO[").and_then(|rest| rest.strip_prefix(name));
                if let Some(list) = inside.and_then(|rest| rest.strip_prefix("]=(")) {
                    let list = list.strip_suffix(')').ok_or(Fault::Word(name, WordFault::Form))?;
                    return self.polynomial(list, (place, axis), name, decimals);
                }
                let plain = word.strip_prefix(name);
                let value = if place == 1 { plain.and_then(|rest| rest.strip_prefix('=')) } else { plain };
                if let Some(value) = value {
                    return set(&mut self.ends[place][axis], name, number(value, name, decimals)?);
                }
            }
        }
        Err(Fault::UnknownWord(word.chars().next().unwrap_or_default()))
    }

    /// The end of a coordinate, and its coefficients.
    fn polynomial(
        &mut self,
        list: &str,
        (point, axis): (usize, usize),
        name: &'static str,
        decimals: u8,
    ) -> Result<(), Fault> {
        for (k, text) in list.split(',').enumerate() {
            match k {
                0 => set(&mut self.ends[point][axis], name, number(text, name, decimals)?)?,
                1..=4 => self.powers[point][k - 1][axis] = number(text, name, FINE_DECIMALS)?,
                _ => return Err(Fault::Word(name, WordFault::Range)),
            }
        }
        Ok(())
    }
}

fn number(text: &str, name: &'static str, decimals: u8) -> Result<f64, Fault> {
    let number = Number::whole_of(text).ok_or(Fault::Word(name, WordFault::Number))?;
    if number.decimals() > usize::from(decimals) {
        return Err(Fault::Word(name, WordFault::Form));
    }
    Ok(number.value)
}

fn set(place: &mut Option<f64>, name: &'static str, value: f64) -> Result<(), Fault> {
    if place.replace(value).is_some() { Err(Fault::Word(name, WordFault::Twice)) } else { Ok(()) }
}
