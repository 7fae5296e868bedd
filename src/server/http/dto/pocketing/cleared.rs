//! What earlier tools have emptied, in requests for pockets.

mod programs;

use serde::Deserialize;
use utoipa::ToSchema;

use crate::config::Limits;
use crate::http::decode::object;
use crate::http::dto::check::Violations;
use crate::http::dto::dialect::DialectName;
use crate::http::dto::outline::{self, Islands, Outline, WalledRegion};
use crate::http::dto::program_reading::{Compensation, WithoutPoint};
use crate::http::dto::schema::{array_of, reference, schema_of};
use crate::http::error::FieldCode;
use crate::http::messages::Warning;
use crate::http::pointer::Pointer;
use programs::{MOST_TOOLS, Program};
use toolpathd_core::operations::pocketing as core;
use toolpathd_core::toolpath::program::Units;

/// What earlier tools have emptied: either a region, which is empty down to the floor of the pocket, or what
/// the flat cutters of an NC program have swept.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = ClearedPlaces)]
pub struct Cleared {
    /// The outer outline of the region, in mm. Required without `nc`.
    boundary: Option<Outline>,
    /// Outlines of what was left inside `boundary`, in mm. Default: none.
    #[schema(value_type = Option<Islands>)]
    islands: Option<Vec<Outline>>,
    /// Text of a program of any origin, in the coordinates of the pocket. A level counts as empty where feed
    /// moves of the program have swept at the height of the level's floor, or lower.
    #[schema(max_length = 16_777_216)]
    nc: Option<String>,
    /// Dialect of `nc`. Default: the default of `/v1/dialects`.
    #[schema(value_type = Option<DialectName>)]
    dialect: Option<String>,
    /// Unit of lengths of `nc` before the first G20 or G21. Default: `mm`.
    units: Option<Units>,
    /// What a length of `nc` without a decimal point means. Default: `increments` for `fanuc`, `haas` and
    /// `mazak`, `units` for the others.
    without_point: Option<WithoutPoint>,
    /// What G41 and G42 of `nc` mean. `compute` takes the radii of the tools. Default: `refuse`.
    compensation: Option<Compensation>,
    /// Diameter of the flat cutter that has run `nc`, in mm. With `nc` either this or `tools` is required.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    tool_diameter_mm: Option<f64>,
    /// The flat cutters of an `nc` that changes tools. What other tools of the program have cut does not
    /// count as empty.
    #[serde(default, deserialize_with = "object::optional_list")]
    #[schema(value_type = Option<ClearingTools>)]
    tools: Option<Vec<ClearingTool>>,
}

schema_of!(ClearingTools of ClearingTool, "Flat cutters, each with another number or name.", {
    array_of(reference::<ClearingTool>(), 1, MOST_TOOLS)
});

/// A flat cutter of a program that has emptied places.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ClearingTool {
    /// Number by which the program calls the tool. Either `number` or `name` is required.
    #[schema(minimum = 1, maximum = 99_999)]
    number: Option<u32>,
    /// Name by which the program calls the tool, in letters of any case.
    #[schema(max_length = 100)]
    name: Option<String>,
    /// Diameter of the cutter, in mm.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    diameter_mm: f64,
}

impl Cleared {
    /// The warning of bulges of more than a half circle.
    pub fn remark(&self, at: &Pointer) -> Option<Warning> {
        outline::remark(at, self.boundary.as_ref()?, self.islands.as_deref().unwrap_or_default())
    }

    /// The places in the core's terms, one for each tool. Adds violations to `violations`.
    pub fn convert(self, at: &Pointer, limits: &Limits, violations: &mut Violations) -> Vec<core::Emptied> {
        let Self {
            boundary,
            islands,
            nc,
            dialect,
            units,
            without_point,
            compensation,
            tool_diameter_mm,
            tools,
        } = self;
        let of_program = [
            ("dialect", dialect.is_some()),
            ("units", units.is_some()),
            ("without_point", without_point.is_some()),
            ("compensation", compensation.is_some()),
            ("tool_diameter_mm", tool_diameter_mm.is_some()),
            ("tools", tools.is_some()),
        ];
        match (boundary, nc) {
            (Some(boundary), None) => {
                refuse(&of_program, "this member belongs to `nc`; leave it out", at, violations);
                let region = WalledRegion::new(boundary, islands);
                vec![core::Emptied::Region(region.convert(at, limits, violations))]
            }
            (None, Some(nc)) => {
                let of_region = [("islands", islands.is_some())];
                refuse(&of_region, "this member belongs to `boundary`; leave it out", at, violations);
                let program = Program { nc, dialect, units, without_point, compensation };
                match programs::cutters(tool_diameter_mm, tools, at, violations) {
                    Some(cutters) => program.convert(&cutters, at, limits, violations),
                    None => Vec::new(),
                }
            }
            _ => {
                let detail = "send either `boundary`, or `nc` with `tool_diameter_mm` or `tools`";
                violations.add(at, FieldCode::Conflict, detail);
                Vec::new()
            }
        }
    }
}

/// Refuses the members that were sent.
fn refuse(members: &[(&str, bool)], detail: &str, at: &Pointer, violations: &mut Violations) {
    for (name, _) in members.iter().filter(|(_, is_sent)| *is_sent) {
        violations.add(&at.field(name), FieldCode::Conflict, detail);
    }
}
