//! What a tool is too short for, and what is doubtful in its use.

use super::{Warning, WarningCode, member};
use crate::http::error::{ApiError, FieldCode, FieldError};
use crate::http::pointer::Pointer;
use toolpathd_core::toolpath::tool_body::{Doubt, TooShort};

/// The failure of a job for which the tool is too short. `at_once` is the path of the member that decides how
/// deep is cut at once, and the advice about it. `None` where nothing is too short.
pub fn too_short(faults: &[TooShort], at_once: (&str, &str)) -> Option<ApiError> {
    let violation = |fault: &TooShort| {
        FieldError::new(&place(fault, at_once.0), FieldCode::OutOfRange, detail(fault, at_once.1))
    };
    (!faults.is_empty()).then(|| ApiError::invalid(faults.iter().map(violation).collect()))
}

fn detail(fault: &TooShort, advice_at_once: &str) -> String {
    match fault {
        TooShort::Flutes { .. } => format!("{fault}; {advice_at_once}"),
        TooShort::Holder { .. } => {
            format!("{fault}; send a tool that sticks out farther, or a lesser depth")
        }
    }
}

fn place(fault: &TooShort, at_once: &str) -> Pointer {
    match fault {
        TooShort::Flutes { .. } => member(at_once),
        TooShort::Holder { widest, .. } => match widest.section {
            Some(k) => member("/tool/holder").index(k),
            None => member("/tool/length_mm"),
        },
    }
}

impl From<Doubt> for Warning {
    fn from(doubt: Doubt) -> Self {
        match doubt {
            Doubt::ShankBesideWall { .. } => {
                let advice = "make sure that the shank is no wider than the cutter";
                Self::new(WarningCode::ShankBesideWall, format!("{doubt}; {advice}"))
                    .about(&member("/tool/flute_length_mm"))
            }
            Doubt::FeedPerTooth { .. } => {
                let advice = "check the units of `feed_mm_per_min` and `spindle_rpm`";
                Self::new(WarningCode::FeedPerTooth, format!("{doubt}; {advice}"))
            }
        }
    }
}
