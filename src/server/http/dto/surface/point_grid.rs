//! The surface kind `point_grid` in requests: measured points.

use nalgebra::{Point3, Vector3};
use serde::Deserialize;
use utoipa::ToSchema;

use super::grid::{self, PointRows};
use crate::config::Limits;
use crate::http::decode::object;
use crate::http::decode::tagged::Kind;
use crate::http::dto::check::Violations;
use crate::http::dto::point::Point;
use crate::http::dto::point_faults::{self, Outliers};
use crate::http::dto::schema::{array_of, reference, schema_of};
use crate::http::error::FieldCode;
use crate::http::messages::Warning;
use crate::http::pointer::Pointer;
use toolpathd_core::geometry::point_judge::{Fault, Verdict, judge};
use toolpathd_core::geometry::surface::point_grid::{self as core, Twist};

/// Measured points, joined by a smooth surface: bicubic splines with uniform parameters.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PointGrid {
    #[serde(rename = "kind")]
    #[schema(ignore)]
    _kind: Kind,
    /// Points in mm through which the surface passes: `points[i][j]`, i along u and j along v. At least 2
    /// rows of at least 2 points; every row is as long as the first row.
    #[schema(value_type = PointRows)]
    points: Vec<Vec<Point>>,
    /// The mixed derivatives at the points. `spline`: the derivatives of the cubic spline. `zero`: zero.
    #[serde(default)]
    #[schema(default = "spline")]
    twist: Twist,
    /// The end conditions of the splines. `not_a_knot`: the first two spans are one cubic, and the last two
    /// spans are one cubic. `natural`: no curvature at the edges; this flattens the rim of a curved part.
    /// `clamped`: the tangents of `end_tangents`. `bessel`: the slope of the parabola through the three
    /// points nearest to the edge. `periodic`: the surface closes smoothly, with continuous second
    /// derivatives, along u where the first and the last row coincide within 1e-6 mm, and along v where the
    /// first and the last column do; a direction that is not closed gets `not_a_knot`. Default: `periodic`
    /// for a closed direction that bends no more at its seam than elsewhere (the answer warns:
    /// `ends_periodic`), else `not_a_knot`. The warning `ends_reduced` is given only where the request itself
    /// contains `ends: not_a_knot`.
    ends: Option<Ends>,
    /// What to do with points that look like mistakes: points off the surface of their neighbours, repeated
    /// points, numbers that stand for missing values, exchanged axes, rows out of order. `refuse`: rows,
    /// columns and points are put into order where that is unambiguous, and the answer warns
    /// (`points_reordered`); anything else is refused with its pointer. `accept`: the points are taken as
    /// they were sent.
    #[serde(default)]
    #[schema(default = "refuse")]
    outliers: Outliers,
    /// Tangents at the boundaries, in mm. Required with `ends: clamped`, refused with other ends.
    #[serde(default, deserialize_with = "object::optional")]
    end_tangents: Option<EndTangents>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Ends {
    Natural,
    NotAKnot,
    Clamped,
    Bessel,
    Periodic,
}

/// Tangents across the boundaries, in mm, one vector for each boundary point: the derivative by a parameter
/// that grows by 1 from point to point.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct EndTangents {
    /// Tangents along u at the points of the first row, in mm: the derivative by a parameter that grows by 1
    /// from row to row, in the direction of growing u.
    #[schema(value_type = TangentRow)]
    u0: Vec<Point>,
    /// Tangents along u at the points of the last row, in mm, measured as for `u0`.
    #[schema(value_type = TangentRow)]
    u1: Vec<Point>,
    /// Tangents along v at the first point of each row, in mm: the derivative by a parameter that grows by 1
    /// from point to point, in the direction of growing v.
    #[schema(value_type = TangentRow)]
    v0: Vec<Point>,
    /// Tangents along v at the last point of each row, in mm, measured as for `v0`.
    #[schema(value_type = TangentRow)]
    v1: Vec<Point>,
}

schema_of!(TangentRow of Point, "Vectors `[x, y, z]`, in mm, one for each point of a boundary.", {
    array_of(reference::<Point>(), 2, Limits::DEFAULT.surface_points / 2)
});

impl PointGrid {
    /// A grid with the defaults of all other members.
    pub fn of_points(points: Vec<Vec<Point>>) -> Self {
        let (twist, outliers) = (Twist::default(), Outliers::default());
        Self { _kind: Kind, points, twist, ends: None, outliers, end_tangents: None }
    }

    pub fn points(&self) -> impl Iterator<Item = &Point> {
        self.points.iter().flatten()
    }

