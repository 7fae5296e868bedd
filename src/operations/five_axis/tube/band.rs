//! Solves a symmetric positive definite system with five diagonals beside the main one.

/// Diagonals of one side, with the main one.
pub const WIDTH: usize = 6;

/// The matrix: row k holds the entries at (k, k), (k, k - 1), ... (k, k - 5).
#[derive(Clone)]
pub struct Band {
    rows: Vec<[f64; WIDTH]>,
}

impl Band {
    pub fn zeros(size: usize) -> Self {
        Self { rows: vec![[0.0; WIDTH]; size] }
    }

    /// Adds to the entry at (row, row - back).
    pub fn add(&mut self, row: usize, back: usize, value: f64) {
        self.rows[row][back] += value;
    }

    /// The sum of this matrix and a multiple of another.
    pub fn plus(&self, other: &Self, factor: f64) -> Self {
        let sum = |(a, b): (&[f64; WIDTH], &[f64; WIDTH])| std::array::from_fn(|k| a[k] + factor * b[k]);
        Self { rows: self.rows.iter().zip(&other.rows).map(sum).collect() }
    }

    /// Replaces the matrix by its factor L with L L' = A. False if the matrix is not positive definite.
    pub fn factor(&mut self) -> bool {
        for k in 0..self.rows.len() {
            for back in (0..WIDTH.min(k + 1)).rev() {
                let column = k - back;
                let mut sum = self.rows[k][back];
                for further in back + 1..WIDTH.min(k + 1) {
                    let beside = further - back;
                    if beside < WIDTH {
                        sum -= self.rows[k][further] * self.rows[column][beside];
                    }
                }
                if back == 0 {
                    if !(sum > 0.0 && sum.is_finite()) {
                        return false;
                    }
                    self.rows[k][0] = sum.sqrt();
                } else {
                    self.rows[k][back] = sum / self.rows[column][0];
                }
            }
        }
        true
    }

    /// Replaces the right sides by the solutions, after [`Band::factor`].
    pub fn solve<const N: usize>(&self, x: &mut [[f64; N]]) {
        for k in 0..x.len() {
            for back in 1..WIDTH.min(k + 1) {
                let (entry, before) = (self.rows[k][back], x[k - back]);
                for n in 0..N {
                    x[k][n] -= entry * before[n];
                }
            }
            x[k] = x[k].map(|value| value / self.rows[k][0]);
        }
        for k in (0..x.len()).rev() {
            for ahead in 1..WIDTH.min(x.len() - k) {
                let (entry, after) = (self.rows[k + ahead][ahead], x[k + ahead]);
                for n in 0..N {
                    x[k][n] -= entry * after[n];
                }
            }
            x[k] = x[k].map(|value| value / self.rows[k][0]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_solution_satisfies_the_equations() {
        let size = 11;
        let entry =
            |k: usize, back: usize| [9.0 + k as f64, -1.5, 0.7, 0.3 + 0.01 * k as f64, -0.4, 0.2][back];
        let mut band = Band::zeros(size);
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
        let mut negative = Band::zeros(2);
        negative.add(0, 0, -1.0);
        assert!(!negative.factor());
    }
}
