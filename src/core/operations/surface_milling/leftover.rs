//! What the passes of a job leave on its surface, and the stepover that leaves no more than is asked for.
//!
//! # Method
//! 1. Estimate the stepover from the slopes of the surface (`scallop`), and cut the passes.
//! 2. Bound what they leave ([`uncut`]). Where this is more than the height that is asked for, choose a
//!    smaller stepover: what is left is taken for a power of the stepover, first for its square.
//! 3. Repeat this at most [`TRIALS`] times. A height that is not reached then is refused, with the least
//!    height that was proved.

use nalgebra::Point3;

use super::passes::CutPass;
use super::rest::Positions;
use super::{Error, Job, Spacing, Warning, scallop};
use crate::budget::Budget;
use crate::geometry::surface::{BezierSurface, Patch};
use crate::machining::regularity::Slope;
use crate::machining::uncut::{self, Left, Leftover, Swept, Wanted};
use crate::toolpath::quantize::round;

/// By how much the bound may exceed what was found, as a share of it and as a share of the tolerance. A
/// smaller gap takes more time, as its logarithm; a larger one states more than is left.
const GAP_SHARE: f64 = 0.08;
const GAP_TOLERANCE_SHARE: f64 = 0.01;

/// Parts smaller than this share of the gap are not halved: they count as points.
const SMALLEST_SHARE: f64 = 0.1;

/// The most parts of the search, and the most for each square of the stepover along the passes.
const PARTS: usize = 40_000;
const PARTS_EACH: f64 = 20.0;

/// The most squares that count. A part of no width has passes at no distance, and squares without end.
const MOST_SQUARES: f64 = 1e6;

/// The share of the asked height by which passes may deviate: what they leave varies by as much.
const DEVIATION_SHARE: f64 = 0.25;

/// The least deviation that is asked of passes, in steps of the last decimal: rounding alone takes 1.5.
const LEAST_DEVIATION_STEPS: f64 = 3.0;

/// The most stepovers that are tried for a height.
const TRIALS: usize = 5;

/// The first guess of the power with which the height grows with the stepover, and the least and the largest.
const POWER: f64 = 2.0;
const POWERS: [f64; 2] = [0.5, 2.5];

/// The share of the height that the next stepover is chosen for, and the least and the largest share of a
/// stepover that the next one is.
const AIM: f64 = 0.96;
const NARROWED: [f64; 2] = [0.25, 0.95];

/// A stepover that leaves more than this share of what a larger one left shows that the stepover does not
/// matter.
const NO_BETTER: f64 = 0.9;

/// A strip is left where the passes leave this many times what neighbouring passes should, and the tolerance
/// more.
const STRIP: f64 = 2.0;

/// The part of a job that is to be milled, and where the cutter may go.
pub(super) struct Material<'a, P> {
    pub(super) part: &'a BezierSurface<P>,
    pub(super) positions: Positions<'a, P>,
}

impl<P: Patch> Material<'_, P> {
    /// What passes `stepover_mm` apart leave, as computed and as the program states them.
    pub(super) fn left(
        &self,
        job: &Job,
        passes: &[CutPass],
        stepover_mm: f64,
        budget: &Budget,
    ) -> Result<Left, Error> {
        let mut slack = 0.0f64;
        for curve in passes.iter().flat_map(|pass| &pass.curves) {
            slack = slack.max(round(curve, job.resolution, &job.curves)?.displacement_mm);
        }
        let gap_mm = GAP_TOLERANCE_SHARE * job.tolerance.mm();
        let curves = passes.iter().map(|pass| pass.curves.as_slice());
        let swept = Swept::new(&job.tool.cutter(), job.allowance_mm, curves, slack, gap_mm);
        let length: f64 = passes.iter().flat_map(|pass| &pass.curves).map(|curve| curve.length()).sum();
        let wanted = Wanted {
            gap_share: GAP_SHARE,
            gap_mm,
            target_mm: asked(job),
            grain_mm: stepover_mm,
            smallest_mm: SMALLEST_SHARE * gap_mm,
            part_limit: PARTS + (PARTS_EACH * (length / stepover_mm).min(MOST_SQUARES)) as usize,
        };
        Ok(uncut::left(self.part, &[swept], &self.positions, wanted, budget)?)
    }
}

/// The height asked for, mm.
fn asked(job: &Job) -> Option<f64> {
    match job.spacing {
        Spacing::ScallopHeight(mm) => Some(mm),
        Spacing::Stepover(_) | Spacing::WirePitch(_) => None,
    }
}

