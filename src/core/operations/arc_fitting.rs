//! Fits arcs and lines to a polyline, and makes a toolpath of them.
//!
//! # Method
//! 1. Fit curves to the points of the polyline ([`arc_fit`](crate::geometry::arc_fit)). Arcs lie in the
//!    requested plane. Without a requested plane, they lie in the plane of the points.
//! 2. Measure the deviation of each fitted curve again, by separate code ([`following`]). If rounding lets it
//!    exceed the tolerance, fit again within a slightly smaller tolerance. If it still exceeds the tolerance,
//!    replace the curve by lines through its points. Biarcs are not replaced.
//! 3. Make a toolpath of the curves. Round the curves to the decimals of the program, and bound the deviation
//!    of the rounded curves as well.
//!
//! # Guarantees
//! * `deviation_max_mm` bounds the deviation of the curves before they are rounded to decimals. By the
//!   measure `points`, the deviation is the distance of the points from the curves, with both taken in the
//!   order of travel. By the measure `polyline`, it is the largest distance of a point of the curves from the
//!   polyline, or of a point of the polyline from the curves.
//! * The deviation is at most the tolerance. Only biarcs may exceed the tolerance; a warning then says so.
//! * Arcs are no larger than those that the control runs ([`Curves::largest_radius_mm`]), apart from smooth
//!   chains and biarcs. A warning says where the limit costs elements.
//!
//! # Degenerate input
//! Points that are all the same are refused.
//!
//! # Cost
//! The cost is that of the fit.
//!
//! # Reference
//! S. Y. Ju, "CL-Cartesian Machining along Approximated Circular Arcs", sections 4 and 5.

mod large_arcs;

use nalgebra::Point3;

use crate::budget::{Budget, Stopped};
use crate::geometry::arc_fit::{
    Continuity, Fit, FitError, FittedCurve, Measure, Method, NotProved, fit_in_space,
};
use crate::geometry::curve::{Curve, Line};
use crate::geometry::following;
use crate::geometry::plane::Plane;
use crate::toolpath::contour::{TOP_MM, contour};
use crate::toolpath::cutting::{Cutting, CuttingRequest, HeightError};
use crate::toolpath::program::{Resolution, Units};
use crate::toolpath::quantize::{Curves, QuantizeError, round};
use crate::toolpath::units::rounded_up;
use crate::toolpath::{PathError, Toolpath};

/// Curves between two checks of the budget.
const CURVES_BETWEEN_CHECKS: usize = 1024;

/// Samples count as coarse if the lines between them lie more than this many tolerances from the curves.
const COARSE_TOLERANCES: f64 = 2.0;

/// Rounding of a deviation: a share of the tolerance, and mm. A second fit keeps a tolerance smaller by this,
/// and a warning waits for a deviation larger by this. The measured deviation is a bound whose excess is 1e-7
/// of itself.
const ROUNDING: f64 = 1e-6;
const ROUNDING_MM: f64 = 1e-9;

/// The largest share of the tolerance by which the second fit is closer.
const LARGEST_ROUNDING: f64 = 0.01;

/// The least angle that counts as a kink, degrees; smaller angles come from rounding.
const KINK_DEG: f64 = 0.01;

#[derive(Debug, Clone)]
pub struct Job {
    /// At least two points, mm. On a closed path the first point need not be repeated at the end.
    pub points: Vec<Point3<f64>>,
    /// The plane of the arcs; `None` for the plane of the points.
    pub plane: Option<Plane>,
    pub fit: Fit,
    /// The cutting conditions; without them the toolpath has no feeds.
    pub cutting: Option<CuttingRequest>,
    pub resolution: Resolution,
    /// What the control of the written program runs. The report counts what rounding does to it.
    pub curves: Curves,
}

impl Job {
    /// The job with the default of everything that has one, written in mm with three decimals for a control
    /// that runs all arcs.
    pub fn new(points: Vec<Point3<f64>>, tolerance_mm: f64) -> Self {
        let resolution = Resolution { units: Units::Mm, decimals: 3 };
        let fit = Fit::within(tolerance_mm);
        Self { points, plane: None, fit, cutting: None, resolution, curves: Curves::ARCS }
    }
}

