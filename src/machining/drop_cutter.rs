//! Where a cutter that comes down from above touches a surface first.
//!
//! # Method
//! With the cutter's axis at a, a surface point P within its radius R lifts the tip to P_z - h(|P - a|), h
//! the height of the cutter's lower side over its tip ([`Cutter`]). The tip's height is the largest lift over
//! all of the surface: an upper envelope, so that folds of the offset, loops, sharp edges, overhangs and
//! boundaries need no care of their own.
//! 1. The surface is kept in small parts under a hierarchy of boxes, each with a plane over what is in it
//!    (`tree`).
//! 2. On a part the largest lift is found by Newton's method (`climb`): for the place whose tangent plane
//!    touches the cutter over the axis, which knows no steep slopes, or within the square for the lift
//!    itself, which knows edges and corners.
//! 3. That no other place lifts more is proved part by part: by boxes and planes, by the tangent plane of the
//!    contact known with the paraboloid that supports the cutter, by the side of the cutter for parts along
//!    it, by a concave quadratic bound (`bound`), or by round bodies about the cutter (`round`, `side`). What
//!    that does not decide is halved.
//!
//! # Guarantees
//! A tip is below the true height by no more than [`Contact::gap_mm`], at most some 1e-9 mm (or the accuracy
//! asked for) but where the limit of work is reached; rounding comes on top. The surface may be anything:
//! only control nets count.
//!
//! # Cost
//! O(log m) for m parts. On a wave of 9 x 9 points a ball or a flat end of 10 mm takes some 3 us a point
//! along lines, without a neighbour 10 and 20; where the cutter touches all around, as on the axis of a bowl,
//! tens of milliseconds.
//!
//! # Differences from the papers
//! Ju traces sections of the offset and Koo et al. unite shifted wires: neither sees what lies beside the
//! section or the wire.

mod axis_above_surface;
mod drop;
mod edge_contacts;
mod lift_bound;
mod newton;
mod round;
mod segment_proof;
mod side;
mod support;
mod tip_section;
mod tree;

use nalgebra::{Point3, Vector2, Vector3};

use super::cutter::Cutter;
use crate::budget::{Budget, Stopped};
use crate::geometry::surface::patch::{Bounds, Patch};
use crate::geometry::surface::{BezierSurface, Surface, span_of};
use drop::{Best, Drop};
use lift_bound::AxisMove;
pub use tip_section::TipSections;
use tree::{SubPatch, Tree};

/// Parts are not halved below this share of the coordinates: they are points to the arithmetic.
const SMALLEST_PART: f64 = 1e-13;

/// Whoever is nearer to the radius than by this part of it is beside the cutter: heights there are not known
/// to the arithmetic.
const GRAZING: f64 = 1e-12;

/// What is large against a surface, as a part of its diagonal in plan.
const SCALE_SHARE: f64 = 0.1;

/// Sides whose ends are this near to each other are no edges: they close, or are a point.
const CLOSED_MM: f64 = 1e-7;

/// Places along a side that are compared.
const SIDE_SAMPLES: usize = 8;

/// Parts that are halved for one question; beyond that the bound at hand is taken.
const HALVING_LIMIT: usize = 20_000;

/// Parameters this near to those of an edge are on it: a tip is as high there to the arithmetic.
const ON_EDGE: f64 = 1e-8;

/// And so are places this near to it, which may be far apart in parameters where a side is a point.
const ON_EDGE_MM: f64 = 1e-8;

/// Normals that differ by more than this: the cutter rolls over an edge; radians.
const ROLLING: f64 = 1e-9;

/// A surface and a cutter, made ready for the question where they touch.
pub struct Contacts<'a, P> {
    surface: &'a BezierSurface<P>,
    cutter: Cutter,
    tree: Tree<P>,
    /// Bounds of the second derivatives over each patch, mm: by u, by both, by v.
    bends: Vec<[f64; 3]>,
    /// Whether the sides u = 0, u = nu, v = 0, v = nv are edges of the surface.
    edges: [bool; 4],
    /// Parts of this size are not halved, mm.
    smallest: f64,
    /// What is large against the cutter or the surface, whichever is smaller, mm.
    scale: f64,
}

/// A cutter that touches the surface from above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// The tip.
    pub tip: Point3<f64>,
    /// A surface point that it touches.
    pub point: Point3<f64>,
    /// The parameters of that point.
    pub place: [f64; 2],
    /// The true tip is at most this much higher, mm.
    pub gap_mm: f64,
    /// The slope of the cutter where it touches.
    pub slope: f64,
    /// Whether the cutter hangs on an edge where the surface ends, and turned from its normal.
    pub is_rolling: bool,
}

/// A cutter or a surface whose slope is less counts as level: rounding of a height alone can make a contact
/// this steep.
const LEVEL_SLOPE: f64 = 1e-6;

/// A tip is proved to be this exact, mm.
const ACCURACY_MM: f64 = 1e-9;

/// Halvings of a patch for bounds of its second derivatives.
const BEND_HALVINGS: u32 = 6;

