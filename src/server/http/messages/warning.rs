//! Warnings as answers hold them.

use serde::Serialize;
use utoipa::ToSchema;

use crate::http::pointer::Pointer;

/// Something to know before the program runs, which does not stop the job.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct Warning {
    /// What the warning is about, for software: a code that does not change.
    pub code: WarningCode,
    /// What the warning is about, for people.
    pub detail: String,
    /// The member of the request's body that the warning is about: a JSON pointer as URI fragment (RFC 6901).
    /// Absent where the warning is about the result.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(example = "#/region/islands/3")]
    pub pointer: Option<String>,
}

impl Warning {
    /// A warning about the result.
    pub fn new(code: WarningCode, detail: impl Into<String>) -> Self {
        Self { code, detail: detail.into(), pointer: None }
    }

    /// The same warning, about the member at `at`.
    #[must_use]
    pub fn about(self, at: &Pointer) -> Self {
        Self { pointer: Some(at.as_str().to_owned()), ..self }
    }
}

/// What a warning is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum WarningCode {
    /// A direction has fewer points than `not_a_knot` needs, and one polynomial passes through all of them.
    EndsReduced,
    /// The points are closed, and the surface closes smoothly without the caller's word.
    EndsPeriodic,
    /// Rows, columns or points were sent out of order, and were put into order.
    PointsReordered,
    /// Patches leave a gap or meet in a sharp edge.
    NotSmooth,
    /// The surface has, or may have, a place without a normal.
    NoNormal,
    /// The cutter cannot reach all of the surface.
    RestLeft,
    /// Far more material stays than between neighbouring passes.
    StripLeft,
    /// Short pieces of passes are left out, and their material stays.
    ShortPiecesLeftOut,
    /// The part is smaller than the cutter along x and along y.
    PartSmallerThanCutter,
    /// `stock` is absent: rapids come down near the surface.
    StockNotGiven,
    /// Some entries or exits have no room for the requested shape: the cutter moves straight down or up
    /// there.
    EntryNotClear,
    /// The roughing path cuts into the surface; the report bounds the depth.
    RoughingPathGouges,
    /// The tool is too large for some places of the pocket.
    PlacesNotReached,
    /// The stepover is larger than the cutter's radius.
    StepoverNarrowed,
    /// The cutter comes nearer to walls beside its cuts than asked for, where there is no room.
    NarrowForClearance,
    /// On some levels the cutter does not come down at `entry.at`.
    EntryElsewhere,
    /// `choose_by: paper_time` does not bound the load of the cutter.
    LoadNotBounded,
    /// Rounding to the program's decimals may leave the band.
    RoundingLeavesBand,
    /// Rounding to the program's decimals may exceed the tolerance.
    RoundingExceedsTolerance,
    /// The elements are near the points, but not near the lines between the points.
    CoarseSamples,
    /// The largest radius of the control costs elements.
    RadiusLimited,
    /// The requested method ignores the tolerance.
    ToleranceExceeded,
    /// Where the tool axis passes a pole of the machine, the limits of the axes are not proved.
    LimitsNotProved,
    /// The motion takes over 5 % longer than the proved lower bound of its time.
    AboveLowerBound,
    /// The program states the tool axis, and the control chooses the positions of the rotary axes.
    PositionsOfControl,
    /// The cutter is too large for some of the contour.
    ContourNotReached,
    /// The program starts no spindle.
    NoSpindleSpeed,
    /// `tool.number` is absent: the program calls tool 1.
    NoToolNumber,
    /// `program.work_offset` is absent: the program runs with the active work offset.
    NoWorkOffset,
    /// The decimals of F cannot state some feeds closely; those moves run slower.
    FeedRounded,
    /// `tool.length_offset` differs from `tool.number`.
    LengthOffsetDiffers,
    /// Words of `cl` or `nc` change nothing of the answer.
    WordsLeftAlone,
    /// Lengths stand before the first G20 or G21.
    UnitsAssumed,
    /// Numbers have no decimal point, and settings of controls differ on their meaning.
    PointsMissing,
    /// The program pauses for more than a minute.
    LongDwell,
    /// Controls of the dialect disagree on the unit of a pause.
    DwellAssumed,
    /// Places before and after a change of the zero are not related.
    UnrelatedOffsets,
    /// The path under G41 and G42 counts as that of the cutter's centre.
    CompensationAsWear,
    /// The path under G41 and G42 is computed from the radius of the cutter.
    CompensationComputed,
    /// How far above the last peck a drill stops its rapid is assumed.
    PeckClearanceAssumed,
    /// The program runs again and again; one run is read.
    ProgramRepeats,
    /// The two radii of arcs differ, and exact arcs stand for them.
    ArcsMadeExact,
    /// Parts of a file are left out.
    FileLeftOut,
    /// The file states no unit of length.
    FileUnitMissing,
    /// The request states another unit than the file.
    UnitsOverridden,
    /// Loops of a drawing are taken as walls and islands by what lies within what.
    LoopsNested,
    /// Gaps between curves of a drawing are bridged.
    GapsBridged,
    /// Arcs and lines stand for splines and ellipses of a drawing.
    CurvesFitted,
    /// More than two curves of a drawing meet in a place.
    CurvesBranch,
    /// Curves of a drawing make no closed loop.
    OpenCurves,
    /// Points in any order are put into rows.
    PointsGridded,
    /// Whether centres are incremental or absolute was found from the arcs.
    CentersAssumed,
    /// A setting of the control decides what a word means, and one of its values is taken.
    SettingAssumed,
    /// A tapping cycle is taken to follow its feed.
    TappingAssumed,
    /// `cutting.clearance_z_mm` is absent: the service chose a clearance plane above everything that is cut.
    ClearanceChosen,
    /// An arc of an outline turns by more than a half circle.
    BulgeOverHalfCircle,
    /// An island lies wholly outside the wall, and changes nothing.
    IslandOutside,
    /// Another of several regions cuts a part of an island.
    IslandCut,
    /// The region reaches beyond the surface or the heights, and nothing is cut there.
    RegionBeyondPart,
    /// The part stands above the top of the stock.
    StockBelowPart,
    /// A line of the caller's own selects a work offset beside `program.work_offset`.
    WorkOffsetTwice,
    /// The feed in slots is above the feed.
    SlotFeedAboveFeed,
    /// The tolerance is more than a tenth of the cutter's radius.
    ToleranceCoarse,
    /// The program takes more than ten hours.
    LongTime,
    /// The job is deeper than the cutting edges are long.
    ShankBesideWall,
    /// The feed of a cutting edge is far from usual.
    FeedPerTooth,
}

impl WarningCode {
    /// The code as answers hold it, such as `not_smooth`.
    pub fn name(self) -> String {
        serde_json::to_value(self).ok().and_then(|name| name.as_str().map(str::to_owned)).unwrap_or_default()
    }
}
