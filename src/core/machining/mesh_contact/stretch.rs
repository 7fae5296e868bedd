//! Proves how far the tips of a stretch are from its chord. On a stretch, the axis moves straight from one
//! position to another. The contacts at both positions are known.
//!
//! Along the stretch, the lift of a triangle is a concave function of the place, where the triangle is below
//! the cutter at all.
//! * *Not too low.* A triangle that the cutter touches at one end lifts the tip at least to the chord between
//!   its own lifts at both ends. The triangles of both ends together leave at most d e / (d + e) below the
//!   chord, where d and e are what each lacks at the other end.
//! * *Not too high.* The lift of a triangle is nowhere above its tangents at the ends. Where they meet too
//!   far above the chord, the stretch is halved for this triangle.

use nalgebra::{Vector2, Vector3};

use super::lift::{REACH, Support, height, lift};
use super::{MeshContact, MeshContacts, box_of};
use crate::geometry::bounding_tree::Visitor;
use crate::geometry::surface::patch::Bounds;

/// Most halvings of a stretch for one triangle.
const HALVINGS: usize = 12;

/// A stretch is not cut nearer to its ends than this share of its length.
const LEAST_SHARE: f64 = 0.02;

/// What the proof for a stretch shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Verdict {
    /// All tips are near the chord.
    Within,
    /// They may not be. The share of the stretch at which it is best cut in two.
    CutAt(f64),
}

impl MeshContacts<'_> {
    /// Compares the tips between two contacts with the chord of their tips: they may lie up to `below` mm
    /// under it and up to `above` mm over it.
    pub(super) fn stretch(&self, from: &MeshContact, to: &MeshContact, [below, above]: [f64; 2]) -> Verdict {
        if let Some(share) = self.too_low(from, to, below) {
            return Verdict::CutAt(share.clamp(LEAST_SHARE, 1.0 - LEAST_SHARE));
        }
        let [start, end] = [from, to].map(|contact| contact.tip.coords);
        let mut search = Above { contacts: self, start, way: end - start, above, found: None };
        self.mesh.search(&mut search);
        match search.found {
            None => Verdict::Within,
            Some(share) => Verdict::CutAt(share.clamp(LEAST_SHARE, 1.0 - LEAST_SHARE)),
        }
    }

    /// Whether no triangle lifts the tip anywhere between two positions of the axis.
    pub(super) fn is_free(&self, [from, to]: [Vector2<f64>; 2]) -> bool {
        let start = Vector3::new(from.x, from.y, f64::NEG_INFINITY);
        let way = Vector3::new(to.x - from.x, to.y - from.y, 0.0);
        let mut search = Near { contacts: self, start, way, is_found: false };
        self.mesh.search(&mut search);
        !search.is_found
    }

    /// The share of the stretch at which the tips may be more than `below` mm under the chord.
    fn too_low(&self, from: &MeshContact, to: &MeshContact, below: f64) -> Option<f64> {
        if from.triangle == to.triangle {
            return None;
        }
        // What the triangle of one end lacks at the other.
        let lacks = |own: &MeshContact, other: &MeshContact| {
            let corners = self.mesh.corners(own.triangle as usize);
            let lifted = lift(&self.cutter, &corners, &other.tip.xy().coords);
            lifted.map_or(f64::INFINITY, |lift| (other.tip.z - lift.tip_z).max(0.0))
        };
        let (first, last) = (lacks(from, to), lacks(to, from));
        if first.min(last) <= below {
            return None;
        }
        if !(first.is_finite() && last.is_finite()) {
            return Some(0.5);
        }
        (first * last / (first + last) > below).then_some(last / (first + last))
    }
}

/// A lift over a stretch.
#[derive(Clone, Copy)]
struct Over {
    /// The share of the stretch.
    at: f64,
    /// The height over the chord, mm; `None` where the triangle is beside the cutter.
    height: Option<f64>,
    /// Its change over the whole stretch, mm; `None` where it is not known.
    rise: Option<f64>,
}

/// A search for triangles that may lift the tip far above the chord.
struct Above<'a> {
    contacts: &'a MeshContacts<'a>,
    start: Vector3<f64>,
    way: Vector3<f64>,
    above: f64,
    /// The share of the stretch where one does.
    found: Option<f64>,
}

