//! What a cutter cannot reach.
//!
//! # Method
//! At places of the surface the cutter is put where its lower side would touch with the tangent plane there. Where other places lift it
//! by then, its axis is moved about for as long as its lower side comes nearer to the place from above. What is left there is
//! no higher, along the normal, than the height that remains makes it.
//!
//! # Guarantees
//! None between the places: the figure is sampled. At them it is not too low.

use nalgebra::{Point3, Vector2};

use crate::budget::{Budget, Stopped};
use crate::geometry::contact::Contacts;
use crate::geometry::surface::Patch;

/// Places that are looked at.
const PLACES: usize = 1500;

/// What is less is reached, mm.
const REACHED_MM: f64 = 1e-6;

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

/// How high over a point of the surface the lower side of the cutter stays, mm, wherever it goes from an axis on; what is below
/// `enough` is not looked at closer.
fn left_over<P: Patch>(
    contacts: &Contacts<P>,
    point: &Point3<f64>,
    mut axis: Vector2<f64>,
    enough: f64,
    budget: &Budget,
) -> Result<f64, Stopped> {
    let radius = contacts.cutter().radius();
    let height_at = |axis: Vector2<f64>| -> Result<f64, Stopped> {
        let height = contacts.cutter().height((point.coords.xy() - axis).norm());
        match contacts.drop(axis, None, budget)? {
            Some(contact) if height.is_finite() => Ok(contact.tip.z + height - point.z),
            _ => Ok(f64::INFINITY),
        }
    };
    let mut left = height_at(axis)?;
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
