//! Axes that were exchanged.
//!
//! # Method
//! The part of each cell of the grid that is seen from above is compared with the cell. Where the cells stand
//! steeply, and some face up and some face down, the sheet is folded, as no surface that is milled from above
//! is. Where exchanging z with another axis makes it a plain sheet that faces one way, the axes were
//! exchanged.

use nalgebra::{Point3, Vector3};

use super::Fault;

/// Largest part of the area that is seen along z in a grid with exchanged axes.
const STANDS: f64 = 0.5;

/// Least part of the area that is seen along the right axis.
const LIES: f64 = 0.75;

/// Largest part of the area seen that faces one way, of a grid that is folded; and least part of a plain one.
const FOLDED: f64 = 0.9;
const PLAIN: f64 = 0.99;

/// The axes that were exchanged, if that is certain.
pub fn exchanged(rows: &[Vec<Point3<f64>>], work: &mut usize) -> Option<Fault> {
    *work += 4 * rows.len() * rows[0].len();
    let mut whole = 0.0;
    let (mut seen, mut sum) = (Vector3::zeros(), Vector3::zeros());
    for pair in rows.windows(2) {
        for j in 0..pair[0].len() - 1 {
            let area = (pair[1][j + 1] - pair[0][j]).cross(&(pair[0][j + 1] - pair[1][j])) * 0.5;
            whole += area.norm();
            seen += area.abs();
            sum += area;
        }
    }
    if whole <= 0.0 {
        return None;
    }
    // The part of the area seen along an axis that faces its larger side.
    let one_way = |axis: usize| if seen[axis] > 0.0 { 0.5 + 0.5 * sum[axis].abs() / seen[axis] } else { 0.5 };
    let is_wrong = seen.z < STANDS * whole && one_way(2) < FOLDED;
    let is_right = |axis: usize| seen[axis] > LIES * whole && one_way(axis) > PLAIN;
    let axis = [1, 0].into_iter().find(|axis| is_right(*axis))?;
    is_wrong.then_some(Fault::ExchangedAxes { axis })
}
