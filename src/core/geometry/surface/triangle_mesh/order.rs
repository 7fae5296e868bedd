//! The order of the triangles of a mesh, and the tree of boxes over it.

use nalgebra::{Point3, Vector3};

use crate::budget::{Budget, Stopped};
use crate::geometry::bounding_tree::BoundingTree;
use crate::geometry::surface::patch::Bounds;

/// The most triangles of one box that is not halved: more make searches slower, fewer take more memory.
const TOGETHER: usize = 4;

/// Ranges of more triangles check the budget.
const LARGE: usize = 4096;

/// The triangles of a mesh while they are ordered.
struct Ordering<'a> {
    points: &'a [Point3<f64>],
    tree: BoundingTree<Bounds, [u32; 2]>,
    budget: &'a Budget,
}

/// Puts the triangles into an order in which near ones follow each other, and returns a tree of boxes over
/// ranges of them.
///
/// # Errors
/// Only the budget's stop.
pub(super) fn order(
    points: &[Point3<f64>],
    triangles: &mut [[u32; 3]],
    budget: &Budget,
) -> Result<BoundingTree<Bounds, [u32; 2]>, Stopped> {
    let mut ordering = Ordering { points, tree: BoundingTree::default(), budget };
    ordering.halve(triangles, 0)?;
    Ok(ordering.tree)
}

impl Ordering<'_> {
    fn corners(&self, triangle: &[u32; 3]) -> [&Vector3<f64>; 3] {
        triangle.map(|corner| &self.points[corner as usize].coords)
    }

    /// Three times the centre of a triangle.
    fn centre(&self, triangle: &[u32; 3]) -> Vector3<f64> {
        let [a, b, c] = self.corners(triangle);
        a + b + c
    }

    /// Orders the triangles from place `first` on, and returns the node of their tree. The depth is the
    /// logarithm of their number.
    fn halve(&mut self, triangles: &mut [[u32; 3]], first: usize) -> Result<usize, Stopped> {
        let n = triangles.len();
        if n <= TOGETHER {
            let mut bounds = Bounds::EMPTY;
            for triangle in &*triangles {
                self.corners(triangle).into_iter().for_each(|corner| bounds.include(corner));
            }
            return Ok(self.tree.add(bounds, [first as u32, (first + n) as u32]));
        }
        if n > LARGE {
            self.budget.check()?;
        }
        let mut centres = Bounds::EMPTY;
        triangles.iter().for_each(|triangle| centres.include(&self.centre(triangle)));
        let axis = (centres.max - centres.min).imax();
        let key = |triangle: &[u32; 3]| self.centre(triangle)[axis];
        let by_key = |a: &[u32; 3], b: &[u32; 3]| key(a).total_cmp(&key(b)).then_with(|| a.cmp(b));
        triangles.select_nth_unstable_by(n / 2, by_key);
        let (low, high) = triangles.split_at_mut(n / 2);
        let halves = [self.halve(low, first)?, self.halve(high, first + n / 2)?];
        Ok(self.tree.join(halves))
    }
}
