//! Several regions that are cleared down to one floor.
//!
//! # Method
//! 1. Regions that overlap, or touch along a stretch, become one area, so that no pass is cut along a wall
//!    between them (`merge`).
//! 2. Each area is planned alone, as if the job had no other. The areas share the limit of comparisons by the
//!    length of their paths. Of what earlier tools have emptied, each area gets what is near it (`near`).
//! 3. The areas are put into a sequence (`sequence`), and their tasks are joined: area by area, or level by
//!    level.
//!
//! # Guarantees
//! * The plan of an area is the plan that its region alone would have. Open edges of regions that become one
//!   stay open, as far as no other region lies in front of them.
//! * The way from area to area is never longer than in the order in which the regions are given.
//!
//! # Degenerate input
//! Regions may contain each other, and be equal. An area that earlier tools have emptied stays in the report
//! and has no moves.

mod merge;
mod near;
mod overlaps;
mod sequence;

use nalgebra::Point2;

use super::area::{Area, Task};
use super::cleared::Cleared;
use super::job::{Emptied, Job, LevelOrder, Outlines, Regions, Sequence};
use super::join::{Visit, join, whole};
use super::{Plan, PocketError, entry_place};
use crate::budget::{Budget, Progress, Stopped};
use crate::geometry::region;
use crate::geometry::segment::Segment;
use merge::{Merged, merged};
use near::Surroundings;
pub use overlaps::{CutIsland, cut_islands};
use sequence::{Tour, shortest};

/// Plans several regions.
///
/// # Errors
/// One of [`PocketError`]; an error about one region names it.
pub fn plan(job: &Job, regions: &Regions, budget: &Budget) -> Result<Plan, PocketError> {
    let merged = merged(&regions.all, budget)?;
    // The mistakes in emptied places are told by their indices in the whole job.
    Cleared::new(&job.cleared, budget)?;
    let shares = Shares::new(job, &merged);
    let progress = Progress::new("regions", merged.len());
    let area = |k: usize| {
        let Merged { area, of } = &merged[k];
        let job = shares.job(k, area, budget)?;
        let area = Area::new(&job, Some(of.clone()), budget).map_err(|error| error.of_regions(of));
        progress.tell_one(budget);
        area
    };
    let areas = budget.in_order(merged.len(), area)?;
    entry_place::check(&job.entry, areas.iter().flat_map(|area| &area.shapes))?;
    let visits = visits(&areas, regions, budget)?;
    join(job, areas, &visits, budget)
}

impl PocketError {
    /// The error of an area that stands for `regions`. An error that has nothing to do with the area stays as
    /// it is.
    fn of_regions(self, regions: &[usize]) -> Self {
        match self {
            Self::Stopped(_)
            | Self::Heights(_)
            | Self::FloorNotBelowTop { .. }
            | Self::Cleared { .. }
            | Self::ClearedEmpty { .. } => self,
            error => Self::OfRegions { regions: regions.to_vec(), error: Box::new(error) },
        }
    }
}

/// What the areas share.
struct Shares<'a> {
    /// The job without regions and emptied places.
    alone: Job,
    cleared: Vec<Surroundings<'a>>,
    /// The limit of comparisons of each area.
    comparisons: Vec<u64>,
}

impl<'a> Shares<'a> {
    fn new(job: &'a Job, merged: &[Merged]) -> Self {
        let alone = Job { regions: None, cleared: Vec::new(), ..job.clone() };
        let lengths: Vec<f64> = merged.iter().map(|merged| path_length_mm(&merged.area, job)).collect();
        let whole: f64 = lengths.iter().sum();
        let limit = |length: &f64| (job.comparison_limit as f64 * (length / whole)) as u64;
        let comparisons = lengths.iter().map(limit).collect();
        Self { alone, cleared: job.cleared.iter().map(Surroundings::new).collect(), comparisons }
    }

    /// The job of an area.
    fn job(&self, k: usize, area: &Outlines, budget: &Budget) -> Result<Job, Stopped> {
        let mut cleared: Vec<Emptied> = Vec::new();
        for place in &self.cleared {
            budget.check()?;
            cleared.extend(place.near(&area.boundary));
        }
        let comparison_limit = self.comparisons[k];
        Ok(Job { area: Some(area.clone()), cleared, comparison_limit, ..self.alone.clone() })
    }
}

/// About the length of a path that clears an area, mm.
fn path_length_mm(area: &Outlines, job: &Job) -> f64 {
    let walls: f64 = area.islands.iter().flatten().chain(&area.boundary).map(Segment::length).sum();
    walls + region::area(&area.boundary).abs() / job.stepover_mm
}

/// The order in which the tool visits the areas.
fn visits(areas: &[Area], regions: &Regions, budget: &Budget) -> Result<Vec<Visit>, Stopped> {
    let as_given = in_order(areas, &(0..areas.len()).collect::<Vec<_>>(), regions.order);
    if regions.sequence == Sequence::AsGiven {
        return Ok(as_given);
    }
    // An area in which nothing is cut has no ends, and comes last.
    let (mut cut, mut idle, mut known) = (Vec::new(), Vec::new(), Vec::new());
    for (k, area) in areas.iter().enumerate() {
        match ends(area, regions.order) {
            Some(ends) => {
                cut.push(k);
                known.push(ends);
            }
            None => idle.push(k),
        }
    }
    let tour = match regions.order {
        LevelOrder::DepthFirst => Tour::Once,
        LevelOrder::LevelFirst => Tour::Rounds,
    };
    let found = shortest(&known, tour, budget)?;
    let order: Vec<usize> = found.into_iter().map(|k| cut[k]).chain(idle).collect();
    let found = in_order(areas, &order, regions.order);
    // Levels of one area may begin at different places, and the search knows those of the first alone.
    let is_shorter = travel_mm(areas, &found) < travel_mm(areas, &as_given);
    Ok(if is_shorter { found } else { as_given })
}

