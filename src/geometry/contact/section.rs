//! Tips along a line of positions: what a pass follows, with a proved distance from what lies between.
//!
//! # Method
//! The line is walked over the surface. Each position is taken from the one before by Newton's method alone; that nothing else lifts the
//! cutter there is proved with the stretch between ([`Contacts::is_within`]), and where that fails the contact is looked for
//! anew and the step shortened. Where tips jump, at upright walls and where sheets end, the step shrinks to
//! a millionth of a millimetre, and the chord is the wall, if nothing stands higher. Where that is not known either, the section
//! breaks off and goes on behind the step.
//!
//! A tip counts where the cutter touches the surface with its tangent plane, or an edge within the surface. Where it only hangs on
//! an edge at which the surface ends, the section ends.
//!
//! # Cost
//! O(points): some ten microseconds a point on a grid of 60 x 60 at a chord height of 6e-4 mm.

use super::Contacts;
use super::pace::SHORTEST_STEP_MM;
use super::sides::{Sides, position};
use super::walk::Walk;
use crate::budget::{Budget, Stopped};
use crate::geometry::section::{Chain, PlaneAt, SectionError, Spacing};
use crate::geometry::surface::patch::Patch;

/// The cutter just grazes the surface from farther out, in parts of the radius.
const GRAZING: f64 = 1e-6;

/// The tips over lines at right angles to an axis.
pub struct TipSections<'a, P> {
    pub(super) contacts: &'a Contacts<'a, P>,
    /// 0 is x, 1 is y.
    pub(super) axis: usize,
    pub(super) sides: Sides,
}

impl<'a, P: Patch> TipSections<'a, P> {
    /// Over lines at right angles to `axis` (0 is x, 1 is y).
    ///
    /// # Errors
    /// Only the budget's stop.
    pub fn new(contacts: &'a Contacts<'a, P>, axis: usize, budget: &Budget) -> Result<Self, Stopped> {
        Ok(Self { contacts, axis, sides: Sides::new(contacts, axis, budget)? })
    }

    /// The sections over `plane`, in the sense of the growing coordinate.
    ///
    /// # Errors
    /// When a section has too many points, or the budget stops.
    pub fn chains(
        &self,
        plane: PlaneAt,
        spacing: Spacing,
        budget: &Budget,
    ) -> Result<Vec<Chain>, SectionError> {
        let mut walk = Walk::new(self, plane, spacing, budget);
        walk.all()?;
        let chain =
            |points| Chain { points, chord_height_mm: spacing.chord_height_mm + 2.0 * SHORTEST_STEP_MM };
        Ok(walk.chains.into_iter().filter(|points| points.len() >= 2).map(chain).collect())
    }

    /// The steps of one section, at least: none is longer than a radius, or than a tenth of the surface.
    pub fn least_steps(&self) -> f64 {
        let [low, high] = self.range();
        (high - low) / self.contacts.scale
    }

    /// Between which positions along a line the cutter is over the surface, mm.
    pub(super) fn range(&self) -> [f64; 2] {
        let along = 1 - self.axis;
        let radius = (1.0 - GRAZING) * self.contacts.cutter.radius();
        [self.contacts.bounds().min[along] - radius, self.contacts.bounds().max[along] + radius]
    }

    /// The least and the largest coordinate of positions along the axis that may count, mm: those whose cutter touches a side of the
    /// surface with its tangent plane, or any part of it at the middle.
    pub fn extent(&self) -> [f64; 2] {
        let contacts = self.contacts;
        let middles =
            contacts.tree.parts.iter().filter_map(|part| position(contacts, part.on_surface([0.5, 0.5])));
        let mut extent = [f64::INFINITY, f64::NEG_INFINITY];
        for at in self.sides.positions().copied().chain(middles) {
            extent = [extent[0].min(at[self.axis]), extent[1].max(at[self.axis])];
        }
        extent
    }
}
