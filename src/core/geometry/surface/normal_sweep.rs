//! The surface that a plane drive curve sweeps while it is carried along a basic curve in space. The plane of
//! the drive curve is upright. It always stands at right angles to the projection of the basic curve on the
//! xy plane.
//!
//! # Method
//! The first coordinate of the drive curve counts along the unit normal of the projection (to the left), the
//! second upward from the basic curve. Each pair of a piece of the basic curve and a piece of the drive curve
//! makes a patch (`leg`):
//! 1. Where the projection is a line or an arc, the unit normal is a quotient of polynomials. So the patch is
//!    exact.
//! 2. Along a cubic, another cubic replaces the unit normal (`unit_normal`). Where this other cubic is not
//!    near enough to the unit normal, the piece of the basic curve is halved.
//! 3. A tilted arc is replaced by cubics first.
//! 4. At a sharp corner between two lines in plan, the patches along both lines end in the upright plane that
//!    halves the corner (a mitre, `corner`). Every point of the drive curve is there at the height of the
//!    corner, and changes its height along each line as the basic curve does.
//!
//! # Guarantees
//! Along lines, level arcs and arcs in upright planes the surface is exact, up to rounding. Along cubics it
//! is within [`TOLERANCE_MM`] of the exact surface, and along tilted arcs within twice that. The surface does
//! not fold along any piece of the basic curve. Parts of the surface along different pieces may still
//! intersect.
//!
//! # Degenerate input
//! Refused are:
//! * a drive curve that reaches so far to the side that the surface would fold;
//! * a sharp corner with an arc or a cubic on one side: the surfaces on the two sides do not meet in a plane;
//! * a basic curve that turns back on itself at a corner, or has a cusp;
//! * a basic curve that runs upright: its projection has no direction there.
//!
//! # Reference
//! Y. H. Koo, D. J. Lee, S. Namgung, M. S. Kang, "A Study on the Construction of CAD/CAM System for Machining
//! of Sculptured Surface of Die", 1989, section 3.2.2.

mod corner;
mod leg;
mod unit_normal;

use nalgebra::{Point2, Point3, Vector2, Vector3};

use super::any_surface::{AnySurface, PATCH_LIMIT};
use super::swept::{self, Station, SweepRail, TooManyPatches};
use crate::geometry::profile::{Piece, Profile, Shape};
use leg::SweepLeg;
use unit_normal::NormalFault;

/// How far the surface may leave the exact one along cubics of the basic curve, mm.
pub const TOLERANCE_MM: f64 = 1e-6;

/// How far the drive curve may exceed its permitted reach before it is refused, mm: room for rounding.
const REACH_ROUNDING_MM: f64 = 1e-9;

/// The basic curve, along u, and the drive curve (left of the basic curve, up), along v; mm.
#[derive(Debug, Clone, PartialEq)]
pub struct NormalSweep {
    pub basic: Profile<3>,
    pub drive: Profile<2>,
}

/// Why the curves make no surface. `place` is the place of the piece of the basic curve that is at fault.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum NormalSweepError {
    #[error("a curve has no pieces; it needs at least one")]
    Empty,
    #[error("the surface needs more than {PATCH_LIMIT} patches, the most that are supported")]
    TooManyPatches,
    #[error(
        "the basic curve has a sharp corner of {turn_deg} degrees beside an arc or a smooth curve; only corners between two lines can be mitred"
    )]
    Corner { place: usize, turn_deg: f64 },
    #[error("the basic curve turns back by {turn_deg} degrees; a mitre there would be infinitely long")]
    Reversal { place: usize, turn_deg: f64 },
    #[error(
        "the drive curve reaches {reach_mm} mm to the {side} of the basic curve, whose radius is {radius_mm} mm there, so the surface would fold; make the drive curve narrower or the radius larger"
    )]
    Fold { place: usize, side: Side, reach_mm: f64, radius_mm: f64 },
    #[error(
        "the drive curve reaches {reach_mm} mm to the {side} of the basic curve, where the mitres of this corner and the next corner already meet at {room_mm} mm; make the drive curve narrower"
    )]
    Mitre { place: usize, side: Side, reach_mm: f64, room_mm: f64 },
    #[error(
        "the basic curve has a cusp, or turns so tightly that it may have one; the curve has no normal at a cusp"
    )]
    Cusp { place: usize },
    #[error(
        "seen from above, the basic curve stands still or turns back here; its projection on the xy plane needs a direction everywhere"
    )]
    Upright { place: usize },
}