impl Above<'_> {
    fn over(&self, corners: &[Vector3<f64>; 3], at: f64) -> Over {
        let place = self.start + self.way * at;
        match lift(&self.contacts.cutter, corners, &place.xy()) {
            None => Over { at, height: None, rise: None },
            Some(lift) => {
                let rise = lift.rise(&place.xy(), &self.way.xy()) - self.way.z;
                let rise = rise.is_finite().then_some(rise);
                Over { at, height: Some(lift.tip_z - place.z), rise }
            }
        }
    }

    /// Where between two places a triangle may lift the tip too far above the chord; `None` if it is proved
    /// that it does not.
    fn too_high(&self, corners: &[Vector3<f64>; 3], ends: [Over; 2], halvings: usize) -> Option<f64> {
        let [from, to] = ends;
        if let Some(end) = ends.iter().find(|end| end.height.is_some_and(|height| height > self.above)) {
            return Some(end.at);
        }
        let (at, height) = self.top(corners, ends);
        if height <= self.above {
            return None;
        }
        let share = LEAST_SHARE * (to.at - from.at);
        let at = at.clamp(from.at + share, to.at - share);
        if halvings == 0 {
            return Some(at);
        }
        let between = self.over(corners, at);
        let halves = [[from, between], [between, to]];
        halves.into_iter().find_map(|half| self.too_high(corners, half, halvings - 1))
    }

    /// A bound of the lift over the chord between two places, mm, after the share of the stretch where it may
    /// be.
    fn top(&self, corners: &[Vector3<f64>; 3], [from, to]: [Over; 2]) -> (f64, f64) {
        let tangent = |end: &Over| Some((end.at, end.height?, end.rise?));
        let value = |(at, height, rise): (f64, f64, f64), to: f64| height + rise * (to - at);
        match [tangent(&from), tangent(&to)] {
            [None, None] => self.without_tangents(corners, [from.at, to.at]),
            [Some(one), None] | [None, Some(one)] => {
                let [low, high] = [value(one, from.at), value(one, to.at)];
                let most = low.max(high);
                // Half way to the end without a tangent: from there on the triangle is below the cutter.
                (0.5 * (from.at + to.at), most)
            }
            [Some(first), Some(last)] => {
                let ((t, f, g), (u, h, k)) = (first, last);
                if g <= 0.0 {
                    (t, f)
                } else if k >= 0.0 {
                    (u, h)
                } else {
                    let at = ((h - f + g * t - k * u) / (g - k)).clamp(t, u);
                    (at, value(first, at).max(value(last, at)))
                }
            }
        }
    }

    /// As [`Self::top`], where no tangent is known: by the box of the triangle, if the triangle comes below
    /// the cutter at all.
    fn without_tangents(&self, corners: &[Vector3<f64>; 3], [from, to]: [f64; 2]) -> (f64, f64) {
        let ends = [from, to].map(|at| (self.start + self.way * at).xy());
        let (share, distance) = closest(ends, corners.map(|corner| corner.xy()));
        let at = from + (to - from) * share;
        if distance > REACH * self.contacts.cutter.radius() {
            return (at, f64::NEG_INFINITY);
        }
        (at, self.of_box(&box_of(corners), [from, to]))
    }

    /// How far a triangle lifts the tip over the chord at most, mm, by a plane below the cutter in the middle
    /// of the stretch.
    fn by_plane(&self, corners: &[Vector3<f64>; 3]) -> f64 {
        let middle = self.start + self.way * 0.5;
        let from_axis = corners.map(|corner| {
            let off = corner.xy() - middle.xy();
            Vector3::new(off.x, off.y, corner.z - middle.z)
        });
        let center = from_axis.iter().sum::<Vector3<f64>>() / 3.0;
        let support = Support::near(&self.contacts.cutter, &center.xy());
        // Plane and chord are straight along the stretch: their difference is largest at one of its ends.
        support.lift(&from_axis) + 0.5 * (support.rise(&self.way.xy()) - self.way.z).abs()
    }

    /// How far anything in a box lifts the tip over the chord at most, between two shares of the stretch, mm.
    fn of_box(&self, bounds: &Bounds, [from, to]: [f64; 2]) -> f64 {
        let cutter = &self.contacts.cutter;
        let Some(([from, to], distance)) = near(cutter.radius(), bounds, self.start, self.way, [from, to])
        else {
            return f64::NEG_INFINITY;
        };
        let chord = (self.start.z + self.way.z * from).min(self.start.z + self.way.z * to);
        bounds.max.z - height(cutter, distance) - chord
    }
}

