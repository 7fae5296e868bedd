//! Surfaces as they are sent.

use nalgebra::{Point3, Vector3};
use serde::{Deserialize, Deserializer};
use serde_json::value::RawValue;
use utoipa::ToSchema;
use utoipa::openapi::schema::{ArrayBuilder, Schema};

use super::check::Violations;
use super::object;
use super::point::{Point, row_schema};
use super::tagged;
use crate::config::Limits;
use crate::geometry::surface::point_grid as core;
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;

/// A surface, told apart by `kind`.
#[derive(Debug, ToSchema)]
#[serde(untagged)]
pub enum Surface {
    PointGrid(PointGrid),
}

/// Surfaces of the contract that this version cannot read.
const LATER: [&str; 6] = ["ferguson", "parallel_sweep", "normal_sweep", "ruled", "bezier_patches", "nurbs"];

impl<'de> Deserialize<'de> for Surface {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let object = <&RawValue>::deserialize(deserializer)?;
        match tagged::kind_of::<D::Error>(object)?.as_str() {
            "point_grid" => tagged::decode(object).map(Self::PointGrid),
            other => Err(tagged::unknown(other, &LATER, &["point_grid"])),
        }
    }
}

#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum PointGridKind {
    PointGrid,
}

/// Measured points, joined by a smooth surface with uniform parameters. The cutter is on its +z side.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PointGrid {
    #[serde(rename = "kind")]
    #[schema(inline)]
    _kind: PointGridKind,
    /// `points[i][j]`, i along u: at least 2 rows of at least 2 points, every row as long as the first. The number of
    /// points is limited in all.
    #[schema(schema_with = points_schema)]
    points: Vec<Vec<Point>>,
    /// How the mixed derivatives at the points are chosen: those of the cubic spline, or zero.
    #[serde(default)]
    #[schema(default = "spline")]
    twist: Twist,
    /// The end conditions of the splines; `clamped` takes the tangents of `end_tangents`.
    #[serde(default)]
    #[schema(default = "natural")]
    ends: Ends,
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

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Ends {
    #[default]
    Natural,
    NotAKnot,
    Clamped,
    Bessel,
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

fn points_schema() -> Schema {
    let most = Limits::DEFAULT.surface_points / 2;
    ArrayBuilder::new().items(row_schema(most)).min_items(Some(2)).max_items(Some(most)).into()
}

fn tangents_schema() -> Schema {
    row_schema(Limits::DEFAULT.surface_points / 2).into()
}

impl Surface {
    /// Collects what is wrong with the surface at `at`.
    pub fn check(&self, at: &Pointer, limits: &Limits, violations: &mut Violations) {
        let Surface::PointGrid(grid) = self;
        grid.check(at, limits, violations);
    }

    /// The corners of the box around the points.
    pub fn bounds(&self) -> (Point3<f64>, Point3<f64>) {
        let Surface::PointGrid(grid) = self;
        let empty = (Point3::from([f64::INFINITY; 3]), Point3::from([f64::NEG_INFINITY; 3]));
        grid.points.iter().flatten().fold(empty, |(low, high), &point| {
            let point: Point3<f64> = point.into();
            (low.inf(&point), high.sup(&point))
        })
    }
}

impl PointGrid {
    fn check(&self, at: &Pointer, limits: &Limits, violations: &mut Violations) {
        let Self { _kind: _, points, twist: _, ends, end_tangents } = self;
        let at_points = at.field("points");
        // Empty rows count too, lest they make violations without end.
        let total: usize = points.iter().map(|row| row.len().max(1)).sum();
        if total > limits.surface_points {
            let detail = format!("{total} surface points; at most {} are allowed", limits.surface_points);
            violations.add(&at_points, FieldCode::LimitExceeded, detail);
            return;
        }
        if points.len() < 2 {
            let detail = format!("{} rows; at least 2 are needed", points.len());
            violations.add(&at_points, FieldCode::TooFewPoints, detail);
        }
        let columns = points.first().map_or(0, Vec::len);
        for (i, row) in points.iter().enumerate() {
            if row.len() < 2 {
                let detail = format!("{} points; at least 2 are needed", row.len());
                violations.add(&at_points.index(i), FieldCode::TooFewPoints, detail);
            } else if row.len() != columns {
                let detail = format!("{} points where row 0 has {columns}", row.len());
                violations.add(&at_points.index(i), FieldCode::RaggedGrid, detail);
            }
            let at_row = at_points.index(i);
            for (j, point) in row.iter().enumerate() {
                point.check_in(&at_row, j, violations);
            }
        }
        let at_tangents = at.field("end_tangents");
        match (ends, end_tangents) {
            (Ends::Clamped, Some(tangents)) => {
                tangents.check(&at_tangents, (points.len(), columns), violations);
            }
            (Ends::Clamped, None) => {
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
impl From<Surface> for core::PointGrid {
    fn from(surface: Surface) -> Self {
        let Surface::PointGrid(PointGrid { _kind: _, points, twist, ends, end_tangents }) = surface;
        core::PointGrid {
            points: points.into_iter().map(|row| row.into_iter().map(Point3::from).collect()).collect(),
            twist: match twist {
                Twist::Spline => core::Twist::Spline,
                Twist::Zero => core::Twist::Zero,
            },
            ends: match (ends, end_tangents) {
                (Ends::Clamped, Some(tangents)) => core::Ends::Clamped(tangents.into()),
                (Ends::Natural | Ends::Clamped, _) => core::Ends::Natural,
                (Ends::NotAKnot, _) => core::Ends::NotAKnot,
                (Ends::Bessel, _) => core::Ends::Bessel,
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
