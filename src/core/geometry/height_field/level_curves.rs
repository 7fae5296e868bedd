//! The boundary of the low part of a height field: of the places that are not higher than a given height.
//!
//! # Method
//! In each triangle the boundary of the low part is at most one straight line, from one edge of the triangle
//! to another. Where the low part reaches the edge of the field, the boundary runs along that edge. On the
//! common edge of two triangles, the lines of both triangles end at the same place. So lines are joined if
//! they end on the same edge or at the same corner, and no distances are compared. On a surface, arcs and
//! longer lines then replace runs of these lines.

use std::collections::HashMap;

use nalgebra::Point2;

use super::HeightField;
use crate::budget::{Budget, Stopped};
use crate::geometry::polyline;
use crate::geometry::segment::Segment;

/// Where a line ends: at a corner, or on the edge between two corners, the smaller index first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
enum Node {
    Corner(u32),
    Edge(u32, u32),
}

/// Closed chains with the places that are not higher than `z_mm` on their left. If `fit_mm` is above zero,
/// arcs and longer lines within this distance replace the lines of level curves.
///
/// # Errors
/// When the budget ends.
pub fn around_low(
    field: &HeightField,
    z_mm: f64,
    fit_mm: f64,
    budget: &Budget,
) -> Result<Vec<Vec<Segment>>, Stopped> {
    let is_low = |corner: u32| field.points[corner as usize].z <= z_mm;
    let mut next: HashMap<Node, Node> = HashMap::new();
    for triangle in &field.triangles {
        if let Some((from, to)) = across(triangle, triangle.map(is_low)) {
            next.insert(from, to);
        }
    }
    for &[a, b] in &field.rim {
        let [from, to] = [Node::Corner(a), Node::Corner(b)];
        match (is_low(a), is_low(b)) {
            (true, true) => next.insert(from, to),
            (true, false) => next.insert(from, edge(a, b)),
            (false, true) => next.insert(edge(a, b), to),
            (false, false) => None,
        };
    }
    let mut all = Vec::new();
    for chain in chains(next) {
        let places: Vec<(Node, Point2<f64>)> =
            chain.into_iter().map(|node| (node, place(field, z_mm, node))).collect();
        let elements = elements(&places, fit_mm, budget)?;
        if !elements.is_empty() {
            all.push(elements);
        }
    }
    Ok(all)
}

/// The line across a triangle with its low part on the left.
fn across(triangle: &[u32; 3], low: [bool; 3]) -> Option<(Node, Node)> {
    // Edge k runs from corner k to the next corner. The line starts on the edge from a low corner to a high
    // corner, and ends on the edge from a high corner to a low corner. So the low part is on its left.
    let rises = (0..3).find(|k| low[*k] && !low[(k + 1) % 3])?;
    let falls = (0..3).find(|k| !low[*k] && low[(k + 1) % 3])?;
    let on = |k: usize| edge(triangle[k], triangle[(k + 1) % 3]);
    Some((on(rises), on(falls)))
}

fn edge(a: u32, b: u32) -> Node {
    Node::Edge(a.min(b), a.max(b))
}

/// The closed chains of nodes.
fn chains(mut next: HashMap<Node, Node>) -> Vec<Vec<Node>> {
    let mut starts: Vec<Node> = next.keys().copied().collect();
    // Corners come first. So a chain that touches the edge of the field begins at a corner, and its beginning
    // divides no level curve.
    starts.sort_unstable();
    let mut chains = Vec::new();
    for start in starts {
        let mut chain = Vec::new();
        let mut node = start;
        while let Some(to) = next.remove(&node) {
            chain.push(node);
            node = to;
        }
        if !chain.is_empty() {
            chains.push(chain);
        }
    }
    chains
}

/// The elements of a closed chain of nodes: lines along the edge of the field; elsewhere lines if `fit_mm` is
/// zero, else arcs and lines within `fit_mm` of the lines between the nodes.
fn elements(places: &[(Node, Point2<f64>)], fit_mm: f64, budget: &Budget) -> Result<Vec<Segment>, Stopped> {
    let mut chain = Vec::new();
    let mut curve: Vec<Point2<f64>> = Vec::new();
    let following = places.iter().cycle().skip(1);
    for ((node, from), (next, to)) in places.iter().zip(following) {
        let is_on_rim = matches!(node, Node::Corner(_)) || matches!(next, Node::Corner(_));
        if is_on_rim || fit_mm == 0.0 {
            chain.extend(polyline::as_arcs(&std::mem::take(&mut curve), fit_mm, budget)?);
            if from != to {
                chain.push(Segment::Line { start: *from, end: *to });
            }
            continue;
        }
        if curve.is_empty() {
            curve.push(*from);
        }
        curve.push(*to);
    }
    chain.extend(polyline::as_arcs(&curve, fit_mm, budget)?);
    Ok(chain)
}

/// Where a node lies on the level curve at `z_mm`.
fn place(field: &HeightField, z_mm: f64, node: Node) -> Point2<f64> {
    match node {
        Node::Corner(corner) => field.points[corner as usize].xy(),
        Node::Edge(a, b) => {
            let [a, b] = [a, b].map(|corner| field.points[corner as usize]);
            let t = ((z_mm - a.z) / (b.z - a.z)).clamp(0.0, 1.0);
            a.xy() + (b.xy() - a.xy()) * t
        }
    }
}
