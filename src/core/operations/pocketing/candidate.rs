//! Candidates: the route of each pattern, with its check.

use nalgebra::Point2;

use super::PocketError;
use super::check::{Check, check};
use super::conditions::Conditions;
use super::crossings::Frame;
use super::entry::Entry;
use super::job::{Load, Milling, Pattern};
use super::level::{Room, Shape};
use super::rings::{self, Order};
use super::router::{Router, Run};
use super::rows::{self, AtIsland, Layout};
use super::walls::Followed;
use super::{engagement, islands, strips, walls, work};
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

impl Route {
    /// How often the cutter comes down where material stands.
    pub fn n_entries(&self) -> usize {
        self.runs.iter().filter(|run| run.entry != Entry::Open).count()
    }
}

/// The routes of a pattern, of which the fastest is to be taken. Each first clears the inner region of the
/// room in its own way, and then cuts along walls and islands.
pub fn routes(
    pattern: Pattern,
    shape: &Shape,
    conditions: &Conditions,
    budget: &Budget,
) -> Result<Vec<Route>, PocketError> {
    // Earlier tools may have left little to do.
    if shape.emptied.is_empty() || shape.is_open() {
        work::check(pattern, shape.path_length_mm(conditions.stepover_mm), conditions)?;
    }
    let Shape { room, emptied, .. } = shape;
    let (radius, stepover) = (conditions.radius_mm, conditions.stepover_mm);
    let begin = || Router::new(conditions, &room.safe, emptied, budget).with_open_edges(shape.is_open());
    let layout = |area: Region, needed: Region, at_island| Ok::<_, PocketError>((area, needed, at_island));
    let ways = match pattern {
        Pattern::IslandOffset => {
            let mut router = begin();
            islands::cut(&mut router, room, budget)?;
            vec![walled(router, room)?]
        }
        Pattern::IslandStockOffset => {
            let rings = rings::rings(&room.inner, radius, stepover, budget)?;
            let cut = |order| {
                let mut router = begin();
                rings::cut(&rings, order, &mut router)?;
                walled(router, room)
            };
            [Order::InsideOut, Order::OutsideIn].into_iter().map(cut).collect::<Result<_, PocketError>>()?
        }
        Pattern::ZigzagStockOffset => short_rows(room, conditions, begin, budget)?,
        Pattern::Engagement => vec![bounded(shape, conditions, budget)?],
        Pattern::ZigzagOffset | Pattern::ContinuousOffset | Pattern::ContinuousStockOffset => {
            let at_island = if pattern == Pattern::ZigzagOffset { AtIsland::Turn } else { AtIsland::Around };
            let needed = room.centers.offset_inward(radius, budget)?;
            let (area, needed, at_island) = match (conditions.load, pattern) {
                (Load::Bounded, _) if room.is_layer_whole => {
                    layout(room.inner.clone(), room.inner.clone(), at_island)?
                }
                (_, Pattern::ContinuousStockOffset) => {
                    // Rows that end this far inside free all that the pass along the walls does not.
                    let inset = radius - 0.5 * stepover;
                    let area = if inset > 0.0 {
                        room.centers.offset_inward(inset, budget)?
                    } else {
                        room.safe.clone()
                    };
                    layout(area, needed, at_island)?
                }
                _ => layout(room.safe.clone(), needed, at_island)?,
            };
            vec![rows(room, [&area, &needed], at_island, begin(), budget)?]
        }
    };
    let checked = |runs: Vec<Run>| Ok(Route { check: check(&runs, shape, conditions, budget)?, runs });
    ways.into_iter().map(checked).collect()
}

/// The runs of a router after the pass along walls and islands.
fn walled<'a>(mut router: Router<'a>, room: &'a Room) -> Result<Vec<Run>, PocketError> {
    walls::cut(&mut router, room, Followed::WhereMaterialIs)?;
    Ok(router.finish())
}

/// Passes whose angle is bounded. They keep the material on their right; for conventional milling those of
/// the mirrored region are mirrored.
fn bounded(shape: &Shape, conditions: &Conditions, budget: &Budget) -> Result<Vec<Run>, PocketError> {
    let Shape { room, emptied, .. } = shape;
    let cut = |room: &Room, emptied: &[Vec<Segment>], conditions: &Conditions| {
        let mut router =
            Router::new(conditions, &room.inner, emptied, budget).with_open_edges(shape.is_open());
        engagement::cut(&mut router, &room.inner, budget)?;
        walls::cut(&mut router, room, Followed::WhereMaterialIs)?;
        Ok(router.finish())
    };
    if conditions.milling == Milling::Climb {
        return cut(room, emptied, conditions);
    }
    let emptied: Vec<Vec<Segment>> =
        emptied.iter().map(|path| path.iter().map(Segment::mirrored).collect()).collect();
    let runs: Vec<Run> = cut(&room.mirrored(), &emptied, &conditions.mirrored())?;
    Ok(runs.iter().map(Run::mirrored).collect())
}

/// Runs along rows, and then along walls and islands. The rows end on the edge of `area`. They lie so close
/// that no place of `needed` is farther than half a stepover beside a row.
fn rows<'a>(
    room: &'a Room,
    [area, needed]: [&Region; 2],
    at_island: AtIsland,
    mut router: Router<'a>,
    budget: &Budget,
) -> Result<Vec<Run>, PocketError> {
    let (radius, stepover) = (router.conditions.radius_mm, router.conditions.stepover_mm);
    let chains = shortest([&room.centers, area, needed], radius, |[_, area, needed], frame| {
        rows::chains(&Layout { area, needed, stepover_mm: stepover, at_island }, frame, budget)
    })?;
    router.cut_nearest_end(chains)?;
    walled(router, room)
}

/// Rows only where the pass along the walls leaves material, and that pass. Where the load is bounded, the
/// pass along the walls leaves all but a layer as thick as the stepover.
fn short_rows<'a>(
    room: &'a Room,
    conditions: &Conditions,
    begin: impl Fn() -> Router<'a>,
    budget: &Budget,
) -> Result<Vec<Vec<Run>>, PocketError> {
    let (radius, stepover) = (conditions.radius_mm, conditions.stepover_mm);
    let needed = match conditions.load {
        // Rows are up to half a stepover nearer to the walls than what they clear.
        Load::Bounded => {
            let inset = stepover.max(0.5 * stepover + room.side_mm).min(radius);
            room.centers.offset_inward(inset, budget)?
        }
        Load::Paper => room.centers.offset_inward(radius, budget)?,
    };
    let chains = shortest([&room.centers, &needed], radius, |[centers, needed], frame| {
        strips::chains(needed, centers, radius, stepover, frame, budget)
    })?;
    let mut router = begin();
    router.cut_nearest_end(chains)?;
    Ok(vec![walled(router, room)?])
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
