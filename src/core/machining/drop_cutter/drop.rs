//! The search for the contact at one position of the axis. Newton's method finds a contact, and a proof shows
//! that no point of the surface lifts the tip higher.

use nalgebra::{Point3, Vector2};

use super::lift_bound::{AxisMove, Threshold};
use super::newton::{self, Climb, Found};
use super::round::RoundBodies;
use super::support::Support;
use super::tree::{Cover, Held, PartVisitor, SubPatch};
use super::{Contact, Contacts};
use crate::budget::{Budget, Stopped};
use crate::geometry::best_first::BestFirst;
use crate::geometry::surface::patch::Patch;
use crate::geometry::surface::{Jet, Surface, span_of};
use crate::machining::cutter::LowerPoint;

/// Newton steps on one patch where the contact is expected, and number of patches that are tried one after
/// another.
const FIRST_STEPS: usize = 5;
const PATCHES_TRIED: usize = 3;

/// The highest contact found so far.
#[derive(Debug, Clone, Copy)]
pub(super) struct Best {
    pub(super) height: f64,
    pub(super) jet: Jet,
    pub(super) place: [f64; 2],
    pub(super) lower: LowerPoint,
}

/// A search for the contact at one position.
pub(super) struct Drop<'a, 'b, P> {
    contacts: &'b Contacts<'a, P>,
    track: AxisMove,
    /// Accuracy to which the tip is proved, mm.
    accuracy: f64,
    /// The parameters near which the contact is expected.
    guess: Option<[f64; 2]>,
    best: Option<Best>,
    /// The bounds on other parts by the best contact.
    support: Option<Support>,
    round: Option<RoundBodies>,
    /// Parts that may lift the tip higher, with bounds of the height to which they lift it.
    open: BestFirst<Held<'b, P>>,
    /// Bound of the tip's height, mm, where the search ended early; else minus infinity.
    above: f64,
}

impl<'b, P: Patch> PartVisitor<'b, P> for Drop<'_, 'b, P> {
    fn promise(&self, cover: &Cover) -> f64 {
        match &self.support {
            Some(support)
                if support.excess_under(cover, &self.track, &self.flat_level()) <= self.accuracy =>
            {
                f64::NEG_INFINITY
            }
            _ => self.contacts.lift_of_box(&cover.bounds, &self.track),
        }
    }

    fn is_settled(&self, promise: f64) -> bool {
        promise <= self.level()
    }

    fn visit(&mut self, part: Held<'b, P>, promise: f64) {
        let highest =
            promise.min(self.contacts.lift_of_box(&part.bounds, &self.track)).min(self.highest(&part));
        self.renew_support();
        if highest > self.level() {
            self.open.push(highest, part);
        }
    }
}

impl<'a, 'b, P: Patch> Drop<'a, 'b, P> {
    pub(super) fn new(
        contacts: &'b Contacts<'a, P>,
        at: Vector2<f64>,
        guess: Option<[f64; 2]>,
        accuracy: f64,
    ) -> Self {
        Self {
            contacts,
            track: AxisMove::point(at),
            accuracy,
            guess,
            best: None,
            support: None,
            round: None,
            open: BestFirst::default(),
            above: f64::NEG_INFINITY,
        }
    }

    /// Parts that lift the tip no higher than this height, mm, do not matter.
    fn level(&self) -> f64 {
        self.best.map_or(f64::NEG_INFINITY, |best| best.height + self.accuracy)
    }

    /// Climbs from the parameters `place`, and goes on over joints of patches.
    pub(super) fn try_at(&mut self, mut place: [f64; 2]) {
        let spans = self.contacts.surface.spans();
        let mut patch = [0, 1].map(|k| span_of(place[k], spans[k]));
        for _ in 0..PATCHES_TRIED {
            place = self.climb_patch(patch, place);
            let next = [0, 1].map(|k| match place[k] - patch[k] as f64 {
                t if t <= 0.0 => patch[k].saturating_sub(1),
                t if t >= 1.0 => (patch[k] + 1).min(spans[k] - 1),
                _ => patch[k],
            });
            if next == patch {
                break;
            }
            patch = next;
        }
        self.renew_support();
    }

    /// Computes the bounds by the best contact, unless they are up to date.
    fn renew_support(&mut self) {
        if let (None, Some(best)) = (&self.support, &self.best) {
            self.support = Some(Support::of(&self.contacts.cutter, &best.lower, &self.track));
            self.round = Some(RoundBodies::around(&self.contacts.cutter, &best.lower, &best.jet));
        }
    }

    /// The height of the best contact, as a level.
    fn flat_level(&self) -> Threshold {
        Threshold { level: self.best.map_or(f64::NEG_INFINITY, |best| best.height), slope: 0.0 }
    }

