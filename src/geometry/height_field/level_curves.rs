//! The boundary of the low part of a height field.
//!
//! # Method
//! In each triangle the boundary of the low part is at most one straight line, from one edge of the triangle
//! to another. Where the low part reaches the edge of the field, it runs along that edge. Neighbouring
//! triangles cross their common edge at the same place. So the lines are joined by the corners and edges on
//! which they end, and no distances are compared. On a curved surface, arcs then replace runs of these lines.

use std::collections::HashMap;

use nalgebra::{Point2, Vector2};

use super::HeightField;
use crate::budget::{Budget, Stopped};
use crate::geometry::arc_fit::{self, Fit, Joints, Measure, Method, Points, Shape};
use crate::geometry::element::{Element, PlaneArc};

/// Where a line ends: at a corner, or on the edge between two corners, the smaller index first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
enum Node {
    Corner(u32),
    Edge(u32, u32),
}

/// Closed chains that have the places with heights of at most `z_mm` on their left. Where `fit_mm` is above
/// zero, arcs within this distance replace the lines of level curves.
///
/// # Errors
/// When the budget ends.
pub fn around_low(
    field: &HeightField,
    z_mm: f64,
    fit_mm: f64,
    budget: &Budget,
) -> Result<Vec<Vec<Element>>, Stopped> {
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
    // Edge k runs from corner k to the next. The low part is on the left of a line that comes from the edge on
    // which the triangle's boundary rises and goes to the edge on which it falls.
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
    // Corners come first: a chain along the edge of the field begins there.
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

/// A chain of nodes as lines, or, where they are on a curved surface, as arcs within `fit_mm` of these lines.
fn elements(places: &[(Node, Point2<f64>)], fit_mm: f64, budget: &Budget) -> Result<Vec<Element>, Stopped> {
    let mut chain = Vec::new();
    let mut curve: Vec<Vector2<f64>> = Vec::new();
    let following = places.iter().cycle().skip(1);
    for ((node, from), (next, to)) in places.iter().zip(following) {
        let is_on_rim = matches!(node, Node::Corner(_)) || matches!(next, Node::Corner(_));
        if is_on_rim || fit_mm == 0.0 {
            append_fitted(&mut chain, &mut curve, fit_mm, budget)?;
            if from != to {
                chain.push(Element::Line { start: *from, end: *to });
            }
            continue;
        }
        if curve.is_empty() {
            curve.push(from.coords);
        }
        if to.coords != curve[curve.len() - 1] {
            curve.push(to.coords);
        }
    }
    append_fitted(&mut chain, &mut curve, fit_mm, budget)?;
    Ok(chain)
}

/// Appends elements along a level curve, which is empty afterwards.
fn append_fitted(
    chain: &mut Vec<Element>,
    curve: &mut Vec<Vector2<f64>>,
    fit_mm: f64,
    budget: &Budget,
) -> Result<(), Stopped> {
    let flat = std::mem::take(curve);
    if flat.len() < 2 {
        return Ok(());
    }
    let request = Fit {
        method: Method::Greedy,
        joints: Joints::OnPoints,
        measure: Measure::Polyline,
        ..Fit::within(fit_mm)
    };
    let fitted = arc_fit::fit(Points { flat: &flat, heights: &[] }, &request, budget)?;
    let mut start = Point2::from(fitted.start);
    for element in fitted.elements {
        let end = Point2::from(element.to);
        let arc = match element.shape {
            Shape::Arc { bulge } => PlaneArc::with_bulge(start, end, bulge),
            // An open curve has no full circles.
            Shape::Line | Shape::FullCircle { .. } => None,
        };
        chain.push(arc.map_or(Element::Line { start, end }, Element::Arc));
        start = end;
    }
    Ok(())
}

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
