//! What earlier tools have emptied, in requests for pockets.

use serde::Deserialize;
use utoipa::ToSchema;

use crate::config::Limits;
use crate::http::dto::check::{Range, Violations};
use crate::http::dto::dialect::{self, DialectName};
use crate::http::dto::outline::{Islands, Outline, Region, Vertex};
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;
use toolpathd_core::geometry::curve::Curve;
use toolpathd_core::operations::pocketing as core;
use toolpathd_post::Dialect;
use toolpathd_post::read::{Reader, Step};

/// By how much the distances of an arc's ends from its centre may differ in a program, mm. Rounding to the
/// program's decimals makes a few thousandths.
const RADII_MM: f64 = 0.01;

/// What an earlier tool has emptied: either a region, which is empty down to the floor of the pocket, or what
/// an NC program has swept with a flat cutter.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = ClearedPlaces)]
pub struct Cleared {
    /// The outer outline of the region, in mm. Required without `nc`.
    #[schema(value_type = Option<Outline>)]
    boundary: Option<Vec<Vertex>>,
    /// Outlines of what was left inside `boundary`, in mm. Default: none.
    #[schema(value_type = Option<Islands>)]
    islands: Option<Vec<Vec<Vertex>>>,
    /// Text of a program that this service has written, in the coordinates of the pocket. A level counts as
    /// empty where the program's feed moves have swept at the height of the level's floor, or lower.
    #[schema(max_length = 16_777_216)]
    nc: Option<String>,
    /// Dialect of `nc`. Default: the default of `/v1/dialects`.
    #[schema(value_type = Option<DialectName>)]
    dialect: Option<String>,
    /// Diameter of the flat cutter that has run `nc`, in mm. Required with `nc`.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    tool_diameter_mm: Option<f64>,
}

impl Cleared {
    /// The places in the core's terms. Adds violations to `violations`.
    pub fn convert(
        self,
        at: &Pointer,
        limits: &Limits,
        violations: &mut Violations,
    ) -> Option<core::Emptied> {
        let Self { boundary, islands, nc, dialect, tool_diameter_mm } = self;
        if boundary.is_some() == nc.is_some() {
            let detail = "send either `boundary`, or `nc` with `tool_diameter_mm`";
            violations.add(at, FieldCode::Conflict, detail);
            return None;
        }
        let Some(nc) = nc else {
            let program = [("dialect", dialect.is_some()), ("tool_diameter_mm", tool_diameter_mm.is_some())];
            for (field, _) in program.into_iter().filter(|(_, is_sent)| *is_sent) {
                violations.add(
                    &at.field(field),
                    FieldCode::Conflict,
                    "this member belongs to `nc`; leave it out",
                );
            }
            let region = Region::new(boundary?, islands);
            return Some(core::Emptied::Region(region.convert(at, limits, violations)));
        };
        if islands.is_some() {
            violations.add(
                &at.field("islands"),
                FieldCode::Conflict,
                "this member belongs to `boundary`; leave it out",
            );
        }
        let diameter = at.field("tool_diameter_mm");
        let Some(diameter_mm) = tool_diameter_mm else {
            violations.add(&diameter, FieldCode::MissingField, "`nc` needs the diameter of its cutter");
            return None;
        };
        violations.number(&diameter, diameter_mm, Range::POSITIVE, "mm");
        let dialect = match dialect::find(dialect.as_deref()) {
            Ok(dialect) => dialect,
            Err(detail) => {
                violations.add(&at.field("dialect"), FieldCode::UnknownDialect, detail);
                return None;
            }
        };
        let along = feed_moves(&nc, dialect, &at.field("nc"), limits, violations)?;
        Some(core::Emptied::Path { along, radius_mm: 0.5 * diameter_mm })
    }
}

/// The feed moves of a program.
fn feed_moves(
    nc: &str,
    dialect: &'static Dialect,
    at: &Pointer,
    limits: &Limits,
    violations: &mut Violations,
) -> Option<Vec<Curve>> {
    let mut moves = Vec::new();
    let mut program = Reader::new(nc, dialect, RADII_MM);
    let mut first = None;
    while let Some(placed) = program.next() {
        match placed.map(|placed| placed.step) {
            Ok(Step::Feed { along, .. }) => {
                let state = program.state();
                let own = (state.tool, state.work_offset);
                if *first.get_or_insert(own) != own {
                    let detail = format!(
                        "line {}: another tool or work offset than the cuts before; send the part of each tool and offset as a program of its own",
                        program.line()
                    );
                    violations.add(at, FieldCode::Unsupported, detail);
                    return None;
                }
                moves.push(along);
            }
            Ok(_) => {}
            Err(error) => {
                violations.add(at, FieldCode::Syntax, error.to_string());
                return None;
            }
        }
        if moves.len() > limits.moves {
            let detail = format!("the program has more than {} feed moves", limits.moves);
            violations.add(at, FieldCode::LimitExceeded, detail);
            return None;
        }
    }
    Some(moves)
}
