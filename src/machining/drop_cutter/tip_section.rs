//! Tips along a line of positions: what a pass follows, with a proved distance from what lies between.
//!
//! # Method
//! The line is bisected (`trace`) into chords that the tips are proved to keep to ([`Contacts::stretch`]),
//! upright walls, and stretches without a section.
//!
//! A tip counts where the cutter touches the surface with its tangent plane, or an edge within the surface.
//! Where it only hangs on an edge at which the surface ends, the section ends.
//!
//! # Cost
//! O(points): some ten microseconds a point on a grid of 60 x 60 at a chord height of 6e-4 mm.

mod trace;

use nalgebra::Point3;

use super::Contacts;
use super::edge_contacts::{Sides, position};
use crate::budget::{Budget, Stopped};
use crate::geometry::surface::patch::Patch;
use crate::machining::offset_section::{Chain, PlaneAt, SectionError, Spacing};
use trace::{Trace, WALL_MM};

/// The cutter just grazes the surface from farther out, in parts of the radius.
const GRAZING: f64 = 1e-6;

/// Sections beside a plane are looked for so far from it, in parts of the cutter's radius.
const BESIDE: f64 = 4e-6;

/// Sections, and how far beside their plane they were found, mm.
type Found = (Vec<Vec<Point3<f64>>>, f64);

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
        let (found, beside) = self.found(plane, spacing, budget)?;
        let chord_height_mm = spacing.chord_height_mm + 2.0 * WALL_MM + beside;
        let chain = |points| Chain { points, chord_height_mm };
        Ok(found.into_iter().map(chain).collect())
    }

    /// The sections, and how far beside the plane they were found, mm. Over a plane in which the cutter only
    /// grazes a wall, rounding tells on which side of it the cutter is: the lower of the two sections beside
    /// it is taken.
    fn found(&self, plane: PlaneAt, spacing: Spacing, budget: &Budget) -> Result<Found, SectionError> {
        let mut trace = Trace::new(self, plane, spacing, budget);
        if trace.all()? {
            return Ok((trace.chains, 0.0));
        }
        let beside = BESIDE * self.contacts.cutter.radius();
        let mut lowest: Option<(f64, Vec<Vec<Point3<f64>>>)> = None;
        for by in [beside, -beside] {
            let mut trace =
                Trace::new(self, PlaneAt { traced_at: plane.traced_at + by, ..plane }, spacing, budget);
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
        let mut trace = Trace::new(self, plane, spacing, budget);
        trace.all_jumps()?;
        Ok((trace.chains, 0.0))
    }

    /// Whether there is any section over `plane`.
    ///
    /// # Errors
    /// As for [`Self::chains`].
    pub fn has_any(&self, plane: PlaneAt, spacing: Spacing, budget: &Budget) -> Result<bool, SectionError> {
        Trace::new(self, plane, spacing, budget).has_any()
    }

    /// Between which positions along a line the cutter is over the surface, mm.
    pub(super) fn range(&self) -> [f64; 2] {
        let along = 1 - self.axis;
        let radius = (1.0 - GRAZING) * self.contacts.cutter.radius();
        [self.contacts.bounds().min[along] - radius, self.contacts.bounds().max[along] + radius]
    }

    /// The least and the largest coordinate of positions along the axis that may count, mm: those whose
    /// cutter touches a side of the surface with its tangent plane, or any part of it at the middle.
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
