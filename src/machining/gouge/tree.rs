//! A hierarchy of boxes over the patches of a surface.

use crate::geometry::surface::patch::{Bounds, Patch};
use crate::geometry::surface::{BezierSurface, PatchRange, Surface};

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
        tree.add(surface, PatchRange::all([nu, nv]));
        tree
    }

    /// The box of the whole surface.
    pub(super) fn bounds(&self) -> &Bounds {
        &self.nodes[self.nodes.len() - 1].bounds
    }

    /// Adds the patches of a range; answers the index of their node. The depth is the logarithm of their number.
    fn add(&mut self, surface: &BezierSurface<impl Patch>, range: PatchRange) -> usize {
        let node = match range.halves() {
            None => {
                let (i, j) = (range.i[0], range.j[0]);
                Node { bounds: surface.patch(i, j).bounds(), content: Content::Patch(i, j) }
            }
            Some(halves) => {
                let [first, second] = halves.map(|half| self.add(surface, half));
                let bounds = self.nodes[first].bounds.union(&self.nodes[second].bounds);
                Node { bounds, content: Content::Halves(first, second) }
            }
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
