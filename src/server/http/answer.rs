//! Answers. This file leads from a job to its answer: it runs the computation on a thread, and encodes its
//! result in the form that the caller wants.
//!
//! Here belongs what makes the body of an answer: whole, as events, or as a stream.

pub mod compression;
pub mod encoded;
pub mod events;
pub mod model;
mod page;
pub mod program_stream;
mod proved_cut;
pub mod sending;
pub mod sheet;
mod small_job;
mod stages;
mod streamed;
#[cfg(test)]
mod tests;
pub mod timing;
mod written;

use std::sync::Arc;
use std::time::Instant;

use axum::Extension;
use axum::response::{IntoResponse, Response};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde::Serialize;
use utoipa::ToSchema;

use super::byte_limit::ByteLimit;
use super::compute::{Compute, Failure, Size, Step};
use super::decode::files::Places;
use super::decode::{IntoJob, SentJob};
use super::dto::answer::{Answer, Head, NoMembers, PathMembers, PointMembers};
use super::dto::check::MAX_MAGNITUDE_MM;
use super::dto::meta::Meta;
use super::dto::setup::Setup;
use super::error::{ApiError, Code};
use super::messages::Warning;
use super::request::body::JobBody;
use super::request::negotiation::{Form, Offers, Wanted};
use super::request::representation::Representation;
use super::request::retry;
use crate::config::Limits;
use encoded::Encoded;
use events::Begun;
use model::Solids;
pub use proved_cut::ProvedCut;
use small_job::SmallJob;
use stages::Stages;
use timing::{SERVER_TIMING, Timing};
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::surface::any_surface::AnySurface;
use toolpathd_core::toolpath::Toolpath;
use toolpathd_core::toolpath::cutting::{Caution, Cutting};
use toolpathd_core::toolpath::flattened::Points;
use toolpathd_core::toolpath::measure::{Bounds, measure, measure_on};
use toolpathd_core::toolpath::units::FeedRate;
use toolpathd_plot::Drawing;
use toolpathd_plot::bars::BarChart;
use toolpathd_plot::diagram::Diagram;
use toolpathd_plot::gltf::{CHORD_MM, MOST_VERTICES};
use toolpathd_post::PassNote;
pub use written::NcText;
use written::{gcode, program_for};

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

    /// For each move the time at its end on the clock of the diagrams, s; empty where that is not known.
    fn diagram_ends_s(&self) -> &[f64] {
        &[]
    }

    /// For each cutting move, in their order, how far it may be from what it stands for, mm; empty where that
    /// is not known.
    fn deviations_mm(&self) -> &[f64] {
        &[]
    }

    /// Charts of times, which a page shows below the picture.
    fn charts(&self) -> &[BarChart] {
        &[]
    }

    /// Part and stock in three dimensions.
    ///
    /// # Errors
    /// The budget's stop.
    fn solids(&self, _: &Budget) -> Result<Solids, ApiError> {
        Ok(Solids::default())
    }

    /// For each move the line of the program that was read, from 1 on; empty where no program was read.
    fn read_lines(&self) -> &[u32] {
        &[]
    }

    /// Remarks before passes, in the order of the passes, for the program.
    fn pass_notes(&self) -> &[PassNote] {
        &[]
    }

    /// How fast rapids are.
    fn rapid_feed(&self) -> FeedRate {
        let cutting = self.cut().and_then(|cut| cut.cutting.as_ref());
        cutting.map_or(FeedRate::DEFAULT_RAPID, |cutting| cutting.rapid_feed)
    }

    /// The members of the answer; `written` is the text of the program, where the caller asked for the text.
    fn members(self, written: Option<String>, form: &Form) -> Self::Members;
}

/// The product of an operation that answers a report on a surface alone. The surface is made again where
/// somebody wants to see it.
pub struct OnSurface(pub Box<dyn Fn() -> Option<AnySurface> + Send>);

impl Product for OnSurface {
    type Members = NoMembers;

    const TITLE: &'static str = "Surface";

    fn cut(&self) -> Option<&Cut> {
        None
    }

    fn solids(&self, _: &Budget) -> Result<Solids, ApiError> {
        Ok((self.0)().map(|surface| Solids::of_surface(&surface)).unwrap_or_default())
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
    /// The program, where the computation itself has written it. Then every JSON answer holds its text.
    pub nc: Option<NcText>,
}

impl Product for Cut {
    type Members = PathMembers;

