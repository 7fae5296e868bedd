//! The sides of the triangles of a mesh: whether they close the mesh, and where they are sharp.

use nalgebra::Point3;

use super::{TRIANGLES_BETWEEN_CHECKS, bodies};
use crate::budget::{Budget, Stopped};

/// Sine of the largest angle between the normals of two triangles along a side that is not sharp.
const SMOOTH: f64 = 0.1;

pub(super) struct Sides {
    /// For each triangle, which sides are sharp; the first is from the first corner to the second.
    pub(super) sharp: Vec<[bool; 3]>,
    /// For each triangle, whether its normal by the order of its corners is turned round: to the outside of
    /// a closed mesh, and up in any other.
    pub(super) turned: Vec<bool>,
    pub(super) is_closed: bool,
}

/// A side of a triangle: its corners in order, and three times the number of the triangle, plus the side.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Side {
    corners: [u32; 2],
    owner: u32,
}

/// Looks at the sides of all triangles.
///
/// # Errors
/// Only the budget's stop.
pub(super) fn sides(
    points: &[Point3<f64>],
    triangles: &[[u32; 3]],
    budget: &Budget,
) -> Result<Sides, Stopped> {
    let at = |k: u32| points[k as usize].coords;
    let normal = |&[a, b, c]: &[u32; 3]| (at(b) - at(a)).cross(&(at(c) - at(a)));
    let mut all = Vec::with_capacity(3 * triangles.len());
    for (k, triangle) in triangles.iter().enumerate() {
        if k % TRIANGLES_BETWEEN_CHECKS == 0 {
            budget.check()?;
        }
        all.extend((0..3).map(|side| {
            let (from, to) = (triangle[side], triangle[(side + 1) % 3]);
            Side { corners: [from.min(to), from.max(to)], owner: (3 * k + side) as u32 }
        }));
    }
    all.sort_unstable();
    budget.check()?;
    let mut sharp = vec![[true; 3]; triangles.len()];
    let mut is_closed = true;
    for group in all.chunk_by(|one, other| one.corners == other.corners) {
        let owners = |side: &Side| ((side.owner / 3) as usize, (side.owner % 3) as usize);
        let [one, other] = group else {
            is_closed = false;
            continue;
        };
        let [(k, side), (n, beside)] = [owners(one), owners(other)];
        // Triangles that turn alike go along their common side in opposite directions.
        let is_alike = triangles[k][side] != triangles[n][beside];
        is_closed &= is_alike;
        let (mine, others) = (normal(&triangles[k]), normal(&triangles[n]));
        let others = if is_alike { others } else { -others };
        let size = mine.norm() * others.norm();
        let is_smooth = mine.dot(&others) > 0.0 && mine.cross(&others).norm() <= SMOOTH * size;
        sharp[k][side] = !is_smooth;
        sharp[n][beside] = !is_smooth;
    }
    let turned = if is_closed {
        bodies::turned(points, triangles, budget)?
    } else {
        triangles.iter().map(|triangle| normal(triangle).z < 0.0).collect()
    };
    Ok(Sides { sharp, turned, is_closed })
}
