//! Replaces the arcs at nearly straight corners of a contour by mitres. Such arcs would be only a few
//! micrometres long.
//!
//! # Method
//! These steps are done for each such arc. The arc is left out, and the elements before and after it are
//! lengthened until they meet. The place where they meet is farther from the corner than the arc is. If it is
//! farther by more than the caller allows, or if the two elements do not meet, the arc is kept.
//!
//! # Guarantees
//! Each element starts exactly where the element before it ends. A lengthened element stays within
//! [`MEETS_MM`] of its former line or circle.

use nalgebra::{Point2, Vector2};

use crate::geometry::segment::{PlaneArc, Segment, left};

/// Steps of Newton's method to the place where two elements meet. Each step doubles the digits.
const STEPS: usize = 4;

/// Elements meet if the place found is within this distance of both, mm.
const MEETS_MM: f64 = 1e-9;

/// An arc is one about a corner if its radius differs from the offset's distance by at most this share.
/// Joined ends move the circle of an arc of some micrometres by more than rounding does.
const SAME_RADIUS_PART: f64 = 1e-6;

/// The largest half turn of an arc that a mitre may replace, radians. At larger turns the mitre is as visible
/// as a corner, however far the caller lets it reach.
const LARGEST_HALF_TURN: f64 = 0.1;

/// The chain with mitres for arcs of radius `distance` mm, where the mitre is at most `most` mm farther from
/// the contour.
pub(super) fn mitred(chain: &[Segment], distance: f64, most: f64) -> Vec<Segment> {
    let mut kept: Vec<Segment> = Vec::with_capacity(chain.len());
    let mut k = 0;
    while k < chain.len() {
        let mitre = match (kept.last(), chain[k], chain.get(k + 1)) {
            (Some(before), Segment::Arc(corner), Some(after)) => {
                mitre(before, &corner, after, distance, most)
            }
            _ => None,
        };
        if let Some([before, after]) = mitre {
            kept.pop();
            kept.extend([before, after]);
            k += 2;
        } else {
            kept.push(chain[k]);
            k += 1;
        }
    }
    kept
}

/// The elements before and after a corner, up to the place where they meet; `None` if the corner keeps its
/// arc. If the contour turns by the angle a and the arc has the radius d, the place is farther from the
/// corner than d, by d (1 / cos(a / 2) - 1).
fn mitre(
    before: &Segment,
    corner: &PlaneArc,
    after: &Segment,
    distance: f64,
    most: f64,
) -> Option<[Segment; 2]> {
    let half = 0.5 * corner.turn().abs();
    let is_about_corner = (corner.radius() - distance).abs() <= SAME_RADIUS_PART * distance;
    if !is_about_corner || half >= LARGEST_HALF_TURN || distance * (1.0 / half.cos() - 1.0) > most {
        return None;
    }
    let middle = Segment::Arc(*corner).at(0.5);
    let first = corner.center() + (middle - corner.center()) / half.cos();
    let mut place = first;
    for _ in 0..STEPS {
        let [(p, along), (q, across)] = [before, after].map(|element| foot(element, place));
        place = p + along * ((q - p).perp(&across) / along.perp(&across));
    }
    let meets = [before, after].iter().all(|element| element.distance_to_carrier(place) <= MEETS_MM);
    // Written so that NaN counts as not meeting.
    if !(meets && (place - first).norm() <= corner.radius() * half) {
        return None;
    }
    Some([lengthened(before, [before.start(), place])?, lengthened(after, [place, after.end()])?])
}

/// The place nearest to `p` on the line or circle that an element is a part of, and the direction there.
fn foot(element: &Segment, p: Point2<f64>) -> (Point2<f64>, Vector2<f64>) {
    match element {
        Segment::Line { start, end } => {
            let along = (end - start).normalize();
            (start + along * (p - start).dot(&along), along)
        }
        Segment::Arc(arc) => {
            let spoke = (p - arc.center()).normalize();
            (arc.center() + spoke * arc.radius(), left(spoke) * arc.turn().signum())
        }
    }
}

/// The element on the same line or circle between new ends, which are a little farther apart than its own.
fn lengthened(element: &Segment, [start, end]: [Point2<f64>; 2]) -> Option<Segment> {
    let Segment::Arc(arc) = element else { return Some(Segment::Line { start, end }) };
    let angle = |from: Point2<f64>, to: Point2<f64>| {
        let (from, to) = (from - arc.center(), to - arc.center());
        from.perp(&to).atan2(from.dot(&to))
    };
    let turn = arc.turn() + angle(start, arc.start()) + angle(arc.end(), end);
    PlaneArc::with_bulge(start, end, -(turn / 4.0).tan()).map(Segment::Arc)
}
