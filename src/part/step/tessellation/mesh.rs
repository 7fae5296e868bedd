//! The triangulation of the plane of a face's parameters.

use std::collections::HashMap;

use nalgebra::Point3;
use spade::handles::{FixedDirectedEdgeHandle, FixedFaceHandle, FixedVertexHandle, InnerTag};
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation};

use super::polygons::Node;

/// A point of the triangulation: its place in steps, its parameters and its vertex.
#[derive(Debug, Clone, Copy)]
pub struct Spot {
    pub place: Point2<f64>,
    pub at: [f64; 2],
    pub node: Node,
    /// The surface's point.
    pub point: Point3<f64>,
}

impl HasPosition for Spot {
    type Scalar = f64;
    fn position(&self) -> Point2<f64> {
        self.place
    }
}

pub type Mesh = ConstrainedDelaunayTriangulation<Spot>;

/// Which faces of the triangulation lie within the polygons, by their index.
pub fn inside(mesh: &Mesh, is_bound: &HashMap<[usize; 2], bool>) -> Vec<bool> {
    let n = mesh.num_all_faces();
    let mut is_inside: Vec<Option<bool>> = vec![None; n];
    let mut open = Vec::new();
    let outer = mesh.outer_face();
    is_inside[outer.index()] = Some(false);
    for edge in mesh.convex_hull() {
        enter(mesh, is_bound, edge.rev().fix(), false, &mut is_inside, &mut open);
        enter(mesh, is_bound, edge.fix(), false, &mut is_inside, &mut open);
    }
    while let Some(face) = open.pop() {
        let here = is_inside[face.index()].unwrap_or(false);
        for edge in mesh.face(face).adjacent_edges() {
            enter(mesh, is_bound, edge.rev().fix(), here, &mut is_inside, &mut open);
        }
    }
    is_inside.into_iter().map(|found| found.unwrap_or(false)).collect()
}

/// Marks the face of an edge that is entered from its other side.
fn enter(
    mesh: &Mesh,
    bounds: &HashMap<[usize; 2], bool>,
    edge: FixedDirectedEdgeHandle,
    from: bool,
    is_inside: &mut [Option<bool>],
    open: &mut Vec<FixedFaceHandle<InnerTag>>,
) {
    let edge = mesh.directed_edge(edge);
    let face = edge.face().index();
    if is_inside[face].is_none() {
        let key = pair([edge.from().fix(), edge.to().fix()]);
        let is_bound = edge.is_constraint_edge() && bounds.get(&key).copied().unwrap_or(false);
        is_inside[face] = Some(from ^ is_bound);
        open.extend(edge.face().as_inner().map(|face| face.fix()));
    }
}

/// The vertices of a side in the order of their numbers.
pub fn pair([a, b]: [FixedVertexHandle; 2]) -> [usize; 2] {
    let [a, b] = [a.index(), b.index()];
    [a.min(b), a.max(b)]
}
