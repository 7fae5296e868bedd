//! Rails. A rail replaces several moves by two polynomials: one moves the tip, the other moves a second point
//! on the tool axis above the tip.

use std::ops::Range;

use nalgebra::{Point3, Vector3};

/// Number of Bernstein coefficients: the polynomials have degree 5.
pub const ORDER: usize = 6;

/// One pair of polynomials over the parameter 0 to 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Rail {
    /// The moves of the pass for which the rail stands.
    pub moves: Range<usize>,
    /// Bernstein coefficients of the tip, mm.
    pub tip: [Point3<f64>; ORDER],
    /// Bernstein coefficients of the vector from the tip to the second point, mm.
    pub to_second: [Vector3<f64>; ORDER],
}

impl Rail {
    /// The coefficients of the powers 2 to 5 of the parameter, of the tip and of the second point, mm. The
    /// first two follow from the ends.
    pub fn higher_powers(&self) -> [[Vector3<f64>; 4]; 2] {
        let second: [Vector3<f64>; ORDER] = std::array::from_fn(|k| self.tip[k].coords + self.to_second[k]);
        [self.tip.map(|p| p.coords), second].map(|points| {
            let all = powers(points);
            [all[2], all[3], all[4], all[5]]
        })
    }

    /// The least distance of the second point from the tip, mm: a lower bound.
    pub fn height_mm(&self) -> f64 {
        let mean: Vector3<f64> = self.to_second.iter().sum();
        let along = mean.try_normalize(0.0).unwrap_or_else(Vector3::z);
        self.to_second.iter().map(|p| p.dot(&along)).fold(f64::INFINITY, f64::min)
    }
}

/// The coefficients of the powers of the parameter: forward differences times the binomials "k of 5".
fn powers(mut points: [Vector3<f64>; ORDER]) -> [Vector3<f64>; ORDER] {
    const OF_FIVE: [f64; ORDER] = [1.0, 5.0, 10.0, 10.0, 5.0, 1.0];
    std::array::from_fn(|k| {
        let coefficient = points[0] * OF_FIVE[k];
        for i in 0..ORDER - 1 - k {
            points[i] = points[i + 1] - points[i];
        }
        coefficient
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_have_the_values_of_the_bernstein_form() {
        let points: [Vector3<f64>; ORDER] =
            std::array::from_fn(|k| Vector3::new((k * k) as f64, 1.0 / (1.0 + k as f64), (k as f64).sin()));
        let all = powers(points);
        for t in [0.0_f64, 0.3, 0.7, 1.0] {
            let mut row = points;
            for left in (1..ORDER).rev() {
                for k in 0..left {
                    row[k] = row[k].lerp(&row[k + 1], t);
                }
            }
            let sum = (0..ORDER).rev().fold(Vector3::zeros(), |sum, k| sum * t + all[k]);
            assert!((sum - row[0]).norm() < 1e-12);
        }
    }
}
