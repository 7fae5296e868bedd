//! Faults of a grid's points that make no surface, or one that nobody meant: named before anything is computed.

use nalgebra::Point3;

use crate::http::dto::check::Violations;
use crate::http::dto::point::Point;
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;

/// Points that are nearer than this are the same, mm.
const SAME_MM: f64 = 1e-9;

/// A row runs the other way if its points in reverse lie nearer to the row before: their distances in sum are less than this part of
/// the sum in the given order.
const REVERSED_PART: f64 = 0.5;

/// Blames the first row or column that repeats the one before it, and the first row that runs the other way; a grid whose
/// points are all the same as a whole. Rows are as long as the first.
pub fn check(at: &Pointer, points: &[Vec<Point>], violations: &mut Violations) {
    let rows: Vec<Vec<Point3<f64>>> =
        points.iter().map(|row| row.iter().copied().map(Point3::from).collect()).collect();
    let columns = rows.first().map_or(0, Vec::len);
    if columns == 0 || rows.iter().any(|row| row.len() != columns) {
        return;
    }
    let is_same = |a: &Point3<f64>, b: &Point3<f64>| (a - b).norm() <= SAME_MM;
    let first = rows[0][0];
    if rows.iter().flatten().all(|p| is_same(p, &first)) {
        violations.add(at, FieldCode::Coincident, "all points are the same");
        return;
    }
    let repeats = |pair: &[Vec<Point3<f64>>]| pair[0].iter().zip(&pair[1]).all(|(a, b)| is_same(a, b));
    if let Some(i) = rows.windows(2).position(repeats) {
        let detail = format!("row {} repeats row {i}: leave one of them out", i + 1);
        violations.add(&at.index(i + 1), FieldCode::Coincident, detail);
    }
    let repeats = |j: &usize| rows.iter().all(|row| is_same(&row[*j], &row[j - 1]));
    if let Some(j) = (1..columns).find(repeats) {
        let detail = format!("column {j} repeats column {} in every row: leave one of them out", j - 1);
        violations.add(&at.index(0).index(j), FieldCode::Coincident, detail);
    }
    if let Some(i) = rows.windows(2).position(|pair| is_reversed(&pair[0], &pair[1])) {
        let detail =
            format!("row {} runs the other way than row {i}: reverse it, so that all rows run alike", i + 1);
        violations.add(&at.index(i + 1), FieldCode::ReversedRow, detail);
    }
}

fn is_reversed(before: &[Point3<f64>], row: &[Point3<f64>]) -> bool {
    let straight: f64 = before.iter().zip(row).map(|(a, b)| (a - b).norm()).sum();
    let reversed: f64 = before.iter().zip(row.iter().rev()).map(|(a, b)| (a - b).norm()).sum();
    reversed < REVERSED_PART * straight
}
