//! Outlines in requests: closed chains of lines and arcs, as vertices or as a section curve.

mod file;
mod open;
mod vertex;
mod weld;

use std::fmt;

use serde::de::value::SeqAccessDeserializer;
use serde::de::{Error, IntoDeserializer, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use serde_json::value::RawValue;
use utoipa::openapi::schema::{ObjectBuilder, OneOfBuilder, Schema, Type};
use utoipa::openapi::{Ref, RefOr};
use utoipa::{PartialSchema, ToSchema};

use super::check::Violations;
use super::schema::{array_of, reference, schema_of};
use super::surface::{Room, SectionText};
use crate::config::Limits;
use crate::http::decode::files::FileReading;
use crate::http::decode::tagged;
use crate::http::error::FieldCode;
use crate::http::messages::Warning;
use crate::http::pointer::Pointer;
pub use file::{CURVE_TOLERANCE_MM, CURVE_TOLERANCES, GAP_MM, GAPS, RegionFile};
pub use open::OpenEdges;
use toolpathd_core::geometry::profile::Shape;
use toolpathd_core::geometry::segment::Segment;
use toolpathd_core::language::section_curve::TEXT_LIMIT;
use toolpathd_core::operations::pocketing as core;
pub use vertex::Vertex;
use weld::Corner;

/// The most regions of a request.
pub const MOST_REGIONS: usize = 1000;

/// The most islands of a pocket.
const MAX_ISLANDS: usize = 10_000;

/// A closed outline.
#[derive(Debug)]
pub enum Outline {
    Vertices(Vec<Vertex>),
    /// A section curve, which a straight line closes.
    Text(SectionText),
}

/// An area with walls and islands: its outlines, or the file that holds them.
#[derive(Debug)]
pub enum Region {
    Walled(WalledRegion),
    File(RegionFile),
}

/// A wall and the islands inside it.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = PocketRegion)]
pub struct WalledRegion {
    /// The wall: a closed outline, in mm, in either direction. The last vertex is joined to the first.
    boundary: Outline,
    /// Outlines of what stays, in mm. Islands may overlap each other and the wall. Default: none.
    #[schema(value_type = Option<Islands>)]
    islands: Option<Vec<Outline>>,
    /// The edges of `boundary` beyond which there is neither part nor material, by the numbers of their
    /// vertices: the cutter comes in over them from outside, and goes out by its radius and more. For pockets
    /// only. Default: none.
    open: Option<OpenEdges>,
}

schema_of!(Islands of Outline, "Closed outlines.", { array_of(reference::<Outline>(), 0, MAX_ISLANDS) });

impl Region {
    /// Puts the outlines that a file holds in the place of the reference to the file.
    pub fn read_file(&mut self, at: &Pointer, reading: &mut FileReading) {
        if let Self::File(file) = self
            && let Some(region) = file.region(at, reading)
        {
            reading.moved(at.clone(), at.clone(), Some(file.file_name()));
            *self = Self::Walled(region);
        }
    }

    /// As [`Self::read_file`] for a list: a file may hold several regions.
    pub fn read_files(all: &mut Vec<Self>, at: &Pointer, reading: &mut FileReading) {
        if all.len() > MOST_REGIONS || !all.iter().any(|region| matches!(region, Self::File(_))) {
            return;
        }
        let mut read = Vec::with_capacity(all.len());
        let mut n_vertices = 0;
        for (k, region) in std::mem::take(all).into_iter().enumerate() {
            let (sent, first) = (at.index(k), read.len());
            let file = match region {
                Self::Walled(region) => {
                    read.push(region);
                    None
                }
                Self::File(file) => {
                    read.extend(file.regions(&sent, reading).unwrap_or_default());
                    Some(file)
                }
            };
            let name = file.as_ref().map(RegionFile::file_name);
            (first..read.len()).for_each(|judged| reading.moved(at.index(judged), sent.clone(), name));
            n_vertices += read[first..].iter().map(WalledRegion::n_vertices).sum::<usize>();
            if !reading.violations.count_of_points(&sent, n_vertices, 0, reading.limits.curve_points) {
                break;
            }
        }
        *all = read.into_iter().map(Self::Walled).collect();
    }

    /// The number of all vertices, or of pieces of texts.
    pub fn n_vertices(&self) -> usize {
        match self {
            Self::Walled(region) => region.n_vertices(),
            Self::File(_) => 0,
        }
    }

    /// As [`WalledRegion::convert`].
    pub fn convert(self, at: &Pointer, limits: &Limits, violations: &mut Violations) -> core::Outlines {
        self.walled(at, violations).convert(at, limits, violations)
    }

    /// As [`WalledRegion::convert_with_open`].
    pub fn convert_with_open(
        self,
        at: &Pointer,
        limits: &Limits,
        violations: &mut Violations,
    ) -> (core::Outlines, Vec<Segment>) {
        self.walled(at, violations).convert_with_open(at, limits, violations)
    }

    /// As [`WalledRegion::remark`].
    pub fn remark(&self, at: &Pointer) -> Option<Warning> {
        match self {
            Self::Walled(region) => region.remark(at),
            Self::File(_) => None,
        }
    }

    /// The outlines; none, with a violation, where a file was not read.
    fn walled(self, at: &Pointer, violations: &mut Violations) -> WalledRegion {
        match self {
            Self::Walled(region) => region,
            Self::File(_) => {
                violations.add(at, FieldCode::Unsupported, "no file is read here: send the outlines");
                WalledRegion::new(Outline::Vertices(Vec::new()), None)
            }
        }
    }
}

impl<'de> Deserialize<'de> for Region {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let object = <&RawValue>::deserialize(deserializer)?;
        match tagged::optional_kind_of::<D::Error>(object)?.as_deref() {
            Some("file") => tagged::decode(object).map(Self::File),
            Some(_) => Err(D::Error::custom("the kind is unknown")),
            None => tagged::decode(object).map(Self::Walled),
        }
    }
}

