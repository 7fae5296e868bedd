//! The modal state behind each block that has run.

use toolpathd_core::geometry::plane::Plane;

use super::codes::{FeedMode, Motion, Side};
use super::placement::At;

/// The state of a control behind a block.
#[derive(Debug, Clone, PartialEq)]
pub struct TracedBlock {
    /// Line of the text, counted from 1.
    pub line: u32,
    pub motion: Option<Motion>,
    /// The number of the canned cycle in force.
    pub cycle: Option<u8>,
    pub plane: Plane,
    pub is_in_inches: bool,
    pub is_absolute: bool,
    pub feed_mode: FeedMode,
    /// In mm/min, 1/min or mm per turn, by the mode.
    pub feed: Option<f64>,
    pub speed_rpm: Option<f64>,
    pub is_turning: bool,
    pub tool: Option<u32>,
    pub work_offset: u32,
    pub compensation: Option<Side>,
    /// The programmed place of the tool, mm.
    pub at: At,
}
