//! Bounds from above how much material moves leave at the upright walls of a pocket.
//!
//! What is *left* at a place of a wall is the distance of the place, in plan, from what cutters have swept at
//! the level of the place. A cutter with its shank sweeps all that lies above what it sweeps. So no place
//! above a level has more left than the place of the wall at the level.
//!
//! A place of a wall is *reached* if a cutter that touches the wall there enters no other wall. Corners that
//! are narrower than the cutter are not reached, so the material in them does not count.
//!
//! # Method
//! 1. Cut the moves into lines and arcs in plan. Each sweeps, at the level, discs of a radius that its height
//!    tells (`cleared`).
//! 2. For a piece of a wall, find the track that is nearest to its middle. Bound the distance of the whole
//!    piece from this track: the distance from a line is a convex function of the place, and so is the
//!    distance from the centre of an arc.
//! 3. Halve the piece with the largest bound until the bound exceeds the largest distance found by at most a
//!    gap. Pieces without a reached place are dropped.
//!
//! # Guarantees
//! * No reached place of a wall has more left than the bound, with what the control may leave the path.
//!
//! # Degenerate input
//! Where nothing is swept at the level, the bound is infinite.
//!
//! # Cost
//! O(n log m) for n pieces of the walls and m moves; about one piece for each wall and track beside it.

mod cleared;

use nalgebra::Point2;

use crate::budget::{Budget, Stopped};
use crate::geometry::best_first::BestFirst;
use crate::geometry::region::{Containment, Region};
use crate::geometry::segment::{Segment, left};
pub use cleared::{Cleared, Slice, Swath, radius_at};

/// How far the boundary of a region may lie from the outline that was given, and how much nearer to another
/// wall a cutter may stand that touches a wall, mm.
const SNAP_MM: f64 = 1e-4;

/// The most pieces that the search examines. A search that ends at this limit returns a true bound, which may
/// exceed the largest distance found by more than the gap.
const MOST_PIECES: usize = 400_000;

/// Pieces between two checks of the budget.
const PIECES_BETWEEN_CHECKS: usize = 256;

/// The largest turn of a piece of an arc, radians.
const MOST_TURN: f64 = 1.0;

/// Walls that are longer than this multiple of the cutter's radius are cut before the search.
const LONGEST: f64 = 8.0;

/// The thickest material at the walls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Thickest {
    /// Proved upper bound, mm; infinite where nothing is swept.
    pub bound_mm: f64,
    /// The largest distance found at a reached place, mm.
    pub found_mm: f64,
    /// That place, or else the middle of the piece with the bound.
    pub at: Point2<f64>,
    /// The number of the move that is nearest to the place; `None` where nothing is swept.
    pub nearest: Option<usize>,
}

/// Bounds the thickness of the material at the reached places of the walls of `region`. A place is reached if
/// a disc of `radius_mm` touches the wall there and enters no other wall. `None` where no place is reached.
///
/// # Errors
/// Only the budget's stop.
pub fn thickest(
    region: &Region,
    cleared: &Cleared,
    radius_mm: f64,
    gap_mm: f64,
    budget: &Budget,
) -> Result<Option<Thickest>, Stopped> {
    let search = Search { region, cleared, radius_mm, gap_mm };
    let mut found: Option<Thickest> = None;
    let mut open = BestFirst::default();
    let walls = region.outlines().flat_map(|outline| outline.elements());
    for (k, wall) in walls.enumerate() {
        if k % PIECES_BETWEEN_CHECKS == 0 {
            budget.check()?;
        }
        let by_length = wall.length() / (LONGEST * radius_mm);
        let n = (wall.turn().abs() / MOST_TURN).max(by_length).ceil().clamp(1.0, 1e4);
        for part in 0..n as usize {
            let piece = wall.part(part as f64 / n, (part as f64 + 1.0) / n);
            search.add(piece, &mut found, &mut open);
        }
    }
    for k in 0..MOST_PIECES {
        if k % PIECES_BETWEEN_CHECKS == 0 {
            budget.check()?;
        }
        let Some((bound, piece)) = open.pop() else { return Ok(found) };
        let known = found.map_or(0.0, |found| found.found_mm);
        if bound <= known + search.gap() || piece.length() <= 0.1 * gap_mm || bound == f64::INFINITY {
            return Ok(Some(search.with_bound(found, bound, &piece)));
        }
        for [from, to] in [[0.0, 0.5], [0.5, 1.0]] {
            search.add(piece.part(from, to), &mut found, &mut open);
        }
    }
    Ok(match open.pop() {
        Some((bound, piece)) => Some(search.with_bound(found, bound, &piece)),
        None => found,
    })
}

struct Search<'a> {
    region: &'a Region,
    cleared: &'a Cleared,
    radius_mm: f64,
    gap_mm: f64,
}

impl Search<'_> {
    /// By how much the bound may exceed the largest distance found, mm. One part of the bound is how far the
    /// control may leave the path, and shorter pieces do not make this part smaller.
    fn gap(&self) -> f64 {
        self.gap_mm + 2.0 * self.cleared.off_mm() + SNAP_MM
    }

    /// Looks at a piece of a wall, unless no place of it is reached.
    fn add(&self, piece: Segment, found: &mut Option<Thickest>, open: &mut BestFirst<Segment>) {
        let middle = piece.at(0.5);
        let center = middle + left(piece.direction(0.5)) * self.radius_mm;
        let room = if self.region.place(center, 0.0) == Containment::Outside {
            -self.region.distance_to_boundary(center)
        } else {
            self.region.distance_to_boundary(center)
        };
        let short = self.radius_mm - SNAP_MM - room;
        // Along the piece the centre of the disc moves by at most this.
        let moved = 0.5 * piece.length() * (1.0 + piece.curvature().abs() * self.radius_mm);
        if short > moved {
            return;
        }
        let Some(near) = self.cleared.nearest(middle) else {
            open.push(f64::INFINITY, piece);
            return;
        };
        let of_middle = near.distance_mm.max(0.0);
        let known = (of_middle - 2.0 * self.cleared.off_mm()).max(0.0);
        if short <= 0.0 && found.is_none_or(|found| known > found.found_mm) {
            let bound_mm = found.map_or(0.0, |found| found.bound_mm);
            let nearest = Some(near.number);
            *found = Some(Thickest { bound_mm, found_mm: known, at: middle, nearest });
        }
        let bound = self.cleared.farthest(near, &piece).min(of_middle + 0.5 * piece.length());
        open.push(bound.max(0.0) + SNAP_MM, piece);
    }

    fn with_bound(&self, found: Option<Thickest>, bound_mm: f64, piece: &Segment) -> Thickest {
        match found {
            Some(found) if bound_mm < f64::INFINITY => Thickest { bound_mm, ..found },
            _ => {
                let at = piece.at(0.5);
                let nearest = self.cleared.nearest(at).map(|near| near.number);
                Thickest { bound_mm, found_mm: 0.0, at, nearest }
            }
        }
    }
}

#[cfg(test)]
mod tests;
