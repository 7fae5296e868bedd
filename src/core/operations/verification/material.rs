//! What the moves do to the stock, and how near rapids, shank and holder come to what is left of it.

use nalgebra::Point3;

use super::findings::{Certainty, Finding, Findings, Kind};
use super::motions::Motion;
use super::{Error, Job, MaterialReport, Worst};
use crate::budget::Budget;
use crate::machining::stock::{Effect, FAR_MM, Shape, Step, Stock};

/// The number of cells of a height map where the job names no size.
const CELLS: f64 = 250_000.0;

/// A cell is no larger than this share of the smallest cutter's radius, where the job names no size.
const CELL_OF_RADIUS: f64 = 0.25;

/// Beside a wall that the program has cut, a cell across the wall counts as full. Its nearest place lies in
/// the cutter by up to this many half diagonals of a cell.
const BESIDE_WALLS: f64 = 3.0;

/// A coarse grid leaves no more than this share of the cutter's radius undecided without a finding.
const UNDECIDED_OF_RADIUS: f64 = 0.5;

/// Runs all moves in the stock. Returns also the least distance of shank and holder from the stock, where a
/// tool has them.
pub(super) fn run(
    raw: &Shape,
    job: &Job,
    motions: &[Motion],
    findings: &mut Findings,
    budget: &Budget,
) -> Result<(MaterialReport, Option<Worst>), Error> {
    let stock = Stock::new(raw, cell_mm(raw, job), job.most_cells, budget)?;
    let mut steps = Vec::with_capacity(motions.len());
    let mut owners = Vec::with_capacity(motions.len());
    for (k, motion) in motions.iter().enumerate() {
        let is_sure = motion.ways.len() == 1;
        for (way, curve) in
            motion.ways.iter().enumerate().flat_map(|(n, way)| way.iter().map(move |c| (n, c)))
        {
            let tool = &job.tool(motion).assembly;
            let is_rapid = motion.is_rapid;
            steps.push(Step { tip: *curve, slack_mm: job.control_tolerance_mm, tool, is_rapid, is_sure });
            owners.push((k, way));
        }
    }
    let (left, effects) = stock.after(&steps, job.clearance_mm, budget)?;
    let mut report = MaterialReport {
        before: stock.volume(),
        after: left.volume(),
        air_length_mm: 0.0,
        depth: None,
        rapid_depth: Worst { bound_mm: 0.0, found_mm: None, at: None, place: None },
        left,
    };
    let has_sections = job.tools.iter().any(|tool| !tool.assembly.sections.is_empty());
    let mut nearest =
        has_sections.then_some(Worst { bound_mm: FAR_MM, found_mm: None, at: None, place: None });
    let half = stock.grid().half_diagonal();
    for (motion, effect) in joined(&effects, &owners, motions) {
        if motion.is_rapid {
            rapid(&effect, half, job, motion, &mut report, findings);
        } else {
            feed(&effect, job, motion, &mut report, findings);
        }
        if let Some(nearest) = &mut nearest {
            approach(&effect, job, motion, nearest, findings);
        }
    }
    Ok((report, nearest))
}

/// The effects of the ways of each motion together: bounds of all ways, and what is found on each of them.
fn joined<'m>(
    effects: &[Effect],
    owners: &[(usize, usize)],
    motions: &'m [Motion],
) -> Vec<(&'m Motion, Effect)> {
    let mut all: Vec<(&Motion, Effect)> = Vec::with_capacity(motions.len());
    let all_steps = effects.iter().zip(owners).collect::<Vec<_>>();
    for of_motion in all_steps.chunk_by(|(_, one), (_, other)| one.0 == other.0) {
        let ways = of_motion.chunk_by(|(_, one), (_, other)| one.1 == other.1);
        let of_way = |way: &[(&Effect, &(usize, usize))]| {
            way.iter().fold(Effect::NONE, |sum, (own, _)| sum.and(**own))
        };
        let sum = ways.map(of_way).reduce(Effect::or);
        all.extend(sum.map(|effect| (&motions[of_motion[0].1.0], effect)));
    }
    all
}

