//! Passes whose angle in the material is bounded: the pattern `engagement`.
//!
//! # Method
//! 1. The cutter comes down on the largest helix about the deepest place and leaves it on a spiral.
//! 2. Away from walls, the cutter follows arcs that continue each other, each turned so that the angle in the
//!    material at its end is the target (`tracker`). Whatever shape is left, the angle is kept.
//! 3. The wall is the boundary of the region of centres with its inner corners rounded by a small radius. The
//!    cutter always has room for a full circle of this radius to the left. So it can always turn away, come
//!    to the wall along it, and leave the floor that is cleared by a lead-out.
//! 4. Where a pass left the wall, material begins, and a later pass begins there, on the wall. Passes follow
//!    each other nearest first, by a straight link with arcs on both ends, or by a lift. In a channel these
//!    passes are trochoids.
//! 5. At the end, rings are followed where they meet material: inner corners, and what no pass came to.
//!
//! # Guarantees
//! The angle is bounded along every pass as for all patterns. Where it exceeds 1.1 of that of the stepover is
//! in the report: inner corners, necks in which the cutter cannot turn, and ramps where no helix fits.

mod tracker;
mod wall;

use nalgebra::{Point2, Vector2};

use super::PocketError;
use super::conditions::Conditions;
use super::depth::deepest;
use super::entry::Entry;
use super::rings;
use super::router::{Purpose, Router};
use crate::budget::Budget;
use crate::geometry::element::Element;
use crate::geometry::offset::swept;
use crate::geometry::region::Region;
use tracker::Tracker;
use wall::Wall;

/// The radius of the tightest turn to the left, in stepovers, and its limit in cutter radii.
const TIGHTEST: [f64; 2] = [0.5, 0.25];

/// Pieces of rings with smaller angles are not followed again, radians: what they leave is thinner than a
/// hundredth of the radius.
const SLIVER: f64 = 0.1;

/// Pieces of a ring that are nearer to each other are cut as one, in cutter radii.
const JOINED: f64 = 1.0;

pub fn cut(router: &mut Router, centers: &Region, budget: &Budget) -> Result<(), PocketError> {
    let conditions = router.conditions;
    let tight = tightest(conditions);
    let turning = centers.offset_inward(tight, budget)?;
    if !turning.is_empty() {
        let rounded = turning.offset_outward(tight, budget)?;
        for part in rounded.parts() {
            let place = deepest(&part, conditions.radius_mm, budget)?;
            let radius = part.distance_to_boundary(place).min(0.5 * conditions.entry.max_diameter_mm);
            if radius < (0.5 * conditions.entry.min_diameter_mm).max(tight) {
                continue;
            }
            router.begin(place + Vector2::x() * radius, Entry::Helix { center: place, is_left: true });
            let wall = Wall::new(&part);
            Tracker::new(router, &wall, &turning, tight, budget).clear()?;
        }
    }
    cut_rest(router, centers, tight, budget)
}

fn tightest(conditions: &Conditions) -> f64 {
    (TIGHTEST[0] * conditions.stepover_mm).min(TIGHTEST[1] * conditions.radius_mm)
}

/// Follows rings where material is left.
fn cut_rest(router: &mut Router, centers: &Region, tight: f64, budget: &Budget) -> Result<(), PocketError> {
    let (radius, stepover) = (router.conditions.radius_mm, router.conditions.stepover_mm);
    let chains = router.chains();
    let chains: Vec<&[Element]> = chains.iter().map(Vec::as_slice).collect();
    let inside = centers.offset_inward(radius, budget)?;
    let is_left_inside = swept::boundary(&chains, radius, budget)?
        .iter()
        .any(|element| !inside.ranges_inside(element, 0.0).is_empty());
    let outlines = if is_left_inside {
        rings::inside_out(&rings::rings(centers, radius, stepover, budget)?)
    } else {
        centers.outlines().map(|outline| outline.elements().to_vec()).collect()
    };
    for outline in outlines {
        let pieces = pieces(router, &outline)?;
        let is_loop = outline[0].start() == outline[outline.len() - 1].end();
        if is_loop && pieces.len() == 1 && pieces[0].len() >= outline.len() {
            router.cut_loop(&outline)?;
            continue;
        }
        for piece in pieces {
            let (first, last) = (piece[0], piece[piece.len() - 1]);
            let left = |v: Vector2<f64>| Vector2::new(-v.y, v.x) * tight;
            let turn: [Point2<f64>; 2] =
                [first.start() + left(first.direction(0.0)), last.end() + left(last.direction(1.0))];
            router.lead_to(first.start(), turn[0])?;
            router.follow(&piece, Purpose::Cut)?;
            router.leave_about(turn[1]);
        }
    }
    Ok(())
}

/// The pieces of a loop along which there is material; the loop itself where there is material all along.
fn pieces(router: &mut Router, outline: &[Element]) -> Result<Vec<Vec<Element>>, PocketError> {
    let mut pieces: Vec<Vec<Element>> = Vec::new();
    let mut gap = f64::INFINITY;
    let mut skipped: Vec<Element> = Vec::new();
    for element in outline {
        let length = element.length();
        for stretch in router.survey(element, SLIVER)? {
            let part = element.part(stretch.from, stretch.to);
            if stretch.angle <= SLIVER {
                gap += (stretch.to - stretch.from) * length;
                skipped.push(part);
                continue;
            }
            match pieces.last_mut() {
                Some(piece) if gap < JOINED * router.conditions.radius_mm => {
                    piece.append(&mut skipped);
                    piece.push(part);
                }
                _ => pieces.push(vec![part]),
            }
            skipped.clear();
            gap = 0.0;
        }
    }
    Ok(pieces)
}
