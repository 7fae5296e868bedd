//! Vertices of outlines: plain points, points with a bulge, and the ends of arcs that are given by their
//! radius.

use std::fmt;

use nalgebra::{Point2, distance};
use serde::de::value::MapAccessDeserializer;
use serde::de::{Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use utoipa::openapi::RefOr;
use utoipa::openapi::schema::{OneOfBuilder, Schema};
use utoipa::{PartialSchema, ToSchema};

use super::weld::Corner;
use crate::http::dto::check::{Range, Violations};
use crate::http::dto::schema::{array_of, number, reference};
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;
use toolpathd_core::geometry::curve::Direction;

/// Legal bulges: an arc of nearly a full turn has a bulge of 1000.
const BULGE: Range = Range { min: -1000.0, max: 1000.0 };

/// By how much the radius of an arc may be less than half the distance of its ends, mm. A radius with three
/// decimals is short by up to half of this where the arc is a half circle.
const RADIUS_SHORT_MM: f64 = 0.001;

/// By how much a bulge may be above that of a half circle and still count as one: bulges are rounded.
const HALF_CIRCLE_ROUNDING: f64 = 1e-6;

/// A vertex of an outline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vertex {
    at: [f64; 2],
    element: Element,
}

/// What a vertex says of the elements beside it.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Element {
    /// Nothing: lines, unless another vertex says more.
    Plain,
    /// The bulge of the element from this vertex to the next.
    Bulge(f64),
    /// The arc from the vertex before to this one.
    Arc { radius_mm: f64, direction: Direction, large: bool },
}

/// The end of an arc: the arc leads from the vertex before to `to`. The vertex before the first vertex is the
/// last.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ArcVertex {
    /// The vertex `[x, y]`, in mm.
    #[schema(min_items = 2, max_items = 2)]
    to: [f64; 2],
    /// Radius of the arc, in mm; at least half of the distance of its ends. With exactly half, the arc is a
    /// half circle; up to 0.001 mm less counts as half.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    radius_mm: f64,
    /// Whether the arc turns clockwise or counterclockwise from the vertex before to `to`.
    #[serde(default = "counterclockwise")]
    #[schema(default = "ccw")]
    direction: Direction,
    /// Whether the arc is the larger one of the two arcs with this radius and direction: more than a half
    /// circle.
    #[serde(default)]
    #[schema(default = false)]
    large: bool,
}

fn counterclockwise() -> Direction {
    Direction::Ccw
}

impl Vertex {
    /// A vertex that says nothing of the elements beside it.
    pub fn plain(at: [f64; 2]) -> Self {
        Self { at, element: Element::Plain }
    }

    /// A vertex after which the element has this bulge.
    pub fn bulging(at: [f64; 2], bulge: f64) -> Self {
        Self { at, element: Element::Bulge(bulge) }
    }

    /// Whether the vertex has a bulge of more than a half circle.
    pub fn is_over_half_circle(&self) -> bool {
        matches!(self.element, Element::Bulge(bulge) if bulge.abs() > 1.0 + HALF_CIRCLE_ROUNDING)
    }

    /// Checks the vertex and the element that leads to it from `before`.
    pub fn check(&self, at: &Pointer, before: &Vertex, at_before: &Pointer, violations: &mut Violations) {
        let at_arc = matches!(self.element, Element::Arc { .. });
        let place = if at_arc { at.field("to") } else { at.clone() };
        for (axis, value) in self.at.into_iter().enumerate() {
            violations.number(&place.index(axis), value, Range::COORDINATE, "mm");
        }
        match self.element {
            Element::Plain => {}
            Element::Bulge(bulge) => violations.number(&at.index(2), bulge, BULGE, ""),
            Element::Arc { radius_mm, .. } => {
                violations.number(&at.field("radius_mm"), radius_mm, Range::POSITIVE, "mm");
                if Range::POSITIVE.holds(radius_mm) {
                    self.check_arc(at, before, radius_mm, violations);
                }
                if matches!(before.element, Element::Bulge(_)) {
                    let detail = "the arc behind this vertex has a radius: leave the bulge out";
                    violations.add(&at_before.index(2), FieldCode::Conflict, detail);
                }
            }
        }
    }

