//! What a picture shows of a surface.

use toolpathd_core::geometry::surface::source::Source;
use toolpathd_core::geometry::surface::triangle_mesh::TopView;
use toolpathd_core::machining::wire_model::{self, Wire};
use toolpathd_plot::Drawing;

/// The most sharp edges of a mesh in a picture.
const MOST_LINES: usize = 20_000;

/// A few curves on the surface; the sharp edges of a mesh.
pub fn sketched(surface: &Source) -> Vec<Wire> {
    match surface {
        Source::Mesh(mesh) => mesh.sharp_lines(MOST_LINES).into_iter().map(|line| line.to_vec()).collect(),
        source => source.surface().map(|surface| wire_model::sketch(&surface)).unwrap_or_default(),
    }
}

/// The surface as a shaded relief, with a few curves on it.
pub fn relief(surface: &Source) -> Drawing {
    match surface {
        Source::Mesh(mesh) => Drawing::of_relief(&TopView(mesh), sketched(surface)),
        source => {
            let draw = |made| Drawing::of_relief(&made, wire_model::sketch(&made));
            source.surface().map(draw).unwrap_or_default()
        }
    }
}
