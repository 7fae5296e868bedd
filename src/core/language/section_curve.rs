//! Section curves: the language for cross-sections of dies, and the geometry of the curves that it describes.
//!
//! A text is a list of items, separated by white space, in their order along the curve. Numbers are mm.
//! Either all points of a text have two coordinates, or all have three.
//!
//! | item | what it is |
//! |---|---|
//! | `l(x,y)`, `l(x,y,z)` | a point; straight lines join it to the items before and after it |
//! | `r(x,y,R)`, `r(x,y,z,R)` | a corner, rounded by an arc of radius R between its two lines; R = 0: sharp |
//! | `b((x,y),(x,y),...)`, `b((x,y,z),...)` | a smooth curve through the points |
//! | `b(x,y), (x,y), ...`, `b(x,y,z), ...` | the same, as the paper prints it |
//!
//! # Method
//! 1. `grammar` turns the text into items.
//! 2. `corner` turns each rounded corner into an arc that touches both of its lines.
//! 3. `chain` joins the items by straight lines. Each `b` becomes a natural cubic spline of its own. The
//!    parameter of the spline grows by the same amount from point to point.
//!
//! # Guarantees
//! Arcs are exact, up to rounding, as rational quadratic curves.
//!
//! # Degenerate input
//! Each error names its place in the text. Neighbouring points that coincide are refused. A rounded corner is
//! refused if the arc does not fit on the lines beside it, or if the curve turns back on itself there.
//!
//! # Cost
//! O(n) in the length of the text.
//!
//! # Differences from the paper
//! The paper prints neither the parameters nor the end conditions of the smooth curve. Beside its
//! `b(x1,y1), (x2,y2)`, outer parentheses are allowed.
//!
//! # Reference
//! Y. H. Koo, D. J. Lee, S. Namgung, M. S. Kang, "A Study on the Construction of CAD/CAM System for Machining
//! of Sculptured Surface of Die", 1989, section 3.2.

mod chain;
mod corner;
mod grammar;

pub use chain::{Chain, ChainPiece, Item};

use crate::geometry::plane_curve::piecewise::{BezierError, PiecewiseError};
pub use crate::geometry::profile::Shape;

/// The largest coordinate and radius, mm: a kilometre, the same as for all other coordinates.
pub const LARGEST_NUMBER: f64 = 1e6;

/// Points that are at most this far apart coincide, mm. The value is the rounding of the largest coordinates,
/// and far below the precision of any machine.
pub const NEAREST_MM: f64 = 1e-9;

/// Most points of a curve. Each point makes one or two pieces, and a sweep makes a patch of each pair of
/// pieces of two curves.
pub const POINT_LIMIT: usize = 100_000;

/// The longest text, bytes: enough for [`POINT_LIMIT`] points of three numbers in full precision.
pub const TEXT_LIMIT: usize = 80 * POINT_LIMIT;

/// Why a text is not a section curve, and where.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{fault} (at byte {at})")]
pub struct SectionCurveError {
    /// The byte of the text, from zero.
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
    #[error(
        "a curve cannot start or end with a rounded corner; write l(...) instead of r(...) for the first and the last item"
    )]
    CornerAtEnd,
    #[error("the radius {radius_mm} mm is negative")]
    NegativeRadius { radius_mm: f64 },
    #[error("the point coincides with the point before it; leave one of them out")]
    Coincident,
    #[error("the curve turns back on itself, so no arc of radius {radius_mm} mm touches both lines")]
    Reversal { radius_mm: f64 },
    #[error(
        "the radius {radius_mm} mm is too large: the roundings at the ends of this line need {taken_mm} mm together, and the line is {length_mm} mm long"
    )]
    CornerDoesNotFit { radius_mm: f64, taken_mm: f64, length_mm: f64 },
    /// The parameters of the curve do not rise. That takes points a micrometre apart on a curve a thousand
    /// times longer than any part.
    #[error("{0}")]
    Chain(PiecewiseError),
    #[error("{0}")]
    Piece(BezierError),
}

/// A section curve, in the plane or in space.
///
/// # Example
/// Two lines at a right angle, with a corner of radius 2 mm.
///
/// ```
/// use std::f64::consts::PI;
/// use toolpathd_core::geometry::plane_curve::PlaneCurve;
/// use toolpathd_core::language::section_curve::SectionCurve;
///
/// let curve = SectionCurve::parse("l(0,0) r(10,0,2) l(10,10)").unwrap();
/// let SectionCurve::Plane(chain) = curve else { panic!("the points have two coordinates") };
/// let curve = chain.curve().unwrap();
/// // The lines lose 2 mm each, and the arc is a quarter of a circle.
/// let lengths = [curve.breaks()[0], curve.breaks()[1], curve.domain()[1]];
/// assert!((lengths[0] - 8.0).abs() < 1e-12);
/// assert!((lengths[1] - (8.0 + PI)).abs() < 1e-12);
/// assert!((lengths[2] - (8.0 + PI + 8.0)).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub enum SectionCurve {
    Plane(Chain<2>),
    Space(Chain<3>),
}

impl SectionCurve {
    /// Reads a curve.
    ///
    /// # Errors
    /// The first place that breaks the grammar; otherwise the first item that is impossible.
    pub fn parse(text: &str) -> Result<Self, SectionCurveError> {
        let items = grammar::items(text)?;
        // The first item cannot be a rounded corner. So its number of coordinates decides between plane and
        // space.
        let is_space = items.first().and_then(|item| item.rows.first()).is_some_and(|row| row.count == 3);
        Ok(if is_space { Self::Space(Chain::new(&items)?) } else { Self::Plane(Chain::new(&items)?) })
    }
}

#[cfg(test)]
mod tests;
