//! Follows the modal state of the control line by line, and says on which modes a line relies.

use super::block::Block;
use super::mentions::Mentions;
use crate::dialect::{Dialect, Point};
use crate::nc::{
    Decimal, Distance, Effect, FeedMode, Function, Modal, Modifier, Motion, PositionEffect, effect, function,
    is_coordinate,
};
use toolpathd_core::toolpath::program::Units;

/// The code of a dwell, in tenths.
const DWELL: i32 = 40;

/// The modal state before a line. Coordinates are millionths of a unit of the program.
pub type Modes = Modal<i64, Feed>;

/// A feed as it is written. If the decimal point decides what a number means, numbers with and without a
/// point differ.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Feed {
    pub millionths: i64,
    pub has_point: bool,
}

/// The modes that a line relies on and that a rewritten run may have changed, and which of these modes the
/// line itself sets.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Needs {
    pub plane: bool,
    pub motion: MotionNeed,
    pub says_plane: bool,
    pub says_motion: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MotionNeed {
    #[default]
    Nothing,
    /// The line moves as the mode says; a G1 in the line has the same effect.
    Word,
    /// The line may depend on the mode in another way.
    Mode,
}

impl Needs {
    pub const ALL: Self =
        Self { plane: true, motion: MotionNeed::Mode, says_plane: false, says_motion: false };

    /// The needs of a program's end: the next program says how it moves, but perhaps not in which plane.
    const END: Self = Self { plane: true, motion: MotionNeed::Nothing, says_plane: false, says_motion: true };
}

impl Modes {
    /// Whether lines under these modes may be in a run.
    pub fn allow_runs(&self) -> bool {
        let may_write_centers = match self.centers {
            Some(Distance::Absolute) => self.at.iter().all(Option::is_some),
            Some(Distance::Incremental) => true,
            None => false,
        };
        let is_known = self.units.is_some() && self.distance.is_some() && self.plane.is_some();
        let has_feed_mode = matches!(self.feed_mode, Some(FeedMode::InverseTime | FeedMode::PerMinute));
        // Under exact stop, the control stops at the end of each block, wherever that is.
        let modifiers = self.modifiers & !(Modifier::ExactStop as u16);
        modifiers == 0 && may_write_centers && is_known && has_feed_mode
    }

    /// The state after `block`, and what the block needs of the state before it. After an assignment to a
    /// variable, only feed and position are unknown.
    pub fn read(&self, block: &Block, dialect: &Dialect, mentions: &Mentions) -> (Self, Needs) {
        if block.is_assignment {
            return (Self { feed: None, at: [None; 3], ..*self }, Needs::ALL);
        }
        if block.is_plain_jump {
            return (*self, Needs::ALL);
        }
        if block.is_unclear {
            return (mentions.forget(self), Needs::ALL);
        }
        if block.has_tape_mark || block.has(b"O") {
            let is_first = *self == Self::START;
            let needs = if block.has_tape_mark { Needs::END } else { Needs::ALL };
            return (if is_first { *self } else { mentions.forget(self) }, needs);
        }
        let (next, needs) = self.understood(block, dialect, mentions);
        if block.is_optional { (self.common_with(&next), Needs::ALL) } else { (next, needs) }
    }

    fn understood(&self, block: &Block, dialect: &Dialect, mentions: &Mentions) -> (Self, Needs) {
        let mut reading = OpenBlock {
            modes: *self,
            needs: Needs::default(),
            moves_axes: true,
            loses_place: false,
            is_unknown: false,
            leaves: false,
            ends: false,
        };
        block.g.all().iter().for_each(|&code| reading.take(effect(code)));
        block.m.all().iter().for_each(|&code| reading.function(function(code)));
        if block.has(b"TH") {
            reading.place(PositionEffect::Shifted);
        }
        if let Some((feed, _)) = block.feed {
            // F of a dwell is a time on some controls.
            reading.modes.feed = Some(Feed::of(feed, dialect)).filter(|_| !block.g.has(DWELL));
        }
        reading.go(block, dialect);
        if reading.leaves || reading.ends {
            reading.modes = mentions.forget(&reading.modes);
        }
        (reading.modes, reading.needs)
    }

    /// The decimals of the least increment, where numbers without a point count least increments; see
    /// [`Decimal::coordinate`].
    pub fn increment(&self, dialect: &Dialect) -> Option<u8> {
        (dialect.numbers.point == Point::Always).then(|| default_decimals(self.units, dialect))
    }

    /// The position of the axis after a block with this word for the axis; `None` if it is unknown.
    fn reached(&self, axis: usize, word: Decimal, dialect: &Dialect) -> Option<i64> {
        let (value, _) = word.coordinate(self.increment(dialect))?;
        let from = match self.distance? {
            Distance::Absolute => 0,
            Distance::Incremental => self.at[axis]?,
        };
        Some(from + value).filter(|at| is_coordinate(*at))
    }
}

