//! The words of one block of Klartext: each is a name and, for most names, a number right behind it.

use super::super::number::Number;
use super::super::state::Spindle;
use crate::nc::{Fault, WordFault};
use toolpathd_core::geometry::curve::Direction;
use toolpathd_core::toolpath::cutting::Coolant;

/// The names that may stand in each kind of block, in the order in which the control writes them. A word may
/// stand once for each time that its name is listed. In the plane ZX, Z may stand before X or behind it.
pub const STRAIGHT: &[&str] = &["X", "Y", "Z", "A", "B", "C", "R", "F", "M", "M", "M", "M"];
pub const VECTOR: &[&str] = &["X", "Y", "Z", "TX", "TY", "TZ", "R", "F", "M", "M", "M", "M"];
pub const CENTER: &[&str] = &["X", "Y", "Z", "X"];
pub const ARC: &[&str] = &["X", "Y", "Z", "X", "DR", "R", "F", "M", "M", "M", "M"];
pub const HELIX: &[&str] = &["IPA", "IZ", "DR", "R", "F", "M", "M", "M", "M"];
pub const CORNER: &[&str] = &["X", "Y", "Z"];
pub const FUNCTIONS: &[&str] = &["M", "M", "M", "M"];

/// Names with a number. `Words::get` finds a number by the place of its name.
const NUMBERS: [&str; 11] = ["X", "Y", "Z", "A", "B", "C", "TX", "TY", "TZ", "IPA", "IZ"];

/// Other names.
const OTHERS: [&str; 4] = ["DR", "R", "F", "M"];

/// Digits before the point of a coordinate, an angle or a feed, and of the angle of a helix.
const WHOLE_DIGITS: usize = 5;
const HELIX_WHOLE_DIGITS: usize = 4;
const HELIX_DECIMALS: u8 = 4;

/// Decimals of a component of a vector: neither more nor fewer.
const VECTOR_DECIMALS: u8 = 7;

/// The decimals that numbers may have.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    pub decimals: u8,
    pub angle_decimals: u8,
    pub feed_decimals: u8,
}

/// The F word of a block.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Speed {
    /// FMAX.
    Rapid,
    /// As written, above zero.
    Feed(f64),
}

/// The M words of a block.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Functions {
    pub spindle: Option<Spindle>,
    pub coolant: Option<Coolant>,
    pub has_end: bool,
    /// The last M word is M91, and it is the only one.
    pub has_machine_zero: bool,
    /// M99, alone: the canned cycle runs at the end of the block.
    pub has_call: bool,
}

/// The words of a block.
#[derive(Debug, Default)]
pub struct Words {
    numbers: [Option<f64>; NUMBERS.len()],
    pub direction: Option<Direction>,
    pub speed: Option<Speed>,
    pub functions: Functions,
}

impl Words {
    /// Reads words that blanks divide. `names` are those that may stand in the block, in their order.
    ///
    /// # Errors
    /// When a word is unknown, stands twice or in the wrong place, or when its number has another form.
    pub fn of(text: &str, names: &[&'static str], limits: &Limits) -> Result<Self, Fault> {
        let mut words = Self::default();
        let mut next = 0;
        for word in text.split_ascii_whitespace() {
            let end = word.find(|c: char| !c.is_ascii_uppercase()).unwrap_or(word.len());
            let (written, value) = if word == "FMAX" { ("F", "MAX") } else { word.split_at(end) };
            let known = NUMBERS.iter().chain(&OTHERS).find(|name| **name == written);
            let Some(&name) = known else {
                return Err(Fault::UnknownWord(word.chars().next().unwrap_or_default()));
            };
            let Some(place) = names[next..].iter().position(|allowed| *allowed == name) else {
                return Err(Fault::Word(name, words.misplaced(name, names)));
            };
            next += place + 1;
            words.take(name, value, limits)?;
        }
        Ok(words)
    }

    /// Why a word may not stand where it stands.
    fn misplaced(&self, name: &'static str, names: &[&'static str]) -> WordFault {
        let is_twice = match name {
            "DR" => self.direction.is_some(),
            "F" => self.speed.is_some(),
            _ => self.get(name).is_some(),
        };
        if is_twice {
            WordFault::Twice
        } else if names.contains(&name) {
            WordFault::Order
        } else {
            WordFault::Unused
        }
    }

