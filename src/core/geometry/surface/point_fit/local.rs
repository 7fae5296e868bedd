//! The height of a point as its neighbours predict it: a quadratic polynomial, fitted robustly.
//!
//! # Method
//! Least squares first; then rounds in which neighbours that lie far off count less (Huber's weights), and
//! last rounds in which they do not count at all (Tukey's weights). The scale of the residuals is their
//! median absolute deviation.
//!
//! # Reference
//! P. J. Huber, E. M. Ronchetti, "Robust Statistics", 2009, chapter 7.

use super::neighbours::Near;

/// Coefficients of a quadratic polynomial of two variables.
const N: usize = 6;

/// Fewest neighbours beyond the coefficients; with fewer, the residuals tell nothing.
const LEAST_FREEDOM: usize = 4;

/// Rounds with Huber's weights, and with Tukey's. After these the weights hardly change.
const HUBER_ROUNDS: usize = 8;
const TUKEY_ROUNDS: usize = 4;

/// Residuals beyond this many scales count less (Huber), or not at all (Tukey). The usual values, which lose
/// about 5 per cent of the precision for normal noise.
const HUBER: f64 = 1.345;
const TUKEY: f64 = 4.685;

/// The standard deviation of normal noise in median absolute deviations.
const BY_MEDIAN: f64 = 1.482_6;

/// The least pivot of the normal equations, as a part of the largest. Neighbours that lie on a line have a
/// smaller one.
const LEAST_PIVOT: f64 = 1e-9;

/// What the neighbours say of a point.
#[derive(Debug, Clone, Copy)]
pub struct Prediction {
    /// The height of the point above the predicted height, mm.
    pub off: f64,
    /// The standard deviation of a neighbour's height, mm.
    pub scale: f64,
    /// The variance of the prediction, in variances of a neighbour's height.
    pub leverage: f64,
    /// Neighbours beyond the coefficients.
    pub freedom: usize,
}

/// A neighbour with its height above the point, mm.
#[derive(Debug, Clone, Copy)]
pub struct Neighbour {
    pub near: Near,
    pub rise: f64,
}

/// How a prediction treats neighbours that lie far off the others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Robustness {
    /// As all others: one round of least squares.
    None,
    Full,
}

/// The prediction by the neighbours; `None` where they are too few, or on a line. No scale is taken smaller
/// than `least_scale`.
pub fn predicted(neighbours: &[Neighbour], robustness: Robustness, least_scale: f64) -> Option<Prediction> {
    let freedom = neighbours.len().checked_sub(N).filter(|freedom| *freedom >= LEAST_FREEDOM)?;
    let reach = neighbours.iter().map(|one| one.near.distance).fold(0.0, f64::max);
    let terms: Vec<[f64; N]> = neighbours.iter().map(|one| terms(one.near.offset, reach)).collect();
    let mut weights = vec![1.0; neighbours.len()];
    let mut fit = fitted(neighbours, &terms, &weights)?;
    let mut scale = fit.scale(freedom).max(least_scale);
    if robustness == Robustness::Full {
        for round in 0..HUBER_ROUNDS + TUKEY_ROUNDS {
            for (weight, rest) in weights.iter_mut().zip(&fit.rests) {
                let ratio = rest.abs() / scale;
                *weight = if round < HUBER_ROUNDS {
                    (HUBER / ratio).min(1.0)
                } else {
                    (1.0 - (ratio / TUKEY).powi(2)).max(0.0).powi(2)
                };
            }
            let Some(next) = fitted(neighbours, &terms, &weights) else { break };
            fit = next;
            scale = fit.scale(freedom).max(least_scale);
        }
    }
    Some(Prediction { off: -fit.value, scale, leverage: fit.leverage, freedom })
}

struct Fit {
    /// The polynomial at the point.
    value: f64,
    rests: Vec<f64>,
    leverage: f64,
}

impl Fit {
    fn scale(&self, freedom: usize) -> f64 {
        let mut sizes: Vec<f64> = self.rests.iter().map(|rest| rest.abs()).collect();
        let middle = sizes.len() / 2;
        let median = *sizes.select_nth_unstable_by(middle, f64::total_cmp).1;
        // The coefficients take a part of the noise.
        BY_MEDIAN * median * ((freedom + N) as f64 / freedom as f64).sqrt()
    }
}

