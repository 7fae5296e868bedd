//! A tree of bounding boxes over a chain of elements, for searches for the elements near a place.
//!
//! The chain is halved again and again, until each part has only a few elements. Each part gets a box, so
//! elements that follow each other in the chain share boxes. A search is O(log n + found) for n elements,
//! unless parts that are far apart in the chain lie close together in the plane.

use nalgebra::{Point2, Vector2};

use crate::geometry::bounding_tree::{BoundingTree, Visitor, Volume};
use crate::geometry::segment::Segment;

/// Elements under one box at the bottom of the tree.
const LEAF: usize = 4;

/// The share of the largest coordinate by which a search opens boxes. The corners of boxes are rounded
/// points.
const ROUNDING: f64 = 1e-14;

/// A chain of elements with its boxes.
#[derive(Debug, Clone)]
pub(in crate::geometry) struct Tree {
    elements: Vec<Segment>,
    /// Over ranges of indices of elements: from the first to before the last.
    boxes: BoundingTree<Bounds, [usize; 2]>,
}

/// The lowest and the highest coordinates.
#[derive(Debug, Clone, Copy)]
pub(in crate::geometry) struct Bounds {
    pub(in crate::geometry) low: Point2<f64>,
    pub(in crate::geometry) high: Point2<f64>,
}

impl Bounds {
    /// The bounds of no point.
    pub(in crate::geometry) const NONE: Self = Self {
        low: Point2::new(f64::INFINITY, f64::INFINITY),
        high: Point2::new(-f64::INFINITY, -f64::INFINITY),
    };

    pub(in crate::geometry) fn of(element: &Segment) -> Self {
        let [low, high] = element.bounding_box();
        Self { low, high }
    }

    fn distance(&self, p: Point2<f64>) -> f64 {
        let beyond = |low: f64, x: f64, high: f64| (low - x).max(x - high).max(0.0);
        Vector2::new(beyond(self.low.x, p.x, self.high.x), beyond(self.low.y, p.y, self.high.y)).norm()
    }

    fn meets(&self, other: &Self) -> bool {
        (0..2).all(|k| self.low[k] <= other.high[k] && other.low[k] <= self.high[k])
    }
}

impl Volume for Bounds {
    fn joined(&self, other: &Self) -> Self {
        Self { low: self.low.inf(&other.low), high: self.high.sup(&other.high) }
    }
}

impl Tree {
    pub(in crate::geometry) fn new(elements: Vec<Segment>) -> Self {
        let mut boxes = BoundingTree::default();
        add(&mut boxes, &elements, [0, elements.len()]);
        Self { elements, boxes }
    }

    pub(in crate::geometry) fn elements(&self) -> &[Segment] {
        &self.elements
    }

    /// Shows the elements nearer to `p` than `within`, with their distances, until `see` answers false.
    pub(in crate::geometry) fn near(
        &self,
        p: Point2<f64>,
        within: f64,
        mut see: impl FnMut(usize, f64) -> bool,
    ) {
        let opened = within + ROUNDING * (p.x.abs().max(p.y.abs()) + within);
        self.boxes.search(&mut Search {
            elements: &self.elements,
            matters: |bounds: &Bounds| bounds.distance(p) < opened,
            see: |k, element: &Segment| {
                let distance = element.distance_to(p);
                distance >= within || see(k, distance)
            },
            is_over: false,
        });
    }

    /// Shows the elements whose boxes meet `place`.
    pub(in crate::geometry) fn meeting(&self, place: &Bounds, mut see: impl FnMut(usize, &Segment)) {
        self.boxes.search(&mut Search {
            elements: &self.elements,
            matters: |bounds: &Bounds| bounds.meets(place),
            see: |k, element: &Segment| {
                if Bounds::of(element).meets(place) {
                    see(k, element);
                }
                true
            },
            is_over: false,
        });
    }

    /// The distance of the nearest element, if it is less than `bound`; else `bound`.
    pub(in crate::geometry) fn nearest(&self, p: Point2<f64>, bound: f64) -> f64 {
        let mut nearest = Nearest { elements: &self.elements, p, distance: bound };
        self.boxes.search(&mut nearest);
        nearest.distance
    }
}

/// Adds a range of elements and returns the index of its node. The tree visits the second of two halves that
/// promise the same first, so the second is the one that comes first in the chain.
fn add(boxes: &mut BoundingTree<Bounds, [usize; 2]>, elements: &[Segment], [from, to]: [usize; 2]) -> usize {
    if to - from <= LEAF {
        let bounds = elements[from..to].iter().map(Bounds::of);
        return boxes.add(bounds.fold(Bounds::NONE, |all, own| all.joined(&own)), [from, to]);
    }
    let middle = usize::midpoint(from, to);
    let halves = [add(boxes, elements, [middle, to]), add(boxes, elements, [from, middle])];
    boxes.join(halves)
}

/// Shows the elements under boxes that matter, in the order of the chain, until `see` answers false.
struct Search<'a, M, S> {
    elements: &'a [Segment],
    matters: M,
    see: S,
    is_over: bool,
}

impl<M, S> Visitor<Bounds, [usize; 2]> for Search<'_, M, S>
where
    M: Fn(&Bounds) -> bool,
    S: FnMut(usize, &Segment) -> bool,
{
    fn promise(&self, bounds: &Bounds) -> f64 {
        if (self.matters)(bounds) { 1.0 } else { 0.0 }
    }

    fn is_settled(&self, promise: f64) -> bool {
        self.is_over || promise == 0.0
    }

    fn visit(&mut self, [from, to]: &[usize; 2], _promise: f64) {
        self.is_over = !(*from..*to).all(|k| (self.see)(k, &self.elements[k]));
    }
}

/// The search for the element nearest to a point.
struct Nearest<'a> {
    elements: &'a [Segment],
    p: Point2<f64>,
    distance: f64,
}

impl Visitor<Bounds, [usize; 2]> for Nearest<'_> {
    fn promise(&self, bounds: &Bounds) -> f64 {
        -bounds.distance(self.p)
    }

    fn is_settled(&self, promise: f64) -> bool {
        promise <= -self.distance
    }

    fn visit(&mut self, [from, to]: &[usize; 2], _promise: f64) {
        for element in &self.elements[*from..*to] {
            self.distance = self.distance.min(element.distance_to(self.p));
        }
    }
}
