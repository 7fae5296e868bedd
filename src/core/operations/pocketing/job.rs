//! The pocketing job: the area, the heights, the tool, and what is left to choose.

use nalgebra::Point2;

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

/// How far moves beside the cut keep away from walls where nothing is given, as a part of the cutter's
/// diameter, and at least, mm.
const SIDE: f64 = 0.02;
const LEAST_SIDE_MM: f64 = 0.2;

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

/// How the feed follows the load of the cutter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Load {
    /// Passes lie a stepover apart, those along the walls included. Where the angle of the cutter in the
    /// material is larger than on a straight pass, the feed goes down.
    Bounded,
    /// The paper's passes, which may be slots, at one feed unless a feed for slots is given.
    Paper,
}

/// How the cutter comes to a wall and leaves it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "wire", derive(serde::Deserialize, utoipa::ToSchema), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "wire", schema(as = LeadKind))]
pub enum LeadKind {
    /// On a quarter of a circle that touches the wall.
    #[default]
    Arc,
    /// Straight to the wall and away from it.
    Line,
    /// The cutter comes down beside the wall.
    None,
}

/// How passes along walls and islands begin and end.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Lead {
    pub kind: LeadKind,
    /// The radius of the arc, or the length of the line, mm. Default: half of the cutter's radius, and at
    /// least what the pass cuts. Where it does not fit, it is as large as fits.
    pub radius_mm: Option<f64>,
    /// How far a closed pass goes on beyond its start, mm. Default: a tenth of the cutter's diameter.
    pub overlap_mm: Option<f64>,
}

/// The passes that bring walls and islands to their size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FinishWalls {
    /// How many passes share the allowance.
    pub passes: u32,
    /// What each pass but the first takes, mm. Default: equal parts of the allowance.
    pub stepover_mm: Option<f64>,
    /// The largest depth of a pass, mm. Default: the whole depth.
    pub stepdown_mm: Option<f64>,
    /// Default: the feed.
    pub feed: Option<FeedRate>,
    /// How often the last pass is followed again.
    pub spring_passes: u32,
}

/// The level that takes the allowance off the floor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FinishFloor {
    /// Default: the stepover of the job.
    pub stepover_mm: Option<f64>,
    /// Default: the feed.
    pub feed: Option<FeedRate>,
}

/// What is done with the allowances.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Finish {
    pub walls: Option<FinishWalls>,
    pub floor: Option<FinishFloor>,
}

/// Which part of the work is done.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "wire", derive(serde::Deserialize, utoipa::ToSchema), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "wire", schema(as = PocketPart))]
pub enum Only {
    Roughing,
    Finishing,
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
    /// Where the cutter comes down first in the connected part that has this place; none leaves the choice
    /// to the planner. The centre of the helix, or of the hole.
    pub at: Option<Point2<f64>>,
    /// Whether a hole is drilled at this place down to the floor, into which the cutter goes straight down.
    pub is_predrilled: bool,
}

/// Closed chains of lines and arcs: a wall, and the islands inside it. Islands may overlap each other and the
/// wall.
#[derive(Debug, Clone, PartialEq)]
pub struct Outlines {
    pub boundary: Vec<Segment>,
    pub islands: Vec<Vec<Segment>>,
}

/// Where material stands before the first cut.
#[derive(Debug, Clone, PartialEq)]
pub struct Standing {
    /// In plan, with holes as islands.
    pub outlines: Outlines,
    pub bottom_z_mm: f64,
}

/// The order in which the levels of several regions are cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "wire", derive(serde::Deserialize, utoipa::ToSchema), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "wire", schema(as = PocketOrder))]
pub enum LevelOrder {
    /// All levels of a region and its finishing passes come before the next region.
    #[default]
    DepthFirst,
    /// Each level of all regions comes before the next level; the finishing passes of all regions come last.
    LevelFirst,
}

/// The sequence of several regions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "wire", derive(serde::Deserialize, utoipa::ToSchema), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "wire", schema(as = PocketSequence))]
pub enum Sequence {
    /// The sequence with short rapids from region to region, which is never longer than the order of the
    /// list.
    #[default]
    LeastTravel,
    /// The order of the list.
    AsGiven,
}

