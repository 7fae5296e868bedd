//! Faces of a file: the surface with its bounds in space.

use nalgebra::{Point3, Vector3};

use super::curve::Curve;
use super::frame::Frame;
use super::instance::Instance;
use super::model::{Edge, Loop};
use super::placement::Geometry;
use super::refusal::Refusal;
use super::surface::Surface;
use crate::fault::Unreadable;

/// The most edges of a face.
const MOST_EDGES: usize = 100_000;

/// A vertex may lie this far from its curve, mm, and this part of the edge's length. Kernels allow 0.01 mm.
const VERTEX_MISS_MM: f64 = 0.05;
const VERTEX_MISS_SHARE: f64 = 1e-3;

/// Two vertices nearer than this, mm, make a closed curve a whole turn.
const SAME_POINT_MM: f64 = 1e-7;

/// A face as the file has it, in the units of its representation.
#[derive(Debug, Clone, PartialEq)]
pub struct FaceOutline {
    pub entity: u64,
    pub name: String,
    pub surface: Surface,
    /// Whether the normal of the face is opposite to that of the surface.
    pub is_reversed: bool,
    pub loops: Vec<Loop>,
}

impl Geometry<'_> {
    /// A face.
    ///
    /// # Errors
    /// The file is broken, or the face is of a kind that is left out.
    pub fn face(&self, number: u32) -> Result<FaceOutline, Refusal> {
        let instance = self.source.get(number)?;
        let entity = instance.place();
        let (base, first) = if instance.is_complex() && instance.has("FACE") {
            (instance.part("FACE")?, 0)
        } else {
            (instance.attributes(), 1)
        };
        let mut loops = Vec::new();
        let mut n_edges = 0;
        for bound in base.references(first)? {
            let found = self.bound(bound)?;
            n_edges += found.as_ref().map_or(0, |one| one.edges.len());
            if n_edges > MOST_EDGES {
                return Err(Refusal::shape(instance.kind(), "it has more than 100000 edges", entity));
            }
            loops.extend(found);
        }
        let name = self.name_of(&instance);
        match instance.kind() {
            "FACE" if !instance.is_complex() => {
                let surface = plane_of(&loops).ok_or_else(|| {
                    Refusal::shape("FACE", "it has no surface, and its bounds make no plane", entity)
                })?;
                Ok(FaceOutline { entity, name, surface, is_reversed: false, loops })
            }
            "ADVANCED_FACE" | "FACE_SURFACE" | "FACE" => {
                let (part, first) = if instance.is_complex() {
                    (instance.part("FACE_SURFACE")?, 0)
                } else {
                    (instance.attributes(), 2)
                };
                let surface = self.surface(part.reference(first)?)?;
                let is_reversed = !part.truth(first + 1)?;
                Ok(FaceOutline { entity, name, surface, is_reversed, loops })
            }
            kind => Err(Refusal::shape(kind, "faces of this kind are not read", entity)),
        }
    }

    fn name_of(&self, instance: &Instance) -> String {
        let part = instance.part("REPRESENTATION_ITEM").unwrap_or_else(|_| instance.attributes());
        part.text(0)
    }

    /// The loop of a bound in the direction of the bound. `None` for a loop that is a point.
    fn bound(&self, number: u32) -> Result<Option<Loop>, Refusal> {
        let bound = self.source.get(number)?;
        if !matches!(bound.kind(), "FACE_BOUND" | "FACE_OUTER_BOUND") {
            return Err(bound.fault(format!("a bound of a face is expected, not {}", bound.name())).into());
        }
        let part = bound.attributes();
        let instance = self.source.get(part.reference(1)?)?;
        let is_forward = part.truth(2)?;
        let of = instance.attributes();
        let mut edges = match instance.kind() {
            "VERTEX_LOOP" => return Ok(None),
            "EDGE_LOOP" => {
                let numbers = of.references(1)?;
                if numbers.len() > MOST_EDGES {
                    let reason = "a bound has more than 100000 edges";
                    return Err(Refusal::shape(instance.kind(), reason, instance.place()));
                }
                numbers.iter().map(|number| self.oriented_edge(*number)).collect::<Result<Vec<_>, _>>()?
            }
            "POLY_LOOP" => polygon(&self.points(&of.references(1)?)?),
            kind => return Err(Refusal::shape(kind, "loops of this kind are not read", instance.place())),
        };
        if !is_forward {
            edges.reverse();
            edges.iter_mut().for_each(|edge| std::mem::swap(&mut edge.from, &mut edge.to));
        }
        if edges.is_empty() {
            return Err(instance.fault("the loop has no edges").into());
        }
        Ok(Some(Loop { edges }))
    }

    fn oriented_edge(&self, number: u32) -> Result<Edge, Refusal> {
        self.budget.check()?;
        let oriented = self.source.get(number)?;
        let part = oriented.part("ORIENTED_EDGE")?;
        let mut edge = self.edge(part.reference(3)?)?;
        if !part.truth(4)? {
            std::mem::swap(&mut edge.from, &mut edge.to);
        }
        Ok(edge)
    }

    fn edge(&self, number: u32) -> Result<Edge, Refusal> {
        let instance = self.source.get(number)?;
        if instance.kind() != "EDGE_CURVE" {
            let reason = "edges of this kind have no curve that is read";
            return Err(Refusal::shape(&instance.name(), reason, instance.place()));
        }
        let part = instance.attributes();
        let ends = [part.reference(1)?, part.reference(2)?];
        let points = [self.vertex(ends[0])?, self.vertex(ends[1])?];
        let curve = self.curve(part.reference(3)?)?;
        let is_same_vertex = ends[0] == ends[1] || (points[1] - points[0]).norm() < SAME_POINT_MM;
        let [from, to] = range(&curve, &points, is_same_vertex, part.truth(4)?);
        let edge = Edge { entity: instance.place(), curve, from, to };
        let chord = (points[1] - points[0]).norm();
        let allowed = VERTEX_MISS_MM + VERTEX_MISS_SHARE * chord;
        let miss = (edge.start() - points[0]).norm().max((edge.end() - points[1]).norm());
        if miss.is_nan() || miss > allowed {
            let reason = "a vertex of an edge is not on its curve";
            return Err(Refusal::shape("EDGE_CURVE", reason, instance.place()));
        }
        Ok(edge)
    }

    fn vertex(&self, number: u32) -> Result<Point3<f64>, Unreadable> {
        let instance = self.source.get(number)?;
        self.point(instance.part("VERTEX_POINT")?.reference(1)?)
    }
}

