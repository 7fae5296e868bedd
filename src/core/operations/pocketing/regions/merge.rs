//! Regions that overlap, or touch along a stretch, as one area.
//!
//! # Method
//! Regions whose boxes meet, directly or by way of others, are looked at together. Their union has no edge
//! where two of them touch. Where coordinates are rounded, a gap as narrow as the rounding may stay between
//! them. It is found by growing the union and shrinking it again: what this adds between two regions is
//! filled. A connected part of the union that holds places of several regions is one area. A region that
//! shares no part with another one stays exactly as it was given.

use std::collections::BTreeSet;

use nalgebra::Point2;

use super::super::PocketError;
use super::super::job::Outlines;
use super::near::Bounds;
use crate::budget::{Budget, Stopped};
use crate::geometry::region::{Face, Outline, OutlineError, Region, RegionError};
use crate::geometry::segment::Segment;

/// A wall between two regions that is thinner is rounding of their outlines, mm: twice the last decimal that
/// programs and drawings usually have.
const GAP_MM: f64 = 2e-3;

/// A gap is filled if its edge is at least this long, mm. Two corners that only touch have a shorter one.
const LEAST_EDGE_MM: f64 = 0.05;

/// An area to be cut.
pub struct Merged {
    pub area: Outlines,
    /// The indices of the regions for which the area stands, in ascending order.
    pub of: Vec<usize>,
}

/// The areas that regions make, in the order of the first region of each.
///
/// # Errors
/// When an outline is none, or a union cannot be computed.
pub fn merged(regions: &[Outlines], budget: &Budget) -> Result<Vec<Merged>, PocketError> {
    let mut all = Vec::new();
    for together in groups(regions, budget)? {
        match together[..] {
            [only] => all.push(Merged { area: regions[only].clone(), of: vec![only] }),
            _ => all.extend(areas(&together, regions, budget)?),
        }
    }
    all.sort_by(|a, b| a.of.cmp(&b.of));
    Ok(all)
}

/// The regions whose boxes meet, directly or by way of others.
fn groups(regions: &[Outlines], budget: &Budget) -> Result<Vec<Vec<usize>>, Stopped> {
    let bounds: Vec<Bounds> =
        regions.iter().map(|region| Bounds::of(&region.boundary).grown(0.5 * GAP_MM)).collect();
    let mut left: Vec<usize> = (0..regions.len()).collect();
    let mut groups = Vec::new();
    while let Some(first) = left.first().copied() {
        left.remove(0);
        let mut group = vec![first];
        let mut next = 0;
        while let Some(k) = group.get(next).copied() {
            budget.check()?;
            let is_near = |other: &usize| bounds[k].meets(&bounds[*other]);
            let (near, far): (Vec<usize>, Vec<usize>) = left.into_iter().partition(is_near);
            group.extend(near);
            left = far;
            next += 1;
        }
        group.sort_unstable();
        groups.push(group);
    }
    Ok(groups)
}

/// The areas of regions whose boxes meet.
fn areas(together: &[usize], regions: &[Outlines], budget: &Budget) -> Result<Vec<Merged>, PocketError> {
    let region = |k: &usize| exact(&regions[*k], budget).map_err(|error| error.of_regions(&[*k]));
    let exact: Vec<Region> = together.iter().map(region).collect::<Result<_, _>>()?;
    let parts = union(&exact, budget).map_err(|error| error.of_regions(together))?.parts();
    let owners = owners(&parts, &exact, budget).map_err(|error| error.of_regions(together))?;
    let is_alone = |k: usize| owners.iter().all(|owners| !owners.contains(&k) || owners.len() == 1);
    let mut all = Vec::new();
    for (_, index) in together.iter().enumerate().filter(|(k, _)| is_alone(*k)) {
        // Its parts are one area, as where there is no other region.
        all.push(Merged { area: regions[*index].clone(), of: vec![*index] });
    }
    for (part, owners) in parts.iter().zip(&owners) {
        if owners.iter().any(|k| !is_alone(*k)) {
            let of: Vec<usize> = owners.iter().map(|k| together[*k]).collect();
            all.extend(part.faces().iter().map(|face| Merged { area: outlines(face), of: of.clone() }));
        }
    }
    Ok(all)
}

fn outlines(face: &Face) -> Outlines {
    Outlines {
        boundary: face.outer.elements().to_vec(),
        islands: face.islands.iter().map(|island| island.elements().to_vec()).collect(),
    }
}

