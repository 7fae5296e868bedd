//! Makes the line, arc or parabola for a range of the curve. Sampled places of the curve determine the
//! element, and [`judge`] proves that it stays within the band.

mod bow;

use nalgebra::{Point2, Vector2};

use super::band::BandAlong;
use super::job::Method;
use super::meter::Meter;
use crate::geometry::arc_fit::FLATTEST_MM;
use crate::geometry::deviation::{
    Band, Element, Ends, GUARD_MM, GUARD_PART, Measure, Spread, Verdict, judge,
};
use crate::geometry::plane_curve::PlaneCurve;
use crate::geometry::segment::Segment;
use bow::Bow;

/// Places at which a deviation is sampled, as shares of a range: at even steps, or, for bands with a narrow
/// side, closer together towards the ends.
const EVEN: [f64; 9] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9];
const GRADED: [f64; 17] =
    [0.0003, 0.002, 0.01, 0.03, 0.08, 0.18, 0.3, 0.4, 0.5, 0.6, 0.7, 0.82, 0.92, 0.97, 0.99, 0.998, 0.9997];

/// A band is lopsided if its narrow side is less than this share of its wide side.
const LOPSIDED_PART: f64 = 0.99;

/// The most steps towards the place of the largest deviation, by parabolas through three places. An element
/// that has to touch the curve takes more steps.
const PEAK_STEPS: usize = 4;
const TOUCH_STEPS: usize = 16;

/// The search ends with a step below this share of the ranges beside the place. The value changes with the
/// square of the step there, so that it is then known to 1e-10 of itself.
const CLOSE_PART: f64 = 5e-6;

/// The distance that an element keeps in its middle from a side of the curve without room, as a share of the
/// wide side. An element that coincides with the curve takes many cells to prove.
const CLEAR_PART: f64 = 1e-4;

/// If a side is narrower than the share `NARROW_PART` of the other, elements aim at the share `NARROW_USE` of
/// it only.
const NARROW_PART: f64 = 1e-3;
const NARROW_USE: f64 = 0.7;

/// How often the places of an element's largest deviations are added to those that determine the next
/// element.
const EXCHANGES: usize = 4;

/// A side of the band narrower than the share `NO_ROOM_PART` of the other has no room for an element that
/// bends to it. On such a band, an element that is `HOPELESS_FACTOR` times shorter than the wide side alone
/// would allow stays within the band by rounding only.
const NO_ROOM_PART: f64 = 1e-7;
const HOPELESS_FACTOR: f64 = 1024.0;

/// The most steps of the search for the best bow; it takes five to ten.
const BULGE_STEPS: usize = 40;

/// The share of the range to which the place of a line's largest deviation is found. The deviation is flat
/// there, so that its error is about the square of this share.
const TOP_PART: f64 = 1e-7;

/// Feet no farther beyond an end of the element than this share of it count as at the end: rounding decides
/// on which side they are.
const END_ROUNDING: f64 = 1e-9;

/// How exactly the bow is found that uses both sides of the band alike, as shares of what the bows through
/// the places differ by: on a band with equal sides, before the first exchange of places, and after each. An
/// exchange changes the places, so that the first bow may be rough.
const EVEN_BOW_PART: f64 = 1e-12;
const FIRST_BOW_PART: f64 = 1e-4;
const BOW_PART: f64 = 1e-9;

/// The shape of an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    Line,
    Parabola,
    Arc,
}

impl Method {
    /// The shapes to try, in this order.
    pub fn shapes(self) -> &'static [Shape] {
        match self {
            Method::Linear => &[Shape::Line],
            Method::Parabolic => &[Shape::Parabola],
            Method::Mixed => &[Shape::Line, Shape::Parabola],
            Method::Arc => &[Shape::Arc],
        }
    }
}

/// An element that is proved to stay within the band.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fitted {
    pub element: Element,
    /// The range of the curve's parameter that the element covers.
    pub range: [f64; 2],
    pub spread: Spread,
}

/// Makes elements with joints on a curve.
#[derive(Clone, Copy)]
pub struct Fitter<'a, C> {
    pub curve: &'a C,
    pub method: Method,
    /// The band, with upper bounds of widths that change along the curve.
    pub band: Band,
    pub along: &'a BandAlong,
    /// The largest radius of an arc, mm.
    pub largest_radius_mm: f64,
    pub element_limit: usize,
    pub meter: &'a Meter<'a>,
}

