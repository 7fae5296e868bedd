//! The pieces that the offset can be made of: the elements of the contour moved aside, and arcs about its
//! convex corners.
//!
//! # Method
//! Lines move in parallel, arcs keep their centres; those that would get no radius vanish. The point of the
//! offset that is nearest to a corner lies on the circle about it, between the normals of the two elements.
//!
//! # Guarantees
//! Every point beside the contour at exactly the distance from it, seen from its nearest point on the side,
//! lies on a piece.
//!
//! # Degenerate input
//! A contour that turns back on itself is rounded on both sides if it is straight there, else on the side of
//! the cusp.

use nalgebra::{Point2, Rotation2, Vector2};

use super::distance::left;
use crate::geometry::element::{Element, PlaneArc};

/// Shorter pieces are left out, mm.
pub(super) const SHORTEST_MM: f64 = 1e-9;

/// Straight elements with a turn this near to a half turn may turn to either side, radians.
const TURNED_BACK: f64 = 1e-9;

/// Of bent elements with a turn this near to a half turn the bends tell the side, radians: tangents where
/// elements touch are known to about 1e-8, and ten times more where an arc is short.
const TURNED_BACK_BENT: f64 = 1e-6;

/// A piece of the offset before anything is cut away.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    pub element: Element,
    /// The element of all contours that the piece runs beside; `None` about a corner.
    pub beside: Option<usize>,
}

/// Appends the pieces of a contour in its order, `distance` to its left, or to its right if negative. Its
/// elements follow `before` elements of other contours.
pub(super) fn append(
    contour: &[Element],
    before: usize,
    is_closed: bool,
    distance: f64,
    pieces: &mut Vec<Piece>,
) {
    for (k, element) in contour.iter().enumerate() {
        if let Some(element) = beside(element, distance).filter(|piece| length(piece) >= SHORTEST_MM) {
            pieces.push(Piece { element, beside: Some(before + k) });
        }
        let next = match contour.get(k + 1) {
            Some(next) => next,
            None if is_closed => &contour[0],
            None => continue,
        };
        if let Some(element) = about(element, next, distance).filter(|piece| length(piece) >= SHORTEST_MM) {
            pieces.push(Piece { element, beside: None });
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

/// The arc about the corner between two elements, if it is convex.
fn about(before: &Element, after: &Element, distance: f64) -> Option<Element> {
    let corner = before.end();
    let tangents = [tangent(before, true), tangent(after, false)];
    let mut turn = tangents[0].perp(&tangents[1]).atan2(tangents[0].dot(&tangents[1]));
    // The way back lies on the side to which both bend; without a bend the corner is rounded on both sides.
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

/// Signed: positive where the element turns to the left, 1/mm.
fn curvature(element: &Element) -> f64 {
    if let Element::Arc(arc) = element { arc.curvature() } else { 0.0 }
}

/// The unit tangent at the start or the end.
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

/// Length of a line or an arc, mm.
pub(in crate::geometry) fn length(element: &Element) -> f64 {
    match element {
        Element::Arc(arc) => arc.radius * arc.turn.abs(),
        line => (line.end() - line.start()).norm(),
    }
}

/// The place at `t`, from 0 at the start to 1 at the end.
pub(in crate::geometry) fn at(element: &Element, t: f64) -> Point2<f64> {
    match element {
        _ if t <= 0.0 => element.start(),
        _ if t >= 1.0 => element.end(),
        Element::Arc(arc) => arc.center + Rotation2::new(arc.turn * t) * (arc.start - arc.center),
        line => line.start() + (line.end() - line.start()) * t,
    }
}

/// The middle of an element, and the radius of the disc about it that holds the element, mm.
pub(super) fn disc(element: &Element) -> (Point2<f64>, f64) {
    let middle = at(element, 0.5);
    (middle, (middle - element.start()).norm().max((middle - element.end()).norm()))
}

/// How far a place is from the line or circle that the element is a part of, mm.
pub(super) fn from_carrier(element: &Element, p: Point2<f64>) -> f64 {
    match element {
        Element::Arc(arc) => ((p - arc.center).norm() - arc.radius).abs(),
        line => tangent(line, false).perp(&(p - line.start())).abs(),
    }
}

/// The angle turned, radians, from one place beside the element to another, near `from` and `to` of its way;
/// `None` where that is too short or turns back.
pub(super) fn turn_between(
    element: &Element,
    [from, to]: [f64; 2],
    [start, end]: [Point2<f64>; 2],
) -> Option<f64> {
    match element {
        Element::Arc(arc) => {
            let angle = |t: f64, p: Point2<f64>| {
                let (spoke, moved) = (at(element, t) - arc.center, p - arc.center);
                arc.turn * t + spoke.perp(&moved).atan2(spoke.dot(&moved))
            };
            let turn = angle(to, end) - angle(from, start);
            (turn * arc.turn.signum() * arc.radius >= SHORTEST_MM).then_some(turn)
        }
        line => ((end - start).dot(&tangent(line, false)) >= SHORTEST_MM).then_some(0.0),
    }
}
