//! A curve in the plane as arcs and lines within a tolerance, with a proof.
//!
//! # Method
//! 1. The curve is divided at its corners.
//! 2. From one joint to the next, the longest element is sought by samples, doubling and halving its range.
//!    An element is the arc through the curve's points at both ends and in the middle of the range, or their
//!    chord.
//! 3. [`judge`] proves that the element stays within the tolerance of its range of the curve, and the range
//!    within the tolerance of the element. Where it proves nothing, as at a cusp, the range is halved until a
//!    box about it is smaller than the tolerance.
//!
//! # Guarantees
//! Elements start and end on the curve, and turn by half a turn at most. The deviation that is told is a
//! bound.

use nalgebra::Point2;
use toolpathd_core::budget::{Budget, Stopped};
use toolpathd_core::geometry::deviation::{Band, Ends, GUARD_MM, GUARD_PART, Measure, Verdict, judge};
use toolpathd_core::geometry::interval::Interval;
use toolpathd_core::geometry::plane_curve::PlaneCurve;
use toolpathd_core::geometry::plane_curve::piecewise::Piecewise;
use toolpathd_core::geometry::segment::Segment;

/// A jump of the tangent by more than this sine is a corner, where two elements meet.
const CORNER_SINE: f64 = 1e-6;

/// An arc that rises less above its chord is tried as a line first: this part of the tolerance.
const FLAT_PART: f64 = 0.05;

/// The largest radius of an arc, mm. Flatter arcs become lines, or shorter arcs.
const LARGEST_RADIUS_MM: f64 = 1e5;

/// Halvings between the longest range whose samples are near the element and the shortest whose are not.
const REFINEMENTS: usize = 5;

/// The steps between samples, and how near they have to be, as a part of the tolerance: samples miss the
/// largest deviation by less than the rest.
const SAMPLES: u32 = 12;
const NEAR_PART: f64 = 0.97;

/// Where the proof of an element fails, the element is shortened by this factor.
const SHORTENED: f64 = 0.93;

/// After so many shortenings the element is halved.
const SHORTENINGS: usize = 3;

/// The length that is tried after an element that had to be halved, as a multiple of that element's.
const GROWTH: f64 = 2.0;

/// A chain of elements on a curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Arcs {
    /// x, y and the bulge of the element to the next vertex; the last bulge is zero.
    pub vertices: Vec<[f64; 3]>,
    pub deviation_mm: f64,
}

/// The elements of a curve; `None` if there are more than `limit`.
///
/// # Errors
/// When the budget ends.
pub fn of_curve(
    curve: &Piecewise,
    tolerance_mm: f64,
    limit: usize,
    budget: &Budget,
) -> Result<Option<Arcs>, Stopped> {
    let [start, end] = curve.domain();
    let corners = curve.breaks().iter().copied().filter(|t| curve.has_corner(*t, CORNER_SINE));
    let mut arcs = Arcs { vertices: Vec::new(), deviation_mm: 0.0 };
    let mut n_elements = 0;
    let mut from = start;
    for to in corners.chain([end]) {
        let mut at = from;
        let mut length = to - from;
        // Where samples promise more than is proved, elements grow from proved lengths only.
        let mut is_promising = true;
        while at < to {
            budget.check()?;
            n_elements += 1;
            if n_elements > limit {
                return Ok(None);
            }
            let promised = match is_promising {
                true => longest_by_samples(curve, [at, to], length, tolerance_mm),
                false => (GROWTH * length).min(to - at),
            };
            let element = longest_proved(curve, [at, to], promised, tolerance_mm);
            length = element.to - at;
            is_promising = length > 0.5 * promised;
            at = element.to;
            arcs.deviation_mm = arcs.deviation_mm.max(element.deviation_mm);
            if let Some(vertex) = element.vertex {
                arcs.vertices.push(vertex);
            }
        }
        from = to;
    }
    let last = curve.point(end);
    arcs.vertices.push([last.x, last.y, 0.0]);
    Ok(Some(arcs))
}

/// An element up to the parameter `to`.
#[derive(Debug, Clone, Copy)]
struct Approximant {
    to: f64,
    /// Where the element starts, with its bulge; `None` if the element has no length.
    vertex: Option<[f64; 3]>,
    deviation_mm: f64,
}

/// The first element that is proved, from the start of a range and of this length or shorter.
fn longest_proved(
    curve: &Piecewise,
    [from, most]: [f64; 2],
    mut length: f64,
    tolerance_mm: f64,
) -> Approximant {
    let end = |length: f64| if length >= most - from { most } else { from + length };
    for attempt in 0.. {
        if let Some(element) = fit(curve, [from, end(length)], tolerance_mm) {
            return element;
        }
        length *= if attempt < SHORTENINGS { SHORTENED } else { 0.5 };
        if from + length <= from {
            break;
        }
    }
    // The two parameters are neighbours, and so are their points to rounding.
    jump(curve, [from, from.next_up().min(most)])
}

