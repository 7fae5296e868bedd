//! The motions of a program: from the words of a block to poses.

use nalgebra::{Point3, Unit, UnitVector3, Vector3};

use super::super::way::{ArcWay, parts};
use super::super::{FEEDS_MM_PER_MIN, Fault, PathFault, coordinate, direction, feed};
use super::Reader;
use super::block::Line;
use crate::nc::{Distance, FeedMode, Motion};
use toolpathd_core::geometry::curve::Direction;
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::machine::AxisPositions;
use toolpathd_core::toolpath::pose::{Pace, Pose, SAME_TIP_MM, Waypoint};
use toolpathd_core::toolpath::tool_axes::between;
use toolpathd_core::toolpath::units::FeedRate;

/// How far the ends of an arc may be apart beyond twice its radius, mm: twice the rounding of programs with
/// two decimals.
const RADIUS_MISMATCH_MM: f64 = 0.02;

/// The most by which an angle changes between two poses of an arc, or of a line with angles, radians.
/// With larger values a full turn has the length of none.
const MAX_TURN: f64 = 0.5;

/// Where all axes stand.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stand {
    pub at: Point3<f64>,
    pub angles: [f64; 2],
    pub vector: Option<UnitVector3<f64>>,
}

impl Reader<'_> {
    /// A block with coordinates, angles or a tool axis.
    pub(super) fn go(&mut self, line: &Line) -> Result<(), Fault> {
        let is_arc = matches!(self.modal.motion, Some(Motion::Arc(_))) && !line.is_rapid;
        let has_ijk = line.ijk.iter().any(Option::is_some);
        let has_center = is_arc && (line.radius.is_some() || has_ijk && !self.axis_is_ijk);
        if !is_arc && line.radius.is_some() {
            return Err(PathFault::Unused("R".to_owned()).into());
        }
        if has_ijk && !self.axis_is_ijk && !is_arc {
            return Err(PathFault::Unused("I, J or K".to_owned()).into());
        }
        let vector = if self.axis_is_ijk { line.ijk } else { line.vector };
        let has_vector = vector.iter().any(Option::is_some);
        let moves = line.at.iter().chain(&line.angles).any(Option::is_some) || has_vector || has_center;
        if !moves {
            return Ok(());
        }
        let motion = if line.is_rapid { Some(Motion::Rapid) } else { self.modal.motion };
        let motion = motion.ok_or(PathFault::NoMotion)?;
        let start = self.stand();
        let was_stated = self.is_stated;
        self.take(line)?;
        if has_vector {
            self.vector = Some(direction(Vector3::from(vector.map(Option::unwrap_or_default)))?);
        }
        let is_part = self.keeps_tip() || !self.survey.keeps_tip;
        if !is_part {
            if motion != Motion::Rapid {
                return Err(PathFault::OutsideTip.into());
            }
            if !self.trail.is_empty() {
                self.trail.left_alone("G0 without tip control");
            }
            self.trail.bar(PathFault::Leaves { word: "G0".to_owned() });
            return Ok(());
        }
        match (motion, self.stand()) {
            (Motion::Rapid, Some(to)) => {
                let rotary = self.rotary(&to, self.is_stated);
                self.trail.push(Waypoint { rotary, ..Waypoint::new(self.pose(&to), Pace::Rapid) })
            }
            // The path begins where all coordinates are known.
            (Motion::Rapid, None) => Ok(()),
            (_, None) => Err(PathFault::NoStart.into()),
            (Motion::Line, Some(to)) if start.is_none() && self.trail.is_empty() => {
                if self.modal.feed_mode == Some(FeedMode::InverseTime) {
                    return Err(PathFault::NoStart.into());
                }
                let (pose, pace) = (self.pose(&to), Pace::Feed(self.feed_over(0.0, line.has_feed, 1)?));
                let rotary = self.rotary(&to, self.is_stated);
                self.trail.push(Waypoint { rotary, ..Waypoint::new(pose, pace) })
            }
            (motion, Some(to)) => {
                let start = start.ok_or(PathFault::NoStart)?;
                if self.trail.is_empty() {
                    let rotary = self.rotary(&start, was_stated);
                    self.trail.push(Waypoint { rotary, ..Waypoint::new(self.pose(&start), Pace::Rapid) })?;
                }
                match motion {
                    Motion::Arc(turn) => self.arc(line, turn, &start, &to),
                    _ => self.straight(line, &start, &to),
                }
            }
        }
    }

    /// Where the axes stand; `None` where that is not known of all.
    pub(super) fn stand(&self) -> Option<Stand> {
        let ([Some(x), Some(y), Some(z)], [Some(first), Some(second)]) = (self.modal.at, self.angles) else {
            return None;
        };
        Some(Stand { at: Point3::new(x, y, z), angles: [first, second], vector: self.vector })
    }

    /// Takes the coordinates and the angles of a block.
    fn take(&mut self, line: &Line) -> Result<(), PathFault> {
        let is_relative = self.modal.distance == Some(Distance::Incremental);
        let unit_mm = self.unit_mm();
        for (k, own) in line.at.iter().enumerate() {
            let Some(own) = own.map(|own| own * unit_mm) else { continue };
            let from = if is_relative { self.modal.at[k].ok_or(PathFault::NoStart)? } else { self.shift[k] };
            self.modal.at[k] = Some(coordinate(from + own)?);
        }
        if self.has_spatial_angles && line.angles.iter().any(Option::is_some) {
            let advice = "write AXIS POS with positions of the rotary axes, or LN with TX, TY and TZ";
            return Err(PathFault::Refused { word: "an angle under AXIS SPAT".to_owned(), advice });
        }
        for (letter, angle) in ['A', 'B', 'C'].into_iter().zip(line.angles) {
            let Some(angle) = angle.map(f64::to_radians) else { continue };
            let machine = self.machine.ok_or(PathFault::NoMachine)?;
            let k = machine.rotary().iter().position(|axis| axis.name == letter);
            let k = k.ok_or(PathFault::NoSuchAxis(letter))?;
            let from = if is_relative { self.angles[k].ok_or(PathFault::NoStart)? } else { 0.0 };
            self.angles[k] = Some(from + angle);
            self.is_stated[k] = true;
            self.vector = None;
        }
        Ok(())
    }

    pub(super) fn pose(&self, stand: &Stand) -> Pose {
        let Stand { at, angles, vector } = *stand;
        if let Some(axis) = vector {
            return Pose { tip: at, axis };
        }
        let Some(machine) = self.machine else {
            return Pose { tip: at, axis: Vector3::z_axis() };
        };
        let pose = machine.forward(&AxisPositions { linear_mm: at.coords.into(), rotary: angles });
        if self.keeps_tip() { Pose { tip: at, ..pose } } else { pose }
    }

    /// The positions of the rotary axes, where the program states both.
    fn rotary(&self, stand: &Stand, is_stated: [bool; 2]) -> Option<[f64; 2]> {
        (stand.vector.is_none() && is_stated == [true; 2]).then_some(stand.angles)
    }

    /// A line of the tip with tip control, or of all axes without. The angles turn in step with it, unless
    /// the axis turns on the great circle.
    fn straight(&mut self, line: &Line, from: &Stand, to: &Stand) -> Result<(), Fault> {
        let turned = [0, 1].map(|k| to.angles[k] - from.angles[k]);
        let has_vectors = from.vector.is_some() || to.vector.is_some();
        let is_circle = self.keeps_tip() && (has_vectors || self.turns_on_circle);
        if is_circle || turned == [0.0; 2] {
            return self.divided(line.has_feed, from, 1, |_| *to);
        }
        let stand = |part: f64| Stand {
            at: from.at + (to.at - from.at) * part,
            angles: [0, 1].map(|k| from.angles[k] + turned[k] * part),
            vector: to.vector,
        };
        let count = parts(|part| self.pose(&stand(part)), self.reading.chords, fewest_turns(turned))?;
        self.divided(line.has_feed, from, count, |part| if part == 1.0 { *to } else { stand(part) })
    }

    /// A block as `count` poses. Under G93 the poses share the time of the block evenly.
    pub(super) fn divided(
        &mut self,
        has_feed: bool,
        from: &Stand,
        count: usize,
        way: impl Fn(f64) -> Stand,
    ) -> Result<(), Fault> {
        let mut before = self.pose(from);
        for k in 1..=count {
            let there = way(k as f64 / count as f64);
            let pose = self.pose(&there);
            let way_mm = before.way_mm(&pose, self.top_mm);
            let pace = Pace::Feed(self.feed_over(way_mm, has_feed, count)?);
            let rotary = self.rotary(&there, self.is_stated);
            self.trail.push(Waypoint { pose, pace, rotary, seconds: self.seconds(count) })?;
            before = pose;
        }
        Ok(())
    }

    /// The time of one of `count` even parts of a block under G93, s.
    fn seconds(&self, count: usize) -> Option<f64> {
        let per_minute = self.modal.feed.filter(|_| self.modal.feed_mode == Some(FeedMode::InverseTime))?;
        Some(60.0 / (per_minute * count as f64))
    }

    fn arc(&mut self, line: &Line, turn: Direction, from: &Stand, to: &Stand) -> Result<(), Fault> {
        let plane = self.modal.plane.unwrap_or(Plane::Xy);
        let normal = plane.axes()[2];
        let mut up = Vector3::zeros();
        up[normal] = if turn == Direction::Ccw { 1.0 } else { -1.0 };
        let up = Unit::new_unchecked(up);
        let ijk = if self.axis_is_ijk { [None; 3] } else { line.ijk };
        let center = match line.radius {
            Some(_) if ijk.iter().any(Option::is_some) => return Err(PathFault::Conflict.into()),
            Some(radius) => center_of(&from.at, &to.at, radius * self.unit_mm(), &up)?,
            None => self.center(ijk, &from.at, normal)?,
        };
        let arc = ArcWay::new(&from.at, &to.at, &center, &up)?;
        let turned = [0, 1].map(|k| to.angles[k] - from.angles[k]);
        let stand = |part: f64| Stand {
            at: arc.at(part),
            angles: [0, 1].map(|k| from.angles[k] + turned[k] * part),
            vector: match (from.vector, to.vector) {
                (Some(from), Some(to)) => Some(between(&from, &to, part)),
                (_, to) => to,
            },
        };
        let least = fewest_turns(turned).max(arc.fewest_parts());
        let count = parts(|part| self.pose(&stand(part)), self.reading.chords, least)?;
        self.divided(line.has_feed, from, count, |part| if part == 1.0 { *to } else { stand(part) })
    }

    /// The centre that I, J and K name.
    fn center(
        &self,
        ijk: [Option<f64>; 3],
        from: &Point3<f64>,
        normal: usize,
    ) -> Result<Point3<f64>, PathFault> {
        let unit_mm = self.unit_mm();
        let is_absolute = self.modal.centers == Some(Distance::Absolute);
        if ijk.iter().all(Option::is_none) {
            return Err(PathFault::NoCenter);
        }
        let mut center = *from;
        for (k, own) in ijk.iter().enumerate() {
            match own.map(|own| own * unit_mm) {
                Some(own) if is_absolute => center[k] = own + self.shift[k],
                Some(own) => center[k] += own,
                None if is_absolute && k != normal => return Err(PathFault::NoCenter),
                None => {}
            }
        }
        Ok(center)
    }

    /// The feed of a way of this length, mm, which is one of `count` parts of its block.
    fn feed_over(&self, way_mm: f64, has_feed: bool, count: usize) -> Result<FeedRate, PathFault> {
        match (self.modal.feed_mode, self.modal.feed) {
            (Some(FeedMode::InverseTime), own) => {
                let per_minute = own.filter(|_| has_feed).ok_or(PathFault::NoBlockTime)?;
                if per_minute <= 0.0 {
                    return Err(PathFault::BadFeed(per_minute));
                }
                let per_minute = per_minute * count as f64;
                let most = *FEEDS_MM_PER_MIN.end();
                // A block that moves nothing has no feed of its own. The slowest feed is not limited: a tip
                // that creeps while the axis turns keeps the time of its block.
                match way_mm * per_minute {
                    0.0 => feed(1.0),
                    own if own <= most => FeedRate::from_mm_per_min(own).ok_or(PathFault::BadFeed(own)),
                    _ => Err(PathFault::TooFast { seconds: 60.0 / per_minute, way_mm, most }),
                }
            }
            (Some(FeedMode::PerTurn), Some(own)) => {
                feed(own * self.unit_mm() * self.spindle_rpm.ok_or(PathFault::NoSpindle)?)
            }
            (_, Some(own)) => feed(own * self.unit_mm()),
            (_, None) => self.reading.feed.ok_or(PathFault::NoFeed),
        }
    }
}

/// Parts of a block in each of which no angle changes by more than [`MAX_TURN`].
fn fewest_turns(turned: [f64; 2]) -> usize {
    (turned[0].abs().max(turned[1].abs()) / MAX_TURN).ceil() as usize
}

/// The centre of an arc with a radius. A negative radius turns by more than half a turn.
fn center_of(
    from: &Point3<f64>,
    to: &Point3<f64>,
    radius: f64,
    up: &UnitVector3<f64>,
) -> Result<Point3<f64>, PathFault> {
    let way = to - from;
    let chord = way - up.scale(way.dot(up));
    let half = 0.5 * chord.norm();
    if half <= SAME_TIP_MM {
        return Err(PathFault::NoCenter);
    }
    if half > radius.abs() + 0.5 * RADIUS_MISMATCH_MM {
        return Err(PathFault::ArcEnd);
    }
    let height = (radius * radius - half * half).max(0.0).sqrt().copysign(radius);
    let left = up.cross(&chord.normalize());
    Ok(from + chord * 0.5 + left * height)
}
