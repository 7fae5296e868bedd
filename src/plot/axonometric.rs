//! Draws a scene as one axonometric view: isometric, from the front left and above. Hidden strokes are left
//! out.
//!
//! # Method
//! 1. `isometric` chooses the largest standard scale at which everything fits. Lengths along x, y and z are
//!    drawn to this scale.
//! 2. `faces` draws the cells of the surface from the farthest to the nearest, in the colours of their
//!    heights, with shade.
//! 3. `depth` keeps how near the surface is at each spot of paper. Wires and moves are drawn where nothing of
//!    the surface is in front of them.
//!
//! # Guarantees
//! * The same content gives the same bytes. A sheet has about 3 MB at most.
//! * Near the outline of the surface, a hidden stroke may show for half a millimetre of paper.
//!
//! # Reference
//! Y. H. Koo, D. J. Lee, S. Namgung, M. S. Kang, "A Study on the Construction of CAD/CAM System for Machining
//! of Sculptured Surface of Die", 1989, figures 3-4 to 3-7 and 4-2.

mod depth;
mod faces;
mod isometric;

use nalgebra::Point3;

use super::class::{self, Class};
use super::layers::{self, Layer, Pens};
use super::layout::{Layout, Projection};
use super::pen::{CHORD_MM, Pen};
use super::{Drawing, MAX_PATH_BYTES, RASTERS_MM, Scene, column, marks, opening};
use depth::Depth;
use isometric::Isometric;
use toolpathd_core::geometry::flatten::flatten;
use toolpathd_core::geometry::mesh::Mesh;

/// Most chords of one move. A full turn as wide as the sheet takes some 400.
const MAX_CHORDS: usize = 10_000;

/// Draws `scene` as an SVG document.
pub fn svg(scene: &Scene) -> String {
    let mut out = opening(scene.title, "axonometric view", faces::STYLE);
    match Layout::of(scene) {
        Ok(base) => {
            let isometric = Isometric::of(&base.bounds);
            let (scale, step) = (isometric.scale, isometric.step);
            let layout = Layout { scale, step, projection: Projection::Isometric, ..base };
            let mesh = scene.drawing.relief.as_ref();
            let depth = mesh.map(|mesh| Depth::of(mesh, &isometric));
            let (paths, raster_mm) = draw(scene, &isometric, depth.as_ref());
            out += "<g class=\"view\" id=\"axonometric\">\n";
            out += &isometric.frame();
            if let Some(mesh) = mesh {
                out += &format!("<g class=\"relief\">\n{}</g>\n", faces::draw(mesh, &isometric));
            }
            out += &layers::strokes("isometric", &paths);
            out += &ends(scene, &isometric);
            out += "</g>\n";
            if let Some(mesh) = mesh {
                out += &format!("<style>{}</style>\n", faces::legend_style(mesh));
            }
            out += &column::draw(scene, &layout, &layers::used(paths.iter()), raster_mm);
        }
        Err(reason) => out += &column::refusal(scene, &reason.to_string()),
    }
    out + "</svg>\n"
}

/// The marks of zero, start and end of a toolpath.
fn ends(scene: &Scene, isometric: &Isometric) -> String {
    let Some(toolpath) = scene.toolpath else { return String::new() };
    let last = toolpath.moves().filter_map(class::of).last();
    let end = last.map_or(toolpath.start(), |(_, curve)| curve.end());
    let zero = isometric.project(&Point3::origin());
    let datum = if isometric.shows(&Point3::origin()) { marks::datum(zero) } else { String::new() };
    datum + &marks::start(isometric.project(&toolpath.start())) + &marks::cross(isometric.project(&end))
}

