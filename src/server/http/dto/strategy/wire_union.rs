//! The strategy `wire_union`.

use serde::Deserialize;
use utoipa::ToSchema;

use super::super::check::{Range, Violations};
use super::{Sections, check_count};
use crate::http::decode::tagged::Kind;
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;
use toolpathd_core::operations::surface_milling::{Boundary, CutDirection, SectionPlane, Spacing};

/// Roughing passes along wires: curves on the surface at constant y. All passes run in the same direction and
/// consist of lines; any cutter may be used. At each x the tip is at the greatest height of these wires: the
/// pass's own wire, all wires within the cutter's radius, and in any case the next wire on each side. Where
/// the surface slopes along the wires, the path **gouges the part**; a warning states the proved depth.
/// `boundary` must be `on`.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct WireUnion {
    #[serde(rename = "kind")]
    #[schema(ignore)]
    _kind: Kind,
    /// Largest distance of neighbouring wires, in mm. A larger pitch makes fewer passes.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    pitch_mm: f64,
}

impl WireUnion {
    /// As [`Strategy::convert`](super::Strategy::convert), for a surface with the given size along y, mm.
    pub fn convert(&self, at: &Pointer, extent: f64, most: usize, violations: &mut Violations) -> Sections {
        let at_pitch = at.field("pitch_mm");
        violations.number(&at_pitch, self.pitch_mm, Range::POSITIVE, "mm");
        check_count(&at_pitch, extent, self.pitch_mm, most, violations);
        Sections {
            plane: SectionPlane::Zx,
            spacing: Spacing::WirePitch(self.pitch_mm),
            direction: CutDirection::OneWay,
        }
    }
}

impl Sections {
    /// Refuses a member that a wire union cannot use: its cutter always moves straight down and straight up.
    pub fn check_absent(&self, at: &Pointer, is_given: bool, violations: &mut Violations) {
        if is_given && matches!(self.spacing, Spacing::WirePitch(_)) {
            violations.add(
                at,
                FieldCode::Conflict,
                "`wire_union` moves straight down and straight up: leave `entry` and `exit` out",
            );
        }
    }

    /// Refuses any boundary but `on` for a wire union, because its wires end on the edge of the surface.
    pub fn check_boundary(&self, at: &Pointer, boundary: Boundary, violations: &mut Violations) {
        let is_union = matches!(self.spacing, Spacing::WirePitch(_));
        if is_union && matches!(boundary, Boundary::Inside | Boundary::Past) {
            let detail = "the wires of `wire_union` end on the edge of the surface: send `boundary: on`";
            violations.add(at, FieldCode::Conflict, detail);
        }
    }
}
