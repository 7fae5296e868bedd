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
        match warning {
            surface_model::Warning::EndsReduced { direction, points } => {
                Self::ends_reduced(direction, *points)
            }
            surface_model::Warning::NotSmooth(fault) => Self::new(
                WarningCode::NotSmooth,
                format!("{fault}: `engine: offset_section` refuses this surface, `engine: contact` mills it"),
            ),
            surface_model::Warning::NoNormal => Self::new(
                WarningCode::NoNormal,
                "the surface has, or may have, a place without a normal, such as a pole: the report has no curvature",
            ),
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
            WireError::TooManyWires { needed: _, limit: _ } => too_large("/wires/pitch_mm", fact),
            WireError::TooManyPoints { limit: _ } => too_large("/wires", fact),
            WireError::Overhang { at } => Self::new(Code::Overhang, fact).at(at.into()),
            WireError::SectionLost { at } => Self::new(Code::SectionLost, fact).at(at.into()),
        }
    }
}
