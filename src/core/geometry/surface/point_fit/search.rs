//! The smoothest spline within a stated error: the net and the weight of the energy.
//!
//! # Method
//! Nets are tried from coarse to fine; each has twice as many cells in each direction as the one before. On
//! the first net whose closest fit has no larger error than stated, the weight is raised as far as the error
//! permits: by the rule of false position in the logarithms of weight and error, with the Illinois change.

use super::Error;
use super::net::{Net, WIDTH};
use super::system::{Sample, Solution, System};
use crate::budget::{Budget, Stopped};

/// Cells along the longer side of the coarsest net.
const COARSEST: usize = 4;

/// The most control points. One factorization for so many takes a third of a second.
pub const MOST_CONTROL_POINTS: usize = 10_000;

/// The weight of the closest fit, as a part of the weight that balances energy and heights. A smaller one
/// would leave the surface in gaps between points to rounding.
const CLOSEST: f64 = 1e-7;

/// The closest fit gets a weight this many times larger where rounding leaves no positive pivot.
const RAISE: f64 = 100.0;
const MOST_RAISES: usize = 4;

/// The largest weight. In the unit frame it makes the surface a plane but for a thousandth of the heights.
const STIFFEST: f64 = 100.0;

/// The error comes at least this near to the stated one.
const NEAR: f64 = 0.98;

/// The most weights on the last net.
const MOST_WEIGHTS: usize = 14;

/// A spline on a net.
pub struct Spline {
    pub net: Net,
    /// Heights of control points, `[i][j]`, i along u.
    pub control: Vec<Vec<f64>>,
}

/// How the search ended.
pub enum Found {
    Spline(Spline),
    /// The closest fit on the finest net: its error, and the sample that is farthest off.
    TooFar {
        error: f64,
        worst: usize,
    },
}

impl Error {
    /// The error of a surface with these residuals.
    pub fn of(self, residuals: &[f64]) -> f64 {
        match self {
            Self::Max(_) => residuals.iter().fold(0.0, |most, r| r.abs().max(most)),
            Self::Rms(_) => (residuals.iter().map(|r| r * r).sum::<f64>() / residuals.len() as f64).sqrt(),
        }
    }

    /// The stated bound.
    pub fn bound(self) -> f64 {
        let (Self::Max(bound) | Self::Rms(bound)) = self;
        bound
    }
}

/// The smoothest spline over the unit frame, with sides `lengths` of which the longer is 1, whose error at
/// the samples is within the bound.
///
/// # Errors
/// Only the budget's stop.
pub fn smoothest(
    samples: &[Sample],
    lengths: [f64; 2],
    error: Error,
    budget: &Budget,
) -> Result<Found, Stopped> {
    let nets = nets(lengths);
    let mut closest = (f64::INFINITY, 0);
    for (k, net) in nets.iter().enumerate() {
        budget.progress("fit", k, nets.len());
        let steps = [0, 1].map(|k| lengths[k] / net.cells[k] as f64);
        let system = System::new(*net, steps, samples);
        let Some((weight, solution)) = closest_fit(&system, budget)? else { continue };
        let reached = error.of(&solution.residuals);
        if reached <= error.bound() {
            let first = Tried { weight, error: reached, solution };
            let best = raised(&system, first, error, budget)?;
            return Ok(Found::Spline(Spline { net: *net, control: system.control_points(&best) }));
        }
        if reached < closest.0 {
            closest = (reached, worst(&solution.residuals));
        }
    }
    Ok(Found::TooFar { error: closest.0, worst: closest.1 })
}

/// The nets from coarse to fine. The last one has as many cells as the limit permits.
fn nets(lengths: [f64; 2]) -> Vec<Net> {
    let of =
        |cells: usize| Net { cells: lengths.map(|length| ((length * cells as f64).round() as usize).max(1)) };
    let is_small = |net: &Net| net.n_control_points() <= MOST_CONTROL_POINTS;
    let mut nets: Vec<Net> = (0..).map(|k| of(COARSEST << k)).take_while(is_small).collect();
    let last = COARSEST << (nets.len() - 1);
    let finest = (last + 1..2 * last).rev().map(of).find(is_small);
    nets.extend(finest);
    nets
}

/// The fit with the least weight that rounding permits, and that weight.
fn closest_fit(system: &System, budget: &Budget) -> Result<Option<(f64, Solution)>, Stopped> {
    let mut weight = CLOSEST * system.balance();
    for _ in 0..=MOST_RAISES {
        if let Some(solution) = system.solve(weight, budget)? {
            return Ok(Some((weight, solution)));
        }
        weight *= RAISE;
    }
    Ok(None)
}

fn worst(residuals: &[f64]) -> usize {
    let by_size = |a: &usize, b: &usize| residuals[*a].abs().total_cmp(&residuals[*b].abs());
    (0..residuals.len()).max_by(by_size).unwrap_or(0)
}

struct Tried {
    weight: f64,
    error: f64,
    solution: Solution,
}

/// The solution with the largest weight found whose error is within the bound; `low` is within it.
fn raised(system: &System, low: Tried, error: Error, budget: &Budget) -> Result<Solution, Stopped> {
    let excess = |reached: f64| (reached / error.bound()).max(f64::MIN_POSITIVE).ln();
    let Some(stiffest) = system.solve(STIFFEST, budget)? else { return Ok(low.solution) };
    let reached = error.of(&stiffest.residuals);
    if reached <= error.bound() || low.weight >= STIFFEST {
        return Ok(stiffest);
    }
    let mut best = low;
    // The ends of the interval, each with its logarithm of the weight and its excess.
    let mut inside = [best.weight.ln(), excess(best.error)];
    let mut outside = [STIFFEST.ln(), excess(reached)];
    let mut last_was_inside = None;
    for round in 0..MOST_WEIGHTS {
        if best.error >= NEAR * error.bound() {
            break;
        }
        let share = if round < 2 { 0.5 } else { inside[1] / (inside[1] - outside[1]) };
        let weight = (inside[0] + share.clamp(0.02, 0.98) * (outside[0] - inside[0])).exp();
        let Some(solution) = system.solve(weight, budget)? else { break };
        let reached = error.of(&solution.residuals);
        let is_inside = reached <= error.bound();
        // The end that stays counts half, so that both ends move.
        if last_was_inside == Some(is_inside) {
            let other = if is_inside { &mut outside } else { &mut inside };
            other[1] *= 0.5;
        }
        last_was_inside = Some(is_inside);
        if is_inside {
            inside = [weight.ln(), excess(reached)];
            best = Tried { weight, error: reached, solution };
        } else {
            outside = [weight.ln(), excess(reached)];
        }
    }
    Ok(best.solution)
}

/// Knots beyond the domain at each end.
pub const KNOTS_BEYOND: usize = WIDTH - 1;