/// The region inside the wall and outside all islands, with all lines of its outlines.
///
/// # Errors
/// When an outline is none, the region cannot be computed, or islands fill it.
pub fn exact(area: &Outlines, budget: &Budget) -> Result<Region, PocketError> {
    let outline = |elements: &[Segment], island: Option<usize>| {
        Outline::new(elements, budget).map_err(|error| match error {
            OutlineError::Stopped(stopped) => PocketError::Stopped(stopped),
            error => PocketError::Outline { island, error },
        })
    };
    let boundary = outline(&area.boundary, None)?;
    let islands = area.islands.iter().enumerate().map(|(k, island)| outline(island, Some(k)));
    let region = Region::new(&[boundary], &islands.collect::<Result<Vec<_>, _>>()?, budget)?;
    if region.is_empty() { Err(PocketError::NothingToCut) } else { Ok(region) }
}

/// The union of regions, with the gaps between them filled that are as narrow as rounding.
fn union(regions: &[Region], budget: &Budget) -> Result<Region, PocketError> {
    let whole = Region::union(&regions.iter().collect::<Vec<_>>(), budget)?;
    match filled(&whole, regions, budget) {
        Ok(filled) => Ok(filled),
        Err(RegionError::Stopped(stopped)) => Err(stopped.into()),
        // The gaps stay: what is cut is what was asked for.
        Err(_) => Ok(whole),
    }
}

fn filled(whole: &Region, regions: &[Region], budget: &Budget) -> Result<Region, RegionError> {
    let grown = whole.offset_outward(0.5 * GAP_MM, budget)?;
    let added = grown.offset_inward(0.5 * GAP_MM, budget)?.difference(whole, budget)?;
    let mut all = vec![whole.clone()];
    for part in added.parts() {
        budget.check()?;
        if edge_mm(&part) >= LEAST_EDGE_MM && is_between(&part, regions) {
            all.push(part);
        }
    }
    if all.len() == 1 {
        return Ok(all.swap_remove(0));
    }
    Region::union(&all.iter().collect::<Vec<_>>(), budget)
}

fn edge_mm(region: &Region) -> f64 {
    region.outlines().flat_map(Outline::elements).map(Segment::length).sum()
}

/// Whether a narrow part is beside several regions.
fn is_between(part: &Region, regions: &[Region]) -> bool {
    let elements = || part.outlines().flat_map(Outline::elements);
    let longest = elements().max_by(|a, b| a.length().total_cmp(&b.length()));
    let Some(at) = longest.map(|element| element.at(0.5)) else { return false };
    regions.iter().filter(|region| region.distance_to_boundary(at) <= GAP_MM).nth(1).is_some()
}

/// For each part of the union the regions that have places in it.
fn owners(
    parts: &[Region],
    regions: &[Region],
    budget: &Budget,
) -> Result<Vec<BTreeSet<usize>>, PocketError> {
    let boxes: Vec<Option<[Point2<f64>; 2]>> = parts.iter().map(Region::bounding_box).collect();
    let mut owners = vec![BTreeSet::new(); parts.len()];
    for (k, region) in regions.iter().enumerate() {
        for piece in region.parts() {
            if let Some(part) = holder(&piece, parts, &boxes, budget)? {
                owners[part].insert(k);
            }
        }
    }
    Ok(owners)
}

/// The part that holds a connected piece: the one with which the piece has most area in common. `boxes` are
/// those of the parts.
fn holder(
    piece: &Region,
    parts: &[Region],
    boxes: &[Option<[Point2<f64>; 2]>],
    budget: &Budget,
) -> Result<Option<usize>, PocketError> {
    let Some(bounds) = piece.bounding_box() else { return Ok(None) };
    let holds = |around: &Option<[Point2<f64>; 2]>| around.is_some_and(|around| is_within(bounds, around));
    let possible: Vec<usize> = (0..parts.len()).filter(|k| holds(&boxes[*k])).collect();
    if let [only] = possible[..] {
        return Ok(Some(only));
    }
    let mut best = None;
    for k in possible {
        budget.check()?;
        let area = piece.intersection(&parts[k], budget)?.area();
        if best.is_none_or(|(_, most)| area > most) {
            best = Some((k, area));
        }
    }
    Ok(best.map(|(k, _)| k))
}

