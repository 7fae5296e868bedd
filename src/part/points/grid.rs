//! Points in any order as a grid: rows and columns at right angles, turned in plan by any angle, with any
//! spacing.
//!
//! # Method
//! 1. The direction of the rows: the mean direction of nearest neighbours, modulo a right angle. It is made
//!    finer by straight lines through the points of rows, first near the middle, then ever farther out.
//! 2. Rows: the points in the order of their distance from a line along the direction, divided where two
//!    neighbours are more than half of the least spacing apart. Columns: the same at a right angle.
//! 3. The points are a grid if there is one in each row and column, and none is farther than a stated
//!    distance from the middle of its row and of its column.
//!
//! # Cost
//! O(n log n) for n points.

use super::neighbours;
use toolpathd_core::budget::{Budget, Stopped};

/// The part of the least spacing by which two points are apart if they belong to different rows.
const PART_OF_SPACING: f64 = 0.5;

/// The quantile of the distances to the nearest neighbour that counts as the least spacing.
const LEAST_QUANTILE: f64 = 0.05;

/// How many spacings the first part of the points reaches from the middle, and how much farther the next.
const FIRST_REACH: f64 = 6.0;
const FARTHER: f64 = 3.0;

/// The usual distance of a point from row and column, as a part of the least spacing.
pub const USUAL_PART: f64 = 0.1;

/// Points in rows and columns.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// `rows[j][i]` is the number of the point in row j, from below, and column i, from the left.
    pub rows: Vec<Vec<usize>>,
    /// The direction of the rows against x, radians, within an eighth of a turn.
    pub angle: f64,
    /// The largest distance of a point from the middle of its row or column in plan, in the unit of the
    /// points.
    pub off: f64,
    /// A small distance of nearest neighbours, in the unit of the points: one in twenty is smaller.
    pub spacing: f64,
}

/// Why points are no grid.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NoGrid {
    #[error("there are {count} points; a grid has at least two rows and two columns")]
    TooFew { count: usize },
    #[error("many points have the same x and y")]
    Doubled { point: usize },
    #[error("rows are unequal: most have {most} points, and one has {count}")]
    Ragged { most: usize, count: usize, point: usize },
    #[error("a point is {off} off its row or column, more than {within}")]
    Off { off: f64, within: f64, point: usize },
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

/// Puts points into rows and columns. `within` is the largest distance of a point from its row and column in
/// plan, in the unit of the points; without it [`USUAL_PART`] of the least spacing.
///
/// # Errors
/// Why the points are no grid, with the number of a point at fault; the budget's stop.
pub fn grid(points: &[[f64; 3]], within: Option<f64>, budget: &Budget) -> Result<Grid, NoGrid> {
    if points.len() < 4 {
        return Err(NoGrid::TooFew { count: points.len() });
    }
    let middle = middle(points);
    let plan: Vec<[f64; 2]> = points.iter().map(|p| [p[0] - middle[0], p[1] - middle[1]]).collect();
    let neighbours = neighbours::ways(&plan, budget)?;
    let spacing = least_spacing(&neighbours);
    if spacing <= 0.0 {
        let point = neighbours.iter().position(|offset| *offset == [0.0; 2]).unwrap_or_default();
        return Err(NoGrid::Doubled { point });
    }
    let angle = refined(&plan, mean_direction(&neighbours), spacing, budget)?;
    let turned: Vec<[f64; 2]> = plan.iter().map(|&p| turned(p, -angle)).collect();
    budget.check()?;
    let rows = divided(&turned, 1, PART_OF_SPACING * spacing);
    let columns = divided(&turned, 0, PART_OF_SPACING * spacing);
    check_counts(&rows, columns.len())?;
    check_counts(&columns, rows.len())?;
    if rows.len() < 2 || columns.len() < 2 {
        return Err(NoGrid::TooFew { count: points.len() });
    }
    let (off, point) = [(&rows, 1), (&columns, 0)]
        .into_iter()
        .flat_map(|(lines, axis)| lines.iter().map(move |line| (line, axis)))
        .map(|(line, axis)| off_middle(&turned, line, axis))
        .fold((0.0, 0), |worst, own| if own.0 > worst.0 { own } else { worst });
    let within = within.unwrap_or(USUAL_PART * spacing);
    if off > within {
        return Err(NoGrid::Off { off, within, point });
    }
    let mut column_of = vec![0; points.len()];
    for (k, column) in columns.iter().enumerate() {
        column.iter().for_each(|&point| column_of[point] = k);
    }
    let in_order = |mut row: Vec<usize>| {
        row.sort_by_key(|&point| column_of[point]);
        row
    };
    let rows: Vec<Vec<usize>> = rows.into_iter().map(in_order).collect();
    for row in &rows {
        if let Some(pair) = row.windows(2).find(|pair| column_of[pair[0]] == column_of[pair[1]]) {
            return Err(NoGrid::Doubled { point: pair[1] });
        }
    }
    Ok(Grid { rows, angle, off, spacing })
}

