//! Draws a toolpath, a surface or both as one SVG sheet: A4 landscape, to scale when printed. [`svg`] draws
//! three views; [`axonometric`](fn@axonometric) draws one. [`gltf`] writes them for programs that show three
//! dimensions.
//!
//! # Method
//! 1. `layout` arranges three views in first-angle projection: plan, front and left side. It takes the
//!    largest standard scale at which all three fit.
//! 2. `view` projects each curve into each view. An arc or a helix is drawn as an arc in the view that faces
//!    its plane. In the other views an arc is a straight line, and a helix is drawn as chords.
//! 3. `pen` writes the path data of the curves. It omits details below the resolution of the drawing.
//! 4. `relief` draws the surface under the paths, as coloured bands of heights.
//! 5. If the path data exceeds [`MAX_PATH_BYTES`], or the lines would merge into a block, the paths are drawn
//!    with fewer strokes. A stroke is omitted if earlier strokes of its kind pass near all of it (`ink`). The
//!    sheet then says how near.
//!
//! # Guarantees
//! * Each point of a move is drawn within 0.02 mm of paper of its exact place, unless the sheet says that
//!   strokes are omitted.
//! * A sheet has about 3 MB at most.
//! * The same content gives the same bytes. Texts of the caller appear as text only, never as markup.
//!
//! # Degenerate input
//! If there is nothing to draw, or a coordinate is larger than a thousand kilometres in size, the sheet has
//! no drawing and says so. A single point is drawn at 1:1.
//!
//! # Cost
//! O(n) for n moves and points.

mod axes;
mod axonometric;
pub mod bars;
mod class;
mod column;
pub mod diagram;
pub mod gltf;
mod ink;
mod layers;
mod layout;
mod marks;
mod number;
mod pen;
mod relief;
pub mod solid;
pub mod stl;
#[cfg(test)]
mod tests;
pub mod text;
mod view;

pub use axonometric::svg as axonometric;
use nalgebra::Point3;

use class::Class;
use column::Texts;
use layers::{Layer, Pens};
use layout::Layout;
use pen::Pen;
use relief::Relief;
use text::escape;
use toolpathd_core::geometry::mesh::Mesh;
use toolpathd_core::geometry::surface::Surface;
use toolpathd_core::toolpath::{Move, Toolpath};
use view::View;

/// The sheet is A4 landscape: width and height, mm.
const SHEET_MM: [u32; 2] = [297, 210];

/// The content of a sheet: the drawing and the texts beside it.
#[derive(Debug, Clone, Copy)]
pub struct Scene<'a> {
    pub title: &'a str,
    /// Lines beside the drawing: part, tool, feeds, proved figures.
    pub notes: &'a [String],
    /// Warnings above the notes.
    pub warnings: &'a [String],
    pub toolpath: Option<&'a Toolpath>,
    pub drawing: &'a Drawing,
}

impl<'a> Scene<'a> {
    fn texts(&self) -> Texts<'a> {
        Texts { warnings: self.warnings, notes: self.notes }
    }
}

/// What is drawn in addition to the toolpath: a surface, polylines and points; mm.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Drawing {
    /// The surface that is drawn as bands of heights with shade.
    pub relief: Option<Mesh>,
    /// Wires of a surface.
    pub surface: Vec<Vec<Point3<f64>>>,
    /// The walls and the islands of a pocket.
    pub walls: Vec<Vec<Point3<f64>>>,
    /// Designed curves.
    pub curve: Vec<Vec<Point3<f64>>>,
    /// The edges of places that stay uncut.
    pub uncut: Vec<Vec<Point3<f64>>>,
    /// The edges of the band in which elements have to stay.
    pub band: Vec<Vec<Point3<f64>>>,
    /// The places where elements meet.
    pub joints: Vec<Point3<f64>>,
    /// Given places of the tip. They are drawn below the path.
    pub poses: Vec<Point3<f64>>,
    /// Lines along the tool axis, from the tip.
    pub tool_axes: Vec<Vec<Point3<f64>>>,
    /// Outlines of the stock, of walls and of fixtures.
    pub solids: Vec<Vec<Point3<f64>>>,
    /// Places where something is wrong. They are drawn over everything else.
    pub findings: Vec<Point3<f64>>,
}

