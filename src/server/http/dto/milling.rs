//! The request to mill a surface, and its conversion to a job.

use serde::Deserialize;
use utoipa::ToSchema;

use super::approach::{Entry, Exit, Stock};
use super::check::{Range, Violations};
use super::cutting::Cutting;
use super::machine_abilities::MachineAbilities;
use super::meta::{Meta, MetaTexts};
use super::program::Program;
use super::setup::{self, JobWithSetup, SentSetup};
use super::strategy::{Sections, Strategy};
use super::surface::Surface;
use super::tool::Tool;
use crate::config::Limits;
use crate::http::decode::IntoJob;
use crate::http::decode::files::FileReading;
use crate::http::decode::object;
use crate::http::error::{ApiError, FieldCode};
use crate::http::messages::Warning;
use crate::http::pointer::Pointer;
use toolpathd_core::operations::surface_milling::{self as core, Boundary, Engine, Interpolation};
use toolpathd_core::toolpath::units::Tolerance;

/// A surface to be milled.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct MillRequest {
    /// The surface of the part.
    surface: Surface,
    /// The cutter.
    #[serde(deserialize_with = "object::required")]
    tool: Tool,
    /// How the surface is milled.
    strategy: Strategy,
    /// Largest allowed distance between the exact path and the written path, in mm. A larger tolerance makes
    /// a shorter program.
    #[schema(minimum = 0.000_001, maximum = 10)]
    tolerance_mm: f64,
    /// What joins the CL points. `arcs`: as few arcs and lines as possible. `lines`: lines only.
    #[serde(default)]
    #[schema(default = "arcs")]
    interpolation: Interpolation,
    /// Largest distance of neighbouring CL points, in mm. A shorter step makes more points. Default: as long
    /// as the tolerance allows.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    step_length_mm: Option<f64>,
    /// How `cl_cartesian` finds the CL points. `contact` lowers the cutter until it touches the surface. It
    /// works with any cutter and any surface, sharp edges included; only what is visible from above is
    /// milled. `offset_section` intersects planes with the offset of the surface. It works with ball cutters
    /// only, and only where the surface is smooth, has no overhangs and is nowhere curved too tightly for the
    /// ball.
    #[serde(default)]
    #[schema(default = "contact")]
    engine: Engine,
    /// Where the passes end. `inside`: the cutter stays inside the outline, seen from above. `on`: the
    /// cutter's contact reaches the edge. `past`: the contact continues past the edge along the tangents, by
    /// at least the cutter's radius.
    #[serde(default)]
    #[schema(default = "on")]
    boundary: Boundary,
    /// Thickness of the stock that the program leaves on the surface, in mm.
    #[schema(minimum = 0, maximum = 1000, default = 0)]
    allowance_mm: Option<f64>,
    /// The stock that stands over the surface. Without `stock`, `cl_cartesian` brings rapids down to 2 mm
    /// above the finished surface plus `allowance_mm`, and the answer warns. `wire_union` brings rapids down
    /// to `cutting.retract_z_mm`, by default 2 mm above the part's highest point, or above the top of `stock`
    /// where that is higher. `wire_union` does not warn where `stock` is absent. Where raw material stands
    /// higher than the part, send `stock`, or the rapids run into it. Programs for Heidenhain state the box
    /// around the part and its stock (BLK FORM).
    stock: Option<Stock>,
    /// How the cutter comes down to a pass of `cl_cartesian`. Default: a plunge.
    entry: Option<Entry>,
    /// How the cutter leaves a pass of `cl_cartesian`. Default: straight up.
    exit: Option<Exit>,
    /// What the machine can do. Default: nothing is assumed.
    #[serde(default, deserialize_with = "object::required")]
    machine: MachineAbilities,
    /// Feeds, spindle, coolant and heights.
    #[serde(deserialize_with = "object::required")]
    cutting: Cutting,
    /// How the NC program is written. Default: for LinuxCNC in mm.
    #[serde(default, deserialize_with = "object::required")]
    program: Program,
    /// Up to 32 names with texts of your choice, for example part id, operation and work order. The answer,
    /// the header of the program and the sheet repeat the texts.
    #[schema(value_type = Option<MetaTexts>)]
    meta: Option<Meta>,
}

/// Refuses a surface that is far smaller than the cutter. Its points were probably sent in metres or inches.
/// `extent` is the size along x and along y, mm.
fn check_size(at: &Pointer, extent: [f64; 2], tool: &Tool, violations: &mut Violations) {
    let [x, y] = extent;
    let is_speck = x.max(y) < LEAST_PART_OF_CUTTER * tool.diameter_mm();
    // An illegal diameter is itself the mistake.
    if Range::POSITIVE.holds(tool.diameter_mm()) && is_speck && x.max(y) > 0.0 {
        let detail = format!(
            "the part measures {x:.4} mm by {y:.4} mm, less than a twentieth of the cutter's diameter: send the points in mm, not in metres or inches"
        );
        violations.add(at, FieldCode::OutOfRange, detail);
    }
}

