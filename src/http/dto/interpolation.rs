//! A request for interpolating a curve, and its conversion to a job.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::check::{Range, Violations};
use super::curve::Curve;
use super::cutting::Cutting;
use super::meta::{self, Meta};
use super::object;
use super::program::Program;
use super::tool::Tool;
use crate::config::Limits;
use crate::geometry::deviation as core_band;
use crate::geometry::element::Element;
use crate::http::error::{ApiError, FieldCode};
use crate::http::extract::IntoJob;
use crate::http::pointer::Pointer;
use crate::operations::interpolation as core;
use crate::post::Dialect;
use crate::toolpath::{program, tool};

/// Sides of a band, mm: as tolerances, but one of them may be zero.
const SIDES: Range = Range { min: 0.0, max: 10.0 };

/// Heights of a contour, mm: what is lifted above it is a coordinate too.
const HEIGHTS: Range = Range { min: -100_000.0, max: 100_000.0 };

/// The least width of a band, mm.
const LEAST_WIDTH_MM: f64 = 1e-6;

const INITIAL_ELEMENTS: (u32, u32) = (1, 10_000);

/// Interpolating a plane curve by elements that stay within a band about it.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct InterpolateRequest {
    curve: Curve,
    method: Method,
    /// `bisection` halves what leaves the band, as Hyun does; `least` makes as few elements as possible.
    #[serde(default)]
    #[schema(default = "bisection")]
    subdivision: Subdivision,
    /// Where elements meet, with `least`: on the curve, or for lines anywhere in the band where that saves some.
    #[serde(default)]
    #[schema(default = "on_curve")]
    joints: Joints,
    /// Equal parts of the domain, in x or the curve's parameter, into which the curve is divided beforehand.
    #[serde(default = "one")]
    #[schema(default = 1, minimum = 1, maximum = 10_000)]
    initial_elements: u32,
    #[serde(deserialize_with = "object::required")]
    band: Band,
    /// On which side of the contour, seen along it, the cutter runs: its path is then the contour's offset by the radius of
    /// `tool`. For lines and arcs.
    #[serde(default)]
    #[schema(default = "none")]
    compensation: Compensation,
    /// Default: tool 1 with length offset 1, of unknown shape.
    #[serde(default, deserialize_with = "object::optional")]
    tool: Option<Tool>,
    /// Height of the contour. Default: 0.
    #[schema(minimum = -100_000, maximum = 100_000)]
    z_mm: Option<f64>,
    /// Without it the toolpath has no feeds and no times, and no program can be written. The top of the part is taken to be
    /// at 0, or at the contour if that is higher.
    #[serde(default, deserialize_with = "object::optional")]
    cutting: Option<Cutting>,
    #[serde(default, deserialize_with = "object::required")]
    program: Program,
    /// Texts of the caller under names of the caller, returned as they came: at most 32.
    #[schema(schema_with = meta::schema)]
    meta: Option<Meta>,
}

fn one() -> u32 {
    1
}

#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = InterpolationMethod)]
pub enum Method {
    Linear,
    Parabolic,
    /// Lines where they stay within the band, else parabolas.
    Mixed,
    /// Arcs, and lines where they would be too flat.
    Arc,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Subdivision {
    #[default]
    Bisection,
    Least,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Joints {
    #[default]
    OnCurve,
    InBand,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Compensation {
    #[default]
    None,
    Left,
    Right,
}

/// How far elements may lie from the curve: below is to its right, above to its left. Together at least 1e-6 mm.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Band {
    #[schema(minimum = 0, maximum = 10)]
    below_mm: f64,
    #[schema(minimum = 0, maximum = 10)]
    above_mm: f64,
    /// `normal`: the distance; `vertical`: along y, for graphs.
    #[serde(default)]
    #[schema(default = "normal")]
    measure: Measure,
}

#[derive(Debug, Clone, Copy, Default, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    #[default]
    Normal,
    Vertical,
}

/// A request in the core's terms, with what the operation does not need to know.
#[derive(Debug)]
pub struct InterpolateJob {
    pub job: core::Job,
    pub tool: Option<tool::Tool>,
    pub program: program::Program,
    pub dialect: &'static Dialect,
    pub meta: Option<Meta>,
}

impl Band {
    fn convert(self, at: &Pointer, violations: &mut Violations) -> core_band::Band {
        let Self { below_mm, above_mm, measure } = self;
        violations.number(&at.field("below_mm"), below_mm, SIDES, "mm");
        violations.number(&at.field("above_mm"), above_mm, SIDES, "mm");
        if below_mm >= 0.0 && above_mm >= 0.0 && below_mm + above_mm < LEAST_WIDTH_MM {
            let detail = format!("{} mm wide; at least {LEAST_WIDTH_MM} mm are needed", below_mm + above_mm);
            violations.add(at, FieldCode::OutOfRange, detail);
        }
        let measure = match measure {
            Measure::Normal => core_band::Measure::Normal,
            Measure::Vertical => core_band::Measure::Vertical,
        };
        core_band::Band { below_mm, above_mm, measure }
    }
}

impl IntoJob for InterpolateRequest {
    type Job = InterpolateJob;

