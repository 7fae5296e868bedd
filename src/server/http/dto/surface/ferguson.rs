//! The surface kind `ferguson` in requests: points with tangents and twists.

use serde::Deserialize;
use utoipa::ToSchema;

use super::grid::{self, PointRows};
use crate::config::Limits;
use crate::http::decode::tagged::Kind;
use crate::http::dto::check::Violations;
use crate::http::dto::point::Point;
use crate::http::pointer::Pointer;
use toolpathd_core::geometry::surface::ferguson as core;

/// Points with given tangents: Ferguson's composite surface. `tangents_u`, `tangents_v` and `twists` have the
/// same numbers of rows and columns as `points`.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Ferguson {
    #[serde(rename = "kind")]
    #[schema(ignore)]
    _kind: Kind,
    /// Points in mm through which the surface passes: `points[i][j]`, i along u and j along v. At least 2
    /// rows of at least 2 points.
    #[schema(value_type = PointRows)]
    points: Vec<Vec<Point>>,
    /// Tangent vectors along u at the points, in mm: the derivative by a parameter that grows by 1 from point
    /// to point. With a longer vector the surface keeps the direction of the vector for longer.
    #[schema(value_type = PointRows)]
    tangents_u: Vec<Vec<Point>>,
    /// Tangent vectors along v at the points, in mm: the derivative by a parameter that grows by 1 from point
    /// to point.
    #[schema(value_type = PointRows)]
    tangents_v: Vec<Vec<Point>>,
    /// Twist vectors at the points, in mm: the mixed derivatives along u and v. Default: zero everywhere.
    #[schema(value_type = Option<PointRows>)]
    twists: Option<Vec<Vec<Point>>>,
}

impl Ferguson {
    pub fn points(&self) -> impl Iterator<Item = &Point> {
        self.points.iter().flatten()
    }

    pub fn check(&self, at: &Pointer, limits: &Limits, violations: &mut Violations) {
        let Self { _kind: _, points, tangents_u, tangents_v, twists } = self;
        let Some(size) = grid::check_points(&at.field("points"), points, limits, violations) else { return };
        let vectors = [("tangents_u", tangents_u), ("tangents_v", tangents_v)];
        for (name, vectors) in vectors.into_iter().chain(twists.as_ref().map(|twists| ("twists", twists))) {
            grid::check_like(&at.field(name), vectors, size, violations, grid::check_row);
        }
    }
}

/// Converts a surface that has been checked.
impl From<Ferguson> for core::Ferguson {
    fn from(Ferguson { _kind: _, points, tangents_u, tangents_v, twists }: Ferguson) -> Self {
        Self {
            points: grid::converted(points),
            tangents_u: grid::converted(tangents_u),
            tangents_v: grid::converted(tangents_v),
            twists: twists.map(grid::converted),
        }
    }
}
