//! The relief: a surface as coloured bands of heights. The plan shows the bands with contours between them,
//! and light from the upper left. Front and left side show the area that the surface covers.
//!
//! # Method
//! 1. The surface becomes a mesh of triangles.
//! 2. For the plan, each triangle is cut at the heights where two bands meet (`bands`), and where light or
//!    shade begins (`tone`). The pieces of each band are joined to one area (`border`).
//! 3. In the plan, the bands are drawn from the lowest to the highest. So higher parts of the surface cover
//!    lower parts.
//! 4. For the front and for the left side, all triangles are joined to one area. The area is filled with the
//!    colours of the bands by height.
//!
//! # Guarantees
//! A relief has at most about [`MAX_BYTES`]. If a relief would have more, a coarser mesh is drawn.
//!
//! # Cost
//! O(n log n) for n pieces of triangles.

mod bands;
mod border;
mod tone;

use nalgebra::{Point2, Point3, Vector3};

use super::layout::Layout;
use super::view::View;
pub use bands::{Bands, legend};
use border::Border;
use tone::TONES;
use toolpathd_core::geometry::mesh::Mesh;

/// Cells of a mesh along each direction. With this number, a circle as large as a sheet is drawn within 0.1
/// mm of paper.
pub const CELLS: usize = 72;

/// Most bytes of a relief before a coarser mesh is drawn.
pub const MAX_BYTES: usize = 300_000;
/// Most cuts of a mesh's triangles. A mesh with more cuts is too rough and a coarser mesh is drawn. A smooth
/// surface has some 2000 cuts.
const MOST_CUTS: usize = 6_000;

/// Numbers of cells and of tones, in the order in which they are tried. The last relief always fits.
const DETAILS: [(usize, usize); 5] =
    [(CELLS, TONES.len()), (36, TONES.len()), (18, TONES.len()), (18, 0), (9, 0)];

/// The elements of a relief.
#[derive(Debug, Clone, Default)]
pub struct Relief {
    /// Rules of the style sheet, and definitions that fills refer to.
    pub style: String,
    pub definitions: String,
    /// The elements of plan, front and left side.
    pub views: [String; 3],
}

/// A corner of a piece of the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner {
    pub at: Point2<f64>,
    /// mm of the part.
    pub height: f64,
    /// The light here minus the light on a level place; negative in shade.
    pub light: f64,
}

/// The relief of `mesh`.
pub fn draw(mesh: &Mesh, layout: &Layout) -> Relief {
    let bands = Bands::of(mesh.points());
    let mut views = Default::default();
    for (cells, tones) in DETAILS {
        let mesh = mesh.thinned(cells);
        let cuts: usize = mesh.triangles().map(|t| bands.cuts(t.map(|k| mesh.points()[k].z))).sum();
        if cuts > MOST_CUTS {
            continue;
        }
        let [plan, front, side] = &layout.views;
        views = [shaded(&mesh, plan, &bands, tones), hidden(&mesh, front), hidden(&mesh, side)];
        if views.iter().map(String::len).sum::<usize>() <= MAX_BYTES {
            break;
        }
    }
    let [_, front, side] = &layout.views;
    Relief {
        style: bands.style() + &tone::style() + &fill(front) + &fill(side),
        definitions: bands.gradient(front, &gradient_id(front)) + &bands.gradient(side, &gradient_id(side)),
        views,
    }
}

fn gradient_id(view: &View) -> String {
    format!("heights-{}", view.id)
}

/// The rule that fills the area of the surface in `view`.
fn fill(view: &View) -> String {
    format!(".plot .hidden-{}{{fill:url(#{});stroke:none}}", view.id, gradient_id(view))
}

/// One band of heights: the border of its pieces, and for each tone the border of its parts.
#[derive(Debug, Clone, Default)]
struct Slab {
    border: Border,
    tones: [Border; TONES.len()],
}

