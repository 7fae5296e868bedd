//! Proves how far rails are from the straight legs that they replace.
//!
//! # Method
//! The distance of a point from a line between two points is convex, and a polynomial lies in
//! the convex hull of its Bernstein control points. So the largest distance of the control points bounds the
//! distance of the tip. The part of the leg at which the tip is nearest, as far as the infinite line
//! through the leg goes, is a polynomial too; so is the vector that interpolates both axes there. The angle
//! between this vector and the rail's top follows from bounds of their cross product and of their lengths.
//! A span is halved until the bound is near what its ends and its middle show.
//!
//! # Guarantees
//! * [`of_span`] is at least the largest distance of the tip from the leg and the largest angle between the
//!   axis and the leg's axis at the nearest place, except for rounding.
//! * Where the tip runs along the whole leg and never back, this also bounds the distance of the leg from
//!   the tip: in each plane across the leg there is a point of the rail.
//!
//! # Cost
//! O(m) for m parts of a span, at most 128.

use nalgebra::Vector3;

use super::leg::Leg;
use super::rail::{Point6, Span, tip, top};
use crate::toolpath::tool_axes::angle_between;

/// Halvings of a span, at most.
const MOST_HALVINGS: usize = 7;

/// A bound that is at most this multiple of what was seen is near enough.
const NEAR: f64 = 1.002;

/// Added to that multiple: a nanometre, and an angle that moves a place a metre from the tip by a tenth of a
/// micrometre. No machine shows either. Without this part, a span on its leg would be halved to the end:
/// its deviation is zero, and no bound is within a multiple of zero.
const UNSEEN: Deviation = Deviation { tip_mm: 1e-6, axis: 1e-7 };

/// The directions of a mean of two vectors and of the great circle between them differ by at most this part
/// of the cube of their angle: the largest value of x (1 - x) (1 - 2 x) / 6 is 0.01604.
const MEAN_OF_AXES: f64 = 0.017;

/// Above this angle the last constant does not hold, radians.
const LARGE_ANGLE: f64 = 1.0;

/// Below this angle the mean of two axes is on their great circle but for a tenth of a nanoradian.
const SMALL_ANGLE: f64 = 1e-3;

/// How far the path is from what was asked for.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Deviation {
    pub tip_mm: f64,
    /// Radians.
    pub axis: f64,
}

impl Deviation {
    pub const NONE: Self = Self { tip_mm: 0.0, axis: 0.0 };

    /// The larger one of each figure.
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        Self { tip_mm: self.tip_mm.max(other.tip_mm), axis: self.axis.max(other.axis) }
    }

    /// The sums of both figures.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self { tip_mm: self.tip_mm + other.tip_mm, axis: self.axis + other.axis }
    }

    /// This tolerance less what is kept free of it. At least half of the tolerance is left.
    #[must_use]
    pub fn without(self, room: Self) -> Self {
        Self {
            tip_mm: (self.tip_mm - room.tip_mm).max(0.5 * self.tip_mm),
            axis: (self.axis - room.axis).max(0.5 * self.axis),
        }
    }

    /// The smaller one of each figure.
    fn min(self, other: Self) -> Self {
        Self { tip_mm: self.tip_mm.min(other.tip_mm), axis: self.axis.min(other.axis) }
    }

    /// The larger one of the two figures, each as a part of its tolerance.
    pub fn of(self, tolerance: Self) -> f64 {
        (self.tip_mm / tolerance.tip_mm).max(self.axis / tolerance.axis)
    }
}

/// Bound of the deviation of a span from legs. Each part of the span may take another leg. A bound of at
/// most `enough` is not made exact.
pub fn of_span(span: &Span, legs: &[Leg], enough: Deviation) -> Deviation {
    of_part(span, legs, enough, MOST_HALVINGS)
}

fn of_part(span: &Span, legs: &[Leg], enough: Deviation, halvings: usize) -> Deviation {
    // Distances count before angles: they choose the leg that is nearest.
    let bounds = legs.iter().map(|leg| beside(leg, span)).map(|leg| (bound(span, &leg), leg));
    let Some((bound, leg)) = bounds.reduce(|a, b| if b.0.tip_mm < a.0.tip_mm { b } else { a }) else {
        return Deviation::NONE;
    };
    let is_enough = bound.tip_mm <= enough.tip_mm && bound.axis <= enough.axis;
    if is_enough || halvings == 0 || is_near(bound, span, legs, &leg) {
        return bound;
    }
    let [first, second] = span.halves();
    let parts = of_part(&first, legs, enough, halvings - 1).max(of_part(&second, legs, enough, halvings - 1));
    if legs.len() == 1 { parts.min(bound) } else { parts }
}

