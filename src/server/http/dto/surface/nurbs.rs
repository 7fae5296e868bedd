//! The surface kind `nurbs` in requests: rational B-spline surfaces.

use nalgebra::Point3;
use serde::Deserialize;
use utoipa::ToSchema;

use super::grid::{self, PointRows};
use crate::config::Limits;
use crate::http::decode::tagged::Kind;
use crate::http::dto::check::{MAX_MAGNITUDE_MM, Range, Violations};
use crate::http::dto::point::Point;
use crate::http::dto::schema::{array_of, number, schema_of};
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;
use toolpathd_core::geometry::surface::nurbs as core;
use toolpathd_core::geometry::surface::patch::rational::MAX_DEGREE;

/// Legal weights. Only the ratios of weights matter.
pub const WEIGHTS: Range = Range { min: 1e-6, max: 1e6 };

/// A rational B-spline surface. Each knot vector has as many knots as there are control points along its
/// direction, plus the degree, plus 1. The knot vectors need not be clamped.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Nurbs {
    #[serde(rename = "kind")]
    #[schema(ignore)]
    _kind: Kind,
    /// Degree along u: a count, 3 for cubics.
    #[schema(minimum = 1, maximum = 7)]
    degree_u: u32,
    /// Degree along v: a count, 3 for cubics.
    #[schema(minimum = 1, maximum = 7)]
    degree_v: u32,
    /// Knots along u: plain numbers, none smaller than the knot before. Inside the domain no knot is repeated
    /// more often than the degree. An end knot is repeated at most degree + 1 times.
    #[schema(value_type = SurfaceKnots)]
    knots_u: Vec<f64>,
    /// Knots along v: plain numbers, none smaller than the knot before. Inside the domain no knot is repeated
    /// more often than the degree. An end knot is repeated at most degree + 1 times.
    #[schema(value_type = SurfaceKnots)]
    knots_v: Vec<f64>,
    /// Control points in mm: `control_points[i][j]`, i along u and j along v. The coordinates are not
    /// multiplied by the weights.
    #[schema(value_type = PointRows)]
    control_points: Vec<Vec<Point>>,
    /// Weights of the control points: plain numbers above 0. Only the ratios of weights matter. A larger
    /// weight pulls the surface towards its control point. The ratio of two weights is at most 1e6. Default:
    /// all 1.
    #[schema(value_type = Option<SurfaceWeights>)]
    weights: Option<Vec<Vec<f64>>>,
}

schema_of!(SurfaceKnots, "Knots: numbers, none smaller than the knot before.", {
    array_of(number(Range::COORDINATE), 4, Limits::DEFAULT.surface_points / 2 + MAX_DEGREE + 1)
});

schema_of!(SurfaceWeights, "Rows of weights, one for each control point.", {
    let most = Limits::DEFAULT.surface_points / 2;
    array_of(array_of(number(WEIGHTS), 2, most), 2, most)
});

impl Nurbs {
    pub fn points(&self) -> impl Iterator<Item = &Point> {
        self.control_points.iter().flatten()
    }

    pub fn check(&self, at: &Pointer, limits: &Limits, violations: &mut Violations) {
        let Self { _kind: _, degree_u, degree_v, knots_u, knots_v, control_points, weights } = self;
        for (name, degree) in [("degree_u", *degree_u), ("degree_v", *degree_v)] {
            violations.integer(&at.field(name), degree, (1, MAX_DEGREE as u32));
        }
        let at_points = at.field("control_points");
        let Some(size) = grid::check_points(&at_points, control_points, limits, violations) else { return };
        for (name, knots, degree, points) in
            [("knots_u", knots_u, *degree_u, size[0]), ("knots_v", knots_v, *degree_v, size[1])]
        {
            // With an illegal degree the right number of knots is unknown, and only the degree is reported.
            let is_legal = (1..=MAX_DEGREE as u32).contains(&degree);
            let expected = is_legal.then_some(points + degree as usize + 1);
            check_knots(&at.field(name), knots, expected, violations);
        }
        if let Some(weights) = weights {
            let check_row = |at: &Pointer, row: &[f64], violations: &mut Violations| {
                for (j, weight) in row.iter().enumerate().filter(|(_, w)| !WEIGHTS.holds(**w)) {
                    violations.number(&at.index(j), *weight, WEIGHTS, "");
                }
            };
            grid::check_like(&at.field("weights"), weights, size, violations, check_row);
        }
    }
}

/// Checks a knot vector that must have `expected` knots. `None` leaves the number unchecked.
pub fn check_knots(at: &Pointer, knots: &[f64], expected: Option<usize>, violations: &mut Violations) {
    if let Some(expected) = expected.filter(|expected| knots.len() != *expected) {
        let detail =
            format!("there are {} knots; the control points and the degree need {expected}", knots.len());
        violations.add(at, FieldCode::WrongLength, detail);
    }
    for (k, knot) in knots.iter().enumerate() {
        if knot.abs() > MAX_MAGNITUDE_MM {
            violations.number(&at.index(k), *knot, Range::COORDINATE, "");
        }
    }
    if let Some(k) = knots.windows(2).position(|pair| pair[1] < pair[0]) {
        let detail = format!(
            "a knot of {} follows a knot of {}; no knot may be smaller than the knot before it",
            knots[k + 1],
            knots[k]
        );
        violations.add(&at.index(k + 1), FieldCode::OutOfRange, detail);
    }
}

impl Nurbs {
    /// The surface as a request would send it, with `mm` millimetres in each of its units of length.
    pub fn scaled(nurbs: &core::Nurbs, mm: f64) -> Self {
        let core::Nurbs { degree: [degree_u, degree_v], knots: [knots_u, knots_v], control_points, weights } =
            nurbs;
        let degree = |degree: usize| u32::try_from(degree).unwrap_or(u32::MAX);
        let row = |row: &Vec<Point3<f64>>| row.iter().map(|point| Point::from(point * mm)).collect();
        Self {
            _kind: Kind,
            degree_u: degree(*degree_u),
            degree_v: degree(*degree_v),
            knots_u: knots_u.clone(),
            knots_v: knots_v.clone(),
            control_points: control_points.iter().map(row).collect(),
            weights: weights.clone(),
        }
    }
}

/// Converts a surface that has been checked.
impl From<Nurbs> for core::Nurbs {
    fn from(nurbs: Nurbs) -> Self {
        let Nurbs { _kind: _, degree_u, degree_v, knots_u, knots_v, control_points, weights } = nurbs;
        Self {
            degree: [degree_u as usize, degree_v as usize],
            knots: [knots_u, knots_v],
            control_points: grid::converted(control_points),
            weights,
        }
    }
}
