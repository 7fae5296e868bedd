//! A request for fitting arcs to a polyline, and its conversion to a job.

use serde::{Deserialize, Serialize};
use utoipa::openapi::schema::Schema;
use utoipa::{IntoParams, ToSchema};

use super::check::{Range, Violations};
use super::cutting::Cutting;
use super::meta::{self, Meta};
use super::moves::Plane;
use super::object;
use super::point::{Position, row_schema_of};
use super::program::Program;
use super::tool::Tool;
use crate::config::Limits;
use crate::geometry::arc_fit as core_fit;
use crate::geometry::plane;
use crate::http::error::{ApiError, Code, FieldCode};
use crate::http::extract::IntoJob;
use crate::http::output::Representation;
use crate::http::pointer::Pointer;
use crate::http::v1::dialects;
use crate::operations::arc_fitting as core;
use crate::post::Dialect;
use crate::post::rewrite::{self, Figures, RewriteJob};
use crate::toolpath::{program, tool};

/// Fitting the fewest arcs and lines to a polyline. An arc turns by at most 180 degrees between two neighbouring points.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct FitRequest {
    /// Points `[x, y]`, at z = 0, or `[x, y, z]`, all of one kind. Coincident neighbours count once.
    #[schema(schema_with = polyline_schema)]
    polyline: Vec<Position>,
    /// Where the arcs lie. Default: where the points do, stretch by stretch; helices over the xy plane elsewhere.
    #[schema(inline)]
    plane: Option<Plane>,
    #[schema(minimum = 0.000_001, maximum = 10)]
    tolerance_mm: f64,
    #[serde(default)]
    #[schema(default = "optimal")]
    method: Method,
    #[serde(default)]
    #[schema(default = "position")]
    continuity: Continuity,
    #[serde(default)]
    #[schema(default = "points")]
    measure: Measure,
    #[serde(default)]
    #[schema(default = "free")]
    joints: Joints,
    /// The last point is joined to the first. A closed polyline may be one full circle.
    #[serde(default)]
    #[schema(default = false)]
    closed: bool,
    /// Without it the toolpath has no feeds and no times, and no program can be written. The top of the part is taken to be
    /// at 0, or at the highest point if that is higher.
    #[serde(default, deserialize_with = "object::optional")]
    cutting: Option<Cutting>,
    /// Default: tool 1 with length offset 1, of unknown shape.
    #[serde(default, deserialize_with = "object::optional")]
    tool: Option<Tool>,
    #[serde(default, deserialize_with = "object::required")]
    program: Program,
    /// Texts of the caller under names of the caller, returned as they came: at most 32.
    #[schema(schema_with = meta::schema)]
    meta: Option<Meta>,
}

fn polyline_schema() -> Schema {
    row_schema_of::<Position>(Limits::DEFAULT.curve_points).into()
}

/// `optimal`: the fewest elements. `greedy`: each as long as it can be (Ju). `biarc`: two arcs a span through every point,
/// whatever the tolerance.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = ArcFitMethod)]
pub enum Method {
    #[default]
    Optimal,
    Greedy,
    Biarc,
}

/// `position`: elements meet. `tangent`: they also go on in the same direction, but at real corners.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = ArcFitContinuity)]
pub enum Continuity {
    #[default]
    Position,
    Tangent,
}

/// What is within the tolerance. `points`: the points, taken as samples of a smooth curve; between them the elements may be
/// farther from the lines that join them. `polyline`: the lines between the points are the shape, and lie within the
/// tolerance of the elements, and these of them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = ArcFitMeasure)]
pub enum Measure {
    #[default]
    Points,
    Polyline,
}

/// Where elements meet. `on_points`: on points of the polyline. `free`: also beside them, within the tolerance, where the points
/// have errors of their own and that saves elements.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = ArcFitJoints)]
pub enum Joints {
    #[default]
    Free,
    OnPoints,
}

impl From<Method> for core_fit::Method {
    fn from(method: Method) -> Self {
        match method {
            Method::Optimal => Self::Optimal,
            Method::Greedy => Self::Greedy,
            Method::Biarc => Self::Biarc,
        }
    }
}

impl From<Continuity> for core_fit::Continuity {
    fn from(continuity: Continuity) -> Self {
        match continuity {
            Continuity::Position => Self::Position,
            Continuity::Tangent => Self::Tangent,
        }
    }
}

