//! How deep the cutter enters the part on each move.

use super::findings::{Certainty, Finding, Findings, Kind};
use super::motions::Motion;
use super::part::{Depths, PartProof};
use super::{Error, Job, Worst};
use crate::budget::{Budget, Stopped};
use crate::geometry::curve::Curve;
use crate::machining::gouge::Penetration;

/// By how much a bound may exceed the depth that is found, as a share of the tolerance.
const GAP: f64 = 0.1;

/// The gap is made smaller by this factor where it does not decide, down to [`LEAST_GAP_MM`].
const FINER: f64 = 0.1;
const LEAST_GAP_MM: f64 = 1e-6;

/// Moves that one thread takes at once.
const ROW: usize = 64;

/// The deepest entry of one row of moves.
struct Row {
    worst: Worst,
    /// The entry of each move, where the job asks for it.
    of_moves: Vec<Worst>,
    findings: Vec<Finding>,
}

/// The deepest entry of all moves into the part, and where the job asks for it the entry of each.
pub(super) fn deepest(
    part: &PartProof,
    job: &Job,
    motions: &[Motion],
    findings: &mut Findings,
    budget: &Budget,
) -> Result<(Worst, Vec<Worst>), Error> {
    let proofs: Vec<Box<dyn Depths + '_>> =
        job.tools.iter().map(|tool| part.depths(&tool.assembly.cutter, 0.0)).collect();
    let rows: Vec<&[Motion]> = motions.chunks(ROW).collect();
    let done = budget.in_order(rows.len(), |k| {
        budget.progress("gouge", k, rows.len());
        row(rows[k], &proofs, job, budget)
    })?;
    let mut worst = NONE;
    let mut of_moves = Vec::new();
    for row in done {
        worst = deeper(worst, row.worst);
        of_moves.extend(row.of_moves);
        row.findings.into_iter().for_each(|finding| findings.add(finding));
    }
    Ok((worst, of_moves))
}

const NONE: Worst = Worst { bound_mm: 0.0, found_mm: None, at: None, place: None };

/// The one with the larger bound.
fn deeper(one: Worst, other: Worst) -> Worst {
    if other.bound_mm > one.bound_mm { other } else { one }
}

fn row(
    motions: &[Motion],
    proofs: &[Box<dyn Depths + '_>],
    job: &Job,
    budget: &Budget,
) -> Result<Row, Stopped> {
    let (tolerance, slack) = (job.tolerance_mm, job.control_tolerance_mm);
    // The deepest of the moves within the tolerance: shallower moves need no closer look.
    let mut within = Penetration::NONE;
    let mut worst = NONE;
    let mut of_moves = Vec::new();
    let mut findings = Vec::new();
    for motion in motions {
        budget.check()?;
        let proof = &proofs[job.tool_of_pass[motion.place.pass]];
        let mut own = if job.lists_moves { Penetration::NONE } else { within };
        for curve in motion.curves() {
            own = proof.penetration(curve, slack, GAP * tolerance, own, budget)?;
        }
        let mut is_certain = false;
        if own.bound_mm > tolerance {
            let of_ways = motion.ways.iter().map(|way| decided(way, proof.as_ref(), job, budget));
            let of_ways = of_ways.collect::<Result<Vec<_>, _>>()?;
            is_certain = of_ways.iter().all(|way| way.found_mm - slack > tolerance);
            own = of_ways.into_iter().fold(Penetration::NONE, Penetration::or_deeper);
        }
        if own.bound_mm <= tolerance {
            within = within.or_deeper(own);
        }
        let told = Worst {
            bound_mm: own.bound_mm,
            found_mm: own.at.map(|_| own.found_mm),
            at: own.at,
            place: Some(motion.place),
        };
        worst = deeper(worst, told);
        if job.lists_moves {
            of_moves.push(told);
        }
        if own.bound_mm > tolerance {
            findings.push(Finding {
                kind: if motion.is_rapid { Kind::RapidThroughPart } else { Kind::Gouge },
                certainty: if is_certain { Certainty::Certain } else { Certainty::Possible },
                place: motion.place,
                at: own.at,
                found_mm: told.found_mm,
                bound_mm: own.bound_mm,
            });
        }
    }
    Ok(Row { worst, of_moves, findings })
}

/// The depth of one way of a move, so finely bounded that it lies on one side of the tolerance where that is
/// possible.
fn decided(way: &[Curve], proof: &dyn Depths, job: &Job, budget: &Budget) -> Result<Penetration, Stopped> {
    let (tolerance, slack) = (job.tolerance_mm, job.control_tolerance_mm);
    let mut gap = GAP * tolerance;
    loop {
        let mut own = Penetration::NONE;
        for curve in way {
            own = proof.penetration(curve, slack, gap, own, budget)?;
        }
        let is_decided = own.bound_mm <= tolerance || own.found_mm - slack > tolerance;
        if is_decided || gap <= LEAST_GAP_MM {
            return Ok(own);
        }
        gap = (FINER * gap).max(LEAST_GAP_MM);
    }
}
