//! Finds the sections over one line of positions of the axis, by bisection.
//!
//! # Method
//! Cut the line into intervals, and find for both ends of each interval whether a section runs through the
//! tip there: whether they *count*.
//! * *Neither end counts.* If no triangle is near the interval, there is no section over it. A short interval
//!   is taken to have none either. Any other is halved.
//! * *One end counts.* A section ends within the interval. Bisection finds this end to 1e-8 mm.
//! * *Both ends count.* If all tips over the interval are proved to be near the chord between the tips at its
//!   ends, this chord is a part of the section. Otherwise the interval is cut in two, unless it is shorter
//!   than 1e-6 mm: then the tips at its ends are the foot and the head of an upright wall.

use nalgebra::{Point3, Vector2};

use super::super::MeshContact;
use super::super::stretch::Verdict;
use super::{Counting, MeshSections};
use crate::budget::Budget;
use crate::machining::offset_section::{PlaneAt, SectionError, Spacing};

/// Distance in plan, mm, up to which two tips may be foot and head of an upright wall.
pub(super) const WALL_MM: f64 = 1e-6;

/// Accuracy of the ends of a section, mm, and the most halvings on the way to it.
const END_MM: f64 = 1e-8;
const END_HALVINGS: usize = 60;

/// Length, as a share of the radius and of the size of the mesh in plan, up to which an interval between two
/// positions that do not count is not halved again.
const SEARCH_STEP: f64 = 0.05;
const SEARCH_SIZE: f64 = 0.005;

/// Largest number of points over one line.
const POINT_LIMIT: usize = 1_000_000;

/// Intervals between two looks at the budget.
const INTERVALS_BETWEEN_CHECKS: usize = 64;

/// Largest slope of a contact at which the tip's height is corrected for the distance between the traced
/// plane and the plane of the pass. On a steeper slope a tiny move to the side has the same effect.
const STEEPEST_RISE: f64 = 10.0;

/// Intervals shorter than this, mm, are halved only at walls and at ends of sections. A line on which more
/// than `SHORT_LIMIT` of them are halved grazes a wall.
const SHORT_MM: f64 = 1e-4;
const SHORT_LIMIT: usize = 4000;

/// A position along the line, mm, with the contact there if it counts.
#[derive(Debug, Clone, Copy)]
struct Probe {
    at: f64,
    contact: Option<MeshContact>,
}

/// The sections over one line.
pub(super) struct Trace<'a> {
    sections: &'a MeshSections<'a>,
    counting: Counting,
    plane: PlaneAt,
    spacing: Spacing,
    budget: &'a Budget,
    pub(super) chains: Vec<Vec<Point3<f64>>>,
    /// The points so far of the section that is being traced.
    points: Vec<Point3<f64>>,
    n_points: usize,
    /// Short intervals that were halved.
    n_short: usize,
}

impl<'a> Trace<'a> {
    pub(super) fn new(
        sections: &'a MeshSections<'a>,
        counting: Counting,
        plane: PlaneAt,
        spacing: Spacing,
        budget: &'a Budget,
    ) -> Self {
        let (chains, points) = (Vec::new(), Vec::new());
        Self { sections, counting, plane, spacing, budget, chains, points, n_points: 0, n_short: 0 }
    }

    /// Finds every section. Where `may_end`, returns `false` if the line only grazes something, so that the
    /// contact jumps more often than walls explain.
    pub(super) fn all(&mut self, may_end: bool) -> Result<bool, SectionError> {
        let is_grazing = |trace: &Self| may_end && trace.n_short > SHORT_LIMIT;
        self.until(is_grazing)?;
        Ok(!is_grazing(self))
    }

    /// Whether there is a section of any length.
    pub(super) fn has_any(&mut self) -> Result<bool, SectionError> {
        let is_long = |points: &Vec<Point3<f64>>| points.iter().any(|point| *point != points[0]);
        let is_found = |trace: &Self| trace.chains.iter().chain([&trace.points]).any(is_long);
        self.until(|trace| trace.n_short > SHORT_LIMIT || is_found(trace))?;
        Ok(is_found(self))
    }

    /// Finds sections until `is_enough` holds.
    fn until(&mut self, is_enough: impl Fn(&Self) -> bool) -> Result<(), SectionError> {
        // The intervals still to be examined; the next along the line is the last element.
        let mut open = vec![self.sections.range().map(|at| self.probe(at, None))];
        for tries in 0usize.. {
            if is_enough(self) {
                return Ok(());
            }
            let Some([from, to]) = open.pop() else { break };
            if tries.is_multiple_of(INTERVALS_BETWEEN_CHECKS) {
                self.budget.check()?;
            }
            if self.n_points + self.points.len() >= POINT_LIMIT {
                return Err(SectionError::TooManyPoints { limit: POINT_LIMIT });
            }
            let length = to.at - from.at;
            match (from.contact, to.contact) {
                (None, None) if self.is_empty(&from, &to) => {}
                (None, None) => self.cut([from, to], 0.5, &mut open),
                (Some(first), Some(last)) => match self.stretch(&first, &last) {
                    Verdict::Within => {
                        self.begin(&first);
                        self.points.push(self.point(&last));
                    }
                    Verdict::CutAt(_) if length <= WALL_MM => {
                        self.begin(&first);
                        self.climb(&last);
                    }
                    Verdict::CutAt(share) => self.cut([from, to], share, &mut open),
                },
                (Some(first), None) if length > END_MM => {
                    let [last, beyond] = self.last_counting(first, to.at);
                    open.extend([[beyond, to], [last, beyond], [from, last]]);
                }
                (None, Some(last)) if length > END_MM => {
                    let [first, before] = self.last_counting(last, from.at);
                    open.extend([[first, to], [before, first], [from, before]]);
                }
                (Some(first), None) => {
                    self.begin(&first);
                    self.finish();
                }
                (None, Some(_)) => self.finish(),
            }
        }
        self.finish();
        Ok(())
    }