/// How the G1 blocks of a program are fitted: the query of a body that is NC text.
#[derive(Debug, Clone, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct ProgramQuery {
    /// With a body of NC text, where it is required: the largest distance, both ways, of what is written from the lines that it
    /// stands for.
    #[param(required = false, minimum = 0.000_001, maximum = 10)]
    tolerance_mm: f64,
    /// With a body of NC text: a name listed by `/v1/dialects`. Default: `linuxcnc`.
    dialect: Option<String>,
    /// With a body of NC text. Default: `optimal`.
    #[serde(default)]
    #[param(inline, required = false)]
    method: ProgramMethod,
    /// With a body of NC text. Default: `position`.
    #[serde(default)]
    #[param(inline, required = false)]
    continuity: Continuity,
    /// Read with the endpoint's other parameters.
    #[serde(rename = "format")]
    #[param(ignore)]
    pub representation: Option<Representation>,
}

/// What a program can be fitted by: `optimal`, the fewest elements, or `greedy`, each as long as it can be.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ProgramMethod {
    #[default]
    Optimal,
    Greedy,
}

impl ProgramQuery {
    /// # Errors
    /// `invalid_query`.
    pub fn job(&self) -> Result<RewriteJob, ApiError> {
        let invalid = |detail: String| ApiError::new(Code::InvalidQuery, detail);
        let Self { tolerance_mm, dialect, method, continuity, representation: _ } = self;
        if !TOLERANCES.holds(*tolerance_mm) {
            let Range { min, max } = TOLERANCES;
            return Err(invalid(format!("`tolerance_mm` is {tolerance_mm}; it must be in {min}..={max}")));
        }
        let method = match method {
            ProgramMethod::Optimal => core_fit::Method::Optimal,
            ProgramMethod::Greedy => core_fit::Method::Greedy,
        };
        let continuity = (*continuity).into();
        let fit = core_fit::Fit { method, continuity, ..core_fit::Fit::within(*tolerance_mm) };
        Ok(RewriteJob { dialect: dialects::find(dialect.as_deref()).map_err(invalid)?, fit })
    }
}

/// Of a polyline, or of a program.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[serde(untagged)]
pub enum AnyFitReport {
    Polyline(FitReport),
    Program(ProgramReport),
}

/// What was done to a program.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct ProgramReport {
    /// Runs of G1 blocks that were fitted.
    n_runs: u64,
    /// Ends of their blocks.
    n_points: u64,
    n_arcs: u64,
    n_lines: u64,
    /// Proved: nothing that was written is farther from the lines that it stands for, nor they from it, as a control may
    /// run it.
    deviation_max_mm: f64,
    /// Lines that move an axis.
    n_motions: u64,
    /// Cutting lines that could be in no run, by what kept them out of one.
    #[schema(inline)]
    left_alone: LeftAlone,
    bytes_in: u64,
    bytes_out: u64,
}

/// Why cutting lines were left as they are, and how many.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct LeftAlone {
    /// Variables, expressions, and words that are not understood.
    macros: u64,
    /// Axes beside X, Y and Z.
    other_axes: u64,
    /// Cutter compensation, absolute centres, feeds by time, or a mode of which nothing is known.
    modes: u64,
}

impl From<Figures> for ProgramReport {
    fn from(figures: Figures) -> Self {
        let Figures { n_runs, n_points, n_arcs, n_lines, deviation_max_mm, n_motions, left_alone, .. } =
            figures;
        let rewrite::LeftAlone { macros, other_axes, modes } = left_alone;
        let left_alone = LeftAlone { macros, other_axes, modes };
        let Figures { bytes_in, bytes_out, .. } = figures;
        Self {
            n_runs,
            n_points,
            n_arcs,
            n_lines,
            deviation_max_mm,
            n_motions,
            left_alone,
            bytes_in,
            bytes_out,
        }
    }
}

/// A request in the core's terms, with what the operation does not need to know.
#[derive(Debug)]
pub struct FitJob {
    pub job: core::Job,
    pub tool: Option<tool::Tool>,
    pub program: program::Program,
    pub dialect: &'static Dialect,
    pub meta: Option<Meta>,
}

