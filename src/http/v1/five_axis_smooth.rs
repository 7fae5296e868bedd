//! `POST /v1/five-axis/smooth`: smooths a path of tips and tool axes, and answers the motion along it.

use std::sync::Arc;

use axum::extract::State;
use axum::response::Response;

use crate::budget::Budget;
use crate::http::App;
use crate::http::answer::{Cut, Outcome, Product, answer};
use crate::http::dto::answer::Answer;
use crate::http::dto::five_axis::{
    Sample, SampleMembers, SmoothJob, SmoothQuery, SmoothReport, SmoothRequest,
};
use crate::http::dto::toolpath::{Warning, WarningCode};
use crate::http::error::{ApiError, Code, FieldCode};
use crate::http::extract::JobBody;
use crate::http::negotiation::{Form, Models, Offers, Wanted};
use crate::http::output::Representation;
use crate::http::pointer::Pointer;
use crate::machine::{FollowError, Machine};
use crate::operations::five_axis::{self, FiveAxisError, TimedPose};
use crate::plot::Drawing;
use crate::toolpath::units::rounded_up_mm;

/// The answer in JSON.
type SmoothAnswer = Answer<SmoothReport, SampleMembers>;

/// The forms of the answer, and its query.
pub enum Smooths {}

impl Offers for Smooths {
    const OFFERS: &'static [Representation] = Models::OFFERS;
    const OWN_PARAMETERS: &'static [&'static str] = &SmoothQuery::NAMES;
    type Query = SmoothQuery;
}

/// Smooth a path of five axes.
///
/// The answer says how far the smooth path is from the given path, how long the motion takes and how it
/// accelerates. With `?samples=true` the answer holds the motion itself.
#[utoipa::path(post, path = "/v1/five-axis/smooth", operation_id = "smoothPath", tag = "five-axis",
    params(Wanted<Smooths>, SmoothQuery), request_body = SmoothRequest,
    responses((status = 200, description = "The figures of the smooth path, and its samples.", body = SmoothAnswer)))]
pub async fn smooth_path(
    State(app): State<Arc<App>>,
    wanted: Wanted<Smooths>,
    body: JobBody<SmoothRequest>,
) -> Result<Response, ApiError> {
    let with_samples = wanted.query.with_samples();
    answer(&app, wanted, body, move |job, budget| smooth(job, with_samples, budget)).await
}

/// The motion, and whether the answer holds it.
struct Motion {
    samples: Vec<TimedPose>,
    machine: Option<Machine>,
    with_samples: bool,
}

impl Product for Motion {
    type Members = SampleMembers;

    const TITLE: &'static str = "Path of the tip";

    fn cut(&self) -> Option<&Cut> {
        None
    }

    fn members(self, _: Option<String>, _: &Form) -> SampleMembers {
        SampleMembers {
            samples: self.with_samples.then(|| {
                self.samples.iter().map(|sample| Sample::new(sample, self.machine.as_ref())).collect()
            }),
        }
    }
}

fn smooth(
    job: SmoothJob,
    with_samples: bool,
    budget: &Budget,
) -> Result<Outcome<SmoothReport, Motion>, ApiError> {
    let SmoothJob { job, meta } = job;
    let plan = five_axis::plan(&job, budget)?;
    let tips = plan.samples.iter().map(|sample| sample.pose.tip).collect();
    let given = job.poses.iter().map(|pose| pose.tip).collect();
    let excess = (!plan.report.is_within_tolerance).then(|| Warning {
        code: WarningCode::ToleranceExceeded,
        detail: format!(
            "`method: paper` leaves the tolerances: up to {:.4} mm and {:.3} degrees from the given path; send `interpolating`",
            rounded_up_mm(plan.report.deviation_mm),
            plan.report.deviation_axis.to_degrees()
        ),
    });
    Ok(Outcome {
        meta,
        warnings: excess.into_iter().collect(),
        report: SmoothReport::from(&plan.report),
        product: Motion { samples: plan.samples, machine: job.machine, with_samples },
        drawing: drawing(tips, given),
    })
}

/// The smooth path of the tip, and the given tips.
fn drawing(
    tips: Vec<nalgebra::Point3<f64>>,
    given: Vec<nalgebra::Point3<f64>>,
) -> Box<dyn Fn() -> Drawing + Send> {
    Box::new(move || Drawing { curve: vec![tips.clone()], joints: given.clone(), ..Drawing::default() })
}

impl From<FiveAxisError> for ApiError {
    fn from(error: FiveAxisError) -> Self {
        let detail = error.to_string();
        let path = Pointer::root().field("path");
        let invalid =
            |at: &Pointer| Self::new(Code::InvalidRequest, detail.clone()).blaming(at, FieldCode::OutOfRange);
        match error {
            FiveAxisError::Stopped(stopped) => stopped.into(),
            FiveAxisError::NoMotion => invalid(&path),
            FiveAxisError::OppositeAxes { index } => invalid(&path.index(index).field("axis")),
            FiveAxisError::ToleranceNotReached { at } => {
                Self::new(Code::ToleranceNotReached, detail).at(at.into())
            }
            FiveAxisError::NotFollowed { error, at } => {
                let code = match error {
                    FollowError::Unreachable { .. } => Code::AxisUnreachable,
                    _ => Code::OutOfTravel,
                };
                Self::new(code, detail).at(at.into())
            }
            FiveAxisError::OnPole { at } => Self::new(Code::AxisOnPole, detail).at(at.into()),
            FiveAxisError::NotScheduled { at, .. } => {
                let limits = Pointer::root().field("limits");
                Self::new(Code::InvalidRequest, detail).blaming(&limits, FieldCode::OutOfRange).at(at.into())
            }
            FiveAxisError::TooManySamples { .. } => Self::new(Code::LimitExceeded, detail)
                .blaming(&Pointer::root().field("sample_period_ms"), FieldCode::LimitExceeded),
        }
    }
}
