//! What is told of the solids of a file.

use nalgebra::Point3;
use serde::Serialize;
use utoipa::ToSchema;

use super::FileBox;
use toolpathd_part::step::{Body, Face, Hole, LevelFaces, Model};

/// The solids and sheets of a file, with their faces.
#[derive(Serialize, ToSchema)]
pub struct ModelContents {
    /// The name of the schema that the file states.
    schema: String,
    /// The solids and sheets; each copy in an assembly is one.
    bodies: Vec<BodyReport>,
    /// The faces of all bodies. `faces` of a surface in a file is the number of a face in this list, counted
    /// from 0.
    faces: Vec<FaceReport>,
    /// Round holes: cylinders that are seen from inside, all the way round.
    holes: Vec<HoleReport>,
    /// Level faces, by their height.
    levels: Vec<LevelReport>,
    /// The area of all faces, in mm2.
    area_mm2: f64,
}

/// A solid or a sheet.
#[derive(Serialize, ToSchema)]
struct BodyReport {
    /// Its name in the file; it may be empty.
    name: String,
    /// The number of its entity.
    entity: u64,
    /// Whether it is closed, so that it has an inside.
    is_solid: bool,
    /// The number of its first face, counted from 0.
    first_face: usize,
    /// The number of its faces, which follow each other.
    n_faces: usize,
}

/// A face.
#[derive(Serialize, ToSchema)]
struct FaceReport {
    /// The kind of its surface: `plane`, `cylinder`, `cone`, `sphere`, `torus`, `extrusion`, `revolution` or
    /// `spline`.
    kind: &'static str,
    /// The number of its entity.
    entity: u64,
    /// The number of its body, counted from 0.
    body: usize,
    /// Its area within its edges, in mm2.
    area_mm2: f64,
    /// A box around it, in mm. The box of a spline is found by a search, and is not proved.
    bounds: FileBox,
    /// The number of its closed chains of edges.
    n_loops: usize,
    /// Whether it is the whole of its surface, so that a surface in a file may name it.
    is_untrimmed: bool,
}

/// A round hole.
#[derive(Serialize, ToSchema)]
struct HoleReport {
    /// The number of its body, counted from 0.
    body: usize,
    /// The numbers of its faces, counted from 0.
    faces: Vec<usize>,
    /// The middle of its open end, in mm; of a hole that goes through, of one of the two.
    start: [f64; 3],
    /// The direction from there into the hole: plain numbers, of unit length.
    axis: [f64; 3],
    /// Its diameter, in mm.
    diameter_mm: f64,
    /// The length of its cylinder, in mm.
    depth_mm: f64,
    /// Whether both ends are open.
    is_through: bool,
}

/// Level faces of one height.
#[derive(Serialize, ToSchema)]
struct LevelReport {
    /// Their height, in mm.
    z_mm: f64,
    /// Whether the side without material is above.
    is_up: bool,
    /// The numbers of the faces, counted from 0.
    faces: Vec<usize>,
    /// Their area, in mm2.
    area_mm2: f64,
}

impl ModelContents {
    /// What a model holds, with `mm` millimetres in each of its units of length.
    pub fn new(model: &Model, mm: f64) -> Self {
        Self {
            schema: model.schema.clone(),
            bodies: model.bodies.iter().map(BodyReport::from).collect(),
            faces: model.faces.iter().map(|face| FaceReport::new(face, mm)).collect(),
            holes: model.holes.iter().map(|hole| HoleReport::new(hole, mm)).collect(),
            levels: model.levels.iter().map(|level| LevelReport::new(level, mm)).collect(),
            area_mm2: model.faces.iter().map(|face| face.area_mm2).sum::<f64>() * mm * mm,
        }
    }
}

impl From<&Body> for BodyReport {
    fn from(Body { entity, name, is_solid, faces }: &Body) -> Self {
        let (first_face, n_faces) = (faces.start, faces.len());
        Self { name: name.clone(), entity: *entity, is_solid: *is_solid, first_face, n_faces }
    }
}

impl FaceReport {
    fn new(face: &Face, mm: f64) -> Self {
        let [min, max] = face.bounds_mm.map(|corner| coordinates(&corner, mm));
        Self {
            kind: face.surface.kind(),
            entity: face.entity,
            body: face.body,
            area_mm2: face.area_mm2 * mm * mm,
            bounds: FileBox { min, max },
            n_loops: face.loops.len(),
            is_untrimmed: face.is_untrimmed,
        }
    }
}

impl HoleReport {
    fn new(hole: &Hole, mm: f64) -> Self {
        Self {
            body: hole.body,
            faces: hole.faces.clone(),
            start: coordinates(&hole.start, mm),
            // No minus stands before a zero.
            axis: hole.axis.map(|x| x + 0.0).into(),
            diameter_mm: hole.diameter_mm * mm,
            depth_mm: hole.depth_mm * mm,
            is_through: hole.is_through,
        }
    }
}

impl LevelReport {
    fn new(level: &LevelFaces, mm: f64) -> Self {
        Self {
            z_mm: level.height_mm * mm,
            is_up: level.is_up,
            faces: level.faces.clone(),
            area_mm2: level.area_mm2 * mm * mm,
        }
    }
}

fn coordinates(point: &Point3<f64>, mm: f64) -> [f64; 3] {
    (point * mm).into()
}
