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

use nalgebra::{Matrix2, Point3, Vector2, Vector3};

use super::lift_bound::{AxisMove, Threshold};
use super::newton::{Climb, TOUCHING};
use super::round::RoundBodies;
use super::support::Support;
use super::tree::{Cover, Held, PartVisitor, SubPatch};
use super::{Contact, Contacts, patches_at};
use crate::geometry::surface::patch::{DerivativeBounds, Patch};
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

/// A bound of second derivatives on a part is loose if its radius exceeds `LOOSE` times its middle by more
/// than `LOOSE_SHARE` of the height that is to be proved. The part is halved, at most `PART_HALVINGS` times,
/// while the line of parameters covers less than 1 / `FEWEST_PARTS` of it. Looser bounds make chords shorter,
/// tighter ones take more time for each chord.
const LOOSE: f64 = 0.15;
const LOOSE_SHARE: f64 = 0.4;
const PART_HALVINGS: u32 = 6;
const FEWEST_PARTS: f64 = 0.7;

/// How far points are moved towards the axis, as a multiple of how much farther from it they may be than the
/// ends of their chord.
const INWARD_SHARE: f64 = 1.02;

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
    /// these points may lie too far from the axis for a proof, the line is moved towards the axis.
    fn is_above_by_line(&self, from: &Contact, to: &Contact, height: f64) -> bool {
        let tips = [from.tip, to.tip];
        let Some(dip) = self.dip([from.place, to.place], tips, [0.0, 0.0], height) else { return false };
        if dip.depth <= height {
            return true;
        }
        let nearer = |contact: &Contact| {
            self.nearer_to_axis(contact, INWARD_SHARE * dip.outward + 4.0 * TOUCHING * self.cutter.radius())
        };
        let (Some(nearer_from), Some(nearer_to)) = (nearer(from), nearer(to)) else { return false };
        let ends = [(nearer_from, from.tip), (nearer_to, to.tip)]
            .map(|(place, tip)| tip.z - self.lift(place, tip.xy().coords));
        self.dip([nearer_from, nearer_to], tips, ends, height).is_some_and(|dip| dip.depth <= height)
    }

    /// Takes the surface points on the line of parameters between two `places`, and bounds how far below the
    /// chord of two tips they let the tip sink. At the ends of the line that distance is `ends`, mm. `None`
    /// where the line crosses too many joints.
    ///
    /// Seen from the moving axis, the points of the curve's own chord lie on a straight line. The height h of
    /// the cutter is convex along this line, so these points lift the tip, relative to the tips' chord, no
    /// less than the lower end does. The curve itself lies beside its chord by e, which is at most an eighth
    /// of its second derivative S'' in every direction. Because h is convex, the lift is less by no more than
    /// the component of e along (-grad h, 1), with the gradient where the curve is.
    fn dip(&self, places: [[f64; 2]; 2], tips: [Point3<f64>; 2], ends: [f64; 2], height: f64) -> Option<Dip> {
        let step = [0, 1].map(|k| places[1][k] - places[0][k]);
        let place = |t: f64| [0, 1].map(|k| places[0][k] + t * step[k]);
        let tip = |t: f64| tips[0] + (tips[1] - tips[0]) * t;
        let end = |t: f64| {
            let [u, v] = place(t);
            let off = (self.surface.jet(u, v).point - tip(t)).xy();
            let dip = match t {
                0.0 => ends[0],
                1.0 => ends[1],
                _ => tip(t).z - self.lift(place(t), tip(t).xy().coords),
            };
            (off, dip.max(0.0))
        };
        let mut dip = Dip { depth: 0.0, outward: 0.0 };
        for pair in joints(places)?.windows(2) {
            let ends = [end(pair[0]), end(pair[1])];
            let offs = ends.map(|(off, _)| off);
            let (middle, half) = (0.5 * (offs[0] + offs[1]), 0.5 * (offs[1] - offs[0]).norm());
            let far = offs[0].norm().max(offs[1].norm());
            let outward = middle.try_normalize(0.0);
            let gradient = self.cutter.lower_point(middle).map_or(Vector2::zeros(), |lower| lower.gradient);
            let lift_way = Vector3::new(-gradient.x, -gradient.y, 1.0);
            let second = self.second_along(
                [place(pair[0]), place(pair[1])],
                outward
                    .map_or([lift_way; 2], |outward| [lift_way, Vector3::new(-outward.x, -outward.y, 0.0)]),
                LOOSE_SHARE * height,
            );
            let bend = second.length / 8.0;
            // How far the curve may lie farther from the axis than the ends of its chord.
            let beyond = outward.map_or(bend, |_| {
                let turned = (2.0 * half / middle.norm()).min(2.0);
                let outward = (second.most[1] / 8.0).max(0.0) + turned * bend;
                bend.min(outward + bend * bend / (2.0 * far))
            });
            let farthest = far + beyond;
            let depth = if farthest > self.cutter.radius() {
                f64::INFINITY
            } else {
                let turned = self.cutter.bend(farthest) * (half + bend);
                (second.most[0] / 8.0 + if bend > 0.0 { turned * bend } else { 0.0 }).max(0.0)
            };
            let depth = ends[0].1.max(ends[1].1) + depth;
            dip = Dip { depth: dip.depth.max(depth), outward: dip.outward.max(beyond) };
        }
        Some(dip)
    }

    /// Bounds the second derivative of the surface points on a straight line of parameters within one patch,
    /// by the fraction of the line: its length, and its components along two vectors, mm. A bound that
    /// exceeds the values by up to `loose` mm is good enough.
    fn second_along(&self, [from, to]: [[f64; 2]; 2], ways: [Vector3<f64>; 2], loose: f64) -> Second {
        let [nu, nv] = self.surface.spans();
        let patch = span_of(0.5 * (from[0] + to[0]), nu) * nv + span_of(0.5 * (from[1] + to[1]), nv);
        let range = [[0, 1].map(|k| from[k].min(to[k])), [0, 1].map(|k| from[k].max(to[k]))];
        let mut second = Second { length: 0.0, most: [f64::NEG_INFINITY; 2] };
        self.tree.over_range(patch, range, PART_HALVINGS, &mut |part, is_last| {
            let [du, dv] = [0, 1].map(|k| (to[k] - from[k]) / part.scale[k]);
            let DerivativeBounds { duu, duv, dvv, .. } = part.bends().derivatives;
            let ball = duu.scaled(du * du).plus(duv.scaled(2.0 * du * dv)).plus(dvv.scaled(dv * dv));
            let center = ball.center.norm();
            let is_tight =
                is_last || ball.radius <= LOOSE * center + loose || du.abs() + dv.abs() > FEWEST_PARTS;
            if is_tight {
                let along = |k: usize| ways[k].dot(&ball.center) + ways[k].norm() * ball.radius;
                second.length = second.length.max(center + ball.radius);
                second.most = [0, 1].map(|k| second.most[k].max(along(k)));
            }
            is_tight
        });
        second
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
    /// How much farther from the axis the points may be than the ends of their chord, mm.
    outward: f64,
}

