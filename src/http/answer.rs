//! From a job to its answer: the computation on the pool, and the outcome in the form in which it is wanted.

pub mod sheet;

use std::sync::Arc;
use std::time::Instant;

use axum::Extension;
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use tracing::{Instrument, Span};
use utoipa::ToSchema;

use super::dto::answer::Answer;
use super::dto::check::MAX_MAGNITUDE_MM;
use super::dto::meta::Meta;
use super::dto::toolpath::{Measures, Warning};
use super::error::{ApiError, Code, FieldCode, FieldError};
use super::events;
use super::extract::{IntoJob, JobBody};
use super::output::{Encoded, Representation, file_name, page};
use super::pointer::Pointer;
use super::timing::{SERVER_TIMING, Timing};
use super::wanted::{Form, Wanted};
use super::{App, ENGINE_VERSION};
use crate::budget::Budget;
use crate::plot::Drawing;
use crate::post::{self, Dialect, ProgramJob};
use crate::toolpath::Toolpath;
use crate::toolpath::cutting::Cutting;
use crate::toolpath::measure::{Bounds, measure};
use crate::toolpath::program::Program;
use crate::toolpath::tool::Tool;
use crate::toolpath::units::FeedRate;

/// What a computation comes to, before it is known in which form it is wanted.
pub struct Outcome<R> {
    pub meta: Option<Meta>,
    pub warnings: Vec<Warning>,
    pub report: R,
    pub cut: Option<Cut>,
    /// The program, where the JSON answer is to hold it; else it is written when it is asked for.
    pub nc: Option<String>,
    /// Draws what a picture shows beside the toolpath.
    pub drawing: Box<dyn Fn() -> Drawing + Send>,
}

/// A toolpath with all that its program is written from.
pub struct Cut {
    pub toolpath: Toolpath,
    pub tool: Option<Tool>,
    /// Without them there are no feeds, and no program.
    pub cutting: Option<Cutting>,
    pub program: Program,
    pub dialect: &'static Dialect,
    /// What is to be said of it beside the caller's own `meta`, for the program's header and below the picture.
    pub comments: Vec<String>,
}

/// Computes `plan` of the body's job on the pool and answers what comes of it as it is wanted.
///
/// # Errors
/// When there is no place on the pool, or the plan or its representation fails; once events are streamed, failures
/// are among them.
pub async fn answer<O, T, R, F>(
    app: &Arc<App>,
    wanted: Wanted<O>,
    body: JobBody<T>,
    plan: F,
) -> Result<Response, ApiError>
where
    T: IntoJob,
    R: Serialize + ToSchema,
    F: FnOnce(T::Job, &Budget) -> Result<Outcome<R>, ApiError> + Send + 'static,
{
    let form = wanted.form;
    let request_id = form.request_id.clone();
    let is_streamed = form.representation == Representation::Events;
    let asked = Instant::now();
    let compute = move |budget: &Budget| {
        let begun = Instant::now();
        let outcome = plan(body.job, budget)?;
        let computed = Instant::now();
        let encoded = represent(outcome, &form, budget)?;
        let encoded = if is_streamed { encoded } else { encoded.sealed(form.with_gzip)? };
        let timing = Timing {
            queue: begun - asked,
            parse: body.parsing,
            compute: computed - begun,
            encode: computed.elapsed(),
        };
        Ok::<_, ApiError>((encoded, timing))
    };
    let ticket = app.compute.admit()?;
    if is_streamed {
        let app = Arc::clone(app);
        // The stream outlives the handler, and the span in which it was called.
        let span = Span::current();
        return Ok(events::stream(request_id, |listener| {
            let computation = async move {
                let (encoded, _) = app.compute.run_admitted(ticket, Some(listener), compute).await??;
                Ok(encoded)
            };
            computation.instrument(span)
        }));
    }
    let (encoded, timing) = app.compute.run_admitted(ticket, None, compute).await??;
    Ok(([(SERVER_TIMING, timing.header_value())], Extension(timing), encoded).into_response())
}

