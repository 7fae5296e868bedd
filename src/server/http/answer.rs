//! From a job to its answer: runs the computation on a thread, and encodes its result in the form
//! that the caller wants.

pub mod sheet;

use std::sync::Arc;
use std::time::Instant;

use axum::Extension;
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use utoipa::ToSchema;

use super::App;
use super::decode::IntoJob;
use super::dto::answer::{Answer, Head, NoMembers, PathMembers};
use super::dto::axis_output::AxisSetup;
use super::dto::check::MAX_MAGNITUDE_MM;
use super::dto::meta::Meta;
use super::dto::setup::Setup;
use super::dto::toolpath::{Measures, Warning};
use super::error::{ApiError, Code, FieldCode, FieldError};
use super::events::{self, Begun};
use super::extract::JobBody;
use super::negotiation::{Form, Offers, Wanted};
use super::output::{Encoded, Representation, file_name, page};
use super::pointer::Pointer;
use super::retry;
use super::timing::{SERVER_TIMING, Timing};
use toolpathd_core::budget::Budget;
use toolpathd_core::toolpath::Toolpath;
use toolpathd_core::toolpath::cutting::Cutting;
use toolpathd_core::toolpath::measure::{Bounds, measure};
use toolpathd_core::toolpath::units::FeedRate;
use toolpathd_plot::Drawing;
use toolpathd_plot::diagram::Diagram;
use toolpathd_post::ProgramJob;

/// The result of a computation, before it is encoded in one of the forms of answers.
pub struct Outcome<R, P> {
    pub meta: Option<Meta>,
    pub warnings: Vec<Warning>,
    pub report: R,
    /// The toolpath, or `()` for an operation that makes none.
    pub product: P,
    /// Makes the parts of a picture that are not the toolpath, such as the surface.
    pub drawing: Box<dyn Fn() -> Drawing + Send>,
}

/// The product of an operation beside its report, with the members of the JSON answer that hold the product.
pub trait Product {
    type Members: Serialize + ToSchema;

    /// What a picture shows.
    const TITLE: &'static str;

    /// The toolpath from which a program is written. `None` where the operation makes no toolpath.
    fn cut(&self) -> Option<&Cut>;

    /// Diagrams of quantities over time. If there are any, they are the picture, and a second picture of a
    /// page.
    fn diagrams(&self) -> &[Diagram] {
        &[]
    }

    /// The members of the answer; `written` is the text of the program, where the caller asked for the text.
    fn members(self, written: Option<String>, form: &Form) -> Self::Members;
}

/// The product of an operation that answers a report alone.
impl Product for () {
    type Members = NoMembers;

    const TITLE: &'static str = "Surface";

    fn cut(&self) -> Option<&Cut> {
        None
    }

    fn members(self, _: Option<String>, _: &Form) {}
}

/// A toolpath with all other data from which its program is written.
pub struct Cut {
    pub toolpath: Toolpath,
    /// The cutting conditions. Without them there are no feeds, and no program can be written.
    pub cutting: Option<Cutting>,
    pub setup: Setup,
    /// Remarks of the operation for the program's header and for the sheet. The caller's `meta` joins them
    /// there.
    pub comments: Vec<String>,
    /// The text of the program, where the computation itself has written it. Then every JSON answer holds the
    /// text.
    pub nc: Option<String>,
}

impl Product for Cut {
    type Members = PathMembers;

    const TITLE: &'static str = "Toolpath";

    fn cut(&self) -> Option<&Cut> {
        Some(self)
    }

    fn members(self, written: Option<String>, form: &Form) -> PathMembers {
        let nc = self.nc.or(written);
        // An answer with the text of the program leaves the toolpath out unless the caller asks for it.
        let with_toolpath = form.with_toolpath.unwrap_or(nc.is_none());
        let measures = Some(Measures::of(&self.toolpath, self.cutting.as_ref()));
        PathMembers { measures, nc, toolpath: with_toolpath.then(|| self.toolpath.into()) }
    }
}

