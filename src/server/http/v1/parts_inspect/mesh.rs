//! What is told and shown of a mesh of triangles.

use nalgebra::{Point3, Vector3};

use super::{Found, Shape, unreadable};
use crate::http::answer::model::Solids;
use crate::http::dto::inspection::{FileBox, Inspection, MeshReport};
use crate::http::error::ApiError;
use toolpathd_core::budget::Budget;
use toolpathd_part::fault::Unreadable;
use toolpathd_part::mesh::edges::Edges;
use toolpathd_part::mesh::figures::Figures;
use toolpathd_part::mesh::shading::Shaded;
use toolpathd_part::mesh::{self, MeshFile, MeshFormat, outline};
use toolpathd_part::unit::Unit;
use toolpathd_plot::Drawing;
use toolpathd_plot::gltf::Triangles;

/// Most edges in a picture. More of them would be a black area, and a large file.
const MOST_LINES: usize = 20_000;

/// The direction from the part to the eye of the picture: x leads to the right and away, y to the left and
/// away.
const VIEW: [f64; 3] = [-1.0, -1.0, 1.0];

/// Reads a mesh. All that is shown is in mm where the unit is known.
pub fn found(job: &Inspection, format: MeshFormat, budget: &Budget) -> Result<Found, ApiError> {
    let fault = |fault| unreadable(job, fault);
    let mesh = mesh::read(format, &job.bytes, job.limits.mesh_triangles, budget).map_err(fault)?;
    let edges = Edges::of(&mesh, budget).map_err(fault)?;
    let figures = Figures::of(&mesh, &edges, budget).map_err(fault)?;
    let lines = outline::lines(&mesh, &edges, VIEW, MOST_LINES, budget).map_err(fault)?;
    let mm = job.units.map(Unit::from).or(mesh.unit).map_or(1.0, Unit::mm);
    let at = |vertex: u32| Point3::from(mesh.vertices[vertex as usize]) * mm;
    let picture =
        Drawing { solids: lines.iter().map(|ends| ends.map(at).to_vec()).collect(), ..Drawing::default() };
    let [min, max] = figures.bounds.map(|corner| corner.map(|x| x * mm));
    Ok(Found {
        format: format.into(),
        unit: mesh.unit,
        has_unit: mesh.unit.is_some(),
        model: None,
        bounds: Some(FileBox { min, max }),
        drawing: None,
        mesh: Some(MeshReport::new(&mesh, &figures, mm)),
        points: None,
        left_out: mesh.left_out.clone(),
        shape: Shape::Mesh { mesh, mm },
        picture,
    })
}

/// The triangles of a mesh as a part.
pub fn solids(mesh: &MeshFile, mm: f64, budget: &Budget) -> Result<Solids, ApiError> {
    let shaded = match Shaded::of(mesh, budget) {
        Ok(shaded) => shaded,
        Err(Unreadable::Stopped(stopped)) => return Err(stopped.into()),
        // A mesh that was read breaks no format.
        Err(Unreadable::Broken { .. }) => return Ok(Solids::default()),
    };
    let part = Triangles {
        points: shaded.points.into_iter().map(|point| Point3::from(point) * mm).collect(),
        normals: shaded.normals.into_iter().map(Vector3::from).collect(),
        triangles: shaded.triangles,
    };
    Ok(Solids { part: Some(part), part_chord_mm: None, stock: None })
}
