//! Proves that a part of the surface is clear of the cutter, in a view from the side.
//!
//! # Method
//! 1. Look at cutter and part along a level direction. On one side of the axis, the outline of the cutter
//!    consists of its flat, its corner and its shank.
//! 2. Find the stretch of the outline that the part can meet, from the part's least distance to the axis and
//!    the part's largest height.
//! 3. Choose a circle that contains this stretch at both ends of a straight move of the cutter. Because
//!    circles are convex, the circle contains the stretch during the whole move.
//! 4. If all points of the part lie outside the circle in this view, the part is clear of the cutter.
//!    Otherwise try a circle with another centre.
//!
//! # Guarantees
//! The proof succeeds without a margin for a fillet that is swept along the direction of the view, because
//! the centre of the fillet is one of the centres tried.

use nalgebra::{Matrix2, Vector2, Vector3};

use super::tree::SubPatch;
use crate::geometry::surface::Jet;
use crate::geometry::surface::patch::Patch;
use crate::machining::cutter::{Cutter, LowerPoint};

/// Largest radius of a circle that is tried, in radii of the cutter. A larger circle bounds no better than a
/// plane.
const LARGEST: f64 = 50.0;

/// A cutter that touches a surface, seen from the side.
#[derive(Debug, Clone, Copy)]
pub(super) struct Side {
    flat: f64,
    corner: f64,
    /// Sine and cosine of the slope's angle at the contact.
    steepness: [f64; 2],
    /// The unit vector in plan from the axis to the contact.
    away: Vector2<f64>,
    /// The surface point of the contact.
    touched: Vector3<f64>,
    /// The radius of curvature of the surface at the contact, along its steepest direction, mm; `None` where
    /// the surface is not concave.
    hollow: Option<f64>,
    /// The largest radius of circles that are tried, mm.
    largest: f64,
}

impl Side {
    /// `lower` is the point of the cutter that touches the surface, `jet` the surface's jet there.
    pub(super) fn new(cutter: &Cutter, lower: &LowerPoint, jet: &Jet) -> Self {
        let slope = lower.slope();
        let cosine = 1f64.hypot(slope).recip();
        let sine = if slope.is_finite() { slope * cosine } else { 1.0 };
        Self {
            flat: cutter.flat_radius(),
            corner: cutter.corner_radius(),
            steepness: [sine, cosine],
            away: lower.away(),
            touched: jet.point.coords,
            hollow: hollow(jet, lower),
            largest: LARGEST * cutter.radius(),
        }
    }

    /// Whether it is proved, in the view along the level vector `along`, that no point of a part lifts the
    /// tip higher. Let Q be the place in this view at the part's least distance from the axis and at the
    /// part's largest height. The part can meet only the stretch of the outline from the point beneath Q to
    /// the point beside Q. The tip makes a straight move with its middle at `tip`; `half` is half the vector
    /// of the move.
    pub(super) fn keeps_below<P: Patch>(
        &self,
        part: &SubPatch<P>,
        [tip, half]: [Vector3<f64>; 2],
        along: Vector3<f64>,
    ) -> bool {
        let right = Vector3::new(along.y, -along.x, 0.0);
        let side = right.dot(&(part.middle() - tip)).signum() * right;
        let seen = |p: &Vector3<f64>| Vector2::new(side.dot(p), p.z);
        // The centre of the corner at both ends of the move.
        let corner = seen(&tip) + Vector2::new(self.flat, self.corner);
        let half = seen(&half);
        let ends = [corner - half, corner + half];
        let [low, high] = [ends[0].inf(&ends[1]), ends[0].sup(&ends[1])];
        let top = part.bounds.max.z.max(high.y);
        let mut held = [None; 3];
        if self.flat > 0.0 {
            let nearest = part.patch.control_points().map(|p| side.dot(&p)).fold(low.x, f64::min);
            let beneath = Vector2::new(nearest, low.y - self.corner);
            held = [
                Some(beneath),
                Some(Vector2::new(high.x + self.corner, top)),
                Some(Vector2::new(nearest, top)),
            ];
        } else if part.bounds.max.z > low.y {
            return false;
        }
        let is_clear = |center: Vector2<f64>| {
            let reach = |p: &Vector2<f64>| (p - center).norm();
            let radius = ends.iter().map(|end| reach(end) + self.corner).fold(0.0, f64::max);
            let radius = held.iter().flatten().map(reach).fold(radius, f64::max);
            let origin = side * center.x + Vector3::z() * center.y;
            radius < self.largest
                && part.is_beyond(&origin, &[side, Vector3::z()], &[1.0; 2], radius * radius)
        };
        // The upward normal of the surface at the contact, in this view.
        let [sine, cosine] = self.steepness;
        let up = Vector2::new(-sine, cosine);
        if let Some(hollow) = self.hollow
            && is_clear(seen(&self.touched) + up * hollow)
        {
            return true;
        }
        if is_clear(corner) {
            return true;
        }
        // The smallest circle that touches the corner at the contact and contains the other points.
        let from_corner =
            |p: &Vector2<f64>| (p - corner).norm_squared() / (2.0 * up.dot(&(p - corner))).max(0.0);
        let more = held.iter().flatten().map(from_corner).fold(0.0, f64::max);
        more.is_finite() && is_clear(corner + up * more)
    }

    /// As [`Self::keeps_below`], by a ball about the surface's centre of curvature. It contains the cutter up
    /// to the highest point of the part. Exact for bowls.
    pub(super) fn ball_keeps_below<P: Patch>(
        &self,
        part: &SubPatch<P>,
        [tip, half]: [Vector3<f64>; 2],
    ) -> bool {
        let Some(hollow) = self.hollow else { return false };
        let [sine, cosine] = self.steepness;
        let up = Vector3::new(-self.away.x * sine, -self.away.y * sine, cosine);
        let center = self.touched + up * hollow;
        let radius = [tip - half, tip + half].map(|tip| {
            let off = (tip - center).xy().norm() + self.flat;
            let below = |height: f64| center.z - height;
            let top = part.bounds.max.z.max(tip.z + self.corner);
            (off.hypot(below(tip.z + self.corner)) + self.corner).max((off + self.corner).hypot(below(top)))
        });
        let radius = radius[0].max(radius[1]);
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        radius < self.largest && part.is_beyond(&center, &axes, &[1.0; 3], radius * radius)
    }
}

/// The radius of curvature of a surface, mm, along the steepest way up at the place where the cutter touches.
/// `None` where the surface is not concave along it.
fn hollow(jet: &Jet, lower: &LowerPoint) -> Option<f64> {
    let across = Matrix2::from_columns(&[jet.du.xy(), jet.dv.xy()]);
    let [u, v]: [f64; 2] = (across.try_inverse()? * lower.away()).into();
    let way = jet.du * u + jet.dv * v;
    let bend = jet.duu * (u * u) + jet.duv * (2.0 * u * v) + jet.dvv * (v * v);
    let radius = way.norm_squared() / bend.dot(&jet.normal().try_normalize(0.0)?);
    (radius > 0.0 && radius.is_finite()).then_some(radius)
}
