//! How deep a cutter enters the material on its way, and how near its shank and holder come to it.

use nalgebra::{Point2, Point3};

use super::band::{NOTHING, Rows};
use super::blocks::SIDE;
use super::sweep::Sweep;
use super::{Approach, Effect};
use crate::budget::{Budget, Stopped};
use crate::geometry::curve::Line;
use crate::machining::assembly::Assembly;
use crate::machining::cutter::Cutter;
use crate::machining::gouge::solid::Solid;

/// A slope is divided into steps that fall by this share of a cell's diagonal.
const FALL: f64 = 0.5;

/// A cell whose heights are this near to each other has a known height, mm.
const KNOWN_MM: f64 = 1e-6;

/// The most steps of one slope. Steps of a longer one fall farther, and bounds are wider.
const MOST_STEPS: f64 = 1e4;

/// A line along which the control may leave the tip by `slack` mm.
#[derive(Debug, Clone, Copy)]
pub(super) struct Way<'a> {
    pub(super) line: &'a Line,
    pub(super) slack: f64,
}

impl Rows {
    /// How deep a cutter enters the material along a way.
    ///
    /// # Errors
    /// Only the budget's stop.
    pub(super) fn enter(
        &self,
        cutter: &Cutter,
        way: Way<'_>,
        effect: &mut Effect,
        budget: &Budget,
    ) -> Result<(), Stopped> {
        let solid = Solid { flat: cutter.flat_radius(), corner: cutter.corner_radius() };
        let half = self.grid.half_diagonal();
        for step in steps(way.line, FALL * half) {
            budget.check()?;
            let sweep = Sweep::new(*cutter, &step);
            let lowest = sweep.lowest() - way.slack;
            let reach = cutter.radius() + way.slack + half;
            let [first, last] = self.rows_near(&sweep, reach);
            for j in first..last {
                let [from, to] = self.columns_near(&sweep, reach, j);
                for i in from..to {
                    let [outer, inner] = self.heights(i, j);
                    if outer <= lowest {
                        continue;
                    }
                    let nearest = self.meet(&sweep, &solid, (i, j), way.slack, effect);
                    if outer - inner <= KNOWN_MM {
                        // The height of the whole cell is known, and so is its nearest place.
                        let away = (nearest - way.slack).max(0.0);
                        effect.enter(solid.depth_at(away, outer - lowest), self.center(i, j));
                    } else {
                        let away = (sweep.distance(self.center(i, j)) - half - way.slack).max(0.0);
                        effect.touch(solid.depth_at(away, outer - lowest), self.center(i, j));
                    }
                }
            }
        }
        Ok(())
    }

    /// How deep certain material of a cell lies in the cutter. Returns the distance of the cell from the
    /// line, mm: a corner of the cell or an end of the line is nearest, unless they cross.
    fn meet(
        &self,
        sweep: &Sweep,
        solid: &Solid,
        (i, j): (usize, usize),
        slack: f64,
        effect: &mut Effect,
    ) -> f64 {
        let inner = self.heights(i, j)[1];
        let mut nearest = f64::INFINITY;
        let mut look = |p: Point2<f64>, height: f64| {
            let tip = sweep.tip_nearest(p);
            let away = (p - tip.xy()).norm();
            nearest = nearest.min(away);
            let depth = solid.depth_at(away + slack, height - tip.z - slack);
            if height > NOTHING && depth > effect.found_mm {
                effect.found_mm = depth;
                effect.found_at = Some(Point3::new(p.x, p.y, height));
            }
        };
        for (i, j) in [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)] {
            look(self.grid.corner(i, j), self.certain(i, j).max(inner));
        }
        let [low, high] = [self.grid.corner(i, j), self.grid.corner(i + 1, j + 1)];
        for p in sweep.ends().into_iter().chain([sweep.tip_nearest(self.center(i, j)).xy()]) {
            look(p.sup(&low).inf(&high), inner);
        }
        nearest
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
        let below = assembly.lowest_section();
        for step in [*way.line] {
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
    let is_upright = line.end.xy() == line.start.xy();
    parts(line, if is_upright { f64::INFINITY } else { fall })
}

/// A line in parts, each of which falls or rises by at most `fall` mm.
pub(super) fn parts(line: &Line, fall: f64) -> impl Iterator<Item = Line> {
    let n = ((line.end.z - line.start.z).abs() / fall).ceil().clamp(1.0, MOST_STEPS);
    let line = *line;
    (0..n as usize).map(move |k| Line {
        start: line.point_at(k as f64 / n),
        end: if k as f64 + 1.0 < n { line.point_at((k as f64 + 1.0) / n) } else { line.end },
    })
}