    /// Puts the two parts of an interval on `open`, cut at a share of its length.
    fn cut(&mut self, [from, to]: [Probe; 2], share: f64, open: &mut Vec<[Probe; 2]>) {
        self.n_short += usize::from(to.at - from.at < SHORT_MM);
        let near = from.contact.or(to.contact);
        let middle = self.probe(from.at + share * (to.at - from.at), near.as_ref());
        open.extend([[middle, to], [from, middle]]);
    }

    /// Whether the search finds no section between two positions that do not count.
    fn is_empty(&self, from: &Probe, to: &Probe) -> bool {
        let contacts = &self.sections.contacts;
        let bounds = contacts.mesh.bounds();
        let size = (bounds.max - bounds.min).xy().norm();
        let step = (SEARCH_STEP * contacts.cutter.radius()).min(SEARCH_SIZE * size);
        let [low, high] = self.sections.range();
        to.at - from.at <= step.max((high - low) / POINT_LIMIT as f64)
            || contacts.is_free([from, to].map(|probe| self.position(probe.at)))
    }

    /// Begins a section, if none is being traced.
    fn begin(&mut self, first: &MeshContact) {
        if self.points.is_empty() {
            self.points.push(self.point(first));
        }
    }

    fn finish(&mut self) {
        self.n_points += self.points.len();
        if self.points.len() > 1 {
            self.chains.push(std::mem::take(&mut self.points));
        }
        self.points.clear();
    }

    /// Compares the tips between two contacts with the chord of these.
    fn stretch(&self, from: &MeshContact, to: &MeshContact) -> Verdict {
        let way = to.tip - from.tip;
        if way.norm() > self.spacing.step_length_mm {
            return Verdict::CutAt(0.5);
        }
        // Vertical distances bound the distances in order, also where the tips turn back beside the chord.
        self.sections.contacts.stretch(from, to, [self.spacing.chord_height_mm; 2])
    }

    /// Adds the way up or down a wall, with points no farther apart than the step length.
    fn climb(&mut self, to: &MeshContact) {
        let (from, to) = (self.points[self.points.len() - 1], self.point(to));
        let steps = ((to - from).norm() / self.spacing.step_length_mm).ceil().clamp(1.0, POINT_LIMIT as f64);
        self.points.extend((1..=steps as usize).map(|k| from + (to - from) * (k as f64 / steps)));
    }

    /// The tip as a point of the pass. The plane of the pass may lie a little beside the plane over which the
    /// tip was found.
    fn point(&self, contact: &MeshContact) -> Point3<f64> {
        let axis = self.sections.axis;
        let mut point = contact.tip;
        point[axis] = self.plane.at;
        let out = (contact.point - contact.tip).xy();
        let rise = contact.slope * out[axis] / out.norm() * (self.plane.at - self.plane.traced_at);
        point.z += if contact.slope < STEEPEST_RISE && rise.is_finite() { rise } else { 0.0 };
        point
    }

    fn position(&self, at: f64) -> Vector2<f64> {
        let mut position = Vector2::repeat(self.plane.traced_at);
        position[1 - self.sections.axis] = at;
        position
    }

    /// The contact at a position; `near` is one near by.
    fn probe(&self, at: f64, near: Option<&MeshContact>) -> Probe {
        let contact = self.sections.contacts.drop_near(self.position(at), near);
        Probe { at, contact: contact.filter(|contact| self.sections.counts(self.counting, contact)) }
    }

    /// The last position that counts on the way from `counting` to `outside`, which does not count; and a
    /// position just beyond it.
    fn last_counting(&self, mut counting: MeshContact, mut outside: f64) -> [Probe; 2] {
        let along = 1 - self.sections.axis;
        for _ in 0..END_HALVINGS {
            let at = counting.tip[along];
            if (at - outside).abs() <= END_MM {
                break;
            }
            let middle = self.probe(0.5 * (at + outside), Some(&counting));
            match middle.contact {
                Some(contact) => counting = contact,
                None => outside = middle.at,
            }
        }
        let last = Probe { at: counting.tip[along], contact: Some(counting) };
        [last, Probe { at: outside, contact: None }]
    }
}
