//! The section planes of a job, and the CL curves in these planes.

use nalgebra::Point3;

use super::outline::Outline;
use super::{Error, Job};
use crate::budget::Budget;
use crate::geometry::solve::try_bisect;
use crate::geometry::spacing::spaces;
use crate::geometry::surface::patch::Patch;
use crate::machining::drop_cutter::TipSections;
use crate::machining::offset_section::{
    Chain, INSET_MM, INSET_PART, PlaneAt, SectionError, Sections, Spacing,
};

/// How far inside the extent the outermost plane lies at an edge that is not straight, mm. On the extent the
/// plane would touch the offset in one point and have no section; half a hundredth of a millimetre inside it
/// has one.
const TOUCH_MM: f64 = 5e-3;

/// An edge counts as straight if the section next to it has at least this share of the length of the section
/// [`TOUCH_MM`] inside.
const STRAIGHT_SHARE: f64 = 0.9;

/// The number of places at which the first and the last section are looked for. A part narrower than the
/// distance between two places may be missed.
const PROBES: usize = 64;

/// Bisection steps between a plane with sections and one without: 24 find the limit to a ten-millionth of the
/// distance between two probes.
const HALVINGS: usize = 24;

/// Spacing of points that is fine enough to compare the lengths of sections.
const COARSE: Spacing = Spacing { chord_height_mm: TOUCH_MM, step_length_mm: f64::INFINITY };

/// A way to find the CL curves in a plane.
pub(super) trait ClCurves: Sync {
    /// The range of planes that may hold CL curves, mm.
    fn reach(&self) -> [f64; 2];

    /// The first and the last plane within the reach that hold CL curves, mm.
    fn extent(&self, reach: [f64; 2], budget: &Budget) -> Result<[f64; 2], SectionError>;

    /// The curves of the tip in one plane.
    fn chains(&self, plane: PlaneAt, spacing: Spacing, budget: &Budget) -> Result<Vec<Chain>, SectionError>;

    /// The curves of the tip in one plane, with those on which the cutter touches edges of the surface alone.
    fn chains_over_edges(
        &self,
        plane: PlaneAt,
        spacing: Spacing,
        budget: &Budget,
    ) -> Result<Vec<Chain>, SectionError>;
}

/// CL curves as sections of the offset surface, whose points lie `rise` mm above the tip.
pub(super) struct OffsetCurves<'a> {
    pub(super) sections: Sections<'a>,
    pub(super) rise: f64,
}

impl ClCurves for OffsetCurves<'_> {
    fn reach(&self) -> [f64; 2] {
        self.sections.extent()
    }

    fn extent(&self, reach: [f64; 2], _budget: &Budget) -> Result<[f64; 2], SectionError> {
        Ok(reach)
    }

    fn chains(&self, plane: PlaneAt, spacing: Spacing, budget: &Budget) -> Result<Vec<Chain>, SectionError> {
        Ok(raised(self.sections.chains(plane, spacing, budget)?, -self.rise))
    }

    /// The offset ends at the edges.
    fn chains_over_edges(
        &self,
        plane: PlaneAt,
        spacing: Spacing,
        budget: &Budget,
    ) -> Result<Vec<Chain>, SectionError> {
        self.chains(plane, spacing, budget)
    }
}

/// CL curves by direct contact of the cutter, enlarged by the allowance `stock` mm.
pub(super) struct ContactCurves<'a, P> {
    pub(super) sections: TipSections<'a, P>,
    pub(super) stock: f64,
}

