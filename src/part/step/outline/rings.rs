//! The loops around level faces that hang together by edges.
//!
//! # Method
//! 1. The outermost loop of each face is directed counterclockwise in plan, the others clockwise.
//! 2. An edge that two faces pass in opposite directions is inside: it vanishes. A walk along the other edges
//!    goes on, at the end of an edge, past the edges that vanish.
//! 3. Among the loops around faces that are joined by edges that vanish, the largest is the outer one.
//!
//! # Guarantees
//! The area of the outer loop less those of the inner ones is the area of the faces, within the deviation;
//! where the walk leads to another area, no edge vanishes, and each face stands alone.

use std::collections::BTreeMap;
use std::ops::Range;

use nalgebra::{Point3, Vector3};
use toolpathd_core::budget::Budget;

use super::plan::{self, NoPlan, PlanEdge};
use crate::drawing::bulge;
use crate::step::curve::Curve;
use crate::step::model::{Edge, Face};
use crate::step::piece::spread;

/// The area within the loops may differ from that of the faces by this part of the area.
const SAME_AREA: f64 = 1e-6;

/// What tells an edge from others: its number, or its ends if it is a side of a polygon.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum EdgeKey {
    Entity(u64),
    Ends([[u64; 3]; 2]),
}

impl EdgeKey {
    /// The key of an edge of a loop, and whether the loop passes the edge forwards.
    pub fn of(edges: &[Edge], k: usize) -> (Self, bool) {
        let edge = &edges[k];
        let is_forward = edge.from < edge.to;
        if edge.entity > 0 {
            return (Self::Entity(edge.entity), is_forward);
        }
        let n = edges.len();
        let origin = |edge: &Edge| match &edge.curve {
            Curve::Line { origin, .. } => *origin,
            _ => edge.start(),
        };
        // The origin of a side is a point of the file, to the last digit; its end is computed.
        let other = if is_forward { (k + 1) % n } else { (k + n - 1) % n };
        let bits = |point: Point3<f64>| <[f64; 3]>::from(point).map(|x| (x + 0.0).to_bits());
        let ends = [bits(origin(edge)), bits(origin(&edges[other]))];
        let is_growing = ends[0] <= ends[1];
        let sorted = if is_growing { ends } else { [ends[1], ends[0]] };
        (Self::Ends(sorted), is_growing == is_forward)
    }
}

/// An edge as a face passes it, with the face to the left in plan.
#[derive(Debug, Clone, PartialEq)]
pub struct HalfEdge {
    pub face: usize,
    pub key: EdgeKey,
    is_forward: bool,
    pub plan: PlanEdge,
    /// Places on the edge, and the direction of the edge there, mm per unit of its parameter.
    pub places: Vec<(Point3<f64>, Vector3<f64>)>,
    /// The next half edge of the face.
    next: usize,
}

/// Faces that hang together, with the half edges of their loops.
#[derive(Debug, Clone, PartialEq)]
pub struct JoinedFaces {
    pub faces: Vec<usize>,
    pub outer: Vec<HalfEdge>,
    pub inner: Vec<Vec<HalfEdge>>,
}

/// The level faces of one body that are joined by edges. The numbers grow.
///
/// # Errors
/// An edge has no plan, or the budget has ended. The number is that of the edge, or of its face.
pub fn joined_faces(
    faces: &[Face],
    numbers: &[usize],
    tolerance_mm: f64,
    budget: &Budget,
) -> Result<Vec<JoinedFaces>, (u64, NoPlan)> {
    let mut halves = Vec::new();
    for number in numbers {
        push_face(*number, &faces[*number], tolerance_mm, budget, &mut halves)?;
    }
    let joined = Halves { twins: twins(&halves), halves: &halves };
    let apart = Halves { twins: vec![None; halves.len()], halves: &halves };
    let mut found = Vec::new();
    for group in joined.groups(numbers) {
        budget.check().map_err(|stopped| (0, stopped.into()))?;
        let expected: f64 = group.iter().map(|number| faces[*number].area_mm2).sum();
        match joined.around(&group).filter(|joined| has_area(joined, expected)) {
            Some(joined) => found.push(joined),
            None => found.extend(group.iter().filter_map(|number| apart.around(&[*number]))),
        }
    }
    Ok(found)
}

/// The vertices of a loop of half edges.
pub fn vertices(ring: &[HalfEdge]) -> Vec<[f64; 3]> {
    let without_end = |half: &HalfEdge| half.plan.vertices[..half.plan.vertices.len() - 1].to_vec();
    ring.iter().flat_map(without_end).collect()
}

/// The largest distance of a loop from its edges: of arcs from the curves in their place, and between the
/// ends of edges that meet, mm.
pub fn deviation_mm(ring: &[HalfEdge]) -> f64 {
    let n = ring.len();
    let gap = |k: usize| {
        let (end, start) = (&ring[k].plan.vertices, &ring[(k + 1) % n].plan.vertices[0]);
        let end = end[end.len() - 1];
        f64::hypot(start[0] - end[0], start[1] - end[1])
    };
    (0..n).map(|k| gap(k) + ring[k].plan.deviation_mm).fold(0.0, f64::max)
}