impl Drawing {
    pub fn of_surface(surface: Vec<Vec<Point3<f64>>>) -> Self {
        Self { surface, ..Self::default() }
    }

    /// A surface as a relief, with its wires on top.
    pub fn of_relief(relief: &dyn Surface, surface: Vec<Vec<Point3<f64>>>) -> Self {
        Self { relief: Some(Mesh::of(relief, relief::CELLS)), ..Self::of_surface(surface) }
    }

    fn points(&self) -> impl Iterator<Item = &Point3<f64>> {
        let shaded = self.relief.iter().flat_map(Mesh::points);
        let lines = self.surface.iter().chain(&self.curve).chain(&self.uncut).chain(&self.band);
        let all = lines.chain(&self.tool_axes).chain(&self.solids).chain(&self.walls).flatten();
        all.chain(&self.joints).chain(&self.poses).chain(&self.findings).chain(shaded)
    }
}

/// Most bytes of path data before strokes are left out. A browser shows a picture of this size, and a mail
/// carries it, without delay.
pub const MAX_PATH_BYTES: usize = 2_000_000;

/// Cell sizes of the rasters on which strokes are left out, mm of paper. The first is the width of a line.
/// The last has so few cells that the paths cannot grow much beyond the limit.
const RASTERS_MM: [f64; 4] = [0.25, 0.5, 1.0, 2.0];

/// The width of a line of a cut, mm of paper.
const CUT_WIDTH_MM: f64 = 0.18;

/// The part of the area of a path in plan that its lines may cover, and the room around a path without an
/// area, mm of paper.
const MOST_INK: f64 = 0.5;
const ROOM_MM: f64 = 2.0;

/// Fewer cuts than this are all drawn.
const FEWEST_OF_BLOCK: usize = 1000;

/// The cells for a path that would be a block.
const LEAST_OF_BLOCK_MM: f64 = 0.5;

/// Path data by view, level and class.
type Paths = [Vec<Layer>; 3];

/// Draws `scene` as an SVG document.
pub fn svg(scene: &Scene) -> String {
    let mut out = opening(scene.title, "plan, front and left side", "");
    match Layout::of(scene) {
        Ok(layout) => {
            let (paths, raster_mm) = draw(scene, &layout);
            let shaded = scene.drawing.relief.as_ref().map(|mesh| relief::draw(mesh, &layout));
            let Relief { style, definitions, views: reliefs } = shaded.unwrap_or_default();
            if !style.is_empty() {
                out += &format!("<style>{style}</style>\n<defs>\n{definitions}</defs>\n");
            }
            for ((view, paths), relief) in layout.views.iter().zip(&paths).zip(&reliefs) {
                out += &format!("<g class=\"view\" id=\"{}\">\n", view.id);
                if !relief.is_empty() {
                    out += &format!("<g class=\"relief\">\n{relief}</g>\n");
                }
                out += &axes::draw(view, &layout);
                out += &layers::strokes(view.id, paths);
                out += &marks::draw(scene, view);
                out += "</g>\n";
            }
            out += &column::draw(scene, &layout, &layers::used(paths.iter().flatten()), raster_mm);
        }
        Err(reason) => out += &column::refusal(scene, &reason.to_string()),
    }
    out + "</svg>\n"
}

/// The beginning of a sheet, up to its border. `shows` says what is drawn; `style` adds rules.
fn opening(title: &str, shows: &str, style: &str) -> String {
    let title = escape(&text::clean(title));
    let [width, height] = SHEET_MM;
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"plot\" width=\"{width}mm\" height=\"{height}mm\" \
         viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{title}: {shows}\">\n\
         <title>{title}</title>\n<style>{}{style}</style>\n{}",
        class::style(),
        column::border()
    )
}

