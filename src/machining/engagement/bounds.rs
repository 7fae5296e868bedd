//! Bounds of the angle along a motion.

use super::spans::{self, Few, Left, Spans};
use super::{Enough, Frame, Segment, Stretch, Swept, distance_to_segment};
use crate::budget::{Budget, Stopped};
use crate::geometry::element::Element;

/// How near the bound of a stretch comes to the angles at its ends, degrees.
const CLOSE_DEG: f64 = 1.0;

/// The shortest stretch, as a part of the radius.
const SHORTEST: f64 = 0.01;

/// On a stretch of an arc, the points of the circle stay this near to their chords, as a part of the radius.
const STRAIGHT: f64 = 0.001;

/// The longest stretch whose bound does not meet [`Enough`] although one of its ends does, as a part of the
/// radius.
const MIXED: f64 = 0.1;

/// Stretches between two checks of the budget.
const STRETCHES_BETWEEN_CHECKS: usize = 256;

/// The points of the half circle that segments free at a place.
pub(super) struct Freed {
    /// The index of each segment with the ranges that the segment frees: first the list of the coarse
    /// segments, then the list of the fine segments.
    of_segments: [Vec<(u32, Few)>; 2],
    pub left: Left,
}

/// The part of the half circle that no single segment frees at both places. The indices of the segments have
/// to be in ascending order.
fn common(first: &Freed, last: &Freed) -> Left {
    let mut both = Spans::default();
    for (first, last) in first.of_segments.iter().zip(&last.of_segments) {
        let mut others = last.iter().peekable();
        for (k, own) in first {
            while others.next_if(|(other, _)| other < k).is_some() {}
            if let Some((_, other)) = others.next_if(|(other, _)| other == k) {
                both.add_common(own, other);
            }
        }
    }
    both.left()
}

impl Swept {
    /// Adds bounds of the angles along a part of a motion.
    pub(super) fn angles(
        &mut self,
        motion: &Element,
        [from, to]: [f64; 2],
        enough: Enough,
        stretches: &mut Vec<Stretch>,
        budget: &Budget,
    ) -> Result<(), Stopped> {
        let part = motion.part(from, to);
        let mut near = std::mem::take(&mut self.near);
        self.cells.near(&part, 2.0 * self.radius_mm, &mut near);
        let (middle, reach) = part.disc();
        let within = 2.0 * self.radius_mm + reach;
        near.retain(|k| {
            let Segment { start, end, .. } = self.segments[*k as usize];
            distance_to_segment(middle, start, end) < within
        });
        let count = self.straight_parts(&part);
        let at = |k: usize| from + (to - from) * (k as f64 / count as f64);
        let height_mm = self.height_mm(motion, (to - from) / count as f64);
        let mut before = self.freed(motion, from, height_mm, &near);
        for k in 0..count {
            self.steps += 1;
            if self.steps.is_multiple_of(STRETCHES_BETWEEN_CHECKS) {
                budget.check()?;
            }
            let after = self.freed(motion, at(k + 1), height_mm, &near);
            let range = [at(k), at(k + 1)];
            let left = common(&before, &after);
            if self.is_final(motion, range, left, [before.left, after.left], enough) {
                stretches.push(Stretch::new(range, left));
            } else {
                self.halve(motion, range, enough, &near, stretches, budget)?;
            }
            before = after;
        }
        self.near = near;
        Ok(())
    }

    /// Bounds of the halves of a stretch, and of their halves, until they are final.
    fn halve(
        &mut self,
        motion: &Element,
        range: [f64; 2],
        enough: Enough,
        near: &[u32],
        stretches: &mut Vec<Stretch>,
        budget: &Budget,
    ) -> Result<(), Stopped> {
        let halves = |[from, to]: [f64; 2]| {
            let middle = 0.5 * (from + to);
            [[middle, to], [from, middle]]
        };
        let mut open = halves(range).to_vec();
        while let Some([from, to]) = open.pop() {
            self.steps += 1;
            if self.steps.is_multiple_of(STRETCHES_BETWEEN_CHECKS) {
                budget.check()?;
            }
            let height_mm = self.height_mm(motion, to - from);
            let [first, last] = [from, to].map(|t| self.freed(motion, t, height_mm, near));
            let left = common(&first, &last);
            if self.is_final(motion, [from, to], left, [first.left, last.left], enough) {
                stretches.push(Stretch::new([from, to], left));
            } else {
                open.extend(halves([from, to]));
            }
        }
        Ok(())
    }

    /// Whether the bound of a stretch is near the angles at its ends, or as good as it gets.
    fn is_final(
        &self,
        motion: &Element,
        [from, to]: [f64; 2],
        left: Left,
        at_ends: [Left; 2],
        enough: Enough,
    ) -> bool {
        let length_mm = (to - from) * motion.length();
        let is_straight = self.height_mm(motion, to - from) <= 1.01 * STRAIGHT * self.radius_mm;
        let most = at_ends[0].angle.max(at_ends[1].angle);
        let is_close = is_straight
            && left.angle <= most + CLOSE_DEG.to_radians()
            && (!at_ends.iter().any(|end| enough.is_met(*end)) || length_mm <= MIXED * self.radius_mm);
        enough.is_met(left) || is_close || length_mm <= SHORTEST * self.radius_mm
    }

    /// The number of parts of a motion along which points of the circle move straight enough.
    fn straight_parts(&self, motion: &Element) -> usize {
        match motion {
            Element::Arc(arc) => {
                let height = STRAIGHT * self.radius_mm / (arc.radius + self.radius_mm);
                (arc.turn.abs() / (2.0 * (1.0 - height).acos())).ceil().max(1.0) as usize
            }
            _ => 1,
        }
    }

    /// The points that segments free at a place of a motion, where points of the circle move up to
    /// `height_mm` away from their chords.
    fn freed(&self, motion: &Element, t: f64, height_mm: f64, near: &[u32]) -> Freed {
        self.freed_in(&Frame::at(motion, t), height_mm, near)
    }

    /// The points that segments free in a frame. The fine chords are used only where the coarse segments
    /// leave material.
    pub(super) fn freed_in(&self, frame: &Frame, height_mm: f64, near: &[u32]) -> Freed {
        let mut all = Spans::default();
        let mut of_segments = [Vec::new(), Vec::new()];
        for (is_fine, of_segments) in of_segments.iter_mut().enumerate() {
            let Some((middle, within)) = all.disc_of_left() else { break };
            for k in near {
                let segment = &self.segments[*k as usize];
                let reach = 1.0 - (segment.slack_mm + height_mm) / self.radius_mm;
                if segment.is_coarse != (is_fine == 0) || reach <= 0.0 {
                    continue;
                }
                let [a, b] = [segment.start, segment.end].map(|p| frame.local(p) / self.radius_mm);
                if spans::is_near(a - middle, b - middle, reach + within) {
                    let own = spans::freed(a, b, reach);
                    all.add(&own);
                    of_segments.push((*k, own));
                }
            }
        }
        Freed { of_segments, left: all.left() }
    }

    /// How far points of the circle come from their chords along a part of a motion, mm. They are at most the
    /// sum of both radii from the centre of the motion's arc.
    fn height_mm(&self, motion: &Element, part: f64) -> f64 {
        match motion {
            Element::Arc(arc) => (arc.radius + self.radius_mm) * (1.0 - (0.5 * arc.turn.abs() * part).cos()),
            _ => 0.0,
        }
    }
}
