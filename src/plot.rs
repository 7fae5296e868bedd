//! Pictures: a toolpath, a surface or both as one SVG sheet, A4 landscape, that prints true to its stated
//! scale.
//!
//! # Method
//! 1. The bounds of all that is drawn choose the largest standard scale at which the plan, the front and the
//!    left side fit in first-angle arrangement (`layout`).
//! 2. Every curve is projected into every view (`view`): an arc facing the view stays an arc, in pieces of a
//!    quarter turn at most; an arc seen from its edge is its extremes; a helix seen from its side is
//!    flattened; a parabola is a quadratic curve in every view.
//! 3. For each view and each class of motion one pen writes path data (`pen`): runs of lines are thinned
//!    within a cone of directions, curves below the drawing's resolution become lines.
//! 4. A surface lies under the strokes, as bands of heights (`relief`).
//! 5. Where the paths grow beyond [`MAX_PATH_BYTES`], they are drawn again and strokes on paper that the same
//!    class has already inked are left out (`ink`), on a finer and then coarser raster. The sheet says so.
//!
//! # Guarantees
//! * Unless the sheet says that strokes are left out, no point of a move is drawn farther than 0.02 mm of
//!   paper from where it belongs, and nothing else is drawn; the relief of a surface is as true as its mesh.
//! * A picture has at most some 3 MB, whatever it shows.
//! * Same scene, same bytes. Texts reach the picture as text only.
//!
//! # Degenerate input
//! Points and straight paths are drawn at the scale that the rest asks for. What has no extent is drawn at
//! 1:1. A scene with nothing in it, or with coordinates beyond a thousand kilometres, is a sheet that says
//! so.
//!
//! # Cost
//! O(n) in the moves and points: each is projected three times, and at most five times over when strokes are
//! left out; then a stroke costs its length in cells of the raster.

mod axes;
mod class;
mod column;
mod ink;
mod layout;
mod marks;
mod number;
mod pen;
mod relief;
#[cfg(test)]
mod tests;
pub mod text;
mod view;

use nalgebra::Point3;

use crate::geometry::mesh::Mesh;
use crate::geometry::surface::Surface;
use crate::toolpath::{Move, Toolpath};
use class::Class;
use layout::Layout;
use pen::Pen;
use relief::Relief;
use text::escape;
use view::View;

/// The sheet is A4 landscape: width and height, mm.
const SHEET_MM: [u32; 2] = [297, 210];

/// What is drawn, and what the sheet says of it.
#[derive(Debug, Clone, Copy)]
pub struct Scene<'a> {
    pub title: &'a str,
    /// Lines beside the drawing: part, tool, feeds, proved figures.
    pub notes: &'a [String],
    pub toolpath: Option<&'a Toolpath>,
    pub drawing: &'a Drawing,
}

/// What is drawn beside the toolpath: a surface, polylines and points, mm.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Drawing {
    /// What is shaded.
    pub relief: Option<Mesh>,
    /// Wires of a surface.
    pub surface: Vec<Vec<Point3<f64>>>,
    /// Curves as they were designed.
    pub curve: Vec<Vec<Point3<f64>>>,
    /// The edges of what is allowed.
    pub band: Vec<Vec<Point3<f64>>>,
    /// Where elements meet.
    pub joints: Vec<Point3<f64>>,
}

impl Drawing {
    pub fn of_surface(surface: Vec<Vec<Point3<f64>>>) -> Self {
        Self { surface, ..Self::default() }
    }

    /// The surface shaded, under its wires.
    pub fn of_relief(relief: &dyn Surface, surface: Vec<Vec<Point3<f64>>>) -> Self {
        Self { relief: Some(Mesh::of(relief, relief::CELLS)), ..Self::of_surface(surface) }
    }

    fn points(&self) -> impl Iterator<Item = &Point3<f64>> {
        let shaded = self.relief.iter().flat_map(Mesh::points);
        let lines = self.surface.iter().chain(&self.curve).chain(&self.band).flatten();
        lines.chain(&self.joints).chain(shaded)
    }
}

/// Path data beyond this is thinned: what a browser shows and a mail carries without delay.
pub const MAX_PATH_BYTES: usize = 2_000_000;

