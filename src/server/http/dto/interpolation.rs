//! The request to interpolate a curve, and its conversion to a job.

use std::fmt::{self, Formatter};

use serde::Deserialize;
use serde::de::{self, Deserializer, Visitor};
use utoipa::openapi::RefOr;
use utoipa::openapi::schema::{ObjectBuilder, OneOfBuilder, Schema, Type};
use utoipa::{PartialSchema, ToSchema};

use super::check::{Range, Violations};
use super::curve::Curve;
use super::cutting::Cutting;
use super::meta::{Meta, MetaTexts};
use super::program::Program;
use super::schema::number;
use super::setup::{JobWithSetup, SentSetup};
use super::tool::Tool;
use crate::config::Limits;
use crate::http::decode::IntoJob;
use crate::http::decode::object;
use crate::http::error::{ApiError, FieldCode};
use crate::http::pointer::Pointer;
use toolpathd_core::geometry::deviation::{self, Measure};
use toolpathd_core::language::expression::LONGEST_TEXT;
use toolpathd_core::operations::interpolation::{self as core, Joints, Method, Widths};

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
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Band {
    /// Width of the band to the right of the curve, in mm, seen along the curve: below a graph. A wider band
    /// makes fewer elements.
    below_mm: BandWidth,
    /// Width of the band to the left of the curve, in mm, seen along the curve: above a graph. A wider band
    /// makes fewer elements.
    above_mm: BandWidth,
    /// How the distance from the curve is measured. `normal`: the shortest distance. `vertical`: the distance
    /// along y, for graphs only.
    #[serde(default)]
    #[schema(default = "normal")]
    measure: Measure,
}

/// The width of one side of a band.
#[derive(Debug, Clone)]
pub enum BandWidth {
    Number(f64),
    Expression(String),
}

impl BandWidth {
    /// The number, or zero with the expression.
    fn parts(self) -> (f64, Option<String>) {
        match self {
            Self::Number(mm) => (mm, None),
            Self::Expression(text) => (0.0, Some(text)),
        }
    }
}

impl<'de> Deserialize<'de> for BandWidth {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Read;

        impl Visitor<'_> for Read {
            type Value = BandWidth;

            fn expecting(&self, f: &mut Formatter) -> fmt::Result {
                f.write_str("a number of mm, or an expression in x as a string")
            }

            fn visit_f64<E: de::Error>(self, mm: f64) -> Result<BandWidth, E> {
                Ok(BandWidth::Number(mm))
            }

            fn visit_u64<E: de::Error>(self, mm: u64) -> Result<BandWidth, E> {
                Ok(BandWidth::Number(mm as f64))
            }

            fn visit_i64<E: de::Error>(self, mm: i64) -> Result<BandWidth, E> {
                Ok(BandWidth::Number(mm as f64))
            }

            fn visit_str<E: de::Error>(self, text: &str) -> Result<BandWidth, E> {
                Ok(BandWidth::Expression(text.to_owned()))
            }
        }

        deserializer.deserialize_any(Read)
    }
}

/// What the contract says of a width.
const BAND_WIDTH: &str = "Width of one side of a band: a number of mm, or an expression in x for its width in mm. An \
    expression supports graphs only, and joints on the curve. Its x is that of the point of the curve from which the \
    deviation is measured. Where it is below 0 the side has no width; it may be up to 10.";

impl PartialSchema for BandWidth {
    fn schema() -> RefOr<Schema> {
        let text = ObjectBuilder::new()
            .schema_type(Type::String)
            .max_length(Some(LONGEST_TEXT))
            .examples([serde_json::json!("0.01 + 0.002*x")]);
        let one_of = OneOfBuilder::new().item(number(SIDES)).item(text);
        one_of.description(Some(BAND_WIDTH)).into()
    }
}

impl ToSchema for BandWidth {}

impl Band {
    fn convert(self, at: &Pointer, violations: &mut Violations) -> (deviation::Band, Widths) {
        let Self { below_mm, above_mm, measure } = self;
        let (below_mm, below) = below_mm.parts();
        let (above_mm, above) = above_mm.parts();
        violations.number(&at.field("below_mm"), below_mm, SIDES, "mm");
        violations.number(&at.field("above_mm"), above_mm, SIDES, "mm");
        let are_numbers = below.is_none() && above.is_none();
        if are_numbers && below_mm >= 0.0 && above_mm >= 0.0 && below_mm + above_mm < LEAST_WIDTH_MM {
            let detail = format!(
                "the band is {} mm wide; `below_mm` and `above_mm` together must be at least {LEAST_WIDTH_MM} mm",
                below_mm + above_mm
            );
            violations.add(at, FieldCode::OutOfRange, detail);
        }
        (deviation::Band { below_mm, above_mm, measure }, Widths { below, above })
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
        let (band, widths) = band.convert(&root.field("band"), &mut violations);
        let body = tool.as_ref().map(Tool::body).unwrap_or_default();
        let convert = match compensation {
            Compensation::None => Tool::convert,
            Compensation::Left | Compensation::Right => Tool::convert_mill,
        };
        let tool = tool.map(|tool| convert(&tool, &root.field("tool"), &mut violations));
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
        let sent = SentSetup { tool, body, cutting, program, meta };
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
            widths,
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
