//! Holes of canned cycles as a control reads them.

use toolpathd_core::toolpath::cycle::CycleKind;
use toolpathd_core::toolpath::units::FeedRate;

/// A hole of a canned cycle. Lengths and positions in mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hole {
    pub from: [f64; 3],
    pub to: [f64; 2],
    /// The height at which the tool ends.
    pub returns_mm: f64,
    pub cycle: Cycle,
}

/// A canned cycle in force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cycle {
    pub kind: CycleKind,
    /// The height of the material. `None` where programs of the control do not state it.
    pub top_mm: Option<f64>,
    pub retract_mm: f64,
    pub bottom_mm: f64,
    /// The depth of a peck; `None` where the cycle has none.
    pub peck_mm: Option<f64>,
    pub dwell_s: f64,
    pub rate: FeedRate,
}

/// How far two heights may be apart that are the same, mm: the rounding of a sum of two numbers. The least
/// increment of a control is larger.
const SAME_HEIGHT_MM: f64 = 1e-6;

impl Cycle {
    /// Whether the tool starts at `from_mm` and ends at `returns_mm` above what it drills, and drills down.
    pub fn goes_down(&self, from_mm: f64, returns_mm: f64) -> bool {
        self.bottom_mm < self.retract_mm
            && self.retract_mm <= from_mm.min(returns_mm) + SAME_HEIGHT_MM
            && self.peck_mm.is_none_or(|peck| peck > 0.0)
            && self.dwell_s >= 0.0
    }
}
