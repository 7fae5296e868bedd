//! Distances of the tool from the part and from fixtures, and the travel of the machine.

use nalgebra::{Point3, Vector3};

use super::findings::{Certainty, Finding, Findings, Kind};
use super::motions::{Motion, farthest};
use super::part::{Depths, PartProof};
use super::{Error, Job, Worst};
use crate::budget::{Budget, Stopped};
use crate::geometry::curve::{Curve, Line};
use crate::machining::assembly::Frustum;
use crate::machining::cutter::Cutter;
use crate::machining::gouge::Penetration;
use crate::machining::prism::{Asked, Largest, Prism};
use crate::machining::stock::FAR_MM;

/// By how much a distance that is found may exceed its bound, mm.
const GAP_MM: f64 = 0.005;

/// Distances below this are looked for even where another move comes as near, mm.
const LEAST_MM: f64 = 0.1;

/// A distance that falls short of the one asked for by less is as good, mm: outlines are known no better.
const TOUCH_MM: f64 = 1e-4;

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

/// Distances within which the holder is measured from a surface, mm, one after the other until it is nearer.
/// A surface that is grown far gives poor bounds.
const WITHIN_MM: [f64; 3] = [1.0, 10.0, FAR_MM];

/// How much farther than the distance that is asked for a holder is measured from a surface.
const FARTHER: f64 = 1.5;

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
    let PartProof::Pocket { walls, floor_mm } = part else {
        return of_surface(part, job, motions, findings, budget).map(Some);
    };
    let near = |motion: &Motion, limit: f64| {
        let assembly = &job.tool(motion).assembly;
        each_way(motion, limit, |curve, enough_mm| {
            let asked = Asked { slack_mm: job.control_tolerance_mm, gap_mm: GAP_MM, enough_mm };
            let of_walls = walls.nearness_of_sections(assembly, curve, asked, budget)?;
            let lowest = farthest(curve, 2, -1.0);
            let over_floor = lowest.z + assembly.lowest_section() - floor_mm;
            let of_floor =
                Largest { bound: asked.slack_mm - over_floor, found: -over_floor, at: Some(lowest) };
            Ok(if of_floor.bound > of_walls.bound { of_floor } else { of_walls })
        })
    };
    nearest(Kind::HolderNearPart, job, motions, findings, near, budget).map(Some)
}

/// The least distance of shank and holder from a surface. A cone counts as a cylinder of its widest place.
fn of_surface(
    part: &PartProof,
    job: &Job,
    motions: &[Motion],
    findings: &mut Findings,
    budget: &Budget,
) -> Result<Worst, Error> {
    let mut found = Worst { bound_mm: FAR_MM, found_mm: None, at: None, place: None };
    for within in WITHIN_MM {
        let within = within.max(FARTHER * job.clearance_mm).min(FAR_MM);
        let of_tools: Vec<Vec<(Frustum, Box<dyn Depths + '_>)>> = job
            .tools
            .iter()
            .map(|tool| {
                let proof = |section: &Frustum| {
                    let radius = section.bottom_radius_mm.max(section.top_radius_mm);
                    (*section, part.depths(&Cutter::bull_nose(radius, 0.0), within))
                };
                tool.assembly.sections.iter().map(proof).collect()
            })
            .collect();
        let near = |motion: &Motion, _: f64| {
            each_way(motion, within, |curve, _| {
                let mut nearest = NOT_NEAR;
                for (section, proof) in &of_tools[job.tool_of_pass[motion.place.pass]] {
                    let raised = raised(curve, section.bottom_mm);
                    let slack = job.control_tolerance_mm;
                    let depth = proof.penetration(&raised, slack, GAP_MM, Penetration::NONE, budget)?;
                    let is_straight = section.bottom_radius_mm == section.top_radius_mm;
                    let is_found = is_straight && depth.at.is_some();
                    let found = if is_found { depth.found_mm - within } else { f64::NEG_INFINITY };
                    nearest =
                        nearer(nearest, Largest { bound: depth.bound_mm - within, found, at: depth.at });
                }
                Ok(nearest)
            })
        };
        let mut own = Findings::default();
        found = nearest(Kind::HolderNearPart, job, motions, &mut own, near, budget)?;
        if within == FAR_MM || found.bound_mm < within {
            own.listed.into_iter().for_each(|finding| findings.add(finding));
            break;
        }
    }
    Ok(found)
}

const NOT_NEAR: Largest = Largest { bound: f64::NEG_INFINITY, found: f64::NEG_INFINITY, at: None };

/// The larger bound, and the larger value that was found with its place.
fn nearer(one: Largest, other: Largest) -> Largest {
    let at = if other.found > one.found || one.at.is_none() { other.at } else { one.at };
    Largest { bound: one.bound.max(other.bound), found: one.found.max(other.found), at }
}

/// The nearest approach on any of the ways of a move, where one is nearer than `limit`. What is found holds
/// on all ways. `nearness` is told which nearness is enough.
fn each_way(
    motion: &Motion,
    limit: f64,
    nearness: impl Fn(&Curve, f64) -> Result<Largest, Stopped>,
) -> Result<Option<Near>, Stopped> {
    let mut worst: Option<Near> = None;
    for way in &motion.ways {
        let mut own = NOT_NEAR;
        for curve in way {
            own = nearer(own, nearness(curve, own.bound.max(-limit))?);
        }
        let near = Near { bound_mm: (-own.bound).max(0.0), found_mm: -own.found, at: own.at };
        worst = Some(match worst {
            None => near,
            Some(worst) => Near {
                bound_mm: worst.bound_mm.min(near.bound_mm),
                found_mm: worst.found_mm.max(near.found_mm),
                at: if near.bound_mm < worst.bound_mm { near.at } else { worst.at },
            },
        });
    }
    Ok(worst.filter(|near| near.bound_mm < limit))
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
        each_way(motion, limit, |curve, enough_mm| {
            let mut nearest = NOT_NEAR;
            for fixture in fixtures {
                let enough_mm = nearest.bound.max(enough_mm);
                let asked = Asked { slack_mm: job.control_tolerance_mm, gap_mm: GAP_MM, enough_mm };
                nearest = nearer(nearest, fixture.nearness(assembly, curve, asked, budget)?);
            }
            Ok(nearest)
        })
    };
    nearest(Kind::FixtureNear, job, motions, findings, near, budget).map(Some)
}

