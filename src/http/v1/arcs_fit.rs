//! `POST /v1/arcs/fit`: a polyline goes in, the fewest arcs and lines come out.

use std::sync::Arc;

use axum::extract::State;
use axum::response::Response;
use nalgebra::Point3;

use crate::budget::Budget;
use crate::http::App;
use crate::http::answer::{Cut, Outcome, answer};
use crate::http::dto::answer::Answer;
use crate::http::dto::arc_fitting::{FitJob, FitReport, FitRequest};
use crate::http::dto::toolpath::{Warning, WarningCode};
use crate::http::error::{ApiError, Code, FieldCode, FieldError};
use crate::http::extract::JobBody;
use crate::http::pointer::Pointer;
use crate::http::wanted::{Toolpaths, Wanted};
use crate::operations::arc_fitting::{self, Error, Plan};
use crate::plot::Drawing;

/// Fits the fewest arcs and lines to a polyline and answers them, the NC program that runs them, or a picture.
#[utoipa::path(post, path = "/v1/arcs/fit", operation_id = "fitArcs", tag = "curves",
    params(Wanted<Toolpaths>), request_body = FitRequest,
    responses((status = 200, description = "The elements, in one of their forms.", body = Answer<FitReport>)))]
pub async fn fit_arcs(
    State(app): State<Arc<App>>,
    wanted: Wanted<Toolpaths>,
    body: JobBody<FitRequest>,
) -> Result<Response, ApiError> {
    answer(&app, wanted, body, fit).await
}

fn fit(job: FitJob, budget: &Budget) -> Result<Outcome<FitReport>, ApiError> {
    let FitJob { job, tool, program, dialect, meta } = job;
    let Plan { toolpath, joints, report, cutting, warnings } = arc_fitting::plan(&job, budget)?;
    let comments = vec![proved(&report)];
    let mut polyline: Vec<Point3<f64>> = job.points;
    if job.fit.is_closed {
        polyline.extend(polyline.first().copied());
    }
    Ok(Outcome {
        meta,
        warnings: warnings.iter().map(Warning::from).collect(),
        cut: Some(Cut { toolpath, tool, cutting, program, dialect, comments }),
        report: FitReport::from(report),
        nc: None,
        drawing: Box::new(move || Drawing {
            curve: vec![polyline.clone()],
            joints: joints.clone(),
            ..Drawing::default()
        }),
    })
}

/// The figures for a program's header, rounded up.
fn proved(report: &arc_fitting::Report) -> String {
    let up = |mm: f64| (mm * 1e4).ceil() / 1e4;
    format!(
        "{} ARCS AND {} LINES FOR {} POINTS - DEVIATION {:.4} MM",
        report.n_arcs,
        report.n_lines,
        report.n_points,
        up(report.deviation_max_mm)
    )
}

impl From<&arc_fitting::Warning> for Warning {
    fn from(warning: &arc_fitting::Warning) -> Self {
        let (code, detail) = match warning {
            arc_fitting::Warning::RoundingExceedsTolerance { deviation_mm } => (
                WarningCode::RoundingExceedsTolerance,
                format!(
                    "the program rounds to its decimals: it may be {deviation_mm} mm from the points, beyond the tolerance; more decimals would help"
                ),
            ),
            arc_fitting::Warning::CoarseSamples { deviation_mm } => (
                WarningCode::CoarseSamples,
                format!(
                    "the points are taken as samples of a smooth curve; from the lines between them the elements are up to {deviation_mm} mm away; where the lines are the shape, ask for `measure: polyline`"
                ),
            ),
            arc_fitting::Warning::ToleranceExceeded { deviation_mm } => (
                WarningCode::ToleranceExceeded,
                format!(
                    "this method knows no tolerance: its elements are up to {deviation_mm} mm away, by the measure that was asked for"
                ),
            ),
        };
        Self { code, detail }
    }
}

impl From<Error> for ApiError {
    fn from(error: Error) -> Self {
        let detail = error.to_string();
        match error {
            Error::Stopped(stopped) => stopped.into(),
            Error::OnePlace => {
                let at = Pointer::root().field("polyline");
                Self::invalid(vec![FieldError::new(&at, FieldCode::Coincident, detail)])
            }
            Error::Heights(heights) => heights.into(),
            Error::Quantize(quantize) => quantize.into(),
            Error::Arc(_) | Error::Path(_) => Self::new(Code::InternalError, detail),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::budget::Stopped;
    use crate::geometry::curve::ArcError;
    use crate::toolpath::PathError;
    use crate::toolpath::quantize::QuantizeError;

    #[test]
    fn every_failure_has_its_code() {
        let code = |error: Error| ApiError::from(error).code();
        assert_eq!(code(Error::Stopped(Stopped::DeadlinePassed)), Code::DeadlinePassed);
        assert_eq!(code(Error::OnePlace), Code::InvalidRequest);
        assert_eq!(ApiError::from(Error::OnePlace).errors()[0].pointer, "#/polyline");
        assert_eq!(code(Error::Quantize(QuantizeError::TooManyPieces { limit: 7 })), Code::LimitExceeded);
        assert_eq!(code(Error::Arc(ArcError::ZeroRadius)), Code::InternalError);
        assert_eq!(code(Error::Path(PathError::NotFinite)), Code::InternalError);
    }
}