/// What the elements are like, with the proved distances.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, utoipa::ToSchema), schema(as = FitReport))]
pub struct Report {
    /// Number of points, coincident neighbours counted once.
    pub n_points: usize,
    /// Number of arcs.
    pub n_arcs: usize,
    /// Number of lines.
    pub n_lines: usize,
    /// Why it is not proved that no chain whose elements meet on points has fewer elements. `windows`: there
    /// are more than 10,000 points, and up to 10,000 are searched at once. `search_ended`: the search was too
    /// long and ended, or rounding replaced an element. `in_space`: not all points have the same x, the same
    /// y or the same z. Absent where it is proved, and with `method: greedy`, `method: biarc` and
    /// `continuity: tangent`, which prove nothing.
    #[cfg_attr(feature = "wire", serde(skip_serializing_if = "Option::is_none"))]
    pub fewest_not_proved: Option<NotProved>,
    /// Largest distance of the points from the elements, in mm. With `measure: polyline` the largest distance
    /// between the elements and the lines between the points, measured from each to the other.
    pub deviation_max_mm: f64,
    /// Proved upper bound of `deviation_max_mm` for the elements as the program has them, rounded to its
    /// decimals, in mm.
    pub deviation_written_max_mm: f64,
    /// Largest angle at which neighbouring elements meet, in degrees.
    pub kink_max_deg: f64,
    /// Number of joints with an angle above 0.01 degrees. With `continuity: tangent` these are the real
    /// corners.
    pub n_kinks: usize,
    /// Length of the elements, in mm.
    pub length_mm: f64,
    /// Length divided by the feed, in s. Absent without `cutting`.
    #[cfg_attr(feature = "wire", serde(skip_serializing_if = "Option::is_none"))]
    pub cutting_time_s: Option<f64>,
}

/// Something the caller should know that does not stop the job.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Warning {
    #[error("rounding to the program's decimals moves the path up to {:.4} mm from the points, beyond the tolerance", rounded_up(*deviation_mm))]
    RoundingExceedsTolerance { deviation_mm: f64 },
    #[error("the elements are up to {:.4} mm from the straight lines between the points", rounded_up(*deviation_mm))]
    CoarseSamples { deviation_mm: f64 },
    #[error(
        "the control runs arcs up to a radius of {largest_radius_mm} mm: with larger arcs, {n_joints} of the joints would not be needed"
    )]
    RadiusLimited { largest_radius_mm: f64, n_joints: usize },
    #[error("biarcs ignore the tolerance: the elements are up to {:.4} mm from the straight lines between the points", rounded_up(*deviation_mm))]
    ToleranceExceeded { deviation_mm: f64 },
}

