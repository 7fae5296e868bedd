//! Plans a roughing path above the wires of a surface, after Koo et al. Above each wire, the path is as high
//! as the highest wire within the cutter's radius.
//!
//! # Method
//! 1. Cut the surface by planes of constant y at equal distances, at most the pitch apart. The section in
//!    each plane is a wire. Where the surface overhangs, the wire is the highest part of the section
//!    (`upper_envelope`).
//! 2. For each wire and each x, take the largest z of the wire itself and of its neighbours within the
//!    cutter's radius. The next wire on each side counts in any case. As a function of x, this largest z is
//!    the *union* of the wire. The allowance of the job is added to the radius and to z.
//! 3. Move the tip along each union on lines. A rapid leads from the end of one union to the start of the
//!    next.
//! 4. Bound how deep the cutter cuts into the surface ([`gouge`](crate::machining::gouge)).
//!
//! # Guarantees
//! * `deviation_max_mm` bounds the distance of every point of the path from the exact unions, and of every
//!   point of the exact unions from the path. It holds for the path as computed and as the program states it,
//!   and is at most the tolerance. Slots of the surface may be missing from the unions if they are narrower
//!   than 2 % of the tolerance.
//! * **The path gouges**, because the unions are not offset in the direction of x: where a wire has the slope
//!   angle a, a ball cutter of radius R cuts R (1 - cos a) deep. `gouge_max_mm` bounds the depth of all
//!   gouges, and the answer warns of it.
//!
//! # Cost
//! O(n log n) for n stretches of wires, plus the cost of the gouge bound.
//!
//! # Reference
//! Y. H. Koo, D. J. Lee, S. Namgung, M. S. Kang, "A Study on the Construction of CAD/CAM System for Machining
//! of Sculptured Surface of Die", 1989, section 4.1.

mod wires;

use nalgebra::Point3;

use super::deviation::Deviation;
use super::passes::{self, CutPass};
use super::{
    CERTIFICATE_GAP, Error, Job, Plan, Report, TOP_ACCURACY_MM, Warning, certificate, counts, data_warnings,
};
use crate::budget::Budget;
use crate::geometry::arc_fit::{Fit, FitError, Joints, Shapes, fit_in_space};
use crate::geometry::curve::{Curve, Line};
use crate::geometry::following;
use crate::geometry::plane::Plane;
use crate::geometry::spacing::spaces;
use crate::geometry::surface::{BezierSurface, Patch};
use crate::machining::gouge::{GougeProof, Penetration};
use crate::machining::upper_envelope::{Accuracy, EnvelopeError, Stretch, UpperEnvelope, union};
use crate::toolpath::cutting::Cutting;
use crate::toolpath::linking::at_height;
use crate::toolpath::quantize::round;
use crate::toolpath::{PathError, Role, Toolpath};
use wires::WireModel;

/// The share of the tolerance that wires may take as height over the chords of their points. It is small
/// because points cost little; more tolerance left over saves lines of the program.
const HEIGHT_SHARE: f64 = 0.1;

/// The share of the tolerance by which vertical walls may be out of place.
const WIDTH_SHARE: f64 = 0.02;

/// The most stretches of wires that all passes of a job may compare: half a minute of work, or more.
pub const MOST_COMPARED: usize = 500_000_000;

/// Lines between two checks of the budget.
const PARTS_BETWEEN_CHECKS: usize = 256;

/// Search budget for the fewest lines: evaluations for each point.
const EFFORT: usize = 600;

/// Depths up to this are reported as zero, mm. The certificate counts its own rounding, and contacts are
/// accurate to 1e-9 mm.
const LEAST_DEPTH_MM: f64 = 1e-8;

/// The accuracy with which an envelope is made from its stretches, mm.
const SKYLINE_ACCURACY_MM: f64 = 2e-7;

/// A wire exactly at the radius counts although its place is rounded; this is the margin, in pitches.
const PITCH_ROUNDING: f64 = 1e-9;

impl From<EnvelopeError> for Error {
    fn from(error: EnvelopeError) -> Self {
        match error {
            EnvelopeError::Stopped(stopped) => Self::Stopped(stopped),
            EnvelopeError::Lost { at } => Self::SectionLost { at },
        }
    }
}