/// Refuses an allowance that makes the cutter so much larger than the surface that the passes cut nothing, or
/// take far longer than the deadline. `extent` is as in [`check_size`].
fn check_allowance(
    at: &Pointer,
    extent: [f64; 2],
    tool: &Tool,
    allowance_mm: Option<f64>,
    violations: &mut Violations,
) {
    let Some(allowance) = allowance_mm.filter(|allowance| ALLOWANCE.holds(*allowance)) else { return };
    let longer = extent[0].max(extent[1]);
    // A part that is too small even without an allowance is a violation of the surface.
    let is_part = longer >= LEAST_PART_OF_CUTTER * tool.diameter_mm();
    if is_part && longer < LEAST_PART_OF_CUTTER * (tool.diameter_mm() + 2.0 * allowance) {
        let most = 0.5 * (longer / LEAST_PART_OF_CUTTER - tool.diameter_mm());
        let detail = format!(
            "{allowance} mm is too much for a part that measures {longer:.4} mm: send at most {most:.3} mm"
        );
        violations.add(at, FieldCode::LimitExceeded, detail);
    }
}

/// Smallest size of a surface, as a fraction of the cutter's diameter. A smaller surface is refused.
const LEAST_PART_OF_CUTTER: f64 = 0.05;

/// Legal thicknesses of the stock that the program leaves, mm.
const ALLOWANCE: Range = Range { min: 0.0, max: 1000.0 };

impl IntoJob for MillRequest {
    type Job = JobWithSetup<core::Job>;

    fn read_files(&mut self, reading: &mut FileReading) {
        self.surface.read_file(&Pointer::root().field("surface"), reading);
    }

    fn put_right(&mut self, limits: &Limits) -> Vec<Warning> {
        self.surface.put_right(limits)
    }

    fn into_job(self, limits: &Limits) -> Result<Self::Job, ApiError> {
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
            machine,
            cutting,
            program,
            meta,
        } = self;
        let root = Pointer::root();
        let mut violations = Violations::default();

        surface.check(&root.field("surface"), limits, &mut violations);
        if let (Strategy::ClCartesian(_), Engine::OffsetSection) = (&strategy, engine) {
            tool.check_is_ball(&root.field("tool"), &mut violations);
        }
        let checked_tool = tool.convert_mill(&root.field("tool"), &mut violations);
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
        check_allowance(&root.field("allowance_mm"), extent, &tool, allowance_mm, &mut violations);
        violations.optional(&root.field("step_length_mm"), step_length_mm, Range::POSITIVE, "mm");
        let stock = stock.map(|stock| stock.convert(&root.field("stock"), &mut violations));
        let entry = entry.map(|entry| entry.convert(&root.field("entry"), &mut violations));
        let exit = exit.map(|exit| exit.convert(&root.field("exit"), &mut violations));
        let sent =
            SentSetup { tool: Some(checked_tool), body: tool.body(), cutting: Some(cutting), program, meta };
        let (mut setup, cutting, meta) = sent.convert(&mut violations);
        let max_rpm = machine.max_rpm(&root.field("machine"), &mut violations);
        if let Some(cutting) = &cutting {
            setup::check_machine_speed(cutting, max_rpm, &mut violations);
        }
        setup.remarks.extend(Warning::tolerance_coarse(tolerance_mm, checked_tool.radius_mm));
        let (Some(tolerance), Some(cutting), Some(sections)) =
            (Tolerance::from_mm(tolerance_mm), cutting, sections)
        else {
            return Err(violations.into_error());
        };
        violations.result()?;

        let Sections { plane, spacing, direction } = sections;
        let job = core::Job {
            surface: surface.into(),
            tool: checked_tool,
            engine,
            plane,
            spacing,
            boundary,
            direction,
            tolerance,
            allowance_mm: allowance_mm.unwrap_or(0.0),
            stock,
            entry: entry.unwrap_or_default(),
            exit: exit.unwrap_or_default(),
            interpolation,
            step_length_mm,
            cutting,
            resolution: setup.program.resolution,
            curves: setup.dialect.curves,
            plane_limit: limits.sections,
            move_limit: limits.moves,
            point_limit: limits.cl_points,
        };
        Ok(JobWithSetup { job, setup, meta })
    }
}
