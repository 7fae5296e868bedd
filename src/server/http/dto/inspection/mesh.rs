//! What is told of a mesh of triangles.

use serde::Serialize;
use utoipa::ToSchema;

use toolpathd_part::mesh::MeshFile;
use toolpathd_part::mesh::figures::Figures;

/// A mesh of triangles.
#[derive(Serialize, ToSchema)]
pub struct MeshReport {
    /// The number of triangles. Triangles without area do not count.
    n_triangles: usize,
    /// The number of different corners of all triangles.
    n_vertices: usize,
    /// The number of triangles that were left out because two of their corners are equal, or because they
    /// have no area.
    n_degenerate: usize,
    /// The number of faces with more than three corners, which were cut into triangles.
    n_polygons: usize,
    /// The largest distance of a corner of such a face from its plane, in mm. The triangles of a face that is
    /// not flat depend on how it was cut. 0 where there is no such face.
    off_plane_max_mm: f64,
    /// The number of bodies: triangles of one body are joined through edges.
    n_bodies: usize,
    /// The area of all triangles, in mm2.
    area_mm2: f64,
    /// Whether each edge has two triangles, which agree which side is outside: the mesh encloses a volume.
    is_closed: bool,
    /// The number of edges of one triangle alone: the borders of holes.
    n_open_edges: usize,
    /// The number of edges of more than two triangles.
    n_crowded_edges: usize,
    /// The number of edges of two triangles that disagree which side is outside.
    n_turned_edges: usize,
    /// The enclosed volume, in mm3; the volume of bodies whose normals point inward is taken off, and the sum
    /// may be negative. Absent where the mesh is not closed.
    #[serde(skip_serializing_if = "Option::is_none")]
    volume_mm3: Option<f64>,
    /// The number of bodies whose normals point inward: voids, or solids that are turned inside out. Absent
    /// where the mesh is not closed.
    #[serde(skip_serializing_if = "Option::is_none")]
    n_inward_bodies: Option<usize>,
    /// Whether the normals point out of the material. A body whose normals point inward counts as a void
    /// where it lies within the box of a larger body whose normals point outward. Absent where the mesh is
    /// not closed.
    #[serde(skip_serializing_if = "Option::is_none")]
    is_outward: Option<bool>,
}

impl MeshReport {
    /// The figures of a mesh, with `mm` millimetres in each of its units of length.
    pub fn new(mesh: &MeshFile, figures: &Figures, mm: f64) -> Self {
        let Figures { area, bounds: _, n_bodies, n_open_edges, n_crowded_edges, n_turned_edges, solid } =
            figures;
        Self {
            n_triangles: mesh.triangles.len(),
            n_vertices: mesh.vertices.len(),
            n_degenerate: mesh.n_degenerate,
            n_polygons: mesh.n_polygons,
            off_plane_max_mm: mesh.off_plane_max * mm,
            n_bodies: *n_bodies,
            area_mm2: area * mm * mm,
            is_closed: solid.is_some(),
            n_open_edges: *n_open_edges,
            n_crowded_edges: *n_crowded_edges,
            n_turned_edges: *n_turned_edges,
            volume_mm3: solid.map(|solid| solid.volume * mm.powi(3)),
            n_inward_bodies: solid.map(|solid| solid.n_inward_bodies),
            is_outward: solid.map(|solid| solid.is_outward),
        }
    }
}
