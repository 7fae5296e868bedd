//! The state of a control, as far as the lines read so far tell it.

use super::codes::{Effect, Function, Place, effect, function};
use super::line::Line;
use super::number::{Number, is_coordinate};
use crate::geometry::curve::Direction;
use crate::geometry::plane::Plane;
use crate::post::dialect::{Dialect, Point};
use crate::toolpath::program::Units;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    Rapid,
    Line,
    Arc(Direction),
}

/// How coordinates, or the centres of arcs, are counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Distance {
    Absolute,
    Incremental,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FeedMode {
    InverseTime,
    PerMinute,
    PerTurn,
}

/// Modes under which nothing is fitted: there an arc is not what it would be without, or every block is more than a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u16)]
pub enum Bar {
    Compensation = 1,
    Rotation = 2,
    Scaling = 4,
    Mirror = 8,
    Polar = 16,
    Diameter = 32,
    Cylinder = 64,
    ToolPoint = 128,
    ExactStop = 256,
    Macro = 512,
}

/// A feed as it is written; where the point decides what a number means, numbers with and without are different.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Feed {
    pub millionths: i64,
    pub has_point: bool,
}

/// What holds before a line; none where it is not known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Modes {
    pub units: Option<Units>,
    pub distance: Option<Distance>,
    pub centers: Option<Distance>,
    pub plane: Option<Plane>,
    pub feed_mode: Option<FeedMode>,
    pub motion: Option<Motion>,
    pub feed: Option<Feed>,
    /// Millionths of a unit of the program.
    pub at: [Option<i64>; 3],
    barred: u16,
}

/// What a line needs of the modes that a rewritten run may have left different, and what it says of them itself.
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
    /// It moves as the mode says, and a G1 in it says the same.
    Word,
    /// Something of it may depend on the mode.
    Mode,
}

impl Needs {
    pub const ALL: Self =
        Self { plane: true, motion: MotionNeed::Mode, says_plane: false, says_motion: false };

    /// Those of the end of a program: what runs next says how it moves, but perhaps not in which plane.
    const END: Self = Self { plane: true, motion: MotionNeed::Nothing, says_plane: false, says_motion: true };
}

impl Modes {
    /// What holds at the start of a program that says nothing else: mm, absolute, in XY, feeds by the minute.
    pub const START: Self = Self {
        units: Some(Units::Mm),
        distance: Some(Distance::Absolute),
        centers: Some(Distance::Incremental),
        plane: Some(Plane::Xy),
        feed_mode: Some(FeedMode::PerMinute),
        motion: None,
        feed: None,
        at: [None; 3],
        barred: 0,
    };

    /// What holds where nothing is known; compensations are taken to be off.
    const UNKNOWN: Self = Self {
        units: None,
        distance: None,
        centers: None,
        plane: None,
        feed_mode: None,
        motion: None,
        feed: None,
        at: [None; 3],
        barred: 0,
    };

    /// Whether a run may stand here, if its blocks are lines.
    pub fn allow_runs(&self) -> bool {
        let may_write_centers = match self.centers {
            Some(Distance::Absolute) => self.at.iter().all(Option::is_some),
            Some(Distance::Incremental) => true,
            None => false,
        };
        let is_known = self.units.is_some() && self.distance.is_some() && self.plane.is_some();
        let has_feed_mode = matches!(self.feed_mode, Some(FeedMode::InverseTime | FeedMode::PerMinute));
        self.barred == 0 && may_write_centers && is_known && has_feed_mode
    }

    /// What is left when another part of the program, or another program, has run: units, the way centres are counted and
    /// feeds are, and compensations are taken to be as they were.
    pub fn forgotten(&self) -> Self {
        Self { distance: None, plane: None, motion: None, feed: None, at: [None; 3], ..*self }
    }

    /// What holds behind `line`, and what the line needs of what holds before it.
    pub fn read(&self, line: &Line, dialect: &Dialect) -> (Self, Needs) {
        if line.is_assignment {
            return (Self { feed: None, at: [None; 3], ..*self }, Needs::ALL);
        }
        if line.is_unclear {
            return (self.forgotten(), Needs::ALL);
        }
        if line.is_mark || line.is_named {
            let is_first = *self == Self::START;
            let needs = if line.is_mark { Needs::END } else { Needs::ALL };
            return (if is_first { *self } else { self.forgotten() }, needs);
        }
        let (next, needs) = self.understood(line, dialect);
        if line.is_optional { (self.common_with(&next), Needs::ALL) } else { (next, needs) }
    }

    fn understood(&self, line: &Line, dialect: &Dialect) -> (Self, Needs) {
        let mut reading = Reading {
            modes: *self,
            needs: Needs::default(),
            axes: Axes::Move,
            loses_place: false,
            is_unknown: false,
        };
        line.g.all().iter().for_each(|&tenths| reading.take(effect(tenths)));
        line.m.all().iter().for_each(|&tenths| reading.function(function(tenths)));
        if line.has(b"TH") {
            reading.place(Place::Shifted);
        }
        if let Some(feed) = line.feed {
            reading.modes.feed = Some(Feed::of(feed, dialect));
        }
        reading.go(line, dialect);
        (reading.modes, reading.needs)
    }

