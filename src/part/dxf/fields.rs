//! The groups of one entity, by their codes.

use super::groups::{Group, Groups};
use super::placement::Placement;
use crate::fault::{Place, Unreadable};

/// The first code of extended data, which belongs to applications.
const EXTENDED: i32 = 1000;

/// The largest part of a normal that may point sideways. The value is far above the rounding of normals in
/// files. An entity as tilted as this is shortened by less than a part in 1e17.
const TILT: f64 = 1e-9;

/// An entity as the file has it.
#[derive(Debug, Clone, Default)]
pub struct Fields<'a> {
    pub kind: &'a [u8],
    pub place: Option<Place>,
    pub groups: Vec<Group<'a>>,
}

/// Where the normal of an entity points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Normal {
    Up,
    Down,
    Sideways,
}

impl<'a> Fields<'a> {
    /// Reads the groups up to the next entity, and returns the group that starts it. `start` is the group
    /// with the kind. Extended data, and the groups of applications between braces, are skipped.
    ///
    /// # Errors
    /// When the file ends, or a group is broken.
    pub fn read(&mut self, start: Group<'a>, groups: &mut Groups<'a>) -> Result<Group<'a>, Unreadable> {
        self.kind = start.text();
        self.place = Some(start.place);
        self.groups.clear();
        let mut is_between_braces = false;
        loop {
            let Some(group) = groups.next()? else {
                return Err(Unreadable::at(groups.place(), "the file ends within a section"));
            };
            match group.code {
                0 => return Ok(group),
                102 => is_between_braces = group.text().starts_with(b"{"),
                code if code < EXTENDED && !is_between_braces => self.groups.push(group),
                _ => {}
            }
        }
    }

    pub fn place(&self) -> Place {
        self.place.unwrap_or(Place::File)
    }

    pub fn text(&self, code: i32) -> &'a [u8] {
        self.find(code).map_or(b"", |group| group.text())
    }

    /// # Errors
    /// When the group is no number.
    pub fn real(&self, code: i32) -> Result<Option<f64>, Unreadable> {
        self.find(code).map(|group| group.real()).transpose()
    }

    /// # Errors
    /// When the group is no number, or absent.
    pub fn need(&self, code: i32) -> Result<f64, Unreadable> {
        self.real(code)?.ok_or_else(|| {
            let kind = String::from_utf8_lossy(self.kind);
            Unreadable::at(self.place(), format!("this {kind} lacks the group {code}"))
        })
    }

    /// A whole number; 0 if it is absent.
    ///
    /// # Errors
    /// When the group is no whole number.
    pub fn integer(&self, code: i32) -> Result<i64, Unreadable> {
        self.find(code).map_or(Ok(0), |group| group.integer())
    }

    /// x and y of a point.
    ///
    /// # Errors
    /// As [`Fields::need`].
    pub fn point(&self, code: i32) -> Result<[f64; 2], Unreadable> {
        Ok([self.need(code)?, self.need(code + 10)?])
    }

    /// # Errors
    /// When a group is no number.
    pub fn normal(&self) -> Result<Normal, Unreadable> {
        let x = self.real(210)?.unwrap_or(0.0);
        let y = self.real(220)?.unwrap_or(0.0);
        let z = self.real(230)?.unwrap_or(1.0);
        Ok(if x.abs().max(y.abs()) > TILT * z.abs() || z == 0.0 {
            Normal::Sideways
        } else if z > 0.0 {
            Normal::Up
        } else {
            Normal::Down
        })
    }

    fn find(&self, code: i32) -> Option<&Group<'a>> {
        self.groups.iter().find(|group| group.code == code)
    }
}

impl Normal {
    /// The map from the entity's own plane to the drawing; `None` if the two are not parallel.
    pub fn placement(self) -> Option<Placement> {
        match self {
            Self::Up => Some(Placement::scaled(1.0)),
            Self::Down => Some(Placement::seen_from_below()),
            Self::Sideways => None,
        }
    }
}
