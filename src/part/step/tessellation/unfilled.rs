//! Why a face is not filled with triangles.

use toolpathd_core::budget::Stopped;

/// Why a face is not filled.
#[derive(Debug, Clone, PartialEq)]
pub enum Unfilled {
    /// Sides of polygons cross: pairs of a loop and a corner.
    Crossed(Vec<[usize; 2]>),
    /// Why, as a clause.
    Failed(&'static str),
    TooMany,
    Stopped(Stopped),
}

impl From<Stopped> for Unfilled {
    fn from(stopped: Stopped) -> Self {
        Self::Stopped(stopped)
    }
}
