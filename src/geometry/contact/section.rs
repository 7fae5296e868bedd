//! Tips along a line of positions: what a pass follows, with a proved distance from what lies between.
//!
//! # Method
//! The line is walked over the surface. Each position is taken from the one before by Newton's method alone; that nothing else lifts the
//! cutter there is proved with the stretch between ([`Contacts::is_within`]), and where that fails the contact is looked for
//! anew and the step shortened. Where tips jump, at upright walls and where sheets end, the step shrinks to
//! [`SHORTEST_STEP_MM`], and the chord is the wall, if nothing stands higher.
//!
//! A tip counts where the cutter touches the surface with its tangent plane, or an edge within the surface. Where it only hangs on
//! an edge at which the surface ends, the section ends.
//!
//! # Cost
//! O(points): some ten microseconds a point on a grid of 60 x 60 at a chord height of 6e-4 mm.

use nalgebra::{Point2, Point3, Vector2, Vector3};

use super::sides::{Sides, position};
use super::{Contact, Contacts};
use crate::budget::{Budget, Stopped};
use crate::geometry::section::{Chain, PlaneAt, SectionError, Spacing};
use crate::geometry::surface::Surface;
use crate::geometry::surface::patch::Patch;

/// Tips this near to each other may be at any height: the wall between them is upright.
pub const SHORTEST_STEP_MM: f64 = 1e-6;

/// The cutter just grazes the surface from farther out, in parts of the radius.
const GRAZING: f64 = 1e-6;

/// The distance at which positions are looked at where the surface is not found yet, in parts of what is large.
const SEARCH_STEP: f64 = 0.25;

/// The first step of a section, in parts of what is large.
const FIRST_STEP: f64 = 0.05;

/// How steps grow near the longest that is possible, and far below it: after so many in a row.
const GROWTH: f64 = 1.05;
const GROWTH_FAR: f64 = 1.4;
const FAR: usize = 8;
const SHRINKAGE: f64 = 0.8;

/// A contact is overtaken where another lifts the tip higher by this part of the chord height.
const OVERTAKEN_SHARE: f64 = 0.01;

/// Upright walls in a row before the section is lost.
const WALL_LIMIT: usize = 8;

/// Looks at parts of the surface for all sections of a job: some two minutes.
const LOOK_LIMIT: usize = 100_000_000;

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

/// The tips over lines at right angles to an axis.
pub struct TipSections<'a, P> {
    contacts: &'a Contacts<'a, P>,
    /// 0 is x, 1 is y.
    axis: usize,
    sides: Sides,
}

/// A walk along one line.
struct Walk<'a, P> {
    sections: &'a TipSections<'a, P>,
    plane: PlaneAt,
    spacing: Spacing,
    budget: &'a Budget,
    chains: Vec<Vec<Point3<f64>>>,
    n_points: usize,
}

impl<'a, P: Patch> TipSections<'a, P> {
    /// Over lines at right angles to `axis` (0 is x, 1 is y).
    ///
    /// # Errors
    /// Only the budget's stop.
    pub fn new(contacts: &'a Contacts<'a, P>, axis: usize, budget: &Budget) -> Result<Self, Stopped> {
        Ok(Self { contacts, axis, sides: Sides::new(contacts, axis, budget)? })
    }

    /// The sections over `plane`, in the sense of the growing coordinate.
    ///
    /// # Errors
    /// When a section has too many points, or the budget stops.
    pub fn chains(
        &self,
        plane: PlaneAt,
        spacing: Spacing,
        budget: &Budget,
    ) -> Result<Vec<Chain>, SectionError> {
        let mut walk = Walk { sections: self, plane, spacing, budget, chains: Vec::new(), n_points: 0 };
        walk.all()?;
        let chain =
            |points| Chain { points, chord_height_mm: spacing.chord_height_mm + 2.0 * SHORTEST_STEP_MM };
        Ok(walk.chains.into_iter().filter(|points| points.len() >= 2).map(chain).collect())
    }

    /// The steps of one section, at least: none is longer than a radius, or than a tenth of the surface.
    pub fn least_steps(&self) -> f64 {
        let [low, high] = self.range();
        (high - low) / self.contacts.scale
    }

    /// Between which positions along a line the cutter is over the surface, mm.
    fn range(&self) -> [f64; 2] {
        let along = 1 - self.axis;
        let radius = (1.0 - GRAZING) * self.contacts.cutter.radius();
        [self.contacts.bounds().min[along] - radius, self.contacts.bounds().max[along] + radius]
    }

    /// The least and the largest coordinate of positions along the axis that may count, mm: those whose cutter touches a side of the
    /// surface with its tangent plane, or any part of it at the middle.
    pub fn extent(&self) -> [f64; 2] {
        let contacts = self.contacts;
        let middles =
            contacts.tree.parts.iter().filter_map(|part| position(contacts, part.on_surface([0.5, 0.5])));
        let mut extent = [f64::INFINITY, f64::NEG_INFINITY];
        for at in self.sides.positions().copied().chain(middles) {
            extent = [extent[0].min(at[self.axis]), extent[1].max(at[self.axis])];
        }
        extent
    }
}

