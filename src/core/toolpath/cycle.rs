//! Canned cycles: holes along Z that many controls drill by one word. A cycle of a pass stands for some of
//! its moves, which are there all the same: measures, times and pictures need not know of cycles.

use std::ops::Range;

use nalgebra::Point2;

use super::units::FeedRate;

/// After a peck with a full retract the tool comes back as a rapid to this far above the depth that is
/// drilled, mm; after the other pecks it goes back by as much. A control that has the cycle uses its own
/// setting.
pub const PECK_CLEARANCE_MM: f64 = 0.5;

/// A last peck of less than this is the rounding of a sum, mm: there is none.
const LEAST_PECK_MM: f64 = 1e-6;

/// How a hole is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize, utoipa::ToSchema))]
#[cfg_attr(feature = "wire", serde(rename_all = "snake_case"))]
pub enum CycleKind {
    /// To the bottom at feed, and back as a rapid (G81; G82 with a dwell at the bottom).
    Drill,
    /// In pecks. After each of them the tool goes back by a little, so that the chip breaks (G73).
    ChipBreak,
    /// In pecks. After each of them the tool goes back to the retract plane, so that chips leave the hole
    /// (G83).
    Peck,
    /// To the bottom and back to the retract plane, both at feed (G85; G89 with a dwell at the bottom).
    Ream,
}

impl CycleKind {
    pub const ALL: [Self; 4] = [Self::Drill, Self::ChipBreak, Self::Peck, Self::Ream];

    pub fn pecks(self) -> bool {
        matches!(self, Self::ChipBreak | Self::Peck)
    }
}

/// Where the tool goes after each hole.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize, utoipa::ToSchema))]
#[cfg_attr(feature = "wire", serde(rename_all = "snake_case"))]
pub enum ReturnTo {
    /// To the retract plane (G99).
    #[default]
    RetractPlane,
    /// To the height at which the tool was before the cycle (G98).
    Start,
}

/// The holes of a cycle, but for their places.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hole {
    pub kind: CycleKind,
    /// The height of the material.
    pub top_z_mm: f64,
    /// The height from which the tool drills, above the top: it comes down there as a rapid.
    pub retract_z_mm: f64,
    pub bottom_z_mm: f64,
    /// The depth of a peck; `None` where the cycle has no pecks.
    pub peck_mm: Option<f64>,
    /// The pause at the bottom. A cycle with pecks has none.
    pub dwell_s: f64,
    pub rate: FeedRate,
    pub return_to: ReturnTo,
}

/// A canned cycle of a pass.
#[derive(Debug, Clone, PartialEq)]
pub struct Cycle {
    /// The moves of the pass for which the cycle stands.
    pub moves: Range<usize>,
    pub hole: Hole,
    /// The height of the tool before the cycle.
    pub start_z_mm: f64,
    pub places: Vec<Point2<f64>>,
}

impl Cycle {
    /// The height at which the tool ends each hole, mm.
    pub fn return_z_mm(&self) -> f64 {
        match self.hole.return_to {
            ReturnTo::RetractPlane => self.hole.retract_z_mm,
            ReturnTo::Start => self.start_z_mm,
        }
    }
}

/// Why a cycle cannot be added.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum CycleError {
    #[error("the cycle has no holes")]
    NoHoles,
    #[error(
        "the heights of the cycle are not in order: the bottom, above it the top, above it the retract plane"
    )]
    Heights,
    #[error(
        "the cycle starts at z = {start_z_mm} mm, below its retract plane at z = {retract_z_mm} mm: go up before it"
    )]
    StartsBelow { start_z_mm: f64, retract_z_mm: f64 },
    #[error("a cycle with pecks needs a depth of a peck above zero, and no other cycle has one")]
    Peck,
    #[error("the pause of a cycle is a time of zero or more seconds, and a cycle with pecks has none")]
    Dwell,
    #[error("a cycle needs the tool straight up; send its moves instead")]
    Leans,
}

impl Hole {
    /// The same hole. A peck that reaches the bottom from the top is no peck.
    #[must_use]
    pub fn simplified(self) -> Self {
        let depth_mm = self.top_z_mm - self.bottom_z_mm;
        if self.peck_mm.is_some_and(|peck| peck >= depth_mm) {
            Self { kind: CycleKind::Drill, peck_mm: None, ..self }
        } else {
            self
        }
    }

    /// The number of pecks before the last, each with the way back.
    pub fn n_pecks(&self) -> f64 {
        let depth_mm = self.retract_z_mm - self.bottom_z_mm;
        self.peck_mm.map_or(0.0, |peck| ((depth_mm - LEAST_PECK_MM) / peck).ceil() - 1.0).max(0.0)
    }

    /// The number of moves of `n` holes, at most.
    pub fn n_moves(&self, n: usize) -> f64 {
        // Across, down the hole, and up.
        const OF_HOLE: f64 = 3.0;
        let returns_high = self.return_to == ReturnTo::Start;
        let of_peck = if self.kind == CycleKind::Peck { 3.0 } else { 2.0 };
        let down = f64::from(u8::from(returns_high));
        let pause = f64::from(u8::from(self.dwell_s > 0.0));
        // At feed to the retract plane, and up from there.
        let out = f64::from(u8::from(self.kind == CycleKind::Ream && returns_high));
        let of_hole = OF_HOLE + of_peck * self.n_pecks() + down + pause + out;
        // The first hole may begin with a way down.
        of_hole * n as f64 + 1.0
    }

    /// Checks the holes of a cycle that starts at this height.
    ///
    /// # Errors
    /// When a figure does not fit the others, or the kind of the cycle.
    pub fn check(&self, start_z_mm: f64) -> Result<(), CycleError> {
        let Self { kind, top_z_mm, retract_z_mm, bottom_z_mm, peck_mm, dwell_s, .. } = *self;
        if !(bottom_z_mm < top_z_mm && top_z_mm < retract_z_mm) {
            return Err(CycleError::Heights);
        }
        if start_z_mm < retract_z_mm {
            return Err(CycleError::StartsBelow { start_z_mm, retract_z_mm });
        }
        if peck_mm.is_some() != kind.pecks() || peck_mm.is_some_and(|peck| peck.is_nan() || peck <= 0.0) {
            return Err(CycleError::Peck);
        }
        let is_time = dwell_s.is_finite() && dwell_s >= 0.0;
        if !is_time || kind.pecks() && dwell_s > 0.0 { Err(CycleError::Dwell) } else { Ok(()) }
    }
}
