//! Where the rectangle of a fitted surface has no points near: there the surface is an extrapolation.

use super::frame::Frame;
use super::neighbours::Cells;
use crate::budget::{Budget, Stopped};

/// A place is covered where a point is within this many usual spacings of points.
const REACH: f64 = 4.0;

/// Places along the longer side at which the distance to the nearest point is measured.
const PLACES: f64 = 100.0;

/// The part of a surface without points near.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extrapolated {
    /// The part of the rectangle's area, from 0 to 1.
    pub share: f64,
    /// The place that is farthest from all points, x and y, and its distance to the nearest point; mm.
    pub at: [f64; 2],
    pub distance_mm: f64,
}

/// The part of the frame without points near; `None` where points are everywhere.
///
/// # Errors
/// Only the budget's stop.
pub fn extrapolated(
    cells: &Cells,
    frame: &Frame,
    n_points: usize,
    budget: &Budget,
) -> Result<Option<Extrapolated>, Stopped> {
    let reach = REACH * (frame.hull_area / n_points as f64).sqrt();
    let step = frame.lengths[0].max(frame.lengths[1]) / PLACES;
    let counts = frame.lengths.map(|length| (length / step).round().max(1.0));
    let (mut n_far, mut farthest) = (0.0, (0.0, [0.0; 2]));
    for i in 0..counts[0] as usize {
        budget.check()?;
        for j in 0..counts[1] as usize {
            let place = [0, 1].map(|k| ([i, j][k] as f64 + 0.5) / counts[k] * frame.lengths[k]);
            let distance = cells.nearest(&place);
            n_far += f64::from(u8::from(distance > reach));
            if distance > farthest.0 {
                farthest = (distance, place);
            }
        }
    }
    let (distance_mm, place) = farthest;
    let at = frame.point(place);
    let share = n_far / (counts[0] * counts[1]);
    Ok((n_far > 0.0).then_some(Extrapolated { share, at: [at.x, at.y], distance_mm }))
}
