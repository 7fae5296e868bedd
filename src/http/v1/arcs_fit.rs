//! `POST /v1/arcs/fit`: a polyline goes in, the fewest arcs and lines come out; or an NC program, and the same program comes out
//! with arcs in place of its runs of short lines.

use std::sync::Arc;

use axum::body::Body;
use axum::extract::{FromRequest, FromRequestParts, Request, State};
use axum::http::header;
use axum::response::{IntoResponse, Response};
use futures_util::StreamExt;
use futures_util::future::ready;
use futures_util::stream::once;
use nalgebra::Point3;

use crate::budget::Budget;
use crate::http::answer::{Cut, Outcome, answer};
use crate::http::dto::answer::Answer;
use crate::http::dto::arc_fitting::{AnyFitReport, FitJob, FitRequest, ProgramQuery};
use crate::http::dto::toolpath::{Warning, WarningCode};
use crate::http::error::{ApiError, Code, FieldCode, FieldError};
use crate::http::extract::{JobBody, StrictQuery, media_type, next_bytes};
use crate::http::output::{self, Encoded, GCODE, Representation};
use crate::http::pointer::Pointer;
use crate::http::program_stream::ProgramStream;
use crate::http::request_id::RequestId;
use crate::http::wanted::{STREAMS, Toolpaths, Wanted};
use crate::http::{App, ENGINE_VERSION};
use crate::operations::arc_fitting::{self, Error, Plan};
use crate::plot::Drawing;
use crate::post::rewrite::Rewriter;
use crate::toolpath::units::rounded_up_mm;

/// Fits the fewest arcs and lines to a polyline and answers them, the NC program that runs them, or a picture.
///
/// With a body of NC text the answer is NC text (or, by `Accept`, the figures alone): the same program, in which runs of G1
/// have become arcs, helices and longer lines, and everything else stays byte for byte. It is read and answered as a stream,
/// of any length.
#[utoipa::path(post, path = "/v1/arcs/fit", operation_id = "fitArcs", tag = "curves",
    params(Wanted<Toolpaths>, ProgramQuery),
    request_body(content((FitRequest = "application/json"), (String = "text/x-gcode"))),
    responses((status = 200, description = "The elements, in one of their forms.", body = Answer<AnyFitReport>)))]
pub async fn fit_arcs(State(app): State<Arc<App>>, request: Request) -> Result<Response, ApiError> {
    let (is_program, request) = match media_type(request.headers()) {
        Some(name) if GCODE.contains(&name.as_str()) => (true, request),
        // No type, or what curl says of `-d` when told nothing.
        None => looks_like_program(&app, request).await?,
        Some(name) if name == "application/x-www-form-urlencoded" => {
            looks_like_program(&app, request).await?
        }
        Some(_) => (false, request),
    };
    if is_program {
        return fit_program(&app, request).await;
    }
    let (mut parts, body) = request.into_parts();
    let wanted = Wanted::<Toolpaths>::from_request_parts(&mut parts, &app).await?;
    let body = JobBody::<FitRequest>::from_request(Request::from_parts(parts, body), &app).await?;
    answer(&app, wanted, body, fit).await
}

/// As `POST`: what `curl -T` sends, a program that is put where it becomes another one.
#[utoipa::path(put, path = "/v1/arcs/fit", operation_id = "putArcs", tag = "curves",
    params(Wanted<Toolpaths>, ProgramQuery),
    request_body(content((FitRequest = "application/json"), (String = "text/x-gcode"))),
    responses((status = 200, description = "The elements, in one of their forms.", body = Answer<AnyFitReport>)))]
pub async fn put_arcs(state: State<Arc<App>>, request: Request) -> Result<Response, ApiError> {
    fit_arcs(state, request).await
}

/// Whether a body without a type of its own begins as NC text does, as JSON never does: with a mark, a comment, or a letter with a
/// number. The request comes back with its body whole. Coded bodies are taken for JSON.
async fn looks_like_program(app: &Arc<App>, request: Request) -> Result<(bool, Request), ApiError> {
    if request.headers().contains_key(header::CONTENT_ENCODING) {
        return Ok((false, request));
    }
    let (parts, mut body) = request.into_parts();
    let Some(first) = next_bytes(&mut body, app).await? else {
        return Ok((false, Request::from_parts(parts, body)));
    };
    let is_program = match first.trim_ascii_start() {
        [b'%' | b'(' | b';' | b'/', ..] => true,
        [letter, digit, ..] => letter.is_ascii_alphabetic() && digit.is_ascii_digit(),
        _ => false,
    };
    let rest = body.into_data_stream();
    let body = Body::from_stream(once(ready(Ok(first))).chain(rest));
    Ok((is_program, Request::from_parts(parts, body)))
}

async fn fit_program(app: &Arc<App>, request: Request) -> Result<Response, ApiError> {
    let (mut parts, body) = request.into_parts();
    let request_id = RequestId::from_request_parts(&mut parts, app).await?;
    let StrictQuery(query) = StrictQuery::<ProgramQuery>::from_request_parts(&mut parts, app).await?;
    let (representation, media_type) = output::choose(STREAMS, &parts.headers, query.representation)?;
    let job = query.job()?;
    let stream = ProgramStream::begin(app, Request::from_parts(parts, body), Rewriter::new(job))?;
    if representation == Representation::Gcode {
        let file_name = format!("arcs.{}", job.dialect.file_extension);
        return stream.text(media_type, &file_name).await;
    }
    let report = AnyFitReport::Program(stream.figures().await?.into());
    Ok(Encoded::json(&Answer::of_report(ENGINE_VERSION, request_id.as_str(), report))?.into_response())
}

fn fit(job: FitJob, budget: &Budget) -> Result<Outcome<AnyFitReport>, ApiError> {
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
        report: AnyFitReport::Polyline(report.into()),
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
    format!(
        "{} ARCS AND {} LINES FOR {} POINTS - WITHIN {:.4} MM AS WRITTEN",
        report.n_arcs,
        report.n_lines,
        report.n_points,
        rounded_up_mm(report.deviation_written_max_mm)
    )
}

impl From<&arc_fitting::Warning> for Warning {
    fn from(warning: &arc_fitting::Warning) -> Self {
        let (code, detail) = match warning {
            arc_fitting::Warning::RoundingExceedsTolerance { deviation_mm } => (
                WarningCode::RoundingExceedsTolerance,
                format!(
                    "the program rounds to its decimals: it may be {:.4} mm from the points, beyond the tolerance; more decimals would help",
                    rounded_up_mm(*deviation_mm)
                ),
            ),
            arc_fitting::Warning::CoarseSamples { deviation_mm } => (
                WarningCode::CoarseSamples,
                format!(
                    "the points are taken as samples of a smooth curve; from the lines between them the elements are up to {:.4} mm away; where the lines are the shape, ask for `measure: polyline`",
                    rounded_up_mm(*deviation_mm)
                ),
            ),
            arc_fitting::Warning::ToleranceExceeded { deviation_mm } => (
                WarningCode::ToleranceExceeded,
                format!(
                    "this method knows no tolerance: its elements are up to {:.4} mm away, by the measure that was asked for",
                    rounded_up_mm(*deviation_mm)
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
            Error::Path(_) => Self::new(Code::InternalError, detail),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::budget::Stopped;
    use crate::toolpath::PathError;
    use crate::toolpath::quantize::QuantizeError;

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
