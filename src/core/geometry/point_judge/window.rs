//! The local fit by which a point is judged: a polynomial through the other points of a small window.
//!
//! # Method
//! The window holds up to five rows and five columns around the point. A polynomial of the indices, of degree
//! three at most, is fitted to all of its points but the one that is judged, by least squares. All windows of
//! a grid have the same size, so the fit is the same linear map for each place of the point in its window.

/// The most rows and columns of a window.
pub const WIDEST: usize = 5;

/// Most points of a window.
pub const MOST: usize = WIDEST * WIDEST;

/// Fewest points of a window beyond the coefficients of its polynomial. With fewer, the fit meets almost any
/// points, and its residuals tell nothing.
const LEAST_FREEDOM: usize = 4;

/// The fit for one place of the left-out point. Entries of arrays belong to the points of the window, row by
/// row; the entry of the left-out point is zero.
pub struct Fit {
    /// The value of the polynomial at the left-out place is the sum of these multiples of the values.
    pub value: [f64; MOST],
    /// The same for the derivatives along u and along v, by the index.
    pub along: [[f64; MOST]; 2],
    /// An orthonormal basis of the polynomials on the window.
    pub basis: Vec<[f64; MOST]>,
    /// The variance of the predicted value divided by the variance of one measured value: the sum of the
    /// squares of `value`.
    pub leverage: f64,
    /// Points less coefficients.
    pub freedom: usize,
}

/// The fits of all places in a window of `size` rows and columns. `None` where the window is too small.
pub fn fits(size: [usize; 2]) -> Option<Vec<Fit>> {
    let degrees = degrees(size);
    if size[0] * size[1] < degrees.len() + 1 + LEAST_FREEDOM {
        return None;
    }
    let places = (0..size[0]).flat_map(|a| (0..size[1]).map(move |b| [a, b]));
    places.map(|place| fit(size, &degrees, place)).collect()
}

/// The exponents of u and v in the terms of the polynomial. The first three are the constant, u and v.
fn degrees(size: [usize; 2]) -> Vec<[u32; 2]> {
    let most = size.map(|n| n.saturating_sub(2).clamp(1, 3) as u32);
    let total = if size[0].min(size[1]) < 3 { 2 } else { 3 };
    let mut degrees = vec![[0, 0], [1, 0], [0, 1]];
    for p in 0..=most[0] {
        degrees.extend((0..=most[1]).map(|q| [p, q]).filter(|[p, q]| (2..=total).contains(&(p + q))));
    }
    degrees
}

/// The fit to all points but the one at `place`, by Gram-Schmidt on the terms.
fn fit(size: [usize; 2], degrees: &[[u32; 2]], place: [usize; 2]) -> Option<Fit> {
    let left_out = place[0] * size[1] + place[1];
    let n = degrees.len();
    let mut basis: Vec<[f64; MOST]> = Vec::with_capacity(n);
    // The triangle that gives the terms as multiples of the basis.
    let mut triangle = vec![vec![0.0; n]; n];
    for (k, [p, q]) in degrees.iter().enumerate() {
        let mut column = [0.0; MOST];
        for a in 0..size[0] {
            for b in 0..size[1] {
                let from = |x: usize, place: usize| x as f64 - place as f64;
                column[a * size[1] + b] =
                    from(a, place[0]).powi(*p as i32) * from(b, place[1]).powi(*q as i32);
            }
        }
        column[left_out] = 0.0;
        let length = norm(&column);
        // The second round removes what rounding left of the first.
        for _ in 0..2 {
            for (m, other) in basis.iter().enumerate() {
                let part = dot(&column, other);
                triangle[m][k] += part;
                column.iter_mut().zip(other).for_each(|(x, y)| *x -= part * y);
            }
        }
        let rest = norm(&column);
        if rest <= 1e-9 * length {
            return None;
        }
        triangle[k][k] = rest;
        column.iter_mut().for_each(|x| *x /= rest);
        basis.push(column);
    }
    // The multiples of the values that give coefficient `k`.
    let coefficient = |k: usize| {
        let mut x = vec![0.0; n];
        for row in 0..n {
            let right = f64::from(u8::from(row == k));
            let known: f64 = (0..row).map(|m| triangle[m][row] * x[m]).sum();
            x[row] = (right - known) / triangle[row][row];
        }
        let mut weights = [0.0; MOST];
        for (x, column) in x.iter().zip(&basis) {
            weights.iter_mut().zip(column).for_each(|(w, y)| *w += x * y);
        }
        weights
    };
    let value = coefficient(0);
    let along = [coefficient(1), coefficient(2)];
    let leverage = dot(&value, &value);
    Some(Fit { value, along, basis, leverage, freedom: size[0] * size[1] - 1 - n })
}

pub fn dot(a: &[f64; MOST], b: &[f64; MOST]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn norm(a: &[f64; MOST]) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fit_predicts_a_cubic_and_its_slopes_at_every_place() {
        let f = |u: f64, v: f64| 1.0 + 2.0 * u - v + 0.3 * u * v + 0.1 * u * u * v - 0.05 * v * v * v;
        for (place, fit) in fits([5, 5]).expect("a window").iter().enumerate() {
            let mut values = [0.0; MOST];
            (0..MOST).for_each(|k| values[k] = f((k / 5) as f64, (k % 5) as f64));
            values[place] = 1e9;
            let (u, v) = ((place / 5) as f64, (place % 5) as f64);
            assert!((dot(&fit.value, &values) - f(u, v)).abs() < 1e-6, "{place}");
            let slopes = [2.0 + 0.3 * v + 0.2 * u * v, -1.0 + 0.3 * u + 0.1 * u * u - 0.15 * v * v];
            for (along, slope) in fit.along.iter().zip(slopes) {
                assert!((dot(along, &values) - slope).abs() < 1e-6, "{place}");
            }
            assert_eq!(fit.freedom, 14);
        }
    }

    #[test]
    fn a_window_with_too_few_points_has_no_fit() {
        assert!(fits([2, 3]).is_none() && fits([2, 2]).is_none());
        assert!(fits([3, 3]).is_some() && fits([2, 5]).is_some());
    }
}
