//! Makes passes from CL curves. A pass is a chain of arcs and lines, with a proved bound of its deviation
//! from the CL curve.

mod left_out;

use std::sync::atomic::{AtomicUsize, Ordering};

use nalgebra::Point3;

use super::deviation::{self, Deviation, Seam};
use super::planes::Slicer;
use super::{CutDirection, Error, Interpolation, Job};
use crate::budget::Budget;
use crate::geometry::arc_fit::{Fit, FitError, Joints, Shapes, fit_in_space};
use crate::geometry::curve::Curve;
use crate::machining::offset_section::{Chain, PlaneAt, SectionError, Spacing, chord_height};
use crate::toolpath::PathError;
pub(super) use left_out::LeftOut;
use left_out::leave_out_short;

/// Room kept for rounding the ends and the centre of an arc, in steps of the last decimal; most arcs stay
/// within it.
const ROUNDING_STEPS: f64 = 0.8;

/// Nearly straight sections deviate far less than their bound states. To sharpen the bound, the allowed chord
/// height is multiplied by `SHARPENED_BY`, at most `SHARPENINGS` times.
const SHARPENINGS: usize = 3;
const SHARPENED_BY: f64 = 0.3;

/// An arc bridges a wall if it leaves a chord by more than this multiple of the section's height over that
/// chord.
const BULGE: f64 = 20.0;

/// Least height of sections over their chords, mm, where steps are only counted.
const COARSE_HEIGHT_MM: f64 = 5e-3;

/// The part by which a count of least steps may exceed the limit before the job is refused: the lengths that
/// are divided are rounded, and a job at its limit has to pass.
const COUNT_ROUNDING: f64 = 1e-6;

/// For each curve of all passes the proved bound of its deviation, mm.
pub(super) fn deviations_mm(passes: &[CutPass]) -> Vec<f64> {
    passes.iter().flat_map(|pass| pass.deviations_mm.iter().copied()).collect()
}

/// The number of planes that are cut beforehand to estimate the number of CL points.
const SAMPLED: usize = 16;

/// The golden ratio less 1. Its multiples without their whole parts spread over the range from 0 to 1 at
/// unequal distances.
const GOLDEN: f64 = 0.618_033_988_749_895;

/// A job is refused beforehand if the estimate is above this many times the limit: the sampled planes may
/// have more points than the others.
const FAR_ABOVE: f64 = 1.5;

/// Trials with finer points before a section's tolerance counts as not reachable.
const REFINEMENT_LIMIT: usize = 12;

/// One connected chain of cuts, in the direction of travel.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct CutPass {
    pub(super) curves: Vec<Curve>,
    pub(super) n_points: usize,
    /// The deviation from the exact CL curve.
    pub(super) deviation: Deviation,
    /// For each curve the proved bound of its deviation, mm.
    pub(super) deviations_mm: Vec<f64>,
}

impl CutPass {
    pub(super) fn start(&self) -> Point3<f64> {
        self.curves[0].start()
    }

    pub(super) fn end(&self) -> Point3<f64> {
        self.curves[self.curves.len() - 1].end()
    }

    fn length(&self) -> f64 {
        self.curves.iter().map(Curve::length).sum()
    }
}

/// All passes in the order of cutting, and the pieces left out because they are too short.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Passes {
    pub(super) passes: Vec<CutPass>,
    pub(super) left_out: LeftOut,
}

impl Passes {
    fn and(mut self, more: Self) -> Self {
        self.passes.extend(more.passes);
        self.left_out = self.left_out.and(more.left_out);
        self
    }

    /// Whether any pass has at least the length `shortest` mm.
    fn has_long(&self, shortest: f64) -> bool {
        self.passes.iter().any(|pass| pass.length() >= shortest)
    }

    /// Moves all passes to the pieces left out.
    fn without_passes(self) -> Self {
        let passes = self.passes.iter().map(|pass| LeftOut::of(pass.length(), pass.start()));
        Self { passes: Vec::new(), left_out: passes.fold(self.left_out, LeftOut::and) }
    }
}

/// The limits that every pass keeps.
#[derive(Debug, Clone, Copy)]
pub(super) struct Allowed {
    /// The largest deviation of a pass, mm.
    pub(super) tolerance: f64,
    /// The jump and the bend that rounded data cause at joints.
    pub(super) seam: Seam,
    /// The share of the tolerance that the section may take as height over its chords. A smaller share needs
    /// more points. A larger one needs more arcs, but their number grows only with the inverse cube root of
    /// the tolerance that is left.
    pub(super) chord_height_share: f64,
    /// A job that needs more CL points is refused.
    pub(super) point_limit: usize,
}