/// A curve through points within the range of coordinates may leave it between them.
fn check_range(toolpath: &Toolpath) -> Result<(), ApiError> {
    let Bounds { min, max } = measure(toolpath, FeedRate::DEFAULT_RAPID).bounds;
    let farthest = min.coords.amax().max(max.coords.amax());
    if farthest <= MAX_MAGNITUDE_MM {
        return Ok(());
    }
    let detail = format!("the toolpath reaches {farthest} mm; coordinates end at {MAX_MAGNITUDE_MM} mm");
    Err(ApiError::new(Code::LimitExceeded, detail))
}

/// What there is to say of any cut.
fn cautions<R>(outcome: &Outcome<R>) -> Vec<Warning> {
    let cut = outcome.cut.iter();
    let of = |cut: &Cut| cut.cutting.map(|cutting| cutting.cautions(cut.tool.as_ref(), &cut.program));
    cut.filter_map(of).flatten().map(Warning::from).collect()
}

/// The codes of warnings, each once, for a header.
fn warning_codes(warnings: &[Warning]) -> String {
    let mut codes: Vec<String> = Vec::new();
    for code in warnings.iter().map(|warning| warning.code.name()) {
        if !codes.contains(&code) {
            codes.push(code);
        }
    }
    codes.join(", ")
}

fn represent<R: Serialize + ToSchema>(
    mut outcome: Outcome<R>,
    form: &Form,
    budget: &Budget,
) -> Result<Encoded, ApiError> {
    if let Some(cut) = &outcome.cut {
        check_range(&cut.toolpath)?;
    }
    outcome.warnings.extend(cautions(&outcome));
    let codes = warning_codes(&outcome.warnings);
    if form.with_nc && outcome.nc.is_none() {
        outcome.nc = Some(written(&outcome, budget)?);
    }
    let encoded = match form.representation {
        Representation::Json | Representation::Events => Encoded::json(&envelope(outcome, form)),
        Representation::Gcode => program(outcome, form.media_type, budget),
        Representation::Svg => Ok(Encoded::text(sheet::picture(&outcome), form.media_type)),
        Representation::Html => {
            let (title, svg) = (sheet::title(&outcome), sheet::picture(&outcome));
            let bare = Form { with_toolpath: Some(false), with_nc: false, ..form.clone() };
            let figures = serde_json::to_value(envelope(outcome, &bare))
                .map_err(|error| ApiError::new(Code::InternalError, format!("writing JSON: {error}")))?;
            Ok(Encoded::text(page::page(&title, &svg, &figures), form.media_type))
        }
    }?;
    Ok(encoded.warning_of(&codes))
}

fn envelope<R: ToSchema>(outcome: Outcome<R>, form: &Form) -> Answer<R> {
    let Outcome { meta, warnings, report, cut, nc, drawing: _ } = outcome;
    // A caller that asked for text has the toolpath already.
    let with_toolpath = form.with_toolpath.unwrap_or(nc.is_none());
    Answer {
        engine_version: ENGINE_VERSION,
        request_id: form.request_id.as_str().to_owned(),
        meta,
        warnings,
        report,
        measures: cut.as_ref().map(|cut| Measures::of(&cut.toolpath, cut.cutting.as_ref())),
        nc,
        toolpath: cut.filter(|_| with_toolpath).map(|cut| cut.toolpath.into()),
    }
}

/// The NC program, written here unless it was part of the computation.
fn program<R>(
    mut outcome: Outcome<R>,
    media_type: &'static str,
    budget: &Budget,
) -> Result<Encoded, ApiError> {
    let text = match outcome.nc.take() {
        Some(text) => text,
        None => written(&outcome, budget)?,
    };
    let Some(Cut { program, dialect, .. }) = outcome.cut else { return Err(no_toolpath()) };
    let file_name = file_name(program.name.as_deref(), program.number, dialect.file_extension);
    Ok(Encoded::gcode(text, media_type, &file_name))
}

