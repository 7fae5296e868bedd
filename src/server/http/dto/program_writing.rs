//! The request to write the program of a toolpath, its conversion to a job, and the report.

mod further;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use self::further::Before;
pub use self::further::{FurtherOperation, Operation};
use super::axis_output::AxisSetup;
use super::check::Violations;
use super::cutting::Cutting;
use super::five_axis::SentMachine;
use super::meta::{Meta, MetaTexts};
use super::program::Program;
use super::schema::{array_of, reference, schema_of};
use super::sent_toolpath::{Read, ReadSettings, SentToolpath};
use super::setup::{JobWithSetup, SentSetup, Setup};
use super::tool::Tool;
use crate::config::Limits;
use crate::http::decode::IntoJob;
use crate::http::decode::object;
use crate::http::error::{ApiError, FieldCode};
use crate::http::pointer::Pointer;
use toolpathd_core::machine::Straying;
use toolpathd_core::toolpath as core;
use toolpathd_core::toolpath::cutting::{self, CLEARANCE_ABOVE_TOP_MM, Caution, CuttingRequest};
use toolpathd_core::toolpath::path::{Move, Pass, Role};
use toolpathd_core::toolpath::units::FeedRate;
use toolpathd_core::toolpath::{measure, program};
use toolpathd_post::{AxisOutput, Dialect, NcProgram};

/// How far the radii at the start and at the end of an arc may differ, in units of the last decimal. Rounding
/// the points of an exact arc makes its radii differ by about this much.
const ARC_TOLERANCE_STEPS: f64 = 1.5;

/// A toolpath to be written as an NC program.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct WriteRequest {
    /// The toolpath: moves as other endpoints return them, and canned cycles.
    #[serde(deserialize_with = "object::required")]
    toolpath: SentToolpath,
    /// How the NC program is written. Default: for LinuxCNC in mm.
    #[serde(default, deserialize_with = "object::required")]
    program: Program,
    /// Spindle, coolant, the clearance plane, and the feeds of moves that have no `feed_mm_per_min` of their
    /// own. Without `cutting` the program starts no spindle and no coolant. Without `clearance_z_mm` the
    /// clearance plane is 20 mm above everything that the toolpath cuts, or at the highest place of the
    /// toolpath if that place is higher, and the answer warns.
    #[serde(default, deserialize_with = "object::optional")]
    cutting: Option<Cutting>,
    /// The tool. Without `tool` the program calls tool 1 with length offset 1.
    #[serde(default, deserialize_with = "object::optional")]
    tool: Option<Tool>,
    /// The machine of a toolpath whose tool axis leans or turns. Default: none.
    #[serde(default, deserialize_with = "object::optional")]
    machine: Option<SentMachine>,
    /// How the program states the tool axis. Default: as `angles` where the dialect can and `machine` is
    /// given, as `vectors` where the dialect can and there is no `machine`, else as `machine`. A toolpath
    /// whose axis is straight up needs neither.
    axis_output: Option<AxisOutput>,
    /// Operations that follow in the same program, in order. Between two operations of different tools or
    /// work offsets the tool moves to the `safe_home`, which has to be another than `none` where the dialect
    /// has one. Between two tools, spindle and coolant stop, and the program changes the tool. An operation
    /// of the same tool at the same offset goes on over the higher one of both clearance planes. Default:
    /// none. The dialect `deckel` has one operation to a program, and `grbl` one tool.
    #[serde(default, deserialize_with = "object::optional_list")]
    #[schema(value_type = Option<FurtherOperations>)]
    further_operations: Option<Vec<FurtherOperation>>,
    /// Up to 32 names with texts of your choice, for example part id, operation and work order. The answer,
    /// the header of the program and the sheet repeat the texts.
    #[schema(value_type = Option<MetaTexts>)]
    meta: Option<Meta>,
}

schema_of!(FurtherOperations of FurtherOperation, "Operations that follow the first one.", {
    array_of(reference::<FurtherOperation>(), 0, further::MOST)
});

/// The job of writing a program.
#[derive(Debug)]
pub struct Writing {
    pub first: Operation,
    pub further: Vec<Operation>,
}

impl Writing {
    pub fn operations(&self) -> impl Iterator<Item = &Operation> {
        std::iter::once(&self.first).chain(&self.further)
    }

    /// Upper bound for the distance between the arcs in the request and the exact arcs, mm.
    pub fn moved_mm(&self) -> f64 {
        self.operations().map(|operation| operation.moved_mm).fold(0.0, f64::max)
    }
}

impl IntoJob for WriteRequest {
    type Job = JobWithSetup<Writing>;

