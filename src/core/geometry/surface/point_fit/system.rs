//! The penalized least squares of heights on one net.
//!
//! # Method
//! The control points c minimize (1/n) (B c - z)^T W (B c - z) + weight c^T R c, where B holds the basis
//! functions at the n points, W their weights, and R is the energy of a thin plate. The normal equations are
//! solved by Cholesky's method in a band, and again for what rounding left.

use super::banded::{Banded, Factor};
use super::net::{CellMatrix, Net, WIDTH, basis, roughness};
use crate::budget::{Budget, Stopped};

/// Control points behind a control point along each direction that share a cell with it, and itself.
const REACH: usize = 2 * WIDTH - 1;

/// Rows of the lower half of a matrix: for each control point, the entries with control points up to three
/// places before it along the slow direction, and up to three places to each side along the fast one.
type Stencil = [f64; WIDTH * REACH];

/// Solutions again for what rounding left.
const CORRECTIONS: usize = 2;

/// A height at a place of the unit frame.
#[derive(Debug, Clone, Copy)]
pub struct Sample {
    /// From 0 to 1 along u and v.
    pub place: [f64; 2],
    pub height: f64,
    /// How much its squared error counts.
    pub weight: f64,
}

/// The control point before all others on a sample's cell, and the values of the basis functions there.
struct Row {
    first: usize,
    along: [[f64; WIDTH]; 2],
    height: f64,
    /// The weight of the sample over the number of samples.
    share: f64,
}

/// The equations of one net.
pub struct System {
    /// The number of control points along the fast direction, which is the shorter one.
    n_fast: usize,
    n: usize,
    /// Whether u is the fast direction.
    is_turned: bool,
    rows: Vec<Row>,
    /// B^T W B / n and R.
    squares: Vec<Stencil>,
    energy: Vec<Stencil>,
}

/// Control points, with their errors at the samples.
#[derive(Debug, Clone)]
pub struct Solution {
    /// In the order of the system.
    control: Vec<f64>,
    /// The surface less the height, for each sample.
    pub residuals: Vec<f64>,
}

impl System {
    /// The equations of `samples` on `net`, whose cells have the sides `steps`.
    pub fn new(net: Net, steps: [f64; 2], samples: &[Sample]) -> Self {
        let is_turned = net.cells[0] < net.cells[1];
        let order = |pair: [usize; 2]| if is_turned { [pair[1], pair[0]] } else { pair };
        let [slow_cells, fast_cells] = order(net.cells);
        let n_fast = fast_cells + WIDTH - 1;
        let n = net.n_control_points();
        let share = 1.0 / samples.len() as f64;
        let mut system = Self {
            n_fast,
            n,
            is_turned,
            rows: samples.iter().map(|sample| row(sample, net, is_turned, n_fast, share)).collect(),
            squares: vec![[0.0; WIDTH * REACH]; n],
            energy: vec![[0.0; WIDTH * REACH]; n],
        };
        for row in &system.rows {
            let values = products(&row.along);
            let mut matrix = [[0.0; 16]; 16];
            for (line, x) in matrix.iter_mut().zip(values) {
                line.iter_mut().zip(values).for_each(|(entry, y)| *entry = row.share * x * y);
            }
            add_cell(&mut system.squares, row.first, n_fast, &matrix);
        }
        let turned_steps = if is_turned { [steps[1], steps[0]] } else { steps };
        let matrix = roughness(turned_steps);
        for i in 0..slow_cells {
            for j in 0..fast_cells {
                add_cell(&mut system.energy, i * n_fast + j, n_fast, &matrix);
            }
        }
        system
    }

    /// The weight at which the energy counts as much as the heights, on average over the control points.
    pub fn balance(&self) -> f64 {
        let trace = |matrix: &[Stencil]| matrix.iter().map(|row| row[WIDTH - 1]).sum::<f64>();
        trace(&self.squares) / trace(&self.energy)
    }

    /// The solution for a weight of the energy; `None` where rounding leaves no positive pivot.
    ///
    /// # Errors
    /// Only the budget's stop.
    pub fn solve(&self, weight: f64, budget: &Budget) -> Result<Option<Solution>, Stopped> {
        Ok(self.factored(weight, budget)?.map(|factor| self.solution(&factor, weight)))
    }

    /// As [`Self::solve`], with the leverage of each sample: how far the solution moves there with the
    /// sample's height, as a part of the height's change.
    ///
    /// # Errors
    /// Only the budget's stop.
    pub fn solve_with_leverages(
        &self,
        weight: f64,
        budget: &Budget,
    ) -> Result<Option<(Solution, Vec<f64>)>, Stopped> {
        let Some(factor) = self.factored(weight, budget)? else { return Ok(None) };
        let inverse = factor.inverse(budget)?;
        let leverage = |row: &Row| -> f64 {
            let values = products(&row.along);
            let at = |k: usize| row.first + k / WIDTH * self.n_fast + k % WIDTH;
            let line = |k: usize| -> f64 {
                values.iter().enumerate().map(|(l, y)| inverse.at(at(k), at(l)) * y).sum()
            };
            row.share * values.iter().enumerate().map(|(k, x)| x * line(k)).sum::<f64>()
        };
        let leverages = self.rows.iter().map(leverage).collect();
        Ok(Some((self.solution(&factor, weight), leverages)))
    }

