//! Where a cutter that comes down from above touches a surface first.
//!
//! # Method
//! With the cutter's axis at a, a surface point P within its radius R lifts the tip to P_z - h(|P - a|), h the height of the
//! cutter's lower side over its tip ([`Cutter`]). The tip's height is the largest lift over all of the surface: an upper
//! envelope, so that folds of the offset, loops, sharp edges, overhangs and boundaries need no care of their own.
//! 1. The surface is kept in small parts under a hierarchy of boxes, each with a plane over what is in it (`tree`).
//! 2. On a part the largest lift is found by Newton's method (`climb`): for the place whose tangent plane touches the cutter over the
//!    axis, which knows no steep slopes, or within the square for the lift itself, which knows edges and corners.
//! 3. That no other place lifts more is proved part by part: by boxes and planes, by the tangent plane of the contact known with the
//!    paraboloid that supports the cutter, by the side of the cutter for parts along it, or by a concave quadratic bound (`bound`). What
//!    that does not decide is halved.
//!
//! # Guarantees
//! A tip is below the true height by no more than [`Contact::gap_mm`], at most some 1e-9 mm but where the
//! limit of work is reached; rounding comes on top. The surface may be anything: only control nets count.
//!
//! # Cost
//! O(log m) for m parts. On a wave of 9 x 9 points a ball or a flat end of 10 mm takes some 3 us a point along lines, without a
//! neighbour 10 and 20; where the cutter touches all around, as on the axis of a bowl, tens of milliseconds.
//!
//! # Differences from the papers
//! Ju traces sections of the offset and Koo et al. unite shifted wires: neither sees what lies beside the
//! section or the wire.

mod bound;
mod climb;
mod drop;
mod over;
mod pace;
mod section;
mod sides;
mod stretch;
mod support;
mod tree;
mod walk;

use std::sync::atomic::{AtomicUsize, Ordering};

use nalgebra::{Point3, Vector2, Vector3};

use super::cutter::Cutter;
use super::surface::patch::{Bounds, Patch};
use super::surface::{BezierSurface, Surface};
use crate::budget::{Budget, Stopped};
use bound::Track;
use drop::{Best, Drop};
pub use section::TipSections;
use tree::{Part, Tree, squared_distance_in_plan};

/// Parts are not halved below this share of the coordinates: they are points to the arithmetic.
const SMALLEST_PART: f64 = 1e-13;

/// Whoever is nearer to the radius than by this part of it is beside the cutter: heights there are not known to the arithmetic.
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
    /// Parts that were looked at so far.
    looks: AtomicUsize,
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

impl<'a, P: Patch> Contacts<'a, P> {
    /// # Errors
    /// Only the budget's stop.
    pub fn new(surface: &'a BezierSurface<P>, cutter: Cutter, budget: &Budget) -> Result<Self, Stopped> {
        let tree = Tree::new(surface, cutter.radius(), budget)?;
        let bend = |patch: &P| {
            let derivatives = patch.derivatives();
            [derivatives.duu, derivatives.duv, derivatives.dvv].map(|ball| ball.reach())
        };
        let bends = surface.patches().iter().map(bend).collect();
        let smallest = SMALLEST_PART * (tree.bounds().magnitude() + cutter.radius());
        let size = (tree.bounds().max - tree.bounds().min).xy().norm();
        let scale = cutter.radius().min(SCALE_SHARE * size);
        let looks = AtomicUsize::new(0);
        Ok(Self { surface, cutter, tree, bends, edges: edges(surface), smallest, looks, scale })
    }

    /// How many parts were looked at so far, for whatever was asked, as if they were bicubic: a measure of the work.
    pub fn looks(&self) -> usize {
        self.looks.load(Ordering::Relaxed).saturating_mul(P::WORK)
    }

    /// A box of the surface, mm.
    pub fn bounds(&self) -> &Bounds {
        self.tree.bounds()
    }

    pub fn cutter(&self) -> &Cutter {
        &self.cutter
    }

