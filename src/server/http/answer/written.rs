//! The program of an outcome: written once for all parts of an answer that need it.

use super::encoded::{Encoded, file_name};
use super::{Cut, Outcome, Product, sheet};
use crate::http::dto::axis_output::AxisSetup;
use crate::http::dto::setup::Setup;
use crate::http::error::{ApiError, Code, FieldCode, FieldError};
use crate::http::pointer::Pointer;
use crate::http::request::negotiation::Form;
use crate::http::request::representation::Representation;
use toolpathd_core::budget::Budget;
use toolpathd_post::{NcProgram, ProgramJob};

/// The NC program as a file.
pub fn gcode<R, P: Product>(
    outcome: &Outcome<R, P>,
    text: String,
    media_type: &'static str,
) -> Result<Encoded, ApiError> {
    let Setup { program, dialect, .. } = &outcome.product.cut().ok_or_else(no_toolpath)?.setup;
    let file_name = file_name(program.name.as_deref(), program.number, dialect);
    Ok(Encoded::gcode(text, media_type, &file_name))
}

/// The text of a program.
#[derive(Debug, Clone, PartialEq)]
pub struct NcText {
    pub text: String,
    /// For each move the line that ends it, counted from 1; 0 for a way that the program does not tell.
    pub move_lines: Vec<u32>,
}

/// The program that an answer needs. A model does without the lines of a program that cannot be written.
///
/// # Errors
/// When a program that was asked for cannot be written, and the budget's stop.
pub fn program_for<R, P: Product>(
    outcome: &Outcome<R, P>,
    form: &Form,
    budget: &Budget,
) -> Result<Option<NcText>, ApiError> {
    if form.with_nc || form.representation == Representation::Gcode {
        return text_of(outcome, budget).map(Some);
    }
    let has_feeds = outcome.product.cut().is_some_and(|cut| cut.cutting.is_some());
    let written = if form.wants_model() && has_feeds { text_of(outcome, budget).ok() } else { None };
    budget.check()?;
    Ok(written)
}

/// The NC text of an outcome's toolpath, written here unless the computation has written it.
fn text_of<R, P: Product>(outcome: &Outcome<R, P>, budget: &Budget) -> Result<NcText, ApiError> {
    let Cut { toolpath, cutting, setup, comments: _, nc } = outcome.product.cut().ok_or_else(no_toolpath)?;
    if let Some(nc) = nc {
        return Ok(nc.clone());
    }
    let Some(cutting) = cutting else {
        let detail = "a program needs feeds: send `cutting` with `feed_mm_per_min`";
        let at = Pointer::root().field("cutting");
        return Err(ApiError::invalid(vec![FieldError::new(&at, FieldCode::FeedRequired, detail)]));
    };
    let Setup { tool, program, dialect, five_axes, called, body: _, remarks: _ } = setup;
    let five_axes = five_axes.as_ref().map(AxisSetup::five_axes);
    let (comments, warnings) = (&sheet::notes(outcome), &sheet::told_in_program(&outcome.warnings));
    let job = ProgramJob {
        program,
        tool: tool.as_ref(),
        cutting,
        dialect,
        comments,
        pass_notes: outcome.product.pass_notes(),
        warnings,
        five_axes,
        called: *called,
    };
    let NcProgram { text, move_lines, .. } = toolpathd_post::write(toolpath, &job, budget)?;
    Ok(NcText { text, move_lines: move_lines.concat() })
}

fn no_toolpath() -> ApiError {
    ApiError::new(Code::InternalError, "there is no toolpath to write a program of")
}