/// The parameters of the ends of an edge, from its first vertex to its second.
fn range(curve: &Curve, points: &[Point3<f64>; 2], is_same_vertex: bool, is_forward: bool) -> [f64; 2] {
    let [a, b] = [curve.nearest(&points[0]), curve.nearest(&points[1])];
    let Some(period) = curve.period() else {
        // An open curve whose ends meet less closely than a closed one is passed once.
        let ends = curve.domain().filter(|_| is_same_vertex);
        return match (ends, is_forward) {
            (None, _) => [a, b],
            (Some([from, to]), true) => [from, to],
            (Some([from, to]), false) => [to, from],
        };
    };
    let near = 1e-9 * period;
    let turn = match (is_same_vertex, is_forward) {
        (true, true) => period,
        (true, false) => -period,
        (false, true) => (b - a - near).rem_euclid(period) + near,
        (false, false) => -((a - b - near).rem_euclid(period) + near),
    };
    let Some([start, end]) = curve.domain() else { return [a, a + turn] };
    // A part that begins at the joint of a closed curve begins at the end that it leaves from.
    if is_forward && (a - end).abs() < near {
        [start, start + turn]
    } else if !is_forward && (a - start).abs() < near {
        [end, end + turn]
    } else {
        [a, a + turn]
    }
}

/// The edges of a polygon.
fn polygon(points: &[Point3<f64>]) -> Vec<Edge> {
    let n = points.len();
    let side = |k: usize| {
        let (origin, end) = (points[k], points[(k + 1) % n]);
        let along = (end - origin).try_normalize(f64::MIN_POSITIVE)?;
        let to = (end - origin).norm();
        Some(Edge { entity: 0, curve: Curve::Line { origin, along }, from: 0.0, to })
    };
    (0..n).filter_map(side).collect()
}

/// The plane of the largest loop, with the normal about which the loop goes counterclockwise.
fn plane_of(loops: &[Loop]) -> Option<Surface> {
    let normal_of = |one: &Loop| -> Vector3<f64> {
        let origin = one.edges[0].start();
        let cross = |edge: &Edge| (edge.start() - origin).cross(&(edge.end() - origin));
        one.edges.iter().map(cross).sum()
    };
    let normals = loops.iter().filter(|one| !one.edges.is_empty()).map(|one| (normal_of(one), &one.edges[0]));
    let (normal, edge) = normals.max_by(|a, b| a.0.norm().total_cmp(&b.0.norm()))?;
    let near = edge.end() - edge.start();
    Frame::from_axis(edge.start(), normal, Some(near)).map(|frame| Surface::Plane { frame })
}