/// The paths, and the cell size of the raster, mm, if strokes were left out.
fn draw(scene: &Scene, isometric: &Isometric, depth: Option<&Depth>) -> (Vec<Layer>, Option<f64>) {
    let [finer @ .., coarsest] = RASTERS_MM;
    for raster_mm in [None].into_iter().chain(finer.map(Some)) {
        if let Some(paths) = trace(scene, isometric, depth, raster_mm, MAX_PATH_BYTES) {
            return (paths, raster_mm);
        }
    }
    let paths = trace(scene, isometric, depth, Some(coarsest), usize::MAX);
    (paths.unwrap_or_default(), Some(coarsest))
}

/// The paths; `None` if they grow beyond `max_bytes`.
fn trace(
    scene: &Scene,
    isometric: &Isometric,
    depth: Option<&Depth>,
    raster_mm: Option<f64>,
    max_bytes: usize,
) -> Option<Vec<Layer>> {
    let mut pens = Pens::new(raster_mm);
    let is_within = |pens: &Pens| pens.bytes() <= max_bytes;
    let Drawing { relief, surface, walls, curve, uncut, band, joints, poses, tool_axes, solids, findings } =
        scene.drawing;
    let sides = relief.as_ref().map(sides).unwrap_or_default();
    let polylines = [
        (Class::Band, band),
        (Class::Solid, solids),
        (Class::Wire, &sides),
        (Class::Wall, walls),
        (Class::Wire, surface),
        (Class::ToolAxis, tool_axes),
        (Class::Curve, curve),
        (Class::Uncut, uncut),
    ];
    for (class, wires) in polylines {
        for wire in wires {
            polyline(wire, isometric, depth, pens.pen(class));
            if !is_within(&pens) {
                return None;
            }
        }
    }
    let levels = scene.toolpath.map(layers::levels).unwrap_or_default();
    for (pass, level) in scene.toolpath.iter().flat_map(|toolpath| toolpath.passes()).zip(levels) {
        pens.turn_to(level);
        for (class, curve) in pass.moves().iter().filter_map(class::of) {
            let chords = flatten(&curve, CHORD_MM / isometric.scale.value(), MAX_CHORDS);
            let points = chords.unwrap_or_else(|_| vec![curve.start(), curve.end()]);
            polyline(&points, isometric, depth, pens.pen(class));
            if !is_within(&pens) {
                return None;
            }
        }
    }
    pens.turn_to(None);
    for (class, dots) in [(Class::Joint, joints), (Class::Pose, poses), (Class::Finding, findings)] {
        for dot in dots {
            polyline(&[*dot, *dot], isometric, depth, pens.pen(class));
        }
    }
    is_within(&pens).then(|| pens.finish())
}

/// The four sides of a mesh.
fn sides(mesh: &Mesh) -> Vec<Vec<Point3<f64>>> {
    let points = mesh.points();
    // The first triangle leads from the first row to the second.
    let Some([_, columns, _]) = mesh.triangles().next() else { return Vec::new() };
    let rows = points.len() / columns;
    let along = |from: usize, step: usize, n: usize| (0..n).map(|k| points[from + k * step]).collect();
    vec![
        along(0, 1, columns),
        along((rows - 1) * columns, 1, columns),
        along(0, columns, rows),
        along(columns - 1, columns, rows),
    ]
}

/// Draws the visible parts of a polyline.
fn polyline(points: &[Point3<f64>], isometric: &Isometric, depth: Option<&Depth>, pen: &mut Pen) {
    for pair in points.windows(2) {
        let [from, to] = [pair[0], pair[1]];
        let Some(depth) = depth else {
            pen.line(isometric.project(&from), isometric.project(&to));
            continue;
        };
        let length = (isometric.project(&to) - isometric.project(&from)).norm();
        let parts = (length / depth::LOOK_MM).ceil().max(1.0);
        let at = |k: f64| if k == parts { to } else { from + (to - from) * (k / parts) };
        for k in 0..parts as usize {
            let k = k as f64;
            if depth.shows(&at(k + 0.5), isometric) {
                pen.line(isometric.project(&at(k)), isometric.project(&at(k + 1.0)));
            }
        }
    }
}

#[cfg(test)]
mod tests;
