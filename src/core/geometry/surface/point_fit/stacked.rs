//! Points one above the other: places in plan with two heights.
//!
//! # Method
//! The plan is divided into cells that are much smaller than the usual spacing of points. In each cell the
//! lowest and the highest point are compared.
//!
//! # Cost
//! O(n log n) for n points.

use nalgebra::Point3;

/// The side of a cell, as a part of the side of a cell of two points.
const SIDE: f64 = 0.05;

/// Points rise more steeply than this (87 degrees) only where they are no function of the place.
const STEEP: f64 = 20.0;

/// The largest part of the points that may be stacked because of outliers.
pub const MOST: f64 = 0.01;

/// Two points, the lower one first, and how far apart they are in height, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    pub pair: [usize; 2],
    pub rise: f64,
}

/// A pair for each cell with points that are more than `rise` apart in height, among the points `chosen`.
/// `side` is that of a cell of two points, mm.
pub fn stacked(
    chosen: &[usize],
    places: &[[f64; 2]],
    points: &[Point3<f64>],
    side: f64,
    rise: f64,
) -> Vec<Pair> {
    let side = SIDE * side;
    let cell = |k: usize| places[k].map(|x| (x / side).floor() as i64);
    let mut by_cell: Vec<([i64; 2], usize)> = chosen.iter().map(|k| (cell(*k), *k)).collect();
    by_cell.sort_unstable();
    let least = rise + STEEP * side * std::f64::consts::SQRT_2;
    let groups = by_cell.chunk_by(|a, b| a.0 == b.0);
    let pair = |group: &[([i64; 2], usize)]| {
        let height = |one: &&([i64; 2], usize)| points[one.1].z;
        let low = group.iter().min_by(|a, b| height(a).total_cmp(&height(b)))?.1;
        let high = group.iter().max_by(|a, b| height(a).total_cmp(&height(b)))?.1;
        let rise = points[high].z - points[low].z;
        (rise > least).then_some(Pair { pair: [low, high], rise })
    };
    groups.filter_map(pair).collect()
}
