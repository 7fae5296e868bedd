//! Offsets of regions, and the areas that discs sweep.
//!
//! # Method
//! 1. The usual way moves the outlines aside ([`offset`]) into chains. The offset is the area to the left of
//!    these chains.
//! 2. Rounding may leave a gap in a chain, or move a chain too near to an outline. Then the offset is made of
//!    capsules. A capsule is the area that a disc sweeps along one element. To grow, a region takes in the
//!    capsules of all elements of its boundary; to shrink, it loses them. A capsule is a closed loop even
//!    after rounding.
//!
//! # Guarantees
//! The usual way is exact to a few snaps. A region that loses capsules loses [`BIAS_MM`] more than the
//! distance, so that snaps leave no place nearer to the boundary than the distance.
//!
//! # Cost
//! O(n log n) for n elements that overlap only their neighbours. The capsules of neighbouring elements are
//! joined in groups first, so that few edges are left when the groups are joined.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{Point2, Vector2};

use super::arrangement::Loop;
use super::trace::{self, Wedge};
use super::{Region, RegionError};
use crate::budget::Budget;
use crate::geometry::offset::{OffsetError, Side, offset, swept};
use crate::geometry::segment::{Segment, left};

/// By how much more a region shrinks by capsules, mm: four snaps, of the set operations that take capsules
/// away.
const BIAS_MM: f64 = 4e-6;

/// Elements whose capsules are joined first, and groups that are joined to larger groups.
const GROUP: usize = 16;

/// The largest gap between two neighbouring elements in the boundary of a swept area, mm: the largest snap. A
/// wider gap means that a part of the boundary is missing.
const UNCLOSED_MM: f64 = 1.6e-5;

/// Elements that are no longer are points, mm.
const POINT_MM: f64 = 1e-9;

impl Region {
    /// The places of the region that are at least `distance_mm` from its boundary. The result may be empty.
    ///
    /// # Errors
    /// One of [`RegionError`].
    pub fn offset_inward(&self, distance_mm: f64, budget: &Budget) -> Result<Self, RegionError> {
        self.offset(Side::Left, distance_mm, budget)
    }

    /// The places that are in the region or nearer to it than `distance_mm`.
    ///
    /// # Errors
    /// One of [`RegionError`].
    pub fn offset_outward(&self, distance_mm: f64, budget: &Budget) -> Result<Self, RegionError> {
        self.offset(Side::Right, distance_mm, budget)
    }

    /// The places that a disc sweeps while its centre follows chains of lines and arcs.
    ///
    /// # Errors
    /// One of [`RegionError`].
    pub fn swept(chains: &[&[Segment]], radius_mm: f64, budget: &Budget) -> Result<Self, RegionError> {
        is_distance(radius_mm)?;
        let boundary = swept::boundary(chains, radius_mm, budget)?;
        let (area, allowed) = (super::area(&boundary), UNCLOSED_MM * super::outline::length(&boundary));
        match Self::on_the_left(&[boundary], budget) {
            // Where parts of the boundary are missing, its area is another.
            Ok(swept) if (swept.area() - area).abs() <= allowed => Ok(swept),
            Ok(_) | Err(RegionError::Tangled { .. }) => {
                Self::of_capsules(chains.iter().copied().flatten(), radius_mm, budget)
            }
            Err(error) => Err(error),
        }
    }

    fn offset(&self, side: Side, distance_mm: f64, budget: &Budget) -> Result<Self, RegionError> {
        is_distance(distance_mm)?;
        match self.moved_aside(side, distance_mm, budget) {
            Err(RegionError::Tangled { .. } | RegionError::Offset(OffsetError::Unproved { .. })) => {
                self.by_capsules(side, distance_mm, budget)
            }
            offset => offset,
        }
    }

