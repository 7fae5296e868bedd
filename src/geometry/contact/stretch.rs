//! How far the tips of a stretch of positions leave the chord of those at its ends.
//!
//! # Method
//! While the axis follows a line from a to b, the tip follows a curve z. Its chord is the line between both tips.
//! *Above*: no part lifts the tip more than `height` over the chord, for no position: the bound of `bound` with the way
//! as a third variable. *Below*: the points of the surface on the straight line of parameters between both contacts
//! lift the tip at least to the chord, but for how far their curve bends away from its own chord, because the lower side of the
//! cutter is convex; or else, the contact of each end lifts the tip high enough up to the middle.
//!
//! # Guarantees
//! What is confirmed holds for every position of the stretch, but for rounding.

use nalgebra::{Point3, Vector2};

use super::bound::{Level, Track};
use super::climb::Climb;
use super::tree::{Part, Visitor};
use super::{Contact, Contacts, Support};
use crate::geometry::surface::patch::{Bounds, Patch};
use crate::geometry::surface::{Surface, span_of};

/// Halvings of parts for one stretch; beyond that the stretch is too long. Where contacts change place, a short one needs many.
const HALVING_LIMIT: usize = 4;
const HALVING_LIMIT_SHORT: usize = 256;

/// Halvings of a straight way.
const LINK_HALVINGS: usize = 64;

/// What is short, in parts of what is large.
const SHORT: f64 = 2e-3;

/// Steps on one part.
const STEPS: usize = 2;

/// Joints of patches between the contacts of a stretch; more are too many.
const JOINT_LIMIT: usize = 6;

impl<P: Patch> Contacts<'_, P> {
    /// Whether the tips between two contacts lie nowhere more than `height` mm above or below the chord of theirs. A `false` may
    /// mean that this is not known.
    pub fn is_within(&self, from: &Contact, to: &Contact, height: f64) -> bool {
        let guess = [0, 1].map(|k| 0.5 * (from.place[k] + to.place[k]));
        self.is_above(from, to, height) && self.is_below([from.tip, to.tip], guess, height)
    }

    /// Whether the cutter may go straight from one place to another, with nothing that lifts its tip by more than `height` mm. A `false`
    /// may mean that this is not known.
    pub fn is_clear(&self, from: Point3<f64>, to: Point3<f64>, height: f64) -> bool {
        let mut open = vec![[from, to]];
        let mut halvings = 0;
        while let Some([from, to]) = open.pop() {
            let middle = nalgebra::center(&from, &to);
            let near = self.tree.parts[0].on_surface([0.5, 0.5]);
            if self.is_below([from, to], near, height) {
                continue;
            }
            halvings += 1;
            if halvings > LINK_HALVINGS || (to - from).norm() < SHORT * self.scale {
                return false;
            }
            open.extend([[middle, to], [from, middle]]);
        }
        true
    }

    /// Whether no part lifts the tip more than `height` over the chord; the contact is expected near `guess`.
    fn is_below(&self, [from, to]: [Point3<f64>; 2], guess: [f64; 2], height: f64) -> bool {
        let way = (to - from).xy();
        let length = way.norm();
        let unit = if length > 0.0 { way / length } else { Vector2::zeros() };
        let center = 0.5 * (from.coords + to.coords);
        let slope = if length > 0.0 { (to.z - from.z) / length } else { 0.0 };
        let mut look = Look {
            contacts: self,
            track: Track { center: center.xy(), way: unit, reach: 0.5 * length },
            level: Level { level: center.z + height, slope },
            guess,
            support: None,
            halvings: if length < SHORT * self.scale { HALVING_LIMIT_SHORT } else { HALVING_LIMIT },
            is_below: true,
        };
        if let Some(middle) = self.near(look.track.center, guess) {
            if middle.tip.z > look.level.level {
                return false;
            }
            look.guess = middle.place;
            look.support = look.support_at(middle.place);
        }
        self.tree.visit(&mut look);
        look.is_below
    }

    /// Whether the surface is known to lift the tip to `height` below the chord everywhere.
    fn is_above(&self, from: &Contact, to: &Contact, height: f64) -> bool {
        self.is_above_by_line(from, to, height) || self.is_above_by_ends(from, to, height)
    }

    /// By the line of parameters between the contacts.
    fn is_above_by_line(&self, from: &Contact, to: &Contact, height: f64) -> bool {
        let [nu, nv] = self.surface.spans();
        let step = [0, 1].map(|k| to.place[k] - from.place[k]);
        // Where the line meets joints of patches.
        let mut joints = vec![0.0, 1.0];
        for (k, step) in step.into_iter().enumerate() {
            let [low, high] = [from.place[k].min(to.place[k]), from.place[k].max(to.place[k])];
            if (high.floor() - low.ceil()) as usize > JOINT_LIMIT {
                return false;
            }
            let mut joint = low.floor() + 1.0;
            while joint < high {
                joints.push((joint - from.place[k]) / step);
                joint += 1.0;
            }
        }
        joints.sort_by(f64::total_cmp);
        let place = |t: f64| [0, 1].map(|k| from.place[k] + t * step[k]);
        let lift = |t: f64| {
            let [u, v] = place(t);
            let axis = from.tip.xy() + (to.tip - from.tip).xy() * t;
            let point = self.surface.jet(u, v).point;
            point.z - self.cutter.height((point.xy() - axis).norm() * (1.0 - 1e-14))
        };
        let chord = |t: f64| from.tip.z + (to.tip.z - from.tip.z) * t;
        let tilt = self.steepness(from).max(self.steepness(to));
        joints.windows(2).all(|pair| {
            let [from_t, to_t] = [pair[0], pair[1]];
            let middle = place(0.5 * (from_t + to_t));
            let [i, j] = [span_of(middle[0], nu), span_of(middle[1], nv)];
            let [uu, uv, vv] = self.bends[i * nv + j];
            let [du, dv] = step.map(|d| d.abs() * (to_t - from_t));
            let bend = (uu * du * du + 2.0 * uv * du * dv + vv * dv * dv) / 8.0;
            // Lifts at joints are what they are; those at the ends are the tips themselves.
            let dip = [from_t, to_t]
                .map(|t| if t == 0.0 || t == 1.0 { 0.0 } else { (chord(t) - lift(t)).max(0.0) });
            dip[0].max(dip[1]) + bend * tilt <= height
        })
    }

    /// How much the lift changes at most where a surface point near a contact is moved by a millimetre: as steep as the cutter is there,
    /// with something for what lies beside it; a sharp rim is moved along the surface.
    fn steepness(&self, contact: &Contact) -> f64 {
        let slope = contact.slope;
        1.1 * (1.0 + slope * slope).sqrt() + 0.1
    }

    /// By the contacts of both ends, each up to the middle.
    fn is_above_by_ends(&self, from: &Contact, to: &Contact, height: f64) -> bool {
        let middle = nalgebra::center(&from.tip, &to.tip);
        [from, to].iter().all(|contact| {
            let lift = contact.point.z - self.cutter.height((contact.point - middle).xy().norm());
            lift >= middle.z - height
        })
    }
}

