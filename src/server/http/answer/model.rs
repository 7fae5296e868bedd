//! An answer in three dimensions: a binary glTF file with part, stock, cutter and path.

use nalgebra::Vector3;

use super::{Cut, Outcome, Product, sheet};
use crate::http::dto::setup::Setup;
use crate::http::error::ApiError;
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::mesh::Mesh;
use toolpathd_plot::gltf::{CHORD_MM, Content, Stock, Triangles, glb};
use toolpathd_plot::stl::stl;
use toolpathd_post::PassNote;

/// The bodies of an answer beside cutter and path.
#[derive(Default)]
pub struct Solids {
    pub part: Option<Triangles>,
    pub stock: Option<Stock>,
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
    let Solids { part, stock } = solids(outcome, budget)?;
    let names: Vec<(usize, String)> = outcome.product.pass_notes().iter().map(name).collect();
    let tool = cut.and_then(|Cut { setup: Setup { tool, body, .. }, .. }| Some((tool.as_ref()?, body)));
    Ok(glb(&Content {
        title: &sheet::title(outcome),
        toolpath: cut.map(|cut| &cut.toolpath),
        rapid_feed: outcome.product.rapid_feed(),
        lines,
        names: &names,
        part: part.as_ref(),
        stock: stock.as_ref(),
        tool,
        diagrams: outcome.product.diagrams(),
        chord_mm: CHORD_MM,
    }))
}

/// The part of an outcome as a binary STL file.
///
/// # Errors
/// The budget's stop.
pub fn triangles_file<R, P: Product>(outcome: &Outcome<R, P>, budget: &Budget) -> Result<Vec<u8>, ApiError> {
    Ok(stl(&solids(outcome, budget)?.part.unwrap_or_default()))
}

/// The bodies of an outcome. The surface of its drawing is a part.
fn solids<R, P: Product>(outcome: &Outcome<R, P>, budget: &Budget) -> Result<Solids, ApiError> {
    let Solids { part, stock } = outcome.product.solids(budget)?;
    let part = part.or_else(|| (outcome.drawing)().relief.as_ref().map(triangles));
    Ok(Solids { part, stock })
}

/// What is told of the passes from one on.
fn name(note: &PassNote) -> (usize, String) {
    let PassNote { pass, label, text, z_mm: _ } = note;
    (*pass, format!("{label} {text}").to_lowercase())
}

fn triangles(mesh: &Mesh) -> Triangles {
    let index = |k: usize| u32::try_from(k).unwrap_or(u32::MAX);
    let told = |normal: Vector3<f64>| if normal == Vector3::zeros() { Vector3::z() } else { normal };
    Triangles {
        points: mesh.points().to_vec(),
        normals: mesh.normals().into_iter().map(told).collect(),
        triangles: mesh.triangles().map(|corners| corners.map(index)).collect(),
    }
}
