//! Searches for rest: material that the cutter cannot remove without cutting into the surface elsewhere.
//!
//! # Method
//! 1. Take about 1500 places of the surface.
//! 2. For each place, put the axis where the lower side of the cutter touches the surface at this place, and
//!    drop the cutter. If it comes to rest higher, because the surface is in the way elsewhere, try other
//!    positions of the axis. Keep the position at which the lower side lies least above the place.
//! 3. For each place, the rest is the height of this lower side above the place, times the z coordinate of
//!    the unit normal.
//!
//! # Guarantees
//! At a sampled place, the computed rest is at most 1e-4 mm below the true one. It may be above the true one,
//! because the search may miss the best position of the axis. Nothing is known between the sampled places.

use nalgebra::{Point3, Vector2};

use crate::budget::{Budget, Stopped};
use crate::geometry::surface::Patch;
use crate::machining::drop_cutter::Contacts;

/// About how many places of the surface are sampled.
const PLACES: usize = 1500;

/// A place with less rest than this counts as reached, mm.
const REACHED_MM: f64 = 1e-6;

/// Directions and distances, in radii of the cutter, in which the axis is tried around a place.
const DIRECTIONS: usize = 8;
const DISTANCES: [f64; 2] = [0.5, 0.999];

/// The number of best axes from which the axis is moved on.
const STARTS: usize = 4;

/// The first and the last step by which the axis is moved, in radii of the cutter, and the most steps.
const FIRST_MOVE: f64 = 0.5;
const LAST_MOVE: f64 = 1e-3;
const MOVES: usize = 60;

/// The thickest rest found.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rest {
    pub(super) height_mm: f64,
    /// The surface point with that rest; `None` without rest.
    pub(super) at: Option<Point3<f64>>,
}

/// The accuracy of a tip, mm.
const TIP_ACCURACY_MM: f64 = 1e-4;

/// The thickest rest at the sampled places.
pub(super) fn largest<P: Patch>(contacts: &Contacts<P>, budget: &Budget) -> Result<Rest, Stopped> {
    let mut largest = Rest { height_mm: 0.0, at: None };
    for place in contacts.places(PLACES) {
        let Some((tip, normal, at)) = contacts.touching(place) else { continue };
        let enough = largest.height_mm.max(REACHED_MM) / normal.z;
        let left_mm = left_over(contacts, &at, tip.xy().coords, enough, budget)?;
        if left_mm > enough {
            largest = Rest { height_mm: left_mm * normal.z, at: Some(at) };
        }
    }
    Ok(largest)
}

/// The least height of the cutter's lower side over a point of the surface that the search finds, mm. The
/// first axis tried is `axis`. The search ends early at a height of at most `enough` mm.
fn left_over<P: Patch>(
    contacts: &Contacts<P>,
    point: &Point3<f64>,
    axis: Vector2<f64>,
    enough: f64,
    budget: &Budget,
) -> Result<f64, Stopped> {
    let radius = contacts.cutter().radius();
    let height_at = |axis: Vector2<f64>| -> Result<f64, Stopped> {
        let height = contacts.cutter().height((point.coords.xy() - axis).norm());
        match contacts.drop_within(TIP_ACCURACY_MM, axis, None, budget)? {
            Some(contact) if height.is_finite() => Ok(contact.tip.z + height - point.z),
            _ => Ok(f64::INFINITY),
        }
    };
    let left = height_at(axis)?;
    if left <= enough {
        return Ok(left);
    }
    let mut starts = vec![(axis, left)];
    for k in 0..DIRECTIONS {
        let angle = k as f64 * std::f64::consts::TAU / DIRECTIONS as f64;
        for share in DISTANCES {
            let axis = point.coords.xy() + Vector2::new(angle.cos(), angle.sin()) * (share * radius);
            let left = height_at(axis)?;
            if left <= enough {
                return Ok(left);
            }
            starts.push((axis, left));
        }
    }
    starts.sort_by(|(_, a), (_, b)| a.total_cmp(b));
    let mut least = f64::INFINITY;
    for start in starts.into_iter().take(STARTS) {
        least = least.min(moved_about(start, radius, enough, &height_at)?);
        if least <= enough {
            break;
        }
    }
    Ok(least)
}

/// The least height, mm, that is found by moving the axis to better places.
fn moved_about(
    (mut axis, mut left): (Vector2<f64>, f64),
    radius: f64,
    enough: f64,
    height_at: &impl Fn(Vector2<f64>) -> Result<f64, Stopped>,
) -> Result<f64, Stopped> {
    let mut by = FIRST_MOVE * radius;
    for _ in 0..MOVES {
        if left <= enough || by < LAST_MOVE * radius {
            break;
        }
        let mut is_nearer = false;
        for way in [Vector2::x(), Vector2::y(), -Vector2::x(), -Vector2::y()] {
            let next = axis + way * by;
            let there = height_at(next)?;
            if there < left {
                (axis, left, is_nearer) = (next, there, true);
                break;
            }
        }
        by *= if is_nearer { 1.0 } else { 0.5 };
    }
    Ok(left)
}
