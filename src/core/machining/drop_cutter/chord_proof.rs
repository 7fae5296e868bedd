//! Compares the tips over a stretch with the chord between the tips at its two ends. On a stretch, the axis
//! moves straight from one position to another. The contacts at both positions are known.
//!
//! # Method
//! 1. *Not too low.* Draw a straight line in the parameters u and v from one contact to the other. Show for
//!    all surface points on this line together that they lift the tip nearly to the chord. If that fails, try
//!    the points of the two contacts alone, each for its half of the stretch.
//! 2. *Not too high.* Show for every part of the surface that it lifts the tip at most a given height above
//!    the chord, at every position of the stretch (`lift_bound`).
//!
//! # Guarantees
//! A successful proof holds for every position of the stretch, to within rounding. If step 2 needs too many
//! halvings of parts, the tips count as too high.

use nalgebra::{Matrix2, Point3, Vector2};

use super::lift_bound::{AxisMove, Threshold};
use super::newton::{Climb, TOUCHING};
use super::round::RoundBodies;
use super::support::Support;
use super::tree::{Cover, PartVisitor, SubPatch};
use super::{Contact, Contacts, patches_at};
use crate::geometry::surface::patch::Patch;
use crate::geometry::surface::{Jet, Surface, span_of};
use crate::machining::cutter::LowerPoint;

/// Halvings of parts that are allowed for a stretch as long as [`Contacts::scale`]. The number is inversely
/// proportional to the length of the stretch, and stays within `HALVING_LIMITS`. A stretch that needs more
/// counts as too long. Short stretches get more because they decide where the contact changes place.
const HALVINGS: f64 = 0.5;
const HALVING_LIMITS: [f64; 2] = [4.0, 2048.0];

/// Newton steps on one part.
const STEPS: usize = 2;

/// Largest number of joints of patches, in u and in v, on the line of parameters between two contacts. A line
/// with more joints proves nothing.
const JOINT_LIMIT: usize = 6;

/// A bound of a second derivative is loose if it exceeds `LOOSE` times the value in the middle of the patch
/// by more than `LOOSE_SHARE` of the size of the patch.
const LOOSE: f64 = 1.5;
const LOOSE_SHARE: f64 = 0.01;

/// How far points are moved towards the axis, as a multiple of how far they may leave their chord.
const INWARD_SHARE: f64 = 1.01;

/// A place on the curved surface must be nearer to the axis by at least this share of that move.
const ENOUGH_INWARD: f64 = 0.995;

/// Where the tips of a stretch lie relative to their chord.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum ChordVerdict {
    /// Proved to be near the chord, on both sides.
    Within,
    /// Perhaps too far below the chord.
    Lower,
    /// Proved not to be too far below the chord, perhaps too far above it.
    Higher,
}