/// Decodes the body, runs `plan` with its job, and answers the outcome in the form that the caller wants. All
/// of this is one computation.
///
/// # Errors
/// When the queue is full, or decoding, planning or encoding fails. An answer of events reports a failure
/// after decoding as an event `problem`.
pub async fn answer<O: Offers, T, R, P, F>(
    app: &Arc<App>,
    wanted: Wanted<O>,
    body: JobBody<T>,
    plan: F,
) -> Result<Response, ApiError>
where
    T: IntoJob,
    R: Serialize + ToSchema,
    P: Product,
    F: Fn(T::Job, &Budget) -> Result<Outcome<R, P>, ApiError> + Send + Sync + 'static,
{
    let form = wanted.form;
    let request_id = form.request_id.clone();
    let is_streamed = form.representation == Representation::Events;
    let (limits, memory) = (app.limits, Arc::clone(&app.answer_memory));
    let asked = Instant::now();
    let decoded = Begun::default();
    let tell_decoded = decoded.clone();
    let compute = move |budget: &Budget| {
        let begun = Instant::now();
        let job = body.job(&limits)?;
        let parsed = Instant::now();
        tell_decoded.tell();
        let outcome = plan(job, budget)?;
        let computed = Instant::now();
        let encoded = represent(outcome, &form, budget)?;
        let encoded = if is_streamed { encoded } else { encoded.sealed(form.with_gzip)? };
        let encoded = encoded.held_in(&memory)?;
        let timing = Timing {
            queue: begun - asked,
            parse: parsed - begun,
            compute: computed - parsed,
            encode: computed.elapsed(),
        };
        Ok::<_, ApiError>((encoded, timing))
    };
    let ticket = app.compute.admit()?;
    if is_streamed {
        let app = Arc::clone(app);
        let start = |listener| async move { Ok(app.compute.run(ticket, Some(listener), compute).await??.0) };
        return events::stream(request_id, decoded, start).await;
    }
    let (encoded, timing) = app.compute.run(ticket, None, compute).await??;
    Ok(([(SERVER_TIMING, timing.header_value())], Extension(timing), encoded).into_response())
}

/// Refuses a toolpath that leaves the range of coordinates. A curve may leave it between points that lie
/// within it.
fn check_range(toolpath: &Toolpath) -> Result<(), ApiError> {
    let Bounds { min, max } = measure(toolpath, FeedRate::DEFAULT_RAPID).bounds;
    let farthest = min.coords.amax().max(max.coords.amax());
    if farthest <= MAX_MAGNITUDE_MM {
        return Ok(());
    }
    let detail = format!("the toolpath reaches {farthest} mm; coordinates end at {MAX_MAGNITUDE_MM} mm");
    Err(ApiError::new(Code::LimitExceeded, detail))
}

/// The warnings that every toolpath gets for its cutting conditions, tool and program.
fn cautions<P: Product>(product: &P) -> Vec<Warning> {
    let of = |cut: &Cut| {
        let Setup { tool, program, .. } = &cut.setup;
        cut.cutting.map(|cutting| cutting.cautions(tool.as_ref(), program))
    };
    product.cut().and_then(of).into_iter().flatten().map(Warning::from).collect()
}

/// The codes of all warnings for a header, each code once, separated by commas.
fn warning_codes(warnings: &[Warning]) -> String {
    let mut codes: Vec<String> = Vec::new();
    for code in warnings.iter().map(|warning| warning.code.name()) {
        if !codes.contains(&code) {
            codes.push(code);
        }
    }
    codes.join(", ")
}

