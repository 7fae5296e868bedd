//! Candidates: the route of each pattern, with its check.

use nalgebra::Point2;

use super::PocketError;
use super::check::{Check, check};
use super::conditions::Conditions;
use super::crossings::Frame;
use super::job::{Milling, Pattern};
use super::level::Shape;
use super::rings::{self, Order};
use super::router::{Router, Run};
use super::rows::{self, AtIsland, Layout};
use super::{engagement, islands, strips, work};
use crate::budget::Budget;
use crate::geometry::region::Region;
use crate::geometry::segment::Segment;

/// What a new chain of rows costs, as a length in radii of the cutter, when directions of rows are compared.
const COST_OF_CHAIN: f64 = 6.0;

/// Two lengths count as equal if they differ by this part: the first direction is then kept.
const EQUAL: f64 = 1e-9;

/// A route for a shape.
#[derive(Debug, Clone)]
pub struct Route {
    pub runs: Vec<Run>,
    pub check: Check,
}

/// The routes of a pattern, of which the fastest is to be taken.
pub fn routes(
    pattern: Pattern,
    shape: &Shape,
    conditions: &Conditions,
    budget: &Budget,
) -> Result<Vec<Route>, PocketError> {
    // Earlier tools may have left little to do.
    if shape.emptied.is_empty() {
        work::check(pattern, shape.path_length_mm(conditions.stepover_mm), conditions)?;
    }
    let centers = &shape.centers;
    let begin = || Router::new(conditions, centers, &shape.emptied, budget);
    let ways = match pattern {
        Pattern::IslandOffset => {
            let mut router = begin();
            islands::cut(&mut router, centers, budget)?;
            vec![router.finish()]
        }
        Pattern::IslandStockOffset => {
            let rings = rings::rings(centers, conditions.radius_mm, conditions.stepover_mm, budget)?;
            let cut = |order| {
                let mut router = begin();
                rings::cut(&rings, order, &mut router)?;
                Ok(router.finish())
            };
            [Order::InsideOut, Order::OutsideIn].into_iter().map(cut).collect::<Result<_, PocketError>>()?
        }
        Pattern::ZigzagOffset => vec![rows(centers, AtIsland::Turn, 0.0, begin(), budget)?],
        Pattern::ContinuousOffset => vec![rows(centers, AtIsland::Around, 0.0, begin(), budget)?],
        Pattern::ContinuousStockOffset => {
            // Rows that end this far inside free all that the pass along the walls does not.
            let inset = conditions.radius_mm - 0.5 * conditions.stepover_mm;
            vec![rows(centers, AtIsland::Around, inset, begin(), budget)?]
        }
        Pattern::ZigzagStockOffset => short_rows(centers, conditions, begin, budget)?,
        Pattern::Engagement => vec![bounded(shape, conditions, budget)?],
    };
    let checked = |runs: Vec<Run>| Ok(Route { check: check(&runs, shape, conditions, budget)?, runs });
    ways.into_iter().map(checked).collect()
}

/// Passes whose angle is bounded. They keep the material on their right; for conventional milling those of
/// the mirrored region are mirrored.
fn bounded(shape: &Shape, conditions: &Conditions, budget: &Budget) -> Result<Vec<Run>, PocketError> {
    let Shape { centers, emptied, .. } = shape;
    if conditions.milling == Milling::Climb {
        let mut router = Router::new(conditions, centers, emptied, budget);
        engagement::cut(&mut router, centers, budget)?;
        return Ok(router.finish());
    }
    let mirrored = centers.mirrored();
    let emptied: Vec<Vec<Segment>> =
        emptied.iter().map(|path| path.iter().map(Segment::mirrored).collect()).collect();
    let mut router = Router::new(conditions, &mirrored, &emptied, budget);
    engagement::cut(&mut router, &mirrored, budget)?;
    Ok(router.finish().iter().map(Run::mirrored).collect())
}

