//! How deep a cutter enters the material on its way, and how near its shank and holder come to it.

use nalgebra::Point3;

use super::band::{Band, NOTHING};
use super::blocks::SIDE;
use super::sweep::Sweep;
use super::{Approach, Effect};
use crate::geometry::curve::Line;
use crate::machining::assembly::Assembly;
use crate::machining::cutter::Cutter;
use crate::machining::gouge::solid::Solid;

/// A slope is divided into steps that fall by this share of a cell's diagonal.
const FALL: f64 = 0.5;

/// The most steps of one slope. Steps of a longer one fall farther, and bounds are wider.
const MOST_STEPS: f64 = 1e4;

/// A line along which the control may leave the tip by `slack` mm.
#[derive(Debug, Clone, Copy)]
pub(super) struct Way<'a> {
    pub(super) line: &'a Line,
    pub(super) slack: f64,
}

impl Band {
    /// How deep a cutter enters the material along a way.
    pub(super) fn enter(&self, cutter: &Cutter, way: Way<'_>, effect: &mut Effect) {
        // A cutter that rises straight stays within the material that it has left.
        if way.line.end.xy() == way.line.start.xy() && way.line.end.z >= way.line.start.z {
            return;
        }
        let solid = Solid { flat: cutter.flat_radius(), corner: cutter.corner_radius() };
        let half = self.grid.half_diagonal();
        for step in steps(way.line, FALL * half) {
            let sweep = Sweep::new(*cutter, &step);
            let lowest = sweep.lowest() - way.slack;
            let reach = cutter.radius() + way.slack + half;
            let [first, last] = self.rows_near(&sweep, reach);
            for j in first..last {
                let [from, to] = self.columns_near(&sweep, reach, j);
                for i in from..to {
                    let outer = self.outer_at(i, j);
                    if outer <= lowest {
                        continue;
                    }
                    let away = (sweep.distance(self.center(i, j)) - half - way.slack).max(0.0);
                    let depth = solid.depth_at(away, outer - lowest);
                    if depth > effect.depth_bound_mm {
                        effect.depth_bound_mm = depth;
                        effect.bound_at = Some(self.center(i, j));
                    }
                    self.meet(&sweep, &solid, (i, j), way.slack, effect);
                }
            }
        }
    }

    /// How deep certain material at the corners of a cell lies in the cutter.
    fn meet(&self, sweep: &Sweep, solid: &Solid, (i, j): (usize, usize), slack: f64, effect: &mut Effect) {
        for (i, j) in [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)] {
            let height = self.certain(i, j);
            if height == NOTHING {
                continue;
            }
            let p = self.grid.corner(i, j);
            let tip = sweep.tip_nearest(p);
            let depth = solid.depth_at((p - tip.xy()).norm() + slack, height - tip.z - slack);
            if depth > effect.found_mm {
                effect.found_mm = depth;
                effect.found_at = Some(Point3::new(p.x, p.y, height));
            }
        }
    }

    /// How near the sections of `assembly` come to the material along a way. Distances of `limit` mm or more
    /// are not told; `limit` falls to the least distance, but not below `least`.
    pub(super) fn approach(
        &mut self,
        assembly: &Assembly,
        way: Way<'_>,
        (limit, least): (&mut f64, f64),
        effect: &mut Effect,
    ) {
        let half = self.grid.half_diagonal();
        let below = assembly.lowest_section();
        for step in steps(way.line, 2.0 * half) {
            let sweep = Sweep::new(assembly.cutter, &step);
            let lowest = sweep.lowest() - way.slack;
            let reach = assembly.widest_section() + *limit + way.slack;
            let [first, last] = self.rows_near(&sweep, reach);
            if first >= last {
                continue;
            }
            let blocks = [first - self.rows[0], last - 1 - self.rows[0]].map(|row| row / SIDE);
            for b in blocks[0]..=blocks[1] {
                let rows = [b * SIDE, ((b + 1) * SIDE).min(self.rows[1] - self.rows[0])];
                let rows = rows.map(|row| row + self.rows[0]);
                let strip = rows.map(|j| self.grid.corner(0, j).y);
                let Some(columns) = sweep.columns(strip, reach) else { continue };
                let [from, to] = self.grid.columns(columns);
                for a in from / SIDE..to.div_ceil(SIDE) {
                    let most = self.blocks.most(a, b, &self.outer);
                    if most - lowest <= below - *limit {
                        continue;
                    }
                    let columns = [a * SIDE, ((a + 1) * SIDE).min(self.grid.n[0])];
                    let [low, high] =
                        [self.grid.corner(columns[0], rows[0]), self.grid.corner(columns[1], rows[1])];
                    let middle = nalgebra::center(&low, &high);
                    let near = sweep.distance(middle) - 0.5 * (high - low).norm() - way.slack;
                    if assembly.clearance(near.max(0.0), most - lowest) < *limit {
                        self.approach_block(
                            assembly,
                            (&sweep, way.slack),
                            [columns, rows],
                            (limit, least),
                            effect,
                        );
                    }
                }
            }
        }
    }

    fn approach_block(
        &self,
        assembly: &Assembly,
        (sweep, slack): (&Sweep, f64),
        [columns, rows]: [[usize; 2]; 2],
        (limit, least): (&mut f64, f64),
        effect: &mut Effect,
    ) {
        let lowest = sweep.lowest() - slack;
        for (j, i) in (rows[0]..rows[1]).flat_map(|j| (columns[0]..columns[1]).map(move |i| (j, i))) {
            let outer = self.outer_at(i, j);
            if outer == NOTHING {
                continue;
            }
            let near = sweep.distance(self.center(i, j)) - self.grid.half_diagonal() - slack;
            let clearance = assembly.clearance(near.max(0.0), outer - lowest);
            if clearance >= *limit {
                continue;
            }
            *limit = clearance.max(least);
            let is_met = clearance == 0.0 && self.meets(assembly, (sweep, slack), (i, j));
            let at = self.center(i, j);
            effect.approach(Approach { clearance_mm: clearance, at: Point3::new(at.x, at.y, outer), is_met });
        }
    }

    /// Whether certain material at a corner of a cell lies in a section.
    fn meets(&self, assembly: &Assembly, (sweep, slack): (&Sweep, f64), (i, j): (usize, usize)) -> bool {
        let corners = [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)];
        corners.into_iter().any(|(i, j)| {
            let (p, height) = (self.grid.corner(i, j), self.certain(i, j));
            let tip = sweep.tip_nearest(p);
            height > NOTHING
                && assembly.clearance((p - tip.xy()).norm() + slack, height - tip.z - slack) == 0.0
        })
    }
}

/// A line in parts, each of which falls or rises by at most `fall` mm, or runs straight up or down.
fn steps(line: &Line, fall: f64) -> impl Iterator<Item = Line> {
    let way = line.end - line.start;
    let is_level = way.x == 0.0 && way.y == 0.0;
    let n = if is_level { 1.0 } else { (way.z.abs() / fall).ceil().clamp(1.0, MOST_STEPS) };
    let line = *line;
    (0..n as usize).map(move |k| Line {
        start: line.point_at(k as f64 / n),
        end: if k as f64 + 1.0 < n { line.point_at((k as f64 + 1.0) / n) } else { line.end },
    })
}
