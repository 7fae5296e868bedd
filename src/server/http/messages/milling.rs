//! Milling of surfaces.

use super::{Warning, WarningCode, member, too_large};
use crate::http::error::{ApiError, Code, FieldCode};
use toolpathd_core::operations::surface_milling::{self, Error};
use toolpathd_core::toolpath::PathError;

impl From<&surface_milling::Warning> for Warning {
    fn from(warning: &surface_milling::Warning) -> Self {
        use surface_milling::Warning as Of;
        let fact = warning.to_string();
        let (code, detail) = match *warning {
            Of::EndsReduced { direction, points } => return Self::ends_reduced(direction, points),
            Of::RestLeft { .. } => (WarningCode::RestLeft, format!("{fact}; use a smaller cutter there")),
            Of::ShortPiecesLeftOut { .. } => (WarningCode::ShortPiecesLeftOut, fact),
            Of::PartSmallerThanCutter => (WarningCode::PartSmallerThanCutter, fact),
            Of::StockNotGiven { approach_mm } => (
                WarningCode::StockNotGiven,
                format!(
                    "`stock` is absent: rapids come down to {approach_mm} mm above the surface; make sure that no stock is higher there, or send `stock`"
                ),
            ),
            Of::EntryNotClear { .. } => (WarningCode::EntryNotClear, fact),
            Of::RoughingPathGouges { .. } => (WarningCode::RoughingPathGouges, fact),
            Of::StripLeft { .. } => (WarningCode::StripLeft, fact),
        };
        Self::new(code, detail)
    }
}

