//! The pocketing job: the area, the heights, the tool, and what is left to choose.

use crate::geometry::curve::Curve;
use crate::geometry::height_field::HeightGrid;
use crate::geometry::segment::Segment;
use crate::geometry::surface::source::Source;
use crate::toolpath::cutting::CuttingRequest;
use crate::toolpath::program::{Resolution, Units};
use crate::toolpath::quantize::Curves;
use crate::toolpath::tool::Tool;
use crate::toolpath::units::FeedRate;

/// The diameters of helices where none are given, as parts of the cutter's diameter. The widest leaves no
/// core.
const NARROWEST_HELIX: f64 = 0.25;
const WIDEST_HELIX: f64 = 0.9;

/// The angle of helices and ramps where none is given, degrees.
const RAMP_DEG: f64 = 5.0;

/// The most moves and the most comparisons of a job whose caller sets no limits.
const DEFAULT_MOVE_LIMIT: usize = 500_000;
const DEFAULT_COMPARISON_LIMIT: u64 = 400_000_000;

/// A way to clear a level. All but `engagement` have a pass along walls and islands of their own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize, utoipa::ToSchema))]
#[cfg_attr(feature = "wire", serde(rename_all = "snake_case"))]
pub enum Pattern {
    /// Rings about the islands, outward.
    IslandOffset,
    /// Rings beside the wall and the islands at once.
    IslandStockOffset,
    /// Rows to and fro up to walls and islands.
    ZigzagOffset,
    /// Rows to and fro only where the pass along walls and islands leaves material.
    ZigzagStockOffset,
    /// Rows up to the wall that go around islands and on.
    ContinuousOffset,
    /// Rows that go around islands and on, and end inside the pass along the wall.
    ContinuousStockOffset,
    /// Passes whose angle in the material is bounded. All other patterns are from the paper.
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

/// The figure by which a pattern is chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "wire", derive(serde::Deserialize, utoipa::ToSchema), serde(rename_all = "snake_case"))]
pub enum ChooseBy {
    /// The time of all moves at their feeds, entries and slots included.
    #[default]
    Time,
    /// The paper's time: cutting length by feed, and rapid length by traverse rate.
    PaperTime,
    /// The estimated time on a machine that accelerates and brakes.
    TimeWithAcceleration,
}

/// The side on which the material is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "wire", derive(serde::Deserialize, utoipa::ToSchema), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "wire", schema(as = MillingDirection))]
pub enum Milling {
    /// On the right, seen along the feed: a cutter that turns clockwise comes out of the material at its
    /// surface.
    #[default]
    Climb,
    /// On the left.
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
    pub boundary: Vec<Segment>,
    pub islands: Vec<Vec<Segment>>,
}

/// The heights of a part that has more than a flat floor and upright walls.
#[derive(Debug, Clone, PartialEq)]
pub enum Relief {
    Grid(HeightGrid),
    Surface(Source),
}

/// How the islands of a level are found in a relief.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum IslandsBy {
    /// From the level curves of the height field.
    #[default]
    Slicing,
    /// From the cells of a grid that are higher than the level, as in the paper. For a surface, the cells
    /// have this size, mm. For measured heights, the cells are those of their own grid.
    Labelling { cell_mm: f64 },
}

/// What an earlier tool has emptied.
#[derive(Debug, Clone, PartialEq)]
pub enum Emptied {
    /// Down to the floor of the pocket.
    Region(Outlines),
    /// All that a flat cutter has swept along a path.
    Path { along: Vec<Curve>, radius_mm: f64 },
}

#[derive(Debug, Clone)]
pub struct Job {
    /// The wall and the islands of the pocket. None, with a relief only, stands for the edge of the relief.
    pub area: Option<Outlines>,
    pub relief: Option<Relief>,
    pub islands_by: IslandsBy,
    pub cleared: Vec<Emptied>,
    /// The height of the stock's top, mm. None stands for the highest point of the relief, or for 0 without a
    /// relief.
    pub top_z_mm: Option<f64>,
    pub floor_z_mm: f64,
    pub stepdown_max_mm: f64,
    /// The thickest material that a level may leave on a relief, mm.
    pub roughing_allowance_mm: Option<f64>,
    pub tool: Tool,
    pub stepover_mm: f64,
    pub patterns: Vec<Pattern>,
    pub choose_by: ChooseBy,
    pub entry: EntryLimits,
    pub milling: Milling,
    pub cutting: CuttingRequest,
    pub resolution: Resolution,
    /// What the control of the written program runs.
    pub curves: Curves,
    /// A pocket that needs more moves is refused.
    pub move_limit: usize,
    /// The most comparisons of the cutter with earlier cuts, of one pattern. The shapes of all levels
    /// share them evenly, and a pattern that needs more for a shape is left out. 15 to 35 million took a
    /// second on one core.
    pub comparison_limit: u64,
}

impl EntryLimits {
    /// The limits for a cutter where none are given.
    pub fn of(diameter_mm: f64) -> Self {
        Self {
            max_diameter_mm: WIDEST_HELIX * diameter_mm,
            min_diameter_mm: NARROWEST_HELIX * diameter_mm,
            ramp_angle: RAMP_DEG.to_radians(),
            plunge: true,
        }
    }
}

impl Job {
    /// The job with the default of everything that has one: a pocket with upright walls, cleared in one level
    /// from 0 down to the floor, and written in mm with three decimals for a control that runs all arcs.
    pub fn new(area: Outlines, floor_z_mm: f64, tool: Tool, stepover_mm: f64, feed: FeedRate) -> Self {
        Self {
            area: Some(area),
            relief: None,
            islands_by: IslandsBy::default(),
            cleared: Vec::new(),
            top_z_mm: None,
            floor_z_mm,
            stepdown_max_mm: -floor_z_mm,
            roughing_allowance_mm: None,
            tool,
            stepover_mm,
            patterns: Pattern::ALL.to_vec(),
            choose_by: ChooseBy::default(),
            entry: EntryLimits::of(2.0 * tool.radius_mm),
            milling: Milling::default(),
            cutting: CuttingRequest::at_feed(feed),
            resolution: Resolution { units: Units::Mm, decimals: 3 },
            curves: Curves::ARCS,
            move_limit: DEFAULT_MOVE_LIMIT,
            comparison_limit: DEFAULT_COMPARISON_LIMIT,
        }
    }
}