/// The decimals of a program in these units.
pub fn default_decimals(units: Option<Units>, dialect: &Dialect) -> u8 {
    match units {
        Some(Units::Inch) => dialect.default_decimals_inch,
        Some(Units::Mm) | None => dialect.default_decimals_mm,
    }
}

impl Feed {
    pub fn of(number: Decimal, dialect: &Dialect) -> Self {
        let has_point = number.has_point && dialect.numbers.point == Point::Always;
        Self { millionths: number.millionths, has_point }
    }
}

/// A block while its words take effect.
struct OpenBlock {
    modes: Modes,
    needs: Needs,
    /// Whether the axis words are coordinates; otherwise they are parameters of a code.
    moves_axes: bool,
    loses_place: bool,
    is_unknown: bool,
    /// Another program runs, or has run at blocks before this one.
    leaves: bool,
    /// The program ends.
    ends: bool,
}

impl OpenBlock {
    fn take(&mut self, effect: Effect) {
        let before = self.modes;
        self.modes.apply(effect);
        match effect {
            Effect::Motion(_) => self.needs.says_motion = true,
            Effect::Plane(_) => self.needs.says_plane = true,
            Effect::Units(_) if self.modes.units != before.units => {
                self.modes.at = [None; 3];
                self.modes.feed = None;
            }
            Effect::FeedMode(_) if self.modes.feed_mode != before.feed_mode => {
                self.modes.feed = None;
                // A G1 that comes later would need a feed of the other kind.
                self.needs.motion = MotionNeed::Mode;
            }
            Effect::Begins(modifier, place) | Effect::Ends(modifier, place) => {
                self.leaves |= modifier == Modifier::ModalMacro;
                self.needs.plane = true;
                self.place(place);
            }
            Effect::Position(place) => self.place(place),
            Effect::NoMotion => {
                // If another word of motion stands beside G80, G80 ends only the cycle.
                self.modes.motion = before.motion.filter(|_| self.needs.says_motion);
                self.needs.plane = true;
                self.needs.motion = MotionNeed::Mode;
                self.place(PositionEffect::Shifted);
            }
            Effect::Leaves => (self.is_unknown, self.leaves) = (true, true),
            Effect::Unknown => self.is_unknown = true,
            _ => {}
        }
    }

    fn function(&mut self, function: Function) {
        match function {
            Function::Inert => {}
            Function::ToolChange => self.place(PositionEffect::Shifted),
            Function::Ends => {
                self.needs = Needs::END;
                self.ends = true;
            }
            Function::Leaves => (self.is_unknown, self.leaves) = (true, true),
            Function::Restores => {
                self.is_unknown = true;
                self.modes = Modes { modifiers: self.modes.modifiers, ..Modes::UNKNOWN };
            }
            Function::Unknown => self.is_unknown = true,
        }
    }

    fn place(&mut self, place: PositionEffect) {
        // Some controls compensate the tool's length along the normal of the plane.
        self.needs.plane |= place == PositionEffect::Shifted;
        if place == PositionEffect::Shifted {
            self.modes.at = [None; 3];
        }
        self.moves_axes &= !matches!(place, PositionEffect::Taken | PositionEffect::Idle);
        self.loses_place |= matches!(place, PositionEffect::Taken | PositionEffect::Elsewhere);
    }

    /// Moves to the coordinates of the axis words.
    fn go(&mut self, block: &Block, dialect: &Dialect) {
        let is_arc = matches!(self.modes.motion, Some(Motion::Arc(_)));
        let has_center = block.has(b"IJKR");
        if self.moves_axes && (block.has_axes() || is_arc && has_center) {
            self.needs.plane |= is_arc;
            if !self.needs.says_motion && self.needs.motion == MotionNeed::Nothing {
                self.needs.motion = MotionNeed::Word;
            }
            let rounds_corners = !is_arc && has_center;
            // Rounded distances would add up.
            let adds_up = block.is_rounded && self.modes.distance != Some(Distance::Absolute);
            self.loses_place |=
                self.modes.motion.is_none() || rounds_corners || block.has_other_axes() || adds_up;
            for (axis, word) in block.axes.iter().enumerate() {
                if let Some(word) = word {
                    self.modes.at[axis] = self.modes.reached(axis, *word, dialect);
                }
            }
        }
        if self.is_unknown {
            self.needs = Needs::ALL;
            self.modes.motion = None;
        }
        if self.is_unknown || self.loses_place {
            self.modes.at = [None; 3];
        }
    }
}
