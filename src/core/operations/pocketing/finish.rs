//! Finishing of walls and islands: passes along them that take what roughing has left.
//!
//! # Method
//! Levels that follow each other with the same walls are finished together, over their whole depth or in
//! parts as deep as a stepdown. The passes share the allowance. The last of them is followed again as often
//! as spring passes are asked for. What roughing has cleared counts as emptied, so that the cutter comes
//! down, moves and is lifted there.
//!
//! # Guarantees
//! Each pass is checked like a level of roughing: what it leaves in the reach of the cutter, how near it
//! comes to walls, and where it links.

use super::PocketError;
use super::check::{Check, check};
use super::conditions::Conditions;
use super::job::{FinishWalls, Job};
use super::level::{Heights, Level, Shape, Stage};
use super::rings;
use super::router::{Router, Run};
use super::walls::{self, Followed};
use crate::budget::Budget;
use crate::geometry::spacing::spaces;
use crate::toolpath::cutting::Cutting;

/// The distance of paths that stand for what roughing has cleared, in radii of the cutter.
const APART: f64 = 1.0;

/// How far beside the material passes along walls begin and end where the wall is open, mm.
const BESIDE_MM: f64 = 0.2;

/// Passes along walls of one depth.
pub struct Finished {
    /// The index of the lowest of the levels that are finished together.
    pub level: usize,
    pub top_z_mm: f64,
    pub z_mm: f64,
    /// The passes one after the other, with their conditions.
    pub passes: Vec<(Vec<Run>, Conditions)>,
    /// The figures of the last pass.
    pub check: Check,
}

/// The passes along walls and islands after all levels are cleared. The heights and cutting conditions are
/// those of the job.
pub fn walls(
    job: &Job,
    finish: FinishWalls,
    shapes: &[Shape],
    levels: &[Level],
    heights: &Heights,
    cutting: &Cutting,
    budget: &Budget,
) -> Result<Vec<Finished>, PocketError> {
    let mut all = Vec::new();
    for [first, last] in groups(shapes, levels) {
        let shape = &shapes[levels[last].shape];
        if shape.room.centers.is_empty() {
            continue;
        }
        let steps = cuts(job, finish, shape, budget)?;
        let (top, bottom) = (levels[first].top_z_mm, levels[last].z_mm);
        let parts = finish.stepdown_mm.map_or(1.0, |stepdown| spaces(top - bottom, stepdown));
        for k in 0..parts as usize {
            let height = |k: usize| top + (bottom - top) * (k as f64 / parts);
            let range = [height(k), if k + 1 == parts as usize { bottom } else { height(k + 1) }];
            let mut passes = Vec::new();
            let mut figures = Check::default();
            for (job, shape) in &steps {
                let cutting = Cutting { feed: job.cutting.feed, ..*cutting };
                let conditions = Conditions::new(job, &cutting, heights.highest_mm, range, 1);
                let runs = pass(shape, &conditions, budget)?;
                figures = check(&runs, shape, &conditions, budget)?;
                if let Some(because) = &figures.invalid_because {
                    return Err(PocketError::NoneValid { because: because.to_string() });
                }
                passes.push((runs, conditions));
            }
            let [top_z_mm, z_mm] = range;
            all.push(Finished { level: last, top_z_mm, z_mm, passes, check: figures });
        }
    }
    Ok(all)
}

/// The ranges of levels that have the same walls.
fn groups(shapes: &[Shape], levels: &[Level]) -> Vec<[usize; 2]> {
    let mut groups: Vec<[usize; 2]> = Vec::new();
    let walls = |k: usize| shapes[levels[k].shape].walls.faces();
    for (k, level) in levels.iter().enumerate() {
        match groups.last_mut() {
            // The floor of a pocket is finished within the walls of the level above it.
            Some([_, last]) if level.stage == Stage::Floor || walls(*last) == walls(k) => *last = k,
            _ => groups.push([k, k]),
        }
    }
    groups
}

/// The job and the shape of each pass, from what roughing leaves to the walls' size.
fn cuts(
    job: &Job,
    finish: FinishWalls,
    rough: &Shape,
    budget: &Budget,
) -> Result<Vec<(Job, Shape)>, PocketError> {
    let radius = job.tool.radius_mm;
    let mut cuts: Vec<(Job, Shape)> = Vec::new();
    let count = finish.passes.max(1);
    for k in 1..=count {
        let each = finish.stepover_mm.unwrap_or(job.allowance_mm / f64::from(count));
        let left_mm = f64::from(count - k) * each;
        let before = cuts.last().map_or(rough, |(_, shape)| shape);
        let mut own = job.clone();
        own.stepover_mm = (before.allowance_mm - left_mm).max(LEAST_MM).min(2.0 * radius);
        own.allowance_mm = left_mm;
        own.cutting.feed = finish.feed.unwrap_or(job.cutting.feed);
        let cleared = rings::rings(&before.room.centers, radius, APART * radius, budget)?;
        let shape = before.finished(&own, rings::inside_out(&cleared), budget)?;
        cuts.push((own, shape));
    }
    for _ in 0..finish.spring_passes {
        let Some((own, shape)) = cuts.last().cloned() else { break };
        cuts.push((own, shape));
    }
    Ok(cuts)
}

/// What a pass takes at least, mm: without an allowance there is nothing to take.
const LEAST_MM: f64 = 1e-3;

fn pass(shape: &Shape, conditions: &Conditions, budget: &Budget) -> Result<Vec<Run>, PocketError> {
    let mut router = Router::new(conditions, &shape.room.safe, &shape.emptied, budget);
    if let Some(opened) = &shape.opened {
        // The edges of zones are no walls.
        let near_mm = conditions.radius_mm + shape.deviation_mm + shape.allowance_mm + BESIDE_MM;
        let near = opened.material.offset_outward(near_mm, budget)?;
        walls::cut(&mut router, &shape.room, Followed::Over(&near))?;
    } else {
        walls::cut(&mut router, &shape.room, Followed::Whole)?;
    }
    Ok(router.finish())
}
