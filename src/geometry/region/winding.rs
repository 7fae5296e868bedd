//! How often loops wind about a place, and about the two sides of an edge.
//!
//! # Method
//! A ray runs from the place toward larger x. Every element that passes it upward winds once about the place,
//! every element that passes it downward winds back. An element holds its lower end and not its upper one, so
//! that a vertex on the ray counts once, and a horizontal line never. Along an edge, and on through vertices
//! where only two edges meet, the windings of both sides stay: one ray serves a whole chain of edges.
//!
//! # Guarantees
//! A place is on the same side of an element as by its cross product with the line, or its distance from the
//! centre of the arc, to rounding. Nothing else is computed; tangent rays need no care.

use nalgebra::Point2;

use super::arrangement::{Arrangement, Edge};
use crate::budget::{Budget, Stopped};
use crate::geometry::element::Element;
use crate::geometry::offset::pieces;
use crate::geometry::offset::tree::Tree;

/// Edges between two looks at the budget.
const EDGES_BETWEEN_CHECKS: usize = 64;

/// The windings of each group about places beside an edge.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sides {
    pub left: [i32; 2],
    pub right: [i32; 2],
}

/// 1 where an element passes the ray from `p` toward larger x upward, -1 downward, else 0. Along the element
/// y must only rise or only fall.
pub(super) fn passes(element: &Element, p: Point2<f64>) -> i32 {
    let (start, end) = (element.start(), element.end());
    let sense = match (start.y <= p.y, end.y <= p.y) {
        (true, false) => 1,
        (false, true) => -1,
        _ => return 0,
    };
    let is_ahead = match element {
        Element::Arc(arc) => {
            let is_in_circle = (p - arc.center).norm() < arc.radius;
            let bulges_ahead = f64::from(sense) * arc.turn > 0.0;
            if bulges_ahead {
                p.x < arc.center.x || is_in_circle
            } else {
                p.x < arc.center.x && !is_in_circle
            }
        }
        _ => f64::from(sense) * (end - start).perp(&(p - start)) > 0.0,
    };
    if is_ahead { sense } else { 0 }
}

/// Shows the elements, along each of which y only rises or only falls, that the ray from `p` passes, with 1
/// or -1.
pub(super) fn along_ray(tree: &Tree, p: Point2<f64>, mut see: impl FnMut(usize, i32)) {
    tree.meeting(p, Point2::new(f64::INFINITY, p.y), |k, element| {
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
    for first in 0..edges.len() {
        if first % EDGES_BETWEEN_CHECKS == 0 {
            budget.check()?;
        }
        if sides[first].is_some() {
            continue;
        }
        let known = by_ray(edges, &tree, first);
        sides[first] = Some(known);
        let Edge { from, to, .. } = edges[first];
        let mirrored = Sides { left: known.right, right: known.left };
        for (mut at, here, mut edge) in [(to, known, first), (from, mirrored, first)] {
            // Onward, until edges meet or the chain is closed.
            while let [a, b] = edges_at[at][..] {
                let next = if a == edge { b } else { a };
                if sides[next].is_some() {
                    break;
                }
                let is_onward = edges[next].from == at;
                sides[next] =
                    Some(if is_onward { here } else { Sides { left: here.right, right: here.left } });
                at = if is_onward { edges[next].to } else { edges[next].from };
                edge = next;
            }
        }
    }
    Ok(sides.into_iter().flatten().collect())
}

fn by_ray(edges: &[Edge], tree: &Tree, k: usize) -> Sides {
    let Edge { element, count, .. } = &edges[k];
    let middle = pieces::at(element, 0.5);
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
    // Beside an edge that rises the ray runs on its right. A place at the height of the upper end, as all on
    // a horizontal edge are, counts as above the edge, and at a lower height than both ends, where these are
    // snapped, as below.
    let is_ahead_left = match (start.y <= middle.y, end.y <= middle.y) {
        (true, false) => false,
        (false, true) => true,
        (true, true) => start.x < end.x,
        (false, false) => start.x >= end.x,
    };
    if is_ahead_left { Sides { left: ahead, right: less } } else { Sides { left: more, right: ahead } }
}

/// A vertex where a chain of edges ends of which one is `such`: more than two edges meet there. Without such
/// vertices, the start of the edge.
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