    /// What is so in both cases; where either is barred, it is.
    fn common_with(&self, other: &Self) -> Self {
        fn both<T: PartialEq>(one: Option<T>, other: Option<T>) -> Option<T> {
            one.filter(|one| Some(one) == other.as_ref())
        }
        Self {
            units: both(self.units, other.units),
            distance: both(self.distance, other.distance),
            centers: both(self.centers, other.centers),
            plane: both(self.plane, other.plane),
            feed_mode: both(self.feed_mode, other.feed_mode),
            motion: both(self.motion, other.motion),
            feed: both(self.feed, other.feed),
            at: std::array::from_fn(|k| both(self.at[k], other.at[k])),
            barred: self.barred | other.barred,
        }
    }

    /// The decimals of the least increment, where numbers without a point count those; see [`Number::coordinate`].
    pub fn increment(&self, dialect: &Dialect) -> Option<u8> {
        (dialect.numbers.point == Point::Always).then(|| default_decimals(self.units, dialect))
    }
}

/// The decimals a program in these units has.
pub fn default_decimals(units: Option<Units>, dialect: &Dialect) -> u8 {
    match units {
        Some(Units::Inch) => dialect.default_decimals_inch,
        Some(Units::Mm) | None => dialect.default_decimals_mm,
    }
}

impl Feed {
    pub fn of(number: Number, dialect: &Dialect) -> Self {
        let has_point = number.has_point && dialect.numbers.point == Point::Always;
        Self { millionths: number.millionths, has_point }
    }
}

/// What the axis words of a line are for.
#[derive(Clone, Copy, PartialEq)]
enum Axes {
    Move,
    SayElse,
}

/// A line while its words take effect.
struct Reading {
    modes: Modes,
    needs: Needs,
    axes: Axes,
    loses_place: bool,
    is_unknown: bool,
}

impl Reading {
    fn take(&mut self, effect: Effect) {
        match effect {
            Effect::Motion(motion) => {
                self.modes.motion = Some(motion);
                self.needs.says_motion = true;
            }
            Effect::Plane(plane) => {
                self.modes.plane = Some(plane);
                self.needs.says_plane = true;
            }
            Effect::Units(units) if self.modes.units == Some(units) => {}
            Effect::Units(units) => {
                self.modes.units = Some(units);
                self.modes.at = [None; 3];
                self.modes.feed = None;
            }
            Effect::Distance(distance) => self.modes.distance = Some(distance),
            Effect::Centers(distance) => self.modes.centers = Some(distance),
            Effect::FeedMode(mode) if self.modes.feed_mode == Some(mode) => {}
            Effect::FeedMode(mode) => {
                self.modes.feed_mode = Some(mode);
                self.modes.feed = None;
            }
            Effect::Begins(bar, place) => self.bar(self.modes.barred | bar as u16, place),
            Effect::Ends(bar, place) => self.bar(self.modes.barred & !(bar as u16), place),
            Effect::Place(place) => self.place(place),
            Effect::NoMotion => {
                self.modes.motion = self.modes.motion.filter(|_| self.needs.says_motion);
                self.needs.plane = true;
                self.needs.motion = MotionNeed::Mode;
                self.place(Place::Shifted);
            }
            Effect::Nothing => {}
            Effect::Unknown => self.is_unknown = true,
        }
    }

    fn bar(&mut self, barred: u16, place: Place) {
        self.modes.barred = barred;
        self.needs.plane = true;
        self.place(place);
    }

    fn function(&mut self, function: Function) {
        match function {
            Function::Inert => {}
            Function::ToolChange => self.place(Place::Shifted),
            Function::Ends => {
                self.needs = Needs::END;
                self.modes = self.modes.forgotten();
            }
            Function::Leaves => {
                self.is_unknown = true;
                self.modes = self.modes.forgotten();
            }
            Function::Restores => {
                self.is_unknown = true;
                self.modes = Modes { barred: self.modes.barred, ..Modes::UNKNOWN };
            }
            Function::Unknown => self.is_unknown = true,
        }
    }

    fn place(&mut self, place: Place) {
        // Some controls compensate the tool's length along the normal of the plane.
        self.needs.plane |= place == Place::Shifted;
        if place == Place::Shifted {
            self.modes.at = [None; 3];
        }
        if matches!(place, Place::Taken | Place::Idle) {
            self.axes = Axes::SayElse;
        }
        self.loses_place |= matches!(place, Place::Taken | Place::Elsewhere);
    }

    /// Goes where the axis words say.
    fn go(&mut self, line: &Line, dialect: &Dialect) {
        let is_arc = matches!(self.modes.motion, Some(Motion::Arc(_)));
        let has_center = line.has(b"IJKR");
        let moves = self.axes == Axes::Move && (line.has_axes() || is_arc && has_center);
        if moves {
            self.needs.plane |= is_arc;
            if !self.needs.says_motion && self.needs.motion == MotionNeed::Nothing {
                self.needs.motion = MotionNeed::Word;
            }
            let rounds_corners = !is_arc && has_center;
            self.loses_place |= self.modes.motion.is_none() || rounds_corners || line.has_other_axes();
            for (axis, word) in line.axes.iter().enumerate() {
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

impl Modes {
    /// Where the axis is behind a block that has this word for it.
    pub fn reached(&self, axis: usize, word: Number, dialect: &Dialect) -> Option<i64> {
        let (value, _) = word.coordinate(self.increment(dialect))?;
        let from = match self.distance? {
            Distance::Absolute => 0,
            Distance::Incremental => self.at[axis]?,
        };
        Some(from + value).filter(|at| is_coordinate(*at))
    }
}