    fn take(&mut self, name: &'static str, value: &str, limits: &Limits) -> Result<(), Fault> {
        let wrong = |fault| Fault::Word(name, fault);
        match (name, value) {
            ("DR", "+") => self.direction = Some(Direction::Ccw),
            ("DR", "-") => self.direction = Some(Direction::Cw),
            ("R", "0") => {}
            ("DR" | "R", _) => return Err(wrong(WordFault::Form)),
            ("F", "MAX") => self.speed = Some(Speed::Rapid),
            ("F", _) => {
                let feed = Number::whole_of(value).ok_or(wrong(WordFault::Number))?;
                if feed.sign.is_some() || !feed.fits(WHOLE_DIGITS, limits.feed_decimals) {
                    return Err(wrong(WordFault::Form));
                }
                if feed.value <= 0.0 {
                    return Err(wrong(WordFault::Range));
                }
                self.speed = Some(Speed::Feed(feed.value));
            }
            ("M", _) => {
                let number = Number::whole_of(value).ok_or(wrong(WordFault::Number))?;
                self.functions.take(number.count().ok_or(wrong(WordFault::Form))?)?;
            }
            _ => {
                let number = Number::whole_of(value).ok_or(wrong(WordFault::Number))?;
                let has_form = match name {
                    "TX" | "TY" | "TZ" => {
                        number.fits(1, VECTOR_DECIMALS) && number.decimals() == usize::from(VECTOR_DECIMALS)
                    }
                    "IPA" => number.fits(HELIX_WHOLE_DIGITS, HELIX_DECIMALS),
                    "A" | "B" | "C" => number.fits(WHOLE_DIGITS, limits.angle_decimals),
                    _ => number.fits(WHOLE_DIGITS, limits.decimals),
                };
                let has_digits = !number.whole.is_empty() && number.fraction != Some("");
                if number.sign.is_none() || !has_form || !has_digits {
                    return Err(wrong(WordFault::Form));
                }
                let place = NUMBERS.iter().position(|known| *known == name).unwrap_or_default();
                // X is listed twice where Z may stand before it.
                if self.numbers[place].replace(number.value).is_some() {
                    return Err(wrong(WordFault::Twice));
                }
            }
        }
        Ok(())
    }

    pub fn get(&self, name: &str) -> Option<f64> {
        self.numbers[NUMBERS.iter().position(|known| *known == name)?]
    }

    /// The numbers of three names.
    pub fn three(&self, names: [&str; 3]) -> [Option<f64>; 3] {
        names.map(|name| self.get(name))
    }
}

impl Functions {
    fn take(&mut self, code: u32) -> Result<(), Fault> {
        let is_twice = match code {
            3 => self.spindle.replace(Spindle::Clockwise).is_some(),
            5 => self.spindle.replace(Spindle::Off).is_some(),
            8 => self.coolant.replace(Coolant::Flood).is_some(),
            9 => self.coolant.replace(Coolant::Off).is_some(),
            30 => std::mem::replace(&mut self.has_end, true),
            99 => std::mem::replace(&mut self.has_call, true),
            91 => std::mem::replace(&mut self.has_machine_zero, true),
            _ => return Err(Fault::UnknownM(f64::from(code))),
        };
        if is_twice {
            return Err(Fault::Conflict);
        }
        let others = self.spindle.is_some() || self.coolant.is_some() || self.has_end;
        let alone = [self.has_machine_zero, self.has_call];
        if alone.contains(&true) && (others || alone == [true; 2]) { Err(Fault::Conflict) } else { Ok(()) }
    }
}
