//! The feeds of blocks: by the minute, or by their times, and so slow that no axis is too fast.

use super::super::block::{AxisWords, BlockFeed};
use super::super::dialect::{AxisOutput, Turns};
use super::super::words;
use super::{Lowering, WriteError, axis_of};
use toolpathd_core::toolpath::tool_axes::angle_between;
use toolpathd_core::toolpath::units::FeedRate;

/// A block takes longer than its motion by at most this part, where rounding makes it longer.
const LONGER: f64 = 0.01;

impl Lowering<'_> {
    /// The feed of a block along a way that should take `own_s`: no axis takes less than `least_s`. `None`
    /// where the feed would be too slow for a word and the block may state its time.
    pub(super) fn per_minute(
        &mut self,
        rate: FeedRate,
        length_mm: f64,
        own_s: f64,
        least_s: f64,
    ) -> Result<Option<BlockFeed>, WriteError> {
        let (units, numbers) = (self.job.program.resolution.units, &self.job.dialect.numbers);
        let written_s = length_mm / rate.mm_per_s();
        // Blocks of few units of the last decimal are longer or shorter than their motions. Where the axes
        // are the limit, they take the time of the motions.
        if written_s >= least_s && (least_s == 0.0 || written_s <= (1.0 + LONGER) * own_s) {
            return words::feed(rate, units, numbers).map(|feed| Some(BlockFeed::PerMinute(feed)));
        }
        let mm_per_min = 60.0 * length_mm / least_s.max(own_s);
        let decimals = numbers.feed_decimals(units);
        match self.slowed.at_most(mm_per_min / units.mm(), decimals, least_s.max(own_s)) {
            Some(feed) => {
                self.capped_s += (least_s - own_s).max(0.0);
                Ok(Some(BlockFeed::PerMinute(feed)))
            }
            None if self.has_time() => Ok(None),
            None => Err(WriteError::Feed { mm_per_min }),
        }
    }

    /// The feed of a block by its time. No axis takes less than `least_s`.
    pub(super) fn of_time(
        &mut self,
        own_s: f64,
        least_s: f64,
        ends: [AxisWords; 2],
    ) -> Result<BlockFeed, WriteError> {
        self.capped_s += (least_s - own_s).max(0.0);
        let seconds = own_s.max(least_s);
        let numbers = &self.job.dialect.numbers;
        Ok(match self.job.dialect.five_axes.turns {
            Turns::InverseTime { most } => {
                BlockFeed::InverseTime(self.slowed.inverse_time(seconds, most, numbers)?)
            }
            Turns::DegreesPerMinute => {
                let degrees = self.degrees(ends);
                BlockFeed::DegreesPerMinute(self.slowed.degrees_per_minute(degrees, seconds, numbers)?)
            }
        })
    }

    /// The shortest time in which all axes run from the position as last written to another, s. It is zero
    /// where no positions are written.
    pub(super) fn least_s(&self, to: [i64; 3], axis: AxisWords) -> f64 {
        let ends = (self.positions(self.at, self.axis), self.positions(to, axis), self.five.machine);
        let (Some(from), Some(to), Some(machine)) = ends else { return 0.0 };
        let ways = match self.five.output {
            AxisOutput::Machine => {
                let [x, y, z] = [0, 1, 2].map(|k| (to.linear_mm[k] - from.linear_mm[k]).abs());
                let [first, second] = [0, 1].map(|k| (to.rotary[k] - from.rotary[k]).abs());
                [x, y, z, first, second]
            }
            // The control keeps the tip on its line.
            AxisOutput::Angles | AxisOutput::Vectors | AxisOutput::Rails => {
                machine.ways([from.linear_mm.into(), to.linear_mm.into()], [from.rotary, to.rotary])
            }
        };
        ways.iter().zip(self.five.speeds).map(|(way, speed)| way / speed).fold(0.0, f64::max)
    }

    /// How far a turn about a resting tip goes, degrees: both rotary axes together, or the tool axis where
    /// vectors are written.
    fn degrees(&self, [from, to]: [AxisWords; 2]) -> f64 {
        match (from, to) {
            (AxisWords::Angles(from), AxisWords::Angles(to)) => {
                let scale = 10f64.powi(i32::from(self.job.dialect.five_axes.angle_decimals));
                let turned = [0, 1].map(|k| (to[k] - from[k]) as f64 / scale);
                turned[0].hypot(turned[1])
            }
            (AxisWords::Vector(from), AxisWords::Vector(to)) => {
                let [from, to] = [from, to].map(axis_of);
                angle_between(&from, &to).to_degrees()
            }
            _ => 0.0,
        }
    }
}
