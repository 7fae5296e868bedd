//! A surface of Bezier patches of one type.

use nalgebra::Vector3;

use super::patch::{BicubicPatch, Bounds, Patch};
use super::topology::Topology;
use super::{Jet, PatchRange, Surface, span_of};
use crate::budget::{Budget, Stopped};
use crate::geometry::bounding_tree::BoundingTree;

/// Most halvings in the search for the highest point. A surface that is level at its top along a curve would
/// need more; then the height of the remaining control points is the answer.
const TOP_HALVINGS: usize = 100_000;

/// Samples for each span of a side, where [`BezierSurface::continued`] measures the tangents across the side.
const SIDE_SAMPLES: usize = 16;

/// A surface of nu by nv patches; patch (i, j) is `patches[i * nv + j]` and covers i..=i+1, j..=j+1.
#[derive(Debug, Clone, PartialEq)]
pub struct BezierSurface<P = BicubicPatch> {
    spans: [usize; 2],
    patches: Vec<P>,
}

impl<P: Patch> BezierSurface<P> {
    /// Makes the surface whose patch (i, j) is `patch(i, j)`; both spans are at least 1.
    pub fn from_fn(spans: [usize; 2], mut patch: impl FnMut(usize, usize) -> P) -> Self {
        let mut patches = Vec::with_capacity(spans[0] * spans[1]);
        for i in 0..spans[0] {
            patches.extend((0..spans[1]).map(|j| patch(i, j)));
        }
        Self { spans, patches }
    }

    /// The patch over i..=i+1, j..=j+1; both indices are within [`Surface::spans`].
    pub fn patch(&self, i: usize, j: usize) -> &P {
        &self.patches[i * self.spans[1] + j]
    }

    pub fn patches(&self) -> &[P] {
        &self.patches
    }

    /// A bounding tree over the indices (i, j) of the patches, made of the boxes of their control points.
    pub fn bounding_tree(&self) -> BoundingTree<Bounds, [usize; 2]> {
        let mut tree = BoundingTree::default();
        self.add_boxes(&mut tree, PatchRange::all(self.spans));
        tree
    }

    fn add_boxes(&self, tree: &mut BoundingTree<Bounds, [usize; 2]>, range: PatchRange) -> usize {
        let Some(halves) = range.halves() else {
            let (i, j) = (range.i[0], range.j[0]);
            return tree.add(self.patch(i, j).bounds(), [i, j]);
        };
        let [first, second] = halves.map(|half| self.add_boxes(tree, half));
        // A search without a preference visits the second of a pair first. This order makes it visit the
        // patches in the order of their indices.
        tree.join([second, first])
    }

    /// An upper bound of the height of the surface's highest point, mm. It exceeds that height by at most
    /// `accuracy` mm. Only on a surface that is level at its top along a whole curve it may be as high as the
    /// control points.
    ///
    /// # Errors
    /// Only the budget's stop.
    pub fn top(&self, accuracy: f64, budget: &Budget) -> Result<f64, Stopped> {
        self.farthest_along(&Vector3::z(), accuracy, budget)
    }

    /// An upper bound of the surface's largest coordinate along the unit vector `direction`, mm, as precise
    /// as [`Self::top`].
    ///
    /// # Errors
    /// Only the budget's stop.
    pub fn farthest_along(
        &self,
        direction: &Vector3<f64>,
        accuracy: f64,
        budget: &Budget,
    ) -> Result<f64, Stopped> {
        let highest = |part: &P| -part.lowest_along(&-direction);
        let at_corners =
            |part: &P| part.corners().map(|p| p.dot(direction)).into_iter().fold(f64::MIN, f64::max);
        let mut open: Vec<P> = self.patches.clone();
        let mut found = open.iter().map(at_corners).fold(f64::NEG_INFINITY, f64::max);
        let mut farthest = found;
        let (mut halvings, mut parts) = (0, 0usize);
        while let Some(part) = open.pop() {
            parts += 1;
            if parts.is_multiple_of(1024) {
                budget.check()?;
            }
            found = found.max(at_corners(&part));
            if highest(&part) <= found + accuracy || halvings >= TOP_HALVINGS {
                farthest = farthest.max(highest(&part));
            } else {
                halvings += 1;
                open.extend(part.split());
            }
        }
        Ok(farthest)
    }

    /// The same surface with u and v exchanged, so that its normal points the other way.
    pub fn transposed(&self) -> Self {
        let [nu, nv] = self.spans;
        Self::from_fn([nv, nu], |j, i| self.patch(i, j).transposed())
    }