/// Whether a bound is hardly more than what is seen at the ends and in the middle.
fn is_near(bound: Deviation, span: &Span, legs: &[Leg], nearest: &Leg) -> bool {
    let middle = 0.5 * (span.from + span.to);
    let places = [span.start(), span.jet(middle)[0], span.end()];
    let seen = places.iter().map(|p| seen(p, legs)).fold(Deviation::NONE, Deviation::max);
    bound.tip_mm <= NEAR * seen.tip_mm + UNSEEN.tip_mm
        && bound.axis <= NEAR * seen.axis + UNSEEN.axis + mean_of_axes(nearest)
}

/// The deviation of a place from the nearest of some legs.
pub fn seen(p: &Point6, legs: &[Leg]) -> Deviation {
    let from = |leg: &Leg| {
        let part = part_of(leg, &tip(p)).clamp(0.0, 1.0);
        Deviation { tip_mm: distance(leg, &tip(p)), axis: angle_between(&top(p), &leg.top_at(part)) }
    };
    let nearest = legs.iter().map(from).reduce(|a, b| if b.tip_mm < a.tip_mm { b } else { a });
    nearest.unwrap_or(Deviation::NONE)
}

/// The part of a leg that is nearest to a span. The shorter it is, the nearer is the mean of its axes to
/// their great circle.
fn beside(leg: &Leg, span: &Span) -> Leg {
    if leg.angle <= SMALL_ANGLE || leg.is_rotation() {
        return *leg;
    }
    let feet = span.control.map(|p| part_of(leg, &tip(&p)).clamp(0.0, 1.0));
    let [from, to] = [feet.iter().copied().fold(1.0, f64::min), feet.iter().copied().fold(0.0, f64::max)];
    let part = leg.between([from, to]);
    if part.is_rotation() { *leg } else { part }
}

fn bound(span: &Span, leg: &Leg) -> Deviation {
    let tips = span.control.iter().map(|p| distance(leg, &tip(p)));
    Deviation { tip_mm: tips.fold(0.0, f64::max), axis: axis_bound(span, leg) }
}

/// The distance of a point from the leg's line, mm.
pub fn distance(leg: &Leg, p: &Vector3<f64>) -> f64 {
    if leg.is_rotation() {
        return (p - tip(&leg.start)).norm();
    }
    let t = part_of(leg, p).clamp(0.0, 1.0);
    (p - tip(&leg.start).lerp(&tip(&leg.end), t)).norm()
}

/// The part of the leg's line at which it is nearest to a point; zero where the tip rests.
pub fn part_of(leg: &Leg, p: &Vector3<f64>) -> f64 {
    if leg.is_rotation() {
        return 0.0;
    }
    let along = tip(&leg.end) - tip(&leg.start);
    along.dot(&(p - tip(&leg.start))) / along.norm_squared()
}

/// How far the mean of the axes of a leg is from its great circle, radians, with both tops as far from the
/// tip.
pub fn mean_of_axes(leg: &Leg) -> f64 {
    MEAN_OF_AXES * leg.angle.powi(3)
}

/// Bound of the angle between the axis of the rail and the axis of the leg at the nearest place, radians.
fn axis_bound(span: &Span, leg: &Leg) -> f64 {
    if leg.angle > LARGE_ANGLE {
        return std::f64::consts::PI;
    }
    let (a, b) = (top(&leg.start), top(&leg.end));
    let rail = span.control.map(|p| top(&p));
    let wanted = span.control.map(|p| a + (b - a) * part_of(leg, &tip(&p)));
    let across = cross(&rail, &wanted).iter().map(Vector3::norm).fold(0.0, f64::max);
    let middle = (rail[2] + rail[3]).normalize();
    let least =
        |points: &[Vector3<f64>; 6]| points.iter().map(|p| p.dot(&middle)).fold(f64::INFINITY, f64::min);
    let (shortest, other) = (least(&rail), least(&wanted));
    if !(shortest > 0.0 && other > 0.0) {
        return std::f64::consts::PI;
    }
    let sine = across / (shortest * other);
    if sine >= 1.0 { std::f64::consts::PI } else { sine.asin() + mean_of_axes(leg) }
}