/// The surface from above, in bands and tones, as elements.
fn shaded(mesh: &Mesh, view: &View, bands: &Bands, tones: usize) -> String {
    let corner = |(p, normal): (&Point3<f64>, Vector3<f64>)| Corner {
        at: view.project(p),
        height: bands.snapped(p.z),
        light: tone::light(&normal),
    };
    let corners: Vec<Corner> = mesh.points().iter().zip(mesh.normals()).map(corner).collect();
    let mut slabs = vec![Slab::default(); bands.count()];
    for triangle in mesh.triangles() {
        let triangle = triangle.map(|k| corners[k]);
        let sense = sense(triangle.map(|corner| corner.at));
        bands.cut(&triangle, |band, piece| slabs[band].add(sense, piece, tones));
    }
    elements(slabs)
}

/// The slabs as elements, the lowest first. The area of each includes all higher slabs. Light and shade of a
/// slab are drawn over its area.
fn elements(slabs: Vec<Slab>) -> String {
    let mut above = Border::default();
    let mut out = Vec::new();
    for (band, slab) in slabs.into_iter().enumerate().rev() {
        above.merge(slab.border.settled());
        above = above.settled();
        let tones = slab.tones.into_iter().enumerate();
        let tones: String = tones.map(|(k, border)| path(TONES[k].name, &border.settled().data())).collect();
        out.push(path(&format!("contour h{band}"), &above.data()) + &tones);
    }
    out.into_iter().rev().collect()
}

/// The area that the surface covers in a view.
fn hidden(mesh: &Mesh, view: &View) -> String {
    let places: Vec<Point2<f64>> = mesh.points().iter().map(|p| view.project(p)).collect();
    let mut border = Border::default();
    for triangle in mesh.triangles() {
        let triangle = triangle.map(|k| places[k]);
        border.add(sense(triangle), triangle.into_iter());
    }
    path(&format!("hidden-{}", view.id), &border.settled().data())
}

fn path(class: &str, data: &str) -> String {
    if data.is_empty() { String::new() } else { format!("<path class=\"{class}\" d=\"{data}\"/>\n") }
}

/// 1 if the corners turn clockwise on paper, otherwise -1.
fn sense([a, b, c]: [Point2<f64>; 3]) -> i32 {
    if (b - a).perp(&(c - a)) < 0.0 { -1 } else { 1 }
}

impl Slab {
    fn add(&mut self, sense: i32, piece: &[Corner], tones: usize) {
        self.border.add(sense, places(piece));
        for (tone, border) in TONES.iter().zip(&mut self.tones).take(tones) {
            let part = tone.part_of(piece);
            if !part.is_empty() {
                border.add(sense, places(&part));
            }
        }
    }
}

fn places(piece: &[Corner]) -> impl Iterator<Item = Point2<f64>> + Clone {
    piece.iter().map(|corner| corner.at)
}

/// The parts of a convex piece where `value` is below `level`, and where it is not.
///
/// The cut of an edge is computed from its lower end, so both pieces beside the edge get the same point.
fn split(piece: &[Corner], level: f64, value: impl Fn(&Corner) -> f64) -> [Vec<Corner>; 2] {
    let mut parts = [Vec::with_capacity(piece.len() + 1), Vec::with_capacity(piece.len() + 1)];
    for (k, corner) in piece.iter().enumerate() {
        let next = &piece[(k + 1) % piece.len()];
        let [here, there] = [corner, next].map(|corner| value(corner) >= level);
        parts[usize::from(here)].push(*corner);
        if here != there {
            let (low, high) = if here { (next, corner) } else { (corner, next) };
            let cut = low.towards(high, (level - value(low)) / (value(high) - value(low)));
            parts.iter_mut().for_each(|part| part.push(cut));
        }
    }
    parts
}

impl Corner {
    fn towards(&self, other: &Self, t: f64) -> Self {
        Self {
            at: self.at + (other.at - self.at) * t,
            height: self.height + (other.height - self.height) * t,
            light: self.light + (other.light - self.light) * t,
        }
    }
}
