//! Windings: how often loops turn about a place. Each counterclockwise turn adds one, and each clockwise turn
//! subtracts one.
//!
//! # Method
//! 1. A ray runs from the place toward larger x. An element that crosses the ray upward adds 1 to the
//!    winding, and an element that crosses it downward subtracts 1.
//! 2. For step 1, an element contains its lower end, but not its upper end (Franklin's rule). So where a loop
//!    crosses the ray at a vertex, only one of the two elements counts. A horizontal line never counts.
//! 3. On each side of an edge, all places next to the edge have the same winding. At a vertex where only two
//!    edges meet, the second edge has the windings of the first. So one ray is enough for a whole chain of
//!    such edges.
//!
//! # Reference
//! W. Randolph Franklin's rule for places in polygons.

use nalgebra::Point2;

use super::arrangement::{Arrangement, Edge};
use crate::budget::{Budget, Stopped};
use crate::geometry::offset::tree::{Bounds, Tree};
use crate::geometry::segment::Segment;

/// Edges between two checks of the budget.
const EDGES_BETWEEN_CHECKS: usize = 64;

/// The windings of each group about the places on either side of an edge.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sides {
    pub left: [i32; 2],
    pub right: [i32; 2],
}

/// 1 if the element passes the ray from `p` toward larger x upward, -1 if downward, else 0. Along the element
/// y must only rise or only fall. The side of the element on which `p` lies decides, by the cross product for
/// a line, and by the distance from the centre for an arc. No crossing is computed, so a ray that is tangent
/// to an arc needs no special case.
pub(super) fn passes(element: &Segment, p: Point2<f64>) -> i32 {
    let (start, end) = (element.start(), element.end());
    let sense = match (start.y <= p.y, end.y <= p.y) {
        (true, false) => 1,
        (false, true) => -1,
        _ => return 0,
    };
    let is_ahead = match element {
        Segment::Line { .. } => f64::from(sense) * (end - start).perp(&(p - start)) > 0.0,
        Segment::Arc(arc) => {
            let is_in_circle = (p - arc.center()).norm() < arc.radius();
            let bulges_ahead = f64::from(sense) * arc.turn() > 0.0;
            if bulges_ahead {
                p.x < arc.center().x || is_in_circle
            } else {
                p.x < arc.center().x && !is_in_circle
            }
        }
    };
    if is_ahead { sense } else { 0 }
}

/// Calls `see` for each element that the ray from `p` passes, with the element's index and with 1 or -1 as in
/// [`passes`]. Along each element of the tree y must only rise or only fall.
pub(super) fn along_ray(tree: &Tree, p: Point2<f64>, mut see: impl FnMut(usize, i32)) {
    tree.meeting(&Bounds { low: p, high: Point2::new(f64::INFINITY, p.y) }, |k, element| {
        let sense = passes(element, p);
        if sense != 0 {
            see(k, sense);
        }
    });
}

/// The windings about both sides of every edge.
///
/// # Errors
/// When the budget ends.
pub(super) fn sides(arrangement: &Arrangement, budget: &Budget) -> Result<Vec<Sides>, Stopped> {
    let edges = &arrangement.edges;
    let tree = Tree::new(edges.iter().map(|edge| edge.element).collect());
    let edges_at = arrangement.edges_at();
    let mut sides: Vec<Option<Sides>> = vec![None; edges.len()];
    let mut chain: Vec<(usize, bool)> = Vec::new();
    for first in 0..edges.len() {
        if first % EDGES_BETWEEN_CHECKS == 0 {
            budget.check()?;
        }
        if sides[first].is_some() {
            continue;
        }
        let unknown = Sides { left: [0; 2], right: [0; 2] };
        sides[first] = Some(unknown);
        chain.clear();
        chain.push((first, true));
        let Edge { from, to, .. } = edges[first];
        for (mut at, mut edge, is_forward) in [(to, first, true), (from, first, false)] {
            // Follows the chain until more than two edges meet, or the chain is closed.
            while let [a, b] = edges_at[at][..] {
                let next = if a == edge { b } else { a };
                if sides[next].is_some() {
                    break;
                }
                sides[next] = Some(unknown);
                let is_onward = edges[next].from == at;
                chain.push((next, is_onward == is_forward));
                at = if is_onward { edges[next].to } else { edges[next].from };
                edge = next;
            }
        }
        // The middle of the longest edge is the farthest from other edges.
        let length = |(k, _): &(usize, bool)| edges[*k].element.length();
        let longest = chain.iter().copied().reduce(|a, b| if length(&b) > length(&a) { b } else { a });
        let (longest, is_along) = longest.unwrap_or((first, true));
        let known = by_ray(edges, &tree, longest);
        for (k, own) in &chain {
            let is_same = *own == is_along;
            sides[*k] = Some(if is_same { known } else { Sides { left: known.right, right: known.left } });
        }
    }
    Ok(sides.into_iter().flatten().collect())
}

fn by_ray(edges: &[Edge], tree: &Tree, k: usize) -> Sides {
    let Edge { element, count, .. } = &edges[k];
    let middle = element.at(0.5);
    let mut ahead = [0; 2];
    along_ray(tree, middle, |other, sense| {
        if other != k {
            let passed = edges[other].count;
            ahead = [ahead[0] + sense * passed[0], ahead[1] + sense * passed[1]];
        }
    });
    let less = [ahead[0] - count[0], ahead[1] - count[1]];
    let more = [ahead[0] + count[0], ahead[1] + count[1]];
    let (start, end) = (element.start(), element.end());
    // The ray runs on the right of an edge that rises. A place at the height of the edge's upper end, as
    // every place of a horizontal edge, counts as above the edge. Snapping can put a place below both ends;
    // such a place counts as below the edge.
    let is_ahead_left = match (start.y <= middle.y, end.y <= middle.y) {
        (true, false) => false,
        (false, true) => true,
        (true, true) => start.x < end.x,
        (false, false) => start.x >= end.x,
    };
    if is_ahead_left { Sides { left: ahead, right: less } } else { Sides { left: more, right: ahead } }
}

/// A vertex where more than two edges meet, at an end of an edge whose windings are `such`. If there is no
/// such vertex, the start of the first such edge; `None` if there is no such edge.
pub(super) fn first_junction(
    arrangement: &Arrangement,
    sides: &[Sides],
    such: impl Fn(&Sides) -> bool,
) -> Option<Point2<f64>> {
    let edges_at = arrangement.edges_at();
    let all: Vec<&Edge> =
        arrangement.edges.iter().zip(sides).filter(|(_, sides)| such(sides)).map(|(edge, _)| edge).collect();
    let junction = all.iter().flat_map(|edge| [edge.from, edge.to]).find(|at| edges_at[*at].len() > 2);
    junction.or(all.first().map(|edge| edge.from)).map(|at| arrangement.vertices[at])
}
