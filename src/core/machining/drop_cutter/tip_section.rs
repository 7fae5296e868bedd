//! Finds the points that a pass follows: tips along a line of positions of the axis. The distance of all tips
//! over the line from the chords between these points is proved.
//!
//! A *section* is a connected curve of tips. It runs where the cutter is tangent to the surface, or touches a
//! sharp edge inside the surface. It ends where the cutter touches only an edge at which the surface ends.
//! [`TipSections::chains_over_edges`] lets it run on over edges.
//!
//! # Method
//! By bisection, divide the line into three kinds of stretches: stretches whose tips are proved to be near a
//! chord, upright walls, and stretches without a section (`trace`).
//!
//! # Cost
//! O(n) for n points: some ten microseconds each on a grid of 60 x 60, at a chord height of 6e-4 mm.

mod counting;
mod trace;

use nalgebra::Point3;

use super::Contacts;
use super::edge_contacts::{Sides, position};
use crate::budget::{Budget, Stopped};
use crate::geometry::surface::patch::Patch;
use crate::machining::offset_section::{Chain, PlaneAt, SectionError, Spacing};
use counting::Counting;
use trace::{Trace, WALL_MM};

/// Share of the radius by which the searched range is shortened at both ends. Beyond it the cutter only just
/// grazes the surface.
const GRAZING: f64 = 1e-6;

/// Distance from a plane at which sections beside it are traced, as a share of the cutter's radius.
const BESIDE: f64 = 4e-6;

/// Sections, and how far beside their plane they were traced, mm.
type Found = (Vec<Vec<Point3<f64>>>, f64);

/// Sections of tips over lines at right angles to the x or y axis.
pub struct TipSections<'a, P> {
    pub(super) contacts: &'a Contacts<'a, P>,
    /// 0 is x, 1 is y.
    pub(super) axis: usize,
    pub(super) sides: Sides,
}

impl<'a, P: Patch> TipSections<'a, P> {
    /// Prepares sections over lines at right angles to `axis` (0 is x, 1 is y).
    ///
    /// # Errors
    /// Only the budget's stop.
    pub fn new(contacts: &'a Contacts<'a, P>, axis: usize, budget: &Budget) -> Result<Self, Stopped> {
        Ok(Self { contacts, axis, sides: Sides::new(contacts, axis, budget)? })
    }

    /// The sections over `plane`, each in the direction of the growing coordinate.
    ///
    /// # Errors
    /// When a section has too many points, or the budget stops.
    pub fn chains(
        &self,
        plane: PlaneAt,
        spacing: Spacing,
        budget: &Budget,
    ) -> Result<Vec<Chain>, SectionError> {
        self.chains_where(Counting::Touching, plane, spacing, budget)
    }

    /// As [`Self::chains`], for a cutter that may touch edges of the surface alone: it rolls over them where
    /// the contact is not steep, and while the axis is between the ends of the surface's box along the line.
    ///
    /// # Errors
    /// As for [`Self::chains`].
    pub fn chains_over_edges(
        &self,
        plane: PlaneAt,
        spacing: Spacing,
        budget: &Budget,
    ) -> Result<Vec<Chain>, SectionError> {
        self.chains_where(Counting::Rolling, plane, spacing, budget)
    }

    fn chains_where(
        &self,
        counting: Counting,
        plane: PlaneAt,
        spacing: Spacing,
        budget: &Budget,
    ) -> Result<Vec<Chain>, SectionError> {
        let (found, beside) = self.found(counting, plane, spacing, budget)?;
        let chord_height_mm = spacing.chord_height_mm + 2.0 * WALL_MM + beside;
        let chain = |points| Chain { points, chord_height_mm };
        Ok(found.into_iter().map(chain).collect())
    }

    /// The sections, and how far beside the plane they were traced, mm. Over some planes the cutter only
    /// grazes a wall, and rounding decides on which side of the wall it is. There the sections are traced a
    /// little beside the plane on both sides, and the lower ones are taken.
    fn found(
        &self,
        counting: Counting,
        plane: PlaneAt,
        spacing: Spacing,
        budget: &Budget,
    ) -> Result<Found, SectionError> {
        let mut trace = Trace::new(self, counting, plane, spacing, budget);
        if trace.all()? {
            return Ok((trace.chains, 0.0));
        }
        let beside = BESIDE * self.contacts.cutter.radius();
        let mut lowest: Option<(f64, Vec<Vec<Point3<f64>>>)> = None;
        for by in [beside, -beside] {
            let mut trace = Trace::new(
                self,
                counting,
                PlaneAt { traced_at: plane.traced_at + by, ..plane },
                spacing,
                budget,
            );
            let is_all = trace.all()?;
            let height = trace.chains.iter().flatten().map(|point| point.z).fold(f64::INFINITY, f64::min);
            if is_all && !trace.chains.is_empty() && lowest.as_ref().is_none_or(|(least, _)| height < *least)
            {
                lowest = Some((height, trace.chains));
            }
        }
        if let Some((_, chains)) = lowest {
            return Ok((chains, beside));
        }
        let mut trace = Trace::new(self, counting, plane, spacing, budget);
        trace.all_jumps()?;
        Ok((trace.chains, 0.0))
    }

    /// Whether there is any section over `plane`.
    ///
    /// # Errors
    /// As for [`Self::chains`].
    pub fn has_any(&self, plane: PlaneAt, spacing: Spacing, budget: &Budget) -> Result<bool, SectionError> {
        Trace::new(self, Counting::Touching, plane, spacing, budget).has_any()
    }

    /// The range of positions along a line at which the cutter may touch the surface, mm.
    pub(super) fn range(&self) -> [f64; 2] {
        let along = 1 - self.axis;
        let radius = (1.0 - GRAZING) * self.contacts.cutter.radius();
        [self.contacts.bounds().min[along] - radius, self.contacts.bounds().max[along] + radius]
    }

    /// The least and the largest coordinate along the axis of positions that may count, mm. Examined are
    /// positions at which the cutter touches the tangent plane on a side of the surface, or in the middle of
    /// a part.
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