/// The nearest approach of all moves, with a finding for each that comes too near. `near` is told from which
/// distance on nothing needs to be found.
fn nearest(
    kind: Kind,
    job: &Job,
    motions: &[Motion],
    findings: &mut Findings,
    near: impl Fn(&Motion, f64) -> Result<Option<Near>, Stopped> + Sync,
    budget: &Budget,
) -> Result<Worst, Error> {
    let rows: Vec<&[Motion]> = motions.chunks(ROW).collect();
    let done = budget.in_order(rows.len(), |k| {
        budget.progress("clearance", k, rows.len());
        let mut row = Row { nearest: None, findings: Vec::new() };
        for motion in rows[k] {
            budget.check()?;
            let least = row.nearest.map_or(FAR_MM, |worst| worst.bound_mm);
            let Some(own) = near(motion, least.max(job.clearance_mm).max(LEAST_MM))? else { continue };
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
    let is_near = near.bound_mm < job.clearance_mm - TOUCH_MM || near.bound_mm == 0.0;
    let found = near.found_mm + job.control_tolerance_mm;
    let is_certain = found < job.clearance_mm - TOUCH_MM || found <= 0.0;
    is_near.then(|| {
        let Worst { bound_mm, found_mm, at, .. } = worst(near, motion);
        let certainty = if is_certain { Certainty::Certain } else { Certainty::Possible };
        Finding { kind, certainty, place: motion.place, at, found_mm, bound_mm }
    })
}

/// Finds moves that leave the travel.
pub(super) fn travel(job: &Job, motions: &[Motion], findings: &mut Findings) {
    let Some(travel) = job.travel else { return };
    let slack = job.control_tolerance_mm;
    for motion in motions {
        let mut most: Option<(f64, Point3<f64>)> = None;
        for curve in motion.curves() {
            for (axis, sign) in [0, 1, 2].into_iter().flat_map(|axis| [(axis, 1.0), (axis, -1.0)]) {
                let limit = if sign > 0.0 { travel.high[axis] } else { -travel.low[axis] };
                let beyond = curve.support(&Vector3::ith(axis, sign)) - limit;
                if beyond + slack > ROUNDING_MM && most.is_none_or(|(before, _)| beyond > before) {
                    most = Some((beyond, farthest(curve, axis, sign)));
                }
            }
        }
        if let Some((beyond, at)) = most {
            let is_certain = beyond - slack > ROUNDING_MM;
            findings.add(Finding {
                kind: Kind::OutsideTravel,
                certainty: if is_certain { Certainty::Certain } else { Certainty::Possible },
                place: motion.place,
                at: Some(at),
                found_mm: (beyond > 0.0).then_some(beyond),
                bound_mm: beyond + slack,
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