    fn into_job(self, limits: &Limits) -> Result<InterpolateJob, ApiError> {
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
            let detail = "joints in the band go with `subdivision: least`";
            violations.add(&root.field("joints"), FieldCode::Conflict, detail);
        }
        violations.integer(&root.field("initial_elements"), initial_elements, INITIAL_ELEMENTS);
        let band = band.convert(&root.field("band"), &mut violations);
        if let Some(tool) = &tool {
            tool.check(&root.field("tool"), &mut violations);
        }
        let tool: Option<tool::Tool> = tool.map(Into::into);
        let side = match compensation {
            Compensation::None => None,
            Compensation::Left => Some(core::Side::Left),
            Compensation::Right => Some(core::Side::Right),
        };
        if side.is_some() && tool.is_none() {
            let detail = "`tool` is required where its radius is compensated";
            violations.add(&root.field("tool"), FieldCode::MissingField, detail);
        }
        violations.optional(&root.field("z_mm"), z_mm, HEIGHTS, "mm");
        let cutting = cutting.and_then(|cutting| cutting.convert(&root.field("cutting"), &mut violations));
        program.check(&root.field("program"), &mut violations);
        if let Some(meta) = &meta {
            meta::check(meta, &root.field("meta"), &mut violations);
        }
        violations.result()?;

        let (dialect, program) = program.convert();
        let job = core::Job {
            curve: curve.into(),
            method: match method {
                Method::Linear => core::Method::Linear,
                Method::Parabolic => core::Method::Parabolic,
                Method::Mixed => core::Method::Mixed,
                Method::Arc => core::Method::Arc,
            },
            subdivision: match (subdivision, joints) {
                (Subdivision::Bisection, _) => core::Subdivision::Bisection,
                (Subdivision::Least, Joints::OnCurve) => core::Subdivision::Least(core::Joints::OnCurve),
                (Subdivision::Least, Joints::InBand) => core::Subdivision::Least(core::Joints::InBand),
            },
            initial_elements: initial_elements as usize,
            band,
            compensation: side.zip(tool.map(|tool| tool.radius_mm)),
            z_mm: z_mm.unwrap_or(0.0),
            cutting,
            resolution: program.resolution,
            element_limit: limits.elements,
            parabolas: dialect.parabolas,
        };
        Ok(InterpolateJob { job, tool, program, dialect, meta })
    }
}

#[derive(Debug, Clone, Copy, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    Line,
    Parabola,
    Arc,
}

impl From<&Element> for Shape {
    fn from(element: &Element) -> Self {
        match element {
            Element::Line { .. } => Self::Line,
            Element::Arc(_) => Self::Arc,
            Element::Parabola { .. } => Self::Parabola,
        }
    }
}

/// One element of the interpolation, in order.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[schema(as = InterpolatedElement)]
pub struct ReportedElement {
    #[schema(inline)]
    shape: Shape,
    /// The initial element it is a part of, counted from 1.
    initial_element: usize,
    /// The part of the curve it stands for: x of a graph, else the curve's parameter.
    domain: [f64; 2],
    /// Proved: nowhere is it farther from the curve, by the measure of the band.
    deviation_mm: f64,
}

/// What the elements are like.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct InterpolateReport {
    n_elements: usize,
    /// Proved: no elements of this method, with joints as they are asked for, are fewer. Not told of more than 10,000 elements
    /// by bisection.
    #[serde(skip_serializing_if = "Option::is_none")]
    n_elements_lower_bound: Option<usize>,
    elements_per_initial: Vec<usize>,
    /// Of what is cut.
    length_mm: f64,
    /// Length by feed, where there is a feed.
    #[serde(skip_serializing_if = "Option::is_none")]
    cutting_time_s: Option<f64>,
    /// Proved: no element is anywhere farther from the curve, by the measure of the band.
    deviation_max_mm: f64,
    /// Proved, of the program as it is written: `deviation_max_mm` with what rounding to its decimals adds. Not where the
    /// radius of a tool is compensated.
    #[serde(skip_serializing_if = "Option::is_none")]
    deviation_written_max_mm: Option<f64>,
    elements: Vec<ReportedElement>,
}

impl From<core::Report> for InterpolateReport {
    fn from(report: core::Report) -> Self {
        let core::Report {
            elements,
            elements_per_initial,
            n_elements_lower_bound,
            length_mm,
            cutting_time_s,
            deviation_max_mm,
            deviation_written_max_mm,
        } = report;
        let reported = |element: &core::ReportedElement| {
            let core::ReportedElement { element, initial_element, domain, spread } = element;
            ReportedElement {
                shape: element.into(),
                initial_element: initial_element + 1,
                domain: *domain,
                deviation_mm: spread.largest_mm(),
            }
        };
        Self {
            n_elements: elements.len(),
            n_elements_lower_bound,
            elements_per_initial,
            length_mm,
            cutting_time_s,
            deviation_max_mm,
            deviation_written_max_mm,
            elements: elements.iter().map(reported).collect(),
        }
    }
}
