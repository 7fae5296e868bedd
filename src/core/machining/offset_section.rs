//! Traces sections of the offset of a surface with planes at right angles to x or y. The method is that of
//! Ju, section 3.
//!
//! # Method
//! 1. Find all points where the plane meets the boundary of the offset (`boundary`).
//! 2. From one of these points, trace the section point by point: go a short way along the tangent, and then
//!    move the new point onto the section by Newton's method.
//! 3. End the section where it reaches the boundary again. Trace the next section from a point of step 1 at
//!    which no section starts or ends yet, until there is no such point.
//! 4. Sides at which the surface is closed belong to the boundary in steps 1 to 3. Afterwards, join the
//!    sections that end there to those that go on at the opposite side (`seams`).
//!
//! # Guarantees
//! * The caller must have proved that the offset has no fold and the surface no overhang
//!   ([`regularity`](super::regularity)). Then every section ends at the boundary, so that none is missed.
//! * Every point lies on the section to within rounding. Between two neighbouring points, the section leaves
//!   their chord by at most 1.01 times the chord height asked for.
//!
//! The plane must cross the edges of the surface wherever it meets them. A plane that only touches an edge,
//! or that contains a part of it, is not supported. A plane may contain a seam.
//!
//! # Cost
//! O(s + n) for n points of a section and s stretches of the boundary.
//!
//! # Reference
//! S. Y. Ju, "CL-Cartesian Machining along Approximated Circular Arcs", section 3, eq. 2 and 3.

mod boundary;
mod seams;

use nalgebra::{Point3, Vector3};

use super::regularity::Regularity;
use crate::budget::{Budget, Stopped};
use crate::geometry::surface::offset::{OffsetJet, offset};
use crate::geometry::surface::{Surface, span_of};
use boundary::{Boundary, BoundaryPoint};
use seams::{Seams, Traced};

/// How far inside the extent of the offset its outermost sections are traced, mm. On the extent the plane
/// would touch the boundary, or contain a part of it. The inset is large enough for a plane along a straight
/// edge to meet the edges at its ends, and too small to show in any program.
pub const INSET_MM: f64 = 1e-6;

/// The largest part of the extent by which an outermost section may lie inside: on a part of micrometres the
/// sections of both ends would otherwise meet.
pub const INSET_PART: f64 = 1e-3;

/// Largest number of points of one section. At 0.01 mm apart this is a section of ten metres.
const POINT_LIMIT: usize = 1_000_000;

/// Largest number of Newton steps for one point; two or three are usual.
const NEWTON_LIMIT: usize = 12;

/// How near to its plane Newton's method brings a point: mm, or a part of the largest coordinate if that is
/// more. The first is a ten-thousandth of the smallest legal tolerance, the second a few units of rounding.
const IN_PLANE_MM: f64 = 1e-10;
const IN_PLANE_PART: f64 = 1e-15;

/// How near a point comes to its place along the step, as a part of the step. Points may lie anywhere on the
/// section, so that less accuracy does: it only makes the spacing uneven by this part.
const ALONG_PART: f64 = 1e-6;

/// How far beside a step a crossing may lie for rounding alone, as a part of 1 mm plus the largest
/// coordinate. It is ten times above the accuracy of the points.
const BESIDE_PART: f64 = 1e-9;

/// Step length, mm, below which a section has reached the boundary.
const SHORTEST_STEP_MM: f64 = 1e-9;

/// A step is halved at most this often before the section counts as lost.
const HALVING_LIMIT: u32 = 40;

#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SectionError {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    #[error("the section could not be traced near {at}")]
    Lost { at: Point3<f64> },
    #[error("one section needs more than {limit} points")]
    TooManyPoints { limit: usize },
}

/// One connected section: points of the offset surface, from boundary to boundary.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
    pub points: Vec<Point3<f64>>,
    /// The section leaves the polygon through the points by at most this distance, mm.
    pub chord_height_mm: f64,
}

impl Chain {
    /// The length of the polygon, mm.
    pub fn length(&self) -> f64 {
        self.points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum()
    }
}

/// A plane at right angles to the axis of [`Sections`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneAt {
    /// The coordinate of the points of the sections, mm.
    pub at: f64,
    /// The coordinate at which the sections are traced, mm. It differs from `at` only for a plane along an
    /// edge, which is traced [`INSET_MM`] inside; the points are then moved to the edge.
    pub traced_at: f64,
}

