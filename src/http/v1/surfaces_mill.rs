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
use crate::http::dto::toolpath::{Measures, ToolpathAnswer, Warning, WarningCode};
use crate::http::error::ApiError;
use crate::http::extract::{JsonBody, StrictQuery};
use crate::http::output::{Encoded, Format, Representation, file_name};
use crate::http::request_id::RequestId;
use crate::http::{App, ENGINE_VERSION};
use crate::operations::surface_milling::{self, Plan};
use crate::post::{self, ProgramJob};

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
    represent(plan, accepted, wanted, id, budget)
}

fn represent(
    plan: Plan,
    accepted: MillJob,
    wanted: &Wanted,
    id: &RequestId,
    budget: &Budget,
) -> Result<Encoded, ApiError> {
    match wanted.representation {
        Representation::Gcode(media_type) => {
            let text = nc_text(&plan, &accepted, budget)?;
            let program = &accepted.program;
            let file_name =
                file_name(program.name.as_deref(), program.number, accepted.dialect.file_extension);
            Ok(Encoded::gcode(text, media_type, &file_name))
        }
        Representation::Json => Encoded::json(&ToolpathAnswer {
            engine_version: ENGINE_VERSION,
            request_id: id.as_str().to_owned(),
            meta: accepted.meta,
            warnings: plan.warnings.iter().map(Warning::from).collect(),
            report: MillReport::from(&plan.report),
            measures: Measures::of(&plan.toolpath, &plan.cutting),
            toolpath: wanted.with_toolpath.then(|| plan.toolpath.into()),
        }),
    }
}

/// The program that cuts the plan.
fn nc_text(plan: &Plan, accepted: &MillJob, budget: &Budget) -> Result<String, ApiError> {
    let MillJob { job, program, dialect, meta } = accepted;
    let meta = meta.iter().flatten().map(|(key, value)| format!("{key}: {value}"));
    let comments: Vec<String> = meta.chain([proved(&plan.report)]).collect();
    let job =
        ProgramJob { program, tool: Some(&job.tool), cutting: &plan.cutting, dialect, comments: &comments };
    Ok(post::write(&plan.toolpath, &job, budget)?.text)
}

/// The proved figures for a program's header, rounded up.
fn proved(report: &surface_milling::Report) -> String {
    let up = |mm: f64| (mm * 1e4).ceil() / 1e4;
    format!(
        "PROVED DEVIATION {:.4} MM - GOUGE {:.4} MM",
        up(report.deviation_max_mm),
        up(report.gouge_max_mm)
    )
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

#[cfg(test)]
mod tests {
    use axum::body::to_bytes;
    use axum::response::IntoResponse;
    use nalgebra::Point3;
    use serde_json::{Value, json};

    use super::*;
    use crate::http::decode::decode;
    use crate::operations::surface_milling::Report;
    use crate::toolpath::cutting::CuttingRequest;
    use crate::toolpath::units::FeedRate;
    use crate::toolpath::{Role, Toolpath};

    const ONE_PASS: &[u8] = include_bytes!("../../../openapi/examples/surfaces-mill/one-pass.json");

    fn plan() -> Plan {
        let rate = FeedRate::from_mm_per_min(500.0).expect("a feed");
        let mut builder = Toolpath::builder(Point3::new(0.0, 0.0, 2.0));
        builder.rapid(Point3::new(10.0, 0.0, 2.0)).expect("a rapid");
        builder.line(Point3::new(10.0, 0.0, 0.0), rate, Role::Plunge).expect("a line");
        Plan {
            toolpath: builder.finish().expect("a toolpath"),
            report: Report {
                n_passes: 1,
                n_cl_points: 2,
                deviation_max_mm: 0.001,
                gouge_max_mm: 0.0,
                n_arcs: 0,
                n_lines: 1,
            },
            cutting: CuttingRequest::at_feed(rate).at_heights(20.0, 2.0),
            warnings: vec![surface_milling::Warning::NoSpindleSpeed],
        }
    }

    async fn answer_of(with_toolpath: bool) -> Value {
        let mut accepted = decode::<MillRequest>(ONE_PASS)
            .and_then(|request| request.convert(&Limits::DEFAULT))
            .expect("legal");
        accepted.meta = Some([("part_id".to_owned(), "7".to_owned())].into());
        let wanted = Wanted { representation: Representation::Json, with_toolpath };
        let id = RequestId::of(&Default::default());
        let encoded = represent(plan(), accepted, &wanted, &id, &Budget::unlimited()).expect("an answer");
        let body = to_bytes(encoded.into_response().into_body(), usize::MAX).await.expect("a body");
        serde_json::from_slice(&body).expect("JSON")
    }

    #[tokio::test]
    async fn the_answer_has_the_members_of_the_contract() {
        let answer = answer_of(true).await;
        assert_eq!(answer["engine_version"], ENGINE_VERSION);
        assert_eq!(answer["meta"], json!({ "part_id": "7" }));
        assert_eq!(answer["warnings"][0]["code"], "no_spindle_speed");
        assert_eq!(answer["report"]["deviation_max_mm"], 0.001);
        assert_eq!(answer["measures"]["rapid_length_mm"], 10.0);
        assert_eq!(answer["measures"]["moves"]["line"], 1);
        assert_eq!(answer["measures"]["bounds"]["max"], json!([10.0, 0.0, 2.0]));
        assert_eq!(answer["toolpath"]["passes"][0]["moves"][1]["role"], "plunge");
        assert_eq!(answer_of(false).await.get("toolpath"), None);
    }
}
