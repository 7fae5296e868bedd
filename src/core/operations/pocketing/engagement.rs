//! Passes whose angle in the material is bounded: the pattern `engagement`.
//!
//! # Method
//! 1. The cutter follows the middle of the region (`core`), which is a slot, and leaves it on a spiral. Where
//!    no middle leads to nearly all places, it comes down on the largest helix about the deepest place, and
//!    leaves that on a spiral.
//! 2. Away from walls, the cutter follows arcs that continue each other, each turned so that the angle in the
//!    material at its end is the target (`tracker`). Whatever shape is left, the angle is kept.
//! 3. The wall is the boundary of the region of centres with its inner corners rounded by a small radius. The
//!    cutter always has room for a full circle of this radius to the left. So it can always turn away, come
//!    to the wall along it, and leave the floor that is cleared by a lead-out.
//! 4. Where a pass left the wall, material begins, and a later pass begins there, on the wall. Passes follow
//!    each other nearest first, by a smooth link over cleared ground, or by a lift. In a channel these
//!    passes are trochoids.
//! 5. At the end, rings are followed where they meet material: inner corners, and what no pass came to. Where
//!    earlier tools have emptied some of the pocket, this step is the only one.
//!
//! # Guarantees
//! The angle is bounded along every pass as for all patterns. Where it exceeds 1.1 of that of the stepover is
//! in the report: the middle, inner corners, necks in which the cutter cannot turn, and ramps where no helix
//! fits.

mod core;
mod tracker;
mod wall;

use nalgebra::{Point2, Vector2};

use super::PocketError;
use super::conditions::Conditions;
use super::depth::deepest;
use super::entry::{self, Entry};
use super::pieces::Pieces;
use super::rings;
use super::router::{Purpose, Router};
use crate::budget::Budget;
use crate::geometry::offset::swept;
use crate::geometry::region::{Outline, Region};
use crate::geometry::segment::Segment;
use tracker::Tracker;
use wall::Wall;

/// The radius of the tightest turn to the left, in stepovers, and its limit in cutter radii.
const TIGHTEST: [f64; 2] = [0.5, 0.25];

pub fn cut(router: &mut Router, centers: &Region, budget: &Budget) -> Result<(), PocketError> {
    let conditions = router.conditions;
    let tight = tightest(conditions);
    let turning = centers.offset_inward(tight, budget)?;
    if !turning.is_empty() && !router.is_rest() {
        let rounded = turning.offset_outward(tight, budget)?;
        for part in rounded.parts() {
            open_part(router, &part, &turning, tight, budget)?;
        }
    }
    cut_rest(router, centers, tight, budget)
}

/// Comes down in a connected part, and cuts from there on as long as passes meet material.
fn open_part(
    router: &mut Router,
    part: &Region,
    turning: &Region,
    tight: f64,
    budget: &Budget,
) -> Result<(), PocketError> {
    let conditions = router.conditions;
    let told = router.told_place(part);
    let place = match told {
        Some(at) => at,
        None => deepest(part, conditions.radius_mm, budget)?,
    };
    let room = part.distance_to_boundary(place);
    let wall = Wall::new(part);
    if told.is_none()
        && let Some(core) = core::of(part, room, conditions, budget)?
    {
        let loops: Vec<&[Segment]> = core.outlines().map(Outline::elements).collect();
        for elements in &loops {
            router.cut_loop(elements)?;
        }
        return Tracker::new(router, &wall, turning, tight, budget).clear_beside(&loops);
    }
    let radius = room.min(0.5 * conditions.entry.max_diameter_mm);
    if radius < (0.5 * conditions.entry.min_diameter_mm).max(tight) {
        return Ok(());
    }
    if told.is_some() && conditions.entry.is_predrilled {
        router.begin(place, Entry::Plunge);
        router.follow(&entry::spiral(place, radius, conditions.stepover_mm), Purpose::Cut)?;
    } else {
        router.begin(place + Vector2::x() * radius, Entry::Helix { center: place, is_left: true });
    }
    Tracker::new(router, &wall, turning, tight, budget).clear()
}

fn tightest(conditions: &Conditions) -> f64 {
    (TIGHTEST[0] * conditions.stepover_mm).min(TIGHTEST[1] * conditions.radius_mm)
}

/// Whether the path so far leaves material farther from walls than a pass along them cuts.
fn is_left_inside(router: &Router, centers: &Region, budget: &Budget) -> Result<bool, PocketError> {
    let radius = router.conditions.radius_mm;
    let chains = router.chains();
    let chains: Vec<&[Segment]> = chains.iter().map(Vec::as_slice).collect();
    let inside = centers.offset_inward(radius, budget)?;
    let boundary = swept::boundary(&chains, radius, budget)?;
    Ok(boundary.iter().any(|element| !inside.ranges_inside(element, 0.0).is_empty()))
}

/// Follows rings where material is left.
fn cut_rest(router: &mut Router, centers: &Region, tight: f64, budget: &Budget) -> Result<(), PocketError> {
    let (radius, stepover) = (router.conditions.radius_mm, router.conditions.stepover_mm);
    let outlines = if router.is_rest() || is_left_inside(router, centers, budget)? {
        rings::inside_out(&rings::rings(centers, radius, stepover, budget)?)
    } else {
        centers.outlines().map(|outline| outline.elements().to_vec()).collect()
    };
    for outline in outlines {
        let pieces = match router.pieces(&outline, 0.0)? {
            Pieces::Whole if outline[0].start() == outline[outline.len() - 1].end() => {
                router.cut_loop(&outline)?;
                continue;
            }
            Pieces::Whole => vec![outline],
            Pieces::Some(pieces) => pieces,
        };
        for piece in pieces {
            let (first, last) = (piece[0], piece[piece.len() - 1]);
            let left = |v: Vector2<f64>| Vector2::new(-v.y, v.x) * tight;
            let turn: [Point2<f64>; 2] =
                [first.start() + left(first.direction(0.0)), last.end() + left(last.direction(1.0))];
            if router.lead_to(&piece, turn[0])? {
                router.follow(&piece, Purpose::Cut)?;
                router.leave_about(turn[1]);
            }
        }
    }
    Ok(())
}
