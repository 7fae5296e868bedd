//! Finds where a cutter that comes down from above touches a surface first.
//!
//! The axis of the cutter is at a given position in plan. Each surface point under the cutter would stop the
//! tip at some height, the *lift* of the point. The tip comes to rest at the largest lift of all points.
//!
//! # Method
//! 1. Divide the surface into small parts, in a hierarchy of boxes (`tree`).
//! 2. Search single parts for a large lift by Newton's method (`newton`).
//! 3. For each part, try to prove that no point of it has a larger lift than the largest one found
//!    (`support`, `round`, `side`, `lift_bound`).
//! 4. Halve each part for which the proof fails, and repeat steps 2 and 3 for its halves.
//!
//! # Guarantees
//! * The surface may have any shape: folds, sharp edges, overhangs and boundaries are allowed.
//! * The true tip is at [`Contact::tip`], or higher by at most [`Contact::gap_mm`] plus rounding. The gap is
//!   1e-9 mm, or the accuracy asked for. It is larger if 20,000 halvings are not enough.
//!
//! # Cost
//! O(log m) for m parts: 3 to 20 microseconds on a wave of 9 x 9 points. On the axis of a bowl, where the
//! cutter touches all around, one search takes tens of milliseconds.

mod axis_above_surface;
mod chord_proof;
mod crossing;
mod drop;
mod edge_contacts;
mod lift_bound;
mod newton;
mod round;
mod side;
mod support;
mod tip_section;
mod tree;

use nalgebra::{Point3, Vector2, Vector3};

use super::cutter::Cutter;
use crate::budget::{Budget, Stopped};
use crate::geometry::surface::patch::{Bounds, Patch};
use crate::geometry::surface::topology::Topology;
use crate::geometry::surface::{BezierSurface, Surface, span_of};
use drop::{Best, Drop};
use lift_bound::AxisMove;
pub use tip_section::TipSections;
use tree::{SubPatch, Tree};

/// Least size of a part, as a share of the largest coordinate plus the radius. Smaller parts are not halved:
/// rounding does not tell their points apart.
const SMALLEST_PART: f64 = 1e-13;

/// A point counts as beside the cutter if its distance from the axis exceeds 1 minus this, in radii. The
/// lower side may be so steep there that rounding hides its height.
const GRAZING: f64 = 1e-12;

/// The length scale of a surface, as a share of its diagonal in plan.
const SCALE_SHARE: f64 = 0.1;

/// Largest number of parts halved for one drop. At this limit the drop returns the bound it has, as a larger
/// gap.
const HALVING_LIMIT: usize = 20_000;

/// Largest distance from an edge, in parameters, at which a place counts as on the edge. The tip's height
/// does not change measurably within it.
const ON_EDGE: f64 = 1e-8;

/// Largest distance from an edge, mm, at which a place counts as on the edge. Near a side that is a point,
/// places this close together may be far apart in parameters.
const ON_EDGE_MM: f64 = 1e-8;

/// Largest angle between the normals of surface and cutter, radians, at which the cutter does not roll over
/// an edge.
const ROLLING: f64 = 1e-9;

/// A surface and a cutter, prepared for finding contacts.
///
/// With the axis at `a` in plan, the lift of a surface point P is P_z - h(|P - a|). Here h(d) is the height
/// of the cutter's lower side over the tip, at the distance d from the axis.
///
/// # Example
/// On a plane that rises 1 mm in 2 mm, the tip of a ball is higher than the plane below it.
///
/// ```
/// use nalgebra::{Point3, Vector2};
/// use toolpathd_core::budget::Budget;
/// use toolpathd_core::geometry::surface::point_grid::{Ends, PointGrid, Twist};
/// use toolpathd_core::machining::cutter::Cutter;
/// use toolpathd_core::machining::drop_cutter::Contacts;
///
/// let points = [0.0, 40.0].map(|x| [0.0, 40.0].map(|y| Point3::new(x, y, x / 2.0)).to_vec()).to_vec();
/// let plane = PointGrid { points, twist: Twist::Spline, ends: Ends::Usual }.surface().unwrap();
/// let budget = Budget::unlimited();
/// let contacts = Contacts::new(&plane, Cutter::ball(5.0), &budget).unwrap();
/// let contact = contacts.drop(Vector2::new(20.0, 20.0), None, &budget).unwrap().unwrap();
/// let height = 10.0 + 5.0 * (1.25_f64.sqrt() - 1.0);
/// assert!((contact.tip - Point3::new(20.0, 20.0, height)).norm() < 1e-9);
/// assert_eq!(contacts.drop(Vector2::new(-6.0, 20.0), None, &budget).unwrap(), None);
/// ```
pub struct Contacts<'a, P> {
    surface: &'a BezierSurface<P>,
    cutter: Cutter,
    tree: Tree<P>,
    /// Which sides of the surface are edges, seams or poles.
    topology: Topology,
    /// Parts of this size or smaller are not halved, mm.
    smallest: f64,
    /// The length scale, mm: the cutter's radius, or `SCALE_SHARE` of the surface's diagonal in plan if that
    /// is smaller.
    scale: f64,
}

