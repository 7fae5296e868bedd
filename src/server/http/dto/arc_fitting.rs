//! The requests to fit arcs to a polyline and to an NC program.

use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

use super::check::{Range, Violations};
use super::cutting::Cutting;
use super::dialect::{self, DialectName};
use super::meta::{Meta, MetaTexts};
use super::point::Position;
use super::program::Program;
use super::schema::{array_of, reference, schema_of};
use super::setup::{JobWithSetup, SentSetup};
use super::tool::Tool;
use crate::config::Limits;
use crate::http::decode::query::{self, FromQuery, Parameters};
use crate::http::decode::{IntoJob, object};
use crate::http::error::{ApiError, Code, FieldCode};
use crate::http::pointer::Pointer;
use toolpathd_core::geometry::arc_fit::{Continuity, Fit, Joints, Measure, Method};
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::operations::arc_fitting as core;
use toolpathd_post::rewrite::{Figures, RewriteJob};

/// Points to be replaced by arcs and lines. An arc turns by at most 180 degrees between two neighbouring
/// points.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct FitRequest {
    /// The points in mm, in order: all `[x, y]`, at z = 0, or all `[x, y, z]`. Neighbours that coincide count
    /// as one point.
    #[schema(value_type = Polyline)]
    polyline: Vec<Position>,
    /// The plane of the arcs: `xy` (G17), `zx` (G18) or `yz` (G19). Default: for each stretch of the polyline
    /// the plane that the stretch is parallel to; a stretch parallel to none of the three planes becomes
    /// helices about Z.
    plane: Option<Plane>,
    /// Largest allowed distance between the elements and the points, or the polyline, in mm: `measure` says
    /// which. A larger tolerance makes fewer elements.
    #[schema(minimum = 0.000_001, maximum = 10)]
    tolerance_mm: f64,
    /// How elements are found. `optimal`: the fewest elements; `fewest_not_proved` in the report names where
    /// that is not proved. `greedy`: each element is as long as possible. `biarc`: two arcs through each pair
    /// of neighbouring points; `tolerance_mm` is ignored.
    #[serde(default)]
    #[schema(default = "optimal")]
    method: Method,
    /// How neighbouring elements meet. `position`: at an angle if need be. `tangent`: in the same direction,
    /// except at real corners.
    #[serde(default)]
    #[schema(default = "position")]
    continuity: Continuity,
    /// What the tolerance applies to. `points`: the points are samples of a smooth curve. The elements pass
    /// every point within the tolerance; between the points they may be farther from the straight lines.
    /// `polyline`: the straight lines between the points are the exact shape. No point of an element is
    /// farther than the tolerance from the lines, and no point of the lines is farther than the tolerance
    /// from the elements.
    #[serde(default)]
    #[schema(default = "points")]
    measure: Measure,
    /// Where elements meet. `on_points`: on points of the polyline. `free`: on points, or beside points
    /// within the tolerance where that saves elements. Places beside points are tried, and the fewest
    /// elements over all places are not proved. Up to 100 points, `continuity: position` makes no more
    /// elements than `continuity: tangent`.
    #[serde(default)]
    #[schema(default = "free")]
    joints: Joints,
    /// Whether the last point is joined to the first point. A closed polyline may become one full circle.
    #[serde(default)]
    #[schema(default = false)]
    closed: bool,
    /// Feeds, spindle, coolant and heights. Without `cutting` the toolpath has no feeds and no times, and no
    /// program can be written. For the default heights the top of the part is taken as z = 0, or as the
    /// highest point where that point is above 0; heights below that top are refused.
    #[serde(default, deserialize_with = "object::optional")]
    cutting: Option<Cutting>,
    /// The tool. Without `tool` the program calls tool 1 with length offset 1.
    #[serde(default, deserialize_with = "object::optional")]
    tool: Option<Tool>,
    /// How the NC program is written. Default: for LinuxCNC in mm.
    #[serde(default, deserialize_with = "object::required")]
    program: Program,
    /// Up to 32 names with texts of your choice, for example part id, operation and work order. The answer,
    /// the header of the program and the sheet repeat the texts.
    #[schema(value_type = Option<MetaTexts>)]
    meta: Option<Meta>,
}

schema_of!(Polyline of Position, "Points in mm, in order.", {
    array_of(reference::<Position>(), 2, Limits::DEFAULT.curve_points)
});

