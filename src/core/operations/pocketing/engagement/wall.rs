//! The loops along which the cutter may slide: the edge of the region of centres, without corners that are
//! sharper than its tightest turn. They have the region on their left.

use nalgebra::Point2;

use super::super::chain::{SHORTEST_MM, nearest};
use crate::geometry::region::Region;
use crate::geometry::segment::Segment;

pub struct Wall {
    loops: Vec<Loop>,
}

struct Loop {
    elements: Vec<Segment>,
    /// The length from the start of the loop to the end of each element, mm.
    ends: Vec<f64>,
}

/// A place on the wall: a loop, and the length along it, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OnWall {
    pub index: usize,
    pub length_mm: f64,
}

impl Wall {
    pub fn new(region: &Region) -> Self {
        let one = |elements: &[Segment]| {
            let mut length = 0.0;
            let mut end = |element: &Segment| {
                length += element.length();
                length
            };
            Loop { ends: elements.iter().map(&mut end).collect(), elements: elements.to_vec() }
        };
        Self { loops: region.outlines().map(|outline| one(outline.elements())).collect() }
    }

    pub fn length(&self, index: usize) -> f64 {
        self.loops[index].ends[self.loops[index].ends.len() - 1]
    }

    /// The place nearest to a point.
    pub fn nearest(&self, p: Point2<f64>) -> (OnWall, Point2<f64>) {
        let mut best = (f64::INFINITY, OnWall { index: 0, length_mm: 0.0 }, p);
        for (index, own) in self.loops.iter().enumerate() {
            let (k, t) = nearest(&own.elements, p);
            let place = own.elements[k].at(t);
            let distance = (place - p).norm();
            if distance < best.0 {
                let length = own.elements[k].length();
                best = (distance, OnWall { index, length_mm: own.ends[k] - (1.0 - t) * length }, place);
            }
        }
        (best.1, best.2)
    }

    /// The wall from a place on, at most this long and within one element.
    pub fn part(&self, from: OnWall, length_mm: f64) -> Segment {
        let own = &self.loops[from.index];
        let at = self.wrapped(from).length_mm;
        // What is left of an element and is shorter than rounding does not count.
        let k = own.ends.partition_point(|end| *end <= at + SHORTEST_MM) % own.ends.len();
        let element = &own.elements[k];
        let whole = element.length();
        let start =
            if at + SHORTEST_MM >= self.length(from.index) { 0.0 } else { at - (own.ends[k] - whole) };
        let start = start.max(0.0);
        element.part(start / whole, ((start + length_mm) / whole).min(1.0))
    }

    pub fn onward(&self, from: OnWall, length_mm: f64) -> OnWall {
        self.wrapped(OnWall { index: from.index, length_mm: from.length_mm + length_mm })
    }

    fn wrapped(&self, place: OnWall) -> OnWall {
        let length_mm = place.length_mm.rem_euclid(self.length(place.index));
        OnWall { index: place.index, length_mm }
    }
}
