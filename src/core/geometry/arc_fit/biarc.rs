//! Biarcs: a chain with two arcs between each two neighbouring points. The chain passes through all points
//! and has no kinks.
//!
//! # Method
//! 1. Each point gets a tangent: that of the circle through the point, the point before it and the point
//!    after it. The first point has no point before it, so its tangent is that of the circle through the
//!    first three points. The last point uses the circle through the last three points. If the last point
//!    equals the first, both are treated as one inner point: the last but one comes before it, and the second
//!    after it. If the three points lie on one line, this line is the tangent.
//! 2. Between two neighbouring points P and Q, two arcs meet in a joint. The tangent at the joint meets the
//!    tangent at P in a place A, and the tangent at Q in a place B. The joint is chosen such that the
//!    distance from P to A equals the distance from Q to B.
//!
//! If the tangents at P and Q both have the direction from P to Q, the line from P to Q replaces the two
//! arcs.
//!
//! # Reference
//! K. M. Bolton, "Biarc curves", Computer-Aided Design, vol. 7, no. 2, 1975.

use nalgebra::Vector2;

use super::Element;

/// Directions whose angle has a smaller sine count as parallel, and arcs with a smaller bulge as lines.
const STRAIGHT: f64 = 1e-9;

pub fn elements(points: &[Vector2<f64>], is_closed: bool) -> Vec<Element> {
    let tangents: Vec<_> = (0..points.len()).map(|k| tangent(points, k, is_closed)).collect();
    let mut elements = Vec::with_capacity(2 * points.len());
    for (k, pair) in points.windows(2).enumerate() {
        let [from, to] = [pair[0], pair[1]];
        let [start, end] = [tangents[k], tangents[k + 1]];
        match joint([from, to], [start, end]) {
            Some(joint) => {
                elements.push(element(k, [from, joint], bulge_along([from, joint], start)));
                // Run backwards, the second arc starts against the tangent at its end.
                elements.push(element(k + 1, [joint, to], -bulge_along([to, joint], -end)));
            }
            None => elements.push(Element::line(k + 1, from, to)),
        }
    }
    elements
}

/// The unit tangent at a point.
fn tangent(points: &[Vector2<f64>], k: usize, is_closed: bool) -> Vector2<f64> {
    let last = points.len() - 1;
    if last == 1 {
        return (points[1] - points[0]).normalize();
    }
    let at_ends = k == 0 || k == last;
    let [a, b, c] = match k {
        _ if at_ends && is_closed => [last - 1, 0, 1],
        0 => [0, 1, 2],
        k if k == last => [last - 2, last - 1, last],
        k => [k - 1, k, k + 1],
    }
    .map(|k| points[k]);
    let ([u, v], [lu, lv]) = ([b - a, c - b], [(b - a).norm(), (c - b).norm()]);
    let [u, v] = [u / lu, v / lv];
    // The sines of the angles between the tangent and the chords are in the ratio of the chords' lengths.
    let middle = (u * lv + v * lu).try_normalize(0.0).unwrap_or(u);
    if !at_ends || is_closed {
        return middle;
    }
    // At an end of the points the tangent is that at the chord's other end, mirrored in the chord.
    let chord = if k == 0 { u } else { v };
    chord * (2.0 * chord.dot(&middle)) - middle
}

/// The place where the two arcs meet; `None` if the points and tangents lie on one line, or rounding leaves
/// no such place.
fn joint([from, to]: [Vector2<f64>; 2], [start, end]: [Vector2<f64>; 2]) -> Option<Vector2<f64>> {
    let chord = to - from;
    let sum = start + end;
    let (a, b) = (2.0 * (1.0 - start.dot(&end)), chord.dot(&sum));
    let length = if a < STRAIGHT {
        chord.norm_squared() / (2.0 * b)
    } else {
        let root = (b * b + a * chord.norm_squared()).sqrt();
        (root - b) / a
    };
    let is_straight = start.perp(&chord).abs().max(end.perp(&chord).abs()) <= STRAIGHT * chord.norm();
    let joint = (from + to + (start - end) * length) * 0.5;
    let is_inside = joint != from && joint != to;
    (!is_straight && length.is_finite() && length > 0.0 && is_inside).then_some(joint)
}

/// The bulge of the arc between two points that begins along `start`.
fn bulge_along([from, to]: [Vector2<f64>; 2], start: Vector2<f64>) -> f64 {
    let chord = to - from;
    // The tangent at the start leaves the chord by half the sweep; to the left of the chord the bulge is
    // positive.
    (0.5 * chord.perp(&start).atan2(chord.dot(&start))).tan()
}

fn element(end: usize, [start, to]: [Vector2<f64>; 2], bulge: f64) -> Element {
    if bulge.abs() < STRAIGHT {
        Element::line(end, start, to)
    } else {
        Element::bulging(end, [start, to], bulge)
    }
}