/// The paths, and the cell size of the raster, mm, if strokes were left out. The paths are drawn without a
/// raster first, then with larger and larger cells until the path data is small enough. So each curve is
/// projected three to fifteen times. A path whose lines would merge into a block is drawn with a raster at
/// once.
fn draw(scene: &Scene, layout: &Layout) -> (Paths, Option<f64>) {
    let [finer @ .., coarsest] = RASTERS_MM;
    let is_block = scene.toolpath.is_some_and(|toolpath| is_block(toolpath, layout.scale.value()));
    let attempts = [None].into_iter().chain(finer.map(Some));
    let attempts = attempts.filter(|raster_mm| !is_block || *raster_mm >= Some(LEAST_OF_BLOCK_MM));
    for raster_mm in attempts {
        if let Some(paths) = trace(scene, layout, raster_mm, MAX_PATH_BYTES) {
            return (paths, raster_mm);
        }
    }
    let paths = trace(scene, layout, Some(coarsest), usize::MAX);
    (paths.unwrap_or_default(), Some(coarsest))
}

/// Whether the cuts of a toolpath would cover much of their area in plan, at a scale.
fn is_block(toolpath: &Toolpath, scale: f64) -> bool {
    let (mut ink_mm2, mut n_cuts) = (0.0, 0);
    let mut corners: Option<[Point3<f64>; 2]> = None;
    for (class, along) in toolpath.moves().filter_map(class::of) {
        if matches!(class, Class::CutLine | Class::CutArc | Class::CutParabola) {
            n_cuts += 1;
            ink_mm2 += along.length() * scale * CUT_WIDTH_MM;
            let ends = [along.start(), along.end()];
            let [low, high] = corners.unwrap_or([ends[0]; 2]);
            corners = Some(ends.iter().fold([low, high], |[low, high], end| [low.inf(end), high.sup(end)]));
        }
    }
    let area_mm2 = corners.map_or(0.0, |[low, high]| {
        let size = (high - low) * scale;
        (size.x + ROOM_MM) * (size.y + ROOM_MM)
    });
    n_cuts >= FEWEST_OF_BLOCK && ink_mm2 > MOST_INK * area_mm2
}

/// The paths; `None` if they grow beyond `max_bytes`.
fn trace(scene: &Scene, layout: &Layout, raster_mm: Option<f64>, max_bytes: usize) -> Option<Paths> {
    let mut pens = [(); 3].map(|()| Pens::new(raster_mm));
    let is_within = |pens: &[Pens; 3]| pens.iter().map(Pens::bytes).sum::<usize>() <= max_bytes;
    let Drawing { relief: _, surface, walls, curve, uncut, band, joints, poses, tool_axes, solids, findings } =
        scene.drawing;
    let polylines = [
        (Class::Band, band),
        (Class::Solid, solids),
        (Class::Wall, walls),
        (Class::Wire, surface),
        (Class::ToolAxis, tool_axes),
        (Class::Curve, curve),
        (Class::Uncut, uncut),
    ];
    for (class, wires) in polylines {
        for wire in wires {
            for (view, pens) in layout.views.iter().zip(&mut pens) {
                trace_wire(view, wire, pens.pen(class));
            }
            if !is_within(&pens) {
                return None;
            }
        }
    }
    let levels = scene.toolpath.map(layers::levels).unwrap_or_default();
    for (pass, level) in scene.toolpath.iter().flat_map(|toolpath| toolpath.passes()).zip(levels) {
        pens.iter_mut().for_each(|pens| pens.turn_to(level));
        for (class, curve) in pass.moves().iter().filter_map(class::of) {
            for (view, pens) in layout.views.iter().zip(&mut pens) {
                view.trace(&curve, pens.pen(class));
            }
            if !is_within(&pens) {
                return None;
            }
        }
    }
    pens.iter_mut().for_each(|pens| pens.turn_to(None));
    for (class, dots) in [(Class::Joint, joints), (Class::Pose, poses), (Class::Finding, findings)] {
        for dot in dots {
            for (view, pens) in layout.views.iter().zip(&mut pens) {
                trace_wire(view, std::slice::from_ref(dot), pens.pen(class));
            }
        }
    }
    if !is_within(&pens) {
        return None;
    }
    Some(pens.map(Pens::finish))
}

fn trace_wire(view: &View, wire: &[Point3<f64>], pen: &mut Pen) {
    for pair in wire.windows(2) {
        pen.line(view.project(&pair[0]), view.project(&pair[1]));
    }
    if let [point] = wire {
        pen.line(view.project(point), view.project(point));
    }
}
