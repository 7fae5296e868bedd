//! The pocketing job: the area, the heights, the tool, and what is left to choose.

use crate::geometry::element::Element;
use crate::toolpath::cutting::CuttingRequest;
use crate::toolpath::program::Resolution;
use crate::toolpath::tool::Tool;

/// A way to clear a level. The first six are those of Ryu et al.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Pattern {
    /// Rings about the islands, outward.
    IslandOffset,
    /// Rings beside the wall and the islands at once.
    IslandStockOffset,
    /// Rows to and fro up to walls and islands.
    ZigzagOffset,
    /// Rows to and fro inside a ring beside walls and islands.
    ZigzagStockOffset,
    /// Rows that go around islands and on.
    ContinuousOffset,
    /// Rows that go around islands and on, inside a ring beside walls and islands.
    ContinuousStockOffset,
    /// Passes whose angle in material is bounded.
    Engagement,
}

impl Pattern {
    pub const ALL: [Self; 7] = [
        Self::IslandOffset,
        Self::IslandStockOffset,
        Self::ZigzagOffset,
        Self::ZigzagStockOffset,
        Self::ContinuousOffset,
        Self::ContinuousStockOffset,
        Self::Engagement,
    ];
}

/// The figure that the chosen pattern of a level has least.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ChooseBy {
    #[default]
    Time,
    /// The paper's sum of lengths divided by feeds.
    PaperTime,
    /// The time on a machine with limited acceleration.
    TimeWithAcceleration,
}

/// The side of the cutter on which the material is, seen along the feed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Milling {
    /// On the right: a cutter that turns clockwise comes out of the material at its surface.
    #[default]
    Climb,
    Conventional,
}

/// How the cutter may come down into the material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EntryLimits {
    /// The largest and the smallest diameter of the circle that the tip follows on a helix, mm.
    pub max_diameter_mm: f64,
    pub min_diameter_mm: f64,
    /// The steepest angle of helices and ramps, radians.
    pub ramp_angle: f64,
    /// Whether the cutter may plunge where neither a helix nor a ramp fits.
    pub plunge: bool,
}

/// Closed chains of lines and arcs: a wall, and the islands inside it. Islands may overlap each other and the
/// wall.
#[derive(Debug, Clone, PartialEq)]
pub struct Outlines {
    pub boundary: Vec<Element>,
    pub islands: Vec<Vec<Element>>,
}

#[derive(Debug, Clone)]
pub struct Job {
    pub area: Outlines,
    pub top_z_mm: f64,
    pub floor_z_mm: f64,
    pub stepdown_max_mm: f64,
    pub tool: Tool,
    pub stepover_mm: f64,
    pub patterns: Vec<Pattern>,
    pub choose_by: ChooseBy,
    pub entry: EntryLimits,
    pub milling: Milling,
    pub cutting: CuttingRequest,
    pub resolution: Resolution,
}
