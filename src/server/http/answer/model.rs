//! An answer in three dimensions: a binary glTF file with part, stock, cutter and path.

use nalgebra::Vector3;

use super::{Cut, Outcome, Product, sheet};
use crate::http::dto::setup::Setup;
use toolpathd_core::geometry::mesh::Mesh;
use toolpathd_plot::gltf::{CHORD_MM, Content, Triangles, glb};
use toolpathd_post::PassNote;

/// The file of an outcome. `lines` has for each move the line of the program that ends it, and nothing
/// without a program.
pub fn file<R, P: Product>(outcome: &Outcome<R, P>, lines: &[u32]) -> Vec<u8> {
    let cut = outcome.product.cut();
    let relief = (outcome.drawing)().relief;
    let part = relief.as_ref().map(part);
    let names: Vec<(usize, String)> = outcome.product.pass_notes().iter().map(name).collect();
    let tool = cut.and_then(|Cut { setup: Setup { tool, body, .. }, .. }| Some((tool.as_ref()?, body)));
    glb(&Content {
        title: &sheet::title(outcome),
        toolpath: cut.map(|cut| &cut.toolpath),
        rapid_feed: outcome.product.rapid_feed(),
        lines,
        names: &names,
        part: part.as_ref(),
        stock: None,
        tool,
        chord_mm: CHORD_MM,
    })
}

/// What is told of the passes from one on.
fn name(note: &PassNote) -> (usize, String) {
    let PassNote { pass, label, text, z_mm: _ } = note;
    (*pass, format!("{label} {text}").to_lowercase())
}

fn part(mesh: &Mesh) -> Triangles {
    let index = |k: usize| u32::try_from(k).unwrap_or(u32::MAX);
    let told = |normal: Vector3<f64>| if normal == Vector3::zeros() { Vector3::z() } else { normal };
    Triangles {
        points: mesh.points().to_vec(),
        normals: mesh.normals().into_iter().map(told).collect(),
        triangles: mesh.triangles().map(|corners| corners.map(index)).collect(),
    }
}
