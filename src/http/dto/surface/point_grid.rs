//! Measured points, as they are sent.

use nalgebra::Vector3;
use serde::Deserialize;
use utoipa::ToSchema;
use utoipa::openapi::schema::Schema;

use super::{grid, grid_order};
use crate::config::Limits;
use crate::geometry::surface::point_grid as core;
use crate::http::dto::check::Violations;
use crate::http::dto::object;
use crate::http::dto::point::{Point, row_schema};
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;

#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum PointGridKind {
    PointGrid,
}

/// Measured points, joined by a smooth surface with uniform parameters.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PointGrid {
    #[serde(rename = "kind")]
    #[schema(inline)]
    _kind: PointGridKind,
    /// `points[i][j]`, i along u: at least 2 rows of at least 2 points, every row as long as the first. The number of
    /// points is limited in all.
    #[schema(schema_with = grid::schema)]
    points: Vec<Vec<Point>>,
    /// How the mixed derivatives at the points are chosen: those of the cubic spline, or zero.
    #[serde(default)]
    #[schema(default = "spline")]
    twist: Twist,
    /// The end conditions of the splines; `clamped` takes the tangents of `end_tangents`. `natural` has no curvature at the
    /// edges, which bends the rim of a part that was measured. Default: `not_a_knot`.
    ends: Option<Ends>,
    /// What happens where a point lies far away from all of its neighbours, five times as far as they lie from each other: mostly it is a
    /// mistake, and takes long to mill.
    #[serde(default)]
    #[schema(default = "refuse")]
    outliers: Outliers,
    #[serde(default, deserialize_with = "object::optional")]
    end_tangents: Option<EndTangents>,
}

#[derive(Debug, Clone, Copy, Default, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Twist {
    #[default]
    Spline,
    Zero,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Ends {
    Natural,
    NotAKnot,
    Clamped,
    Bessel,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Outliers {
    #[default]
    Refuse,
    Accept,
}

/// Tangents along the boundaries, one vector for each boundary point: derivatives by the parameter that grows by one
/// from point to point.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct EndTangents {
    /// Along `points[0]`.
    #[schema(schema_with = tangents_schema)]
    u0: Vec<Point>,
    /// Along the last row of `points`.
    #[schema(schema_with = tangents_schema)]
    u1: Vec<Point>,
    /// Along the first points of the rows.
    #[schema(schema_with = tangents_schema)]
    v0: Vec<Point>,
    /// Along the last points of the rows.
    #[schema(schema_with = tangents_schema)]
    v1: Vec<Point>,
}

fn tangents_schema() -> Schema {
    row_schema(Limits::DEFAULT.surface_points / 2).into()
}

impl PointGrid {
    pub fn points(&self) -> impl Iterator<Item = &Point> {
        self.points.iter().flatten()
    }

    pub fn check(&self, at: &Pointer, limits: &Limits, violations: &mut Violations) {
        let Self { _kind: _, points, twist: _, ends, outliers, end_tangents } = self;
        let Some(size) = grid::check_points(&at.field("points"), points, limits, violations) else { return };
        grid_order::check(&at.field("points"), points, *outliers == Outliers::Refuse, violations);
        let at_tangents = at.field("end_tangents");
        match (ends, end_tangents) {
            (Some(Ends::Clamped), Some(tangents)) => tangents.check(&at_tangents, size.into(), violations),
            (Some(Ends::Clamped), None) => {
                let detail = "`end_tangents` is required with `ends: clamped`";
                violations.add(&at_tangents, FieldCode::MissingField, detail);
            }
            (_, Some(_)) => {
                let detail = "`end_tangents` has a meaning with `ends: clamped` only";
                violations.add(&at_tangents, FieldCode::UnknownField, detail);
            }
            (_, None) => {}
        }
    }
}

impl EndTangents {
    fn check(&self, at: &Pointer, (rows, columns): (usize, usize), violations: &mut Violations) {
        let Self { u0, u1, v0, v1 } = self;
        for (name, side, expected) in
            [("u0", u0, columns), ("u1", u1, columns), ("v0", v0, rows), ("v1", v1, rows)]
        {
            let at = at.field(name);
            if side.len() != expected {
                let detail = format!("{} vectors; there are {expected} boundary points", side.len());
                violations.add(&at, FieldCode::WrongLength, detail);
            }
            for (k, vector) in side.iter().enumerate() {
                vector.check_in(&at, k, violations);
            }
        }
    }
}

/// Converts what has been checked.
impl From<PointGrid> for core::PointGrid {
    fn from(PointGrid { _kind: _, points, twist, ends, outliers: _, end_tangents }: PointGrid) -> Self {
        Self {
            points: grid::converted(points),
            twist: match twist {
                Twist::Spline => core::Twist::Spline,
                Twist::Zero => core::Twist::Zero,
            },
            ends: match (ends, end_tangents) {
                (Some(Ends::Clamped), Some(tangents)) => core::Ends::Clamped(tangents.into()),
                (None | Some(Ends::Clamped), _) => core::Ends::Usual,
                (Some(Ends::Natural), _) => core::Ends::Natural,
                (Some(Ends::NotAKnot), _) => core::Ends::NotAKnot,
                (Some(Ends::Bessel), _) => core::Ends::Bessel,
            },
        }
    }
}

impl From<EndTangents> for core::EndTangents {
    fn from(EndTangents { u0, u1, v0, v1 }: EndTangents) -> Self {
        let vectors = |side: Vec<Point>| side.into_iter().map(Vector3::from).collect();
        Self { u0: vectors(u0), u1: vectors(u1), v0: vectors(v0), v1: vectors(v1) }
    }
}
