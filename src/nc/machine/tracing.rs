//! Records the modal state behind each block.

use super::Machine;
use crate::trace::TracedBlock;

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