    /// The contact with the axis at `at`; `None` beside the surface. Parameters near those of the contact make it faster and
    /// change nothing but the last digits.
    ///
    /// # Errors
    /// Only the budget's stop.
    pub fn drop(
        &self,
        at: Vector2<f64>,
        near: Option<[f64; 2]>,
        budget: &Budget,
    ) -> Result<Option<Contact>, Stopped> {
        self.drop_within(at, near, HALVING_LIMIT, budget)
    }

    /// The same with so many halvings of parts at most; what they leave open is in [`Contact::gap_mm`].
    fn drop_within(
        &self,
        at: Vector2<f64>,
        near: Option<[f64; 2]>,
        halvings: usize,
        budget: &Budget,
    ) -> Result<Option<Contact>, Stopped> {
        let mut drop = Drop::new(self, at, near);
        if let Some(place) = near {
            drop.try_at(place);
        }
        self.tree.visit(&mut drop);
        drop.close(halvings, budget)?;
        self.looks.fetch_add(drop.looks, Ordering::Relaxed);
        Ok(drop.contact())
    }

    /// A contact that Newton's method finds from parameters near it: other places may lift the cutter more. `None` where it finds none.
    pub fn near(&self, at: Vector2<f64>, place: [f64; 2]) -> Option<Contact> {
        let mut drop = Drop::new(self, at, Some(place));
        drop.try_at(place);
        drop.contact().map(|contact| Contact { gap_mm: f64::INFINITY, ..contact })
    }

    /// Places spread over the surface, about so many.
    pub fn places(&self, count: usize) -> impl Iterator<Item = [f64; 2]> {
        let step = self.tree.parts.len().div_ceil(count);
        self.tree.parts.iter().step_by(step).map(|part| part.on_surface([0.5, 0.5]))
    }

    /// The tip of the cutter that touches the surface with the tangent plane at a place, whatever else is in its way; with the upward
    /// normal and the surface point. `None` where the normal does not point up.
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
    fn lift_of_box(&self, bounds: &Bounds, track: &Track) -> f64 {
        let squared = squared_distance_in_plan(bounds, &track.center);
        let most = (1.0 - GRAZING) * self.cutter.radius() + track.reach;
        if squared > most * most {
            f64::NEG_INFINITY
        } else {
            bounds.max.z - self.cutter.height(squared.sqrt() - track.reach)
        }
    }
}

impl<P: Patch> Contacts<'_, P> {
    /// The most that a part can lift the tip along a track, as seen along the line from the axis to it: parts that lie along the side of
    /// the cutter are beside it by less than their boxes know. Infinite where boxes say as much.
    fn lift_of_part(&self, part: &Part<P>, track: &Track) -> f64 {
        let outward = part.lengths.center - track.center;
        let distance = outward.norm();
        if distance + part.lengths.half_diagonal + track.reach < self.cutter.radius() {
            return f64::INFINITY;
        }
        let beyond = |p: Vector3<f64>| outward.dot(&(p.xy() - track.center));
        let nearest = part.patch.control_points().map(beyond).fold(f64::INFINITY, f64::min) / distance;
        let nearest = nearest - track.reach * outward.dot(&track.way).abs() / distance;
        if nearest > (1.0 - GRAZING) * self.cutter.radius() {
            f64::NEG_INFINITY
        } else {
            part.bounds.max.z - self.cutter.height(nearest)
        }
    }

    /// Whether a contact lies on an edge of the surface and is none of its tangent plane.
    fn is_rolling(&self, best: &Best) -> bool {
        let [nu, nv] = self.surface.spans().map(|n| n as f64);
        let [u, v] = best.place;
        let on = [u <= ON_EDGE, u >= nu - ON_EDGE, v <= ON_EDGE, v >= nv - ON_EDGE];
        if !on.iter().zip(&self.edges).any(|(on, edge)| *on && *edge) {
            return false;
        }
        let Some(normal) = best.jet.normal().try_normalize(0.0) else { return true };
        let cutter = Vector3::new(-best.lower.gradient.x, -best.lower.gradient.y, 1.0).normalize();
        normal.cross(&cutter).norm() > ROLLING
    }
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
