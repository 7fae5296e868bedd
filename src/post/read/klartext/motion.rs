//! Blocks of motion.

use nalgebra::{Point3, Vector2};

use super::super::cut::Cut;
use super::super::{Posed, PosedFeed, Step, TipMode};
use super::words::{self, Speed, Words};
use super::{Feed, Reader};
use crate::nc::{Fault, WordFault};
use toolpathd_core::geometry::curve::Direction;
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::program::Units;
use toolpathd_core::toolpath::units::FeedRate;

const LINEAR: [&str; 3] = ["X", "Y", "Z"];
const ROTARY: [&str; 3] = ["A", "B", "C"];
const VECTOR: [&str; 3] = ["TX", "TY", "TZ"];

/// The largest angle of `CP`, and the angle of one turn, degrees.
const MAX_HELIX_DEG: f64 = 5400.0;
const TURN_DEG: f64 = 360.0;

/// Largest difference of the length of a vector from 1. Seven decimals make a tenth of it.
const LENGTH_AGREEMENT: f64 = 1e-6;

impl Reader<'_> {
    /// `L`: a straight motion, or the move to zero of the machine's coordinates.
    pub(super) fn straight(&mut self, tail: &str) -> Result<Option<Step>, Fault> {
        let words = Words::of(tail, words::STRAIGHT, &self.limits())?;
        if words.functions.has_machine_zero {
            return self.machine_zero(&words);
        }
        if words.functions.has_call {
            return self.hole(&words).map(Some);
        }
        self.functions(&words.functions)?;
        let turned = words.three(ROTARY);
        if words.three(LINEAR).iter().chain(&turned).all(Option::is_none) {
            return Err(Fault::Word("X", WordFault::Missing));
        }
        if self.mode == TipMode::Vectors {
            return self.across(&words).map(Some);
        }
        let from = self.moved(words.three(LINEAR));
        let before = self.angles;
        self.angles = [0, 1, 2].map(|k| turned[k].or(before[k]));
        if self.mode != TipMode::Off || self.angles.iter().any(Option::is_some) {
            let is_known = (0..3).all(|k| before[k].is_some() || self.angles[k].is_none());
            let is_known = is_known && (self.mode == TipMode::Off || before.iter().any(Option::is_some));
            let turns = self.angles != before;
            return self.posed(from, turns, is_known, words.speed).map(Some);
        }
        if words.speed == Some(Speed::Rapid) {
            return Ok(Some(Step::Rapid { from, to: self.at }));
        }
        let rate = self.rate(words.speed)?;
        if self.has_lost_axis {
            return Err(Fault::UnknownStart);
        }
        Ok(Some(Cut::between(from, self.at, rate)?.line()))
    }

    /// `L X+0 Y+16 R0 FMAX` before the first vector: the tip goes across, at whatever height it is.
    fn across(&mut self, words: &Words) -> Result<Step, Fault> {
        let is_known = self.at.iter().any(Option::is_some) || self.vector.is_some();
        let has_others = words.get("Z").is_some() || words.three(ROTARY).iter().any(Option::is_some);
        if is_known || has_others || words.speed != Some(Speed::Rapid) {
            return Err(Fault::UnderTipControl);
        }
        let from = self.moved(words.three(LINEAR));
        let (to, angles, mode) = (self.at, [None; 3], self.mode);
        Ok(Step::Posed(Posed { from, to, angles, vector: None, mode, feed: PosedFeed::Rapid }))
    }

    /// `L Z+0 R0 FMAX M91`, a rapid in the machine's coordinates.
    fn machine_zero(&mut self, words: &Words) -> Result<Option<Step>, Fault> {
        if self.mode != TipMode::Off {
            return Err(Fault::UnderTipControl);
        }
        let is_z_alone = ["X", "Y", "A", "B", "C"].iter().all(|name| words.get(name).is_none());
        if !is_z_alone || words.get("Z") != Some(0.0) || words.speed != Some(Speed::Rapid) {
            return Err(Fault::Conflict);
        }
        self.at[2] = None;
        self.state.homes += 1;
        Ok(None)
    }

    /// `LN`: a straight motion with the vector of the tool axis at its end.
    pub(super) fn vector(&mut self, tail: &str) -> Result<Step, Fault> {
        let words = Words::of(tail, words::VECTOR, &self.limits())?;
        self.functions(&words.functions)?;
        if self.mode != TipMode::Vectors {
            return Err(Fault::NoTipControl);
        }
        for name in LINEAR.into_iter().chain(VECTOR) {
            words.get(name).ok_or(Fault::Word(name, WordFault::Missing))?;
        }
        let vector = words.three(VECTOR).map(Option::unwrap_or_default);
        let length = vector[0].hypot(vector[1]).hypot(vector[2]);
        if (length - 1.0).abs() > LENGTH_AGREEMENT {
            return Err(Fault::Word("TX", WordFault::Range));
        }
        let from = self.moved(words.three(LINEAR));
        let before = self.vector.replace(vector);
        (self.angles, self.has_lost_axis) = ([None; 3], true);
        self.posed(from, before != Some(vector), before.is_some(), words.speed)
    }

    /// A straight motion to the position and the axis of the modal state. `turns` tells whether the axis
    /// turns, and `is_known` whether its start is known.
    fn posed(
        &mut self,
        from: [Option<f64>; 3],
        turns: bool,
        is_known: bool,
        speed: Option<Speed>,
    ) -> Result<Step, Fault> {
        let feed = if speed == Some(Speed::Rapid) {
            PosedFeed::Rapid
        } else if self.mode == TipMode::Off && turns {
            return Err(Fault::Conflict);
        } else if from.iter().any(Option::is_none) || !is_known {
            return Err(Fault::UnknownStart);
        } else if turns && from == self.at {
            self.turning(speed)?
        } else {
            PosedFeed::Feed(self.rate(speed)?)
        };
        let (to, angles, vector, mode) = (self.at, self.angles, self.vector, self.mode);
        Ok(Step::Posed(Posed { from, to, angles, vector, mode, feed }))
    }

    /// `CC`: the centre of the arcs behind it.
    pub(super) fn circle_center(&mut self, tail: &str) -> Result<Option<Step>, Fault> {
        let words = Words::of(tail, words::CENTER, &self.limits())?;
        let plane = match words.three(LINEAR) {
            [Some(_), Some(_), None] => Plane::Xy,
            [Some(_), None, Some(_)] => Plane::Zx,
            [None, Some(_), Some(_)] => Plane::Yz,
            [Some(_), Some(_), Some(_)] => return Err(Fault::Conflict),
            [None, None, _] => return Err(Fault::Word("X", WordFault::Missing)),
            _ => return Err(Fault::Word("Z", WordFault::Missing)),
        };
        let center = words.three(LINEAR).map(|value| value.unwrap_or_default() * self.units.mm());
        self.center = Some((plane, Point3::from(center)));
        Ok(None)
    }

    /// `C`: an arc about the centre in the plane of the centre.
    pub(super) fn arc(&mut self, tail: &str) -> Result<Step, Fault> {
        let words = Words::of(tail, words::ARC, &self.limits())?;
        let (plane, center) = self.center.ok_or(Fault::MissingCenter)?;
        let to = words.three(LINEAR);
        let normal = plane.axes()[2];
        if to[normal].is_some() {
            return Err(Fault::Word(LINEAR[normal], WordFault::Unused));
        }
        if to.iter().all(Option::is_none) {
            return Err(Fault::Word(LINEAR[plane.axes()[0]], WordFault::Missing));
        }
        let (direction, rate) = self.turn(&words)?;
        let from = self.moved(to);
        Cut::between(from, self.at, rate)?.arc(plane, direction, center, &self.arcs)
    }

    /// `CP IPA IZ`: a helix about the centre in XY. Its end is the start turned by IPA and raised by IZ.
    pub(super) fn helix(&mut self, tail: &str) -> Result<Step, Fault> {
        let words = Words::of(tail, words::HELIX, &self.limits())?;
        let (plane, center) = self.center.ok_or(Fault::MissingCenter)?;
        if plane != Plane::Xy {
            return Err(Fault::Conflict);
        }
        let angle = words.get("IPA").ok_or(Fault::Word("IPA", WordFault::Missing))?;
        let (direction, rate) = self.turn(&words)?;
        if angle == 0.0 || angle.abs() > MAX_HELIX_DEG {
            return Err(Fault::Word("IPA", WordFault::Range));
        }
        if (angle > 0.0) != (direction == Direction::Ccw) {
            return Err(Fault::Conflict);
        }
        if angle.abs() > TURN_DEG {
            return Err(Fault::ManyTurns);
        }
        let start = Cut::between(self.at, self.at, rate)?.start();
        let spoke: Vector2<f64> = (start - center).xy();
        let mut end = start;
        // A full turn has to end exactly where it begins.
        if angle.abs() < TURN_DEG {
            let (sin, cos) = angle.to_radians().sin_cos();
            end.x = center.x + cos * spoke.x - sin * spoke.y;
            end.y = center.y + sin * spoke.x + cos * spoke.y;
        }
        end.z += words.get("IZ").unwrap_or_default() * self.units.mm();
        let from = std::mem::replace(&mut self.at, [end.x, end.y, end.z].map(Some));
        Cut::between(from, self.at, rate)?.arc(plane, direction, center, &self.arcs)
    }

    /// The sense and the feed of an arc.
    fn turn(&mut self, words: &Words) -> Result<(Direction, FeedRate), Fault> {
        self.functions(&words.functions)?;
        if self.mode != TipMode::Off {
            return Err(Fault::UnderTipControl);
        }
        if self.has_lost_axis || self.angles.iter().any(Option::is_some) || words.speed == Some(Speed::Rapid)
        {
            return Err(Fault::Conflict);
        }
        let direction = words.direction.ok_or(Fault::Word("DR", WordFault::Missing))?;
        Ok((direction, self.rate(words.speed)?))
    }

    /// Goes to the coordinates of a block, and returns where the block starts.
    fn moved(&mut self, to: [Option<f64>; 3]) -> [Option<f64>; 3] {
        let from = self.at;
        self.at = [0, 1, 2].map(|axis| to[axis].map(|value| value * self.units.mm()).or(from[axis]));
        from
    }

    /// The feed of a motion along a way.
    fn rate(&mut self, speed: Option<Speed>) -> Result<FeedRate, Fault> {
        if let Some(Speed::Feed(feed)) = speed {
            let feed_mm = match self.units {
                Units::Mm => feed,
                Units::Inch => feed / 10.0 * self.units.mm(),
            };
            let rate = FeedRate::from_mm_per_min(feed_mm);
            self.feed = Some(Feed::Along(rate.ok_or(Fault::Word("F", WordFault::Range))?));
        }
        match self.feed {
            Some(Feed::Along(rate)) => Ok(rate),
            _ => Err(Fault::NoFeed),
        }
    }

    /// The feed of a turn about a resting tip, in degrees per minute also in a program in inches.
    fn turning(&mut self, speed: Option<Speed>) -> Result<PosedFeed, Fault> {
        if let Some(Speed::Feed(feed)) = speed {
            self.feed = Some(Feed::Turning(feed));
        }
        match self.feed {
            Some(Feed::Turning(rate)) => Ok(PosedFeed::DegreesPerMinute(rate)),
            _ => Err(Fault::NoFeed),
        }
    }
}
