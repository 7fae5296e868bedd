//! Upper bounds of the distance between a curve (a line, an arc or a helix) and a sequence of points.
//!
//! * [`from_lines`] bounds the Frechet distance between the curve and the polyline through the points.
//!   Suppose that one place moves along the curve and another along the polyline, both from start to end and
//!   never back. The Frechet distance is the least number d for which both can move such that their distance
//!   never exceeds d.
//! * [`from_points`] bounds the least number d for which each point has a place on the curve no farther away
//!   than d, and these places follow each other along the curve in the order of the points.
//!
//! # Method
//! 1. Each point gets a place on the curve: its foot, the nearest place. If the feet are not in the order of
//!    the points, other places, which are in order, replace them. These are chosen such that the largest
//!    distance of a point from its place is as small as possible.
//! 2. For [`from_lines`], each line of the polyline is compared with a part of the curve: the part between
//!    the places of the two ends of the line.
//!
//! # Guarantees
//! A result may be larger than the exact distance, but never smaller. It is infinite for a parabola. For
//! [`from_points`] it is also infinite if an arc or helix turns by more than half a turn between the places
//! of two neighbouring points. The module shares no code with the fit that makes the curves, so it can check
//! the fit.
//!
//! # Cost
//! O(n) for n points whose feet are in order. If they are not, the places are found by bisection, and the
//! cost is O(n log(1 / e)) for the relative rounding error e.

use std::f64::consts::{PI, TAU};

use nalgebra::{Point3, Vector3};

use super::curve::{Arc, Curve, Direction};
use super::solve::bisect;

/// A bound may exceed the largest distance found by `LOOSE_PART` of it plus `LOOSE_MM`, mm.
const LOOSE_PART: f64 = 1e-7;
const LOOSE_MM: f64 = 1e-11;

/// The most parts into which one line is divided. After that, the bounds of the parts that are left are used
/// as they are.
const MOST_PARTS: usize = 400;

/// Bisection steps for the least distance, and for the first place within a distance.
const DISTANCE_STEPS: usize = 40;
const PLACE_STEPS: usize = 40;

/// Turns above this are halved at the middle place if the middle of the line has no foot inside, radians.
const LONG_WAY: f64 = PI / 4.0;

/// The largest turn that counts as half a turn, radians: the excess allows for rounding.
const HALF_A_TURN: f64 = PI + 1e-7;

/// A place of an arc is the foot of a point if their angles about the centre differ by less than this,
/// radians. Rounding makes them differ by some 1e-15. A place that was moved to an end of the arc, or into
/// order, differs by more.
const SAME_ANGLE: f64 = 1e-9;

/// Steps of Newton's method to a foot on a helix.
const FOOT_STEPS: usize = 6;

/// Upper bound of the least distance within which the curve passes the points in order, mm. Infinite if the
/// curve turns by more than half a turn between two neighbouring points: the points do not justify such a
/// turn.
pub fn from_points(curve: &Curve, points: &[Point3<f64>]) -> f64 {
    let given = points;
    let Some(track) = FramedCurve::new(curve) else { return f64::INFINITY };
    let points: Vec<Vector3<f64>> = points.iter().map(|p| track.local(p)).collect();
    let places = track.places(&points);
    let justified = |places: &[f64]| {
        let ends = std::iter::once(0.0).chain(places.iter().copied()).chain([1.0]);
        let mut steps = ends.clone().zip(ends.skip(1));
        let is_half_a_turn = |(from, to): (f64, f64)| track.turn() * (to - from) <= HALF_A_TURN;
        if steps.all(is_half_a_turn) { track.largest(&points, places) } else { f64::INFINITY }
    };
    let found = justified(&places);
    if found.is_finite() {
        return found;
    }
    // These places are the first ones of each point, so that the last step may be too long. The last places
    // of each point are the first ones of the way back. Places half way between both make shorter steps.
    let back = reversed(curve).map_or(Vec::new(), |back| {
        FramedCurve::new(&back).map_or(Vec::new(), |track| {
            let points: Vec<Vector3<f64>> = given.iter().rev().map(|p| track.local(p)).collect();
            track.places(&points)
        })
    });
    let last: Vec<f64> = back.iter().rev().map(|place| 1.0 - place).collect();
    let between: Vec<f64> = places.iter().zip(&last).map(|(a, b)| 0.5 * (a + b)).collect();
    if between.len() < places.len() { f64::INFINITY } else { justified(&last).min(justified(&between)) }
}

