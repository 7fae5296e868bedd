//! The material that moves of a tool leave of a raw part, as a height map with proved bounds.
//!
//! The cutter comes from above, so that all material lies below a height over each point of the plane. The
//! map divides the plane into cells. No material of a cell is above its *outer* height; all of the cell is
//! material up to its *inner* height. At the corners of the cells the map also holds a height up to which
//! there is material.
//!
//! # Method
//! 1. Replace arcs and parabolas by chords. The distance of the chords from the curves, and what a control
//!    may leave the path, is the *slack*.
//! 2. For each chord, compute the swept height (`sweep`) at the corners of the cells that the cutter passes
//!    over. It is a convex function of the place: its value at the corners of a cell bounds it from above,
//!    its tangent planes at the corners bound it from below (`band`).
//! 3. With slack, compute the bound from above with a smaller cutter. The smaller cutter stays within the
//!    real cutter wherever the control runs the real cutter. Compute the bound from below with a larger
//!    cutter, which covers the real cutter.
//! 4. Before a step cuts, tell how deep a rapid enters the material, and how near sections of the shank and
//!    of the holder come to it (`probe`).
//!
//! # Guarantees
//! * Exact material lies between the inner and the outer heights, whatever the steps. Rounding is included.
//! * Removed material, and a rapid or a holder that meets material, are told only where they are certain.
//! * The result does not depend on the number of threads: each band of rows runs all steps in order.
//!
//! # Degenerate input
//! A step of no length cuts where it stands. A cutter not larger than the slack removes nothing for certain.
//!
//! # Cost
//! O(n a) for n chords and the a cells that the cutter covers on each. Cells that are lower than the chord
//! cost one comparison.

mod band;
mod blocks;
mod grid;
mod probe;
mod shape;
mod sweep;

use nalgebra::{Point2, Point3};

use super::assembly::Assembly;
use super::cutter::Cutter;
use crate::budget::{Budget, Stopped};
use crate::geometry::curve::{Curve, Line};
use crate::geometry::flatten::flatten;
use band::{Cut, Rows};
pub use grid::Grid;
use probe::{Way, parts};
pub use shape::{Shape, ShapeError};
use sweep::Sweep;

/// Rows of a band. One thread runs one band at a time.
const BAND_ROWS: usize = 32;

/// The height of chords, as a share of a cell's diagonal.
const CHORD: f64 = 0.01;

/// The most chords of one curve. Flatter chords are used for a longer curve.
const MOST_CHORDS: usize = 100_000;

/// Steps between two checks of the budget.
const STEPS_BETWEEN_CHECKS: usize = 256;

/// Distances of shank and holder from the material are told below this, mm.
pub const FAR_MM: f64 = 50.0;

/// The material of a raw part before or after some moves.
#[derive(Debug, Clone, PartialEq)]
pub struct Stock {
    grid: Grid,
    bottom_mm: f64,
    bands: Vec<Rows>,
}

/// One move of a tool.
#[derive(Debug, Clone, Copy)]
pub struct Step<'a> {
    pub tip: Curve,
    /// How far the control may leave the curve, mm.
    pub slack_mm: f64,
    pub tool: &'a Assembly,
    pub is_rapid: bool,
    /// Whether the control runs this curve and no other one instead.
    pub is_sure: bool,
}

/// What a step does to the material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effect {
    /// How far the material that the step removes for certain stands above the tip, mm, and its place.
    pub removed: Option<(f64, Point3<f64>)>,
    /// For a rapid, how deep the deepest point of certain material lies in the cutter, mm, and that point.
    pub found_mm: f64,
    pub found_at: Option<Point3<f64>>,
    /// For a rapid, a bound of how deep any point of a cell of known height lies in the cutter, mm.
    pub depth_bound_mm: f64,
    /// The same for a cell of which a part is cut. Such a cell counts as full up to its highest place.
    pub beside_bound_mm: f64,
    /// The place of the larger bound.
    pub bound_at: Option<Point2<f64>>,
    /// The nearest approach of shank or holder below [`FAR_MM`].
    pub approach: Option<Approach>,
}

/// How near shank or holder come to the material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Approach {
    /// Proved lower bound of the distance, mm.
    pub clearance_mm: f64,
    pub at: Point3<f64>,
    /// Whether they meet certain material.
    pub is_met: bool,
}

impl Effect {
    pub const NONE: Self = Self {
        removed: None,
        found_mm: 0.0,
        found_at: None,
        depth_bound_mm: 0.0,
        beside_bound_mm: 0.0,
        bound_at: None,
        approach: None,
    };

    fn remove(&mut self, depth: f64, at: Point3<f64>) {
        if self.removed.is_none_or(|(before, _)| depth > before) {
            self.removed = Some((depth, at));
        }
    }

