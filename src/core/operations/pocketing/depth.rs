//! The deepest place of a region, and discs.

use nalgebra::{Point2, Vector2};

use super::PocketError;
use crate::budget::Budget;
use crate::geometry::region::{Containment, Outline, OutlineError, Region, RegionError};
use crate::geometry::segment::Segment;

/// How near the deepest place is found, as a part of the cutter's radius.
const DEPTH_ACCURACY: f64 = 5e-4;

/// How near the radius of the largest disc is found, mm.
const RADIUS_ACCURACY_MM: f64 = 1e-7;

/// By how much a diameter that is shown may exceed the largest, mm: less than the slack of centres allows.
const ROUNDED_MM: f64 = 1e-5;

/// Steps in which diameters are shown, of each mm.
const SHOWN_A_MM: f64 = 1e3;

/// A place that is nearly as far from the boundary as any.
pub fn deepest(region: &Region, radius_mm: f64, budget: &Budget) -> Result<Point2<f64>, PocketError> {
    let mut inner = region.clone();
    let mut step = radius_mm;
    let least = DEPTH_ACCURACY * radius_mm;
    while step > least {
        let next = inner.offset_inward(step, budget)?;
        if next.is_empty() {
            step *= 0.5;
        } else {
            inner = next;
        }
    }
    let largest = inner.faces().iter().max_by(|a, b| a.outer.area().total_cmp(&b.outer.area()));
    let place = largest.map_or_else(Point2::origin, |face| face.outer.elements()[0].start());
    Ok(place)
}

/// The diameter of the largest disc in a region, mm, and its centre. The diameter is rounded down to the
/// three decimals that are shown; a shortfall of `ROUNDED_MM` is rounding of the outlines.
pub fn largest_disc(
    region: &Region,
    radius_mm: f64,
    budget: &Budget,
) -> Result<(f64, Point2<f64>), PocketError> {
    let mut at = deepest(region, radius_mm, budget)?;
    let mut low = region.distance_to_boundary(at);
    let mut high = low + 2.0 * DEPTH_ACCURACY * radius_mm;
    while high - low > RADIUS_ACCURACY_MM {
        let middle = 0.5 * (low + high);
        let inner = region.offset_inward(middle, budget)?;
        match inner.faces().first() {
            Some(face) => (low, at) = (middle, face.outer.elements()[0].start()),
            None => high = middle,
        }
    }
    Ok((((2.0 * low + ROUNDED_MM) * SHOWN_A_MM).floor() / SHOWN_A_MM, at))
}

/// The faces of a region of centres whose outer outline is at least this long, mm: in shorter ones the cutter
/// has no way to go. The face with the place `kept` stays too. All of them, if none is.
pub fn with_room(centers: Region, length_mm: f64, kept: Option<Point2<f64>>) -> Region {
    let length = |face: &Region| -> f64 {
        face.faces().iter().flat_map(|face| face.outer.elements()).map(Segment::length).sum()
    };
    let is_kept = |part: &Region| kept.is_some_and(|kept| part.place(kept, 0.0) != Containment::Outside);
    let is_roomy = |part: &Region| length(part) >= length_mm || is_kept(part);
    let roomy: Vec<Region> = centers.parts().into_iter().filter(is_roomy).collect();
    if roomy.is_empty() || roomy.len() == centers.faces().len() { centers } else { Region::of_parts(&roomy) }
}

/// A disc as a region.
pub fn disc(center: Point2<f64>, radius: f64, budget: &Budget) -> Result<Region, PocketError> {
    let [a, b] = [center - Vector2::x() * radius, center + Vector2::x() * radius];
    let half = |start, end| Segment::about(center, radius, [start, end], std::f64::consts::PI);
    let outline = Outline::new(&[half(a, b), half(b, a)], budget).map_err(|error| match error {
        OutlineError::Stopped(stopped) => RegionError::Stopped(stopped),
        _ => RegionError::Tangled { at: center },
    })?;
    Ok(Region::new(&[outline], &[], budget)?)
}