/// The arc in the other sense; `None` for other curves, which turn by nothing.
fn reversed(curve: &Curve) -> Option<Curve> {
    let Curve::Arc(arc) = curve else { return None };
    let direction = match arc.direction() {
        Direction::Ccw => Direction::Cw,
        Direction::Cw => Direction::Ccw,
    };
    let [_, _, normal] = arc.plane().axes();
    let mut center = arc.center();
    center[normal] = arc.end()[normal];
    Arc::new(arc.plane(), direction, arc.end(), arc.start(), center).ok().map(Curve::Arc)
}

/// Whether the places of the curve nearest to the points follow each other along it in the order of the
/// points, without a turn of more than half a turn between two of them. `false` for a parabola whose points
/// do not advance along its chord.
pub fn is_in_order(curve: &Curve, points: &[Point3<f64>]) -> bool {
    let Some(track) = FramedCurve::new(curve) else {
        let along = curve.end() - curve.start();
        return points.iter().map(|p| along.dot(&p.coords)).is_sorted();
    };
    let feet = points.iter().map(|p| track.foot(&track.local(p)));
    let mut before = 0.0;
    feet.into_iter().all(|foot| {
        let is_next = before <= foot && track.turn() * (foot - before) <= HALF_A_TURN;
        before = foot;
        is_next
    })
}

/// Upper bound of the distance within which the curve, from its start to its end, and the lines between the
/// points run side by side, mm.
pub fn from_lines(curve: &Curve, points: &[Point3<f64>]) -> f64 {
    let Some(track) = FramedCurve::new(curve) else { return f64::INFINITY };
    let points: Vec<Vector3<f64>> = points.iter().map(|p| track.local(p)).collect();
    let mut places = track.places(&points);
    if let [first, .., last] = places.as_mut_slice() {
        (*first, *last) = (0.0, 1.0);
    }
    let mut most = track.largest(&points, &places);
    for (pair, at) in points.windows(2).zip(places.windows(2)) {
        most = track.beside([pair[0], pair[1]], [at[0], at[1]], most);
    }
    most
}

/// A curve in a frame of its own. Places on it run from 0 at the start to 1 at the end.
enum FramedCurve<'a> {
    /// The line runs along the first axis, from 0.
    Line { length: f64, start: Point3<f64>, along: Vector3<f64> },
    /// The arc runs about the third axis, from the first axis to the left.
    Arc {
        arc: &'a Arc,
        center: Vector3<f64>,
        first: [f64; 2],
        sense: f64,
        radius: f64,
        sweep: f64,
        rise: f64,
    },
}

impl<'a> FramedCurve<'a> {
    fn new(curve: &'a Curve) -> Option<Self> {
        match curve {
            Curve::Line(line) => {
                let length = line.length();
                let along = if length > 0.0 { (line.end - line.start) / length } else { Vector3::x() };
                Some(Self::Line { length, start: line.start, along })
            }
            Curve::Arc(arc) => {
                let [start, center] = [arc.start(), arc.center()].map(|p| arc.plane().to_local(&p));
                let spoke = start - center;
                let radius = spoke.xy().norm();
                let sense = if arc.direction() == Direction::Ccw { 1.0 } else { -1.0 };
                let first = [spoke.x / radius, spoke.y / radius];
                let center = Vector3::new(center.x, center.y, start.z);
                Some(Self::Arc { arc, center, first, sense, radius, sweep: arc.sweep(), rise: arc.rise() })
            }
            Curve::Parabola(_) => None,
        }
    }

