//! Clears a pocket level by level, each with the pattern that takes the least time (Ryu, Kang, Jeon).
//!
//! # Method
//! 1. The pocket is divided into levels (`level`). The pocket of a level comes from outlines, from measured
//!    heights or from a surface (`part`, `labelling`). The cutter's centre may be in the pocket, offset
//!    inward by the radius and the allowance.
//! 2. Each pattern first clears all but a layer about one stepover thick along walls and islands. It makes
//!    chains of lines and arcs (`rings`, `islands`, `rows`, `strips`), or follows the edge of the material
//!    (`engagement`). Then the layer is cut along walls and islands, with leads (`walls`). The `router` joins
//!    the chains: it chooses where loops begin, links them, lifts, and comes down into the material
//!    (`entry`), first at the place that the job names (`entry_place`). It knows the angle of the cutter in
//!    the material all along ([`engagement`](crate::machining::engagement)). What earlier tools have emptied
//!    counts as cut before the first move (`cleared`); then only the parts of chains that meet material are
//!    cut (`pieces`).
//! 3. Each route is checked for what it leaves, for gouges and for links through material (`check`).
//! 4. On each level the route with the least time among those that pass the check is taken (`choice`). The
//!    feed goes down where the angle of the cutter in the material is large (`feeds`), so such places take
//!    their time.
//! 5. Walls and floor are finished (`finish`).
//! 6. Steps 1 to 5 plan one area (`area`). Several regions make areas that have nothing in common
//!    (`regions`), and each area is planned alone. Their paths become one toolpath (`join`).
//!
//! # Guarantees
//! * Where the room is wide enough, only passes along walls and islands and their leads touch these, or come
//!   nearer to them than the clearance beside the cut.
//! * At the full feed the cutter is in the material by at most 1.1 times the angle of a straight pass, except
//!   with the paper's time as the figure.
//! * The cutter is never nearer to a wall than its radius, except for rounding; `gouge_max_mm` bounds this
//!   after rounding to the program's decimals. With `labelling` this holds for the walls of the cells, and
//!   the path may cut into the part.
//! * Links and rapids never run through material. Below the top of the material rapids go straight up, or
//!   straight down where the floor is cleared. Nothing is cut deeper than the stepdown.
//! * The paths of `island_stock_offset`, `zigzag_stock_offset` and the rows free all that the tool can
//!   reach. Whatever a path leaves is in the report.
//!
//! # Degenerate input
//! Islands may overlap, touch the wall or lie closer to each other than the tool. A tool that fits nowhere
//! is refused with the largest that fits; so is a tool that cannot enter where plunging is not allowed.
//!
//! # Differences from the paper
//! * The paper's time has no plunges and no slower slots. It is reported, and may be chosen by; the default
//!   is the time with both.
//! * Patterns without a pass along the walls leave material there and then win by not doing the work. Every
//!   pattern here ends with such a pass.
//!
//! # Reference
//! J. Ryu, S. Kang, Y. Jeon, *The minimum time pocketing cycle for the workshop oriented programming*.

mod area;
mod candidate;
mod chain;
mod check;
mod choice;
mod cleared;
mod conditions;
mod crossings;
mod depth;
mod doubts;
mod engagement;
mod entry;
mod entry_place;
mod feeds;
mod finish;
mod growth;
mod islands;
mod job;
mod join;
mod labelling;
mod leads;
mod level;
mod links;
mod opened;
mod outlines;
mod part;
mod path;
mod pieces;
mod regions;
mod report;
mod rings;
mod router;
mod rows;
mod strips;
mod walls;
mod work;

use nalgebra::Point2;

use crate::budget::{Budget, Stopped};
use crate::geometry::height_field::HeightFieldError;
use crate::geometry::region::{OutlineError, RegionError};
use crate::geometry::surface::source::SourceError;
use crate::toolpath::Toolpath;
use crate::toolpath::cutting::{Cutting, HeightError};
use crate::toolpath::path::PathError;
use crate::toolpath::quantize::QuantizeError;
use crate::toolpath::units::rounded_up;
use area::Area;
pub use check::{Exception, Invalid};
pub use doubts::{Doubt, doubts};
pub use job::{
    ChooseBy, Emptied, EntryLimits, Finish, FinishFloor, FinishWalls, IslandsBy, Job, Lead, LeadKind,
    LevelOrder, Load, Milling, Only, Outlines, Pattern, Regions, Relief, Sequence, Standing,
};
pub use labelling::MOST_CELLS;
pub use level::{Island, MOST_LEVELS, MOST_RADII, Uncut};
pub use report::{Candidate, LevelOutlines, LevelReport, Report};