/// How the G1 blocks of a program are fitted: the query of a body that is NC text.
#[derive(Debug, Clone, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct ProgramQuery {
    /// Required with a body of NC text, refused with a body of JSON: the largest distance between the new
    /// blocks and the straight moves that they replace, in mm. A larger tolerance makes fewer blocks.
    #[param(required = false, minimum = 0.000_001, maximum = 10)]
    tolerance_mm: f64,
    /// Dialect of a body of NC text, as listed by `/v1/dialects`; refused with a body of JSON. `siemens`,
    /// `heidenhain`, `deckel` and `okuma` are not read. Default:
    /// `linuxcnc`.
    #[param(value_type = Option<DialectName>)]
    dialect: Option<String>,
    /// How the blocks for a body of NC text are found; refused with a body of JSON. `optimal`: the fewest
    /// blocks. `greedy`: each block is as long as possible. Default: `optimal`.
    #[param(inline, required = false)]
    method: ProgramMethod,
    /// How neighbouring blocks for a body of NC text meet; refused with a body of JSON. `position`: at an
    /// angle if need be. `tangent`: in the same direction, except at real corners. Default: `position`.
    #[param(inline, required = false)]
    continuity: Continuity,
}

/// How the blocks of a program are found.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ProgramMethod {
    #[default]
    Optimal,
    Greedy,
}

impl FromQuery for ProgramQuery {
    const NAMES: &'static [&'static str] = &["tolerance_mm", "dialect", "method", "continuity"];

    fn read(sent: &Parameters) -> Result<Self, String> {
        Ok(Self {
            tolerance_mm: sent.number("tolerance_mm")?.ok_or_else(|| query::required("tolerance_mm"))?,
            dialect: sent.text("dialect")?.map(str::to_owned),
            method: sent.name("method")?.unwrap_or_default(),
            continuity: sent.name("continuity")?.unwrap_or_default(),
        })
    }
}

impl ProgramQuery {
    /// The job of the query.
    ///
    /// # Errors
    /// `invalid_query` when the tolerance is out of range, or the dialect is unknown or cannot be rewritten.
    pub fn job(&self) -> Result<RewriteJob, ApiError> {
        let invalid = |detail: String| ApiError::new(Code::InvalidQuery, detail);
        let Self { tolerance_mm, dialect, method, continuity } = self;
        if !TOLERANCES.holds(*tolerance_mm) {
            let Range { min, max } = TOLERANCES;
            return Err(invalid(format!("`tolerance_mm` is {tolerance_mm}; send {min} to {max} mm")));
        }
        let method = match method {
            ProgramMethod::Optimal => Method::Optimal,
            ProgramMethod::Greedy => Method::Greedy,
        };
        let fit = Fit { method, continuity: *continuity, ..Fit::within(*tolerance_mm) };
        let dialect = dialect::find(dialect.as_deref()).map_err(invalid)?;
        if !dialect.has_plain_words() {
            let detail = format!(
                "programs in the dialect `{}` are not read here; choose another dialect, or send points as JSON",
                dialect.name
            );
            return Err(invalid(detail));
        }
        Ok(RewriteJob { dialect, fit })
    }
}

/// The report on a polyline, or on an NC program.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[serde(untagged)]
pub enum AnyFitReport {
    Polyline(core::Report),
    Program(Figures),
}

/// Legal tolerances of a fit, mm.
pub const TOLERANCES: Range = Range { min: 1e-6, max: 10.0 };

impl IntoJob for FitRequest {
    type Job = JobWithSetup<core::Job>;

    fn into_job(self, limits: &Limits) -> Result<Self::Job, ApiError> {
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
        let is_flat = polyline.first().is_some_and(Position::is_flat);
        if is_flat && plane.is_some_and(|plane| plane != Plane::Xy) {
            let detail = "points `[x, y]` lie in the xy plane: leave `plane` out, or send points `[x, y, z]`";
            violations.add(&root.field("plane"), FieldCode::Conflict, detail);
        }
        violations.number(&root.field("tolerance_mm"), tolerance_mm, TOLERANCES, "mm");
        let body = tool.as_ref().map(Tool::body).unwrap_or_default();
        let tool = tool.map(|tool| tool.convert(&root.field("tool"), &mut violations));
        let sent = SentSetup { tool, body, cutting, program, meta };
        let (setup, cutting, meta) = sent.convert(&mut violations);
        violations.result()?;

        let within = Fit::within(tolerance_mm);
        let fit = Fit { method, continuity, measure, joints, is_closed: closed, ..within };
        let job = core::Job {
            points: polyline.into_iter().map(Into::into).collect(),
            plane,
            fit,
            cutting,
            resolution: setup.program.resolution,
            curves: setup.dialect.curves,
        };
        Ok(JobWithSetup { job, setup, meta })
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
            let detail = "the first point has another number of coordinates: send all points as `[x, y]`, or all as `[x, y, z]`";
            violations.add(&at.index(k), FieldCode::WrongLength, detail);
        }
    }
}