    /// A bound of how deep any point of the material lies in the cutter, mm.
    pub fn depth_bound(&self) -> f64 {
        self.depth_bound_mm.max(self.beside_bound_mm).max(self.found_mm)
    }

    /// A cell of known height lies in the cutter, `depth` mm at most.
    fn enter(&mut self, depth: f64, at: Point2<f64>) {
        if depth > self.depth_bound() {
            self.bound_at = Some(at);
        }
        self.depth_bound_mm = self.depth_bound_mm.max(depth);
    }

    /// A cell of which a part is cut may lie in the cutter, `depth` mm at most.
    fn touch(&mut self, depth: f64, at: Point2<f64>) {
        if depth > self.depth_bound() {
            self.bound_at = Some(at);
        }
        self.beside_bound_mm = self.beside_bound_mm.max(depth);
    }

    fn approach(&mut self, other: Approach) {
        let is_met = other.is_met || self.approach.is_some_and(|own| own.is_met);
        let nearest = match self.approach {
            Some(own) if own.clearance_mm <= other.clearance_mm && (own.is_met || !other.is_met) => own,
            _ => other,
        };
        self.approach = Some(Approach { is_met, ..nearest });
    }

    /// The effect of a move that the control runs on one of two ways: the bounds of both ways together,
    /// and as certain only what both ways do.
    pub fn or(self, other: Self) -> Self {
        let less = if other.found_mm < self.found_mm { other } else { self };
        let removed = self.removed.and(other.removed);
        let is_met = |effect: &Self| effect.approach.is_some_and(|approach| approach.is_met);
        let is_met = is_met(&self) && is_met(&other);
        let mut both = self.and(other);
        (both.found_mm, both.found_at, both.removed) = (less.found_mm, less.found_at, removed);
        both.approach = both.approach.map(|approach| Approach { is_met, ..approach });
        // A depth that is found on one way is a bound for both ways, and certain for neither.
        both.depth_bound_mm = both.depth_bound_mm.max(self.found_mm).max(other.found_mm);
        both
    }

    /// The effect of two curves that are run one after the other.
    pub fn and(mut self, other: Self) -> Self {
        if let Some((depth, at)) = other.removed {
            self.remove(depth, at);
        }
        if other.found_mm > self.found_mm {
            (self.found_mm, self.found_at) = (other.found_mm, other.found_at);
        }
        if other.depth_bound() > self.depth_bound() {
            self.bound_at = other.bound_at;
        }
        self.depth_bound_mm = self.depth_bound_mm.max(other.depth_bound_mm);
        self.beside_bound_mm = self.beside_bound_mm.max(other.beside_bound_mm);
        if let Some(approach) = other.approach {
            self.approach(approach);
        }
        self
    }
}

/// A volume that lies between two figures, mm³.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Volume {
    pub least_mm3: f64,
    pub most_mm3: f64,
}

impl Stock {
    /// A raw part in cells of at most `cell_mm`.
    ///
    /// # Errors
    /// When the shape has no inside, or needs more than `most_cells` cells.
    pub fn new(shape: &Shape, cell_mm: f64, most_cells: usize, budget: &Budget) -> Result<Self, ShapeError> {
        let [low, high] = shape.rectangle().ok_or(ShapeError::Empty)?;
        let (bottom_mm, top_mm) = shape.heights();
        if !(low.x < high.x && low.y < high.y && bottom_mm < top_mm) {
            return Err(ShapeError::Empty);
        }
        let grid = Grid::over(low, high, cell_mm);
        if grid.cells() > most_cells as f64 {
            return Err(ShapeError::TooManyCells { cells: grid.cells(), limit: most_cells });
        }
        let n = grid.n[1].div_ceil(BAND_ROWS);
        let bands = budget.in_order(n, |k| {
            budget.check()?;
            let rows = [k * BAND_ROWS, ((k + 1) * BAND_ROWS).min(grid.n[1])];
            Ok::<_, Stopped>(shape.band(&grid, rows, (bottom_mm, top_mm)))
        })?;
        Ok(Self { grid, bottom_mm, bands })
    }

    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    pub fn bottom_mm(&self) -> f64 {
        self.bottom_mm
    }

    /// The outer and the inner height of the cell (i, j), mm; minus infinity where there is no material.
    pub fn cell(&self, i: usize, j: usize) -> [f64; 2] {
        let band = &self.bands[j / BAND_ROWS];
        let k = (j - band.rows[0]) * self.grid.n[0] + i;
        [band.outer[k], band.inner[k]]
    }

    /// The volume of the material.
    pub fn volume(&self) -> Volume {
        let sum = |heights: &dyn Fn(&Rows) -> f64| self.bands.iter().map(heights).sum();
        Volume {
            least_mm3: sum(&|band| band.volume(&band.inner)),
            most_mm3: sum(&|band| band.volume(&band.outer)),
        }
    }