impl<C: PlaneCurve> Fitter<'_, C> {
    /// The element over `range` of the first shape that is proved to stay within the band; `None` if no shape
    /// is.
    pub fn fit(&self, range: [f64; 2]) -> Option<Fitted> {
        self.method.shapes().iter().find_map(|shape| {
            let element = self.element(*shape, range)?;
            let verdict = if self.along.varies() {
                judge(self.curve, &element, range, Ends::OnCurve, self.along)
            } else {
                judge(self.curve, &element, range, Ends::OnCurve, &self.band)
            };
            match verdict {
                Verdict::Within(spread) => Some(Fitted { element, range, spread }),
                Verdict::Outside { .. } | Verdict::Unproved { .. } => None,
            }
        })
    }

    /// The largest deviation over `range` as a share of the band, by the shape with the least share; at one
    /// the element reaches the edge of the band. The deviation is sampled, which is good enough for a search.
    pub fn strain(&self, range: [f64; 2]) -> f64 {
        let strains = self.method.shapes().iter().filter_map(|shape| {
            let element = self.element(*shape, range)?;
            Some(self.strain_of(&element, range))
        });
        strains.fold(f64::INFINITY, f64::min)
    }

    /// As `strain`, for lines along a curve that bends to one side only. There the deviation is largest where
    /// the curve is parallel to the line, and a few tangents find that place.
    pub fn strain_of_hump(&self, [from, to]: [f64; 2]) -> f64 {
        let Some(line) = self.element(Shape::Line, [from, to]) else { return f64::INFINITY };
        let along = line.end() - line.start();
        let turned = |t: f64| along.perp(&self.curve.derivative(t));
        let (at_from, at_to) = (turned(from), turned(to));
        // At a corner, the last parameter of a piece has the tangent of the next piece. The signs may then
        // agree, and samples serve instead.
        if at_from == 0.0 || at_to == 0.0 || (at_from > 0.0) == (at_to > 0.0) {
            return self.strain([from, to]);
        }
        let sign = at_from.signum();
        let top = root(|t| sign * turned(t), [from, to], TOP_PART);
        self.part(&line, top, self.distance(&line, top, 0.5))
    }

    /// The share of the band that a deviation takes up, for a curve that lies `distance` mm to the left of an
    /// element. The band's side is widened by half of the rounding that proofs allow for.
    fn part(&self, element: &Element, t: f64, distance: f64) -> f64 {
        let [below_mm, above_mm] = self.sides(t);
        let guard = GUARD_MM + 0.5 * GUARD_PART * element.magnitude();
        if distance > 0.0 { distance / (below_mm + guard) } else { -distance / (above_mm + guard) }
    }

    /// The widths of the band below and above at a parameter, mm.
    fn sides(&self, t: f64) -> [f64; 2] {
        if self.along.varies() { self.along.at(t) } else { [self.band.below_mm, self.band.above_mm] }
    }

    /// The widths in the middle of a range, for the choice of an element.
    fn sides_of(&self, [from, to]: [f64; 2]) -> [f64; 2] {
        self.sides(0.5 * (from + to))
    }

    /// Whether the narrow side of the band has no room for any element near `range`: if both sides were as
    /// wide as the wider one, an element [`HOPELESS_FACTOR`] times as long would fit.
    pub fn is_hopeless(&self, [from, to]: [f64; 2]) -> bool {
        let Band { below_mm, above_mm, .. } = self.band;
        if self.along.varies() || below_mm.min(above_mm) > NO_ROOM_PART * below_mm.max(above_mm) {
            return false;
        }
        let wide = below_mm.max(above_mm);
        let relaxed = Self { band: Band { below_mm: wide, above_mm: wide, ..self.band }, ..*self };
        let [first, last] = self.curve.domain();
        let length = HOPELESS_FACTOR * (to - from);
        length < last - first
            && relaxed
                .fit(if from + length <= last { [from, from + length] } else { [to - length, to] })
                .is_some()
    }

    fn element(&self, shape: Shape, [from, to]: [f64; 2]) -> Option<Element> {
        let [start, end] = [from, to].map(|t| self.curve.point(t));
        if start == end {
            return None;
        }
        match shape {
            Shape::Line => Some(Segment::Line { start, end }.into()),
            Shape::Parabola if self.is_lopsided([from, to]) => {
                let chord = (end - start).normalize();
                let axis = if self.curve.is_graph() { Vector2::y() } else { Vector2::new(-chord.y, chord.x) };
                let bows = Bow::Parabolas { start, end, axis };
                bows.element(self.best_bow(&bows, [from, to])?)
            }
            Shape::Parabola => {
                Some(Element::parabola_through([start, self.curve.point(0.5 * (from + to)), end]))
            }
            Shape::Arc => self.arc([from, to], start, end),
        }
    }

    /// Whether one side of the band is narrower than the other. Then the paper's parabola, which meets the
    /// curve in its middle, wastes the wide side, and deviations to the narrow side are large only near the
    /// ends.
    fn is_lopsided(&self, range: [f64; 2]) -> bool {
        let [below_mm, above_mm] = self.sides_of(range);
        below_mm.min(above_mm) < LOPSIDED_PART * below_mm.max(above_mm)
    }

    /// The places at which deviations are sampled, as shares of the range.
    fn places(&self, range: [f64; 2]) -> &'static [f64] {
        if self.is_lopsided(range) { &GRADED } else { &EVEN }
    }

    /// How far the curve lies to the left of `element` at `t`, mm.
    fn distance(&self, element: &Element, t: f64, near: f64) -> f64 {
        let p = self.curve.point(t);
        match self.band.measure {
            Measure::Normal => {
                let (foot, _) = element.foot(p, near);
                // Beyond an end of the element, the point is farther from the element than from its
                // continuation.
                let out = (-foot.u).max(foot.u - 1.0);
                if out <= END_ROUNDING {
                    foot.distance
                } else {
                    foot.distance.hypot(out * element.speed([foot.u; 2]).lo())
                }
            }
            Measure::Vertical => element.graph_at(t).map_or(f64::INFINITY, |y| p.y - y),
        }
    }

    fn strain_of(&self, element: &Element, [from, to]: [f64; 2]) -> f64 {
        let at = |s: f64| {
            let t = from + (to - from) * s;
            self.part(element, t, self.distance(element, t, s))
        };
        // Other peaks that are nearly as high are left to the proof.
        peak(at, self.places([from, to]), [0.0, 0.0], PEAK_STEPS)
            .map_or(f64::INFINITY, |[_, most]| most.max(0.0))
    }

    /// The arc whose deviations use both sides of the band alike; a line if the arc would be too flat to be
    /// run as an arc.
    fn arc(&self, [from, to]: [f64; 2], start: Point2<f64>, end: Point2<f64>) -> Option<Element> {
        let half = 0.5 * (end - start).norm();
        let bows = Bow::Arcs { start, end };
        let bulge = self.best_bow(&bows, [from, to])?;
        let line = Segment::Line { start, end };
        let [below, above] = self.sides_of([from, to]).map(|mm| mm + GUARD_MM);
        let is_near = |s: &f64| {
            (-above..=below).contains(&line.foot(self.curve.point(from + (to - from) * s)).distance)
        };
        let is_straight = self.places([from, to]).iter().all(is_near);
        let is_too_large = half * (1.0 + bulge * bulge) > 2.0 * bulge.abs() * self.largest_radius_mm;
        if is_too_large || (is_straight && (bulge * half).abs() < FLATTEST_MM) {
            return Some(line.into());
        }
        Some(Segment::bulging(start, end, bulge).into())
    }

    /// The bow whose deviations use both sides of the band alike; `None` if it is not finite.
    fn best_bow(&self, bows: &Bow, [from, to]: [f64; 2]) -> Option<f64> {
        let [below_mm, above_mm] = self.sides_of([from, to]);
        let point = |s: f64| self.curve.point(from + (to - from) * s);
        if below_mm.min(above_mm) > NO_ROOM_PART * below_mm.max(above_mm) || below_mm == above_mm {
            return self.balanced_bow(bows, [from, to], point);
        }
        // The least of the bows leaves the whole curve to the left of the element, the largest leaves it to
        // the right.
        let sign = if above_mm < below_mm { -1.0 } else { 1.0 };
        let tangents = [self.curve.derivative(from), self.curve.derivative(to.next_down())];
        let at_ends = bows.along(tangents).map(|bow| sign * bow);
        let [_, inside] = peak(|s| sign * bows.through(point(s)), &EVEN, at_ends, TOUCH_STEPS)?;
        let most = at_ends[0].max(at_ends[1]).max(inside);
        let clear = bows.rise(CLEAR_PART * below_mm.max(above_mm));
        Some(sign * (most + clear)).filter(|bow| bow.is_finite())
    }

    /// As `best_bow`, for a band with room on both sides; `point` maps 0 to 1 to the points of the curve.
    fn balanced_bow(&self, bows: &Bow, range: [f64; 2], point: impl Fn(f64) -> Point2<f64>) -> Option<f64> {
        let sides = self.sides_of(range);
        let wide = sides[0].max(sides[1]);
        // A very narrow side is not used up, because its deviations are not found exactly.
        let [below, above] =
            sides.map(|mm| GUARD_MM + if mm < NARROW_PART * wide { NARROW_USE * mm } else { mm });
        let balance = |points: &[Point2<f64>], part: f64| {
            let through: Vec<f64> = points.iter().map(|p| bows.through(*p)).collect();
            let low = through.iter().copied().fold(f64::INFINITY, f64::min);
            let high = through.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            // Every distance falls as the bow grows, so this balance of both sides has one root.
            let lack = |bow: f64| {
                let distance = bows.distance(bow);
                let [least, most] = points
                    .iter()
                    .map(|p| distance(*p))
                    .fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], d| [a.min(d), b.max(d)]);
                most * above + least * below
            };
            through.iter().all(|bow| bow.is_finite()).then(|| root(lack, [low, high], part))
        };
        let mut points: Vec<Point2<f64>> = self.places(range).iter().map(|s| point(*s)).collect();
        if !self.is_lopsided(range) {
            return balance(&points, EVEN_BOW_PART);
        }
        let mut bow = balance(&points, FIRST_BOW_PART)?;
        for _ in 0..EXCHANGES {
            let distance = bows.distance(bow);
            for sign in [1.0, -1.0] {
                let side = |s: f64| sign * distance(point(s));
                points.extend(peak(side, &GRADED, [0.0, 0.0], PEAK_STEPS).map(|[s, _]| point(s)));
            }
            bow = balance(&points, BOW_PART)?;
        }
        Some(bow)
    }
}

