//! Computes a lower bound for the number of elements that a curve needs, if all joints lie on the curve.
//!
//! # Method
//! 1. Let r be the start of the curve, and count no element yet.
//! 2. Find a place b such that every element that starts at r or before r, and stays within the band, ends at
//!    b or before b.
//! 3. Count one element, and take b as the next r. Repeat steps 2 and 3 until r is the end of the curve. The
//!    count is the lower bound. If the steps of the search end before (`meter`), the lower bound is one more
//!    than the count.
//!
//! A place b is proved in one of two ways:
//! * *Lines on a convex part of the curve.* The line from r to b leaves the band.
//! * *All other cases.* A few points of the curve between r and b are so placed that no element passes near
//!   enough to all of them: three points for lines, four for arcs and parabolas.
//!
//! # Guarantees
//! The bound holds up to a rounding of 1e-9 of the width of the band. For lines on a convex curve it is the
//! number that greedy growth finds (`least`). For arcs and parabolas it is about a tenth below that number.
//! In the worst case seen, near inflections, it is a third below. For parabolas on a curve that is no graph
//! y(x), it is 1.
//!
//! # Reference
//! Lines and parabolas: C. J. de la Vallee Poussin's theorem; arcs: Ebara, Fukuyama, Nakano, Nakanishi,
//! *Roundness algorithms using the Voronoi diagrams*, CCCG 1989.

use nalgebra::{Matrix2, Point2, Vector2};

use super::Error;
use super::fit::{Fitted, Fitter};
use super::job::Method;
use crate::geometry::deviation::{Ends, GUARD_MM, Measure, Verdict, judge};
use crate::geometry::interval::Interval;
use crate::geometry::plane_curve::{Enclosure, PlaneCurve};
use crate::geometry::segment::Segment;
use crate::geometry::solve::bisect;

/// How far beyond the guessed reach an element is tested, as shares of its length. The first element that
/// leaves the band bounds the reach.
const BEYOND_PARTS: [f64; 5] = [1e-6, 1e-4, 1e-3, 1e-2, 5e-2];

/// Lengths, in multiples of the guessed length, that are tried in turn for one that no element reaches. The
/// curve must be convex up to there.
const FAR_FACTORS: [f64; 3] = [1.5, 2.0, 3.0];

/// How often a range is halved to show that the curve is convex there.
const HALVINGS: u32 = 4;

/// A jump of the tangent by more than this sine makes a corner: the curve does not count as convex there.
const CORNER_SINE: f64 = 1e-9;

/// The rounding of a turn of the curve, as a part of the product of both derivatives. A curve that is
/// straight up to rounding counts as convex.
const STRAIGHT_PART: f64 = 1e-12;

/// The part of its width by which the band is exceeded before points rule an element out. It is above the
/// rounding of widths and divided differences, and the bound of the report holds up to it.
const WIDTH_ROUNDING: f64 = 1e-9;

/// The places of the four points that rule out an arc or a parabola, as shares of the range: those of
/// Chebyshev.
const FOUR: [f64; 4] = [0.0, 0.25, 0.75, 1.0];

/// Points from which the three that rule out a line are chosen.
const LINE_POINTS: usize = 17;

/// A range grows by the factor `GROWTH` until an element is ruled out. Then `REFINEMENTS` bisection steps
/// refine its length.
const GROWTH: f64 = 1.04;
const REFINEMENTS: usize = 8;

/// A lower bound for the number of elements over the range of `guide`, whose elements are each as long as
/// possible.
///
/// # Errors
/// When the budget ends.
pub fn lower_bound(fitter: &Fitter<impl PlaneCurve>, guide: &[Fitted]) -> Result<usize, Error> {
    let (Some(first), Some(last)) = (guide.first(), guide.last()) else { return Ok(0) };
    let (from, to) = (first.range[0], last.range[1]);
    let end = fitter.meter.end_of_search();
    let (mut before, mut reached, mut count, mut at) = (from, from, 0usize, 0);
    while reached < to {
        fitter.meter.check()?;
        if fitter.meter.is_past(end) {
            // At least one more element leads to the end.
            return Ok(count + 1);
        }
        while guide[at].range[1] <= reached {
            at += 1;
        }
        let next =
            fitter.reach_at_most([before, reached, to], guide[at].range, guide.get(at + 1).map(|g| g.range));
        (before, reached) = (reached, next);
        count += 1;
    }
    Ok(count)
}

