//! The edges of a mesh that show its shape in a picture.

use std::cmp::Reverse;

use toolpathd_core::budget::Budget;

use super::edges::{Edge, Edges};
use super::welding::{cross, dot, sub};
use super::{MeshFile, STEPS_PER_CHECK};
use crate::fault::Unreadable;

/// Most edges of a mesh of which all are drawn.
const FEW: usize = 600;

/// The least turn between two triangles that makes a sharp edge, radians: 20 degrees, more than the steps of
/// round walls that are fine enough to mill by, less than any bevel.
const SHARP: f64 = 0.349;

/// The numbers of the ends of the edges that show the shape of a mesh as seen from the direction `view`: all
/// of a small mesh; of others those that are sharp, those that are not of two triangles, and those between a
/// triangle that is seen from outside and one that is seen from inside. If these are more than `most`, the
/// sharpest of them.
///
/// # Errors
/// The budget's stop.
pub fn lines(
    mesh: &MeshFile,
    edges: &Edges,
    view: [f64; 3],
    most: usize,
    budget: &Budget,
) -> Result<Vec<[u32; 2]>, Unreadable> {
    let are_few = edges.iter().take(FEW + 1).count() <= FEW;
    let mut found = Vec::new();
    for (k, edge) in edges.iter().enumerate() {
        if k.is_multiple_of(STEPS_PER_CHECK) {
            budget.check()?;
        }
        let turn = turn(mesh, &edge, view);
        if are_few || turn >= SHARP {
            found.push((turn, edge.ends));
        }
    }
    if found.len() > most {
        // Turns are positive numbers, whose bits are in their order.
        found.select_nth_unstable_by_key(most, |(turn, ends)| (Reverse(turn.to_bits()), *ends));
        found.truncate(most);
        found.sort_unstable_by_key(|(_, ends)| *ends);
    }
    Ok(found.into_iter().map(|(_, ends)| ends).collect())
}

/// The turn between the triangles of an edge, radians. More than any turn where the edge has not two
/// triangles, and at an outline.
fn turn(mesh: &MeshFile, edge: &Edge, view: [f64; 3]) -> f64 {
    const CERTAIN: f64 = 4.0;
    let [a, b] = edge.sides else { return CERTAIN };
    let normal = |side: &super::edges::Side| {
        let [a, b, c] = mesh.corners(mesh.triangles.get(side.triangle())?);
        Some(cross(sub(b, a), sub(c, a)))
    };
    // A sliver has no normal.
    let (Some(a), Some(b)) = (normal(a), normal(b)) else { return 0.0 };
    if (dot(a, view) > 0.0) != (dot(b, view) > 0.0) {
        return CERTAIN;
    }
    let across = cross(a, b);
    dot(across, across).sqrt().atan2(dot(a, b))
}
