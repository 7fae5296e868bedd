//! Finds the sections over one line of positions of the axis, by bisection.
//!
//! A *section* is a curve of the tip over a stretch of the line. A position *counts* if a section runs
//! through the tip there.
//!
//! # Method
//! Cut the line into intervals, and find for both ends of each interval whether they count.
//! * *Neither end counts.* If no part of the surface is near the interval, there is no section over it. An
//!   interval shorter than 0.05 of the cutter's radius (less on a small surface) is taken to have no section
//!   either. Halve any other interval.
//! * *One end counts.* A section ends within the interval. Bisection finds this end to 1e-8 mm.
//! * *Both ends count.* If all tips over the interval are proved to be near the chord between the tips at its
//!   ends, this chord is a part of the section. Otherwise halve the interval, unless it is shorter than 1e-6
//!   mm. Such a short interval counts as an upright wall; the tips at its ends are the foot and the head of
//!   the wall.
//!
//! # Guarantees
//! The distance of the tips from the chords of a section is proved. So are the contacts at the ends of the
//! section.

mod ends;

use nalgebra::{Point3, Vector2};

use super::TipSections;
use super::counting::Counting;
use crate::budget::Budget;
use crate::geometry::surface::patch::Patch;
use crate::machining::drop_cutter::Contact;
use crate::machining::drop_cutter::chord_proof::ChordVerdict;
use crate::machining::offset_section::{PlaneAt, SectionError, Spacing};

/// Distance in plan, mm, up to which two tips may be foot and head of an upright wall.
pub(super) const WALL_MM: f64 = 1e-6;

/// Accuracy of the ends of a section, mm.
const END_MM: f64 = 1e-8;

/// Length, in units of `Contacts::scale`, up to which an interval between two positions that do not count is
/// not halved again. A shorter section is found only between two crossings of the line with sides of the
/// surface.
const SEARCH_STEP: f64 = 0.05;

/// Largest number of points over one line.
const POINT_LIMIT: usize = 1_000_000;

/// Intervals between two looks at the budget.
const INTERVALS_BETWEEN_CHECKS: usize = 16;

/// Height difference, mm, above which two tips belong to different contacts.
const HIGHER_MM: f64 = 1e-8;

/// Distance in parameters above which two contacts at one position are different.
const SAME_PLACE: f64 = 1e-6;

/// Largest slope of a contact at which the tip's height is corrected for the distance between the traced
/// plane and the plane of the pass. On a steeper slope a tiny move to the side has the same effect.
const STEEPEST_RISE: f64 = 10.0;

/// Length, in units of `Contacts::scale`, below which the ends of an interval are proved before it is halved.
const TRUSTED_LENGTH: f64 = 0.01;

/// Number of contacts that are found by drops after a contact of Newton's method was not the highest.
const DISTRUSTED: usize = 4;

/// Length, in units of `Contacts::scale`, up to which a crossing of two contacts is looked for. Over a longer
/// interval there may be other contacts between.
const CROSSING_LENGTH: f64 = 1.0;

/// Intervals shorter than this, mm, are halved only at walls and at ends of sections, about seven times each.
/// A line on which more than `SHORT_LIMIT` of them are halved grazes a wall.
const SHORT_MM: f64 = 1e-4;
const SHORT_LIMIT: usize = 1000;

/// Accuracy of tips at positions that do not count, as a share of the chord height.
const ROUGH_SHARE: f64 = 0.05;

/// A position along the line, mm, with the contact there if it counts.
#[derive(Debug, Clone, Copy)]
struct Probe {
    at: f64,
    contact: Option<Contact>,
}

/// Whether it is proved that no place lifts the cutter higher.
fn is_proved(contact: &Contact) -> bool {
    contact.gap_mm.is_finite()
}