/// The Bernstein coefficients of the cross product of two polynomials of degree 5.
fn cross(a: &[Vector3<f64>; 6], b: &[Vector3<f64>; 6]) -> [Vector3<f64>; 11] {
    const CHOOSE_5: [f64; 6] = [1.0, 5.0, 10.0, 10.0, 5.0, 1.0];
    const CHOOSE_10: [f64; 11] = [1.0, 10.0, 45.0, 120.0, 210.0, 252.0, 210.0, 120.0, 45.0, 10.0, 1.0];
    let mut product = [Vector3::zeros(); 11];
    for i in 0..6 {
        for j in 0..6 {
            product[i + j] += a[i].cross(&b[j]) * (CHOOSE_5[i] * CHOOSE_5[j]);
        }
    }
    for (sum, choose) in product.iter_mut().zip(CHOOSE_10) {
        *sum /= choose;
    }
    product
}

/// Bound of the distance of a part of a leg's line from a span, mm. `[from, to]` are parts of the leg.
pub fn of_line(span: &Span, leg: &Leg, part: [f64; 2]) -> f64 {
    const POINTS: usize = 64;
    let at = |k: usize| span.from + span.length() * (k as f64 / POINTS as f64);
    let points: Vec<Vector3<f64>> = (0..=POINTS).map(|k| tip(&span.jet(at(k))[0])).collect();
    // An eighth of the second derivative bounds the height of a chord, and a quintic's has 20 times the
    // second differences.
    let bend = span.control.windows(3).map(|p| (tip(&p[2]) - tip(&p[1]) * 2.0 + tip(&p[0])).norm());
    let height = 2.5 * bend.fold(0.0, f64::max) / (POINTS * POINTS) as f64;
    let of_feet = of_feet(&points, leg, part).map_or(f64::INFINITY, |distance| distance + height);
    of_feet.min(of_points(&points, leg, part))
}

/// Bound of the distance of a part of a leg's line from a row of chords, mm.
pub fn of_chords(points: &[Vector3<f64>], leg: &Leg, part: [f64; 2]) -> f64 {
    // The chords are nearer than their ends are: each is divided.
    const PARTS: usize = 8;
    let divided = points
        .windows(2)
        .flat_map(|pair| (0..=PARTS).map(|k| pair[0].lerp(&pair[1], k as f64 / PARTS as f64)))
        .collect::<Vec<_>>();
    let of_feet = of_feet(points, leg, part).unwrap_or(f64::INFINITY);
    of_feet.min(of_points(&divided, leg, part))
}

/// The same where the chords pass the whole part: each of its places is then the foot of a place of theirs.
fn of_feet(points: &[Vector3<f64>], leg: &Leg, [from, to]: [f64; 2]) -> Option<f64> {
    const ROUNDING: f64 = 1e-12;
    let feet: Vec<f64> = points.iter().map(|p| part_of(leg, p)).collect();
    let last = feet.iter().position(|foot| *foot >= to - ROUNDING)?;
    let first = feet[..=last].iter().rposition(|foot| *foot <= from + ROUNDING)?;
    let clipped = |outer: usize, inner: usize, wanted: f64| {
        let share = (wanted - feet[outer]) / (feet[inner] - feet[outer]);
        if share.is_finite() {
            points[outer].lerp(&points[inner], share.clamp(0.0, 1.0))
        } else {
            points[outer]
        }
    };
    let off = |p: &Vector3<f64>| (p - tip(&leg.start).lerp(&tip(&leg.end), part_of(leg, p))).norm();
    let ends = if first < last {
        [clipped(first, first + 1, from), clipped(last, last - 1, to)]
    } else {
        [points[first]; 2]
    };
    let inner = points.get(first + 1..last).unwrap_or(&[]);
    Some(ends.iter().chain(inner).map(off).fold(0.0, f64::max))
}

