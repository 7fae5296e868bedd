//! The walk along one line of positions, over all of its sections.

use nalgebra::{Point2, Point3, Vector2};

use super::Contact;
use super::pace::{Pace, SHORTEST_STEP_MM};
use super::section::TipSections;
use crate::budget::Budget;
use crate::geometry::section::{PlaneAt, SectionError, Spacing};
use crate::geometry::surface::Surface;
use crate::geometry::surface::patch::Patch;

/// The distance at which positions are looked at where the surface is not found yet, in parts of what is large.
const SEARCH_STEP: f64 = 0.05;

/// How retreats from an end that is not found again grow.
const RETREAT_GROWTH: f64 = 8.0;

/// A contact is overtaken where another lifts the tip higher by this part of the chord height.
const OVERTAKEN_SHARE: f64 = 0.01;

/// Upright walls in a row before the section is lost, and places at which it is broken.
const WALL_LIMIT: usize = 64;
const BREAK_LIMIT: usize = 8;

/// Looks at parts of the surface for all sections of a job: some fifteen seconds of one core where they are dear, and three times what a
/// flat end takes for a hundred metres of path.
const LOOK_LIMIT: usize = 30_000_000;

/// Halvings of parts for one position: what lies between positions is proved, so that nobody need know one any better.
const HALVINGS_OF_PARTS: usize = 200;

/// And where no step could be made with that.
const HALVINGS_AT_LAST: usize = 4_000;

/// Steps that are shortened before another contact than the one followed is looked for.
const FAILURES: usize = 3;

/// Points of one section.
const POINT_LIMIT: usize = 1_000_000;

/// Halvings between a position that counts and one that does not.
const HALVINGS: usize = 60;

/// Positions between two looks at the budget.
const STEPS_BETWEEN_CHECKS: usize = 64;

/// Tips that differ by more are not of the same contact, mm.
const HIGHER_MM: f64 = 1e-8;

/// The cutter stands level where its slope is less.
const LEVEL_SLOPE: f64 = 1e-9;

/// Where the cutter touches steeper, the tip is as near to its plane by a move to the side.
const STEEPEST_RISE: f64 = 10.0;

/// Contacts this near to the border of the flat, in parts of its radius, are its own: how steep they are is not known to the arithmetic.
const ON_RIM: f64 = 1e-6;

/// A walk along one line.
pub(super) struct Walk<'a, P> {
    sections: &'a TipSections<'a, P>,
    plane: PlaneAt,
    spacing: Spacing,
    budget: &'a Budget,
    pub(super) chains: Vec<Vec<Point3<f64>>>,
    n_points: usize,
}

/// What came of a step.
enum Step {
    /// The tips between keep to the chord.
    Joined(Contact),
    /// The tips jump.
    Wall(Contact),
    /// What is between is not known: the section goes on behind it.
    Break(Contact),
    TooLong,
    /// The contact there does not count: the section ends on the way.
    Outside,
}

impl<'a, P: Patch> Walk<'a, P> {
    pub(super) fn new(
        sections: &'a TipSections<'a, P>,
        plane: PlaneAt,
        spacing: Spacing,
        budget: &'a Budget,
    ) -> Self {
        Self { sections, plane, spacing, budget, chains: Vec::new(), n_points: 0 }
    }

