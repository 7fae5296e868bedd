//! Canned cycles as they are written.

use std::ops::RangeInclusive;

use super::WriteError;
use super::dialect::{Dialect, Syntax};
use super::words::{self, FeedWord};
use toolpathd_core::toolpath::cycle::{Cycle, CycleKind, Hole, PECK_CLEARANCE_MM, ReturnTo};
use toolpathd_core::toolpath::program::{Resolution, Units};
use toolpathd_core::toolpath::quantize::Grid;

/// The distances of the retract plane from the material from which cycle 200 drills in pecks, mm. After each
/// peck a rapid goes down the hole to this distance above what was drilled: less would be too near, and more
/// would be drilled again.
const CLEARANCES_OF_PECKS_MM: RangeInclusive<f64> = PECK_CLEARANCE_MM..=5.0;

/// Whether cycle 200 or 201 makes the hole. What their feeds count in a program in inches is not certain.
fn is_for_klartext(hole: &Hole, units: Units) -> bool {
    let above_mm = hole.retract_z_mm - hole.top_z_mm;
    units == Units::Mm && (CLEARANCES_OF_PECKS_MM.contains(&above_mm) || !hole.kind.pecks())
}

/// Refuses a cycle whose heights rounding joins: the tool comes down to the retract plane as a rapid, so the
/// plane has to be above the material.
///
/// # Errors
/// When it is not, or nothing is left of the depth.
pub fn check_heights(hole: &Hole, grid: &Grid) -> Result<(), WriteError> {
    let Hole { top_z_mm, retract_z_mm, bottom_z_mm, .. } = *hole;
    let [retract, bottom] = [grid.units(retract_z_mm)?, grid.units(bottom_z_mm)?];
    let top = grid.units(top_z_mm)?;
    let is_above = grid.mm(retract) > top_z_mm && retract > top;
    if is_above && bottom < top {
        Ok(())
    } else {
        Err(WriteError::CycleHeights { top_z_mm, retract_z_mm, bottom_z_mm })
    }
}

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
    /// The words of a cycle. `None` where its moves have to be written instead: where the dialect has no
    /// words for it, and where rounding leaves nothing of a peck.
    ///
    /// # Errors
    /// When a number or the pause is too large.
    pub fn of(cycle: &Cycle, resolution: Resolution, dialect: &Dialect) -> Result<Option<Self>, WriteError> {
        let (hole, abilities) = (&cycle.hole, &dialect.abilities);
        let is_klartext = dialect.syntax == Syntax::Klartext;
        if !abilities.cycles.contains(&hole.kind) || is_klartext && !is_for_klartext(hole, resolution.units) {
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
            // Rounding has made one peck of several.
            (words.kind, words.peck) = (CycleKind::Drill, 0);
        }
        Ok((words.peck > 0 || !words.kind.pecks()).then_some(words))
    }
}
