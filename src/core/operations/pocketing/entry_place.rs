//! The place at which the caller wants the cutter to come down first.

use nalgebra::Point2;

use super::entry::Entry;
use super::job::EntryLimits;
use super::level::Shape;
use super::router::Run;
use super::{PocketError, Warning};
use crate::geometry::region::{Containment, Region};

/// How near the edge of a region the place may be, mm: above the rounding of offsets.
const BESIDE_MM: f64 = 2e-6;

/// An entry that is nearer to the place is at the place, mm: mirroring and rounding move it by less.
const SAME_MM: f64 = 1e-6;

/// Refuses a place that is outside on all levels, or that has no room for an entry on any.
///
/// # Errors
/// When the place is outside on all levels, or has room for a helix on none and the cutter may not go
/// straight down.
pub fn check<'a>(
    limits: &EntryLimits,
    shapes: impl IntoIterator<Item = &'a Shape> + Clone,
) -> Result<(), PocketError> {
    let Some(at) = limits.at else { return Ok(()) };
    let rooms = || shapes.clone().into_iter().map(|shape| &shape.room.safe).filter(|safe| !safe.is_empty());
    let is_inside = |safe: &&Region| safe.place(at, BESIDE_MM) != Containment::Outside;
    let distance = |safe: &Region| safe.distance_to_boundary(at);
    let Some(room_mm) = rooms().filter(is_inside).map(distance).reduce(f64::max) else {
        return match rooms().map(distance).reduce(f64::min) {
            Some(by_mm) => Err(PocketError::EntryOutside { at, by_mm }),
            None => Ok(()),
        };
    };
    let (room_mm, least_mm) = (2.0 * room_mm, limits.min_diameter_mm);
    if room_mm < least_mm && !limits.is_predrilled && !limits.plunge {
        return Err(PocketError::EntryTooNarrow { at, room_mm, least_mm });
    }
    Ok(())
}

/// Whether a route comes down at the place, if there is one.
pub fn is_kept(limits: &EntryLimits, runs: &[Run]) -> bool {
    limits.at.is_none_or(|at| runs.iter().any(|run| is_at(run, at)))
}

fn is_at(run: &Run, at: Point2<f64>) -> bool {
    let place = match &run.entry {
        Entry::Helix { center, .. } => *center,
        Entry::Plunge => run.start,
        Entry::Open | Entry::Ramp { .. } => return false,
    };
    (place - at).norm() <= SAME_MM
}

/// On how many levels the cutter comes down, and on how many of them elsewhere.
#[derive(Debug, Default)]
pub struct Entries {
    n_levels: usize,
    n_elsewhere: usize,
    /// The height of the first level on which the cutter comes down elsewhere, mm.
    first_z_mm: Option<f64>,
}

impl Entries {
    /// Counts the level at `z_mm`, if the limits have a place.
    pub fn add(&mut self, limits: &EntryLimits, runs: &[Run], z_mm: f64) {
        if limits.at.is_none() {
            return;
        }
        self.n_levels += 1;
        if !is_kept(limits, runs) {
            self.n_elsewhere += 1;
            self.first_z_mm.get_or_insert(z_mm);
        }
    }

    pub fn warning(&self) -> Option<Warning> {
        let z_mm = self.first_z_mm?;
        Some(Warning::EntryElsewhere { count: self.n_elsewhere, of: self.n_levels, z_mm })
    }
}
