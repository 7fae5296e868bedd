//! Divides a plane curve into lines, arcs or parabolas that stay within a band about the curve.
//!
//! # Method
//! 1. Divide the domain of the curve into as many equal ranges as the job asks for.
//! 2. Divide each range into elements, by one of two methods. *Bisection*, as in Hyun's paper: halve each
//!    element that leaves the band (`bisection`). *Fewest elements*: let each element reach as far as it can
//!    (`least`). This is not always the smallest number, so a beam search and bisection then look for fewer
//!    elements (`beam_search`, `fewest`).
//! 3. Prove for each element that all of it stays within the band
//!    ([`deviation`](crate::geometry::deviation)).
//! 4. Compute a lower bound for the number of elements that the curve needs (`lower_bound`).
//! 5. Turn the elements into a toolpath (`path`). On request, offset the toolpath by the cutter's radius
//!    (`compensation`).
//!
//! # Guarantees
//! * Elements join without gaps from the first point of the curve to the last.
//! * `deviation_max_mm` is at least the deviation of every element. Its excess over the largest deviation is
//!   at most 2.5e-7 mm plus a quarter of this deviation.
//! * A job is refused if even the shortest element leaves the band at some place of the curve.
//!
//! # Cost
//! O(n) for n elements. Bisection of a curve with many knots takes O(n log n).
//!
//! # Reference
//! C. H. Hyun, "The Tool Path Determination for Machining the Plane Curve by an Adaptive Mesh Generation
//! Technique",
//! 1992. The paper samples the deviation of each element; here a bound of the deviation is proved.

mod band;
mod beam_search;
mod bisection;
mod compensation;
mod corners;
mod corridor;
mod fewest;
mod fit;
mod job;
mod least;
mod lower_bound;
mod meter;
mod path;
mod preview;
mod source;
mod straight;

use nalgebra::Point2;

use crate::budget::{Budget, Stopped};
use crate::geometry::deviation::{Element, Ends, Measure, Spread, Verdict, judge};
pub use crate::geometry::offset::Side;
use crate::geometry::plane_curve::PlaneCurve;
use crate::geometry::segment::Segment;
use crate::toolpath::cutting::{Cutting, HeightError};
use crate::toolpath::quantize::QuantizeError;
use crate::toolpath::units::rounded_up;
use crate::toolpath::{PathError, Toolpath};
pub use band::{BandAlong, Side as BandSide, WidthError};
pub use compensation::CompensationError;
use corridor::Corridor;
use fit::{Fitted, Fitter};
pub use job::{DEFAULT_ELEMENT_LIMIT, Job, Joints, Method, Source, Subdivision, Widths};
use meter::{Meter, Metered};
pub use preview::{Sketch, sketch};
pub use source::{AnyCurve, SourceError};

/// The most elements of a bisection for which a lower bound is computed. The bound takes much longer than the
/// bisection.
const MOST_BOUNDED: usize = 10_000;

/// The largest radius of an arc, mm, also on a control that runs larger arcs. Flatter arcs would stand for
/// straight parts of a profile, which are lines.
const LARGEST_RADIUS_MM: f64 = 1e4;

/// The shape of an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, utoipa::ToSchema))]
#[cfg_attr(feature = "wire", serde(rename_all = "snake_case"), schema(as = ElementShape))]
pub enum Shape {
    Line,
    Parabola,
    Arc,
}

impl From<&Element> for Shape {
    fn from(element: &Element) -> Self {
        match element {
            Element::Segment(Segment::Line { .. }) => Self::Line,
            Element::Segment(Segment::Arc(_)) => Self::Arc,
            Element::Parabola { .. } => Self::Parabola,
        }
    }
}

/// One element of the interpolation.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, utoipa::ToSchema), schema(as = InterpolatedElement))]
pub struct ReportedElement {
    #[cfg_attr(feature = "wire", serde(skip), schema(ignore))]
    pub element: Element,
    /// The shape of the element.
    pub shape: Shape,
    /// Number of the initial part of the curve to which the element belongs, counted from 1.
    pub initial_element: usize,
    /// Where on the curve the element begins and ends: x in mm for a graph, else the curve's parameter, a
    /// plain number.
    pub domain: [f64; 2],
    /// Proved largest distance of the element from the curve, in mm, by the `measure` of the band.
    pub deviation_mm: f64,
}

