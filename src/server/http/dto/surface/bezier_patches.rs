//! The surface kind `bezier_patches` in requests: control nets of Bezier patches.

use serde::Deserialize;
use utoipa::ToSchema;

use crate::config::Limits;
use crate::http::decode::tagged::Kind;
use crate::http::dto::check::Violations;
use crate::http::dto::point::Point;
use crate::http::dto::schema::{array_of, reference, schema_of};
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;
use toolpathd_core::geometry::surface::net_grid as core;

/// Number of control points of one patch.
const POINTS: usize = 16;

/// Bicubic Bezier patches side by side. Neighbouring patches share the control points of their common
/// boundary.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct BezierPatches {
    #[serde(rename = "kind")]
    #[schema(ignore)]
    _kind: Kind,
    /// Control points in mm: `patches[i][j][a][b]` is point a, b of the 4 x 4 control net of patch i, j.
    /// Indices i and a run along u, indices j and b along v. Every row has as many patches as the first row.
    #[schema(value_type = BezierNets)]
    patches: Vec<Vec<[[Point; 4]; 4]>>,
}

schema_of!(BezierNets of Point, "Rows of 4 x 4 control nets, in mm.", {
    let net = array_of(array_of(reference::<Point>(), 4, 4), 4, 4);
    let most = Limits::DEFAULT.surface_points / POINTS;
    array_of(array_of(net, 1, most), 1, most)
});

impl BezierPatches {
    pub fn points(&self) -> impl Iterator<Item = &Point> {
        self.patches.iter().flatten().flatten().flatten()
    }

    pub fn check(&self, at: &Pointer, limits: &Limits, violations: &mut Violations) {
        let Self { _kind: _, patches } = self;
        let at = at.field("patches");
        let total: usize = patches.iter().map(|row| POINTS * row.len().max(1)).sum();
        if total > limits.surface_points {
            let detail =
                format!("the surface has {total} control points; send at most {}", limits.surface_points);
            violations.add(&at, FieldCode::LimitExceeded, detail);
            return;
        }
        let columns = patches.first().map_or(0, Vec::len);
        if columns == 0 {
            violations.add(&at, FieldCode::TooFewPoints, "there is no patch; send at least one");
        }
        for (i, row) in patches.iter().enumerate() {
            if row.len() != columns {
                let detail = format!(
                    "the row has {} patches and row 0 has {columns}; make all rows equally long",
                    row.len()
                );
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

/// Converts a surface that has been checked.
impl From<BezierPatches> for core::NetGrid {
    fn from(BezierPatches { _kind: _, patches }: BezierPatches) -> Self {
        let net = |net: [[Point; 4]; 4]| net.map(|row| row.map(Into::into));
        Self { nets: patches.into_iter().map(|row| row.into_iter().map(net).collect()).collect() }
    }
}