/// Plans the roughing path along the union.
///
/// # Errors
/// One of [`Error`]. A path that gouges is not an error.
pub(super) fn plan<P: Patch>(
    surface: &BezierSurface<P>,
    job: &Job,
    pitch_mm: f64,
    budget: &Budget,
) -> Result<Plan, Error> {
    let cutting = job.cutting.above(job.top(surface.top(TOP_ACCURACY_MM, budget)?))?;
    let tolerance = job.tolerance.mm();
    let accuracy = Accuracy { height_mm: HEIGHT_SHARE * tolerance, width_mm: WIDTH_SHARE * tolerance };
    let model = WireModel::new(surface, pitch_mm, job.plane_limit, accuracy, budget)?;
    let passes = passes(job, &model, accuracy, budget)?;
    let toolpath = one_way(&cutting, &passes, job.move_limit)?;
    let gap = CERTIFICATE_GAP * tolerance;
    let proof = GougeProof::new(surface, &job.tool.cutter(), 0.0);
    let moves = certificate::curves(&toolpath);
    let search = certificate::Search::new(&proof, job, [gap, f64::INFINITY], moves.len(), budget);
    let deepest = search.deepest(Penetration::NONE, &moves)?;
    let report = Report {
        n_passes: passes.len(),
        n_cl_points: passes.iter().map(|pass| pass.n_points).sum(),
        stepover_mm: model.pitch_mm,
        deviation_max_mm: passes.iter().map(|pass| pass.deviation.bound_mm).fold(0.0, f64::max),
        gouge_max_mm: if deepest.bound_mm > LEAST_DEPTH_MM { deepest.bound_mm } else { 0.0 },
        gouge_at: deepest.at,
        scallop_max_mm: None,
        scallop_at: None,
        rest_max_mm: None,
        rest_at: None,
        n_arcs: 0,
        n_lines: passes.iter().map(|pass| pass.curves.len()).sum(),
        elements_per_pass: counts::elements(&passes),
    };
    let warnings = warnings(job, &report);
    Ok(Plan { toolpath, deviations_mm: passes::deviations_mm(&passes), report, cutting, warnings })
}

fn warnings(job: &Job, report: &Report) -> Vec<Warning> {
    let mut warnings = data_warnings(job);
    if report.gouge_max_mm > 0.0 {
        warnings.push(Warning::RoughingPathGouges { depth_mm: report.gouge_max_mm });
    }
    warnings
}

/// The number of wires on each side over which a path passes at least as high: all wires within the reach,
/// and at least one.
///
/// The paper shifts the wires by "the wire pitch that corresponds to the tool radius". It says that the
/// neighbouring wires protect the part while the cutter's diameter is at most twice the pitch. For such
/// diameters the rule here is the paper's. For larger diameters it protects the part as well. The pitch here
/// is the distance of the planes that are cut. It may be a little less than the requested pitch.
fn neighbours(reach_mm: f64, pitch_mm: f64) -> usize {
    ((reach_mm / pitch_mm + PITCH_ROUNDING).floor() as usize).max(1)
}

/// Refuses passes that compare more stretches of wires than [`MOST_COMPARED`]: each pass compares all
/// stretches of the wires within its reach.
fn check_comparisons(model: &WireModel, reach: usize) -> Result<(), Error> {
    let n = model.wires.len();
    let mut before = vec![0; n + 1];
    for (k, wire) in model.wires.iter().enumerate() {
        before[k + 1] = before[k] + wire.stretches.len();
    }
    let of_pass = |k: usize| before[k.saturating_add(reach).min(n - 1) + 1] - before[k.saturating_sub(reach)];
    let needed = (0..n).map(of_pass).sum();
    if needed > MOST_COMPARED {
        let what = "comparisons of stretches of wires";
        return Err(Error::TooMuchWork { what, needed, limit: MOST_COMPARED });
    }
    Ok(())
}

/// The passes over every wire.
fn passes(job: &Job, model: &WireModel, accuracy: Accuracy, budget: &Budget) -> Result<Vec<CutPass>, Error> {
    let reach = neighbours(job.offset_mm(), model.pitch_mm);
    check_comparisons(model, reach)?;
    let mut passes = Vec::new();
    let mut n_lines = 0;
    for k in 0..model.wires.len() {
        budget.check()?;
        budget.progress("wires", k, model.wires.len());
        let last = k.saturating_add(reach).min(model.wires.len() - 1);
        let near: Vec<Stretch> = model.wires[k.saturating_sub(reach)..=last]
            .iter()
            .flat_map(|wire| &wire.stretches)
            .copied()
            .collect();
        for envelope in union(&near, accuracy.width_mm, budget)? {
            let Some(pass) =
                pass(job, &envelope, model.wires[k].at, accuracy, job.move_limit - n_lines, budget)?
            else {
                continue;
            };
            n_lines += pass.curves.len();
            passes.push(pass);
        }
    }
    if passes.is_empty() { Err(Error::NothingToCut) } else { Ok(passes) }
}

