//! `POST /v1/surfaces/drop`: lowers a cutter onto a surface at many places. Answers, for each place, the
//! cutter location at which the cutter first touches the surface.

use std::sync::Arc;

use axum::extract::State;
use axum::response::Response;

use crate::http::answer::{Computing, OnSurface, Outcome, answer};
use crate::http::dto::answer::{Answer, NoMembers};
use crate::http::dto::dropping::{DropJob, DropRequest};
use crate::http::error::ApiError;
use crate::http::request::body::JobBody;
use crate::http::request::negotiation::{Figures, Wanted};
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::surface::source::Source;
use toolpathd_core::machining::wire_model::{self, Wire};
use toolpathd_core::operations::cutter_location::{self, Report};
use toolpathd_plot::Drawing;

/// The answer in JSON.
type DropAnswer = Answer<Report, NoMembers>;

/// Lower a cutter onto a surface at many places.
///
/// The answer is the position of the cutter's tip where the cutter touches the surface first, for every
/// place.
#[utoipa::path(post, path = "/v1/surfaces/drop", operation_id = "dropCutter", tag = "surfaces",
    params(Wanted<Figures>), request_body = DropRequest,
    responses((status = 200, description = "The tips, in the order of the points.", body = DropAnswer)))]
pub async fn drop_cutter(
    State(computing): State<Computing>,
    wanted: Wanted<Figures>,
    body: JobBody<DropRequest>,
) -> Result<Response, ApiError> {
    answer(computing, wanted, body, locate).await
}

fn locate(job: DropJob, budget: &Budget) -> Result<Outcome<Report, OnSurface>, ApiError> {
    let DropJob { job, meta } = job;
    let locations = cutter_location::locate(&job, budget)?;
    let surface = Arc::new(job.surface);
    let shown = Arc::clone(&surface);
    Ok(Outcome {
        meta,
        warnings: Vec::new(),
        report: Report::new(&locations),
        product: OnSurface(Box::new(move || shown.surface().ok())),
        drawing: Box::new(move || Drawing::of_surface(sketched(&surface))),
    })
}

/// A few curves on the surface.
fn sketched(surface: &Source) -> Vec<Wire> {
    surface.surface().map(|surface| wire_model::sketch(&surface)).unwrap_or_default()
}
