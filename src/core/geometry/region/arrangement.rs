//! An arrangement: closed loops of lines and arcs, cut into edges that meet only at the vertices where they
//! end.
//!
//! # Method
//! Places that are nearer to each other than a given short distance, the snap, count as one place.
//! 1. The ends of all elements become vertices, and so do all places where two elements cross or nearly
//!    touch.
//! 2. Each element is cut at all vertices within the snap of it. The parts are the edges. Each edge is made
//!    anew, so that it starts and ends exactly at vertices.
//! 3. Edges that were moved to vertices may meet others anew. So the edges are cut again, up to the asked
//!    number of passes, until none is.
//! 4. Several edges between the same two vertices become one edge, if their middles also lie close together.
//!    The new edge counts how often the loops run along it in its direction, less how often they run along it
//!    backward. If the count is zero, the edge is dropped.
//!
//! # Guarantees
//! Edges lie within a few snaps of the elements that they are parts of. At every vertex, the loops arrive as
//! often as they leave. More than a million elements are refused, and so are more than a million cuts.
//!
//! # Cost
//! O(n log n + k) for n elements, where k is the number of pairs of elements whose boxes meet.

use std::collections::HashMap;

use nalgebra::{Point2, Vector2};

use super::contacts;
use crate::budget::{Budget, Stopped};
use crate::geometry::offset::tree::{Bounds, Tree};
use crate::geometry::segment::{PlaneArc, Segment};

/// The least distance from an arc's end at which the arc is divided, mm.
const SHORTEST_MM: f64 = 1e-9;

/// Places nearer to each other than this are one place, mm. The value is ten times the distance by which ends
/// of offsets may lie beside their circles. With a smaller value, edges that should coincide would leave
/// slivers between them. A larger value would show in programs.
pub(super) const SNAP_MM: f64 = 1e-6;

/// Edges between the same vertices are one edge if their middles are no farther apart than this many snaps:
/// both ends of both edges may have moved by the snap.
const SNAPS_OF_AN_EDGE: f64 = 4.0;

/// The largest number of elements, and of cuts of elements: what one machine holds with ease.
pub(super) const LIMIT: usize = 1_000_000;

/// Elements between two checks of the budget.
const ELEMENTS_BETWEEN_CHECKS: usize = 64;

/// A closed loop. The area to its left belongs to the group.
pub(super) struct Loop<'a> {
    pub group: usize,
    pub elements: &'a [Segment],
}

/// A part of an element between two vertices; it stands for all elements that run along it.
pub(super) struct Edge {
    pub element: Segment,
    pub from: usize,
    pub to: usize,
    /// How often the loops of each group run along the edge, less how often they run back along it.
    pub count: [i32; 2],
    /// The index of the element that the edge lies on, counted over all loops.
    pub origin: usize,
}

pub(super) struct Arrangement {
    pub vertices: Vec<Point2<f64>>,
    pub edges: Vec<Edge>,
    /// A place where two elements run along each other, if there is one.
    pub overlap: Option<Point2<f64>>,
}

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub(super) enum ArrangementError {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    #[error("the outlines need more than {limit} elements")]
    TooMany { limit: usize },
}

impl Arrangement {
    /// The arrangement of loops. The edges are cut up to `passes` times.
    ///
    /// # Errors
    /// One of [`ArrangementError`].
    pub(super) fn new(
        loops: &[Loop],
        snap_mm: f64,
        passes: usize,
        budget: &Budget,
    ) -> Result<Self, ArrangementError> {
        if loops.iter().map(|one| one.elements.len()).sum::<usize>() > LIMIT {
            return Err(ArrangementError::TooMany { limit: LIMIT });
        }
        let (mut edges, mut vertices, mut parts) = (Vec::new(), Vertices::new(snap_mm), Vec::new());
        let all = loops.iter().flat_map(|one| one.elements.iter().map(|element| (one.group, element)));
        for (origin, (group, element)) in all.enumerate() {
            append_monotone(element, &mut parts);
            for element in parts.drain(..) {
                let [from, to] = [element.start(), element.end()].map(|p| vertices.at(p));
                if from != to {
                    let mut count = [0; 2];
                    count[group] = 1;
                    edges.push(Edge { element, from, to, count, origin });
                }
            }
        }
        let mut overlap = None;
        for _ in 0..passes {
            let before = edges.len();
            let parts = divided(&edges, &mut vertices, budget)?;
            let is_settled = parts.len() == before;
            let (kept, overlapping) = merged(parts, SNAPS_OF_AN_EDGE * snap_mm);
            edges = kept;
            overlap = overlap.or(overlapping);
            if is_settled {
                break;
            }
        }
        Ok(Self { vertices: vertices.places, edges, overlap })
    }

