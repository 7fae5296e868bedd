//! The nearest neighbour of each of many points in the plane.
//!
//! # Cost
//! O(n log n) for n points, however they are spread.

use toolpathd_core::budget::{Budget, Stopped};
use toolpathd_core::geometry::bounding_tree::{BoundingTree, Visitor, Volume};

/// Searches between two looks at the budget.
const SEARCHES_PER_CHECK: usize = 1024;

/// A box in the plane: its corners with the least and the largest coordinates.
#[derive(Debug, Clone, Copy)]
struct Box2([[f64; 2]; 2]);

impl Volume for Box2 {
    fn joined(&self, other: &Self) -> Self {
        let ([low, high], [other_low, other_high]) = (self.0, other.0);
        Self([[0, 1].map(|k| low[k].min(other_low[k])), [0, 1].map(|k| high[k].max(other_high[k]))])
    }
}

/// The nearest other point found so far.
struct Nearest<'a> {
    points: &'a [[f64; 2]],
    of: usize,
    way: [f64; 2],
    squared: f64,
}

impl Visitor<Box2, usize> for Nearest<'_> {
    /// Minus the square of the distance of the box.
    fn promise(&self, Box2([low, high]): &Box2) -> f64 {
        let at = self.points[self.of];
        let apart = [0, 1].map(|k| (low[k] - at[k]).max(at[k] - high[k]).max(0.0));
        -(apart[0] * apart[0] + apart[1] * apart[1])
    }

    fn is_settled(&self, promise: f64) -> bool {
        -promise >= self.squared
    }

    fn visit(&mut self, item: &usize, _: f64) {
        let (at, other) = (self.points[self.of], self.points[*item]);
        let way = [other[0] - at[0], other[1] - at[1]];
        let squared = way[0] * way[0] + way[1] * way[1];
        if *item != self.of && squared < self.squared {
            (self.way, self.squared) = (way, squared);
        }
    }
}

/// For each point the way to its nearest neighbour.
///
/// # Errors
/// The budget's stop.
pub fn ways(points: &[[f64; 2]], budget: &Budget) -> Result<Vec<[f64; 2]>, Stopped> {
    let mut tree = BoundingTree::default();
    let mut order: Vec<usize> = (0..points.len()).collect();
    build(&mut tree, points, &mut order);
    let way = |of: usize| {
        if of.is_multiple_of(SEARCHES_PER_CHECK) {
            budget.check()?;
        }
        let mut nearest = Nearest { points, of, way: [0.0; 2], squared: f64::INFINITY };
        tree.search(&mut nearest);
        Ok(nearest.way)
    };
    (0..points.len()).map(way).collect()
}

/// Adds points to the tree, halved along the longer side of their box, and returns the node of all of them.
fn build(tree: &mut BoundingTree<Box2, usize>, points: &[[f64; 2]], order: &mut [usize]) -> usize {
    if let [only] = *order {
        return tree.add(Box2([points[only]; 2]), only);
    }
    let boxes = order.iter().map(|&k| Box2([points[k]; 2]));
    let size = boxes
        .reduce(|a, b| a.joined(&b))
        .map_or([0.0; 2], |Box2([low, high])| [0, 1].map(|k| high[k] - low[k]));
    let along = usize::from(size[1] > size[0]);
    let middle = order.len() / 2;
    order.select_nth_unstable_by(middle, |a, b| points[*a][along].total_cmp(&points[*b][along]));
    let (left, right) = order.split_at_mut(middle);
    let halves = [build(tree, points, left), build(tree, points, right)];
    tree.join(halves)
}