/// The place on the way between `ends` that is nearest to a triangle in plan, as a share of the way, and the
/// distance there, mm.
fn closest(ends: [Vector2<f64>; 2], corners: [Vector2<f64>; 3]) -> (f64, f64) {
    let way = ends[1] - ends[0];
    let foot = |p: &Vector2<f64>, start: &Vector2<f64>, way: &Vector2<f64>| {
        let share = (p - start).dot(way) / way.norm_squared();
        // A way without a length has no direction.
        if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 }
    };
    let mut best = (0.5, f64::INFINITY);
    let mut look = |share: f64, distance: f64| {
        if distance < best.1 {
            best = (share, distance);
        }
    };
    for k in 0..3 {
        let (p, q) = (corners[k], corners[(k + 1) % 3]);
        let side = q - p;
        let share = foot(&p, &ends[0], &way);
        look(share, (ends[0] + way * share - p).norm());
        for (share, end) in [(0.0, ends[0]), (1.0, ends[1])] {
            look(share, (p + side * foot(&end, &p, &side) - end).norm());
        }
        let turn = way.perp(&side);
        let [along, on_side] = [(p - ends[0]).perp(&side) / turn, (p - ends[0]).perp(&way) / turn];
        if (0.0..=1.0).contains(&along) && (0.0..=1.0).contains(&on_side) {
            look(along, 0.0);
        }
    }
    best
}

/// The part of a stretch on which a box may be below a cutter of `radius` mm, and the least distance in plan
/// of the axis from the box; `None` if the box is beside the cutter everywhere.
fn near(
    radius: f64,
    bounds: &Bounds,
    start: Vector3<f64>,
    way: Vector3<f64>,
    [from, to]: [f64; 2],
) -> Option<([f64; 2], f64)> {
    let [mut from, mut to] = [from, to];
    for c in 0..2 {
        let [low, high] = [bounds.min[c] - radius - start[c], bounds.max[c] + radius - start[c]];
        if way[c] != 0.0 {
            let [first, last] = [low / way[c], high / way[c]];
            (from, to) = (from.max(first.min(last)), to.min(first.max(last)));
        } else if low > 0.0 || high < 0.0 {
            return None;
        }
    }
    if from > to {
        return None;
    }
    // The box of the part of the way, widened: its distance is no larger than that of the way.
    let ends = [from, to].map(|at| (start + way * at).xy());
    let (low, high) = (ends[0].inf(&ends[1]), ends[0].sup(&ends[1]));
    let off = |c: usize| (bounds.min[c] - high[c]).max(low[c] - bounds.max[c]).max(0.0);
    let distance = off(0).hypot(off(1));
    (distance <= REACH * radius).then_some(([from, to], distance))
}

impl Visitor<Bounds, [u32; 2]> for Above<'_> {
    fn promise(&self, bounds: &Bounds) -> f64 {
        self.of_box(bounds, [0.0, 1.0])
    }

    fn is_settled(&self, promise: f64) -> bool {
        self.found.is_some() || promise <= self.above
    }

    fn visit(&mut self, range: &[u32; 2], _promise: f64) {
        for k in range[0]..range[1] {
            let corners = self.contacts.mesh.corners(k as usize);
            if self.is_settled(self.by_plane(&corners)) {
                continue;
            }
            let ends = [0.0, 1.0].map(|at| self.over(&corners, at));
            self.found = self.too_high(&corners, ends, HALVINGS);
        }
    }
}

/// A search for any triangle below the cutter on a stretch.
struct Near<'a> {
    contacts: &'a MeshContacts<'a>,
    start: Vector3<f64>,
    way: Vector3<f64>,
    is_found: bool,
}

impl Visitor<Bounds, [u32; 2]> for Near<'_> {
    fn promise(&self, bounds: &Bounds) -> f64 {
        let radius = self.contacts.cutter.radius();
        if near(radius, bounds, self.start, self.way, [0.0, 1.0]).is_some() { 1.0 } else { -1.0 }
    }

    fn is_settled(&self, promise: f64) -> bool {
        self.is_found || promise < 0.0
    }

    fn visit(&mut self, range: &[u32; 2], _promise: f64) {
        let mut own = range[0] as usize..range[1] as usize;
        let is_near = |k: usize| self.promise(&box_of(&self.contacts.mesh.corners(k))) > 0.0;
        self.is_found = own.any(is_near);
    }
}