impl PartialSchema for Region {
    fn schema() -> RefOr<Schema> {
        let items = [WalledRegion::name(), RegionFile::name()].map(Ref::from_schema_name);
        let description = "An area with walls and islands: its outlines, or with `kind: file` a drawing that is sent with the request.";
        let one_of = items.into_iter().fold(OneOfBuilder::new(), OneOfBuilder::item);
        one_of.description(Some(description)).into()
    }
}

impl ToSchema for Region {
    fn schemas(schemas: &mut Vec<(String, RefOr<Schema>)>) {
        schemas.push((WalledRegion::name().into_owned(), WalledRegion::schema()));
        WalledRegion::schemas(schemas);
        let file = tagged::with_kind("file", RegionFile::schema());
        schemas.push((RegionFile::name().into_owned(), file));
        RegionFile::schemas(schemas);
    }
}

impl WalledRegion {
    pub fn new(boundary: Outline, islands: Option<Vec<Outline>>) -> Self {
        Self { boundary, islands, open: None }
    }

    /// The number of all vertices, or of pieces of texts.
    pub fn n_vertices(&self) -> usize {
        self.boundary.len() + self.islands.iter().flatten().map(Outline::len).sum::<usize>()
    }

    /// The outlines in the core's terms, of a region whose edges are all closed. Adds violations to
    /// `violations`.
    pub fn convert(self, at: &Pointer, limits: &Limits, violations: &mut Violations) -> core::Outlines {
        if self.open.is_some() {
            let detail = "only a pocket that is planned has open edges: leave `open` out, and send a `boundary` with room in front of them";
            violations.add(&at.field("open"), FieldCode::Unsupported, detail);
        }
        self.convert_with_open(at, limits, violations).0
    }

    /// The outlines in the core's terms, and the open edges. Adds violations to `violations`.
    pub fn convert_with_open(
        self,
        at: &Pointer,
        limits: &Limits,
        violations: &mut Violations,
    ) -> (core::Outlines, Vec<Segment>) {
        let Self { boundary, islands, open } = self;
        let islands = islands.unwrap_or_default();
        let total = boundary.len() + islands.iter().map(Outline::len).sum::<usize>();
        if islands.len() > MAX_ISLANDS {
            violations.count_of_points(&at.field("islands"), islands.len(), 0, MAX_ISLANDS);
        } else if violations.count_of_points(at, total, 0, limits.curve_points) {
            boundary.check(&at.field("boundary"), limits, violations);
            for (k, island) in islands.iter().enumerate() {
                island.check(&at.field("islands").index(k), limits, violations);
            }
        }
        let open = open.map(|open| open.of(&boundary.edges(), &at.field("open"), violations));
        let outlines = core::Outlines {
            boundary: boundary.elements(),
            islands: islands.iter().map(Outline::elements).collect(),
        };
        (outlines, open.unwrap_or_default())
    }

    /// The warning of bulges of more than a half circle. `at` is the place of the region.
    pub fn remark(&self, at: &Pointer) -> Option<Warning> {
        remark(at, &self.boundary, self.islands.as_deref().unwrap_or_default())
    }
}

/// The warning of bulges of more than a half circle in a wall and its islands. `at` is the place of the
/// object with both.
pub fn remark(at: &Pointer, boundary: &Outline, islands: &[Outline]) -> Option<Warning> {
    let of_islands = islands.iter().enumerate().map(|(k, island)| (Some(k), island));
    let outlines = std::iter::once((None, boundary)).chain(of_islands);
    let mut wide = outlines.flat_map(|(island, outline)| outline.wide_bulges().map(move |k| (island, k)));
    let (island, k) = wide.next()?;
    let outline = island.map_or_else(|| at.field("boundary"), |island| at.field("islands").index(island));
    Some(Warning::bulge_over_half_circle(&outline.index(k).index(2), 1 + wide.count()))
}