    fn factored(&self, weight: f64, budget: &Budget) -> Result<Option<Factor>, Stopped> {
        let half = (WIDTH - 1) * (self.n_fast + 1);
        let mut matrix = Banded::zeros(self.n, half);
        for (i, (squares, energy)) in self.squares.iter().zip(&self.energy).enumerate() {
            for (k, (x, y)) in squares.iter().zip(energy).enumerate() {
                if let Some(j) = self.neighbour(i, k) {
                    matrix.add(i, j, x + weight * y);
                }
            }
        }
        matrix.factored(budget)
    }

    fn solution(&self, factor: &Factor, weight: f64) -> Solution {
        let mut control = vec![0.0; self.n];
        for _ in 0..=CORRECTIONS {
            let mut right = self.rest(&control, weight);
            factor.solve(&mut right);
            control.iter_mut().zip(&right).for_each(|(x, step)| *x += step);
        }
        let residuals = self.residuals(&control);
        Solution { control, residuals }
    }

    /// What the control points leave of the normal equations.
    fn rest(&self, control: &[f64], weight: f64) -> Vec<f64> {
        let mut rest = vec![0.0; self.n];
        for (row, residual) in self.rows.iter().zip(self.residuals(control)) {
            let [slow, fast] = &row.along;
            for (a, x) in slow.iter().enumerate() {
                let line = &mut rest[row.first + a * self.n_fast..][..WIDTH];
                line.iter_mut().zip(fast).for_each(|(r, y)| *r -= row.share * residual * x * y);
            }
        }
        for (i, energy) in self.energy.iter().enumerate() {
            for (k, entry) in energy.iter().enumerate() {
                let Some(j) = self.neighbour(i, k) else { continue };
                rest[i] -= weight * entry * control[j];
                if i != j {
                    rest[j] -= weight * entry * control[i];
                }
            }
        }
        rest
    }

    fn residuals(&self, control: &[f64]) -> Vec<f64> {
        let value = |row: &Row| -> f64 {
            let [slow, fast] = &row.along;
            let line = |a: usize| -> f64 {
                let line = &control[row.first + a * self.n_fast..][..WIDTH];
                line.iter().zip(fast).map(|(c, y)| c * y).sum()
            };
            slow.iter().enumerate().map(|(a, x)| x * line(a)).sum()
        };
        self.rows.iter().map(|row| value(row) - row.height).collect()
    }

    /// The control point of entry `k` in the row of control point `i`; `None` above the diagonal, and where
    /// the entry lies beyond the net.
    fn neighbour(&self, i: usize, k: usize) -> Option<usize> {
        let (back, side) = (k / REACH, k % REACH);
        let (slow, fast) = (i / self.n_fast, i % self.n_fast);
        let fast = (fast + WIDTH - 1).checked_sub(side).filter(|fast| *fast < self.n_fast)?;
        let j = slow.checked_sub(back)? * self.n_fast + fast;
        (j <= i).then_some(j)
    }

    /// The control points of a solution, `[i][j]` with i along u.
    pub fn control_points(&self, solution: &Solution) -> Vec<Vec<f64>> {
        let n_slow = self.n / self.n_fast;
        let at = |i: usize, j: usize| solution.control[i * self.n_fast + j];
        if self.is_turned {
            (0..self.n_fast).map(|i| (0..n_slow).map(|j| at(j, i)).collect()).collect()
        } else {
            (0..n_slow).map(|i| (0..self.n_fast).map(|j| at(i, j)).collect()).collect()
        }
    }
}

fn row(sample: &Sample, net: Net, is_turned: bool, n_fast: usize, share: f64) -> Row {
    let along = |k: usize| {
        let t = sample.place[k] * net.cells[k] as f64;
        let cell = (t.max(0.0) as usize).min(net.cells[k] - 1);
        (cell, basis((t - cell as f64).clamp(0.0, 1.0)))
    };
    let (slow, fast) = if is_turned { (along(1), along(0)) } else { (along(0), along(1)) };
    Row {
        first: slow.0 * n_fast + fast.0,
        along: [slow.1, fast.1],
        height: sample.height,
        share: sample.weight * share,
    }
}

fn products([slow, fast]: &[[f64; WIDTH]; 2]) -> [f64; 16] {
    std::array::from_fn(|k| slow[k / WIDTH] * fast[k % WIDTH])
}

/// Adds the lower half of the matrix of a cell whose first control point is `first`.
fn add_cell(matrix: &mut [Stencil], first: usize, n_fast: usize, cell: &CellMatrix) {
    for (k, line) in cell.iter().enumerate() {
        let [a, b] = [k / WIDTH, k % WIDTH];
        let row = &mut matrix[first + a * n_fast + b];
        for (l, entry) in line.iter().enumerate().take(k + 1) {
            let [c, d] = [l / WIDTH, l % WIDTH];
            row[(a - c) * REACH + (b + WIDTH - 1 - d)] += entry;
        }
    }
}