/// All passes in the order of cutting.
pub(super) fn cut(
    job: &Job,
    slicer: &Slicer,
    planes: &[PlaneAt],
    allowed: Allowed,
    budget: &Budget,
) -> Result<Passes, Error> {
    check_steps(job, slicer, planes, allowed, budget)?;
    check_points(job, slicer, planes, allowed, budget)?;
    let (done, n_points, n_curves) = (AtomicUsize::new(0), AtomicUsize::new(0), AtomicUsize::new(0));
    let cut_one = |k: usize| -> Result<Passes, Error> {
        budget.check()?;
        let forward = job.direction == CutDirection::OneWay || k.is_multiple_of(2);
        let chains = |spacing| slicer.chains(planes[k], spacing, budget);
        let cut = cut_plane(job, &chains, planes[k], forward, allowed, budget)?;
        let passes = &cut.passes;
        let count = |counter: &AtomicUsize, more: usize| counter.fetch_add(more, Ordering::Relaxed) + more;
        let limit = allowed.point_limit;
        if count(&n_points, passes.iter().map(|pass| pass.n_points).sum()) > limit {
            return Err(Error::TooManyPoints { limit });
        }
        let limit = job.move_limit;
        if count(&n_curves, passes.iter().map(|pass| pass.curves.len()).sum()) > limit {
            return Err(PathError::TooManyMoves { limit }.into());
        }
        budget.progress("sections", done.fetch_add(1, Ordering::Relaxed), planes.len());
        Ok(cut)
    };
    let cut = budget.in_order(planes.len(), cut_one)?;
    let cut = with_long_passes(job, cut, |k| {
        let forward = job.direction == CutDirection::OneWay || k.is_multiple_of(2);
        cut_plane(
            job,
            &|spacing| slicer.chains_over_edges(planes[k], spacing, budget),
            planes[k],
            forward,
            allowed,
            budget,
        )
    })?;
    let cut = cut.into_iter().fold(Passes::default(), Passes::and);
    if cut.passes.is_empty() { Err(Error::NothingToCut) } else { Ok(cut) }
}

/// Leaves out the passes of planes that have short pieces alone, unless all planes of the job have. A plane
/// without a long piece between planes with long ones would leave a strip: there the cutter follows the edges
/// of the surface (`over_edges`).
fn with_long_passes(
    job: &Job,
    mut cut: Vec<Passes>,
    over_edges: impl Fn(usize) -> Result<Passes, Error>,
) -> Result<Vec<Passes>, Error> {
    let shortest = job.short_mm();
    let is_long = |passes: &Passes| passes.has_long(shortest);
    let (Some(first), Some(last)) = (cut.iter().position(is_long), cut.iter().rposition(is_long)) else {
        return Ok(cut);
    };
    for (k, passes) in cut.iter_mut().enumerate().filter(|(_, passes)| !passes.has_long(shortest)) {
        let rolled = if (first..last).contains(&k) { over_edges(k)? } else { Passes::default() };
        let own = std::mem::take(passes);
        *passes = if rolled.has_long(shortest) { rolled } else { own.without_passes() };
    }
    Ok(cut)
}

/// Refuses a step length that needs too many CL points, before the points are found: from an end of a section
/// to its other end leads at least one step for each step length of their distance in plan.
///
/// The sections are traced without a limit for their steps, which takes a small part of the time. If the
/// section in the middle lets all planes together expect less than half of the limit, only that section is
/// traced.
fn check_steps(
    job: &Job,
    slicer: &Slicer,
    planes: &[PlaneAt],
    allowed: Allowed,
    budget: &Budget,
) -> Result<(), Error> {
    let Some(step_length) = job.step_length_mm else { return Ok(()) };
    let height = (allowed.chord_height_share * allowed.tolerance).max(COARSE_HEIGHT_MM);
    let spacing = Spacing { chord_height_mm: height, step_length_mm: f64::INFINITY };
    let axis = 1 - job.plane.normal_axis();
    let least_steps = |plane: &PlaneAt| -> Result<f64, Error> {
        let chains = match slicer.chains(*plane, spacing, budget) {
            // What cannot be traced is told where the passes are cut.
            Err(SectionError::Lost { .. } | SectionError::TooManyPoints { .. }) => return Ok(0.0),
            chains => chains?,
        };
        let way = |chain: &Chain| (chain.points[chain.points.len() - 1][axis] - chain.points[0][axis]).abs();
        let shortest = job.short_mm();
        let kept = chains.iter().filter(|chain| chain.length() >= shortest);
        Ok(kept.map(|chain| way(chain) / step_length).sum())
    };
    let limit = allowed.point_limit;
    let in_all = least_steps(&planes[planes.len() / 2])? * planes.len() as f64;
    if in_all <= 0.5 * limit as f64 {
        return Ok(());
    }
    let mut steps = 0.0;
    for plane in planes {
        budget.check()?;
        steps += least_steps(plane)?;
        if steps * (1.0 - COUNT_ROUNDING) > limit as f64 {
            return Err(Error::TooManyPoints { limit });
        }
    }
    Ok(())
}

