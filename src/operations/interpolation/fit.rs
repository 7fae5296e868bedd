//! The element over a range of parameters: made by its shape, guessed at by samples, proved by [`judge`].

use nalgebra::{Point2, Vector2};

use super::job::Method;
use crate::geometry::arc_fit::{FLATTEST_MM, LARGEST_RADIUS_MM};
use crate::geometry::deviation::{Band, Ends, GUARD_MM, Measure, Spread, Verdict, judge};
use crate::geometry::element::{Element, PlaneArc};
use crate::geometry::plane_curve::PlaneCurve;

/// Places at which a deviation is looked for, and steps of parabolas through three of them to where it is largest.
const SAMPLES: usize = 9;
const PEAK_STEPS: usize = 4;

/// A side of the band that is narrower than this part of the other has no room for an element that bends to it; one that is
/// this much shorter than the other side would take is there by rounding.
const NO_ROOM_PART: f64 = 1e-7;
const HOPELESS_FACTOR: f64 = 1024.0;

/// Steps in the search for the best bulge; it takes five to ten.
const BULGE_STEPS: usize = 40;

/// What an element may be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    Line,
    Parabola,
    Arc,
}

impl Method {
    /// The shapes that are tried, in this order.
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
    /// The range of the curve's parameter that it stands for.
    pub range: [f64; 2],
    pub spread: Spread,
}

/// Makes elements with joints on a curve.
#[derive(Clone, Copy)]
pub struct Fitter<'a, C> {
    pub curve: &'a C,
    pub method: Method,
    pub band: Band,
    pub element_limit: usize,
}

impl<C: PlaneCurve> Fitter<'_, C> {
    /// The first shape that is proved to stay within the band over `range`.
    pub fn fit(&self, range: [f64; 2]) -> Option<Fitted> {
        self.method.shapes().iter().find_map(|shape| {
            let element = self.element(*shape, range)?;
            match judge(self.curve, &element, range, Ends::OnCurve, &self.band) {
                Verdict::Within(spread) => Some(Fitted { element, range, spread }),
                Verdict::Outside { .. } | Verdict::Unproved { .. } => None,
            }
        })
    }

    /// The largest deviation over `range` in parts of the band, by the shape that needs least: one is its edge. It is found
    /// by samples: good enough to search with.
    pub fn strain(&self, range: [f64; 2]) -> f64 {
        let strains = self.method.shapes().iter().filter_map(|shape| {
            let element = self.element(*shape, range)?;
            Some(self.strain_of(&element, range))
        });
        strains.fold(f64::INFINITY, f64::min)
    }

    /// As `strain`, for lines along a curve that bends to one side only: there the deviation is largest where the curve runs
    /// along the line, which takes a few tangents to find.
    pub fn strain_of_hump(&self, [from, to]: [f64; 2]) -> f64 {
        let Some(line) = self.element(Shape::Line, [from, to]) else { return f64::INFINITY };
        let along = line.end() - line.start();
        let turned = |t: f64| along.perp(&self.curve.derivative(t));
        let (at_from, at_to) = (turned(from), turned(to));
        // The last parameter of a piece that ends in a corner has the tangent of the next.
        if at_from == 0.0 || at_to == 0.0 || (at_from > 0.0) == (at_to > 0.0) {
            return self.strain([from, to]);
        }
        let sign = at_from.signum();
        let top = root(|t| sign * turned(t), [from, to], 1e-7);
        self.part(self.distance(&line, top, 0.5))
    }

    /// A distance of the curve to the left of an element in parts of the side of the band it is on.
    fn part(&self, distance: f64) -> f64 {
        let Band { below_mm, above_mm, .. } = self.band;
        if distance > 0.0 { distance / (below_mm + GUARD_MM) } else { -distance / (above_mm + GUARD_MM) }
    }

    /// Whether an element over `range` is so much shorter than one that both sides of the band would take if they were as wide
    /// as the wider that it is the narrow side that has no room for any.
    pub fn is_hopeless(&self, [from, to]: [f64; 2]) -> bool {
        let Band { below_mm, above_mm, .. } = self.band;
        if below_mm.min(above_mm) > NO_ROOM_PART * below_mm.max(above_mm) {
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
        match shape {
            Shape::Line => (start != end).then_some(Element::Line { start, end }),
            Shape::Parabola => {
                let element = Element::parabola_through([start, self.curve.point(0.5 * (from + to)), end]);
                (start != end).then_some(element)
            }
            Shape::Arc => self.arc([from, to], start, end),
        }
    }

    /// How far the curve lies to the left of `element` at `t`, mm.
    fn distance(&self, element: &Element, t: f64, near: f64) -> f64 {
        let p = self.curve.point(t);
        match self.band.measure {
            Measure::Normal => {
                let foot = element.foot(p, near);
                // Behind an end it is farther away than it seems.
                let out = (-foot.u).max(foot.u - 1.0);
                if out <= 1e-9 { foot.distance } else { foot.distance.hypot(out * element.speed().lo()) }
            }
            Measure::Vertical => element.graph_at(t).map_or(f64::INFINITY, |y| p.y - y),
        }
    }

    fn strain_of(&self, element: &Element, [from, to]: [f64; 2]) -> f64 {
        let at = |s: f64| self.distance(element, from + (to - from) * s, s);
        let step = 1.0 / (SAMPLES + 1) as f64;
        let mut read = [0.0; SAMPLES + 2];
        for (k, distance) in read.iter_mut().enumerate().take(SAMPLES + 1).skip(1) {
            *distance = at(k as f64 * step);
        }
        let (mut best, mut most) = (1, 0.0);
        for (k, distance) in read.iter().enumerate() {
            if self.part(*distance) > most {
                (best, most) = (k, self.part(*distance));
            }
        }
        if !most.is_finite() {
            return f64::INFINITY;
        }
        // Other peaks that are nearly as high are found by the proof, if at all.
        climb(
            |s| self.part(at(s)),
            best as f64 * step,
            step,
            [best - 1, best, best + 1].map(|k| self.part(read[k])),
        )
    }

    /// The arc whose deviations use both sides of the band alike; a line where it would be too flat to be run as an arc.
    fn arc(&self, [from, to]: [f64; 2], start: Point2<f64>, end: Point2<f64>) -> Option<Element> {
        let chord = end - start;
        let half = 0.5 * chord.norm();
        if half == 0.0 {
            return None;
        }
        let points: [Point2<f64>; SAMPLES] = std::array::from_fn(|k| {
            self.curve.point(from + (to - from) * ((k + 1) as f64 / (SAMPLES + 1) as f64))
        });
        let bulges = points.map(|p| bulge_through(p, start, chord / (2.0 * half), half));
        let [low, high] = bulges
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], b| [low.min(*b), high.max(*b)]);
        if !(low.is_finite() && high.is_finite()) {
            return None;
        }
        let (below, above) = (self.band.below_mm + GUARD_MM, self.band.above_mm + GUARD_MM);
        // Every distance falls as the bulge grows: the root of what the sides lack.
        let lack = |bulge: f64| {
            let arc =
                PlaneArc::with_bulge(start, end, bulge).map_or(Element::Line { start, end }, Element::Arc);
            let distances = points.map(|p| arc.foot(p, 0.5).distance);
            let left = distances.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b));
            let right = -distances.iter().fold(f64::INFINITY, |a, b| a.min(*b));
            left * above - right * below
        };
        let bulge = root(lack, [low, high], 1e-12);
        let line = Element::Line { start, end };
        let distances = points.map(|p| line.foot(p, 0.5).distance);
        let is_straight = distances.iter().all(|distance| (-above..=below).contains(distance));
        let is_too_large = half * (1.0 + bulge * bulge) > 2.0 * bulge.abs() * LARGEST_RADIUS_MM;
        if is_too_large || (is_straight && (bulge * half).abs() < FLATTEST_MM) {
            return Some(line);
        }
        Some(PlaneArc::with_bulge(start, end, bulge).map_or(line, Element::Arc))
    }
}

