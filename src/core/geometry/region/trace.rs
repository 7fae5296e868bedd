//! Traces the outlines of an area. The input is the edges of an arrangement, and a rule that tells on which
//! sides of each edge the area lies.
//!
//! # Method
//! 1. An edge bounds the area if the area lies on exactly one side of the edge. Such an edge is turned so
//!    that the area is on its left.
//! 2. These edges are joined into loops. Where several edges could follow at a vertex, the first one
//!    clockwise from the edge that arrives is taken: these two edges bound the same corner of the area.
//! 3. A loop that visits a vertex twice is divided there into two loops.
//! 4. Successive edges on one line or circle become one element. Loops narrower than 1e-6 mm are dropped.
//! 5. Loops that run clockwise are islands. Each island belongs to the smallest outer outline that contains
//!    it.
//!
//! If the edges do not form closed loops, the area is refused.

use std::collections::HashMap;

use nalgebra::{Point2, Vector2};

use super::arrangement::{Arrangement, Edge, SNAP_MM, append_monotone};
use super::outline::{self, Outline};
use super::winding::{self, Sides};
use super::{Face, RegionError};
use crate::budget::Budget;
use crate::geometry::offset::tree::Tree;
use crate::geometry::segment::Segment;

/// Lines and circles that differ by less are the same, mm: the difference is rounding.
const SAME_CARRIER_MM: f64 = 1e-9;

/// The largest turn of an arc that is joined from several, radians, so that no arc is nearly a full circle.
const LARGEST_TURN: f64 = 1.5 * std::f64::consts::PI;

/// Steps between two checks of the budget.
const STEPS_BETWEEN_CHECKS: usize = 256;

/// The side of a boundary that an offset needs: inside the area or outside it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Wedge {
    Inside,
    Outside,
}

/// An edge of the boundary, with the area on its left.
#[derive(Clone, Copy)]
struct Side {
    element: Segment,
    from: usize,
    to: usize,
    origin: usize,
}

/// The faces of the area in which `is_inside` holds for the windings of both groups.
///
/// # Errors
/// [`RegionError::Tangled`] where the boundary is not closed, [`RegionError::Stopped`].
pub(super) fn faces(
    arrangement: &Arrangement,
    is_inside: impl Fn([i32; 2]) -> bool,
    budget: &Budget,
) -> Result<Vec<Face>, RegionError> {
    let windings = winding::sides(arrangement, budget)?;
    let boundary: Vec<Side> = arrangement
        .edges
        .iter()
        .zip(&windings)
        .filter_map(|(edge, sides)| bounding(edge, sides, &is_inside))
        .collect();
    if let Some(at) = unbalanced(&arrangement.vertices, &boundary) {
        return Err(RegionError::Tangled { at });
    }
    let ways = loops(&arrangement.vertices, &boundary, Wedge::Inside, budget)?;
    // Elements end where outlines touch.
    let mut leaving = vec![0; arrangement.vertices.len()];
    for side in &boundary {
        leaving[side.from] += 1;
    }
    let mut found = Vec::new();
    for sides in ways.iter().flat_map(|way| simple(way)) {
        let elements = joined(&sides, |vertex| leaving[vertex] > 1);
        let area = outline::area(&elements);
        // Loops narrower than the snap are dropped.
        if area.abs() > SNAP_MM * outline::length(&elements) {
            let on_it = sides[0].element.at(0.5);
            found.push((Outline::unchecked(elements), area, on_it));
        }
    }
    nested(found, budget)
}

/// A vertex at which the numbers of arriving and leaving sides differ; `None` if there is none.
fn unbalanced(vertices: &[Point2<f64>], boundary: &[Side]) -> Option<Point2<f64>> {
    let mut excess = vec![0_i32; vertices.len()];
    for side in boundary {
        excess[side.from] += 1;
        excess[side.to] -= 1;
    }
    excess.iter().position(|excess| *excess != 0).map(|vertex| vertices[vertex])
}

fn bounding(edge: &Edge, sides: &Sides, is_inside: impl Fn([i32; 2]) -> bool) -> Option<Side> {
    let Edge { element, from, to, origin, .. } = *edge;
    match (is_inside(sides.left), is_inside(sides.right)) {
        (true, false) => Some(Side { element, from, to, origin }),
        (false, true) => Some(Side { element: element.reversed(), from: to, to: from, origin }),
        _ => None,
    }
}