    fn into_job(self, limits: &Limits) -> Result<Self::Job, ApiError> {
        let Self { toolpath, program, cutting, tool, machine, axis_output, further_operations, meta } = self;
        let root = Pointer::root();
        let mut violations = Violations::default();

        let body = tool.as_ref().map(Tool::body).unwrap_or_default();
        let tool = tool.map(|tool| tool.convert(&root.field("tool"), &mut violations));
        let sent = SentSetup { tool, body, cutting, program, meta };
        let (mut setup, request, meta) = sent.convert(&mut violations);
        let machine = machine.and_then(|sent| sent.convert(&root.field("machine"), &mut violations));
        let reading = ReadSettings {
            cutting: request.as_ref(),
            arc_tolerance_mm: ARC_TOLERANCE_STEPS * setup.program.resolution.step_mm(),
            max_moves: limits.moves,
            may_be_apart: false,
        };
        let read = toolpath.convert(&root.field("toolpath"), &reading, &mut violations);
        let Some(Read { toolpath, moved_mm }) = read else { return Err(violations.into_error()) };
        if !toolpath.is_upright() || machine.is_some() || axis_output.is_some() {
            let allowed =
                Straying { tip_mm: setup.program.resolution.step_mm(), axis: STRAYING_DEG.to_radians() };
            setup.five_axes =
                AxisSetup::choose(axis_output, machine, setup.dialect, allowed, &mut violations);
        }
        let (cutting, caution) = conditions(&toolpath, request, &root, &mut violations);
        let further = further_operations.unwrap_or_default();
        if !further.is_empty() && setup.five_axes.is_some() {
            let detail = "a program whose tool leans or turns, or with `machine` or `axis_output`, has one operation: send each toolpath alone";
            violations.add(&root.field("further_operations"), FieldCode::Conflict, detail);
        }
        let before =
            Before { tool: setup.tool, body: setup.body.clone(), request, program: setup.program.clone() };
        let n_moves = toolpath.moves().count();
        let further = converted(further, (before, setup.dialect), n_moves, limits, &mut violations);
        violations.result()?;
        let (tool, program) = (setup.tool, setup.program.clone());
        let remarks = setup.remarks.clone();
        let first = Operation { name: None, toolpath, moved_mm, caution, cutting, tool, program, remarks };
        Ok(JobWithSetup { job: Writing { first, further }, setup, meta })
    }
}