/// The NC text of an outcome's toolpath.
fn written<R>(outcome: &Outcome<R>, budget: &Budget) -> Result<String, ApiError> {
    let Some(cut) = &outcome.cut else { return Err(no_toolpath()) };
    let Cut { toolpath, tool, cutting, program, dialect, comments: _ } = cut;
    let Some(cutting) = cutting else {
        let detail = "`cutting` with a feed is required for a program";
        let at = Pointer::root().field("cutting");
        return Err(ApiError::invalid(vec![FieldError::new(&at, FieldCode::FeedRequired, detail)]));
    };
    let (comments, warnings) = (sheet::notes(outcome), sheet::told(&outcome.warnings));
    let (comments, warnings) = (&comments, &warnings);
    let job = ProgramJob { program, tool: tool.as_ref(), cutting, dialect, comments, warnings };
    Ok(post::write(toolpath, &job, budget)?.text)
}

fn no_toolpath() -> ApiError {
    ApiError::new(Code::InternalError, "there is no toolpath to write a program of")
}

#[cfg(test)]
mod tests {
    use axum::body::to_bytes;
    use axum::http::header;
    use nalgebra::Point3;
    use serde_json::{Value, json};

    use super::*;
    use crate::http::dto::toolpath::WarningCode;
    use crate::http::request_id::RequestId;
    use crate::toolpath::Role;
    use crate::toolpath::cutting::CuttingRequest;
    use crate::toolpath::program::{Resolution, SafeHome, Units};

    #[derive(Serialize, ToSchema)]
    struct Report {
        n_passes: usize,
    }

    fn cut() -> Cut {
        let rate = FeedRate::from_mm_per_min(500.0).expect("a feed");
        let mut builder = Toolpath::builder(Point3::new(0.0, 0.0, 2.0));
        builder.rapid(Point3::new(10.0, 0.0, 2.0)).expect("a rapid");
        builder.line(Point3::new(10.0, 0.0, 0.0), rate, Role::Plunge).expect("a line");
        Cut {
            toolpath: builder.finish().expect("a toolpath"),
            tool: Some(Tool::ball(3.0)),
            cutting: Some(CuttingRequest::at_feed(rate).at_heights(20.0, 2.0)),
            program: Program {
                resolution: Resolution { units: Units::Mm, decimals: 3 },
                number: 1,
                name: Some("die".to_owned()),
                block_numbers: false,
                work_offset: None,
                safe_home: SafeHome::None,
            },
            dialect: post::DIALECTS[0],
            comments: vec!["PROVED".to_owned()],
        }
    }

    fn outcome(cut: Option<Cut>, nc: Option<&str>) -> Outcome<Report> {
        let warning = Warning { code: WarningCode::PassesApart, detail: "far".to_owned() };
        Outcome {
            meta: Some([("part_id".to_owned(), "7 <b>".to_owned())].into()),
            warnings: vec![warning],
            report: Report { n_passes: 1 },
            cut,
            nc: nc.map(str::to_owned),
            drawing: Box::new(|| {
                Drawing::of_surface(vec![vec![Point3::origin(), Point3::new(4.0, 0.0, 0.0)]])
            }),
        }
    }

    /// Content type and text of the answer.
    async fn shown(
        outcome: Outcome<Report>,
        representation: Representation,
        with_toolpath: Option<bool>,
    ) -> Result<(String, String), ApiError> {
        let request_id = RequestId::of(&Default::default());
        let media_type = representation.media_types()[0];
        let form =
            Form { representation, media_type, with_toolpath, with_nc: false, with_gzip: false, request_id };
        let response = represent(outcome, &form, &Budget::unlimited())?.into_response();
        let content_type = response.headers()[header::CONTENT_TYPE].to_str().expect("text").to_owned();
        let body = to_bytes(response.into_body(), usize::MAX).await.expect("a body");
        Ok((content_type, String::from_utf8(body.into()).expect("UTF-8")))
    }