/// Rows that end on the edge of the centres' region, or `inset_mm` inside, and a pass along the walls.
fn rows(
    centers: &Region,
    at_island: AtIsland,
    inset_mm: f64,
    mut router: Router,
    budget: &Budget,
) -> Result<Vec<Run>, PocketError> {
    let (radius, stepover) = (router.conditions.radius_mm, router.conditions.stepover_mm);
    let needed = centers.offset_inward(radius, budget)?;
    let inset = if inset_mm > 0.0 { centers.offset_inward(inset_mm, budget)? } else { centers.clone() };
    let chains = shortest([centers, &inset, &needed], radius, |[_, area, needed], frame| {
        rows::chains(&Layout { area, needed, stepover_mm: stepover, at_island }, frame, budget)
    })?;
    router.cut_nearest_end(chains)?;
    rings::cut_walls(centers, &mut router)?;
    Ok(router.finish())
}

/// Rows only where the pass along the walls leaves material, and that pass: as few rows as cover, and rows
/// with the stepover beside the walls too, which cost less where slots are cut slowly.
fn short_rows<'a>(
    centers: &Region,
    conditions: &Conditions,
    begin: impl Fn() -> Router<'a>,
    budget: &Budget,
) -> Result<Vec<Vec<Run>>, PocketError> {
    let (radius, stepover) = (conditions.radius_mm, conditions.stepover_mm);
    let mut insets = vec![radius];
    if conditions.has_slot_feed() && stepover < radius {
        insets.push(0.5 * stepover);
    }
    let cut = |inset: f64| {
        let needed = centers.offset_inward(inset, budget)?;
        let chains = shortest([centers, &needed], radius, |[centers, needed], frame| {
            strips::chains(needed, centers, radius, stepover, frame, budget)
        })?;
        let mut router = begin();
        router.cut_nearest_end(chains)?;
        rings::cut_walls(centers, &mut router)?;
        Ok(router.finish())
    };
    insets.into_iter().map(cut).collect()
}

/// The chains in the direction in which they are shortest, begun at any of the four corners. The first region
/// is that of the centres.
fn shortest<const N: usize>(
    regions: [&Region; N],
    radius_mm: f64,
    chains: impl Fn([&Region; N], Frame) -> Result<Vec<Vec<Segment>>, PocketError>,
) -> Result<Vec<Vec<Segment>>, PocketError> {
    let mirrored = regions.map(Region::mirrored);
    let mut best: Option<(f64, Vec<Vec<Segment>>)> = None;
    for is_mirrored in [false, true] {
        let regions = if is_mirrored { mirrored.each_ref() } else { regions };
        for frame in Frame::candidates(regions[0]) {
            for frame in [frame, frame.reversed()] {
                let mut chains = chains(regions, frame)?;
                if is_mirrored {
                    chains.iter_mut().flatten().for_each(|element| *element = element.mirrored());
                }
                let cost = cost(&chains, radius_mm);
                if best.as_ref().is_none_or(|(least, _)| cost < *least * (1.0 - EQUAL)) {
                    best = Some((cost, chains));
                }
            }
        }
    }
    Ok(best.map(|(_, chains)| chains).unwrap_or_default())
}

/// The length of chains and of the ways between them, where each follows the nearest end, with a length for
/// every way.
fn cost(chains: &[Vec<Segment>], radius_mm: f64) -> f64 {
    let mut cost: f64 = chains.iter().flatten().map(Segment::length).sum();
    let mut ends: Vec<[Point2<f64>; 2]> =
        chains.iter().map(|chain| [chain[0].start(), chain[chain.len() - 1].end()]).collect();
    let mut at: Option<Point2<f64>> = None;
    while !ends.is_empty() {
        let distance = |end: Point2<f64>| at.map_or(0.0, |at| (end - at).norm());
        let mut best = (f64::INFINITY, 0, 0);
        for (k, both) in ends.iter().enumerate() {
            for (side, end) in both.iter().enumerate() {
                if distance(*end) < best.0 {
                    best = (distance(*end), k, side);
                }
            }
        }
        let (distance, k, side) = best;
        cost += distance + COST_OF_CHAIN * radius_mm;
        at = Some(ends.remove(k)[1 - side]);
    }
    cost
}
