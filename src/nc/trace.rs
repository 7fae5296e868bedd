//! The modal state behind each block that has run.

use toolpathd_core::geometry::plane::Plane;

use super::codes::{FeedMode, Motion};
use super::machine::{At, Machine, Side};

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

impl Machine<'_> {
    /// Records the state behind a block, where the caller has asked for it.
    pub(crate) fn trace(&mut self, line: usize) {
        if self.traced.len() >= self.most_traced() {
            return;
        }
        let block = TracedBlock {
            line: line as u32,
            motion: self.motion,
            cycle: self.cycle_number(),
            plane: self.plane,
            is_in_inches: self.in_inches(),
            is_absolute: self.is_absolute,
            feed_mode: self.feed_mode,
            feed: self.feed,
            speed_rpm: self.speed,
            is_turning: self.is_turning,
            tool: self.tool(),
            work_offset: self.frames.active(),
            compensation: self.compensation_side(),
            at: self.at,
        };
        self.traced.push(block);
    }
}
