//! Problem documents for the failures of interpolation.

use crate::http::error::{ApiError, Code, FieldCode, FieldError};
use crate::http::pointer::Pointer;
use toolpathd_core::geometry::plane_curve::interpolant::InterpolantError;
use toolpathd_core::geometry::plane_curve::nurbs::NurbsError;
use toolpathd_core::geometry::plane_curve::weights::WeightError;
use toolpathd_core::language::expression::Undefined;
use toolpathd_core::operations::interpolation::{CompensationError, Error, SourceError};

impl From<Error> for ApiError {
    fn from(error: Error) -> Self {
        let detail = error.to_string();
        let root = Pointer::root();
        let unsupported = |at: Pointer, detail: String| {
            Self::new(Code::Unsupported, detail).blaming(&at, FieldCode::Unsupported)
        };
        match error {
            Error::Stopped(stopped) => stopped.into(),
            Error::Source(source) => source.into(),
            Error::VerticalWithoutGraph => {
                let at = root.field("band").field("measure");
                Self::invalid(vec![FieldError::new(&at, FieldCode::Conflict, detail)])
            }
            Error::JointsInBand => unsupported(root.field("joints"), detail),
            Error::CompensatedParabola => unsupported(root.field("compensation"), detail),
            Error::TooManyElements { limit: _ } | Error::TooManySteps { limit: _ } => {
                Self::new(Code::LimitExceeded, detail).blaming(&root.field("band"), FieldCode::LimitExceeded)
            }
            Error::BandInfeasible { at } => {
                let band = root.field("band");
                Self::new(Code::BandInfeasible, detail)
                    .blaming(&band, FieldCode::OutOfRange)
                    .at([at.x, at.y, 0.0])
            }
            Error::Compensation(compensation) => compensation.into(),
            Error::Heights(heights) => heights.into(),
            Error::Quantize(quantize) => quantize.into(),
            Error::Path(_) => Self::new(Code::InternalError, detail),
        }
    }
}

impl From<CompensationError> for ApiError {
    fn from(error: CompensationError) -> Self {
        let detail = error.to_string();
        let root = Pointer::root();
        match error {
            CompensationError::Stopped(stopped) => stopped.into(),
            CompensationError::NothingLeft => {
                let diameter = root.field("tool").field("diameter_mm");
                Self::new(Code::NothingToCut, detail).blaming(&diameter, FieldCode::OutOfRange)
            }
            CompensationError::Gouges { at } => {
                Self::new(Code::ToleranceNotReached, detail).at([at.x, at.y, 0.0])
            }
            CompensationError::TooMany { limit: _ } => {
                Self::new(Code::LimitExceeded, detail).blaming(&root.field("band"), FieldCode::LimitExceeded)
            }
        }
    }
}

impl From<SourceError> for ApiError {
    fn from(error: SourceError) -> Self {
        let detail = error.to_string();
        let curve = Pointer::root().field("curve");
        let expression = curve.field("expression");
        let one = |error: FieldError| Self::invalid(vec![error]);
        match error {
            SourceError::Expression(fault) => {
                one(FieldError::in_text(&expression, fault.at, FieldCode::Syntax, detail))
            }
            SourceError::Undefined(undefined) => match undefined {
                Undefined::Stopped(stopped) => stopped.into(),
                Undefined::NoDomain => {
                    one(FieldError::new(&curve.field("domain"), FieldCode::OutOfRange, detail))
                }
                Undefined::At { at, .. } | Undefined::Near { at, .. } | Undefined::NotRuledOut { at, .. } => {
                    one(FieldError::in_text(&expression, at, FieldCode::Undefined, detail))
                }
            },
            SourceError::TooLarge { .. } => one(FieldError::new(&expression, FieldCode::TooLarge, detail)),
            SourceError::Interpolant(fault) => {
                let points = curve.field("points");
                let (at, code) = match fault {
                    InterpolantError::TooFewPoints { .. } => (points, FieldCode::TooFewPoints),
                    InterpolantError::Point { index } => (points.index(index), FieldCode::TooLarge),
                    InterpolantError::Coincident { index } => (points.index(index), FieldCode::Coincident),
                    InterpolantError::Piece(_) | InterpolantError::Chain(_) => {
                        (points, FieldCode::OutOfRange)
                    }
                };
                one(FieldError::new(&at, code, detail))
            }
            SourceError::Nurbs(fault) => nurbs(fault, &curve, detail),
            SourceError::SectionCurve(fault) => {
                one(FieldError::in_text(&curve.field("text"), fault.at, FieldCode::Syntax, detail))
            }
            SourceError::InSpace => {
                one(FieldError::new(&curve.field("text"), FieldCode::Unsupported, detail))
            }
        }
    }
}

fn nurbs(fault: NurbsError, curve: &Pointer, detail: String) -> ApiError {
    let (at, code) = match fault {
        NurbsError::Degree { .. } => (curve.field("degree"), FieldCode::OutOfRange),
        NurbsError::TooFewPoints { .. } => (curve.field("control_points"), FieldCode::TooFewPoints),
        NurbsError::Point { index } => (curve.field("control_points").index(index), FieldCode::TooLarge),
        NurbsError::Knots(_) => (curve.field("knots"), FieldCode::OutOfRange),
        NurbsError::Weights(WeightError::Count { .. }) => (curve.field("weights"), FieldCode::WrongLength),
        NurbsError::Weights(WeightError::Range { index, .. } | WeightError::Ratio { index, .. }) => {
            (curve.field("weights").index(index), FieldCode::OutOfRange)
        }
        NurbsError::Gap { .. } => (curve.field("knots"), FieldCode::OutOfRange),
        NurbsError::Chain(_) | NurbsError::Piece(_) => (curve.clone(), FieldCode::OutOfRange),
    };
    ApiError::invalid(vec![FieldError::new(&at, code, detail)])
}