impl Outline {
    /// The number of its vertices, or of the pieces of its text.
    fn len(&self) -> usize {
        match self {
            Self::Vertices(vertices) => vertices.len(),
            Self::Text(text) => text.in_plane().pieces().len(),
        }
    }

    fn check(&self, at: &Pointer, limits: &Limits, violations: &mut Violations) {
        let vertices = match self {
            Self::Vertices(vertices) => vertices,
            Self::Text(text) => return check_text(text, at, limits, violations),
        };
        violations.count_of_points(at, vertices.len(), 2, usize::MAX);
        let Some(last) = vertices.len().checked_sub(1) else { return };
        for (k, vertex) in vertices.iter().enumerate() {
            let before = k.checked_sub(1).unwrap_or(last);
            vertex.check(&at.index(k), &vertices[before], &at.index(before), violations);
        }
    }

    /// The indices of the vertices with a bulge of more than a half circle.
    fn wide_bulges(&self) -> impl Iterator<Item = usize> {
        let vertices = match self {
            Self::Vertices(vertices) => vertices.as_slice(),
            Self::Text(_) => &[],
        };
        let wide = vertices.iter().enumerate().filter(|(_, vertex)| vertex.is_over_half_circle());
        wide.map(|(k, _)| k)
    }

    /// The lines and arcs between the vertices, without those that are rounding.
    fn elements(&self) -> Vec<Segment> {
        let vertices = match self {
            Self::Vertices(vertices) => vertices,
            Self::Text(text) => return elements_of(text),
        };
        weld::elements(&corners(vertices))
    }

    /// The lines and arcs between the vertices as they were sent: each after the vertex with its own index.
    fn edges(&self) -> Vec<Segment> {
        match self {
            Self::Vertices(vertices) => weld::edges(&corners(vertices)),
            Self::Text(text) => elements_of(text),
        }
    }
}

/// The vertices, each with the element to the next.
fn corners(vertices: &[Vertex]) -> Vec<Corner> {
    let next = vertices.iter().cycle().skip(1);
    vertices.iter().zip(next).map(|(from, to)| to.corner_after(from)).collect()
}

fn check_text(text: &SectionText, at: &Pointer, limits: &Limits, violations: &mut Violations) {
    text.check(at, Room::PlaneOnly, limits, violations);
    let curve = text.in_plane();
    if let Some(piece) = curve.pieces().iter().find(|piece| matches!(piece.shape, Shape::Cubic(_))) {
        let detail = "an outline is made of lines and arcs: write `l` and `r`, or send the smooth curve to `/v1/curves/interpolate` first";
        violations.add_in_text(at, piece.place, FieldCode::Unsupported, detail);
    }
}

/// The lines and arcs of a text that has been checked, and the line that closes them.
fn elements_of(text: &SectionText) -> Vec<Segment> {
    let curve = text.in_plane();
    let mut elements: Vec<Segment> = curve
        .pieces()
        .iter()
        .map(|piece| match piece.shape {
            Shape::Arc { points: [start, corner, end], weight } => {
                // The weight is the cosine of half of the arc's turn.
                let bulge = ((1.0 - weight) / (1.0 + weight)).sqrt();
                let turn = (corner - start).perp(&(end - corner));
                Segment::bulging(start, end, -bulge.copysign(turn))
            }
            shape => Segment::Line { start: shape.start(), end: shape.end() },
        })
        .collect();
    if let (Some(first), Some(last)) = (elements.first(), elements.last())
        && first.start() != last.end()
    {
        elements.push(Segment::Line { start: last.end(), end: first.start() });
    }
    elements
}

impl<'de> Deserialize<'de> for Outline {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(VerticesOrText)
    }
}

struct VerticesOrText;

impl<'de> Visitor<'de> for VerticesOrText {
    type Value = Outline;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("vertices or the text of a section curve")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Outline, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(seq)).map(Outline::Vertices)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Outline, E> {
        SectionText::deserialize(text.into_deserializer()).map(Outline::Text)
    }
}

impl PartialSchema for Outline {
    fn schema() -> RefOr<Schema> {
        let vertices = array_of(reference::<Vertex>(), 2, Limits::DEFAULT.curve_points);
        let text = ObjectBuilder::new()
            .schema_type(Type::String)
            .max_length(Some(TEXT_LIMIT))
            .examples([serde_json::json!("l(0,0) r(50,0,10) r(50,40,10) l(0,40)")]);
        let description = "A closed outline in mm: its vertices, or a section curve of items `l(x,y)` and `r(x,y,R)`, which a straight line \
             closes.";
        OneOfBuilder::new().item(vertices).item(text).description(Some(description)).into()
    }
}

impl ToSchema for Outline {
    fn schemas(schemas: &mut Vec<(String, RefOr<Schema>)>) {
        schemas.push((Vertex::name().into_owned(), Vertex::schema()));
        Vertex::schemas(schemas);
    }
}
