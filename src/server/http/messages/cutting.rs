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
        Self { code, detail }
    }
}