/// Whether a box is in another box, or reaches beyond it by rounding alone.
fn is_within([low, high]: [Point2<f64>; 2], [least, most]: [Point2<f64>; 2]) -> bool {
    let is_below = |a: Point2<f64>, b: Point2<f64>| a.x <= b.x + GAP_MM && a.y <= b.y + GAP_MM;
    is_below(least, low) && is_below(high, most)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chain(corners: &[[f64; 2]]) -> Vec<Segment> {
        let n = corners.len();
        let corner = |k: usize| Point2::from(corners[k % n]);
        (0..n).map(|k| Segment::Line { start: corner(k), end: corner(k + 1) }).collect()
    }

    fn rectangle([x, y]: [f64; 2], [width, height]: [f64; 2]) -> Vec<Segment> {
        chain(&[[x, y], [x + width, y], [x + width, y + height], [x, y + height]])
    }

    fn region(at: [f64; 2], size: [f64; 2]) -> Outlines {
        Outlines { boundary: rectangle(at, size), islands: Vec::new() }
    }

    /// The regions of each area, with its area in mm2 and the number of its islands.
    fn made(regions: &[Outlines]) -> Vec<(Vec<usize>, f64, usize)> {
        let budget = Budget::unlimited();
        let figures = |merged: Merged| {
            let region = exact(&merged.area, &budget).unwrap();
            let islands = region.faces().iter().map(|face| face.islands.len()).sum();
            (merged.of, (region.area() * 100.0).round() / 100.0, islands)
        };
        merged(regions, &budget).unwrap().into_iter().map(figures).collect()
    }

    #[test]
    fn regions_apart_stay_as_they_were_given() {
        let regions = [region([0.0, 0.0], [10.0, 10.0]), region([20.0, 0.0], [10.0, 5.0])];
        let merged = merged(&regions, &Budget::unlimited()).unwrap();
        assert_eq!(
            merged.iter().map(|merged| &merged.area).collect::<Vec<_>>(),
            regions.iter().collect::<Vec<_>>()
        );
    }

    #[test]
    fn regions_that_share_a_wall_or_overlap_are_one() {
        let shared = [region([0.0, 0.0], [10.0, 10.0]), region([10.0, 2.0], [10.0, 5.0])];
        assert_eq!(made(&shared), [(vec![0, 1], 150.0, 0)]);
        let overlapping = [region([0.0, 0.0], [10.0, 10.0]), region([8.0, 2.0], [12.0, 5.0])];
        assert_eq!(made(&overlapping), [(vec![0, 1], 150.0, 0)]);
        // The third joins the others, and the second is alone in the middle of the list.
        let chain = [
            region([0.0, 0.0], [10.0, 10.0]),
            region([50.0, 0.0], [5.0, 5.0]),
            region([10.0, 0.0], [10.0, 10.0]),
        ];
        assert_eq!(made(&chain), [(vec![0, 2], 200.0, 0), (vec![1], 25.0, 0)]);
    }

    #[test]
    fn regions_that_meet_in_a_point_stay_apart() {
        let corners = [region([0.0, 0.0], [10.0, 10.0]), region([10.0, 10.0], [10.0, 10.0])];
        assert_eq!(made(&corners), [(vec![0], 100.0, 0), (vec![1], 100.0, 0)]);
    }

    #[test]
    fn equal_regions_and_a_region_in_another_are_one() {
        let regions = [region([0.0, 0.0], [10.0, 10.0]), region([2.0, 2.0], [3.0, 3.0])];
        assert_eq!(made(&regions), [(vec![0, 1], 100.0, 0)]);
        let twice = [regions[1].clone(), regions[1].clone()];
        assert_eq!(made(&twice), [(vec![0, 1], 9.0, 0)]);
    }

    #[test]
    fn a_region_on_the_island_of_another_is_an_area_of_its_own_until_it_crosses_the_edge() {
        let mut ring = region([0.0, 0.0], [30.0, 30.0]);
        ring.islands.push(rectangle([10.0, 10.0], [10.0, 10.0]));
        let inner = region([12.0, 12.0], [4.0, 4.0]);
        assert_eq!(made(&[ring.clone(), inner]), [(vec![0], 800.0, 1), (vec![1], 16.0, 0)]);
        let across = region([8.0, 12.0], [6.0, 4.0]);
        assert_eq!(made(&[ring, across]), [(vec![0, 1], 816.0, 1)]);
    }

    #[test]
    fn walls_that_are_apart_by_the_rounding_of_coordinates_are_one() {
        let left = Outlines {
            boundary: chain(&[[0.0, 0.0], [30.0, 10.0], [20.0, 40.0], [-10.0, 30.0]]),
            islands: Vec::new(),
        };
        // The corner would be at a third and two thirds of the slanted wall, with more decimals.
        for shift in [0.0, 0.0009] {
            let (a, b) = ([26.667 + shift, 20.0], [23.333 + shift, 30.0]);
            let right =
                Outlines { boundary: chain(&[a, [50.0, 20.0], [50.0, 30.0], b]), islands: Vec::new() };
            let made = made(&[left.clone(), right]);
            assert_eq!(made.len(), 1, "{made:?}");
            assert_eq!((&made[0].0, made[0].2), (&vec![0, 1], 0));
        }
    }

    #[test]
    fn the_error_of_a_region_names_it() {
        let crossed = chain(&[[5.0, 0.0], [15.0, 10.0], [15.0, 0.0], [5.0, 10.0]]);
        let crossed = Outlines { boundary: crossed, islands: Vec::new() };
        let error = merged(&[region([0.0, 0.0], [10.0, 10.0]), crossed], &Budget::unlimited()).err();
        let named = matches!(&error, Some(PocketError::OfRegions { regions, .. }) if regions == &[1]);
        assert!(named, "{error:?}");
    }
}
