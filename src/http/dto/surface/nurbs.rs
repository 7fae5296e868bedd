//! Rational B-spline surfaces, as they are sent.

use serde::Deserialize;
use utoipa::ToSchema;
use utoipa::openapi::schema::{
    ArrayBuilder, KnownFormat, ObjectBuilder, Schema, SchemaFormat, SchemaType, Type,
};

use super::grid;
use crate::config::Limits;
use crate::geometry::surface::nurbs as core;
use crate::geometry::surface::patch::rational::MAX_DEGREE;
use crate::http::dto::check::{MAX_MAGNITUDE_MM, Range, Violations};
use crate::http::dto::point::Point;
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;

/// Weights; only their ratios matter.
pub const WEIGHTS: Range = Range { min: 1e-6, max: 1e6 };

#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum NurbsKind {
    Nurbs,
}

/// A rational B-spline surface. Knot vectors are full: as many knots as control points, and the degree and one more;
/// they need not be clamped.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Nurbs {
    #[serde(rename = "kind")]
    #[schema(inline)]
    _kind: NurbsKind,
    #[schema(minimum = 1, maximum = 7)]
    degree_u: u32,
    #[schema(minimum = 1, maximum = 7)]
    degree_v: u32,
    /// Not falling; inside the domain no knot stands more often than the degree.
    #[schema(schema_with = knots_schema)]
    knots_u: Vec<f64>,
    #[schema(schema_with = knots_schema)]
    knots_v: Vec<f64>,
    /// `control_points[i][j]`, i along u, in space: not multiplied by the weights.
    #[schema(schema_with = grid::schema)]
    control_points: Vec<Vec<Point>>,
    /// Above zero, no two with a quotient above 1e6. Default: all 1.
    #[schema(schema_with = weights_schema)]
    weights: Option<Vec<Vec<f64>>>,
}

fn knots_schema() -> Schema {
    let most = Limits::DEFAULT.surface_points / 2 + MAX_DEGREE + 1;
    let knots = ArrayBuilder::new().items(number(Range::COORDINATE));
    knots.min_items(Some(4)).max_items(Some(most)).into()
}

fn weights_schema() -> Schema {
    let most = Limits::DEFAULT.surface_points / 2;
    let row = ArrayBuilder::new().items(number(WEIGHTS)).min_items(Some(2)).max_items(Some(most));
    let rows = ArrayBuilder::new().items(row).min_items(Some(2)).max_items(Some(most));
    // Null is read as nothing.
    rows.schema_type(SchemaType::from_iter([Type::Array, Type::Null])).into()
}

/// The schema of a number in a range.
pub fn number(range: Range) -> ObjectBuilder {
    ObjectBuilder::new()
        .schema_type(Type::Number)
        .format(Some(SchemaFormat::KnownFormat(KnownFormat::Double)))
        .minimum(Some(range.min))
        .maximum(Some(range.max))
}

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
            // A wrong degree is to blame itself, not the number of knots.
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

/// Looks at a knot vector that is to have `expected` knots.
pub fn check_knots(at: &Pointer, knots: &[f64], expected: Option<usize>, violations: &mut Violations) {
    if let Some(expected) = expected.filter(|expected| knots.len() != *expected) {
        let detail = format!("{} knots; control points and degree ask for {expected}", knots.len());
        violations.add(at, FieldCode::WrongLength, detail);
    }
    for (k, knot) in knots.iter().enumerate() {
        if knot.abs() > MAX_MAGNITUDE_MM {
            violations.number(&at.index(k), *knot, Range::COORDINATE, "");
        }
    }
    if let Some(k) = knots.windows(2).position(|pair| pair[1] < pair[0]) {
        let detail = format!("{} is below {} before it", knots[k + 1], knots[k]);
        violations.add(&at.index(k + 1), FieldCode::OutOfRange, detail);
    }
}

/// Converts what has been checked.
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
