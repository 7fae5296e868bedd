//! Polylines in DXF: LWPOLYLINE with its vertices among its groups, and POLYLINE with VERTEX entities.

use super::fields::Fields;
use super::groups::Group;
use super::reasons;
use super::shape::{Content, Shape, is_flat, magnitude};
use crate::fault::Unreadable;

/// Bits of POLYLINE's flags.
const CLOSED: i64 = 1;
const IN_SPACE: i64 = 8;
const MESHES: i64 = 16 | 64;

/// The bit of a VERTEX that controls a fitted curve and is not on it.
const CONTROL_FRAME: i64 = 16;

/// Reads an LWPOLYLINE. A vertex without a bulge starts a line.
///
/// # Errors
/// When a group is broken, or there are fewer vertices than the entity states.
pub fn light(fields: &Fields) -> Result<Content, Unreadable> {
    let mut vertices: Vec<[f64; 3]> = Vec::new();
    let mut lacks_y = None;
    for group in &fields.groups {
        match group.code {
            10 => {
                if lacks_y.is_some() {
                    break;
                }
                vertices.push([group.real()?, 0.0, 0.0]);
                lacks_y = Some(group.place);
            }
            20 | 42 => {
                let Some(vertex) = vertices.last_mut() else { return Err(without_vertex(group)) };
                let k = if group.code == 20 { 1 } else { 2 };
                vertex[k] = group.real()?;
                if group.code == 20 {
                    lacks_y = None;
                }
            }
            _ => {}
        }
    }
    if let Some(place) = lacks_y {
        return Err(Unreadable::at(place, "a vertex has no y"));
    }
    let stated = fields.integer(90)?;
    if stated > vertices.len() as i64 {
        let detail = format!("a polyline of {stated} vertices has only {}", vertices.len());
        return Err(Unreadable::at(fields.place(), detail));
    }
    let is_closed = fields.integer(70)? & CLOSED != 0;
    placed(fields, vertices, is_closed)
}

fn without_vertex(group: &Group) -> Unreadable {
    Unreadable::at(group.place, format!("the group {} has no vertex before it", group.code))
}

/// A POLYLINE, whose vertices follow it.
#[derive(Debug, Clone)]
pub struct Polyline {
    flags: i64,
    vertices: Vec<[f64; 3]>,
    heights: Vec<f64>,
}

impl Polyline {
    /// # Errors
    /// When a group is broken.
    pub fn new(fields: &Fields) -> Result<Self, Unreadable> {
        Ok(Self { flags: fields.integer(70)?, vertices: Vec::new(), heights: Vec::new() })
    }

    /// Adds a VERTEX.
    ///
    /// # Errors
    /// When a group is broken.
    pub fn push(&mut self, vertex: &Fields) -> Result<(), Unreadable> {
        if self.flags & MESHES != 0 || vertex.integer(70)? & CONTROL_FRAME != 0 {
            return Ok(());
        }
        let [x, y] = vertex.point(10)?;
        let bulge = if self.flags & IN_SPACE == 0 { vertex.real(42)?.unwrap_or(0.0) } else { 0.0 };
        self.vertices.push([x, y, bulge]);
        self.heights.push(vertex.real(30)?.unwrap_or(0.0));
        Ok(())
    }

    /// The curve; `fields` are those of the POLYLINE.
    ///
    /// # Errors
    /// When a group is broken.
    pub fn content(self, fields: &Fields) -> Result<Content, Unreadable> {
        if self.flags & MESHES != 0 {
            return Ok(Content::LeftOut(reasons::MESH));
        }
        let is_closed = self.flags & CLOSED != 0;
        if self.flags & IN_SPACE == 0 {
            return placed(fields, self.vertices, is_closed);
        }
        let largest = magnitude(self.vertices.iter().map(|[x, y, _]| [*x, *y]));
        Ok(if is_flat(self.heights.into_iter(), largest) {
            Content::Curve(Shape::Polyline { vertices: self.vertices, is_closed })
        } else {
            Content::LeftOut(reasons::NOT_FLAT)
        })
    }
}

/// The polyline in the plane of the drawing.
fn placed(fields: &Fields, mut vertices: Vec<[f64; 3]>, is_closed: bool) -> Result<Content, Unreadable> {
    let Some(placement) = fields.normal()?.placement() else {
        return Ok(Content::LeftOut(reasons::TILTED));
    };
    if placement.is_mirrored() {
        for vertex in &mut vertices {
            *vertex = [-vertex[0], vertex[1], -vertex[2]];
        }
    }
    Ok(Content::Curve(Shape::Polyline { vertices, is_closed }))
}