/// Upper bounds of a second derivative: its length, and its components along two vectors.
struct Second {
    length: f64,
    most: [f64; 2],
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
            if climb.excess(part, bends, &jet, &self.level) <= 0.0 {
                return true;
            }
            if !climb.step(&part.patch, &jet) {
                break;
            }
        }
        self.round.is_some_and(|round| round.keep_below(part, &self.track, &self.level))
    }
}

impl<'b, P: Patch> PartVisitor<'b, P> for Look<'_, 'b, P> {
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

    fn visit(&mut self, part: Held<'b, P>, _promise: f64) {
        let tree = &self.contacts.tree;
        let mut open = vec![];
        if !self.settles(&part) {
            open.extend(tree.halves(&part));
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
            open.extend(tree.halves(&part));
        }
    }
}

/// A search for any part near a track.
struct Near<'a, 'b, P> {
    contacts: &'b Contacts<'a, P>,
    track: AxisMove,
    is_found: bool,
}

impl<'b, P: Patch> PartVisitor<'b, P> for Near<'_, 'b, P> {
    fn promise(&self, cover: &Cover) -> f64 {
        self.contacts.lift_of_box(&cover.bounds, &self.track)
    }

    fn is_settled(&self, promise: f64) -> bool {
        self.is_found || promise == f64::NEG_INFINITY
    }

    fn visit(&mut self, part: Held<'b, P>, _promise: f64) {
        self.is_found = self.contacts.lift_of_part(&part, &self.track) > f64::NEG_INFINITY;
    }
}