    /// Puts rows, columns and points into order where that is unambiguous and nothing else is wrong.
    pub fn put_right(&mut self, limits: &Limits) -> Vec<Warning> {
        let total: usize = self.points.iter().map(Vec::len).sum();
        if total > limits.surface_points {
            return Vec::new();
        }
        let mut remarks = Vec::new();
        if self.outliers == Outliers::Refuse && self.end_tangents.is_none() {
            let verdict = self.verdict();
            if let Some(order) = verdict.order.filter(|_| verdict.faults.is_empty()) {
                let at = |[i, j]: [usize; 2]| self.points[i][j];
                self.points = order.into_iter().map(|row| row.into_iter().map(at).collect()).collect();
                remarks.extend(verdict.changes.iter().map(Warning::from));
            }
        }
        if self.ends.is_none() && self.is_rectangle() {
            let grid = core::PointGrid { points: self.rows(), twist: self.twist, ends: core::Ends::Usual };
            let periodic = grid.periodic();
            if periodic != [false; 2] {
                remarks.push(Warning::ends_periodic(periodic));
            }
        }
        remarks
    }

    fn rows(&self) -> Vec<Vec<Point3<f64>>> {
        self.points.iter().map(|row| row.iter().copied().map(Point3::from).collect()).collect()
    }

    /// Whether there are rows, and all rows are equally long.
    fn is_rectangle(&self) -> bool {
        let columns = self.points.first().map_or(0, Vec::len);
        columns > 0 && self.points.iter().all(|row| row.len() == columns)
    }

    fn is_closed(&self) -> bool {
        let grid = core::PointGrid { points: self.rows(), twist: self.twist, ends: core::Ends::Periodic };
        self.is_rectangle() && grid.closed() != [false; 2]
    }

    /// Points with a number beyond the legal range are refused for it, and not judged.
    fn verdict(&self) -> Verdict {
        if self.points().all(Point::is_legal) { judge(&self.rows()) } else { judge(&[]) }
    }

    pub fn check(&self, at: &Pointer, limits: &Limits, violations: &mut Violations) {
        let Self { _kind: _, points, twist: _, ends, outliers, end_tangents } = self;
        let Some(size) = grid::check_points(&at.field("points"), points, limits, violations) else { return };
        let verdict = self.verdict();
        let faults = match (outliers, end_tangents) {
            (Outliers::Accept, _) => verdict.faults.into_iter().filter(|f| *f == Fault::AllSame).collect(),
            (Outliers::Refuse, Some(_)) => verdict.faults_as_sent(),
            (Outliers::Refuse, None) => verdict.faults,
        };
        point_faults::add(&at.field("points"), &faults, violations);
        if *ends == Some(Ends::Periodic) && !self.is_closed() {
            let detail = "neither the first and last rows nor the first and last columns coincide within 1e-6 mm: send a closed grid of at least four points along the closed direction, its first points again at its end, or other ends";
            violations.add(&at.field("ends"), FieldCode::Conflict, detail);
        }
        let at_tangents = at.field("end_tangents");
        match (ends, end_tangents) {
            (Some(Ends::Clamped), Some(tangents)) => tangents.check(&at_tangents, size.into(), violations),
            (Some(Ends::Clamped), None) => {
                let detail = "`end_tangents` is required with `ends: clamped`";
                violations.add(&at_tangents, FieldCode::MissingField, detail);
            }
            (_, Some(_)) => {
                let detail = "`end_tangents` needs `ends: clamped`";
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
                let detail = format!(
                    "there are {} vectors for {expected} boundary points; send equally many",
                    side.len()
                );
                violations.add(&at, FieldCode::WrongLength, detail);
            }
            for (k, vector) in side.iter().enumerate() {
                vector.check_in(&at, k, violations);
            }
        }
    }
}

/// Converts a surface that has been checked.
impl From<PointGrid> for core::PointGrid {
    fn from(PointGrid { _kind: _, points, twist, ends, outliers: _, end_tangents }: PointGrid) -> Self {
        Self {
            points: grid::converted(points),
            twist,
            ends: match (ends, end_tangents) {
                (Some(Ends::Clamped), Some(tangents)) => core::Ends::Clamped(tangents.into()),
                (None | Some(Ends::Clamped), _) => core::Ends::Usual,
                (Some(Ends::Natural), _) => core::Ends::Natural,
                (Some(Ends::NotAKnot), _) => core::Ends::NotAKnot,
                (Some(Ends::Bessel), _) => core::Ends::Bessel,
                (Some(Ends::Periodic), _) => core::Ends::Periodic,
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