impl PlaneAt {
    pub fn new(at: f64) -> Self {
        Self { at, traced_at: at }
    }
}

/// The spacing of the points of a section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spacing {
    /// Largest height of the section over the chord of neighbouring points, mm.
    pub chord_height_mm: f64,
    /// Largest distance of neighbouring points, mm.
    pub step_length_mm: f64,
}

/// All sections of one offset surface with planes at right angles to one axis.
pub struct Sections<'a> {
    surface: &'a dyn Surface,
    radius: f64,
    axis: usize,
    regularity: &'a Regularity,
    boundary: Boundary,
    seams: Seams,
}

/// A place on the offset surface with its parameters.
#[derive(Clone, Copy)]
struct OffsetPoint {
    u: f64,
    v: f64,
    jet: OffsetJet,
}

/// A place where the boundary meets the plane.
struct Crossing {
    boundary: BoundaryPoint,
    place: OffsetPoint,
}

impl<'a> Sections<'a> {
    /// `regularity` is the proof for the same surface, radius (mm) and axis (0 is x, 1 is y).
    ///
    /// # Errors
    /// Only the budget's stop.
    pub fn new(
        surface: &'a dyn Surface,
        radius: f64,
        axis: usize,
        regularity: &'a Regularity,
        budget: &Budget,
    ) -> Result<Self, Stopped> {
        let boundary = Boundary::new(surface, radius, axis, budget)?;
        let seams = Seams::of(surface, radius);
        Ok(Self { surface, radius, axis, regularity, boundary, seams })
    }

    /// The least and the largest coordinate of the offset along the axis, mm. They lie on the boundary, since
    /// inside no normal is parallel to the axis.
    pub fn extent(&self) -> [f64; 2] {
        self.boundary.extent()
    }

    /// The sections with `plane`, in no particular order or sense.
    ///
    /// # Errors
    /// When a section is lost (the surface is not as regular as it was proved to be), has too many points, or
    /// the budget stops.
    pub fn chains(
        &self,
        plane: PlaneAt,
        spacing: Spacing,
        budget: &Budget,
    ) -> Result<Vec<Chain>, SectionError> {
        if self.seams.is_none() {
            let traced = self.traced(plane, spacing, budget)?;
            return Ok(traced.into_iter().map(|traced| traced.chain).collect());
        }
        self.across_seams(plane, spacing, budget)
    }

    /// The sections with `plane`, from boundary to boundary.
    fn traced(&self, plane: PlaneAt, spacing: Spacing, budget: &Budget) -> Result<Vec<Traced>, SectionError> {
        let starts = self.boundary.crossings(self.surface, plane.traced_at).into_iter();
        let mut open: Vec<Crossing> = starts.filter_map(|boundary| self.crossing(boundary)).collect();
        let mut all = Vec::new();
        while let Some(start) = open.pop() {
            budget.check()?;
            if let Some((traced, reached)) = self.trace(&start, &open, plane, spacing, budget)? {
                if let Some(k) = reached {
                    open.remove(k);
                }
                all.push(traced);
            }
        }
        Ok(all)
    }

