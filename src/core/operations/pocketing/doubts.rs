//! What is legal in the outlines and the heights of a pocket, and yet often a mistake.

use nalgebra::{Point2, Vector3};

use super::job::{Job, Outlines, Regions, Relief};
use super::regions::{CutIsland, cut_islands};
use super::{Plan, PocketError};
use crate::budget::Budget;
use crate::geometry::height_field::HeightGrid;
use crate::geometry::region::{Containment, Outline, OutlineError, Region, RegionError};
use crate::geometry::segment::Segment;
use crate::geometry::surface::any_surface::AnySurface;
use crate::geometry::surface::source::Source;

/// Outlines that overlap by less than this width all along the island do not overlap: coordinates are
/// rounded.
const TOUCHING_MM: f64 = 1e-4;

/// By how much a region may reach beyond the part, or the part above the stock, without a doubt, mm: the
/// triangles of a surface are less than half of this away from the surface.
const SLIGHT_MM: f64 = 0.005;

/// A doubt about a pocket.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Doubt {
    #[error("island {index}{} lies wholly outside the wall, and changes nothing", of_region(*region))]
    IslandOutside { region: Option<usize>, index: usize },
    #[error(
        "region {by} cuts a part of island {index} of region {region}: an island stays in its own region alone"
    )]
    IslandCut { region: usize, index: usize, by: usize },
    #[error(
        "the region reaches {by_mm:.3} mm beyond the box around the part: nothing is known of the part there, and nothing is cut there"
    )]
    RegionBeyondPart { by_mm: f64 },
    #[error("the part is {part_mm:.3} mm high, and the top of the stock lies lower, at {top_mm} mm")]
    StockBelowPart { top_mm: f64, part_mm: f64 },
}

/// The region of an island, if there are several regions.
fn of_region(region: Option<usize>) -> String {
    region.map_or_else(String::new, |region| format!(" of region {region}"))
}

/// The doubts about a job that has been planned.
///
/// # Errors
/// The budget's stop, and where the data make no surface.
pub fn doubts(job: &Job, plan: &Plan, budget: &Budget) -> Result<Vec<Doubt>, PocketError> {
    let mut doubts = Vec::new();
    if let Some(area) = &job.area {
        let outside = islands_outside(area, budget)?;
        doubts.extend(outside.into_iter().map(|index| Doubt::IslandOutside { region: None, index }));
    }
    if let Some(Regions { all, .. }) = &job.regions {
        doubts.extend(doubts_of_regions(all, budget)?);
    }
    if let (Some(area), Some(relief)) = (&job.area, &job.relief)
        && let Some(by_mm) = beyond_mm(&area.boundary, part_box(relief, budget)?, budget)?
    {
        doubts.push(Doubt::RegionBeyondPart { by_mm });
    }
    if let Some(top_mm) = job.top_z_mm.filter(|top_mm| plan.highest_mm > top_mm + SLIGHT_MM) {
        doubts.push(Doubt::StockBelowPart { top_mm, part_mm: plan.highest_mm });
    }
    Ok(doubts)
}

/// The doubts about several regions.
fn doubts_of_regions(regions: &[Outlines], budget: &Budget) -> Result<Vec<Doubt>, PocketError> {
    let mut doubts = Vec::new();
    for (region, area) in regions.iter().enumerate() {
        let outside = islands_outside(area, budget)?.into_iter();
        doubts.extend(outside.map(|index| Doubt::IslandOutside { region: Some(region), index }));
    }
    let cut = cut_islands(regions, budget)?.into_iter();
    let doubt = |CutIsland { region, island, by }| Doubt::IslandCut { region, index: island, by };
    doubts.extend(cut.map(doubt));
    Ok(doubts)
}

/// An outline, or none where the elements are none: a plan of such elements has failed.
fn outline(elements: &[Segment], budget: &Budget) -> Result<Option<Outline>, PocketError> {
    match Outline::new(elements, budget) {
        Err(OutlineError::Stopped(stopped)) => Err(stopped.into()),
        outline => Ok(outline.ok()),
    }
}

/// The indices of the islands that share no area with the inside of the wall.
fn islands_outside(area: &Outlines, budget: &Budget) -> Result<Vec<usize>, PocketError> {
    let mut outside = Vec::new();
    let wall = match outline(&area.boundary, budget)? {
        Some(wall) if !area.islands.is_empty() => Region::new(&[wall], &[], budget)?,
        _ => return Ok(outside),
    };
    for (index, island) in area.islands.iter().enumerate() {
        budget.check()?;
        let Some(first) = island.first() else { continue };
        if wall.place(first.start(), 0.0) != Containment::Inside && is_outside(&wall, island, budget)? {
            outside.push(index);
        }
    }
    Ok(outside)
}

fn is_outside(wall: &Region, island: &[Segment], budget: &Budget) -> Result<bool, PocketError> {
    let Some(island) = outline(island, budget)? else { return Ok(false) };
    let [low, high] = island.bounding_box();
    let apart = wall.bounding_box().is_none_or(|[least, most]| {
        low.x >= most.x || low.y >= most.y || high.x <= least.x || high.y <= least.y
    });
    if apart {
        return Ok(true);
    }
    let length_mm: f64 = island.elements().iter().map(Segment::length).sum();
    let inside = Region::new(&[island], &[], budget)?;
    match wall.intersection(&inside, budget) {
        Ok(common) => Ok(common.area() < TOUCHING_MM * length_mm),
        Err(RegionError::Stopped(stopped)) => Err(stopped.into()),
        // Outlines that cannot be told apart share a place.
        Err(_) => Ok(false),
    }
}

/// The box around the part in plan.
fn part_box(relief: &Relief, budget: &Budget) -> Result<[Point2<f64>; 2], PocketError> {
    match relief {
        Relief::Grid(HeightGrid { origin, spacing_mm, rows }) => {
            let last = |count: usize| spacing_mm * count.saturating_sub(1) as f64;
            let columns = rows.first().map_or(0, Vec::len);
            Ok([*origin, Point2::new(origin.x + last(columns), origin.y + last(rows.len()))])
        }
        Relief::Surface(source) => surface_box(source, budget),
    }
}

fn surface_box(source: &Source, budget: &Budget) -> Result<[Point2<f64>; 2], PocketError> {
    let surface = source.surface().map_err(PocketError::Surface)?;
    let farthest = |along: Vector3<f64>| match &surface {
        AnySurface::Bicubic(surface) => surface.farthest_along(&along, SLIGHT_MM, budget),
        AnySurface::Rational(surface) => surface.farthest_along(&along, SLIGHT_MM, budget),
        AnySurface::HighDegree(surface) => surface.farthest_along(&along, SLIGHT_MM, budget),
    };
    let [x, y] = [Vector3::x(), Vector3::y()];
    let low = Point2::new(-farthest(-x)?, -farthest(-y)?);
    Ok([low, Point2::new(farthest(x)?, farthest(y)?)])
}

/// How far an outline reaches beyond a box, mm. `None` where it does not.
fn beyond_mm(
    elements: &[Segment],
    [low, high]: [Point2<f64>; 2],
    budget: &Budget,
) -> Result<Option<f64>, PocketError> {
    let Some(outline) = outline(elements, budget)? else { return Ok(None) };
    let [least, most] = outline.bounding_box();
    let beyond = [low - least, most - high].iter().flat_map(|by| by.iter().copied()).fold(0.0, f64::max);
    Ok((beyond > SLIGHT_MM).then_some(beyond))
}