/// The sections over one line.
pub(super) struct Trace<'a, P> {
    sections: &'a TipSections<'a, P>,
    counting: Counting,
    plane: PlaneAt,
    spacing: Spacing,
    budget: &'a Budget,
    pub(super) chains: Vec<Vec<Point3<f64>>>,
    /// The points so far of the section that is being traced.
    points: Vec<Point3<f64>>,
    n_points: usize,
    /// How many of the next middles are found by drops, not by Newton's method.
    n_distrusted: usize,
    /// Short intervals that were halved.
    n_short: usize,
}

impl<'a, P: Patch> Trace<'a, P> {
    pub(super) fn new(
        sections: &'a TipSections<'a, P>,
        counting: Counting,
        plane: PlaneAt,
        spacing: Spacing,
        budget: &'a Budget,
    ) -> Self {
        Self {
            sections,
            counting,
            plane,
            spacing,
            budget,
            chains: Vec::new(),
            points: Vec::new(),
            n_points: 0,
            n_distrusted: 0,
            n_short: 0,
        }
    }

    /// Finds every section. Returns `false` if the line only grazes something, so that the contact jumps more
    /// often than walls explain.
    pub(super) fn all(&mut self) -> Result<bool, SectionError> {
        self.until(|trace| trace.n_short > SHORT_LIMIT)?;
        Ok(self.n_short <= SHORT_LIMIT)
    }

