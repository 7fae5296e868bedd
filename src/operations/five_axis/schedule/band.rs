//! Solves a symmetric positive definite system of equations with two diagonals beside the main one.

/// The matrix: row k holds the entries at (k, k), (k, k - 1) and (k, k - 2).
pub struct Band {
    rows: Vec<[f64; 3]>,
}

impl Band {
    pub fn zeros(size: usize) -> Self {
        Self { rows: vec![[0.0; 3]; size] }
    }

    pub fn clear(&mut self) {
        self.rows.fill([0.0; 3]);
    }

    /// Adds to the entry at (row, row - back), where `back` is at most 2.
    pub fn add(&mut self, row: usize, back: usize, value: f64) {
        self.rows[row][back] += value;
    }

    /// Replaces the matrix by its factors L D L'. False if the matrix is not positive definite.
    pub fn factor(&mut self) -> bool {
        let (mut one, mut two) = ([0.0, 0.0], 0.0);
        // `one` holds D and the first entry of L of the row before; `two` holds D of the row before that.
        for [d, a, b] in &mut self.rows {
            let [pivot, beside] = one;
            let second = if two > 0.0 { *b / two } else { 0.0 };
            let first = if pivot > 0.0 { (*a - *b * beside) / pivot } else { 0.0 };
            *d -= first * first * pivot + second * second * two;
            if !(*d > 0.0 && d.is_finite()) {
                return false;
            }
            (*a, *b) = (first, second);
            two = pivot;
            one = [*d, first];
        }
        true
    }

    /// Replaces the right sides `x` by the solutions, after [`Band::factor`].
    pub fn solve<const N: usize>(&self, x: &mut [[f64; N]]) {
        for k in 0..x.len() {
            let [_, a, b] = self.rows[k];
            let one = if k > 0 { x[k - 1] } else { [0.0; N] };
            let two = if k > 1 { x[k - 2] } else { [0.0; N] };
            x[k] = std::array::from_fn(|n| x[k][n] - a * one[n] - b * two[n]);
        }
        for k in (0..x.len()).rev() {
            let d = self.rows[k][0];
            for n in 0..N {
                let one = if k + 1 < x.len() { self.rows[k + 1][1] * x[k + 1][n] } else { 0.0 };
                let two = if k + 2 < x.len() { self.rows[k + 2][2] * x[k + 2][n] } else { 0.0 };
                x[k][n] = x[k][n] / d - one - two;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_solution_satisfies_the_equations() {
        let size = 9;
        let mut band = Band::zeros(size);
        let entry = |k: usize, back: usize| [5.0 + k as f64, -1.5 + 0.1 * k as f64, 0.7][back];
        for k in 0..size {
            for back in 0..=k.min(2) {
                band.add(k, back, entry(k, back));
            }
        }
        let solution: Vec<f64> = (0..size).map(|k| (k as f64).sin()).collect();
        let at = |r: usize, c: usize| match r.abs_diff(c) {
            back @ 0..=2 => entry(r.max(c), back),
            _ => 0.0,
        };
        let mut x: Vec<[f64; 1]> =
            (0..size).map(|r| [(0..size).map(|c| at(r, c) * solution[c]).sum::<f64>()]).collect();
        assert!(band.factor());
        band.solve(&mut x);
        assert!(x.iter().zip(&solution).all(|(x, s)| (x[0] - s).abs() < 1e-12), "{x:?}");
    }

    #[test]
    fn a_matrix_that_is_not_positive_definite_is_refused() {
        let mut band = Band::zeros(2);
        band.add(0, 0, 1.0);
        band.add(1, 0, 1.0);
        band.add(1, 1, 2.0);
        assert!(!band.factor());
    }
}
