//! Decides whether one element can replace a sequence of points between two given ends.
//!
//! # Method
//! The chord is the straight line from one end to the other.
//! 1. The arcs over the chord differ in one number, the bulge: the tangent of a quarter of the sweep. For
//!    each point, [`Chord`] gives the bulges of the arcs that pass within the tolerance of the point. The
//!    bulges that suit all points form at most two intervals.
//! 2. The line and some arcs with bulges in these intervals are tried, until one fits. An element fits if it
//!    passes the points in their order. With [`Measure::Polyline`], the lines between the points also have to
//!    be within the tolerance of the element. If the points have different heights, distances are measured in
//!    space.
//!    At last, an arc from each range is tried in which the lines between the points turn equally far about
//!    the arc's centre (`turns`).
//! 3. The best of the arcs that fit is chosen (`best`).
//!
//! Step 2 tries only some of the arcs. So an element that fits may exist although none is found.

use nalgebra::Vector2;

use super::chord::{Bulges, Chord, LARGEST_BULGE};
use super::chord_frame::{ChordArc, ChordFrame};
use super::{Measure, Shapes, turns};
use crate::geometry::segment::center;

/// Arcs with a smaller radius, in tolerances, are refused for polylines: for such arcs the checks prove
/// nothing about the lines between the points.
const LEAST_RADIUS_TOLERANCES: f64 = 2.0;

/// Search costs in evaluations: of a span in addition to its points, and of a point whose angle or height is
/// checked, as a multiple.
const LOOKS_A_SPAN: usize = 10;
const SLOW_LOOKS: usize = 8;

/// The conditions that an element has to keep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rule {
    pub tolerance_mm: f64,
    pub shapes: Shapes,
    pub measure: Measure,
    /// The largest radius of an arc, mm.
    pub largest_radius_mm: f64,
}

impl Rule {
    /// Whether the lines between the points limit arcs more than the points do.
    pub fn counts_lines(&self) -> bool {
        self.measure == Measure::Polyline && self.shapes == Shapes::ArcsAndLines
    }
}

/// Points in a plane, with their heights over the plane, mm.
#[derive(Debug, Clone, Copy)]
pub struct Points<'a> {
    pub flat: &'a [Vector2<f64>],
    /// Empty if all heights are equal.
    pub heights: &'a [f64],
}

/// An element from `from`, which stands for the point `first`, to `to`, which stands for the point `last`.
#[derive(Debug, Clone, Copy)]
pub struct PointRange<'a> {
    pub points: Points<'a>,
    pub first: usize,
    pub last: usize,
    pub from: Vector2<f64>,
    pub to: Vector2<f64>,
}

/// The points that excluded the last bulges, or refused the last element: they are likely to do so again, and
/// are checked first. Also the number of evaluations so far.
#[derive(Debug, Clone, Copy, Default)]
pub struct Witnesses {
    low: usize,
    high: usize,
    /// A point that was too far from an element.
    far: usize,
    /// Two points that were out of order on an element.
    crossed: [usize; 2],
    pub looks: usize,
}

impl Witnesses {
    pub fn points(self) -> impl Iterator<Item = usize> {
        [self.low, self.high].into_iter()
    }
}

impl<'a> PointRange<'a> {
    pub fn of(points: Points<'a>, first: usize, last: usize) -> Self {
        Self { points, first, last, from: points.flat[first], to: points.flat[last] }
    }

    /// Whether the element starts and ends on points.
    pub fn is_on_points(&self) -> bool {
        [self.from, self.to] == [self.first, self.last].map(|k| self.points.flat[k])
    }

