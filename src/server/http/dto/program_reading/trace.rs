//! The modal state behind each block of a program, as an answer holds it.

use serde::Serialize;
use utoipa::ToSchema;

use toolpathd_core::geometry::curve::Direction;
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::program::Units;
use toolpathd_nc::codes::{FeedMode, Motion};
use toolpathd_nc::frames;
use toolpathd_nc::machine::Side;
use toolpathd_nc::trace::TracedBlock;

/// The modal state of the control behind a block.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[schema(as = TracedBlock)]
pub struct TracedReport {
    /// Number of the block's line, counted from 1.
    line: u32,
    /// The motion in force. `null` where none is.
    #[schema(required)]
    motion: Option<TracedMotion>,
    /// Number of the canned cycle in force, such as 81. `null` where none is.
    #[schema(required)]
    cycle: Option<u8>,
    /// The plane of arcs.
    plane: TracedPlane,
    /// Unit of lengths.
    units: Units,
    /// Whether coordinates are absolute.
    is_absolute: bool,
    /// What `feed` counts.
    feed_mode: TracedFeed,
    /// The feed: a number of mm/min, of 1/min or of mm per turn, by `feed_mode`. `null` where none is in
    /// force.
    #[schema(required)]
    feed: Option<f64>,
    /// The speed of the spindle, in 1/min. `null` where none was given.
    #[schema(required)]
    spindle_rpm: Option<f64>,
    /// Whether the spindle turns.
    is_spindle_on: bool,
    /// Number of the tool in the spindle. `null` where it is not known.
    #[schema(required)]
    tool: Option<u32>,
    /// The work offset in force.
    work_offset: String,
    /// The side of the contour on which cutter compensation leads the tool. `null` where it is off, and where
    /// the program's path is that of the centre.
    #[schema(required)]
    compensation: Option<TracedSide>,
    /// The programmed place of the tip, in mm: x, y and z, each `null` where it is not known.
    #[schema(value_type = Vec<Option<f64>>, min_items = 3, max_items = 3)]
    at: [Option<f64>; 3],
}

/// A motion in force.
#[derive(Debug, Clone, Copy, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
enum TracedMotion {
    Rapid,
    Line,
    ArcClockwise,
    ArcCounterclockwise,
}

/// A plane of two axes.
#[derive(Debug, Clone, Copy, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
enum TracedPlane {
    Xy,
    Zx,
    Yz,
}

/// What a feed counts.
#[derive(Debug, Clone, Copy, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
enum TracedFeed {
    PerMinute,
    InverseTime,
    PerTurn,
}

/// A side of a contour, seen along the way of the tool.
#[derive(Debug, Clone, Copy, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
enum TracedSide {
    Left,
    Right,
}

impl From<&TracedBlock> for TracedReport {
    fn from(block: &TracedBlock) -> Self {
        Self {
            line: block.line,
            motion: block.motion.map(|motion| match motion {
                Motion::Rapid => TracedMotion::Rapid,
                Motion::Line => TracedMotion::Line,
                Motion::Arc(Direction::Cw) => TracedMotion::ArcClockwise,
                Motion::Arc(Direction::Ccw) => TracedMotion::ArcCounterclockwise,
            }),
            cycle: block.cycle,
            plane: match block.plane {
                Plane::Xy => TracedPlane::Xy,
                Plane::Zx => TracedPlane::Zx,
                Plane::Yz => TracedPlane::Yz,
            },
            units: if block.is_in_inches { Units::Inch } else { Units::Mm },
            is_absolute: block.is_absolute,
            feed_mode: match block.feed_mode {
                FeedMode::PerMinute => TracedFeed::PerMinute,
                FeedMode::InverseTime => TracedFeed::InverseTime,
                FeedMode::PerTurn => TracedFeed::PerTurn,
            },
            feed: block.feed,
            spindle_rpm: block.speed_rpm,
            is_spindle_on: block.is_turning,
            tool: block.tool,
            work_offset: frames::name(block.work_offset),
            compensation: block.compensation.map(|side| match side {
                Side::Left => TracedSide::Left,
                Side::Right => TracedSide::Right,
            }),
            at: block.at,
        }
    }
}