impl<C: PlaneCurve> Fitter<'_, C> {
    /// An upper bound for the end of every element that starts between `before` and `start`. `own` is the
    /// range of the guide's element with `start` in it; `next` is the range of the element after it.
    fn reach_at_most(&self, [before, start, to]: [f64; 3], own: [f64; 2], next: Option<[f64; 2]>) -> f64 {
        let Some(next) = next else { return to };
        // The guessed end lies as far into the next element as the start lies into its own.
        let part = (start - own[0]) / (own[1] - own[0]);
        let length = next[0] + part * (next[1] - next[0]) - start;
        if self.method == Method::Linear {
            // No element reaches past this place, so the curve has to be convex only up to it.
            let farthest = FAR_FACTORS.iter().map(|factor| start + factor * length);
            let farthest = farthest.take_while(|end| *end < to).find(|end| self.rules_out([start, *end]));
            if let Some(farthest) = farthest.filter(|farthest| self.is_convex([before, *farthest])) {
                let ends = BEYOND_PARTS.iter().map(|beyond| start + length * (1.0 + beyond));
                let mut ends = ends.take_while(|end| *end < farthest);
                if let Some(end) = ends.find(|end| self.is_outside([start, *end])) {
                    return end;
                }
            }
        }
        self.free_reach([start, to], length)
    }

    /// Whether the chord over a range certainly leaves the band.
    fn is_outside(&self, [from, to]: [f64; 2]) -> bool {
        let line = Segment::Line { start: self.curve.point(from), end: self.curve.point(to) };
        matches!(
            judge(self.curve, &line.into(), [from, to], Ends::OnCurve, &self.band),
            Verdict::Outside { .. }
        )
    }

    /// Whether the curve turns to one side only over a range; by the normal measure also by less than a right
    /// angle.
    ///
    /// Then a part of the curve is no higher over its own chord than the whole is over the whole's chord. The
    /// part lies in a strip of the whole's height along the whole's chord, over which the curve is a graph.
    /// At the point of the part farthest from its chord, the tangent is parallel to that chord. So this point
    /// lies on the side of the apex where the strip's height counts in full, and its distance is at most that
    /// height times the cosine between the chords. By the vertical measure the chord of the whole lies above
    /// the chord of the part, without a condition on the tangents.
    fn is_convex(&self, [from, to]: [f64; 2]) -> bool {
        let breaks = self.curve.breaks();
        let along = (self.curve.point(to) - self.curve.point(from)).normalize();
        let first = breaks.partition_point(|t| *t <= from);
        let last = breaks.partition_point(|t| *t < to).max(first);
        let breaks = &breaks[first..last];
        let (mut left, mut right) = (true, true);
        let mut start = from;
        for end in breaks.iter().copied().chain([to]) {
            let mut open = vec![(start, end, HALVINGS)];
            while let Some((a, b, halvings)) = open.pop() {
                match self.turns([a, b], along) {
                    Some(side) => (left, right) = (left && side[0], right && side[1]),
                    None if halvings == 0 => return false,
                    None => {
                        let middle = 0.5 * (a + b);
                        open.extend([(a, middle, halvings - 1), (middle, b, halvings - 1)]);
                    }
                }
            }
            start = end;
        }
        (left || right) && !breaks.iter().any(|t| self.curve.has_corner(*t, CORNER_SINE))
    }

    /// Whether the curve turns only to the left, and whether only to the right, over a range without breaks.
    /// A straight piece does both. `None` if this cannot be told; by the normal measure also if the tangents
    /// are not within half a right angle of `along`.
    fn turns(&self, [from, to]: [f64; 2], along: Vector2<f64>) -> Option<[bool; 2]> {
        let Enclosure { first, second, .. } = self.curve.enclose(from, to);
        if self.band.measure == Measure::Normal {
            let ahead = first[0] * along.x + first[1] * along.y;
            let aside = first[1] * along.x - first[0] * along.y;
            if aside.mag() > ahead.lo() {
                return None;
            }
        }
        let turn = first[0] * second[1] - first[1] * second[0];
        let slack = STRAIGHT_PART * (first[0].mag() + first[1].mag()) * (second[0].mag() + second[1].mag());
        let sides = [turn.lo() >= -slack, turn.hi() <= slack];
        (sides[0] || sides[1]).then_some(sides)
    }

    /// An upper bound for the end of every element that stays within the band from `start` on, wherever it
    /// starts.
    fn free_reach(&self, [start, to]: [f64; 2], length: f64) -> f64 {
        if matches!(self.method, Method::Parabolic | Method::Mixed) && !self.curve.is_graph() {
            return to;
        }
        let is_ruled_out = |length: f64| self.rules_out([start, start + length]);
        let (mut low, mut high) = (length, length);
        while !is_ruled_out(high) {
            low = high;
            high *= GROWTH;
            if start + high >= to {
                return to;
            }
        }
        let [ruled_out, _] = bisect([high, low], REFINEMENTS, is_ruled_out);
        start + ruled_out
    }

    /// Whether a few points over a range prove that no element of the method stays within the band there:
    /// * three points, for lines: their triangle is higher than the band is wide;
    /// * four points, for arcs: the thinnest ring that holds them is wider than the band;
    /// * four points of a graph y(x), for parabolas: their third divided difference is too large.
    fn rules_out(&self, [from, to]: [f64; 2]) -> bool {
        let at = |part: f64| from + (to - from) * part;
        match self.method {
            Method::Linear => {
                let points: Vec<_> = (0..LINE_POINTS)
                    .map(|k| self.curve.point(at(k as f64 / (LINE_POINTS - 1) as f64)))
                    .collect();
                let width = self.band.below_mm + self.band.above_mm + 4.0 * GUARD_MM;
                triples(LINE_POINTS)
                    .any(|t| self.thickness(t.map(|k| points[k])) > width * (1.0 + WIDTH_ROUNDING))
            }
            Method::Arc => {
                let width = self.band.below_mm + self.band.above_mm + 4.0 * GUARD_MM;
                // The distance is at most the vertical deviation, so this test serves both measures.
                ring(FOUR.map(|part| self.curve.point(at(part)))) > width * (1.0 + WIDTH_ROUNDING)
            }
            Method::Parabolic | Method::Mixed => self.no_parabola(FOUR.map(at)),
        }
    }

    /// The width of the thinnest strip that holds three points, by the measure of the band.
    fn thickness(&self, [a, b, c]: [Point2<f64>; 3]) -> f64 {
        let twice_area = (b - a).perp(&(c - a)).abs();
        match self.band.measure {
            Measure::Normal => twice_area / (b - a).norm().max((c - b).norm()).max((a - c).norm()),
            Measure::Vertical => twice_area / (c.x - a.x).abs(),
        }
    }

    /// Whether no quadratic function passes near enough to four points of a graph.
    ///
    /// An element within the distance w of the curve lies above or below the curve by at most w sqrt(1 +
    /// m^2). Here m is the largest slope of the curve within w of that place.
    fn no_parabola(&self, x: [f64; 4]) -> bool {
        let [first, last] = self.curve.domain();
        let (below, above) = (self.band.below_mm + 2.0 * GUARD_MM, self.band.above_mm + 2.0 * GUARD_MM);
        // For a quadratic through the points with each y moved by e, the sum of (y + e) / w'(x) is zero.
        let (mut sum, mut least, mut most) = (0.0, 0.0, 0.0);
        for (k, xk) in x.iter().enumerate() {
            let product: f64 = x.iter().enumerate().filter(|(j, _)| *j != k).map(|(_, xj)| xk - xj).product();
            let steepness = match self.band.measure {
                Measure::Vertical => 1.0,
                Measure::Normal => {
                    let reach = below.max(above);
                    let slope = self.curve.enclose((xk - reach).max(first), (xk + reach).min(last)).first[1];
                    (Interval::point(1.0) + slope.sqr()).sqrt().hi()
                }
            };
            sum += self.curve.point(*xk).y / product;
            let (a, b) = (-below * steepness / product, above * steepness / product);
            (least, most) = (least + a.min(b), most + a.max(b));
        }
        let slack = WIDTH_ROUNDING * (most - least);
        !(least - slack..=most + slack).contains(&-sum) && least.is_finite() && most.is_finite()
    }
}

