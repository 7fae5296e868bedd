//! Rings about the islands, outward: the pattern `island_offset`.
//!
//! # Method
//! The rings are the fronts of the islands as they grow by a stepover at a time, within the region of centres
//! (`growth`). Islands closer than the tool are one, because the centres' region does not pass between them.
//! The fronts keep away from the walls.
//!
//! # Differences from the paper
//! A pocket without islands gets rings about its deepest place, so that the pattern always has a path. Where
//! a ring meets the wall, it is cut in parts.

use super::PocketError;
use super::depth::{deepest, disc};
use super::growth;
use super::level::Room;
use super::router::Router;
use crate::budget::Budget;
use crate::geometry::region::{Outline, Region};

/// The radius of the seed in a pocket without islands, as a part of the cutter's radius.
const SEED: f64 = 0.05;

/// The least step of the fronts where no step keeps all of the safe region within reach, in cutter radii.
const LEAST_STEP: f64 = 0.25;

pub fn cut<'a>(router: &mut Router<'a>, room: &'a Room, budget: &Budget) -> Result<(), PocketError> {
    let (radius, stepover) = (router.conditions.radius_mm, router.conditions.stepover_mm);
    // A place beside the edge of the safe region is left to the pass along the walls.
    let step = stepover.min((radius - room.side_mm).max(LEAST_STEP * radius));
    for part in room.safe.parts() {
        let islands: Vec<Outline> =
            part.faces().iter().flat_map(|face| &face.islands).map(Outline::reversed).collect();
        let seed = if islands.is_empty() {
            disc(deepest(&part, radius, budget)?, SEED * radius, budget)?
        } else {
            Region::new(&islands, &[], budget)?
        };
        for wave in growth::waves(&seed, &part, step, budget)? {
            router.cut_nearest(wave)?;
        }
    }
    Ok(())
}