/// The share of the tolerance by which passes may deviate so that the height can be met.
pub(super) fn deviation_share(job: &Job) -> f64 {
    let Some(asked) = asked(job) else { return 1.0 };
    let least = LEAST_DEVIATION_STEPS * job.resolution.step_mm();
    ((DEVIATION_SHARE * asked).max(least) / job.tolerance.mm()).min(1.0)
}

/// The stepovers that were tried for a job, with what they left, mm.
pub(super) struct Stepovers {
    asked: Option<f64>,
    next: f64,
    tried: Vec<[f64; 2]>,
}

impl Stepovers {
    pub(super) fn new(job: &Job, slopes: &[Slope]) -> Self {
        let cutter = job.tool.cutter();
        let next = match (job.spacing, cutter.corner_radius()) {
            (Spacing::Stepover(mm) | Spacing::WirePitch(mm), _) => mm,
            (Spacing::ScallopHeight(mm), 0.0) => scallop::spacing_of_flat_ends(cutter.radius(), mm, slopes),
            (Spacing::ScallopHeight(mm), corner) => {
                // Rounding takes a part of the height.
                let rounding = job.resolution.step_mm().min(0.1 * mm);
                scallop::spacing(corner, mm - rounding, slopes)
            }
        };
        Self { asked: asked(job), next, tried: Vec::new() }
    }

    /// The stepover to be tried next, mm.
    pub(super) fn next(&self) -> f64 {
        self.next
    }

    /// Whether `left` at `stepover_mm` is no more than was asked for. Chooses the next stepover if it is
    /// more.
    ///
    /// # Errors
    /// When no stepover is expected to meet the height.
    pub(super) fn is_met(&mut self, stepover_mm: f64, left: &Leftover) -> Result<bool, Error> {
        let Some(asked) = self.asked.filter(|asked| left.bound_mm > *asked) else { return Ok(true) };
        let before = self.tried.last().copied();
        self.tried.push([stepover_mm, left.bound_mm]);
        let is_no_better = before.is_some_and(|[_, more]| left.bound_mm > NO_BETTER * more);
        if self.tried.len() >= TRIALS || is_no_better || !left.bound_mm.is_finite() {
            return Err(self.refused(left.at));
        }
        let power =
            before.map_or(POWER, |[wider, more]| (more / left.bound_mm).ln() / (wider / stepover_mm).ln());
        let power = if power.is_finite() { power.clamp(POWERS[0], POWERS[1]) } else { POWERS[0] };
        let narrowed = (AIM * asked / left.bound_mm).powf(1.0 / power);
        self.next = stepover_mm * narrowed.clamp(NARROWED[0], NARROWED[1]);
        Ok(false)
    }

    /// The error of passes that cannot be cut for the next stepover, if a wider one was cut.
    pub(super) fn or_refused(&self, error: Error) -> Error {
        match error {
            Error::TooMuchWork { .. } | Error::TooManyPoints { .. } | Error::Path(_)
                if !self.tried.is_empty() =>
            {
                self.refused(None)
            }
            error => error,
        }
    }

    fn refused(&self, at: Option<Point3<f64>>) -> Error {
        let least_mm = self.tried.iter().map(|[_, left]| *left).fold(f64::INFINITY, f64::min);
        Error::ScallopNotReached { asked_mm: self.asked.unwrap_or(0.0), least_mm, at }
    }
}

/// What a caller should know of what is left.
pub(super) fn warnings(job: &Job, left: &Left, stepover_mm: f64, slopes: &[Slope]) -> Vec<Warning> {
    let mut warnings = Vec::new();
    let most = job.tolerance.mm();
    if let (Some(at), true) = (left.rest.place(), left.rest.bound_mm > most) {
        warnings.push(Warning::RestLeft { depth_mm: left.rest.bound_mm, at });
    }
    let strip = STRIP * height_between(job, stepover_mm, slopes) + most;
    if let (Some(at), true) = (left.reached.place(), left.reached.bound_mm > strip) {
        warnings.push(Warning::StripLeft { depth_mm: left.reached.bound_mm, at });
    }
    warnings
}

/// What neighbouring passes should leave between them, mm.
fn height_between(job: &Job, stepover_mm: f64, slopes: &[Slope]) -> f64 {
    let corner = job.tool.cutter().corner_radius();
    if corner == 0.0 {
        return stepover_mm;
    }
    let level = [Slope { share: 1.0, concavity: 0.0 }];
    let height = |slopes: &[Slope]| scallop::height(corner, stepover_mm, slopes);
    height(slopes).or_else(|| height(&level)).unwrap_or(corner)
}

#[cfg(test)]
mod tests;