/// A cutter that touches the surface from above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// The tip.
    pub tip: Point3<f64>,
    /// A surface point that the cutter touches.
    pub point: Point3<f64>,
    /// The parameters of that point.
    pub place: [f64; 2],
    /// The true tip is at most this much higher, mm.
    pub gap_mm: f64,
    /// The slope of the cutter's lower side where it touches.
    pub slope: f64,
    /// Whether the cutter touches an edge where the surface ends, and its normal there differs from the
    /// surface's normal.
    pub is_rolling: bool,
}

/// Slope below which a contact or a surface counts as level. Rounding of heights alone can make a contact
/// this steep.
const LEVEL_SLOPE: f64 = 1e-6;

/// Accuracy to which [`Contacts::drop`] proves the height of a tip, mm.
const ACCURACY_MM: f64 = 1e-9;

impl<'a, P: Patch> Contacts<'a, P> {
    /// # Errors
    /// Only the budget's stop.
    pub fn new(surface: &'a BezierSurface<P>, cutter: Cutter, budget: &Budget) -> Result<Self, Stopped> {
        let tree = Tree::new(surface, cutter.radius(), budget)?;
        let smallest = SMALLEST_PART * (tree.bounds().magnitude() + cutter.radius());
        let size = (tree.bounds().max - tree.bounds().min).xy().norm();
        let scale = cutter.radius().min(SCALE_SHARE * size);
        Ok(Self { surface, cutter, tree, topology: Topology::of(surface), smallest, scale })
    }

    /// A box of the surface, mm.
    pub fn bounds(&self) -> &Bounds {
        self.tree.bounds()
    }

    pub fn cutter(&self) -> &Cutter {
        &self.cutter
    }

    /// The contact of the cutter with its axis at `at`; `None` if the cutter misses the surface. `near` are
    /// parameters near those of the contact. They make the drop faster, and change only the last digits of
    /// the answer.
    ///
    /// # Errors
    /// Only the budget's stop.
    pub fn drop(
        &self,
        at: Vector2<f64>,
        near: Option<[f64; 2]>,
        budget: &Budget,
    ) -> Result<Option<Contact>, Stopped> {
        self.drop_within(ACCURACY_MM, at, near, budget)
    }

    /// As [`Self::drop`], with the tip proved to within `accuracy` mm. A larger value is faster where several
    /// contacts are nearly equally high.
    ///
    /// # Errors
    /// Only the budget's stop.
    pub fn drop_within(
        &self,
        accuracy: f64,
        at: Vector2<f64>,
        near: Option<[f64; 2]>,
        budget: &Budget,
    ) -> Result<Option<Contact>, Stopped> {
        let mut drop = Drop::new(self, at, near, accuracy);
        if let Some(place) = near {
            drop.try_at(place);
        }
        self.tree.visit(&mut drop);
        drop.close(HALVING_LIMIT, budget)?;
        // A true contact beside the edge may be higher than the contact found on the edge, by less than the
        // accuracy. Another climb from there finds it.
        match drop.contact() {
            Some(contact) if contact.is_rolling => drop.try_at(contact.place),
            _ => {}
        }
        Ok(drop.contact())
    }

    /// The contact that Newton's method finds from the parameters `place`; `None` where it finds none. Other
    /// places may lift the cutter more, so the gap is infinite.
    pub fn near(&self, at: Vector2<f64>, place: [f64; 2]) -> Option<Contact> {
        let mut drop = Drop::new(self, at, Some(place), ACCURACY_MM);
        drop.try_at(place);
        drop.contact().map(|contact| Contact { gap_mm: f64::INFINITY, ..contact })
    }

    /// About `count` places spread over the surface, as parameters.
    pub fn places(&self, count: usize) -> impl Iterator<Item = [f64; 2]> {
        let step = self.tree.parts.len().div_ceil(count);
        self.tree.parts.iter().step_by(step).map(|part| part.on_surface([0.5, 0.5]))
    }

    /// The tip while the cutter touches the tangent plane of a place, with the upward unit normal and the
    /// surface point. The rest of the surface may be in the cutter's way. `None` where the normal does not
    /// point up.
    pub fn touching(&self, [u, v]: [f64; 2]) -> Option<(Point3<f64>, Vector3<f64>, Point3<f64>)> {
        let jet = self.surface.jet(u, v);
        let normal = jet.normal().try_normalize(0.0)?;
        let gradient = jet.gradient();
        if !(normal.z > 0.0 && gradient.norm().is_finite()) {
            return None;
        }
        let lower = self.cutter.tangent_point(gradient);
        let axis = jet.point.coords.xy() - lower.place;
        Some((Point3::new(axis.x, axis.y, jet.point.z - lower.height), normal, jet.point))
    }