/// The pass along an envelope in the plane at `y` mm, of at most `room` lines; `None` if it would vanish in
/// rounding.
///
/// For an allowance the paper takes a larger cutter. Here the wires within the radius plus the allowance
/// count, and the path is lifted by the allowance. So level places keep the allowance.
fn pass(
    job: &Job,
    envelope: &UpperEnvelope,
    y: f64,
    accuracy: Accuracy,
    room: usize,
    budget: &Budget,
) -> Result<Option<CutPass>, Error> {
    let step = job.resolution.step_mm();
    let tips: Vec<Point3<f64>> =
        envelope.iter().map(|point| Point3::new(point.x, y, point.y + job.allowance_mm)).collect();
    let length: f64 = tips.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
    if length <= 2.0 * step {
        return Ok(None);
    }
    let known = accuracy.height_mm.hypot(accuracy.width_mm) + SKYLINE_ACCURACY_MM;
    // Rounding moves an end by at most half a step along each axis.
    let rounding = 0.5 * 3f64.sqrt() * step;
    let fit_tolerance = job.tolerance.mm() - known - rounding - SKYLINE_ACCURACY_MM;
    let request = Fit {
        shapes: Shapes::LinesOnly,
        joints: Joints::OnPoints,
        effort: EFFORT,
        ..Fit::within(fit_tolerance)
    };
    let pieces = match fit_in_space(&tips, Some(Plane::Zx), &request, budget) {
        Ok(pieces) => pieces.curves,
        Err(FitError::Stopped(stopped)) => return Err(stopped.into()),
        Err(FitError::OnePlace) => return Ok(None),
    };
    let mut deviations_mm = Vec::with_capacity(pieces.len());
    let mut curves = Vec::with_capacity(pieces.len());
    let mut start = 0;
    for piece in pieces {
        // A line passes its tips in order, so that it is as near to the lines between them.
        let off = following::from_points(&piece.curve, &tips[start..=piece.end]);
        let line = Line { start: piece.curve.start(), end: piece.curve.end() };
        let n_parts = n_parts(&line, job.step_length_mm);
        if curves.len() as f64 + n_parts > room as f64 {
            return Err(PathError::TooManyMoves { limit: job.move_limit }.into());
        }
        for (k, part) in divided(&line, n_parts).enumerate() {
            if k.is_multiple_of(PARTS_BETWEEN_CHECKS) {
                budget.check()?;
            }
            let written = round(&part, job.resolution, &job.curves)?;
            deviations_mm.push(off + written.displacement_mm + known);
            curves.push(part);
        }
        start = piece.end;
    }
    let deviation_mm = deviations_mm.iter().copied().fold(0.0, f64::max);
    if deviation_mm > job.tolerance.mm() {
        return Err(Error::ToleranceNotReached {
            tolerance_mm: job.tolerance.mm(),
            deviation_mm,
            at: tips[0],
        });
    }
    let deviation = Deviation::within(deviation_mm);
    Ok(Some(CutPass { n_points: curves.len() + 1, curves, deviation, deviations_mm }))
}

/// The number of equal parts of a line that are no longer than `longest_mm`.
fn n_parts(line: &Line, longest_mm: Option<f64>) -> f64 {
    longest_mm.map_or(1.0, |longest| spaces(line.length(), longest))
}

/// The line in `n` equal parts.
fn divided(line: &Line, n: f64) -> impl Iterator<Item = Curve> {
    let Line { start, end } = *line;
    let at = move |k: f64| if k == n { end } else { start + (end - start) * (k / n) };
    (0..n as usize).map(move |k| Curve::Line(Line { start: at(k as f64), end: at(k as f64 + 1.0) }))
}

/// The toolpath from the clearance plane over the first pass to the clearance plane over the last.
fn one_way(cutting: &Cutting, passes: &[CutPass], move_limit: usize) -> Result<Toolpath, Error> {
    let start = at_height(passes[0].start(), cutting.clearance_z_mm);
    let mut builder = Toolpath::builder(start).with_limit(move_limit);
    for pass in passes {
        builder.begin_pass(None);
        builder.rapid_over(pass.start(), cutting.clearance_z_mm, cutting.retract_z_mm)?;
        builder.line(pass.start(), cutting.feed_of(Role::Plunge), Role::Plunge)?;
        for curve in &pass.curves {
            builder.line(curve.end(), cutting.feed, Role::Cut)?;
        }
    }
    builder.rapid_to_height(cutting.clearance_z_mm)?;
    Ok(builder.finish()?)
}

#[cfg(test)]
mod tests;
