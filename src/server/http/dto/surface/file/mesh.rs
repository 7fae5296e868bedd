//! Triangles of a file as a surface.

use std::sync::Arc;

use nalgebra::Point3;

use crate::http::decode::files::FileReading;
use crate::http::dto::file::Reference;
use crate::http::error::FieldCode;
use crate::http::messages::WarningCode;
use toolpathd_core::geometry::surface::triangle_mesh::{MeshError, TriangleMesh};
use toolpathd_part::mesh::{self, MeshFile, MeshFormat};
use toolpathd_part::step::Model;
use toolpathd_part::step::tessellation::{self, FaceTriangles, Untessellated};

/// Distance from its plane, mm, up to which a corner of a face counts as in the plane.
const FLAT_MM: f64 = 1e-6;

/// The mesh of a file of triangles; `None` with a violation where there is none.
pub fn of_file(
    file: &Reference,
    format: MeshFormat,
    bytes: &[u8],
    reading: &mut FileReading,
) -> Option<Arc<TriangleMesh>> {
    let read = mesh::read(format, bytes, reading.limits.mesh_triangles, reading.budget);
    let MeshFile { unit, vertices, mut triangles, slivers, left_out, off_plane_max, .. } =
        file.read(read, reading)?;
    let mm = file.mm(unit, reading)?;
    file.tell_left_out(&left_out, reading);
    if off_plane_max * mm > FLAT_MM {
        let detail = format!(
            "faces of `{}` with more than three corners are not flat, by up to {:.6} mm: other programs may cut them into other triangles",
            file.name,
            off_plane_max * mm
        );
        reading.warn(file.at, WarningCode::SurfaceOfTriangles, detail);
    }
    // Slivers have no area, but they join the triangles around them.
    triangles.extend(slivers);
    of_triangles(file, vertices, triangles, mm, 0.0, reading)
}

/// Triangles within `within_mm` of faces of a model, with `mm` millimetres in each of its units of length.
pub fn of_faces(
    file: &Reference,
    (model, faces): (&Model, &[usize]),
    mm: f64,
    within_mm: f64,
    reading: &mut FileReading,
) -> Option<Arc<TriangleMesh>> {
    let most = reading.limits.mesh_triangles;
    match tessellation::triangles(model, faces, within_mm / mm, most, reading.budget) {
        Ok(FaceTriangles { vertices, triangles, chord_mm, .. }) => {
            of_triangles(file, vertices, triangles, mm, chord_mm * mm, reading)
        }
        Err(Untessellated::Stopped(stopped)) => {
            reading.stop(stopped);
            None
        }
        Err(fault @ Untessellated::TooMany { .. }) => {
            let detail = format!("{fault}: send a larger `triangles_within_mm` or fewer `faces`");
            file.blame(FieldCode::LimitExceeded, &detail, reading);
            None
        }
        Err(fault) => {
            file.blame(FieldCode::Unsupported, &fault.to_string(), reading);
            None
        }
    }
}

/// The mesh of triangles whose corners are in a unit of `mm` mm. They stand for a surface that is within
/// `deviation_mm` of them.
pub fn of_triangles(
    file: &Reference,
    vertices: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    mm: f64,
    deviation_mm: f64,
    reading: &mut FileReading,
) -> Option<Arc<TriangleMesh>> {
    let points = vertices.into_iter().map(|point| Point3::from(point.map(|x| x * mm))).collect();
    match TriangleMesh::new(points, triangles, deviation_mm, reading.budget) {
        Ok(mesh) => {
            reading.warn(file.at, WarningCode::SurfaceOfTriangles, told(file.name, &mesh));
            Some(Arc::new(mesh))
        }
        Err(MeshError::Stopped(stopped)) => {
            reading.stop(stopped);
            None
        }
        Err(fault) => {
            file.blame(FieldCode::UnreadableFile, &fault.to_string(), reading);
            None
        }
    }
}

/// What the figures of an answer are about.
fn told(name: &str, mesh: &TriangleMesh) -> String {
    let n = mesh.triangles().len();
    let closed =
        if mesh.is_closed() { "a closed mesh" } else { "an open mesh, all of which counts as facing up" };
    match mesh.deviation_mm() {
        0.0 => format!(
            "`{name}` is {closed} of {n} triangles: all figures are about these triangles, and what is left on upright walls and undersides is not counted"
        ),
        by => format!(
            "the faces of `{name}` are taken as {n} triangles ({closed}) within {by:.6} mm of them: all figures are about these triangles, and what is left on upright walls and undersides is not counted"
        ),
    }
}
