//! Tells which points of a surface the cutter can reach. What stays at the other points is rest: no position
//! of the cutter removes it without cutting into the surface elsewhere, or leaving the outline.
//!
//! # Method
//! The cutter reaches a point with a normal only where it touches the tangent plane of the surface. So put
//! the axis where the lower side touches the plane at the point, and drop the cutter. Where the whole surface
//! lets it come down to the point, or to a tenth of what is left there, the point is reached. A flat of the
//! cutter touches a level place with any of its points. So for a cutter with a flat other axes are tried too.

use nalgebra::{Point3, Vector2, Vector3};

use super::outline::Outline;
use crate::budget::{Budget, Stopped};
use crate::geometry::surface::Patch;
use crate::machining::cutter::Cutter;
use crate::machining::drop_cutter::Contacts;
use crate::machining::uncut::{Reach, distance_from};

/// A point is reached if the cutter comes as near to it as this share of what is left there. A smaller share
/// counts more of what passes leave as rest, a larger one less.
const REACHED_SHARE: f64 = 0.1;

/// A point is reached if the cutter comes as near to it as this, mm: ten times the accuracy of a drop.
const REACHED_MM: f64 = 1e-5;

/// The accuracy of a tip, as a share of the distance at which a point counts as reached.
const TIP_ACCURACY: f64 = 0.05;

/// An axis beside the first one is tried if the cutter, resting on the tangent plane there, is at most this
/// many times as far from the point as counts as reached. Where the surface falls away from the plane the
/// cutter comes nearer.
const BESIDE: f64 = 4.0;

/// How far the axis may be beyond the margin of the outline, mm. Passes along it are as accurate.
const BESIDE_MARGIN_MM: f64 = 1e-3;

/// Directions in which the axis of a cutter with a flat is tried, and distances in radii of the flat.
const DIRECTIONS: usize = 8;
const DISTANCES: [f64; 2] = [0.98, 0.5];

/// The z coordinate of a unit normal below which a surface counts as a wall.
const UPRIGHT: f64 = 1e-9;

/// The positions that the cutter may take.
pub(super) struct Positions<'a, P> {
    pub(super) contacts: &'a Contacts<'a, P>,
    /// The outline, and the distance of the axis from it, mm; `None` where the axis may be anywhere.
    pub(super) inside: Option<(Outline, f64)>,
}

impl<P: Patch> Reach for Positions<'_, P> {
    fn is_reached(
        &self,
        point: &Point3<f64>,
        normal: &Vector3<f64>,
        left: f64,
        budget: &Budget,
    ) -> Result<bool, Stopped> {
        let enough = REACHED_MM.max(REACHED_SHARE * left);
        let cutter = self.contacts.cutter();
        for (k, axis) in axes(cutter, point, normal).into_iter().enumerate() {
            let is_promising = k == 0 || {
                let tip = resting(cutter, axis, point, normal);
                distance_from(cutter, &tip, point) <= BESIDE * enough
            };
            if is_promising
                && self.is_allowed(&axis)
                && let Some(contact) = self.contacts.drop_within(TIP_ACCURACY * enough, axis, None, budget)?
                && distance_from(cutter, &contact.tip, point) <= enough
            {
                return Ok(true);
            }
        }
        Ok(false)
    }
}

impl<P: Patch> Positions<'_, P> {
    fn is_allowed(&self, axis: &Vector2<f64>) -> bool {
        let Some((outline, margin)) = &self.inside else { return true };
        outline.depth(axis) >= margin - BESIDE_MARGIN_MM
    }
}

/// The tip of a cutter that rests on the plane through `point` with a normal that points up.
fn resting(cutter: &Cutter, axis: Vector2<f64>, point: &Point3<f64>, normal: &Vector3<f64>) -> Point3<f64> {
    let gradient = -normal.xy() / normal.z;
    let lower = cutter.tangent_point(gradient);
    let touched = axis + lower.place - point.coords.xy();
    Point3::new(axis.x, axis.y, point.z + gradient.dot(&touched) - lower.height)
}

/// The axes at which the cutter may touch the surface in `point`, the likeliest first.
fn axes(cutter: &Cutter, point: &Point3<f64>, normal: &Vector3<f64>) -> Vec<Vector2<f64>> {
    let place = point.coords.xy();
    if normal.z < UPRIGHT {
        let sideways = normal.xy().try_normalize(0.0).unwrap_or_default();
        return vec![place + sideways * cutter.radius()];
    }
    let lower = cutter.tangent_point(-normal.xy() / normal.z);
    let mut axes = vec![place - lower.place];
    let flat = cutter.flat_radius();
    if flat > 0.0 {
        axes.push(place);
        for share in DISTANCES {
            axes.extend((0..DIRECTIONS).map(|k| {
                let angle = k as f64 * std::f64::consts::TAU / DIRECTIONS as f64;
                place + Vector2::new(angle.cos(), angle.sin()) * (share * flat)
            }));
        }
    }
    axes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lower_side_touches_the_plane_at_the_first_axis() {
        let point = Point3::new(3.0, -2.0, 1.0);
        for cutter in [Cutter::ball(4.0), Cutter::bull_nose(4.0, 1.0), Cutter::bull_nose(4.0, 0.0)] {
            for normal in [Vector3::new(0.3, -0.4, 1.0), Vector3::new(1.0, 0.0, 0.0)].map(|n| n.normalize()) {
                let axis = axes(&cutter, &point, &normal)[0];
                let off = point.coords.xy() - axis;
                // The point lies against the normal from the axis.
                assert!(off.dot(&normal.xy()) < 0.0 && off.norm() <= cutter.radius() + 1e-12);
            }
        }
    }
}