#[derive(Debug, Clone)]
pub struct Plan {
    pub toolpath: Toolpath,
    /// For each cutting move of the toolpath, in their order, its deviation, mm.
    pub deviations_mm: Vec<f64>,
    /// The joints of the curves, and both ends of the path.
    pub joints: Vec<Point3<f64>>,
    pub report: Report,
    /// The conditions with every default filled in.
    pub cutting: Option<Cutting>,
    pub warnings: Vec<Warning>,
}

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    #[error("all points coincide; at least two different points are needed")]
    OnePlace,
    #[error(transparent)]
    Heights(#[from] HeightError),
    #[error(transparent)]
    Quantize(#[from] QuantizeError),
    #[error(transparent)]
    Path(#[from] PathError),
}

impl From<FitError> for Error {
    fn from(error: FitError) -> Self {
        match error {
            FitError::Stopped(stopped) => stopped.into(),
            FitError::OnePlace => Self::OnePlace,
        }
    }
}

/// Fits arcs and lines to a polyline.
///
/// # Errors
/// One of [`Error`]; no toolpath is returned with one.
///
/// # Example
/// Points of a closed circle of radius 10 mm become one arc.
///
/// ```
/// use std::f64::consts::TAU;
/// use nalgebra::Point3;
/// use toolpathd_core::budget::Budget;
/// use toolpathd_core::operations::arc_fitting::{Job, plan};
///
/// let angles = (0..100).map(|k| TAU * f64::from(k) / 100.0);
/// let points = angles.map(|t| Point3::new(10.0 * t.cos(), 10.0 * t.sin(), 0.0)).collect();
/// let mut job = Job::new(points, 0.001);
/// job.fit.is_closed = true;
/// let report = plan(&job, &Budget::unlimited()).unwrap().report;
/// assert_eq!((report.n_lines, report.n_arcs), (0, 1));
/// assert!((report.length_mm - 10.0 * TAU).abs() <= 0.001 * TAU);
/// assert!(report.deviation_max_mm <= 0.001);
/// ```
pub fn plan(job: &Job, budget: &Budget) -> Result<Plan, Error> {
    let mut points = job.points.clone();
    if job.fit.is_closed && points.first() != points.last() {
        points.extend(job.points.first());
    }
    let top_mm = points.iter().map(|p| p.z).fold(TOP_MM, f64::max);
    let cutting = job.cutting.map(|cutting| cutting.above(top_mm)).transpose()?;
    budget.progress("fit", 0, 1);
    let largest_radius_mm = job.fit.largest_radius_mm.min(job.curves.largest_radius_mm);
    let fit = Fit { largest_radius_mm, ..job.fit };
    let mut fitted = fit_in_space(&points, job.plane, &fit, budget)?;
    let mut pieces = fitted.curves;
    budget.progress("measure", 0, 1);
    let mut figures = measured(&pieces, &points, job, budget)?;
    if job.fit.method != Method::Biarc {
        // The measured deviation decides.
        if figures.is_far.contains(&true) {
            let rounding =
                (ROUNDING * fit.tolerance_mm + ROUNDING_MM).min(LARGEST_ROUNDING * fit.tolerance_mm);
            let closer = Fit { tolerance_mm: fit.tolerance_mm - rounding, ..fit };
            fitted = fit_in_space(&points, job.plane, &closer, budget)?;
            pieces = fitted.curves;
            figures = measured(&pieces, &points, job, budget)?;
        }
        // Lines replace the curves that exceed the tolerance; if a curve still exceeds it, lines replace all
        // curves.
        for is_far in [|piece: bool| piece, |_| true] {
            if figures.is_far.contains(&true) {
                fitted.not_proved = Some(NotProved::SearchEnded)
                    .filter(|_| fit.method == Method::Optimal && fit.continuity == Continuity::Position);
                pieces = as_lines(&pieces, &points, figures.is_far.iter().map(|piece| is_far(*piece)));
                figures = measured(&pieces, &points, job, budget)?;
            }
        }
    }
    let n_needless = large_arcs::needless_joints(&pieces, &points, job, budget)?;
    let curves: Vec<Curve> = pieces.iter().map(|piece| piece.curve).collect();
    let kinks = kinks(&curves, job.fit.is_closed);
    let length_mm = curves.iter().map(Curve::length).sum();
    let report = Report {
        n_points: job.points.len(),
        n_arcs: curves.iter().filter(|curve| matches!(curve, Curve::Arc(_))).count(),
        n_lines: curves.iter().filter(|curve| matches!(curve, Curve::Line(_))).count(),
        fewest_not_proved: fitted.not_proved,
        deviation_max_mm: figures.deviation_mm,
        deviation_written_max_mm: figures.written_mm,
        kink_max_deg: kinks.iter().copied().fold(0.0, f64::max),
        n_kinks: kinks.iter().filter(|kink| **kink > KINK_DEG).count(),
        length_mm,
        cutting_time_s: cutting.map(|cutting| length_mm / cutting.feed.mm_per_s()),
    };
    let joints = curves.iter().map(Curve::start).chain(curves.last().map(Curve::end)).collect();
    let toolpath = contour(&[curves], top_mm, cutting.as_ref())?;
    let mut warnings = warnings(job, &figures);
    if n_needless > 0 {
        let largest_radius_mm = job.curves.largest_radius_mm;
        warnings.push(Warning::RadiusLimited { largest_radius_mm, n_joints: n_needless });
    }
    Ok(Plan { toolpath, deviations_mm: figures.deviations_mm, joints, warnings, report, cutting })
}

/// Deviations of curves and points, mm.
struct Figures {
    deviation_mm: f64,
    /// Of each curve.
    deviations_mm: Vec<f64>,
    written_mm: f64,
    /// The distance between the curves and the lines between the points, both ways.
    from_lines_mm: f64,
    /// For each curve, whether its deviation exceeds the tolerance.
    is_far: Vec<bool>,
}

/// The chain with lines through the points in place of the chosen curves. If all curves are chosen, the chain
/// passes through every point.
fn as_lines(
    pieces: &[FittedCurve],
    points: &[Point3<f64>],
    chosen: impl Iterator<Item = bool>,
) -> Vec<FittedCurve> {
    let chosen: Vec<bool> = chosen.collect();
    let is_whole = chosen.iter().all(|piece| *piece);
    let mut chain = Vec::new();
    let mut first = 0;
    let mut at = if is_whole { points[0] } else { pieces[0].curve.start() };
    for (piece, is_chosen) in pieces.iter().zip(chosen) {
        if !is_chosen {
            chain.push(*piece);
        } else {
            for (end, point) in points.iter().enumerate().take(piece.end + 1).skip(first + 1) {
                let to = if end == piece.end && !is_whole { piece.curve.end() } else { *point };
                if to != at {
                    chain.push(FittedCurve { end, curve: Curve::Line(Line { start: at, end: to }) });
                    at = to;
                }
            }
        }
        (first, at) = (piece.end, chain.last().map_or(at, |piece| piece.curve.end()));
    }
    chain
}

fn measured(
    pieces: &[FittedCurve],
    points: &[Point3<f64>],
    job: &Job,
    budget: &Budget,
) -> Result<Figures, Error> {
    let mut figures = Figures {
        deviation_mm: 0.0,
        deviations_mm: Vec::with_capacity(pieces.len()),
        written_mm: 0.0,
        from_lines_mm: 0.0,
        is_far: Vec::with_capacity(pieces.len()),
    };
    let mut start = 0;
    for (k, piece) in pieces.iter().enumerate() {
        if k.is_multiple_of(CURVES_BETWEEN_CHECKS) {
            budget.check()?;
        }
        let passed = &points[start..=piece.end];
        let from_lines_mm = match job.fit.method {
            Method::Biarc => beside(&piece.curve, &points[start..(piece.end + 1).max(start + 2)]),
            Method::Greedy | Method::Optimal => following::from_lines(&piece.curve, passed),
        };
        let deviation_mm = match (job.fit.measure, job.fit.method) {
            (Measure::Polyline, _) => from_lines_mm,
            (Measure::Points, Method::Biarc) => 0.0,
            (Measure::Points, _) => following::from_points(&piece.curve, passed),
        };
        let rounded = round(&piece.curve, job.resolution, &job.curves)?;
        figures.is_far.push(deviation_mm > job.fit.tolerance_mm);
        figures.from_lines_mm = figures.from_lines_mm.max(from_lines_mm);
        figures.deviations_mm.push(deviation_mm);
        figures.deviation_mm = figures.deviation_mm.max(deviation_mm);
        figures.written_mm = figures.written_mm.max(deviation_mm + rounded.displacement_mm);
        start = piece.end;
    }
    Ok(figures)
}

/// A bound for the distance of half a biarc from the line between the two points that the biarc joins, mm. No
/// point of an arc is farther from the arc's chord than the arc is high.
fn beside(half: &Curve, points: &[Point3<f64>]) -> f64 {
    let line = Line { start: points[0], end: points[points.len() - 1] };
    let height = match half {
        Curve::Arc(arc) => arc.radius() * (1.0 - (arc.sweep() / 2.0).cos()),
        Curve::Line(_) | Curve::Parabola(_) => 0.0,
    };
    height + line.distance_to(&half.start()).max(line.distance_to(&half.end()))
}

fn warnings(job: &Job, figures: &Figures) -> Vec<Warning> {
    let tolerance = job.fit.tolerance_mm;
    let over = |mm: f64, times: f64| exceeds(mm, times * tolerance).then_some(mm);
    let exceeded = over(figures.deviation_mm, 1.0);
    let rounding = over(figures.written_mm, 1.0).filter(|_| exceeded.is_none());
    let coarse =
        over(figures.from_lines_mm, COARSE_TOLERANCES).filter(|_| job.fit.measure == Measure::Points);
    let exceeded = exceeded.map(|deviation_mm| Warning::ToleranceExceeded { deviation_mm });
    let rounding = rounding.map(|deviation_mm| Warning::RoundingExceedsTolerance { deviation_mm });
    let coarse = coarse.map(|deviation_mm| Warning::CoarseSamples { deviation_mm });
    exceeded.into_iter().chain(rounding).chain(coarse).collect()
}

/// Whether a deviation exceeds a tolerance by more than rounding.
fn exceeds(deviation_mm: f64, tolerance_mm: f64) -> bool {
    deviation_mm > tolerance_mm * (1.0 + ROUNDING) + ROUNDING_MM
}

/// The angles between neighbouring curves, degrees; for a closed path also the angle between the last and the
/// first curve.
fn kinks(curves: &[Curve], is_closed: bool) -> Vec<f64> {
    let angle = |before: &Curve, after: &Curve| {
        let [_, a] = before.tangents();
        let [b, _] = after.tangents();
        a.cross(&b).norm().atan2(a.dot(&b)).to_degrees()
    };
    let seam = curves.last().zip(curves.first()).filter(|_| is_closed);
    let neighbours = curves.windows(2).map(|pair| (&pair[0], &pair[1]));
    neighbours.chain(seam).map(|(before, after)| angle(before, after)).collect()
}

#[cfg(test)]
mod tests;