impl<'a, P: Patch> Contacts<'a, P> {
    /// # Errors
    /// Only the budget's stop.
    pub fn new(surface: &'a BezierSurface<P>, cutter: Cutter, budget: &Budget) -> Result<Self, Stopped> {
        let tree = Tree::new(surface, cutter.radius(), budget)?;
        let bends =
            surface.patches().iter().map(|patch| segment_proof::bends(patch, BEND_HALVINGS)).collect();
        let smallest = SMALLEST_PART * (tree.bounds().magnitude() + cutter.radius());
        let size = (tree.bounds().max - tree.bounds().min).xy().norm();
        let scale = cutter.radius().min(SCALE_SHARE * size);
        Ok(Self { surface, cutter, tree, bends, edges: edges(surface), smallest, scale })
    }

    /// A box of the surface, mm.
    pub fn bounds(&self) -> &Bounds {
        self.tree.bounds()
    }

    pub fn cutter(&self) -> &Cutter {
        &self.cutter
    }

    /// The contact with the axis at `at`; `None` beside the surface. Parameters near those of the contact
    /// make it faster and change nothing but the last digits.
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

    /// As [`Self::drop`], with the tip proved to within `accuracy` mm. A larger accuracy is faster where
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
        // A contact on an edge may be as high to the accuracy, and not quite so, as one beside it.
        match drop.contact() {
            Some(contact) if contact.is_rolling => drop.try_at(contact.place),
            _ => {}
        }
        Ok(drop.contact())
    }

    /// A contact that Newton's method finds from parameters near it: other places may lift the cutter more.
    /// `None` where it finds none.
    pub fn near(&self, at: Vector2<f64>, place: [f64; 2]) -> Option<Contact> {
        let mut drop = Drop::new(self, at, Some(place), ACCURACY_MM);
        drop.try_at(place);
        drop.contact().map(|contact| Contact { gap_mm: f64::INFINITY, ..contact })
    }

    /// Places spread over the surface, about so many.
    pub fn places(&self, count: usize) -> impl Iterator<Item = [f64; 2]> {
        let step = self.tree.parts.len().div_ceil(count);
        self.tree.parts.iter().step_by(step).map(|part| part.on_surface([0.5, 0.5]))
    }

    /// The tip of the cutter that touches the surface with the tangent plane at a place, whatever else is in
    /// its way; with the upward normal and the surface point. `None` where the normal does not point up.
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

    /// The most that anything in a box can lift the tip along a track.
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
    /// The most that a part can lift the tip along a track, as seen along the line from the axis to it, or at
    /// right angles to a steep part: parts that lie along the side of the cutter are beside it by less than
    /// their boxes know. Infinite where boxes say as much.
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

    /// The slope below which a contact counts as level: a point of the rounded corner with this slope lies
    /// higher than the flat of the cutter by less than the accuracy of a drop.
    fn level_slope(&self) -> f64 {
        let [flat, corner] = [self.cutter.flat_radius(), self.cutter.corner_radius()];
        if flat > 0.0 && corner > 0.0 {
            LEVEL_SLOPE.max(2.0 * (2.0 * ACCURACY_MM / corner).sqrt())
        } else {
            LEVEL_SLOPE
        }
    }

    /// Whether the surface is level at a place, on any patch that meets there.
    fn is_level_at(&self, [u, v]: [f64; 2]) -> bool {
        patches_at([u, v], self.surface.spans()).any(|[i, j]| {
            let jet = self.surface.patch(i, j).jet(u - i as f64, v - j as f64);
            jet.gradient().norm() <= LEVEL_SLOPE
        })
    }

    /// Whether a contact lies on an edge of the surface and is none of its tangent plane.
    fn is_rolling(&self, best: &Best) -> bool {
        let [nu, nv] = self.surface.spans().map(|n| n as f64);
        let [u, v] = best.place;
        let is_on = |to_edge: f64, derivative: &Vector3<f64>| {
            to_edge <= ON_EDGE || to_edge * derivative.norm() <= ON_EDGE_MM
        };
        let (du, dv) = (&best.jet.du, &best.jet.dv);
        let on = [is_on(u, du), is_on(nu - u, du), is_on(v, dv), is_on(nv - v, dv)];
        if !on.iter().zip(&self.edges).any(|(on, edge)| *on && *edge) {
            return false;
        }
        let cutter = Vector3::new(-best.lower.gradient.x, -best.lower.gradient.y, 1.0).normalize();
        // Any patch that meets there may be the one that is touched.
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

/// Which sides of a surface are edges: not those that are a point, and not those that close.
fn edges(surface: &BezierSurface<impl Patch>) -> [bool; 4] {
    let [nu, nv] = surface.spans().map(|n| n as f64);
    let points = |place: &dyn Fn(f64) -> [f64; 2]| -> Vec<Point3<f64>> {
        let point = |k: usize| {
            let [u, v] = place(k as f64 / SIDE_SAMPLES as f64);
            surface.jet(u, v).point
        };
        (0..=SIDE_SAMPLES).map(point).collect()
    };
    let sides = [
        points(&|t| [0.0, t * nv]),
        points(&|t| [nu, t * nv]),
        points(&|t| [t * nu, 0.0]),
        points(&|t| [t * nu, nv]),
    ];
    let is_point = |side: &[Point3<f64>]| side.iter().all(|p| (p - side[0]).norm() < CLOSED_MM);
    let is_same =
        |a: &[Point3<f64>], b: &[Point3<f64>]| a.iter().zip(b).all(|(p, q)| (p - q).norm() < CLOSED_MM);
    std::array::from_fn(|k| !is_point(&sides[k]) && !is_same(&sides[k], &sides[k ^ 1]))
}

#[cfg(test)]
mod tests;
