//! Rational B-spline curves in the plane, as they are sent.

use serde::Deserialize;
use utoipa::ToSchema;
use utoipa::openapi::schema::{ArrayBuilder, Schema, SchemaType, Type};

use super::check_points;
use crate::config::Limits;
use crate::geometry::plane_curve::nurbs as core;
use crate::http::dto::check::Range;
use crate::http::dto::check::Violations;
use crate::http::dto::point::{PlanePoint, row_schema_of};
use crate::http::dto::surface::nurbs::{WEIGHTS, check_knots, number};
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;

/// Degrees that can be read.
const DEGREES: (u32, u32) = (1, 7);

#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = NurbsCurveKind)]
pub enum NurbsKind {
    Nurbs,
}

/// A rational B-spline curve. The knot vector is full: as many knots as control points, and the degree and one more; it need
/// not be clamped.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = NurbsCurve)]
pub struct Nurbs {
    #[serde(rename = "kind")]
    #[schema(inline)]
    _kind: NurbsKind,
    #[schema(minimum = 1, maximum = 7)]
    degree: u32,
    /// Not falling.
    #[schema(schema_with = knots_schema)]
    knots: Vec<f64>,
    /// In the plane: not multiplied by the weights.
    #[schema(schema_with = points_schema)]
    control_points: Vec<PlanePoint>,
    /// Above zero, no two with a quotient above 1e6. Default: all 1.
    #[schema(schema_with = weights_schema)]
    weights: Option<Vec<f64>>,
}

fn knots_schema() -> Schema {
    let most = Limits::DEFAULT.curve_points + DEGREES.1 as usize + 1;
    ArrayBuilder::new().items(number(Range::COORDINATE)).min_items(Some(4)).max_items(Some(most)).into()
}

fn points_schema() -> Schema {
    row_schema_of::<PlanePoint>(Limits::DEFAULT.curve_points).into()
}

fn weights_schema() -> Schema {
    let most = Limits::DEFAULT.curve_points;
    let weights = ArrayBuilder::new().items(number(WEIGHTS)).min_items(Some(2)).max_items(Some(most));
    // Null is read as nothing.
    weights.schema_type(SchemaType::from_iter([Type::Array, Type::Null])).into()
}

impl Nurbs {
    pub fn check(&self, at: &Pointer, limits: &Limits, violations: &mut Violations) {
        let Self { _kind: _, degree, knots, control_points, weights } = self;
        violations.integer(&at.field("degree"), *degree, DEGREES);
        if !check_points(&at.field("control_points"), control_points, limits, violations) {
            return;
        }
        // A wrong degree is to blame itself, not the number of knots.
        let is_legal = (DEGREES.0..=DEGREES.1).contains(degree);
        let expected = is_legal.then_some(control_points.len() + *degree as usize + 1);
        check_knots(&at.field("knots"), knots, expected, violations);
        let Some(weights) = weights else { return };
        let at = at.field("weights");
        if weights.len() != control_points.len() {
            let detail = format!("{} weights for {} control points", weights.len(), control_points.len());
            violations.add(&at, FieldCode::WrongLength, detail);
        }
        for (k, weight) in weights.iter().enumerate().filter(|(_, weight)| !WEIGHTS.holds(**weight)) {
            violations.number(&at.index(k), *weight, WEIGHTS, "");
        }
    }
}

/// Converts what has been checked.
impl From<Nurbs> for core::Nurbs {
    fn from(nurbs: Nurbs) -> Self {
        let Nurbs { _kind: _, degree, knots, control_points, weights } = nurbs;
        Self {
            degree: degree as usize,
            knots,
            control_points: control_points.into_iter().map(Into::into).collect(),
            weights,
        }
    }
}