/// Tolerances of any fit, mm.
pub const TOLERANCES: Range = Range { min: 1e-6, max: 10.0 };

impl IntoJob for FitRequest {
    type Job = FitJob;

    fn into_job(self, limits: &Limits) -> Result<FitJob, ApiError> {
        let Self {
            polyline,
            plane,
            tolerance_mm,
            method,
            continuity,
            measure,
            joints,
            closed,
            cutting,
            tool,
            program,
            meta,
        } = self;
        let root = Pointer::root();
        let mut violations = Violations::default();

        check_polyline(&root.field("polyline"), &polyline, closed, limits, &mut violations);
        let plane = plane.map(plane::Plane::from);
        let is_flat = polyline.first().is_some_and(Position::is_flat);
        if is_flat && plane.is_some_and(|plane| plane != plane::Plane::Xy) {
            let detail = "points [x, y] lie in the xy plane";
            violations.add(&root.field("plane"), FieldCode::Conflict, detail);
        }
        violations.number(&root.field("tolerance_mm"), tolerance_mm, TOLERANCES, "mm");
        let cutting = cutting.and_then(|cutting| cutting.convert(&root.field("cutting"), &mut violations));
        if let Some(tool) = &tool {
            tool.check(&root.field("tool"), &mut violations);
        }
        program.check(&root.field("program"), &mut violations);
        if let Some(meta) = &meta {
            meta::check(meta, &root.field("meta"), &mut violations);
        }
        violations.result()?;

        let (dialect, program) = program.convert();
        let fit = core_fit::Fit {
            method: method.into(),
            continuity: continuity.into(),
            measure: match measure {
                Measure::Points => core_fit::Measure::Points,
                Measure::Polyline => core_fit::Measure::Polyline,
            },
            joints: match joints {
                Joints::Free => core_fit::Joints::Free,
                Joints::OnPoints => core_fit::Joints::OnPoints,
            },
            is_closed: closed,
            ..core_fit::Fit::within(tolerance_mm)
        };
        let job = core::Job {
            points: polyline.into_iter().map(Into::into).collect(),
            plane,
            fit,
            cutting,
            resolution: program.resolution,
        };
        Ok(FitJob { job, tool: tool.map(Into::into), program, dialect, meta })
    }
}

fn check_polyline(
    at: &Pointer,
    polyline: &[Position],
    is_closed: bool,
    limits: &Limits,
    violations: &mut Violations,
) {
    let least = if is_closed { 3 } else { 2 };
    if !violations.count_of_points(at, polyline.len(), least, limits.curve_points) {
        return;
    }
    for (k, point) in polyline.iter().enumerate() {
        point.check_in(at, k, violations);
        if point.is_flat() != polyline[0].is_flat() {
            let detail = "points are all [x, y] or all [x, y, z]";
            violations.add(&at.index(k), FieldCode::WrongLength, detail);
        }
    }
}

/// What the elements are like.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct FitReport {
    n_points: usize,
    n_arcs: usize,
    n_lines: usize,
    /// The distance within which the elements pass the points in order; by the measure `polyline` that of the lines between
    /// them too, both ways.
    deviation_max_mm: f64,
    /// Proved, of the program as it is written: `deviation_max_mm` with what rounding to its decimals adds.
    deviation_written_max_mm: f64,
    /// The largest angle at which neighbouring elements meet.
    kink_max_deg: f64,
    /// Joints where they meet at more than 0.01 degrees: with `continuity: tangent` the real corners.
    n_kinks: usize,
    /// Of what is cut.
    length_mm: f64,
    /// Length by feed, where there is a feed.
    #[serde(skip_serializing_if = "Option::is_none")]
    cutting_time_s: Option<f64>,
}

impl From<core::Report> for FitReport {
    fn from(report: core::Report) -> Self {
        let core::Report {
            n_points,
            n_arcs,
            n_lines,
            deviation_max_mm,
            deviation_written_max_mm,
            kink_max_deg,
            n_kinks,
            length_mm,
            cutting_time_s,
        } = report;
        Self {
            n_points,
            n_arcs,
            n_lines,
            deviation_max_mm,
            deviation_written_max_mm,
            kink_max_deg,
            n_kinks,
            length_mm,
            cutting_time_s,
        }
    }
}
