//! Waves: the fronts of a region that grows from a seed by equal steps until it fills the centres' region.
//!
//! # Guarantees
//! Let the step be at most the cutter's radius. Then every place of the centres' region is within the radius
//! of a front, or of the edge of the centres' region: the place of the grown region that is nearest to it is
//! on a front or on the edge.

use super::PocketError;
use crate::budget::Budget;
use crate::geometry::element::Element;
use crate::geometry::region::Region;

/// The most steps, and the most elements of all fronts.
const MOST_STEPS: usize = 100_000;
const MOST_ELEMENTS: usize = 300_000;

/// Parts of the boundary that are nearer to the edge of the centres' region belong to the edge, mm.
const ON_EDGE_MM: f64 = 1e-5;

/// The fronts after each step, as chains with the grown region on their left.
pub fn waves(
    seed: &Region,
    centers: &Region,
    step_mm: f64,
    budget: &Budget,
) -> Result<Vec<Vec<Vec<Element>>>, PocketError> {
    let mut grown = seed.clone();
    let mut waves = Vec::new();
    let mut n_elements = 0;
    while waves.len() < MOST_STEPS && n_elements <= MOST_ELEMENTS {
        grown = grown.offset_outward(step_mm, budget)?.intersection(centers, budget)?;
        let fronts = fronts(&grown, centers);
        if fronts.is_empty() {
            return Ok(waves);
        }
        n_elements += fronts.iter().map(Vec::len).sum::<usize>();
        waves.push(fronts);
    }
    Err(PocketError::TooMuchWork { what: "rings", limit: MOST_STEPS })
}

/// The chains of a region's boundary that are not on the edge of another region.
fn fronts(grown: &Region, centers: &Region) -> Vec<Vec<Element>> {
    let mut fronts = Vec::new();
    for outline in grown.outlines() {
        let elements = outline.elements();
        let is_front: Vec<bool> = elements
            .iter()
            .map(|element| centers.distance_to_boundary(element.at(0.5)) > ON_EDGE_MM)
            .collect();
        // A loop that begins in the middle of a front is begun at its first element on the edge.
        let first = is_front.iter().position(|is_front| !is_front).unwrap_or(0);
        let mut chain = Vec::new();
        for k in (first..elements.len()).chain(0..first) {
            if is_front[k] {
                chain.push(elements[k]);
            } else if !chain.is_empty() {
                fronts.push(std::mem::take(&mut chain));
            }
        }
        if !chain.is_empty() {
            fronts.push(chain);
        }
    }
    fronts
}
