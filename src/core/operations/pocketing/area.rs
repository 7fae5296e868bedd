//! The plan of one area: the routes of all patterns for each shape, the route of each level, and the
//! passes that finish walls.

use std::sync::Arc;

use nalgebra::Point2;

use super::PocketError;
use super::candidate::routes;
use super::choice::{Chosen, Found, choose};
use super::conditions::Conditions;
use super::entry_place;
use super::finish::{self, Finished};
use super::job::{EntryLimits, Job, Only, Pattern};
use super::level::{Heights, Level, Shape, Stage, levels};
use super::report::{LevelOutlines, LevelReport};
use super::router::Run;
use crate::budget::{Budget, Progress, Stopped};
use crate::toolpath::cutting::Cutting;

/// A planned area.
pub struct Area {
    /// The indices of the regions for which the area stands; none where the job has one area only.
    pub regions: Option<Vec<usize>>,
    /// The limits of entries, with the place of the job if it lies in the area.
    pub entry: EntryLimits,
    pub heights: Heights,
    pub cutting: Cutting,
    pub shapes: Vec<Shape>,
    pub levels: Vec<Level>,
    /// The report of each level, and its outlines.
    pub reports: Vec<(LevelReport, LevelOutlines)>,
    pub finished: Vec<Finished>,
    /// The chosen route and the conditions of each level.
    cuts: Vec<Cut>,
}

/// The chosen route of a level, and the conditions under which it is cut.
struct Cut {
    chosen: Chosen,
    conditions: Conditions,
}

/// A part of the work in an area that is done without a break.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Task {
    /// The level with this index is cut.
    Level(usize),
    /// The walls are finished over the depth with this index.
    Finish(usize),
}

impl Area {
    /// Plans the area of a job, which stands for `regions` if the job is a part of a larger one. Then the
    /// place of the entry may lie in another area.
    ///
    /// # Errors
    /// One of [`PocketError`].
    pub fn new(job: &Job, regions: Option<Vec<usize>>, budget: &Budget) -> Result<Self, PocketError> {
        let (heights, shapes, levels) = levels(job, budget)?;
        let elsewhere = match entry_place::check(&job.entry, &shapes) {
            Err(error) if regions.is_none() => return Err(error),
            Err(_) => Some(Job { entry: EntryLimits { at: None, ..job.entry }, ..job.clone() }),
            Ok(()) => None,
        };
        let job = elsewhere.as_ref().unwrap_or(job);
        let cutting = job.cutting.above(heights.highest_mm)?;
        let conditions = conditions(job, &heights, &cutting, &levels, shapes.len());
        let found = routes_of_shapes(job, &shapes, &levels, &conditions, regions.is_none(), budget)?;
        let (mut reports, mut cuts) = (Vec::with_capacity(levels.len()), Vec::with_capacity(levels.len()));
        for (level, conditions) in levels.iter().zip(conditions) {
            let shape = &shapes[level.shape];
            let (candidates, chosen) = choose(job, shape, &found[level.shape], &conditions, budget)?;
            let route = chosen.as_ref().map(|(pattern, route)| (*pattern, route.as_ref()));
            reports.push(LevelReport::new(shape, level, &conditions, route, candidates, budget)?);
            cuts.push(Cut { chosen, conditions });
        }
        let finished = match job.finishing_walls() {
            Some(finish) => finish::walls(job, finish, &shapes, &levels, &heights, &cutting, budget)?,
            None => Vec::new(),
        };
        let entry = job.entry;
        Ok(Self { regions, entry, heights, cutting, shapes, levels, reports, finished, cuts })
    }

    /// The levels from the top down.
    pub fn cutting_tasks(&self) -> impl Iterator<Item = Task> + use<> {
        (0..self.levels.len()).map(Task::Level)
    }

    /// The passes that finish walls, from the top down.
    pub fn finishing_tasks(&self) -> impl Iterator<Item = Task> + use<> {
        (0..self.finished.len()).map(Task::Finish)
    }

