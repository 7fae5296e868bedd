//! `POST /v1/programs/write`: writes the NC program of a toolpath.

use axum::extract::State;
use axum::response::Response;

use crate::http::answer::{Computing, Cut, Outcome, answer, sheet};
use crate::http::dto::answer::Answer;
use crate::http::dto::axis_output::AxisSetup;
use crate::http::dto::meta;
use crate::http::dto::program_writing::{WriteReport, WriteRequest, Writing};
use crate::http::dto::setup::JobWithSetup;
use crate::http::error::ApiError;
use crate::http::messages::Warning;
use crate::http::request::body::JobBody;
use crate::http::request::negotiation::{Programs, Wanted};
use toolpathd_core::budget::Budget;
use toolpathd_core::toolpath::units::rounded_up;
use toolpathd_plot::Drawing;
use toolpathd_post::ProgramJob;

/// The answer in JSON.
type WriteAnswer = Answer<WriteReport>;

/// Write a toolpath as an NC program.
///
/// The answer is the NC program, with a proved bound of how far rounding moves the toolpath, or a picture.
#[utoipa::path(post, path = "/v1/programs/write", operation_id = "writeProgram", tag = "programs",
    params(Wanted<Programs>), request_body = WriteRequest,
    responses((status = 200, description = "The program, the report or a picture.", body = WriteAnswer)))]
pub async fn write_program(
    State(computing): State<Computing>,
    wanted: Wanted<Programs>,
    body: JobBody<WriteRequest>,
) -> Result<Response, ApiError> {
    answer(computing, wanted, body, write).await
}

fn write(job: JobWithSetup<Writing>, budget: &Budget) -> Result<Outcome<WriteReport, Cut>, ApiError> {
    let JobWithSetup { job, setup, meta } = job;
    let comments: Vec<String> = meta::notes(meta.as_ref()).chain(adjusted(job.moved_mm)).collect();
    let warnings: Vec<Warning> = job.caution.map(Warning::from).into_iter().collect();
    let cautions = job.cutting.cautions(setup.tool.as_ref(), &setup.program);
    let told: Vec<Warning> =
        warnings.iter().cloned().chain(cautions.into_iter().map(Warning::from)).collect();
    let program_job = ProgramJob {
        program: &setup.program,
        tool: setup.tool.as_ref(),
        cutting: &job.cutting,
        dialect: setup.dialect,
        comments: &comments,
        warnings: &sheet::told(&told),
        five_axes: setup.five_axes.as_ref().map(AxisSetup::five_axes),
        called: setup.called,
    };
    let written = toolpathd_post::write(&job.toolpath, &program_job, budget)?;
    let report = WriteReport::new(&job, &setup, &written);
    let Writing { toolpath, moved_mm: _, caution: _, cutting } = job;
    let (cutting, nc) = (Some(cutting), Some(written.text));
    Ok(Outcome {
        meta,
        warnings,
        report,
        product: Cut { toolpath, cutting, setup, comments: Vec::new(), nc },
        drawing: Box::new(Drawing::default),
    })
}

/// The header's line about arcs that were moved to become exact. `None` where no arc was moved.
fn adjusted(moved_mm: f64) -> Option<String> {
    (moved_mm > 0.0).then(|| format!("ARCS WERE MADE EXACT WITHIN {:.4} MM", rounded_up(moved_mm)))
}
