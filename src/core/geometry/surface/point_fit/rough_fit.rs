//! What a coarse robust spline leaves of heights, so that a quadratic polynomial follows the rest near each
//! point.
//!
//! # Method
//! A spline with a control point for every few points is fitted by least squares, and again with less weight
//! for heights that are far off (Huber's weights). It need not be near the points: it takes the waves of the
//! part away, and is smooth where heights are wrong.

use super::net::Net;
use super::system::{Sample, System};
use crate::budget::{Budget, Stopped};

/// Points for each control point.
const POINTS: usize = 8;

/// The most control points. A factorization for so many takes a tenth of a second.
const MOST_CONTROL_POINTS: usize = 4000;

/// The weight of the energy, as a part of the weight that balances energy and heights: enough for gaps.
const WEIGHT: f64 = 1e-4;

/// Rounds of least squares; later rounds change the weights little.
const ROUNDS: usize = 4;

/// Residuals beyond this many scales count less.
const HUBER: f64 = 1.345;

/// The standard deviation of normal noise in medians of its absolute values.
const BY_MEDIAN: f64 = 1.482_6;

/// The heights of the samples above the spline; `None` where there are too few points for one. The longer of
/// `lengths` is 1.
///
/// # Errors
/// Only the budget's stop.
pub fn rest(samples: &[Sample], lengths: [f64; 2], budget: &Budget) -> Result<Option<Vec<f64>>, Stopped> {
    let Some(net) = net(samples.len(), lengths) else { return Ok(None) };
    let steps = [0, 1].map(|k| lengths[k] / net.cells[k] as f64);
    let mut samples = samples.to_vec();
    let mut rest = None;
    for _ in 0..ROUNDS {
        let system = System::new(net, steps, &samples);
        let Some(solution) = system.solve(WEIGHT * system.balance(), budget)? else { break };
        let mut sizes: Vec<f64> = solution.residuals.iter().map(|r| r.abs()).collect();
        let middle = sizes.len() / 2;
        let scale = BY_MEDIAN * *sizes.select_nth_unstable_by(middle, f64::total_cmp).1;
        for (sample, residual) in samples.iter_mut().zip(&solution.residuals) {
            let size = residual.abs();
            sample.weight = if size > HUBER * scale { HUBER * scale / size } else { 1.0 };
        }
        rest = Some(solution.residuals.iter().map(|r| -r).collect());
        if scale <= 0.0 {
            break;
        }
    }
    Ok(rest)
}

/// The finest net with few enough control points; `None` where a net of one cell has too many.
fn net(n: usize, lengths: [f64; 2]) -> Option<Net> {
    let most = (n / POINTS).min(MOST_CONTROL_POINTS);
    let of = |cells: usize| Net {
        cells: lengths.map(|length| ((length * cells as f64).round() as usize).max(1)),
    };
    let cells = (1..).take_while(|cells| of(*cells).n_control_points() <= most).last()?;
    Some(of(cells))
}
