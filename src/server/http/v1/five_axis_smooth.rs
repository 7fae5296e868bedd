//! `POST /v1/five-axis/smooth`: smooths a path of tips and tool axes, and answers the motion along it.

use axum::extract::State;
use axum::response::Response;
use nalgebra::{Point3, Vector3};

use crate::http::answer::{Computing, Cut, Outcome, Product, answer};
use crate::http::dto::answer::Answer;
use crate::http::dto::check::Violations;
use crate::http::dto::five_axis::{
    Sample, SampleMembers, SmoothJob, SmoothMembers, SmoothQuery, SmoothRequest,
};
use crate::http::dto::program_writing::conditions;
use crate::http::error::ApiError;
use crate::http::messages::{self, Warning};
use crate::http::pointer::Pointer;
use crate::http::request::body::JobBody;
use crate::http::request::negotiation::{Form, Offers, Toolpaths, Wanted};
use crate::http::request::representation::Representation;
use toolpathd_core::budget::Budget;
use toolpathd_core::machine::Machine;
use toolpathd_core::operations::five_axis::history::{self, Course};
use toolpathd_core::operations::five_axis::{self, Job, Plan, Report, TimedPose};
use toolpathd_core::toolpath::units::rounded_up;
use toolpathd_plot::Drawing;
use toolpathd_plot::diagram::Diagram;

/// The answer in JSON.
type SmoothAnswer = Answer<Report, SmoothMembers>;

/// The forms of the answer, and its query.
pub enum Smooths {}

impl Offers for Smooths {
    const OFFERS: &'static [Representation] = Toolpaths::OFFERS;
    type Query = SmoothQuery;
}

/// Smooth a path of five axes.
///
/// The answer says how far the smooth path is from the given path, how long the motion takes and how it
/// accelerates, and holds straight moves along the path. With `?samples=true` the answer holds the motion
/// itself. As `text/x-gcode` it is the NC program.
#[utoipa::path(post, path = "/v1/five-axis/smooth", operation_id = "smoothPath", tag = "five-axis",
    params(Wanted<Smooths>, SmoothQuery), request_body = SmoothRequest,
    responses((status = 200, description = "The smooth path: its figures, its program or a picture.", body = SmoothAnswer)))]
pub async fn smooth_path(
    State(computing): State<Computing>,
    wanted: Wanted<Smooths>,
    body: JobBody<SmoothRequest>,
) -> Result<Response, ApiError> {
    let representation = wanted.form.representation;
    let shown = Shown {
        samples: wanted.query.with_samples(),
        program: wanted.form.with_nc || representation == Representation::Gcode,
        diagrams: match representation {
            Representation::Svg => wanted.query.shows_motion(),
            representation => representation == Representation::Html || wanted.form.wants_model(),
        },
        model: wanted.form.wants_model(),
    };
    answer(computing, wanted, body, move |job, budget| smooth(job, shown, budget)).await
}

/// What the answer holds beside the toolpath.
#[derive(Clone, Copy)]
struct Shown {
    samples: bool,
    program: bool,
    diagrams: bool,
    model: bool,
}

/// The toolpath and the motion.
struct Motion {
    cut: Cut,
    samples: Vec<TimedPose>,
    machine: Option<Machine>,
    shown: Shown,
    diagrams: Vec<Diagram>,
    /// For each move the time of the motion at its end, s.
    move_ends_s: Vec<f64>,
}

impl Product for Motion {
    type Members = SmoothMembers;

    const TITLE: &'static str = "Path of the tip";

    fn cut(&self) -> Option<&Cut> {
        Some(&self.cut)
    }

    fn diagrams(&self) -> &[Diagram] {
        &self.diagrams
    }

    fn diagram_ends_s(&self) -> &[f64] {
        &self.move_ends_s
    }

    fn members(self, written: Option<String>, form: &Form) -> SmoothMembers {
        let Self { cut, samples, machine, shown, diagrams: _, move_ends_s: _ } = self;
        let samples: Option<Vec<Sample>> = shown
            .samples
            .then(|| samples.iter().map(|sample| Sample::new(sample, machine.as_ref())).collect());
        SmoothMembers { path: cut.members(written, form), motion: SampleMembers { samples } }
    }
}