impl From<Error> for ApiError {
    fn from(error: Error) -> Self {
        let fact = error.to_string();
        match error {
            Error::Stopped(stopped) => stopped.into(),
            Error::Source(source) => source.into(),
            Error::NoBall => {
                let detail =
                    "the engine `offset_section` supports ball cutters only; use the engine `contact`";
                Self::new(Code::InvalidRequest, detail)
                    .blaming(&member("/tool/shape"), FieldCode::Unsupported)
            }
            Error::NotSmooth(joint) => joint.into(),
            Error::NoWayPast => {
                Self::new(Code::NotSmooth, format!("{fact}; use the boundary `on` or `inside`"))
                    .blaming(&member("/boundary"), FieldCode::Unsupported)
            }
            Error::Overhang { at } => {
                let advice = "the engine `offset_section` cannot cut it; use the engine `contact`";
                Self::new(Code::Overhang, format!("{fact}; {advice}")).at(at.into())
            }
            Error::OffsetFolds { at } => {
                let advice = "use a smaller cutter or the engine `contact`";
                Self::new(Code::OffsetFolds, format!("{fact}; {advice}")).at(at.into())
            }
            Error::Heights(heights) => heights.into(),
            Error::ToleranceBelowResolution { .. } => Self::new(Code::ToleranceBelowDecimals, fact)
                .blaming(&member("/tolerance_mm"), FieldCode::ToleranceBelowDecimals)
                .blaming(&member("/program/decimals"), FieldCode::ToleranceBelowDecimals),
            Error::ToleranceNotReached { at, .. } => Self::new(Code::ToleranceNotReached, fact).at(at.into()),
            Error::TooMuchWork { .. } => too_large("/strategy", fact),
            Error::ScallopNotReached { at, .. } => {
                let advice = "send a larger `scallop_height_mm`, the other `plane` or `boundary: past`";
                let error = Self::new(Code::ScallopNotReached, format!("{fact}; {advice}"))
                    .blaming(&member("/strategy/scallop_height_mm"), FieldCode::OutOfRange);
                at.into_iter().fold(error, |error, at| error.at(at.into()))
            }
            Error::NothingToCut => Self::new(Code::NothingToCut, fact),
            Error::SectionLost { at } => Self::new(Code::SectionLost, fact).at(at.into()),
            Error::Quantize(quantize) => quantize.into(),
            Error::Path(PathError::TooManyMoves { .. }) => {
                let advice = "send a larger spacing of passes or a larger tolerance";
                too_large("/strategy", format!("{fact}: {advice}"))
            }
            Error::TooManyPoints { .. } => {
                too_large("/step_length_mm", fact).blaming(&member("/strategy"), FieldCode::LimitExceeded)
            }
            Error::Path(_) => Self::new(Code::InternalError, fact),
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Point3;

    use super::*;
    use toolpathd_core::budget::Stopped;
    use toolpathd_core::geometry::surface::joints::NotSmooth;
    use toolpathd_core::geometry::surface::nurbs::NurbsError;
    use toolpathd_core::geometry::surface::point_grid::GridError;
    use toolpathd_core::toolpath::cutting::HeightError;
    use toolpathd_core::toolpath::quantize::QuantizeError;

    /// The code of the problem and the pointers of its violations.
    fn told(error: Error) -> (Code, Vec<String>) {
        let error = ApiError::from(error);
        (error.code(), error.errors().iter().map(|error| error.pointer.clone()).collect())
    }

    #[test]
    fn every_failure_has_its_code_and_its_places() {
        let at = Point3::new(1.0, 2.0, 3.0);
        for (error, code, places) in [
            (Error::Stopped(Stopped::DeadlinePassed), Code::DeadlinePassed, &[][..]),
            (Error::Overhang { at }, Code::Overhang, &[]),
            (Error::OffsetFolds { at }, Code::OffsetFolds, &[]),
            (
                Error::Heights(HeightError::RetractBelowTop { z_mm: 1.0, top_mm: 2.0 }),
                Code::HeightBelowTop,
                &["#/cutting/retract_z_mm"],
            ),
            (
                Error::Heights(HeightError::ClearanceBelowRetract { clearance_mm: 1.0, retract_mm: 2.0 }),
                Code::InvalidRequest,
                &["#/cutting/clearance_z_mm"],
            ),
            (
                Error::ToleranceBelowResolution { tolerance_mm: 1e-4, decimals: 3, least_mm: 0.0015 },
                Code::ToleranceBelowDecimals,
                &["#/tolerance_mm", "#/program/decimals"],
            ),
            (
                Error::ToleranceNotReached { tolerance_mm: 0.1, deviation_mm: 0.2, at },
                Code::ToleranceNotReached,
                &[],
            ),
            (
                Error::TooMuchWork { what: "passes", needed: 5, limit: 4 },
                Code::LimitExceeded,
                &["#/strategy"],
            ),
            (
                Error::ScallopNotReached { asked_mm: 0.01, least_mm: 0.2, at: Some(at) },
                Code::ScallopNotReached,
                &["#/strategy/scallop_height_mm"],
            ),
            (Error::NothingToCut, Code::NothingToCut, &[]),
            (Error::SectionLost { at }, Code::SectionLost, &[]),
            (
                Error::Quantize(QuantizeError::TooManyPieces { limit: 4 }),
                Code::LimitExceeded,
                &["#/program/decimals"],
            ),
            (
                Error::Source(GridError::Ragged { row: 2, points: 3, expected: 4 }.into()),
                Code::InvalidRequest,
                &["#/surface/points/2"],
            ),
            (
                Error::Source(NurbsError::KnotCount { along: 1, found: 2, points: 3, degree: 4 }.into()),
                Code::InvalidRequest,
                &["#/surface/knots_v"],
            ),
            (Error::NoBall, Code::InvalidRequest, &["#/tool/shape"]),
            (Error::NotSmooth(NotSmooth::Edge { at, angle_deg: 45.0 }), Code::NotSmooth, &[]),
            (Error::NoWayPast, Code::NotSmooth, &["#/boundary"]),
            (
                Error::NotSmooth(NotSmooth::Gap { at, gap_mm: 1.0, patches: [[0, 0], [0, 1]] }),
                Code::NotSmooth,
                &["#/surface/patches/0/1"],
            ),
        ] {
            let (told_code, told_places) = told(error);
            assert_eq!(told_code, code, "{error:?}");
            assert_eq!(told_places, places, "{error:?}");
        }
    }
}
