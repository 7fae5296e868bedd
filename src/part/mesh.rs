//! Meshes of triangles: STL, OBJ, PLY and 3MF.
//!
//! # Method
//! 1. A reader of the format finds corners and faces, and refuses what breaks the format, with its place.
//! 2. Faces of more than three corners are cut into triangles (`polygon`).
//! 3. Points that are equal bit for bit become one vertex (`welding`), because STL repeats each corner in
//!    each of its triangles. The objects of a 3MF file keep vertices of their own.
//!
//! # Guarantees
//! * A triangle with two equal corners or without area is no triangle of the mesh; it is counted.
//! * Whatever else is left out is listed. A vertex that no triangle uses counts as left out.
//! * No count that a file states is believed: memory grows with the bytes of the file, and with the triangles
//!   that were read.
//!
//! # Cost
//! O(n) in the bytes of the file; a face of n corners that is not convex takes O(n²).

mod bytes;
pub mod edges;
pub mod figures;
mod obj;
pub mod outline;
mod ply;
mod polygon;
pub mod shading;
mod stl;
mod three_mf;
mod welding;
mod words;

use toolpathd_core::budget::Budget;

use super::fault::{Place, Unreadable};
use super::left_out::LeftOut;
use super::unit::Unit;
use welding::Welding;

/// The largest coordinate that counts as one, in any unit.
const LARGEST: f64 = 1e9;

/// Statements, triangles or vertices between two looks at the budget.
const STEPS_PER_CHECK: usize = 4096;

/// A format of files of triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeshFormat {
    /// As text or binary.
    Stl,
    /// Wavefront OBJ.
    Obj,
    /// As text or binary.
    Ply,
    /// The 3D Manufacturing Format.
    ThreeMf,
}

/// A mesh that was read, in the unit of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshFile {
    /// The unit of the file. STL, OBJ and PLY state none.
    pub unit: Option<Unit>,
    /// The points of the mesh; each is a corner of a triangle or of a sliver.
    pub vertices: Vec<[f64; 3]>,
    /// The corners of each triangle, counterclockwise as seen from outside, by the numbers of vertices.
    pub triangles: Vec<[u32; 3]>,
    /// Triangles with three corners on one line. They are no part of the surface, but they join the edges of
    /// the triangles around them, so that a closed mesh stays closed.
    pub slivers: Vec<[u32; 3]>,
    /// The number of triangles that were left out because two of their corners are equal, or because they
    /// have no area.
    pub n_degenerate: usize,
    /// The number of faces with more than three corners, which were cut into triangles.
    pub n_polygons: usize,
    /// The largest distance of a corner of such a face from the plane through the middle of its corners. The
    /// triangles of a face that is not flat depend on how it was cut.
    pub off_plane_max: f64,
    /// What was left out.
    pub left_out: Vec<LeftOut>,
}

impl MeshFile {
    /// The points at the corners of a triangle of the mesh.
    pub fn corners(&self, triangle: &[u32; 3]) -> [[f64; 3]; 3] {
        triangle.map(|corner| self.vertices[corner as usize])
    }
}

/// Reads a mesh of at most `most_triangles` triangles.
///
/// # Errors
/// The first place that breaks the format; a file without triangles, or with too many; the budget's stop.
pub fn read(
    format: MeshFormat,
    bytes: &[u8],
    most_triangles: usize,
    budget: &Budget,
) -> Result<MeshFile, Unreadable> {
    let mut welding = Welding::new(most_triangles);
    let unit = match format {
        MeshFormat::Stl => stl::read(bytes, &mut welding, budget).map(|()| None),
        MeshFormat::Obj => obj::read(bytes, &mut welding, budget).map(|()| None),
        MeshFormat::Ply => ply::read(bytes, &mut welding, budget).map(|()| None),
        MeshFormat::ThreeMf => three_mf::read(bytes, most_triangles, &mut welding, budget).map(Some),
    }?;
    let mesh = welding.mesh(unit);
    if mesh.triangles.is_empty() {
        return Err(Unreadable::at(Place::File, "there is no triangle in it"));
    }
    Ok(mesh)
}

/// Whether a file is STL by its contents alone.
pub fn is_stl(bytes: &[u8]) -> bool {
    stl::is_binary_by_length(bytes) || stl::is_text(bytes)
}

/// Whether a number can be a coordinate.
fn is_coordinate(value: f64) -> bool {
    value.abs() <= LARGEST
}

#[cfg(test)]
mod tests;
