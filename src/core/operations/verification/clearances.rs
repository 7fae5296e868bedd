//! Distances of the tool from the part and from fixtures, and the travel of the machine.

use nalgebra::{Point3, Vector3};

use super::findings::{Certainty, Finding, Findings, Kind};
use super::motions::Motion;
use super::part::{Depths, PartProof};
use super::{Error, Job, Worst};
use crate::budget::{Budget, Stopped};
use crate::geometry::curve::{Curve, Line};
use crate::machining::assembly::Section;
use crate::machining::cutter::Cutter;
use crate::machining::gouge::Penetration;
use crate::machining::prism::{Asked, Prism};
use crate::machining::stock::FAR_MM;

/// By how much a distance that is found may exceed its bound, mm.
const GAP_MM: f64 = 0.005;

/// Rounding of a coordinate that is compared with a limit, mm.
const ROUNDING_MM: f64 = 1e-9;

/// Moves that one thread takes at once.
const ROW: usize = 64;

/// The nearest approach of one move: a bound of the distance, and a distance that was found.
#[derive(Debug, Clone, Copy)]
struct Near {
    bound_mm: f64,
    found_mm: f64,
    at: Option<Point3<f64>>,
}

/// What a row of moves comes to.
struct Row {
    nearest: Option<Worst>,
    findings: Vec<Finding>,
}

