//! The least distance between two segments, in closed form.
//!
//! # Method
//! Suppose that a place on one segment and a place on the other have the least distance. Then the two
//! segments cross there, or one of the places is an end of its segment, or the line between the places is
//! normal to both segments. All such places of one segment are computed, and their distances from the other
//! segment. The least of these distances is the result.
//!
//! # Guarantees
//! The error of the result is some 1e-15 of the largest coordinate or radius. Lines without length count as
//! points.

use nalgebra::{Point2, Vector2};

use super::{Segment, left};

impl Segment {
    /// The place nearest to a point.
    pub fn nearest(&self, p: Point2<f64>) -> Point2<f64> {
        match self {
            Self::Line { .. } => self.at(self.foot(p).u.clamp(0.0, 1.0)),
            Self::Arc(arc) => {
                let spoke = p - arc.center();
                if arc.covers(spoke) {
                    arc.center() + spoke.try_normalize(0.0).unwrap_or_else(Vector2::x) * arc.radius()
                } else if (p - arc.start()).norm_squared() < (p - arc.end()).norm_squared() {
                    arc.start()
                } else {
                    arc.end()
                }
            }
        }
    }

    /// The distance from a point, mm.
    pub fn distance_to(&self, p: Point2<f64>) -> f64 {
        match self {
            Self::Line { start, end } => {
                let (along, from) = (end - start, p - start);
                let square = along.norm_squared();
                let u = if square > 0.0 { (from.dot(&along) / square).clamp(0.0, 1.0) } else { 0.0 };
                (from - along * u).norm()
            }
            Self::Arc(arc) => {
                let spoke = p - arc.center();
                if arc.covers(spoke) {
                    (spoke.norm() - arc.radius()).abs()
                } else {
                    (p - arc.start()).norm_squared().min((p - arc.end()).norm_squared()).sqrt()
                }
            }
        }
    }

    /// The distance of a place from the line or circle that the segment is a part of, mm.
    pub fn distance_to_carrier(&self, p: Point2<f64>) -> f64 {
        match self {
            Self::Line { start, .. } => self.tangents()[0].perp(&(p - start)).abs(),
            Self::Arc(arc) => ((p - arc.center()).norm() - arc.radius()).abs(),
        }
    }

    /// The least distance from another segment, mm, with the place on this segment. No place can make it too
    /// small, because each place lies on a segment. Two arcs with the same centre have infinitely many common
    /// normals; there, the ends of the arcs are enough.
    pub fn distance_between(&self, other: &Self) -> (f64, Point2<f64>) {
        let mut least = (f64::INFINITY, self.start());
        let mut see = |distance: f64, at: Point2<f64>| {
            if distance < least.0 {
                least = (distance, at);
            }
        };
        for p in [other.start(), other.end()] {
            see(self.distance_to(p), p);
        }
        for p in [self.start(), self.end()] {
            see(other.distance_to(p), p);
        }
        // Places on the line or circle of this segment that are not on the segment itself do not count.
        let mut see_on_carrier = |p: Point2<f64>| {
            let is_on = match self {
                Self::Line { start, end } => {
                    let along = end - start;
                    (0.0..=along.norm_squared()).contains(&(p - start).dot(&along))
                }
                Self::Arc(arc) => arc.covers(p - arc.center()),
            };
            if is_on {
                see(other.distance_to(p), p);
            }
        };
        match (self, other) {
            (Self::Arc(a), Self::Arc(b)) => {
                let apart = b.center() - a.center();
                if let Some(toward) = apart.try_normalize(0.0) {
                    see_on_carrier(a.center() + toward * a.radius());
                    see_on_carrier(a.center() - toward * a.radius());
                    for spoke in circles_meet(a.radius(), apart, b.radius()).into_iter().flatten() {
                        see_on_carrier(a.center() + spoke);
                    }
                }
            }
            (Self::Arc(arc), Self::Line { start, end }) | (Self::Line { start, end }, Self::Arc(arc)) => {
                let Some(along) = (end - start).try_normalize(0.0) else { return least };
                if let Self::Arc(_) = self {
                    // Of the two feet on the arc, the one that faces the line is nearer; the other one does
                    // no harm.
                    see_on_carrier(arc.center() + left(along) * arc.radius());
                    see_on_carrier(arc.center() - left(along) * arc.radius());
                } else {
                    see_on_carrier(start + along * (arc.center() - start).dot(&along));
                }
                for spoke in circle_meets(arc.radius(), start - arc.center(), along).into_iter().flatten() {
                    see_on_carrier(arc.center() + spoke);
                }
            }
            (Self::Line { start, end }, Self::Line { start: from, end: to }) => {
                lines_meet([*start, *end], [*from, *to]).map(see_on_carrier);
            }
        }
        least
    }
}

/// Where two lines meet, each given by two of its places; `None` if they are parallel.
pub fn lines_meet(one: [Point2<f64>; 2], other: [Point2<f64>; 2]) -> Option<Point2<f64>> {
    let (along, across) = (one[1] - one[0], other[1] - other[0]);
    let u = (other[0] - one[0]).perp(&across) / along.perp(&across);
    u.is_finite().then(|| one[0] + along * u)
}

/// The two places where a circle about the origin meets the line through `from` along a unit vector; `None`
/// if it does not.
pub fn circle_meets(radius: f64, from: Vector2<f64>, along: Vector2<f64>) -> Option<[Vector2<f64>; 2]> {
    let foot = left(along) * along.perp(&from);
    let beside = foot.norm();
    let square = (radius - beside) * (radius + beside);
    (square >= 0.0).then(|| [foot - along * square.sqrt(), foot + along * square.sqrt()])
}

/// The two places where a circle about the origin meets a circle of radius `other` with its centre at
/// `apart`; `None` if it does not.
pub fn circles_meet(radius: f64, apart: Vector2<f64>, other: f64) -> Option<[Vector2<f64>; 2]> {
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
