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

use nalgebra::{Point2, Vector2};

use super::distance::left;
use crate::geometry::element::{Element, PlaneArc};

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
    pub element: Element,
    /// The index of the contour element that the piece runs beside, or at whose end its corner is, counted
    /// over all contours.
    pub element_index: usize,
    /// Whether the piece is an arc about a corner.
    pub is_corner: bool,
}

/// Appends the pieces of a contour, in its order, at the distance `distance` mm to its left, or to its right
/// if negative. `before` elements of other contours come before its elements.
pub(super) fn append(
    contour: &[Element],
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

fn beside(element: &Element, distance: f64) -> Option<Element> {
    match element {
        Element::Arc(arc) => {
            let moved = arc.radius - arc.turn.signum() * distance;
            let at = |p: Point2<f64>| arc.center + (p - arc.center) * (moved / arc.radius);
            (moved > 0.0).then(|| {
                Element::Arc(PlaneArc { start: at(arc.start), end: at(arc.end), radius: moved, ..*arc })
            })
        }
        line => {
            let aside = left(tangent(line, false)) * distance;
            Some(Element::Line { start: line.start() + aside, end: line.end() + aside })
        }
    }
}

/// The arc about the corner between two elements; `None` if the corner is not convex on this side.
fn about(before: &Element, after: &Element, distance: f64) -> Option<Element> {
    let corner = before.end();
    let tangents = [tangent(before, true), tangent(after, false)];
    let mut turn = tangents[0].perp(&tangents[1]).atan2(tangents[0].dot(&tangents[1]));
    // A contour that turns back does so on the side to which its elements curve. Without curvature the corner
    // is rounded on both sides.
    let bend = curvature(before) + curvature(after);
    let from_back = std::f64::consts::PI - turn.abs();
    if bend != 0.0 && from_back < TURNED_BACK_BENT {
        turn = -turn.abs() * bend.signum();
    } else if from_back < TURNED_BACK {
        turn = -turn.abs() * distance.signum();
    }
    let [start, end] = tangents.map(|tangent| corner + left(tangent) * distance);
    (turn * distance < 0.0)
        .then(|| Element::Arc(PlaneArc { start, end, center: corner, radius: distance.abs(), turn }))
}

/// The signed curvature, 1/mm: positive if the element turns to the left.
fn curvature(element: &Element) -> f64 {
    if let Element::Arc(arc) = element { arc.curvature() } else { 0.0 }
}

/// The unit tangent at the start or the end of an element.
fn tangent(element: &Element, is_at_end: bool) -> Vector2<f64> {
    let along = match element {
        Element::Arc(arc) => {
            let p = if is_at_end { arc.end } else { arc.start };
            left(p - arc.center) * arc.turn.signum()
        }
        line => line.end() - line.start(),
    };
    along.try_normalize(0.0).unwrap_or_else(Vector2::x)
}

/// The distance of a place from the line or circle that the element is a part of, mm.
pub(super) fn from_carrier(element: &Element, p: Point2<f64>) -> f64 {
    match element {
        Element::Arc(arc) => ((p - arc.center).norm() - arc.radius).abs(),
        line => tangent(line, false).perp(&(p - line.start())).abs(),
    }
}

/// The angle in radians that the element turns from `start` to `end`, two places beside it near the fractions
/// `from` and `to` of its length; 0 for a line. `None` if this part is too short or runs backwards.
pub(super) fn turn_between(
    element: &Element,
    [from, to]: [f64; 2],
    [start, end]: [Point2<f64>; 2],
) -> Option<f64> {
    match element {
        Element::Arc(arc) => {
            let angle = |t: f64, p: Point2<f64>| {
                let (spoke, moved) = (element.at(t) - arc.center, p - arc.center);
                arc.turn * t + spoke.perp(&moved).atan2(spoke.dot(&moved))
            };
            let turn = angle(to, end) - angle(from, start);
            (turn * arc.turn.signum() * arc.radius >= SHORTEST_MM).then_some(turn)
        }
        line => ((end - start).dot(&tangent(line, false)) >= SHORTEST_MM).then_some(0.0),
    }
}
