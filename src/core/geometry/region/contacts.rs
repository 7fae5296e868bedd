//! The places where two segments cross or come within a short distance of each other.

use nalgebra::Point2;

use crate::geometry::segment::{Segment, circle_meets, circles_meet, lines_meet};

/// Appends places that are within `within` mm of both elements: crossings of their lines or circles, and the
/// places where the two have a common normal. Ends of one element that lie on the other element are not
/// appended.
pub(super) fn append(a: &Segment, b: &Segment, within: f64, found: &mut Vec<Point2<f64>>) {
    let mut see = |p: Point2<f64>| {
        if a.distance_to(p) <= within && b.distance_to(p) <= within {
            found.push(p);
        }
    };
    match (a, b) {
        (Segment::Arc(a), Segment::Arc(b)) => {
            let apart = b.center() - a.center();
            let distance = apart.norm();
            if distance > 0.0 {
                for spoke in circles_meet(a.radius(), apart, b.radius()).into_iter().flatten() {
                    see(a.center() + spoke);
                }
                let toward = apart * (a.radius() / distance);
                see(a.center() + toward);
                see(a.center() - toward);
            }
        }
        (Segment::Arc(arc), Segment::Line { start, end })
        | (Segment::Line { start, end }, Segment::Arc(arc)) => {
            if let Some(along) = (end - start).try_normalize(0.0) {
                for spoke in circle_meets(arc.radius(), start - arc.center(), along).into_iter().flatten() {
                    see(arc.center() + spoke);
                }
                see(start + along * (arc.center() - start).dot(&along));
            }
        }
        (Segment::Line { start, end }, Segment::Line { start: from, end: to }) => {
            lines_meet([*start, *end], [*from, *to]).map(see);
        }
    }
}
