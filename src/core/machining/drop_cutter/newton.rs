//! Finds the place of a part that lifts the tip most, by Newton's method. The search starts at a place of the
//! part.
//!
//! # Method
//! Each step to the next place is computed in one of two ways:
//! 1. *By the tangent plane.* Find the point of the cutter's lower side that has the gradient of the surface
//!    at the place. The step leads to where the tangent plane of the surface lies under that point. This way
//!    works on the steepest walls, and for sharp rims.
//! 2. *By the lift.* The step leads to where the gradient of the lift vanishes. If it would leave the part,
//!    it ends on a side or in a corner of the part. This way does not work for a sharp rim, because a sharp
//!    rim has no gradient.
//!
//! The first way is used as long as its steps stay inside the part. At the sides of the part, the second way
//! is used.

use nalgebra::{Matrix2, Vector2, Vector3};

use super::lift_bound::{AxisMove, Threshold, Touch};
use super::tree::{Bends, SubPatch};
use crate::geometry::solve::falling_root;
use crate::geometry::surface::Jet;
use crate::geometry::surface::patch::Patch;
use crate::machining::cutter::{Cutter, LowerPoint};

/// Newton steps on a part before the part is halved.
pub(super) const STEPS: usize = 7;

/// Slope below which a surface counts as level.
const LEVEL_SLOPE: f64 = 1e-12;

/// Largest distance, in radii of the cutter, at which a tangent point touches its surface point.
pub(super) const TOUCHING: f64 = 1e-10;

/// Slope below which a rise towards a side is only rounding, and the side does not hold the search back.
const HELD_SLOPE: f64 = 1e-12;

/// A lift counts as level along a line if it bends there by less than this share of its bend across the line.
/// The step then goes across the line.
const LEVEL_SHARE: f64 = 1e-9;

/// Distance outside the part, in the part's parameters, up to which a place counts as on the side.
const ON_SIDE: f64 = 1e-12;

/// Length of a step, in the part's parameters, up to which the search ends.
const NO_STEP: f64 = 1e-15;

/// A place that lifts the cutter, in parameters of the part.
pub(super) struct Found {
    pub(super) height: f64,
    pub(super) jet: Jet,
    pub(super) place: [f64; 2],
    pub(super) lower: LowerPoint,
}

#[derive(Clone, Copy)]
pub(super) struct Climb<'a> {
    cutter: &'a Cutter,
    track: &'a AxisMove,
    place: [f64; 2],
    /// The cutter's point that has the gradient of the surface, where there is one.
    tangent: Option<LowerPoint>,
    /// The cutter's point over the surface point, where there is one.
    over: Option<LowerPoint>,
    /// Whether the place is under a sharp rim, on a side of the part, and the lift grows along the rim away
    /// from that side.
    leaves_side: bool,
}

impl<'a> Climb<'a> {
    pub(super) fn new(cutter: &'a Cutter, track: &'a AxisMove, place: [f64; 2]) -> Self {
        Self { cutter, track, place, tangent: None, over: None, leaves_side: false }
    }

    /// Evaluates the surface at the place, and finds the cutter's points there. Returns the surface's jet.
    pub(super) fn look(&mut self, patch: &impl Patch) -> Jet {
        let jet = patch.jet(self.place[0], self.place[1]);
        let gradient = jet.gradient();
        let is_upright = !(gradient.x.is_finite() && gradient.y.is_finite());
        let is_level = gradient.norm() <= LEVEL_SLOPE && self.cutter.flat_radius() > 0.0;
        let on_rim = self.on_rim(&jet);
        self.leaves_side = on_rim.as_ref().is_some_and(|lower| self.grows_inward(&jet, lower));
        self.tangent = on_rim
            .filter(|_| !self.leaves_side)
            .or_else(|| (!is_upright && !is_level).then(|| self.cutter.tangent_point(gradient)));
        self.over = self.cutter.lower_point(self.off(&jet));
        jet
    }

    /// The point of a sharp rim that a side of the part crosses at the place, rising outwards. Its gradient
    /// makes the plane through it contain the tangent of the side.
    fn on_rim(&self, jet: &Jet) -> Option<LowerPoint> {
        let off = self.off(jet);
        let radius = self.cutter.radius();
        if !self.is_sharp() || (off.norm() - radius).abs() > TOUCHING * radius {
            return None;
        }
        let along = self.side(jet)?;
        let outward = off.normalize();
        let slope = along.z / outward.dot(&along.xy());
        (slope > LEVEL_SLOPE && slope.is_finite()).then(|| self.cutter.tangent_point(outward * slope))
    }

