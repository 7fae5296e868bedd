//! Edges of bodies, each divided once for all faces that share it.
//!
//! # Method
//! Faces of one body name the same edge by its instance; sides of polygons by their ends. Where one edge of a
//! loop ends the next begins: the two ends are one vertex, however far apart the file has them. Between its
//! ends an edge has places, each with a vertex.

use std::collections::BTreeMap;

use nalgebra::Point3;

use super::curve_bounds::CurveBounds;
use crate::step::curve::Curve;
use crate::step::model::{Edge, Face};

/// Two parameters of an edge are one if they differ by less than this part of its length.
const SAME: f64 = 1e-10;

/// A place on an edge with its vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mark {
    pub t: f64,
    pub vertex: u32,
}

/// An edge of a body.
#[derive(Debug, Clone)]
pub struct Record {
    pub curve: Curve,
    pub bounds: CurveBounds,
    /// Growing, with both ends.
    pub places: Vec<Mark>,
}

/// How a face uses an edge: the record, and whether its parameter runs the other way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Use {
    pub record: usize,
    pub is_turned: bool,
}

/// The edges of bodies with their vertices.
#[derive(Debug, Clone, Default)]
pub struct Edges {
    pub records: Vec<Record>,
    pub vertices: Vec<Point3<f64>>,
    /// The largest distance of two ends that are one vertex, mm.
    pub gap_mm: f64,
}

/// What makes two edges of faces one: body and instance, or body and ends.
type Key = (usize, u64, [[u64; 3]; 2]);

impl Record {
    pub fn ends(&self) -> [f64; 2] {
        [self.places[0].t, self.places[self.places.len() - 1].t]
    }

    /// The number of the place at a parameter.
    pub fn find(&self, t: f64) -> Option<usize> {
        let [from, to] = self.ends();
        let near = SAME * (to - from);
        let k = self.places.partition_point(|place| place.t < t - near);
        self.places.get(k).is_some_and(|place| (place.t - t).abs() <= near).then_some(k)
    }

    /// The parameter of a face's edge in the parameter of the record, or the other way round.
    pub fn turned(&self, t: f64, is_turned: bool) -> f64 {
        let [from, to] = self.ends();
        if is_turned { from + (to - t) } else { t }
    }

    /// The most that a chord leaves the curve between two parameters, mm.
    pub fn deviation(&self, [from, to]: [f64; 2]) -> f64 {
        let (length, kinks) = (to - from, self.bounds.jumps([from, to]));
        self.bounds.over([from, to])[1] * length * length / 8.0 + kinks * length.abs() / 4.0
    }
}

impl Edges {
    /// The edges of faces, undivided, with how each face uses its edges in the order of its loops.
    pub fn of(faces: &[&Face]) -> (Self, Vec<Vec<Use>>) {
        let mut edges = Self::default();
        let mut known: BTreeMap<Key, usize> = BTreeMap::new();
        let mut groups = Groups::default();
        let mut uses = Vec::with_capacity(faces.len());
        for face in faces {
            let mut of_face = Vec::new();
            for one in &face.loops {
                let first = of_face.len();
                for (k, edge) in one.edges.iter().enumerate() {
                    let n = one.edges.len();
                    let key = key(face.body, edge, &one.edges[(k + n - 1) % n], &one.edges[(k + 1) % n]);
                    let record = *known.entry(key).or_insert_with(|| edges.add(edge, &mut groups));
                    of_face.push(Use { record, is_turned: edges.is_turned(record, edge) });
                }
                edges.join(&one.edges, &of_face[first..], &mut groups);
            }
            uses.push(of_face);
        }
        edges.merge(&mut groups);
        (edges, uses)
    }

    /// Adds an edge, whose vertices are its ends.
    fn add(&mut self, edge: &Edge, groups: &mut Groups) -> usize {
        let ends = [edge.from.min(edge.to), edge.from.max(edge.to)];
        let places = ends.map(|t| Mark { t, vertex: self.add_vertex(edge.curve.point(t)) });
        groups.grow(self.vertices.len());
        let (curve, bounds) = (edge.curve.clone(), CurveBounds::new(&edge.curve));
        self.records.push(Record { curve, bounds, places: places.to_vec() });
        self.records.len() - 1
    }

    fn add_vertex(&mut self, point: Point3<f64>) -> u32 {
        self.vertices.push(point);
        (self.vertices.len() - 1) as u32
    }

    /// Whether the side of a polygon has been added in the other direction.
    fn is_turned(&self, record: usize, edge: &Edge) -> bool {
        let (Curve::Line { along, .. }, Curve::Line { along: first, .. }) =
            (&edge.curve, &self.records[record].curve)
        else {
            return false;
        };
        edge.entity == 0 && along.dot(first) < 0.0
    }

