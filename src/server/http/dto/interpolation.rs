//! The request to interpolate a curve, and its conversion to a job.

use serde::Deserialize;
use utoipa::ToSchema;

use super::check::{Range, Violations};
use super::curve::Curve;
use super::cutting::Cutting;
use super::meta::{Meta, MetaTexts};
use super::program::Program;
use super::setup::{JobWithSetup, SentSetup};
use super::tool::Tool;
use crate::config::Limits;
use crate::http::decode::IntoJob;
use crate::http::decode::object;
use crate::http::error::{ApiError, FieldCode};
use crate::http::pointer::Pointer;
use toolpathd_core::geometry::deviation::{self, Measure};
use toolpathd_core::operations::interpolation::{self as core, Joints, Method};

/// Legal widths of each side of a band, mm. One side may be zero.
const SIDES: Range = Range { min: 0.0, max: 10.0 };

/// Legal heights of a contour, mm. Retract and clearance planes above the contour must be legal coordinates
/// too.
const HEIGHTS: Range = Range { min: -100_000.0, max: 100_000.0 };

/// Smallest width of both sides of a band together, mm.
const LEAST_WIDTH_MM: f64 = 1e-6;

/// The smallest and the largest legal number of initial elements.
const INITIAL_ELEMENTS: (u32, u32) = (1, 10_000);

/// A plane curve to be replaced by lines, arcs or parabolas that stay within a band around the curve.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct InterpolateRequest {
    /// The curve.
    curve: Curve,
    /// The elements that the curve is divided into. `linear`: lines. `parabolic`: parabolas. `mixed`: lines
    /// where lines stay within the band, else parabolas. `arc`: arcs, and lines where arcs would be too flat.
    method: Method,
    /// How the curve is divided. `bisection`: each element that leaves the band is halved. `least`: as few
    /// elements as possible.
    #[serde(default)]
    #[schema(default = "bisection")]
    subdivision: Subdivision,
    /// Where elements meet. `on_curve`: on the curve. `in_band`: anywhere in the band, where that saves
    /// elements. `in_band` needs `subdivision: least` and `method: linear`.
    #[serde(default)]
    #[schema(default = "on_curve")]
    joints: Joints,
    /// Number of equal parts into which the curve is divided at first: equal in x for a graph, else in the
    /// curve's parameter.
    #[serde(default = "one")]
    #[schema(default = 1, minimum = 1, maximum = 10_000)]
    initial_elements: u32,
    /// The band around the curve in which the elements stay.
    #[serde(deserialize_with = "object::required")]
    band: Band,
    /// The side of the contour on which the cutter runs, seen along the curve: `left`, `right` or `none`.
    /// With `left` or `right` the path is the contour's offset by the radius of `tool`; `method` must be
    /// `linear` or `arc`.
    #[serde(default)]
    #[schema(default = "none")]
    compensation: Compensation,
    /// The tool. Required with `compensation: left` or `right`. Without `tool` the program calls tool 1 with
    /// length offset 1.
    #[serde(default, deserialize_with = "object::optional")]
    tool: Option<Tool>,
    /// Height of the contour, in mm.
    #[schema(minimum = -100_000, maximum = 100_000, default = 0)]
    z_mm: Option<f64>,
    /// Feeds, spindle, coolant and heights. Without `cutting` the toolpath has no feeds and no times, and no
    /// program can be written. For the default heights the top of the part is taken as z = 0, or as `z_mm`
    /// where `z_mm` is above 0; heights below that top are refused.
    #[serde(default, deserialize_with = "object::optional")]
    cutting: Option<Cutting>,
    /// How the NC program is written. Default: for LinuxCNC in mm.
    #[serde(default, deserialize_with = "object::required")]
    program: Program,
    /// Up to 32 names with texts of your choice, for example part id, operation and work order. The answer,
    /// the header of the program and the sheet repeat the texts.
    #[schema(value_type = Option<MetaTexts>)]
    meta: Option<Meta>,
}

