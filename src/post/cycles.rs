//! Canned cycles as they are written.

use super::WriteError;
use super::dialect::{Dialect, Syntax};
use super::words::{self, FeedWord};
use toolpathd_core::toolpath::cycle::{Cycle, CycleKind, Hole, PECK_CLEARANCE_MM, ReturnTo};
use toolpathd_core::toolpath::program::{Resolution, Units};
use toolpathd_core::toolpath::quantize::Grid;

/// Whether cycle 200 or 201 makes the hole. What their feeds count in a program in inches is not certain.
/// After each peck a rapid goes down the hole to the distance of the retract plane from the material above
/// what was drilled.
fn is_for_klartext(hole: &Hole, units: Units) -> bool {
    let is_clear = hole.retract_z_mm - hole.top_z_mm >= PECK_CLEARANCE_MM || !hole.kind.pecks();
    units == Units::Mm && is_clear
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
    /// words for it, and where rounding leaves nothing of the hole or of a peck, or puts the retract plane
    /// above the start.
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
            returns: 0,
            return_to: hole.return_to,
        };
        if grid.mm(words.retract) <= hole.top_z_mm {
            // The tool comes down there as a rapid.
            words.retract += 1;
        }
        let start = grid.units(cycle.start_z_mm)?;
        words.returns = match hole.return_to {
            ReturnTo::RetractPlane => words.retract,
            ReturnTo::Start => start,
        };
        if words.peck >= words.top - words.bottom {
            // Rounding has made one peck of several.
            (words.kind, words.peck) = (CycleKind::Drill, 0);
        }
        let is_hole =
            words.bottom < words.top && words.retract <= start && (words.peck > 0 || !words.kind.pecks());
        Ok(is_hole.then_some(words))
    }
}
