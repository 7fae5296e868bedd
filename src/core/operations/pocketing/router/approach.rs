//! How the cutter gets from one stroke to the next.

use nalgebra::Point2;

use super::super::PocketError;
use super::super::chain::foot;
use super::super::conditions::Conditions;
use super::super::entry::Entry;
use super::super::job::Milling;
use super::super::leads::{lead_from, lead_to};
use super::super::links::{Pose, Room, TURNS, direct};
use super::{BESIDE_MM, Purpose, Router};
use crate::geometry::segment::Segment;
use crate::toolpath::path::Role;

/// The longest way through material from one stroke to the next, in stepovers.
const THROUGH: f64 = 2.0;

/// How much longer a link may take than a lift, seconds: a lift marks the floor and wears the machine.
const PATIENCE_S: f64 = 1.5;

/// The longest link, in radii of the cutter.
const LONGEST: f64 = 40.0;

/// The radii of the arcs on which a stroke is come to through material, in stepovers: the first begins on a
/// straight stroke that runs a stepover beside.
const INTO: [f64; 2] = [1.0, 0.5];

/// The most ways that are examined for a link.
const MOST_WAYS: usize = 6;

impl Router<'_> {
    /// Comes to the start of a stroke. Returns whether the cutter can get there.
    pub fn come_to(&mut self, stroke: &[Segment]) -> Result<bool, PocketError> {
        Ok(self.approach(stroke)? || self.enter(stroke)?)
    }

    /// Says that the cutter may leave the last cut on the circle about this centre, to the left.
    pub fn leave_about(&mut self, center: Point2<f64>) {
        self.leaving = Some(center);
    }

    /// Comes to the start of a stroke on the circle about `center`, to the left: by a link from the last cut,
    /// or by a lift. Returns whether the cutter can get there.
    pub fn lead_to(&mut self, stroke: &[Segment], center: Point2<f64>) -> Result<bool, PocketError> {
        let leaving = self.leaving.take();
        let lead = lead_to(stroke[0].start(), center);
        if !self.is_allowed(&[lead]) || !self.is_free(lead.start()) {
            return self.come_to(stroke);
        }
        let to = Pose::before(&lead);
        if let Some(from) = self.heading() {
            let out = leaving.map(|center| lead_from(from.at, center)).filter(|out| self.is_allowed(&[*out]));
            let from = out.as_ref().map_or(from, Pose::after);
            if let Some(way) = self.link([from, to])? {
                self.follow(out.as_slice(), Purpose::Cut)?;
                self.follow(&way, Purpose::Link)?;
                self.follow(&[lead], Purpose::Cut)?;
                return Ok(true);
            }
        }
        self.begin(lead.start(), Entry::Open);
        self.follow(&[lead], Purpose::Cut)?;
        Ok(true)
    }

    /// Goes to the start of a stroke if it can be reached without an entry into the full material.
    pub(super) fn approach(&mut self, stroke: &[Segment]) -> Result<bool, PocketError> {
        let Some(at) = self.at() else { return Ok(false) };
        let start = stroke[0].start();
        if at == start {
            return Ok(true);
        }
        if self.link_to(stroke)? {
            return Ok(true);
        }
        let straight = Segment::Line { start: at, end: start };
        let length = straight.length();
        let is_allowed = self.centers.contains(&straight, BESIDE_MM);
        if is_allowed && self.is_clear(&straight)? {
            if !self.is_free(start) {
                self.follow(&[straight], Purpose::Link)?;
            } else {
                self.begin(start, Entry::Open);
            }
            return Ok(true);
        }
        let conditions = self.conditions;
        let through = THROUGH * conditions.stepover_mm;
        if is_allowed && length <= through {
            self.follow(&[straight], Purpose::Cut)?;
            return Ok(true);
        }
        let Some((distance, place)) = self.nearest_cut(start, through) else {
            if self.is_rest() && self.is_free(start) {
                return Ok(false);
            }
            let seconds = length / conditions.slot_feed.mm_per_s();
            let is_fast = seconds <= conditions.lift_seconds(length) + conditions.entry_seconds();
            if is_allowed && is_fast {
                self.follow(&[straight], Purpose::Cut)?;
            }
            return Ok(is_allowed && is_fast);
        };
        let link = Segment::Line { start: at, end: place };
        let length = link.length();
        let is_fast = self.conditions.link_seconds(length) <= self.conditions.lift_seconds(length);
        if length > 0.0 && is_fast && self.centers.contains(&link, BESIDE_MM) && self.is_clear(&link)? {
            self.follow(&[link], Purpose::Link)?;
        } else if length > 0.0 {
            self.begin(place, Entry::Open);
        }
        if distance > 0.0 {
            self.follow(&[Segment::Line { start: place, end: start }], Purpose::Cut)?;
        }
        Ok(true)
    }

    /// The place on the path so far that is nearest to `p`, if it is no farther than `within_mm` and the
    /// centre may go straight from there.
    pub(super) fn nearest_cut(&self, p: Point2<f64>, within_mm: f64) -> Option<(f64, Point2<f64>)> {
        let mut nearest: Option<(f64, Point2<f64>)> = None;
        for element in self.runs.iter().flat_map(|run| &run.steps).map(|step| &step.element) {
            let (middle, reach) = element.disc();
            let bound = nearest.map_or(within_mm, |(least, _)| least);
            if (middle - p).norm() - reach > bound {
                continue;
            }
            let (distance, place) = foot(element, p);
            if distance <= within_mm && nearest.is_none_or(|(least, _)| distance < least) {
                let way = Segment::Line { start: place, end: p };
                if distance <= BESIDE_MM || self.centers.contains(&way, BESIDE_MM) {
                    nearest = Some((distance, place));
                }
            }
        }
        nearest
    }

    /// Goes to the start of a stroke smoothly over cleared ground, or as far and on through a stepover of
    /// material on an arc.
    fn link_to(&mut self, stroke: &[Segment]) -> Result<bool, PocketError> {
        let Some(from) = self.heading() else { return Ok(false) };
        let to = Pose::before(&stroke[0]);
        if (to.at - from.at).norm() > longest_link(self.conditions, (to.at - from.at).norm()) {
            return Ok(false);
        }
        if self.is_free(to.at)
            && let Some(way) = self.link([from, to])?
        {
            self.follow(&way, Purpose::Link)?;
            return Ok(true);
        }
        // The material is on the other side.
        let side = if self.conditions.milling == Milling::Climb { 1.0 } else { -1.0 };
        for radius in INTO.map(|part| part * self.conditions.stepover_mm.min(self.conditions.radius_mm)) {
            for side in [side, -side] {
                let lead = to.lead(side * radius, std::f64::consts::FRAC_PI_2);
                if !self.is_allowed(&[lead]) || !self.is_free(lead.start()) {
                    continue;
                }
                let way = self.link([from, Pose::before(&lead)])?;
                let Some(way) = way else { return Ok(false) };
                self.follow(&way, Purpose::Link)?;
                self.follow(&[lead], Purpose::Cut)?;
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// A smooth way over cleared ground that takes at most a little longer than a lift.
    fn link(&mut self, ends: [Pose; 2]) -> Result<Option<Vec<Segment>>, PocketError> {
        let distance = (ends[1].at - ends[0].at).norm();
        let most_mm = longest_link(self.conditions, distance);
        if distance > most_mm {
            return Ok(None);
        }
        let radii = TURNS.map(|turn| turn * self.conditions.radius_mm);
        let ways = direct(ends, radii);
        if let Some(way) = self.first_clear(ways, most_mm)? {
            return Ok(Some(way));
        }
        for room in [Room::Wide, Room::Narrow] {
            let ways = self.links.around(ends, room, most_mm, self.budget)?;
            if let Some(way) = self.first_clear(ways, most_mm)? {
                return Ok(Some(way));
            }
        }
        Ok(None)
    }

    /// The first way that is allowed and runs over cleared ground.
    fn first_clear(
        &mut self,
        ways: Vec<Vec<Segment>>,
        most_mm: f64,
    ) -> Result<Option<Vec<Segment>>, PocketError> {
        let is_short = |way: &Vec<Segment>| way.iter().map(Segment::length).sum::<f64>() <= most_mm;
        for way in ways.into_iter().filter(is_short).take(MOST_WAYS) {
            if self.is_allowed(&way) && self.are_clear(&way)? {
                return Ok(Some(way));
            }
        }
        Ok(None)
    }
}

/// The longest way that takes a link at most `PATIENCE_S` longer than a lift, mm.
fn longest_link(conditions: &Conditions, distance_mm: f64) -> f64 {
    let seconds = conditions.lift_seconds(distance_mm) + PATIENCE_S;
    let by_time = seconds * conditions.cutting.feed_of(Role::Link).mm_per_s();
    by_time.min(LONGEST * conditions.radius_mm)
}