impl<P: Patch> Contacts<'_, P> {
    /// Compares the tips between two contacts with the chord of the contacts' tips. The tips may lie up to
    /// `below` mm under the chord and up to `above` mm over it.
    pub(super) fn stretch(&self, from: &Contact, to: &Contact, [below, above]: [f64; 2]) -> ChordVerdict {
        let guess = [0, 1].map(|k| 0.5 * (from.place[k] + to.place[k]));
        if !self.is_above(from, to, below) {
            ChordVerdict::Lower
        } else if self.is_below([from.tip, to.tip], guess, above) {
            ChordVerdict::Within
        } else {
            ChordVerdict::Higher
        }
    }

    /// Whether it is proved that no part is near enough to lift the tip anywhere between two positions.
    pub(super) fn is_free(&self, [from, to]: [Vector2<f64>; 2]) -> bool {
        let mut near = Near { contacts: self, track: AxisMove::between(from, to), is_found: false };
        self.tree.visit(&mut near);
        !near.is_found
    }

    /// Whether it is proved that no part lifts the tip more than `height` mm over the chord. The contact is
    /// expected near the parameters `guess`.
    fn is_below(&self, [from, to]: [Point3<f64>; 2], guess: [f64; 2], height: f64) -> bool {
        let length = (to - from).xy().norm();
        let center = 0.5 * (from.coords + to.coords);
        let slope = if length > 0.0 { (to.z - from.z) / length } else { 0.0 };
        let mut look = Look {
            contacts: self,
            track: AxisMove::between(from.xy().coords, to.xy().coords),
            level: Threshold { level: center.z + height, slope },
            guess,
            support: None,
            round: None,
            halvings: (HALVINGS * self.scale / length).clamp(HALVING_LIMITS[0], HALVING_LIMITS[1]) as usize,
            is_below: true,
        };
        if let Some(middle) = self.near(look.track.center, guess) {
            if middle.tip.z > look.level.level {
                return false;
            }
            look.guess = middle.place;
            if let Some((lower, jet)) = look.touch_at(middle.place) {
                look.support = Some(Support::of(&self.cutter, &lower, &look.track));
                look.round = Some(RoundBodies::around(&self.cutter, &lower, &jet));
            }
        }
        self.tree.visit(&mut look);
        look.is_below
    }

    /// Whether it is proved that the surface lifts the tip everywhere to at most `height` mm below the chord.
    pub(super) fn is_above(&self, from: &Contact, to: &Contact, height: f64) -> bool {
        self.is_above_by_line(from, to, height) || self.is_above_by_ends(from, to, height)
    }

    /// Proves [`Self::is_above`] by the surface points on the line of parameters between the contacts. Where
    /// the cutter is too steep at these points, the line is moved towards the axis by as much as the points
    /// may leave their chord.
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

    /// Takes the surface points on the line of parameters between two `places`, and bounds how far below the
    /// chord of two tips they let the tip sink. At the ends of the line that distance is `ends`, mm. `None`
    /// where the line crosses too many joints.
    ///
    /// The curve of these points leaves its own chord by at most `bend`. Seen from the moving axis, the
    /// points of that chord lie on a straight line. The height of the cutter is convex along this line, so
    /// these points lift the tip, relative to the tips' chord, no less than the lower end does. Moving a
    /// point by `bend` changes the lift by at most `bend` times the steepness of the cutter at the largest
    /// distance from the axis.
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

    /// The height to which a place of the surface lifts the tip with the axis at `axis`, mm; minus infinity
    /// where the place is beside the cutter.
    fn lift(&self, [u, v]: [f64; 2], axis: Vector2<f64>) -> f64 {
        let point = self.surface.jet(u, v).point.coords;
        point.z - self.cutter.height((point.xy() - axis).norm())
    }

    /// A place about `by` mm nearer to the axis than the contact. It lies straight inward on a patch that
    /// meets at the contact, or along u or v from the contact, as along a crest. Among these places the one
    /// that lifts the tip most is returned; `None` if there is none.
    fn nearer_to_axis(&self, contact: &Contact, by: f64) -> Option<[f64; 2]> {
        let [u, v] = contact.place;
        let axis = contact.tip.xy().coords;
        let inward = (contact.tip - contact.point).xy().try_normalize(0.0)?;
        let from_axis = (contact.tip - contact.point).xy().norm();
        let mut best: Option<([f64; 2], f64)> = None;
        for [i, j] in patches_at(contact.place, self.surface.spans()) {
            let jet = self.surface.patch(i, j).jet(u - i as f64, v - j as f64);
            let across = Matrix2::from_columns(&[jet.du.xy(), jet.dv.xy()]);
            let straight =
                across.try_inverse().map_or([f64::NAN; 2], |inverse| (inverse * inward * by).into());
            let along = [jet.du, jet.dv].map(|d| by / inward.dot(&d.xy()));
            for step in [straight, [along[0], 0.0], [0.0, along[1]]] {
                let place = [u + step[0], v + step[1]];
                let is_on_patch = (0.0..=1.0).contains(&(place[0] - i as f64))
                    && (0.0..=1.0).contains(&(place[1] - j as f64));
                if !is_on_patch {
                    continue;
                }
                let distance = (self.surface.jet(place[0], place[1]).point.coords.xy() - axis).norm();
                let lift = self.lift(place, axis);
                if distance <= from_axis - ENOUGH_INWARD * by
                    && lift > best.map_or(f64::NEG_INFINITY, |(_, most)| most)
                {
                    best = Some((place, lift));
                }
            }
        }
        best.map(|(place, _)| place)
    }

    /// Proves [`Self::is_above`] by the contacts at both ends, each up to the middle.
    fn is_above_by_ends(&self, from: &Contact, to: &Contact, height: f64) -> bool {
        let middle = nalgebra::center(&from.tip, &to.tip);
        [from, to].iter().all(|contact| {
            let lift = contact.point.z - self.cutter.height((contact.point - middle).xy().norm());
            lift >= middle.z - height
        })
    }
}

/// How far surface points let the tip sink below a chord, at most, mm.
struct Dip {
    depth: f64,
    /// How far the points leave their own chord, at most, mm.
    bend: f64,
}

