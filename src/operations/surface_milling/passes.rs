//! The passes: sections of the offset as chains of arcs and lines with a proved deviation.

use std::sync::atomic::{AtomicUsize, Ordering};

use nalgebra::Point3;

use super::planes::Slicer;
use super::{CutDirection, Error, Interpolation, Job};
use crate::budget::Budget;
use crate::geometry::arc_fit::{Fit, FitError, Joints, Shapes, fit_in_space};
use crate::geometry::curve::Curve;
use crate::geometry::section::{Chain, PlaneAt, Spacing, chord_height};
use crate::operations::sharing::in_order;
use crate::toolpath::PathError;
use crate::toolpath::quantize::{Grid, Parabolas, round};

/// CL points of one job; a path of ten kilometres has some of the order.
const CL_POINT_LIMIT: usize = 20_000_000;

/// Arcs and lines of one job; as a program they are some thirty megabytes.
const CURVE_LIMIT: usize = 1_000_000;

/// What rounding the ends and centre of an arc usually takes, in steps of the last decimal.
const ROUNDING_STEPS: f64 = 0.8;

/// How exactly a tip lies on its section, mm.
const ACCURACY_MM: f64 = 2e-10;

/// Rounding of a distance in parts of the coordinates.
const ROUNDING: f64 = 1e-14;

/// Arcs that leave a chord by so many times as much as the section does are none of the section.
const BULGE: f64 = 20.0;

/// Refinements of one section before the tolerance counts as not reachable.
const REFINEMENT_LIMIT: usize = 12;

/// One connected chain of cuts, in the direction of travel.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct CutPass {
    pub(super) curves: Vec<Curve>,
    pub(super) n_points: usize,
    /// Proved distance between the exact CL curve and the curves, as computed and as written, mm.
    pub(super) deviation_mm: f64,
}

impl CutPass {
    pub(super) fn start(&self) -> Point3<f64> {
        self.curves[0].start()
    }
}

/// What the exact CL curve may do where patches join that are smooth but for the rounding of their data.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seam {
    /// It jumps by this at most, mm.
    pub(super) jump: f64,
    /// It leaves a chord across the joint by this part of the chord at most: a quarter of the angle in which it bends.
    pub(super) bend: f64,
}

impl Seam {
    /// The CL curve is the exact one everywhere.
    pub(super) const NONE: Self = Self { jump: 0.0, bend: 0.0 };
}

/// What every pass is held to, mm.
#[derive(Debug, Clone, Copy)]
pub(super) struct Allowed {
    /// Each pass deviates by at most this.
    pub(super) tolerance: f64,
    /// What the rounding of the data makes of joints.
    pub(super) seam: Seam,
    /// The part of the tolerance that the section may take between its points. Smaller parts cost points, larger ones arcs, whose
    /// number falls only with the cube root of what is left.
    pub(super) chord_height_share: f64,
}

/// All passes in the order of cutting.
pub(super) fn cut(
    job: &Job,
    slicer: &Slicer,
    planes: &[PlaneAt],
    allowed: Allowed,
    budget: &Budget,
) -> Result<Vec<CutPass>, Error> {
    let (done, n_points, n_curves) = (AtomicUsize::new(0), AtomicUsize::new(0), AtomicUsize::new(0));
    let cut_one = |k: usize| -> Result<Vec<CutPass>, Error> {
        budget.check()?;
        let forward = job.direction == CutDirection::OneWay || k.is_multiple_of(2);
        let passes = cut_plane(job, slicer, planes[k], forward, allowed, budget)?;
        let count = |what, counter: &AtomicUsize, more: usize, limit| {
            let before = counter.fetch_add(more, Ordering::Relaxed);
            let needed = limit + 1;
            if before + more > limit { Err(Error::TooMuchWork { what, needed, limit }) } else { Ok(()) }
        };
        count("CL points", &n_points, passes.iter().map(|pass| pass.n_points).sum(), CL_POINT_LIMIT)?;
        count("arcs and lines", &n_curves, passes.iter().map(|pass| pass.curves.len()).sum(), CURVE_LIMIT)?;
        budget.progress("sections", done.fetch_add(1, Ordering::Relaxed), planes.len());
        Ok(passes)
    };
    let passes: Vec<CutPass> = in_order(planes.len(), cut_one)?.into_iter().flatten().collect();
    if passes.is_empty() { Err(Error::NothingToCut) } else { Ok(passes) }
}