/// Cells of the rasters on which strokes are left out, mm of paper. The first is a line's width; on the last
/// there are too few cells for the paths to grow much beyond the limit.
const RASTERS_MM: [f64; 4] = [0.25, 0.5, 1.0, 2.0];

/// Path data by view and class.
type Paths = [[String; Class::ALL.len()]; 3];

/// Draws `scene`.
pub fn svg(scene: &Scene) -> String {
    let title = escape(&text::clean(scene.title));
    let [width, height] = SHEET_MM;
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"plot\" width=\"{width}mm\" height=\"{height}mm\" \
         viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{title}: plan, front and left side\">\n\
         <title>{title}</title>\n<style>{}</style>\n",
        class::style()
    );
    out += &column::border();
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
                out += &strokes(paths);
                out += &marks::draw(scene, view);
                out += "</g>\n";
            }
            out += &column::draw(scene, &layout, &used(&paths), raster_mm);
        }
        Err(reason) => out += &column::refusal(scene, &reason.to_string()),
    }
    out + "</svg>\n"
}

/// The paths, and the raster on which strokes were left out, if any.
fn draw(scene: &Scene, layout: &Layout) -> (Paths, Option<f64>) {
    let [finer @ .., coarsest] = RASTERS_MM;
    let attempts = [None].into_iter().chain(finer.map(Some));
    for raster_mm in attempts {
        if let Some(paths) = trace(scene, layout, raster_mm, MAX_PATH_BYTES) {
            return (paths, raster_mm);
        }
    }
    let paths = trace(scene, layout, Some(coarsest), usize::MAX);
    (paths.unwrap_or_default(), Some(coarsest))
}

/// The paths; nothing when they grow beyond `max_bytes`.
fn trace(scene: &Scene, layout: &Layout, raster_mm: Option<f64>, max_bytes: usize) -> Option<Paths> {
    let mut pens = [(); 3].map(|()| Class::ALL.map(|_| Pen::new(raster_mm)));
    let is_within = |pens: &[[Pen; Class::ALL.len()]; 3]| {
        pens.iter().flatten().map(Pen::bytes).sum::<usize>() <= max_bytes
    };
    let Drawing { relief: _, surface, curve, band, joints } = scene.drawing;
    for (class, wires) in [(Class::Band, band), (Class::Wire, surface), (Class::Curve, curve)] {
        for wire in wires {
            for (view, pens) in layout.views.iter().zip(&mut pens) {
                trace_wire(view, wire, &mut pens[class as usize]);
            }
            if !is_within(&pens) {
                return None;
            }
        }
    }
    for step in scene.toolpath.iter().flat_map(|toolpath| toolpath.moves()) {
        let Some((class, curve)) = class::of(step) else { continue };
        for (view, pens) in layout.views.iter().zip(&mut pens) {
            view.trace(&curve, &mut pens[class as usize]);
        }
        if !is_within(&pens) {
            return None;
        }
    }
    for joint in joints {
        for (view, pens) in layout.views.iter().zip(&mut pens) {
            trace_wire(view, std::slice::from_ref(joint), &mut pens[Class::Joint as usize]);
        }
    }
    if !is_within(&pens) {
        return None;
    }
    Some(pens.map(|pens| pens.map(Pen::finish)))
}

fn trace_wire(view: &View, wire: &[Point3<f64>], pen: &mut Pen) {
    for pair in wire.windows(2) {
        pen.line(view.project(&pair[0]), view.project(&pair[1]));
    }
    if let [point] = wire {
        pen.line(view.project(point), view.project(point));
    }
}

/// The classes that are drawn somewhere.
fn used(paths: &Paths) -> Vec<Class> {
    Class::ALL
        .into_iter()
        .filter(|class| paths.iter().any(|view| !view[*class as usize].is_empty()))
        .collect()
}

fn strokes(paths: &[String; Class::ALL.len()]) -> String {
    let elements = Class::ALL.iter().zip(paths).filter(|(_, data)| !data.is_empty());
    elements.map(|(class, data)| format!("<path class=\"{}\" d=\"{data}\"/>\n", class.name())).collect()
}
