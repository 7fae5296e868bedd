//! Islands of a region that another region cuts: an island stays in its own region alone.

use super::super::PocketError;
use super::super::job::Outlines;
use super::merge::exact;
use super::near::Bounds;
use crate::budget::Budget;
use crate::geometry::region::{Outline, Region};
use crate::geometry::segment::Segment;

/// Outlines that overlap by less than this width all along do not overlap, mm: coordinates are rounded.
const TOUCHING_MM: f64 = 1e-3;

/// An island of which another region cuts a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CutIsland {
    /// The region that has the island, and the index of the island in it.
    pub region: usize,
    pub island: usize,
    /// The first region that cuts a part of it.
    pub by: usize,
}

/// The islands across whose edge another region reaches. A region that lies wholly on an island is meant to
/// be there.
///
/// # Errors
/// The budget's stop. Outlines that are none, or cannot be told apart, are left out.
pub fn cut_islands(regions: &[Outlines], budget: &Budget) -> Result<Vec<CutIsland>, PocketError> {
    let bounds: Vec<Bounds> = regions.iter().map(|region| Bounds::of(&region.boundary)).collect();
    let mut all = Vec::new();
    for (k, region) in regions.iter().enumerate().filter(|(_, region)| !region.islands.is_empty()) {
        budget.check()?;
        let near = (0..regions.len()).filter(|other| *other != k && bounds[k].meets(&bounds[*other]));
        let mut others: Vec<(usize, Region)> = Vec::new();
        for other in near {
            others.extend(known(exact(&regions[other], budget))?.map(|region| (other, region)));
        }
        if others.is_empty() {
            continue;
        }
        let wall = Outlines { islands: Vec::new(), ..region.clone() };
        let Some(wall) = known(exact(&wall, budget))? else { continue };
        for (island, outline) in region.islands.iter().enumerate() {
            budget.check()?;
            let around = Bounds::of(outline);
            for (by, other) in others.iter().filter(|(by, _)| bounds[*by].meets(&around)) {
                if known(is_cut(outline, &wall, other, budget))? == Some(true) {
                    all.push(CutIsland { region: k, island, by: *by });
                    break;
                }
            }
        }
    }
    Ok(all)
}

/// What was found; none where the outlines do not allow it.
fn known<T>(found: Result<T, PocketError>) -> Result<Option<T>, PocketError> {
    match found {
        Ok(found) => Ok(Some(found)),
        Err(error @ PocketError::Stopped(_)) => Err(error),
        Err(_) => Ok(None),
    }
}

/// Whether a region cuts a part of an island inside a wall and lies beside the island too.
fn is_cut(island: &[Segment], wall: &Region, other: &Region, budget: &Budget) -> Result<bool, PocketError> {
    let island = Outlines { boundary: island.to_vec(), islands: Vec::new() };
    let stays = exact(&island, budget)?.intersection(wall, budget)?;
    let common_mm2 = stays.intersection(other, budget)?.area();
    let is_beside = other.area() - common_mm2 > TOUCHING_MM * edge_mm(other);
    Ok(is_beside && common_mm2 > TOUCHING_MM * edge_mm(&stays))
}

fn edge_mm(region: &Region) -> f64 {
    region.outlines().flat_map(Outline::elements).map(Segment::length).sum()
}

#[cfg(test)]
mod tests {
    use nalgebra::Point2;

    use super::*;

    fn rectangle([x, y]: [f64; 2], [width, height]: [f64; 2]) -> Vec<Segment> {
        let corner = [[x, y], [x + width, y], [x + width, y + height], [x, y + height]].map(Point2::from);
        (0..4).map(|k| Segment::Line { start: corner[k], end: corner[(k + 1) % 4] }).collect()
    }

    #[test]
    fn only_a_region_across_the_edge_of_an_island_cuts_it() {
        let region = |at, size| Outlines { boundary: rectangle(at, size), islands: Vec::new() };
        let ring = Outlines {
            islands: vec![rectangle([2.0, 2.0], [3.0, 3.0]), rectangle([10.0, 10.0], [10.0, 10.0])],
            ..region([0.0, 0.0], [30.0, 30.0])
        };
        let cut = |other| {
            cut_islands(&[region([90.0, 0.0], [1.0, 1.0]), ring.clone(), other], &Budget::unlimited())
        };
        // Inside of the island, in its edge, beside it, and across its edge.
        assert_eq!(cut(region([12.0, 12.0], [4.0, 4.0])), Ok(vec![]));
        assert_eq!(cut(region([10.0, 12.0], [4.0, 4.0])), Ok(vec![]));
        assert_eq!(cut(region([6.0, 12.0], [4.0, 4.0])), Ok(vec![]));
        let found = CutIsland { region: 1, island: 1, by: 2 };
        assert_eq!(cut(region([8.0, 12.0], [4.0, 4.0])), Ok(vec![found]));
    }
}