fn terms([x, y]: [f64; 2], reach: f64) -> [f64; N] {
    let (x, y) = if reach > 0.0 { (x / reach, y / reach) } else { (0.0, 0.0) };
    [1.0, x, y, x * x, x * y, y * y]
}

/// Weighted least squares by Cholesky's method.
fn fitted(neighbours: &[Neighbour], terms: &[[f64; N]], weights: &[f64]) -> Option<Fit> {
    let mut matrix = [[0.0; N]; N];
    let mut right = [0.0; N];
    for ((one, terms), weight) in neighbours.iter().zip(terms).zip(weights) {
        for i in 0..N {
            let value = weight * terms[i];
            right[i] += value * one.rise;
            (0..=i).for_each(|j| matrix[i][j] += value * terms[j]);
        }
    }
    let largest = (0..N).map(|i| matrix[i][i]).fold(0.0, f64::max);
    for i in 0..N {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| matrix[i][k] * matrix[j][k]).sum();
            let rest = matrix[i][j] - known;
            if i > j {
                matrix[i][j] = rest / matrix[j][j];
            } else if rest > LEAST_PIVOT * largest {
                matrix[i][i] = rest.sqrt();
            } else {
                return None;
            }
        }
    }
    let coefficients = solved(&matrix, right);
    let mut first = [0.0; N];
    first[0] = 1.0;
    let leverage = solved(&matrix, first)[0];
    let value = |terms: &[f64; N]| -> f64 { terms.iter().zip(&coefficients).map(|(t, c)| t * c).sum() };
    let rests = neighbours.iter().zip(terms).map(|(one, terms)| one.rise - value(terms)).collect();
    Some(Fit { value: coefficients[0], rests, leverage })
}

fn solved(lower: &[[f64; N]; N], mut right: [f64; N]) -> [f64; N] {
    for i in 0..N {
        let known: f64 = (0..i).map(|k| lower[i][k] * right[k]).sum();
        right[i] = (right[i] - known) / lower[i][i];
    }
    for i in (0..N).rev() {
        let known: f64 = (i + 1..N).map(|k| lower[k][i] * right[k]).sum();
        right[i] = (right[i] - known) / lower[i][i];
    }
    right
}

#[cfg(test)]
mod tests {
    use super::*;

    fn neighbours(height: impl Fn(f64, f64) -> f64) -> Vec<Neighbour> {
        let at = |k: i32| [f64::from(k % 5 - 2), f64::from(k / 5 - 2)];
        let one = |(index, offset): (usize, [f64; 2])| {
            let near = Near { index, sector: 0, offset, distance: offset[0].hypot(offset[1]) };
            Neighbour { near, rise: height(offset[0], offset[1]) }
        };
        (0..25).filter(|k| *k != 12).map(at).enumerate().map(one).collect()
    }

    #[test]
    fn a_quadratic_is_predicted_and_four_mistakes_do_not_move_the_prediction() {
        let height = |x: f64, y: f64| 0.3 + x - 2.0 * y + 0.1 * x * y + 0.2 * y * y;
        let right = predicted(&neighbours(height), Robustness::None, 1e-9).unwrap();
        assert!((right.off + 0.3).abs() < 1e-13 && right.freedom == 18, "{right:?}");
        let mut wrong = neighbours(height);
        [0, 11, 12, 17].into_iter().for_each(|k| wrong[k].rise += 5.0);
        assert!((predicted(&wrong, Robustness::None, 1e-9).unwrap().off + 0.3).abs() > 0.5);
        let robust = predicted(&wrong, Robustness::Full, 1e-9).unwrap();
        assert!((robust.off + 0.3).abs() < 1e-9, "{robust:?}");
    }

    #[test]
    fn neighbours_on_a_line_predict_nothing() {
        let mut line = neighbours(|_, _| 1.0);
        line.iter_mut().for_each(|one| one.near.offset[1] = 0.5 * one.near.offset[0]);
        assert!(predicted(&line, Robustness::Full, 1e-9).is_none());
        assert!(predicted(&line[..9], Robustness::Full, 1e-9).is_none());
    }
}
