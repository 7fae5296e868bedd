//! A request for the program of a toolpath, and its conversion to a job.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::check::Violations;
use super::cutting::Cutting;
use super::meta::{self, Meta};
use super::object;
use super::program::{Program, Units};
use super::sent_toolpath::{Read, Reading, SentToolpath};
use super::tool::Tool;
use super::toolpath::Toolpath;
use crate::config::Limits;
use crate::http::error::{ApiError, FieldCode};
use crate::http::extract::IntoJob;
use crate::http::pointer::Pointer;
use crate::post::{Dialect, NcProgram};
use crate::toolpath as core;
use crate::toolpath::cutting::{self, CLEARANCE_ABOVE_TOP_MM, CuttingRequest};
use crate::toolpath::path::{Move, Role};
use crate::toolpath::units::FeedRate;
use crate::toolpath::{measure, program, tool};

/// How far the radii of an arc may differ, in units of the last decimal: what rounding its points does to it.
const ARC_TOLERANCE_STEPS: f64 = 1.5;

/// Writing a toolpath as an NC program.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct WriteRequest {
    #[serde(deserialize_with = "object::required")]
    #[schema(value_type = Toolpath)]
    toolpath: SentToolpath,
    #[serde(default, deserialize_with = "object::required")]
    program: Program,
    /// Feeds of moves that have none of their own, spindle, coolant and the clearance plane. Default: no spindle, no
    /// coolant, and, with a warning, a clearance plane 20 mm above everything that is cut, or at the highest place of the
    /// toolpath if that is higher.
    #[serde(default, deserialize_with = "object::optional")]
    cutting: Option<Cutting>,
    /// Default: tool 1 with length offset 1, of unknown shape.
    #[serde(default, deserialize_with = "object::optional")]
    tool: Option<Tool>,
    /// Texts of the caller under names of the caller, returned as they came: at most 32.
    #[schema(schema_with = meta::schema)]
    meta: Option<Meta>,
}

/// A request in the core's terms.
#[derive(Debug)]
pub struct WriteJob {
    pub toolpath: core::Toolpath,
    /// Upper bound for the distance between the arcs as sent and the exact ones, mm.
    pub moved_mm: f64,
    /// The clearance height, where nobody gave one, mm.
    pub clearance_chosen_mm: Option<f64>,
    pub tool: Option<tool::Tool>,
    pub cutting: cutting::Cutting,
    pub program: program::Program,
    pub dialect: &'static Dialect,
    pub meta: Option<Meta>,
}

impl IntoJob for WriteRequest {
    type Job = WriteJob;

    fn into_job(self, limits: &Limits) -> Result<WriteJob, ApiError> {
        let Self { toolpath, program, cutting, tool, meta } = self;
        let root = Pointer::root();
        let mut violations = Violations::default();

        program.check(&root.field("program"), &mut violations);
        let (dialect, program) = program.convert();
        let request = cutting.and_then(|cutting| cutting.convert(&root.field("cutting"), &mut violations));
        if let Some(tool) = &tool {
            tool.check(&root.field("tool"), &mut violations);
        }
        if let Some(meta) = &meta {
            meta::check(meta, &root.field("meta"), &mut violations);
        }
        let reading = Reading {
            cutting: request.as_ref(),
            arc_tolerance_mm: ARC_TOLERANCE_STEPS * program.resolution.step_mm(),
            max_moves: limits.moves,
        };
        let read = toolpath.convert(&root.field("toolpath"), &reading, &mut violations);
        let Some(Read { toolpath, moved_mm }) = read else { return Err(violations.into_error()) };
        let is_chosen = request.as_ref().is_none_or(|request| request.clearance_z_mm.is_none());
        let cutting = conditions(&toolpath, request, &mut violations);
        violations.result()?;
        let clearance_chosen_mm = is_chosen.then_some(cutting.clearance_z_mm);
        let tool = tool.map(Into::into);
        Ok(WriteJob { toolpath, moved_mm, clearance_chosen_mm, tool, cutting, program, dialect, meta })
    }
}

/// The conditions for a toolpath that is planned already. The clearance plane is above everything that is cut: a program neither
/// begins nor ends at a height where it cuts.
fn conditions(
    toolpath: &core::Toolpath,
    request: Option<CuttingRequest>,
    violations: &mut Violations,
) -> cutting::Cutting {
    let request = request.unwrap_or_else(|| CuttingRequest::at_feed(first_feed(toolpath)));
    let highest_mm = measure::measure(toolpath, FeedRate::DEFAULT_RAPID).bounds.max.z;
    let top_mm = highest_cut_mm(toolpath);
    let chosen_mm = (top_mm + CLEARANCE_ABOVE_TOP_MM).max(highest_mm);
    let clearance_z_mm = request.clearance_z_mm.unwrap_or(chosen_mm);
    let given = [("clearance_z_mm", request.clearance_z_mm), ("retract_z_mm", request.retract_z_mm)];
    for (field, height_mm) in given {
        if let Some(height_mm) = height_mm.filter(|height_mm| *height_mm <= top_mm) {
            let at = Pointer::root().field("cutting").field(field);
            let detail = format!(
                "{field} is {height_mm} mm; it must be above {top_mm} mm, up to which the toolpath cuts"
            );
            violations.add(&at, FieldCode::HeightBelowTop, detail);
        }
    }
    request.at_heights(clearance_z_mm, request.retract_z_mm.unwrap_or(clearance_z_mm))
}

/// The highest place that is cut: feed moves, but not where the tool comes down from and leaves to. Zero where nothing is.
fn highest_cut_mm(toolpath: &core::Toolpath) -> f64 {
    let heights = toolpath.moves().filter_map(|step| match step {
        Move::Feed { along, role: Role::Cut | Role::Link, .. } => {
            Some(along.support(&nalgebra::Vector3::z()))
        }
        Move::Feed { along, .. } => Some(along.start().z.min(along.end().z)),
        Move::Rapid { .. } | Move::Dwell { .. } => None,
    });
    heights.reduce(f64::max).unwrap_or(0.0)
}

/// The feed of the first move that has one.
fn first_feed(toolpath: &core::Toolpath) -> FeedRate {
    let feed = toolpath.moves().find_map(|step| match step {
        Move::Feed { rate, .. } => *rate,
        Move::Rapid { .. } | Move::Dwell { .. } => None,
    });
    feed.unwrap_or(FeedRate::DEFAULT_RAPID)
}

/// What is proved of a written program.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct WriteReport {
    /// Proved: no point of the cutting moves is farther from the program, nor the other way round, whatever of what it
    /// allows the control does.
    deviation_max_mm: f64,
    /// The part of it that comes of arcs whose radii did not agree as they were sent.
    arc_adjustment_max_mm: f64,
    /// The two radii of an arc block differ nowhere by more.
    radius_mismatch_max_mm: f64,
    /// Blocks of motion and dwell.
    n_blocks: usize,
    n_bytes: usize,
    #[schema(inline)]
    units: Units,
    decimals: u8,
    dialect: &'static str,
}

impl WriteReport {
    pub fn new(job: &WriteJob, written: &NcProgram) -> Self {
        let program::Resolution { units, decimals } = job.program.resolution;
        Self {
            deviation_max_mm: written.max_displacement_mm + job.moved_mm,
            arc_adjustment_max_mm: job.moved_mm,
            radius_mismatch_max_mm: written.max_radius_mismatch_mm,
            n_blocks: written.blocks,
            n_bytes: written.text.len(),
            units: units.into(),
            decimals,
            dialect: job.dialect.name,
        }
    }
}
