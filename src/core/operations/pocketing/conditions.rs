//! The cutting conditions of one level, with what follows from them.

use super::job::{EntryLimits, Job, Milling};
use crate::machining::engagement::straight_angle;
use crate::toolpath::cutting::Cutting;
use crate::toolpath::path::Role;
use crate::toolpath::units::FeedRate;

/// The angle by which a pass may exceed that of the stepover before it counts as deeper in the material,
/// radians: the bounds of angles are about so much too large.
const ANGLE_ALLOWANCE: f64 = 0.02;

#[derive(Debug, Clone)]
pub struct Conditions {
    pub radius_mm: f64,
    pub stepover_mm: f64,
    /// The angle of a straight pass in the material, and the angle from which on the slot feed holds,
    /// radians.
    pub straight_angle: f64,
    pub slot_angle: f64,
    pub entry: EntryLimits,
    pub milling: Milling,
    pub cutting: Cutting,
    pub slot_feed: FeedRate,
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
        let slot_feed = cutting.slot_feed;
        // A helix or ramp is a slot; it comes down no faster than a plunge.
        let sine = job.entry.ramp_angle.sin();
        let fastest = FeedRate::from_mm_per_min(cutting.plunge_feed.mm_per_min() / sine);
        let gentle =
            fastest.map_or(slot_feed, |fastest| if fastest < slot_feed { fastest } else { slot_feed });
        Self {
            radius_mm,
            stepover_mm: job.stepover_mm,
            straight_angle: straight,
            slot_angle: straight + ANGLE_ALLOWANCE,
            entry: job.entry,
            milling: job.milling,
            cutting: *cutting,
            slot_feed,
            entry_feed: job.cutting.ramp_feed.unwrap_or(gentle),
            top_z_mm,
            z_mm,
            clearance_mm: cutting.retract_z_mm - highest_mm,
            most_comparisons: job.comparison_limit / n_shapes.max(1) as u64,
        }
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

    /// Seconds for a helix or a ramp into the material.
    pub fn entry_seconds(&self) -> f64 {
        self.depth_mm() / self.entry.ramp_angle.sin() / self.entry_feed.mm_per_s()
    }

    pub fn depth_mm(&self) -> f64 {
        self.top_z_mm - self.z_mm
    }
}