/// Refuses a job that needs far too many CL points before all of them are found. The function cuts the passes
/// of [`SAMPLED`] planes and assumes that the other planes have as many points on average. If the points of
/// the first plane, times the number of planes, are at most half of the limit, it cuts no further plane.
fn check_points(
    job: &Job,
    slicer: &Slicer,
    planes: &[PlaneAt],
    allowed: Allowed,
    budget: &Budget,
) -> Result<(), Error> {
    if planes.len() < SAMPLED {
        return Ok(());
    }
    let limit = allowed.point_limit;
    let mut n_points = 0;
    for k in 0..SAMPLED {
        // The planes are spread, and at no equal distances: the part may repeat itself.
        let at = (k as f64 * GOLDEN + 0.5).fract() * planes.len() as f64;
        let plane = planes[at as usize];
        let chains = |spacing| slicer.chains(plane, spacing, budget);
        match cut_plane(job, &chains, plane, true, allowed, budget) {
            Ok(cut) => n_points += cut.passes.iter().map(|pass| pass.n_points).sum::<usize>(),
            Err(Error::Stopped(stopped)) => return Err(stopped.into()),
            // What cannot be cut is told where all passes are.
            Err(_) => {}
        }
        if k == 0 && (n_points * planes.len()) as f64 <= 0.5 * limit as f64 {
            return Ok(());
        }
        if (n_points * planes.len()) as f64 > FAR_ABOVE * limit as f64 * SAMPLED as f64 {
            return Err(Error::TooManyPoints { limit });
        }
    }
    Ok(())
}

/// The passes of one plane along its CL curves, in the direction of travel.
fn cut_plane(
    job: &Job,
    chains: &dyn Fn(Spacing) -> Result<Vec<Chain>, SectionError>,
    plane: PlaneAt,
    forward: bool,
    Allowed { tolerance, seam, chord_height_share, point_limit: _ }: Allowed,
    budget: &Budget,
) -> Result<Passes, Error> {
    let mut spacing = Spacing {
        chord_height_mm: chord_height_share * tolerance,
        // At this step length a seam bends the section under a chord by no more than the section's own
        // height.
        step_length_mm: job
            .step_length_mm
            .unwrap_or(f64::INFINITY)
            .min(chord_height_share * tolerance / seam.bend),
    };
    let mut fit_tolerance =
        tolerance - ROUNDING_STEPS * job.resolution.step_mm() - 2.0 * spacing.chord_height_mm;
    fit_tolerance = fit_tolerance.max(0.1 * tolerance);
    let mut worst = (Deviation::NONE, Point3::origin());
    for tries in 0..REFINEMENT_LIMIT {
        let mut chains = chains(spacing)?;
        chains.retain(|chain| chain.length() > job.vanishing_mm());
        let left_out = leave_out_short(&mut chains, job.short_mm());
        orient(&mut chains, 1 - job.plane.normal_axis(), forward);
        let passes: Result<Vec<_>, Error> =
            chains.iter().map(|chain| fit(job, chain, plane.at, fit_tolerance, seam, budget)).collect();
        let passes = passes?;
        worst = (Deviation::NONE, Point3::origin());
        for pass in &passes {
            if pass.deviation.bound_mm > worst.0.bound_mm {
                worst.1 = pass.start();
            }
            worst.0 = worst.0.or_more(&pass.deviation);
        }
        let too_much = worst.0.bound_mm - tolerance;
        if too_much > 0.0 {
            fit_tolerance = (fit_tolerance - 1.1 * too_much).max(0.5 * fit_tolerance);
            spacing.chord_height_mm *= 0.5;
        } else if tries < SHARPENINGS && !worst.0.is_sharp(job.resolution.step_mm()) {
            spacing.chord_height_mm *= SHARPENED_BY;
        } else {
            return Ok(Passes { passes, left_out });
        }
    }
    let deviation_mm = worst.0.bound_mm;
    Err(Error::ToleranceNotReached { tolerance_mm: job.tolerance.mm(), deviation_mm, at: worst.1 })
}

