//! `POST /v1/surfaces/mill`: a surface goes in, a toolpath or an NC program comes out.

mod failure;

use std::sync::Arc;

use axum::extract::{FromRequestParts, State};
use axum::http::request::Parts;
use serde::Deserialize;
use utoipa::IntoParams;

use crate::budget::Budget;
use crate::config::Limits;
use crate::http::dto::milling::{MillJob, MillReport, MillRequest};
use crate::http::dto::point::Point;
use crate::http::dto::toolpath::{Bounds, Measures, MoveCounts, ToolpathAnswer, Warning, WarningCode};
use crate::http::error::{ApiError, Code};
use crate::http::extract::{JsonBody, StrictQuery};
use crate::http::output::{Encoded, Format, Representation, file_name};
use crate::http::request_id::RequestId;
use crate::http::{App, ENGINE_VERSION};
use crate::operations::surface_milling::{self, Plan};

/// How the answer is wanted.
#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct MillQuery {
    /// Overrides `Accept`.
    #[param(inline)]
    format: Option<Format>,
    /// Whether the JSON answer holds the toolpath. Default: true.
    toolpath: Option<bool>,
}

/// What the query and `Accept` ask for.
pub struct Wanted {
    representation: Representation,
    with_toolpath: bool,
}

impl FromRequestParts<Arc<App>> for Wanted {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, app: &Arc<App>) -> Result<Self, ApiError> {
        let StrictQuery(MillQuery { format, toolpath }) = StrictQuery::from_request_parts(parts, app).await?;
        let representation = Representation::choose(&parts.headers, format)?;
        Ok(Self { representation, with_toolpath: toolpath.unwrap_or(true) })
    }
}

/// Plans the finishing of a surface and answers the toolpath, or the NC program that cuts it.
#[utoipa::path(post, path = "/v1/surfaces/mill", operation_id = "millSurface", tag = "surfaces",
    params(MillQuery), request_body = MillRequest,
    responses((status = 200, description = "The toolpath, or the NC program.", content(
        (ToolpathAnswer<MillReport> = "application/json"), (String = "text/x-gcode"), (String = "text/x.gcode"),
        (String = "application/x-gcode"), (String = "text/plain")))))]
pub async fn mill_surface(
    State(app): State<Arc<App>>,
    id: RequestId,
    wanted: Wanted,
    JsonBody(request): JsonBody<MillRequest>,
) -> Result<Encoded, ApiError> {
    let limits = app.limits;
    app.compute.run(move |budget| answer(request, &limits, &wanted, &id, budget)).await?
}

fn answer(
    request: MillRequest,
    limits: &Limits,
    wanted: &Wanted,
    id: &RequestId,
    budget: &Budget,
) -> Result<Encoded, ApiError> {
    let accepted = request.convert(limits)?;
    let plan = surface_milling::plan(&accepted.job, budget)?;
    match wanted.representation {
        Representation::Gcode(media_type) => {
            let text = nc_text(&plan, &accepted)?;
            let file_name = file_name(accepted.program.name.as_deref(), accepted.program.number);
            Ok(Encoded::gcode(text, media_type, &file_name))
        }
        Representation::Json => Encoded::json(&ToolpathAnswer {
            engine_version: ENGINE_VERSION,
            request_id: id.as_str().to_owned(),
            meta: accepted.meta,
            warnings: plan.warnings.iter().map(Warning::from).collect(),
            report: MillReport::from(&plan.report),
            measures: measures(&plan),
            toolpath: wanted.with_toolpath.then(|| plan.toolpath.into()),
        }),
    }
}

/// The program that cuts the plan.
fn nc_text(_plan: &Plan, job: &MillJob) -> Result<String, ApiError> {
    let detail = format!("programs in the dialect `{}` cannot be written yet", job.dialect);
    Err(ApiError::new(Code::InternalError, detail))
}

/// The figures of the plan's toolpath.
fn measures(plan: &Plan) -> Measures {
    let start = Point::from(plan.toolpath.start());
    Measures {
        cutting_length_mm: 0.0,
        rapid_length_mm: 0.0,
        cutting_time_s: 0.0,
        rapid_time_s: 0.0,
        total_time_s: 0.0,
        dwell_time_s: 0.0,
        moves: MoveCounts::default(),
        bounds: Bounds { min: start, max: start },
    }
}

impl From<&surface_milling::Warning> for Warning {
    fn from(warning: &surface_milling::Warning) -> Self {
        match warning {
            surface_milling::Warning::EndsReduced { direction, points } => Self {
                code: WarningCode::EndsReduced,
                detail: format!(
                    "`not_a_knot` needs 4 points along {direction}; through {points} runs the interpolating polynomial"
                ),
            },
            surface_milling::Warning::NoSpindleSpeed => Self {
                code: WarningCode::NoSpindleSpeed,
                detail: "`cutting.spindle_rpm` is absent: the program starts no spindle".into(),
            },
        }
    }
}