    /// Upper bound of the height to which anything in a box lifts the tip, for every position of a track, mm.
    /// Minus infinity if the box is beside the cutter.
    fn lift_of_box(&self, bounds: &Bounds, track: &AxisMove) -> f64 {
        let squared = track.squared_distance(bounds, &track.center);
        let most = (1.0 - GRAZING) * self.cutter.radius();
        if squared > most * most {
            f64::NEG_INFINITY
        } else {
            bounds.max.z - self.cutter.height(squared.sqrt())
        }
    }
}

impl<P: Patch> Contacts<'_, P> {
    /// Upper bound of the height to which a part lifts the tip, for every position of a track, mm. It uses
    /// the part's distance from the axis in two directions: towards the part's centre, and at right angles to
    /// a steep part. A part along the side of the cutter may be clear of the cutter although its box is not.
    /// Infinite where the box gives as good a bound.
    fn lift_of_part(&self, part: &SubPatch<P>, track: &AxisMove) -> f64 {
        let from = track.nearest(&part.center);
        let outward = part.center - from;
        let distance = outward.norm();
        let is_under = distance + part.half_diagonal < self.cutter.radius();
        if is_under && part.facing.is_none() {
            return f64::INFINITY;
        }
        let seen_along = |direction: Vector2<f64>| {
            let ahead = |p: Vector3<f64>| direction.dot(&(p.xy() - track.center));
            let nearest = part.patch.control_points().map(ahead).fold(f64::INFINITY, f64::min);
            let nearest = nearest - track.reach * direction.dot(&track.way).abs();
            if nearest > (1.0 - GRAZING) * self.cutter.radius() {
                f64::NEG_INFINITY
            } else {
                part.bounds.max.z - self.cutter.height(nearest)
            }
        };
        let along_line = if is_under { f64::INFINITY } else { seen_along(outward / distance) };
        match part.facing {
            Some(facing) if along_line > f64::NEG_INFINITY => {
                let sense = if facing.dot(&outward) < 0.0 { -1.0 } else { 1.0 };
                along_line.min(seen_along(facing * sense))
            }
            _ => along_line,
        }
    }

    /// The slope below which a contact counts as level. A point of the rounded corner with this slope lies
    /// above the flat of the cutter by only a few times the accuracy of a drop.
    fn level_slope(&self) -> f64 {
        let [flat, corner] = [self.cutter.flat_radius(), self.cutter.corner_radius()];
        if flat > 0.0 && corner > 0.0 {
            LEVEL_SLOPE.max(2.0 * (2.0 * ACCURACY_MM / corner).sqrt())
        } else {
            LEVEL_SLOPE
        }
    }

    /// Whether the surface is level at a place, on any of the patches that meet there.
    fn is_level_at(&self, [u, v]: [f64; 2]) -> bool {
        patches_at([u, v], self.surface.spans()).any(|[i, j]| {
            let jet = self.surface.patch(i, j).jet(u - i as f64, v - j as f64);
            jet.gradient().norm() <= LEVEL_SLOPE
        })
    }

    /// Whether the cutter touches an edge of the surface without touching the surface's tangent plane there.
    fn is_rolling(&self, best: &Best) -> bool {
        let [nu, nv] = self.surface.spans().map(|n| n as f64);
        let [u, v] = best.place;
        let is_on = |to_edge: f64, derivative: &Vector3<f64>| {
            to_edge <= ON_EDGE || to_edge * derivative.norm() <= ON_EDGE_MM
        };
        let (du, dv) = (&best.jet.du, &best.jet.dv);
        let on = [is_on(u, du), is_on(nu - u, du), is_on(v, dv), is_on(nv - v, dv)];
        if !on.iter().zip(self.topology.edges()).any(|(on, edge)| *on && edge) {
            return false;
        }
        let cutter = Vector3::new(-best.lower.gradient.x, -best.lower.gradient.y, 1.0).normalize();
        // The cutter may touch any of the patches that meet there: it rolls only if it is turned from all of
        // them.
        let is_turned = |[i, j]: [usize; 2]| {
            let jet = self.surface.patch(i, j).jet(u - i as f64, v - j as f64);
            let normal = jet.normal().try_normalize(0.0);
            normal.is_none_or(|normal| normal.cross(&cutter).norm() > ROLLING)
        };
        patches_at(best.place, self.surface.spans()).all(is_turned)
    }
}

/// The indices of the patches that meet at the parameters (u, v), of nu x nv patches.
fn patches_at([u, v]: [f64; 2], [nu, nv]: [usize; 2]) -> impl Iterator<Item = [usize; 2]> {
    let at = |t: f64, n: usize| {
        let span = span_of(t, n);
        [if span as f64 == t { span.saturating_sub(1) } else { span }, span]
    };
    at(u, nu).into_iter().flat_map(move |i| at(v, nv).map(|j| [i, j]))
}

#[cfg(test)]
mod tests;
