//! `POST /v1/surfaces/mill`: plans the milling of a surface, and answers a toolpath, an NC program or a
//! picture.

mod failure;

use std::sync::Arc;

use axum::extract::State;
use axum::response::Response;

use crate::http::App;
use crate::http::answer::{Cut, Outcome, answer};
use crate::http::dto::answer::Answer;
use crate::http::dto::milling::MillRequest;
use crate::http::dto::setup::JobWithSetup;
use crate::http::dto::toolpath::{Warning, WarningCode};
use crate::http::error::ApiError;
use crate::http::extract::JobBody;
use crate::http::negotiation::{Toolpaths, Wanted};
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::surface::source::Source;
use toolpathd_core::machining::wire_model;
use toolpathd_core::operations::surface_milling::{self, Job, Plan, Report};
use toolpathd_core::toolpath::units::rounded_up;
use toolpathd_plot::Drawing;

/// The answer in JSON.
type MillAnswer = Answer<Report>;

/// Plan the milling of a surface.
///
/// The answer is the toolpath with proved bounds of deviation and gouging, the NC program, or a picture.
#[utoipa::path(post, path = "/v1/surfaces/mill", operation_id = "millSurface", tag = "surfaces",
    params(Wanted<Toolpaths>), request_body = MillRequest,
    responses((status = 200, description = "The toolpath, the program or a picture.", body = MillAnswer)))]
pub async fn mill_surface(
    State(app): State<Arc<App>>,
    wanted: Wanted<Toolpaths>,
    body: JobBody<MillRequest>,
) -> Result<Response, ApiError> {
    answer(&app, wanted, body, mill).await
}

fn mill(job: JobWithSetup<Job>, budget: &Budget) -> Result<Outcome<Report, Cut>, ApiError> {
    let JobWithSetup { job, setup, meta } = job;
    let Plan { toolpath, report, cutting, warnings } = surface_milling::plan(&job, budget)?;
    Ok(Outcome {
        meta,
        warnings: warnings.iter().map(Warning::from).collect(),
        product: Cut { toolpath, cutting: Some(cutting), setup, comments: vec![proved(&report)], nc: None },
        report,
        drawing: Box::new(move || drawing(&job.surface)),
    })
}

/// The milled surface as a shaded relief, with a few curves on it.
fn drawing(surface: &Source) -> Drawing {
    let draw = |surface| Drawing::of_relief(&surface, wire_model::sketch(&surface));
    surface.surface().map(draw).unwrap_or_default()
}

/// The line with the proved figures for the program's header. The figures are rounded up.
fn proved(report: &Report) -> String {
    format!(
        "PROVED DEVIATION {:.4} MM - GOUGE {:.4} MM",
        rounded_up(report.deviation_max_mm),
        rounded_up(report.gouge_max_mm)
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
                detail: "the report has no scallop height, because the cutter is no ball or cannot follow the surface everywhere"
                    .into(),
            },
            surface_milling::Warning::ShortPiecesLeftOut { count, longest_mm } => Self {
                code: WarningCode::ShortPiecesLeftOut,
                detail: format!(
                    "{count} pieces of passes are shorter than a tenth of the cutter's radius and left out, and their material stays; the longest is {:.4} mm",
                    rounded_up(*longest_mm)
                ),
            },
            surface_milling::Warning::PartSmallerThanCutter => Self {
                code: WarningCode::PartSmallerThanCutter,
                detail: "the part is smaller than the cutter along x and along y: check that the points are in mm".into(),
            },
            surface_milling::Warning::StockNotGiven { approach_mm } => Self {
                code: WarningCode::StockNotGiven,
                detail: format!(
                    "`stock` is absent: rapids come down to {approach_mm} mm above the surface; make sure that no stock is higher there, or send `stock`"
                ),
            },
            surface_milling::Warning::EntryNotClear { count } => Self {
                code: WarningCode::EntryNotClear,
                detail: format!(
                    "{count} entries and exits have no room: there the cutter goes straight down or up"
                ),
            },
            surface_milling::Warning::RoughingPathGouges { depth_mm } => Self {
                code: WarningCode::RoughingPathGouges,
                detail: format!(
                    "the path is for roughing and cuts up to {:.4} mm into the surface",
                    rounded_up(*depth_mm)
                ),
            },
            surface_milling::Warning::PassesApart { stepover_mm } => Self {
                code: WarningCode::PassesApart,
                detail: format!(
                    "the cuts of passes {stepover_mm} mm apart do not overlap everywhere: material stays between the passes"
                ),
            },
        }
    }
}
