//! Cycles for holes: 200, 201, 202, 203, 205, 206, 207 and 240, and the older 1, 2 and 17.
//!
//! # Method
//! 1. Rapid to the clearance (Q200) above the surface (Q203). A cycle of the older form begins where the tool
//!    stands, at its clearance above the surface.
//! 2. Feed to the depth, in infeeds for cycles 1, 200 and 205. An infeed ends with a rapid to the clearance
//!    and a rapid down the hole to a distance above the bottom: the clearance for cycle 200, Q258 for cycle
//!    205, and 0.6 mm to 7 mm by the depth for cycle 1.
//! 3. Pause, and back to the clearance by rapid or feed as the cycle says.
//! 4. Rapid to the second clearance (Q204), if that is higher.
//!
//! # Guarantees
//! Chip breaking, infeeds that shrink, moves to the side at the bottom and depths that count from a diameter
//! are refused, because their paths depend on the control or on the tool.

use std::collections::BTreeMap;

use super::Execution;
use super::parameters::Key;
use super::script::Block;
use crate::codes::FeedMode;
use crate::fault::Fault;
use crate::machine::{At, Machine};
use crate::notes::Note;
use crate::placement::Coordinate;

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
type Rate = (FeedMode, f64);

/// A cycle for holes. Lengths are in mm of the program and positive.
#[derive(Debug, Clone)]
pub struct Drilling {
    /// `None` for a cycle that begins where the tool stands.
    pub surface: Option<f64>,
    pub clearance: f64,
    /// Zero for a cycle that does nothing.
    depth: f64,
    pub second: f64,
    rate: Rate,
    infeed: f64,
    /// Where the rapid down the hole ends, above the bottom of the last infeed.
    stop: f64,
    /// The distance is the clearance, whatever that is.
    stops_at_clearance: bool,
    top_s: f64,
    bottom_s: f64,
    /// `None` for a rapid.
    out: Option<Rate>,
    is_tapping: bool,
    /// The parameters of its definition.
    values: Values,
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
        // Breaking chips, shrinking infeeds, deeper starts, moves aside and depths of a diameter.
        let unsure = [212, 257, 379, 395, 214, 343, 342, 213];
        if let Some(unsure) = unsure.into_iter().find(|number| own(*number) != 0.0) {
            return Err(Fault::UnsureParameter(unsure));
        }
        let depth = positive(-own(201) * unit)?;
        let has_infeeds = values.contains_key(&202);
        let infeed = if has_infeeds { positive(length(202))? } else { depth };
        let is_pecking = depth > infeed;
        if has_infeeds && depth > 0.0 && !(infeed > 0.0 && depth / infeed <= MAX_PECKS) {
            return Err(Fault::OutOfRange(own(202)));
        }
        let unsure = match number {
            203 if is_pecking => Some(202),
            205 if is_pecking && own(258) != own(259) => Some(259),
            205 if is_pecking && own(208) != 0.0 && own(208) < RAPID => Some(208),
            _ => None,
        };
        if let Some(unsure) = unsure {
            return Err(Fault::UnsureParameter(unsure));
        }
        if in_inches {
            return Err(Fault::UnsureFeed);
        }
        let rate = if number == 207 {
            (FeedMode::PerTurn, positive(own(239).abs())?)
        } else {
            (FeedMode::PerMinute, positive(own(206))?)
        };
        let out = match number {
            206 | 207 => Some(rate),
            201 | 202 if own(208) == 0.0 => Some(rate),
            201..=203 | 205 if own(208) > 0.0 && own(208) < RAPID => Some((FeedMode::PerMinute, own(208))),
            _ => None,
        };
        positive(own(208))?;
        let stop = positive(if number == 205 { length(258) } else { length(200) })?;
        Ok(Self {
            surface: Some(length(203)),
            clearance: positive(length(200))?,
            depth,
            second: positive(length(204))?,
            rate,
            infeed,
            stop,
            stops_at_clearance: number != 205,
            top_s: positive(own(210))?,
            bottom_s: positive(own(211))?,
            out,
            is_tapping: matches!(number, 206 | 207),
            values,
        })
    }

    /// A cycle of the older form by the values of its blocks: clearance, depth, and infeed, pause and feed
    /// of cycle 1, pause and feed of cycle 2, or pitch of cycle 17.
    ///
    /// # Errors
    /// When a value is out of range.
    pub fn older(number: u32, values: &[f64], in_inches: bool) -> Result<Self, Fault> {
        if in_inches {
            return Err(Fault::UnsureFeed);
        }
        let own = |index: usize| values.get(index).copied().unwrap_or(0.0);
        let depth = positive(-own(1))?;
        let infeed = if number == 1 { positive(own(2).abs())? } else { depth };
        if depth > 0.0 && !(infeed > 0.0 && depth / infeed <= MAX_PECKS) {
            return Err(Fault::OutOfRange(own(2)));
        }
        let rate = match number {
            1 => (FeedMode::PerMinute, positive(own(4))?),
            2 => (FeedMode::PerMinute, positive(own(3))?),
            _ => (FeedMode::PerTurn, positive(own(2).abs())?),
        };
        let bottom_s = match number {
            1 => positive(own(3))?,
            2 => positive(own(2))?,
            _ => 0.0,
        };
        Ok(Self {
            surface: None,
            clearance: own(0).abs(),
            depth,
            second: 0.0,
            rate,
            infeed,
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

fn positive(value: f64) -> Result<f64, Fault> {
    if value >= 0.0 { Ok(value.abs()) } else { Err(Fault::OutOfRange(value)) }
}

impl<'a> Execution<'a, '_> {
    /// Runs the cycle in force where the tool stands. `span` is where the call stands in the block.
    pub(super) fn call_cycle(&mut self, block: &Block<'a>, span: [usize; 2]) {
        match self.cycle.clone() {
            None if span == [0, 0] => self.refuse_block(block, Fault::Lacks("CYCL DEF")),
            None => self.refuse(block, span, Fault::Lacks("CYCL DEF")),
            Some(Cycle::Refused) => {
                self.machine.refuse_state(block.line(), Fault::Lacks("CYCL DEF"));
                self.lose_place();
            }
            Some(Cycle::Program(name)) => self.call_program(block, &name),
            Some(Cycle::Hole(drilling)) => self.make_hole(block, &drilling, 0.0),
        }
    }

    /// The drilling cycle in force. Refuses a block without one.
    pub(super) fn drilling(&mut self, block: &Block<'a>) -> Option<Drilling> {
        match &self.cycle {
            Some(Cycle::Hole(drilling)) => return Some((**drilling).clone()),
            Some(Cycle::Refused) => self.machine.refuse_state(block.line(), Fault::Lacks("CYCL DEF")),
            _ => self.refuse_block(block, Fault::Lacks("CYCL DEF")),
        }
        self.lose_place();
        None
    }

    /// The height of a coordinate along the tool axis.
    pub(super) fn height(&self, mm: f64) -> Option<f64> {
        let n = self.machine.plane.axes()[2];
        let mut along = [None; 3];
        along[n] = Some(Coordinate::Absolute(mm));
        self.machine.placed(along)[n]
    }

    /// Makes a hole where the tool stands, with the surface raised by `raised_mm`.
    pub(super) fn make_hole(&mut self, block: &Block<'a>, drilling: &Drilling, raised_mm: f64) {
        self.machine.exclude_compensation(block.line());
        if self.has_changed(drilling, &[]) {
            return self.refuse_block(block, Fault::ChangedCycle);
        }
        self.drill(block, drilling, raised_mm);
    }

    /// Whether a parameter of a cycle, other than `replaced`, has changed since its definition.
    pub(super) fn has_changed(&self, drilling: &Drilling, replaced: &[u16]) -> bool {
        let values = drilling.values.iter().filter(|(own, _)| !replaced.contains(own));
        let is_now =
            |own: u16, value: f64| self.parameters.get(Key::of_cycle(own)).is_ok_and(|now| now == value);
        values.into_iter().any(|(own, value)| !is_now(*own, *value))
    }

    /// Drills where the tool stands.
    pub(super) fn drill(&mut self, block: &Block<'a>, drilling: &Drilling, raised_mm: f64) {
        let n = self.machine.plane.axes()[2];
        let factor = self.machine.placement.factor(n);
        if drilling.depth == 0.0 {
            return;
        }
        if factor <= 0.0 {
            return self.refuse_block(block, Fault::NotRead);
        }
        let surface = match drilling.surface {
            Some(surface) => self.height(surface + raised_mm),
            None => self.machine.at[n].map(|at| at - factor * drilling.clearance),
        };
        let Some(surface) = surface else {
            return self.machine.refuse_state(block.line(), Fault::UnknownStart(['X', 'Y', 'Z'][n]));
        };
        self.forget_tangent();
        if drilling.is_tapping {
            self.machine.note_first(Note::Tapping { line: block.line().number });
        }
        let height = |mm: f64| surface + factor * mm;
        let own_mode = if self.is_per_turn { FeedMode::PerTurn } else { FeedMode::PerMinute };
        self.set_feed((drilling.rate.0, Some(drilling.rate.1)));
        self.rapid_to(block, height(drilling.clearance));
        self.infeed(block, drilling, &height);
        self.cut_to(block, height(-drilling.depth));
        self.cycle_pause(block, drilling.bottom_s);
        match drilling.out {
            Some((mode, feed)) => {
                self.set_feed((mode, Some(feed)));
                self.cut_to(block, height(drilling.clearance));
            }
            None => self.rapid_to(block, height(drilling.clearance)),
        }
        if drilling.second > drilling.clearance {
            self.rapid_to(block, height(drilling.second));
        }
        self.set_feed((own_mode, None));
    }

    /// All infeeds but the last.
    fn infeed(&mut self, block: &Block<'a>, drilling: &Drilling, height: &dyn Fn(f64) -> f64) {
        let mut bottom = drilling.infeed;
        while bottom < drilling.depth - 1e-9 && !self.machine.is_full() && self.spend(block, 1) {
            self.cut_to(block, height(-bottom));
            self.rapid_to(block, height(drilling.clearance));
            self.cycle_pause(block, drilling.top_s);
            self.rapid_to(block, height((drilling.stop - bottom).min(drilling.clearance)));
            bottom += drilling.infeed;
        }
    }

    fn cycle_pause(&mut self, block: &Block<'a>, seconds: f64) {
        if seconds > 0.0 {
            self.pause(block, seconds, [0, block.text.len()]);
        }
    }

    fn along(&self, height: f64) -> At {
        let Machine { mut at, plane, .. } = *self.machine;
        at[plane.axes()[2]] = Some(height);
        at
    }

    pub(super) fn rapid_to(&mut self, block: &Block<'a>, height: f64) {
        let to = self.along(height);
        self.machine.rapid(block.line(), to);
    }

    fn cut_to(&mut self, block: &Block<'a>, height: f64) {
        let to = self.along(height);
        self.machine.line(block.line(), to);
    }
}