    pub fn inner(&self) -> &'a [Vector2<f64>] {
        &self.points.flat[self.first + 1..self.last]
    }

    /// The bulges of arcs, up to `largest`, that pass within `tolerance` mm of every inner point; `None` if
    /// there are none.
    pub fn near(&self, tolerance: f64, largest: f64, witnesses: &mut Witnesses) -> Option<Bulges> {
        let chord = Chord::new(self.from, self.to)?;
        let mut bulges = Bulges::up_to(largest);
        witnesses.looks += LOOKS_A_SPAN;
        for k in [witnesses.low, witnesses.high] {
            if self.holds(k) {
                chord.keep_near(self.points.flat[k], tolerance, &mut bulges);
            }
        }
        if bulges.is_empty() {
            return None;
        }
        // A coarse pass first: if no bulge is left, a few points show it.
        let inner = self.inner();
        let stride = (inner.len() / 32).max(1);
        let strides: &[usize] = if stride > 1 { &[stride, 1] } else { &[1] };
        for &stride in strides {
            for k in (0..inner.len()).step_by(stride) {
                witnesses.looks += 1;
                let before = bulges;
                chord.keep_near(inner[k], tolerance, &mut bulges);
                if bulges.least > before.least {
                    witnesses.low = self.first + 1 + k;
                }
                if bulges.most < before.most {
                    witnesses.high = self.first + 1 + k;
                }
                if bulges.least > bulges.most {
                    return None;
                }
            }
        }
        (!bulges.is_empty()).then_some(bulges)
    }

    /// The bulges of arcs that keep the rule's tolerance at every inner point and, for polylines, along the
    /// lines; `None` if there are none.
    pub fn bulges(&self, rule: &Rule, witnesses: &mut Witnesses) -> Option<Bulges> {
        let largest = match rule.shapes {
            Shapes::LinesOnly => 0.0,
            Shapes::ArcsAndLines => LARGEST_BULGE,
        };
        let bulges = self.near(rule.tolerance_mm, largest, witnesses)?;
        if rule.counts_lines() { self.near_lines(bulges, rule) } else { Some(bulges) }
    }

    /// Removes from `bulges` the arcs that leave a line between the points too far on their inside; `None` if
    /// none is left.
    fn near_lines(&self, mut bulges: Bulges, rule: &Rule) -> Option<Bulges> {
        let chord = Chord::new(self.from, self.to)?;
        for [a, b] in self.lines() {
            if let Some(highest) = chord.highest_over(a, b, rule.tolerance_mm) {
                bulges.most = bulges.most.min(highest);
            }
            if let Some(lowest) = chord.lowest_under(a, b, rule.tolerance_mm) {
                bulges.least = bulges.least.max(lowest);
            }
        }
        (!bulges.is_empty()).then_some(bulges)
    }

    /// The lines between neighbouring points, from `first` to `last`. The element itself may start and end
    /// beside these points.
    pub fn lines(&self) -> impl Iterator<Item = [Vector2<f64>; 2]> + 'a {
        self.points.flat[self.first..=self.last].windows(2).map(|pair| [pair[0], pair[1]])
    }

    /// A bulge that keeps the rule, 0 for a line; `None` if none was found.
    pub fn find(&self, rule: &Rule, witnesses: &mut Witnesses) -> Option<f64> {
        if self.last == self.first + 1 {
            return Some(0.0);
        }
        let any_measure = Rule { measure: Measure::Points, ..*rule };
        let near = self.bulges(&any_measure, witnesses)?;
        let chord = Chord::new(self.from, self.to)?;
        let mut keeps = |bulge: &f64| self.keeps(*bulge, rule, &chord, witnesses);
        // Mostly the lines exclude nothing that the points allow, so a few candidates are tried without the
        // lines' limits.
        let most = if rule.counts_lines() { 2 } else { usize::MAX };
        let mut allowed = near;
        let flattest = chord.flattest(rule.largest_radius_mm);
        let mut found = self.candidates(&near, flattest).take(most).find(&mut keeps);
        if found.is_none() && rule.counts_lines() {
            allowed = self.near_lines(near, rule)?;
            found = self.candidates(&allowed, flattest).find(&mut keeps);
        }
        found.or_else(|| {
            turns::one_bulge_per_range(self.lines(), &allowed, &chord, flattest).into_iter().find(keeps)
        })
    }

    /// The bulges to try: that of a line, and of arcs from all over the set.
    fn candidates(&self, bulges: &Bulges, flattest: f64) -> impl Iterator<Item = f64> + use<> {
        const PLACES: [f64; 19] = [
            0.5, 0.25, 0.75, 0.02, 0.98, 0.125, 0.375, 0.625, 0.875, 0.0625, 0.1875, 0.3125, 0.4375, 0.5625,
            0.6875, 0.8125, 0.9375, 0.005, 0.995,
        ];
        let line = bulges.contains(0.0).then_some(0.0);
        let arcs = bulges.curved(flattest).flat_map(|part| {
            // Evenly by the arc's angle: evenly by the bulge, most would be nearly full circles.
            let [low, high] = part.map(f64::atan);
            PLACES.into_iter().map(move |place| (low + (high - low) * place).tan())
        });
        line.into_iter().chain(arcs)
    }

    /// Whether the points' nearest places on the arc's circle, or on the chord, run from one end to the other
    /// and never back.
    fn advances(&self, track: &ChordFrame) -> bool {
        let points = [self.from].into_iter().chain(self.inner().iter().copied()).chain([self.to]);
        let Some(ChordArc { bulge, .. }) = track.arc() else {
            let along = self.to - self.from;
            return points.map(|p| along.dot(&p)).is_sorted();
        };
        let center = center(self.from, self.to, *bulge);
        // An arc to the left of its chord turns clockwise.
        let turned = |a: &Vector2<f64>, b: &Vector2<f64>| if *bulge > 0.0 { b.perp(a) } else { a.perp(b) };
        // The first and the last line belong to points that may lie beside the element's ends.
        let flat = self.points.flat;
        let is_backward = |k: usize| turned(&(flat[k] - center), &(flat[k + 1] - center)) < 0.0;
        if is_backward(self.first) || is_backward(self.last - 1) {
            return false;
        }
        let start = self.from - center;
        let (mut before, mut is_past_half) = (start, false);
        points.skip(1).all(|p| {
            let radial = p - center;
            let (step, from_start) = (turned(&before, &radial), turned(&start, &radial));
            let is_forward = step > 0.0 || step == 0.0 && before.dot(&radial) > 0.0;
            // A point on the first half of the turn, after one on the second half, has gone round more than
            // once.
            let is_once = !is_past_half || from_start < 0.0;
            is_past_half |= from_start < 0.0;
            before = radial;
            is_forward && is_once
        })
    }

    /// Whether the element keeps the rule. The distances of points in a plane are not checked again: the
    /// closed form ensures them.
    pub fn keeps(&self, bulge: f64, rule: &Rule, chord: &Chord, witnesses: &mut Witnesses) -> bool {
        let (track, tolerance) = (self.track(chord, bulge), rule.tolerance_mm);
        let is_flat = self.points.heights.is_empty();
        // The lines between the points may dip inside an arc.
        let dipped = track.arc().filter(|_| rule.measure == Measure::Polyline);
        if dipped.is_some_and(|arc| arc.radius < LEAST_RADIUS_TOLERANCES * tolerance) {
            return false;
        }
        let is_far = |k: usize| self.distance(k, &track, chord) > tolerance;
        if !is_flat && self.holds(witnesses.far) && is_far(witnesses.far) {
            return false;
        }
        let is_crossed = witnesses.crossed.into_iter().all(|k| self.holds(k));
        if is_crossed && self.crossing(&track, tolerance, chord, witnesses.crossed).is_some() {
            return false;
        }
        witnesses.looks += self.inner().len();
        if is_flat && self.advances(&track) {
            return dipped.is_none_or(|arc| self.keeps_lines(&track, arc, tolerance, chord));
        }
        witnesses.looks += SLOW_LOOKS * self.inner().len();
        if !is_flat && let Some(k) = (self.first..=self.last).find(|k| is_far(*k)) {
            witnesses.far = k;
            return false;
        }
        if dipped.is_some_and(|arc| self.dip(&track, arc, chord) > tolerance) {
            return false;
        }
        if let Some(pair) = self.crossing(&track, tolerance, chord, self.first + 1..self.last) {
            witnesses.crossed = pair;
            return false;
        }
        self.winds(&track, chord) && self.turns_little(&track, tolerance, chord)
    }

    /// Whether no two neighbouring points are more than half a turn of the element apart, by the last place
    /// near one and the first near the next. Mirrored in the middle of its chord, an element runs backwards.
    fn turns_little(&self, track: &ChordFrame, tolerance: f64, chord: &Chord) -> bool {
        let Some(arc) = track.arc().filter(|arc| arc.sweep > std::f64::consts::PI) else { return true };
        let places = |points: &mut dyn Iterator<Item = usize>, way: f64| {
            let next = |reached: &mut f64, k: usize| {
                let (p, above) = self.seen(k, chord);
                *reached = track.first_place([way * p.x, p.y].into(), way * above, tolerance, *reached)?;
                Some(*reached)
            };
            points.scan(0.0, next).collect::<Vec<f64>>()
        };
        let inner = self.first + 1..self.last;
        let (mut first, back) = (places(&mut inner.clone(), 1.0), places(&mut inner.clone().rev(), -1.0));
        first.push(1.0);
        let last = std::iter::once(0.0).chain(back.iter().rev().map(|place| 1.0 - place));
        let is_half = |(to, from): (&f64, f64)| (to - from) * arc.sweep <= std::f64::consts::PI;
        first.len() + back.len() > 2 * inner.len() && first.iter().zip(last).all(is_half)
    }

    /// Whether the point with index `k` is an inner point of the span.
    fn holds(&self, k: usize) -> bool {
        (self.first + 1..self.last).contains(&k)
    }

    /// Whether every line between the points stays within `tolerance` mm of the arc on its inside.
    fn keeps_lines(&self, track: &ChordFrame, arc: &ChordArc, tolerance: f64, chord: &Chord) -> bool {
        let center = center(self.from, self.to, arc.bulge);
        // The element may start and end beside its first and its last point: these count, too.
        let passed = &self.points.flat[self.first..=self.last];
        let least = passed.iter().map(|p| (p - center).norm_squared()).fold(f64::INFINITY, f64::min);
        let longest = self.lines().map(|[a, b]| (b - a).norm_squared()).fold(0.0, f64::max);
        // The worst case: the longest line, with both ends on the innermost circle.
        let inside = arc.radius.powi(2).min(least) - 0.25 * longest;
        (inside > 0.0 && arc.radius - inside.sqrt() <= tolerance) || self.dip(track, arc, chord) <= tolerance
    }

    fn track(&self, chord: &Chord, bulge: f64) -> ChordFrame {
        let heights = self.points.heights;
        let [low, high] =
            if heights.is_empty() { [0.0; 2] } else { [heights[self.first], heights[self.last]] };
        ChordFrame::new(chord, bulge, high - low)
    }

    /// A point in the frame of the chord, and its height over the middle between the heights of the ends, mm.
    fn seen(&self, k: usize, chord: &Chord) -> (Vector2<f64>, f64) {
        let Points { flat, heights } = self.points;
        let height = if heights.is_empty() {
            0.0
        } else {
            heights[k] - 0.5 * (heights[self.first] + heights[self.last])
        };
        (chord.local(flat[k]), height)
    }

    /// The distance of a point from the element, mm.
    fn distance(&self, k: usize, track: &ChordFrame, chord: &Chord) -> f64 {
        let (p, height) = self.seen(k, chord);
        track.foot(p, height).distance
    }

    /// The largest distance of the lines between the points inside an arc, or from a helix, mm.
    fn dip(&self, track: &ChordFrame, arc: &ChordArc, chord: &Chord) -> f64 {
        if !self.points.heights.is_empty() {
            let lines = (self.first..self.last).map(|k| [self.seen(k, chord), self.seen(k + 1, chord)]);
            return lines.map(|line| track.beside(arc, line)).fold(0.0, f64::max);
        }
        self.lines().map(|[a, b]| arc.dip(chord.local(a), chord.local(b))).fold(0.0, f64::max)
    }

    /// Whether the lines between the points turn about the centre of an arc as the arc does. If not, they
    /// pass the centre on its other side: the points lie near the ends of the arc, in its gap, and the arc
    /// runs far from them.
    fn winds(&self, track: &ChordFrame, chord: &Chord) -> bool {
        track.arc().is_none_or(|arc| {
            let turned = self.lines().map(|[a, b]| arc.turned(chord.local(a), chord.local(b)));
            (turned.sum::<f64>() - arc.sweep).abs() < std::f64::consts::PI
        })
    }

    /// Two of `points` that the element does not pass in order: no places within `tolerance` mm of them
    /// follow each other along the element. `None` if all points are passed in order.
    fn crossing(
        &self,
        track: &ChordFrame,
        tolerance: f64,
        chord: &Chord,
        points: impl IntoIterator<Item = usize>,
    ) -> Option<[usize; 2]> {
        let (mut reached, mut by) = (0.0, self.first);
        for k in points {
            let (p, height) = self.seen(k, chord);
            let Some(place) = track.first_place(p, height, tolerance, reached) else { return Some([by, k]) };
            if place > reached {
                (reached, by) = (place, k);
            }
        }
        None
    }
}
