//! Holes of canned cycles as a control reads them.

use crate::nc::Fault;
use toolpathd_core::toolpath::cycle::CycleKind;
use toolpathd_core::toolpath::units::FeedRate;

/// A hole of a canned cycle. Lengths and positions in mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hole {
    pub from: [f64; 3],
    pub to: [f64; 2],
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
    /// The height at which the tool ends each hole.
    pub returns_mm: f64,
}

/// How far two heights may be apart that are the same, mm: the rounding of a sum of two numbers. The least
/// increment of a control is larger.
const SAME_HEIGHT_MM: f64 = 1e-6;

impl Cycle {
    /// Makes a hole from the position `at`, and moves the position to where the hole ends. X and Y stay where
    /// `to` does not state them. All in mm.
    ///
    /// # Errors
    /// When the position is not known, or the cycle does not go down from it.
    pub fn hole(self, at: &mut [Option<f64>; 3], to: [Option<f64>; 2]) -> Result<Hole, Fault> {
        let [Some(x), Some(y), Some(z)] = *at else { return Err(Fault::UnknownStart) };
        if !self.goes_down(z) {
            return Err(Fault::Cycle);
        }
        let to = [to[0].unwrap_or(x), to[1].unwrap_or(y)];
        *at = [Some(to[0]), Some(to[1]), Some(self.returns_mm)];
        Ok(Hole { from: [x, y, z], to, cycle: self })
    }

    /// Whether the tool starts at `from_mm` and ends above what it drills, and drills down.
    fn goes_down(&self, from_mm: f64) -> bool {
        self.bottom_mm < self.retract_mm
            && self.retract_mm <= from_mm.min(self.returns_mm) + SAME_HEIGHT_MM
            && self.peck_mm.is_none_or(|peck| peck > 0.0)
            && self.dwell_s >= 0.0
    }
}
