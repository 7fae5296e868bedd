//! Milling strategies as they are sent.

use serde::{Deserialize, Deserializer};
use serde_json::value::RawValue;
use utoipa::ToSchema;

use super::check::{MAX_MAGNITUDE_MM, Range, Violations};
use super::tagged;
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;
use crate::operations::surface_milling as core;

/// How the surface is milled, told apart by `kind`.
#[derive(Debug, ToSchema)]
#[serde(untagged)]
pub enum Strategy {
    ClCartesian(ClCartesian),
}

/// Strategies of the contract that this version does not have.
const LATER: [&str; 1] = ["wire_union"];

impl<'de> Deserialize<'de> for Strategy {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let object = <&RawValue>::deserialize(deserializer)?;
        match tagged::kind_of::<D::Error>(object)?.as_str() {
            "cl_cartesian" => tagged::decode(object).map(Self::ClCartesian),
            other => Err(tagged::unknown(other, &LATER, &["cl_cartesian"])),
        }
    }
}

#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ClCartesianKind {
    ClCartesian,
}

/// Passes along parallel planes, equally spaced, at most `stepover_mm` apart.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ClCartesian {
    #[serde(rename = "kind")]
    #[schema(inline)]
    _kind: ClCartesianKind,
    /// `zx`: planes of constant y; `yz`: planes of constant x.
    #[serde(default)]
    #[schema(default = "zx")]
    plane: Plane,
    /// Largest distance of neighbouring planes.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    stepover_mm: f64,
    #[serde(default)]
    #[schema(default = "zigzag")]
    direction: Direction,
    /// Whether a path that would cut into the part is refused. Always so; `false` is refused itself.
    #[serde(default = "yes")]
    #[schema(default = true)]
    trim: bool,
}

#[derive(Debug, Clone, Copy, Default, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = SectionPlane)]
pub enum Plane {
    #[default]
    Zx,
    Yz,
}

#[derive(Debug, Clone, Copy, Default, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = CutDirection)]
pub enum Direction {
    OneWay,
    #[default]
    Zigzag,
}

fn yes() -> bool {
    true
}

/// A strategy in the core's terms.
pub struct Sections {
    pub plane: core::SectionPlane,
    pub stepover_mm: f64,
    pub direction: core::CutDirection,
}

impl Strategy {
    /// Collects what is wrong with the strategy at `at`, for a surface of the given extents along x and y.
    pub fn check(&self, at: &Pointer, extent: [f64; 2], max_sections: usize, violations: &mut Violations) {
        let Strategy::ClCartesian(ClCartesian { _kind: _, plane, stepover_mm, direction: _, trim }) = self;
        let at_stepover = at.field("stepover_mm");
        violations.number(&at_stepover, *stepover_mm, Range::POSITIVE, "mm");
        let across = match plane {
            Plane::Zx => extent[1],
            Plane::Yz => extent[0],
        };
        let sections = (across / stepover_mm.max(f64::MIN_POSITIVE)).ceil() + 1.0;
        // Points beyond the legal magnitude are to blame themselves.
        let is_legal = *stepover_mm >= Range::POSITIVE.min && across <= 2.0 * MAX_MAGNITUDE_MM;
        if is_legal && sections > max_sections as f64 {
            let detail = format!(
                "{stepover_mm} mm over {across} mm makes {sections} sections; at most {max_sections} are allowed"
            );
            violations.add(&at_stepover, FieldCode::LimitExceeded, detail);
        }
        if !trim {
            let detail = "`trim: false` is refused: an untrimmed path may cut into the part";
            violations.add(&at.field("trim"), FieldCode::Unsupported, detail);
        }
    }
}

/// Converts what has been checked.
impl From<Strategy> for Sections {
    fn from(strategy: Strategy) -> Self {
        let Strategy::ClCartesian(ClCartesian { _kind: _, plane, stepover_mm, direction, trim: _ }) =
            strategy;
        Self {
            plane: match plane {
                Plane::Zx => core::SectionPlane::Zx,
                Plane::Yz => core::SectionPlane::Yz,
            },
            stepover_mm,
            direction: match direction {
                Direction::OneWay => core::CutDirection::OneWay,
                Direction::Zigzag => core::CutDirection::Zigzag,
            },
        }
    }
}
