//! The least distance between two lines or arcs, in closed form.
//!
//! # Method
//! Suppose that a place on one element and a place on the other have the least distance. Then the two
//! elements cross there, or one of the places is an end of its element, or the line between the places is
//! normal to both elements. All such places of one element are computed, and their distances from the other
//! element. The least of these distances is the result.
//!
//! # Guarantees
//! The error of the result is some 1e-15 of the largest coordinate or radius. Elements without length count
//! as points.

use nalgebra::{Point2, Vector2};

use crate::geometry::element::{Element, PlaneArc};

/// The vector turned to the left by a quarter turn.
pub(in crate::geometry) fn left(v: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-v.y, v.x)
}

/// Whether the ray from the centre along `spoke` meets the arc.
pub(in crate::geometry) fn covers(arc: &PlaneArc, spoke: Vector2<f64>) -> bool {
    let sense = arc.turn.signum();
    let is_after_start = sense * (arc.start - arc.center).perp(&spoke) >= 0.0;
    let is_before_end = sense * spoke.perp(&(arc.end - arc.center)) >= 0.0;
    if arc.turn.abs() > std::f64::consts::PI {
        is_after_start || is_before_end
    } else {
        is_after_start && is_before_end
    }
}

/// The place of a line or an arc that is nearest to a point.
pub(super) fn nearest(element: &Element, p: Point2<f64>) -> Point2<f64> {
    match element {
        Element::Arc(arc) => {
            let spoke = p - arc.center;
            if covers(arc, spoke) {
                arc.center + spoke.try_normalize(0.0).unwrap_or_else(Vector2::x) * arc.radius
            } else if (p - arc.start).norm_squared() < (p - arc.end).norm_squared() {
                arc.start
            } else {
                arc.end
            }
        }
        line => line.at(line.foot(p, 0.5).u.clamp(0.0, 1.0)),
    }
}

/// The distance from a point to a line or an arc, mm.
pub(in crate::geometry) fn to_point(element: &Element, p: Point2<f64>) -> f64 {
    match element {
        Element::Arc(arc) => {
            let spoke = p - arc.center;
            if covers(arc, spoke) {
                (spoke.norm() - arc.radius).abs()
            } else {
                (p - arc.start).norm_squared().min((p - arc.end).norm_squared()).sqrt()
            }
        }
        Element::Line { start, end } | Element::Parabola { start, end, .. } => {
            let (along, from) = (end - start, p - start);
            let square = along.norm_squared();
            let u = if square > 0.0 { (from.dot(&along) / square).clamp(0.0, 1.0) } else { 0.0 };
            (from - along * u).norm()
        }
    }
}

/// The least distance between two elements, mm, with the place on the first element. No place can make it too
/// small, because each place lies on an element. Two arcs with the same centre have infinitely many common
/// normals; there, the ends of the arcs are enough.
pub(in crate::geometry) fn between(first: &Element, second: &Element) -> (f64, Point2<f64>) {
    let mut least = (f64::INFINITY, first.start());
    let mut see = |distance: f64, at: Point2<f64>| {
        if distance < least.0 {
            least = (distance, at);
        }
    };
    for p in [second.start(), second.end()] {
        see(to_point(first, p), p);
    }
    for p in [first.start(), first.end()] {
        see(to_point(second, p), p);
    }
    // Places on the line or circle of the first element that are not on the element itself do not count.
    let mut see_on_carrier = |p: Point2<f64>| {
        let is_on = match first {
            Element::Arc(arc) => covers(arc, p - arc.center),
            Element::Line { start, end } | Element::Parabola { start, end, .. } => {
                let along = end - start;
                (0.0..=along.norm_squared()).contains(&(p - start).dot(&along))
            }
        };
        if is_on {
            see(to_point(second, p), p);
        }
    };
    match (first, second) {
        (Element::Arc(a), Element::Arc(b)) => {
            let apart = b.center - a.center;
            let distance = apart.norm();
            if distance > 0.0 {
                let toward = apart / distance;
                see_on_carrier(a.center + toward * a.radius);
                see_on_carrier(a.center - toward * a.radius);
                for spoke in circles_meet(a.radius, apart, b.radius).into_iter().flatten() {
                    see_on_carrier(a.center + spoke);
                }
            }
        }
        (Element::Arc(arc), line) => {
            let along = line.end() - line.start();
            let length = along.norm();
            if length > 0.0 {
                let along = along / length;
                // Of the two feet on the arc, the one that faces the line is nearer; the other one does no
                // harm.
                see_on_carrier(arc.center + left(along) * arc.radius);
                see_on_carrier(arc.center - left(along) * arc.radius);
                for spoke in circle_meets(arc.radius, line.start() - arc.center, along).into_iter().flatten()
                {
                    see_on_carrier(arc.center + spoke);
                }
            }
        }
        (line, Element::Arc(arc)) => {
            let along = line.end() - line.start();
            let length = along.norm();
            if length > 0.0 {
                let along = along / length;
                see_on_carrier(line.start() + along * (arc.center - line.start()).dot(&along));
                for spoke in circle_meets(arc.radius, line.start() - arc.center, along).into_iter().flatten()
                {
                    see_on_carrier(arc.center + spoke);
                }
            }
        }
        (one, other) => {
            let (along, across) = (one.end() - one.start(), other.end() - other.start());
            let u = (other.start() - one.start()).perp(&across) / along.perp(&across);
            if u.is_finite() {
                see_on_carrier(one.start() + along * u);
            }
        }
    }
    least
}

/// The two places where a circle about the origin meets the line through `from` along a unit vector; `None`
/// if it does not.
pub(in crate::geometry) fn circle_meets(
    radius: f64,
    from: Vector2<f64>,
    along: Vector2<f64>,
) -> Option<[Vector2<f64>; 2]> {
    let foot = left(along) * along.perp(&from);
    let beside = foot.norm();
    let square = (radius - beside) * (radius + beside);
    (square >= 0.0).then(|| [foot - along * square.sqrt(), foot + along * square.sqrt()])
}

/// The two places where a circle about the origin meets a circle of radius `other` with its centre at
/// `apart`; `None` if it does not.
pub(in crate::geometry) fn circles_meet(
    radius: f64,
    apart: Vector2<f64>,
    other: f64,
) -> Option<[Vector2<f64>; 2]> {
    // Seen from the smaller circle, the places lose no digits to the other's radius.
    if other < radius {
        let places = circles_meet(other, -apart, radius)?;
        return Some([apart + places[1], apart + places[0]]);
    }
    let distance = apart.norm();
    let toward = apart / distance;
    let along = 0.5 * (distance + (radius - other) * (radius + other) / distance);
    let square = (radius - along) * (radius + along);
    // NaN if the circles are concentric.
    (square >= 0.0).then(|| {
        [toward * along - left(toward) * square.sqrt(), toward * along + left(toward) * square.sqrt()]
    })
}
