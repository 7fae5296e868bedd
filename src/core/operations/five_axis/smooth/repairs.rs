//! Proves the spans of a run, and repairs legs whose spans leave the tolerance: points are added or moved, or
//! an end becomes a corner.

use super::{Inner, LARGEST_TURN, Smoother};
use crate::operations::five_axis::deviation::{Deviation, of_span};
use crate::operations::five_axis::leg::Leg;
use crate::operations::five_axis::rail::{Fitted, Span, tip};

/// A span whose deviation is at most this multiple of the tolerance is drawn nearer to its leg.
const NEARLY: f64 = 1.5;

/// The part of the tolerance that such a span is drawn to.
const DRAWN_TO: f64 = 0.995;

/// A leg is long if it has more than this multiple of the length of the leg beside it.
const LONG: f64 = 3.0;

/// The distances of the points on a long leg grow by this factor.
const GROWTH: f64 = 2.5;

/// Points of a leg that are nearer to each other are one point, mm: the points that are added from both
/// ends may meet those that the leg has. The parts of a leg need a length above rounding.
const ONE_POINT_MM: f64 = 1e-6;

impl Smoother<'_> {
    /// The bound of the deviation of all spans, and the legs of those that leave the tolerance.
    pub(super) fn proved(
        &self,
        spans: &[Fitted],
        is_alone: bool,
    ) -> (Deviation, Vec<(usize, Deviation, Span)>) {
        let mut all = Deviation::NONE;
        let mut failed: Vec<(usize, Deviation, Span)> = Vec::new();
        for (k, Fitted { span, source }) in spans.iter().enumerate() {
            let [leg, _] = source.legs();
            let whole = &self.legs[leg];
            // The points on a leg that stands alone or turns far lie on the leg.
            let is_on_leg = is_alone || whole.angle > LARGEST_TURN;
            let part = if is_on_leg { Leg::new(span.start(), span.end()) } else { *whole };
            let mut deviation = of_span(span, &[part], Deviation::NONE);
            // A leg that stands alone is a line: it runs along itself.
            if !is_alone && !runs_along(span, whole) {
                deviation.tip_mm = deviation.tip_mm.max(2.0 * NEARLY * self.tolerance.tip_mm);
            }
            all = all.max(deviation);
            let is_first =
                k == 0 || spans[k - 1].source != *source || failed.last().is_none_or(|last| last.0 != leg);
            if deviation.of(self.within(leg..leg + 1)) > 1.0 && is_first {
                failed.push((leg, deviation, span.clone()));
            }
        }
        (all, failed)
    }

    pub(super) fn repair(
        &mut self,
        leg: usize,
        deviation: Deviation,
        span: &Span,
        [first, last]: [usize; 2],
    ) {
        let tries = self.repairs[leg];
        self.repairs[leg] = tries.saturating_add(1);
        if tries == 0 && self.divide(leg, [first, last]) {
            return;
        }
        let excess = deviation.of(self.within(leg..leg + 1));
        let own = &self.legs[leg];
        // Another repair of this round may have made its ends corners.
        let is_alone = self.is_corner[leg] && self.is_corner[leg + 1];
        if !is_alone && tries <= 1 && excess <= NEARLY && self.inner[leg].is_empty() {
            let middle = span.jet(0.5 * (span.from + span.to))[0];
            let on_leg = own.at(0.5);
            let at = on_leg + (middle - on_leg) * (DRAWN_TO / excess);
            self.inner[leg].push(Inner { part: 0.5, at });
            return;
        }
        let ends = [leg, leg + 1].into_iter().filter(|k| !self.is_corner[*k]);
        let worst = ends.max_by(|a, b| self.severity(*a).total_cmp(&self.severity(*b)));
        let Some(k) = worst else {
            // The leg stands alone: between more points its axis is nearer to the great circle.
            self.inner[leg] = turned(own, LARGEST_TURN * 0.5_f64.powi(i32::from(tries) + 1));
            return;
        };
        self.make_corner(k);
        // What was drawn to the smooth curve starts again.
        for beside in [k - 1, k] {
            self.inner[beside] = turned(&self.legs[beside], LARGEST_TURN);
            self.repairs[beside] = 0;
        }
    }

    /// Makes every station of a run a corner.
    pub(super) fn isolate(&mut self, first: usize, last: usize) {
        for leg in first..last {
            self.is_corner[leg] = true;
            self.inner[leg] = turned(&self.legs[leg], LARGEST_TURN);
            self.repairs[leg] = 0;
        }
    }

    /// Adds points to a leg that is much longer than a leg beside it. Says whether it did.
    fn divide(&mut self, leg: usize, [first, last]: [usize; 2]) -> bool {
        let own = self.legs[leg];
        let mut parts = Vec::new();
        for (is_inside, beside, is_start) in
            [(leg > first, leg.wrapping_sub(1), true), (leg + 1 < last, leg + 1, false)]
        {
            if !is_inside || self.legs[beside].length * LONG >= own.length {
                continue;
            }
            let mut distance = self.legs[beside].length;
            let mut sum = distance;
            while sum < 0.45 * own.length {
                let part = sum / own.length;
                parts.push(if is_start { part } else { 1.0 - part });
                distance *= GROWTH;
                sum += distance;
            }
        }
        if parts.is_empty() {
            return false;
        }
        parts.extend(self.inner[leg].iter().map(|inner| inner.part));
        parts.sort_by(f64::total_cmp);
        parts.dedup_by(|a, b| (*a - *b) * own.length < ONE_POINT_MM);
        self.inner[leg] = parts.into_iter().map(|part| Inner { part, at: own.at(part) }).collect();
        true
    }
}

/// Points on a leg whose axis turns far: between them the mean of two axes is near their great circle.
pub fn turned(leg: &Leg, largest: f64) -> Vec<Inner> {
    let count = (leg.angle / largest).ceil().max(1.0) as usize;
    (1..count).map(|k| k as f64 / count as f64).map(|part| Inner { part, at: leg.at(part) }).collect()
}

/// Whether the tip never goes back along a leg.
fn runs_along(span: &Span, leg: &Leg) -> bool {
    fn is_forward(span: &Span, direction: &nalgebra::Vector3<f64>, halvings: usize) -> bool {
        let steps: Vec<f64> =
            span.control.windows(2).map(|pair| (tip(&pair[1]) - tip(&pair[0])).dot(direction)).collect();
        if steps.iter().all(|step| *step > 0.0) {
            return true;
        }
        if halvings == 0 || steps[0] <= 0.0 || steps[4] <= 0.0 {
            return false;
        }
        span.halves().iter().all(|half| is_forward(half, direction, halvings - 1))
    }
    const HALVINGS: usize = 3;
    is_forward(span, &leg.direction(), HALVINGS)
}
