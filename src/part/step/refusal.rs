//! Why a shape is not read: the file is broken, or the shape is of a kind that the reader leaves out.

use toolpathd_core::budget::Stopped;

use crate::fault::Unreadable;

/// Why a shape is not read.
#[derive(Debug, Clone, PartialEq)]
pub enum Refusal {
    /// The whole file is refused.
    File(Unreadable),
    /// The shape is left out.
    Shape(Omission),
}

/// A shape that is left out.
#[derive(Debug, Clone, PartialEq)]
pub struct Omission {
    /// The name of the entity.
    pub kind: String,
    /// Why, as a clause.
    pub reason: String,
    /// The number of the instance.
    pub entity: u64,
}

impl Refusal {
    pub fn shape(kind: &str, reason: impl Into<String>, entity: u64) -> Self {
        Self::Shape(Omission { kind: kind.to_owned(), reason: reason.into(), entity })
    }
}

impl From<Unreadable> for Refusal {
    fn from(unreadable: Unreadable) -> Self {
        Self::File(unreadable)
    }
}

impl From<Stopped> for Refusal {
    fn from(stopped: Stopped) -> Self {
        Self::File(Unreadable::Stopped(stopped))
    }
}