fn one() -> u32 {
    1
}

/// How the curve is divided.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Subdivision {
    #[default]
    Bisection,
    Least,
}

/// The side of the contour on which the cutter runs.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Compensation {
    #[default]
    None,
    Left,
    Right,
}

/// The band around the curve. `below_mm` and `above_mm` together are at least 1e-6 mm.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Band {
    /// Width of the band to the right of the curve, in mm, seen along the curve: below a graph. A wider band
    /// makes fewer elements.
    #[schema(minimum = 0, maximum = 10)]
    below_mm: f64,
    /// Width of the band to the left of the curve, in mm, seen along the curve: above a graph. A wider band
    /// makes fewer elements.
    #[schema(minimum = 0, maximum = 10)]
    above_mm: f64,
    /// How the distance from the curve is measured. `normal`: the shortest distance. `vertical`: the distance
    /// along y, for graphs only.
    #[serde(default)]
    #[schema(default = "normal")]
    measure: Measure,
}

impl Band {
    fn convert(self, at: &Pointer, violations: &mut Violations) -> deviation::Band {
        let Self { below_mm, above_mm, measure } = self;
        violations.number(&at.field("below_mm"), below_mm, SIDES, "mm");
        violations.number(&at.field("above_mm"), above_mm, SIDES, "mm");
        if below_mm >= 0.0 && above_mm >= 0.0 && below_mm + above_mm < LEAST_WIDTH_MM {
            let detail = format!(
                "the band is {} mm wide; `below_mm` and `above_mm` together must be at least {LEAST_WIDTH_MM} mm",
                below_mm + above_mm
            );
            violations.add(at, FieldCode::OutOfRange, detail);
        }
        deviation::Band { below_mm, above_mm, measure }
    }
}

impl IntoJob for InterpolateRequest {
    type Job = JobWithSetup<core::Job>;

    fn into_job(self, limits: &Limits) -> Result<Self::Job, ApiError> {
        let Self {
            curve,
            method,
            subdivision,
            joints,
            initial_elements,
            band,
            compensation,
            tool,
            z_mm,
            cutting,
            program,
            meta,
        } = self;
        let root = Pointer::root();
        let mut violations = Violations::default();

        curve.check(&root.field("curve"), limits, &mut violations);
        if joints == Joints::InBand && subdivision != Subdivision::Least {
            let detail = "`joints: in_band` needs `subdivision: least`";
            violations.add(&root.field("joints"), FieldCode::Conflict, detail);
        }
        violations.integer(&root.field("initial_elements"), initial_elements, INITIAL_ELEMENTS);
        let band = band.convert(&root.field("band"), &mut violations);
        let tool = tool.map(|tool| tool.convert(&root.field("tool"), &mut violations));
        let side = match compensation {
            Compensation::None => None,
            Compensation::Left => Some(core::Side::Left),
            Compensation::Right => Some(core::Side::Right),
        };
        if side.is_some() && tool.is_none() {
            let detail = "`compensation` needs the radius of a tool: send `tool`";
            violations.add(&root.field("tool"), FieldCode::MissingField, detail);
        }
        violations.optional(&root.field("z_mm"), z_mm, HEIGHTS, "mm");
        let sent = SentSetup { tool, cutting, program, meta };
        let (setup, cutting, meta) = sent.convert(&mut violations);
        violations.result()?;

        let job = core::Job {
            curve: curve.into(),
            method,
            subdivision: match subdivision {
                Subdivision::Bisection => core::Subdivision::Bisection,
                Subdivision::Least => core::Subdivision::Least(joints),
            },
            initial_elements: initial_elements as usize,
            band,
            compensation: side.zip(setup.tool.map(|tool| tool.radius_mm)),
            z_mm: z_mm.unwrap_or(0.0),
            cutting,
            resolution: setup.program.resolution,
            element_limit: limits.elements,
            step_limit: limits.curve_steps,
            curves: setup.dialect.curves,
        };
        Ok(JobWithSetup { job, setup, meta })
    }
}
