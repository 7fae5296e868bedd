//! Minimises the time within the limits by a primal-dual interior-point method.
//!
//! # Method
//! 1. Give each limit c(m) >= 0 a multiplier. At the start each product of limit and multiplier is the same.
//! 2. Assemble the Newton equations for products equal to mu. The matrix has two diagonals beside the main
//!    one. Negative curvature of the limits is left out, so that the matrix is positive definite.
//! 3. Go as far along the solution as each limit keeps a part of its value. Lower mu after a long step; keep
//!    mu after a short step, which leads back from the limits.
//! 4. End when the sum of the products, which estimates the time still to gain, is small.
//!
//! # Guarantees
//! All limits hold at the nodes after each step, so that the search may end at any step.

use super::least_squares::LeastSquares;
use super::newton::{Local, Step};
use super::rows::{Rows, dot};
use crate::budget::{Budget, Stopped};

/// The most steps. A search takes 15 to 40, and more from a start that is very slow.
const STEPS: usize = 150;

/// The time that the search leaves, as a part of the whole. A smaller part costs a step for each factor of 3.
const GAP: f64 = 5e-4;

/// The most halvings of a step that passed a limit, which happens seldom.
const HALVINGS: usize = 30;

/// The part of the curvature of the time that counts in the equations. With all of it, a step cannot double
/// the squared speed, and the search takes twice as many steps. The result does not depend on it.
const CURVATURE: f64 = 0.3;

/// mu is this part of the mean product: first, and after a step of more than `LONG` and of more than `MIDDLE`
/// of the solution. After a shorter step mu is the mean product, which leads back from the limits.
const FIRST_PART: f64 = 0.3;
const LONG: f64 = 0.8;
const AFTER_LONG: f64 = 0.1;
const MIDDLE: f64 = 0.4;
const AFTER_MIDDLE: f64 = 0.2;

/// The unknowns, the multipliers and the space for one step.
struct Search<'a> {
    rows: &'a Rows,
    m: Vec<f64>,
    multipliers: Vec<f64>,
    changes: Vec<f64>,
    /// b and b' at the nodes, of m and of its change.
    states: Vec<[f64; 2]>,
    state_changes: Vec<[f64; 2]>,
    equations: LeastSquares,
    /// The steps down the gradients of the time and of the sum of the logarithms of the limits.
    steps: Vec<[f64; 2]>,
}

/// The fastest control values that the search finds from `m`, which is within the limits. `gap` estimates the
/// part of the time that may be gained.
///
/// # Errors
/// `Stopped` by the budget.
pub fn fastest(rows: &Rows, m: Vec<f64>, gap: f64, budget: &Budget) -> Result<Vec<f64>, Stopped> {
    let last = rows.lengths.len();
    let jerk = rows.jerk_axes + usize::from(rows.jerk_tip);
    let acceleration = rows.acceleration_axes + usize::from(rows.acceleration_tip);
    let size = (last - 2) * (2 * jerk + 2) + (last - 1) * (acceleration + 1);
    let mut search = Search {
        rows,
        m,
        multipliers: vec![0.0; size],
        changes: vec![0.0; size],
        states: Vec::new(),
        state_changes: Vec::new(),
        equations: LeastSquares::new(last),
        steps: vec![[0.0; 2]; last],
    };
    search.run(gap, budget)?;
    Ok(search.m)
}

