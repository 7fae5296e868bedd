//! The strategy `wire_union`.

use serde::Deserialize;
use utoipa::ToSchema;

use super::super::check::{Range, Violations};
use super::super::milling::Boundary;
use super::{Sections, check_count};
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;
use crate::operations::surface_milling as core;

#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum WireUnionKind {
    WireUnion,
}

/// For roughing: the tip passes, one way, over wires of the surface at constant y, at the largest height of each and of the wires within
/// the cutter's radius beside it. The path **cuts into the surface** where that slopes along the wires; how deep is proved, and
/// said in a warning. Lines, any cutter, `boundary: on`.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct WireUnion {
    #[serde(rename = "kind")]
    #[schema(inline)]
    _kind: WireUnionKind,
    /// Largest distance of neighbouring wires.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    pitch_mm: f64,
}

impl WireUnion {
    /// As [`Strategy::convert`](super::Strategy::convert), for a surface of the given extent along y.
    pub fn convert(&self, at: &Pointer, extent: f64, most: usize, violations: &mut Violations) -> Sections {
        let at_pitch = at.field("pitch_mm");
        violations.number(&at_pitch, self.pitch_mm, Range::POSITIVE, "mm");
        check_count(&at_pitch, extent, self.pitch_mm, most, violations);
        Sections {
            plane: core::SectionPlane::Zx,
            spacing: core::Spacing::WirePitch(self.pitch_mm),
            direction: core::CutDirection::OneWay,
        }
    }
}

impl Sections {
    /// Refuses what says nothing to a wire union, whose cutter goes straight up and down.
    pub fn check_absent(&self, at: &Pointer, is_given: bool, violations: &mut Violations) {
        if is_given && matches!(self.spacing, core::Spacing::WirePitch(_)) {
            violations.add(
                at,
                FieldCode::Conflict,
                "the cutter comes to the wires of `wire_union` straight down",
            );
        }
    }

    /// Refuses another boundary than that of a wire union, whose wires end on the edge.
    pub fn check_boundary(&self, at: &Pointer, boundary: Boundary, violations: &mut Violations) {
        let is_union = matches!(self.spacing, core::Spacing::WirePitch(_));
        if is_union && matches!(boundary, Boundary::Inside | Boundary::Past) {
            let detail = "the wires of `wire_union` end on the edge of the surface";
            violations.add(at, FieldCode::Conflict, detail);
        }
    }
}