/// A side of the basic curve, seen from above in its direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    Left,
    Right,
}

impl std::fmt::Display for Side {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Left => "left",
            Self::Right => "right",
        })
    }
}

/// The rails of the basic curve, and for each piece the index of its first rail.
struct Rails {
    rails: Vec<SweepRail>,
    firsts: Vec<usize>,
}

impl NormalSweep {
    /// The swept surface.
    ///
    /// # Errors
    /// One of [`NormalSweepError`].
    pub fn surface(&self) -> Result<AnySurface, NormalSweepError> {
        if self.drive.start().is_none() || self.basic.start().is_none() {
            return Err(NormalSweepError::Empty);
        }
        let drive = self.drive.mapped(|p| Point3::new(p.x, p.y, 0.0));
        swept::surface(&self.rails()?.rails, &drive)
            .map_err(|TooManyPatches(_)| NormalSweepError::TooManyPatches)
    }

    /// The joints at corners of the curves. Each joint is given by the number of patches before it, along u
    /// and along v. Meaningful only if [`NormalSweep::surface`] succeeds.
    pub fn loose_joints(&self) -> [Vec<usize>; 2] {
        let [low, high] = self.basic.range(2);
        let along_basic = match self.rails() {
            // Beside a rising curve, the way along the surface turns where the curvature in plan jumps.
            Ok(Rails { rails: _, firsts }) if high > low => firsts.into_iter().skip(1).collect(),
            Ok(Rails { rails: _, firsts }) => {
                self.basic.loose_joints().into_iter().map(|joint| firsts[joint]).collect()
            }
            Err(_) => Vec::new(),
        };
        [along_basic, self.drive.loose_joints()]
    }

    fn rails(&self) -> Result<Rails, NormalSweepError> {
        let reach = self.drive.range(0);
        let (legs, firsts) = leg::legs(&self.basic, reach[0].abs().max(reach[1].abs()))?;
        let plan: Vec<Piece<2>> = legs.iter().map(|leg| leg.plan).collect();
        let normals = corner::normals(&plan, self.basic.is_closed(), reach)?;
        let mut rails: Vec<SweepRail> = Vec::with_capacity(legs.len());
        // For each leg, the index of its first rail.
        let mut starts = Vec::with_capacity(legs.len());
        for (SweepLeg { plan: piece, space }, normals) in legs.iter().zip(normals) {
            starts.push(rails.len());
            match (&piece.shape, space) {
                (Shape::Line(line), space) => {
                    check_line(piece, normals, reach)?;
                    rails.push(along_line(line, space, normals));
                }
                (Shape::Arc { .. }, Shape::Arc { points, weight }) => {
                    check_arc(piece, normals, reach)?;
                    // The middle control point of an arc of the unit circle: the sum of the two unit normals
                    // is 2 `weight` long, and the control point is 1 / `weight` from the centre.
                    let middle = (normals[0] + normals[1]) / (2.0 * weight * weight);
                    let control = [(normals[0], 1.0), (middle, *weight), (normals[1], 1.0)];
                    let stations = points.iter().zip(control).map(|(p, (n, w))| station(p, &n, w));
                    rails.push(stations.collect());
                }
                (_, Shape::Cubic(points)) => {
                    let room = PATCH_LIMIT.saturating_sub(rails.len());
                    let parts = unit_normal::parts(*points, reach, room)
                        .map_err(|fault| of_normal(fault, piece.place))?;
                    rails.extend(parts.iter().map(|part| {
                        let control = part.points.iter().zip(&part.normals);
                        control.map(|(p, n)| station(p, n, 1.0)).collect::<SweepRail>()
                    }));
                }
                // A leg has the same kind of shape in plan and in space, unless it is a line in plan.
                (Shape::Arc { .. } | Shape::Cubic(_), Shape::Line(_) | Shape::Arc { .. }) => {}
            }
            if rails.len() > PATCH_LIMIT {
                return Err(NormalSweepError::TooManyPatches);
            }
        }
        Ok(Rails { rails, firsts: firsts.into_iter().map(|leg| starts[leg]).collect() })
    }
}

