//! The entities of a DXF file, as curves, placed blocks, and what is left out.

use std::collections::HashSet;
use std::rc::Rc;

use super::fields::{Fields, Normal};
use super::names::{decoded, key};
use super::polyline;
use super::reasons;
use super::shape::{Content, Insert, Shape, is_flat, magnitude};
use super::spline;
use crate::fault::{Place, Unreadable};

/// An entity that may be drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Entity {
    pub kind: Rc<str>,
    pub layer: Rc<str>,
    pub place: Place,
    pub is_on_paper: bool,
    pub is_invisible: bool,
    pub content: Content,
    /// How many entities it stands for: more than one only for those that are left out alike.
    pub count: usize,
}

/// Names of kinds and layers, each kept once.
#[derive(Debug, Default)]
pub struct SharedNames(HashSet<Rc<str>>);

impl SharedNames {
    fn share(&mut self, name: &str) -> Rc<str> {
        if let Some(shared) = self.0.get(name) {
            return shared.clone();
        }
        let shared: Rc<str> = name.into();
        self.0.insert(shared.clone());
        shared
    }
}

/// Reads an entity that consists of its own groups alone.
///
/// # Errors
/// When a group is broken or absent.
pub fn read(fields: &Fields, names: &mut SharedNames) -> Result<Entity, Unreadable> {
    let content = match fields.kind {
        b"LINE" => line(fields)?,
        b"CIRCLE" => circle(fields)?,
        b"ARC" => arc(fields)?,
        b"ELLIPSE" => ellipse(fields)?,
        b"LWPOLYLINE" => polyline::light(fields)?,
        b"SPLINE" => spline::read(fields)?,
        b"INSERT" => insert(fields)?,
        other => Content::LeftOut(reasons::of_kind(other)),
    };
    with_content(fields, content, names)
}

/// An entity with the properties that all kinds have in common.
///
/// # Errors
/// When a group is broken.
pub fn with_content(
    fields: &Fields,
    content: Content,
    names: &mut SharedNames,
) -> Result<Entity, Unreadable> {
    let layer = decoded(fields.text(8));
    let is_on_paper = fields.integer(67)? == 1;
    let is_invisible = fields.integer(60)? == 1;
    let content = match (is_on_paper, is_invisible) {
        (true, _) => Content::LeftOut(reasons::ON_PAPER),
        (_, true) => Content::LeftOut(reasons::INVISIBLE),
        _ => content,
    };
    Ok(Entity {
        kind: names.share(&decoded(fields.kind)),
        layer: names.share(if layer.is_empty() { "0" } else { &layer }),
        place: fields.place(),
        is_on_paper,
        is_invisible,
        content,
        count: 1,
    })
}

fn line(fields: &Fields) -> Result<Content, Unreadable> {
    let ends = [fields.point(10)?, fields.point(11)?];
    let heights = [fields.real(30)?, fields.real(31)?].map(Option::unwrap_or_default);
    Ok(if is_flat(heights.into_iter(), magnitude(ends.into_iter())) {
        Content::Curve(Shape::Line(ends))
    } else {
        Content::LeftOut(reasons::NOT_FLAT)
    })
}

/// The circle of a CIRCLE or an ARC.
struct Round {
    center: [f64; 2],
    radius: f64,
    is_mirrored: bool,
}

/// The circle, or why it is none.
fn round(fields: &Fields) -> Result<Result<Round, &'static str>, Unreadable> {
    let (center, radius) = (fields.point(10)?, fields.need(40)?);
    let normal = fields.normal()?;
    Ok(match normal.placement() {
        None => Err(reasons::TILTED),
        Some(_) if radius <= 0.0 => Err(reasons::NO_RADIUS),
        Some(placement) => {
            Ok(Round { center: placement.point(center), radius, is_mirrored: normal == Normal::Down })
        }
    })
}

fn circle(fields: &Fields) -> Result<Content, Unreadable> {
    Ok(match round(fields)? {
        Ok(Round { center, radius, is_mirrored }) => {
            Content::Curve(Shape::Circle { center, radius, is_mirrored })
        }
        Err(reason) => Content::LeftOut(reason),
    })
}

fn arc(fields: &Fields) -> Result<Content, Unreadable> {
    let [start, end] = [fields.need(50)?, fields.need(51)?];
    Ok(match round(fields)? {
        Ok(Round { center, radius, is_mirrored }) => {
            Content::Curve(Shape::Arc { center, radius, start, end, is_mirrored })
        }
        Err(reason) => Content::LeftOut(reason),
    })
}

fn ellipse(fields: &Fields) -> Result<Content, Unreadable> {
    let (center, major) = (fields.point(10)?, fields.point(11)?);
    let ratio = fields.need(40)?;
    let start = fields.real(41)?.unwrap_or(0.0);
    let end = fields.real(42)?.unwrap_or(std::f64::consts::TAU);
    let rise = fields.real(31)?.unwrap_or(0.0);
    let normal = fields.normal()?;
    let side = if normal == Normal::Down { -ratio } else { ratio };
    let minor = [-major[1] * side, major[0] * side];
    Ok(if normal == Normal::Sideways || !is_flat([0.0, rise].into_iter(), magnitude([major].into_iter())) {
        Content::LeftOut(reasons::TILTED)
    } else if major == [0.0, 0.0] || ratio == 0.0 {
        Content::LeftOut(reasons::NO_RADIUS)
    } else {
        Content::Curve(Shape::Ellipse { center, major, minor, start, end })
    })
}

fn insert(fields: &Fields) -> Result<Content, Unreadable> {
    let normal = fields.normal()?;
    if normal == Normal::Sideways {
        return Ok(Content::LeftOut(reasons::TILTED));
    }
    let scale = [fields.real(41)?.unwrap_or(1.0), fields.real(42)?.unwrap_or(1.0)];
    if scale.contains(&0.0) {
        return Ok(Content::LeftOut(reasons::NO_SCALE));
    }
    let count = |code: i32| -> Result<u32, Unreadable> {
        let count = fields.integer(code)?.max(1);
        let large = || Unreadable::at(fields.place(), format!("{count} copies of a block are too many"));
        u32::try_from(count).map_err(|_| large())
    };
    Ok(Content::Insert(Box::new(Insert {
        block: key(&decoded(fields.text(2))),
        at: fields.point(10)?,
        scale,
        degrees: fields.real(50)?.unwrap_or(0.0),
        counts: [count(70)?, count(71)?],
        distances: [fields.real(44)?.unwrap_or(0.0), fields.real(45)?.unwrap_or(0.0)],
        is_mirrored: normal == Normal::Down,
    })))
}
