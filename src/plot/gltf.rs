//! Writes a toolpath with its part, its stock and its cutter as a binary glTF file (glTF 2.0), which
//! programs for three dimensions open unchanged.
//!
//! # Method
//! 1. Passes become strips of lines along their curves (`path`).
//! 2. The cutter is turned about its axis (`turned`); part and stock are the caller's triangles.
//! 3. All numbers go into one buffer with the description of its parts (`container`).
//!
//! # Coordinates
//! Lengths are written in metres, as glTF asks. The root node turns the part so that its z points up in
//! glTF, where y does. The numbers in the buffer keep x, y and z of the part. Where the part lies far from
//! the origin, the root node moves it there, so that single precision does for the numbers.
//!
//! # Guarantees
//! * Each point of a curve lies within the chord of [`Content::chord_mm`] of the strip, or of the wider
//!   chord that the file states. A strip has its vertices on the curves, to single precision.
//! * Diagrams keep the least and the largest value of each short time.
//! * The same content gives the same bytes.
//!
//! # Degenerate input
//! A pass without moves has no strip. Content without any triangle and strip is a legal file with an empty
//! scene.
//!
//! # Cost
//! O(n) for n vertices. Curves have at most [`MOST_VERTICES`] vertices together; a toolpath with very many
//! moves has up to four for each move. Turns of the tool axis add at most [`MOST_VERTICES`], and one for each
//! move.

mod clock;
mod container;
mod path;
#[cfg(test)]
mod tests;
mod turned;

use nalgebra::{Point3, Vector3};
use serde_json::{Map, Value, json};

use super::diagram::{Diagram, thinned};
use container::{Document, Look, Mode};
use path::Arrays;
use toolpathd_core::toolpath::Toolpath;
use toolpathd_core::toolpath::measure::{Bounds, measure};
use toolpathd_core::toolpath::tool::Tool;
use toolpathd_core::toolpath::tool_body::ToolBody;
use toolpathd_core::toolpath::units::FeedRate;

/// The chord within which curves become lines, mm, unless they need too many vertices.
pub const CHORD_MM: f64 = 1e-3;

/// Most vertices on curves before their chord is made wider.
pub const MOST_VERTICES: usize = 2_000_000;

/// Farther from the origin than this, the root node moves the part, mm. Single precision is 6e-5 mm there.
const FAR_MM: f64 = 1000.0;

/// Most parts of the time of a diagram; each has two values at most.
const MOST_COLUMNS: usize = 2000;

/// The kinds of stretches, in the order of the numbers in the file.
pub const KINDS: [&str; 10] =
    ["rapid", "cut", "plunge", "ramp", "lead_in", "link", "lead_out", "dwell", "turn", "unknown"];

/// Triangles with a normal at each corner, mm.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Triangles {
    pub points: Vec<Point3<f64>>,
    /// Unit normals of the points.
    pub normals: Vec<Vector3<f64>>,
    /// The corners of each triangle, counterclockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// The raw part.
#[derive(Debug, Clone, PartialEq)]
pub struct Stock {
    pub triangles: Triangles,
    /// Whether the picture assumes its size, because the caller has not told it.
    pub is_assumed: bool,
}

/// What a file shows.
#[derive(Debug, Clone, Copy)]
pub struct Content<'a> {
    pub title: &'a str,
    pub toolpath: Option<&'a Toolpath>,
    /// How fast rapids are.
    pub rapid_feed: FeedRate,
    /// For each move the line of the program that ends it, from 1 on. Empty where no program is written.
    pub lines: &'a [u32],
    /// For each cutting move, in their order, how far it may be from what it stands for, mm. Empty where that
    /// is not known.
    pub deviations_mm: &'a [f64],
    /// Names of passes: each with the index of the first pass that has the name. The passes up to the next
    /// index have the same name.
    pub names: &'a [(usize, String)],
    pub part: Option<&'a Triangles>,
    /// How far the part may be from its triangles, mm, if it is known.
    pub part_chord_mm: Option<f64>,
    pub stock: Option<&'a Stock>,
    pub tool: Option<(&'a Tool, &'a ToolBody)>,
    /// Quantities over time.
    pub diagrams: &'a [Diagram],
    /// For each move the time at its end on the clock of the diagrams, s. Empty where that is not known.
    pub diagram_ends_s: &'a [f64],
    /// The chord of curves, mm.
    pub chord_mm: f64,
}

