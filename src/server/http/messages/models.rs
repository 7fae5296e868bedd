//! Models of surfaces, and cutters lowered onto them.

use super::{Warning, WarningCode, too_large};
use crate::http::error::{ApiError, Code};
use toolpathd_core::machining::wire_model::WireError;
use toolpathd_core::operations::{cutter_location, surface_model};

impl Warning {
    /// The warning of a direction with too few points for the ends that the request asks for.
    pub(super) fn ends_reduced(direction: &str, points: usize) -> Self {
        let detail = format!(
            "`not_a_knot` needs 4 points along {direction}; with {points} points the surface follows the polynomial through the points"
        );
        Self::new(WarningCode::EndsReduced, detail)
    }
}

impl From<&surface_model::Warning> for Warning {
    fn from(warning: &surface_model::Warning) -> Self {
        use surface_model::Warning as Of;
        let fact = warning.to_string();
        match warning {
            Of::EndsReduced { direction, points } => Self::ends_reduced(direction, *points),
            Of::NotSmooth(_) => {
                let advice = "`engine: offset_section` refuses this surface, `engine: contact` mills it";
                Self::new(WarningCode::NotSmooth, format!("{fact}: {advice}"))
            }
            Of::NoNormal => Self::new(WarningCode::NoNormal, fact),
        }
    }
}

impl From<surface_model::Error> for ApiError {
    fn from(error: surface_model::Error) -> Self {
        match error {
            surface_model::Error::Stopped(stopped) => stopped.into(),
            surface_model::Error::Source(source) => source.into(),
            surface_model::Error::Wires(wires) => wires.into(),
            surface_model::Error::TooManyControlPoints { needed, limit } => too_large(
                "/patches",
                format!(
                    "the patches have {needed} control points, and an answer holds at most {limit}: send `patches: false`"
                ),
            ),
        }
    }
}

impl From<cutter_location::Error> for ApiError {
    fn from(error: cutter_location::Error) -> Self {
        match error {
            cutter_location::Error::Stopped(stopped) => stopped.into(),
            cutter_location::Error::Source(source) => source.into(),
        }
    }
}

impl From<WireError> for ApiError {
    fn from(error: WireError) -> Self {
        let fact = error.to_string();
        match error {
            WireError::Stopped(stopped) => stopped.into(),
            WireError::TooManyWires { .. } => too_large("/wires/pitch_mm", fact),
            WireError::TooManyPoints { .. } => too_large("/wires", fact),
            WireError::SectionLost { at } => Self::new(Code::SectionLost, fact).at(at.into()),
        }
    }
}