/// What the elements are like, with the proved distances.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, utoipa::ToSchema), schema(as = InterpolateReport))]
pub struct Report {
    /// Number of elements.
    pub n_elements: usize,
    /// Proved: any division of the curve with this `method` and these `joints` has at least this number of
    /// elements. Absent where `bisection` makes more than 10,000 elements, and where the service finds no
    /// bound.
    #[cfg_attr(feature = "wire", serde(skip_serializing_if = "Option::is_none"))]
    pub n_elements_lower_bound: Option<usize>,
    /// Number of elements in each initial part of the curve.
    pub elements_per_initial: Vec<usize>,
    /// Length of the cutting path, in mm.
    pub length_mm: f64,
    /// Length divided by the feed, in s. Absent without `cutting`.
    #[cfg_attr(feature = "wire", serde(skip_serializing_if = "Option::is_none"))]
    pub cutting_time_s: Option<f64>,
    /// Proved largest distance of an element from the curve, in mm, by the `measure` of the band.
    pub deviation_max_mm: f64,
    /// Proved upper bound of `deviation_max_mm` for the elements as the program has them, rounded to its
    /// decimals, in mm. Absent with `compensation: left` or `right`, and with `measure: vertical`.
    #[cfg_attr(feature = "wire", serde(skip_serializing_if = "Option::is_none"))]
    pub deviation_written_max_mm: Option<f64>,
    /// The elements, in the order of the curve.
    pub elements: Vec<ReportedElement>,
}

/// Something the caller should know that does not stop the job.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Warning {
    #[error("rounding to the program's decimals moves the path up to {:.4} mm from the curve, beyond the band", rounded_up(*deviation_mm))]
    RoundingLeavesBand { deviation_mm: f64 },
    #[error("the contour is curved more tightly than the cutter: material up to {:.4} mm thick stays", rounded_up(*uncut_mm))]
    ContourNotReached { uncut_mm: f64 },
}

