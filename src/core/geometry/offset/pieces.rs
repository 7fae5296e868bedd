//! The pieces of an offset before clipping: each element of a contour moved aside by the offset's distance,
//! and an arc about each convex corner.
//!
//! # Method
//! * A line is moved parallel to itself.
//! * An arc keeps its centre and gets a new radius, which is smaller or larger by the distance. If the new
//!   radius is zero or below, the arc has no piece.
//! * A corner is convex if the contour turns away from the side of the offset there. The arc about the corner
//!   has the distance as its radius. It runs from the normal of the element before the corner to the normal
//!   of the element after it.
//!
//! # Guarantees
//! Every place on the chosen side at exactly the offset's distance from the contour lies on a piece. The ends
//! of an open contour are an exception: no pieces run around them.

use nalgebra::Point2;

use crate::geometry::segment::{PlaneArc, Segment, left};

/// The shortest length of a piece, mm; shorter pieces are left out.
pub(super) const SHORTEST_MM: f64 = 1e-9;

/// Two lines whose turn is this near to a half turn count as turning back, radians: the turn may go to either
/// side.
const TURNED_BACK: f64 = 1e-9;

/// Two elements, at least one an arc, whose turn is this near to a half turn count as turning back, radians.
/// Their curvature then tells the side. Tangents where elements touch are known to about 1e-8, and ten times
/// worse if an arc is short.
const TURNED_BACK_BENT: f64 = 1e-6;

/// A piece of the offset before anything is cut away.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    pub element: Segment,
    /// The index of the contour element that the piece runs beside, or at whose end its corner is, counted
    /// over all contours.
    pub element_index: usize,
    /// Whether the piece is an arc about a corner.
    pub is_corner: bool,
}

/// Appends the pieces of a contour, in its order, at the distance `distance` mm to its left, or to its right
/// if negative. `before` elements of other contours come before its elements.
pub(super) fn append(
    contour: &[Segment],
    before: usize,
    is_closed: bool,
    distance: f64,
    pieces: &mut Vec<Piece>,
) {
    for (k, element) in contour.iter().enumerate() {
        if let Some(element) = beside(element, distance).filter(|piece| piece.length() >= SHORTEST_MM) {
            pieces.push(Piece { element, element_index: before + k, is_corner: false });
        }
        let next = match contour.get(k + 1) {
            Some(next) => next,
            None if is_closed => &contour[0],
            None => continue,
        };
        if let Some(element) = about(element, next, distance).filter(|piece| piece.length() >= SHORTEST_MM) {
            pieces.push(Piece { element, element_index: before + k, is_corner: true });
        }
    }
}

fn beside(element: &Segment, distance: f64) -> Option<Segment> {
    match element {
        Segment::Line { start, end } => {
            let aside = left(element.tangents()[0]) * distance;
            Some(Segment::Line { start: start + aside, end: end + aside })
        }
        Segment::Arc(arc) => {
            let moved = arc.radius() - arc.turn().signum() * distance;
            let at = |p: Point2<f64>| arc.center() + (p - arc.center()) * (moved / arc.radius());
            let ends = [at(arc.start()), at(arc.end())];
            PlaneArc::about(arc.center(), moved, ends, arc.turn()).map(Segment::Arc)
        }
    }
}

/// The arc about the corner between two elements; `None` if the corner is not convex on this side.
fn about(before: &Segment, after: &Segment, distance: f64) -> Option<Segment> {
    let corner = before.end();
    let tangents = [before.tangents()[1], after.tangents()[0]];
    let mut turn = tangents[0].perp(&tangents[1]).atan2(tangents[0].dot(&tangents[1]));
    // A contour that turns back does so on the side to which its elements curve. Without curvature the corner
    // is rounded on both sides.
    let bend = before.curvature() + after.curvature();
    let from_back = std::f64::consts::PI - turn.abs();
    if bend != 0.0 && from_back < TURNED_BACK_BENT {
        turn = -turn.abs() * bend.signum();
    } else if from_back < TURNED_BACK {
        turn = -turn.abs() * distance.signum();
    }
    let ends = tangents.map(|tangent| corner + left(tangent) * distance);
    (turn * distance < 0.0).then(|| Segment::about(corner, distance.abs(), ends, turn))
}

/// The angle in radians that the element turns from `start` to `end`, two places beside it near the fractions
/// `from` and `to` of its length; 0 for a line. `None` if this part is too short or runs backwards.
pub(super) fn turn_between(
    element: &Segment,
    [from, to]: [f64; 2],
    [start, end]: [Point2<f64>; 2],
) -> Option<f64> {
    match element {
        Segment::Line { .. } => ((end - start).dot(&element.tangents()[0]) >= SHORTEST_MM).then_some(0.0),
        Segment::Arc(arc) => {
            let angle = |t: f64, p: Point2<f64>| {
                let (spoke, moved) = (element.at(t) - arc.center(), p - arc.center());
                arc.turn() * t + spoke.perp(&moved).atan2(spoke.dot(&moved))
            };
            let turn = angle(to, end) - angle(from, start);
            (turn * arc.turn().signum() * arc.radius() >= SHORTEST_MM).then_some(turn)
        }
    }
}
