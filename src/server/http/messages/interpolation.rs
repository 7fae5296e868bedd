//! Plane curves, and the elements that replace them.

use super::{Warning, WarningCode, in_plane, member, too_large, violation};
use crate::http::error::{ApiError, Code, FieldCode, FieldError};
use crate::http::pointer::Pointer;
use toolpathd_core::geometry::plane_curve::interpolant::InterpolantError;
use toolpathd_core::geometry::plane_curve::nurbs::NurbsError;
use toolpathd_core::geometry::plane_curve::weights::WeightError;
use toolpathd_core::language::expression::Undefined;
use toolpathd_core::operations::interpolation::{
    self, BandSide, CompensationError, Error, SourceError, WidthError,
};

impl From<&interpolation::Warning> for Warning {
    fn from(warning: &interpolation::Warning) -> Self {
        use interpolation::Warning as Of;
        let fact = warning.to_string();
        let (code, detail) = match warning {
            Of::RoundingLeavesBand { .. } => {
                (WarningCode::RoundingLeavesBand, format!("{fact}: send more `decimals`"))
            }
            Of::ContourNotReached { .. } => (WarningCode::ContourNotReached, fact),
        };
        Self::new(code, detail)
    }
}

impl From<Error> for ApiError {
    fn from(error: Error) -> Self {
        let fact = error.to_string();
        let unsupported = |path: &str, detail: String| {
            Self::new(Code::Unsupported, detail).blaming(&member(path), FieldCode::Unsupported)
        };
        match error {
            Error::Stopped(stopped) => stopped.into(),
            Error::Source(source) => source.into(),
            Error::VerticalWithoutGraph => {
                let detail = "the measure `vertical` supports graphs y(x) only; use the measure `normal`";
                violation(&member("/band/measure"), FieldCode::Conflict, detail.to_owned())
            }
            Error::Width { side, error } => width(side, error, fact),
            Error::JointsInBand => {
                let detail = "joints in the band are supported with the method `linear` only";
                unsupported("/joints", detail.to_owned())
            }
            Error::CompensatedParabola => {
                unsupported("/compensation", format!("{fact}; use the method `linear` or `arc`"))
            }
            Error::TooManyElements { .. } | Error::TooManySteps { .. } => too_large("/band", fact),
            Error::BandInfeasible { at } => Self::new(Code::BandInfeasible, fact)
                .blaming(&member("/band"), FieldCode::OutOfRange)
                .at(in_plane(at)),
            Error::Compensation(compensation) => compensation.into(),
            Error::Heights(heights) => heights.into(),
            Error::Quantize(quantize) => quantize.into(),
            Error::Path(_) => Self::new(Code::InternalError, fact),
        }
    }
}

impl From<CompensationError> for ApiError {
    fn from(error: CompensationError) -> Self {
        let fact = error.to_string();
        match error {
            CompensationError::Stopped(stopped) => stopped.into(),
            CompensationError::NothingLeft => {
                let diameter = member("/tool/diameter_mm");
                Self::new(Code::NothingToCut, fact).blaming(&diameter, FieldCode::OutOfRange)
            }
            CompensationError::Gouges { at } => Self::new(Code::ToleranceNotReached, fact).at(in_plane(at)),
            CompensationError::TooMany { .. } => too_large("/band", fact),
        }
    }
}

impl From<SourceError> for ApiError {
    fn from(error: SourceError) -> Self {
        let fact = error.to_string();
        let curve = member("/curve");
        let expression = curve.field("expression");
        let one = |error: FieldError| Self::invalid(vec![error]);
        match error {
            SourceError::Expression(fault) => {
                one(FieldError::in_text(&expression, fault.at, FieldCode::Syntax, fact))
            }
            SourceError::Undefined(undefined) => match undefined {
                Undefined::Stopped(stopped) => stopped.into(),
                Undefined::NoDomain => violation(&curve.field("domain"), FieldCode::OutOfRange, fact),
                Undefined::At { at, .. } | Undefined::Near { at, .. } | Undefined::NotRuledOut { at, .. } => {
                    one(FieldError::in_text(&expression, at, FieldCode::Undefined, fact))
                }
            },
            SourceError::TooLarge { .. } => violation(&expression, FieldCode::TooLarge, fact),
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
                violation(&at, code, fact)
            }
            SourceError::Nurbs(fault) => nurbs(fault, &curve, fact),
            SourceError::SectionCurve(fault) => {
                one(FieldError::in_text(&curve.field("text"), fault.at, FieldCode::Syntax, fact))
            }
            SourceError::InSpace => violation(&curve.field("text"), FieldCode::Unsupported, fact),
        }
    }
}

/// A width of the band that is an expression.
fn width(side: BandSide, error: WidthError, fact: String) -> ApiError {
    let at = member("/band").field(match side {
        BandSide::Below => "below_mm",
        BandSide::Above => "above_mm",
    });
    let in_text = |place, code| ApiError::invalid(vec![FieldError::in_text(&at, place, code, fact.clone())]);
    match error {
        WidthError::Expression(fault) => in_text(fault.at, FieldCode::Syntax),
        WidthError::Undefined(undefined) => match undefined {
            Undefined::Stopped(stopped) => stopped.into(),
            Undefined::NoDomain => violation(&at, FieldCode::OutOfRange, fact),
            Undefined::At { at: place, .. }
            | Undefined::Near { at: place, .. }
            | Undefined::NotRuledOut { at: place, .. } => in_text(place, FieldCode::Undefined),
        },
        WidthError::TooWide { .. } => violation(&at, FieldCode::TooLarge, fact),
        WidthError::WithoutGraph | WidthError::JointsInBand => violation(&at, FieldCode::Conflict, fact),
    }
}

fn nurbs(fault: NurbsError, curve: &Pointer, fact: String) -> ApiError {
    let (at, code) = match fault {
        NurbsError::Degree { .. } => (curve.field("degree"), FieldCode::OutOfRange),
        NurbsError::TooFewPoints { .. } => (curve.field("control_points"), FieldCode::TooFewPoints),
        NurbsError::Point { index } => (curve.field("control_points").index(index), FieldCode::TooLarge),
        NurbsError::Knots(fault) => {
            let knots = curve.field("knots");
            (fault.index().map_or(knots.clone(), |index| knots.index(index)), FieldCode::OutOfRange)
        }
        NurbsError::NoEffect { index } => (curve.field("control_points").index(index), FieldCode::OutOfRange),
        NurbsError::Weights(WeightError::Count { .. }) => (curve.field("weights"), FieldCode::WrongLength),
        NurbsError::Weights(WeightError::Range { index, .. } | WeightError::Ratio { index, .. }) => {
            (curve.field("weights").index(index), FieldCode::OutOfRange)
        }
        NurbsError::Gap { .. } => (curve.field("knots"), FieldCode::OutOfRange),
        NurbsError::Chain(_) | NurbsError::Piece(_) => (curve.clone(), FieldCode::OutOfRange),
    };
    violation(&at, code, fact)
}