/// The passes of one plane, in the direction of travel.
fn cut_plane(
    job: &Job,
    slicer: &Slicer,
    plane: PlaneAt,
    forward: bool,
    Allowed { tolerance, seam, chord_height_share }: Allowed,
    budget: &Budget,
) -> Result<Vec<CutPass>, Error> {
    let mut spacing = Spacing {
        chord_height_mm: chord_height_share * tolerance,
        // Short enough that a seam under a chord takes no more than the section's own height.
        step_length_mm: job
            .step_length_mm
            .unwrap_or(f64::INFINITY)
            .min(chord_height_share * tolerance / seam.bend),
    };
    let mut fit_tolerance =
        tolerance - ROUNDING_STEPS * job.resolution.step_mm() - 2.0 * spacing.chord_height_mm;
    fit_tolerance = fit_tolerance.max(0.1 * tolerance);
    // What is shorter would vanish in rounding.
    let shortest = 2.0 * job.resolution.step_mm();
    let mut worst = (0.0, Point3::origin());
    for _ in 0..REFINEMENT_LIMIT {
        let mut chains = slicer.chains(plane, spacing, budget)?;
        chains.retain(|chain| chain.length() > shortest);
        orient(&mut chains, 1 - job.plane.normal_axis(), forward);
        let passes: Result<Vec<_>, Error> =
            chains.iter().map(|chain| fit(job, chain, plane.at, fit_tolerance, seam, budget)).collect();
        let passes = passes?;
        worst = (0.0, Point3::origin());
        for pass in &passes {
            if pass.deviation_mm > worst.0 {
                worst = (pass.deviation_mm, pass.start());
            }
        }
        if worst.0 <= tolerance {
            return Ok(passes);
        }
        fit_tolerance = (fit_tolerance - 1.1 * (worst.0 - tolerance)).max(0.5 * fit_tolerance);
        spacing.chord_height_mm *= 0.5;
    }
    Err(Error::ToleranceNotReached { tolerance_mm: job.tolerance.mm(), deviation_mm: worst.0, at: worst.1 })
}

/// Turns the chains into the direction of travel along the coordinate `axis` and sorts them by where they start.
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

/// Joins the CL points of a section by arcs and lines in the plane at `at` mm, and proves how far these leave
/// the section, which may bend and jump at seams.
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
    // The points are exact: elements meet on them, and growing leaves no more than one in five hundred to a search for the fewest.
    let request = Fit { shapes, joints: Joints::OnPoints, effort: 0, ..Fit::within(fit_tolerance) };
    let mut pass = CutPass { curves: Vec::new(), n_points: tips.len(), deviation_mm: 0.0 };
    // Ranges of points that are open, the first on top.
    let mut open = vec![[0, tips.len() - 1]];
    while let Some([first, last]) = open.pop() {
        let pieces = match fit_in_space(&flat[first..=last], Some(plane), &request, budget) {
            Ok(pieces) => pieces,
            Err(FitError::Stopped(stopped)) => return Err(stopped.into()),
            Err(FitError::Arc(error)) => return Err(PathError::from(error).into()),
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
            let deviation = deviation(job, &piece.curve, &tips[start..=end], chain.chord_height_mm, seam)?;
            pass.deviation_mm = pass.deviation_mm.max(deviation);
            pass.curves.push(piece.curve);
            start = end;
        }
    }
    if pass.curves.is_empty() { Err(Error::NothingToCut) } else { Ok(pass) }
}

/// The longest chord of the tips, where an arc leaves it by more than the section may: an upright wall, or as good as one, that knows no
/// points between its ends.
fn wall_under_arc(curve: &Curve, tips: &[Point3<f64>], section_height: f64) -> Option<usize> {
    let Curve::Arc(arc) = curve else { return None };
    let chord = |k: &usize| (tips[k + 1] - tips[*k]).norm();
    let longest = (0..tips.len() - 1).max_by(|a, b| chord(a).total_cmp(&chord(b)))?;
    let is_wall = chord_height(chord(&longest), 1.0 / arc.radius()) > BULGE * section_height;
    (is_wall && tips.len() > 2).then_some(longest)
}

/// Bounds the distance, both ways, between the CL curve through `tips` and `curve`, as computed and as
/// written.
///
/// Between neighbouring tips the CL curve leaves their chord by at most `section_height`, and what `seam` adds. A
/// point of the chord is as far from a line as its ends, and from an arc, which lies as far away as the tips at
/// most, by the height of the chord under that arc more. Ends correspond to ends, and arcs go round their centres
/// as the tips do, so the nearest points of a path that stays in so narrow a band run over all of the other: the
/// bound holds both ways. What is written in several pieces is bounded by its displacement from `curve`.
fn deviation(
    job: &Job,
    curve: &Curve,
    tips: &[Point3<f64>],
    section_height: f64,
    seam: Seam,
) -> Result<f64, Error> {
    let chord = tips.windows(2).map(|pair| (pair[1] - pair[0]).norm()).fold(0.0, f64::max);
    let section_height = section_height + seam.jump + seam.bend * chord;
    let bound = |curve: &Curve| {
        let farthest = tips.iter().map(|tip| curve.distance_to(tip)).fold(0.0, f64::max);
        let under = |radius: f64| chord_height(chord, 1.0 / (radius - farthest).max(0.0));
        let arc_height = match curve {
            Curve::Line(_) => 0.0,
            Curve::Arc(arc) => under(arc.radius()),
            Curve::Parabola(parabola) => under(1.0 / parabola.largest_curvature()),
        };
        farthest + arc_height + section_height + ACCURACY_MM + ROUNDING * tips[0].coords.amax()
    };
    let computed = bound(curve);
    let rounded = round(curve, job.resolution, Parabolas::AsLines)?;
    let written = match &rounded.curves[..] {
        // The element vanishes on the grid; what remains is its length, and half a step each way.
        [] => curve.length() + job.resolution.step_mm(),
        [only] => bound(&only.curve) + only.slack_mm,
        _ => computed + rounded.displacement_mm,
    };
    let grid = Grid::new(job.resolution);
    let mut deviation = computed.max(written);
    for end in [tips[0], tips[tips.len() - 1]] {
        deviation = deviation.max((grid.point(grid.round(&end)?) - end).norm());
    }
    Ok(deviation)
}
