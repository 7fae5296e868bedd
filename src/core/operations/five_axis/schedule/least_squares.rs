//! Solves least-squares problems whose equations each have three neighbouring unknowns.
//!
//! # Method
//! Givens rotations add one equation after the other to a triangle of three diagonals. The normal equations
//! would square the condition of the problem. Nodes that are a millionth of their neighbours apart would then
//! leave no digit.
//!
//! # Cost
//! At most three rotations for each equation.
//!
//! # Reference
//! G. H. Golub, C. F. Van Loan, *Matrix Computations*, 4th edition, 2013, section 5.2 on Givens rotations.

/// The coefficients of an equation from its first unknown on, and its two right sides.
pub type Equation = ([f64; 3], [f64; 2]);

/// The equations that were added so far, as a triangle.
pub struct LeastSquares {
    /// Row k holds the coefficients of the unknowns k, k + 1 and k + 2.
    rows: Vec<Equation>,
}

impl LeastSquares {
    pub fn new(unknowns: usize) -> Self {
        Self { rows: vec![([0.0; 3], [0.0; 2]); unknowns] }
    }

    pub fn clear(&mut self) {
        self.rows.fill(([0.0; 3], [0.0; 2]));
    }

    /// Adds an equation whose first unknown is `first`. Coefficients of unknowns that do not exist are 0.
    #[inline(always)]
    pub fn add(&mut self, first: usize, (mut row, mut sides): Equation) {
        for own in self.rows.iter_mut().skip(first).take(3) {
            if row[0] != 0.0 {
                let length = (own.0[0] * own.0[0] + row[0] * row[0]).sqrt();
                let (c, s) = (own.0[0] / length, row[0] / length);
                for (own, row) in own.0.iter_mut().zip(&mut row).chain(own.1.iter_mut().zip(&mut sides)) {
                    (*own, *row) = (c * *own + s * *row, c * *row - s * *own);
                }
            }
            row = [row[1], row[2], 0.0];
        }
    }

    /// The solutions for both right sides. An unknown without an equation is 0. `None` if a number is not
    /// finite.
    pub fn solve(&self, into: &mut [[f64; 2]]) -> Option<()> {
        let mut after = [[0.0; 2]; 2];
        for ((row, sides), x) in self.rows.iter().zip(into).rev() {
            *x = [0, 1].map(|n| {
                let rest = sides[n] - row[1] * after[0][n] - row[2] * after[1][n];
                if row[0] == 0.0 { 0.0 } else { rest / row[0] }
            });
            if !(x[0].is_finite() && x[1].is_finite()) {
                return None;
            }
            after = [*x, after[0]];
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Second differences over intervals of very different lengths, and a little of each value.
    #[test]
    fn the_solution_is_found_where_normal_equations_leave_no_digit() {
        let h = [1.0, 1e-6, 1.0, 1e-6, 1e-6, 1.0, 1.0];
        let wanted: Vec<f64> = (0..9).map(|k| 1.0 + f64::from(k).sin()).collect();
        let mut problem = LeastSquares::new(9);
        for k in 0..9 {
            let mut row = [1e-3, 0.0, 0.0];
            problem.add(k, (row, [1e-3 * wanted[k], 0.0]));
            if let Some(h) = h.get(k) {
                row = [1.0 / h, -2.0 / h, 1.0 / h];
                let side = (0..3).map(|i| row[i] * wanted[k + i]).sum();
                problem.add(k, (row, [side, 0.0]));
            }
        }
        let mut found = vec![[0.0; 2]; 9];
        problem.solve(&mut found).unwrap();
        for (found, wanted) in found.iter().zip(&wanted) {
            assert!((found[0] - wanted).abs() < 1e-6 && found[1] == 0.0, "{found:?} {wanted}");
        }
    }

    #[test]
    fn what_no_equation_names_is_zero_and_what_is_not_finite_is_refused() {
        let mut problem = LeastSquares::new(3);
        problem.add(1, ([2.0, 0.0, 0.0], [6.0, 8.0]));
        let mut found = vec![[1.0; 2]; 3];
        problem.solve(&mut found).unwrap();
        assert_eq!(found, [[0.0; 2], [3.0, 4.0], [0.0; 2]]);
        problem.add(0, ([f64::NAN, 0.0, 0.0], [0.0; 2]));
        assert!(problem.solve(&mut found).is_none());
    }
}
