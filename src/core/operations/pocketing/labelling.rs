//! Islands by sequential labelling and edge detection on a grid of heights: the way of the paper.
//!
//! # Method
//! A point of the grid is 1 where the part is higher than the level's floor, else 0. A point that is 1 and
//! has a 0 to the left, to the right, above or below is an edge. Each point stands for the square cell about
//! it. The boundary of the islands consists of the sides between edge cells and cells that are 0. The sides
//! are joined into closed chains. The chains separate the islands, so the cells need no labels of their own.
//!
//! # Differences from the paper
//! The paper joins the edge points themselves. An island of a single row of points would then have no area.
//!
//! # Guarantees
//! None about the part between the points: a boundary is wrong by up to a cell. The report states how deep
//! the path cuts into the part.

use std::collections::HashMap;

use nalgebra::Point2;

use super::PocketError;
use crate::budget::Budget;
use crate::geometry::height_field::{HeightField, HeightGrid, SAME_HEIGHT_MM};
use crate::geometry::region::Region;
use crate::geometry::segment::Segment;

/// The largest number of cells.
pub const MOST_CELLS: usize = 1_000_000;

/// How far outside a triangle a point still has its height, in cells, and as a part of the height of the
/// triangle in the plane. A point on a side belongs to both triangles, and rounding must not leave it to
/// neither.
const OUTSIDE: f64 = 1e-9;

/// The heights of a field at the points of a grid; minus infinity at points outside the field.
pub fn sampled(field: &HeightField, cell_mm: f64, budget: &Budget) -> Result<HeightGrid, PocketError> {
    let (mut low, mut high) = (Point2::from([f64::INFINITY; 2]), Point2::from([f64::NEG_INFINITY; 2]));
    field.for_each_facet(budget, |facet| {
        for corner in facet.corners {
            (low, high) = (low.inf(&corner.xy()), high.sup(&corner.xy()));
        }
    })?;
    let counts = [high.x - low.x, high.y - low.y].map(|extent| (extent / cell_mm + OUTSIDE).floor() + 1.0);
    // Written so that NaN is refused.
    let is_small = counts[0] * counts[1] <= MOST_CELLS as f64;
    if !is_small {
        return Err(PocketError::TooManyCells { limit: MOST_CELLS });
    }
    let [columns, n_rows] = counts.map(|count| count as usize);
    let mut rows = vec![vec![f64::NEG_INFINITY; columns]; n_rows];
    let index = |x: f64, most: usize| (x.max(0.0) as usize).min(most - 1);
    field.for_each_facet(budget, |facet| {
        let [a, b, c] = facet.corners;
        let (from, to) = (a.inf(&b).inf(&c), a.sup(&b).sup(&c));
        let first = (from.xy() - low) / cell_mm;
        let last = (to.xy() - low) / cell_mm;
        let double = (b.xy() - a.xy()).perp(&(c.xy() - a.xy()));
        let columns = index((first.x - OUTSIDE).ceil(), columns)..=index(last.x + OUTSIDE, columns);
        let rows_about = index((first.y - OUTSIDE).ceil(), n_rows)..=index(last.y + OUTSIDE, n_rows);
        for (j, row) in rows.iter_mut().enumerate().take(rows_about.end() + 1).skip(*rows_about.start()) {
            for (i, height) in row.iter_mut().enumerate().take(columns.end() + 1).skip(*columns.start()) {
                let p = Point2::new(low.x + cell_mm * i as f64, low.y + cell_mm * j as f64);
                let weight = |q: Point2<f64>, r: Point2<f64>| (q - p).perp(&(r - p)) / double;
                let weights = [weight(b.xy(), c.xy()), weight(c.xy(), a.xy()), weight(a.xy(), b.xy())];
                if double > 0.0 && weights.iter().all(|weight| *weight >= -OUTSIDE) {
                    *height = height.max(weights[0] * a.z + weights[1] * b.z + weights[2] * c.z);
                }
            }
        }
    })?;
    Ok(HeightGrid { origin: low, spacing_mm: cell_mm, rows })
}

/// The region of the cells whose points are not higher than `z_mm`.
pub fn low_cells(grid: &HeightGrid, z_mm: f64, budget: &Budget) -> Result<Region, PocketError> {
    let (columns, n_rows) = (grid.rows.first().map_or(0, Vec::len), grid.rows.len());
    let is_low = |i: usize, j: usize| {
        // Nothing is cleared outside the grid.
        (1..=columns).contains(&i)
            && (1..=n_rows).contains(&j)
            && grid.rows[j - 1][i - 1] <= z_mm + SAME_HEIGHT_MM
    };
    // The sides between a low cell and a cell that is not low, from corner to corner, with the low cell on
    // the left. Where four sides meet, the two sides of the same low cell are joined.
    let mut next: HashMap<(usize, usize), Vec<(usize, usize)>> = HashMap::new();
    let mut add = |from: (usize, usize), to: (usize, usize)| next.entry(from).or_default().push(to);
    for j in 1..=n_rows {
        budget.check()?;
        for i in (1..=columns).filter(|i| is_low(*i, j)) {
            let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
            let beside = [(i, j - 1), (i + 1, j), (i, j + 1), (i - 1, j)];
            for k in (0..4).filter(|k| !is_low(beside[*k].0, beside[*k].1)) {
                add(corners[k], corners[(k + 1) % 4]);
            }
        }
    }
    let place = |(i, j): (usize, usize)| {
        // The outermost cells end on the edge of the grid.
        let inside = |k: usize, most: usize| (k as f64 - 1.5).clamp(0.0, most as f64 - 1.0);
        grid.origin + nalgebra::Vector2::new(inside(i, columns), inside(j, n_rows)) * grid.spacing_mm
    };
    let mut starts: Vec<(usize, usize)> = next.keys().copied().collect();
    starts.sort_unstable();
    let mut chains = Vec::new();
    for start in starts {
        while next.contains_key(&start) {
            let (mut chain, mut at, mut before) = (Vec::new(), start, None);
            while let Some(ways) = next.get_mut(&at) {
                let k = leftmost(at, before, ways);
                let to = ways.swap_remove(k);
                if ways.is_empty() {
                    next.remove(&at);
                }
                let line = Segment::Line { start: place(at), end: place(to) };
                if line.length() > 0.0 {
                    chain.push(line);
                }
                (before, at) = (Some(at), to);
                if at == start {
                    break;
                }
            }
            if !chain.is_empty() {
                chains.push(chain);
            }
        }
    }
    Ok(Region::on_the_left(&chains, budget)?)
}

/// The index of the side that turns left. So cells that meet only at a corner stay apart.
fn leftmost(at: (usize, usize), before: Option<(usize, usize)>, ways: &[(usize, usize)]) -> usize {
    let Some(before) = before else { return 0 };
    let step =
        |from: (usize, usize), to: (usize, usize)| (to.0 as i64 - from.0 as i64, to.1 as i64 - from.1 as i64);
    let (x, y) = step(before, at);
    ways.iter().position(|way| step(at, *way) == (-y, x)).unwrap_or(0)
}