    /// What `steps` leave, and what each of them does. Shank and holder of a step are told where they come
    /// nearer than on any step before, and where they come nearer than `clearance_mm`.
    ///
    /// # Errors
    /// Only the budget's stop.
    pub fn after(
        &self,
        steps: &[Step<'_>],
        clearance_mm: f64,
        budget: &Budget,
    ) -> Result<(Self, Vec<Effect>), Stopped> {
        let n = self.bands.len();
        let run = budget.in_order(n, |k| {
            budget.progress("stock", k, n);
            run(self.bands[k].clone(), steps, clearance_mm, budget)
        })?;
        let mut effects = vec![Effect::NONE; steps.len()];
        let mut bands = Vec::with_capacity(n);
        for (band, own) in run {
            bands.push(band);
            for (k, effect) in own {
                effects[k] = effects[k].and(effect);
            }
        }
        Ok((Self { grid: self.grid, bottom_mm: self.bottom_mm, bands }, effects))
    }
}

/// Chords of a curve, and their distance from it, mm.
fn chords(tip: &Curve, mut height: f64) -> (Vec<Line>, f64) {
    if let Curve::Line(line) = tip {
        return (vec![*line], 0.0);
    }
    loop {
        if let Ok(points) = flatten(tip, height, MOST_CHORDS) {
            let lines = points.windows(2).map(|ends| Line { start: ends[0], end: ends[1] });
            return (lines.collect(), height);
        }
        height *= 2.0;
    }
}

/// Runs all steps in one band.
fn run(
    mut band: Rows,
    steps: &[Step<'_>],
    clearance_mm: f64,
    budget: &Budget,
) -> Result<(Rows, Vec<(usize, Effect)>), Stopped> {
    let mut effects = Vec::new();
    let mut limit = FAR_MM;
    let diagonal = 2.0 * band.grid.half_diagonal();
    for (k, step) in steps.iter().enumerate() {
        let widest = step.tool.cutter.radius().max(step.tool.widest_section() + limit);
        if !band.is_near(&step.tip, widest + step.slack_mm + diagonal) {
            if k % STEPS_BETWEEN_CHECKS == 0 {
                budget.check()?;
            }
            continue;
        }
        let mut effect = Effect::NONE;
        let (lines, height) = chords(&step.tip, CHORD * diagonal);
        let slack = step.slack_mm + height;
        // A tool that rises straight from where it has just cut stays within the material that it has left.
        let is_shadow = slack == 0.0 && step.rises() && k > 0 && steps[k - 1].leads_to(step);
        for line in &lines {
            budget.check()?;
            let way = Way { line, slack };
            if step.is_rapid && !is_shadow {
                band.enter(&step.tool.cutter, way, &mut effect, budget)?;
            }
            if step.tool.sections.is_empty() {
                band.cut(&Cut::new(step, way), &mut effect);
                continue;
            }
            // The holder follows the cutter down: what the cutter has removed is gone before the holder
            // comes.
            for part in parts(line, diagonal) {
                budget.check()?;
                let way = Way { line: &part, slack };
                band.approach(step.tool, way, (&mut limit, clearance_mm), &mut effect);
                band.cut(&Cut::new(step, way), &mut effect);
            }
        }
        if effect != Effect::NONE {
            effects.push((k, effect));
        }
    }
    Ok((band, effects))
}

impl Step<'_> {
    /// Whether the tip goes straight up.
    fn rises(&self) -> bool {
        let (start, end) = (self.tip.start(), self.tip.end());
        matches!(self.tip, Curve::Line(_)) && start.xy() == end.xy() && start.z <= end.z
    }

    /// Whether `next` goes on where this step ends, with the same tool.
    fn leads_to(&self, next: &Step<'_>) -> bool {
        self.is_sure && self.tip.end() == next.tip.start() && std::ptr::eq(self.tool, next.tool)
    }
}

impl Cut {
    /// The line of a cutter with slack.
    fn new(step: &Step<'_>, Way { line, slack }: Way<'_>) -> Self {
        let cutter = &step.tool.cutter;
        if slack == 0.0 {
            let sweep = Sweep::new(*cutter, line);
            return Self { within: step.is_sure.then_some(sweep), around: sweep };
        }
        let raised = |by: f64| {
            let up = nalgebra::Vector3::z() * by;
            Line { start: line.start + up, end: line.end + up }
        };
        let within =
            cutter.reduced(slack).filter(|_| step.is_sure).map(|smaller| Sweep::new(smaller, &raised(slack)));
        // A larger flat end covers it. The swept height of a rounded corner takes longer to compute.
        let larger = match cutter.corner_radius() {
            0.0 => Cutter::bull_nose(cutter.radius() + slack, 0.0),
            _ => cutter.enlarged(slack),
        };
        Self { within, around: Sweep::new(larger, &raised(-slack)) }
    }
}

#[cfg(test)]
mod tests;
