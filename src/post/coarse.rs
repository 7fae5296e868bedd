//! The feeds of a toolpath that the decimals of a control cannot state closely. Their words are slower, and
//! the program says so.

use super::dialect::{AxisOutput, Dialect};
use super::words;
use toolpathd_core::toolpath::Toolpath;
use toolpathd_core::toolpath::path::Move;
use toolpathd_core::toolpath::program::Units;

/// The part by which a written feed may be slower than its move asks for without a word about the difference.
/// People set the override of a control in steps of 5 % or 10 %, so nobody sees 1 %.
pub const CLOSE: f64 = 0.01;

/// Feeds that are written more than 1 % too slow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoarseFeeds {
    pub moves: usize,
    /// The feed that is farthest from its word, mm/min, and what its word states, mm/min.
    pub asked_mm_per_min: f64,
    pub written_mm_per_min: f64,
    /// How much longer the moves take in all, s.
    pub by_s: f64,
}

/// The feeds of `toolpath` that a program in `units` cannot state closely; `None` where there are none, and
/// for a program of the positions of all axes, whose blocks state times in place of feeds.
pub fn coarse_feeds(
    toolpath: &Toolpath,
    dialect: &Dialect,
    units: Units,
    output: Option<AxisOutput>,
) -> Option<CoarseFeeds> {
    if output == Some(AxisOutput::Machine) {
        return None;
    }
    // A feed of so many units of the last decimal loses at most the part `CLOSE` to rounding.
    let fine_mm_per_min = units.mm() / CLOSE / 10f64.powi(i32::from(dialect.numbers.feed_decimals(units)));
    let mut coarse: Option<CoarseFeeds> = None;
    for step in toolpath.moves() {
        let Move::Feed { along, rate: Some(rate), .. } = step else { continue };
        let asked_mm_per_min = rate.mm_per_min();
        if asked_mm_per_min >= fine_mm_per_min {
            continue;
        }
        let Ok(word) = words::feed(*rate, units, &dialect.numbers) else { continue };
        let written_mm_per_min = word.value() * units.mm();
        if written_mm_per_min >= (1.0 - CLOSE) * asked_mm_per_min {
            continue;
        }
        let own_s = along.length() / rate.mm_per_s();
        let feeds =
            coarse.get_or_insert(CoarseFeeds { moves: 0, asked_mm_per_min, written_mm_per_min, by_s: 0.0 });
        feeds.moves += 1;
        feeds.by_s += own_s * (asked_mm_per_min / written_mm_per_min - 1.0);
        if written_mm_per_min * feeds.asked_mm_per_min < feeds.written_mm_per_min * asked_mm_per_min {
            (feeds.asked_mm_per_min, feeds.written_mm_per_min) = (asked_mm_per_min, written_mm_per_min);
        }
    }
    coarse
}