/// A planned pocket.
#[derive(Debug, Clone)]
pub struct Plan {
    pub toolpath: Toolpath,
    pub report: Report,
    /// Of each level of the report.
    pub outlines: Vec<LevelOutlines>,
    /// In the order of the passes.
    pub starts: Vec<LevelStart>,
    pub cutting: Cutting,
    /// The height of the stock's top or of the part's highest point, whichever is higher, mm.
    pub highest_mm: f64,
    pub warnings: Vec<Warning>,
}

/// Where the passes of a level begin, or the passes that finish walls over one depth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LevelStart {
    /// The index of the first pass in the toolpath.
    pub pass: usize,
    /// The index of the level in the report.
    pub level: usize,
    /// The height to which the passes go, mm.
    pub z_mm: f64,
    /// The pattern of the level; none where walls are finished.
    pub pattern: Option<Pattern>,
}

/// Something about the plan that the operator should know.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Warning {
    #[error("the tool cannot reach {count} places of the pocket, which stay uncut; the largest has {:.1} mm2, near ({:.3}, {:.3})", largest.area_mm2, largest.at.x, largest.at.y)]
    PlacesNotReached { count: usize, largest: Uncut },
    #[error(
        "the stepover is larger than the cutter's radius: rings lie closer where they would leave material"
    )]
    StepoverNarrowed,
    #[error(
        "the tool comes within {kept_mm:.3} mm of a wall or an island beside its cuts, where {asked_mm:.3} mm do not fit"
    )]
    NarrowForClearance { kept_mm: f64, asked_mm: f64 },
    #[error(
        "patterns are compared by the paper's time: slots are cut at the full feed, unless a feed for slots is given"
    )]
    LoadNotBounded,
    #[error(
        "on {count} of {of} levels, first at {z_mm} mm, the cutter does not come down at the chosen place: the place is outside there, has no room for an entry, or needs none"
    )]
    EntryElsewhere { count: usize, of: usize, z_mm: f64 },
    #[error("islands by labelling are as coarse as the grid, and the path cuts up to {:.4} mm into the part", rounded_up(*gouge_mm))]
    IslandsByLabelling { gouge_mm: f64 },
}

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PocketError {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    #[error(transparent)]
    Heights(#[from] HeightError),
    #[error(transparent)]
    Region(RegionError),
    #[error(transparent)]
    Quantize(#[from] QuantizeError),
    #[error(transparent)]
    Path(#[from] PathError),
    #[error("{}{error}", island.map_or_else(String::new, |k| format!("island {k}: ")))]
    Outline { island: Option<usize>, error: OutlineError },
    #[error(
        "nothing is left to cut: islands fill the pocket, earlier tools have emptied it, or on every level the part is higher than the level's floor"
    )]
    NothingToCut,
    #[error("the floor at {floor_mm} mm is not below the top at {top_mm} mm")]
    FloorNotBelowTop { floor_mm: f64, top_mm: f64 },
    #[error(transparent)]
    Surface(SourceError),
    #[error(transparent)]
    Relief(HeightFieldError),
    #[error("emptied place {index}{}: {error}", island.map_or_else(String::new, |k| format!(", island {k}")))]
    Cleared { index: usize, island: Option<usize>, error: OutlineError },
    #[error("emptied place {index} is empty, because its islands fill it")]
    ClearedEmpty { index: usize },
    #[error("the outlines need more than {limit} lines and arcs within {within_mm} mm")]
    OutlinesTooFine { limit: usize, within_mm: f64 },
    #[error("labelling needs more than {limit} cells")]
    TooManyCells { limit: usize },
    #[error(
        "the tool of {diameter_mm} mm fits nowhere in the pocket; the largest that fits has {largest_mm:.3} mm, near {at}"
    )]
    ToolTooLarge { diameter_mm: f64, largest_mm: f64, at: Point2<f64> },
    #[error(
        "near {at} neither a helix of {least_mm} mm nor a ramp fits, and a plunge is not allowed; a tool of at most {largest_mm:.3} mm has room"
    )]
    NoEntry { at: Point2<f64>, least_mm: f64, largest_mm: f64 },
    #[error(
        "the place of the entry at {at} is {by_mm:.3} mm outside of where the cutter's centre may come down"
    )]
    EntryOutside { at: Point2<f64>, by_mm: f64 },
    #[error(
        "at {at}, the place of the entry, a helix has room for {room_mm:.3} mm and needs {least_mm} mm, and a plunge is not allowed"
    )]
    EntryTooNarrow { at: Point2<f64>, room_mm: f64, least_mm: f64 },
    #[error("the pocket needs more than {limit} {what}")]
    TooMuchWork { what: &'static str, limit: usize },
    #[error("no pattern passes the check; the first one fails because {because}")]
    NoneValid { because: String },
    #[error("{}: {error}", named(regions))]
    OfRegions { regions: Vec<usize>, error: Box<PocketError> },
}