    /// Follows the section from `start`. Returns the section, and the index in `open` of the crossing it
    /// reached, if it reached one of them. `None` when the section does not enter the surface at `start`.
    fn trace(
        &self,
        start: &Crossing,
        open: &[Crossing],
        plane: PlaneAt,
        mut spacing: Spacing,
        budget: &Budget,
    ) -> Result<Option<(Traced, Option<usize>)>, SectionError> {
        let mut here = start.place;
        let Some(sense) = self.inward_sense(&start.boundary, &here) else { return Ok(None) };
        let at = plane.traced_at;
        let mut chain = Chain { points: vec![self.on_plane(&here, plane)], chord_height_mm: 0.0 };
        let ends = |end: Option<BoundaryPoint>| [Some(start.boundary), end];
        loop {
            if chain.points.len() >= POINT_LIMIT {
                return Err(SectionError::TooManyPoints { limit: POINT_LIMIT });
            }
            if chain.points.len().is_multiple_of(1024) {
                budget.check()?;
            }
            let next = self.step(&here, sense, at, spacing, &mut chain)?;
            let reached = crossing_on_step(&here, &next, open, spacing);
            if let Some(k) = reached {
                chain.points.push(self.on_plane(&open[k].place, plane));
                return Ok(Some((Traced { chain, ends: ends(Some(open[k].boundary)) }, reached)));
            }
            if !self.is_inside(next.u, next.v) {
                let (from, to) = ((here.u, here.v), (next.u, next.v));
                let missed = self.boundary.crossing_between(self.surface, at, from, to);
                if let Some(end) = missed.and_then(|boundary| self.crossing(boundary)) {
                    chain.points.push(self.on_plane(&end.place, plane));
                    return Ok(Some((Traced { chain, ends: ends(Some(end.boundary)) }, None)));
                }
                // A shorter step crosses the boundary nearer to the place where the section does.
                spacing.step_length_mm = 0.5 * (next.jet.point - here.jet.point).norm();
                if spacing.step_length_mm < SHORTEST_STEP_MM {
                    return Ok(Some((Traced { chain, ends: ends(None) }, None)));
                }
                continue;
            }
            chain.points.push(self.on_plane(&next, plane));
            here = next;
        }
    }

    /// The point of the offset next to a traced one, in the plane of the pass. The offset is continued past
    /// its edge for it.
    fn on_plane(&self, traced: &OffsetPoint, plane: PlaneAt) -> Point3<f64> {
        if plane.at == plane.traced_at {
            return traced.jet.point;
        }
        let tangent = self.tangent(&traced.jet, 1.0);
        let moved = self.corrected(traced, tangent, 0.0, plane.at);
        moved.map_or(traced.jet.point, |place| place.jet.point)
    }

    fn crossing(&self, boundary: BoundaryPoint) -> Option<Crossing> {
        let (u, v) = boundary.parameters();
        Some(Crossing { boundary, place: self.place(u, v)? })
    }

    /// The next point of the section, at most one step from `here`; it may lie beyond the boundary.
    fn step(
        &self,
        here: &OffsetPoint,
        sense: f64,
        at: f64,
        spacing: Spacing,
        chain: &mut Chain,
    ) -> Result<OffsetPoint, SectionError> {
        let tangent = self.tangent(&here.jet, sense);
        let curvature = self.curvature_at(here.u, here.v);
        let mut length = spacing.step_length_mm.min(chord_for_height(spacing.chord_height_mm, curvature));
        for _ in 0..HALVING_LIMIT {
            if let Some(next) = self.corrected(here, tangent, length, at) {
                let chord = (next.jet.point - here.jet.point).norm();
                let curvature = curvature.max(self.curvature_at(next.u, next.v));
                let height = chord_height(chord, curvature);
                let forward = self.tangent(&next.jet, sense).dot(&tangent) > 0.5;
                if forward && chord <= 1.5 * length && height <= 1.01 * spacing.chord_height_mm {
                    chain.chord_height_mm = chain.chord_height_mm.max(height);
                    return Ok(next);
                }
            }
            length *= 0.5;
        }
        Err(SectionError::Lost { at: here.jet.point })
    }

    /// Newton's method for the point of the section in the plane at right angles to `tangent`, at `length`
    /// from `here`. `None` where it does not converge.
    fn corrected(
        &self,
        here: &OffsetPoint,
        tangent: Vector3<f64>,
        length: f64,
        at: f64,
    ) -> Option<OffsetPoint> {
        let predicted = here.jet.point + tangent * length;
        let mut place = *here;
        let mut residual = [here.jet.point[self.axis] - at, -length];
        let accurate = IN_PLANE_MM.max(IN_PLANE_PART * here.jet.point.coords.amax());
        for _ in 0..NEWTON_LIMIT {
            let (gu, gv) = (place.jet.du[self.axis], place.jet.dv[self.axis]);
            let (hu, hv) = (place.jet.du.dot(&tangent), place.jet.dv.dot(&tangent));
            let det = gu * hv - gv * hu;
            let du = (residual[0] * hv - residual[1] * gv) / det;
            let dv = (residual[1] * gu - residual[0] * hu) / det;
            let (u, v) = (place.u - du, place.v - dv);
            // A step covers at most half a span, so that the curvature bounds around both ends cover what
            // lies between.
            if !((u - here.u).abs() <= 0.5 && (v - here.v).abs() <= 0.5) {
                return None;
            }
            place = self.place(u, v)?;
            residual = [place.jet.point[self.axis] - at, (place.jet.point - predicted).dot(&tangent)];
            if residual[0].abs() <= accurate && residual[1].abs() <= ALONG_PART * length + accurate {
                return Some(place);
            }
        }
        None
    }

