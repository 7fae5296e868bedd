//! `POST /v1/surfaces/mill`: plans the milling of a surface, and answers a toolpath, an NC program or a
//! picture.

use std::sync::Arc;

use axum::extract::State;
use axum::response::Response;

use crate::http::answer::model::Solids;
use crate::http::answer::{Computing, Cut, Outcome, Product, answer};
use crate::http::dto::answer::{Answer, PathMembers};
use crate::http::dto::milling::MillRequest;
use crate::http::dto::setup::JobWithSetup;
use crate::http::error::ApiError;
use crate::http::messages::Warning;
use crate::http::request::body::JobBody;
use crate::http::request::negotiation::{Form, Toolpaths, Wanted};
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::surface::source::Source;
use toolpathd_core::machining::wire_model;
use toolpathd_core::operations::surface_milling::{self, Job, Plan, Report};
use toolpathd_core::toolpath::Toolpath;
use toolpathd_core::toolpath::measure::{Bounds, measure};
use toolpathd_core::toolpath::program::Blank;
use toolpathd_core::toolpath::tool_body::Depths;
use toolpathd_core::toolpath::units::{FeedRate, rounded_up};
use toolpathd_plot::Drawing;
use toolpathd_plot::gltf::Stock;
use toolpathd_plot::solid;

/// The answer in JSON.
type MillAnswer = Answer<Report>;

/// Plan the milling of a surface.
///
/// The answer is the toolpath with proved bounds of deviation and gouging, the NC program, or a picture.
#[utoipa::path(post, path = "/v1/surfaces/mill", operation_id = "millSurface", tag = "surfaces",
    params(Wanted<Toolpaths>), request_body = MillRequest,
    responses((status = 200, description = "The toolpath, the program or a picture.", body = MillAnswer)))]
pub async fn mill_surface(
    State(computing): State<Computing>,
    wanted: Wanted<Toolpaths>,
    body: JobBody<MillRequest>,
) -> Result<Response, ApiError> {
    let wants_model = wanted.form.wants_model();
    answer(computing, wanted, body, move |job, budget| mill(job, wants_model, budget)).await
}

/// The toolpath, with the box of the raw part.
struct Milled {
    cut: Cut,
    deviations_mm: Vec<f64>,
    blank: Option<Blank>,
    surface: Arc<Source>,
}

impl Product for Milled {
    type Members = PathMembers;

    const TITLE: &'static str = Cut::TITLE;

    fn cut(&self) -> Option<&Cut> {
        Some(&self.cut)
    }

    fn deviations_mm(&self) -> &[f64] {
        &self.deviations_mm
    }

    /// A request tells the stock by its height over the surface, so its extent is assumed.
    fn solids(&self, _: &Budget) -> Result<Solids, ApiError> {
        let stock = self
            .blank
            .map(|Blank { low, high }| Stock { triangles: solid::block(low, high), is_assumed: true });
        let part = self.surface.surface().map(|surface| Solids::of_surface(&surface)).unwrap_or_default();
        Ok(Solids { stock, ..part })
    }

    fn members(self, written: Option<String>, form: &Form) -> PathMembers {
        self.cut.members(written, form)
    }
}

fn mill(
    job: JobWithSetup<Job>,
    wants_model: bool,
    budget: &Budget,
) -> Result<Outcome<Report, Milled>, ApiError> {
    let JobWithSetup { job, mut setup, meta } = job;
    let has_blank = setup.dialect.states_blank() || wants_model;
    let blank = if has_blank { surface_milling::blank(&job, budget)? } else { None };
    setup.program.blank = blank;
    let Plan { toolpath, deviations_mm, report, cutting, warnings } = surface_milling::plan(&job, budget)?;
    if setup.body.limits_depth() {
        let advice = "rough the block first, and send `stock` of the kind `on_surface`";
        setup.check_depths(&depths(&job, &toolpath, budget)?, ("/stock", advice))?;
    }
    let surface = Arc::new(job.surface);
    let of_drawing = Arc::clone(&surface);
    Ok(Outcome {
        meta,
        warnings: warnings.iter().map(Warning::from).collect(),
        product: Milled {
            cut: Cut { toolpath, cutting: Some(cutting), setup, comments: vec![proved(&report)], nc: None },
            deviations_mm,
            blank,
            surface,
        },
        report,
        drawing: Box::new(move || drawing(&of_drawing)),
    })
}

/// How deep the cutter goes below the top of part and stock. A block is cut down to the surface at once.
fn depths(job: &Job, toolpath: &Toolpath, budget: &Budget) -> Result<Depths, ApiError> {
    let Bounds { min, .. } = measure(toolpath, FeedRate::DEFAULT_RAPID).bounds;
    let at_once_mm = match job.stock {
        Some(surface_milling::Stock::Block { top_z_mm }) => Some(top_z_mm - min.z),
        _ => None,
    };
    Ok(Depths { whole_mm: surface_milling::highest_mm(job, budget)? - min.z, at_once_mm })
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
