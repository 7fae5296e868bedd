//! A drive curve carried along a basic curve in the plane at right angles to it.
//!
//! # Method
//! With the basic curve c in the xy plane, n its unit normal to the left and (x, z) the drive curve,
//! S(u, v) = c(u) + n(u) x(v) + k z(v), as a tensor product for each pair of pieces:
//! 1. Along a line n is constant; along an arc it is a rational quadratic with the arc's weights.
//! 2. Along a cubic the unit normal is not rational. It is replaced by cubics that agree with it and its
//!    derivative where they meet (`unit_normal`), and the cubic is halved until they are near enough.
//! 3. At a sharp corner between two lines both normals become the vector of the mitre (`corner`): each line
//!    is cut, or goes on, to the plane that halves the corner. So do the ends of a closed curve.
//!
//! # Guarantees
//! Exact to rounding but for cubics of the basic curve, where the surface leaves the exact one by at most
//! [`TOLERANCE_MM`], proved by Bernstein coefficients, and keeps its smoothness. No part runs backward along
//! the basic curve: the surface does not fold at any place of it. That distant parts of it keep clear of each
//! other is not looked at.
//!
//! # Degenerate input
//! A drive curve that reaches exactly to the centre of an arc, or to where mitres meet, makes a pole there.
//! One that reaches farther is refused, as is a sharp corner beside an arc or a cubic, whose two sides do not
//! meet in a plane.
//!
//! # Cost
//! O(patches).
//!
//! # Differences from the paper
//! The paper's basic curve may leave its plane. Here it is plane.
//!
//! # Reference
//! Y. H. Koo, D. J. Lee, S. Namgung, M. S. Kang, "A Study on the Construction of CAD/CAM System for Machining
//! of Sculptured Surface of Die", 1989, section 3.2.2.

mod corner;
mod unit_normal;

use nalgebra::{Point2, Point3, Vector2, Vector3};

use super::any_surface::{AnySurface, PATCH_LIMIT};
use super::swept::{self, Rail, Station, TooManyPatches};
use crate::geometry::profile::{Piece, Profile, Shape};
use unit_normal::NormalFault;

/// How far the surface may be from the exact one along cubics of the basic curve, mm.
pub const TOLERANCE_MM: f64 = 1e-6;

/// What the drive curve may reach too far by rounding, mm.
const REACH_ROUNDING_MM: f64 = 1e-9;

/// The basic curve in the xy plane, along u, and the drive curve (left of the basic curve, up), along v; mm.
#[derive(Debug, Clone, PartialEq)]
pub struct NormalSweep {
    pub basic: Profile<2>,
    pub drive: Profile<2>,
}

/// Why the curves make no surface; `place` is that of a piece of the basic curve.
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
}

/// A side of the basic curve, seen from above along it.
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

/// The rails of the basic curve, and the number of the first one of each piece.
struct Rails {
    rails: Vec<Rail>,
    firsts: Vec<usize>,
}

impl NormalSweep {
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

    /// The joints at corners, by the number of patches before them along u and v; of curves that make a
    /// surface.
    pub fn loose_joints(&self) -> [Vec<usize>; 2] {
        let along_basic = match self.rails() {
            Ok(Rails { rails: _, firsts }) => {
                self.basic.loose_joints().into_iter().map(|joint| firsts[joint]).collect()
            }
            Err(_) => Vec::new(),
        };
        [along_basic, self.drive.loose_joints()]
    }

    fn rails(&self) -> Result<Rails, NormalSweepError> {
        let reach = self.drive.range(0);
        let normals = corner::normals(&self.basic, reach)?;
        let mut found = Rails { rails: Vec::new(), firsts: Vec::with_capacity(normals.len()) };
        for (piece, normals) in self.basic.pieces().iter().zip(normals) {
            found.firsts.push(found.rails.len());
            match &piece.shape {
                Shape::Line([from, to]) => {
                    check_line(piece, normals, reach)?;
                    found.rails.push(vec![station(from, &normals[0], 1.0), station(to, &normals[1], 1.0)]);
                }
                Shape::Arc { points, weight } => {
                    check_arc(piece, normals, reach)?;
                    // The unit circle's own control point: the sum of two unit vectors is twice the weight
                    // long.
                    let middle = (normals[0] + normals[1]) / (2.0 * weight * weight);
                    let control = [(normals[0], 1.0), (middle, *weight), (normals[1], 1.0)];
                    let stations = points.iter().zip(control).map(|(p, (n, w))| station(p, &n, w));
                    found.rails.push(stations.collect());
                }
                Shape::Cubic(points) => {
                    let room = PATCH_LIMIT.saturating_sub(found.rails.len());
                    let parts = unit_normal::parts(*points, reach, room)
                        .map_err(|fault| of_normal(fault, piece.place))?;
                    found.rails.extend(parts.iter().map(|part| {
                        part.points
                            .iter()
                            .zip(&part.normals)
                            .map(|(p, n)| station(p, n, 1.0))
                            .collect::<Rail>()
                    }));
                }
            }
            if found.rails.len() > PATCH_LIMIT {
                return Err(NormalSweepError::TooManyPatches);
            }
        }
        Ok(found)
    }
}

fn station(point: &Point2<f64>, normal: &Vector2<f64>, weight: f64) -> Station {
    Station {
        origin: Point3::new(point.x, point.y, 0.0),
        axes: [normal.push(0.0), Vector3::z(), Vector3::zeros()],
        weight,
    }
}

/// How far to the side the drive curve may go until a piece between these ends with these normals has no
/// length left; at the side to which the drive curve reaches too far, with how far it reaches.
fn overreach(
    chord: Vector2<f64>,
    [first, last]: [Vector2<f64>; 2],
    [low, high]: [f64; 2],
) -> Option<(Side, f64, f64)> {
    let length = chord.norm();
    let growth = (last - first).dot(&chord) / length;
    // The length at x is `length + growth x`; it vanishes on one side.
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
