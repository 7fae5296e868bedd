//! Finds the points that a pass over a mesh follows: tips along a line of positions of the axis. The distance
//! of all tips over the line from the chords between these points is proved.
//!
//! A *section* is a connected curve of tips. It runs where the cutter touches the mesh, and ends where it
//! touches only the *outline*: a place of the mesh beside which, seen from above, there is no mesh.
//! [`MeshSections::chains_over_edges`] lets it run on over the outline.
//!
//! # Method
//! By bisection, divide the line into three kinds of stretches: stretches whose tips are proved to be near a
//! chord, upright walls, and stretches without a section (`trace`).
//!
//! # Cost
//! O(k log n) for n triangles and k points.

mod trace;

use nalgebra::{Point3, Vector2, Vector3};

use super::{MeshContact, MeshContacts};
use crate::budget::Budget;
use crate::geometry::surface::triangle_mesh::{UPRIGHT, is_sliver};
use crate::machining::offset_section::{Chain, PlaneAt, SectionError, Spacing};
use trace::{Trace, WALL_MM};

/// Share of the radius by which the searched range is shortened at both ends. Beyond it the cutter only just
/// grazes the mesh.
const GRAZING: f64 = 1e-6;

/// Distance from a plane at which sections beside it are traced, as a share of the cutter's radius.
const BESIDE: f64 = 4e-6;

/// How far beside a place of the mesh it is looked for more mesh, mm, and in how many directions. A gap
/// narrower than this distance is no outline.
const BESIDE_OUTLINE_MM: f64 = 1e-3;
const DIRECTIONS: usize = 8;

/// Slope below which a contact counts as level, and sine of the largest angle between the normals of cutter
/// and triangle at which the cutter touches the triangle's plane.
const LEVEL: f64 = 1e-6;
const TANGENT: f64 = 1e-7;

/// Slope up to which a cutter that touches the outline alone follows it. On a steeper contact a ball would
/// dip far below the edge.
const ROLLING_SLOPE: f64 = 1.0;

/// Which contacts count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Counting {
    /// Those through which a section runs.
    Touching,
    /// Those too at which the cutter touches the outline alone.
    Rolling,
}

/// Sections, and how far beside their plane they were traced, mm.
type Found = (Vec<Vec<Point3<f64>>>, f64);

/// Sections of tips over lines at right angles to the x or y axis.
#[derive(Debug, Clone, Copy)]
pub struct MeshSections<'a> {
    contacts: MeshContacts<'a>,
    /// 0 is x, 1 is y.
    axis: usize,
}

impl<'a> MeshSections<'a> {
    /// Sections over lines at right angles to `axis` (0 is x, 1 is y).
    pub fn new(contacts: MeshContacts<'a>, axis: usize) -> Self {
        Self { contacts, axis }
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

    /// As [`Self::chains`], for a cutter that may touch the outline alone: it rolls over it where the contact
    /// is not steep, and while the axis is between the ends of the mesh's box along the line.
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
        Ok(found.into_iter().map(|points| Chain { points, chord_height_mm }).collect())
    }

    /// The sections, and how far beside the plane they were traced, mm. Over some planes the cutter only
    /// grazes a wall, and rounding decides on which side of the wall it is. There the sections are traced a
    /// little beside the plane on both sides, and those with the lowest point are taken.
    fn found(
        &self,
        counting: Counting,
        plane: PlaneAt,
        spacing: Spacing,
        budget: &Budget,
    ) -> Result<Found, SectionError> {
        let mut trace = Trace::new(self, counting, plane, spacing, budget);
        if trace.all(true)? {
            return Ok((trace.chains, 0.0));
        }
        let beside = BESIDE * self.contacts.cutter.radius();
        let mut lowest: Option<(f64, Vec<Vec<Point3<f64>>>)> = None;
        for by in [beside, -beside] {
            let at = PlaneAt { traced_at: plane.traced_at + by, ..plane };
            let mut trace = Trace::new(self, counting, at, spacing, budget);
            let is_all = trace.all(true)?;
            let height = trace.chains.iter().flatten().map(|point| point.z).fold(f64::INFINITY, f64::min);
            let is_lower = lowest.as_ref().is_none_or(|(least, _)| height < *least);
            if is_all && !trace.chains.is_empty() && is_lower {
                lowest = Some((height, trace.chains));
            }
        }
        if let Some((_, chains)) = lowest {
            return Ok((chains, beside));
        }
        let mut trace = Trace::new(self, counting, plane, spacing, budget);
        trace.all(false)?;
        Ok((trace.chains, 0.0))
    }

