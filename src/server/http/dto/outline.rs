//! Outlines of pockets in requests: closed chains of lines and arcs.

use std::fmt;

use nalgebra::Point2;
use serde::de::{Error, IgnoredAny, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use utoipa::openapi::RefOr;
use utoipa::openapi::schema::Schema;
use utoipa::{PartialSchema, ToSchema};

use super::check::{Range, Violations};
use super::schema::{array_of, number, reference, schema_of};
use crate::config::Limits;
use crate::http::pointer::Pointer;
use toolpathd_core::geometry::segment::Segment;
use toolpathd_core::operations::pocketing as core;

/// Legal bulges: an arc of nearly a full turn has a bulge of 1000.
const BULGE: Range = Range { min: -1000.0, max: 1000.0 };

/// The most islands of a pocket.
const MAX_ISLANDS: usize = 10_000;

/// A vertex of an outline, with the bulge of the element from it to the next vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vertex {
    at: [f64; 2],
    bulge: Option<f64>,
}

/// A wall and the islands inside it.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = PocketRegion)]
pub struct Region {
    /// The wall: the vertices of a closed outline, in mm, in either direction. The last vertex is joined to
    /// the first.
    #[schema(value_type = Outline)]
    boundary: Vec<Vertex>,
    /// Outlines of what stays, in mm. Islands may overlap each other and the wall. Default: none.
    #[schema(value_type = Option<Islands>)]
    islands: Option<Vec<Vec<Vertex>>>,
}

schema_of!(Outline of Vertex, "Vertices `[x, y]` or `[x, y, bulge]` of a closed outline.", {
    array_of(reference::<Vertex>(), 2, Limits::DEFAULT.curve_points)
});

schema_of!(Islands of Outline, "Closed outlines.", { array_of(reference::<Outline>(), 0, MAX_ISLANDS) });

impl Region {
    pub fn new(boundary: Vec<Vertex>, islands: Option<Vec<Vec<Vertex>>>) -> Self {
        Self { boundary, islands }
    }

    /// The outlines in the core's terms. Adds violations to `violations`.
    pub fn convert(self, at: &Pointer, limits: &Limits, violations: &mut Violations) -> core::Outlines {
        let Self { boundary, islands } = self;
        let islands = islands.unwrap_or_default();
        let total = boundary.len() + islands.iter().map(Vec::len).sum::<usize>();
        if islands.len() > MAX_ISLANDS {
            violations.count_of_points(&at.field("islands"), islands.len(), 0, MAX_ISLANDS);
        } else if violations.count_of_points(at, total, 0, limits.curve_points) {
            check(&at.field("boundary"), &boundary, violations);
            for (k, island) in islands.iter().enumerate() {
                check(&at.field("islands").index(k), island, violations);
            }
        }
        core::Outlines {
            boundary: elements(&boundary),
            islands: islands.iter().map(|island| elements(island)).collect(),
        }
    }
}

fn check(at: &Pointer, outline: &[Vertex], violations: &mut Violations) {
    violations.count_of_points(at, outline.len(), 2, usize::MAX);
    for (k, vertex) in outline.iter().enumerate() {
        for (axis, value) in vertex.at.into_iter().enumerate() {
            violations.number(&at.index(k).index(axis), value, Range::COORDINATE, "mm");
        }
        violations.optional(&at.index(k).index(2), vertex.bulge, BULGE, "");
    }
}

/// The lines and arcs between the vertices; vertices that repeat the one before are left out.
fn elements(outline: &[Vertex]) -> Vec<Segment> {
    let next = outline.iter().cycle().skip(1);
    let element = |(from, to): (&Vertex, &Vertex)| {
        let [start, end] = [from, to].map(|vertex| Point2::from(vertex.at));
        Segment::bulging(start, end, -from.bulge.unwrap_or_default())
    };
    outline.iter().zip(next).map(element).filter(|element| element.start() != element.end()).collect()
}

impl<'de> Deserialize<'de> for Vertex {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(TwoOrThree)
    }
}

struct TwoOrThree;

impl<'de> Visitor<'de> for TwoOrThree {
    type Value = Vertex;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a vertex [x, y] or [x, y, bulge]")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Vertex, A::Error> {
        let mut at = [0.0; 2];
        for (k, coordinate) in at.iter_mut().enumerate() {
            *coordinate = seq.next_element()?.ok_or_else(|| A::Error::invalid_length(k, &self))?;
        }
        let bulge = seq.next_element()?;
        match bulge.and(seq.next_element::<IgnoredAny>()?) {
            None => Ok(Vertex { at, bulge }),
            Some(_) => Err(A::Error::invalid_length(4, &self)),
        }
    }
}

impl PartialSchema for Vertex {
    fn schema() -> RefOr<Schema> {
        let description = "A vertex of an outline: `[x, y]` in mm, or `[x, y, bulge]`. The bulge belongs to the element from this \
             vertex to the next: the tangent of a quarter of the arc's angle, positive where the arc turns to the left, 0 for a line, 1 \
             for a half circle to the left (as in DXF).";
        array_of(number(Range::COORDINATE), 2, 3).description(Some(description)).into()
    }
}

impl ToSchema for Vertex {}