/// The operations that follow a toolpath of `n_moves` moves. Those with violations are left out.
fn converted(
    further: Vec<FurtherOperation>,
    (mut before, dialect): (Before, &'static Dialect),
    n_moves: usize,
    limits: &Limits,
    violations: &mut Violations,
) -> Vec<Operation> {
    let at = Pointer::root().field("further_operations");
    if further.len() > further::MOST {
        let detail = format!("{} operations are too many; send at most {}", further.len(), further::MOST);
        violations.add(&at, FieldCode::TooLong, detail);
        return Vec::new();
    }
    let n_moves = n_moves + further.iter().map(FurtherOperation::n_moves).sum::<usize>();
    if n_moves > limits.moves {
        let most = limits.moves;
        let detail = format!("the toolpaths have {n_moves} moves together; send at most {most}");
        violations.add(&at, FieldCode::LimitExceeded, detail);
        return Vec::new();
    }
    let mut operations = Vec::with_capacity(further.len());
    for (k, sent) in further.into_iter().enumerate() {
        let (operation, after) = sent.convert(&at.index(k), (before, dialect), limits.moves, violations);
        operations.extend(operation);
        before = after;
    }
    operations
}

/// The cutting conditions for a toolpath that is planned already. The clearance plane must be above all
/// cutting moves, so that a program neither begins nor ends at a height where it cuts. There is a caution
/// where `request` does not give the clearance plane. `at` is the object whose member `cutting` is.
pub fn conditions(
    toolpath: &core::Toolpath,
    request: Option<CuttingRequest>,
    at: &Pointer,
    violations: &mut Violations,
) -> (cutting::Cutting, Option<Caution>) {
    let request = request.unwrap_or_else(|| CuttingRequest::at_feed(first_feed(toolpath)));
    let highest_mm = measure::measure(toolpath, FeedRate::DEFAULT_RAPID).bounds.max.z;
    let top_mm = highest_cut_mm(toolpath);
    let chosen_mm = (top_mm + CLEARANCE_ABOVE_TOP_MM).max(highest_mm);
    let clearance_z_mm = request.clearance_z_mm.unwrap_or(chosen_mm);
    let given = [("clearance_z_mm", request.clearance_z_mm), ("retract_z_mm", request.retract_z_mm)];
    for (field, height_mm) in given {
        if let Some(height_mm) = height_mm.filter(|height_mm| *height_mm <= top_mm) {
            let at = at.field("cutting").field(field);
            let detail = format!(
                "`{field}` is {height_mm} mm, and the highest cut of the toolpath is at z = {top_mm} mm: send a height above {top_mm} mm"
            );
            violations.add(&at, FieldCode::HeightBelowTop, detail);
        }
    }
    let chosen = Caution::ClearanceChosen { z_mm: clearance_z_mm };
    let caution = request.clearance_z_mm.is_none().then_some(chosen);
    (request.at_heights(clearance_z_mm, request.retract_z_mm.unwrap_or(clearance_z_mm)), caution)
}

/// The highest z of cutting moves, mm. Of plunges, ramps, lead-ins and lead-outs only the lower end counts,
/// and of canned cycles the height of the material.
/// Zero without feed moves.
fn highest_cut_mm(toolpath: &core::Toolpath) -> f64 {
    let moves = toolpath.passes().iter().flat_map(Pass::moves_outside_cycles);
    let heights = moves.filter_map(|step| match step {
        Move::Feed { along, role: Role::Cut | Role::Link, .. } => {
            Some(along.support(&nalgebra::Vector3::z()))
        }
        Move::Feed { along, .. } => Some(along.start().z.min(along.end().z)),
        Move::Rapid { .. } | Move::Turn { .. } | Move::Dwell { .. } => None,
    });
    let drilled = toolpath.passes().iter().flat_map(Pass::cycles).map(|cycle| cycle.hole.top_z_mm);
    heights.chain(drilled).reduce(f64::max).unwrap_or(0.0)
}

/// The feed of the first move with a feed, else the default traverse rate.
fn first_feed(toolpath: &core::Toolpath) -> FeedRate {
    let feed = toolpath.moves().find_map(|step| match step {
        Move::Feed { rate, .. } => *rate,
        Move::Rapid { .. } | Move::Turn { .. } | Move::Dwell { .. } => None,
    });
    feed.unwrap_or(FeedRate::DEFAULT_RAPID)
}

/// How far the axis may stray from the great circle between two blocks, degrees: as far as the rounding of
/// angles on most controls.
const STRAYING_DEG: f64 = 0.005;

/// What is proved of a written program.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct WriteReport {
    /// Proved largest distance between the cutting moves as sent and as written, in mm, measured from each to
    /// the other. Because coordinates are rounded, the radii at the start and at the end of an arc differ
    /// slightly; the bound holds for every radius between the two that the control may use. For `G5.1` the
    /// bound includes the arcs that LinuxCNC runs instead.
    deviation_max_mm: f64,
    /// Proved largest angle between the tool axis as sent and as written, in degrees. Absent where the
    /// program states no tool axis.
    #[serde(skip_serializing_if = "Option::is_none")]
    deviation_max_deg: Option<f64>,
    /// The part of `deviation_max_mm`, in mm, that comes from making arcs exact whose radii at the start and
    /// at the end differed in the request.
    arc_adjustment_max_mm: f64,
    /// Largest difference between the radii at the start and at the end of a written arc, in mm.
    radius_mismatch_max_mm: f64,
    /// How much longer blocks take in all that are too short for the largest F that the control reads, in s:
    /// those under G93, and turns whose F counts degrees by the minute. Absent where there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    slowed_s: Option<f64>,
    /// Number of written blocks that move or pause.
    n_blocks: usize,
    /// Length of the program, in bytes.
    n_bytes: usize,
    /// Units of the written program.
    units: program::Units,
    /// Number of decimals of a written coordinate.
    decimals: u8,
    /// Name of the dialect of the written program.
    dialect: &'static str,
}

impl WriteReport {
    pub fn new(job: &Writing, setup: &Setup, written: &NcProgram) -> Self {
        let program::Resolution { units, decimals } = setup.program.resolution;
        Self {
            deviation_max_mm: written.max_displacement_mm + job.moved_mm(),
            deviation_max_deg: setup.five_axes.as_ref().map(|_| written.max_displacement_axis.to_degrees()),
            arc_adjustment_max_mm: job.moved_mm(),
            radius_mismatch_max_mm: written.max_radius_mismatch_mm,
            slowed_s: (written.slowed.blocks > 0).then_some(written.slowed.by_s),
            n_blocks: written.blocks,
            n_bytes: written.text.len(),
            units,
            decimals,
            dialect: setup.dialect.name,
        }
    }
}
