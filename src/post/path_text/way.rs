//! Ways that are no straight lines, as poses along them.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::{Point3, UnitVector3, Vector3};

use super::PathFault;
use toolpathd_core::machine::Straying;
use toolpathd_core::toolpath::pose::Pose;

/// How far the radii at the start and at the end of an arc may differ, mm: twice the rounding of programs
/// with two decimals. The radius changes evenly along the arc. With a larger value a slip of the pen passes.
const RADIUS_MISMATCH_MM: f64 = 0.02;

/// An arc whose end is nearer to its start along the circle than this, radians, is a full turn.
const SAME_PLACE: f64 = 1e-9;

/// Poses of one arc or line, at most. Larger values let one block take all poses of a request; a circle of
/// 1 m radius needs 2,222 within a micrometre.
const MAX_PARTS: usize = 20_000;

/// Where a chord is compared with its way: an S-shaped way crosses its chord in the middle, so the middle
/// alone does not show how far the way leaves the chord.
const COMPARED: [f64; 3] = [0.25, 0.5, 0.75];

/// A part of a circle, or of a helix, about a centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArcWay {
    center: Point3<f64>,
    /// From the centre to the start, across from it in the sense of the turn, and along the axis.
    frame: [Vector3<f64>; 3],
    radii: [f64; 2],
    sweep: f64,
    rise: f64,
}

impl ArcWay {
    /// The arc from one point to another about `center`, counterclockwise as seen from where `normal` points
    /// to. The rise along the normal is even. Equal ends make a full turn.
    ///
    /// # Errors
    /// When the centre is at the start, or the radii at both ends differ.
    pub fn new(
        from: &Point3<f64>,
        to: &Point3<f64>,
        center: &Point3<f64>,
        normal: &UnitVector3<f64>,
    ) -> Result<Self, PathFault> {
        let across = |at: &Point3<f64>| {
            let arm = at - center;
            let height = arm.dot(normal);
            (arm - normal.scale(height), height)
        };
        let ((start, low), (end, high)) = (across(from), across(to));
        let radii = [start.norm(), end.norm()];
        let mismatch_mm = (radii[0] - radii[1]).abs();
        if mismatch_mm > RADIUS_MISMATCH_MM {
            return Err(PathFault::Radii { mismatch_mm });
        }
        if radii[0] <= RADIUS_MISMATCH_MM {
            return Err(PathFault::NoCenter);
        }
        let first = start / radii[0];
        let second = normal.cross(&first);
        let angle = end.dot(&second).atan2(end.dot(&first)).rem_euclid(TAU);
        let sweep = if angle <= SAME_PLACE || TAU - angle <= SAME_PLACE { TAU } else { angle };
        let base = center + normal.scale(low);
        Ok(Self { center: base, frame: [first, second, normal.into_inner()], radii, sweep, rise: high - low })
    }

    /// The place at a part of the arc, from 0 to 1.
    pub fn at(&self, part: f64) -> Point3<f64> {
        let [first, second, normal] = self.frame;
        let (sin, cos) = (self.sweep * part).sin_cos();
        let radius = self.radii[0] + (self.radii[1] - self.radii[0]) * part;
        self.center + (first * cos + second * sin) * radius + normal * (self.rise * part)
    }

    /// Parts of at most a quarter of a turn: the chord of a whole turn has no length.
    pub fn fewest_parts(&self) -> usize {
        (self.sweep / FRAC_PI_2).ceil() as usize
    }

    /// The direction at the end of the arc.
    pub fn direction_at_end(&self) -> Vector3<f64> {
        let [first, second, _] = self.frame;
        let (sin, cos) = self.sweep.sin_cos();
        second * cos - first * sin
    }
}

/// In how many even parts a way is divided, so that straight ways between their ends leave it by at most
/// `allowed`, compared at a quarter, a half and three quarters of each part. At least `least` parts.
///
/// # Errors
/// With more than [`MAX_PARTS`] parts.
pub fn parts(way: impl Fn(f64) -> Pose, allowed: Straying, least: usize) -> Result<usize, PathFault> {
    let mut count = least.max(1);
    while count <= MAX_PARTS {
        let at = |k: f64| way(k / count as f64);
        let strays = |k: usize| {
            let k = k as f64;
            let (start, end) = (at(k), at(k + 1.0));
            let strays = |part: f64| {
                let (chord, there) = (start.between(&end, part), at(k + part));
                let tip = (there.tip - chord.tip).norm() / allowed.tip_mm;
                tip.max(there.axis.angle(&chord.axis) / allowed.axis)
            };
            COMPARED.map(strays).into_iter().fold(0.0, f64::max)
        };
        let worst = (0..count).map(strays).fold(0.0, f64::max);
        if worst <= 1.0 {
            return Ok(count);
        }
        // The height of chords falls with the square of their number.
        count = ((count as f64 * worst.sqrt()).ceil() as usize).max(count + 1);
    }
    Err(PathFault::TooFine { most: MAX_PARTS })
}
