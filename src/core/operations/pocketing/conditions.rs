//! The cutting conditions of one level, with what follows from them.

use nalgebra::Point2;

use super::job::{EntryLimits, Job, Lead, Load, Milling};
use crate::machining::engagement::straight_angle;
use crate::toolpath::cutting::Cutting;
use crate::toolpath::path::Role;
use crate::toolpath::units::FeedRate;

/// The angle by which a pass may exceed that of the stepover before it counts as deeper in the material,
/// radians: the bounds of angles are about so much too large.
const ANGLE_ALLOWANCE: f64 = 0.02;

/// An angle up to this multiple of that of a straight pass is cut at the full feed.
const FULL_FEED: f64 = 1.1;

/// The feed of slots where none is given, as a part of the feed.
const SLOT_FEED: f64 = 0.4;

/// In so many equal steps the feed goes down to that default, over equal ranges of the angle.
const STEPS: f64 = 4.0;

/// The angle of a pass beside cut material that the pattern `engagement` aims at, as a part of that of a
/// straight pass.
const TARGET: f64 = 1.07;

#[derive(Debug, Clone)]
pub struct Conditions {
    pub radius_mm: f64,
    pub stepover_mm: f64,
    /// The angle of a straight pass in the material, and the angle from which on the slot feed holds,
    /// radians.
    pub straight_angle: f64,
    pub slot_angle: f64,
    pub load: Load,
    pub entry: EntryLimits,
    pub lead: Lead,
    pub milling: Milling,
    pub cutting: Cutting,
    pub slot_feed: FeedRate,
    /// Whether the feed goes down to that of slots in steps.
    pub is_stepped: bool,
    pub entry_feed: FeedRate,
    /// Top of the material and the floor of the level, mm.
    pub top_z_mm: f64,
    pub z_mm: f64,
    /// How far the retract plane is above the part, mm.
    pub clearance_mm: f64,
    /// The most comparisons of the cutter with earlier cuts, of each pattern for one shape.
    pub most_comparisons: u64,
}

impl Conditions {
    /// The conditions on a level between the heights `top_z_mm` and `z_mm`. The highest point of the part is
    /// at `highest_mm`. The work is divided evenly among `n_shapes`.
    pub fn new(
        job: &Job,
        cutting: &Cutting,
        highest_mm: f64,
        [top_z_mm, z_mm]: [f64; 2],
        n_shapes: usize,
    ) -> Self {
        let radius_mm = job.tool.radius_mm;
        let straight = straight_angle(radius_mm, job.stepover_mm);
        let load = job.load();
        let by_default = FeedRate::from_mm_per_min(SLOT_FEED * cutting.feed.mm_per_min());
        let stepped = by_default.filter(|_| load == Load::Bounded && job.cutting.slot_feed.is_none());
        let slot_feed = stepped.unwrap_or(cutting.slot_feed);
        let slot_angle = match load {
            Load::Bounded => (FULL_FEED * straight).max(straight + ANGLE_ALLOWANCE),
            Load::Paper => straight + ANGLE_ALLOWANCE,
        };
        // A helix or ramp is a slot; it comes down no faster than a plunge.
        let sine = job.entry.ramp_angle.sin();
        let fastest = FeedRate::from_mm_per_min(cutting.plunge_feed.mm_per_min() / sine);
        let gentle =
            fastest.map_or(slot_feed, |fastest| if fastest < slot_feed { fastest } else { slot_feed });
        Self {
            radius_mm,
            stepover_mm: job.stepover_mm,
            straight_angle: straight,
            slot_angle,
            load,
            entry: job.entry,
            lead: job.lead,
            milling: job.milling,
            cutting: *cutting,
            slot_feed,
            is_stepped: stepped.is_some(),
            entry_feed: job.cutting.ramp_feed.unwrap_or(gentle),
            top_z_mm,
            z_mm,
            clearance_mm: cutting.retract_z_mm - highest_mm,
            most_comparisons: job.comparison_limit / n_shapes.max(1) as u64,
        }
    }