/// Several regions that are cleared down to the same floor. Regions that overlap, or touch along a stretch,
/// are cut as one.
#[derive(Debug, Clone, PartialEq)]
pub struct Regions {
    pub all: Vec<Outlines>,
    pub order: LevelOrder,
    pub sequence: Sequence,
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
    /// The wall and the islands of the pocket. None, with a relief only, stands for the edge of the relief;
    /// with several regions it is none.
    pub area: Option<Outlines>,
    /// The elements of the wall that are open: there the cutter may go beyond the wall, into the air.
    pub open: Vec<Segment>,
    /// The raw part. None: material all over the pocket.
    pub stock: Option<Standing>,
    /// Several regions in place of one area. They have upright walls, so there is no relief.
    pub regions: Option<Regions>,
    pub relief: Option<Relief>,
    pub islands_by: IslandsBy,
    pub cleared: Vec<Emptied>,
    /// The height of the stock's top, mm. None stands for the highest point of the relief, or for 0 without a
    /// relief.
    pub top_z_mm: Option<f64>,
    pub floor_z_mm: f64,
    pub stepdown_max_mm: f64,
    /// What stays on walls and islands before finishing, mm.
    pub allowance_mm: f64,
    /// What stays on the floor before finishing, mm.
    pub floor_allowance_mm: f64,
    pub finish: Finish,
    /// Roughing or finishing alone; none for both.
    pub only: Option<Only>,
    pub lead: Lead,
    /// How far entries, lifts, links and rapids keep away from walls and islands, mm. None stands for
    /// a fiftieth of the cutter's diameter, and at least 0.2 mm.
    pub clearance_side_mm: Option<f64>,
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
    /// The most comparisons of the cutter with earlier cuts, of one pattern. Several regions share them by
    /// their sizes. The shapes of all levels share them evenly, and a pattern that needs more for a shape is
    /// left out. 15 to 35 million took a second on one core.
    pub comparison_limit: u64,
}

impl EntryLimits {
    /// The limits for a cutter where none are given.
    pub fn of(diameter_mm: f64) -> Self {
        Self {
            max_diameter_mm: WIDEST_HELIX * diameter_mm,
            min_diameter_mm: NARROWEST_HELIX * diameter_mm,
            ramp_angle: RAMP_DEG.to_radians(),
            plunge: false,
            at: None,
            is_predrilled: false,
        }
    }
}

impl Job {
    /// How the feed follows the load.
    pub fn load(&self) -> Load {
        if self.choose_by == ChooseBy::PaperTime { Load::Paper } else { Load::Bounded }
    }

    /// The job of the level that takes the allowance off the floor; none without such a level.
    pub fn finishing_floor(&self) -> Option<Self> {
        let floor = self.finish.floor.filter(|_| self.only != Some(Only::Roughing))?;
        let mut job = self.clone();
        job.stepover_mm = floor.stepover_mm.unwrap_or(self.stepover_mm);
        job.cutting.feed = floor.feed.unwrap_or(self.cutting.feed);
        Some(job)
    }

    /// The passes that bring walls and islands to their size; none without such passes.
    pub fn finishing_walls(&self) -> Option<FinishWalls> {
        self.finish.walls.filter(|_| self.only != Some(Only::Roughing))
    }

    /// How far entries, lifts, links and rapids keep away from walls and islands, mm.
    pub fn side_mm(&self) -> f64 {
        let usual = (SIDE * 2.0 * self.tool.radius_mm).max(LEAST_SIDE_MM);
        self.clearance_side_mm.unwrap_or(usual)
    }

    /// The job with the default of everything that has one: a pocket with upright walls, cleared in one level
    /// from 0 down to the floor, and written in mm with three decimals for a control that runs all arcs.
    pub fn new(area: Outlines, floor_z_mm: f64, tool: Tool, stepover_mm: f64, feed: FeedRate) -> Self {
        Self {
            area: Some(area),
            open: Vec::new(),
            stock: None,
            regions: None,
            relief: None,
            islands_by: IslandsBy::default(),
            cleared: Vec::new(),
            top_z_mm: None,
            floor_z_mm,
            stepdown_max_mm: -floor_z_mm,
            allowance_mm: 0.0,
            floor_allowance_mm: 0.0,
            finish: Finish::default(),
            only: None,
            lead: Lead::default(),
            clearance_side_mm: None,
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
