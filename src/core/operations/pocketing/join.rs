//! Joins the plans of areas to one toolpath and one report.
//!
//! The tool comes to each task, and leaves it, at the retract plane.

use std::vec::IntoIter;

use nalgebra::{Point2, Point3};

use super::area::{Area, Task};
use super::entry_place::Entries;
use super::job::Job;
use super::level::Shape;
use super::report::{FinishReport, LevelOutlines, LevelReport, Report};
use super::{LevelStart, Plan, PocketError, path, warnings};
use crate::budget::Budget;
use crate::toolpath::Toolpath;
use crate::toolpath::path::Builder;

/// A task in one of several areas.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Visit {
    /// The index of the area.
    pub area: usize,
    pub task: Task,
}

/// The visits of one area whose work is done without a break: its levels, then its finishing passes.
pub fn whole(index: usize, area: &Area) -> impl Iterator<Item = Visit> + use<> {
    let tasks = area.cutting_tasks().chain(area.finishing_tasks());
    tasks.map(move |task| Visit { area: index, task })
}

/// The plan of a job with one area.
///
/// # Errors
/// As [`join`].
pub fn alone(job: &Job, area: Area, budget: &Budget) -> Result<Plan, PocketError> {
    let visits: Vec<Visit> = whole(0, &area).collect();
    join(job, vec![area], &visits, budget)
}

/// The plan of a job whose areas are visited in this order. Each task of each area has one visit, and the
/// levels of an area come in their order.
///
/// # Errors
/// When nothing is cut, the path has too many moves, or the path as it is written enters a wall.
pub fn join(job: &Job, mut areas: Vec<Area>, visits: &[Visit], budget: &Budget) -> Result<Plan, PocketError> {
    let Some((cutting, heights)) = areas.first().map(|area| (area.cutting, area.heights)) else {
        return Err(PocketError::NothingToCut);
    };
    let begin = |at: Point2<f64>| {
        Toolpath::builder(Point3::new(at.x, at.y, cutting.clearance_z_mm)).with_limit(job.move_limit)
    };
    let Some((mut builder, starts)) = append(&areas, visits, begin, budget)? else {
        return Err(PocketError::NothingToCut);
    };
    builder.rapid_to_height(cutting.clearance_z_mm)?;
    let toolpath = builder.finish()?;
    let (mut report, outlines) = levels(&mut areas, visits);
    report.finish_with(finishes(&areas, visits), job);
    let shapes = shapes(&areas, visits);
    report.finish(&toolpath, &shapes, &heights, job, &cutting)?;
    let mut warnings = warnings(job, &report);
    warnings.extend(entries(&areas, visits).warning());
    Ok(Plan { toolpath, report, outlines, starts, cutting, highest_mm: heights.highest_mm, warnings })
}

/// Appends the runs of all visits to the toolpath that begins over the first run, and tells where the
/// passes of each visit begin. None without any run.
fn append(
    areas: &[Area],
    visits: &[Visit],
    begin: impl Fn(Point2<f64>) -> Builder,
    budget: &Budget,
) -> Result<Option<(Builder, Vec<LevelStart>)>, PocketError> {
    let numbers = numbers(areas, visits);
    let mut builder: Option<Builder> = None;
    let (mut starts, mut n_passes) = (Vec::new(), 0);
    for Visit { area, task } in visits {
        budget.check()?;
        let (area, level) = (&areas[*area], numbers[*area][areas[*area].level_of(*task)]);
        let pass = n_passes;
        for (runs, conditions) in area.parts(*task) {
            let Some(run) = runs.first() else { continue };
            path::append(builder.get_or_insert_with(|| begin(run.start)), level, runs, conditions)?;
            n_passes += runs.len();
        }
        if n_passes > pass {
            let (z_mm, pattern) = (area.z_mm(*task), area.pattern(*task));
            starts.push(LevelStart { pass, level: level as usize, z_mm, pattern });
        }
    }
    Ok(builder.map(|builder| (builder, starts)))
}

/// Where the cutter comes down on all levels.
fn entries(areas: &[Area], visits: &[Visit]) -> Entries {
    let mut entries = Entries::default();
    for Visit { area, task } in visits.iter().filter(|visit| matches!(visit.task, Task::Level(_))) {
        let area = &areas[*area];
        for (runs, conditions) in area.parts(*task) {
            entries.add(&area.entry, runs, conditions.z_mm);
        }
    }
    entries
}

/// For each level of each area its index in the report.
fn numbers(areas: &[Area], visits: &[Visit]) -> Vec<Vec<u32>> {
    let mut numbers: Vec<Vec<u32>> = areas.iter().map(|area| vec![0; area.levels.len()]).collect();
    for (number, (area, level)) in levels_visited(visits).enumerate() {
        numbers[area][level] = u32::try_from(number).unwrap_or(u32::MAX);
    }
    numbers
}

/// The area and the index of each level, in the order of the report.
fn levels_visited(visits: &[Visit]) -> impl Iterator<Item = (usize, usize)> {
    visits.iter().filter_map(|visit| match visit.task {
        Task::Level(k) => Some((visit.area, k)),
        Task::Finish(_) => None,
    })
}

/// The report with the levels of all areas, whose own reports are taken, and the outlines of the levels.
fn levels(areas: &mut [Area], visits: &[Visit]) -> (Report, Vec<LevelOutlines>) {
    let mut waiting: Vec<IntoIter<(LevelReport, LevelOutlines)>> =
        areas.iter_mut().map(|area| std::mem::take(&mut area.reports).into_iter()).collect();
    let mut report = Report::default();
    let mut all = Vec::new();
    for (area, _) in levels_visited(visits) {
        let Some((level, outlines)) = waiting[area].next() else { continue };
        report.levels.push(LevelReport { regions: areas[area].regions.clone(), ..level });
        all.push(outlines);
    }
    (report, all)
}

/// The figures of the finishing passes in the order in which they are cut.
fn finishes(areas: &[Area], visits: &[Visit]) -> Vec<FinishReport> {
    let finish = |visit: &Visit| {
        let area = &areas[visit.area];
        match visit.task {
            Task::Level(_) => None,
            Task::Finish(k) => Some(FinishReport::new(&area.finished[k], area.regions.clone())),
        }
    };
    visits.iter().filter_map(finish).collect()
}

/// The shape of each level of the report.
fn shapes<'a>(areas: &'a [Area], visits: &[Visit]) -> Vec<&'a Shape> {
    let shape = |(area, level): (usize, usize)| &areas[area].shapes[areas[area].levels[level].shape];
    levels_visited(visits).map(shape).collect()
}