    /// Makes the ends of the edges of a loop one vertex with the starts of the next.
    fn join(&mut self, edges: &[Edge], uses: &[Use], groups: &mut Groups) {
        let end = |k: usize, is_end: bool| {
            let (edge, at) = (&edges[k], &uses[k]);
            let is_higher = (edge.from <= edge.to) == is_end;
            let places = &self.records[at.record].places;
            places[usize::from(is_higher != at.is_turned)].vertex
        };
        for k in 0..edges.len() {
            groups.join(end(k, true), end((k + 1) % edges.len(), false));
        }
    }

    /// Gives the vertices of a group one number.
    fn merge(&mut self, groups: &mut Groups) {
        let mut numbers: BTreeMap<u32, u32> = BTreeMap::new();
        let old = std::mem::take(&mut self.vertices);
        for vertex in 0..old.len() as u32 {
            let first = groups.first(vertex);
            let number = *numbers.entry(first).or_insert_with(|| {
                self.vertices.push(old[first as usize]);
                (self.vertices.len() - 1) as u32
            });
            self.gap_mm = self.gap_mm.max((old[vertex as usize] - self.vertices[number as usize]).norm());
        }
        for place in self.records.iter_mut().flat_map(|record| &mut record.places) {
            place.vertex = numbers[&groups.first(place.vertex)];
        }
    }

    /// Divides a record at parameters, apart from those where it has a place. Whether it was divided.
    pub fn divide(&mut self, record: usize, at: &[f64]) -> bool {
        let [from, to] = self.records[record].ends();
        let near = SAME * (to - from);
        let mut new: Vec<f64> = at.iter().copied().filter(|t| *t > from + near && *t < to - near).collect();
        new.sort_by(f64::total_cmp);
        new.dedup_by(|b, a| *b - *a <= near);
        new.retain(|t| self.records[record].find(*t).is_none());
        for t in &new {
            let vertex = self.add_vertex(self.records[record].curve.point(*t));
            self.records[record].places.push(Mark { t: *t, vertex });
        }
        self.records[record].places.sort_by(|a, b| a.t.total_cmp(&b.t));
        !new.is_empty()
    }

    /// How many places a record needs so that its chords are within `allowed_mm`, at most.
    pub fn n_places(&self, record: usize, allowed_mm: f64) -> f64 {
        self.spans(record).into_iter().map(|span| self.parts(record, span, allowed_mm)).sum()
    }

    /// Divides a record at the breaks of its curve, and so finely that its chords are within `allowed_mm`.
    pub fn divide_evenly(&mut self, record: usize, allowed_mm: f64) {
        let mut places = Vec::new();
        for [from, to] in self.spans(record) {
            let n = self.parts(record, [from, to], allowed_mm) as usize;
            places.extend((0..n).map(|k| from + (to - from) * k as f64 / n as f64));
        }
        self.divide(record, &places);
    }

    fn parts(&self, record: usize, [from, to]: [f64; 2], allowed_mm: f64) -> f64 {
        let second = self.records[record].bounds.over([from, to])[1];
        let n = ((to - from) * (second / (8.0 * allowed_mm)).sqrt()).ceil();
        // A closed curve has at least three sides, and other curves turn by a quarter at most.
        if second > 0.0 { n.max(1.0) } else { 1.0 }
    }

    /// The ranges between the breaks of a record.
    fn spans(&self, record: usize) -> Vec<[f64; 2]> {
        let one = &self.records[record];
        let ends = one.ends();
        let breaks = match &one.curve {
            Curve::Circle { .. } | Curve::Ellipse { .. } => {
                let n = ((ends[1] - ends[0]) / std::f64::consts::FRAC_PI_2).ceil().max(1.0);
                (0..=n as usize).map(|k| ends[0] + (ends[1] - ends[0]) * k as f64 / n).collect()
            }
            curve => curve.breaks(ends),
        };
        breaks.windows(2).map(|pair| [pair[0], pair[1]]).collect()
    }
}

/// The key of an edge between two others of its loop.
fn key(body: usize, edge: &Edge, before: &Edge, after: &Edge) -> Key {
    if edge.entity != 0 {
        return (body, edge.entity, Default::default());
    }
    // The start of a side of a polygon is a point of the file; its end is one of the next side's.
    let point = |a: (&Edge, f64), b: (&Edge, f64)| {
        let (edge, t) = if a.1 == 0.0 { a } else { b };
        let point = edge.curve.point(t);
        [point.x, point.y, point.z].map(|x| (x + 0.0).to_bits())
    };
    let mut ends =
        [point((edge, edge.from), (before, before.to)), point((edge, edge.to), (after, after.from))];
    ends.sort_unstable();
    (body, 0, ends)
}

/// Disjoint groups of vertices.
#[derive(Debug, Default)]
struct Groups(Vec<u32>);

impl Groups {
    fn grow(&mut self, n: usize) {
        self.0.extend(self.0.len() as u32..n as u32);
    }

    /// The lowest vertex of the group.
    fn first(&mut self, mut vertex: u32) -> u32 {
        while self.0[vertex as usize] != vertex {
            let above = self.0[vertex as usize];
            self.0[vertex as usize] = self.0[above as usize];
            vertex = above;
        }
        vertex
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.first(a), self.first(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}
