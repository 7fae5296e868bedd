//! `POST /v1/programs/write`: writes the NC program of a toolpath.

use axum::extract::State;
use axum::response::Response;

use crate::http::answer::{Computing, Cut, NcText, Outcome, answer, sheet};
use crate::http::dto::answer::Answer;
use crate::http::dto::axis_output::AxisSetup;
use crate::http::dto::meta;
use crate::http::dto::program_writing::{Operation, WriteReport, WriteRequest, Writing};
use crate::http::dto::setup::JobWithSetup;
use crate::http::error::ApiError;
use crate::http::messages::Warning;
use crate::http::request::body::JobBody;
use crate::http::request::negotiation::{Programs, Wanted};
use toolpathd_core::budget::Budget;
use toolpathd_core::toolpath::Toolpath;
use toolpathd_core::toolpath::cutting::Caution;
use toolpathd_core::toolpath::units::rounded_up;
use toolpathd_plot::Drawing;
use toolpathd_post::{NcProgram, ProgramJob};

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
    let comments: Vec<String> =
        meta::notes(meta.as_ref()).chain(setup.body.note()).chain(adjusted(job.moved_mm())).collect();
    let warnings: Vec<Vec<Warning>> = cautions(&job);
    let told: Vec<Vec<String>> = warnings.iter().map(|own| sheet::told(own)).collect();
    let operations: Vec<toolpathd_post::Operation> = job
        .operations()
        .zip(&told)
        .enumerate()
        .map(|(k, (operation, warnings))| toolpathd_post::Operation {
            name: operation.name.as_deref(),
            toolpath: &operation.toolpath,
            job: ProgramJob {
                program: &operation.program,
                tool: operation.tool.as_ref(),
                cutting: &operation.cutting,
                dialect: setup.dialect,
                comments: if k == 0 { &comments } else { &[] },
                pass_notes: &[],
                warnings,
                five_axes: setup.five_axes.as_ref().map(AxisSetup::five_axes),
                called: setup.called,
            },
        })
        .collect();
    let written = toolpathd_post::write_all(&operations, budget)?;
    let report = WriteReport::new(&job, &setup, &written);
    let warnings = in_answer(&job, warnings);
    let comments = further_lines(&job);
    let cutting = Some(job.first.cutting);
    let NcProgram { text, move_lines: operation_lines, .. } = written;
    let (toolpath, move_lines) = whole(job, operation_lines);
    let nc = Some(NcText { text, move_lines });
    Ok(Outcome {
        meta,
        warnings,
        report,
        product: Cut { toolpath, cutting, setup, comments, nc },
        drawing: Box::new(Drawing::default),
    })
}

/// The header's line about arcs that were moved to become exact. `None` where no arc was moved.
fn adjusted(moved_mm: f64) -> Option<String> {
    (moved_mm > 0.0).then(|| format!("ARCS WERE MADE EXACT WITHIN {:.4} MM", rounded_up(moved_mm)))
}

/// The warnings about each operation. What holds for the first one is not told again.
fn cautions(job: &Writing) -> Vec<Vec<Warning>> {
    let of = |operation: &Operation| {
        let cautions = operation.cutting.cautions(operation.tool.as_ref(), &operation.program);
        operation.caution.into_iter().chain(cautions).collect::<Vec<Caution>>()
    };
    let first = of(&job.first);
    let further = job.further.iter().map(of);
    let fresh = further.map(|own| own.into_iter().filter(|one| !first.contains(one)).collect());
    let all: Vec<Vec<Caution>> = std::iter::once(first.clone()).chain(fresh).collect();
    let told = |(own, operation): (Vec<Caution>, &Operation)| {
        own.into_iter().map(Warning::from).chain(operation.remarks.iter().cloned()).collect()
    };
    all.into_iter().zip(job.operations()).map(told).collect()
}

/// The warnings of the answer, but for those that every answer with the conditions of the first operation
/// has.
fn in_answer(job: &Writing, warnings: Vec<Vec<Warning>>) -> Vec<Warning> {
    let first = job.first.caution.map(Warning::from);
    let further = warnings.into_iter().enumerate().skip(1).flat_map(|(k, own)| {
        own.into_iter().map(move |warning| Warning {
            detail: format!("operation {} of the program: {}", k + 1, warning.detail),
            ..warning
        })
    });
    first.into_iter().chain(further).collect()
}

/// A line of a sheet for each operation behind the first one, of which every sheet tells. The name comes
/// last: a sheet has no room for a long one.
fn further_lines(job: &Writing) -> Vec<String> {
    let n = 1 + job.further.len();
    let line = |(k, operation): (usize, &Operation)| {
        let Operation { name, tool, program, cutting, .. } = operation;
        let name = name.as_ref().map_or(String::new(), |name| format!(" - {name}"));
        format!("{} of {n}: {}{name}", k + 2, sheet::operation_line(tool.as_ref(), program, cutting))
    };
    job.further.iter().enumerate().map(line).collect()
}

/// All toolpaths as one, and for each of its moves the line that ends it. Between two toolpaths the tool goes
/// over the higher one of both clearance planes. The program has other ways there, so these moves have the
/// line 0.
fn whole(job: Writing, operation_lines: Vec<Vec<u32>>) -> (Toolpath, Vec<u32>) {
    let Writing { first, further } = job;
    let mut operation_lines = operation_lines.into_iter();
    let mut lines = operation_lines.next().unwrap_or_default();
    let mut clearance_mm = first.cutting.clearance_z_mm;
    let mut toolpath = first.toolpath;
    for (operation, own_lines) in further.into_iter().zip(operation_lines) {
        let over_mm = clearance_mm.max(operation.cutting.clearance_z_mm);
        clearance_mm = operation.cutting.clearance_z_mm;
        toolpath = toolpath.then(operation.toolpath, over_mm);
        lines.resize(toolpath.moves().count() - own_lines.len(), 0);
        lines.extend(own_lines);
    }
    (toolpath, lines)
}
