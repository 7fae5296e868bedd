//! Bounds from above how much material passes leave on a surface.
//!
//! What is *left* at a point of the surface is the distance of the point from the solid that the cutter and
//! its shank have swept over all passes. With an allowance, the point lies above the surface by the
//! allowance, along the normal.
//!
//! A point is *reached* if some allowed position of the cutter comes near it ([`Reach`]). What is left at
//! points that are not reached is the *rest*. What is left at all others is a matter of the passes: of their
//! distance, and of where they end.
//!
//! # Method
//! 1. Cut the passes into lines and into arcs of at most a quarter turn. Build a tree of boxes for the pieces
//!    of each cutter.
//! 2. For a part of a patch, find the piece that is nearest to the part's centre. Bound from above the
//!    distance of every point of the part from the solid that the cutter sweeps along this piece (`bound`).
//!    For a ball, the squared distance from a line or a circle has Bernstein coefficients. For any cutter,
//!    the distance from a convex solid is largest at a control point of the part. A part on a ridge between
//!    two passes has a bound by a mean of the distances from both.
//! 3. Halve the part with the largest bound, along the parameter in which the bounds of the halves fall more.
//!    Stop when the bound exceeds the largest distance found at a point by at most the gap that is asked for.
//!    The search begins with the largest distance of some hundred places.
//! 4. Where more is left than at any reached place, try whether the cutter reaches the part's centre. A part
//!    belongs to the rest if neither its centre nor one of its corners is reached. If only a corner is, the
//!    part is halved further; a very small one belongs to the rest.
//!
//! # Guarantees
//! * No point of the surface has more left than the larger of the two bounds of [`Left`]: the parts cover the
//!   surface, and each has a bound. Rounding is included.
//! * A bound exceeds the largest distance found by about the gap at most. It exceeds it by more if the limit
//!   of parts is reached.
//! * Only surface, cutter and passes are used. So the result is an independent check of the planning of the
//!   passes: a pass that is missing, too short, too high or out of place raises a bound.
//! * With an allowance, the bound of what is left over the layer follows from the distance of the surface
//!   from the cutter enlarged by the allowance.
//!   It uses the curvature at the centre of each part, so it is an estimate.
//!
//! # Degenerate input
//! Without passes there is no bound. A place without a normal counts as reached.
//!
//! # Cost
//! O(n log m) for m pieces of the passes and n parts: some ten parts for the length of a stepover along and
//! across the passes.

mod bound;
mod search;
mod swept;

use nalgebra::{Point3, Vector3};

use crate::budget::{Budget, Stopped};
use crate::geometry::surface::{BezierSurface, Patch};
use crate::machining::cutter::Cutter;
use crate::machining::gouge::solid::Solid;
use search::Search;
pub use swept::Swept;

/// Where a cutter may go without cutting into the surface.
pub trait Reach: Sync {
    /// Whether some allowed position of the cutter comes much nearer to `point` than `left` mm. The unit
    /// normal of the surface at the point is `normal`.
    ///
    /// # Errors
    /// Only the budget's stop.
    fn is_reached(
        &self,
        point: &Point3<f64>,
        normal: &Vector3<f64>,
        left: f64,
        budget: &Budget,
    ) -> Result<bool, Stopped>;
}

/// How precise the bounds have to be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wanted {
    /// A bound may exceed the largest distance found by this share of the distance, and by `gap_mm`.
    pub gap_share: f64,
    pub gap_mm: f64,
    /// A bound need not be below this, mm, if the largest distance found is not above it and the gap is
    /// smaller.
    pub target_mm: Option<f64>,
    /// Parts of this size or smaller are tried for being reached, mm.
    pub grain_mm: f64,
    /// Parts of this size or smaller are not halved, mm.
    pub smallest_mm: f64,
    /// The most parts of the search, shared out evenly. A part that is not halved any more has the bound that
    /// is known.
    pub part_limit: usize,
}

/// The largest distance from the swept solid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leftover {
    /// Proved upper bound, mm.
    pub bound_mm: f64,
    /// Where that bound was found; `None` if there is nothing to bound.
    pub at: Option<Point3<f64>>,
    /// The largest distance found at a point, mm.
    pub found_mm: f64,
    /// That point.
    pub found_at: Option<Point3<f64>>,
}

impl Leftover {
    const NONE: Self = Self { bound_mm: 0.0, at: None, found_mm: 0.0, found_at: None };

    /// The place of the largest distance: where it was found, or else where it is bounded.
    pub fn place(&self) -> Option<Point3<f64>> {
        self.found_at.or(self.at)
    }

    fn or_more(self, other: Self) -> Self {
        let (bound_mm, at) = if other.bound_mm > self.bound_mm {
            (other.bound_mm, other.at)
        } else {
            (self.bound_mm, self.at)
        };
        let (found_mm, found_at) = if other.found_mm > self.found_mm {
            (other.found_mm, other.found_at)
        } else {
            (self.found_mm, self.found_at)
        };
        Self { bound_mm, at, found_mm, found_at }
    }

    fn without_bound(self) -> Self {
        Self { bound_mm: 0.0, at: None, ..self }
    }
}

/// What passes leave on a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Left {
    /// Where the cutter can reach.
    pub reached: Leftover,
    /// Where it cannot.
    pub rest: Leftover,
}

impl Left {
    const NONE: Self = Self { reached: Leftover::NONE, rest: Leftover::NONE };
    const UNKNOWN: Self =
        Self { reached: Leftover { bound_mm: f64::INFINITY, ..Leftover::NONE }, rest: Leftover::NONE };

    fn or_more(self, other: Self) -> Self {
        Self { reached: self.reached.or_more(other.reached), rest: self.rest.or_more(other.rest) }
    }
}

/// Bounds the material that several cutters together leave on `part`. Each element of `swept` holds the
/// passes of one cutter.
///
/// # Errors
/// Only the budget's stop.
pub fn left<P: Patch>(
    part: &BezierSurface<P>,
    swept: &[Swept],
    reach: &impl Reach,
    wanted: Wanted,
    budget: &Budget,
) -> Result<Left, Stopped> {
    Search { swept, reach, wanted, budget }.run(part)
}

/// The distance of a point from a cutter with its shank whose tip is at `tip`, mm; zero inside.
pub fn distance_from(cutter: &Cutter, tip: &Point3<f64>, point: &Point3<f64>) -> f64 {
    let solid = Solid { flat: cutter.flat_radius(), corner: cutter.corner_radius() };
    let center = tip.coords + Vector3::z() * cutter.corner_radius();
    (-solid.depth(&(point.coords - center))).max(0.0)
}

#[cfg(test)]
mod tests;