/// Encodes the outcome in the form that the caller wants.
fn represent<R: Serialize + ToSchema, P: Product>(
    mut outcome: Outcome<R, P>,
    form: &Form,
    budget: &Budget,
) -> Result<Encoded, ApiError> {
    if let Some(cut) = outcome.product.cut() {
        check_range(&cut.toolpath)?;
    }
    outcome.warnings.extend(cautions(&outcome.product));
    let codes = warning_codes(&outcome.warnings);
    let job_order = retry::job_order(outcome.meta.as_ref());
    let nc = if form.with_nc { Some(text_of(&outcome, budget)?) } else { None };
    let encoded = match form.representation {
        Representation::Json | Representation::Events => Encoded::json(&envelope(outcome, nc, form)),
        Representation::Gcode => program(&outcome, nc, form.media_type, budget),
        Representation::Svg => {
            let picture = if !outcome.product.diagrams().is_empty() {
                sheet::diagrams(&outcome)
            } else {
                sheet::picture(&outcome)
            };
            Ok(Encoded::text(picture, form.media_type))
        }
        Representation::Html => {
            let (title, mut svg) = (sheet::title(&outcome), sheet::picture(&outcome));
            if !outcome.product.diagrams().is_empty() {
                svg += &sheet::diagrams(&outcome);
            }
            let bare = Form { with_toolpath: Some(false), ..form.clone() };
            let figures = serde_json::to_value(envelope(outcome, nc, &bare))
                .map_err(|error| ApiError::new(Code::InternalError, format!("writing JSON: {error}")))?;
            Ok(Encoded::text(page::page(&title, &svg, &figures), form.media_type))
        }
    }?;
    Ok(encoded.warning_of(&codes).for_job_order(job_order))
}

/// The JSON answer: its head, the report and the members of the product.
fn envelope<R, P: Product>(outcome: Outcome<R, P>, nc: Option<String>, form: &Form) -> Answer<R, P::Members> {
    let Outcome { meta, warnings, report, product, drawing: _ } = outcome;
    let head = Head::new(meta, warnings);
    Answer { head, report, members: product.members(nc, form) }
}

/// The NC program as a file.
fn program<R, P: Product>(
    outcome: &Outcome<R, P>,
    nc: Option<String>,
    media_type: &'static str,
    budget: &Budget,
) -> Result<Encoded, ApiError> {
    let text = nc.map_or_else(|| text_of(outcome, budget), Ok)?;
    let Setup { program, dialect, .. } = &outcome.product.cut().ok_or_else(no_toolpath)?.setup;
    let file_name = file_name(program.name.as_deref(), program.number, dialect.file_extension);
    Ok(Encoded::gcode(text, media_type, &file_name))
}