    /// Whether the part rises, from the side that the place lies on, over the plane that touches both that
    /// side and the rim.
    fn grows_inward(&self, jet: &Jet, lower: &LowerPoint) -> bool {
        let across = |t: f64| t <= 0.0 || t >= 1.0;
        let (t, d) = if across(self.place[0]) { (self.place[0], &jet.du) } else { (self.place[1], &jet.dv) };
        let rise = d.z - lower.gradient.dot(&d.xy());
        rise.abs() > HELD_SLOPE * d.norm() && !is_blocked(t, rise)
    }

    /// The derivative along the side that the place lies on; `None` within the part, and in its corners.
    fn side(&self, jet: &Jet) -> Option<Vector3<f64>> {
        let [on_u, on_v] = self.place.map(|t| t <= 0.0 || t >= 1.0);
        if on_u == on_v { None } else { Some(if on_u { jet.dv } else { jet.du }) }
    }

    fn is_sharp(&self) -> bool {
        self.cutter.corner_radius() == 0.0
    }

    /// Where the cutter has a sharp rim and `next` lies beyond it: the last place under the rim on the
    /// straight way to `next`. Otherwise `next`.
    fn under_rim(&self, patch: &impl Patch, next: [f64; 2]) -> [f64; 2] {
        let place = |t: f64| [0, 1].map(|k| self.place[k] + t * (next[k] - self.place[k]));
        let beyond = |t: f64| {
            let [u, v] = place(t);
            self.off(&patch.jet(u, v)).norm() - self.cutter.radius()
        };
        if !self.is_sharp() || self.over.is_none() || beyond(1.0) <= 0.0 {
            return next;
        }
        place(falling_root([0.0, 1.0], |t| -beyond(t)))
    }

    pub(super) fn place(&self) -> [f64; 2] {
        self.place
    }

    /// A point of the cutter that may touch the surface at the place.
    pub(super) fn lower(&self) -> Option<LowerPoint> {
        self.tangent.or(self.over)
    }

    fn off(&self, jet: &Jet) -> Vector2<f64> {
        jet.point.coords.xy() - self.track.center
    }

    /// Whether the cutter touches the tangent plane at the place last evaluated. The distance along that
    /// plane must be within rounding, too.
    fn touches(&self, jet: &Jet) -> bool {
        let limit = TOUCHING * self.cutter.radius();
        self.tangent.is_some_and(|tangent| {
            let steepness = 1.0 + tangent.slope() * tangent.slope();
            (self.off(jet) - tangent.place).norm_squared() * steepness <= limit * limit
        })
    }

    /// The lift at the place last evaluated; `None` where the cutter is beside it.
    pub(super) fn found(&self, jet: &Jet) -> Option<Found> {
        let found = |height, lower| Some(Found { height, jet: *jet, place: self.place, lower });
        match (&self.tangent, &self.over) {
            (Some(tangent), _) if self.touches(jet) => {
                // At steep places this is more exact than the cutter's height over the surface point.
                let beside = tangent.gradient.dot(&(self.off(jet) - tangent.place));
                found(jet.point.z - tangent.height - beside, *tangent)
            }
            (_, Some(over)) => found(jet.point.z - over.height, *over),
            _ => None,
        }
    }

    /// Upper bound of how far the part lifts the tip above `level`, mm, computed from the place last
    /// evaluated.
    pub(super) fn excess<P: Patch>(
        &self,
        part: &SubPatch<P>,
        bends: &Bends,
        jet: &Jet,
        level: &Threshold,
    ) -> f64 {
        let mut excess = f64::INFINITY;
        for lower in [self.tangent, self.over].into_iter().flatten() {
            let touch = Touch { part, bends, place: self.place, jet, lower };
            excess = excess.min(touch.excess(self.cutter, self.track, level));
            if excess <= 0.0 {
                break;
            }
        }
        excess
    }

    /// Moves to a better place of the unit square. Returns whether there is one.
    pub(super) fn step(&mut self, patch: &impl Patch, jet: &Jet) -> bool {
        if self.touches(jet) {
            return false;
        }
        // Where a side holds the search back, the surface's tangent plane does not determine the contact.
        let is_held = !self.leaves_side && self.over.as_ref().is_some_and(|over| self.is_held(jet, over));
        let by_tangent =
            (!is_held).then(|| self.by_tangent(jet)).flatten().filter(|next| self.is_inside(next));
        let next = by_tangent.or_else(|| self.by_lift(jet)).or_else(|| self.by_tangent(jet));
        let Some(next) = next.or_else(|| self.uphill(jet)) else { return false };
        let mut next = next.map(|t| t.clamp(0.0, 1.0));
        if (0..2).any(|k| next[k] == self.place[k]) {
            next = self.under_rim(patch, next);
        }
        let is_same = (0..2).all(|k| (next[k] - self.place[k]).abs() <= NO_STEP);
        self.place = next;
        !is_same
    }