/// The root of a falling function between two places, by regula falsi (the Illinois variant), to the share
/// `part` of the width. If the sign does not change, the end with the smaller value.
fn root(f: impl Fn(f64) -> f64, [mut low, mut high]: [f64; 2], part: f64) -> f64 {
    let width = high - low;
    let (mut at_low, mut at_high) = (f(low), f(high));
    if !(at_low > 0.0 && at_high < 0.0) {
        return if at_low.abs() <= at_high.abs() { low } else { high };
    }
    let mut side = 0;
    for _ in 0..BULGE_STEPS {
        let next = (low * at_high - high * at_low) / (at_high - at_low);
        if !(low < next && next < high) {
            break;
        }
        let value = f(next);
        let step = (next - low).min(high - next);
        if value > 0.0 {
            (low, at_low) = (next, value);
            if side == 1 {
                at_high *= 0.5;
            }
            side = 1;
        } else if value < 0.0 {
            (high, at_high) = (next, value);
            if side == -1 {
                at_low *= 0.5;
            }
            side = -1;
        } else {
            return next;
        }
        if step <= part * width {
            return next;
        }
    }
    0.5 * (low + high)
}

/// Where `f` is largest between 0 and 1, and its value there: the best of `places`, refined by parabolas
/// through three places. `at_ends` are the values at 0 and 1. `None` if `f` is not finite at one of the
/// places.
fn peak(f: impl Fn(f64) -> f64, places: &[f64], at_ends: [f64; 2], steps: usize) -> Option<[f64; 2]> {
    let mut x = [0.0; GRADED.len() + 2];
    let mut y = [at_ends[0]; GRADED.len() + 2];
    for (k, place) in places.iter().enumerate() {
        (x[k + 1], y[k + 1]) = (*place, f(*place));
        if !y[k + 1].is_finite() {
            return None;
        }
    }
    let last = places.len() + 1;
    (x[last], y[last]) = (1.0, at_ends[1]);
    let best = (1..last).fold(1, |best, k| if y[k] > y[best] { k } else { best });
    if !(y[best - 1].is_finite() && y[best + 1].is_finite()) {
        return Some([x[best], y[best]]);
    }
    let near = |values: [f64; GRADED.len() + 2]| [values[best - 1], values[best], values[best + 1]];
    Some(climb(f, near(x), near(y), steps))
}

