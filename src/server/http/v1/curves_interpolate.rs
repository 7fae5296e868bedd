//! `POST /v1/curves/interpolate`: replaces a plane curve by lines, arcs or parabolas that stay in a band
//! about the curve. Answers these elements as JSON, a program or a picture.

use axum::extract::State;
use axum::response::Response;
use nalgebra::{Point2, Point3};

use crate::http::answer::{Computing, Cut, Outcome, ProvedCut, answer};
use crate::http::dto::answer::Answer;
use crate::http::dto::interpolation::InterpolateRequest;
use crate::http::dto::setup::JobWithSetup;
use crate::http::error::ApiError;
use crate::http::messages::Warning;
use crate::http::request::body::JobBody;
use crate::http::request::negotiation::{Toolpaths, Wanted};
use toolpathd_core::budget::Budget;
use toolpathd_core::operations::interpolation::{self, Job, Plan, Report, Sketch};
use toolpathd_core::toolpath::units::rounded_up;
use toolpathd_plot::Drawing;

/// The answer in JSON.
type InterpolateAnswer = Answer<Report>;

/// Replace a plane curve by lines, arcs or parabolas within a band.
///
/// The answer is the elements, the NC program that runs the elements, or a picture. Every element has a
/// proved distance from the curve.
#[utoipa::path(post, path = "/v1/curves/interpolate", operation_id = "interpolateCurve", tag = "curves",
    params(Wanted<Toolpaths>), request_body = InterpolateRequest,
    responses((status = 200, description = "The elements, the program or a picture.", body = InterpolateAnswer)))]
pub async fn interpolate_curve(
    State(computing): State<Computing>,
    wanted: Wanted<Toolpaths>,
    body: JobBody<InterpolateRequest>,
) -> Result<Response, ApiError> {
    answer(computing, wanted, body, interpolate).await
}

fn interpolate(job: JobWithSetup<Job>, budget: &Budget) -> Result<Outcome<Report, ProvedCut>, ApiError> {
    let JobWithSetup { job, setup, meta } = job;
    let plan = interpolation::plan(&job, budget)?;
    let Plan { curve, band, toolpath, deviations_mm, report, cutting, warnings } = plan;
    let (elements, height) = (report.elements.clone(), job.z_mm);
    Ok(Outcome {
        meta,
        warnings: warnings.iter().map(Warning::from).collect(),
        product: ProvedCut {
            cut: Cut { toolpath, cutting, setup, comments: vec![proved(&report)], nc: None },
            deviations_mm,
        },
        report,
        drawing: Box::new(move || drawing(interpolation::sketch(&curve, &band, &elements), height)),
    })
}

/// The sketch of the curve, its band and its joints, lifted to the height of the contour.
fn drawing(sketch: Sketch, z_mm: f64) -> Drawing {
    let lift = |points: Vec<Point2<f64>>| points.into_iter().map(|p| Point3::new(p.x, p.y, z_mm)).collect();
    let Sketch { curve, band, joints } = sketch;
    Drawing {
        curve: vec![lift(curve)],
        band: band.map(lift).into(),
        joints: lift(joints),
        ..Drawing::default()
    }
}

/// The line with the proved figures for the program's header. The deviation is rounded up.
fn proved(report: &Report) -> String {
    let least = report.n_elements_lower_bound.map(|least| format!(" - AT LEAST {least}")).unwrap_or_default();
    format!(
        "{} ELEMENTS{least} - PROVED DEVIATION {:.4} MM",
        report.n_elements,
        rounded_up(report.deviation_max_mm)
    )
}
