//! Bounds of the angle along a motion.

use nalgebra::Vector2;

use super::spans::{self, Few, Left, Spans};
use super::{Chord, Enough, Frame, LongChord, REACH, Stretch, Swept, distance_to_chord};
use crate::budget::{Budget, Stopped};
use crate::geometry::segment::Segment;

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

/// The points of the half circle that chords free at a place.
pub(super) struct Freed {
    /// The index of each long chord with the ranges that the chord frees, and the same of the short chords.
    of_chords: [Vec<(u32, Few)>; 2],
    pub left: Left,
}

/// The part of the half circle that no single chord frees at both places. The indices of the chords have to
/// be in ascending order.
fn common(first: &Freed, last: &Freed) -> Left {
    let mut both = Spans::default();
    for (first, last) in first.of_chords.iter().zip(&last.of_chords) {
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
        motion: &Segment,
        [from, to]: [f64; 2],
        enough: Enough,
        stretches: &mut Vec<Stretch>,
        budget: &Budget,
    ) -> Result<(), Stopped> {
        let part = motion.part(from, to);
        let mut near = std::mem::take(&mut self.near);
        self.cells.near(&part, REACH * self.radius_mm, &mut near);
        let (middle, reach) = part.disc();
        let within = REACH * self.radius_mm + reach;
        near.retain(|k| {
            let Chord { start, end, .. } = self.long_chords[*k as usize].chord;
            distance_to_chord(middle, start, end) < within
        });
        let count = self.straight_parts(&part);
        let at = |k: usize| from + (to - from) * (k as f64 / count as f64);
        let height_mm = self.height_mm(motion, (to - from) / count as f64);
        let mut before = self.freed(motion, from, height_mm, &near);
        for k in 0..count {
            self.steps += 1;
            self.comparisons += 2 * near.len() as u64;
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
        motion: &Segment,
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
            self.comparisons += 2 * near.len() as u64;
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
        motion: &Segment,
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
    fn straight_parts(&self, motion: &Segment) -> usize {
        match motion {
            Segment::Arc(arc) => {
                let height = STRAIGHT * self.radius_mm / (arc.radius() + self.radius_mm);
                (arc.turn().abs() / (2.0 * (1.0 - height).acos())).ceil().max(1.0) as usize
            }
            Segment::Line { .. } => 1,
        }
    }

    /// The points that chords free at a place of a motion, where points of the circle move up to
    /// `height_mm` away from their chords.
    fn freed(&self, motion: &Segment, t: f64, height_mm: f64, near: &[u32]) -> Freed {
        self.freed_in(&Frame::at(motion, t), height_mm, near)
    }

    /// The points that chords free in a frame. The short chords are used only where the long ones leave
    /// material.
    fn freed_in(&self, frame: &Frame, height_mm: f64, near: &[u32]) -> Freed {
        let mut all = Spans::default();
        let mut of_long = Vec::with_capacity(near.len());
        let mut of_short = Vec::new();
        let half_circle = all.disc_of_left().unwrap_or_default();
        for k in near {
            let long = &self.long_chords[*k as usize];
            if let Some(own) = self.freed_by(&long.chord, frame, height_mm, half_circle) {
                all.add(&own);
                of_long.push((*k, own));
            }
        }
        if let Some(disc) = all.disc_of_left() {
            for k in near {
                let long = &self.long_chords[*k as usize];
                if !self.may_free_more(long, frame, disc) {
                    continue;
                }
                for (chord, k) in self.short(long).iter().zip(long.short[0]..) {
                    if let Some(own) = self.freed_by(chord, frame, height_mm, disc) {
                        all.add(&own);
                        of_short.push((k, own));
                    }
                }
            }
        }
        Freed { of_chords: [of_long, of_short], left: all.left() }
    }

    /// The part of the half circle that no chord frees in a frame. The last chords come first: they lie
    /// beside the cutter, and most others add nothing to what they free.
    pub(super) fn left_in(&self, frame: &Frame, near: &mut Vec<u32>) -> Left {
        near.sort_unstable_by(|a, b| b.cmp(a));
        near.dedup();
        let mut all = Spans::default();
        let mut disc = all.disc_of_left().unwrap_or_default();
        for short in [false, true] {
            for k in near.iter() {
                let long = &self.long_chords[*k as usize];
                let chords = if short { self.short(long) } else { std::slice::from_ref(&long.chord) };
                if short && !self.may_free_more(long, frame, disc) {
                    continue;
                }
                for chord in chords {
                    if let Some(own) = self.freed_by(chord, frame, 0.0, disc)
                        && !own.ranges().is_empty()
                    {
                        all.add(&own);
                        let Some(left) = all.disc_of_left() else { return all.left() };
                        disc = left;
                    }
                }
            }
        }
        all.left()
    }

    /// Whether the short chords of a long one may free a point of a disc, in radii of the cutter.
    fn may_free_more(&self, long: &LongChord, frame: &Frame, (middle, within): (Vector2<f64>, f64)) -> bool {
        let Chord { start, end, slack_mm } = long.chord;
        let [a, b] = [start, end].map(|p| frame.local(p) / self.radius_mm);
        long.short[0] < long.short[1]
            && spans::is_near(a - middle, b - middle, 1.0 + slack_mm / self.radius_mm + within)
    }

    /// The points of the half circle that a chord frees in a frame; `None` if all of them are outside a disc,
    /// which is in radii of the cutter.
    fn freed_by(
        &self,
        chord: &Chord,
        frame: &Frame,
        height_mm: f64,
        (middle, within): (Vector2<f64>, f64),
    ) -> Option<Few> {
        let reach = 1.0 - (chord.slack_mm + height_mm) / self.radius_mm;
        let [a, b] = [chord.start, chord.end].map(|p| frame.local(p) / self.radius_mm);
        // The half circle lies ahead.
        let is_behind = a.x.max(b.x) < -reach;
        (reach > 0.0 && !is_behind && spans::is_near(a - middle, b - middle, reach + within))
            .then(|| spans::freed(a, b, reach))
    }

    /// How far points of the circle come from their chords along a part of a motion, mm. They are at most the
    /// sum of both radii from the centre of the motion's arc.
    fn height_mm(&self, motion: &Segment, part: f64) -> f64 {
        match motion {
            Segment::Arc(arc) => {
                (arc.radius() + self.radius_mm) * (1.0 - (0.5 * arc.turn().abs() * part).cos())
            }
            Segment::Line { .. } => 0.0,
        }
    }
}
