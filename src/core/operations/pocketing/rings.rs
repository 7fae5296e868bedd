//! Rings at a constant distance from walls and islands: the pattern `island_stock_offset`.

use nalgebra::Point2;

use super::PocketError;
use super::chain::nearest;
use super::job::Milling;
use super::router::Router;
use crate::budget::Budget;
use crate::geometry::region::{Outline, Region};
use crate::geometry::segment::Segment;

/// The most rings of a level, and the most elements of all its rings.
const MOST_RINGS: usize = 100_000;
const MOST_ELEMENTS: usize = 300_000;

/// Places that are nearer to each other are the same, mm, as regions take them. The ends of neighbouring
/// parts differ by the rounding of two elements.
const SAME_PLACE_MM: f64 = 1e-6;

/// All rings of a region of centres. A ring comes before those inside it.
pub struct Rings {
    all: Vec<Ring>,
    outermost: Vec<usize>,
}

/// A face of the centres' region, or a face of the places at least a stepover inside the ring before.
struct Ring {
    face: Region,
    /// Open parts between this ring and the next that cover what neither of them does.
    between: Vec<Vec<Segment>>,
    /// The rings a stepover farther inside.
    inner: Vec<usize>,
}

/// The order in which rings are cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    InsideOut,
    OutsideIn,
}

/// The rings of a region of centres.
pub fn rings(
    centers: &Region,
    radius_mm: f64,
    stepover_mm: f64,
    budget: &Budget,
) -> Result<Rings, PocketError> {
    let mut rings = Rings { all: Vec::new(), outermost: Vec::new() };
    let mut n_elements = 0;
    let mut open: Vec<(Region, Option<usize>)> = Vec::new();
    open.extend(centers.parts().into_iter().rev().map(|face| (face, None)));
    while let Some((face, parent)) = open.pop() {
        let index = rings.all.len();
        match parent {
            Some(parent) => rings.all[parent].inner.push(index),
            None => rings.outermost.push(index),
        }
        n_elements += face.outlines().map(|outline| outline.elements().len()).sum::<usize>();
        if index >= MOST_RINGS || n_elements > MOST_ELEMENTS {
            return Err(PocketError::TooMuchWork { what: "rings", limit: MOST_RINGS });
        }
        let (inner, between) = next_inside(&face, radius_mm, stepover_mm, budget)?;
        open.extend(inner.into_iter().rev().map(|face| (face, Some(index))));
        rings.all.push(Ring { face, between, inner: Vec::new() });
    }
    Ok(rings)
}

/// The faces a stepover inside a face, and the open parts between.
fn next_inside(
    face: &Region,
    radius_mm: f64,
    stepover_mm: f64,
    budget: &Budget,
) -> Result<(Vec<Region>, Vec<Vec<Segment>>), PocketError> {
    let none = || Ok((Vec::new(), Vec::new()));
    // What is farther from the ring than the radius is not cut by it.
    if face.area() < std::f64::consts::PI * radius_mm * radius_mm {
        return none();
    }
    let uncut = face.offset_inward(radius_mm, budget)?;
    if uncut.is_empty() {
        return none();
    }
    let inner = face.offset_inward(stepover_mm, budget)?;
    let mut between = Vec::new();
    if stepover_mm > radius_mm {
        let left = if inner.is_empty() {
            uncut
        } else {
            uncut.difference(&inner.offset_outward(radius_mm, budget)?, budget)?
        };
        if !left.is_empty() {
            let near = left.offset_outward(radius_mm, budget)?;
            let middle = face.offset_inward(0.5 * stepover_mm, budget)?;
            for outline in middle.outlines() {
                between.extend(clipped(outline.elements(), &near));
            }
        }
    }
    Ok((inner.parts(), between))
}

/// The parts of a closed chain in a region, each connected; a whole loop as one chain.
pub fn clipped(elements: &[Segment], region: &Region) -> Vec<Vec<Segment>> {
    let mut chains: Vec<Vec<Segment>> = Vec::new();
    for element in elements {
        for [from, to] in region.ranges_inside(element, SAME_PLACE_MM) {
            let part = element.part(from, to);
            match chains.last_mut() {
                Some(chain)
                    if chain
                        .last()
                        .is_some_and(|last| (last.end() - part.start()).norm() < SAME_PLACE_MM) =>
                {
                    chain.push(part)
                }
                _ => chains.push(vec![part]),
            }
        }
    }
    if chains.len() > 1
        && let (Some(first), Some(last)) =
            (chains.first().and_then(|chain| chain.first()), chains.last().and_then(|chain| chain.last()))
        && (first.start() - last.end()).norm() < SAME_PLACE_MM
        && let Some(mut last) = chains.pop()
    {
        last.append(&mut chains[0]);
        chains[0] = last;
    }
    chains
}

/// The outlines of all rings, those inside first, and the open parts between them.
pub fn inside_out(rings: &Rings) -> Vec<Vec<Segment>> {
    let mut outlines = Vec::new();
    for ring in rings.all.iter().rev() {
        outlines.extend(ring.between.iter().cloned());
        outlines.extend(ring.face.outlines().map(|outline| outline.elements().to_vec()));
    }
    outlines
}

pub fn cut(rings: &Rings, order: Order, router: &mut Router) -> Result<(), PocketError> {
    // Rings side by side that are left, with the ring around them.
    let mut open = vec![(None, rings.outermost.clone())];
    while let Some((around, left)) = open.last_mut() {
        let Some(k) = next(rings, left, router.at()) else {
            let around: Option<usize> = *around;
            open.pop();
            if let Some(ring) = around.map(|k| &rings.all[k])
                && order == Order::InsideOut
            {
                cut_between(&ring.between, router)?;
                cut_loops(&ring.face, router, false)?;
            }
            continue;
        };
        let index = left.swap_remove(k);
        let ring = &rings.all[index];
        if order == Order::OutsideIn {
            // The first pass has material on both sides: what counts is the wall.
            cut_loops(&ring.face, router, around.is_some())?;
            cut_between(&ring.between, router)?;
        }
        open.push((Some(index), ring.inner.clone()));
    }
    Ok(())
}

/// The place in a list of the ring that is nearest.
fn next(rings: &Rings, left: &[usize], at: Option<Point2<f64>>) -> Option<usize> {
    let distance = |k: usize| at.map_or(0.0, |at| rings.all[left[k]].face.distance_to_boundary(at));
    (0..left.len()).min_by(|a, b| distance(*a).total_cmp(&distance(*b)))
}

fn cut_between(chains: &[Vec<Segment>], router: &mut Router) -> Result<(), PocketError> {
    for chain in chains {
        router.cut_chain(chain)?;
    }
    Ok(())
}

/// Cuts along all outlines of a face. `is_inside` if the material is inside the face.
fn cut_loops(face: &Region, router: &mut Router, is_inside: bool) -> Result<(), PocketError> {
    let mut left: Vec<&Outline> = face.outlines().collect();
    // Outlines have the face on their left.
    let is_reversed = is_inside != (router.conditions.milling == Milling::Conventional);
    while !left.is_empty() {
        let k = router.at().map_or(0, |at| {
            let distance = |outline: &&Outline| {
                let (k, t) = nearest(outline.elements(), at);
                (outline.elements()[k].at(t) - at).norm()
            };
            (0..left.len()).min_by(|a, b| distance(&left[*a]).total_cmp(&distance(&left[*b]))).unwrap_or(0)
        });
        let outline = left.remove(k);
        if is_reversed {
            router.cut_loop(outline.reversed().elements())?;
        } else {
            router.cut_loop(outline.elements())?;
        }
    }
    Ok(())
}
