//! Finds curves, and loops, that are drawn twice.
//!
//! Two curves are the same if their vertices lie within a tolerance of each other, one by one, in either
//! direction and, for loops, from any first vertex, and if the middles of their arcs do. A curve that is
//! hardly larger than the tolerance has to be the same exactly: it may as well be the next piece of a fine
//! outline.
//!
//! # Cost
//! O(n) for n vertices, besides curves of one size about one place.

use std::collections::HashMap;

use toolpathd_core::budget::{Budget, Stopped};

use super::bulge;

/// Curves smaller than this many tolerances are compared exactly.
const LEAST_SIZE: f64 = 100.0;

/// The most first vertices of a loop that are tried. More serve only loops that pass one place many times.
const MOST_ROTATIONS: usize = 8;

/// The least size of a cell, mm, where the tolerance is zero.
const LEAST_CELL_MM: f64 = 1e-9;

/// The items that repeat no earlier one; `tell` is called for each of the others.
///
/// # Errors
/// When the budget ends.
pub fn without_copies<T>(
    items: Vec<T>,
    shape: impl Fn(&T) -> (&[[f64; 3]], bool),
    tolerance_mm: f64,
    budget: &Budget,
    mut tell: impl FnMut(&T),
) -> Result<Vec<T>, Stopped> {
    let cell_mm = (2.0 * tolerance_mm).max(LEAST_CELL_MM);
    let mut known: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    let mut kept: Vec<T> = Vec::with_capacity(items.len());
    for item in items {
        budget.check()?;
        let (vertices, is_closed) = shape(&item);
        let [x, y, size] = place_and_size(vertices);
        let within_mm = if size < LEAST_SIZE * tolerance_mm { 0.0 } else { tolerance_mm };
        // A number beyond the range of `i64` is the last of the range.
        let cell = [x, y, size].map(|number| (number / cell_mm).floor() as i64);
        let is_copy = around(cell).filter_map(|cell| known.get(&cell)).flatten().any(|other| {
            let (others, is_other_closed) = shape(&kept[*other]);
            is_closed == is_other_closed && are_same(vertices, others, is_closed, within_mm)
        });
        if is_copy {
            tell(&item);
        } else {
            known.entry(cell).or_default().push(kept.len());
            kept.push(item);
        }
    }
    Ok(kept)
}

/// The middle of the box around the vertices, and the sum of its sides.
fn place_and_size(vertices: &[[f64; 3]]) -> [f64; 3] {
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for vertex in vertices {
        for k in 0..2 {
            low[k] = low[k].min(vertex[k]);
            high[k] = high[k].max(vertex[k]);
        }
    }
    [0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), (high[0] - low[0]) + (high[1] - low[1])]
}

/// A cell and its neighbours.
fn around([x, y, size]: [i64; 3]) -> impl Iterator<Item = [i64; 3]> {
    let near = |at: i64| [at.saturating_sub(1), at, at.saturating_add(1)];
    near(x)
        .into_iter()
        .flat_map(move |x| near(y).into_iter().flat_map(move |y| near(size).map(|size| [x, y, size])))
}

fn are_same(one: &[[f64; 3]], other: &[[f64; 3]], is_closed: bool, within_mm: f64) -> bool {
    if one.len() != other.len() {
        return false;
    }
    let n = one.len();
    let is_near =
        |a: &[f64; 3], b: &[f64; 3]| (a[0] - b[0]).abs() <= within_mm && (a[1] - b[1]).abs() <= within_mm;
    let starts = |others: &[[f64; 3]]| -> Vec<usize> {
        let count = if is_closed { n } else { 1 };
        (0..count).filter(|k| is_near(&one[0], &others[*k])).take(MOST_ROTATIONS).collect()
    };
    let is_along = |others: &[[f64; 3]]| {
        starts(others).into_iter().any(|start| {
            (0..n).all(|k| {
                let (a, b) = (&one[k], &others[(start + k) % n]);
                let next = &one[(k + 1) % n];
                let chord = f64::hypot(next[0] - a[0], next[1] - a[1]);
                is_near(a, b) && 0.5 * chord * (a[2] - b[2]).abs() <= within_mm
            })
        })
    };
    is_along(other) || is_along(&bulge::reversed(other, is_closed))
}
