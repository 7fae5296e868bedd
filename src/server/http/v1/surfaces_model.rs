//! `POST /v1/surfaces/model`: answers the patches, measures and wires of a surface, or its picture.

use axum::extract::State;
use axum::response::Response;

use crate::http::answer::{Computing, OnSurface, Outcome, answer};
use crate::http::dto::answer::{Answer, NoMembers};
use crate::http::dto::modelling::{ModelJob, ModelReport, ModelRequest};
use crate::http::error::ApiError;
use crate::http::messages::Warning;
use crate::http::request::body::JobBody;
use crate::http::request::negotiation::{Models, Wanted};
use toolpathd_core::budget::Budget;
use toolpathd_core::machining::wire_model::sketch;
use toolpathd_core::operations::surface_model;
use toolpathd_plot::Drawing;

/// The answer in JSON.
type ModelAnswer = Answer<ModelReport, NoMembers>;

/// Describe a surface.
///
/// The answer is the patches, bounds, curvature and wires of the surface, or a picture.
#[utoipa::path(post, path = "/v1/surfaces/model", operation_id = "modelSurface", tag = "surfaces",
    params(Wanted<Models>), request_body = ModelRequest,
    responses((status = 200, description = "The description or a picture.", body = ModelAnswer)))]
pub async fn model_surface(
    State(computing): State<Computing>,
    wanted: Wanted<Models>,
    body: JobBody<ModelRequest>,
) -> Result<Response, ApiError> {
    answer(computing, wanted, body, model).await
}

fn model(job: ModelJob, budget: &Budget) -> Result<Outcome<ModelReport, OnSurface>, ApiError> {
    let ModelJob { job, with_patches, meta } = job;
    let model = surface_model::model(&job, budget)?;
    // The picture shows the wires of the request, or a few curves where the request asks for no wires.
    let (surface, wires) = (model.surface.clone(), model.wires.clone());
    let shown = surface.clone();
    let drawing = move || {
        let wires = wires.clone().unwrap_or_else(|| sketch(&surface));
        Drawing::of_relief(&surface, wires)
    };
    Ok(Outcome {
        meta,
        warnings: model.warnings.iter().map(Warning::from).collect(),
        report: ModelReport::new(model, with_patches),
        product: OnSurface(Box::new(move || Some(shown.clone()))),
        drawing: Box::new(drawing),
    })
}
