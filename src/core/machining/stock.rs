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
//! 3. With slack, the bound from above is that of a cutter that lies within the cutter at every place that
//!    the control may run, and the bound from below is that of one that covers all these cutters.
//! 4. Before a step cuts, tell how deep a rapid enters the material, and how near sections of the shank and
//!    of the holder come to it (`probe`).
//!
//! # Guarantees
//! * Exact material lies between the inner and the outer heights, whatever the steps. Rounding is included.
//! * What is found is certain: a step removes material, a rapid or a holder meets material.
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
use band::{Band, Cut};
pub use grid::Grid;
use probe::Way;
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

/// A raw part, or what is left of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Stock {
    grid: Grid,
    bottom_mm: f64,
    bands: Vec<Band>,
}

/// One move of a tool.
#[derive(Debug, Clone, Copy)]
pub struct Step<'a> {
    pub tip: Curve,
    /// How far the control may leave the curve, mm.
    pub slack_mm: f64,
    pub tool: &'a Assembly,
    pub is_rapid: bool,
}

/// What a step does to the material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effect {
    /// How far the material that the step removes for certain stands above the tip, mm, and its place.
    pub removed: Option<(f64, Point3<f64>)>,
    /// For a rapid, how deep the deepest point of certain material lies in the cutter, mm, and that point.
    pub found_mm: f64,
    pub found_at: Option<Point3<f64>>,
    /// For a rapid, a bound of how deep any point of the material lies in the cutter, mm, and its place.
    pub depth_bound_mm: f64,
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
    const NONE: Self = Self {
        removed: None,
        found_mm: 0.0,
        found_at: None,
        depth_bound_mm: 0.0,
        bound_at: None,
        approach: None,
    };

    fn remove(&mut self, depth: f64, at: Point3<f64>) {
        if self.removed.is_none_or(|(before, _)| depth > before) {
            self.removed = Some((depth, at));
        }
    }

    fn approach(&mut self, other: Approach) {
        let is_met = other.is_met || self.approach.is_some_and(|own| own.is_met);
        let nearest = match self.approach {
            Some(own) if own.clearance_mm <= other.clearance_mm && (own.is_met || !other.is_met) => own,
            _ => other,
        };
        self.approach = Some(Approach { is_met, ..nearest });
    }

    fn and(mut self, other: Self) -> Self {
        if let Some((depth, at)) = other.removed {
            self.remove(depth, at);
        }
        if other.found_mm > self.found_mm {
            (self.found_mm, self.found_at) = (other.found_mm, other.found_at);
        }
        if other.depth_bound_mm > self.depth_bound_mm {
            (self.depth_bound_mm, self.bound_at) = (other.depth_bound_mm, other.bound_at);
        }
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

/// A step as chords.
struct Chords<'a> {
    lines: Vec<Line>,
    /// mm.
    slack: f64,
    tool: &'a Assembly,
    is_rapid: bool,
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
        let sum = |heights: &dyn Fn(&Band) -> f64| self.bands.iter().map(heights).sum();
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
        let chord_height = CHORD * 2.0 * self.grid.half_diagonal();
        let chords: Vec<Chords<'_>> = steps.iter().map(|step| Chords::new(step, chord_height)).collect();
        let n = self.bands.len();
        let run = budget.in_order(n, |k| {
            budget.progress("stock", k, n);
            run(self.bands[k].clone(), &chords, clearance_mm, budget)
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

impl<'a> Chords<'a> {
    fn new(step: &Step<'a>, chord_height: f64) -> Self {
        let Step { tip, slack_mm, tool, is_rapid } = *step;
        let (lines, height) = match tip {
            Curve::Line(line) => (vec![line], 0.0),
            Curve::Arc(_) | Curve::Parabola(_) => chords(&tip, chord_height),
        };
        Self { lines, slack: slack_mm + height, tool, is_rapid }
    }
}

/// Chords of a curve, and their distance from it, mm.
fn chords(tip: &Curve, mut height: f64) -> (Vec<Line>, f64) {
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
    mut band: Band,
    steps: &[Chords<'_>],
    clearance_mm: f64,
    budget: &Budget,
) -> Result<(Band, Vec<(usize, Effect)>), Stopped> {
    let mut effects = Vec::new();
    let mut limit = FAR_MM;
    for (k, step) in steps.iter().enumerate() {
        if k % STEPS_BETWEEN_CHECKS == 0 {
            budget.check()?;
        }
        let mut effect = Effect::NONE;
        for line in &step.lines {
            let way = Way { line, slack: step.slack };
            if step.is_rapid {
                band.enter(&step.tool.cutter, way, &mut effect);
            }
            if !step.tool.sections.is_empty() {
                band.approach(step.tool, way, (&mut limit, clearance_mm), &mut effect);
            }
            band.cut(&Cut::new(&step.tool.cutter, way), &mut effect);
        }
        if effect != Effect::NONE {
            effects.push((k, effect));
        }
    }
    Ok((band, effects))
}

impl Cut {
    /// The line of a cutter with slack.
    fn new(cutter: &Cutter, Way { line, slack }: Way<'_>) -> Self {
        if slack == 0.0 {
            let sweep = Sweep::new(*cutter, line);
            return Self { within: Some(sweep), around: sweep };
        }
        let raised = |by: f64| {
            let up = nalgebra::Vector3::z() * by;
            Line { start: line.start + up, end: line.end + up }
        };
        let within = cutter.reduced(slack).map(|smaller| Sweep::new(smaller, &raised(slack)));
        // A flat end stays a flat end, whose slopes are faster to compute than those of a small corner.
        let larger = match cutter.corner_radius() {
            0.0 => Cutter::bull_nose(cutter.radius() + slack, 0.0),
            _ => cutter.enlarged(slack),
        };
        Self { within, around: Sweep::new(larger, &raised(-slack)) }
    }
}

#[cfg(test)]
mod tests;
