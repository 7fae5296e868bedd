//! What is told of the outlines of level faces.

use serde::Serialize;
use utoipa::ToSchema;

use crate::http::dto::inspection::LoopVertex;
use crate::http::dto::outline::OpenEdges;
use toolpathd_part::step::outline::{Outline, OutlineLoop, Walled};

/// The outline of level faces of one body that hang together by edges.
#[derive(Serialize, ToSchema)]
pub struct OutlineReport {
    /// The numbers of its faces, counted from 0.
    faces: Vec<usize>,
    /// `pocket`: walls go up all along `vertices`. `open`: from some of the edges only. `top`: from none.
    /// Present where `is_up` is true.
    #[serde(skip_serializing_if = "Option::is_none")]
    kind: Option<OutlineKind>,
    /// The vertices of the outer loop, counterclockwise, as `boundary` of a region takes them: `[x, y]` or
    /// `[x, y, bulge]`, in mm.
    #[schema(value_type = Vec<Vec<f64>>)]
    vertices: Vec<LoopVertex>,
    /// The edges from which no wall goes up, by the numbers of their vertices, as `open` of a region takes
    /// them. Present with `open` and `top`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<OpenEdges>)]
    open: Option<OpenReport>,
    /// The height at which all walls along `vertices` end, in mm. Absent without walls, and where the walls
    /// end at several heights or slope.
    #[serde(skip_serializing_if = "Option::is_none")]
    top_z_mm: Option<f64>,
    /// The loops inside `vertices`.
    inner: Vec<InnerReport>,
    /// The area of its faces, in mm2: inside `vertices` and outside the loops in `inner`.
    area_mm2: f64,
    /// How far lines and arcs may be from the edges in their place, in mm.
    deviation_max_mm: f64,
    /// Whether a level face of the body looks down on it, or a wall leans over it, so that no tool reaches
    /// all of it from above. Present where `is_up` is true.
    #[serde(skip_serializing_if = "Option::is_none")]
    is_covered: Option<bool>,
}

/// A loop inside an outline.
#[derive(Serialize, ToSchema)]
struct InnerReport {
    /// `island`: walls go up all along it. `opening`: from none of its edges, as at a hole or at a deeper
    /// pocket, and nothing stands higher inside. `mixed`: from some, or something stands higher inside.
    /// Present where `is_up` is true.
    #[serde(skip_serializing_if = "Option::is_none")]
    kind: Option<InnerKind>,
    /// Its vertices, counterclockwise, as an element of `islands` of a region takes them, in mm.
    #[schema(value_type = Vec<Vec<f64>>)]
    vertices: Vec<LoopVertex>,
    /// The height at which all of its walls end, in mm. Absent without walls, and where the walls end at
    /// several heights or slope.
    #[serde(skip_serializing_if = "Option::is_none")]
    top_z_mm: Option<f64>,
    /// The area inside, in mm2.
    area_mm2: f64,
}

/// From which edges of an outline walls go up.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
enum OutlineKind {
    Pocket,
    Open,
    Top,
}

/// What is inside an inner loop.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
enum InnerKind {
    Island,
    Opening,
    Mixed,
}

/// Edges without walls: the word for all, or stretches from a vertex on to another.
#[derive(Serialize)]
#[serde(untagged)]
enum OpenReport {
    All(&'static str),
    Ranges(Vec<[usize; 2]>),
}

impl OutlineReport {
    /// An outline, with `mm` millimetres in its unit of length.
    pub fn new(outline: &Outline, is_up: bool, mm: f64) -> Self {
        let Outline { faces, outer, inner, area_mm2, deviation_max_mm, is_covered } = outline;
        let kind = match outer.walled() {
            Walled::All => OutlineKind::Pocket,
            Walled::Some => OutlineKind::Open,
            Walled::None => OutlineKind::Top,
        };
        let open = match outer.walled() {
            Walled::All => None,
            Walled::Some => Some(OpenReport::Ranges(outer.open())),
            Walled::None => Some(OpenReport::All("all")),
        };
        Self {
            faces: faces.clone(),
            kind: is_up.then_some(kind),
            vertices: vertices(outer, mm),
            open: open.filter(|_| is_up),
            top_z_mm: outer.top_mm.map(|top| top * mm),
            inner: inner.iter().map(|ring| InnerReport::new(ring, is_up, mm)).collect(),
            area_mm2: area_mm2 * mm * mm,
            deviation_max_mm: deviation_max_mm * mm,
            is_covered: is_up.then_some(*is_covered),
        }
    }
}

impl InnerReport {
    fn new(ring: &OutlineLoop, is_up: bool, mm: f64) -> Self {
        let kind = match ring.walled() {
            Walled::All => InnerKind::Island,
            Walled::Some => InnerKind::Mixed,
            Walled::None if ring.holds_higher => InnerKind::Mixed,
            Walled::None => InnerKind::Opening,
        };
        Self {
            kind: is_up.then_some(kind),
            vertices: vertices(ring, mm),
            top_z_mm: ring.top_mm.map(|top| top * mm),
            area_mm2: ring.area_mm2 * mm * mm,
        }
    }
}

fn vertices(ring: &OutlineLoop, mm: f64) -> Vec<LoopVertex> {
    ring.vertices.iter().map(|[x, y, bulge]| LoopVertex::from(&[x * mm, y * mm, *bulge])).collect()
}
