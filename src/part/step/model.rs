//! What a STEP file holds: bodies with faces, as surfaces with their trims, and the features found in them.

use std::ops::Range;

use nalgebra::{Point3, Vector3};
use toolpathd_core::geometry::surface::nurbs::Nurbs;

use super::curve::Curve;
use super::surface::Surface;
use crate::left_out::LeftOut;
use crate::unit::Unit;

/// The shapes of a STEP file, placed as in the whole assembly. Lengths are mm.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    /// The name of the schema, such as `AUTOMOTIVE_DESIGN`.
    pub schema: String,
    /// The unit of length of the first representation with shapes. `None` if the file states none, or one
    /// that has no name here.
    pub unit: Option<Unit>,
    /// mm in this unit; 1 if the file states none.
    pub mm_per_unit: f64,
    /// Whether the file states a unit of length.
    pub is_unit_stated: bool,
    pub bodies: Vec<Body>,
    /// The faces of all bodies, in the order of the bodies.
    pub faces: Vec<Face>,
    pub holes: Vec<Hole>,
    pub levels: Vec<LevelFaces>,
    pub left_out: Vec<LeftOut>,
    /// The corners of the box of all faces, mm.
    pub bounds_mm: Option<[Point3<f64>; 2]>,
}

/// A solid or a sheet. A body of an assembly occurs once for each copy.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// The number of the instance.
    pub entity: u64,
    pub name: String,
    /// Whether its shells are closed, so that it has an inside.
    pub is_solid: bool,
    /// The places of its faces in [`Model::faces`].
    pub faces: Range<usize>,
}

/// A trimmed surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Face {
    /// The number of the instance.
    pub entity: u64,
    pub name: String,
    /// The place of its body in [`Model::bodies`].
    pub body: usize,
    pub surface: Surface,
    /// Whether the side without material is where the surface's normal points away from.
    pub is_reversed: bool,
    /// The bounds as the file has them. A whole sphere or torus may have none.
    pub loops: Vec<Loop>,
    /// The bounds in the parameters of the surface, as polygons within 1e-3 of the size of the face. The
    /// first goes round the face counterclockwise, the others are holes. Seams and poles are part of the
    /// polygons.
    pub trim: Vec<Vec<[f64; 2]>>,
    /// The ranges of u and v that the trim covers.
    pub domain: [[f64; 2]; 2],
    /// The surface over the domain. Its points are points of the surface; its parameters are u and v at the
    /// knots, and between the knots also for planes and splines. A plane with four straight sides is the
    /// ruled patch of its corners.
    pub nurbs: Nurbs,
    /// Whether the trim is the whole of [`Face::nurbs`], within 1e-6 mm.
    pub is_untrimmed: bool,
    /// The area within the trim, mm2.
    pub area_mm2: f64,
    /// The corners of the box of the face, mm.
    pub bounds_mm: [Point3<f64>; 2],
    /// The largest distance of an edge from the surface, mm.
    pub edge_deviation_mm: f64,
}

/// A closed chain of edges.
#[derive(Debug, Clone, PartialEq)]
pub struct Loop {
    pub edges: Vec<Edge>,
}

/// A part of a curve, from the parameter `from` to the parameter `to`, which may be the smaller.
#[derive(Debug, Clone, PartialEq)]
pub struct Edge {
    /// The number of the instance; 0 for an edge of a polygon. Faces that meet share the edge.
    pub entity: u64,
    pub curve: Curve,
    pub from: f64,
    pub to: f64,
}

/// A round hole: cylindrical faces with one axis and one diameter, seen from inside, all the way round.
#[derive(Debug, Clone, PartialEq)]
pub struct Hole {
    pub body: usize,
    /// The places of its faces in [`Model::faces`].
    pub faces: Vec<usize>,
    /// The middle of the first end, mm. For a blind hole it is the open end.
    pub start: Point3<f64>,
    /// From the first end into the hole; unit length.
    pub axis: Vector3<f64>,
    pub diameter_mm: f64,
    /// The length of the cylinder, mm.
    pub depth_mm: f64,
    /// Whether both ends are open.
    pub is_through: bool,
}

/// Plane faces of one height whose normal is along z.
#[derive(Debug, Clone, PartialEq)]
pub struct LevelFaces {
    pub height_mm: f64,
    /// Whether the side without material is above.
    pub is_up: bool,
    /// The places of its faces in [`Model::faces`].
    pub faces: Vec<usize>,
    /// The area of its faces, mm2.
    pub area_mm2: f64,
}

impl Face {
    /// The unit normal on the side without material at (u, v). `None` at a pole.
    pub fn normal(&self, at: [f64; 2]) -> Option<Vector3<f64>> {
        let (_, du, dv) = self.surface.jet(at);
        let normal = du.cross(&dv).try_normalize(f64::MIN_POSITIVE)?;
        Some(if self.is_reversed { -normal } else { normal })
    }
}

impl Edge {
    pub fn start(&self) -> Point3<f64> {
        self.curve.point(self.from)
    }

    pub fn end(&self) -> Point3<f64> {
        self.curve.point(self.to)
    }
}
