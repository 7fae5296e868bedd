//! Arcs and lines for points, and NC programs that are rewritten.

use super::{Warning, WarningCode, member, violation};
use crate::http::error::{ApiError, Code, FieldCode};
use toolpathd_core::operations::arc_fitting::{self, Error};
use toolpathd_core::toolpath::units::rounded_up;
use toolpathd_post::rewrite::RewriteError;

impl From<&arc_fitting::Warning> for Warning {
    fn from(warning: &arc_fitting::Warning) -> Self {
        use arc_fitting::Warning as Of;
        let fact = warning.to_string();
        let (code, detail) = match *warning {
            Of::RoundingExceedsTolerance { .. } => {
                (WarningCode::RoundingExceedsTolerance, format!("{fact}: send more `decimals`"))
            }
            Of::CoarseSamples { .. } => {
                let advice = "if the part really consists of these straight lines, send `measure: polyline`";
                (WarningCode::CoarseSamples, format!("{fact}: {advice}"))
            }
            Of::RadiusLimited { .. } => {
                let advice =
                    "choose the dialect of your control, whose `largest_radius_mm` `/v1/dialects` states";
                (WarningCode::RadiusLimited, format!("{fact}: {advice}"))
            }
            Of::ToleranceExceeded { deviation_mm } => (
                WarningCode::ToleranceExceeded,
                format!(
                    "`method: biarc` ignores the tolerance: the elements are up to {:.4} mm from the straight lines between the points",
                    rounded_up(deviation_mm)
                ),
            ),
        };
        Self::new(code, detail)
    }
}

impl From<Error> for ApiError {
    fn from(error: Error) -> Self {
        let fact = error.to_string();
        match error {
            Error::Stopped(stopped) => stopped.into(),
            Error::OnePlace => violation(&member("/polyline"), FieldCode::Coincident, fact),
            Error::Heights(heights) => heights.into(),
            Error::Quantize(quantize) => quantize.into(),
            Error::Path(_) => Self::new(Code::InternalError, fact),
        }
    }
}

impl From<RewriteError> for ApiError {
    fn from(error: RewriteError) -> Self {
        let fact = error.to_string();
        match error {
            RewriteError::Stopped(stopped) => stopped.into(),
            RewriteError::LineTooLong { .. } | RewriteError::LateJump { .. } => {
                Self::new(Code::LimitExceeded, fact)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use toolpathd_core::budget::Stopped;
    use toolpathd_core::toolpath::PathError;
    use toolpathd_core::toolpath::quantize::QuantizeError;

    #[test]
    fn every_failure_has_its_code() {
        let code = |error: Error| ApiError::from(error).code();
        assert_eq!(code(Error::Stopped(Stopped::DeadlinePassed)), Code::DeadlinePassed);
        assert_eq!(code(Error::OnePlace), Code::InvalidRequest);
        assert_eq!(ApiError::from(Error::OnePlace).errors()[0].pointer, "#/polyline");
        assert_eq!(code(Error::Quantize(QuantizeError::TooManyPieces { limit: 7 })), Code::LimitExceeded);
        assert_eq!(code(Error::Path(PathError::NotFinite)), Code::InternalError);
    }
}
