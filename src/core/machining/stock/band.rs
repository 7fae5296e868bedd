//! Some rows of a height map, and the cuts in them.

use nalgebra::{Point2, Point3, Vector3};

use super::Effect;
use super::blocks::Blocks;
use super::grid::Grid;
use super::sweep::{SLACK_MM, Sweep, Swept};
use crate::geometry::curve::Curve;

/// No material.
pub(super) const NOTHING: f64 = f64::NEG_INFINITY;

/// Rows of cells with the heights of the material in them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Rows {
    pub(super) grid: Grid,
    /// The first row, and the one behind the last.
    pub(super) rows: [usize; 2],
    pub(super) bottom: f64,
    /// For each cell a height that no material exceeds.
    pub(super) outer: Vec<f64>,
    /// For each cell a height up to which all of the cell is material.
    pub(super) inner: Vec<f64>,
    /// For each corner of the cells a height up to which there is material.
    pub(super) samples: Vec<f64>,
    pub(super) blocks: Blocks,
}

/// How a cutter passes over a corner of cells, as bounds of the swept height from above and from below.
#[derive(Debug, Clone, Copy)]
enum Passed {
    Unknown,
    At { above: Option<Swept>, below: Option<Swept> },
}

/// The line of a cut, run by a cutter that lies within every cutter that the control may run, and by a cutter
/// that covers all of these.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cut {
    /// `None` where the cutter is not larger than the slack.
    pub(super) within: Option<Sweep>,
    pub(super) around: Sweep,
}

impl Rows {
    fn columns(&self) -> usize {
        self.grid.n[0]
    }

    fn cell(&self, i: usize, j: usize) -> usize {
        (j - self.rows[0]) * self.columns() + i
    }

    fn sample(&self, i: usize, j: usize) -> usize {
        (j - self.rows[0]) * (self.columns() + 1) + i
    }

    /// The height of certain material at a corner, mm.
    pub(super) fn certain(&self, i: usize, j: usize) -> f64 {
        self.samples[self.sample(i, j)]
    }

    pub(super) fn outer_at(&self, i: usize, j: usize) -> f64 {
        self.outer[self.cell(i, j)]
    }

    /// The outer and the inner height of a cell, mm.
    pub(super) fn heights(&self, i: usize, j: usize) -> [f64; 2] {
        let k = self.cell(i, j);
        [self.outer[k], self.inner[k]]
    }

    /// Whether the box of a curve, grown by `reach` mm on all sides, meets the band.
    pub(super) fn is_near(&self, tip: &Curve, reach: f64) -> bool {
        let [from, to] = [self.grid.corner(0, self.rows[0]), self.grid.corner(self.columns(), self.rows[1])];
        (0..2).all(|axis| {
            let (most, least) = (Vector3::ith(axis, 1.0), Vector3::ith(axis, -1.0));
            tip.support(&most) + reach >= from[axis] && -tip.support(&least) - reach <= to[axis]
        })
    }

    /// The middle of a cell.
    pub(super) fn center(&self, i: usize, j: usize) -> Point2<f64> {
        self.grid.corner(i, j) + 0.5 * self.grid.cell
    }

    /// The rows of the band that come within `reach` mm of the line of `sweep`.
    pub(super) fn rows_near(&self, sweep: &Sweep, reach: f64) -> [usize; 2] {
        let [low, high] = sweep.rows();
        let [from, to] = self.grid.rows([low - reach, high + reach]);
        [from.max(self.rows[0]), to.min(self.rows[1])]
    }

    /// The columns of row `j` that come within `reach` mm of the line of `sweep`.
    pub(super) fn columns_near(&self, sweep: &Sweep, reach: f64, j: usize) -> [usize; 2] {
        let strip = [j, j + 1].map(|j| self.grid.corner(0, j).y);
        sweep.columns(strip, reach).map_or([0, 0], |columns| self.grid.columns(columns))
    }