/// The middle of the box around points in plan.
fn middle(points: &[[f64; 3]]) -> [f64; 2] {
    [0, 1].map(|axis| {
        let values = points.iter().map(|point| point[axis]);
        let (low, high) =
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        0.5 * (low + high)
    })
}

fn turned([x, y]: [f64; 2], angle: f64) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    [x * cos - y * sin, x * sin + y * cos]
}

fn least_spacing(neighbours: &[[f64; 2]]) -> f64 {
    let mut distances: Vec<f64> = neighbours.iter().map(|way| way[0].hypot(way[1])).collect();
    let at = (LEAST_QUANTILE * distances.len() as f64) as usize;
    *distances.select_nth_unstable_by(at, f64::total_cmp).1
}

/// The mean direction of the neighbours, modulo a right angle, within an eighth of a turn.
fn mean_direction(neighbours: &[[f64; 2]]) -> f64 {
    let sum = neighbours.iter().fold([0.0; 2], |sum, way| {
        let (sin, cos) = (4.0 * way[1].atan2(way[0])).sin_cos();
        [sum[0] + cos, sum[1] + sin]
    });
    0.25 * sum[1].atan2(sum[0])
}

/// The direction of the rows, by straight lines through the points of each row.
fn refined(plan: &[[f64; 2]], mut angle: f64, spacing: f64, budget: &Budget) -> Result<f64, Stopped> {
    let whole = plan.iter().flatten().fold(0.0_f64, |reach, value| reach.max(value.abs()));
    let mut reach = FIRST_REACH * spacing;
    loop {
        budget.check()?;
        let near: Vec<[f64; 2]> =
            plan.iter().filter(|p| p[0].abs().max(p[1].abs()) <= reach).map(|&p| turned(p, -angle)).collect();
        angle += slope(&near, spacing);
        if reach > 2.0 * whole {
            return Ok(angle);
        }
        reach *= FARTHER;
    }
}

/// The common slope of the rows and, turned by a right angle, the columns.
fn slope(turned: &[[f64; 2]], spacing: f64) -> f64 {
    let (mut mixed, mut squared) = (0.0, 0.0);
    for (axis, sign) in [(1, 1.0), (0, -1.0)] {
        for line in divided(turned, axis, PART_OF_SPACING * spacing) {
            let count = line.len() as f64;
            let mean = |axis: usize| line.iter().map(|&k| turned[k][axis]).sum::<f64>() / count;
            let (along, across) = (mean(1 - axis), mean(axis));
            for &k in &line {
                let (a, b) = (turned[k][1 - axis] - along, turned[k][axis] - across);
                mixed += sign * a * b;
                squared += a * a;
            }
        }
    }
    if squared > 0.0 { (mixed / squared).atan() } else { 0.0 }
}

/// The points in the order of a coordinate, divided where neighbours are farther apart than `gap`.
fn divided(turned: &[[f64; 2]], axis: usize, gap: f64) -> Vec<Vec<usize>> {
    let mut order: Vec<usize> = (0..turned.len()).collect();
    order.sort_by(|a, b| turned[*a][axis].total_cmp(&turned[*b][axis]));
    order.chunk_by(|a, b| turned[*b][axis] - turned[*a][axis] <= gap).map(<[usize]>::to_vec).collect()
}

fn check_counts(lines: &[Vec<usize>], expected: usize) -> Result<(), NoGrid> {
    let mut sizes: Vec<usize> = lines.iter().map(Vec::len).collect();
    sizes.sort_unstable();
    let most = sizes.get(sizes.len() / 2).copied().unwrap_or_default();
    let odd = lines.iter().find(|line| line.len() != most);
    match odd.or_else(|| lines.first().filter(|_| most != expected)) {
        Some(line) => Err(NoGrid::Ragged { most: expected.max(most), count: line.len(), point: line[0] }),
        None => Ok(()),
    }
}

/// The largest distance of a point of a line from the middle of the line, and the point.
fn off_middle(turned: &[[f64; 2]], line: &[usize], axis: usize) -> (f64, usize) {
    let mean = line.iter().map(|&k| turned[k][axis]).sum::<f64>() / line.len() as f64;
    let own = line.iter().map(|&k| ((turned[k][axis] - mean).abs(), k));
    own.fold((0.0, 0), |worst, own| if own.0 > worst.0 { own } else { worst })
}