impl<P: Patch> ClCurves for ContactCurves<'_, P> {
    fn reach(&self) -> [f64; 2] {
        self.sections.extent()
    }

    fn extent(&self, [low, high]: [f64; 2], budget: &Budget) -> Result<[f64; 2], SectionError> {
        let has_section = |at: f64| self.sections.has_any(PlaneAt::new(at), COARSE, budget);
        // The place that reaches farthest across the planes may not be the place that touches the cutter
        // first.
        let inset = TOUCH_MM.min(INSET_PART * (high - low));
        if has_section(low + inset)? && has_section(high - inset)? {
            return Ok([low, high]);
        }
        Ok(extent_where([low, high], has_section)?.unwrap_or([low, high]))
    }

    fn chains(&self, plane: PlaneAt, spacing: Spacing, budget: &Budget) -> Result<Vec<Chain>, SectionError> {
        Ok(raised(self.sections.chains(plane, spacing, budget)?, self.stock))
    }

    fn chains_over_edges(
        &self,
        plane: PlaneAt,
        spacing: Spacing,
        budget: &Budget,
    ) -> Result<Vec<Chain>, SectionError> {
        Ok(raised(self.sections.chains_over_edges(plane, spacing, budget)?, self.stock))
    }
}

/// The range within `low` to `high` in which `holds` is true, as far as [`PROBES`] find it; `None` if it
/// holds at no probe.
fn extent_where<E>(
    [low, high]: [f64; 2],
    holds: impl Fn(f64) -> Result<bool, E>,
) -> Result<Option<[f64; 2]>, E> {
    let probe = |k: usize| low + (high - low) * (k as f64 + 0.5) / PROBES as f64;
    let first_of = |probes: &mut dyn Iterator<Item = usize>| -> Result<Option<usize>, E> {
        for k in probes {
            if holds(probe(k))? {
                return Ok(Some(k));
            }
        }
        Ok(None)
    };
    let Some(first) = first_of(&mut (0..PROBES))? else { return Ok(None) };
    let last = first_of(&mut (first..PROBES).rev())?.unwrap_or(first);
    let outside = [
        if first == 0 { low } else { probe(first - 1) },
        if last == PROBES - 1 { high } else { probe(last + 1) },
    ];
    let [low, _] = try_bisect([probe(first), outside[0]], HALVINGS, &holds)?;
    let [high, _] = try_bisect([probe(last), outside[1]], HALVINGS, &holds)?;
    Ok(Some([low, high]))
}

fn raised(mut chains: Vec<Chain>, by: f64) -> Vec<Chain> {
    chains.iter_mut().flat_map(|chain| &mut chain.points).for_each(|point| point.z += by);
    chains
}

/// The sections of a job, clipped to where the cutter may go.
pub(super) struct Slicer<'a> {
    curves: &'a dyn ClCurves,
    /// The index of the coordinate that is constant on a plane.
    axis: usize,
    /// The outline, and the distance to be kept from it, mm.
    inside: Option<(Outline, f64)>,
}

impl<'a> Slicer<'a> {
    pub(super) fn new(curves: &'a dyn ClCurves, axis: usize, inside: Option<(Outline, f64)>) -> Self {
        Self { curves, axis, inside }
    }

    /// Whether the axis of the cutter may go straight from `from` to `to`: anywhere, unless the job keeps the
    /// cutter inside the outline.
    pub(super) fn lets_pass(&self, from: &Point3<f64>, to: &Point3<f64>) -> bool {
        let [from, to] = [from, to].map(|place| place.coords.xy());
        self.inside.as_ref().is_none_or(|(outline, margin)| outline.holds(from, to, *margin))
    }

    pub(super) fn chains(
        &self,
        plane: PlaneAt,
        spacing: Spacing,
        budget: &Budget,
    ) -> Result<Vec<Chain>, SectionError> {
        self.clipped(self.curves.chains(plane, spacing, budget)?, budget)
    }

    /// As [`Self::chains`], with the curves on which the cutter touches edges of the surface alone.
    pub(super) fn chains_over_edges(
        &self,
        plane: PlaneAt,
        spacing: Spacing,
        budget: &Budget,
    ) -> Result<Vec<Chain>, SectionError> {
        self.clipped(self.curves.chains_over_edges(plane, spacing, budget)?, budget)
    }

