//! Canned cycles as they are written.

use super::WriteError;
use super::dialect::{Dialect, Syntax};
use super::words::{self, FeedWord};
use toolpathd_core::toolpath::cycle::{Cycle, CycleKind, ReturnTo};
use toolpathd_core::toolpath::program::{Resolution, Units};
use toolpathd_core::toolpath::quantize::Grid;

/// A canned cycle, but for the places of its holes. Heights are in units of the last decimal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CycleWords {
    pub kind: CycleKind,
    pub top: i64,
    pub retract: i64,
    pub bottom: i64,
    /// The depth of a peck; zero where the cycle has none.
    pub peck: i64,
    pub dwell_ms: u64,
    pub feed: FeedWord,
    /// The height at which the tool ends each hole.
    pub returns: i64,
    pub return_to: ReturnTo,
}

impl CycleWords {
    /// The words of a cycle. `None` where the dialect has none for it, and where nothing of the hole or of a
    /// peck is left by the rounding: its moves have to be written instead.
    ///
    /// # Errors
    /// When a number or the pause is too large.
    pub fn of(cycle: &Cycle, resolution: Resolution, dialect: &Dialect) -> Result<Option<Self>, WriteError> {
        let (hole, abilities) = (&cycle.hole, &dialect.abilities);
        // What the feed of a Klartext cycle counts in a program in inches is not certain.
        let has_feed = dialect.syntax != Syntax::Klartext || resolution.units == Units::Mm;
        if !abilities.cycles.contains(&hole.kind) || !has_feed {
            return Ok(None);
        }
        let grid = Grid::new(resolution);
        if hole.dwell_s > abilities.max_dwell_s {
            return Err(WriteError::Dwell { seconds: hole.dwell_s, most_s: abilities.max_dwell_s });
        }
        let mut words = Self {
            kind: hole.kind,
            top: grid.units(hole.top_z_mm)?,
            retract: grid.units(hole.retract_z_mm)?,
            bottom: grid.units(hole.bottom_z_mm)?,
            peck: hole.peck_mm.map_or(Ok(0), |peck| grid.units(peck))?,
            dwell_ms: (hole.dwell_s * 1000.0).round() as u64,
            feed: words::feed(hole.rate, resolution.units, &dialect.numbers)?,
            returns: grid.units(cycle.return_z_mm())?,
            return_to: hole.return_to,
        };
        if words.peck >= words.top - words.bottom {
            // One peck is no peck: where the first is counted from differs between controls.
            (words.kind, words.peck) = (CycleKind::Drill, 0);
        }
        let is_hole = words.bottom < words.top && (words.peck > 0 || !words.kind.pecks());
        Ok(is_hole.then_some(words))
    }
}