/// Bounds of the lengths of the second derivatives of a patch: by u twice, by u and v, by v twice. A patch
/// with a loose bound is halved, to a depth of at most `halvings`.
pub(super) fn bends<P: Patch>(patch: &P, halvings: u32) -> [f64; 3] {
    let derivatives = patch.derivatives();
    let bounds = [derivatives.duu, derivatives.duv, derivatives.dvv].map(|ball| ball.reach());
    let jet = patch.jet(0.5, 0.5);
    let [uu, uv, vv] = [jet.duu, jet.duv, jet.dvv].map(|second| second.norm());
    let [along_u, along_v] = patch.extents();
    let is_loose = |k: usize, inside: f64| bounds[k] > LOOSE * inside + LOOSE_SHARE * (along_u + along_v);
    let by_u = is_loose(0, uu) || is_loose(1, uv) && !is_loose(2, vv);
    if halvings == 0 || !(by_u || is_loose(1, uv) || is_loose(2, vv)) {
        return bounds;
    }
    let (halves, shares) =
        if by_u { (patch.split_u(), [4.0, 2.0, 1.0]) } else { (patch.split_v(), [1.0, 2.0, 4.0]) };
    let [first, second] = halves.map(|half| bends(&half, halvings - 1));
    [0, 1, 2].map(|k| bounds[k].min(shares[k] * first[k].max(second[k])))
}

/// Fractions of a line of parameters: its ends, and where it crosses joints of patches. `None` where it
/// crosses too many joints.
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

/// A search among all parts that may lift the tip over the chord.
struct Look<'a, 'b, P> {
    contacts: &'b Contacts<'a, P>,
    track: AxisMove,
    level: Threshold,
    guess: [f64; 2],
    support: Option<Support>,
    round: Option<RoundBodies>,
    /// Halvings that are left.
    halvings: usize,
    is_below: bool,
}

impl<P: Patch> Look<'_, '_, P> {
    /// The point of the cutter that touches at a place, and the surface's jet there.
    fn touch_at(&self, [u, v]: [f64; 2]) -> Option<(LowerPoint, Jet)> {
        let [nu, nv] = self.contacts.surface.spans();
        let [i, j] = [span_of(u, nu), span_of(v, nv)];
        let patch = self.contacts.surface.patch(i, j);
        let mut climb = Climb::new(&self.contacts.cutter, &self.track, [u - i as f64, v - j as f64]);
        let jet = climb.look(patch);
        Some((climb.lower()?, jet))
    }

    fn settles(&mut self, part: &SubPatch<P>) -> bool {
        if let Some(support) = &self.support
            && support.excess(part, &self.track, &self.level) <= 0.0
        {
            return true;
        }
        if self.is_settled(self.contacts.lift_of_part(part, &self.track)) {
            return true;
        }
        let bends = part.bends();
        let mut climb = Climb::new(&self.contacts.cutter, &self.track, part.nearest(self.guess));
        for _ in 0..STEPS {
            let jet = climb.look(&part.patch);
            if climb.excess(part, &bends, &jet, &self.level) <= 0.0 {
                return true;
            }
            if !climb.step(&part.patch, &jet) {
                break;
            }
        }
        self.round.is_some_and(|round| round.keep_below(part, &self.track, &self.level))
    }
}

impl<P: Patch> PartVisitor<P> for Look<'_, '_, P> {
    fn promise(&self, cover: &Cover) -> f64 {
        match &self.support {
            Some(support) if support.excess_under(cover, &self.track, &self.level) <= 0.0 => {
                f64::NEG_INFINITY
            }
            _ => self.contacts.lift_of_box(&cover.bounds, &self.track),
        }
    }

    fn is_settled(&self, promise: f64) -> bool {
        let least = self.level.level - self.level.slope.abs() * self.track.reach;
        !self.is_below || promise <= least
    }

    fn visit(&mut self, part: &SubPatch<P>, _promise: f64) {
        let mut open = vec![];
        if !self.settles(part) {
            open.extend(part.halves());
        }
        while let Some(part) = open.pop() {
            if self.is_settled(self.contacts.lift_of_box(&part.bounds, &self.track)) || self.settles(&part) {
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

/// A search for any part near a track.
struct Near<'a, 'b, P> {
    contacts: &'b Contacts<'a, P>,
    track: AxisMove,
    is_found: bool,
}

impl<P: Patch> PartVisitor<P> for Near<'_, '_, P> {
    fn promise(&self, cover: &Cover) -> f64 {
        self.contacts.lift_of_box(&cover.bounds, &self.track)
    }

    fn is_settled(&self, promise: f64) -> bool {
        self.is_found || promise == f64::NEG_INFINITY
    }

    fn visit(&mut self, part: &SubPatch<P>, _promise: f64) {
        self.is_found = self.contacts.lift_of_part(part, &self.track) > f64::NEG_INFINITY;
    }
}
