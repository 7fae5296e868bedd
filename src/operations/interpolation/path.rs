//! The toolpath along elements.

use nalgebra::{Point2, Point3};

use super::compensation::compensate;
use super::fit::Fitter;
use super::{Error, Job, Method, ReportedElement, Warning, bisection, least};
use crate::budget::Budget;
use crate::geometry::curve::Direction;
use crate::geometry::deviation::Measure;
use crate::geometry::element::Element;
use crate::geometry::plane::Plane;
use crate::geometry::plane_curve::PlaneCurve;
use crate::toolpath::cutting::Cutting;
use crate::toolpath::quantize::{self, Parabolas};
use crate::toolpath::units::FeedRate;
use crate::toolpath::{Builder, Move, Role, Toolpath};

/// The top of the part where nothing else is known of it: zero, or the contour if that is higher, mm.
const TOP_MM: f64 = 0.0;

/// How far the tool is lifted between chains of which nobody said how to cut them, mm.
const LIFT_MM: f64 = 2.0;

/// What the cutter leaves is worth a word from here on, mm: less is lost in the program's decimals.
const UNCUT_MM: f64 = 1e-3;

/// Moves between two looks at the budget.
const MOVES_BETWEEN_CHECKS: usize = 1024;

/// The way of the tool, with its figures.
pub struct Path {
    pub toolpath: Toolpath,
    pub length_mm: f64,
    pub cutting_time_s: Option<f64>,
    pub deviation_written_mm: Option<f64>,
    pub cutting: Option<Cutting>,
    pub warnings: Vec<Warning>,
}

/// An element on its way to the program, with its proved deviation from the curve.
struct Stretch {
    element: Element,
    deviation_mm: f64,
}

pub fn path(
    curve: &impl PlaneCurve,
    elements: &[ReportedElement],
    job: &Job,
    budget: &Budget,
) -> Result<Path, Error> {
    let cutting = job.cutting.map(|cutting| cutting.above(TOP_MM.max(job.z_mm))).transpose()?;
    let stretches = runnable(curve, elements, job, budget)?;
    let contour: Vec<Element> = stretches.iter().map(|stretch| stretch.element).collect();
    let mut warnings = Vec::new();
    let chains = match job.compensation {
        None => vec![contour],
        Some((side, radius_mm)) => {
            let compensated = compensate(&contour, side, radius_mm, budget)?;
            let uncut_mm = compensated.uncut_mm;
            warnings.extend((uncut_mm > UNCUT_MM).then_some(Warning::ContourNotReached { uncut_mm }));
            compensated.chains
        }
    };
    let toolpath = toolpath(&chains, job, cutting.as_ref())?;
    let mut length_mm = 0.0;
    let mut seconds = Some(0.0);
    let mut written: f64 = 0.0;
    let mut deviations = stretches.iter().map(|stretch| stretch.deviation_mm);
    for (k, step) in toolpath.moves().enumerate() {
        if k.is_multiple_of(MOVES_BETWEEN_CHECKS) {
            budget.check()?;
        }
        if let Move::Feed { along, rate, role: Role::Cut } = step {
            let length = along.length();
            length_mm += length;
            seconds = seconds.zip(*rate).map(|(seconds, rate)| seconds + length / rate.mm_per_s());
            let rounded = quantize::round(along, job.resolution, job.parabolas)?;
            written = written.max(deviations.next().unwrap_or(0.0) + rounded.displacement_mm);
        }
    }
    // A displacement has no bound along y on an upright curve.
    let is_told = job.compensation.is_none() && job.band.measure == Measure::Normal;
    let deviation_written_mm = is_told.then_some(written);
    Ok(Path { toolpath, length_mm, cutting_time_s: seconds, deviation_written_mm, cutting, warnings })
}

/// The elements as the control runs them: arcs, else lines, within the same band instead of parabolas that it does not
/// know.
fn runnable(
    curve: &impl PlaneCurve,
    elements: &[ReportedElement],
    job: &Job,
    budget: &Budget,
) -> Result<Vec<Stretch>, Error> {
    let mut stretches = Vec::with_capacity(elements.len());
    let fitter = |method| Fitter { curve, method, band: job.band, element_limit: job.element_limit };
    for element in elements {
        let is_run = job.parabolas == Parabolas::InXy || !matches!(element.element, Element::Parabola { .. });
        if is_run {
            stretches.push(Stretch { element: element.element, deviation_mm: element.spread.largest_mm() });
            continue;
        }
        let fitted = match least::fewest(&fitter(Method::Arc), element.domain, budget) {
            // Upright arcs are no graphs.
            Err(Error::BandInfeasible { .. }) => {
                bisection::bisect(&fitter(Method::Linear), element.domain, budget)?
            }
            fitted => fitted?,
        };
        stretches.extend(
            fitted
                .iter()
                .map(|fitted| Stretch { element: fitted.element, deviation_mm: fitted.spread.largest_mm() }),
        );
    }
    Ok(stretches)
}

/// Down at the start of each chain, along it, and up at its end; without cutting conditions a single chain lies in its
/// plane alone.
fn toolpath(chains: &[Vec<Element>], job: &Job, cutting: Option<&Cutting>) -> Result<Toolpath, Error> {
    let at = |p: Point2<f64>| Point3::new(p.x, p.y, job.z_mm);
    let is_lifted = cutting.is_some() || chains.len() > 1;
    let lifted_mm = cutting.map_or(TOP_MM.max(job.z_mm) + LIFT_MM, |cutting| cutting.retract_z_mm);
    let above = |p: Point2<f64>| Point3::new(p.x, p.y, lifted_mm);
    let feed = |role: Role| cutting.map(|cutting| cutting.feed_of(role));
    let start = chains.iter().flatten().next().map_or(Point2::origin(), Element::start);
    let mut builder = Toolpath::builder(if is_lifted { above(start) } else { at(start) });
    for chain in chains {
        let (Some(first), Some(last)) = (chain.first(), chain.last()) else { continue };
        builder.begin_pass(None);
        if is_lifted {
            if builder.at() != above(first.start()) {
                builder.rapid(above(first.start()))?;
            }
            builder.line(at(first.start()), feed(Role::Plunge), Role::Plunge)?;
        }
        for element in chain {
            cut(&mut builder, element, job.z_mm, feed(Role::Cut))?;
        }
        if is_lifted {
            builder.rapid(above(last.end()))?;
        }
    }
    Ok(builder.finish()?)
}

fn cut(builder: &mut Builder, element: &Element, z_mm: f64, rate: Option<FeedRate>) -> Result<(), Error> {
    let at = |p: &Point2<f64>| Point3::new(p.x, p.y, z_mm);
    match element {
        Element::Line { end, .. } => builder.line(at(end), rate, Role::Cut)?,
        Element::Arc(arc) => {
            let direction = if arc.turn > 0.0 { Direction::Ccw } else { Direction::Cw };
            builder.arc(at(&arc.end), at(&arc.center), (Plane::Xy, direction), rate, Role::Cut)?;
        }
        Element::Parabola { control, end, .. } => builder.parabola(at(end), at(control), rate, Role::Cut)?,
    }
    Ok(())
}
