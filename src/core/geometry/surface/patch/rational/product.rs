//! Sums of squares of polynomials, and bounds of their quotients, from Bernstein coefficients.

use super::{MAX_DEGREE, SIZE};

/// Number of coefficients, in one direction, of a product of two polynomials of the largest degree.
pub(super) const PRODUCT_SIZE: usize = 2 * MAX_DEGREE + 1;

/// Bernstein coefficients of a product of two polynomials of the degree of a patch. The product has twice
/// that degree.
pub(super) struct Product {
    degree: [usize; 2],
    coefficients: [[f64; PRODUCT_SIZE]; PRODUCT_SIZE],
}

impl Product {
    pub(super) fn zero(factor_degree: [usize; 2]) -> Self {
        Self { degree: factor_degree, coefficients: [[0.0; PRODUCT_SIZE]; PRODUCT_SIZE] }
    }

    /// Adds `weight` times the square of the polynomial with the Bernstein coefficients `factor`. The stored
    /// coefficients are multiplied by their binomials.
    pub(super) fn add_square(&mut self, factor: &dyn Fn(usize, usize) -> f64, weight: f64) {
        let [p, q] = self.degree;
        let (along_u, along_v) = (BINOMIALS[p], BINOMIALS[q]);
        let mut scaled = [[0.0; SIZE]; SIZE];
        for (a, row) in scaled.iter_mut().enumerate().take(p + 1) {
            for (b, x) in row.iter_mut().enumerate().take(q + 1) {
                *x = factor(a, b) * along_u[a] * along_v[b];
            }
        }
        for i in 0..=p {
            for k in i..=p {
                let weight = if i == k { weight } else { 2.0 * weight };
                let target = &mut self.coefficients[i + k];
                for (j, x) in scaled[i].iter().enumerate().take(q + 1) {
                    for (l, y) in scaled[k].iter().enumerate().take(q + 1) {
                        target[j + l] += weight * x * y;
                    }
                }
            }
        }
    }

    /// The quotients of the coefficients. The quotient of the polynomials stays within the range of these
    /// numbers if all coefficients of `divisor` are above zero.
    pub(super) fn over(mut self, divisor: &Product) -> Self {
        for (row, below) in
            self.coefficients.iter_mut().zip(&divisor.coefficients).take(2 * self.degree[0] + 1)
        {
            for (x, w) in row.iter_mut().zip(below).take(2 * self.degree[1] + 1) {
                *x /= w;
            }
        }
        self
    }

    fn rows(&self) -> impl Iterator<Item = &[f64]> {
        let [p, q] = self.degree;
        self.coefficients.iter().take(2 * p + 1).map(move |row| &row[..2 * q + 1])
    }

    pub(super) fn lowest(&self) -> f64 {
        self.rows().flatten().copied().fold(f64::INFINITY, f64::min)
    }

    pub(super) fn highest(&self) -> f64 {
        self.rows().flatten().copied().fold(f64::NEG_INFINITY, f64::max)
    }

    /// The largest absolute second differences of the coefficients along u and v.
    pub(super) fn bends(&self) -> [f64; 2] {
        let bend = |a: f64, b: f64, c: f64| (a - 2.0 * b + c).abs();
        let along_v = self.rows().flat_map(|row| row.windows(3).map(|w| bend(w[0], w[1], w[2])));
        let along_u = self
            .rows()
            .zip(self.rows().skip(1))
            .zip(self.rows().skip(2))
            .flat_map(|((a, b), c)| a.iter().zip(b).zip(c).map(|((a, b), c)| bend(*a, *b, *c)));
        [along_u.fold(0.0, f64::max), along_v.fold(0.0, f64::max)]
    }
}

/// The binomial coefficients n over k, as `BINOMIALS[n][k]`.
pub(super) const BINOMIALS: [[f64; PRODUCT_SIZE]; PRODUCT_SIZE] = {
    let mut rows = [[0.0; PRODUCT_SIZE]; PRODUCT_SIZE];
    let mut n = 0;
    while n < PRODUCT_SIZE {
        rows[n][0] = 1.0;
        let mut k = 1;
        while k <= n {
            rows[n][k] = rows[n - 1][k - 1] + rows[n - 1][k];
            k += 1;
        }
        n += 1;
    }
    rows
};
