//! Bounds the height to which a part of the surface lifts the tip, from a contact that is already known. The
//! lower side of the cutter lies on or above a paraboloid that touches it at the known contact.

use nalgebra::{Vector2, Vector3};

use super::lift_bound::{AxisMove, Threshold};
use super::tree::{Cover, SubPatch};
use crate::geometry::surface::patch::{Bounds, Patch};
use crate::machining::cutter::{Cutter, LowerPoint};

/// The tangent plane of a known contact, and the paraboloid about it that supports the cutter.
#[derive(Debug, Clone, Copy)]
pub(super) struct Support {
    /// Where the cutter touches in plan, mm.
    at: Vector2<f64>,
    height: f64,
    gradient: Vector2<f64>,
    round: f64,
}

impl Support {
    pub(super) fn of(cutter: &Cutter, lower: &LowerPoint, track: &AxisMove) -> Self {
        Self {
            at: track.center + lower.place,
            height: lower.height,
            gradient: lower.gradient,
            round: cutter.support_forms(lower, f64::NEG_INFINITY)[0].norm(),
        }
    }

    /// Upper bound of how far a part lifts the tip above `level`, mm.
    pub(super) fn excess<P: Patch>(&self, part: &SubPatch<P>, track: &AxisMove, level: &Threshold) -> f64 {
        let tilted = |p: Vector3<f64>| p.z - self.gradient.dot(&(p.xy() - self.at));
        let higher = |highest: f64, height: f64| if height > highest { height } else { highest };
        let highest = part.patch.control_points().map(tilted).fold(f64::NEG_INFINITY, higher);
        self.excess_of(highest, &part.bounds, track, level)
    }

    /// As [`Self::excess`], for anything under a cover.
    pub(super) fn excess_under(&self, cover: &Cover, track: &AxisMove, level: &Threshold) -> f64 {
        self.excess_of(cover.highest_over(&self.gradient, &self.at), &cover.bounds, track, level)
    }

    /// As [`Self::excess`], for anything in a box that lies at most `highest` mm above the plane with the
    /// contact's gradient that is zero at the contact.
    fn excess_of(&self, highest: f64, bounds: &Bounds, track: &AxisMove, level: &Threshold) -> f64 {
        let along = (self.gradient.dot(&track.way) - level.slope).abs() * track.reach;
        let squared = track.squared_distance(bounds, &self.at);
        highest - self.height + along - 0.5 * self.round * squared - level.level
    }
}
