//! The cells of the surface as areas, from the farthest to the nearest.

use std::fmt::Write;

use nalgebra::{Point3, Vector3};

use super::isometric::Isometric;
use crate::number::fixed;
use crate::relief::{Bands, Corner};
use toolpathd_core::geometry::mesh::Mesh;

/// The rule of the areas. Each has a border of its own colour, so that no slits show between neighbours.
pub const STYLE: &str = ".plot .face{fill:currentColor;stroke:currentColor;stroke-width:.12}";

/// Direction towards the light, of any length: from the upper left of the picture.
const LIGHT: [f64; 3] = [-0.75, 0.15, 1.0];

/// The direction towards the reader.
const READER: [f64; 3] = [-1.0, -1.0, 1.0];

/// The light of a place that is turned away from the light, as a part of full light.
const LEAST_LIGHT: f64 = 0.62;

/// The areas of `mesh`.
pub fn draw(mesh: &Mesh, isometric: &Isometric) -> String {
    let bands = Bands::of(mesh.points());
    let points = mesh.points();
    let triangles: Vec<[usize; 3]> = mesh.triangles().collect();
    // The two triangles of a cell share their first and third corner.
    let cells = triangles.chunks_exact(2).map(|pair| [pair[0][0], pair[0][1], pair[0][2], pair[1][2]]);
    let mut cells: Vec<(f64, [Point3<f64>; 4])> = cells
        .map(|cell| {
            let corners = cell.map(|k| points[k]);
            (corners.iter().map(|p| isometric.nearness(p)).sum(), corners)
        })
        .collect();
    cells.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut out = String::new();
    for (_, corners) in &cells {
        let light = light(corners);
        let piece = corners.map(|p| Corner { at: isometric.project(&p), height: bands.snapped(p.z), light });
        bands.cut(&piece, |band, part| {
            if part.len() > 2 {
                out += &face(bands.rgb(band), light, part);
            }
        });
    }
    out
}

/// The rules that the legend of heights needs.
pub fn legend_style(mesh: &Mesh) -> String {
    Bands::of(mesh.points()).style()
}

/// The light on a cell, as a part of full light.
fn light([a, b, c, d]: &[Point3<f64>; 4]) -> f64 {
    let normal = (c - a).cross(&(d - b));
    let normal = if normal.dot(&Vector3::from(READER)) < 0.0 { -normal } else { normal };
    let facing = normal.normalize().dot(&Vector3::from(LIGHT).normalize());
    if facing.is_finite() { LEAST_LIGHT + (1.0 - LEAST_LIGHT) * facing.max(0.0) } else { 1.0 }
}

fn face(color: [u8; 3], light: f64, part: &[Corner]) -> String {
    let [r, g, b] = color.map(|share| (f64::from(share) * light).round() as u8);
    let mut data = String::new();
    for (k, corner) in part.iter().enumerate() {
        let command = if k == 0 { 'M' } else { 'L' };
        // Writing to a string cannot fail.
        let _ = write!(data, "{command}{} {}", fixed(corner.at.x), fixed(corner.at.y));
    }
    format!("<path class=\"face\" color=\"#{r:02x}{g:02x}{b:02x}\" d=\"{data}Z\"/>\n")
}