    /// Climbs on one patch. Returns the parameters at which the climb ends.
    fn climb_patch(&mut self, [i, j]: [usize; 2], place: [f64; 2]) -> [f64; 2] {
        let patch = self.contacts.surface.patch(i, j);
        let start = [i as f64, j as f64];
        let own = [0, 1].map(|k| (place[k] - start[k]).clamp(0.0, 1.0));
        let (contacts, track) = (self.contacts, self.track);
        let mut climb = Climb::new(&contacts.cutter, &track, own);
        for _ in 0..FIRST_STEPS {
            let jet = climb.look(patch);
            self.raise(climb.found(&jet), start, [1.0, 1.0]);
            if !climb.step(patch, &jet) {
                break;
            }
        }
        [0, 1].map(|k| start[k] + climb.place()[k])
    }

    fn raise(&mut self, found: Option<Found>, start: [f64; 2], scale: [f64; 2]) {
        if let Some(Found { height, jet, place, lower }) = found
            && self.best.is_none_or(|best| height > best.height)
        {
            let place = [0, 1].map(|k| start[k] + scale[k] * place[k]);
            self.best = Some(Best { height, jet, place, lower });
            self.support = None;
            self.guess = Some(place);
        }
    }

    /// Halves the parts that may lift the tip higher, the one with the highest bound first, until none is
    /// left or `most` parts are halved.
    pub(super) fn close(&mut self, most: usize, budget: &Budget) -> Result<(), Stopped> {
        for halvings in 1.. {
            let Some((highest, part)) = self.open.pop() else { return Ok(()) };
            if highest <= self.level() {
                return Ok(());
            }
            if part.size() <= self.contacts.smallest || halvings > most {
                self.above = highest;
                return Ok(());
            }
            if halvings.is_multiple_of(64) {
                budget.check()?;
            }
            for half in self.contacts.tree.halves(&part) {
                let promise = self.contacts.lift_of_box(&half.bounds, &self.track);
                if !self.is_settled(promise) {
                    self.visit(half, promise);
                }
            }
        }
        Ok(())
    }

    /// Upper bound of the height to which a part lifts the tip. It is refined only until it is no higher than
    /// [`Self::level`]. A contact found on the way may become the best.
    fn highest(&mut self, part: &SubPatch<P>) -> f64 {
        if let (Some(best), Some(support)) = (&self.best, &self.support) {
            let highest = best.height + support.excess(part, &self.track, &self.flat_level());
            if highest <= self.level() {
                return highest;
            }
        }
        let highest = self.contacts.lift_of_part(part, &self.track);
        if highest <= self.level() {
            return highest;
        }
        let start = self.guess.map_or([0.5, 0.5], |place| part.nearest(place));
        let (under, is_found) = self.climb_part(part, start);
        if under <= self.level() {
            return under;
        }
        self.renew_support();
        let level = Threshold { level: self.level(), slope: 0.0 };
        if self.round.is_some_and(|round| round.keep_below(part, &self.track, &level)) {
            return level.level;
        }
        // A climb that starts beside the cutter may never get under it.
        let under = if is_found {
            under
        } else {
            under.min(self.climb_part(part, part.nearest_corner(&self.track.center)).0)
        };
        highest.min(under)
    }

    /// Climbs on a part from a place in the part's own parameters. Returns an upper bound of the height to
    /// which the part lifts the tip, and whether any place of the climb lifts it.
    fn climb_part(&mut self, part: &SubPatch<P>, start: [f64; 2]) -> (f64, bool) {
        let (contacts, track) = (self.contacts, self.track);
        let bends = part.bends();
        let mut climb = Climb::new(&contacts.cutter, &track, start);
        let (mut highest, mut is_found) = (f64::INFINITY, false);
        for k in 1..=newton::STEPS {
            let jet = climb.look(&part.patch);
            let found = climb.found(&jet);
            is_found |= found.is_some();
            self.raise(found, part.start, part.scale);
            let least = self.best.map_or(jet.point.z, |best| best.height);
            let level = Threshold { level: least, slope: 0.0 };
            let seen_from = |climb: &Climb| least + climb.excess(part, bends, &jet, &level);
            // The first and the last place of a climb give the best bounds.
            if k == 1 {
                highest = seen_from(&climb);
                if highest <= self.level() {
                    break;
                }
            }
            let looked = climb;
            if k == newton::STEPS || !climb.step(&part.patch, &jet) {
                highest = highest.min(seen_from(&looked));
                break;
            }
        }
        (highest, is_found)
    }

    #[cfg(test)]
    pub(super) fn best(&self) -> Option<Best> {
        self.best
    }

    pub(super) fn contact(&self) -> Option<Contact> {
        let best = self.best.as_ref()?;
        let at = self.track.center;
        let gap_mm = (self.above - best.height).max(self.accuracy);
        Some(Contact {
            tip: Point3::new(at.x, at.y, best.height),
            point: best.jet.point,
            place: best.place,
            gap_mm,
            slope: best.lower.slope(),
            is_rolling: self.contacts.is_rolling(best),
        })
    }
}
