//! Bounds of the second derivatives of B-spline surfaces.
//!
//! # Method
//! Each knot span is cut into parts, whose Bezier pieces have bounds (`bezier_bounds`). Where a knot is as
//! often as the degree, the first derivative may jump: the jump times the square of the denominator is a
//! polynomial along the knot, which its control points bound.

use nalgebra::Vector4;
use toolpathd_core::budget::{Budget, Stopped};

use super::bezier_bounds::{Net, along_u, numerator, seconds, transposed};
use super::curve_bounds::parted;
use crate::step::basis;
use crate::step::spline_surface::SplineSurface;

/// The least number of parts along each parameter, so that the bounds of a part hold for little more than
/// itself.
const LEAST_PARTS: usize = 12;

/// A jump of the first derivative below this part of its size is rounding.
const NO_JUMP: f64 = 1e-9;

/// Bounds of the second derivatives of one surface.
#[derive(Debug, Clone)]
pub struct SplineBounds {
    /// The ends of the parts along u and v.
    ends: [Vec<f64>; 2],
    /// Bounds of the derivatives along uu, uv and vv for each part along u and v.
    seconds: Vec<Vec<[f64; 3]>>,
    /// Parameters along u and v where the first derivative jumps, with how far at most.
    jumps: [Vec<(f64, f64)>; 2],
    is_closed: [bool; 2],
}

impl SplineBounds {
    /// # Errors
    /// The budget has ended.
    pub fn new(spline: &SplineSurface, budget: &Budget) -> Result<Self, Stopped> {
        let breaks = [0, 1].map(|k| spline.breaks(k));
        let ends = [0, 1].map(|k| {
            let spans = breaks[k].len() - 1;
            let n = LEAST_PARTS.div_ceil(spans);
            let starts = breaks[k].windows(2).flat_map(|pair| parted([pair[0], pair[1]], n));
            let mut ends: Vec<f64> = starts.map(|[from, _]| from).collect();
            ends.extend(breaks[k].last());
            ends
        });
        let piece = |u: &[f64], v: &[f64]| {
            seconds(&net(spline, [[u[0], u[1]], [v[0], v[1]]]), [u[1] - u[0], v[1] - v[0]])
        };
        let mut seconds = Vec::with_capacity(ends[0].len() - 1);
        for u in ends[0].windows(2) {
            let mut row = Vec::with_capacity(ends[1].len() - 1);
            for v in ends[1].windows(2) {
                budget.check()?;
                row.push(piece(u, v));
            }
            seconds.push(row);
        }
        let jumps = [0, 1].map(|along| jumps(spline, along, &breaks));
        Ok(Self { ends, seconds, jumps, is_closed: spline.is_closed })
    }

    /// Bounds along uu, uv and vv over a rectangle.
    pub fn over(&self, ranges: [[f64; 2]; 2]) -> [f64; 3] {
        let [us, vs] = [0, 1].map(|k| self.touched(k, ranges[k]));
        let mut most = [0.0_f64; 3];
        for i in us.iter().flat_map(|range| range.clone()) {
            for j in vs.iter().flat_map(|range| range.clone()) {
                most = [0, 1, 2].map(|k| most[k].max(self.seconds[i][j][k]));
            }
        }
        most
    }

    /// The jumps strictly within a range along u or v.
    pub fn kinks(&self, along: usize, [from, to]: [f64; 2]) -> Vec<(f64, f64)> {
        let ends = &self.ends[along];
        let (start, length) = (ends[0], ends[ends.len() - 1] - ends[0]);
        let least = 1e-12 * (to - from);
        let first = if self.is_closed[along] { ((from - start) / length).floor() } else { 0.0 };
        let n = if self.is_closed[along] { 3 } else { 1 };
        let turns = (0..n).map(|turn| (first + f64::from(turn)) * length);
        let all = turns.flat_map(|shift| self.jumps[along].iter().map(move |(t, jump)| (t + shift, *jump)));
        all.filter(|(t, _)| *t > from + least && *t < to - least).collect()
    }