    fn check_arc(&self, at: &Pointer, before: &Vertex, radius_mm: f64, violations: &mut Violations) {
        let apart_mm = distance(&Point2::from(before.at), &Point2::from(self.at));
        if apart_mm == 0.0 {
            let detail = "the arc ends where it starts: send a full circle as two arcs";
            violations.add(&at.field("to"), FieldCode::Coincident, detail);
            return;
        }
        let detail = match self.bulge_from(before) {
            None => format!(
                "an arc of {radius_mm} mm cannot span the {apart_mm:.4} mm from the vertex before; send at least {:.4} mm",
                0.5 * apart_mm
            ),
            Some(bulge) if !BULGE.holds(bulge) => {
                "the arc is as good as a full circle: send it as two arcs".to_owned()
            }
            Some(_) => return,
        };
        violations.add(&at.field("radius_mm"), FieldCode::OutOfRange, detail);
    }

    /// The bulge of the element from `before` to this vertex. `None` where the arc has too small a radius.
    fn bulge_from(&self, before: &Vertex) -> Option<f64> {
        match (self.element, before.element) {
            (Element::Arc { radius_mm, direction, large }, _) => {
                let half_mm = 0.5 * distance(&Point2::from(before.at), &Point2::from(self.at));
                if half_mm > radius_mm + RADIUS_SHORT_MM {
                    return None;
                }
                // The sine of half of the smaller arc's turn.
                let sine = (half_mm / radius_mm).min(1.0);
                let quarter = sine / (1.0 + (1.0 - sine * sine).sqrt());
                let bulge = if large { 1.0 / quarter } else { quarter };
                Some(if direction == Direction::Ccw { bulge } else { -bulge })
            }
            (_, Element::Bulge(bulge)) => Some(bulge),
            _ => Some(0.0),
        }
    }

    /// The vertex `before` with the element from there to this vertex, which has been checked.
    pub fn corner_after(&self, before: &Vertex) -> Corner {
        Corner { at: before.at.into(), bulge: self.bulge_from(before).unwrap_or_default() }
    }
}

impl<'de> Deserialize<'de> for Vertex {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(PointOrArc)
    }
}

struct PointOrArc;

impl<'de> Visitor<'de> for PointOrArc {
    type Value = Vertex;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a vertex [x, y], [x, y, bulge] or {to, radius_mm}")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Vertex, A::Error> {
        let mut at = [0.0; 2];
        for (k, coordinate) in at.iter_mut().enumerate() {
            *coordinate = seq.next_element()?.ok_or_else(|| A::Error::invalid_length(k, &self))?;
        }
        let Some(bulge) = seq.next_element()? else { return Ok(Vertex { at, element: Element::Plain }) };
        match seq.next_element::<IgnoredAny>()? {
            None => Ok(Vertex::bulging(at, bulge)),
            Some(_) => Err(A::Error::invalid_length(4, &self)),
        }
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Vertex, A::Error> {
        let ArcVertex { to, radius_mm, direction, large } =
            ArcVertex::deserialize(MapAccessDeserializer::new(map))?;
        Ok(Vertex { at: to, element: Element::Arc { radius_mm, direction, large } })
    }
}

impl PartialSchema for Vertex {
    fn schema() -> RefOr<Schema> {
        let description = "A vertex of an outline: `[x, y]` in mm, or `[x, y, bulge]`, or an object that gives the arc to the vertex by \
             its radius. The bulge belongs to the element from this vertex to the next: the tangent of a quarter of the arc's angle, \
             positive where the arc turns to the left, 0 for a line, 1 for a half circle to the left (as in DXF). A bulge beyond 1 is an \
             arc of more than a half circle, and the answer warns.";
        let place = array_of(number(Range::COORDINATE), 2, 3);
        OneOfBuilder::new().item(place).item(reference::<ArcVertex>()).description(Some(description)).into()
    }
}

impl ToSchema for Vertex {
    fn schemas(schemas: &mut Vec<(String, RefOr<Schema>)>) {
        schemas.push((ArcVertex::name().into_owned(), ArcVertex::schema()));
        ArcVertex::schemas(schemas);
    }
}
