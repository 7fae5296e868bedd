//! The connected parts of the region of centres, with the room that each has for an entry.

use nalgebra::Point2;

use super::super::PocketError;
use super::super::depth::deepest;
use super::{BESIDE_MM, Router};
use crate::geometry::region::{Containment, Region};

/// A connected part of the region of centres.
#[derive(Debug)]
pub struct Place {
    pub region: Region,
    /// The place that is farthest from the edge, and how far it is, mm; known once it was needed.
    deepest: Option<(Point2<f64>, f64)>,
    /// Whether the cutter has no way to come down in it.
    is_left_out: bool,
    /// Whether the place that the caller chose has been tried.
    pub is_entered: bool,
}

impl Router<'_> {
    /// The parts in which the cutter cannot come down. What only they reach is not cut.
    pub fn left_out(&self) -> impl Iterator<Item = &Region> {
        self.parts.iter().flatten().filter(|part| part.is_left_out).map(|part| &part.region)
    }

    /// Whether a place lies in a part in which the cutter cannot come down.
    pub(super) fn is_left_out(&mut self, p: Point2<f64>) -> Result<bool, PocketError> {
        if self.left_out().next().is_none() {
            return Ok(false);
        }
        let k = self.part_of(p);
        Ok(self.parts()[k].is_left_out)
    }

    pub(super) fn parts(&mut self) -> &mut Vec<Place> {
        let centers = self.centers;
        let place = |region| Place { region, deepest: None, is_left_out: false, is_entered: false };
        self.parts.get_or_insert_with(|| centers.parts().into_iter().map(place).collect())
    }

    /// The index of the part in which a place lies, or of the nearest.
    pub(super) fn part_of(&mut self, p: Point2<f64>) -> usize {
        let parts = self.parts();
        let is_in = |part: &Place| part.region.place(p, BESIDE_MM) != Containment::Outside;
        if let Some(k) = parts.iter().position(is_in) {
            return k;
        }
        let distance = |k: usize| parts[k].region.distance_to_boundary(p);
        (0..parts.len()).min_by(|a, b| distance(*a).total_cmp(&distance(*b))).unwrap_or(0)
    }

    /// The place of a part that is farthest from its edge, and how far it is, mm.
    pub(super) fn deepest(&mut self, k: usize) -> Result<(Point2<f64>, f64), PocketError> {
        if let Some(known) = self.parts()[k].deepest {
            return Ok(known);
        }
        let (radius, budget) = (self.conditions.radius_mm, self.budget);
        let part = &mut self.parts()[k];
        let place = deepest(&part.region, radius, budget)?;
        let found = (place, part.region.distance_to_boundary(place));
        part.deepest = Some(found);
        Ok(found)
    }

    /// Leaves a part out. The error where nothing is left: the cutter cannot come down in any part. It has
    /// the largest tool that can come down near `at`.
    pub(super) fn leave_out(&mut self, k: usize, at: Point2<f64>) -> Result<(), PocketError> {
        self.parts()[k].is_left_out = true;
        if !self.runs.is_empty() || self.parts().iter().any(|part| !part.is_left_out) {
            return Ok(());
        }
        let (_, room) = self.deepest(k)?;
        let least_mm = self.conditions.entry.min_diameter_mm;
        let largest_mm = (2.0 * (self.conditions.radius_mm + room) - least_mm).max(0.0);
        Err(PocketError::NoEntry { at, least_mm, largest_mm })
    }
}
