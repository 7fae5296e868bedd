//! Ways to and from a wall, on circles that touch it.

use nalgebra::{Point2, Vector2};

use super::chain::ROUNDING_MM;
use crate::geometry::element::{Element, PlaneArc};

/// The turn of the arc on which the cutter comes to a wall after a lift, radians. The arc begins an eighth of
/// its radius away from the wall. A larger turn takes longer through the air, and a path has hundreds of
/// these arcs.
const LEAD_TURN: f64 = std::f64::consts::FRAC_PI_6;

/// The way from one place to another on circles to the left about two centres and the line that touches both.
pub fn belt([from, to]: [Point2<f64>; 2], [first, second]: [Point2<f64>; 2]) -> Vec<Element> {
    let left = |v: Vector2<f64>| Vector2::new(-v.y, v.x);
    let Some(along) = (second - first).try_normalize(ROUNDING_MM) else { return Vec::new() };
    let (out, back) = ((from - first).norm(), (to - second).norm());
    // For equal radii the line runs parallel to that between the centres.
    let aside = (out - back) / (second - first).norm();
    let spoke = -left(along) * (1.0 - aside * aside).max(0.0).sqrt() + along * aside;
    let (leave, meet) = (first + spoke * out, second + spoke * back);
    let arc = |start: Point2<f64>, end: Point2<f64>, center: Point2<f64>, radius: f64| {
        let (a, b) = (start - center, end - center);
        let turn = a.perp(&b).atan2(a.dot(&b)).rem_euclid(std::f64::consts::TAU);
        Element::Arc(PlaneArc { start, end, center, radius, turn })
    };
    vec![arc(from, leave, first, out), Element::Line { start: leave, end: meet }, arc(meet, to, second, back)]
        .into_iter()
        .filter(|element| element.length() > ROUNDING_MM)
        .collect()
}

/// The arc to the left about a centre that ends at a place.
pub fn lead_to(end: Point2<f64>, center: Point2<f64>) -> Element {
    let spoke = end - center;
    let (sin, cos) = LEAD_TURN.sin_cos();
    let start = center + Vector2::new(spoke.x * cos + spoke.y * sin, spoke.y * cos - spoke.x * sin);
    Element::Arc(PlaneArc { start, end, center, radius: spoke.norm(), turn: LEAD_TURN })
}
