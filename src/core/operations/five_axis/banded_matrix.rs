//! Solves a symmetric positive definite system of equations whose matrix has few diagonals.

/// The matrix with `WIDTH` diagonals on and below the main one: row k holds the entries at (k, k), (k, k - 1)
/// and so on.
#[derive(Clone)]
pub struct BandedMatrix<const WIDTH: usize> {
    rows: Vec<[f64; WIDTH]>,
}

impl<const WIDTH: usize> BandedMatrix<WIDTH> {
    pub fn zeros(size: usize) -> Self {
        Self { rows: vec![[0.0; WIDTH]; size] }
    }

    /// Adds to the entry at (row, row - back), where `back` is below `WIDTH`.
    pub fn add(&mut self, row: usize, back: usize, value: f64) {
        self.rows[row][back] += value;
    }

    /// The sum of this matrix and a multiple of another.
    pub fn plus(&self, other: &Self, factor: f64) -> Self {
        let sum = |(a, b): (&[f64; WIDTH], &[f64; WIDTH])| std::array::from_fn(|k| a[k] + factor * b[k]);
        Self { rows: self.rows.iter().zip(&other.rows).map(sum).collect() }
    }

    /// Replaces the matrix by its factors L D L'. False if the matrix is not positive definite.
    pub fn factor(&mut self) -> bool {
        for k in 0..self.rows.len() {
            let mut row = self.rows[k];
            let near = WIDTH.min(k + 1);
            // First the row of L times D.
            for back in (1..near).rev() {
                for further in back + 1..near {
                    row[back] -= row[further] * self.rows[k - back][further - back];
                }
            }
            let mut lost = 0.0;
            for (back, entry) in row.iter_mut().enumerate().take(near).skip(1) {
                let pivot = self.rows[k - back][0];
                *entry /= pivot;
                lost += *entry * *entry * pivot;
            }
            row[0] -= lost;
            if !(row[0] > 0.0 && row[0].is_finite()) {
                return false;
            }
            self.rows[k] = row;
        }
        true
    }

    /// Replaces the right sides `x` by the solutions, after [`BandedMatrix::factor`].
    pub fn solve<const N: usize>(&self, x: &mut [[f64; N]]) {
        for k in 0..x.len() {
            for back in 1..WIDTH.min(k + 1) {
                let (entry, before) = (self.rows[k][back], x[k - back]);
                for n in 0..N {
                    x[k][n] -= entry * before[n];
                }
            }
        }
        for k in (0..x.len()).rev() {
            let pivot = self.rows[k][0];
            x[k] = x[k].map(|value| value / pivot);
            for ahead in 1..WIDTH.min(x.len() - k) {
                let (entry, after) = (self.rows[k + ahead][ahead], x[k + ahead]);
                for n in 0..N {
                    x[k][n] -= entry * after[n];
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn the_solution_satisfies_the_equations<const WIDTH: usize>(entry: impl Fn(usize, usize) -> f64) {
        let size = 11;
        let mut band = BandedMatrix::<WIDTH>::zeros(size);
        for k in 0..size {
            for back in 0..WIDTH.min(k + 1) {
                band.add(k, back, entry(k, back));
            }
        }
        let solution: Vec<f64> = (0..size).map(|k| (k as f64).sin()).collect();
        let at = |r: usize, c: usize| match r.abs_diff(c) {
            back if back < WIDTH => entry(r.max(c), back),
            _ => 0.0,
        };
        let mut x: Vec<[f64; 1]> =
            (0..size).map(|r| [(0..size).map(|c| at(r, c) * solution[c]).sum::<f64>()]).collect();
        assert!(band.factor());
        band.solve(&mut x);
        assert!(x.iter().zip(&solution).all(|(x, s)| (x[0] - s).abs() < 1e-12), "{x:?}");
    }

    #[test]
    fn the_solutions_of_both_widths_satisfy_the_equations() {
        the_solution_satisfies_the_equations::<3>(|k, back| {
            [5.0 + k as f64, -1.5 + 0.1 * k as f64, 0.7][back]
        });
        the_solution_satisfies_the_equations::<6>(|k, back| {
            [9.0 + k as f64, -1.5, 0.7, 0.3 + 0.01 * k as f64, -0.4, 0.2][back]
        });
    }

    #[test]
    fn a_matrix_that_is_not_positive_definite_is_refused() {
        let mut band = BandedMatrix::<3>::zeros(2);
        band.add(0, 0, 1.0);
        band.add(1, 0, 1.0);
        band.add(1, 1, 2.0);
        assert!(!band.factor());
        let mut negative = BandedMatrix::<6>::zeros(2);
        negative.add(0, 0, -1.0);
        assert!(!negative.factor());
    }
}