/// For each inner point: the triple with both ends, and the triples in which an end is moved so that the
/// inner point is the middle. They suffice to show how thick a bent strip is.
fn triples(count: usize) -> impl Iterator<Item = [usize; 3]> {
    (1..count - 1).flat_map(move |b| {
        let last = count - 1;
        [[0, b, last], [0, b, (2 * b).min(last)], [(2 * b).saturating_sub(last), b, last]]
            .into_iter()
            .filter(|[a, b, c]| a < b && b < c)
    })
}

/// The width of the thinnest ring, or strip, that holds four points.
///
/// The thinnest ring has two points on each of its circles, or three on one circle and one on the other. The
/// thinnest strip has two points on one of its lines.
fn ring(p: [Point2<f64>; 4]) -> f64 {
    let mut thinnest = strip(p);
    let mut try_center = |center: Option<Point2<f64>>| {
        if let Some(center) = center {
            let distances = p.map(|q| (q - center).norm());
            let [least, most] = distances
                .iter()
                .fold([f64::INFINITY, 0.0], |[least, most], d: &f64| [d.min(least), d.max(most)]);
            // Distances to a centre far away are rounded.
            thinnest = thinnest.min(most - least - 16.0 * f64::EPSILON * most);
        }
    };
    for [a, b, c, d] in [[0, 1, 2, 3], [0, 2, 1, 3], [0, 3, 1, 2]] {
        try_center(equidistant([p[a], p[b]], [p[c], p[d]]));
    }
    for [a, b, c] in [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]] {
        try_center(equidistant([p[a], p[b]], [p[b], p[c]]));
    }
    thinnest
}

