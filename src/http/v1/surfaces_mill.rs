//! `POST /v1/surfaces/mill`: a surface goes in, a toolpath, an NC program or a picture comes out.

mod failure;

use std::sync::Arc;

use axum::extract::State;
use axum::response::Response;

use crate::budget::Budget;
use crate::geometry::surface::source::Source;
use crate::http::App;
use crate::http::answer::{Cut, Outcome, answer};
use crate::http::dto::answer::Answer;
use crate::http::dto::milling::{MillJob, MillReport, MillRequest};
use crate::http::dto::toolpath::{Warning, WarningCode};
use crate::http::error::ApiError;
use crate::http::extract::JobBody;
use crate::http::wanted::{Toolpaths, Wanted};
use crate::machining::wire_model;
use crate::operations::surface_milling::{self, Plan};
use crate::plot::Drawing;
use crate::toolpath::units::rounded_up_mm;

/// Plans the finishing of a surface and answers the toolpath, the NC program that cuts it, or a picture.
#[utoipa::path(post, path = "/v1/surfaces/mill", operation_id = "millSurface", tag = "surfaces",
    params(Wanted<Toolpaths>), request_body = MillRequest,
    responses((status = 200, description = "The toolpath, in one of its forms.", body = Answer<MillReport>)))]
pub async fn mill_surface(
    State(app): State<Arc<App>>,
    wanted: Wanted<Toolpaths>,
    body: JobBody<MillRequest>,
) -> Result<Response, ApiError> {
    answer(&app, wanted, body, mill).await
}

fn mill(job: MillJob, budget: &Budget) -> Result<Outcome<MillReport>, ApiError> {
    let MillJob { job, program, dialect, meta } = job;
    let Plan { toolpath, report, cutting, warnings } = surface_milling::plan(&job, budget)?;
    Ok(Outcome {
        meta,
        warnings: warnings.iter().map(Warning::from).collect(),
        report: MillReport::from(&report),
        cut: Some(Cut {
            toolpath,
            tool: Some(job.tool),
            cutting: Some(cutting),
            program,
            dialect,
            comments: vec![proved(&report)],
        }),
        nc: None,
        drawing: Box::new(move || drawing(&job.surface)),
    })
}

/// The surface that was milled, shaded, with a few curves on it.
fn drawing(surface: &Source) -> Drawing {
    let draw = |surface| Drawing::of_relief(&surface, wire_model::sketch(&surface));
    surface.surface().map(draw).unwrap_or_default()
}

/// The proved figures for a program's header, rounded up.
fn proved(report: &surface_milling::Report) -> String {
    format!(
        "PROVED DEVIATION {:.4} MM - GOUGE {:.4} MM",
        rounded_up_mm(report.deviation_max_mm),
        rounded_up_mm(report.gouge_max_mm)
    )
}

impl From<&surface_milling::Warning> for Warning {
    fn from(warning: &surface_milling::Warning) -> Self {
        match warning {
            surface_milling::Warning::EndsReduced { direction, points } => {
                Self::ends_reduced(direction, *points)
            }
            surface_milling::Warning::ScallopNotProved => Self {
                code: WarningCode::ScallopNotProved,
                detail: "no height left between passes is stated: the cutter is no ball, or cannot follow the surface everywhere"
                    .into(),
            },
            surface_milling::Warning::ShortPiecesLeftOut { count, longest_mm } => Self {
                code: WarningCode::ShortPiecesLeftOut,
                detail: format!(
                    "pieces of passes that are shorter than a tenth of the cutter's radius are left out, and what they would cut is left: {count}, the longest {:.4} mm",
                    rounded_up_mm(*longest_mm)
                ),
            },
            surface_milling::Warning::PartSmallerThanCutter => Self {
                code: WarningCode::PartSmallerThanCutter,
                detail: "the part is smaller than the cutter both ways: are its points in millimetres?".into(),
            },
            surface_milling::Warning::StockNotGiven { approach_mm } => Self {
                code: WarningCode::StockNotGiven,
                detail: format!(
                    "`stock` is absent: rapids come down to {approach_mm} mm above the surface, and no more may stand on it"
                ),
            },
            surface_milling::Warning::EntryNotClear { count } => Self {
                code: WarningCode::EntryNotClear,
                detail: format!(
                    "{count} entries and exits have no room for what was asked for: there the cutter goes straight down or up"
                ),
            },
            surface_milling::Warning::RoughingPathGouges { depth_mm } => Self {
                code: WarningCode::RoughingPathGouges,
                detail: format!(
                    "this path is for roughing: it cuts into the surface by up to {:.4} mm",
                    rounded_up_mm(*depth_mm)
                ),
            },
            surface_milling::Warning::PassesApart { stepover_mm } => Self {
                code: WarningCode::PassesApart,
                detail: format!(
                    "passes {stepover_mm} mm apart do not meet everywhere: stock is left between them"
                ),
            },
        }
    }
}
