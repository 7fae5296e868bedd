//! Places on chains of elements.

use nalgebra::Point2;

use crate::geometry::curve::{Curve, Direction};
use crate::geometry::plane::Plane;
use crate::geometry::segment::Segment;

/// Elements that are no longer come of rounding alone, mm. They are left out: their directions mean nothing.
/// Coordinates of ten metres are rounded to 2e-12 mm, and places made of circles are less exact.
pub const ROUNDING_MM: f64 = 1e-9;

/// No element is divided into parts that are shorter, mm: no control writes them, and regions take places
/// that are nearer to each other as one.
pub const SHORTEST_MM: f64 = 1e-6;

/// The distance of a place from an element, and the place on the element.
pub fn foot(element: &Segment, p: Point2<f64>) -> (f64, Point2<f64>) {
    let u = element.foot(p).u.clamp(0.0, 1.0);
    [u, 0.0, 1.0]
        .map(|u| element.at(u))
        .map(|place| ((place - p).norm(), place))
        .into_iter()
        .fold((f64::INFINITY, p), |a, b| if b.0 < a.0 { b } else { a })
}

/// The element nearest to a place, and the fraction of its length.
pub fn nearest(elements: &[Segment], p: Point2<f64>) -> (usize, f64) {
    let mut best = (f64::INFINITY, 0, 0.0);
    for (k, element) in elements.iter().enumerate() {
        for t in [element.foot(p).u.clamp(0.0, 1.0), 0.0, 1.0] {
            let distance = (element.at(t) - p).norm();
            if distance < best.0 {
                best = (distance, k, t);
            }
        }
    }
    (best.1, best.2)
}

/// The loop from the fraction `t` of element `k` on.
pub fn begun_at(elements: &[Segment], k: usize, t: f64) -> Vec<Segment> {
    let (before, after) = elements.split_at(k);
    let mut begun: Vec<Segment> = Vec::with_capacity(elements.len() + 1);
    let Some((first, rest)) = after.split_first() else { return begun };
    let length = first.length();
    if t * length < SHORTEST_MM {
        begun.extend(after.iter().chain(before));
    } else if (1.0 - t) * length < SHORTEST_MM {
        begun.extend(rest.iter().chain(before).chain([first]));
    } else {
        begun.push(first.part(t, 1.0));
        begun.extend(rest.iter().chain(before));
        begun.push(first.part(0.0, t));
    }
    begun
}

/// The first `length_mm` of a chain, or all of a shorter chain.
pub fn first_part(chain: &[Segment], length_mm: f64) -> Vec<Segment> {
    let mut rest = length_mm;
    let mut part = Vec::new();
    for element in chain {
        let length = element.length();
        if rest <= 0.0 || length == 0.0 {
            break;
        }
        part.push(if length <= rest { *element } else { element.part(0.0, rest / length) });
        rest -= length;
    }
    part
}

/// The curve seen from above.
pub fn from_above(along: &Curve) -> Segment {
    let (start, end) = (along.start().xy(), along.end().xy());
    match along {
        Curve::Arc(arc) if arc.plane() == Plane::Xy => {
            let sense = if arc.direction() == Direction::Ccw { 1.0 } else { -1.0 };
            let turn = sense * arc.sweep();
            Segment::about(arc.center().xy(), arc.radius(), [start, end], turn)
        }
        _ => Segment::Line { start, end },
    }
}
