//! Milling strategies in requests.

pub mod wire_union;

use serde::Deserialize;
use utoipa::ToSchema;

use super::check::{MAX_MAGNITUDE_MM, Range, Violations};
use super::tool::Tool;
use crate::http::decode::tagged::{Kind, by_kind};
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;
use toolpathd_core::operations::surface_milling::{CutDirection, SectionPlane, Spacing};
use wire_union::WireUnion;

by_kind! {
    /// How the surface is milled; `kind` says which strategy.
    #[derive(Debug)]
    Strategy { "cl_cartesian" => ClCartesian(ClCartesian), "wire_union" => WireUnion(WireUnion) }
}

/// Finishing passes in parallel vertical planes, equally spaced. Give either `stepover_mm` or
/// `scallop_height_mm`, not both.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ClCartesian {
    #[serde(rename = "kind")]
    #[schema(ignore)]
    _kind: Kind,
    /// The planes of the passes. `zx`: planes of constant y. `yz`: planes of constant x.
    #[serde(default)]
    #[schema(default = "zx")]
    plane: SectionPlane,
    /// Largest distance of neighbouring planes, in mm. A larger stepover makes fewer passes and higher
    /// scallops.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    stepover_mm: Option<f64>,
    /// Largest height of the material left between passes, in mm along the normal of the surface. A larger
    /// height makes fewer passes.
    #[schema(minimum = 0.000_001, maximum = 1000)]
    scallop_height_mm: Option<f64>,
    /// The directions of the passes. `zigzag`: neighbouring passes run in opposite directions. `one_way`: all
    /// passes run in the same direction.
    #[serde(default)]
    #[schema(default = "zigzag")]
    direction: CutDirection,
    /// Whether the path is kept out of the part. Only `true` is supported.
    #[serde(default = "yes")]
    #[schema(default = true)]
    trim: bool,
}

fn yes() -> bool {
    true
}

/// A strategy in the core's terms.
pub struct Sections {
    pub plane: SectionPlane,
    pub spacing: Spacing,
    pub direction: CutDirection,
}

/// Legal scallop heights, mm.
const SCALLOP_HEIGHT: Range = Range { min: 1e-6, max: 1000.0 };

impl Strategy {
    /// The strategy at `at` for a surface with the given sizes along x and y, mm. `None` where the spacing is
    /// missing or given twice. Adds all violations to `violations`.
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
            let detail =
                "`trim: false` is not supported, because the path may cut into the part: leave `trim` out";
            violations.add(&at.field("trim"), FieldCode::Unsupported, detail);
        }
        let across = match plane {
            SectionPlane::Zx => extent[1],
            SectionPlane::Yz => extent[0],
        };
        let at_stepover = at.field("stepover_mm");
        let spacing = match (stepover_mm, scallop_height_mm) {
            (Some(stepover), None) => {
                violations.number(&at_stepover, stepover, Range::POSITIVE, "mm");
                check_count(&at_stepover, across, stepover, max_sections, violations);
                Spacing::Stepover(stepover)
            }
            (None, Some(height)) => {
                violations.number(&at.field("scallop_height_mm"), height, SCALLOP_HEIGHT, "mm");
                Spacing::ScallopHeight(height)
            }
            (None, None) => {
                let detail = "send `stepover_mm` or `scallop_height_mm`";
                violations.add(&at_stepover, FieldCode::MissingField, detail);
                return None;
            }
            (Some(_), Some(_)) => {
                let detail = "`stepover_mm` and `scallop_height_mm` exclude each other: send one of the two";
                violations.add(&at.field("scallop_height_mm"), FieldCode::Conflict, detail);
                return None;
            }
        };
        Some(Sections { plane, spacing, direction })
    }
}

impl Sections {
    /// Refuses a scallop height for a flat cutter, which leaves steps and no scallops.
    pub fn check_scallops(&self, at: &Pointer, tool: &Tool, violations: &mut Violations) {
        if matches!(self.spacing, Spacing::ScallopHeight(_)) && tool.is_flat() {
            let detail = "a flat end leaves steps, not scallops: send `stepover_mm` instead";
            violations.add(&at.field("scallop_height_mm"), FieldCode::Conflict, detail);
        }
    }
}

/// Checks the number of sections before they are made. An illegal stepover, or a size that only points beyond
/// the legal magnitude can have, is reported elsewhere.
fn check_count(at: &Pointer, across: f64, stepover: f64, most: usize, violations: &mut Violations) {
    let sections = (across / stepover.max(f64::MIN_POSITIVE)).ceil() + 1.0;
    let is_legal = stepover >= Range::POSITIVE.min && across <= 2.0 * MAX_MAGNITUDE_MM;
    if is_legal && sections > most as f64 {
        let detail = format!(
            "planes {stepover} mm apart on a surface {across} mm wide make {sections} passes; at most {most} are allowed: send a larger distance"
        );
        violations.add(at, FieldCode::LimitExceeded, detail);
    }
}