/// The content as a binary glTF file.
pub fn glb(content: &Content) -> Vec<u8> {
    let mut document = Document::new(origin(content));
    let mut about = Map::new();
    about.insert("unit".into(), json!("mm"));
    about.insert("metres_per_unit".into(), json!(container::METRES));
    about.insert("up".into(), json!("z"));
    let mut nodes = Vec::new();
    let stock = content.stock.map(|stock| &stock.triangles);
    for (name, mesh, look) in [("part", content.part, Look::Part), ("stock", stock, Look::Stock)] {
        if let Some(mesh) = mesh.filter(|mesh| !mesh.triangles.is_empty()) {
            nodes.push(solid(&mut document, name, mesh, look));
        }
    }
    if let Some(chord_mm) = content.part_chord_mm {
        about.insert("part_chord_mm".into(), json!(chord_mm));
    }
    if let Some(Stock { is_assumed, .. }) = content.stock {
        about.insert("stock_is_assumed".into(), json!(is_assumed));
    }
    if let Some((tool, body)) = content.tool {
        let mesh = turned::cutter(tool, body);
        // The cutter belongs to its tip, and not to a place of the part.
        let placed =
            Triangles { points: mesh.points.iter().map(|p| p + document.origin()).collect(), ..mesh };
        nodes.push(solid(&mut document, "cutter", &placed, Look::Cutter));
    }
    let mut clock = Vec::new();
    if let Some(toolpath) = content.toolpath {
        let (strips, chord_mm) = path::strips(toolpath, content);
        clock = clock::pairs(content.diagram_ends_s, strips.move_ends_s());
        about.insert("chord_mm".into(), json!(chord_mm));
        about.insert("kinds".into(), json!(KINDS));
        let mut passes = Vec::with_capacity(strips.passes.len());
        if !strips.passes.is_empty() {
            let arrays = Arrays::new(&mut document, &strips);
            passes.extend(strips.passes.iter().map(|strip| path::node(&mut document, &arrays, strip)));
        }
        nodes.push(document.node(json!({ "name": "path" }), None, &passes));
    }
    if !content.diagrams.is_empty() {
        let starts_at_s = clock.first().map(|[_, path_s]| *path_s);
        let told = content.diagrams.iter().map(|one| diagram(one, starts_at_s));
        about.insert("diagrams".into(), told.collect());
        if !clock.is_empty() {
            about.insert("clock".into(), json!(clock));
        }
    }
    document.finish(content.title, &nodes, Value::Object(about))
}

/// The node of a mesh of triangles.
fn solid(document: &mut Document, name: &str, mesh: &Triangles, look: Look) -> usize {
    let points = document.points(&mesh.points);
    let normals = document.vectors(&mesh.normals);
    let indices = document.indices(&mesh.triangles);
    let attributes = vec![("POSITION", points), ("NORMAL", normals)];
    let mesh = document.mesh(name, Mode::Triangles, attributes, Some(indices), Some(look));
    document.node(json!({ "name": name }), Some(mesh), &[])
}

/// A diagram in the description of the file, with the time of the path at which its clock starts, s.
fn diagram(Diagram { name, before, after }: &Diagram, starts_at_s: Option<f64>) -> Value {
    let [before, after] = [before, after].map(|course| thinned(course, MOST_COLUMNS));
    let mut told = json!({ "name": name, "before": before, "after": after });
    if let Some(starts_at_s) = starts_at_s {
        told["starts_at_s"] = json!(starts_at_s);
    }
    told
}

/// The place from which coordinates in the buffer count, mm.
fn origin(content: &Content) -> Point3<f64> {
    let bounds = content.toolpath.map(|toolpath| measure(toolpath, content.rapid_feed).bounds);
    let stock = content.stock.map(|stock| &stock.triangles);
    let solids = [content.part, stock].into_iter().flatten().flat_map(|mesh| &mesh.points);
    let corners = bounds.iter().flat_map(|Bounds { min, max }| [min, max]);
    let mut all = solids.chain(corners);
    let Some(first) = all.next() else { return Point3::origin() };
    let (min, max) = all.fold((*first, *first), |(min, max), p| (min.inf(p), max.sup(p)));
    if min.coords.amax().max(max.coords.amax()) <= FAR_MM {
        return Point3::origin();
    }
    nalgebra::center(&min, &max).map(f64::round)
}
