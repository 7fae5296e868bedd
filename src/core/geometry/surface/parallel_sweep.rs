//! The surface that a drive curve sweeps while it is carried along a basic curve without being rotated.
//!
//! The point of the surface at (u, v) is basic(u) + drive(v) - drive(0). Each pair of a piece of the basic
//! curve and a piece of the drive curve makes a patch. The surface is exact, up to rounding. If the tangents
//! of both curves are parallel for some (u, v), the surface has no normal at (u, v); such curves are
//! accepted.
//!
//! # Reference
//! Y. H. Koo, D. J. Lee, S. Namgung, M. S. Kang, "A Study on the Construction of CAD/CAM System for Machining
//! of Sculptured Surface of Die", 1989, section 3.2.1.

use nalgebra::Vector3;

use super::any_surface::{AnySurface, PATCH_LIMIT};
use super::swept::{self, Station, SweepRail, TooManyPatches};
use crate::geometry::profile::Profile;

/// The basic curve, along u, and the drive curve, along v; mm.
#[derive(Debug, Clone, PartialEq)]
pub struct ParallelSweep {
    pub basic: Profile<3>,
    pub drive: Profile<3>,
}

/// Why the curves make no surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum ParallelSweepError {
    #[error("a curve has no pieces; it needs at least one")]
    Empty,
    #[error(
        "the surface has {patches} patches: the pieces of one curve times the pieces of the other; at most {PATCH_LIMIT} are supported; use curves with fewer pieces"
    )]
    TooManyPatches { patches: usize },
}

impl ParallelSweep {
    /// The swept surface.
    ///
    /// # Errors
    /// When a curve is empty, or there are too many pairs of pieces.
    pub fn surface(&self) -> Result<AnySurface, ParallelSweepError> {
        let (Some(_), Some(start)) = (self.basic.start(), self.drive.start()) else {
            return Err(ParallelSweepError::Empty);
        };
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        let pieces = self.basic.pieces().iter();
        let rails: Vec<SweepRail> = pieces
            .map(|piece| {
                let points = piece.shape.control_points().into_iter();
                points.map(|(p, weight)| Station { origin: p - start.coords, axes, weight }).collect()
            })
            .collect();
        swept::surface(&rails, &self.drive)
            .map_err(|TooManyPatches(patches)| ParallelSweepError::TooManyPatches { patches })
    }

    /// The joints at corners of the curves. Each joint is given by the number of patches before it, along u
    /// and along v.
    pub fn loose_joints(&self) -> [Vec<usize>; 2] {
        [self.basic.loose_joints(), self.drive.loose_joints()]
    }
}

#[cfg(test)]
mod tests;
