//! Rings about the islands, outward: the pattern `island_offset`.
//!
//! # Method
//! The rings are the fronts of the islands as they grow by a stepover at a time, within the region of centres
//! (`growth`). Islands closer than the tool are one, because the centres' region does not pass between them.
//! A pass along walls and islands follows.
//!
//! # Differences from the paper
//! A pocket without islands gets rings about its deepest place, so that the pattern always has a path. Where
//! a ring meets the wall, it is cut in parts.

use super::PocketError;
use super::depth::{deepest, disc};
use super::growth;
use super::rings;
use super::router::Router;
use crate::budget::Budget;
use crate::geometry::region::{Outline, Region};

/// The radius of the seed in a pocket without islands, as a part of the cutter's radius.
const SEED: f64 = 0.05;

pub fn cut(router: &mut Router, centers: &Region, budget: &Budget) -> Result<(), PocketError> {
    let (radius, stepover) = (router.conditions.radius_mm, router.conditions.stepover_mm);
    for part in centers.parts() {
        let islands: Vec<Outline> =
            part.faces().iter().flat_map(|face| &face.islands).map(Outline::reversed).collect();
        let seed = if islands.is_empty() {
            disc(deepest(&part, radius, budget)?, SEED * radius, budget)?
        } else {
            Region::new(&islands, &[], budget)?
        };
        for wave in growth::waves(&seed, &part, stepover.min(radius), budget)? {
            router.cut_nearest(wave)?;
        }
        rings::cut_walls(&part, router)?;
    }
    Ok(())
}