    const TITLE: &'static str = "Toolpath";

    fn cut(&self) -> Option<&Cut> {
        Some(self)
    }

    fn members(self, written: Option<String>, form: &Form) -> PathMembers {
        let nc = self.nc.map(|nc| nc.text).or(written);
        // An answer with the text of the program leaves the toolpath out unless the caller asks for it.
        let with_toolpath = form.with_toolpath.unwrap_or(nc.is_none());
        let measures = Some(measure_on(&self.toolpath, self.cutting.as_ref()));
        PathMembers { measures, nc, toolpath: with_toolpath.then(|| self.toolpath.into()) }
    }
}

/// What computed answers need.
#[derive(Clone)]
pub struct Computing {
    pub compute: Arc<Compute>,
    pub limits: Limits,
    /// The memory for answers that wait for their callers.
    pub memory: Arc<ByteLimit>,
}

/// Decodes the body, runs `plan` with its job, and answers the outcome in the form that the caller wants. All
/// of this is one computation, but a short body is decoded before: its job may be small.
///
/// # Errors
/// When the queue is full, or decoding, planning or encoding fails. An answer of events reports a failure
/// after decoding as an event `problem`.
pub async fn answer<O: Offers, T, R, P, F>(
    computing: Computing,
    wanted: Wanted<O>,
    body: JobBody<T>,
    plan: F,
) -> Result<Response, ApiError>
where
    T: IntoJob,
    T::Job: SmallJob,
    R: Serialize + ToSchema,
    P: Product,
    F: FnOnce(T::Job, &Budget) -> Result<Outcome<R, P>, ApiError> + Send + 'static,
{
    let form = wanted.form;
    let request_id = form.request_id.clone();
    let is_streamed = form.representation == Representation::Events;
    let Computing { compute, limits, memory } = computing;
    let ticket = compute.admit()?;
    let asked = Instant::now();
    let sent = Sent::of(body, &compute, limits).await?;
    let size = sent.size();
    let decoded_at = Instant::now();
    let begun = Begun::default();
    let tell_begun = begun.clone();
    let room = compute.decoding_room();
    let job = move |budget: &Budget| {
        let begun = Instant::now();
        let SentJob { job, remarks, places } = match sent {
            Sent::Job(job) => job,
            Sent::Body(body) => body.job(&limits, &room, budget)?,
        };
        let parsed = Instant::now();
        tell_begun.tell();
        let mut outcome = plan(job, budget).map_err(|error| places.in_error(error))?;
        places.in_warnings(&mut outcome.warnings);
        outcome.warnings.splice(0..0, remarks);
        let computed = Instant::now();
        let encoded = represent(outcome, &places, &form, budget)?;
        let encoded = if is_streamed { encoded } else { encoded.sealed(form.with_gzip)? };
        let encoded = encoded.held_in(&memory)?;
        let timing = Timing {
            queue: begun - decoded_at,
            parse: decoded_at - asked + (parsed - begun),
            compute: computed - parsed,
            encode: computed.elapsed(),
        };
        Ok::<_, ApiError>((encoded, timing))
    };
    if is_streamed {
        let start = |listener| async move {
            let stages = Arc::new(Stages::telling(listener));
            let computed = compute.run(ticket, size, Some(stages.clone()), job).await;
            Ok(flat(computed).map_err(|error| stages.explain(error))?.0)
        };
        return events::stream(request_id, begun, start).await;
    }
    let stages = Arc::new(Stages::default());
    let computed = compute.run(ticket, size, Some(stages.clone()), job).await;
    let (encoded, timing) = flat(computed).map_err(|error| stages.explain(error))?;
    Ok(([(SERVER_TIMING, timing.header_value())], Extension(timing), encoded).into_response())
}

/// The result of a computation that ended, or why it did not end.
fn flat<T>(computed: Result<Result<T, ApiError>, Failure>) -> Result<T, ApiError> {
    computed?
}

/// What was sent: the job of a short body, or a long body.
enum Sent<T: IntoJob> {
    Job(SentJob<T::Job>),
    Body(JobBody<T>),
}

impl<T: IntoJob> Sent<T>
where
    T::Job: SmallJob,
{
    async fn of(body: JobBody<T>, compute: &Compute, limits: Limits) -> Result<Self, ApiError> {
        if !body.may_be_short() {
            return Ok(Self::Body(body));
        }
        let decode = move |budget: &Budget| match body.short_job(&limits, budget) {
            Some(job) => Ok::<_, ApiError>(Self::Job(job?)),
            None => Ok(Self::Body(body)),
        };
        compute.run_step(Step::Decoding, (), decode).await?
    }

    fn size(&self) -> Size {
        match self {
            Self::Job(sent) if sent.job.is_small() => Size::Small,
            _ => Size::Large,
        }
    }
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
        let Setup { tool, program, dialect, five_axes, called, body: _, remarks } = &cut.setup;
        let mut cautions = cut.cutting?.cautions(tool.as_ref(), program);
        cautions.retain(|caution| called.is_none() || *caution != Caution::NoToolNumber);
        let output = five_axes.as_ref().map(|setup| setup.five_axes().output);
        let coarse = toolpathd_post::coarse_feeds(&cut.toolpath, dialect, program.resolution.units, output);
        let long = measure(&cut.toolpath, cut.cutting?.rapid_feed).total_time_s.and_then(Warning::long_time);
        let cautions = cautions.into_iter().map(Warning::from).chain(coarse.map(Warning::from));
        Some(remarks.iter().cloned().chain(cautions).chain(long).collect())
    };
    product.cut().and_then(of).unwrap_or_default()
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
    places: &Places,
    form: &Form,
    budget: &Budget,
) -> Result<Encoded, ApiError> {
    if let Some(cut) = outcome.product.cut() {
        check_range(&cut.toolpath)?;
    }
    let mut cautions = cautions(&outcome.product);
    places.in_warnings(&mut cautions);
    outcome.warnings.extend(cautions);
    let codes = warning_codes(&outcome.warnings);
    let job_order = retry::job_order(outcome.meta.as_ref());
    let program = program_for(&outcome, form, budget)?;
    let lines = program.as_ref().map_or(outcome.product.read_lines(), |program| &program.move_lines);
    let model = form.wants_model().then(|| model::file(&outcome, lines, budget)).transpose()?;
    let nc = program.filter(|_| form.with_nc || form.representation == Representation::Gcode);
    let nc = nc.map(|program| program.text);
    let encoded = match form.representation {
        Representation::Json | Representation::Events => {
            let glb = model.map(|bytes| BASE64_STANDARD.encode(bytes));
            let points = polyline(&outcome, form);
            Encoded::json(&Answer { glb, points, ..envelope(outcome, nc, form) })
        }
        Representation::Glb => Ok(Encoded::binary(model.unwrap_or_default(), form.media_type)),
        Representation::Stl => Ok(Encoded::binary(model::triangles_file(&outcome, budget)?, form.media_type)),
        Representation::Gcode => gcode(&outcome, nc.unwrap_or_default(), form.media_type),
        Representation::Svg => {
            let picture = if !outcome.product.diagrams().is_empty() {
                sheet::diagrams(&outcome)
            } else {
                sheet::picture(&outcome, form.view)
            };
            Ok(Encoded::text(picture, form.media_type))
        }
        Representation::Html => {
            let (title, mut svg) = (sheet::title(&outcome), sheet::picture(&outcome, form.view));
            if !outcome.product.diagrams().is_empty() {
                svg += &sheet::diagrams(&outcome);
            }
            if !outcome.product.charts().is_empty() {
                svg += &sheet::charts(&outcome);
            }
            let bare = Form { with_toolpath: Some(false), ..form.clone() };
            let figures = serde_json::to_value(envelope(outcome, nc, &bare))
                .map_err(|error| ApiError::new(Code::InternalError, format!("writing JSON: {error}")))?;
            Ok(Encoded::text(page::page(&title, &svg, &figures), form.media_type))
        }
    }?;
    Ok(encoded.warning_of(&codes).for_job_order(job_order))
}

/// The path as points, where the caller wants them.
fn polyline<R, P: Product>(outcome: &Outcome<R, P>, form: &Form) -> Option<PointMembers> {
    let cut = outcome.product.cut().filter(|_| form.with_points)?;
    Some(Points::of(&cut.toolpath, CHORD_MM, MOST_VERTICES).into())
}

/// The JSON answer: its head, the report and the members of the product.
fn envelope<R, P: Product>(outcome: Outcome<R, P>, nc: Option<String>, form: &Form) -> Answer<R, P::Members> {
    let Outcome { meta, warnings, report, product, drawing: _ } = outcome;
    let head = Head::new(meta, warnings);
    Answer { head, report, members: product.members(nc, form), glb: None, points: None }
}
