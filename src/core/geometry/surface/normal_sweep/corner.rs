//! Normals at the ends of the pieces of a plane curve, and mitres at its sharp corners.
//!
//! At a corner between two lines, let a and b be the unit normals of the lines, and a . b their scalar
//! product. The mitre vector m = (a + b) / (1 + a . b) replaces both normals at the corner. m lies in the
//! plane that halves the corner. Because m . a = m . b = 1, the parallels of both lines at any distance x
//! meet at the corner plus x m.

use nalgebra::Vector2;

use super::NormalSweepError;
use crate::geometry::profile::{Piece, Shape};

/// A joint is smooth if the offset ends of the two neighbours are closer than this, mm. The offset distance
/// is the farthest reach of the drive curve.
const SMOOTH_MM: f64 = 1e-7;

/// The longest mitre vector, as a multiple of a unit normal: permits turns up to 174 degrees.
const LONGEST_MITRE: f64 = 20.0;

/// The normals to the left at both ends of each piece. They have unit length, except at mitres. `reach` is
/// the range of the distances that the normals are multiplied by, mm.
///
/// # Errors
/// When a cubic has no direction at an end, or a corner can have no mitre.
pub(super) fn normals(
    pieces: &[Piece<2>],
    is_closed: bool,
    reach: [f64; 2],
) -> Result<Vec<[Vector2<f64>; 2]>, NormalSweepError> {
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
    if let ([first, .., last], true) = (pieces, is_closed) {
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