/// The point at equal distances from both points of a pair, for two pairs at once; `None` if there is none.
fn equidistant(one: [Point2<f64>; 2], other: [Point2<f64>; 2]) -> Option<Point2<f64>> {
    let [[a, b], [c, d]] = [one, other];
    let (u, v) = (b - a, d - c);
    let middle = |p: Point2<f64>, q: Point2<f64>| nalgebra::center(&p, &q).coords;
    let rows = Matrix2::new(u.x, u.y, v.x, v.y);
    let right = Vector2::new(u.dot(&middle(a, b)), v.dot(&middle(c, d)));
    rows.try_inverse()
        .map(|inverse| Point2::from(inverse * right))
        .filter(|p| p.x.is_finite() && p.y.is_finite())
}

/// The width of the thinnest strip that holds four points.
fn strip(p: [Point2<f64>; 4]) -> f64 {
    let mut thinnest = f64::INFINITY;
    for (i, a) in p.iter().enumerate() {
        for b in &p[i + 1..] {
            let along = b - a;
            let heights = p.map(|q| along.perp(&(q - a)) / along.norm());
            let [least, most] = heights
                .iter()
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], h| [h.min(least), h.max(most)]);
            if (most - least).is_finite() {
                thinnest = thinnest.min(most - least);
            }
        }
    }
    thinnest
}