    /// The conditions with x negated: conventional milling of a region is climb milling of its mirror image.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let milling = match self.milling {
            Milling::Climb => Milling::Conventional,
            Milling::Conventional => Milling::Climb,
        };
        let at = self.entry.at.map(|at| Point2::new(-at.x, at.y));
        Self { milling, entry: EntryLimits { at, ..self.entry }, ..self.clone() }
    }

    /// Seconds to lift the tool, go `distance_mm` and come down where the level is cleared.
    pub fn lift_seconds(&self, distance_mm: f64) -> f64 {
        let up = self.cutting.retract_z_mm - self.z_mm;
        let slow = self.approach_z_mm(true) - self.z_mm;
        (up + distance_mm + up - slow) / self.cutting.rapid_feed.mm_per_s()
            + slow / self.cutting.feed_of(Role::LeadIn).mm_per_s()
    }

    /// The height down to which the tool comes at rapid feed: as far above the floor where that is cleared,
    /// and above the floor of the level before elsewhere, as the retract plane is above the part, mm.
    pub fn approach_z_mm(&self, is_cleared: bool) -> f64 {
        let below = if is_cleared { self.z_mm } else { self.top_z_mm };
        (below + self.clearance_mm).min(self.cutting.retract_z_mm)
    }

    /// Seconds for a link.
    pub fn link_seconds(&self, distance_mm: f64) -> f64 {
        distance_mm / self.cutting.feed_of(Role::Link).mm_per_s()
    }

    /// Whether slots are cut at a feed of their own.
    pub fn has_slot_feed(&self) -> bool {
        self.slot_feed != self.cutting.feed
    }

    /// How many steps the feed goes down at an angle of the cutter in the material, radians.
    pub fn steps_down(&self, angle: f64) -> u8 {
        if angle <= self.slot_angle || !self.has_slot_feed() {
            0
        } else if self.is_stepped {
            let part = (angle - self.slot_angle) / (std::f64::consts::PI - self.slot_angle);
            (STEPS * part).ceil().clamp(1.0, STEPS) as u8
        } else {
            1
        }
    }

    /// The feed after so many steps down from `feed`.
    pub fn stepped_down(&self, feed: FeedRate, steps: u8) -> FeedRate {
        if steps == 0 {
            return feed;
        }
        let most = if self.is_stepped { STEPS } else { 1.0 };
        let [full, slot] = [self.cutting.feed, self.slot_feed].map(FeedRate::mm_per_min);
        let slowed = FeedRate::from_mm_per_min(full - (full - slot) * f64::from(steps) / most);
        slowed.filter(|slowed| *slowed < feed).unwrap_or(feed)
    }

    /// The angle that a pass beside cut material may have, radians: a little more than on a straight pass,
    /// where the full feed holds for that.
    pub fn target_angle(&self) -> f64 {
        if self.load == Load::Paper && self.has_slot_feed() {
            self.straight_angle
        } else {
            TARGET * self.straight_angle
        }
    }

    /// Seconds for a helix or a ramp into the material.
    pub fn entry_seconds(&self) -> f64 {
        self.depth_mm() / self.entry.ramp_angle.sin() / self.entry_feed.mm_per_s()
    }

    pub fn depth_mm(&self) -> f64 {
        self.top_z_mm - self.z_mm
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use crate::operations::pocketing::job::Outlines;
    use crate::toolpath::tool::{Shape, Tool};

    /// The conditions of a level of 5 mm for a cutter of this radius.
    pub fn conditions(radius_mm: f64, stepover_mm: f64) -> Conditions {
        let tool = Tool { shape: Shape::Flat, ..Tool::ball(radius_mm) };
        let feed = FeedRate::from_mm_per_min(800.0).unwrap();
        let area = Outlines { boundary: Vec::new(), islands: Vec::new() };
        let job = Job::new(area, -5.0, tool, stepover_mm, feed);
        Conditions::new(&job, &job.cutting.above(0.0).unwrap(), 0.0, [0.0, -5.0], 1)
    }
}
