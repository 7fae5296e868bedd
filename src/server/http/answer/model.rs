//! An answer in three dimensions: a binary glTF file with part, stock, cutter and path.

use nalgebra::Vector3;

use super::{Cut, Outcome, Product, sheet};
use crate::http::dto::setup::Setup;
use crate::http::error::ApiError;
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::facets::Facets;
use toolpathd_core::geometry::mesh::Mesh;
use toolpathd_core::geometry::surface::any_surface::AnySurface;
use toolpathd_plot::gltf::{CHORD_MM, Content, Stock, Triangles, glb};
use toolpathd_plot::stl::stl;
use toolpathd_post::PassNote;

/// How far a surface and the walls of a pocket may be from the triangles of the part, mm, where the cells
/// suffice.
pub const PART_CHORD_MM: f64 = 0.01;

/// The most cells of a surface in each direction.
const MOST_CELLS: usize = 300;

/// The bodies of an answer beside cutter and path.
#[derive(Default)]
pub struct Solids {
    pub part: Option<Triangles>,
    /// How far the part may be from its triangles, mm; none where that is not known.
    pub part_chord_mm: Option<f64>,
    pub stock: Option<Stock>,
}

impl Solids {
    /// A surface as a part.
    pub fn of_surface(surface: &AnySurface) -> Self {
        let Facets { mesh, chord_mm } = surface.facets(PART_CHORD_MM, MOST_CELLS);
        Self { part: Some(triangles(&mesh)), part_chord_mm: chord_mm, stock: None }
    }
}

/// The file of an outcome. `lines` has for each move the line of the program that ends it, and nothing
/// without a program.
///
/// # Errors
/// The budget's stop.
pub fn file<R, P: Product>(
    outcome: &Outcome<R, P>,
    lines: &[u32],
    budget: &Budget,
) -> Result<Vec<u8>, ApiError> {
    let cut = outcome.product.cut();
    let Solids { part, part_chord_mm, stock } = outcome.product.solids(budget)?;
    let names: Vec<(usize, String)> = outcome.product.pass_notes().iter().map(name).collect();
    let tool = cut.and_then(|Cut { setup: Setup { tool, body, .. }, .. }| Some((tool.as_ref()?, body)));
    Ok(glb(&Content {
        title: &sheet::title(outcome),
        toolpath: cut.map(|cut| &cut.toolpath),
        rapid_feed: outcome.product.rapid_feed(),
        lines,
        deviations_mm: outcome.product.deviations_mm(),
        names: &names,
        part: part.as_ref(),
        part_chord_mm,
        stock: stock.as_ref(),
        tool,
        diagrams: outcome.product.diagrams(),
        diagram_ends_s: outcome.product.diagram_ends_s(),
        chord_mm: CHORD_MM,
    }))
}

/// The part of an outcome as a binary STL file.
///
/// # Errors
/// The budget's stop.
pub fn triangles_file<R, P: Product>(outcome: &Outcome<R, P>, budget: &Budget) -> Result<Vec<u8>, ApiError> {
    Ok(stl(&outcome.product.solids(budget)?.part.unwrap_or_default()))
}

/// What is told of the passes from one on.
fn name(note: &PassNote) -> (usize, String) {
    let PassNote { pass, label, text, z_mm: _ } = note;
    (*pass, format!("{label} {text}").to_lowercase())
}

fn triangles(mesh: &Mesh) -> Triangles {
    let index = |k: usize| u32::try_from(k).unwrap_or(u32::MAX);
    let normals = mesh.normals();
    let told = |normal: Vector3<f64>| if normal == Vector3::zeros() { Vector3::z() } else { normal };
    Triangles {
        points: mesh.points().to_vec(),
        triangles: mesh
            .triangles()
            .map(|corners| turned_outward(mesh, corners, &normals).map(index))
            .collect(),
        normals: normals.into_iter().map(told).collect(),
    }
}

/// The corners of a triangle, counterclockwise seen from the side of its normals.
fn turned_outward(mesh: &Mesh, [a, b, c]: [usize; 3], normals: &[Vector3<f64>]) -> [usize; 3] {
    let [p, q, r] = [a, b, c].map(|k| mesh.points()[k]);
    let outward = normals[a] + normals[b] + normals[c];
    if (q - p).cross(&(r - p)).dot(&outward) < 0.0 { [a, c, b] } else { [a, b, c] }
}
