//! Normals at the ends of the pieces of a plane curve, and the mitres of its sharp corners.
//!
//! With the unit normals a and b of two lines that meet, both offsets at the distance x pass the point m x
//! from the corner, m = (a + b) / (1 + a b): it lies on the plane that halves the corner, and m a = m b = 1.

use nalgebra::Vector2;

use super::NormalSweepError;
use crate::geometry::profile::{Piece, Profile, Shape};

/// Where the ends of two neighbours, at the farthest reach of the drive curve, are closer than this, their
/// joint is smooth, mm.
const SMOOTH_MM: f64 = 1e-7;

/// The longest mitre in parts of the reach: turns up to 174 degrees.
const LONGEST_MITRE: f64 = 20.0;

/// The normals to the left at both ends of each piece, of unit length but for those of mitres; `reach` is
/// what they will be multiplied by.
///
/// # Errors
/// When a cubic stops at an end, or a corner can have no mitre.
pub(super) fn normals(
    curve: &Profile<2>,
    reach: [f64; 2],
) -> Result<Vec<[Vector2<f64>; 2]>, NormalSweepError> {
    let pieces = curve.pieces();
    let mut normals = pieces.iter().map(own_normals).collect::<Result<Vec<_>, _>>()?;
    let reach = reach[0].abs().max(reach[1].abs());
    for k in 1..pieces.len() {
        let meeting = [normals[k - 1][1], normals[k][0]];
        if are_lines(&pieces[k - 1], &pieces[k]) {
            let mitre = mitre(meeting, pieces[k - 1].place)?;
            (normals[k - 1][1], normals[k][0]) = (mitre, mitre);
        } else if (meeting[1] - meeting[0]).norm() * reach > SMOOTH_MM {
            return Err(NormalSweepError::Corner { place: pieces[k - 1].place, turn_deg: turn_deg(meeting) });
        }
    }
    if let ([first, .., last], true) = (pieces, curve.is_closed()) {
        let end = pieces.len() - 1;
        if are_lines(last, first) {
            let mitre = mitre([normals[end][1], normals[0][0]], last.place)?;
            (normals[end][1], normals[0][0]) = (mitre, mitre);
        }
    }
    Ok(normals)
}

fn are_lines(one: &Piece<2>, other: &Piece<2>) -> bool {
    matches!((&one.shape, &other.shape), (Shape::Line(_), Shape::Line(_)))
}

fn own_normals(piece: &Piece<2>) -> Result<[Vector2<f64>; 2], NormalSweepError> {
    let [from, to] = piece.shape.end_directions().map(|d| Vector2::new(-d.y, d.x).try_normalize(0.0));
    match (from, to) {
        (Some(from), Some(to)) => Ok([from, to]),
        _ => Err(NormalSweepError::Cusp { place: piece.place }),
    }
}

fn mitre([a, b]: [Vector2<f64>; 2], place: usize) -> Result<Vector2<f64>, NormalSweepError> {
    // The square of the mitre's length is 2 / (1 + a b).
    let share = 1.0 + a.dot(&b);
    if share * LONGEST_MITRE * LONGEST_MITRE < 2.0 {
        return Err(NormalSweepError::Reversal { place, turn_deg: turn_deg([a, b]) });
    }
    Ok((a + b) / share)
}

fn turn_deg([a, b]: [Vector2<f64>; 2]) -> f64 {
    a.perp(&b).atan2(a.dot(&b)).to_degrees().abs()
}