/// The least distance of shank and holder from the part; `None` where no tool has them.
pub(super) fn of_part(
    part: &PartProof,
    job: &Job,
    motions: &[Motion],
    findings: &mut Findings,
    budget: &Budget,
) -> Result<Option<Worst>, Error> {
    if job.tools.iter().all(|tool| tool.assembly.sections.is_empty()) {
        return Ok(None);
    }
    // A section without a lower end of its own cutter counts as a flat end as wide as its widest place.
    let of_tools: Vec<Vec<(Section, Box<dyn Depths + '_>)>> = job
        .tools
        .iter()
        .map(|tool| {
            let proof = |section: &Section| {
                let radius = section.bottom_radius_mm.max(section.top_radius_mm);
                (*section, part.depths(&Cutter::bull_nose(radius, 0.0), FAR_MM))
            };
            tool.assembly.sections.iter().map(proof).collect()
        })
        .collect();
    let near = |motion: &Motion, _: f64| {
        let mut nearest = Near { bound_mm: FAR_MM, found_mm: f64::INFINITY, at: None };
        for (section, proof) in &of_tools[job.tool_of_pass[motion.place.pass]] {
            for curve in &motion.curves {
                let raised = raised(curve, section.bottom_mm);
                let slack = job.control_tolerance_mm;
                let depth = proof.penetration(&raised, slack, GAP_MM, Penetration::NONE, budget)?;
                let bound_mm = (FAR_MM - depth.bound_mm).max(0.0);
                if bound_mm < nearest.bound_mm {
                    let is_straight = section.bottom_radius_mm == section.top_radius_mm;
                    let found_mm = if is_straight { FAR_MM - depth.found_mm } else { f64::INFINITY };
                    nearest = Near { bound_mm, found_mm, at: depth.at };
                }
            }
        }
        Ok(nearest)
    };
    nearest(Kind::HolderNearPart, job, motions, findings, near, budget).map(Some)
}

/// The least distance of the whole tool from fixtures; `None` without fixtures.
pub(super) fn of_fixtures(
    fixtures: &[Prism],
    job: &Job,
    motions: &[Motion],
    findings: &mut Findings,
    budget: &Budget,
) -> Result<Option<Worst>, Error> {
    if fixtures.is_empty() {
        return Ok(None);
    }
    let near = |motion: &Motion, limit: f64| {
        let assembly = &job.tool(motion).assembly;
        let mut nearest = Near { bound_mm: limit, found_mm: f64::INFINITY, at: None };
        for (fixture, curve) in
            fixtures.iter().flat_map(|fixture| motion.curves.iter().map(move |c| (fixture, c)))
        {
            let asked =
                Asked { slack_mm: job.control_tolerance_mm, gap_mm: GAP_MM, enough_mm: -nearest.bound_mm };
            let largest = fixture.nearness(assembly, curve, asked, budget)?;
            let bound_mm = (-largest.bound).max(0.0);
            if bound_mm < nearest.bound_mm {
                nearest = Near { bound_mm, found_mm: -largest.found, at: largest.at };
            }
        }
        Ok(nearest)
    };
    nearest(Kind::FixtureNear, job, motions, findings, near, budget).map(Some)
}

/// The nearest approach of all moves, with a finding for each that comes too near. `near` is told which
/// distance matters no more.
fn nearest(
    kind: Kind,
    job: &Job,
    motions: &[Motion],
    findings: &mut Findings,
    near: impl Fn(&Motion, f64) -> Result<Near, Stopped> + Sync,
    budget: &Budget,
) -> Result<Worst, Error> {
    let rows: Vec<&[Motion]> = motions.chunks(ROW).collect();
    let done = budget.in_order(rows.len(), |k| {
        budget.progress("clearance", k, rows.len());
        let mut row = Row { nearest: None, findings: Vec::new() };
        for motion in rows[k] {
            budget.check()?;
            let least = row.nearest.map_or(FAR_MM, |worst| worst.bound_mm);
            let own = near(motion, least.max(job.clearance_mm))?;
            if own.bound_mm < least {
                row.nearest = Some(worst(&own, motion));
            }
            row.findings.extend(finding(kind, &own, job, motion));
        }
        Ok::<_, Stopped>(row)
    })?;
    let mut nearest = Worst { bound_mm: FAR_MM, found_mm: None, at: None, place: None };
    for row in done {
        if let Some(own) = row.nearest {
            nearest = nearest.or_nearer(own);
        }
        row.findings.into_iter().for_each(|finding| findings.add(finding));
    }
    Ok(nearest)
}

fn worst(near: &Near, motion: &Motion) -> Worst {
    let found_mm = near.found_mm.is_finite().then_some(near.found_mm.max(0.0));
    Worst { bound_mm: near.bound_mm, found_mm, at: near.at, place: Some(motion.place) }
}

fn finding(kind: Kind, near: &Near, job: &Job, motion: &Motion) -> Option<Finding> {
    let is_near = near.bound_mm < job.clearance_mm || near.bound_mm == 0.0;
    let found = near.found_mm + job.control_tolerance_mm;
    let is_certain = found < job.clearance_mm || found <= 0.0;
    is_near.then(|| {
        let Worst { bound_mm, found_mm, at, .. } = worst(near, motion);
        let certainty = if is_certain { Certainty::Certain } else { Certainty::Possible };
        Finding { kind, certainty, place: motion.place, at, found_mm, bound_mm }
    })
}

/// Finds moves that leave the travel.
pub(super) fn travel(job: &Job, motions: &[Motion], findings: &mut Findings) {
    let Some(travel) = job.travel else { return };
    for motion in motions {
        let mut most: Option<(f64, Point3<f64>)> = None;
        for curve in &motion.curves {
            for (axis, sign) in [0, 1, 2].into_iter().flat_map(|axis| [(axis, 1.0), (axis, -1.0)]) {
                let direction = Vector3::ith(axis, sign);
                let limit = if sign > 0.0 { travel.high[axis] } else { -travel.low[axis] };
                let beyond = curve.support(&direction) - limit;
                if beyond > ROUNDING_MM && most.is_none_or(|(before, _)| beyond > before) {
                    let along = |p: &Point3<f64>| p.coords.dot(&direction);
                    let (start, end) = (curve.start(), curve.end());
                    let at = if along(&start) >= along(&end) { start } else { end };
                    most = Some((beyond, at));
                }
            }
        }
        if let Some((beyond, at)) = most {
            findings.add(Finding {
                kind: Kind::OutsideTravel,
                certainty: Certainty::Certain,
                place: motion.place,
                at: Some(at),
                found_mm: Some(beyond),
                bound_mm: beyond,
            });
        }
    }
}

fn raised(curve: &Curve, by: f64) -> Curve {
    let up = Vector3::z() * by;
    match curve {
        Curve::Line(line) => Curve::Line(Line { start: line.start + up, end: line.end + up }),
        Curve::Arc(arc) => Curve::Arc(arc.translated(&up)),
        Curve::Parabola(parabola) => Curve::Parabola(parabola.translated(&up)),
    }
}