    fn place(&self, u: f64, v: f64) -> Option<OffsetPoint> {
        let jet = offset(&self.surface.jet(u, v), self.radius)?;
        Some(OffsetPoint { u, v, jet })
    }

    /// Ju eq. 3: the unit tangent of the section.
    fn tangent(&self, jet: &OffsetJet, sense: f64) -> Vector3<f64> {
        let mut plane_normal = Vector3::zeros();
        plane_normal[self.axis] = sense;
        jet.normal.cross(&plane_normal).normalize()
    }

    /// The sign with which the tangent at a boundary point leads into the surface.
    fn inward_sense(&self, start: &BoundaryPoint, here: &OffsetPoint) -> Option<f64> {
        let (gu, gv) = (here.jet.du[self.axis], here.jet.dv[self.axis]);
        let (inward_u, inward_v) = start.inward();
        // Along the section gu du + gv dv = 0: (du, dv) is (-gv, gu) or its opposite.
        let into = -gv * inward_u + gu * inward_v;
        if into == 0.0 {
            return None;
        }
        let along = (here.jet.du * -gv + here.jet.dv * gu) * into.signum();
        let sense = along.dot(&self.tangent(&here.jet, 1.0));
        (sense != 0.0).then(|| sense.signum())
    }

    fn is_inside(&self, u: f64, v: f64) -> bool {
        let [nu, nv] = self.surface.spans();
        (0.0..=nu as f64).contains(&u) && (0.0..=nv as f64).contains(&v)
    }

    fn curvature_at(&self, u: f64, v: f64) -> f64 {
        let [nu, nv] = self.surface.spans();
        self.regularity.section_curvature_around(span_of(u, nu), span_of(v, nv))
    }
}

/// The index of the first crossing that the section passes between `here` and `next`. The section may leave
/// the surface there even if `next` lies inside again.
fn crossing_on_step(
    here: &OffsetPoint,
    next: &OffsetPoint,
    open: &[Crossing],
    spacing: Spacing,
) -> Option<usize> {
    let step = next.jet.point - here.jet.point;
    let length = step.norm();
    // The section keeps within the chord height of the chord; the rest is for rounding.
    let aside =
        2.0 * spacing.chord_height_mm.min(length) + BESIDE_PART * (1.0 + here.jet.point.coords.amax());
    let passed = open.iter().enumerate().filter_map(|(k, crossing)| {
        let to = crossing.place.jet.point - here.jet.point;
        let along = to.dot(&step) / length;
        let is_near = to.norm_squared() - along * along <= aside * aside;
        // Both names of a point on a seam are at one place. The section reaches the name that is near in
        // parameters.
        let expected =
            [here.u + (next.u - here.u) * along / length, here.v + (next.v - here.v) * along / length];
        let is_own_name =
            (crossing.place.u - expected[0]).abs().max((crossing.place.v - expected[1]).abs()) < 0.5;
        (is_near && is_own_name && along >= 0.0 && along <= length).then_some((along, k))
    });
    passed.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, k)| k)
}

/// Height of an arc of curvature `curvature` (1/mm) over its chord, mm. Infinite where the chord is too long
/// for the curvature to bound the height.
pub fn chord_height(chord: f64, curvature: f64) -> f64 {
    let half_turn = 0.5 * chord * curvature;
    if half_turn >= 1.0 {
        return f64::INFINITY;
    }
    0.5 * chord * half_turn / (1.0 + (1.0 - half_turn * half_turn).sqrt())
}

/// The length of the chord with the given height under an arc of curvature `curvature` (1/mm), mm.
fn chord_for_height(height: f64, curvature: f64) -> f64 {
    if curvature > 0.0 { (8.0 * height / curvature).sqrt().min(1.0 / curvature) } else { f64::INFINITY }
}

#[cfg(test)]
mod tests;
