//! Products and derivatives of polynomials over the interval from 0 to 1. A polynomial is given by its
//! Bernstein coefficients. Over the interval, its values lie between the least and the largest coefficient.

use nalgebra::SVector;

/// The Bernstein coefficients of the scalar product of two vector polynomials over the unit interval. Each
/// has at least one coefficient.
pub fn dot<const D: usize>(a: &[SVector<f64, D>], b: &[SVector<f64, D>]) -> Vec<f64> {
    let [m, n] = [a.len() - 1, b.len() - 1];
    let mut product = vec![0.0; m + n + 1];
    for (i, p) in a.iter().enumerate() {
        for (j, q) in b.iter().enumerate() {
            product[i + j] += binomial(m, i) * binomial(n, j) * p.dot(q);
        }
    }
    for (k, coefficient) in product.iter_mut().enumerate() {
        *coefficient /= binomial(m + n, k);
    }
    product
}

/// The Bernstein coefficients of the derivative: one fewer than those of the polynomial.
pub fn derived<const D: usize>(a: &[SVector<f64, D>]) -> Vec<SVector<f64, D>> {
    let degree = (a.len() - 1) as f64;
    a.windows(2).map(|pair| (pair[1] - pair[0]) * degree).collect()
}

/// The least of the coefficients.
pub fn lowest(coefficients: &[f64]) -> f64 {
    coefficients.iter().copied().fold(f64::INFINITY, f64::min)
}

/// The largest absolute value of the coefficients.
pub fn magnitude(coefficients: &[f64]) -> f64 {
    coefficients.iter().map(|c| c.abs()).fold(0.0, f64::max)
}

/// The binomial coefficient n over k; exact for the small degrees of curves.
fn binomial(n: usize, k: usize) -> f64 {
    (0..k).fold(1.0, |value, i| value * (n - i) as f64 / (i + 1) as f64)
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;

    use super::*;

    #[test]
    fn a_product_of_coefficients_is_that_of_the_polynomials() {
        // (t, 1) . (t^2, 1 - t) = t^3 + 1 - t, of degree 1 + 2.
        let a = [Vector2::new(0.0, 1.0), Vector2::new(1.0, 1.0)];
        let b = [Vector2::new(0.0, 1.0), Vector2::new(0.0, 0.5), Vector2::new(1.0, 0.0)];
        let expected = [1.0, 2.0 / 3.0, 1.0 / 3.0, 1.0];
        for (found, expected) in dot(&a, &b).iter().zip(expected) {
            assert!((found - expected).abs() < 1e-15, "{found} {expected}");
        }
        assert_eq!(derived(&b), [Vector2::new(0.0, -1.0), Vector2::new(2.0, -1.0)]);
    }
}
