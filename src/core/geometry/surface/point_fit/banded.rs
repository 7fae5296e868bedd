//! Symmetric positive definite systems of equations whose matrix has a band.
//!
//! # Method
//! Cholesky's factorization, row by row, within the band. The entries of a row lie next to each other, so the
//! inner loop is a dot product of two slices.
//!
//! # Cost
//! O(n w^2) for n equations and half a band of w entries; O(n w) for each right side.

use crate::budget::{Budget, Stopped};

/// The lower half of a symmetric band matrix: row i holds the columns from i - `half` to i.
pub struct Banded {
    half: usize,
    entries: Vec<f64>,
}

/// The factor L of a matrix L L^T, with the same band.
pub struct Factor(Banded);

impl Banded {
    /// A matrix of zeros with `n` rows and `half` entries beside the diagonal.
    pub fn zeros(n: usize, half: usize) -> Self {
        Self { half, entries: vec![0.0; n * (half + 1)] }
    }

    /// Adds to the entry in row `i` and column `j`; `j` is at most `i`, and within the band.
    pub fn add(&mut self, i: usize, j: usize, value: f64) {
        self.entries[i * (self.half + 1) + self.half + j - i] += value;
    }

    fn row(&self, i: usize) -> &[f64] {
        let width = self.half + 1;
        &self.entries[i * width..(i + 1) * width]
    }

    /// The factor; `None` where a pivot is not positive, because of rounding or of the matrix.
    ///
    /// # Errors
    /// Only the budget's stop.
    pub fn factored(mut self, budget: &Budget) -> Result<Option<Factor>, Stopped> {
        let (half, width) = (self.half, self.half + 1);
        let n = self.entries.len() / width;
        for i in 0..n {
            if i.is_multiple_of(64) {
                budget.check()?;
            }
            let (before, rest) = self.entries.split_at_mut(i * width);
            let row = &mut rest[..width];
            let first = i.saturating_sub(half);
            let start = half + first - i;
            for j in first..i {
                let other = &before[j * width..(j + 1) * width];
                let at = half + j - i;
                let shared = dot(&row[start..at], &other[start + i - j..half]);
                row[at] = (row[at] - shared) / other[half];
            }
            let pivot = row[half] - dot(&row[start..half], &row[start..half]);
            // Not a number is no pivot either.
            if pivot.is_nan() || pivot <= 0.0 {
                return Ok(None);
            }
            row[half] = pivot.sqrt();
        }
        Ok(Some(Factor(self)))
    }
}

impl Factor {
    /// Puts the solution of the equations in the place of their right side.
    pub fn solve(&self, right: &mut [f64]) {
        let Self(lower) = self;
        let half = lower.half;
        for i in 0..right.len() {
            let first = i.saturating_sub(half);
            let row = &lower.row(i)[half + first - i..];
            let known = dot(&row[..i - first], &right[first..i]);
            right[i] = (right[i] - known) / row[i - first];
        }
        for i in (0..right.len()).rev() {
            let first = i.saturating_sub(half);
            let row = &lower.row(i)[half + first - i..];
            let value = right[i] / row[i - first];
            right[i] = value;
            right[first..i].iter_mut().zip(row).for_each(|(x, l)| *x -= l * value);
        }
    }
}

/// The entries of an inverse matrix within the band of the matrix.
pub struct Inverse {
    half: usize,
    /// Row i holds the columns from i - `half` to i + `half`.
    entries: Vec<f64>,
}

impl Inverse {
    /// The entry in row `i` and column `j`, which is within the band.
    pub fn at(&self, i: usize, j: usize) -> f64 {
        self.entries[i * (2 * self.half + 1) + self.half + j - i]
    }
}

impl Factor {
    /// The inverse of the matrix within the band, by Takahashi's recursion from the last column to the first.
    ///
    /// # Errors
    /// Only the budget's stop.
    pub fn inverse(&self, budget: &Budget) -> Result<Inverse, Stopped> {
        let Self(lower) = self;
        let (half, width) = (lower.half, 2 * lower.half + 1);
        let n = lower.entries.len() / (half + 1);
        let mut entries = vec![0.0; n * width];
        for j in (0..n).rev() {
            if j.is_multiple_of(64) {
                budget.check()?;
            }
            let end = (j + half + 1).min(n);
            let pivot = lower.row(j)[half];
            let column: Vec<f64> = (j + 1..end).map(|i| lower.row(i)[half + j - i]).collect();
            for i in j + 1..end {
                let at = i * width + half + j + 1 - i;
                let value = -dot(&column, &entries[at..at + column.len()]) / pivot;
                entries[at - 1] = value;
                entries[j * width + half + i - j] = value;
            }
            let at = j * width + half;
            let row = &entries[at + 1..at + 1 + column.len()];
            entries[at] = (1.0 / pivot - dot(&column, row)) / pivot;
        }
        Ok(Inverse { half, entries })
    }
}

/// The dot product, in eight sums so that the processor can add several numbers at a time.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (a_eights, b_eights) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f64 = a_eights.remainder().iter().zip(b_eights.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in a_eights.zip(b_eights) {
        for k in 0..8 {
            sums[k] += x[k] * y[k];
        }
    }
    rest + ((sums[0] + sums[4]) + (sums[1] + sums[5])) + ((sums[2] + sums[6]) + (sums[3] + sums[7]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_solution_satisfies_the_equations() {
        let (n, half) = (40, 11);
        let entry = |i: usize, j: usize| {
            if i == j { 30.0 } else { ((i * 7 + j * 3) % 5) as f64 - 2.0 }
        };
        let mut matrix = Banded::zeros(n, half);
        for i in 0..n {
            (i.saturating_sub(half)..=i).for_each(|j| matrix.add(i, j, entry(i, j)));
        }
        let expected: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
        let mut right: Vec<f64> = (0..n)
            .map(|i| {
                let near = (0..n).filter(|j| i.abs_diff(*j) <= half);
                near.map(|j| entry(i.max(j), i.min(j)) * expected[j]).sum()
            })
            .collect();
        let factor = matrix.factored(&Budget::unlimited()).unwrap().unwrap();
        factor.solve(&mut right);
        let inverse = factor.inverse(&Budget::unlimited()).unwrap();
        for j in [0, 3, 20, n - 1] {
            let mut column: Vec<f64> = (0..n).map(|i| f64::from(u8::from(i == j))).collect();
            factor.solve(&mut column);
            for i in (0..n).filter(|i| i.abs_diff(j) <= half) {
                assert!((inverse.at(i, j) - column[i]).abs() < 1e-15, "{i} {j}");
            }
        }
        for (x, y) in right.iter().zip(&expected) {
            assert!((x - y).abs() < 1e-13, "{x} {y}");
        }
    }

    #[test]
    fn a_matrix_that_is_not_positive_has_no_factor() {
        let mut matrix = Banded::zeros(2, 1);
        [(0, 0, 1.0), (1, 0, 2.0), (1, 1, 1.0)].into_iter().for_each(|(i, j, x)| matrix.add(i, j, x));
        assert!(matrix.factored(&Budget::unlimited()).unwrap().is_none());
    }
}
