//! `POST /v1/programs/read`: reads an NC program of any origin as a toolpath.

use std::sync::Arc;

use axum::extract::{FromRequest, FromRequestParts, Request, State};
use axum::response::Response;

use super::arcs_fit::{is_form, looks_like_program};
use crate::http::answer::{Cut, Outcome, Product, answer};
use crate::http::app::App;
use crate::http::dto::answer::{Answer, PathMembers};
use crate::http::dto::dialect;
use crate::http::dto::program_reading::{ProgramReading, ReadQuery, ReadReport, ReadRequest};
use crate::http::dto::setup::Setup;
use crate::http::error::ApiError;
use crate::http::messages::{Warning, not_read, words_left_alone_in};
use crate::http::pointer::Pointer;
use crate::http::request::body::{JobBody, media_type};
use crate::http::request::negotiation::{Figures, Form, Offers, Wanted};
use crate::http::request::representation::{GCODE, Representation};
use toolpathd_core::budget::Budget;
use toolpathd_core::toolpath::measure::{Measures, measure};
use toolpathd_core::toolpath::motion_time::motion_time;
use toolpathd_core::toolpath::program::{Program, Resolution, Units};
use toolpathd_core::toolpath::units::{Acceleration, FeedRate};
use toolpathd_plot::Drawing;

/// The answer in JSON.
type ReadAnswer = Answer<ReadReport>;

/// The forms of the answer, and its query.
pub enum Readings {}

impl Offers for Readings {
    const OFFERS: &'static [Representation] = Figures::OFFERS;
    const PARAMETERS: &'static [&'static str] = &["format", "toolpath", "glb", "points"];
    const HAS_TOOLPATH: bool = true;
    type Query = ReadQuery;
}

/// Read an NC program of any origin.
///
/// The body is the text of the program, or JSON with the text in `nc`. The answer is the toolpath that the
/// control would run, with its lengths, times and bounds, the sums of each tool and each feed, and the words
/// that were left alone; or a picture. A program that its control would refuse, and a word that this version
/// does not read, are refused with line, column and word.
#[utoipa::path(post, path = "/v1/programs/read", operation_id = "readProgram", tag = "programs",
    params(Wanted<Readings>, ReadQuery),
    request_body(content((ReadRequest = "application/json"), (String = "text/x-gcode"))),
    responses((status = 200, description = "The toolpath, its figures or a picture.", body = ReadAnswer)))]
pub async fn read_program(State(app): State<Arc<App>>, request: Request) -> Result<Response, ApiError> {
    let (is_program, request) = match media_type(request.headers()) {
        Some(name) if GCODE.contains(&name.as_str()) => (true, request),
        Some(name) if !is_form(&name) => (false, request),
        _ => looks_like_program(app.body_limits, request).await?,
    };
    let (mut parts, body) = request.into_parts();
    let wanted = Wanted::<Readings>::from_request_parts(&mut parts, &app).await?;
    let (request, query) = (Request::from_parts(parts, body), wanted.query.clone());
    let body = if is_program {
        let job = move |text: &[u8], limits: &_| Ok(ProgramReading::of_text(text, query.clone(), limits));
        JobBody::<ReadRequest>::of_text(request, app.body_limits, job).await?
    } else {
        let body = JobBody::<ReadRequest>::from_request(request, &app).await?;
        body.then(move |job: ProgramReading| job.or(query.clone()))
    };
    answer(app.computing.clone(), wanted, body, read).await
}

/// The toolpath of a program, with the speed of its rapids.
struct ReadPath {
    cut: Cut,
    rapid_feed: FeedRate,
    lines: Vec<u32>,
}

impl Product for ReadPath {
    type Members = PathMembers;

    const TITLE: &'static str = "Program";

    fn cut(&self) -> Option<&Cut> {
        Some(&self.cut)
    }

    fn rapid_feed(&self) -> FeedRate {
        self.rapid_feed
    }

    fn read_lines(&self) -> &[u32] {
        &self.lines
    }

    fn members(self, _: Option<String>, form: &Form) -> PathMembers {
        let Self { cut: Cut { toolpath, .. }, rapid_feed, lines: _ } = self;
        let time_with_acceleration_s = motion_time(&toolpath, rapid_feed, Acceleration::DEFAULT);
        let measures = Measures { time_with_acceleration_s, ..measure(&toolpath, rapid_feed) };
        let with_toolpath = form.with_toolpath.unwrap_or(true);
        PathMembers { measures: Some(measures), nc: None, toolpath: with_toolpath.then(|| toolpath.into()) }
    }
}

fn read(job: ProgramReading, budget: &Budget) -> Result<Outcome<ReadReport, ReadPath>, ApiError> {
    let control = job.control()?;
    let at = if job.is_body { Pointer::root() } else { Pointer::root().field("nc") };
    let reading = toolpathd_nc::read(&job.read_job(control), budget).map_err(|error| not_read(error, &at))?;
    let warnings = reading.notes.iter().map(Warning::from).chain(words_left_alone_in(&reading.left_alone));
    let program = Program::plain(Resolution { units: Units::Mm, decimals: 3 });
    let setup = Setup::of_program(dialect::DEFAULT, program);
    Ok(Outcome {
        warnings: warnings.collect(),
        report: ReadReport::new(&reading, control, job.is_traced()),
        product: ReadPath {
            cut: Cut { toolpath: reading.toolpath, cutting: None, setup, comments: Vec::new(), nc: None },
            rapid_feed: job.rapid_feed(),
            lines: reading.lines,
        },
        meta: job.meta,
        drawing: Box::new(Drawing::default),
    })
}
