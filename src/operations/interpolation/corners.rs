//! Joints at the corners of a curve, where that takes no more elements.

use super::fit::{Fitted, Fitter};
use crate::geometry::plane_curve::PlaneCurve;

/// A tangent that jumps by more than this makes a corner, as a sine.
const CORNER_SINE: f64 = 1e-3;

/// Moves a joint to each corner that an element cuts off, where both elements at the joint then stay within the band.
pub fn keep_corners(fitter: &Fitter<impl PlaneCurve>, elements: &mut [Fitted]) {
    for corner in fitter.curve.breaks().iter().copied() {
        if !fitter.has_corner(corner) {
            continue;
        }
        let k = elements.partition_point(|element| element.range[1] < corner);
        let Some([from, to]) = elements.get(k).map(|element| element.range) else { continue };
        if from == corner || to == corner {
            continue;
        }
        let before = k.checked_sub(1).map(|j| (j, [elements[j].range[0], corner], [corner, to]));
        let after = elements.get(k + 1).map(|next| (k, [from, corner], [corner, next.range[1]]));
        for (j, first, second) in before.into_iter().chain(after) {
            if let (Some(first), Some(second)) = (fitter.fit(first), fitter.fit(second)) {
                (elements[j], elements[j + 1]) = (first, second);
                break;
            }
        }
    }
}

impl<C: PlaneCurve> Fitter<'_, C> {
    fn has_corner(&self, at: f64) -> bool {
        let (before, after) = (self.curve.derivative(at.next_down()), self.curve.derivative(at));
        before.dot(&after) <= 0.0 || before.perp(&after).abs() > CORNER_SINE * before.norm() * after.norm()
    }
}