    fn clipped(&self, chains: Vec<Chain>, budget: &Budget) -> Result<Vec<Chain>, SectionError> {
        let Some((outline, margin)) = &self.inside else { return Ok(chains) };
        let mut inside = Vec::new();
        for chain in &chains {
            inside.extend(outline.clipped(chain, *margin, budget)?);
        }
        Ok(inside)
    }

    /// Equally spaced planes at most `stepover` mm apart, the first and the last at the ends of the extent of
    /// the CL points.
    pub(super) fn planes(&self, job: &Job, stepover: f64, budget: &Budget) -> Result<Vec<PlaneAt>, Error> {
        let reach = self.reach()?;
        let spaces = spaces(reach[1] - reach[0], stepover);
        let limit = job.plane_limit;
        if spaces >= limit as f64 {
            let needed = (spaces as usize).saturating_add(1);
            return Err(Error::TooMuchWork { what: "section planes", needed, limit });
        }
        let [low, high] = match self.inside {
            Some(_) => reach,
            None => self.curves.extent(reach, budget)?,
        };
        let (width, n) = (high - low, self::spaces(high - low, stepover) as usize);
        let first = self.outermost(job, low, 1.0, [width, stepover], budget)?;
        let last = self.outermost(job, high, -1.0, [width, stepover], budget)?;
        let between = |k: usize| first.at + (last.at - first.at) * (k as f64 / n as f64);
        let inner = (1..n).map(|k| PlaneAt::new(between(k)));
        Ok(std::iter::once(first).chain(inner).chain([last]).collect())
    }

    /// The range of planes that may hold sections inside the outline, mm.
    fn reach(&self) -> Result<[f64; 2], Error> {
        let [low, high] = self.curves.reach();
        // The reach is empty or infinite for a surface that is a point or a vertical line: it has no tangent
        // plane to touch.
        if !(low <= high && (high - low).is_finite()) {
            return Err(Error::NothingToCut);
        }
        let Some((outline, margin)) = &self.inside else { return Ok([low, high]) };
        let is_inside = |at: f64| Ok::<_, Error>(outline.is_inside(self.axis, at, *margin));
        extent_where([low, high], is_inside)?.ok_or(Error::NothingToCut)
    }

    /// The outermost plane at the end `extent` mm; `inward` (1 or -1) points into the part. Along a straight
    /// edge the plane lies on the extent, else [`TOUCH_MM`] inside. At the tip of a sharp corner it lies
    /// farther inside, where the section is long enough to be cut, by at most half of `stepover` mm and a
    /// quarter of `width` mm.
    fn outermost(
        &self,
        job: &Job,
        extent: f64,
        inward: f64,
        [width, stepover]: [f64; 2],
        budget: &Budget,
    ) -> Result<PlaneAt, Error> {
        let [on_edge, first] = [INSET_MM, TOUCH_MM].map(|inset| inset.min(INSET_PART * width));
        let farthest = 0.5 * stepover.min(0.5 * width);
        let mut inset = first;
        // Sections that are too short for a pass count where there are no others.
        for shortest in [job.short_mm(), job.vanishing_mm()] {
            let length = |inset: f64| self.cut_length(extent + inward * inset, shortest, budget);
            inset = first;
            let mut inside = length(inset)?;
            if inside > 0.0 && length(on_edge)? >= STRAIGHT_SHARE * inside {
                return Ok(PlaneAt { at: extent, traced_at: extent + inward * on_edge });
            }
            while inside == 0.0 && inset < farthest {
                inset = farthest.min(2.0 * inset);
                inside = length(inset)?;
            }
            if inside > 0.0 {
                break;
            }
        }
        Ok(PlaneAt::new(extent + inward * inset))
    }

    /// The total length of the sections in the plane at `at` mm that are longer than `shortest` mm, roughly.
    fn cut_length(&self, at: f64, shortest: f64, budget: &Budget) -> Result<f64, Error> {
        let chains = self.chains(PlaneAt::new(at), COARSE, budget)?;
        Ok(chains.iter().map(Chain::length).filter(|length| *length > shortest).sum())
    }
}
