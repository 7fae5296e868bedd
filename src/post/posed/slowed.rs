//! The times of blocks under G93, and the feeds of turns by the minute, within what a control reads.

use crate::WriteError;
use crate::coarse::CLOSE;
use crate::dialect::Numbers;
use crate::words::{self, FeedWord};

/// The longest time of a block, s: F0.001 is the least that Fanuc's manuals give. A longer motion is halved.
pub const LONGEST_S: f64 = 60_000.0;

/// No turn is shorter, s, so that its feed is a number.
const SHORTEST_S: f64 = 1e-9;

/// Digits of the largest feed of a turn, at most.
const LARGEST_DIGITS: u32 = 9;

/// Blocks that take longer than they should, because of what F can state.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Slowed {
    /// Blocks that are too fast for the largest F.
    pub blocks: usize,
    /// How much longer they take in all, s.
    pub by_s: f64,
    /// Blocks whose own feed, which no move of the toolpath has, is too slow for the decimals of F.
    pub coarse: usize,
    /// How much longer they take in all, s.
    pub coarse_by_s: f64,
}

impl std::iter::Sum for Slowed {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::default(), |a, b| Self {
            blocks: a.blocks + b.blocks,
            by_s: a.by_s + b.by_s,
            coarse: a.coarse + b.coarse,
            coarse_by_s: a.coarse_by_s + b.coarse_by_s,
        })
    }
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
        words::per_minute(60.0 / seconds, numbers.max_feed_decimals)
            .ok_or(WriteError::InverseTime { seconds })
    }

    /// The F word of a turn in degrees by the minute. A turn too fast for the largest F takes longer.
    pub fn degrees_per_minute(
        &mut self,
        degrees: f64,
        seconds: f64,
        numbers: &Numbers,
    ) -> Result<FeedWord, WriteError> {
        let most = (10u64.pow(numbers.max_whole_digits.min(LARGEST_DIGITS)) - 1) as f64;
        let rate = 60.0 * degrees / seconds.max(SHORTEST_S);
        if rate > most {
            self.blocks += 1;
            self.by_s += 60.0 * degrees / most - seconds;
            return Ok(FeedWord { digits: most as i64, decimals: 0 });
        }
        let decimals = numbers.max_feed_decimals;
        let word = words::per_minute(rate, decimals).or_else(|| self.at_most(rate, decimals, seconds));
        word.ok_or(WriteError::Feed { mm_per_min: rate })
    }

    /// The F word for at most a value by the minute, of a block that should take some seconds.
    pub fn at_most(&mut self, value: f64, decimals: u8, seconds: f64) -> Option<FeedWord> {
        let word = words::per_minute_at_most(value, decimals)?;
        if word.value() < (1.0 - CLOSE) * value {
            self.coarse += 1;
            self.coarse_by_s += seconds * (value / word.value() - 1.0);
        }
        Some(word)
    }
}
