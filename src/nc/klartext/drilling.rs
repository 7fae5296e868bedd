//! Cycles for holes: 200, 201, 202, 203, 205, 206, 207, 209 and 240, and the older 1, 2 and 17.
//!
//! # Method
//! 1. Rapid to the clearance (Q200) above the surface (Q203). A cycle of the older form begins where the tool
//!    stands, at its clearance above the surface.
//! 2. Feed to the depth, in infeeds for cycles 1, 200, 203 and 205, which shrink by Q212 down to Q205. An
//!    infeed ends with a way to the clearance and a rapid down the hole to a distance above the bottom: the
//!    clearance for cycles 200 and 203, Q258 for cycle 205, and 0.6 mm to 7 mm by the depth for cycle 1.
//! 3. To break chips the tool goes back by Q256: in cycle 203 behind an infeed, Q213 times before it leaves
//!    the hole; in cycles 205 and 209 each Q257. In cycle 209 Q256 counts pitches, and 0 leads out of it.
//! 4. Pause, and back to the clearance by rapid or feed as the cycle says.
//! 5. Rapid to the second clearance (Q204), if that is higher.
//!
//! # Guarantees
//! Deeper starts, moves to the side at the bottom and depths that count from a diameter are refused, because
//! their paths depend on the control or on the tool. What breaks chips stays in the hole that is cut already.

use std::collections::BTreeMap;

use crate::codes::FeedMode;
use crate::fault::Fault;

/// The cycle that a call runs.
#[derive(Debug, Clone)]
pub enum Cycle {
    Hole(Box<Drilling>),
    /// Cycle 12.
    Program(String),
    /// Its definition was refused.
    Refused,
}

/// The values of the Q parameters of a cycle.
pub type Values = BTreeMap<u16, f64>;

/// A feed of FMAX, as the control writes it where a cycle takes a number.
pub const RAPID: f64 = 99_999.0;

/// Most infeeds of one hole. More would be an error of the program.
const MAX_PECKS: f64 = 100_000.0;

/// A feed with its mode.
pub type Rate = (FeedMode, f64);

/// A cycle for holes. Lengths are in mm of the program and positive.
#[derive(Debug, Clone)]
pub struct Drilling {
    /// `None` for a cycle that begins where the tool stands.
    pub surface: Option<f64>,
    pub clearance: f64,
    /// Zero for a cycle that does nothing.
    pub depth: f64,
    pub second: f64,
    pub rate: Rate,
    pub infeed: f64,
    /// How much each infeed is less than the one before, and the least infeed.
    pub decrement: f64,
    pub least: f64,
    pub chips: Chips,
    /// Where the rapid down the hole ends, above the bottom of the last infeed.
    pub stop: f64,
    /// The distance is the clearance, whatever that is.
    stops_at_clearance: bool,
    pub top_s: f64,
    pub bottom_s: f64,
    /// `None` for a rapid.
    pub out: Option<Rate>,
    pub is_tapping: bool,
    /// The parameters of its definition.
    pub values: Values,
}

/// How a cycle breaks chips.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Chips {
    /// How many infeeds end with a way back by `back` before one leaves the hole.
    pub n_infeeds: f64,
    /// The depth behind which the tool goes back; 0 for none.
    pub every: f64,
    pub back: f64,
    /// The tool follows its thread on all ways, and leaves the hole where `back` is zero.
    pub in_thread: bool,
}

/// What a feed of a cycle is multiplied by: in inches it counts tenths of an inch per minute.
fn feed_unit(in_inches: bool) -> f64 {
    if in_inches { 2.54 } else { 1.0 }
}

impl Drilling {
    /// The cycle with this number.
    ///
    /// # Errors
    /// When a value is out of range, or the path is not certain.
    pub fn new(number: u32, values: Values, in_inches: bool) -> Result<Self, Fault> {
        let own = |number: u16| values.get(&number).copied().unwrap_or(0.0);
        let unit = if in_inches { 25.4 } else { 1.0 };
        let length = |number: u16| own(number) * unit;
        // Deeper starts, moves aside and depths of a diameter.
        let unsure = [379, 395, 214, 343, 342];
        if let Some(unsure) = unsure.into_iter().find(|number| own(*number) != 0.0) {
            return Err(Fault::UnsureParameter(unsure));
        }
        let depth = positive(-own(201) * unit)?;
        let has_infeeds = values.contains_key(&202);
        let infeed = if has_infeeds { positive(length(202))? } else { depth };
        let is_pecking = depth > infeed;
        let decrement = positive(length(212))?;
        let least = if decrement > 0.0 { positive(length(205))?.min(infeed) } else { infeed };
        if has_infeeds && depth > 0.0 && !(infeed > 0.0 && depth / infeed <= MAX_PECKS) {
            return Err(Fault::OutOfRange(own(202)));
        }
        if is_pecking && !(least > 0.0 && depth / least <= MAX_PECKS) {
            return Err(Fault::OutOfRange(own(205)));
        }
        let unsure = match number {
            205 if is_pecking && own(258) != own(259) => Some(259),
            205 if is_pecking && own(208) != 0.0 && own(208) < RAPID => Some(208),
            _ => None,
        };
        if let Some(unsure) = unsure {
            return Err(Fault::UnsureParameter(unsure));
        }
        let by_pitch = matches!(number, 207 | 209);
        if in_inches && by_pitch {
            return Err(Fault::UnsureFeed);
        }
        let feed_unit = feed_unit(in_inches);
        let rate = if by_pitch {
            (FeedMode::PerTurn, positive(own(239).abs())?)
        } else {
            (FeedMode::PerMinute, positive(own(206))? * feed_unit)
        };
        let out = match number {
            206 | 207 => Some(rate),
            // Q403 makes the spindle faster on its way out, and the feed with it.
            209 => Some((FeedMode::PerTurn, rate.1 * factor_out(values.get(&403).copied())?)),
            201 | 202 if own(208) == 0.0 => Some(rate),
            201..=203 | 205 if own(208) > 0.0 && own(208) < RAPID => {
                Some((FeedMode::PerMinute, own(208) * feed_unit))
            }
            _ => None,
        };
        let chips = Chips::new(number, &values, unit, depth)?;
        positive(own(208))?;
        let stop = positive(if number == 205 { length(258) } else { length(200) })?;
        Ok(Self {
            surface: Some(length(203)),
            clearance: positive(length(200))?,
            depth,
            second: positive(length(204))?,
            rate,
            infeed,
            decrement,
            least,
            chips,
            stop,
            stops_at_clearance: number != 205,
            top_s: positive(own(210))?,
            bottom_s: positive(own(211))?,
            out,
            is_tapping: matches!(number, 206 | 207 | 209),
            values,
        })
    }