/// Regions by their indices; several are cut as one.
fn named(regions: &[usize]) -> String {
    let indices: Vec<String> = regions.iter().map(usize::to_string).collect();
    match regions {
        [only] => format!("region {only}"),
        _ => format!("regions {} as one", indices.join(", ")),
    }
}

impl From<RegionError> for PocketError {
    fn from(error: RegionError) -> Self {
        match error {
            RegionError::Stopped(stopped) => Self::Stopped(stopped),
            other => Self::Region(other),
        }
    }
}

/// Plans the pocket.
///
/// # Errors
/// One of [`PocketError`].
///
/// # Example
/// A cutter of radius 5 mm clears a rectangular pocket, except for its four corners.
///
/// ```
/// use std::f64::consts::PI;
/// use nalgebra::Point2;
/// use toolpathd_core::budget::Budget;
/// use toolpathd_core::geometry::segment::Segment;
/// use toolpathd_core::operations::pocketing::{Job, Outlines, plan};
/// use toolpathd_core::toolpath::tool::{Shape, Tool};
/// use toolpathd_core::toolpath::units::FeedRate;
///
/// let corner = [[0.0, 0.0], [60.0, 0.0], [60.0, 40.0], [0.0, 40.0]].map(Point2::from);
/// let side = |k: usize| Segment::Line { start: corner[k], end: corner[(k + 1) % 4] };
/// let area = Outlines { boundary: (0..4).map(side).collect(), islands: Vec::new() };
/// let tool = Tool { shape: Shape::Flat, ..Tool::ball(5.0) };
/// let job = Job::new(area, -4.0, tool, 3.0, FeedRate::from_mm_per_min(800.0).unwrap());
/// let report = plan(&job, &Budget::unlimited()).unwrap().report;
/// // In each corner a square of 5 mm stays, without a quarter of a circle.
/// assert!((report.uncut_area_mm2 - 4.0 * 25.0 * (1.0 - PI / 4.0)).abs() < 0.01);
/// assert!(report.gouge_max_mm < 0.001);
/// ```
pub fn plan(job: &Job, budget: &Budget) -> Result<Plan, PocketError> {
    match &job.regions {
        Some(regions) => regions::plan(job, regions, budget),
        None => join::alone(job, Area::new(job, None, budget)?, budget),
    }
}

/// A distance from walls that is less than asked for by no more is rounding, mm.
const SIDE_ACCURACY_MM: f64 = 1e-5;

fn warnings(job: &Job, report: &Report) -> Vec<Warning> {
    let mut warnings = Vec::new();
    let places = || report.levels.iter().flat_map(|level| &level.not_reached);
    if let Some(largest) = places().copied().reduce(|a, b| if b.area_mm2 > a.area_mm2 { b } else { a }) {
        warnings.push(Warning::PlacesNotReached { count: places().count(), largest });
    }
    if job.stepover_mm > job.tool.radius_mm {
        warnings.push(Warning::StepoverNarrowed);
    }
    if job.load() == Load::Paper {
        warnings.push(Warning::LoadNotBounded);
    }
    let asked_mm = job.side_mm();
    if let Some(kept_mm) = report.clearance_side_mm.filter(|kept| *kept < asked_mm - SIDE_ACCURACY_MM) {
        warnings.push(Warning::NarrowForClearance { kept_mm, asked_mm });
    }
    if job.relief.is_some() && matches!(job.islands_by, IslandsBy::Labelling { .. }) {
        warnings.push(Warning::IslandsByLabelling { gouge_mm: report.gouge_max_mm });
    }
    warnings
}
