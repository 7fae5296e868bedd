//! Traces the outlines of an area. The input is the edges of an arrangement, and a rule that tells from the
//! windings about a place whether the place is in the area.
//!
//! # Method
//! 1. Each face between the edges (`orbits`) has the windings that the sides of its edges have over most of
//!    their length. They tell whether the face is in the area.
//! 2. An edge bounds the area if the area lies on exactly one side of the edge. Such an edge is turned so
//!    that the area is on its left.
//! 3. These edges are joined into loops. Where several edges could follow at a vertex, the first one
//!    clockwise from the edge that arrives is taken: these two edges bound the same corner of the area.
//! 4. A loop that visits a vertex twice is divided there into two loops.
//! 5. Successive edges on one line or circle become one element. Loops narrower than 1e-6 mm are dropped.
//! 6. Loops that run clockwise are islands. Each island belongs to the smallest outer outline that contains
//!    it.
//!
//! # Guarantees
//! Every boundary is closed, because the area consists of whole faces. Where sides of one face contradict
//! each other, edges cross between their vertices; [`Bounded::doubt_mm`] tells how long these sides are.

use std::collections::HashMap;

use nalgebra::Point2;

use super::Face;
use super::arrangement::{Arrangement, Edge, SNAP_MM, append_monotone};
use super::orbits::{self, Beside};
use super::outline::{self, Outline};
use super::winding;
use crate::budget::{Budget, Stopped};
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

/// The boundary of an area.
pub(super) struct Bounded<'a> {
    vertices: &'a [Point2<f64>],
    sides: Vec<Side>,
    /// The length of the sides of edges that contradict most of the boundary of their face, mm.
    pub doubt_mm: f64,
    /// The part of this length on which it matters, mm: edge and face do not agree whether the place is in
    /// the area.
    pub wrong_mm: f64,
    /// A place on such a side.
    pub doubtful: Option<Point2<f64>>,
}

/// The boundary of the area in which `is_inside` holds for the windings of both groups.
///
/// # Errors
/// When the budget ends.
pub(super) fn bounded<'a>(
    arrangement: &'a Arrangement,
    is_inside: impl Fn([i32; 2]) -> bool,
    budget: &Budget,
) -> Result<Bounded<'a>, Stopped> {
    let windings = winding::sides(arrangement, budget)?;
    let beside = Beside::new(arrangement);
    // For each face the windings that edges on its boundary say, each with the length of these edges.
    let mut votes: Vec<Vec<([i32; 2], f64)>> = vec![Vec::new(); beside.count];
    for ((edge, sides), faces) in arrangement.edges.iter().zip(&windings).zip(&beside.faces) {
        for (face, said) in faces.iter().zip([sides.left, sides.right]) {
            match votes[*face].iter_mut().find(|(winding, _)| *winding == said) {
                Some((_, length)) => *length += edge.element.length(),
                None => votes[*face].push((said, edge.element.length())),
            }
        }
    }
    let elected = |votes: &Vec<([i32; 2], f64)>| {
        let most = votes.iter().copied().reduce(|a, b| if b.1 > a.1 { b } else { a });
        most.map_or([0; 2], |(winding, _)| winding)
    };
    let elected: Vec<[i32; 2]> = votes.iter().map(elected).collect();
    let (mut sides, mut doubt_mm, mut wrong_mm, mut doubtful) = (Vec::new(), 0.0, 0.0, None);
    for ((edge, said), faces) in arrangement.edges.iter().zip(&windings).zip(&beside.faces) {
        let Edge { element, from, to, origin, .. } = *edge;
        let of_faces = faces.map(|face| elected[face]);
        if of_faces != [said.left, said.right] {
            doubt_mm += element.length();
            doubtful.get_or_insert(element.at(0.5));
            if of_faces.map(&is_inside) != [said.left, said.right].map(&is_inside) {
                wrong_mm += element.length();
            }
        }
        match of_faces.map(&is_inside) {
            [true, false] => sides.push(Side { element, from, to, origin }),
            [false, true] => {
                sides.push(Side { element: element.reversed(), from: to, to: from, origin });
            }
            _ => {}
        }
    }
    Ok(Bounded { vertices: &arrangement.vertices, sides, doubt_mm, wrong_mm, doubtful })
}