    /// For each vertex the edges that end there.
    pub(super) fn edges_at(&self) -> Vec<Vec<usize>> {
        let mut at = vec![Vec::new(); self.vertices.len()];
        for (k, edge) in self.edges.iter().enumerate() {
            at[edge.from].push(k);
            at[edge.to].push(k);
        }
        at
    }
}

/// The parts of edges between the vertices near them.
fn divided(edges: &[Edge], vertices: &mut Vertices, budget: &Budget) -> Result<Vec<Edge>, ArrangementError> {
    let tree = Tree::new(edges.iter().map(|edge| edge.element).collect());
    let cuts = cuts(edges, &tree, vertices, budget)?;
    let mut parts = Vec::with_capacity(edges.len());
    for (edge, cuts) in edges.iter().zip(&cuts) {
        for pair in cuts.windows(2) {
            let [from, to] = [pair[0].1, pair[1].1];
            if from != to {
                let element = between(&edge.element, vertices.places[from], vertices.places[to]);
                parts.push(Edge { element, from, to, ..*edge });
            }
        }
    }
    Ok(parts)
}

/// For each element the vertices at which it is cut, in order, with their places along it.
fn cuts(
    edges: &[Edge],
    tree: &Tree,
    vertices: &mut Vertices,
    budget: &Budget,
) -> Result<Vec<Vec<(f64, usize)>>, ArrangementError> {
    let elements = tree.elements();
    let mut cuts = vec![Vec::new(); elements.len()];
    let (mut found, mut near, mut count) = (Vec::new(), Vec::new(), 0);
    let snap = Vector2::repeat(vertices.snap_mm);
    for (k, element) in elements.iter().enumerate() {
        if k % ELEMENTS_BETWEEN_CHECKS == 0 {
            budget.check()?;
        }
        let Bounds { low, high } = Bounds::of(element);
        let around = Bounds { low: low - snap, high: high + snap };
        near.clear();
        tree.meeting(&around, |other, _| near.extend((other > k).then_some(other)));
        for &other in &near {
            contacts::append(element, &elements[other], vertices.snap_mm, &mut found);
            count += 2 * found.len();
            for place in found.drain(..) {
                let vertex = vertices.at(place);
                cuts[k].push((along(element, place), vertex));
                cuts[other].push((along(&elements[other], place), vertex));
            }
        }
        if count > LIMIT {
            return Err(ArrangementError::TooMany { limit: LIMIT });
        }
    }
    for (vertex, &place) in vertices.places.iter().enumerate() {
        if vertex % ELEMENTS_BETWEEN_CHECKS == 0 {
            budget.check()?;
        }
        tree.near(place, vertices.snap_mm, |k, _| {
            if edges[k].from != vertex && edges[k].to != vertex {
                cuts[k].push((along(&elements[k], place), vertex));
                count += 1;
            }
            count <= LIMIT
        });
    }
    if count > LIMIT {
        return Err(ArrangementError::TooMany { limit: LIMIT });
    }
    for (cuts, edge) in cuts.iter_mut().zip(edges) {
        let [start, end] = [edge.from, edge.to];
        cuts.retain(|(_, vertex)| *vertex != start && *vertex != end);
        cuts.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        cuts.insert(0, (f64::NEG_INFINITY, start));
        cuts.push((f64::INFINITY, end));
        cuts.dedup_by_key(|(_, vertex)| *vertex);
    }
    Ok(cuts)
}

/// A measure, which grows along the element, of how far along it a place beside it is.
fn along(element: &Segment, p: Point2<f64>) -> f64 {
    match element {
        Segment::Line { start, end } => (end - start).dot(&(p - start)),
        Segment::Arc(arc) => arc.turn().signum() * from_middle(arc, p),
    }
}

/// The angle from the middle of an arc to the spoke of a place, radians.
fn from_middle(arc: &PlaneArc, p: Point2<f64>) -> f64 {
    let middle = Segment::Arc(*arc).at(0.5) - arc.center();
    let spoke = p - arc.center();
    middle.perp(&spoke).atan2(middle.dot(&spoke))
}

