//! `POST /v1/surfaces/model`: answers the patches, measures and wires of a surface, or its picture.

use axum::extract::State;
use axum::response::Response;

use crate::http::answer::{Computing, Outcome, answer};
use crate::http::dto::answer::{Answer, NoMembers};
use crate::http::dto::modelling::{ModelJob, ModelReport, ModelRequest};
use crate::http::dto::toolpath::{Warning, WarningCode};
use crate::http::error::{ApiError, Code, FieldCode};
use crate::http::pointer::Pointer;
use crate::http::request::body::JobBody;
use crate::http::request::negotiation::{Models, Wanted};
use toolpathd_core::budget::Budget;
use toolpathd_core::machining::wire_model::{WireError, sketch};
use toolpathd_core::operations::surface_model::{self, Error};
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

fn model(job: ModelJob, budget: &Budget) -> Result<Outcome<ModelReport, ()>, ApiError> {
    let ModelJob { job, with_patches, meta } = job;
    let model = surface_model::model(&job, budget)?;
    // The picture shows the wires of the request, or a few curves where the request asks for no wires.
    let (surface, wires) = (model.surface.clone(), model.wires.clone());
    let drawing = move || {
        let wires = wires.clone().unwrap_or_else(|| sketch(&surface));
        Drawing::of_relief(&surface, wires)
    };
    Ok(Outcome {
        meta,
        warnings: model.warnings.iter().map(Warning::from).collect(),
        report: ModelReport::new(model, with_patches),
        product: (),
        drawing: Box::new(drawing),
    })
}

impl From<&surface_model::Warning> for Warning {
    fn from(warning: &surface_model::Warning) -> Self {
        match warning {
            surface_model::Warning::EndsReduced { direction, points } => {
                Self::ends_reduced(direction, *points)
            }
            surface_model::Warning::NotSmooth(fault) => Self {
                code: WarningCode::NotSmooth,
                detail: format!("{fault}: `engine: offset_section` refuses this surface, `engine: contact` mills it"),
            },
            surface_model::Warning::NoNormal => Self {
                code: WarningCode::NoNormal,
                detail: "the surface has, or may have, a place without a normal, such as a pole: the report has no curvature"
                    .into(),
            },
        }
    }
}

impl From<Error> for ApiError {
    fn from(error: Error) -> Self {
        match error {
            Error::Stopped(stopped) => stopped.into(),
            Error::Source(source) => source.into(),
            Error::Wires(wires) => wires.into(),
            Error::TooManyControlPoints { .. } => Self::new(Code::LimitExceeded, error.to_string())
                .blaming(&Pointer::root().field("patches"), FieldCode::LimitExceeded),
        }
    }
}

impl From<WireError> for ApiError {
    fn from(error: WireError) -> Self {
        let detail = error.to_string();
        let wires = Pointer::root().field("wires");
        match error {
            WireError::Stopped(stopped) => stopped.into(),
            WireError::TooManyWires { needed: _, limit: _ } => Self::new(Code::LimitExceeded, detail)
                .blaming(&wires.field("pitch_mm"), FieldCode::LimitExceeded),
            WireError::TooManyPoints { limit: _ } => {
                Self::new(Code::LimitExceeded, detail).blaming(&wires, FieldCode::LimitExceeded)
            }
            WireError::Overhang { at } => Self::new(Code::Overhang, detail).at(at.into()),
            WireError::SectionLost { at } => Self::new(Code::SectionLost, detail).at(at.into()),
        }
    }
}
