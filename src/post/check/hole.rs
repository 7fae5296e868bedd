//! A hole of a canned cycle, as it is read, against its words.

use super::super::cycles::CycleWords;
use super::super::read::Hole;
use super::{DWELL_AGREEMENT_MS, first_false};

/// The name of what differs; `None` where nothing does. `is_near` compares a length in mm with units of the
/// last decimal.
pub fn difference(
    words: &CycleWords,
    hole: &Hole,
    is_near: impl Fn(f64, i64) -> bool,
) -> Option<&'static str> {
    let cycle = &hole.cycle;
    let is_peck = match cycle.peck_mm {
        Some(peck) => is_near(peck, words.peck),
        None => words.peck == 0,
    };
    first_false(&[
        (cycle.kind == words.kind, "cycle"),
        (cycle.top_mm.is_none_or(|top| is_near(top, words.top)), "height of the material"),
        (is_near(cycle.retract_mm, words.retract), "retract plane"),
        (is_near(cycle.bottom_mm, words.bottom), "depth"),
        (is_peck, "depth of a peck"),
        ((cycle.dwell_s * 1000.0 - words.dwell_ms as f64).abs() <= DWELL_AGREEMENT_MS, "dwell"),
        (is_near(cycle.returns_mm, words.returns), "height of the return"),
    ])
}