/// The stations of a leg that is a line in plan. The normal changes in proportion to the way along the line.
fn along_line(line: &[Point2<f64>; 2], space: &Shape<3>, [first, last]: [Vector2<f64>; 2]) -> SweepRail {
    let points = space.control_points();
    let end = points.len() - 1;
    let normal = |k: usize, p: &Point3<f64>| match k {
        0 => first,
        _ if k == end => last,
        _ => first + (last - first) * leg::share(p, line),
    };
    points.iter().enumerate().map(|(k, (p, weight))| station(p, &normal(k, p), *weight)).collect()
}

fn station(point: &Point3<f64>, normal: &Vector2<f64>, weight: f64) -> Station {
    Station { origin: *point, axes: [normal.push(0.0), Vector3::z(), Vector3::zeros()], weight }
}

/// Checks how far to each side the drive curve may reach along a piece with this chord and these normals at
/// its ends. At some distance the offset of the piece has no length left. If the drive curve reaches farther:
/// the side, the reach, and that distance, mm. If it reaches exactly as far, the surface shrinks to a point
/// there.
fn overreach(
    chord: Vector2<f64>,
    [first, last]: [Vector2<f64>; 2],
    [low, high]: [f64; 2],
) -> Option<(Side, f64, f64)> {
    let length = chord.norm();
    let growth = (last - first).dot(&chord) / length;
    // The offset of the piece at x is `length + growth x` long. That is zero on one side.
    let room = length / growth.abs();
    let (side, reach_mm) = if growth < 0.0 { (Side::Left, high) } else { (Side::Right, -low) };
    (reach_mm > room + REACH_ROUNDING_MM).then_some((side, reach_mm, room))
}

fn check_line(piece: &Piece<2>, normals: [Vector2<f64>; 2], reach: [f64; 2]) -> Result<(), NormalSweepError> {
    let chord = piece.shape.end() - piece.shape.start();
    match overreach(chord, normals, reach) {
        None => Ok(()),
        Some((side, reach_mm, room_mm)) => {
            Err(NormalSweepError::Mitre { place: piece.place, side, reach_mm, room_mm })
        }
    }
}

fn check_arc(piece: &Piece<2>, normals: [Vector2<f64>; 2], reach: [f64; 2]) -> Result<(), NormalSweepError> {
    let chord = piece.shape.end() - piece.shape.start();
    match overreach(chord, normals, reach) {
        None => Ok(()),
        Some((side, reach_mm, radius_mm)) => {
            Err(NormalSweepError::Fold { place: piece.place, side, reach_mm, radius_mm })
        }
    }
}

fn of_normal(fault: NormalFault, place: usize) -> NormalSweepError {
    match fault {
        NormalFault::Cusp => NormalSweepError::Cusp { place },
        NormalFault::TooMany => NormalSweepError::TooManyPatches,
        NormalFault::Fold { reach, radius_mm } => {
            let side = if reach > 0.0 { Side::Left } else { Side::Right };
            NormalSweepError::Fold { place, side, reach_mm: reach.abs(), radius_mm }
        }
    }
}

#[cfg(test)]
mod tests;
