//! Finds the faces into which the edges of an arrangement divide the plane.
//!
//! # Method
//! 1. The edges that meet at a vertex are sorted by the directions in which they leave the vertex. The
//!    directions of two tangent edges are measured at a distance from the vertex: as far away as the shorter
//!    of the two edges reaches.
//! 2. The boundary of a face is followed from edge to edge. At each vertex, the boundary goes on along the
//!    first edge clockwise from the edge on which it arrived.
//!
//! # Guarantees
//! Each edge has two sides, and each side belongs to exactly one face. So an area that consists of whole
//! faces has a closed boundary, even after rounding has moved the edges.
//!
//! # Cost
//! O(n log n) for n edges, if few edges meet at each vertex.

use nalgebra::{Point2, Vector2};

use super::arrangement::Arrangement;
use crate::geometry::segment::Segment;

/// Directions that differ by less may have been put in the wrong order by a short edge beside them, radians.
const TANGENT: f64 = 1e-3;

/// The faces beside each edge, as indices: to its left and to its right.
pub(super) struct Beside {
    pub faces: Vec<[usize; 2]>,
    /// The number of faces.
    pub count: usize,
}

impl Beside {
    pub(super) fn new(arrangement: &Arrangement) -> Self {
        // Each edge is two directed edges: 2 k in its direction, 2 k + 1 back. A face is on their left.
        let n = arrangement.edges.len();
        let mut next = vec![0; 2 * n];
        for (vertex, edges) in arrangement.edges_at().iter().enumerate() {
            let directed: Vec<usize> =
                edges.iter().map(|k| 2 * k + usize::from(arrangement.edges[*k].from != vertex)).collect();
            let leaving = |h: &usize| {
                let element = arrangement.edges[h / 2].element;
                if h.is_multiple_of(2) { element } else { element.reversed() }
            };
            let order = counterclockwise(&directed.iter().map(leaving).collect::<Vec<_>>());
            for (place, k) in order.iter().enumerate() {
                let before = order[(place + order.len() - 1) % order.len()];
                next[directed[*k] ^ 1] = directed[before];
            }
        }
        let mut faces = vec![[usize::MAX; 2]; n];
        let mut count = 0;
        for first in 0..2 * n {
            let mut h = first;
            while faces[h / 2][h % 2] == usize::MAX {
                faces[h / 2][h % 2] = count;
                h = next[h];
            }
            count += usize::from(faces[first / 2][first % 2] == count);
        }
        Self { faces, count }
    }
}

/// The indices of elements that leave one vertex, sorted counterclockwise by their directions.
pub(super) fn counterclockwise(leaving: &[Segment]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..leaving.len()).collect();
    if leaving.len() < 3 {
        return order;
    }
    let chord = |k: usize| (leaving[k].end() - leaving[k].start()).norm();
    let shortest = order.iter().map(|k| chord(*k)).fold(f64::INFINITY, f64::min);
    let angles: Vec<f64> = leaving
        .iter()
        .map(|element| {
            let toward = toward(element, 0.5 * shortest);
            toward.y.atan2(toward.x)
        })
        .collect();
    order.sort_by(|a, b| angles[*a].total_cmp(&angles[*b]).then(a.cmp(b)));
    let is_reversed = |a: usize, b: usize| {
        let reach = 0.5 * chord(a).min(chord(b));
        let [one, other] = [a, b].map(|k| toward(&leaving[k], reach));
        let (across, along) = (one.perp(&other), one.dot(&other));
        across < 0.0 && along > 0.0 && -across < TANGENT * along
    };
    for _ in 0..order.len() {
        let mut is_sorted = true;
        for k in 0..order.len() {
            let after = (k + 1) % order.len();
            if is_reversed(order[k], order[after]) {
                order.swap(k, after);
                is_sorted = false;
            }
        }
        if is_sorted {
            break;
        }
    }
    order
}

/// The vector from the start of an element to the place about `reach` mm along it.
fn toward(element: &Segment, reach: f64) -> Vector2<f64> {
    let length = element.length();
    let place: Point2<f64> = if length > 0.0 { element.at((reach / length).min(1.0)) } else { element.end() };
    place - element.start()
}