    /// Finds every section and follows it.
    pub(super) fn all(&mut self) -> Result<(), SectionError> {
        let contacts = self.sections.contacts;
        let [low, high] = self.sections.range();
        let search_step = (SEARCH_STEP * contacts.scale).max((high - low) / POINT_LIMIT as f64);
        // Sections that are shorter than a step lie between two sides.
        let crossings = self.sections.sides.crossings(self.sections.axis, self.plane.traced_at);
        let mut between: Vec<f64> =
            crossings.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).rev().collect();
        let mut outside = low;
        for k in 0.. {
            if k % STEPS_BETWEEN_CHECKS == 0 {
                self.budget.check()?;
            }
            while between.pop_if(|next| *next <= outside).is_some() {}
            let step = outside + search_step;
            let at = between.pop_if(|next| *next < step).unwrap_or(step).min(high);
            if let Some(found) = self.contact(at, None)? {
                let first = self.last_counting(found, outside)?;
                outside = self.follow(first, high)?;
            } else {
                outside = at;
            }
            if outside >= high {
                return Ok(());
            }
        }
        Ok(())
    }

    /// Follows the tips from one that counts to the last; answers a position beyond it.
    fn follow(&mut self, first: Contact, high: f64) -> Result<f64, SectionError> {
        let mut points = vec![self.point(&first)];
        let (mut before, mut here) = (first, first);
        let mut pace = Pace::new(self.sections.contacts.scale, self.spacing.step_length_mm);
        let (mut walls, mut breaks) = (0, 0);
        // The section ends at `end`; what lies `beyond` does not count.
        let (mut end, mut beyond) = (high, high);
        // Whether a contact counts may not be known to the arithmetic: who does not find the end again looks ever farther before it.
        let mut retreat = SHORTEST_STEP_MM;
        for tries in 1usize.. {
            if self.at(&here) >= end {
                break;
            }
            if tries.is_multiple_of(STEPS_BETWEEN_CHECKS) {
                self.budget.check()?;
            }
            self.check_limits(points.len())?;
            let to = (self.at(&here) + pace.step).min(end);
            match self.step(&before, &here, to, &pace)? {
                Step::Joined(next) => {
                    points.push(self.point(&next));
                    (before, here) = (here, next);
                    (walls, breaks) = (0, 0);
                    pace.quicken();
                }
                Step::Wall(next) => {
                    walls += 1;
                    if walls > WALL_LIMIT {
                        return Err(SectionError::Lost { at: here.tip });
                    }
                    self.climb(&mut points, &next);
                    points.push(self.point(&next));
                    (before, here) = (here, next);
                    pace.quicken();
                }
                Step::Break(next) => {
                    breaks += 1;
                    if breaks > BREAK_LIMIT {
                        return Err(SectionError::Lost { at: here.tip });
                    }
                    self.finish(std::mem::replace(&mut points, vec![self.point(&next)]));
                    (before, here) = (next, next);
                }
                Step::TooLong => {
                    pace.slow();
                    if pace.failures == FAILURES
                        && let Some(higher) = self.higher(&here)?
                    {
                        points.push(self.point(&higher));
                        (before, here) = (higher, higher);
                    }
                }
                Step::Outside if to < end || end == high => {
                    let last = self.last_counting(here, to)?;
                    (end, beyond) = (self.at(&last), to);
                }
                Step::Outside => {
                    (end, beyond) = (end - retreat, to);
                    retreat *= RETREAT_GROWTH;
                }
            }
        }
        self.finish(points);
        Ok(beyond)
    }

    fn finish(&mut self, points: Vec<Point3<f64>>) {
        self.n_points += points.len();
        self.chains.push(points);
    }

    fn check_limits(&self, n_points: usize) -> Result<(), SectionError> {
        if self.sections.contacts.looks() > LOOK_LIMIT {
            Err(SectionError::TooManyLooks { limit: LOOK_LIMIT })
        } else if self.n_points + n_points >= POINT_LIMIT {
            Err(SectionError::TooManyPoints { limit: POINT_LIMIT })
        } else {
            Ok(())
        }
    }

    /// Tries a step on.
    fn step(&mut self, before: &Contact, here: &Contact, to: f64, pace: &Pace) -> Result<Step, SectionError> {
        let followed = self.next(before, here, to);
        let is_shortest = pace.is_shortest() || to - self.at(here) <= SHORTEST_STEP_MM;
        if let Some(next) = followed
            && !is_shortest
        {
            if self.is_joined(here, &next) {
                return Ok(Step::Joined(next));
            }
            // Mostly the step was too long for the chord.
            if pace.failures < FAILURES {
                return Ok(Step::TooLong);
            }
        }
        let halvings = if is_shortest { HALVINGS_AT_LAST } else { HALVINGS_OF_PARTS };
        let Some(next) = self.contact_within(to, Some(here.place), halvings)? else {
            return Ok(Step::Outside);
        };
        let is_new = is_shortest || is_higher(&next, &followed);
        if is_new && self.is_joined(here, &next) {
            Ok(Step::Joined(next))
        } else if !is_shortest {
            Ok(Step::TooLong)
        } else if self.sections.contacts.is_wall(here, &next, self.spacing.chord_height_mm) {
            Ok(Step::Wall(next))
        } else {
            Ok(Step::Break(next))
        }
    }

    /// The contact at the position of one that was followed, where another has come to lift the tip higher, within the chord height.
    fn higher(&mut self, here: &Contact) -> Result<Option<Contact>, SectionError> {
        let contact = self.contact(self.at(here), Some(here.place))?;
        Ok(contact
            .filter(|contact| contact.tip.z > here.tip.z + OVERTAKEN_SHARE * self.spacing.chord_height_mm))
    }

    fn is_joined(&self, from: &Contact, to: &Contact) -> bool {
        let way = to.tip - from.tip;
        if way.norm() > self.spacing.step_length_mm {
            return false;
        }
        let (across, rise) = (way.xy().norm(), way.z);
        let height = self.spacing.chord_height_mm;
        // Vertical heights are larger than distances where the chord is steep and long enough.
        let steep = height * (1.0 + (rise / across).powi(2)).sqrt();
        let vertical = if steep <= 0.25 * way.norm() { steep } else { height };
        self.sections.contacts.is_within(from, to, vertical)
    }

    /// Adds points on the way up or down a wall, no farther apart than the step length.
    fn climb(&self, points: &mut Vec<Point3<f64>>, to: &Contact) {
        let (from, to) = (points[points.len() - 1], self.point(to));
        let steps = ((to - from).norm() / self.spacing.step_length_mm).ceil().min(POINT_LIMIT as f64);
        points.extend((1..steps as usize).map(|k| from + (to - from) * (k as f64 / steps)));
    }

    /// The tip as a point of the pass, whose plane may lie a little beside that over which it was found.
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

    /// Where the contact is expected on the way on.
    fn expected(&self, before: &Contact, here: &Contact, to: f64) -> [f64; 2] {
        let done = self.at(here) - self.at(before);
        let ratio = if done > 0.0 { ((to - self.at(here)) / done).min(2.0) } else { 0.0 };
        let spans = self.sections.contacts.surface.spans();
        [0, 1]
            .map(|k| (here.place[k] + ratio * (here.place[k] - before.place[k])).clamp(0.0, spans[k] as f64))
    }

    /// A contact on the way on that counts, without a proof: where it is expected, if the point that is touched now does not lift the
    /// tip higher.
    fn next(&self, before: &Contact, here: &Contact, to: f64) -> Option<Contact> {
        let next = self.followed(to, self.expected(before, here, to));
        let distance = (here.point.xy() - Point2::from(self.position(to))).norm();
        let lift = here.point.z - self.sections.contacts.cutter.height(distance);
        if next.is_none_or(|next| lift > next.tip.z + HIGHER_MM) {
            self.followed(to, here.place)
        } else {
            next
        }
    }

    /// A contact near an expected one that counts, without a proof.
    fn followed(&self, to: f64, guess: [f64; 2]) -> Option<Contact> {
        let contact = self.sections.contacts.near(self.position(to), guess)?;
        self.counts(&contact).then_some(contact)
    }

    /// The contact at a position, if it counts.
    ///
    /// # Errors
    /// When the sections took too many looks, or the budget stops.
    fn contact(&mut self, at: f64, near: Option<[f64; 2]>) -> Result<Option<Contact>, SectionError> {
        self.contact_within(at, near, HALVINGS_OF_PARTS)
    }

    /// The same with so many halvings of parts.
    fn contact_within(
        &mut self,
        at: f64,
        near: Option<[f64; 2]>,
        halvings: usize,
    ) -> Result<Option<Contact>, SectionError> {
        let contacts = self.sections.contacts;
        if contacts.looks() > LOOK_LIMIT {
            return Err(SectionError::TooManyLooks { limit: LOOK_LIMIT });
        }
        let contact = contacts.drop_within(self.position(at), near, halvings, self.budget)?;
        Ok(contact.filter(|contact| self.counts(contact)))
    }

    fn counts(&self, contact: &Contact) -> bool {
        let contacts = self.sections.contacts;
        let off = (contact.point - contact.tip).xy().norm();
        let is_level = contact.slope <= LEVEL_SLOPE && off < (1.0 - ON_RIM) * contacts.cutter.flat_radius();
        !contact.is_rolling && (!is_level || contacts.is_over(contact))
    }

    /// The last contact that counts on the way from one to a position without: mostly that which can be followed the farthest.
    fn last_counting(&mut self, counting: Contact, outside: f64) -> Result<Contact, SectionError> {
        let followed = self.last(counting, outside, |walk, at, near| Ok(walk.followed(at, near)))?;
        let found = self.contact(self.at(&followed), Some(followed.place))?;
        if found.is_some_and(|found| !is_higher(&found, &Some(followed))) {
            return Ok(followed);
        }
        self.last(counting, outside, |walk, at, near| walk.contact(at, Some(near)))
    }

    /// The last contact from one on to a position without, by halving.
    fn last(
        &mut self,
        mut counting: Contact,
        mut outside: f64,
        look: impl Fn(&mut Self, f64, [f64; 2]) -> Result<Option<Contact>, SectionError>,
    ) -> Result<Contact, SectionError> {
        for _ in 0..HALVINGS {
            let at = self.at(&counting);
            if (at - outside).abs() <= 1e-2 * SHORTEST_STEP_MM {
                break;
            }
            let middle = 0.5 * (at + outside);
            match look(self, middle, counting.place)? {
                Some(contact) => counting = contact,
                None => outside = middle,
            }
        }
        Ok(counting)
    }
}

/// Whether a contact is another than one that was followed.
fn is_higher(contact: &Contact, followed: &Option<Contact>) -> bool {
    followed.is_none_or(|followed| contact.tip.z > followed.tip.z + HIGHER_MM)
}