    async fn json_of(outcome: Outcome<Report>, with_toolpath: Option<bool>) -> Value {
        let (_, text) = shown(outcome, Representation::Json, with_toolpath).await.expect("an answer");
        serde_json::from_str(&text).expect("JSON")
    }

    #[tokio::test]
    async fn the_answer_has_the_members_of_the_contract() {
        let answer = json_of(outcome(Some(cut()), None), None).await;
        assert_eq!(answer["engine_version"], ENGINE_VERSION);
        assert_eq!(answer["meta"], json!({ "part_id": "7 <b>" }));
        // What the operation has to say, and what there is to say of any cut.
        assert_eq!(answer["warnings"][0]["code"], "passes_apart");
        assert_eq!(answer["warnings"][1]["code"], "no_spindle_speed");
        assert_eq!(answer["report"]["n_passes"], 1);
        assert_eq!(answer["measures"]["rapid_length_mm"], 10.0);
        assert_eq!(answer["measures"]["moves"]["line"], 1);
        assert_eq!(answer["measures"]["bounds"]["max"], json!([10.0, 0.0, 2.0]));
        assert_eq!(answer["toolpath"]["passes"][0]["moves"][1]["role"], "plunge");
        assert_eq!(answer.get("nc"), None);
    }

    #[tokio::test]
    async fn what_there_is_not_or_is_not_wanted_is_left_out() {
        let surface = json_of(outcome(None, None), None).await;
        let members: Vec<_> = surface.as_object().expect("an object").keys().cloned().collect();
        assert_eq!(members, ["engine_version", "meta", "report", "request_id", "warnings"]);
        assert_eq!(json_of(outcome(Some(cut()), None), Some(false)).await.get("toolpath"), None);
        let written = json_of(outcome(Some(cut()), Some("M2")), None).await;
        assert_eq!((written.get("toolpath"), &written["nc"]), (None, &json!("M2")));
        assert!(json_of(outcome(Some(cut()), Some("M2")), Some(true)).await["toolpath"].is_object());
    }

    #[tokio::test]
    async fn a_program_is_written_once_and_says_what_the_caller_and_the_operation_say() {
        let (content_type, text) =
            shown(outcome(Some(cut()), None), Representation::Gcode, None).await.expect("NC text");
        assert_eq!(content_type, "text/x-gcode; charset=us-ascii");
        assert!(text.contains("PART_ID 7") && text.contains("PROVED"), "{text}");
        let written = shown(outcome(Some(cut()), Some("M2\n")), Representation::Gcode, None).await;
        assert_eq!(written.expect("NC text").1, "M2\n");
        let error = shown(outcome(None, None), Representation::Gcode, None).await.expect_err("no toolpath");
        assert_eq!(error.code(), Code::InternalError);
    }

    #[tokio::test]
    async fn pictures_are_called_by_the_part() {
        let picture = shown(outcome(Some(cut()), None), Representation::Svg, None).await;
        let (content_type, text) = picture.expect("a picture");
        assert_eq!(content_type, "image/svg+xml; charset=utf-8");
        assert!(text.contains("7 &lt;b&gt;") && text.contains("PROVED"), "{text}");
        assert!(text.contains("ball, diameter 6 mm"), "{text}");
        let page = shown(outcome(None, None), Representation::Html, None).await;
        let (content_type, text) = page.expect("a page");
        assert_eq!(content_type, "text/html; charset=utf-8");
        assert!(text.contains("<title>7 &lt;b&gt;</title>") && text.contains("<svg"), "{text}");
        assert_eq!(sheet::title(&Outcome { meta: None, ..outcome(Some(cut()), None) }), "die");
        assert_eq!(sheet::title(&Outcome { meta: None, ..outcome(None, None) }), "Surface");
    }
}