#[derive(Debug, Clone)]
pub struct Plan {
    pub curve: AnyCurve,
    pub band: BandAlong,
    pub toolpath: Toolpath,
    /// For each cutting move of the toolpath, in their order, its proved deviation from the curve, mm. Empty
    /// for the path of a compensated tool.
    pub deviations_mm: Vec<f64>,
    pub report: Report,
    /// The conditions with every default filled in.
    pub cutting: Option<Cutting>,
    pub warnings: Vec<Warning>,
}

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    #[error(transparent)]
    Source(#[from] SourceError),
    #[error("only graphs y(x) have a vertical deviation")]
    VerticalWithoutGraph,
    #[error("{error}")]
    Width { side: BandSide, error: WidthError },
    #[error("only lines can have joints in the band")]
    JointsInBand,
    #[error("cutter radius compensation supports lines and arcs only")]
    CompensatedParabola,
    #[error("the curve needs more than {limit} elements; use a wider band")]
    TooManyElements { limit: usize },
    #[error(
        "the interpolation takes more than {limit} steps, the most that are allowed; use a wider band, or a shorter curve"
    )]
    TooManySteps { limit: u64 },
    #[error("no element stays within the band near {at}, however short it is; use a wider band")]
    BandInfeasible { at: Point2<f64> },
    #[error(transparent)]
    Compensation(#[from] CompensationError),
    #[error(transparent)]
    Heights(#[from] HeightError),
    #[error(transparent)]
    Quantize(#[from] QuantizeError),
    #[error(transparent)]
    Path(#[from] PathError),
}

/// Interpolates a curve.
///
/// # Errors
/// One of [`Error`]; no toolpath is returned with one.
///
/// # Example
/// The chord of y = x^2 / 100 over a width of w mm lies at most w^2 / 400 mm above the curve. So with
/// 0.0101 mm, a line can be 2.009 mm wide, and 100 mm need 50 lines.
///
/// ```
/// use toolpathd_core::budget::Budget;
/// use toolpathd_core::geometry::deviation::{Band, Measure};
/// use toolpathd_core::operations::interpolation::{Job, Joints, Method, Source, Subdivision, plan};
///
/// let curve = Source::Graph { expression: "x^2/100".to_owned(), domain: [0.0, 100.0] };
/// let band = Band { below_mm: 0.0, above_mm: 0.0101, measure: Measure::Vertical };
/// let job = Job::new(curve, Method::Linear, Subdivision::Least(Joints::OnCurve), band);
/// let plan = plan(&job, &Budget::unlimited()).unwrap();
/// assert_eq!(plan.report.elements.len(), 50);
/// assert_eq!(plan.report.n_elements_lower_bound, Some(50));
/// assert!(plan.report.deviation_max_mm <= 0.0101);
/// ```
pub fn plan(job: &Job, budget: &Budget) -> Result<Plan, Error> {
    if matches!(job.subdivision, Subdivision::Least(Joints::InBand)) && job.method != Method::Linear {
        return Err(Error::JointsInBand);
    }
    if matches!(job.subdivision, Subdivision::Least(Joints::InBand)) {
        let widths = [(&job.widths.below, BandSide::Below), (&job.widths.above, BandSide::Above)];
        if let Some((_, side)) = widths.into_iter().find(|(width, _)| width.is_some()) {
            return Err(Error::Width { side, error: WidthError::JointsInBand });
        }
    }
    if job.compensation.is_some() && matches!(job.method, Method::Parabolic | Method::Mixed) {
        return Err(Error::CompensatedParabola);
    }
    let curve = job.curve.curve(budget)?;
    if job.band.measure == Measure::Vertical && !curve.is_graph() {
        return Err(Error::VerticalWithoutGraph);
    }
    let band = BandAlong::of(job, &curve, budget)?;
    // One instance for each kind of curve: the search spends its time on points of the curve.
    let divided = match &curve {
        AnyCurve::Graph(graph) => divide(graph, &band, job, budget),
        AnyCurve::Piecewise(piecewise) => divide(piecewise, &band, job, budget),
    }?;
    let path = match &curve {
        AnyCurve::Graph(graph) => path::path(graph, &band, &divided.elements, job, budget),
        AnyCurve::Piecewise(piecewise) => path::path(piecewise, &band, &divided.elements, job, budget),
    }?;
    let deviation_max_mm = divided.elements.iter().map(|element| element.deviation_mm).fold(0.0, f64::max);
    let widest = band.widest.below_mm.max(band.widest.above_mm);
    let mut warnings = path.warnings;
    if let Some(deviation_mm) = path.deviation_written_mm.filter(|mm| *mm > widest) {
        warnings.push(Warning::RoundingLeavesBand { deviation_mm });
    }
    let report = Report {
        n_elements: divided.elements.len(),
        n_elements_lower_bound: divided.lower_bound,
        elements_per_initial: divided.per_initial,
        length_mm: path.length_mm,
        cutting_time_s: path.cutting_time_s,
        deviation_max_mm,
        deviation_written_max_mm: path.deviation_written_mm,
        elements: divided.elements,
    };
    let (toolpath, deviations_mm, cutting) = (path.toolpath, path.deviations_mm, path.cutting);
    Ok(Plan { curve, band, toolpath, deviations_mm, report, cutting, warnings })
}

/// The largest radius of the arcs of a job, mm.
fn largest_radius(job: &Job) -> f64 {
    job.curves.largest_radius_mm.min(LARGEST_RADIUS_MM)
}

/// The elements of a curve.
struct Divided {
    elements: Vec<ReportedElement>,
    per_initial: Vec<usize>,
    lower_bound: Option<usize>,
}

fn divide(curve: &impl PlaneCurve, along: &BandAlong, job: &Job, budget: &Budget) -> Result<Divided, Error> {
    let meter = Meter::new(job.step_limit, budget);
    let curve = &Metered::new(curve, &meter);
    let (method, band, element_limit) = (job.method, along.widest, job.element_limit);
    let largest_radius_mm = largest_radius(job);
    let fitter = Fitter { curve, method, band, along, largest_radius_mm, element_limit, meter: &meter };
    let [from, to] = curve.domain();
    let count = job.initial_elements.max(1);
    let at = |k: usize| if k == count { to } else { from + (to - from) * (k as f64 / count as f64) };
    let mut divided = Divided { elements: Vec::new(), per_initial: Vec::new(), lower_bound: None };
    // The elements with joints on the curve, each ending as far on as possible.
    let mut longest = Vec::new();
    for initial_element in 0..count {
        let range = [at(initial_element), at(initial_element + 1)];
        let fitted = match job.subdivision {
            Subdivision::Bisection => bisection::bisect(&fitter, range, budget)?,
            Subdivision::Least(joints) => {
                let fewest::Fewest { elements: mut fitted, longest: each } =
                    fewest::fewest(&fitter, range, budget)?;
                longest.extend(each);
                if joints == Joints::InBand
                    && meter.has_steps_for_search()
                    && let Some(free) = in_band(&fitter, &fitted, budget)?
                {
                    fitted = free;
                }
                fitted
            }
        };
        if divided.elements.len() + fitted.len() > job.element_limit {
            return Err(Error::TooManyElements { limit: job.element_limit });
        }
        divided.per_initial.push(fitted.len());
        divided.elements.extend(fitted.iter().map(|fitted| ReportedElement {
            element: fitted.element,
            shape: (&fitted.element).into(),
            initial_element: initial_element + 1,
            domain: fitted.range,
            deviation_mm: fitted.spread.largest_mm(),
        }));
    }
    divided.lower_bound = match job.subdivision {
        Subdivision::Least(Joints::InBand) => {
            let corridor = match meter.has_steps_for_search() {
                true => Corridor::new(curve, &ranges(&longest), job.band, budget)?,
                false => None,
            };
            corridor.map(|corridor| corridor.fewest(curve, budget)).transpose()?
        }
        Subdivision::Least(Joints::OnCurve) if count == 1 => {
            Some(lower_bound::lower_bound(&fitter, &longest)?)
        }
        Subdivision::Bisection if divided.elements.len() > MOST_BOUNDED || !meter.has_steps_for_search() => {
            None
        }
        Subdivision::Bisection | Subdivision::Least(Joints::OnCurve) => {
            on_its_own(&fitter, [from, to], budget)?
        }
    };
    meter.finish()?;
    Ok(divided)
}

/// The lower bound where the elements themselves do not help to find it; `None` if there are too many
/// elements to compute it.
fn on_its_own(
    fitter: &Fitter<impl PlaneCurve>,
    range: [f64; 2],
    budget: &Budget,
) -> Result<Option<usize>, Error> {
    match least::fewest(fitter, range, budget) {
        Ok(guide) => Ok(Some(lower_bound::lower_bound(fitter, &guide)?)),
        Err(Error::Stopped(stopped)) => Err(stopped.into()),
        Err(_) => Ok(None),
    }
}

fn ranges(elements: &[Fitted]) -> Vec<[f64; 2]> {
    elements.iter().map(|fitted| fitted.range).collect()
}

/// Lines with joints in the band; `None` if they are not proved, or not fewer than the elements on the curve.
fn in_band(
    fitter: &Fitter<impl PlaneCurve>,
    on_curve: &[Fitted],
    budget: &Budget,
) -> Result<Option<Vec<Fitted>>, Error> {
    let corridor = Corridor::new(fitter.curve, &ranges(on_curve), fitter.band, budget)?;
    let Some(joints) = corridor.map(|corridor| corridor.path(fitter.curve, budget)).transpose()?.flatten()
    else {
        return Ok(None);
    };
    if joints.len() > on_curve.len() {
        return Ok(None);
    }
    let mut lines = Vec::with_capacity(joints.len());
    for pair in joints.windows(2) {
        budget.check()?;
        let [start, end] = [pair[0], pair[1]];
        let element = Element::Segment(Segment::Line { start: start.at, end: end.at });
        let offsets = Spread {
            least_mm: start.offset_mm.min(end.offset_mm),
            most_mm: start.offset_mm.max(end.offset_mm),
        };
        let is_in_band = -offsets.least_mm <= fitter.band.below_mm && offsets.most_mm <= fitter.band.above_mm;
        match judge(fitter.curve, &element, [start.t, end.t], Ends::Beside, &fitter.band) {
            Verdict::Within(spread) if is_in_band => {
                let spread = spread.hull(&offsets);
                lines.push(Fitted { element, range: [start.t, end.t], spread });
            }
            _ => return Ok(None),
        }
    }
    Ok(Some(lines))
}

#[cfg(test)]
mod tests;