/// The bulge of the arc over a chord that goes through `p`; of the many it has the one that turns least.
fn bulge_through(p: Point2<f64>, start: Point2<f64>, along: Vector2<f64>, half: f64) -> f64 {
    let from = p - start;
    let (x, y) = (from.dot(&along) - half, along.perp(&from));
    let from_end = (x - half).hypot(y);
    // tan(turn / 4) from tan(turn / 2): the chord is seen from the arc under half a turn less half of the arc's.
    let k = x * x + y * y - half * half;
    2.0 * half * y / ((from.norm() * from_end) - k)
}

/// The root of a falling function between two places, by regula falsi (the Illinois variant), to a part of the width.
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

/// The largest value of `f` near a sample that is larger than its neighbours, by parabolas through three places.
fn climb(f: impl Fn(f64) -> f64, middle: f64, step: f64, values: [f64; 3]) -> f64 {
    let mut x = [middle - step, middle, middle + step];
    let mut y = values;
    for _ in 0..PEAK_STEPS {
        let (a, b) = ((y[1] - y[0]) / (x[1] - x[0]), (y[2] - y[1]) / (x[2] - x[1]));
        let bend = (b - a) / (x[2] - x[0]);
        let at = 0.5 * (x[0] + x[1]) - 0.5 * a / bend;
        if !(bend < 0.0 && at > x[0] && at < x[2]) || (at - x[1]).abs() < 1e-5 * step {
            break;
        }
        let value = f(at);
        if value.is_nan() || value <= y[1] {
            break;
        }
        if at < x[1] {
            (x[2], y[2]) = (x[1], y[1]);
        } else {
            (x[0], y[0]) = (x[1], y[1]);
        }
        (x[1], y[1]) = (at, value);
    }
    y[1]
}