/// Appends the half edges of a face, its outermost loop counterclockwise and the others clockwise.
fn push_face(
    number: usize,
    face: &Face,
    tolerance_mm: f64,
    budget: &Budget,
    halves: &mut Vec<HalfEdge>,
) -> Result<(), (u64, NoPlan)> {
    let mut rings = Vec::new();
    for one in face.loops.iter().filter(|one| !one.edges.is_empty()) {
        let mut ring = Vec::with_capacity(one.edges.len());
        for (k, edge) in one.edges.iter().enumerate() {
            let (key, is_forward) = EdgeKey::of(&one.edges, k);
            let entity = if edge.entity > 0 { edge.entity } else { face.entity };
            let plan = plan::plan(edge, tolerance_mm, budget).map_err(|reason| (entity, reason))?;
            let place = |at: f64| {
                let (point, slope) = edge.curve.jet(at);
                (point, if edge.from < edge.to { slope } else { -slope })
            };
            let places = spread(edge).into_iter().map(place).collect();
            ring.push(HalfEdge { face: number, key, is_forward, plan, places, next: 0 });
        }
        rings.push((bulge::area(&vertices(&ring)), ring));
    }
    let outermost = (0..rings.len()).max_by(|a, b| rings[*a].0.abs().total_cmp(&rings[*b].0.abs()));
    for (k, (area, ring)) in rings.into_iter().enumerate() {
        let is_right = (area > 0.0) == (Some(k) == outermost);
        let mut ring = if is_right { ring } else { turned(ring) };
        let (first, n) = (halves.len(), ring.len());
        ring.iter_mut().enumerate().for_each(|(k, half)| half.next = first + (k + 1) % n);
        halves.append(&mut ring);
    }
    Ok(())
}

/// A loop in the other direction.
fn turned(ring: Vec<HalfEdge>) -> Vec<HalfEdge> {
    let turn = |half: HalfEdge| HalfEdge {
        is_forward: !half.is_forward,
        plan: plan::reversed(&half.plan),
        places: half.places.iter().map(|(place, along)| (*place, -along)).collect(),
        ..half
    };
    ring.into_iter().rev().map(turn).collect()
}

/// For each half edge, the one that passes the same edge in the other direction, if there is just one.
fn twins(halves: &[HalfEdge]) -> Vec<Option<usize>> {
    let mut by_key: BTreeMap<EdgeKey, Vec<usize>> = BTreeMap::new();
    for (k, half) in halves.iter().enumerate() {
        by_key.entry(half.key).or_default().push(k);
    }
    let mut twins = vec![None; halves.len()];
    for pair in by_key.values() {
        if let [a, b] = pair[..]
            && halves[a].is_forward != halves[b].is_forward
        {
            (twins[a], twins[b]) = (Some(b), Some(a));
        }
    }
    twins
}

/// Half edges, those of a face side by side, with their twins.
struct Halves<'a> {
    halves: &'a [HalfEdge],
    twins: Vec<Option<usize>>,
}

impl Halves<'_> {
    /// The faces that are joined by twins, in the order of their first faces.
    fn groups(&self, numbers: &[usize]) -> Vec<Vec<usize>> {
        let mut beside: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (half, twin) in self.halves.iter().zip(&self.twins) {
            beside.entry(half.face).or_default().extend(twin.map(|twin| self.halves[twin].face));
        }
        let mut groups = Vec::new();
        for number in numbers {
            let mut open = vec![*number];
            let mut group = Vec::new();
            while let Some(face) = open.pop() {
                if let Some(others) = beside.remove(&face) {
                    group.push(face);
                    open.extend(others);
                }
            }
            group.sort_unstable();
            groups.extend((!group.is_empty()).then_some(group));
        }
        groups
    }

    /// The half edges of a face.
    fn of_face(&self, number: usize) -> Range<usize> {
        let first = self.halves.partition_point(|half| half.face < number);
        first..self.halves.partition_point(|half| half.face <= number)
    }

    /// The loops around faces; `None` if a walk does not come back.
    fn around(&self, group: &[usize]) -> Option<JoinedFaces> {
        let own = || group.iter().flat_map(|number| self.of_face(*number));
        let mut is_open: BTreeMap<usize, bool> = own().map(|k| (k, self.twins[k].is_none())).collect();
        let mut rings: Vec<Vec<HalfEdge>> = Vec::new();
        for first in own() {
            let mut ring = Vec::new();
            let mut at = first;
            while let Some(open) = is_open.get_mut(&at).filter(|open| **open) {
                *open = false;
                ring.push(self.halves[at].clone());
                at = self.next(at)?;
            }
            if !ring.is_empty() {
                if at != first {
                    return None;
                }
                rings.push(ring);
            }
        }
        let area = |ring: &Vec<HalfEdge>| bulge::area(&vertices(ring)).abs();
        let outermost = (0..rings.len()).max_by(|a, b| area(&rings[*a]).total_cmp(&area(&rings[*b])))?;
        let outer = rings.remove(outermost);
        Some(JoinedFaces { faces: group.to_vec(), outer, inner: rings })
    }

    /// The half edge that goes on at the end of another, past the edges that vanish.
    fn next(&self, from: usize) -> Option<usize> {
        let mut at = self.halves[from].next;
        for _ in 0..self.halves.len() {
            match self.twins[at] {
                None => return Some(at),
                Some(twin) => at = self.halves[twin].next,
            }
        }
        None
    }
}

/// Whether the loops around faces bound this area.
fn has_area(joined: &JoinedFaces, expected: f64) -> bool {
    let area = |ring: &Vec<HalfEdge>| bulge::area(&vertices(ring));
    let rings = || joined.inner.iter().chain([&joined.outer]);
    let slack: f64 = rings().map(|ring| deviation_mm(ring) * bulge::length(&vertices(ring), true)).sum();
    // Inner loops run clockwise.
    let found: f64 = rings().map(area).sum();
    (found - expected).abs() <= slack + SAME_AREA * expected
}
