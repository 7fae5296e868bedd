//! Milling strategies as they are sent.

pub mod wire_union;

use serde::{Deserialize, Deserializer};
use serde_json::value::RawValue;
use utoipa::ToSchema;

use super::check::{MAX_MAGNITUDE_MM, Range, Violations};
use super::tagged;
use super::tool::Tool;
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;
use crate::operations::surface_milling as core;
use wire_union::WireUnion;

/// How the surface is milled, told apart by `kind`.
#[derive(Debug, ToSchema)]
#[serde(untagged)]
pub enum Strategy {
    ClCartesian(ClCartesian),
    WireUnion(WireUnion),
}

impl<'de> Deserialize<'de> for Strategy {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let object = <&RawValue>::deserialize(deserializer)?;
        match tagged::kind_of::<D::Error>(object)?.as_str() {
            "cl_cartesian" => tagged::decode(object).map(Self::ClCartesian),
            "wire_union" => tagged::decode(object).map(Self::WireUnion),
            other => Err(tagged::unknown(other, &[], &["cl_cartesian", "wire_union"])),
        }
    }
}

#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ClCartesianKind {
    ClCartesian,
}

/// Passes along parallel planes, equally spaced: exactly one of `stepover_mm` and `scallop_height_mm` says how far apart.
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
    stepover_mm: Option<f64>,
    /// Largest height left between passes, along the normal of the surface.
    #[schema(minimum = 0.000_001, maximum = 1000)]
    scallop_height_mm: Option<f64>,
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
    pub spacing: core::Spacing,
    pub direction: core::CutDirection,
}

/// Heights that may be left between passes, mm.
const SCALLOP_HEIGHT: Range = Range { min: 1e-6, max: 1000.0 };

impl Strategy {
    /// The strategy at `at` for a surface of the given extents along x and y, or nothing with the reasons in `violations`.
    pub fn convert(
        self,
        at: &Pointer,
        extent: [f64; 2],
        max_sections: usize,
        violations: &mut Violations,
    ) -> Option<Sections> {
        let ClCartesian { _kind: _, plane, stepover_mm, scallop_height_mm, direction, trim } = match self {
            Self::ClCartesian(cl_cartesian) => cl_cartesian,
            Self::WireUnion(union) => return Some(union.convert(at, extent[1], max_sections, violations)),
        };
        if !trim {
            let detail = "`trim: false` is refused: an untrimmed path may cut into the part";
            violations.add(&at.field("trim"), FieldCode::Unsupported, detail);
        }
        let across = match plane {
            Plane::Zx => extent[1],
            Plane::Yz => extent[0],
        };
        let at_stepover = at.field("stepover_mm");
        let spacing = match (stepover_mm, scallop_height_mm) {
            (Some(stepover), None) => {
                violations.number(&at_stepover, stepover, Range::POSITIVE, "mm");
                check_count(&at_stepover, across, stepover, max_sections, violations);
                core::Spacing::Stepover(stepover)
            }
            (None, Some(height)) => {
                violations.number(&at.field("scallop_height_mm"), height, SCALLOP_HEIGHT, "mm");
                core::Spacing::ScallopHeight(height)
            }
            (None, None) => {
                let detail = "`stepover_mm` or `scallop_height_mm` is required";
                violations.add(&at_stepover, FieldCode::MissingField, detail);
                return None;
            }
            (Some(_), Some(_)) => {
                let detail = "`stepover_mm` and `scallop_height_mm` exclude each other";
                violations.add(&at.field("scallop_height_mm"), FieldCode::Conflict, detail);
                return None;
            }
        };
        Some(Sections {
            plane: match plane {
                Plane::Zx => core::SectionPlane::Zx,
                Plane::Yz => core::SectionPlane::Yz,
            },
            spacing,
            direction: match direction {
                Direction::OneWay => core::CutDirection::OneWay,
                Direction::Zigzag => core::CutDirection::Zigzag,
            },
        })
    }
}

impl Sections {
    /// Refuses a height of scallops where the cutter leaves none.
    pub fn check_scallops(&self, at: &Pointer, tool: &Tool, violations: &mut Violations) {
        if matches!(self.spacing, core::Spacing::ScallopHeight(_)) && tool.is_flat() {
            let detail = "a flat end leaves steps, not scallops: give `stepover_mm`";
            violations.add(&at.field("scallop_height_mm"), FieldCode::Conflict, detail);
        }
    }
}

/// Looks at the number of sections before they are made; points beyond the legal magnitude are to blame themselves.
fn check_count(at: &Pointer, across: f64, stepover: f64, most: usize, violations: &mut Violations) {
    let sections = (across / stepover.max(f64::MIN_POSITIVE)).ceil() + 1.0;
    let is_legal = stepover >= Range::POSITIVE.min && across <= 2.0 * MAX_MAGNITUDE_MM;
    if is_legal && sections > most as f64 {
        let detail =
            format!("{stepover} mm over {across} mm makes {sections} sections; at most {most} are allowed");
        violations.add(at, FieldCode::LimitExceeded, detail);
    }
}
