//! A binary tree over items, and a search that skips parts of the tree. Each node of the tree has a bounding
//! volume.
//!
//! # Method
//! The caller builds the tree from its leaves up: each item becomes a leaf with a volume, and two nodes get a
//! parent, whose volume contains both of their volumes.
//!
//! The search is given a visitor, which states an upper bound for each volume: nothing in the volume is worth
//! more to the visitor than this number. The search goes down the tree and takes the child with the larger
//! bound first. It skips a node if the visitor declares the bound of the node too small, because of what it
//! has already found.
//!
//! # Cost
//! O(n) to build the tree over n items. A search is O(log n + f) if volumes are hardly larger than the items
//! in them, where f is the number of items that the visitor is shown.

/// A tree of volumes `V` over items `T`.
#[derive(Debug, Clone)]
pub struct BoundingTree<V, T> {
    nodes: Vec<Node<V, T>>,
}

#[derive(Debug, Clone)]
struct Node<V, T> {
    volume: V,
    content: Content<T>,
}

#[derive(Debug, Clone)]
enum Content<T> {
    Item(T),
    /// Indices of two nodes.
    Halves([usize; 2]),
}

/// A set of points that holds others.
pub trait Volume {
    /// A volume that holds both.
    fn joined(&self, other: &Self) -> Self;
}

/// What a search looks for.
pub trait Visitor<V, T> {
    /// An upper bound of what may be found in a volume.
    fn promise(&self, volume: &V) -> f64;

    /// Whether a promise no longer matters.
    fn is_settled(&self, promise: f64) -> bool;

    /// Looks at an item whose volume makes a promise.
    fn visit(&mut self, item: &T, promise: f64);
}

impl<V, T> Default for BoundingTree<V, T> {
    /// A tree without nodes.
    fn default() -> Self {
        Self { nodes: Vec::new() }
    }
}

impl<V: Volume, T> BoundingTree<V, T> {
    /// Adds an item and returns the index of its node.
    pub fn add(&mut self, volume: V, item: T) -> usize {
        self.push(volume, Content::Item(item))
    }

    /// Adds a node above two others and returns its index.
    pub fn join(&mut self, [first, second]: [usize; 2]) -> usize {
        let volume = self.nodes[first].volume.joined(&self.nodes[second].volume);
        self.push(volume, Content::Halves([first, second]))
    }

    fn push(&mut self, volume: V, content: Content<T>) -> usize {
        self.nodes.push(Node { volume, content });
        self.nodes.len() - 1
    }

    /// The volume of all items of a tree that has nodes.
    pub fn volume(&self) -> &V {
        &self.nodes[self.nodes.len() - 1].volume
    }

    /// Shows the visitor the items that may matter to it.
    pub fn search(&self, visitor: &mut impl Visitor<V, T>) {
        let Some(root) = self.nodes.len().checked_sub(1) else { return };
        // Depths are logarithms of numbers of items.
        let mut open: Vec<(usize, f64)> = Vec::with_capacity(64);
        open.push((root, visitor.promise(&self.nodes[root].volume)));
        while let Some((k, promise)) = open.pop() {
            if visitor.is_settled(promise) {
                continue;
            }
            match &self.nodes[k].content {
                Content::Item(item) => visitor.visit(item, promise),
                Content::Halves(halves) => {
                    let [a, b] = halves.map(|half| (half, visitor.promise(&self.nodes[half].volume)));
                    open.extend(if a.1 > b.1 { [b, a] } else { [a, b] });
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A range of numbers.
    impl Volume for [f64; 2] {
        fn joined(&self, other: &Self) -> Self {
            [self[0].min(other[0]), self[1].max(other[1])]
        }
    }

    /// The number nearest to `to`, and how many numbers were looked at.
    struct Nearest {
        to: f64,
        distance: f64,
        looked: usize,
    }

    impl Visitor<[f64; 2], f64> for Nearest {
        fn promise(&self, [low, high]: &[f64; 2]) -> f64 {
            -(low - self.to).max(self.to - high).max(0.0)
        }

        fn is_settled(&self, promise: f64) -> bool {
            promise <= -self.distance
        }

        fn visit(&mut self, item: &f64, _promise: f64) {
            self.looked += 1;
            self.distance = self.distance.min((item - self.to).abs());
        }
    }

    fn tree(numbers: &[f64]) -> BoundingTree<[f64; 2], f64> {
        fn add(tree: &mut BoundingTree<[f64; 2], f64>, numbers: &[f64]) -> usize {
            match numbers {
                [one] => tree.add([*one, *one], *one),
                more => {
                    let (first, second) = more.split_at(more.len() / 2);
                    let halves = [add(tree, first), add(tree, second)];
                    tree.join(halves)
                }
            }
        }
        let mut tree = BoundingTree::default();
        add(&mut tree, numbers);
        tree
    }

    #[test]
    fn a_search_finds_the_nearest_item_and_looks_at_few() {
        let numbers: Vec<f64> = (0..1000).map(|k| f64::from(k * k)).collect();
        let tree = tree(&numbers);
        assert_eq!(*tree.volume(), [0.0, 998_001.0]);
        for to in [-5.0, 0.0, 3.0, 500_000.0, 2e6] {
            let mut nearest = Nearest { to, distance: f64::INFINITY, looked: 0 };
            tree.search(&mut nearest);
            let least = numbers.iter().map(|x| (x - to).abs()).fold(f64::INFINITY, f64::min);
            assert_eq!(nearest.distance, least);
            assert!(nearest.looked <= 2, "{}", nearest.looked);
        }
    }

    #[test]
    fn a_tree_without_nodes_shows_nothing() {
        let mut nearest = Nearest { to: 0.0, distance: 1.0, looked: 0 };
        BoundingTree::default().search(&mut nearest);
        assert_eq!(nearest.looked, 0);
    }
}