    /// The parts that a range touches.
    fn touched(&self, along: usize, [from, to]: [f64; 2]) -> Vec<std::ops::Range<usize>> {
        let ends = &self.ends[along];
        let n = ends.len() - 1;
        let (start, end) = (ends[0], ends[n]);
        let of = |from: f64, to: f64| {
            let first = ends[1..n].partition_point(|t| *t <= from);
            let last = ends[1..n].partition_point(|t| *t < to);
            first..last.max(first) + 1
        };
        if !self.is_closed[along] {
            return vec![of(from, to)];
        }
        let length = end - start;
        if to - from >= length {
            return std::iter::once(0..n).collect();
        }
        let shift = ((from - start) / length).floor() * length;
        let (from, to) = (from - shift, to - shift);
        if to <= end { vec![of(from, to)] } else { vec![of(from, end), of(start, to - length)] }
    }
}

/// The control points over a rectangle within one span along u and v.
fn net(spline: &SplineSurface, [u, v]: [[f64; 2]; 2]) -> Net {
    let nurbs = &spline.nurbs;
    let spans = [(0, u), (1, v)].map(|(k, range)| basis::span(nurbs.degree[k], &nurbs.knots[k], range[0]));
    let window = |k: usize| &nurbs.knots[k][spans[k] - nurbs.degree[k]..=spans[k] + nurbs.degree[k] + 1];
    let part =
        |k: usize, points: &[Vector4<f64>], range| basis::part(nurbs.degree[k], window(k), points, range).1;
    let rows: Vec<Vec<Vector4<f64>>> = (spans[0] - nurbs.degree[0]..=spans[0])
        .map(|i| {
            let row: Vec<Vector4<f64>> =
                (spans[1] - nurbs.degree[1]..=spans[1]).map(|j| spline.lifted(i, j)).collect();
            part(1, &row, v)
        })
        .collect();
    transposed(&transposed(&rows).iter().map(|column| part(0, column, u)).collect::<Net>())
}

/// Where the first derivative along u or v jumps.
fn jumps(spline: &SplineSurface, along: usize, breaks: &[Vec<f64>; 2]) -> Vec<(f64, f64)> {
    let (degree, knots) = (spline.nurbs.degree[along], &spline.nurbs.knots[along]);
    let n = breaks[along].len() - 1;
    let may_jump = |k: usize| {
        let occurs = knots.iter().filter(|knot| **knot == breaks[along][k]).count();
        if k == 0 { spline.is_closed[along] } else { occurs >= degree }
    };
    let mut found = Vec::new();
    for k in (0..n).filter(|k| may_jump(*k)) {
        let mut most = 0.0_f64;
        for other in breaks[1 - along].windows(2) {
            let piece = |k: usize| {
                let range = [breaks[along][k], breaks[along][k + 1]];
                let net = if along == 0 {
                    net(spline, [range, [other[0], other[1]]])
                } else {
                    transposed(&net(spline, [[other[0], other[1]], range]))
                };
                (net, range[1] - range[0])
            };
            most = most.max(jump(&piece((k + n - 1) % n), &piece(k)));
        }
        if most > 0.0 {
            found.push((breaks[along][k], most));
        }
    }
    found
}

/// The most by which the derivative along u jumps from the end of a piece to the start of the next one; 0 for
/// rounding.
fn jump((before, before_length): &(Net, f64), (after, after_length): &(Net, f64)) -> f64 {
    let (before, slopes) = (&before[before.len() - 1], along_u(before, *before_length));
    let (slopes_before, slopes_after) = (&slopes[slopes.len() - 1], &along_u(after, *after_length)[0]);
    // The pieces meet up to rounding and up to a factor of the weights.
    let factor = before[0].w / after[0][0].w;
    let difference: Vec<Vector4<f64>> =
        slopes_after.iter().zip(slopes_before).map(|(a, b)| a * factor - b).collect();
    let least = before.iter().map(|p| p.w).fold(f64::MAX, f64::min);
    let centre = before[0].xyz() / before[0].w;
    let moved = |row: &[Vector4<f64>]| -> Net {
        vec![row.iter().map(|p| (p.xyz() - centre * p.w).push(p.w)).collect()]
    };
    let numerator = numerator(&moved(&difference), &moved(before));
    let jump = numerator.iter().flatten().map(|p| p.xyz().norm()).fold(0.0, f64::max) / (least * least);
    let speed = slopes_before.iter().map(|p| (p.xyz() - centre * p.w).norm()).fold(0.0, f64::max) / least;
    if jump > NO_JUMP * speed { jump } else { 0.0 }
}