/// The place and the value of the maximum of `f` near a place where `f` is larger than at two neighbours, by
/// parabolas through three places.
fn climb(f: impl Fn(f64) -> f64, mut x: [f64; 3], mut y: [f64; 3], steps: usize) -> [f64; 2] {
    let close = CLOSE_PART * (x[2] - x[0]).min(2.0 * (x[1] - x[0]));
    for _ in 0..steps {
        let (a, b) = ((y[1] - y[0]) / (x[1] - x[0]), (y[2] - y[1]) / (x[2] - x[1]));
        let bend = (b - a) / (x[2] - x[0]);
        let at = 0.5 * (x[0] + x[1]) - 0.5 * a / bend;
        if !(bend < 0.0 && at > x[0] && at < x[2]) || (at - x[1]).abs() < close {
            break;
        }
        let value = f(at);
        if value.is_nan() {
            break;
        }
        // Keep the highest of the four places, between its neighbours.
        let (is_before, is_higher) = (at < x[1], value > y[1]);
        match (is_before, is_higher) {
            (true, true) => (x, y) = ([x[0], at, x[1]], [y[0], value, y[1]]),
            (false, true) => (x, y) = ([x[1], at, x[2]], [y[1], value, y[2]]),
            (true, false) => (x[0], y[0]) = (at, value),
            (false, false) => (x[2], y[2]) = (at, value),
        }
    }
    [x[1], y[1]]
}