/// A look at all parts that may lift the tip over the chord.
struct Look<'a, 'b, P> {
    contacts: &'b Contacts<'a, P>,
    track: Track,
    level: Level,
    guess: [f64; 2],
    support: Option<Support>,
    /// Halvings that are left.
    halvings: usize,
    is_below: bool,
}

impl<P: Patch> Look<'_, '_, P> {
    fn support_at(&self, [u, v]: [f64; 2]) -> Option<Support> {
        let [nu, nv] = self.contacts.surface.spans();
        let [i, j] = [span_of(u, nu), span_of(v, nv)];
        let patch = self.contacts.surface.patch(i, j);
        let mut climb = Climb::new(&self.contacts.cutter, &self.track, [u - i as f64, v - j as f64]);
        let _ = climb.look(patch);
        climb.lower().map(|lower| Support::of(&self.contacts.cutter, &lower, &self.track))
    }

    fn settles(&self, part: &Part<P>) -> bool {
        if let Some(support) = &self.support
            && support.excess(part, &self.track, &self.level) <= 0.0
        {
            return true;
        }
        let mut climb = Climb::new(&self.contacts.cutter, &self.track, part.nearest(self.guess));
        for _ in 0..STEPS {
            let jet = climb.look(&part.patch);
            if climb.excess(part, &jet, &self.level) <= 0.0 {
                return true;
            }
            if !climb.step(&jet) {
                break;
            }
        }
        false
    }
}

impl<P: Patch> Visitor<P> for Look<'_, '_, P> {
    fn promise(&self, bounds: &Bounds) -> f64 {
        self.contacts.lift_of_box(bounds, &self.track)
    }

    fn is_settled(&self, promise: f64) -> bool {
        let least = self.level.level - self.level.slope.abs() * self.track.reach;
        !self.is_below || promise <= least
    }

    fn visit(&mut self, part: &Part<P>, _promise: f64) {
        let mut open = vec![];
        if !self.settles(part) {
            open.extend(part.halves());
        }
        while let Some(part) = open.pop() {
            if self.is_settled(self.promise(&part.bounds)) || self.settles(&part) {
                continue;
            }
            self.halvings = self.halvings.saturating_sub(1);
            if self.halvings == 0 || part.size() <= self.contacts.smallest {
                self.is_below = false;
                return;
            }
            open.extend(part.halves());
        }
    }
}