/// The boundary of faces as contours. Where outlines touch, a contour stays about one corner of the wedge. So
/// the corners of a contour are corners of the places beside it.
///
/// # Errors
/// [`RegionError::Tangled`], [`RegionError::Stopped`].
pub(super) fn contours<'a>(
    outlines: impl Iterator<Item = &'a Outline>,
    wedge: Wedge,
    budget: &Budget,
) -> Result<Vec<Vec<Segment>>, RegionError> {
    let mut vertices = Vec::new();
    let mut known = HashMap::new();
    let mut at = |p: Point2<f64>| {
        *known.entry([p.x.to_bits(), p.y.to_bits()]).or_insert_with(|| {
            vertices.push(p);
            vertices.len() - 1
        })
    };
    let side = |(origin, element): (usize, &Segment)| {
        let [from, to] = [element.start(), element.end()].map(&mut at);
        Side { element: *element, from, to, origin }
    };
    let boundary: Vec<Side> = outlines.flat_map(Outline::elements).enumerate().map(side).collect();
    let loops = loops(&vertices, &boundary, wedge, budget)?;
    Ok(loops.iter().map(|way| way.iter().map(|side| side.element).collect()).collect())
}

/// The boundary as loops about the corners of the area, or about the corners of the places outside it.
fn loops(
    vertices: &[Point2<f64>],
    boundary: &[Side],
    wedge: Wedge,
    budget: &Budget,
) -> Result<Vec<Vec<Side>>, RegionError> {
    let mut leaving: Vec<Vec<usize>> = vec![Vec::new(); vertices.len()];
    for (k, side) in boundary.iter().enumerate() {
        leaving[side.from].push(k);
    }
    let mut loops = Vec::new();
    let mut is_used = vec![false; boundary.len()];
    let mut steps = 0;
    for first in 0..boundary.len() {
        let mut way = Vec::new();
        let mut next = first;
        while !is_used[next] {
            steps += 1;
            if steps % STEPS_BETWEEN_CHECKS == 0 {
                budget.check()?;
            }
            is_used[next] = true;
            way.push(boundary[next]);
            let at = boundary[next].to;
            let onward = onward(boundary, next, &leaving[at], wedge);
            next = onward.ok_or(RegionError::Tangled { at: vertices[at] })?;
        }
        if next != first {
            return Err(RegionError::Tangled { at: boundary[next].element.start() });
        }
        if !way.is_empty() {
            loops.push(way);
        }
    }
    Ok(loops)
}

/// Divides a loop into loops that visit no vertex twice.
fn simple(way: &[Side]) -> Vec<Vec<Side>> {
    let (mut loops, mut open): (Vec<Vec<Side>>, Vec<Side>) = (Vec::new(), Vec::new());
    // For each vertex on the loop so far, how many sides lead to it.
    let mut visited = HashMap::new();
    for side in way {
        visited.insert(side.from, open.len());
        open.push(*side);
        if let Some(&start) = visited.get(&side.to) {
            for side in &open[start..] {
                visited.remove(&side.from);
            }
            loops.push(open.drain(start..).collect());
        }
    }
    loops
}

/// The side that goes on from side `k` about the same corner of the wedge, among the sides `leaving` the
/// vertex where `k` arrives.
fn onward(boundary: &[Side], k: usize, leaving: &[usize], wedge: Wedge) -> Option<usize> {
    if leaving.len() < 2 {
        return leaving.first().copied();
    }
    // Sides may be tangent to each other at the vertex. So directions are measured as far from the vertex as
    // the shortest side allows.
    let arrived = boundary[k].element.reversed();
    let chord = |element: &Segment| (element.end() - element.start()).norm();
    let elements = || leaving.iter().map(|other| &boundary[*other].element).chain([&arrived]);
    let reach = 0.5 * elements().map(chord).fold(f64::INFINITY, f64::min);
    let direction = |element: &Segment| {
        let t = (reach / element.length()).min(1.0);
        element.at(t) - element.start()
    };
    let from = direction(&arrived);
    let turn = |other: &usize| {
        let to: Vector2<f64> = direction(&boundary[*other].element);
        let sense = if wedge == Wedge::Inside { -1.0 } else { 1.0 };
        (sense * from.perp(&to)).atan2(from.dot(&to)).rem_euclid(std::f64::consts::TAU)
    };
    leaving.iter().copied().min_by(|a, b| turn(a).total_cmp(&turn(b)))
}

