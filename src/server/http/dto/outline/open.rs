//! Open edges of a wall in requests.

use std::fmt;

use serde::de::value::SeqAccessDeserializer;
use serde::de::{Error, SeqAccess, Unexpected, Visitor};
use serde::{Deserialize, Deserializer};
use utoipa::openapi::RefOr;
use utoipa::openapi::schema::{ObjectBuilder, OneOfBuilder, Schema, Type};
use utoipa::{PartialSchema, ToSchema};

use crate::config::Limits;
use crate::http::dto::check::Violations;
use crate::http::dto::schema::array_of;
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;
use toolpathd_core::geometry::segment::Segment;

/// The word for all edges.
const ALL: &str = "all";

/// The most ranges of edges.
const MOST_RANGES: usize = 1_000;

/// Which edges of a wall are open.
#[derive(Debug)]
pub enum OpenEdges {
    All,
    /// From one vertex on to another, in the order in which the vertices were sent.
    Ranges(Vec<[usize; 2]>),
}

impl OpenEdges {
    /// The open ones of the edges of a wall, of which each follows the vertex with its own index.
    pub fn of(&self, edges: &[Segment], at: &Pointer, violations: &mut Violations) -> Vec<Segment> {
        let ranges = match self {
            Self::All => return edges.to_vec(),
            Self::Ranges(ranges) => ranges,
        };
        let count = edges.len();
        if ranges.len() > MOST_RANGES {
            let detail = format!("there are {} ranges of edges; send at most {MOST_RANGES}", ranges.len());
            violations.add(at, FieldCode::LimitExceeded, detail);
            return Vec::new();
        }
        let mut are_open = vec![false; count];
        for (k, [from, to]) in ranges.iter().enumerate() {
            let place = at.index(k);
            for (side, index) in [from, to].into_iter().enumerate().filter(|(_, index)| **index >= count) {
                let detail = format!("the boundary has no vertex {index}: its last is {}", count.max(1) - 1);
                violations.add(&place.index(side), FieldCode::OutOfRange, detail);
            }
            if *from >= count || *to >= count {
                continue;
            }
            if from == to {
                let detail = "no edge lies between a vertex and itself; send `\"all\"` for all edges";
                violations.add(&place, FieldCode::Conflict, detail);
            }
            if from < to {
                are_open[*from..*to].fill(true);
            } else {
                are_open[*from..].fill(true);
                are_open[..*to].fill(true);
            }
        }
        edges.iter().zip(are_open).filter(|(_, is_open)| *is_open).map(|(edge, _)| *edge).collect()
    }
}

impl<'de> Deserialize<'de> for OpenEdges {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(AllOrRanges)
    }
}

struct AllOrRanges;

impl<'de> Visitor<'de> for AllOrRanges {
    type Value = OpenEdges;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("\"all\" or ranges [i, j] of vertices")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<OpenEdges, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(seq)).map(OpenEdges::Ranges)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<OpenEdges, E> {
        if text == ALL { Ok(OpenEdges::All) } else { Err(E::invalid_value(Unexpected::Str(text), &self)) }
    }
}

impl PartialSchema for OpenEdges {
    fn schema() -> RefOr<Schema> {
        let index = ObjectBuilder::new()
            .schema_type(Type::Integer)
            .minimum(Some(0))
            .maximum(Some(Limits::DEFAULT.curve_points));
        let ranges = array_of(array_of(index, 2, 2), 0, MOST_RANGES);
        let all = ObjectBuilder::new().schema_type(Type::String).enum_values(Some([ALL]));
        let description = "Open edges of a wall: `[[i, j], ...]` for the edges from vertex `i` on to vertex `j`, counted from 0 in the \
             order of `boundary`, around its end where `j` is less than `i`; or `\"all\"`. In a text, each item but the first is the end \
             of an edge.";
        OneOfBuilder::new().item(ranges).item(all).description(Some(description)).into()
    }
}

impl ToSchema for OpenEdges {}
