mod damage;
mod figures;
mod formats;
mod obj;
mod outline;
mod ply;
mod polygon;
mod shading;
mod solids;
mod stl;
mod three_mf;
mod writing;

use toolpathd_core::budget::Budget;

use super::edges::Edges;
use super::figures::Figures;
use super::*;

const MOST: usize = 100_000;

fn read_whole(format: MeshFormat, bytes: &[u8]) -> MeshFile {
    read(format, bytes, MOST, &Budget::unlimited()).unwrap_or_else(|fault| panic!("{fault}"))
}

fn fault(format: MeshFormat, bytes: &[u8]) -> String {
    match read(format, bytes, MOST, &Budget::unlimited()) {
        Ok(mesh) => panic!("{} triangles were read", mesh.triangles.len()),
        Err(fault) => fault.to_string(),
    }
}

fn figures_of(mesh: &MeshFile) -> Figures {
    let edges = Edges::of(mesh, &Budget::unlimited()).unwrap();
    Figures::of(mesh, &edges, &Budget::unlimited()).unwrap()
}

/// What was left out, with its count and place.
fn left_out(mesh: &MeshFile) -> Vec<(&str, usize, String)> {
    mesh.left_out.iter().map(|own| (own.kind.as_str(), own.count, own.first.to_string())).collect()
}
