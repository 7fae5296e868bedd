//! Plane curves in requests.

mod nurbs;

use serde::Deserialize;
use utoipa::ToSchema;

use super::check::{Range, Violations};
use super::point::PlanePoint;
use super::schema::{array_of, reference, schema_of};
use crate::config::Limits;
use crate::http::decode::tagged::{Kind, by_kind};
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;
pub use nurbs::Nurbs;
use toolpathd_core::language::{expression, section_curve};
use toolpathd_core::operations::interpolation::Source;

by_kind! {
    /// A curve in the plane, given in one of several kinds; `kind` says which.
    #[derive(Debug)]
    Curve {
        "graph" => Graph(Graph),
        "points" => Points(Points),
        "nurbs" => Nurbs(Nurbs),
        "section_curve" => SectionCurve(SectionCurve),
    }
}

/// The graph of a function y(x), x and y in mm.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Graph {
    #[serde(rename = "kind")]
    #[schema(ignore)]
    _kind: Kind,
    /// The function: y in mm from x in mm. The expression may use `+ - * / ^`, signs, parentheses, numbers,
    /// `x`, `pi`, `e`, and sin cos tan asin acos atan sinh cosh tanh exp ln log log10 log2 sqrt cbrt abs min
    /// max pow hypot. Angles are in radians. `log` is `ln`. `2^3^2` is `2^(3^2)`, and `-x^2` is `-(x^2)`. A
    /// product needs its `*`. The function must be defined and continuous over the whole domain.
    #[schema(max_length = 10_000, example = "sin(x)")]
    expression: String,
    /// The first and the last x, in mm. The last x is at least 1e-6 mm larger than the first.
    #[schema(min_items = 2, max_items = 2)]
    domain: [f64; 2],
}

/// A smooth curve through points: the C2 cubic spline by chord length with not-a-knot ends.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Points {
    #[serde(rename = "kind")]
    #[schema(ignore)]
    _kind: Kind,
    /// Points `[x, y]` in mm, in the order of the curve. Neighbouring points differ.
    #[schema(value_type = CurvePoints)]
    points: Vec<PlanePoint>,
}

/// A curve of lines, roundings and smooth parts, in the language of section curves.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct SectionCurve {
    #[serde(rename = "kind")]
    #[schema(ignore)]
    _kind: Kind,
    /// The curve, in mm. `l(x,y)` is a corner of a polyline. `r(x,y,R)` is a corner rounded by the radius R.
    /// `b((x,y),...)` is a smooth curve through points. White space separates the items.
    #[schema(max_length = 8_000_000, example = "l(0,0) r(50,0,10) l(50,40)")]
    text: String,
}

schema_of!(CurvePoints of PlanePoint, "Points `[x, y]`, in mm, in the order of a curve.", {
    array_of(reference::<PlanePoint>(), 2, Limits::DEFAULT.curve_points)
});

/// Checks the number of points of a curve and every coordinate. `false` where there are too many points.
fn check_points(at: &Pointer, points: &[PlanePoint], limits: &Limits, violations: &mut Violations) -> bool {
    if !violations.count_of_points(at, points.len(), 2, limits.curve_points) {
        return false;
    }
    for (k, point) in points.iter().enumerate() {
        point.check_in(at, k, violations);
    }
    true
}

impl Curve {
    /// Collects the violations of the curve at `at`.
    pub fn check(&self, at: &Pointer, limits: &Limits, violations: &mut Violations) {
        match self {
            Self::Graph(graph) => graph.check(at, violations),
            Self::Points(Points { _kind: _, points }) => {
                check_points(&at.field("points"), points, limits, violations);
            }
            Self::Nurbs(nurbs) => nurbs.check(at, limits, violations),
            Self::SectionCurve(SectionCurve { _kind: _, text }) => {
                too_long(&at.field("text"), text, section_curve::TEXT_LIMIT, violations);
            }
        }
    }
}

impl Graph {
    fn check(&self, at: &Pointer, violations: &mut Violations) {
        too_long(&at.field("expression"), &self.expression, expression::LONGEST_TEXT, violations);
        let at = at.field("domain");
        for (k, x) in self.domain.into_iter().enumerate() {
            violations.number(&at.index(k), x, Range::COORDINATE, "mm");
        }
        let [from, to] = self.domain;
        if to - from < SHORTEST_DOMAIN_MM {
            let detail = format!(
                "the domain runs from {from} to {to} mm; its end must be at least {SHORTEST_DOMAIN_MM} mm above its start"
            );
            violations.add(&at, FieldCode::OutOfRange, detail);
        }
    }
}

/// Length of the shortest legal domain, mm. No control can tell a shorter curve from a point.
const SHORTEST_DOMAIN_MM: f64 = 1e-6;

/// Refuses a text that is longer than its language allows. Such a text is not parsed.
fn too_long(at: &Pointer, text: &str, most: usize, violations: &mut Violations) {
    if text.len() > most {
        violations.add(
            at,
            FieldCode::TooLong,
            format!("the text has {} bytes; send at most {most}", text.len()),
        );
    }
}

/// Converts a curve that has been checked.
impl From<Curve> for Source {
    fn from(curve: Curve) -> Self {
        match curve {
            Curve::Graph(Graph { _kind: _, expression, domain }) => Self::Graph { expression, domain },
            Curve::Points(Points { _kind: _, points }) => {
                Self::Points(points.into_iter().map(Into::into).collect())
            }
            Curve::Nurbs(nurbs) => Self::Nurbs(nurbs.into()),
            Curve::SectionCurve(SectionCurve { _kind: _, text }) => Self::SectionCurve(text),
        }
    }
}
