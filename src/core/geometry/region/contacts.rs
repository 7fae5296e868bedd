//! The places where two elements, lines or arcs, cross or come within a short distance of each other.

use nalgebra::Point2;

use crate::geometry::element::Element;
use crate::geometry::offset::distance::{circle_meets, circles_meet, to_point};

/// Appends places that are within `within` mm of both elements: crossings of their lines or circles, and the
/// places where the two have a common normal. Ends of one element that lie on the other element are not
/// appended.
pub(super) fn append(a: &Element, b: &Element, within: f64, found: &mut Vec<Point2<f64>>) {
    let mut see = |p: Point2<f64>| {
        if to_point(a, p) <= within && to_point(b, p) <= within {
            found.push(p);
        }
    };
    match (a, b) {
        (Element::Arc(a), Element::Arc(b)) => {
            let apart = b.center - a.center;
            let distance = apart.norm();
            if distance > 0.0 {
                for spoke in circles_meet(a.radius, apart, b.radius).into_iter().flatten() {
                    see(a.center + spoke);
                }
                let toward = apart * (a.radius / distance);
                see(a.center + toward);
                see(a.center - toward);
            }
        }
        (Element::Arc(arc), line) | (line, Element::Arc(arc)) => {
            let chord = line.end() - line.start();
            if let Some(along) = chord.try_normalize(0.0) {
                for spoke in circle_meets(arc.radius, line.start() - arc.center, along).into_iter().flatten()
                {
                    see(arc.center + spoke);
                }
                see(line.start() + along * (arc.center - line.start()).dot(&along));
            }
        }
        (one, other) => {
            let (along, across) = (one.end() - one.start(), other.end() - other.start());
            let u = (other.start() - one.start()).perp(&across) / along.perp(&across);
            if u.is_finite() {
                see(one.start() + along * u);
            }
        }
    }
}