/// The length of the longest range whose samples are near its arc or its chord.
fn longest_by_samples(curve: &Piecewise, [from, most]: [f64; 2], guess: f64, tolerance_mm: f64) -> f64 {
    let room = most - from;
    let is_near = |length: f64| seems_near(curve, [from, from + length], NEAR_PART * tolerance_mm);
    let mut low = guess.min(room);
    let mut high = 2.0 * low;
    if is_near(low) {
        while low < room && is_near(high.min(room)) {
            (low, high) = (high.min(room), 2.0 * high);
        }
        if low >= room {
            return room;
        }
    } else {
        loop {
            high = low;
            low *= 0.5;
            if is_near(low) || from + low <= from {
                break;
            }
        }
    }
    high = high.min(room);
    for _ in 0..REFINEMENTS {
        let middle = 0.5 * (low + high);
        if is_near(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// Whether samples of a range are this near to its arc, or its chord where it has no arc.
fn seems_near(curve: &Piecewise, [from, to]: [f64; 2], near_mm: f64) -> bool {
    let [start, end] = [from, to].map(|t| curve.point(t));
    let bulge = bulge_through(start, curve.point(0.5 * (from + to)), end);
    let bulge = if is_allowed(start, end, bulge) { bulge } else { 0.0 };
    // Between equal ends the segment is a point: that is right where the curve stands still.
    let segment = Segment::bulging(start, end, -bulge);
    let at = |k: u32| curve.point(from + (to - from) * (f64::from(k) / f64::from(SAMPLES)));
    (1..SAMPLES).all(|k| segment.distance_to(at(k)) <= near_mm)
}

/// Whether an element may have this bulge.
fn is_allowed(start: Point2<f64>, end: Point2<f64>, bulge: f64) -> bool {
    let radius = 0.25 * (end - start).norm() * (1.0 + bulge * bulge) / bulge.abs();
    bulge == 0.0 || (bulge.abs() <= 1.0 && radius <= LARGEST_RADIUS_MM)
}

/// The element over a range, if it is proved to stay within the tolerance.
fn fit(curve: &Piecewise, [from, to]: [f64; 2], tolerance_mm: f64) -> Option<Approximant> {
    let [start, end] = [from, to].map(|t| curve.point(t));
    if start != end {
        let bulge = bulge_through(start, curve.point(0.5 * (from + to)), end);
        let rise = 0.5 * bulge.abs() * (end - start).norm();
        let bulges = if rise <= FLAT_PART * tolerance_mm { [0.0, bulge] } else { [bulge, 0.0] };
        for bulge in bulges.into_iter().filter(|bulge| is_allowed(start, end, *bulge)) {
            let segment = Segment::bulging(start, end, -bulge);
            // The judge widens the band by this guard, and the readings are rounded by less.
            let guard = GUARD_MM + GUARD_PART * segment.magnitude();
            let side = (tolerance_mm - 2.0 * guard).max(0.0);
            let band = Band { below_mm: side, above_mm: side, measure: Measure::Normal };
            if let Verdict::Within(spread) = judge(curve, &segment.into(), [from, to], Ends::OnCurve, &band) {
                let deviation_mm = spread.largest_mm() + guard;
                return Some(Approximant { to, vertex: Some([start.x, start.y, bulge]), deviation_mm });
            }
        }
    }
    let small = jump(curve, [from, to]);
    (small.deviation_mm <= tolerance_mm).then_some(small)
}

/// The chord over a range without a corner of the curve inside, with the diagonal of a box about the range as
/// its deviation.
fn jump(curve: &Piecewise, [from, to]: [f64; 2]) -> Approximant {
    let breaks = curve.breaks();
    let inner = &breaks[breaks.partition_point(|t| *t <= from)..];
    let mut sides = [0.0; 2];
    let mut at = from;
    let mut hull: Option<[Interval; 2]> = None;
    for next in inner.iter().copied().take_while(|t| *t < to).chain([to]) {
        let point = curve.enclose(at, next).point;
        let joined = match hull {
            None => point,
            Some([x, y]) => [point[0].hull(x), point[1].hull(y)],
        };
        sides = joined.map(|side| side.width());
        hull = Some(joined);
        at = next;
    }
    let [start, end] = [from, to].map(|t| curve.point(t));
    let vertex = (start != end).then_some([start.x, start.y, 0.0]);
    Approximant { to, vertex, deviation_mm: f64::hypot(sides[0], sides[1]).next_up() }
}

/// The bulge of the arc from `start` to `end` through `via`; zero if the three are on a line.
fn bulge_through(start: Point2<f64>, via: Point2<f64>, end: Point2<f64>) -> f64 {
    let (to, on) = (via - start, end - via);
    // The chords at `via` turn by half the turn of the arc.
    let (sine, cosine) = (to.perp(&on), to.dot(&on));
    let bulge = sine / (f64::hypot(sine, cosine) + cosine);
    if bulge.is_finite() { bulge } else { 0.0 }
}
