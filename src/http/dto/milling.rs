//! A request for milling a surface, and its conversion to a job.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::approach::{Entry, Exit, Stock};
use super::check::{Range, Violations};
use super::cutting::Cutting;
use super::meta::{self, Meta};
use super::object;
use super::point::Place;
use super::program::Program;
use super::strategy::{Sections, Strategy};
use super::surface::Surface;
use super::tool::Tool;
use crate::config::Limits;
use crate::http::error::{ApiError, FieldCode};
use crate::http::extract::IntoJob;
use crate::http::pointer::Pointer;
use crate::operations::surface_milling as core;
use crate::post::Dialect;
use crate::toolpath::program as core_program;
use crate::toolpath::units::Tolerance;

/// Finishing a surface.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct MillRequest {
    surface: Surface,
    #[serde(deserialize_with = "object::required")]
    tool: Tool,
    strategy: Strategy,
    /// The proved distance between the path as written and the exact one is at most this.
    #[schema(minimum = 0.000_001, maximum = 10)]
    tolerance_mm: f64,
    #[serde(default)]
    #[schema(default = "arcs")]
    interpolation: Interpolation,
    /// Upper bound for the distance of neighbouring CL points. Default: none but what the tolerance asks for.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    step_length_mm: Option<f64>,
    /// Of `cl_cartesian`.
    #[serde(default)]
    #[schema(default = "contact")]
    engine: Engine,
    /// Where the passes end: `inside`, the cutter stays inside the outline seen from above; `on`, its contact reaches the
    /// edge; `past`, the contact goes on past the edge, straight on along the tangents, by the cutter's radius at least.
    #[serde(default)]
    #[schema(default = "on")]
    boundary: Boundary,
    /// Stock to be left on the surface. Default: 0.
    #[schema(minimum = 0, maximum = 1000)]
    allowance_mm: Option<f64>,
    /// Without it the answer warns, and rapids end 2 mm above the surface, raised by `allowance_mm`. With `wire_union` they end 2 mm
    /// above the part, and there is no warning.
    stock: Option<Stock>,
    /// Of `cl_cartesian`. Default: a plunge.
    entry: Option<Entry>,
    /// Of `cl_cartesian`. Default: straight up.
    exit: Option<Exit>,
    #[serde(deserialize_with = "object::required")]
    cutting: Cutting,
    #[serde(default, deserialize_with = "object::required")]
    program: Program,
    /// Texts of the caller under names of the caller, returned as they came: at most 32.
    #[schema(schema_with = meta::schema)]
    meta: Option<Meta>,
}

/// What the CL points are joined by.
#[derive(Debug, Clone, Copy, Default, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Interpolation {
    #[default]
    Arcs,
    Lines,
}

/// How the CL points are found. `contact`: the cutter comes down until it touches; any cutter and any surface, seen from above, with its
/// edges. `offset_section`: sections of the offset surface (Ju), for balls and smooth surfaces without overhangs into which the ball
/// fits.
#[derive(Debug, Clone, Copy, Default, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Engine {
    #[default]
    Contact,
    OffsetSection,
}

#[derive(Debug, Clone, Copy, Default, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Boundary {
    Inside,
    #[default]
    On,
    Past,
}

/// Blames a surface that is so much smaller than the cutter that it cannot be meant.
fn check_size(at: &Pointer, extent: [f64; 2], tool: &Tool, violations: &mut Violations) {
    let [x, y] = extent;
    // A cutter beyond any is itself the mistake, or stands for a diameter that could not be read.
    let is_cutter = tool.diameter_mm() <= LARGEST_CUTTER_MM;
    let is_speck = is_cutter && x.max(y) < LEAST_PART_OF_CUTTER * tool.diameter_mm();
    if is_speck && x.max(y) > 0.0 {
        let detail = format!(
            "the part measures {x:.4} mm by {y:.4} mm, less than a twentieth of the cutter: are its points in metres or inches?"
        );
        violations.add(at, FieldCode::OutOfRange, detail);
    }
}

/// No cutter has a larger diameter, mm.
const LARGEST_CUTTER_MM: f64 = 500.0;

/// Surfaces smaller than this part of the cutter's diameter are refused.
const LEAST_PART_OF_CUTTER: f64 = 0.05;

/// Stock that may be left, mm.
const ALLOWANCE: Range = Range { min: 0.0, max: 1000.0 };

/// A request in the core's terms, with what the operation does not need to know.
#[derive(Debug)]
pub struct MillJob {
    pub job: core::Job,
    pub program: core_program::Program,
    pub dialect: &'static Dialect,
    pub meta: Option<Meta>,
}

impl IntoJob for MillRequest {
    type Job = MillJob;

