//! Checks the weights of a rational curve: their number, their size, and the ratio of the largest to the
//! least.

use super::LARGEST;
use crate::geometry::bspline::MAX_WEIGHT_RATIO;

/// Why numbers are not valid weights.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum WeightError {
    #[error("there are {found} weights for {expected} control points; each control point needs one weight")]
    Count { found: usize, expected: usize },
    #[error("weight {weight} is outside the range from {} to {LARGEST:e}", 1.0 / LARGEST)]
    Range { index: usize, weight: f64 },
    #[error(
        "weight {weight} is more than {MAX_WEIGHT_RATIO} times smaller than the largest weight, {largest}"
    )]
    Ratio { index: usize, weight: f64, largest: f64 },
}

/// Checks the weights of a curve with this number of control points.
///
/// # Errors
/// The first fault that is found.
pub fn check_weights(weights: &[f64], control_points: usize) -> Result<(), WeightError> {
    if weights.len() != control_points {
        return Err(WeightError::Count { found: weights.len(), expected: control_points });
    }
    let largest = weights.iter().copied().fold(0.0, f64::max);
    for (index, &weight) in weights.iter().enumerate() {
        if !(1.0 / LARGEST..=LARGEST).contains(&weight) {
            return Err(WeightError::Range { index, weight });
        }
        if weight * MAX_WEIGHT_RATIO < largest {
            return Err(WeightError::Ratio { index, weight, largest });
        }
    }
    Ok(())
}
