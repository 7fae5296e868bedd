//! Waves: the fronts of a region that grows from a seed by equal steps until it fills the centres' region.
//!
//! # Guarantees
//! Let the step be at most the cutter's radius. Then every place of the centres' region is within the radius
//! of a front, or of the edge of the centres' region: the place of the grown region that is nearest to it is
//! on a front or on the edge.

use super::PocketError;
use super::depth::{deepest, disc};
use crate::budget::Budget;
use crate::geometry::region::Region;
use crate::geometry::segment::Segment;

/// The most steps, and the most elements of all fronts.
const MOST_STEPS: usize = 100_000;
const MOST_ELEMENTS: usize = 300_000;

/// Parts of the boundary that are nearer to the edge of the centres' region belong to the edge, mm.
const ON_EDGE_MM: f64 = 1e-5;

/// A region that grows by less in one step has filled all that it can come to, mm².
const STANDSTILL_MM2: f64 = 1e-7;

/// A place beyond a channel gets a seed of its own if its area is larger than this part of the square of a
/// step. Smaller places are rounding.
const LEAST_PART: f64 = 0.01;

/// The radius of such a seed, in steps.
const SEED: f64 = 0.05;

/// The fronts after each step, as chains with the grown region on their left.
pub fn waves(
    seed: &Region,
    centers: &Region,
    step_mm: f64,
    budget: &Budget,
) -> Result<Vec<Vec<Vec<Segment>>>, PocketError> {
    let mut grown = seed.clone();
    let mut area = 0.0;
    let mut waves = Vec::new();
    let mut n_elements = 0;
    for _ in 0..MOST_STEPS {
        grown = grown.offset_outward(step_mm, budget)?.intersection(centers, budget)?;
        let before = std::mem::replace(&mut area, grown.area());
        let fronts = fronts(&grown, centers);
        if fronts.is_empty() && area - before <= STANDSTILL_MM2 {
            // The region does not grow through a channel that is hardly wider than the cutter. A place beyond
            // the channel gets a seed of its own.
            let left = centers.difference(&grown, budget)?;
            let parts = left.parts();
            let Some(beyond) = parts.iter().find(|part| part.area() > LEAST_PART * step_mm * step_mm) else {
                return Ok(waves);
            };
            let seed = disc(deepest(beyond, step_mm, budget)?, SEED * step_mm, budget)?;
            grown = Region::union(&[&grown, &seed], budget)?;
            continue;
        }
        n_elements += fronts.iter().map(Vec::len).sum::<usize>();
        if n_elements > MOST_ELEMENTS {
            break;
        }
        waves.push(fronts);
    }
    Err(PocketError::TooMuchWork { what: "rings", limit: MOST_STEPS })
}

/// The chains of a region's boundary that are not on the edge of another region.
fn fronts(grown: &Region, centers: &Region) -> Vec<Vec<Segment>> {
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