/// The largest size of a cell, mm.
fn cell_mm(raw: &Shape, job: &Job) -> f64 {
    let [width, height] = raw.rectangle().map_or([0.0; 2], |[low, high]| [high.x - low.x, high.y - low.y]);
    let area = width * height;
    let radii = job.tools.iter().map(|tool| tool.assembly.cutter.radius());
    let usual = (area / CELLS).sqrt().min(CELL_OF_RADIUS * radii.fold(f64::INFINITY, f64::min));
    // One row and one column more for what is left over at the edges, of a long strip one at each cell.
    let most = job.most_cells as f64;
    let least = (area / (0.8 * most)).sqrt().max((width + height) / (0.1 * most));
    job.cell_mm.unwrap_or(usual.max(least))
}

/// A rapid that enters the stock.
fn rapid(
    effect: &Effect,
    half_diagonal: f64,
    job: &Job,
    motion: &Motion,
    report: &mut MaterialReport,
    findings: &mut Findings,
) {
    let found_mm = effect.found_at.map(|_| effect.found_mm);
    let bound_mm = effect.depth_bound();
    let bound_at =
        || effect.bound_at.zip(motion.along()).map(|(p, along)| Point3::new(p.x, p.y, along.end().z));
    let at = effect.found_at.or_else(bound_at);
    if bound_mm > report.rapid_depth.bound_mm {
        report.rapid_depth = Worst { bound_mm, found_mm, at, place: Some(motion.place) };
    }
    let radius = job.tool(motion).assembly.cutter.radius();
    let beside = (BESIDE_WALLS * half_diagonal).min(UNDECIDED_OF_RADIUS * radius);
    // The program has cut its walls with the same slack as it comes back to them.
    let allowed = job.tolerance_mm + beside + 2.0 * job.control_tolerance_mm;
    let is_certain = effect.found_mm > job.tolerance_mm;
    let is_possible = effect.depth_bound_mm > job.tolerance_mm || effect.beside_bound_mm > allowed;
    if is_certain || is_possible {
        findings.add(Finding {
            kind: Kind::RapidThroughStock,
            certainty: if is_certain { Certainty::Certain } else { Certainty::Possible },
            place: motion.place,
            at,
            found_mm,
            bound_mm,
        });
    }
}

/// A feed move: what it removes, and how deep.
fn feed(effect: &Effect, job: &Job, motion: &Motion, report: &mut MaterialReport, findings: &mut Findings) {
    let Some((depth, at)) = effect.removed else {
        report.air_length_mm += motion.length();
        return;
    };
    if report.depth.is_none_or(|worst| depth > worst.bound_mm) {
        let place = Some(motion.place);
        report.depth = Some(Worst { bound_mm: depth, found_mm: Some(depth), at: Some(at), place });
    }
    let flutes = job.tool(motion).flute_length_mm;
    if let Some(beyond) = flutes.map(|length| depth - length).filter(|beyond| *beyond > job.tolerance_mm) {
        findings.add(Finding {
            kind: Kind::DeeperThanFlutes,
            certainty: Certainty::Certain,
            place: motion.place,
            at: Some(at),
            found_mm: Some(beyond),
            bound_mm: beyond,
        });
    }
}

/// Shank and holder that come near to the stock.
fn approach(effect: &Effect, job: &Job, motion: &Motion, nearest: &mut Worst, findings: &mut Findings) {
    let Some(approach) = effect.approach else { return };
    let found_mm = approach.is_met.then_some(0.0);
    let own =
        Worst { bound_mm: approach.clearance_mm, found_mm, at: Some(approach.at), place: Some(motion.place) };
    *nearest = nearest.or_nearer(own);
    if approach.clearance_mm < job.clearance_mm || approach.clearance_mm == 0.0 {
        findings.add(Finding {
            kind: Kind::HolderNearStock,
            certainty: if approach.is_met { Certainty::Certain } else { Certainty::Possible },
            place: motion.place,
            at: own.at,
            found_mm,
            bound_mm: approach.clearance_mm,
        });
    }
}
