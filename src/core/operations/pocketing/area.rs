//! The plan of one area: the routes of all patterns for each shape, the choice on each level, and the passes
//! that finish walls.

use std::sync::Arc;

use nalgebra::Point2;

use super::PocketError;
use super::candidate::{Route, routes};
use super::conditions::Conditions;
use super::finish::{self, Finished};
use super::job::{Job, Only, Pattern};
use super::level::{Heights, Level, Shape, Stage, levels};
use super::report::{Candidate, LevelOutlines, LevelReport};
use super::router::Run;
use crate::budget::{Budget, Stopped};
use crate::toolpath::cutting::Cutting;
use crate::toolpath::path::PathError;

/// A planned area.
pub struct Area {
    /// The indices of the regions for which the area stands; none where the job has one area only.
    pub regions: Option<Vec<usize>>,
    pub heights: Heights,
    pub cutting: Cutting,
    pub shapes: Vec<Shape>,
    pub levels: Vec<Level>,
    /// The report of each level, and its outlines.
    pub reports: Vec<(LevelReport, LevelOutlines)>,
    pub finished: Vec<Finished>,
    /// What is cut on each level; none where the tool fits nowhere.
    cuts: Vec<Option<(Arc<Route>, Conditions)>>,
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
    /// Plans the area of a job, which stands for `regions` if the job is a part of a larger one.
    ///
    /// # Errors
    /// One of [`PocketError`].
    pub fn new(job: &Job, regions: Option<Vec<usize>>, budget: &Budget) -> Result<Self, PocketError> {
        let (heights, shapes, levels) = levels(job, budget)?;
        let cutting = job.cutting.above(heights.highest_mm)?;
        let conditions = conditions(job, &heights, &cutting, &levels, shapes.len());
        let found = routes_of_shapes(job, &shapes, &levels, &conditions, budget)?;
        let (mut reports, mut cuts) = (Vec::with_capacity(levels.len()), Vec::with_capacity(levels.len()));
        for (level, conditions) in levels.iter().zip(conditions) {
            let shape = &shapes[level.shape];
            let (candidates, chosen) = choose(job, shape, &found[level.shape], &conditions, budget)?;
            let route = chosen.as_ref().map(|(pattern, route)| (*pattern, route.as_ref()));
            reports.push(LevelReport::new(shape, level, &conditions, route, candidates, budget)?);
            cuts.push(chosen.map(|(_, route)| (route, conditions)));
        }
        let finished = match job.finishing_walls() {
            Some(finish) => finish::walls(job, finish, &shapes, &levels, &heights, &cutting, budget)?,
            None => Vec::new(),
        };
        Ok(Self { regions, heights, cutting, shapes, levels, reports, finished, cuts })
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

    /// The runs of a task in their order, with their conditions.
    pub fn parts(&self, task: Task) -> Vec<(&[Run], &Conditions)> {
        match task {
            Task::Level(k) => {
                let cut = self.cuts[k].as_ref();
                cut.map(|(route, conditions)| (route.runs.as_slice(), conditions)).into_iter().collect()
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

/// The routes of one pattern, or why it has none.
type Found = (Pattern, Result<Vec<Arc<Route>>, PocketError>);

/// The pattern of a level with its route; none where the tool fits nowhere.
type Chosen = Option<(Pattern, Arc<Route>)>;

/// For each shape the routes of all patterns; none where the tool fits nowhere.
fn routes_of_shapes(
    job: &Job,
    shapes: &[Shape],
    levels: &[Level],
    conditions: &[Conditions],
    budget: &Budget,
) -> Result<Vec<Vec<Found>>, PocketError> {
    let patterns = &job.patterns;
    let find = |k: usize| {
        let (shape, pattern) = (k / patterns.len(), patterns[k % patterns.len()]);
        // The conditions of the shape's first level do for all its levels: lifts take about as long on each.
        let level = levels.iter().position(|level| level.shape == shape).ok_or(Stopped::Cancelled)?;
        let is_cut = job.only != Some(Only::Finishing) || levels[level].stage == Stage::Floor;
        if !is_cut || shapes[shape].room.centers.is_empty() {
            return Ok((pattern, Ok(Vec::new())));
        }
        match routes(pattern, &shapes[shape], &conditions[level], budget) {
            Err(PocketError::Stopped(stopped)) => Err(stopped),
            found => Ok((pattern, found.map(|routes| routes.into_iter().map(Arc::new).collect()))),
        }
    };
    let mut all = budget.in_order(shapes.len() * patterns.len(), find)?.into_iter();
    Ok(shapes.iter().map(|_| all.by_ref().take(patterns.len()).collect()).collect())
}

/// The candidates of a level, and the pattern with the least figure among the valid ones. Where the cutter
/// can come in over open edges, only the routes with the fewest entries into material are compared.
fn choose(
    job: &Job,
    shape: &Shape,
    found: &[Found],
    conditions: &Conditions,
    budget: &Budget,
) -> Result<(Vec<Candidate>, Chosen), PocketError> {
    let mut candidates = Vec::new();
    let mut best: Option<((usize, f64), Pattern, &Arc<Route>)> = None;
    let n_entries = |route: &Route| if shape.is_open() { route.n_entries() } else { 0 };
    let mut failure = None;
    for (pattern, routes) in found {
        let routes = match routes {
            Ok(routes) => routes,
            Err(error) => {
                candidates.push(Candidate::failed(*pattern, error.to_string()));
                failure.get_or_insert_with(|| error.clone());
                continue;
            }
        };
        let mut fastest: Option<((usize, f64), Candidate, &Arc<Route>)> = None;
        let mut too_long = None;
        for route in routes {
            budget.check()?;
            let candidate = match Candidate::new(*pattern, route, conditions, job.move_limit) {
                Err(error @ PocketError::Path(PathError::TooManyMoves { .. })) => {
                    too_long = Some(error);
                    continue;
                }
                candidate => candidate?,
            };
            let figure = (n_entries(route), candidate.figure(job.choose_by));
            let is_better = |(least, other, _): &((usize, f64), Candidate, &Arc<Route>)| {
                (!candidate.valid, figure) < (!other.valid, *least)
            };
            if fastest.as_ref().is_none_or(is_better) {
                fastest = Some((figure, candidate, route));
            }
        }
        if let (None, Some(error)) = (&fastest, too_long) {
            candidates.push(Candidate::failed(*pattern, error.to_string()));
            failure.get_or_insert(error);
        }
        let Some((figure, candidate, route)) = fastest else { continue };
        if candidate.valid && best.is_none_or(|(least, ..)| figure < least) {
            best = Some((figure, *pattern, route));
        }
        candidates.push(candidate);
    }
    if let Some((_, pattern, route)) = best {
        return Ok((candidates, Some((pattern, Arc::clone(route)))));
    }
    let because = candidates.iter().find_map(|candidate| candidate.invalid_because.clone());
    let invalid = because.map(|because| PocketError::NoneValid { because });
    // Where the tool fits nowhere there are no routes at all.
    failure.or(invalid).map_or(Ok((candidates, None)), Err)
}
