//! Control nets of Bezier patches, as they are sent.

use serde::Deserialize;
use utoipa::ToSchema;
use utoipa::openapi::schema::{ArrayBuilder, Schema};
use utoipa::openapi::{Ref, RefOr};

use crate::config::Limits;
use crate::geometry::surface::net_grid as core;
use crate::http::dto::check::Violations;
use crate::http::dto::point::Point;
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;

/// Control points of one patch.
const POINTS: usize = 16;

#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum BezierPatchesKind {
    BezierPatches,
}

/// Bicubic Bezier patches side by side, which share their boundaries.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct BezierPatches {
    #[serde(rename = "kind")]
    #[schema(inline)]
    _kind: BezierPatchesKind,
    /// `patches[i][j][a][b]`: rows of 4 x 4 control nets, i and a along u. Every row is as long as the first; the number
    /// of control points is limited in all.
    #[schema(schema_with = schema)]
    patches: Vec<Vec<[[Point; 4]; 4]>>,
}

fn schema() -> Schema {
    let array = |items: RefOr<Schema>, least: usize, most: usize| -> RefOr<Schema> {
        ArrayBuilder::new().items(items).min_items(Some(least)).max_items(Some(most)).into()
    };
    let net = array(array(Ref::from_schema_name("Point").into(), 4, 4), 4, 4);
    let most = Limits::DEFAULT.surface_points / POINTS;
    match array(array(net, 1, most), 1, most) {
        RefOr::T(schema) => schema,
        RefOr::Ref(_) => Schema::default(),
    }
}

impl BezierPatches {
    pub fn points(&self) -> impl Iterator<Item = &Point> {
        self.patches.iter().flatten().flatten().flatten()
    }

    pub fn check(&self, at: &Pointer, limits: &Limits, violations: &mut Violations) {
        let Self { _kind: _, patches } = self;
        let at = at.field("patches");
        let total: usize = patches.iter().map(|row| POINTS * row.len().max(1)).sum();
        if total > limits.surface_points {
            let detail = format!("{total} control points; at most {} are allowed", limits.surface_points);
            violations.add(&at, FieldCode::LimitExceeded, detail);
            return;
        }
        let columns = patches.first().map_or(0, Vec::len);
        if columns == 0 {
            violations.add(&at, FieldCode::TooFewPoints, "no patch; at least one is needed");
        }
        for (i, row) in patches.iter().enumerate() {
            if row.len() != columns {
                let detail = format!("{} patches where row 0 has {columns}", row.len());
                violations.add(&at.index(i), FieldCode::RaggedGrid, detail);
            }
            for (j, net) in row.iter().enumerate() {
                for (a, points) in net.iter().enumerate() {
                    for (b, point) in points.iter().enumerate().filter(|(_, point)| !point.is_legal()) {
                        point.check_in(&at.index(i).index(j).index(a), b, violations);
                    }
                }
            }
        }
    }
}

/// Converts what has been checked.
impl From<BezierPatches> for core::NetGrid {
    fn from(BezierPatches { _kind: _, patches }: BezierPatches) -> Self {
        let net = |net: [[Point; 4]; 4]| net.map(|row| row.map(Into::into));
        Self { nets: patches.into_iter().map(|row| row.into_iter().map(net).collect()).collect() }
    }
}
