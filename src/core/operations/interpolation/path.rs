//! The toolpath along elements.

use nalgebra::{Point2, Point3};

use super::band::BandAlong;
use super::compensation::compensate;
use super::fit::Fitter;
use super::meter::{Meter, Metered};
use super::{Error, Job, Method, ReportedElement, Warning, bisection, largest_radius, least};
use crate::budget::Budget;
use crate::geometry::curve::{Arc, Curve, Direction, Line, Parabola};
use crate::geometry::deviation::{Element, Measure};
use crate::geometry::plane::Plane;
use crate::geometry::plane_curve::PlaneCurve;
use crate::geometry::segment::Segment;
use crate::toolpath::contour::{TOP_MM, contour};
use crate::toolpath::cutting::Cutting;
use crate::toolpath::quantize::{self, Arcs, Parabolas};
use crate::toolpath::{Move, PathError, Role, Toolpath};

/// The least uncut distance that causes a warning, mm: less is lost in the program's decimals.
const UNCUT_MM: f64 = 1e-3;

/// How far the path may lie outside its exact place at nearly smooth joints, in steps of the last decimal.
const MITRE_STEPS: f64 = 0.1;

/// Moves between two checks of the budget.
const MOVES_BETWEEN_CHECKS: usize = 1024;

/// The toolpath with its figures.
pub struct Path {
    pub toolpath: Toolpath,
    /// For each cutting move its deviation from the curve, mm; empty for the path of a compensated tool.
    pub deviations_mm: Vec<f64>,
    pub length_mm: f64,
    pub cutting_time_s: Option<f64>,
    pub deviation_written_mm: Option<f64>,
    pub cutting: Option<Cutting>,
    pub warnings: Vec<Warning>,
}

/// An element as the control runs it, with its proved deviation from the curve.
struct ProvedElement {
    element: Element,
    deviation_mm: f64,
}

pub fn path(
    curve: &impl PlaneCurve,
    band: &BandAlong,
    elements: &[ReportedElement],
    job: &Job,
    budget: &Budget,
) -> Result<Path, Error> {
    let cutting = job.cutting.map(|cutting| cutting.above(TOP_MM.max(job.z_mm))).transpose()?;
    let stretches = runnable(curve, band, elements, job, budget)?;
    let mut warnings = Vec::new();
    let chains = match job.compensation {
        None => vec![stretches.iter().map(|stretch| stretch.element).collect()],
        Some((side, radius_mm)) => {
            let mitre_mm = MITRE_STEPS * job.resolution.step_mm();
            let segment = |stretch: &ProvedElement| match stretch.element {
                Element::Segment(segment) => Ok(segment),
                Element::Parabola { .. } => Err(Error::CompensatedParabola),
            };
            let contour = stretches.iter().map(segment).collect::<Result<Vec<Segment>, Error>>()?;
            let compensated = compensate(&contour, side, radius_mm, mitre_mm, budget)?;
            let uncut_mm = compensated.uncut_mm;
            warnings.extend((uncut_mm > UNCUT_MM).then_some(Warning::ContourNotReached { uncut_mm }));
            let elements = |chain: Vec<Segment>| chain.into_iter().map(Element::Segment).collect();
            compensated.chains.into_iter().map(elements).collect()
        }
    };
    let lifted = |chain: &Vec<Element>| chain.iter().map(|element| lifted(element, job.z_mm)).collect();
    let chains: Vec<Vec<Curve>> = chains.iter().map(lifted).collect::<Result<_, Error>>()?;
    let toolpath = contour(&chains, TOP_MM.max(job.z_mm), cutting.as_ref())?;
    let mut length_mm = 0.0;
    let mut seconds = Some(0.0);
    let mut written: f64 = 0.0;
    let of_stretches = || stretches.iter().map(|stretch| stretch.deviation_mm);
    let mut deviations = of_stretches();
    for (k, step) in toolpath.moves().enumerate() {
        if k.is_multiple_of(MOVES_BETWEEN_CHECKS) {
            budget.check()?;
        }
        if let Move::Feed { along, rate, role: Role::Cut } = step {
            let length = along.length();
            length_mm += length;
            seconds = seconds.zip(*rate).map(|(seconds, rate)| seconds + length / rate.mm_per_s());
            let rounded = quantize::round(along, job.resolution, &job.curves)?;
            written = written.max(deviations.next().unwrap_or(0.0) + rounded.displacement_mm);
        }
    }
    // Where the curve is vertical, a small displacement may mean any deviation along y.
    let is_told = job.compensation.is_none() && job.band.measure == Measure::Normal;
    let deviation_written_mm = is_told.then_some(written);
    let deviations_mm = if job.compensation.is_none() { of_stretches().collect() } else { Vec::new() };
    Ok(Path {
        toolpath,
        deviations_mm,
        length_mm,
        cutting_time_s: seconds,
        deviation_written_mm,
        cutting,
        warnings,
    })
}

/// The elements as the control runs them. If it runs no parabolas, arcs within the same band replace each
/// parabola; if it runs no arcs or arcs do not fit, lines do.
fn runnable(
    curve: &impl PlaneCurve,
    band: &BandAlong,
    elements: &[ReportedElement],
    job: &Job,
    budget: &Budget,
) -> Result<Vec<ProvedElement>, Error> {
    let mut stretches = Vec::with_capacity(elements.len());
    let meter = Meter::new(job.step_limit, budget);
    let curve = &Metered::new(curve, &meter);
    let limit = job.element_limit;
    for element in elements {
        let fitter = |method| Fitter {
            largest_radius_mm: largest_radius(job),
            curve,
            method,
            band: band.widest,
            along: band,
            element_limit: limit.saturating_sub(stretches.len()),
            meter: &meter,
        };
        let is_run =
            job.curves.parabolas == Parabolas::InXy || !matches!(element.element, Element::Parabola { .. });
        if is_run {
            stretches.push(ProvedElement { element: element.element, deviation_mm: element.deviation_mm });
            continue;
        }
        let method = if job.curves.arcs == Arcs::AsLines { Method::Linear } else { Method::Arc };
        let fitted = match least::fewest(&fitter(method), element.domain, budget) {
            // By the vertical measure, an arc that is vertical somewhere is no graph.
            Err(Error::BandInfeasible { .. }) => {
                bisection::bisect(&fitter(Method::Linear), element.domain, budget)?
            }
            fitted => fitted?,
        };
        stretches.extend(fitted.iter().map(|fitted| ProvedElement {
            element: fitted.element,
            deviation_mm: fitted.spread.largest_mm(),
        }));
        if stretches.len() > limit {
            return Err(Error::TooManyElements { limit });
        }
    }
    meter.finish()?;
    Ok(stretches)
}

/// The element as a curve at the height `z_mm`.
fn lifted(element: &Element, z_mm: f64) -> Result<Curve, Error> {
    let at = |p: &Point2<f64>| Point3::new(p.x, p.y, z_mm);
    Ok(match element {
        Element::Segment(Segment::Line { start, end }) => {
            Curve::Line(Line { start: at(start), end: at(end) })
        }
        Element::Segment(Segment::Arc(arc)) => {
            let direction = if arc.turn() > 0.0 { Direction::Ccw } else { Direction::Cw };
            let arc = Arc::new(Plane::Xy, direction, at(&arc.start()), at(&arc.end()), at(&arc.center()));
            Curve::Arc(arc.map_err(PathError::from)?)
        }
        Element::Parabola { start, control, end } => {
            Curve::Parabola(Parabola::new(at(start), at(control), at(end)).map_err(PathError::from)?)
        }
    })
}
