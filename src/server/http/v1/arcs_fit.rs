//! `POST /v1/arcs/fit`: fits the fewest arcs and lines to a polyline. In an NC program, it replaces
//! consecutive short lines by arcs and longer lines.

use std::sync::Arc;

use axum::body::Body;
use axum::extract::{FromRequest, FromRequestParts, Request, State};
use axum::http::header;
use axum::response::{IntoResponse, Response};
use futures_util::StreamExt;
use futures_util::future::ready;
use futures_util::stream::once;
use nalgebra::Point3;

use crate::http::App;
use crate::http::answer::{Cut, Outcome, answer};
use crate::http::dto::answer::{Answer, Head, PathMembers};
use crate::http::dto::arc_fitting::{AnyFitReport, FitRequest, ProgramQuery};
use crate::http::dto::setup::JobWithSetup;
use crate::http::dto::toolpath::{Warning, WarningCode};
use crate::http::error::{ApiError, Code, FieldCode, FieldError};
use crate::http::extract::{JobBody, media_type, next_bytes};
use crate::http::negotiation::{Offers, Toolpaths, Wanted};
use crate::http::output::{Encoded, GCODE, Representation};
use crate::http::pointer::Pointer;
use crate::http::program_stream::ProgramStream;
use toolpathd_core::budget::Budget;
use toolpathd_core::operations::arc_fitting::{self, Error, Job, Plan};
use toolpathd_core::toolpath::units::rounded_up;
use toolpathd_plot::Drawing;
use toolpathd_post::rewrite::Rewriter;

/// The answer in JSON.
type AnyFitAnswer = Answer<AnyFitReport>;

/// Replace points, or the G1 blocks of an NC program, by arcs and lines.
///
/// With a body of JSON the answer is the elements, the NC program that runs the elements, or a picture. With
/// a body of NC text the answer is the same program with arcs, helices and longer lines in place of runs of
/// G1 blocks; everything else stays byte for byte. With a body of NC text and `Accept: application/json` the
/// answer is the report alone. NC text is read and answered as a stream; a program may have as many bytes as
/// `stream_bytes` of `/v1/limits`.
#[utoipa::path(post, path = "/v1/arcs/fit", operation_id = "fitArcs", tag = "curves",
    params(Wanted<Toolpaths>, ProgramQuery),
    request_body(content((FitRequest = "application/json"), (String = "text/x-gcode"))),
    responses((status = 200, description = "The elements, the program or a picture.", body = AnyFitAnswer)))]
pub async fn fit_arcs(State(app): State<Arc<App>>, request: Request) -> Result<Response, ApiError> {
    let (is_program, request) = match media_type(request.headers()) {
        Some(name) if GCODE.contains(&name.as_str()) => (true, request),
        // `curl -T` sends no type, and `curl -d` sends the type of a form unless told otherwise.
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

/// The same as `POST`, for `curl -T`.
///
/// `curl -T program.ngc` sends a file with `PUT`.
#[utoipa::path(put, path = "/v1/arcs/fit", operation_id = "putArcs", tag = "curves",
    params(Wanted<Toolpaths>, ProgramQuery),
    request_body(content((FitRequest = "application/json"), (String = "text/x-gcode"))),
    responses((status = 200, description = "The elements, the program or a picture.", body = AnyFitAnswer)))]
pub async fn put_arcs(state: State<Arc<App>>, request: Request) -> Result<Response, ApiError> {
    fit_arcs(state, request).await
}

/// Whether a body without a media type is an NC program. A program begins with `%`, `/`, a comment, or a
/// letter and a digit; JSON never does. Returns the request with its whole body. A body with a content coding
/// counts as JSON.
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

/// Rewrites an NC program as a stream and answers the text, or its report alone.
async fn fit_program(app: &Arc<App>, request: Request) -> Result<Response, ApiError> {
    let (mut parts, body) = request.into_parts();
    let Wanted { form, query } = Wanted::<Streams>::from_request_parts(&mut parts, app).await?;
    let job = query.job()?;
    let stream = ProgramStream::begin(app, Request::from_parts(parts, body), Rewriter::new(job))?;
    if form.representation == Representation::Gcode {
        let file_name = format!("arcs.{}", job.dialect.file_extension);
        return stream.text(form.media_type, &file_name).await;
    }
    let report = AnyFitReport::Program(stream.figures().await?.into());
    let head = Head::new(None, Vec::new());
    Ok(Encoded::json(&Answer { head, report, members: PathMembers::default() })?.into_response())
}

/// The forms of the answer to an NC program: its rewritten text, or its report as JSON.
enum Streams {}

impl Offers for Streams {
    const OFFERS: &'static [Representation] = &[Representation::Gcode, Representation::Json];
    const PARAMETERS: &'static [&'static str] = &["format"];
    type Query = ProgramQuery;
}

fn fit(job: JobWithSetup<Job>, budget: &Budget) -> Result<Outcome<AnyFitReport, Cut>, ApiError> {
    let JobWithSetup { job, setup, meta } = job;
    let Plan { toolpath, joints, report, cutting, warnings } = arc_fitting::plan(&job, budget)?;
    let comments = vec![proved(&report)];
    let mut polyline: Vec<Point3<f64>> = job.points;
    if job.fit.is_closed {
        polyline.extend(polyline.first().copied());
    }
    Ok(Outcome {
        meta,
        warnings: warnings.iter().map(Warning::from).collect(),
        report: AnyFitReport::Polyline(report.into()),
        product: Cut { toolpath, cutting, setup, comments, nc: None },
        drawing: Box::new(move || Drawing {
            curve: vec![polyline.clone()],
            joints: joints.clone(),
            ..Drawing::default()
        }),
    })
}

/// The line with the figures of the fit for the program's header. The distance is rounded up.
fn proved(report: &arc_fitting::Report) -> String {
    format!(
        "{} ARCS AND {} LINES FOR {} POINTS - WITHIN {:.4} MM AS WRITTEN",
        report.n_arcs,
        report.n_lines,
        report.n_points,
        rounded_up(report.deviation_written_max_mm)
    )
}

impl From<&arc_fitting::Warning> for Warning {
    fn from(warning: &arc_fitting::Warning) -> Self {
        let (code, detail) = match warning {
            arc_fitting::Warning::RoundingExceedsTolerance { deviation_mm } => (
                WarningCode::RoundingExceedsTolerance,
                format!(
                    "rounding to the program's decimals moves the path up to {:.4} mm from the points, beyond the tolerance: send more `decimals`",
                    rounded_up(*deviation_mm)
                ),
            ),
            arc_fitting::Warning::CoarseSamples { deviation_mm } => (
                WarningCode::CoarseSamples,
                format!(
                    "the elements are up to {:.4} mm from the straight lines between the points: if the part really consists of these straight lines, send `measure: polyline`",
                    rounded_up(*deviation_mm)
                ),
            ),
            arc_fitting::Warning::ToleranceExceeded { deviation_mm } => (
                WarningCode::ToleranceExceeded,
                format!(
                    "`method: biarc` ignores the tolerance: the elements are up to {:.4} mm from the straight lines between the points",
                    rounded_up(*deviation_mm)
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
