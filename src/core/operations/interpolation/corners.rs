//! Moves joints to the corners of a curve, where the number of elements stays the same.

use super::fit::{Fitted, Fitter};
use crate::budget::{Budget, Stopped};
use crate::geometry::plane_curve::PlaneCurve;

/// A jump of the tangent by more than this sine makes a corner.
const CORNER_SINE: f64 = 1e-3;

/// Bisection steps to a corner: as many as lead from any length to neighbouring numbers.
const CORNER_STEPS: usize = 64;

/// The most corners that get a joint. A polyline with more points is no contour with corners, and its joints
/// stay where they are.
const MOST_CORNERS: usize = 10_000;

impl<C: PlaneCurve> Fitter<'_, C> {
    /// A corner of the curve between two parameters; `None` if none is found. A graph has no breaks: there
    /// the corner is sought where the tangent turns most.
    pub fn corner(&self, [mut low, mut high]: [f64; 2]) -> Option<f64> {
        if !self.curve.is_graph() {
            return self.corners([low, high]).last();
        }
        let direction = |t: f64| self.curve.derivative(t).normalize();
        let (mut at_low, mut at_high) = (direction(low), direction(high));
        for _ in 0..CORNER_STEPS {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high || (at_high - at_low).norm() <= CORNER_SINE {
                break;
            }
            let at_middle = direction(middle);
            if (at_middle - at_low).norm() >= (at_high - at_middle).norm() {
                (high, at_high) = (middle, at_middle);
            } else {
                (low, at_low) = (middle, at_middle);
            }
        }
        self.curve.has_corner(high, CORNER_SINE).then_some(high)
    }

    /// The corners of the curve between two parameters, the last one first.
    pub fn corners(&self, [from, to]: [f64; 2]) -> impl Iterator<Item = f64> + use<'_, C> {
        let breaks = self.curve.breaks();
        let (first, last) = (breaks.partition_point(|t| *t <= from), breaks.partition_point(|t| *t < to));
        let inside = &breaks[first..last.max(first)];
        inside.iter().rev().copied().filter(|t| self.curve.has_corner(*t, CORNER_SINE))
    }
}

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