    /// Finds every section, however often the contact jumps.
    pub(super) fn all_jumps(&mut self) -> Result<(), SectionError> {
        self.until(|_| false)
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
        let mut open = self.first_intervals()?;
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
            match (from.contact, to.contact) {
                (None, None) if self.is_empty(&from, &to) => {}
                (Some(first), Some(last)) => match self.stretch(&first, &last) {
                    ChordVerdict::Within => {
                        self.begin(&first);
                        self.points.push(self.point(&last));
                    }
                    _ if is_proved(&first) && is_proved(&last) => {
                        if to.at - from.at <= WALL_MM {
                            self.begin(&first);
                            self.climb(&last);
                        } else {
                            self.halve([from, to], &mut open)?;
                        }
                    }
                    ChordVerdict::Lower if to.at - from.at > self.trusted_length() => {
                        self.halve([from, to], &mut open)?
                    }
                    _ => self.prove([from, to], &mut open)?,
                },
                _ if !from.contact.iter().chain(&to.contact).all(is_proved) => {
                    self.prove([from, to], &mut open)?
                }
                (Some(first), None) if to.at - from.at > END_MM => {
                    let [last, beyond] = self.last_counting(first, to.at)?;
                    open.extend([[beyond, to], [last, beyond], [from, last]]);
                }
                (None, Some(last)) if to.at - from.at > END_MM => {
                    let [first, before] = self.last_counting(last, from.at)?;
                    open.extend([[first, to], [before, first], [from, before]]);
                }
                (Some(first), None) => {
                    self.begin(&first);
                    self.finish();
                }
                (None, Some(_)) => self.finish(),
                (None, None) => self.halve([from, to], &mut open)?,
            }
        }
        self.finish();
        Ok(())
    }

    /// Length of an interval, mm, above which its ends are trusted without a proof.
    fn trusted_length(&self) -> f64 {
        if self.n_distrusted > 0 { f64::INFINITY } else { TRUSTED_LENGTH * self.sections.contacts.scale }
    }

    /// Puts the halves of an interval on `open`.
    fn halve(&mut self, [from, to]: [Probe; 2], open: &mut Vec<[Probe; 2]>) -> Result<(), SectionError> {
        if let Some([first, second]) = self.crossing(&from, &to) {
            open.extend([[second, to], [from, first]]);
            return Ok(());
        }
        let at = 0.5 * (from.at + to.at);
        self.n_short += usize::from(to.at - from.at < SHORT_MM);
        let near = from.contact.or(to.contact).map(|contact| contact.place);
        let followed = near.filter(|_| self.n_distrusted == 0).and_then(|place| self.followed(at, place));
        self.n_distrusted = self.n_distrusted.saturating_sub(1);
        let middle = match followed {
            Some(contact) => Probe { at, contact: Some(contact) },
            None => self.probe_roughly(at, near)?,
        };
        open.extend([[middle, to], [from, middle]]);
        Ok(())
    }

    /// Where the contact followed from one end of an interval gives way to the contact followed from the
    /// other end: the same position with both contacts.
    fn crossing(&self, from: &Probe, to: &Probe) -> Option<[Probe; 2]> {
        let is_long =
            to.at - from.at > SHORT_MM && to.at - from.at <= CROSSING_LENGTH * self.sections.contacts.scale;
        let (Some(first), Some(last), true) = (from.contact, to.contact, is_long) else { return None };
        let crossing = self.sections.contacts.crossing(&first, &last)?;
        let is_counted = crossing.iter().all(|contact| self.sections.counts(self.counting, contact));
        is_counted.then(|| crossing.map(|contact| Probe { at: self.at(&contact), contact: Some(contact) }))
    }

    /// Puts an interval on `open` again, with contacts at its ends that are proved to be the highest. If the
    /// proved contact at its start is another one, a step in the section leads to it.
    fn prove(&mut self, [from, to]: [Probe; 2], open: &mut Vec<[Probe; 2]>) -> Result<(), SectionError> {
        let proved = |probe: Probe| match probe.contact {
            Some(contact) if !is_proved(&contact) => self.probe(probe.at, Some(contact.place)),
            _ => Ok(probe),
        };
        let followed = [from, to];
        let (from, to) = (proved(from)?, proved(to)?);
        let is_other = |probe: &Probe, known: &Probe| match (probe.contact, known.contact) {
            (Some(contact), Some(known)) => contact.tip.z > known.tip.z + HIGHER_MM,
            (None, known) => known.is_some(),
            (Some(_), None) => false,
        };
        if is_other(&from, &followed[0]) || is_other(&to, &followed[1]) {
            self.n_distrusted = DISTRUSTED;
        }
        match (self.points.last(), &from.contact) {
            (Some(last), Some(first)) if (self.point(first) - last).norm() > HIGHER_MM => {
                self.points.push(self.point(first))
            }
            (Some(_), None) => self.finish(),
            _ => {}
        }
        if let Some([begin, _]) = open.last_mut() {
            // At a crossing the next interval begins with the other contact, which is as high.
            let is_crossing = match (&begin.contact, &to.contact) {
                (Some(other), Some(own)) => {
                    (0..2).any(|k| (other.place[k] - own.place[k]).abs() > SAME_PLACE)
                        && !is_other(&to, begin)
                }
                _ => false,
            };
            if !is_crossing {
                *begin = to;
            }
        }
        open.push([from, to]);
        Ok(())
    }

    /// The range of the line, cut midway between neighbouring crossings with sides of the surface. Sections
    /// shorter than a search step lie between two sides, where such a cut meets them.
    fn first_intervals(&mut self) -> Result<Vec<[Probe; 2]>, SectionError> {
        let [low, high] = self.sections.range();
        let crossings = self.sections.sides.crossings(self.sections.axis, self.plane.traced_at);
        let between = crossings.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
        let mut at: Vec<f64> = between.filter(|at| (low..high).contains(at)).collect();
        at.insert(0, low);
        at.push(high);
        at.dedup();
        let probes: Result<Vec<Probe>, SectionError> =
            at.into_iter().map(|at| self.probe_roughly(at, None)).collect();
        Ok(probes?.windows(2).rev().map(|pair| [pair[0], pair[1]]).collect())
    }

    /// Whether the search finds no section between two positions that do not count.
    fn is_empty(&self, from: &Probe, to: &Probe) -> bool {
        let contacts = self.sections.contacts;
        let [low, high] = self.sections.range();
        let search_step = (SEARCH_STEP * contacts.scale).max((high - low) / POINT_LIMIT as f64);
        to.at - from.at <= search_step || contacts.is_free([from, to].map(|probe| self.position(probe.at)))
    }

    /// Begins a section, if none is being traced.
    fn begin(&mut self, first: &Contact) {
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
    fn stretch(&self, from: &Contact, to: &Contact) -> ChordVerdict {
        let way = to.tip - from.tip;
        if way.norm() > self.spacing.step_length_mm {
            return ChordVerdict::Lower;
        }
        let (across, rise) = (way.xy().norm(), way.z);
        let height = self.spacing.chord_height_mm;
        // On a steep chord, vertical distances are larger than distances from the chord. The larger height is
        // allowed if the chord is long enough, and if its ends are no lower than the section.
        let steep = height * (1.0 + (rise / across).powi(2)).sqrt();
        let below = if steep <= 0.25 * way.norm() { steep } else { height };
        let above = if is_proved(from) && is_proved(to) { below } else { height };
        // A contact on a seam or a pole has several names in parameters. The proof needs names that are near
        // each other.
        let contacts = self.sections.contacts;
        let renamed = |one: &Contact, other: &Contact| Contact {
            place: contacts.topology.nearest_name(one.place, other.place),
            ..*one
        };
        let from = renamed(from, to);
        contacts.stretch(&from, &renamed(to, &from), [below, above])
    }

    /// Adds the way up or down a wall, with points no farther apart than the step length.
    fn climb(&mut self, to: &Contact) {
        let (from, to) = (self.points[self.points.len() - 1], self.point(to));
        let steps = ((to - from).norm() / self.spacing.step_length_mm).ceil().clamp(1.0, POINT_LIMIT as f64);
        self.points.extend((1..=steps as usize).map(|k| from + (to - from) * (k as f64 / steps)));
    }

    /// The tip as a point of the pass. The plane of the pass may lie a little beside the plane over which the
    /// tip was found.
    fn point(&self, contact: &Contact) -> Point3<f64> {
        let axis = self.sections.axis;
        let mut point = contact.tip;
        point[axis] = self.plane.at;
        let out = (contact.point - contact.tip).xy();
        let rise = contact.slope * out[axis] / out.norm() * (self.plane.at - self.plane.traced_at);
        point.z += if contact.slope < STEEPEST_RISE && rise.is_finite() { rise } else { 0.0 };
        point
    }

    fn at(&self, contact: &Contact) -> f64 {
        contact.tip[1 - self.sections.axis]
    }

    fn position(&self, at: f64) -> Vector2<f64> {
        let mut position = Vector2::repeat(self.plane.traced_at);
        position[1 - self.sections.axis] = at;
        position
    }

    /// Drops the cutter at a position, exact to rounding: the higher of two contacts decides where a section
    /// ends.
    fn probe(&self, at: f64, near: Option<[f64; 2]>) -> Result<Probe, SectionError> {
        let contact = self.sections.contacts.drop(self.position(at), near, self.budget)?;
        Ok(Probe { at, contact: contact.filter(|contact| self.sections.counts(self.counting, contact)) })
    }

    /// As [`Self::probe`], for positions that mostly do not count. A contact that does not count is found
    /// only to a share of the chord height.
    fn probe_roughly(&self, at: f64, near: Option<[f64; 2]>) -> Result<Probe, SectionError> {
        let accuracy = ROUGH_SHARE * self.spacing.chord_height_mm;
        match self.sections.contacts.drop_within(accuracy, self.position(at), near, self.budget)? {
            Some(contact) if self.sections.counts(self.counting, &contact) => {
                self.probe(at, Some(contact.place))
            }
            _ => Ok(Probe { at, contact: None }),
        }
    }

    /// The contact that Newton's method finds from `guess`, if it counts. It is not proved to be the highest.
    /// If it is not, the proof of the chord fails, and the contacts at both ends are searched again with a
    /// proof.
    fn followed(&self, at: f64, guess: [f64; 2]) -> Option<Contact> {
        let contact = self.sections.contacts.near(self.position(at), guess)?;
        self.sections.counts(self.counting, &contact).then_some(contact)
    }
}