    fn into_job(self, limits: &Limits) -> Result<MillJob, ApiError> {
        let Self {
            surface,
            tool,
            strategy,
            tolerance_mm,
            interpolation,
            step_length_mm,
            engine,
            boundary,
            allowance_mm,
            stock,
            entry,
            exit,
            cutting,
            program,
            meta,
        } = self;
        let root = Pointer::root();
        let mut violations = Violations::default();

        surface.check(&root.field("surface"), limits, &mut violations);
        match (&strategy, engine) {
            (Strategy::ClCartesian(_), Engine::OffsetSection) => {
                tool.check_ball(&root.field("tool"), &mut violations);
            }
            (Strategy::ClCartesian(_), Engine::Contact) | (Strategy::WireUnion(_), _) => {
                tool.check(&root.field("tool"), &mut violations);
            }
        }
        let (low, high) = surface.bounds();
        let extent = [high.x - low.x, high.y - low.y];
        check_size(&root.field("surface"), extent, &tool, &mut violations);
        let sections = strategy.convert(&root.field("strategy"), extent, limits.sections, &mut violations);
        if let Some(sections) = &sections {
            sections.check_boundary(&root.field("boundary"), boundary, &mut violations);
            for (name, is_given) in [("entry", entry.is_some()), ("exit", exit.is_some())] {
                sections.check_absent(&root.field(name), is_given, &mut violations);
            }
            sections.check_scallops(&root.field("strategy"), &tool, &mut violations);
        }
        let range = Range { min: Tolerance::MIN_MM, max: Tolerance::MAX_MM };
        violations.number(&root.field("tolerance_mm"), tolerance_mm, range, "mm");
        violations.optional(&root.field("allowance_mm"), allowance_mm, ALLOWANCE, "mm");
        violations.optional(&root.field("step_length_mm"), step_length_mm, Range::POSITIVE, "mm");
        let stock = stock.map(|stock| stock.convert(&root.field("stock"), &mut violations));
        let entry = entry.map(|entry| entry.convert(&root.field("entry"), &mut violations));
        let exit = exit.map(|exit| exit.convert(&root.field("exit"), &mut violations));
        let cutting = cutting.convert(&root.field("cutting"), &mut violations);
        program.check(&root.field("program"), &mut violations);
        if let Some(meta) = &meta {
            meta::check(meta, &root.field("meta"), &mut violations);
        }
        let (Some(tolerance), Some(cutting), Some(sections)) =
            (Tolerance::from_mm(tolerance_mm), cutting, sections)
        else {
            return Err(violations.into_error());
        };
        violations.result()?;

        let Sections { plane, spacing, direction } = sections;
        let (dialect, program) = program.convert();
        let job = core::Job {
            surface: surface.into(),
            tool: tool.into(),
            engine: match engine {
                Engine::Contact => core::Engine::Contact,
                Engine::OffsetSection => core::Engine::OffsetSection,
            },
            plane,
            spacing,
            boundary: match boundary {
                Boundary::Inside => core::Boundary::Inside,
                Boundary::On => core::Boundary::On,
                Boundary::Past => core::Boundary::Past,
            },
            direction,
            tolerance,
            allowance_mm: allowance_mm.unwrap_or(0.0),
            stock,
            entry: entry.unwrap_or_default(),
            exit: exit.unwrap_or_default(),
            interpolation: match interpolation {
                Interpolation::Arcs => core::Interpolation::Arcs,
                Interpolation::Lines => core::Interpolation::Lines,
            },
            step_length_mm,
            cutting,
            resolution: program.resolution,
            plane_limit: limits.sections,
        };
        Ok(MillJob { job, program, dialect, meta })
    }
}

/// What the planned passes are like.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct MillReport {
    n_passes: usize,
    n_cl_points: usize,
    /// Distance of neighbouring planes.
    stepover_mm: f64,
    /// Proved: the path as written lies nowhere farther from the exact one.
    deviation_max_mm: f64,
    /// Proved: the cutter penetrates the surface nowhere deeper.
    gouge_max_mm: f64,
    /// Where it was found to be deepest; `null` where nothing was, or the bound is not that of a place.
    gouge_at: Option<Place>,
    /// What the cutter cannot reach at concave places, along the normal of the surface: the largest that was found among some
    /// thousand places; `null` where it was not looked for: the engine `offset_section` takes no surface that the ball does not reach.
    rest_sampled_max_mm: Option<f64>,
    /// Where that is.
    rest_at: Option<Place>,
    /// Proved: no more is left between passes, along the normal of the surface; but for the deviation, and for what
    /// lies so near to an edge that the way to the next pass leaves the surface. `null` where the passes are too far
    /// apart to meet, the cutter is no ball, or cannot follow the surface everywhere.
    scallop_max_mm: Option<f64>,
    n_arcs: usize,
    n_lines: usize,
}

impl From<&core::Report> for MillReport {
    fn from(report: &core::Report) -> Self {
        let &core::Report {
            n_passes,
            n_cl_points,
            stepover_mm,
            deviation_max_mm,
            gouge_max_mm,
            gouge_at,
            rest_sampled_max_mm,
            rest_at,
            scallop_max_mm,
            n_arcs,
            n_lines,
        } = report;
        Self {
            n_passes,
            n_cl_points,
            stepover_mm,
            deviation_max_mm,
            gouge_max_mm,
            gouge_at: gouge_at.map(Place::from),
            rest_sampled_max_mm,
            rest_at: rest_at.map(Place::from),
            scallop_max_mm,
            n_arcs,
            n_lines,
        }
    }
}
