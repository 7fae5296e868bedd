//! The heights of rapids, and cutting conditions that are often a mistake.

use super::{Warning, WarningCode, member, violation};
use crate::http::error::{ApiError, Code, FieldCode};
use toolpathd_core::toolpath::cutting::{Caution, HeightError, RapidPlane};

impl From<HeightError> for ApiError {
    fn from(error: HeightError) -> Self {
        match error {
            HeightError::BelowTop { plane, z_mm, top_mm } => {
                let name = match plane {
                    RapidPlane::Clearance => "clearance_z_mm",
                    RapidPlane::Retract => "retract_z_mm",
                };
                let detail = format!(
                    "`{name}` is {z_mm} mm, below the top of the part and its stock at {top_mm} mm; send at least {top_mm} mm"
                );
                let at = member("/cutting").field(name);
                Self::new(Code::HeightBelowTop, detail).blaming(&at, FieldCode::HeightBelowTop)
            }
            HeightError::ClearanceBelowRetract { clearance_mm, retract_mm } => {
                let detail = format!(
                    "`clearance_z_mm` is {clearance_mm} mm, below `retract_z_mm` at {retract_mm} mm; send at least {retract_mm} mm"
                );
                violation(&member("/cutting/clearance_z_mm"), FieldCode::OutOfRange, detail)
            }
        }
    }
}

impl From<Caution> for Warning {
    fn from(caution: Caution) -> Self {
        match caution {
            Caution::NoSpindleSpeed => Self::new(
                WarningCode::NoSpindleSpeed,
                "`cutting.spindle_rpm` is absent: the program starts no spindle",
            ),
            Caution::NoToolNumber => {
                Self::new(WarningCode::NoToolNumber, "`tool.number` is absent: the program calls tool 1")
            }
            Caution::NoWorkOffset => Self::new(
                WarningCode::NoWorkOffset,
                "`program.work_offset` is absent: the program runs with the active work offset",
            ),
            Caution::ClearanceChosen { z_mm } => Self::new(
                WarningCode::ClearanceChosen,
                format!(
                    "`cutting.clearance_z_mm` is absent: the program goes to z {z_mm} mm, above everything that the toolpath cuts; check that clamps are lower"
                ),
            ),
            Caution::LengthOffsetDiffers { number, length_offset } => Self::new(
                WarningCode::LengthOffsetDiffers,
                format!("tool {number} runs with the length offset {length_offset}"),
            ),
        }
    }
}
