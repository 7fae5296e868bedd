//! What a cutter cannot reach.
//!
//! # Method
//! At places of the surface the cutter is put where its lower side would touch with the tangent plane there. If other places lift it
//! by then, what is left there is no higher, along the normal, than that lift makes it.
//!
//! # Guarantees
//! None between the places: the figure is sampled.

use nalgebra::Point3;

use crate::budget::{Budget, Stopped};
use crate::geometry::contact::Contacts;
use crate::geometry::surface::Patch;

/// Places that are looked at.
const PLACES: usize = 1500;

/// What is less is reached, mm.
const REACHED_MM: f64 = 1e-6;

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
        let Some(contact) = contacts.drop(tip.coords.xy(), Some(place), budget)? else { continue };
        let height_mm = (contact.tip.z - tip.z) * normal.z;
        if height_mm > largest.height_mm.max(REACHED_MM) {
            largest = Rest { height_mm, at: Some(at) };
        }
    }
    Ok(largest)
}
