//! Points, rows and columns that repeat others.
//!
//! # Method
//! A row that lies on another, point by point, repeats it. The first and the last row may coincide: the grid
//! is closed. A point repeats its neighbour where their distance is three thousandths of the usual step of
//! the row, or less. It repeats any other point where both are exactly the same. A row or a column whose
//! points all coincide is a pole of the surface, and no mistake.

use std::collections::HashMap;

use nalgebra::Point3;

use super::Fault;
use super::sheet::transposed;

/// Largest distance of two points that count as the same point, mm.
const SAME_MM: f64 = 1e-9;

/// Points, and rows, that are apart by less than this part of the usual step were measured twice. Rows that
/// are set closely at an edge on purpose are a hundredth apart.
const SAME_PART: f64 = 3e-3;

/// Most points that repeat a distant one by mistake. A surface that touches itself has more.
const MOST_DISTANT: usize = 3;

/// What repeats something else.
pub fn coincident(rows: &[Vec<Point3<f64>>], work: &mut usize) -> Vec<Fault> {
    *work += 12 * rows.len() * rows[0].len();
    let first = rows[0][0];
    if rows.iter().flatten().all(|p| (p - first).norm() <= SAME_MM) {
        return vec![Fault::AllSame];
    }
    let columns = transposed(rows);
    let repeated: Vec<Fault> = [(rows, false), (&columns[..], true)]
        .into_iter()
        .filter_map(|(rows, is_columns)| repeated(rows, is_columns))
        .collect();
    if !repeated.is_empty() {
        return repeated;
    }
    let mut faults = doubled(rows, false);
    faults.extend(doubled(&columns, true));
    if faults.is_empty() { distant(rows) } else { faults }
}

/// Whether all points of a row coincide.
fn is_pole(row: &[Point3<f64>]) -> bool {
    row.iter().all(|p| (p - row[0]).norm() <= SAME_MM)
}

/// The first row that repeats another.
fn repeated(rows: &[Vec<Point3<f64>>], is_columns: bool) -> Option<Fault> {
    let gap = |a: &[Point3<f64>], b: &[Point3<f64>]| {
        a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
    };
    let mut gaps: Vec<f64> = rows.windows(2).map(|pair| gap(&pair[0], &pair[1])).collect();
    let usual = median(&mut gaps.clone());
    let near = gaps.iter_mut().position(|gap| *gap <= SAME_MM.max(SAME_PART * usual));
    if let Some(i) = near {
        return Some(Fault::Repeated { is_columns, number: i + 1, of: i });
    }
    let bits = |p: &Point3<f64>| [p.x, p.y, p.z].map(|x| (x + 0.0).to_bits());
    let mut known: HashMap<[[u64; 3]; 2], Vec<usize>> = HashMap::new();
    for (i, row) in rows.iter().enumerate().filter(|(_, row)| !is_pole(row)) {
        let same = known.entry([bits(&row[0]), bits(&row[row.len() - 1])]).or_default();
        let is_closing = |k: usize| k == 0 && i + 1 == rows.len();
        if let Some(of) = same.iter().copied().find(|k| rows[*k] == *row && !is_closing(*k)) {
            return Some(Fault::Repeated { is_columns, number: i, of });
        }
        same.push(i);
    }
    None
}

/// Points that repeat the point before in their row.
fn doubled(rows: &[Vec<Point3<f64>>], is_columns: bool) -> Vec<Fault> {
    let mut faults = Vec::new();
    for (i, row) in rows.iter().enumerate().filter(|(_, row)| !is_pole(row)) {
        let mut steps: Vec<f64> = row.windows(2).map(|pair| (pair[1] - pair[0]).norm()).collect();
        let usual = median(&mut steps.clone());
        for (j, step) in steps.iter_mut().enumerate() {
            if *step <= SAME_MM.max(SAME_PART * usual) {
                let [place, of] =
                    [[i, j + 1], [i, j]].map(|place| if is_columns { [place[1], place[0]] } else { place });
                faults.push(Fault::Doubled { place, of });
            }
        }
    }
    faults
}

/// Points that are exactly the same as a distant point. None where there are many: the
/// surface touches itself.
fn distant(rows: &[Vec<Point3<f64>>]) -> Vec<Fault> {
    let last = [rows.len() - 1, rows[0].len() - 1];
    let is_pole_row: Vec<bool> = rows.iter().map(|row| is_pole(row)).collect();
    let is_pole_column: Vec<bool> =
        (0..rows[0].len()).map(|j| rows.iter().all(|row| (row[j] - rows[0][j]).norm() <= SAME_MM)).collect();
    let mut known: HashMap<[u64; 3], [usize; 2]> = HashMap::with_capacity(rows.len() * rows[0].len());
    let mut faults = Vec::new();
    for (i, row) in rows.iter().enumerate() {
        for (j, p) in row.iter().enumerate() {
            if is_pole_row[i] || is_pole_column[j] {
                continue;
            }
            let of = *known.entry([p.x, p.y, p.z].map(|x| (x + 0.0).to_bits())).or_insert([i, j]);
            // The edges of a closed grid coincide.
            let is_edge = |[i, j]: [usize; 2]| [0, last[0]].contains(&i) || [0, last[1]].contains(&j);
            if of != [i, j] && !(is_edge(of) && is_edge([i, j])) {
                faults.push(Fault::Doubled { place: [i, j], of });
                if faults.len() > MOST_DISTANT {
                    return Vec::new();
                }
            }
        }
    }
    faults
}

fn median(values: &mut [f64]) -> f64 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}