impl<P: Patch> Walk<'_, P> {
    fn all(&mut self) -> Result<(), SectionError> {
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
        let contacts = self.sections.contacts;
        let scale = contacts.scale;
        let longest = self.spacing.step_length_mm.min(scale);
        let mut points = vec![self.point(&first)];
        let mut here = first;
        let mut before = first;
        let mut step = longest.min(FIRST_STEP * scale);
        let (mut tries, mut failures, mut successes, mut walls) = (0usize, 0, 0, 0);
        // The section ends at `end`; what lies `beyond` does not count.
        let (mut end, mut beyond) = (high, high);
        while self.at(&here) < end {
            tries += 1;
            if tries.is_multiple_of(STEPS_BETWEEN_CHECKS) {
                self.budget.check()?;
            }
            if contacts.looks() > LOOK_LIMIT {
                return Err(SectionError::TooManyLooks { limit: LOOK_LIMIT });
            }
            if self.n_points + points.len() >= POINT_LIMIT {
                return Err(SectionError::TooManyPoints { limit: POINT_LIMIT });
            }
            let to = (self.at(&here) + step).min(end);
            let is_shortest = step <= SHORTEST_STEP_MM || to - self.at(&here) <= SHORTEST_STEP_MM;
            let next = match self.next(&before, &here, to) {
                Some(next) if !is_shortest && self.is_joined(&here, &next) => Some(next),
                // Mostly the step was too long for the chord.
                Some(_) if !is_shortest && failures < FAILURES => None,
                followed => match self.contact(to, Some(here.place))? {
                    Some(next) if is_shortest => {
                        if !self.is_joined(&here, &next) {
                            walls += 1;
                            if walls > WALL_LIMIT
                                || !contacts.is_wall(&here, &next, self.spacing.chord_height_mm)
                            {
                                return Err(SectionError::Lost { at: here.tip });
                            }
                        }
                        self.climb(&mut points, &next);
                        Some(next)
                    }
                    Some(next) if is_higher(&next, &followed) && self.is_joined(&here, &next) => Some(next),
                    Some(_) => None,
                    None => {
                        let last = self.last_counting(here, to)?;
                        (end, beyond) = (self.at(&last), to);
                        continue;
                    }
                },
            };
            match next {
                Some(next) => {
                    points.push(self.point(&next));
                    (before, here) = (here, next);
                    successes += 1;
                    step = (step * if successes > FAR { GROWTH_FAR } else { GROWTH }).min(longest);
                    failures = 0;
                    walls = if is_shortest { walls } else { 0 };
                }
                None => {
                    step = (step * SHRINKAGE).max(SHORTEST_STEP_MM);
                    (failures, successes) = (failures + 1, 0);
                    if failures == FAILURES
                        && let Some(higher) = self.higher(&here)?
                    {
                        points.push(self.point(&higher));
                        (before, here) = (higher, higher);
                    }
                }
            }
        }
        self.n_points += points.len();
        self.chains.push(points);
        Ok(beyond)
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
        point.z += if rise.is_finite() { rise } else { 0.0 };
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
        let contacts = self.sections.contacts;
        if contacts.looks() > LOOK_LIMIT {
            return Err(SectionError::TooManyLooks { limit: LOOK_LIMIT });
        }
        let contact = contacts.drop(self.position(at), near, self.budget)?;
        Ok(contact.filter(|contact| self.counts(contact)))
    }

    fn counts(&self, contact: &Contact) -> bool {
        let is_level = contact.slope <= LEVEL_SLOPE && self.sections.contacts.cutter.flat_radius() > 0.0;
        !contact.is_rolling && (!is_level || self.sections.contacts.is_over(contact))
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

impl<P: Patch> Contacts<'_, P> {
    /// Whether the axis of a cutter that stands level is over the surface, and not beyond its edges.
    fn is_over(&self, contact: &Contact) -> bool {
        let at = contact.tip.xy();
        let [nu, nv] = self.surface.spans().map(|n| n as f64);
        let mut place = contact.place;
        // Gauss and Newton know no sides: the last step says whether the place is outside.
        for _ in 0..20 {
            let jet = self.surface.jet(place[0], place[1]);
            let across = nalgebra::Matrix2::from_columns(&[jet.du.xy(), jet.dv.xy()]);
            let Some(inverse) = across.try_inverse() else { return true };
            let step = inverse * (at.coords - jet.point.coords.xy());
            if step.norm() < 1e-12 {
                return true;
            }
            let next = [place[0] + step.x, place[1] + step.y];
            let inside = [next[0].clamp(0.0, nu), next[1].clamp(0.0, nv)];
            if inside == place {
                return false;
            }
            place = inside;
        }
        let jet: Vector3<f64> = self.surface.jet(place[0], place[1]).point.coords;
        (at.coords - jet.xy()).norm() <= 1e-9
    }
}

/// Whether a contact is another than one that was followed.
fn is_higher(contact: &Contact, followed: &Option<Contact>) -> bool {
    followed.is_none_or(|followed| contact.tip.z > followed.tip.z + HIGHER_MM)
}
