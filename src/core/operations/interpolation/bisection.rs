//! Hyun's adaptive interpolation: each element that leaves the band is divided in two, until all elements
//! stay within it.
//!
//! # Reference
//! C. H. Hyun, "The Tool Path Determination for Machining the Plane Curve by an Adaptive Mesh Generation
//! Technique", 1992, section 2, steps 1 to 4.

use super::Error;
use super::fit::{Fitted, Fitter};
use crate::budget::Budget;
use crate::geometry::plane_curve::PlaneCurve;

/// Elements between two reports of progress.
const ELEMENTS_BETWEEN_REPORTS: usize = 64;

/// Bisects `range` until every element stays within the band, and returns the elements in order.
///
/// # Errors
/// When the budget ends, there are too many elements or steps, or no element stays within the band however
/// short.
pub fn bisect(
    fitter: &Fitter<impl PlaneCurve>,
    range: [f64; 2],
    budget: &Budget,
) -> Result<Vec<Fitted>, Error> {
    let mut elements = Vec::new();
    let mut open = vec![range];
    let mut looked = 0usize;
    while let Some([from, to]) = open.pop() {
        if looked.is_multiple_of(ELEMENTS_BETWEEN_REPORTS) {
            budget.progress("interpolating", elements.len(), elements.len() + open.len() + 1);
        }
        looked += 1;
        fitter.meter.check()?;
        if let Some(fitted) = fitter.fit([from, to]) {
            if elements.len() >= fitter.element_limit {
                return Err(Error::TooManyElements { limit: fitter.element_limit });
            }
            elements.push(fitted);
            continue;
        }
        let middle = 0.5 * (from + to);
        if fitter.is_least([from, to]) || fitter.is_hopeless([from, to]) {
            return Err(Error::BandInfeasible { at: fitter.curve.point(middle) });
        }
        open.push([middle, to]);
        open.push([from, middle]);
    }
    Ok(elements)
}
