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

use std::sync::atomic::Ordering;

use nalgebra::{Matrix2, Point3, Vector2};

use super::bound::{Level, Track};
use super::climb::{Climb, TOUCHING};
use super::support::Support;
use super::tree::{Cover, Part, Visitor};
use super::{Contact, Contacts};
use crate::geometry::surface::patch::{Bounds, Patch};
use crate::geometry::surface::{Surface, span_of};

/// Halvings of parts for one stretch of a length that is large; a stretch that needs more is too long. Shorter ones may have as many
/// more as they are shorter: where contacts change place, it is they that decide.
const HALVINGS: f64 = 0.5;
const HALVING_LIMITS: [f64; 2] = [4.0, 2048.0];

/// Halvings of a straight way.
const LINK_HALVINGS: usize = 64;

/// Pieces of a straight way are not halved below this part of what is large.
const SHORTEST_PIECE: f64 = 2e-3;

/// Steps on one part.
const STEPS: usize = 2;

/// Joints of patches between the contacts of a stretch; more are too many.
const JOINT_LIMIT: usize = 6;

/// How much nearer to the axis points are taken than they may leave their chord.
const INWARD_SHARE: f64 = 1.01;

impl<P: Patch> Contacts<'_, P> {
    /// Whether the tips between two contacts lie nowhere more than `height` mm above or below the chord of theirs. A `false` may
    /// mean that this is not known.
    pub fn is_within(&self, from: &Contact, to: &Contact, height: f64) -> bool {
        let guess = [0, 1].map(|k| 0.5 * (from.place[k] + to.place[k]));
        self.is_above(from, to, height) && self.is_below([from.tip, to.tip], guess, height)
    }

    /// Whether no part lifts the tip, between two contacts, more than `height` mm over the higher of theirs.
    pub(super) fn is_wall(&self, from: &Contact, to: &Contact, height: f64) -> bool {
        let higher = if from.tip.z > to.tip.z { from } else { to };
        let level = |tip: Point3<f64>| Point3::new(tip.x, tip.y, higher.tip.z);
        self.is_below([level(from.tip), level(to.tip)], higher.place, height)
    }

    /// Whether the cutter may go straight from one place to another, with nothing that lifts its tip by more than `height` mm. A `false`
    /// may mean that this is not known.
    pub fn is_clear(&self, from: Point3<f64>, to: Point3<f64>, height: f64) -> bool {
        let near = self.tree.parts[0].on_surface([0.5, 0.5]);
        let mut open = vec![[from, to]];
        let mut halvings = 0;
        while let Some([from, to]) = open.pop() {
            let middle = nalgebra::center(&from, &to);
            if self.is_below([from, to], near, height) {
                continue;
            }
            halvings += 1;
            if halvings > LINK_HALVINGS || (to - from).norm() < SHORTEST_PIECE * self.scale {
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
            halvings: (HALVINGS * self.scale / length).clamp(HALVING_LIMITS[0], HALVING_LIMITS[1]) as usize,
            looks: 0,
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
        self.looks.fetch_add(look.looks, Ordering::Relaxed);
        look.is_below
    }

    /// Whether the surface is known to lift the tip to `height` below the chord everywhere.
    fn is_above(&self, from: &Contact, to: &Contact, height: f64) -> bool {
        self.is_above_by_line(from, to, height) || self.is_above_by_ends(from, to, height)
    }

    /// By points of the surface on the line of parameters between the contacts, or, where the cutter is too steep there to say much,
    /// on one as much nearer to its axis as the points may leave their chord.
    fn is_above_by_line(&self, from: &Contact, to: &Contact, height: f64) -> bool {
        let tips = [from.tip, to.tip];
        let Some(dip) = self.dip([from.place, to.place], tips, [0.0, 0.0]) else { return false };
        if dip.depth <= height {
            return true;
        }
        let nearer = |contact: &Contact| {
            self.nearer_to_axis(contact, INWARD_SHARE * dip.bend + 4.0 * TOUCHING * self.cutter.radius())
        };
        let (Some(nearer_from), Some(nearer_to)) = (nearer(from), nearer(to)) else { return false };
        let ends = [(nearer_from, from.tip), (nearer_to, to.tip)]
            .map(|(place, tip)| tip.z - self.lift(place, tip.xy().coords));
        self.dip([nearer_from, nearer_to], tips, ends).is_some_and(|dip| dip.depth <= height)
    }

    /// How far below the chord of two tips the points of the surface on the line of parameters between two `places` lift the tip, at
    /// most; at its ends they do so by `ends`, mm. `None` where the line crosses too many joints.
    ///
    /// A curve of points leaves its chord by `bend`. Points of the chord, seen from the axis, go straight on: there the height of the
    /// cutter is convex, and their lift is no less than between the ends. It changes with the point no more than the cutter
    /// is steep at the farthest place from the axis.
    fn dip(&self, places: [[f64; 2]; 2], tips: [Point3<f64>; 2], ends: [f64; 2]) -> Option<Dip> {
        let [nu, nv] = self.surface.spans();
        let step = [0, 1].map(|k| places[1][k] - places[0][k]);
        let place = |t: f64| [0, 1].map(|k| places[0][k] + t * step[k]);
        let tip = |t: f64| tips[0] + (tips[1] - tips[0]) * t;
        let end = |t: f64| {
            let [u, v] = place(t);
            let distance = (self.surface.jet(u, v).point - tip(t)).xy().norm();
            let dip = match t {
                0.0 => ends[0],
                1.0 => ends[1],
                _ => tip(t).z - self.lift(place(t), tip(t).xy().coords),
            };
            (distance, dip.max(0.0))
        };
        let mut dip = Dip { depth: 0.0, bend: 0.0 };
        for pair in joints(places)?.windows(2) {
            let [middle_u, middle_v] = place(0.5 * (pair[0] + pair[1]));
            let [uu, uv, vv] = self.bends[span_of(middle_u, nu) * nv + span_of(middle_v, nv)];
            let [du, dv] = step.map(|d| d.abs() * (pair[1] - pair[0]));
            let bend = (uu * du * du + 2.0 * uv * du * dv + vv * dv * dv) / 8.0;
            let ends = [end(pair[0]), end(pair[1])];
            let farthest = ends[0].0.max(ends[1].0) + bend;
            let steepness = 1f64.hypot(self.cutter.slope(farthest));
            let depth = ends[0].1.max(ends[1].1) + if bend > 0.0 { bend * steepness } else { 0.0 };
            dip = Dip { depth: dip.depth.max(depth), bend: dip.bend.max(bend) };
        }
        Some(dip)
    }

    /// The height to which a place of the surface lifts the tip with the axis at `axis`; minus infinity where it is beside the cutter.
    fn lift(&self, [u, v]: [f64; 2], axis: Vector2<f64>) -> f64 {
        let point = self.surface.jet(u, v).point.coords;
        point.z - self.cutter.height((point.xy() - axis).norm())
    }

    /// A place about `by` mm nearer to the axis than the contact.
    fn nearer_to_axis(&self, contact: &Contact, by: f64) -> Option<[f64; 2]> {
        let [u, v] = contact.place;
        let jet = self.surface.jet(u, v);
        let inward = (contact.tip - jet.point).xy().try_normalize(0.0)?;
        let across = Matrix2::from_columns(&[jet.du.xy(), jet.dv.xy()]);
        let step = across.try_inverse()? * (inward * by);
        let spans = self.surface.spans();
        let place = [0, 1].map(|k| (contact.place[k] + step[k]).clamp(0.0, spans[k] as f64));
        place.iter().all(|t| t.is_finite()).then_some(place)
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

/// How far points of the surface stay below a chord.
struct Dip {
    depth: f64,
    /// How far they leave their own chord, mm.
    bend: f64,
}

/// Where a line of parameters meets joints of patches, and its ends, in fractions of it; `None` where there are too many.
fn joints([from, to]: [[f64; 2]; 2]) -> Option<Vec<f64>> {
    let mut joints = vec![0.0, 1.0];
    for k in 0..2 {
        let [low, high] = [from[k].min(to[k]), from[k].max(to[k])];
        if (high.floor() - low.ceil()) as usize > JOINT_LIMIT {
            return None;
        }
        let mut joint = low.floor() + 1.0;
        while joint < high {
            joints.push((joint - from[k]) / (to[k] - from[k]));
            joint += 1.0;
        }
    }
    joints.sort_by(f64::total_cmp);
    Some(joints)
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
    /// Parts that were looked at.
    looks: usize,
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

    fn settles(&mut self, part: &Part<P>) -> bool {
        self.looks += 1;
        if let Some(support) = &self.support
            && support.excess(part, &self.track, &self.level) <= 0.0
        {
            return true;
        }
        if self.is_settled(self.contacts.lift_of_part(part, &self.track)) {
            return true;
        }
        let mut climb = Climb::new(&self.contacts.cutter, &self.track, part.nearest(self.guess));
        for _ in 0..STEPS {
            let jet = climb.look(&part.patch);
            if climb.excess(part, &jet, &self.level) <= 0.0 {
                return true;
            }
            if !climb.step(&part.patch, &jet) {
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

    fn is_beneath(&self, cover: &Cover) -> bool {
        self.support
            .as_ref()
            .is_some_and(|support| support.excess_under(cover, &self.track, &self.level) <= 0.0)
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