    /// The level on which a task is done.
    pub fn level_of(&self, task: Task) -> usize {
        match task {
            Task::Level(k) => k,
            Task::Finish(k) => self.finished[k].level,
        }
    }

    /// The height to which a task goes, mm.
    pub fn z_mm(&self, task: Task) -> f64 {
        match task {
            Task::Level(k) => self.cuts[k].conditions.z_mm,
            Task::Finish(k) => self.finished[k].z_mm,
        }
    }

    /// The pattern of a task; none where walls are finished or the tool fits nowhere.
    pub fn pattern(&self, task: Task) -> Option<Pattern> {
        match task {
            Task::Level(k) => self.cuts[k].chosen.as_ref().map(|(pattern, _)| *pattern),
            Task::Finish(_) => None,
        }
    }

    /// The runs of a task in their order, with their conditions.
    pub fn parts(&self, task: Task) -> Vec<(&[Run], &Conditions)> {
        match task {
            Task::Level(k) => {
                let Cut { chosen, conditions } = &self.cuts[k];
                chosen.iter().map(|(_, route)| (route.runs.as_slice(), conditions)).collect()
            }
            Task::Finish(k) => {
                let passes = &self.finished[k].passes;
                passes.iter().map(|(runs, conditions)| (runs.as_slice(), conditions)).collect()
            }
        }
    }

    /// Where the first run of a task starts, and where its last run ends; none where nothing is cut.
    pub fn ends(&self, task: Task) -> Option<[Point2<f64>; 2]> {
        let parts = self.parts(task);
        let [start, _] = parts.iter().find_map(|(runs, _)| runs.first())?.ends();
        let [_, end] = parts.iter().rev().find_map(|(runs, _)| runs.last())?.ends();
        Some([start, end])
    }
}

/// The conditions of each level.
fn conditions(
    job: &Job,
    heights: &Heights,
    cutting: &Cutting,
    levels: &[Level],
    n_shapes: usize,
) -> Vec<Conditions> {
    let of_level = |level: &Level| {
        let range = [level.top_z_mm, level.z_mm];
        let floor = job.finishing_floor().filter(|_| level.stage == Stage::Floor);
        let job = floor.as_ref().unwrap_or(job);
        let cutting = Cutting { feed: job.cutting.feed, ..*cutting };
        Conditions::new(job, &cutting, heights.highest_mm, range, n_shapes)
    };
    levels.iter().map(of_level).collect()
}

/// For each shape the routes of all patterns; none where the tool fits nowhere. The progress of a pocket that
/// is planned alone is told.
fn routes_of_shapes(
    job: &Job,
    shapes: &[Shape],
    levels: &[Level],
    conditions: &[Conditions],
    is_alone: bool,
    budget: &Budget,
) -> Result<Vec<Vec<Found>>, PocketError> {
    let patterns = &job.patterns;
    let count = shapes.len() * patterns.len();
    let progress = Progress::new("patterns", if is_alone { count } else { 0 });
    let find = |k: usize| {
        let (shape, pattern) = (k / patterns.len(), patterns[k % patterns.len()]);
        // The conditions of the shape's first level do for all its levels: lifts take about as long on each.
        let level = levels.iter().position(|level| level.shape == shape).ok_or(Stopped::Cancelled)?;
        let is_cut = job.only != Some(Only::Finishing) || levels[level].stage == Stage::Floor;
        if !is_cut || shapes[shape].room.centers.is_empty() {
            progress.tell_one(budget);
            return Ok((pattern, Ok(Vec::new())));
        }
        let found = routes(pattern, &shapes[shape], &conditions[level], budget);
        progress.tell_one(budget);
        match found {
            Err(PocketError::Stopped(stopped)) => Err(stopped),
            found => Ok((pattern, found.map(|routes| routes.into_iter().map(Arc::new).collect()))),
        }
    };
    let mut all = budget.in_order(count, find)?.into_iter();
    Ok(shapes.iter().map(|_| all.by_ref().take(patterns.len()).collect()).collect())
}