/// The elements of a loop: successive sides on one line or circle are one element, unless `is_end` holds for
/// the vertex between them.
fn joined(sides: &[Side], is_end: impl Fn(usize) -> bool) -> Vec<Segment> {
    let joint = |before: &Side, after: &Side| if is_end(after.from) { None } else { joint([before, after]) };
    // If the loop begins in the middle of an element, that element comes last.
    let start = (1..sides.len()).find(|k| joint(&sides[k - 1], &sides[*k]).is_none()).unwrap_or(0);
    let mut elements: Vec<Side> = Vec::with_capacity(sides.len());
    for side in sides[start..].iter().chain(&sides[..start]) {
        let whole = elements.last().and_then(|before| joint(before, side));
        if let (Some(element), Some(before)) = (whole, elements.last_mut()) {
            *before = Side { element, from: before.from, ..*side };
        } else {
            elements.push(*side);
        }
    }
    let remade = |side: Side| match side.element {
        Segment::Line { .. } => side.element,
        Segment::Arc(arc) => Segment::turning(arc.start(), arc.end(), arc.turn()),
    };
    elements.into_iter().map(remade).collect()
}

/// One element for two sides, if both are on the same line or circle.
fn joint([before, after]: [&Side; 2]) -> Option<Segment> {
    let is_one = before.origin == after.origin;
    match (before.element, after.element) {
        (Segment::Arc(a), Segment::Arc(b)) => {
            let turn = a.turn() + b.turn();
            let beside = (a.center() - b.center()).norm() + (a.radius() - b.radius()).abs();
            let is_same = is_one || beside <= SAME_CARRIER_MM;
            (is_same && a.turn() * b.turn() > 0.0 && turn.abs() <= LARGEST_TURN)
                .then(|| a.between([a.start(), b.end()], turn))
        }
        (Segment::Line { start, end: middle }, Segment::Line { end, .. }) => {
            let chord = (end - start).normalize();
            let beside = chord.perp(&(middle - start)).abs();
            let is_ahead = (middle - start).dot(&(end - middle)) > 0.0;
            (is_ahead && (is_one && beside <= SNAP_MM || beside <= SAME_CARRIER_MM))
                .then_some(Segment::Line { start, end })
        }
        _ => None,
    }
}

/// The faces: every island is put into its outline. Each loop comes with its area, and with a place that is
/// on no other loop.
fn nested(loops: Vec<(Outline, f64, Point2<f64>)>, budget: &Budget) -> Result<Vec<Face>, RegionError> {
    let (mut elements, mut owners) = (Vec::new(), Vec::new());
    for (k, (outline, ..)) in loops.iter().enumerate() {
        for element in outline.elements() {
            append_monotone(element, &mut elements);
        }
        owners.resize(elements.len(), k);
    }
    let tree = Tree::new(elements);
    // For each island the index of its outline.
    let mut homes: Vec<Option<usize>> = vec![None; loops.len()];
    let mut windings = vec![0; loops.len()];
    for (k, (_, area, place)) in loops.iter().enumerate().filter(|(_, (_, area, _))| *area < 0.0) {
        budget.check()?;
        let mut met = Vec::new();
        winding::along_ray(&tree, *place, |element, sense| {
            met.push(owners[element]);
            windings[owners[element]] += sense;
        });
        met.sort_unstable();
        met.dedup();
        let about = met.iter().copied().filter(|other| windings[*other] > 0 && loops[*other].1 > -area);
        homes[k] = about.min_by(|a, b| loops[*a].1.total_cmp(&loops[*b].1));
        if homes[k].is_none() {
            return Err(RegionError::Tangled { at: *place });
        }
        for other in met {
            windings[other] = 0;
        }
    }
    let mut faces = Vec::new();
    let mut place = vec![0; loops.len()];
    let mut islands = Vec::new();
    for (k, (outline, area, _)) in loops.into_iter().enumerate() {
        if area > 0.0 {
            place[k] = faces.len();
            faces.push(Face { outer: outline, islands: Vec::new() });
        } else {
            islands.push((homes[k], outline));
        }
    }
    for (home, outline) in islands {
        if let Some(home) = home {
            faces[place[home]].islands.push(outline);
        }
    }
    Ok(faces)
}