/// The part of an element between two vertices beside it. Arcs are made from their ends: an arc that missed
/// its vertex by the snap would have nearby places on the wrong side.
fn between(element: &Segment, start: Point2<f64>, end: Point2<f64>) -> Segment {
    match element {
        Segment::Line { .. } => Segment::Line { start, end },
        Segment::Arc(arc) => Segment::turning(start, end, from_middle(arc, end) - from_middle(arc, start)),
    }
}

/// The edges without repetitions, and a place where an edge was repeated.
fn merged(edges: Vec<Edge>, same_mm: f64) -> (Vec<Edge>, Option<Point2<f64>>) {
    let mut order: Vec<usize> = (0..edges.len()).collect();
    let key = |k: usize| {
        let Edge { from, to, .. } = edges[k];
        (from.min(to), from.max(to), k)
    };
    order.sort_unstable_by_key(|k| key(*k));
    let mut count: Vec<[i32; 2]> = edges.iter().map(|edge| edge.count).collect();
    let mut overlap = None;
    for (place, &k) in order.iter().enumerate() {
        let middle = edges[k].element.at(0.5);
        let same_ends = |other: &&usize| (key(**other).0, key(**other).1) == (key(k).0, key(k).1);
        let before = order[..place].iter().rev().take_while(same_ends);
        // The first of equal edges replaces all of them.
        let first = before.copied().filter(|other| {
            count[*other] != [0; 2] && (edges[*other].element.at(0.5) - middle).norm() <= same_mm
        });
        if let Some(first) = first.last() {
            let sense = if edges[first].from == edges[k].from { 1 } else { -1 };
            let [here, there] = [count[first], count[k]];
            count[first] = [here[0] + sense * there[0], here[1] + sense * there[1]];
            count[k] = [0; 2];
            overlap.get_or_insert(middle);
        }
    }
    let kept = edges.into_iter().zip(count).filter(|(_, count)| *count != [0; 2]);
    (kept.map(|(edge, count)| Edge { count, ..edge }).collect(), overlap)
}

/// The vertices. Places that are nearer to each other than the snap are one vertex.
struct Vertices {
    snap_mm: f64,
    places: Vec<Point2<f64>>,
    cells: HashMap<[i64; 2], Vec<usize>>,
}

impl Vertices {
    fn new(snap_mm: f64) -> Self {
        Self { snap_mm, places: Vec::new(), cells: HashMap::new() }
    }

    /// The index of the vertex nearest to a place, within the snap; a new vertex if there is none.
    fn at(&mut self, p: Point2<f64>) -> usize {
        let cell = |x: f64| (x / self.snap_mm).floor() as i64;
        let [i, j] = [cell(p.x), cell(p.y)];
        let mut nearest: Option<(f64, usize)> = None;
        for (di, dj) in (-1..=1).flat_map(|di| (-1..=1).map(move |dj| (di, dj))) {
            for &vertex in self.cells.get(&[i + di, j + dj]).into_iter().flatten() {
                let distance = (self.places[vertex] - p).norm();
                if distance <= self.snap_mm && nearest.is_none_or(|(least, _)| distance < least) {
                    nearest = Some((distance, vertex));
                }
            }
        }
        nearest.map_or_else(
            || {
                self.places.push(p);
                self.cells.entry([i, j]).or_default().push(self.places.len() - 1);
                self.places.len() - 1
            },
            |(_, vertex)| vertex,
        )
    }
}

/// Appends the parts of an element along which y only rises or only falls. A line is one part; arcs are
/// divided at their highest and lowest points.
pub(super) fn append_monotone(element: &Segment, parts: &mut Vec<Segment>) {
    let Segment::Arc(arc) = element else {
        parts.push(*element);
        return;
    };
    let mut cuts: Vec<(f64, Point2<f64>)> = Vec::with_capacity(2);
    for pole in [Vector2::y(), -Vector2::y()] {
        let angle = arc.angle_to(pole);
        // If the highest or lowest point is nearer to an end than this, y only rises or only falls along the
        // arc, to rounding.
        let shortest = SHORTEST_MM / arc.radius();
        if angle > shortest && angle < arc.turn().abs() - shortest {
            cuts.push((angle, arc.center() + pole * arc.radius()));
        }
    }
    cuts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut turned, mut start) = (0.0, arc.start());
    for (angle, place) in cuts.into_iter().chain([(arc.turn().abs(), arc.end())]) {
        let turn = arc.turn().signum() * (angle - turned);
        parts.push(arc.between([start, place], turn));
        (turned, start) = (angle, place);
    }
}
