//! A hierarchy of boxes over elements in their order, which is also nearly their order in the plane.
//!
//! # Method
//! The sequence is halved until a few elements are left; each part has its box.
//!
//! # Cost
//! O(n) to build. A search among the elements near a point is O(log n + found) where the sequence does not
//! meander.

use nalgebra::{Point2, Vector2};

use super::distance;
use crate::geometry::element::Element;

/// Elements that are looked at one by one.
const LEAF: usize = 4;

/// By how much boxes are opened in a search, in parts of the largest coordinate: they are made of rounded
/// points.
const ROUNDING: f64 = 1e-14;

/// Elements with boxes.
#[derive(Debug, Clone)]
pub(in crate::geometry) struct Tree {
    elements: Vec<Element>,
    nodes: Vec<Node>,
}

#[derive(Debug, Clone)]
struct Node {
    low: Point2<f64>,
    high: Point2<f64>,
    /// From the first element to before the last.
    range: [usize; 2],
    /// The second half; the first one follows its parent. Zero for a leaf.
    second: usize,
}

impl Node {
    fn distance(&self, p: Point2<f64>) -> f64 {
        let beyond = |low: f64, x: f64, high: f64| (low - x).max(x - high).max(0.0);
        Vector2::new(beyond(self.low.x, p.x, self.high.x), beyond(self.low.y, p.y, self.high.y)).norm()
    }
}

impl Tree {
    pub(in crate::geometry) fn new(elements: Vec<Element>) -> Self {
        let mut tree = Self { nodes: Vec::with_capacity(elements.len()), elements };
        tree.add([0, tree.elements.len()]);
        tree
    }

    pub(in crate::geometry) fn elements(&self) -> &[Element] {
        &self.elements
    }

    /// Adds a part with its halves; the depth is the logarithm of the number of elements.
    fn add(&mut self, range: [usize; 2]) -> usize {
        let at = self.nodes.len();
        let [low, high] =
            [Point2::new(f64::INFINITY, f64::INFINITY), Point2::new(-f64::INFINITY, -f64::INFINITY)];
        self.nodes.push(Node { low, high, range, second: 0 });
        let (low, high) = if range[1] - range[0] <= LEAF {
            self.elements[range[0]..range[1]].iter().fold((low, high), |(low, high), element| {
                let [a, b] = bounds(element);
                (low.inf(&a), high.sup(&b))
            })
        } else {
            let middle = usize::midpoint(range[0], range[1]);
            let first = self.add([range[0], middle]);
            let second = self.add([middle, range[1]]);
            self.nodes[at].second = second;
            let [a, b] = [&self.nodes[first], &self.nodes[second]];
            (a.low.inf(&b.low), a.high.sup(&b.high))
        };
        (self.nodes[at].low, self.nodes[at].high) = (low, high);
        at
    }

    /// Shows the elements nearer to `p` than `within`, with their distances, until `see` answers false.
    pub(in crate::geometry) fn near(
        &self,
        p: Point2<f64>,
        within: f64,
        mut see: impl FnMut(usize, f64) -> bool,
    ) {
        let opened = within + ROUNDING * (p.x.abs().max(p.y.abs()) + within);
        let mut stack = vec![0];
        while let Some(at) = stack.pop() {
            let node = &self.nodes[at];
            if node.distance(p) >= opened {
                continue;
            }
            if node.second > 0 {
                stack.extend([node.second, at + 1]);
                continue;
            }
            for k in node.range[0]..node.range[1] {
                let distance = distance::to_point(&self.elements[k], p);
                if distance < within && !see(k, distance) {
                    return;
                }
            }
        }
    }

    /// Shows the elements with boxes that meet the box from `low` to `high`.
    pub(in crate::geometry) fn meeting(
        &self,
        low: Point2<f64>,
        high: Point2<f64>,
        mut see: impl FnMut(usize, &Element),
    ) {
        let mut stack = vec![0];
        while let Some(at) = stack.pop() {
            let node = &self.nodes[at];
            if !meet([node.low, node.high], [low, high]) {
                continue;
            }
            if node.second > 0 {
                stack.extend([node.second, at + 1]);
                continue;
            }
            for k in node.range[0]..node.range[1] {
                if meet(bounds(&self.elements[k]), [low, high]) {
                    see(k, &self.elements[k]);
                }
            }
        }
    }

    /// The distance of the nearest element, if it is less than `bound`; else `bound`.
    pub(in crate::geometry) fn nearest(&self, p: Point2<f64>, bound: f64) -> f64 {
        let mut least = bound;
        let mut stack = vec![(0, self.nodes[0].distance(p))];
        while let Some((at, distance)) = stack.pop() {
            if distance >= least {
                continue;
            }
            let node = &self.nodes[at];
            if node.second > 0 {
                let mut halves = [at + 1, node.second].map(|half| (half, self.nodes[half].distance(p)));
                // The nearer half is looked at first.
                if halves[0].1 <= halves[1].1 {
                    halves.swap(0, 1);
                }
                stack.extend(halves);
                continue;
            }
            for element in &self.elements[node.range[0]..node.range[1]] {
                least = least.min(distance::to_point(element, p));
            }
        }
        least
    }
}

fn meet([low, high]: [Point2<f64>; 2], [other_low, other_high]: [Point2<f64>; 2]) -> bool {
    low.x <= other_high.x && other_low.x <= high.x && low.y <= other_high.y && other_low.y <= high.y
}

/// The lowest and the highest coordinates of an element.
pub(in crate::geometry) fn bounds(element: &Element) -> [Point2<f64>; 2] {
    let (start, end) = (element.start(), element.end());
    let (mut low, mut high) = (start.inf(&end), start.sup(&end));
    if let Element::Arc(arc) = element {
        for axis in [Vector2::x(), -Vector2::x(), Vector2::y(), -Vector2::y()] {
            if distance::covers(arc, axis) {
                let extreme = arc.center + axis * arc.radius;
                (low, high) = (low.inf(&extreme), high.sup(&extreme));
            }
        }
    }
    [low, high]
}
