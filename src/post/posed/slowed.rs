//! The times of blocks under G93, within what a control reads.

use crate::WriteError;
use crate::dialect::Numbers;
use crate::words::{self, FeedWord};

/// The longest time of a block, s: F0.001 is the least that Fanuc's manuals give. A longer motion is halved.
pub const LONGEST_S: f64 = 60_000.0;

/// Blocks that are too short for the largest F.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Slowed {
    pub blocks: usize,
    /// How much longer they take in all, s.
    pub by_s: f64,
}

impl Slowed {
    /// The F word of a block: one by its minutes. A block too short for `most`, the largest F, takes longer.
    pub fn inverse_time(
        &mut self,
        seconds: f64,
        most: u32,
        numbers: &Numbers,
    ) -> Result<FeedWord, WriteError> {
        let least_s = 60.0 / f64::from(most);
        if seconds < least_s {
            self.blocks += 1;
            self.by_s += least_s - seconds;
            return Ok(FeedWord { digits: most.into(), decimals: 0 });
        }
        words::per_minute(60.0 / seconds, numbers).ok_or(WriteError::InverseTime { seconds })
    }
}