impl Search<'_> {
    fn run(&mut self, gap: f64, budget: &Budget) -> Result<(), Stopped> {
        let count = self.multipliers.len() as f64;
        self.rows.states(&self.m, &mut self.states);
        // A step of length 0 with multipliers of 0 changes each to mu / c.
        let still = vec![0.0; self.m.len()];
        self.step(&still, gap * self.time() / count);
        std::mem::swap(&mut self.multipliers, &mut self.changes);
        let mut shrink = FIRST_PART;
        let (mut gap, _) = self.assemble();
        for _ in 0..STEPS {
            budget.check()?;
            // Not a number ends the search as well.
            if gap.is_nan() || gap <= GAP * self.time() || self.equations.solve(&mut self.steps).is_none() {
                break;
            }
            let mu = shrink * gap / count;
            // The sides of the equations are minus the gradients.
            let change: Vec<f64> = self.steps.iter().map(|[time, logs]| time - mu * logs).collect();
            let step = self.step(&change, mu);
            for (multiplier, change) in self.multipliers.iter_mut().zip(&self.changes) {
                *multiplier += step.dual * change;
            }
            let Some(next) = self.advance(&change, step.primal) else { break };
            gap = next;
            shrink = match step.primal.min(step.dual) {
                part if part > LONG => AFTER_LONG,
                part if part > MIDDLE => AFTER_MIDDLE,
                _ => 1.0,
            };
        }
        Ok(())
    }

    /// Goes `part` of the change, or less if a limit is passed there. Returns the gap; `None` if the search
    /// cannot move.
    fn advance(&mut self, change: &[f64], part: f64) -> Option<f64> {
        let from = self.m.clone();
        let mut part = part;
        for _ in 0..HALVINGS {
            for ((m, from), change) in self.m.iter_mut().zip(&from).zip(change) {
                *m = from + part * change;
            }
            self.rows.states(&self.m, &mut self.states);
            let (gap, least) = self.assemble();
            if least > 0.0 && gap.is_finite() {
                return Some(gap);
            }
            part *= 0.5;
        }
        self.m = from;
        None
    }

    /// The time but for the error of the trapezoidal rule.
    fn time(&self) -> f64 {
        (1..self.rows.lengths.len()).map(|j| self.rows.weight[j] / self.states[j][0].sqrt()).sum()
    }

    /// Assembles the Newton equations. Returns the sum of the products of limits and multipliers, and the
    /// smallest limit.
    fn assemble(&mut self) -> (f64, f64) {
        let rows = self.rows;
        let last = rows.lengths.len();
        self.equations.clear();
        let mut multipliers = self.multipliers.iter().copied();
        let (mut gap, mut least) = (0.0, f64::INFINITY);
        for k in 1..last - 1 {
            let h = rows.lengths[k];
            let second = (self.states[k + 1][1] - self.states[k][1]) / h;
            let (start, end) = (rows.maps[k][1], rows.maps[k + 1][1]);
            let curve = [-start[0] / h, (end[0] - start[1]) / h, end[1] / h];
            for end in 0..2 {
                let node = k + end;
                let [b, slope] = self.states[node];
                let y = [b, slope, second];
                let mut local = Local::new();
                let (axes, tip) = rows.jerk_at(k, end).split_at(rows.jerk_axes);
                for (p, l) in axes.iter().zip(&mut multipliers) {
                    local.limit([p], &y, b, 1.0, l);
                }
                if let ([p, q, r], true) = (tip, rows.jerk_tip) {
                    local.limit([p, q, r], &y, b, 1.0, multipliers.next().unwrap_or(0.0));
                }
                if end == 0 || k + 2 == last {
                    let (axes, tip) = rows.acceleration_at(node).split_at(rows.acceleration_axes);
                    let wide = |p: &[f64; 2]| [p[0], p[1], 0.0];
                    for (p, l) in axes.iter().zip(&mut multipliers) {
                        local.limit([&wide(p)], &y, 1.0, 0.0, l);
                    }
                    if let ([p, q, r], true) = (tip, rows.acceleration_tip) {
                        let l = multipliers.next().unwrap_or(0.0);
                        local.limit([&wide(p), &wide(q), &wide(r)], &y, 1.0, 0.0, l);
                    }
                    local.cap(b, rows.cap[node], multipliers.next().unwrap_or(0.0));
                    local.time(b, rows.weight[node], CURVATURE);
                }
                let [value, slope] = rows.maps[node];
                let map = if end == 0 {
                    [[value[0], slope[0], curve[0]], [value[1], slope[1], curve[1]], [0.0, 0.0, curve[2]]]
                } else {
                    [[0.0, 0.0, curve[0]], [value[0], slope[0], curve[1]], [value[1], slope[1], curve[2]]]
                };
                for ([b, slope, second], sides) in local.equations() {
                    let row = map.map(|own| own[0] * b + own[1] * slope + own[2] * second);
                    self.equations.add(k - 1, (row, sides));
                }
                gap += local.gap;
                least = local.least.min(least);
            }
            // The middle control value, below its cap and above 0.
            let m = self.m[k];
            let mut local = Local::new();
            local.cap(m, rows.middle_cap(k), multipliers.next().unwrap_or(0.0));
            let positive = multipliers.next().unwrap_or(0.0);
            local.positive(m, positive);
            let [.., ([by_m, ..], sides)] = local.equations();
            self.equations.add(k, ([by_m, 0.0, 0.0], sides));
            gap += local.gap;
            least = local.least.min(least);
        }
        (gap, least)
    }

    /// The length of the step along `change`, and the changes of the multipliers. The order of the limits is
    /// that of [`Search::assemble`].
    fn step(&mut self, change: &[f64], mu: f64) -> Step {
        let rows = self.rows;
        let last = rows.lengths.len();
        rows.states(change, &mut self.state_changes);
        let mut step = Step { primal: 1.0, dual: 1.0, mu };
        let mut multipliers = self.multipliers.iter().copied().zip(&mut self.changes);
        let mut next = |f: &mut dyn FnMut(f64) -> f64| {
            if let Some((l, dl)) = multipliers.next() {
                *dl = f(l);
            }
        };
        for k in 1..last - 1 {
            let h = rows.lengths[k];
            let second = |states: &[[f64; 2]]| (states[k + 1][1] - states[k][1]) / h;
            let (second, d_second) = (second(&self.states), second(&self.state_changes));
            for end in 0..2 {
                let node = k + end;
                let ([b, slope], [db, d_slope]) = (self.states[node], self.state_changes[node]);
                let (y, dy) = ([b, slope, second], [db, d_slope, d_second]);
                let (axes, tip) = rows.jerk_at(k, end).split_at(rows.jerk_axes);
                for p in axes {
                    next(&mut |l| step.limit([dot(p, &y)], [dot(p, &dy)], [b, db], l));
                }
                if let ([p, q, r], true) = (tip, rows.jerk_tip) {
                    let at = |y: &[f64; 3]| [dot(p, y), dot(q, y), dot(r, y)];
                    next(&mut |l| step.limit(at(&y), at(&dy), [b, db], l));
                }
                if end == 0 || k + 2 == last {
                    let (axes, tip) = rows.acceleration_at(node).split_at(rows.acceleration_axes);
                    let at = |p: &[f64; 2], y: &[f64; 3]| p[0] * y[0] + p[1] * y[1];
                    for p in axes {
                        next(&mut |l| step.limit([at(p, &y)], [at(p, &dy)], [1.0, 0.0], l));
                    }
                    if let ([p, q, r], true) = (tip, rows.acceleration_tip) {
                        let all = |y: &[f64; 3]| [at(p, y), at(q, y), at(r, y)];
                        next(&mut |l| step.limit(all(&y), all(&dy), [1.0, 0.0], l));
                    }
                    next(&mut |l| step.linear(1.0 - b / rows.cap[node], -db / rows.cap[node], l));
                }
            }
            let (m, dm, cap) = (self.m[k], change[k], rows.middle_cap(k));
            next(&mut |l| step.linear(1.0 - m / cap, -dm / cap, l));
            next(&mut |l| step.linear(m, dm, l));
        }
        step
    }
}