    /// Whether there is any section over `plane`.
    ///
    /// # Errors
    /// As for [`Self::chains`].
    pub fn has_any(&self, plane: PlaneAt, spacing: Spacing, budget: &Budget) -> Result<bool, SectionError> {
        Trace::new(self, Counting::Touching, plane, spacing, budget).has_any()
    }

    /// The least and the largest coordinate along the axis of positions at which the cutter touches a
    /// triangle that faces up, mm; those of the mesh without such triangles.
    pub fn extent(&self) -> [f64; 2] {
        let mesh = self.contacts.mesh;
        let mut extent = [f64::INFINITY, f64::NEG_INFINITY];
        for k in 0..mesh.triangles().len() {
            let normal = mesh.normal(k);
            if is_sliver(&mesh.corners(k)) || normal.z <= UPRIGHT * normal.norm() {
                continue;
            }
            let lower = self.contacts.cutter.tangent_point(-normal.xy() / normal.z);
            let off = if lower.slope() == 0.0 { 0.0 } else { lower.place[self.axis] };
            for corner in mesh.corners(k) {
                let at = corner[self.axis] - off;
                extent = [extent[0].min(at), extent[1].max(at)];
            }
        }
        let bounds = mesh.bounds();
        if extent[0] <= extent[1] { extent } else { [bounds.min[self.axis], bounds.max[self.axis]] }
    }

    /// The range of positions along a line at which the cutter may touch the mesh, mm.
    fn range(&self) -> [f64; 2] {
        let (along, bounds) = (1 - self.axis, self.contacts.mesh.bounds());
        let radius = (1.0 - GRAZING) * self.contacts.cutter.radius();
        [bounds.min[along] - radius, bounds.max[along] + radius]
    }

    /// Whether a section runs through a contact. Where a cutter with a flat stands level, it does only while
    /// its axis is over the mesh. A cutter that rolls over a part of the outline that is not steep follows it
    /// while its axis is over the mesh.
    fn counts(&self, counting: Counting, contact: &MeshContact) -> bool {
        let MeshContacts { mesh, cutter } = self.contacts;
        if counting == Counting::Rolling {
            let (along, bounds) = (1 - self.axis, mesh.bounds());
            let ends = bounds.min[along]..=bounds.max[along];
            return contact.slope <= ROLLING_SLOPE && ends.contains(&contact.tip[along]);
        }
        let is_over = || mesh.covers(contact.tip.xy().coords);
        if cutter.flat_radius() > 0.0 && contact.slope <= LEVEL {
            return is_over();
        }
        contact.is_inside
            || contact.slope <= ROLLING_SLOPE && is_over()
            || self.is_tangent(contact)
            || !self.is_on_outline(contact.point.xy().coords)
    }

    /// Whether the cutter touches the plane of the triangle, and not only a side or a corner of it.
    fn is_tangent(&self, contact: &MeshContact) -> bool {
        let normal = self.contacts.mesh.normal(contact.triangle as usize);
        let out = (contact.point - contact.tip).xy();
        // The normal of the lower side points from the surface to the cutter.
        let sideways = out.try_normalize(0.0).unwrap_or_default() * -contact.slope;
        let own = Vector3::new(sideways.x, sideways.y, 1.0);
        contact.slope.is_finite()
            && normal.norm() > 0.0
            && own.cross(&normal).norm() <= TANGENT * own.norm() * normal.norm()
    }

    /// Whether there is no mesh beside a place of it, seen from above.
    fn is_on_outline(&self, place: Vector2<f64>) -> bool {
        (0..DIRECTIONS).any(|k| {
            let angle = k as f64 * std::f64::consts::TAU / DIRECTIONS as f64;
            let (sin, cos) = angle.sin_cos();
            !self.contacts.mesh.covers(place + Vector2::new(cos, sin) * BESIDE_OUTLINE_MM)
        })
    }
}
