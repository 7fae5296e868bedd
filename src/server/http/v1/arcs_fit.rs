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

use crate::http::answer::encoded::Encoded;
use crate::http::answer::program_stream::{ProgramStream, Streams};
use crate::http::answer::{Cut, Outcome, ProvedCut, answer};
use crate::http::app::App;
use crate::http::dto::answer::{Answer, Head, PathMembers};
use crate::http::dto::arc_fitting::{AnyFitReport, FitRequest, ProgramQuery};
use crate::http::dto::setup::JobWithSetup;
use crate::http::error::ApiError;
use crate::http::messages::Warning;
use crate::http::request::body::{BodyLimits, JobBody, media_type};
use crate::http::request::negotiation::{Offers, Toolpaths, Wanted};
use crate::http::request::representation::{GCODE, Representation};
use toolpathd_core::budget::Budget;
use toolpathd_core::operations::arc_fitting::{self, Job, Plan};
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
        None => looks_like_program(app.body_limits, request).await?,
        Some(name) if is_form(&name) => looks_like_program(app.body_limits, request).await?,
        Some(_) => (false, request),
    };
    if is_program {
        return fit_program(&app.streams, request).await;
    }
    let (mut parts, body) = request.into_parts();
    let wanted = Wanted::<Toolpaths>::from_request_parts(&mut parts, &app).await?;
    let body = JobBody::<FitRequest>::from_request(Request::from_parts(parts, body), &app).await?;
    answer(app.computing.clone(), wanted, body, fit).await
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

/// Whether this is the media type that `curl -d` sends unless told otherwise.
pub fn is_form(media_type: &str) -> bool {
    media_type == "application/x-www-form-urlencoded"
}

/// Whether a body without a media type is an NC program. A program begins with `%`, `/`, a comment, or a
/// letter and a digit; JSON never does. Returns the request with its whole body. A body with a content coding
/// counts as JSON.
pub async fn looks_like_program(limits: BodyLimits, request: Request) -> Result<(bool, Request), ApiError> {
    if request.headers().contains_key(header::CONTENT_ENCODING) {
        return Ok((false, request));
    }
    let (parts, mut body) = request.into_parts();
    let Some(first) = limits.next_bytes(&mut body).await? else {
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
async fn fit_program(streams: &Streams, request: Request) -> Result<Response, ApiError> {
    let (mut parts, body) = request.into_parts();
    let Wanted { form, query } = Wanted::<ProgramForms>::from_request_parts(&mut parts, &()).await?;
    let job = query.job()?;
    let stream = ProgramStream::begin(streams, Request::from_parts(parts, body), Rewriter::new(job))?;
    if form.representation == Representation::Gcode {
        let file_name = format!("arcs.{}", job.dialect.file_extension);
        return stream.text(form.media_type, &file_name).await;
    }
    let report = AnyFitReport::Program(stream.figures().await?);
    let head = Head::new(None, Vec::new());
    Ok(Encoded::json(&Answer { head, report, members: PathMembers::default(), glb: None, points: None })?
        .into_response())
}

/// The forms of the answer to an NC program: its rewritten text, or its report as JSON.
enum ProgramForms {}

impl Offers for ProgramForms {
    const OFFERS: &'static [Representation] = &[Representation::Gcode, Representation::Json];
    const PARAMETERS: &'static [&'static str] = &["format"];
    type Query = ProgramQuery;
}

fn fit(job: JobWithSetup<Job>, budget: &Budget) -> Result<Outcome<AnyFitReport, ProvedCut>, ApiError> {
    let JobWithSetup { job, setup, meta } = job;
    let Plan { toolpath, deviations_mm, joints, report, cutting, warnings } =
        arc_fitting::plan(&job, budget)?;
    let comments = vec![proved(&report)];
    let mut polyline: Vec<Point3<f64>> = job.points;
    if job.fit.is_closed {
        polyline.extend(polyline.first().copied());
    }
    Ok(Outcome {
        meta,
        warnings: warnings.iter().map(Warning::from).collect(),
        report: AnyFitReport::Polyline(report),
        product: ProvedCut { cut: Cut { toolpath, cutting, setup, comments, nc: None }, deviations_mm },
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
