//! Finds whether some point of the surface lies on the cutter's axis. Where the flat of a cutter touches a
//! level place of the surface, the contact belongs to a section only if there is such a point.

use nalgebra::{Matrix2, Vector2};

use super::tree::{Cover, Held, PartVisitor, SubPatch, Tree};
use super::{Contact, Contacts};
use crate::geometry::surface::patch::{Bounds, Patch};

/// Steps of Newton's method on one part.
const STEPS: usize = 10;

/// Distance in plan, mm, up to which a place counts as under the axis.
const UNDER_MM: f64 = 1e-9;

/// Largest number of halvings of one part that may be under the axis.
const HALVINGS: usize = 32;

impl<P: Patch> Contacts<'_, P> {
    /// Whether the axis of a cutter that stands level is over the surface, and not beyond its edges.
    pub(super) fn is_over(&self, contact: &Contact) -> bool {
        let mut over = Over { tree: &self.tree, at: contact.tip.xy().coords, is_found: false };
        self.tree.visit(&mut over);
        over.is_found
    }
}

/// A search for a place of the surface.
struct Over<'t, P> {
    tree: &'t Tree<P>,
    at: Vector2<f64>,
    is_found: bool,
}

impl<P: Patch> Over<'_, P> {
    fn may_be_in(&self, bounds: &Bounds) -> bool {
        (0..2).all(|k| (bounds.min[k] - UNDER_MM..=bounds.max[k] + UNDER_MM).contains(&self.at[k]))
    }

    /// Whether Newton's method finds a place of the part under the axis.
    fn is_under(&self, part: &SubPatch<P>) -> bool {
        let mut place = [0.5, 0.5];
        for _ in 0..STEPS {
            let jet = part.patch.jet(place[0], place[1]);
            let off = self.at - jet.point.coords.xy();
            if off.norm() <= UNDER_MM {
                return true;
            }
            let across = Matrix2::from_columns(&[jet.du.xy(), jet.dv.xy()]);
            let Some(step) = across.try_inverse().map(|inverse| inverse * off) else { return false };
            let next = [0, 1].map(|k| (place[k] + step[k]).clamp(0.0, 1.0));
            if next == place {
                return false;
            }
            place = next;
        }
        false
    }
}

impl<'t, P: Patch> PartVisitor<'t, P> for Over<'t, P> {
    fn promise(&self, cover: &Cover) -> f64 {
        if self.may_be_in(&cover.bounds) { 1.0 } else { -1.0 }
    }

    fn is_settled(&self, promise: f64) -> bool {
        self.is_found || promise < 0.0
    }

    fn visit(&mut self, part: Held<'t, P>, _promise: f64) {
        let mut open = vec![part];
        for _ in 0..HALVINGS {
            let Some(part) = open.pop() else { return };
            if self.is_under(&part) {
                self.is_found = true;
                return;
            }
            open.extend(self.tree.halves(&part).into_iter().filter(|half| self.may_be_in(&half.bounds)));
        }
    }
}
