//! The heights of rapids, and cutting conditions that are often a mistake.

use super::{Warning, WarningCode, member, violation};
use crate::http::error::{ApiError, Code, FieldCode};
use toolpathd_core::toolpath::cutting::{Caution, HeightError};

impl From<HeightError> for ApiError {
    fn from(error: HeightError) -> Self {
        match error {
            HeightError::RetractBelowTop { z_mm, top_mm } => below_top("retract_z_mm", z_mm, top_mm),
            HeightError::ClearanceBelowTop { z_mm, top_mm } => below_top("clearance_z_mm", z_mm, top_mm),
            HeightError::ClearanceBelowRetract { clearance_mm, retract_mm } => {
                let detail = format!(
                    "`clearance_z_mm` is {clearance_mm} mm, below `retract_z_mm` at {retract_mm} mm; send at least {retract_mm} mm"
                );
                violation(&member("/cutting/clearance_z_mm"), FieldCode::OutOfRange, detail)
            }
        }
    }
}

fn below_top(name: &str, z_mm: f64, top_mm: f64) -> ApiError {
    let detail = format!(
        "`{name}` is {z_mm} mm, below the top of the part and its stock at {top_mm} mm; send at least {top_mm} mm"
    );
    let at = member("/cutting").field(name);
    ApiError::new(Code::HeightBelowTop, detail).blaming(&at, FieldCode::HeightBelowTop)
}

impl From<Caution> for Warning {
    fn from(caution: Caution) -> Self {
        let (code, detail) = match caution {
            Caution::NoSpindleSpeed => (
                WarningCode::NoSpindleSpeed,
                "`cutting.spindle_rpm` is absent: the program starts no spindle".to_owned(),
            ),
            Caution::NoToolNumber => {
                (WarningCode::NoToolNumber, "`tool.number` is absent: the program calls tool 1".to_owned())
            }
            Caution::NoWorkOffset => (
                WarningCode::NoWorkOffset,
                "`program.work_offset` is absent: the program runs with the active work offset".to_owned(),
            ),
            Caution::ClearanceChosen { z_mm } => (
                WarningCode::ClearanceChosen,
                format!(
                    "`cutting.clearance_z_mm` is absent: the program goes to z {z_mm} mm, above everything that the toolpath cuts; check that clamps are lower"
                ),
            ),
            Caution::LengthOffsetDiffers { .. } => (WarningCode::LengthOffsetDiffers, caution.to_string()),
        };
        Self::new(code, detail)
    }
}

impl Warning {
    /// The warning of a feed in slots above the feed, both in mm/min.
    pub fn slot_feed_above_feed(slot: f64, feed: f64) -> Self {
        let detail = format!(
            "the feed in slots, {slot} mm/min, is above the feed, {feed} mm/min: the cutter goes faster where it cuts more"
        );
        Self::new(WarningCode::SlotFeedAboveFeed, detail)
    }

    /// The warning of a tolerance above a tenth of the cutter's radius. `None` below.
    pub fn tolerance_coarse(tolerance_mm: f64, radius_mm: f64) -> Option<Self> {
        let detail = || {
            format!(
                "the tolerance of {tolerance_mm} mm is more than a tenth of the cutter's radius of {radius_mm} mm: check its unit"
            )
        };
        (tolerance_mm > COARSE_TOLERANCE * radius_mm)
            .then(|| Self::new(WarningCode::ToleranceCoarse, detail()).about(&member("/tolerance_mm")))
    }

    /// The warning of a program that takes very long. `None` below [`LONG_S`] seconds.
    pub fn long_time(seconds: f64) -> Option<Self> {
        let detail = || {
            format!(
                "the program takes {:.1} hours: check that `feed_mm_per_min` and the other feeds are in mm/min, and not in mm/s or inch/min",
                seconds / SECONDS_PER_HOUR
            )
        };
        (seconds > LONG_S).then(|| Self::new(WarningCode::LongTime, detail()))
    }
}

/// A tolerance above this part of the cutter's radius is doubtful: a finished surface has a hundredth.
const COARSE_TOLERANCE: f64 = 0.1;

const SECONDS_PER_HOUR: f64 = 3600.0;

/// A program that takes longer is doubtful: more than a shift. Feeds in mm/s instead of mm/min make a program
/// sixty times as long.
const LONG_S: f64 = 10.0 * SECONDS_PER_HOUR;