    /// The offset by moving the outlines aside.
    pub(super) fn moved_aside(
        &self,
        side: Side,
        distance_mm: f64,
        budget: &Budget,
    ) -> Result<Self, RegionError> {
        let wedge = if side == Side::Left { Wedge::Inside } else { Wedge::Outside };
        let contours = trace::contours(self.outlines(), wedge, budget)?;
        let contours: Vec<&[Segment]> = contours.iter().map(Vec::as_slice).collect();
        let chains = offset(&contours, side, distance_mm, 0.0, budget)?;
        for chain in &chains {
            if let (Some(first), Some(last)) = (chain.first(), chain.last())
                && first.start() != last.end()
            {
                return Err(RegionError::Tangled { at: first.start() });
            }
        }
        Self::on_the_left(&chains, budget)
    }

    /// The offset by the capsules of the boundary.
    pub(super) fn by_capsules(
        &self,
        side: Side,
        distance_mm: f64,
        budget: &Budget,
    ) -> Result<Self, RegionError> {
        let elements = || self.outlines().flat_map(super::Outline::elements);
        if side == Side::Right {
            let rim = Self::of_capsules(elements(), distance_mm, budget)?;
            Self::union(&[self, &rim], budget)
        } else {
            let rim = Self::of_capsules(elements(), distance_mm + BIAS_MM, budget)?;
            self.difference(&rim, budget)
        }
    }

    /// The union of the capsules of elements.
    pub(super) fn of_capsules<'a>(
        elements: impl Iterator<Item = &'a Segment>,
        radius_mm: f64,
        budget: &Budget,
    ) -> Result<Self, RegionError> {
        let mut loops = Vec::new();
        for element in elements {
            append_capsules(element, radius_mm, &mut loops);
        }
        let mut regions = Vec::with_capacity(loops.len() / GROUP + 1);
        for group in loops.chunks(GROUP) {
            let loops = group.iter().map(|elements| Loop { group: 0, elements }).collect();
            regions.push(Self::of(loops, |[winding, _]| winding > 0, budget)?);
        }
        while regions.len() > 1 {
            let joined =
                regions.chunks(GROUP).map(|group| Self::union(&group.iter().collect::<Vec<_>>(), budget));
            regions = joined.collect::<Result<_, _>>()?;
        }
        Ok(regions.pop().unwrap_or_else(Self::empty))
    }
}

/// Refuses distances that are not above zero.
fn is_distance(distance_mm: f64) -> Result<(), RegionError> {
    // Written so that NaN is refused.
    if distance_mm > 0.0 && distance_mm.is_finite() {
        Ok(())
    } else {
        Err(RegionError::Distance { distance_mm })
    }
}

/// Appends closed loops about all places within the radius of an element. Each turns at least once, and never
/// backward, about each of these places: an arc is divided so that the inner side of a part is a single arc.
fn append_capsules(element: &Segment, radius: f64, loops: &mut Vec<Vec<Segment>>) {
    if element.length() <= POINT_MM {
        let [a, b] = [-radius, radius].map(|x| element.start() + Vector2::x() * x);
        loops.push(vec![Segment::turning(a, b, PI), Segment::turning(b, a, PI)]);
        return;
    }
    let count = (element.turn().abs() / FRAC_PI_2).ceil().max(1.0);
    for k in 0..count as usize {
        let part = element.part(k as f64 / count, (k + 1) as f64 / count);
        loops.push(capsule(&part, radius));
    }
}

/// The loop about an element: along its right side, about its end, back along its left side, about its start.
fn capsule(element: &Segment, radius: f64) -> Vec<Segment> {
    let [out, back] = [0.0, 1.0].map(|t| left(element.direction(t)) * radius);
    let (start, end): (Point2<f64>, Point2<f64>) = (element.start(), element.end());
    let turn = element.turn();
    let ends = [start - out, end - back, end + back, start + out];
    let sides = [turn, PI, -turn, PI];
    (0..4)
        .map(|k| Segment::turning(ends[k], ends[(k + 1) % 4], sides[k]))
        .filter(|side| side.start() != side.end())
        .collect()
}
