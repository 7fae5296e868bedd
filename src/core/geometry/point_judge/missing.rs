//! Numbers that stand for a missing value, and values that many points have and no part can have.
//!
//! # Method
//! A number that files use for a missing value, such as -9999, is taken as one where it lies apart from all
//! other values of its coordinate: farther than they spread. Any other number at the end of a coordinate's
//! range is taken as one where several points have exactly this value, and it lies farther from all others
//! than ten times the size of the part.

use nalgebra::Point3;

use super::Fault;

/// Numbers that programs of measuring and mapping write for a missing value, without their sign.
const NO_DATA: [f64; 15] = [
    999.0, 999.9, 999.99, 999.999, 9_999.0, 9_999.9, 9_999.99, 9_999.999, 32_767.0, 32_768.0, 65_535.0,
    99_999.0, 99_999.9, 99_999.99, 999_999.0,
];

/// Least gap beside a value that several points share, in sizes of the rest of the part.
const ABSURD: f64 = 10.0;

/// Such points are at most one in this many.
const FEW: usize = 4;

/// The missing values among the coordinates `axes`. The faults stand in the order of the rows.
pub fn missing(rows: &[Vec<Point3<f64>>], axes: &[usize], work: &mut usize) -> Vec<Fault> {
    let mut faults = Vec::new();
    *work += 8 * axes.len() * rows.iter().map(Vec::len).sum::<usize>();
    let absent: Vec<(usize, f64)> = axes.iter().flat_map(|axis| absent(rows, *axis)).collect();
    if absent.is_empty() {
        return faults;
    }
    for (i, row) in rows.iter().enumerate() {
        for (j, p) in row.iter().enumerate() {
            if let Some((axis, value)) = absent.iter().find(|(axis, value)| p[*axis] == *value) {
                faults.push(Fault::Missing { place: [i, j], axis: *axis, value: *value });
            }
        }
    }
    faults
}

/// The values of a coordinate that stand for a missing value.
fn absent(rows: &[Vec<Point3<f64>>], axis: usize) -> Vec<(usize, f64)> {
    let is_code = |value: f64| NO_DATA.contains(&value.abs());
    let points = || rows.iter().flatten();
    let usual = || points().filter(|p| !p.iter().any(|x| is_code(*x)));
    let [low, high] = range(usual().map(|p| p[axis]));
    let mut found = Vec::new();
    if low <= high {
        for code in NO_DATA.iter().flat_map(|code| [*code, -code]) {
            let gap = (low - code).max(code - high);
            if gap > high - low && points().any(|p| p[axis] == code) {
                found.push((axis, code));
            }
        }
    }
    if !found.is_empty() {
        return found;
    }
    let [low, high] = range(points().map(|p| p[axis]));
    for (end, sign) in [(low, -1.0), (high, 1.0)] {
        let is_end = |p: &&Point3<f64>| p[axis] == end;
        let n_rest = points().filter(|p| !is_end(p)).count();
        let n_end = points().filter(is_end).count();
        if n_end < 2 || FEW * n_end > n_rest {
            continue;
        }
        let size = (0..3)
            .map(|k| range(points().filter(|p| !is_end(p)).map(|p| p[k])))
            .fold(0.0f64, |size, [low, high]| size.max(high - low));
        let [low, high] = range(points().filter(|p| !is_end(p)).map(|p| p[axis]));
        let gap = if sign > 0.0 { end - high } else { low - end };
        if gap > ABSURD * size {
            found.push((axis, end));
        }
    }
    found
}

/// The least and the largest value.
fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
}