    /// The surface, transposed if necessary, so that its normal points up over most of its outline.
    pub fn upward(self) -> Self {
        let facing_up: f64 = self.patches().iter().map(|patch| patch.jet(0.5, 0.5).normal().z).sum();
        if facing_up < 0.0 { self.transposed() } else { self }
    }

    /// The surface with straight patches added along its edges, tangent to it and at least `by` mm long.
    /// Seams and poles are not continued. A cutter that runs past the edges follows this surface. `None`
    /// where an edge has no tangents across, or where the weights of a rational edge leave no room for a
    /// continuation.
    pub fn continued(&self, by: f64) -> Option<Self> {
        let [low_u, high_u, low_v, high_v] = Topology::of(self).edges();
        // Four continuations along u, with a quarter turn after each, end in the original orientation.
        [high_u, high_v, low_u, low_v].into_iter().try_fold(self.clone(), |surface, is_edge| {
            Some(if is_edge { surface.continued_along_u(by)?.turned() } else { surface.turned() })
        })
    }

    fn continued_along_u(&self, by: f64) -> Option<Self> {
        let [nu, nv] = self.spans;
        let places = (0..=nv * SIDE_SAMPLES).map(|k| k as f64 / SIDE_SAMPLES as f64);
        let shortest = places.map(|v| self.jet(nu as f64, v).du.norm()).fold(f64::INFINITY, f64::min);
        // Between the samples a tangent may be a little shorter than the shortest sample.
        let reach = 1.1 * by / shortest;
        if !reach.is_finite() {
            return None;
        }
        let side: Option<Vec<P>> = (0..nv).map(|j| self.patch(nu - 1, j).continued(reach)).collect();
        let side = side?;
        Some(Self::from_fn([nu + 1, nv], |i, j| if i < nu { *self.patch(i, j) } else { side[j] }))
    }

    /// The same surface with its domain turned by a quarter: the side of the largest v becomes the side of
    /// the largest u.
    fn turned(&self) -> Self {
        let [nu, nv] = self.spans;
        Self::from_fn([nv, nu], |i, j| self.patch(nu - 1 - j, i).turned())
    }
}

impl<P: Patch> Surface for BezierSurface<P> {
    fn spans(&self) -> [usize; 2] {
        self.spans
    }

    fn jet(&self, u: f64, v: f64) -> Jet {
        let [nu, nv] = self.spans;
        let (i, j) = (span_of(u, nu), span_of(v, nv));
        self.patch(i, j).jet(u - i as f64, v - j as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dome() -> BezierSurface {
        let at = |i: usize| [0.0, 10.0, 20.0, 30.0][i];
        let height = |a: usize, b: usize| if (1..3).contains(&a) && (1..3).contains(&b) { 9.0 } else { 0.0 };
        BezierSurface::from_fn([1, 2], |_, j| BicubicPatch {
            net: std::array::from_fn(|a| {
                std::array::from_fn(|b| Vector3::new(at(a), at(b) + 30.0 * j as f64, height(a, b)))
            }),
        })
    }

    #[test]
    fn a_continued_surface_holds_the_surface_and_reaches_past_every_side() {
        let wide = dome().continued(4.0).unwrap();
        assert_eq!(wide.spans(), [3, 4]);
        for (u, v) in [(0.2, 0.7), (0.9, 1.6)] {
            assert!((wide.jet(u + 1.0, v + 1.0).point - dome().jet(u, v).point).norm() < 1e-12);
        }
        let corner = wide.jet(0.0, 0.0).point;
        assert!(corner.x <= -4.0 && corner.y <= -4.0, "{corner}");
        let corner = wide.jet(3.0, 4.0).point;
        assert!(corner.x >= 34.0 && corner.y >= 64.0, "{corner}");
        // No kink at the joints.
        for v in [0.3f64, 1.2, 2.9, 3.5] {
            let joint = |i: usize, u: f64| wide.patch(i, v as usize).jet(u, v.fract()).normal().normalize();
            assert!((joint(0, 1.0) - joint(1, 0.0)).norm() < 1e-12);
            assert!((joint(1, 1.0) - joint(2, 0.0)).norm() < 1e-12);
        }
    }

    #[test]
    fn the_top_is_the_height_of_the_domes_highest_point() {
        // 9 times the square of 3/4.
        let top = dome().top(1e-9, &Budget::unlimited()).unwrap();
        assert!((top - 9.0 * 0.5625).abs() < 1e-8, "{top}");
        let farthest = dome().farthest_along(&-Vector3::y(), 1e-9, &Budget::unlimited()).unwrap();
        assert_eq!(farthest, 0.0);
    }
}
