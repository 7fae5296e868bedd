//! Rational B-spline curves of the plane in requests.

use serde::Deserialize;
use utoipa::ToSchema;

use super::{CurvePoints, check_points};
use crate::config::Limits;
use crate::http::decode::tagged::Kind;
use crate::http::dto::check::{Range, Violations};
use crate::http::dto::point::PlanePoint;
use crate::http::dto::schema::{array_of, number, schema_of};
use crate::http::dto::surface::nurbs::{WEIGHTS, check_knots};
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;
use toolpathd_core::geometry::plane_curve::nurbs as core;

/// The lowest and the highest legal degree.
const DEGREES: (u32, u32) = (1, 7);

/// A rational B-spline curve. The knot vector has as many knots as there are control points, plus the degree,
/// plus 1. The knot vector need not be clamped.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = NurbsCurve)]
pub struct Nurbs {
    #[serde(rename = "kind")]
    #[schema(ignore)]
    _kind: Kind,
    /// Degree of the curve: a count, 3 for cubics.
    #[schema(minimum = 1, maximum = 7)]
    degree: u32,
    /// Knots: plain numbers, none smaller than the knot before. An end knot is repeated at most degree + 1
    /// times, so that every control point has an effect.
    #[schema(value_type = CurveKnots)]
    knots: Vec<f64>,
    /// Control points `[x, y]` in mm. The coordinates are not multiplied by the weights.
    #[schema(value_type = CurvePoints)]
    control_points: Vec<PlanePoint>,
    /// Weights of the control points: plain numbers above 0. Only the ratios of weights matter. A larger
    /// weight pulls the curve towards its control point. The ratio of two weights is at most 1e6. Default:
    /// all 1.
    #[schema(value_type = Option<CurveWeights>)]
    weights: Option<Vec<f64>>,
}

schema_of!(CurveKnots, "Knots: numbers, none smaller than the knot before.", {
    array_of(number(Range::COORDINATE), 4, Limits::DEFAULT.curve_points + DEGREES.1 as usize + 1)
});

schema_of!(CurveWeights, "Weights, one for each control point.", {
    array_of(number(WEIGHTS), 2, Limits::DEFAULT.curve_points)
});

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
            let detail = format!(
                "there are {} weights for {} control points; send equally many",
                weights.len(),
                control_points.len()
            );
            violations.add(&at, FieldCode::WrongLength, detail);
        }
        for (k, weight) in weights.iter().enumerate().filter(|(_, weight)| !WEIGHTS.holds(**weight)) {
            violations.number(&at.index(k), *weight, WEIGHTS, "");
        }
    }
}

/// Converts a curve that has been checked.
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
