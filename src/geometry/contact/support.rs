//! What a contact that is known says of other parts.

use nalgebra::{Vector2, Vector3};

use super::bound::{Level, Track};
use super::tree::{Part, squared_distance_in_plan};
use crate::geometry::cutter::{Cutter, LowerPoint};
use crate::geometry::surface::patch::Patch;

/// What the contact known says of other parts: its tangent plane, and the paraboloid about it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Support {
    /// Where the cutter touches in plan, mm.
    at: Vector2<f64>,
    height: f64,
    gradient: Vector2<f64>,
    round: f64,
}

impl Support {
    pub(super) fn of(cutter: &Cutter, lower: &LowerPoint, track: &Track) -> Self {
        Self {
            at: track.center + lower.place,
            height: lower.height,
            gradient: lower.gradient,
            round: cutter.support_forms(lower, f64::NEG_INFINITY)[0].norm(),
        }
    }

    /// By how much a part lifts the tip above a level, at most, mm.
    pub(super) fn excess<P: Patch>(&self, part: &Part<P>, track: &Track, level: &Level) -> f64 {
        let tilted = |p: Vector3<f64>| p.z - self.gradient.dot(&(p.xy() - self.at));
        let highest = part.patch.control_points().map(tilted).fold(f64::NEG_INFINITY, f64::max);
        let along = (self.gradient.dot(&track.way) - level.slope).abs() * track.reach;
        let distance = (squared_distance_in_plan(&part.bounds, &self.at).sqrt() - track.reach).max(0.0);
        highest - self.height + along - 0.5 * self.round * distance * distance - level.level
    }
}
