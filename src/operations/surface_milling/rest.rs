//! What a cutter cannot reach.
//!
//! # Method
//! At places of the surface the cutter is put where its lower side would touch with the tangent plane there.
//! Where other places lift it by then, its axis is put around the place, nearer and farther, and moved about
//! from the best of these, for as long as its lower side comes nearer to the place from above. The stock left
//! at the place is the least height found times the z coordinate of the unit normal.
//!
//! # Guarantees
//! None between the places: the figure is sampled. At them it is too low by `TIP_ACCURACY_MM` at most.

use nalgebra::{Point3, Vector2};

use crate::budget::{Budget, Stopped};
use crate::geometry::surface::Patch;
use crate::machining::drop_cutter::Contacts;

/// Places that are looked at.
const PLACES: usize = 1500;

/// What is less is reached, mm.
const REACHED_MM: f64 = 1e-6;

/// The axis is tried in this many directions around a place, at these distances in radii of the cutter.
const DIRECTIONS: usize = 8;
const DISTANCES: [f64; 2] = [0.5, 0.999];

/// The search goes on from this many of the best axes tried.
const STARTS: usize = 4;

/// The first and the last distance by which the axis is moved about, in radii of the cutter.
const FIRST_MOVE: f64 = 0.5;
const LAST_MOVE: f64 = 1e-3;
const MOVES: usize = 60;

/// Material that is left.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rest {
    pub(super) height_mm: f64,
    /// Where, if it is anything.
    pub(super) at: Option<Point3<f64>>,
}

/// Tips are known to this, mm.
const TIP_ACCURACY_MM: f64 = 1e-4;

/// The most that is left at one of the places.
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

/// How high over a point of the surface the lower side of the cutter stays, mm, wherever it goes from an axis
/// on; what is below `enough` is not looked at closer.
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

/// The least of a height, mm, that is found by moving from an axis to a better one.
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