/// The NC text of an outcome's toolpath, written here unless the computation has written it.
fn text_of<R, P: Product>(outcome: &Outcome<R, P>, budget: &Budget) -> Result<String, ApiError> {
    let Cut { toolpath, cutting, setup, comments: _, nc } = outcome.product.cut().ok_or_else(no_toolpath)?;
    if let Some(text) = nc {
        return Ok(text.clone());
    }
    let Some(cutting) = cutting else {
        let detail = "a program needs feeds: send `cutting` with `feed_mm_per_min`";
        let at = Pointer::root().field("cutting");
        return Err(ApiError::invalid(vec![FieldError::new(&at, FieldCode::FeedRequired, detail)]));
    };
    let Setup { tool, program, dialect, five_axes } = setup;
    let five_axes = five_axes.as_ref().map(AxisSetup::five_axes);
    let (comments, warnings) = (&sheet::notes(outcome), &sheet::told(&outcome.warnings));
    let job = ProgramJob { program, tool: tool.as_ref(), cutting, dialect, comments, warnings, five_axes };
    Ok(toolpathd_post::write(toolpath, &job, budget)?.text)
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
    use crate::http::ENGINE_VERSION;
    use crate::http::dto::toolpath::WarningCode;
    use crate::http::request_id::RequestId;
    use toolpathd_core::toolpath::Role;
    use toolpathd_core::toolpath::cutting::CuttingRequest;
    use toolpathd_core::toolpath::program::{Program, Resolution, Units};
    use toolpathd_core::toolpath::tool::Tool;

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
            cutting: Some(CuttingRequest::at_feed(rate).at_heights(20.0, 2.0)),
            setup: Setup {
                tool: Some(Tool::ball(3.0)),
                program: Program {
                    name: Some("die".to_owned()),
                    ..Program::plain(Resolution { units: Units::Mm, decimals: 3 })
                },
                dialect: toolpathd_post::DIALECTS[0],
                five_axes: None,
            },
            comments: vec!["PROVED".to_owned()],
            nc: None,
        }
    }

    fn written_cut() -> Cut {
        Cut { nc: Some("M2\n".to_owned()), ..cut() }
    }

    fn outcome<P>(product: P) -> Outcome<Report, P> {
        let warning = Warning { code: WarningCode::PassesApart, detail: "far".to_owned() };
        Outcome {
            meta: Some([("part_id".to_owned(), "7 <b>".to_owned())].into()),
            warnings: vec![warning],
            report: Report { n_passes: 1 },
            product,
            drawing: Box::new(|| {
                Drawing::of_surface(vec![vec![Point3::origin(), Point3::new(4.0, 0.0, 0.0)]])
            }),
        }
    }

    /// Content type and text of the answer.
    async fn shown<P: Product>(
        outcome: Outcome<Report, P>,
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

    async fn json_of<P: Product>(outcome: Outcome<Report, P>, with_toolpath: Option<bool>) -> Value {
        let (_, text) = shown(outcome, Representation::Json, with_toolpath).await.expect("an answer");
        serde_json::from_str(&text).expect("JSON")
    }

    #[tokio::test]
    async fn the_answer_has_the_members_of_the_contract() {
        let answer = json_of(outcome(cut()), None).await;
        assert_eq!(answer["engine_version"], ENGINE_VERSION);
        assert_eq!(answer["meta"], json!({ "part_id": "7 <b>" }));
        // First the warning of the operation, then the warnings that every toolpath gets.
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
    async fn absent_and_unwanted_members_are_left_out() {
        let surface = json_of(outcome(()), None).await;
        let members: Vec<_> = surface.as_object().expect("an object").keys().cloned().collect();
        assert_eq!(members, ["engine_version", "meta", "report", "warnings"]);
        assert_eq!(json_of(outcome(cut()), Some(false)).await.get("toolpath"), None);
        let written = json_of(outcome(written_cut()), None).await;
        assert_eq!((written.get("toolpath"), &written["nc"]), (None, &json!("M2\n")));
        assert!(json_of(outcome(written_cut()), Some(true)).await["toolpath"].is_object());
    }

    #[tokio::test]
    async fn a_program_is_written_once_and_says_what_the_caller_and_the_operation_say() {
        let (content_type, text) = shown(outcome(cut()), Representation::Gcode, None).await.expect("NC text");
        assert_eq!(content_type, "text/x-gcode; charset=us-ascii");
        assert!(text.contains("PART_ID 7") && text.contains("PROVED"), "{text}");
        let written = shown(outcome(written_cut()), Representation::Gcode, None).await;
        assert_eq!(written.expect("NC text").1, "M2\n");
        let error = shown(outcome(()), Representation::Gcode, None).await.expect_err("no toolpath");
        assert_eq!(error.code(), Code::InternalError);
    }

    #[tokio::test]
    async fn a_picture_has_the_part_id_as_its_title() {
        let picture = shown(outcome(cut()), Representation::Svg, None).await;
        let (content_type, text) = picture.expect("a picture");
        assert_eq!(content_type, "image/svg+xml; charset=utf-8");
        assert!(text.contains("7 &lt;b&gt;") && text.contains("PROVED"), "{text}");
        assert!(text.contains("ball, diameter 6 mm"), "{text}");
        let page = shown(outcome(()), Representation::Html, None).await;
        let (content_type, text) = page.expect("a page");
        assert_eq!(content_type, "text/html; charset=utf-8");
        assert!(text.contains("<title>7 &lt;b&gt;</title>") && text.contains("<svg"), "{text}");
        assert_eq!(sheet::title(&Outcome { meta: None, ..outcome(cut()) }), "die");
        assert_eq!(sheet::title(&Outcome { meta: None, ..outcome(()) }), "Surface");
    }
}