    /// A cycle of the older form by the values of its blocks: clearance, depth, and infeed, pause and feed
    /// of cycle 1, pause and feed of cycle 2, or pitch of cycle 17.
    ///
    /// # Errors
    /// When a value is out of range.
    pub fn older(number: u32, values: &[f64], in_inches: bool) -> Result<Self, Fault> {
        if in_inches && number == 17 {
            return Err(Fault::UnsureFeed);
        }
        let own = |index: usize| values.get(index).copied().unwrap_or(0.0);
        let (unit, feed_unit) = (if in_inches { 25.4 } else { 1.0 }, feed_unit(in_inches));
        let depth = positive(-own(1) * unit)?;
        let infeed = if number == 1 { positive(own(2).abs() * unit)? } else { depth };
        if depth > 0.0 && !(infeed > 0.0 && depth / infeed <= MAX_PECKS) {
            return Err(Fault::OutOfRange(own(2)));
        }
        let rate = match number {
            1 => (FeedMode::PerMinute, positive(own(4))? * feed_unit),
            2 => (FeedMode::PerMinute, positive(own(3))? * feed_unit),
            _ => (FeedMode::PerTurn, positive(own(2).abs())?),
        };
        let bottom_s = match number {
            1 => positive(own(3))?,
            2 => positive(own(2))?,
            _ => 0.0,
        };
        Ok(Self {
            surface: None,
            clearance: own(0).abs() * unit,
            depth,
            second: 0.0,
            rate,
            infeed,
            decrement: 0.0,
            least: infeed,
            chips: Chips::default(),
            // TNC 426, *User's Manual*: 0.6 mm up to a depth of 30 mm, then a fiftieth of it up to 7 mm.
            stop: if depth <= 30.0 { 0.6 } else { (depth / 50.0).min(7.0) },
            stops_at_clearance: false,
            top_s: 0.0,
            bottom_s,
            out: (number != 1).then_some(rate),
            is_tapping: number != 1,
            values: Values::new(),
        })
    }
}

impl Drilling {
    /// Puts the surface and the clearances of a pattern in the place of its own.
    pub fn place(&mut self, surface: f64, clearance: f64, second: f64) {
        if self.stops_at_clearance {
            self.stop = clearance;
        }
        (self.surface, self.clearance, self.second) = (Some(surface), clearance, second);
    }
}

impl Chips {
    /// What a cycle says of chips.
    fn new(number: u32, values: &Values, unit: f64, depth: f64) -> Result<Self, Fault> {
        let own = |number: u16| values.get(&number).copied().unwrap_or(0.0);
        let (count, every) = (positive(own(213))?, positive(own(257) * unit)?);
        if count == 0.0 && every == 0.0 {
            return Ok(Self::default());
        }
        if !values.contains_key(&256) {
            return Err(Fault::LacksParameter(256));
        }
        if count.fract() != 0.0 || every > 0.0 && depth / every > MAX_PECKS {
            return Err(Fault::OutOfRange(if count.fract() != 0.0 { count } else { own(257) }));
        }
        let in_thread = number == 209;
        let back = positive(own(256))? * if in_thread { own(239).abs() } else { unit };
        Ok(Self { n_infeeds: count, every, back, in_thread })
    }
}

/// The factor of the speed on the way out of a thread.
fn factor_out(given: Option<f64>) -> Result<f64, Fault> {
    match given {
        None => Ok(1.0),
        Some(factor) if (0.0001..=10.0).contains(&factor) => Ok(factor),
        Some(factor) => Err(Fault::OutOfRange(factor)),
    }
}

fn positive(value: f64) -> Result<f64, Fault> {
    if value >= 0.0 { Ok(value.abs()) } else { Err(Fault::OutOfRange(value)) }
}
