//! Points with tangents and twists, as they are sent.

use serde::Deserialize;
use utoipa::ToSchema;

use super::grid;
use crate::config::Limits;
use crate::geometry::surface::ferguson as core;
use crate::http::dto::check::Violations;
use crate::http::dto::point::Point;
use crate::http::pointer::Pointer;

#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum FergusonKind {
    Ferguson,
}

/// Points with given tangents at each: Ferguson's composite surface. All grids are of the size of `points`.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Ferguson {
    #[serde(rename = "kind")]
    #[schema(inline)]
    _kind: FergusonKind,
    /// `points[i][j]`, i along u: at least 2 rows of at least 2 points.
    #[schema(schema_with = grid::schema)]
    points: Vec<Vec<Point>>,
    /// Derivatives by the parameter along u that grows by one from point to point.
    #[schema(schema_with = grid::schema)]
    tangents_u: Vec<Vec<Point>>,
    /// Derivatives by the parameter along v.
    #[schema(schema_with = grid::schema)]
    tangents_v: Vec<Vec<Point>>,
    /// Mixed derivatives. Default: zero.
    #[schema(schema_with = grid::optional_schema)]
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

/// Converts what has been checked.
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
