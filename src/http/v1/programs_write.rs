//! `POST /v1/programs/write`: a toolpath goes in, the NC program that cuts it comes out.

use std::sync::Arc;

use axum::extract::State;
use axum::response::Response;

use crate::budget::Budget;
use crate::http::App;
use crate::http::answer::{Cut, Outcome, answer};
use crate::http::dto::answer::Answer;
use crate::http::dto::meta;
use crate::http::dto::program_writing::{WriteJob, WriteReport, WriteRequest};
use crate::http::error::ApiError;
use crate::http::extract::JobBody;
use crate::http::wanted::{Programs, Wanted};
use crate::plot::Drawing;
use crate::post::{self, ProgramJob};
use crate::toolpath::units::rounded_up_mm;

/// Writes a toolpath as an NC program, with a certificate of how far rounding has moved it.
#[utoipa::path(post, path = "/v1/programs/write", operation_id = "writeProgram", tag = "programs",
    params(Wanted<Programs>), request_body = WriteRequest,
    responses((status = 200, description = "The program, in one of its forms.", body = Answer<WriteReport>)))]
pub async fn write_program(
    State(app): State<Arc<App>>,
    wanted: Wanted<Programs>,
    body: JobBody<WriteRequest>,
) -> Result<Response, ApiError> {
    answer(&app, wanted, body, write).await
}

fn write(job: WriteJob, budget: &Budget) -> Result<Outcome<WriteReport>, ApiError> {
    let comments: Vec<String> = meta::notes(job.meta.as_ref()).chain(adjusted(job.moved_mm)).collect();
    let program_job = ProgramJob {
        program: &job.program,
        tool: job.tool.as_ref(),
        cutting: &job.cutting,
        dialect: job.dialect,
        comments: &comments,
    };
    let written = post::write(&job.toolpath, &program_job, budget)?;
    let report = WriteReport::new(&job, &written);
    let WriteJob { toolpath, moved_mm: _, tool, cutting, program, dialect, meta } = job;
    Ok(Outcome {
        meta,
        warnings: Vec::new(),
        report,
        cut: Some(Cut { toolpath, tool, cutting: Some(cutting), program, dialect, comments: Vec::new() }),
        nc: Some(written.text),
        drawing: Box::new(Drawing::default),
    })
}

/// What the header says of arcs that had to be made exact.
fn adjusted(moved_mm: f64) -> Option<String> {
    (moved_mm > 0.0).then(|| format!("ARCS WERE MADE EXACT WITHIN {:.4} MM", rounded_up_mm(moved_mm)))
}