impl Bounded<'_> {
    /// The faces of the area.
    ///
    /// # Errors
    /// When the budget ends.
    pub(super) fn faces(&self, budget: &Budget) -> Result<Vec<Face>, Stopped> {
        let ways = loops(self.vertices.len(), &self.sides, Wedge::Inside, budget)?;
        // Elements end where outlines touch.
        let mut leaving = vec![0; self.vertices.len()];
        for side in &self.sides {
            leaving[side.from] += 1;
        }
        let mut found = Vec::new();
        for sides in ways.iter().flat_map(|way| simple(way)) {
            let elements = joined(&sides, |vertex| leaving[vertex] > 1);
            let area = outline::area(&elements);
            // Loops narrower than the snap are dropped.
            if area.abs() > SNAP_MM * outline::length(&elements) {
                let length = |side: &&Side| side.element.length();
                let longest = sides.iter().max_by(|a, b| length(a).total_cmp(&length(b)));
                let on_it = longest.map_or_else(|| elements[0].at(0.5), |side| side.element.at(0.5));
                found.push((Outline::unchecked(elements), area, on_it));
            }
        }
        nested(found, budget)
    }
}

/// The boundary of faces as contours. Where outlines touch, a contour stays about one corner of the wedge. So
/// the corners of a contour are corners of the places beside it.
///
/// # Errors
/// When the budget ends.
pub(super) fn contours<'a>(
    outlines: impl Iterator<Item = &'a Outline>,
    wedge: Wedge,
    budget: &Budget,
) -> Result<Vec<Vec<Segment>>, Stopped> {
    let mut known = HashMap::new();
    let mut at = |p: Point2<f64>| {
        let next = known.len();
        *known.entry([p.x.to_bits(), p.y.to_bits()]).or_insert(next)
    };
    let side = |(origin, element): (usize, &Segment)| {
        let [from, to] = [element.start(), element.end()].map(&mut at);
        Side { element: *element, from, to, origin }
    };
    let boundary: Vec<Side> = outlines.flat_map(Outline::elements).enumerate().map(side).collect();
    let loops = loops(known.len(), &boundary, wedge, budget)?;
    Ok(loops.iter().map(|way| way.iter().map(|side| side.element).collect()).collect())
}

/// The boundary as loops about the corners of the area, or about the corners of the places outside it. At
/// every vertex, the number of sides that end there equals the number of sides that begin there.
fn loops(
    n_vertices: usize,
    boundary: &[Side],
    wedge: Wedge,
    budget: &Budget,
) -> Result<Vec<Vec<Side>>, Stopped> {
    let followers = followers(n_vertices, boundary, wedge, budget)?;
    let mut loops = Vec::new();
    let mut is_used = vec![false; boundary.len()];
    for first in 0..boundary.len() {
        let mut way = Vec::new();
        let mut next = first;
        while !is_used[next] {
            is_used[next] = true;
            way.push(boundary[next]);
            next = followers[next];
        }
        if !way.is_empty() {
            loops.push(way);
        }
    }
    Ok(loops)
}

/// For each side the one that goes on about the same corner of the wedge. Every side follows exactly one.
fn followers(
    n_vertices: usize,
    boundary: &[Side],
    wedge: Wedge,
    budget: &Budget,
) -> Result<Vec<usize>, Stopped> {
    let mut meeting: Vec<Vec<(usize, bool)>> = vec![Vec::new(); n_vertices];
    for (k, side) in boundary.iter().enumerate() {
        meeting[side.from].push((k, true));
        meeting[side.to].push((k, false));
    }
    let mut followers: Vec<usize> = (0..boundary.len()).collect();
    for (vertex, meeting) in meeting.iter().enumerate() {
        if vertex % STEPS_BETWEEN_CHECKS == 0 {
            budget.check()?;
        }
        if let [(a, leaves), (b, _)] = meeting[..] {
            if leaves {
                followers[b] = a;
            } else {
                followers[a] = b;
            }
            continue;
        }
        let away = |(k, leaves): &(usize, bool)| {
            if *leaves { boundary[*k].element } else { boundary[*k].element.reversed() }
        };
        let mut order = orbits::counterclockwise(&meeting.iter().map(away).collect::<Vec<_>>());
        if wedge == Wedge::Inside {
            order.reverse();
        }
        // As brackets are matched: each side that leaves follows the last one that arrived. The second time
        // around closes what the first left open.
        let mut open = Vec::new();
        let mut is_taken = vec![false; meeting.len()];
        for (is_first, k) in [true, false].iter().flat_map(|first| order.iter().map(move |k| (*first, *k))) {
            let (side, leaves) = meeting[k];
            if !leaves {
                open.extend(is_first.then_some(side));
            } else if !is_taken[k]
                && let Some(arrived) = open.pop()
            {
                followers[arrived] = side;
                is_taken[k] = true;
            }
        }
    }
    Ok(followers)
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
                .then(|| Segment::turning(a.start(), b.end(), turn))
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
/// on no other loop. An island in no outline is a sliver beside one, and is left out.
fn nested(loops: Vec<(Outline, f64, Point2<f64>)>, budget: &Budget) -> Result<Vec<Face>, Stopped> {
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