/// Where the tool comes to an area first, and where it leaves it for the next one.
fn ends(area: &Area, order: LevelOrder) -> Option<[Point2<f64>; 2]> {
    let mut ends = whole(0, area).filter_map(|visit| area.ends(visit.task));
    let first = ends.next()?;
    match order {
        LevelOrder::DepthFirst => Some([first[0], ends.last().map_or(first[1], |last| last[1])]),
        LevelOrder::LevelFirst => Some(first),
    }
}

/// The visits of areas in this order.
fn in_order(areas: &[Area], order: &[usize], levels: LevelOrder) -> Vec<Visit> {
    if levels == LevelOrder::DepthFirst {
        return order.iter().flat_map(|k| whole(*k, &areas[*k])).collect();
    }
    let deepest = areas.iter().map(|area| area.levels.len()).max().unwrap_or(0);
    let mut visits = Vec::new();
    for level in 0..deepest {
        let with_level = order.iter().filter(|k| level < areas[**k].levels.len());
        visits.extend(with_level.map(|k| Visit { area: *k, task: Task::Level(level) }));
    }
    for k in order {
        visits.extend(areas[*k].finishing_tasks().map(|task| Visit { area: *k, task }));
    }
    visits
}

/// The length of the ways between visits, seen from above, mm.
fn travel_mm(areas: &[Area], visits: &[Visit]) -> f64 {
    let ends: Vec<[Point2<f64>; 2]> =
        visits.iter().filter_map(|visit| areas[visit.area].ends(visit.task)).collect();
    ends.windows(2).map(|pair| (pair[1][0] - pair[0][1]).norm()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operations::pocketing::Pattern;
    use crate::toolpath::tool::{Shape, Tool};
    use crate::toolpath::units::FeedRate;

    fn square(x: f64) -> Outlines {
        let corner = [[x, 0.0], [x + 12.0, 0.0], [x + 12.0, 12.0], [x, 12.0]].map(Point2::from);
        let side = |k: usize| Segment::Line { start: corner[k], end: corner[(k + 1) % 4] };
        Outlines { boundary: (0..4).map(side).collect(), islands: Vec::new() }
    }

    fn planned(places: &[f64], order: LevelOrder, sequence: Sequence) -> Plan {
        let all: Vec<Outlines> = places.iter().map(|x| square(*x)).collect();
        let tool = Tool { shape: Shape::Flat, ..Tool::ball(3.0) };
        let feed = FeedRate::from_mm_per_min(800.0).unwrap();
        let job = Job {
            area: None,
            regions: Some(Regions { all, order, sequence }),
            stepdown_max_mm: 1.0,
            patterns: vec![Pattern::IslandStockOffset],
            ..Job::new(square(0.0), -2.0, tool, 2.0, feed)
        };
        super::super::plan(&job, &Budget::unlimited()).unwrap()
    }

    /// The region and the floor of each level of the report.
    fn levels(plan: &Plan) -> Vec<(usize, f64)> {
        let level = |k: usize| plan.report.levels[k].regions.as_ref().map(|of| of[0]).unwrap_or(usize::MAX);
        (0..plan.report.levels.len()).map(|k| (level(k), plan.report.levels[k].z_mm)).collect()
    }

    #[test]
    fn levels_are_cut_region_by_region_or_level_by_level_and_passes_tell_their_level() {
        for (order, expected) in [
            (LevelOrder::DepthFirst, [(0, -1.0), (0, -2.0), (1, -1.0), (1, -2.0)]),
            (LevelOrder::LevelFirst, [(0, -1.0), (1, -1.0), (0, -2.0), (1, -2.0)]),
        ] {
            let plan = planned(&[0.0, 30.0], order, Sequence::AsGiven);
            assert_eq!(levels(&plan), expected);
            let passes: Vec<Option<u32>> = plan.toolpath.passes().iter().map(|pass| pass.level()).collect();
            assert_eq!(passes, [Some(0), Some(1), Some(2), Some(3)], "one pass for each level");
            assert!(plan.report.gouge_max_mm < 1e-3);
        }
    }

    #[test]
    fn the_sequence_with_the_least_travel_is_found_and_the_same_each_time() {
        let places = [0.0, 60.0, 30.0];
        let given = planned(&places, LevelOrder::DepthFirst, Sequence::AsGiven);
        assert_eq!(levels(&given).iter().map(|(k, _)| *k).collect::<Vec<_>>(), [0, 0, 1, 1, 2, 2]);
        let least = planned(&places, LevelOrder::DepthFirst, Sequence::LeastTravel);
        let order: Vec<usize> = levels(&least).iter().map(|(k, _)| *k).collect();
        assert!(order == [0, 0, 2, 2, 1, 1] || order == [1, 1, 2, 2, 0, 0], "{order:?}");
        let again = planned(&places, LevelOrder::DepthFirst, Sequence::LeastTravel);
        assert_eq!((again.toolpath, again.report), (least.toolpath, least.report));
    }
}
