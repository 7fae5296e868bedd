//! Moves joints to the corners of a curve, where the number of elements stays the same.

use super::fit::{Fitted, Fitter};
use crate::budget::{Budget, Stopped};
use crate::geometry::plane_curve::PlaneCurve;

/// A jump of the tangent by more than this sine makes a corner.
const CORNER_SINE: f64 = 1e-3;

/// The most corners that get a joint. A polyline with more points is no contour with corners, and its joints
/// stay where they are.
const MOST_CORNERS: usize = 10_000;

/// Moves a joint to each corner that an element cuts off, where both elements at the joint then stay within
/// the band.
///
/// # Errors
/// When the budget ends.
pub fn keep_corners(
    fitter: &Fitter<impl PlaneCurve>,
    elements: &mut [Fitted],
    budget: &Budget,
) -> Result<(), Stopped> {
    let is_corner = |t: &f64| fitter.curve.has_corner(*t, CORNER_SINE);
    let corners: Vec<f64> = fitter.curve.breaks().iter().copied().filter(is_corner).collect();
    if corners.len() > MOST_CORNERS {
        return Ok(());
    }
    for corner in corners.iter().copied() {
        budget.check()?;
        let k = elements.partition_point(|element| element.range[1] < corner);
        let Some([from, to]) = elements.get(k).map(|element| element.range) else { continue };
        if from == corner || to == corner {
            continue;
        }
        // A joint on a corner stays there.
        let is_free = |t: f64| corners.binary_search_by(|c| c.total_cmp(&t)).is_err();
        let before = k
            .checked_sub(1)
            .filter(|_| is_free(from))
            .map(|j| (j, [elements[j].range[0], corner], [corner, to]));
        let after = elements
            .get(k + 1)
            .filter(|_| is_free(to))
            .map(|next| (k, [from, corner], [corner, next.range[1]]));
        for (j, first, second) in before.into_iter().chain(after) {
            if let (Some(first), Some(second)) = (fitter.fit(first), fitter.fit(second)) {
                (elements[j], elements[j + 1]) = (first, second);
                break;
            }
        }
    }
    Ok(())
}
