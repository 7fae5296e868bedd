//! A hierarchy of boxes over the patches of a surface.

use crate::geometry::surface::patch::{Bounds, Patch};
use crate::geometry::surface::{BezierSurface, Surface};

/// Index ranges of patches, halved until single, with the boxes of their control points.
pub(super) struct PatchTree {
    nodes: Vec<Node>,
}

struct Node {
    bounds: Bounds,
    content: Content,
}

enum Content {
    Patch(usize, usize),
    /// Indices of the two halves.
    Halves(usize, usize),
}

impl PatchTree {
    pub(super) fn new(surface: &BezierSurface<impl Patch>) -> Self {
        let [nu, nv] = surface.spans();
        let mut tree = Self { nodes: Vec::with_capacity(2 * nu * nv) };
        tree.add(surface, [0, nu], [0, nv]);
        tree
    }

    /// The box of the whole surface.
    pub(super) fn bounds(&self) -> &Bounds {
        &self.nodes[self.nodes.len() - 1].bounds
    }

    /// Adds the patches of two index ranges; answers the index of their node. The depth is the logarithm of
    /// their number.
    fn add(&mut self, surface: &BezierSurface<impl Patch>, i: [usize; 2], j: [usize; 2]) -> usize {
        let (rows, columns) = (i[1] - i[0], j[1] - j[0]);
        let node = if rows == 1 && columns == 1 {
            Node { bounds: surface.patch(i[0], j[0]).bounds(), content: Content::Patch(i[0], j[0]) }
        } else {
            let (first, second) = if rows >= columns {
                let middle = i[0] + rows / 2;
                (self.add(surface, [i[0], middle], j), self.add(surface, [middle, i[1]], j))
            } else {
                let middle = j[0] + columns / 2;
                (self.add(surface, i, [j[0], middle]), self.add(surface, i, [middle, j[1]]))
            };
            let bounds = self.nodes[first].bounds.union(&self.nodes[second].bounds);
            Node { bounds, content: Content::Halves(first, second) }
        };
        self.nodes.push(node);
        self.nodes.len() - 1
    }

    /// Appends the indices of the patches whose boxes meet `reach`.
    pub(super) fn collect(&self, reach: &Bounds, found: &mut Vec<(usize, usize)>) {
        let mut stack = vec![self.nodes.len() - 1];
        while let Some(k) = stack.pop() {
            let Node { bounds, content } = &self.nodes[k];
            let apart = (0..3).any(|c| bounds.min[c] > reach.max[c] || bounds.max[c] < reach.min[c]);
            match content {
                _ if apart => {}
                Content::Patch(i, j) => found.push((*i, *j)),
                Content::Halves(first, second) => stack.extend([*second, *first]),
            }
        }
    }
}