fn smooth(job: SmoothJob, shown: Shown, budget: &Budget) -> Result<Outcome<Report, Motion>, ApiError> {
    let SmoothJob { mut job, setup, cutting, has_program, meta, text } = job;
    job.wants_samples = shown.samples;
    let states_positions = job.in_step.is_some();
    // Only a program needs moves that are so short, and a model tells the lines of its program.
    job.in_step = job.in_step.filter(|_| shown.program || shown.model && has_program);
    let plan = five_axis::plan(&job, budget)?;
    let diagrams = if shown.diagrams { diagrams(&job, &plan, budget)? } else { Vec::new() };
    let Plan { report, samples, period_s: _, toolpath, warnings, move_ends_s } = plan;
    let mut warnings: Vec<Warning> = warnings.iter().map(Warning::from).chain(text.left_alone).collect();
    let mut violations = Violations::default();
    let conditions = (has_program || shown.program)
        .then(|| conditions(&toolpath, cutting, &Pointer::root(), &mut violations));
    violations.result()?;
    let cutting = conditions.map(|(mut cutting, caution)| {
        cutting.spindle_rpm = cutting.spindle_rpm.or(text.spindle_rpm);
        cutting.coolant = text.coolant.unwrap_or(cutting.coolant);
        warnings.extend(caution.map(Warning::from));
        warnings.extend(report.warning_of_program(&job).as_ref().map(Warning::from));
        if job.limits.is_some() && job.machine.is_some() && !states_positions {
            warnings.extend(setup.five_axes.as_ref().map(|_| messages::positions_of_control()));
        }
        cutting
    });
    let given = job.path.iter().map(|waypoint| waypoint.pose.tip).collect();
    let tool_axes = tool_axes(&samples);
    let comments = std::iter::once(proved(&report)).chain(text.comments).collect();
    Ok(Outcome {
        meta,
        warnings,
        report,
        product: Motion {
            cut: Cut { toolpath, cutting, setup, comments, nc: None },
            samples,
            machine: job.machine,
            shown,
            diagrams,
            move_ends_s,
        },
        drawing: drawing(given, tool_axes),
    })
}

/// Feed, acceleration, jerk and the angles of the axes, before and after.
fn diagrams(job: &Job, plan: &Plan, budget: &Budget) -> Result<Vec<Diagram>, ApiError> {
    let [before, after] = history::before_and_after(job, plan, budget)?;
    let scaled =
        |course: Course, factor: f64| course.into_iter().map(|[t, value]| [t, value * factor]).collect();
    let diagram = |name: String, [before, after]: [Course; 2], factor: f64| Diagram {
        name,
        before: scaled(before, factor),
        after: scaled(after, factor),
    };
    let of_tip = [("feed, mm/min", 60.0), ("acceleration, mm/s2", 1.0), ("jerk, mm/s3", 1.0)];
    let tips = before.tip.into_iter().zip(after.tip).zip(of_tip);
    let mut all: Vec<Diagram> = tips
        .map(|((before, after), (name, factor))| diagram(name.to_owned(), [before, after], factor))
        .collect();
    for ((_, before), (name, after)) in before.angles.into_iter().zip(after.angles) {
        all.push(diagram(format!("{name}, degrees"), [before, after], 1.0_f64.to_degrees()));
    }
    Ok(all)
}

/// The line of a program's header about the path.
fn proved(report: &Report) -> String {
    format!(
        "SMOOTH PATH WITHIN {:.4} MM AND {:.4} DEGREES OF {} POSES",
        rounded_up(report.toolpath_deviation_max_mm),
        rounded_up(report.toolpath_deviation_max_deg),
        report.n_poses
    )
}

/// The given tips and the tool axis beside the toolpath.
fn drawing(given: Vec<Point3<f64>>, tool_axes: Vec<Vec<Point3<f64>>>) -> Box<dyn Fn() -> Drawing + Send> {
    Box::new(move || Drawing {
        curve: vec![given.clone()],
        poses: given.clone(),
        tool_axes: tool_axes.clone(),
        ..Drawing::default()
    })
}

/// Lines of a sheet along the tool axis, and their length as a part of the largest extent of the path.
const AXIS_LINES: usize = 60;
const AXIS_LENGTH: f64 = 0.1;

/// The length of such a line where the tip rests, mm.
const AXIS_AT_REST_MM: f64 = 10.0;

/// Lines along the tool axis at even times. There are none where the axis is up throughout.
fn tool_axes(samples: &[TimedPose]) -> Vec<Vec<Point3<f64>>> {
    if samples.iter().all(|sample| sample.pose.axis == Vector3::z_axis()) {
        return Vec::new();
    }
    let extent = |k: usize| {
        let along = samples.iter().map(|sample| sample.pose.tip[k]);
        along.clone().fold(f64::NEG_INFINITY, f64::max) - along.fold(f64::INFINITY, f64::min)
    };
    let largest = (0..3).map(extent).fold(0.0, f64::max);
    let length_mm = if largest > 0.0 { AXIS_LENGTH * largest } else { AXIS_AT_REST_MM };
    let line = |sample: &TimedPose| {
        let tip = sample.pose.tip;
        vec![tip, tip + sample.pose.axis.into_inner() * length_mm]
    };
    // Samples are even in time.
    let last = samples.len() - 1;
    let count = AXIS_LINES.min(last);
    (0..=count).map(|n| line(&samples[n * last / count.max(1)])).collect()
}
