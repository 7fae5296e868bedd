//! A program with what it is verified against.

use nalgebra::{Point2, Point3};
use toolpathd_core::geometry::segment::Segment;
use toolpathd_core::geometry::surface::net_grid::NetGrid;
use toolpathd_core::geometry::surface::source::Source;
use toolpathd_core::machining::assembly::{Assembly, Frustum};
use toolpathd_core::machining::cutter::Cutter;
use toolpathd_core::operations::pocketing::Outlines;
use toolpathd_core::operations::verification as core;

use super::block::{At, Block};
use super::sheet::Sheet;

/// How deep the cutter may enter the part, mm.
pub const TOLERANCE_MM: f64 = 0.004;

/// Cells of the height map of a pocket and of a surface, mm. A rapid beside a cut wall is decided to within some
/// cells, and rows over a surface have many walls.
const CELL_MM: [f64; 2] = [0.5, 0.1];

/// A tool: a flat end with a rounded corner, and one holder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tool {
    pub number: u32,
    pub radius: f64,
    pub corner: f64,
    pub flute: f64,
    /// Height of the lower end of the holder over the tip, and its radius, mm.
    pub stickout: f64,
    pub holder: f64,
}

/// A rectangle with rounded corners in plan, from the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pocket {
    pub size: [f64; 2],
    pub corner: f64,
    pub depth: f64,
    /// How far the island lies within the walls, mm.
    pub corridor: Option<f64>,
}

#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    Pocket(Pocket),
    Sheet(Sheet),
}

/// A box of raw material: the lowest and the highest corner, mm.
pub type Box3 = [At; 2];

/// A program with its surroundings.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    pub shape: Shape,
    pub blocks: Vec<Block>,
    pub start: At,
    /// The zero of G55 relative to that of G54, mm.
    pub zero: At,
    pub tools: Vec<Tool>,
    pub stock: Option<Box3>,
    pub clamp: Box3,
    pub travel: Box3,
    pub clearance: f64,
    /// How much may stand above the part at the end, mm.
    pub allowed: f64,
    pub is_dog_leg: bool,
}

impl Scene {
    pub fn tool(&self, number: u32) -> &Tool {
        self.tools.iter().find(|tool| tool.number == number).expect("a tool of the scene")
    }

    /// The job of verifying, without the program.
    pub fn job(&self, toolpath: toolpathd_core::toolpath::Toolpath, tool_of_pass: Vec<usize>) -> core::Job {
        let point = |p: &At| Point3::from(*p);
        let part = match &self.shape {
            Shape::Pocket(pocket) => {
                core::Part::Pocket { outlines: pocket.outlines(), top_mm: 0.0, floor_mm: -pocket.depth }
            }
            Shape::Sheet(sheet) => {
                let nets = vec![vec![sheet.net().map(|row| row.map(Point3::from))]];
                core::Part::Surface { source: Source::NetGrid(NetGrid { nets }), allowance_mm: 0.0 }
            }
        };
        let [low, high] = &self.clamp;
        let clamp = core::Fixture {
            outlines: rectangle([low[0], low[1]], [high[0], high[1]], 0.0),
            bottom_mm: low[2],
            top_mm: high[2],
        };
        let stock = self.stock.as_ref();
        let plain = core::Job::new(toolpath, self.tools[0].core(), TOLERANCE_MM);
        core::Job {
            tools: self.tools.iter().map(Tool::core).collect(),
            tool_of_pass,
            part: Some(part),
            stock: stock.map(|[low, high]| core::Raw::Block { low: point(low), high: point(high) }),
            cell_mm: Some(CELL_MM[usize::from(matches!(self.shape, Shape::Sheet(_)))]),
            fixtures: vec![clamp],
            travel: Some(core::Travel { low: point(&self.travel[0]), high: point(&self.travel[1]) }),
            clearance_mm: self.clearance,
            allowed_excess_mm: Some(self.allowed),
            rapids: if self.is_dog_leg { core::Rapids::DogLeg } else { core::Rapids::Straight },
            ..plain
        }
    }
}

impl Tool {
    fn core(&self) -> core::Tool {
        let holder = Frustum {
            bottom_mm: self.stickout,
            top_mm: self.stickout + 30.0,
            bottom_radius_mm: self.holder,
            top_radius_mm: self.holder,
        };
        let cutter = Cutter::bull_nose(self.radius, self.corner);
        let assembly = Assembly { cutter, sections: vec![holder] };
        core::Tool { assembly, flute_length_mm: Some(self.flute) }
    }
}

impl Pocket {
    fn outlines(&self) -> Outlines {
        let [w, h] = self.size;
        let wall = rectangle([0.0, 0.0], [w, h], self.corner);
        let island =
            self.corridor.map(|d| rectangle([d, d], [w - d, h - d], (self.corner - d).max(0.0)).boundary);
        Outlines { boundary: wall.boundary, islands: island.into_iter().collect() }
    }
}

fn rectangle(low: [f64; 2], high: [f64; 2], corner: f64) -> Outlines {
    let r = corner;
    let sides = [
        [[low[0] + r, low[1]], [high[0] - r, low[1]]],
        [[high[0], low[1] + r], [high[0], high[1] - r]],
        [[high[0] - r, high[1]], [low[0] + r, high[1]]],
        [[low[0], high[1] - r], [low[0], low[1] + r]],
    ];
    let mut boundary = Vec::new();
    for (k, side) in sides.iter().enumerate() {
        let [start, end] = side.map(Point2::from);
        boundary.push(Segment::Line { start, end });
        if r > 0.0 {
            let next = Point2::from(sides[(k + 1) % 4][0]);
            boundary.push(Segment::turning(end, next, std::f64::consts::FRAC_PI_2));
        }
    }
    Outlines { boundary, islands: Vec::new() }
}