/// Bound of the distance of a part of a leg's line from points, mm. Every stretch of the line is within the
/// larger distance of its ends from one point.
fn of_points(points: &[Vector3<f64>], leg: &Leg, [from, to]: [f64; 2]) -> f64 {
    const STRETCHES: usize = 32;
    let at = |k: usize| from + (to - from) * (k as f64 / STRETCHES as f64);
    let stretch = |k: usize| {
        let ends = [k, k + 1].map(|k| tip(&leg.at(at(k))));
        let reach = |p: &Vector3<f64>| ends.iter().map(|end| (end - p).norm()).fold(0.0, f64::max);
        points.iter().map(reach).fold(f64::INFINITY, f64::min)
    };
    (0..STRETCHES).map(stretch).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operations::five_axis::rail::join;

    fn pose(x: f64, y: f64, z: f64, tilt: f64) -> Point6 {
        join(Vector3::new(x, y, z), Vector3::new(0.0, tilt.sin(), tilt.cos()) * 50.0)
    }

    /// The largest deviation at many places.
    fn sampled(span: &Span, leg: &Leg) -> Deviation {
        let place = |k: i32| span.jet(span.from + span.length() * f64::from(k) / 2000.0)[0];
        (0..=2000).map(|k| seen(&place(k), &[*leg])).fold(Deviation::NONE, Deviation::max)
    }

    #[test]
    fn the_bound_is_never_below_what_is_seen_and_hardly_above() {
        for bend in [0.0, 0.01, 0.3] {
            for tilt in [0.0, 0.02, 0.4] {
                let (start, end) = (pose(0.0, 0.0, 0.0, 0.0), pose(10.0, 0.0, 0.0, tilt));
                let leg = Leg::new(start, end);
                let slope = |sign: f64| {
                    (end - start) / 10.0 + pose(0.0, sign * bend, 0.0, 0.0) * 1.0 - pose(0.0, 0.0, 0.0, 0.0)
                };
                let span = Span::cubic([0.0, 10.0], [start, slope(1.0)], [end, slope(-1.0)]);
                let (bound, seen) = (of_span(&span, &[leg], Deviation::NONE), sampled(&span, &leg));
                assert!(
                    bound.tip_mm >= seen.tip_mm - 1e-12 && bound.axis >= seen.axis - 1e-12,
                    "{bound:?} {seen:?}"
                );
                assert!(bound.tip_mm <= 1.02 * seen.tip_mm + 2e-6, "{bound:?} {seen:?}");
                assert!(
                    bound.axis <= 1.02 * seen.axis + 1e-6 + 2.0 * mean_of_axes(&leg),
                    "{bound:?} {seen:?}"
                );
            }
        }
    }

    #[test]
    fn a_line_beside_chords_that_pass_it_is_as_far_away_as_they_are() {
        let leg = Leg::new(pose(0.0, 0.0, 0.0, 0.0), pose(10.0, 0.0, 0.0, 0.0));
        let row = |places: &[[f64; 2]]| -> Vec<Vector3<f64>> {
            places.iter().map(|[x, y]| Vector3::new(*x, *y, 0.0)).collect()
        };
        let passes = row(&[[2.0, 0.0], [6.0, 0.001], [14.0, 0.009]]);
        assert!((of_chords(&passes, &leg, [0.2, 1.0]) - 0.005).abs() < 1e-12);
        // Back and forth, and then away before the end of the line.
        let turns = row(&[[2.0, 0.0], [5.0, 0.0], [4.0, 3.0], [9.0, 0.0], [9.0, 5.0]]);
        assert!(of_chords(&turns, &leg, [0.2, 0.9]) <= 3.0);
        let ends = of_chords(&turns, &leg, [0.2, 1.0]);
        assert!((1.0..=3.0).contains(&ends), "{ends}");
    }

    #[test]
    fn the_mean_of_two_axes_is_as_near_to_their_great_circle_as_stated() {
        for angle in [0.01, 0.3, 0.7, 1.0] {
            let leg = Leg::new(pose(0.0, 0.0, 0.0, 0.0), pose(1.0, 0.0, 0.0, angle));
            for k in 0..=100 {
                let t = f64::from(k) / 100.0;
                let mean = top(&leg.start).lerp(&top(&leg.end), t);
                assert!(angle_between(&mean, &leg.top_at(t)) <= mean_of_axes(&leg) + 1e-15);
            }
        }
    }
}
