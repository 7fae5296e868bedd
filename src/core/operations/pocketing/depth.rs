//! The deepest place of a region, and discs.

use nalgebra::{Point2, Vector2};

use super::PocketError;
use crate::budget::Budget;
use crate::geometry::region::{Outline, OutlineError, Region, RegionError};
use crate::geometry::segment::Segment;

/// How near the deepest place is found, as a part of the cutter's radius.
const DEPTH_ACCURACY: f64 = 5e-4;

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
