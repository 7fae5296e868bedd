//! Section curves: the language in which sections of dies are written, and its geometry.
//!
//! Items, separated by white space, follow each other along the curve; numbers are mm.
//!
//! | item | what it is |
//! |---|---|
//! | `l(x,y)`, `l(x,y,z)` | a point that straight lines lead to and from |
//! | `r(x,y,R)`, `r(x,y,z,R)` | a corner, rounded by an arc of radius R that touches both of its lines; 0 leaves it sharp |
//! | `b((x,y),(x,y),...)`, `b((x,y,z),...)` | a smooth curve through points |
//!
//! # Method
//! 1. The text becomes items (`grammar`), all in the plane or all in space.
//! 2. Every rounded corner becomes an arc (`corner`): its lines lead to its neighbours, of a `b` to the end
//!    that is nearer along the curve.
//! 3. Straight lines join what is left (`chain`). A `b` is the C2 cubic with uniform parameters and natural
//!    ends.
//!
//! # Guarantees
//! Arcs are exact: rational quadratics of a quarter turn at most. The parameter of lines and arcs is in
//! proportion to the length, and grows by it; along a `b` it grows by the sum of the chords, equally from
//! point to point.
//!
//! # Degenerate input
//! Neighbouring points that coincide, corners that do not fit between their neighbours, and rounded reversals
//! are errors that tell their place. A corner without a turn is a point of its line.
//!
//! # Cost
//! O(n) in the length of the text.
//!
//! # Differences from the paper
//! The paper prints neither parameters nor ends of the smooth curve, and `b(x1,y1),(x2,y2)` without outer
//! parentheses.
//!
//! # Reference
//! Y. H. Koo, D. J. Lee, S. Namgung, M. S. Kang, "A Study on the Construction of CAD/CAM System for Machining
//! of Sculptured Surface of Die", 1989, section 3.2.

mod chain;
mod corner;
mod grammar;

pub use chain::{Chain, Item, Segment};

use crate::geometry::plane_curve::piecewise::{BezierError, PiecewiseError};
pub use crate::geometry::profile::Shape;

/// The largest coordinate and radius, mm: a kilometre, as for every other coordinate.
pub const LARGEST_NUMBER: f64 = 1e6;

/// Points this close coincide, mm: the rounding of the largest coordinates, and far below anything made.
pub const NEAREST_MM: f64 = 1e-9;

/// The most points of a curve: each makes a piece or two, and a sweep multiplies the pieces of two curves.
pub const POINT_LIMIT: usize = 100_000;

/// The longest text, bytes: as many points of three numbers in full precision.
pub const TEXT_LIMIT: usize = 80 * POINT_LIMIT;

/// Why a text is no section curve, and where.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{fault} (at byte {at})")]
pub struct SectionCurveError {
    /// Bytes of the text before the place.
    pub at: usize,
    pub fault: Fault,
}

#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Fault {
    #[error("the text is longer than {TEXT_LIMIT} bytes")]
    TextTooLong,
    #[error("the curve has more than {POINT_LIMIT} points")]
    TooManyPoints,
    #[error("expected {expected}")]
    Syntax { expected: &'static str },
    #[error("the number is beyond {LARGEST_NUMBER} mm")]
    NumberTooLarge,
    #[error(
        "the point has {found} numbers; a point has 2 or 3 coordinates, and a rounded corner a radius after them"
    )]
    NumberCount { found: usize },
    #[error("the point has {found} coordinates; the points before it have {expected}")]
    Dimension { expected: usize, found: usize },
    #[error("the curve has only one point; at least 2 are needed")]
    OnePoint,
    #[error("a smooth curve needs at least 2 points")]
    OneSmoothPoint,
    #[error("a curve cannot start or end with a rounded corner; leave out the radius")]
    CornerAtEnd,
    #[error("the radius {radius_mm} mm is negative")]
    NegativeRadius { radius_mm: f64 },
    #[error("the point coincides with the point before it; leave one of them out")]
    Coincident,
    #[error("the curve turns back on itself, so no arc of radius {radius_mm} mm touches both lines")]
    Reversal { radius_mm: f64 },
    #[error(
        "the radius {radius_mm} mm does not fit; the rounded corners of the line need {taken_mm} mm of its {length_mm} mm"
    )]
    CornerDoesNotFit { radius_mm: f64, taken_mm: f64, length_mm: f64 },
    /// Parameters that do not rise, when curves a thousand times longer than any part have points a
    /// micrometre apart.
    #[error("{0}")]
    Chain(PiecewiseError),
    #[error("{0}")]
    Piece(BezierError),
}

/// A section curve, in the plane or in space.
#[derive(Debug, Clone, PartialEq)]
pub enum SectionCurve {
    Plane(Chain<2>),
    Space(Chain<3>),
}

impl SectionCurve {
    /// Reads a curve.
    ///
    /// # Errors
    /// The first place that breaks the language, or else the first item that cannot be.
    pub fn parse(text: &str) -> Result<Self, SectionCurveError> {
        let items = grammar::items(text)?;
        // The first item decides: its numbers tell the dimension as it is no rounded corner.
        let is_space = items.first().and_then(|item| item.rows.first()).is_some_and(|row| row.count == 3);
        Ok(if is_space { Self::Space(Chain::new(&items)?) } else { Self::Plane(Chain::new(&items)?) })
    }
}

#[cfg(test)]
mod tests;