    /// Removes what the cutter sweeps.
    pub(super) fn cut(&mut self, cut: &Cut, effect: &mut Effect) {
        let around = &cut.around;
        let radius = around.cutter().radius();
        let [first, last] = self.rows_near(around, radius);
        if first >= last {
            return;
        }
        let [left, right] = around.across();
        let [start, end] = self.grid.columns([left - radius, right + radius]);
        let mut below = vec![Passed::Unknown; end - start + 1];
        let mut above = below.clone();
        for j in first..last {
            std::mem::swap(&mut below, &mut above);
            above.fill(Passed::Unknown);
            let [from, to] = self.columns_near(around, radius, j);
            for i in from.max(start)..to.min(end) {
                let k = self.cell(i, j);
                if self.outer[k] <= around.lowest() {
                    continue;
                }
                let corners = [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)];
                let passed = corners.map(|(i, jj)| {
                    let known = if jj == j { &mut below[i - start] } else { &mut above[i - start] };
                    if let Passed::Unknown = known {
                        *known = self.pass(cut, i, jj, effect);
                    }
                    *known
                });
                self.lower(cut, (i, j), passed);
            }
        }
    }

    /// What the cutter leaves at a corner. Lowers the certain material there.
    fn pass(&mut self, cut: &Cut, i: usize, j: usize, effect: &mut Effect) -> Passed {
        let p = self.grid.corner(i, j);
        let below = cut.around.at(p);
        let above = cut.within.as_ref().and_then(|within| within.at(p));
        let k = self.sample(i, j);
        let before = self.samples[k];
        if let Some(above) = above
            && above.height + SLACK_MM < before
        {
            let depth = before - above.tip.max(self.bottom);
            effect.remove(depth, Point3::new(p.x, p.y, before));
        }
        if let Some(below) = below {
            self.samples[k] = self.left(before.min(below.height - SLACK_MM));
        }
        Passed::At { above, below }
    }

    /// Lowers both bounds of a cell.
    fn lower(&mut self, cut: &Cut, (i, j): (usize, usize), corners: [Passed; 4]) {
        let k = self.cell(i, j);
        let highest = corners.iter().try_fold(NOTHING, |highest: f64, passed| match passed {
            Passed::At { above: Some(above), .. } => Some(highest.max(above.height)),
            _ => None,
        });
        // A cutter that passes over all corners passes over the cell, and its swept height is convex.
        if let Some(highest) = highest
            && highest + SLACK_MM < self.outer[k]
        {
            self.outer[k] = self.left(highest + SLACK_MM);
            self.blocks.touch(i, j - self.rows[0]);
        }
        if self.inner[k] > cut.around.lowest()
            && let Some(lowest) = self.lowest(cut, (i, j), corners)
        {
            self.inner[k] = self.left(self.inner[k].min(lowest - SLACK_MM));
        }
    }

    /// A lower bound of the swept height over a cell; `None` where the cutter does not touch the cell.
    fn lowest(&self, cut: &Cut, (i, j): (usize, usize), corners: [Passed; 4]) -> Option<f64> {
        let (dx, dy) = (self.grid.cell.x, self.grid.cell.y);
        let ways = [(dx, dy), (-dx, dy), (dx, -dy), (-dx, -dy)];
        let mut n_passed = 0;
        let mut lowest = NOTHING;
        for (passed, (dx, dy)) in corners.iter().zip(ways) {
            if let Passed::At { below: Some(below), .. } = passed {
                n_passed += 1;
                if below.gradient.iter().all(|slope| slope.is_finite()) {
                    let fall = (below.gradient.x * dx).min(0.0) + (below.gradient.y * dy).min(0.0);
                    lowest = lowest.max(below.height + fall);
                }
            }
        }
        if n_passed == 4 && lowest > NOTHING {
            return Some(lowest);
        }
        let around = &cut.around;
        let center = self.center(i, j);
        let nearest = (around.distance(center) - self.grid.half_diagonal()).max(0.0);
        let radius = around.cutter().radius();
        if n_passed == 0 && nearest > radius {
            return None;
        }
        let tip = around.lowest_near(center, radius + self.grid.half_diagonal());
        Some(lowest.max(tip + around.cutter().height(nearest.min(radius))))
    }

    /// The height, or nothing where it is not above the bottom.
    fn left(&self, height: f64) -> f64 {
        if height > self.bottom { height } else { NOTHING }
    }

    /// The volume between the bottom and the heights, mm³.
    pub(super) fn volume(&self, heights: &[f64]) -> f64 {
        let above: f64 = heights.iter().map(|height| (height - self.bottom).max(0.0)).sum();
        above * self.grid.cell.x * self.grid.cell.y
    }
}
