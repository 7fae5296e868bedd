//! What a coarse robust spline leaves of heights, so that a quadratic polynomial follows the rest near each
//! point.
//!
//! # Method
//! A spline with a control point for every few points is fitted by least squares, and again with less weight
//! for heights that are far off (Cauchy's weights). It need not be near the points: it takes the waves of the
//! part away, and is smooth where heights are wrong.

use super::net::Net;
use super::system::{Sample, System};
use crate::budget::{Budget, Stopped};

/// Points for each control point.
const POINTS: usize = 10;

/// The most control points. A factorization for so many takes a tenth of a second.
const MOST_CONTROL_POINTS: usize = 2500;

/// The weight of the energy, as a part of the weight that balances energy and heights: enough for gaps.
const WEIGHT: f64 = 1e-4;

/// The least part of a height that the spline is taken to leave, against division by zero.
const LEAST_FREE: f64 = 0.1;

/// Rounds of least squares; later rounds change the weights little.
const ROUNDS: usize = 6;

/// Residuals of this many scales count half: the usual value, which loses about 5 per cent of the precision
/// for normal noise.
const CAUCHY: f64 = 2.385;

/// The standard deviation of normal noise in medians of its absolute values.
const BY_MEDIAN: f64 = 1.482_6;

/// The heights of the samples above the spline; `None` where there are too few points for one. Samples of
/// weight 0 do not count. The longer of `lengths` is 1. The noise counts as at least `least_noise`, mm.
///
/// # Errors
/// Only the budget's stop.
pub fn rest(
    samples: &[Sample],
    lengths: [f64; 2],
    least_noise: f64,
    budget: &Budget,
) -> Result<Option<Vec<f64>>, Stopped> {
    let is_counting: Vec<bool> = samples.iter().map(|sample| sample.weight > 0.0).collect();
    let n = is_counting.iter().filter(|counts| **counts).count();
    let Some(net) = net(n, lengths) else { return Ok(None) };
    let steps = [0, 1].map(|k| lengths[k] / net.cells[k] as f64);
    let mut samples = samples.to_vec();
    let mut rest = None;
    for _ in 0..ROUNDS {
        let system = System::new(net, steps, &samples);
        let weight = WEIGHT * system.balance();
        let Some((solution, leverages)) = system.solve_with_leverages(weight, budget)? else { break };
        let studentized = |(r, leverage): (&f64, &f64)| r / (1.0 - leverage).max(LEAST_FREE).sqrt();
        let residuals: Vec<f64> = solution.residuals.iter().zip(&leverages).map(studentized).collect();
        let kept = residuals.iter().zip(&is_counting).filter(|(_, counts)| **counts);
        let mut sizes: Vec<f64> = kept.map(|(r, _)| r.abs()).collect();
        let middle = sizes.len() / 2;
        let median = *sizes.select_nth_unstable_by(middle, f64::total_cmp).1;
        rest = Some(solution.residuals.iter().map(|r| -r).collect());
        let scale = CAUCHY * (BY_MEDIAN * median).max(least_noise);
        let counting = samples.iter_mut().zip(&residuals).zip(&is_counting).filter(|(_, counts)| **counts);
        for ((sample, residual), _) in counting {
            sample.weight = 1.0 / (1.0 + (residual / scale).powi(2));
        }
    }
    Ok(rest)
}

/// The finest net with few enough control points; `None` where a net of one cell has too many.
fn net(n: usize, lengths: [f64; 2]) -> Option<Net> {
    let most = (n / POINTS).min(MOST_CONTROL_POINTS);
    let of =
        |cells: usize| Net { cells: lengths.map(|length| ((length * cells as f64).round() as usize).max(1)) };
    let cells = (1..).take_while(|cells| of(*cells).n_control_points() <= most).last()?;
    Some(of(cells))
}