/// Turns the chains into the direction of travel along the coordinate `axis` and sorts them by their starts.
fn orient(chains: &mut [Chain], axis: usize, forward: bool) {
    let first = |chain: &Chain| chain.points[0][axis];
    let last = |chain: &Chain| chain.points[chain.points.len() - 1][axis];
    for chain in chains.iter_mut() {
        if (first(chain) <= last(chain)) != forward {
            chain.points.reverse();
        }
    }
    chains.sort_by(|a, b| {
        let order = first(a).total_cmp(&first(b));
        if forward { order } else { order.reverse() }
    });
}

/// Joins the CL points of a section by arcs and lines in the plane at `at` mm, and proves their deviation
/// from the section, which may jump and bend at seams.
fn fit(
    job: &Job,
    chain: &Chain,
    at: f64,
    fit_tolerance: f64,
    seam: Seam,
    budget: &Budget,
) -> Result<CutPass, Error> {
    let tips = &chain.points;
    let shapes = match job.interpolation {
        Interpolation::Arcs => Shapes::ArcsAndLines,
        Interpolation::Lines => Shapes::LinesOnly,
    };
    let plane = job.plane.arc_plane();
    let on_plane = |tip: &Point3<f64>| {
        let mut on = *tip;
        on[plane.axes()[2]] = at;
        on
    };
    let flat: Vec<Point3<f64>> = tips.iter().map(on_plane).collect();
    // The points are exact, so elements meet on them. Greedy growth is enough: a search for the fewest
    // elements would save at most one in five hundred.
    let largest_radius_mm = job.curves.largest_radius_mm;
    let within = Fit { largest_radius_mm, ..Fit::within(fit_tolerance) };
    let request = Fit { shapes, joints: Joints::OnPoints, effort: 0, ..within };
    let mut pass = CutPass {
        curves: Vec::new(),
        n_points: tips.len(),
        deviation: Deviation::NONE,
        deviations_mm: Vec::new(),
    };
    // Ranges of points still to be joined; the first range is on top.
    let mut open = vec![[0, tips.len() - 1]];
    while let Some([first, last]) = open.pop() {
        let pieces = match fit_in_space(&flat[first..=last], Some(plane), &request, budget) {
            Ok(pieces) => pieces.curves,
            Err(FitError::Stopped(stopped)) => return Err(stopped.into()),
            Err(FitError::OnePlace) => continue,
        };
        let mut start = first;
        for piece in pieces {
            let end = first + piece.end;
            if let Some(wall) = wall_under_arc(&piece.curve, &tips[start..=end], chain.chord_height_mm) {
                let wall = start + wall;
                open.extend([[end, last], [wall + 1, end], [wall, wall + 1], [start, wall]]);
                open.retain(|[first, last]| first < last);
                break;
            }
            let deviation =
                deviation::of(job, &piece.curve, &tips[start..=end], chain.chord_height_mm, seam)?;
            pass.deviation = pass.deviation.or_more(&deviation);
            pass.deviations_mm.push(deviation.bound_mm);
            pass.curves.push(piece.curve);
            start = end;
        }
    }
    if pass.curves.is_empty() { Err(Error::NothingToCut) } else { Ok(pass) }
}

/// The index of the longest chord of the tips, if the arc leaves that chord by far more than the section
/// does. Such a chord is a vertical or nearly vertical wall, which has no points between its ends.
fn wall_under_arc(curve: &Curve, tips: &[Point3<f64>], section_height: f64) -> Option<usize> {
    let Curve::Arc(arc) = curve else { return None };
    let chord = |k: &usize| (tips[k + 1] - tips[*k]).norm();
    let longest = (0..tips.len() - 1).max_by(|a, b| chord(a).total_cmp(&chord(b)))?;
    let is_wall = chord_height(chord(&longest), 1.0 / arc.radius()) > BULGE * section_height;
    (is_wall && tips.len() > 2).then_some(longest)
}
