//! Problem documents for the failures of milling.

use crate::http::error::{ApiError, Code, FieldCode};
use crate::http::pointer::Pointer;
use toolpathd_core::operations::surface_milling::Error;
use toolpathd_core::toolpath::PathError;

impl From<Error> for ApiError {
    fn from(error: Error) -> Self {
        let detail = error.to_string();
        let root = Pointer::root();
        let strategy = root.field("strategy");
        match error {
            Error::Stopped(stopped) => stopped.into(),
            Error::Source(source) => source.into(),
            Error::NoBall => Self::new(Code::InvalidRequest, detail)
                .blaming(&root.field("tool").field("shape"), FieldCode::Unsupported),
            Error::NotSmooth(joint) => joint.into(),
            Error::NoWayPast => {
                let at = root.field("boundary");
                Self::new(Code::NotSmooth, detail).blaming(&at, FieldCode::Unsupported)
            }
            Error::Overhang { at } => Self::new(Code::Overhang, detail).at(at.into()),
            Error::OffsetFolds { at } => Self::new(Code::OffsetFolds, detail).at(at.into()),
            Error::Heights(heights) => heights.into(),
            Error::ToleranceBelowResolution { tolerance_mm: _, decimals: _, least_mm: _ } => {
                Self::new(Code::ToleranceBelowDecimals, detail)
                    .blaming(&root.field("tolerance_mm"), FieldCode::ToleranceBelowDecimals)
                    .blaming(&root.field("program").field("decimals"), FieldCode::ToleranceBelowDecimals)
            }
            Error::ToleranceNotReached { tolerance_mm: _, deviation_mm: _, at } => {
                Self::new(Code::ToleranceNotReached, detail).at(at.into())
            }
            Error::TooMuchWork { what: _, needed: _, limit: _ } => {
                Self::new(Code::LimitExceeded, detail).blaming(&strategy, FieldCode::LimitExceeded)
            }
            Error::NothingToCut => Self::new(Code::NothingToCut, detail),
            Error::SectionLost { at } => Self::new(Code::SectionLost, detail).at(at.into()),
            Error::Quantize(quantize) => quantize.into(),
            Error::Path(PathError::TooManyMoves { limit: _ }) => {
                let detail = format!("{detail}: send a larger spacing of passes or a larger tolerance");
                Self::new(Code::LimitExceeded, detail).blaming(&strategy, FieldCode::LimitExceeded)
            }
            Error::TooManyPoints { limit: _ } => {
                let error = Self::new(Code::LimitExceeded, detail);
                error
                    .blaming(&root.field("step_length_mm"), FieldCode::LimitExceeded)
                    .blaming(&strategy, FieldCode::LimitExceeded)
            }
            Error::Path(_) => Self::new(Code::InternalError, detail),
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
                Error::Heights(HeightError::BelowTop { field: "retract_z_mm", value_mm: 1.0, top_mm: 2.0 }),
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