    /// A point in the frame. For a line: along it and away from it. For an arc: about its centre, such that
    /// the arc begins at the angle zero and turns to the left.
    fn local(&self, p: &Point3<f64>) -> Vector3<f64> {
        match self {
            Self::Line { start, along, .. } => {
                let from = p - start;
                let x = along.dot(&from);
                // The direction away from the line counts too: two points may lie on different sides of it.
                let beside = from - along * x;
                let u = across(along);
                Vector3::new(x, u.dot(&beside), along.cross(&u).dot(&beside))
            }
            Self::Arc { arc, center, first: [c, s], sense, .. } => {
                let d = arc.plane().to_local(p) - center;
                Vector3::new(d.x * c + d.y * s, sense * (d.y * c - d.x * s), d.z)
            }
        }
    }

    /// The angle that the curve turns, radians.
    fn turn(&self) -> f64 {
        match self {
            Self::Line { .. } => 0.0,
            Self::Arc { sweep, .. } => *sweep,
        }
    }

    fn distance(&self, p: &Vector3<f64>, place: f64) -> f64 {
        match self {
            // This form avoids the cancellation of nearly equal coordinates.
            Self::Arc { radius, sweep, rise, .. } => {
                let out = p.xy().norm();
                let half = 0.5 * (p.y.atan2(p.x) - sweep * place);
                let (radial, round) = (out - radius, 2.0 * (out * radius).sqrt() * half.sin());
                radial.hypot(round).hypot(p.z - rise * place)
            }
            Self::Line { length, .. } => (p - Vector3::new(length * place, 0.0, 0.0)).norm(),
        }
    }

    /// The place nearest to a point; on a helix approximately.
    fn foot(&self, p: &Vector3<f64>) -> f64 {
        match self {
            Self::Line { length, .. } if *length > 0.0 => (p.x / length).clamp(0.0, 1.0),
            Self::Line { .. } => 0.0,
            Self::Arc { radius, sweep, rise, .. } => {
                let angle = p.y.atan2(p.x).rem_euclid(TAU);
                // A point beyond the end that is nearer to the start gets a negative angle.
                let mut at = if angle - sweep > TAU - angle { angle - TAU } else { angle };
                if *rise != 0.0 {
                    let (climb, size) = (rise / sweep, p.xy().norm() * radius);
                    for _ in 0..FOOT_STEPS {
                        let slope = size * (at - angle).sin() - climb * (p.z - climb * at);
                        let bend = size * (at - angle).cos() + climb * climb;
                        if bend <= 0.0 {
                            break;
                        }
                        at -= slope / bend;
                    }
                }
                (at / sweep).clamp(0.0, 1.0)
            }
        }
    }

    fn largest(&self, points: &[Vector3<f64>], places: &[f64]) -> f64 {
        points.iter().zip(places).map(|(p, place)| self.distance(p, *place)).fold(0.0, f64::max)
    }

    /// Places in order, chosen such that the largest distance of a point from its place is as small as
    /// possible.
    fn places(&self, points: &[Vector3<f64>]) -> Vec<f64> {
        let feet: Vec<f64> = points.iter().map(|p| self.foot(p)).collect();
        let mut reached = 0.0f64;
        let mut places: Vec<f64> = feet
            .iter()
            .map(|foot| {
                reached = reached.max(*foot);
                reached
            })
            .collect();
        let mut low = self.largest(points, &feet);
        let mut high = self.largest(points, &places);
        for _ in 0..DISTANCE_STEPS {
            if high <= low * (1.0 + LOOSE_PART) + LOOSE_MM {
                break;
            }
            let middle = 0.5 * (low + high);
            match self.places_within(points, &feet, middle) {
                Some(found) => (places, high) = (found, middle),
                None => low = middle,
            }
        }
        places
    }

    /// For each point the first place within `mm` of it that is not before the place of the point before.
    /// `None` if a point has no such place.
    fn places_within(&self, points: &[Vector3<f64>], feet: &[f64], mm: f64) -> Option<Vec<f64>> {
        let mut reached = 0.0;
        let mut places = Vec::with_capacity(points.len());
        for (p, foot) in points.iter().zip(feet) {
            if self.distance(p, reached) > mm {
                let near = [*foot, 1.0].into_iter().filter(|place| *place > reached);
                let near = near.filter(|place| self.distance(p, *place) <= mm);
                reached = near.map(|place| self.first(p, [reached, place], mm)).min_by(f64::total_cmp)?;
            }
            places.push(reached);
        }
        Some(places)
    }

