//! Plane curves as they are sent.

mod nurbs;

use serde::{Deserialize, Deserializer};
use serde_json::value::RawValue;
use utoipa::ToSchema;
use utoipa::openapi::schema::Schema;

use super::check::{Range, Violations};
use super::point::{PlanePoint, row_schema_of};
use super::tagged;
use crate::config::Limits;
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;
use crate::language::{expression, section_curve};
use crate::operations::interpolation::Source;
pub use nurbs::Nurbs;

/// A curve in the plane, told apart by `kind`.
#[derive(Debug, ToSchema)]
#[schema(as = Curve)]
#[serde(untagged)]
pub enum Curve {
    Graph(Graph),
    Points(Points),
    Nurbs(Nurbs),
    SectionCurve(SectionCurve),
}

const KINDS: [&str; 4] = ["graph", "points", "nurbs", "section_curve"];

impl<'de> Deserialize<'de> for Curve {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let object = <&RawValue>::deserialize(deserializer)?;
        match tagged::kind_of::<D::Error>(object)?.as_str() {
            "graph" => tagged::decode(object).map(Self::Graph),
            "points" => tagged::decode(object).map(Self::Points),
            "nurbs" => tagged::decode(object).map(Self::Nurbs),
            "section_curve" => tagged::decode(object).map(Self::SectionCurve),
            other => Err(tagged::unknown(other, &[], &KINDS)),
        }
    }
}

#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum GraphKind {
    Graph,
}

#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum PointsKind {
    Points,
}

#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum SectionCurveKind {
    SectionCurve,
}

/// The graph of a function y(x), mm.
///
/// The expression is in x: `+ - * / ^`, signs, parentheses, numbers, `pi`, `e`, and sin cos tan asin acos atan sinh cosh
/// tanh exp ln log log10 log2 sqrt cbrt abs min max pow hypot; `log` is `ln`. `^` binds to the right, `-x^2` is
/// `-(x^2)`, a product is written with `*`. It must be defined and continuous over the whole domain.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Graph {
    #[serde(rename = "kind")]
    #[schema(inline)]
    _kind: GraphKind,
    #[schema(max_length = 10_000, example = "sin(x)")]
    expression: String,
    /// The first and the last x, rising.
    #[schema(min_items = 2, max_items = 2)]
    domain: [f64; 2],
}

/// The C2 cubic spline through points, by chord length, with not-a-knot ends.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Points {
    #[serde(rename = "kind")]
    #[schema(inline)]
    _kind: PointsKind,
    /// No two neighbours coincide.
    #[schema(schema_with = points_schema)]
    points: Vec<PlanePoint>,
}

/// A curve in the language of section curves: `l(x,y)` is a corner of a polyline, `r(x,y,R)` a corner rounded by the radius
/// R, `b((x,y),...)` a smooth curve through points. Items are separated by white space.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct SectionCurve {
    #[serde(rename = "kind")]
    #[schema(inline)]
    _kind: SectionCurveKind,
    #[schema(max_length = 8_000_000, example = "l(0,0) r(50,0,10) l(50,40)")]
    text: String,
}

fn points_schema() -> Schema {
    row_schema_of::<PlanePoint>(Limits::DEFAULT.curve_points).into()
}

/// Looks at the points that give a curve its size.
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
    /// Collects what is wrong with the curve at `at`.
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
            let detail =
                format!("from {from} to {to} mm; the domain must rise by at least {SHORTEST_DOMAIN_MM} mm");
            violations.add(&at, FieldCode::OutOfRange, detail);
        }
    }
}

/// Shorter domains are mistakes: they cannot be told from a point by any control, mm.
const SHORTEST_DOMAIN_MM: f64 = 1e-6;

/// Texts beyond their language's limit are refused before they are looked at.
fn too_long(at: &Pointer, text: &str, most: usize, violations: &mut Violations) {
    if text.len() > most {
        violations.add(at, FieldCode::TooLong, format!("{} bytes; at most {most} are allowed", text.len()));
    }
}

/// Converts what has been checked.
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