    /// Whether the lift would go on growing beyond a side that the place is on.
    fn is_held(&self, jet: &Jet, over: &LowerPoint) -> bool {
        [jet.du, jet.dv].iter().zip(self.place).any(|(d, t)| {
            let rise = d.z - over.gradient.dot(&d.xy());
            is_blocked(t, rise) && rise.abs() > HELD_SLOPE * d.norm()
        })
    }

    fn is_inside(&self, place: &[f64; 2]) -> bool {
        place.iter().all(|t| (-ON_SIDE..=1.0 + ON_SIDE).contains(t))
    }

    /// The place after Newton's step that brings the tangent point over the surface point.
    fn by_tangent(&self, jet: &Jet) -> Option<[f64; 2]> {
        let tangent = self.tangent.as_ref()?;
        let off = self.off(jet) - tangent.place;
        let second = |d: &nalgebra::Vector3<f64>| d.z - tangent.gradient.dot(&d.xy());
        let (uu, uv, vv) = (second(&jet.duu), second(&jet.duv), second(&jet.dvv));
        let across = Matrix2::from_columns(&[jet.du.xy(), jet.dv.xy()]);
        let gradients = across.transpose().try_inverse()? * Matrix2::new(uu, uv, uv, vv);
        let moves = across - self.cutter.compliance(tangent) * gradients;
        let step = moves.try_inverse()? * off;
        let next = [self.place[0] - step.x, self.place[1] - step.y];
        next.iter().all(|t| t.is_finite()).then_some(next)
    }

    /// The place after Newton's step towards the largest lift. Where a side blocks the step, it goes along
    /// that side.
    fn by_lift(&self, jet: &Jet) -> Option<[f64; 2]> {
        let over = self.over.as_ref()?;
        let form = self.cutter.curvature(over);
        let rise = |d: &nalgebra::Vector3<f64>| d.z - over.gradient.dot(&d.xy());
        let (gu, gv) = (rise(&jet.du), rise(&jet.dv));
        let (fu, fv) = (form.times(&jet.du.xy()), form.times(&jet.dv.xy()));
        let uu = fu.dot(&jet.du.xy()) - rise(&jet.duu);
        let uv = fu.dot(&jet.dv.xy()) - rise(&jet.duv);
        let vv = fv.dot(&jet.dv.xy()) - rise(&jet.dvv);
        let det = uu * vv - uv * uv;
        let [u, v] = self.place;
        let alone = |g: f64, n: f64| if n > 0.0 { g / n } else { g.signum() };
        let step = if is_blocked(u, gu) {
            [0.0, if is_blocked(v, gv) { 0.0 } else { alone(gv, vv) }]
        } else if is_blocked(v, gv) {
            [alone(gu, uu), 0.0]
        } else if uu > 0.0 && det > LEVEL_SHARE * uu * vv {
            let free = [(vv * gu - uv * gv) / det, (uu * gv - uv * gu) / det];
            self.within(free, [gu, gv], [uu, uv, vv])
        } else if uu > 0.0 && uu >= vv {
            [gu / uu, 0.0]
        } else if vv > 0.0 {
            [0.0, gv / vv]
        } else {
            return None;
        };
        let next = [u + step[0], v + step[1]];
        next.iter().all(|t| t.is_finite()).then_some(next)
    }

    /// A place in the direction in which the lift rises, beyond the square. A lift that does not bend down is
    /// largest at a side.
    fn uphill(&self, jet: &Jet) -> Option<[f64; 2]> {
        let over = self.over.as_ref()?;
        let rises = [jet.du, jet.dv].map(|d| d.z - over.gradient.dot(&d.xy()));
        let next = [0, 1].map(|k| self.place[k] + if rises[k] == 0.0 { 0.0 } else { rises[k].signum() });
        next.iter().all(|t| t.is_finite()).then_some(next)
    }

    /// The step `free` if it stays in the square, else the best step to the side that it would cross.
    fn within(&self, free: [f64; 2], g: [f64; 2], [uu, uv, vv]: [f64; 3]) -> [f64; 2] {
        let [u, v] = self.place;
        let room = |t: f64, step: f64| if step > 0.0 { 1.0 - t } else { -t };
        if free[0].abs() > room(u, free[0]).abs() {
            let du = room(u, free[0]);
            [du, (g[1] - uv * du) / vv]
        } else if free[1].abs() > room(v, free[1]).abs() {
            let dv = room(v, free[1]);
            [(g[0] - uv * dv) / uu, dv]
        } else {
            free
        }
    }
}

/// Whether `t` is at the end of 0..=1 beyond which a function with the derivative `rise` at `t` would grow.
fn is_blocked(t: f64, rise: f64) -> bool {
    (t <= 0.0 && rise < 0.0) || (t >= 1.0 && rise > 0.0)
}