    /// The first place within `mm` of a point, found by bisection between a place that is too far and a place
    /// that is not.
    fn first(&self, p: &Vector3<f64>, [out, within]: [f64; 2], mm: f64) -> f64 {
        bisect([within, out], PLACE_STEPS, |place| self.distance(p, place) <= mm)[0]
    }

    /// Upper bound of the distance between the line from one point to the next and the curve between their
    /// places, mm; at least `most`.
    ///
    /// Two points move at constant speeds, one along the line and one along the arc. They are never farther
    /// apart than the larger of their distances at the start and at the end, plus r a^2 / 8. Here r is the
    /// radius of the arc, and a the angle that it turns between the places.
    fn beside(&self, ends: [Vector3<f64>; 2], places: [f64; 2], most: f64) -> f64 {
        let Self::Arc { radius, sweep, .. } = self else {
            // The distance of two points that move evenly on two lines is convex, so it is largest at an end.
            return most;
        };
        let mut found = most;
        let mut bounded = most;
        let mut open = vec![(ends, places)];
        let mut parts = 0;
        while let Some((ends, places)) = open.pop() {
            let away = [self.distance(&ends[0], places[0]), self.distance(&ends[1], places[1])];
            let larger = away[0].max(away[1]);
            found = found.max(larger);
            let turn = sweep * (places[1] - places[0]);
            let bound = match self.between_feet(ends, places) {
                Some(bound) => bound.max(larger),
                None => larger + 0.125 * radius * turn * turn,
            };
            parts += 1;
            if bound <= found * (1.0 + LOOSE_PART) + LOOSE_MM || parts > MOST_PARTS {
                bounded = bounded.max(bound);
                continue;
            }
            let middle = (ends[0] + ends[1]) * 0.5;
            let foot = self.foot(&middle);
            let is_inside = places[0] < foot && foot < places[1];
            // A middle beyond an end takes that end as its place. If the turn is long, it takes the middle
            // place: otherwise one half would keep all of the turn.
            let place = if is_inside || turn < LONG_WAY {
                foot.clamp(places[0], places[1])
            } else {
                0.5 * (places[0] + places[1])
            };
            open.push(([middle, ends[1]], [place, places[1]]));
            open.push(([ends[0], middle], [places[0], place]));
        }
        bounded
    }

    /// The largest distance of a line from an arc in a plane, in closed form, mm: at an end, or where the
    /// line passes the centre. `None` unless the places are the feet of the line's ends, and the line turns
    /// by less than half a turn about the centre.
    fn between_feet(&self, [a, b]: [Vector3<f64>; 2], places: [f64; 2]) -> Option<f64> {
        let Self::Arc { radius, sweep, rise, .. } = self else { return None };
        let is_foot = |p: &Vector3<f64>, place: f64| {
            let angle = p.y.atan2(p.x) - sweep * place;
            (angle - TAU * (angle / TAU).round()).abs() < SAME_ANGLE
        };
        if *rise != 0.0
            || a.z != b.z
            || sweep * (places[1] - places[0]) > 0.999 * PI
            || !(is_foot(&a, places[0]) && is_foot(&b, places[1]))
        {
            return None;
        }
        let (p, along) = (a.xy(), (b - a).xy());
        let at = (-p.dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
        let nearest = if at.is_finite() { (p + along * at).norm() } else { p.norm() };
        let beside =
            (radius - nearest).abs().max((radius - p.norm()).abs()).max((radius - b.xy().norm()).abs());
        Some(beside.hypot(a.z))
    }
}

/// A unit vector at right angles to another.
fn across(along: &Vector3<f64>) -> Vector3<f64> {
    let least = along.iamin();
    let mut axis = Vector3::zeros();
    axis[least] = 1.0;
    along.cross(&axis).normalize()
}

#[cfg(test)]
mod tests;
