//! The part as points of a grid. It judges the toolpath of an answer by the heights of the part alone: where
//! the cutter must not be, what the cutter can reach, and what stock the cutter meets on its way.

use serde_json::Value;

use super::grid::Grid;
use super::plane::{P, Piece};
use super::service::{Cut, RETRACT_MM, Step, TOP_MM, floors, steps};

/// The distance of neighbouring points of the grid, mm.
const CELL_MM: f64 = 0.25;

/// Halvings between two neighbouring points, one of which is higher than a level.
const HALVINGS: usize = 40;

/// Heights that differ by less are the same, mm.
const SAME_MM: f64 = 1e-6;

/// A place counts as higher than a level if it is higher by more than this, mm.
const HIGHER_MM: f64 = 0.002;

/// How much nearer than its radius the axis may come to such a place, mm.
const GOUGE_MM: f64 = 0.002;

/// A place counts as reachable if a disc that is larger than the cutter by this has room, and a disc that is
/// smaller by this covers the place, mm.
const REACH_MM: f64 = 0.1;

/// A place counts as cut if the axis passes it at the radius and this, mm.
const CUT_MM: f64 = 0.02;

/// The largest part of the reachable points that may stay uncut.
const UNCUT_PART: f64 = 5e-4;

/// The stock is cut by a disc that is larger by so much: slivers of twice this width are forgiven, mm.
const SLIVER_MM: f64 = 0.025;

/// Stock that links meet this near the edge of the cutter does not count, mm.
const LINK_RIM_MM: f64 = 0.02;

/// Stock that the cutter meets this near its edge on its way down or up does not count, mm.
const ENTRY_RIM_MM: f64 = 0.06;

/// The height of arcs over the chords that stand for them, mm.
const CHORD_MM: f64 = 0.005;

/// The longest part of a ramp or helix that counts as level, mm.
const TILTED_MM: f64 = 0.3;

/// The most moves through stock and low rapids that are listed.
const MOST_FAULTS: usize = 10;

/// A part by its height over each place, mm. Where all stays, the height is infinite.
pub struct Part<'a> {
    grid: Grid,
    height: Box<dyn Fn(P) -> f64 + 'a>,
    heights: Vec<f64>,
}

/// What is wrong with a toolpath.
#[derive(Debug)]
pub struct Verdict {
    pub faults: Vec<String>,
    /// How deep the cutter enters the part, mm; negative if the cutter keeps away.
    pub gouge_mm: f64,
}

impl Verdict {
    pub fn assert_sound(&self) {
        assert!(self.faults.is_empty(), "{:#?}", self.faults);
        assert!(self.gouge_mm <= GOUGE_MM, "the cutter enters the part by {} mm", self.gouge_mm);
    }
}

impl<'a> Part<'a> {
    pub fn new(bounds: [P; 2], height: impl Fn(P) -> f64 + 'a) -> Self {
        let grid = Grid::new(bounds, CELL_MM);
        let heights = (0..grid.len()).map(|k| height(grid.point(k))).collect();
        Self { grid, height: Box::new(height), heights }
    }

    /// The height of the stock over each point, mm. All that `is_empty` does not hold for is full.
    pub fn stock(&self, is_empty: impl Fn(P) -> bool) -> Vec<f64> {
        let height = |k: usize| if is_empty(self.grid.point(k)) { f64::NEG_INFINITY } else { TOP_MM };
        (0..self.grid.len()).map(height).collect()
    }

    /// Judges the answer for a cut of this part. `stock` is what stands before.
    pub fn judge(&self, cut: &Cut, answer: &Value, stock: &[f64]) -> Verdict {
        let (steps, floors, radius) = (steps(answer), floors(answer), cut.radius_mm());
        let mut faults = wrong_floors(cut, &floors);
        faults.extend(self.run(&mut stock.to_vec(), &steps, radius).into_iter().take(MOST_FAULTS));
        let mut gouge_mm = f64::NEG_INFINITY;
        for (k, z) in floors.into_iter().enumerate() {
            let is_below =
                |step: &&Step| step.level == Some(k) && step.role.is_some() && step.low() < TOP_MM - SAME_MM;
            let below: Vec<&Step> = steps.iter().filter(is_below).collect();
            let is_wrong = |step: &&&Step| {
                let is_level = step.role.as_deref() == Some("cut");
                step.low() < z - SAME_MM || (is_level && !step.is_at(z))
            };
            faults.extend(below.iter().find(is_wrong).map(|step| format!("not at {z}: {step:?}")));
            // At the floor of the level more of the part stands than higher up.
            let all: Vec<Piece> = below.iter().map(|step| step.piece).collect();
            gouge_mm = gouge_mm.max(self.gouge(&all, z + HIGHER_MM, radius));
            let mut done: Vec<bool> = stock.iter().map(|height| *height <= z + SAME_MM).collect();
            for step in below.iter().filter(|step| step.is_at(z)) {
                for [a, b] in chords(&step.piece, f64::INFINITY) {
                    self.grid.near(a, b, radius + CUT_MM, |range| done[range].fill(true));
                }
            }
            faults.extend(self.uncut(&self.reach(z + SAME_MM, radius), &done, z));
        }
        Verdict { faults, gouge_mm }
    }

    /// Moves the cutter through the stock in the order of the path. Returns where rapids are too low, and
    /// where the cutter meets stock on other moves than cuts, level leads, ramps and plunges.
    pub fn run(&self, stock: &mut [f64], steps: &[Step], radius: f64) -> Vec<String> {
        let mut faults = Vec::new();
        for step in steps {
            let is_rapid = step.role.is_none();
            if is_rapid && step.piece.length() > 0.0 && step.low() < RETRACT_MM - SAME_MM {
                faults.push(format!("a rapid below the retract plane: {step:?}"));
            }
            if step.low() >= TOP_MM {
                continue;
            }
            let free = match step.role.as_deref() {
                Some("cut" | "ramp" | "plunge") => None,
                Some("lead_in" | "lead_out") if step.z[0] == step.z[1] => None,
                Some("link") => Some(radius - LINK_RIM_MM),
                _ => Some(radius - ENTRY_RIM_MM),
            };
            let longest = if step.z[0] == step.z[1] { f64::INFINITY } else { TILTED_MM };
            let chords = chords(&step.piece, longest);
            let n = chords.len() as f64;
            for (k, [a, b]) in chords.into_iter().enumerate() {
                let height = |k: usize| step.z[0] + (step.z[1] - step.z[0]) * k as f64 / n;
                let z = height(k).min(height(k + 1));
                let mut met = 0;
                if let Some(free) = free {
                    self.grid.near(a, b, free, |range| {
                        met += stock[range].iter().filter(|height| **height > z + SAME_MM).count();
                    });
                }
                if met > 0 {
                    faults
                        .push(format!("{met} points of stock are in the way from {a:?} to {b:?}: {step:?}"));
                }
                self.grid.near(a, b, radius + SLIVER_MM, |range| {
                    for height in &mut stock[range] {
                        *height = height.min(z);
                    }
                });
            }
        }
        faults
    }

    /// How deep the cutter enters what is higher than `z`, mm.
    fn gouge(&self, pieces: &[Piece], z: f64, radius: f64) -> f64 {
        let edge = self.edge(z);
        let mut deepest = f64::NEG_INFINITY;
        for piece in pieces {
            let [low, high] = piece.bounds();
            for p in &edge {
                if (0..2).all(|axis| p[axis] > low[axis] - radius && p[axis] < high[axis] + radius) {
                    deepest = deepest.max(radius - piece.distance(*p));
                }
            }
            if [0.0, 1.0].into_iter().any(|end| (self.height)(piece.at(end)) > z) {
                deepest = f64::INFINITY;
            }
        }
        deepest
    }

    /// Places on the edge of what is higher than `z`: one between each two neighbouring points of which one
    /// is higher.
    fn edge(&self, z: f64) -> Vec<P> {
        let (columns, n) = (self.grid.columns, self.grid.len());
        let mut found = Vec::new();
        for k in 0..n {
            let is_high = self.heights[k] > z;
            let right = (!(k + 1).is_multiple_of(columns)).then_some(k + 1);
            let above = (k + columns < n).then_some(k + columns);
            for next in right.into_iter().chain(above) {
                if (self.heights[next] > z) != is_high {
                    let [high, low] = if is_high { [k, next] } else { [next, k] };
                    found.push(self.crossing(self.grid.point(high), self.grid.point(low), z));
                }
            }
        }
        found
    }

    /// A place higher than `z` just beside one that is not, between two such places.
    fn crossing(&self, mut high: P, mut low: P, z: f64) -> P {
        for _ in 0..HALVINGS {
            let middle = [0, 1].map(|axis| 0.5 * (high[axis] + low[axis]));
            if (self.height)(middle) > z { high = middle } else { low = middle }
        }
        high
    }

    /// The points that the cutter can reach where nothing higher than `z` may be cut.
    fn reach(&self, z: f64, radius: f64) -> Vec<bool> {
        let mut centers: Vec<bool> = self.heights.iter().map(|height| *height <= z).collect();
        for p in self.edge(z) {
            self.grid.near(p, p, radius + REACH_MM, |range| centers[range].fill(false));
        }
        let mut reach = centers.clone();
        let columns = self.grid.columns;
        for k in (0..centers.len()).filter(|k| centers[*k]) {
            // The discs about the outermost centres are enough.
            let beside = [k.checked_sub(1), k.checked_sub(columns), Some(k + 1), Some(k + columns)];
            let is_center = |k: Option<usize>| k.and_then(|k| centers.get(k)).is_some_and(|center| *center);
            if !beside.into_iter().all(is_center) {
                let p = self.grid.point(k);
                self.grid.near(p, p, radius - REACH_MM, |range| reach[range].fill(true));
            }
        }
        reach
    }

    fn uncut(&self, reach: &[bool], done: &[bool], z: f64) -> Option<String> {
        let reachable = reach.iter().filter(|reached| **reached).count();
        let left: Vec<usize> = (0..reach.len()).filter(|k| reach[*k] && !done[*k]).collect();
        (left.len() as f64 > UNCUT_PART * reachable as f64).then(|| {
            let place = self.grid.point(left[left.len() / 2]);
            format!("{} of {reachable} points stay uncut at {z}, for example {place:?}", left.len())
        })
    }
}

/// The levels go down from the top to the floor, in steps of at most the stepdown.
fn wrong_floors(cut: &Cut, floors: &[f64]) -> Vec<String> {
    let tops = std::iter::once(&TOP_MM).chain(floors);
    let mut depths = tops.zip(floors).map(|(top, floor)| top - floor);
    let is_fine = depths.all(|depth| depth > 0.0 && depth <= cut.stepdown_mm + 1e-9)
        && floors.last() == Some(&cut.floor_mm);
    if is_fine { Vec::new() } else { vec![format!("floors at {floors:?}")] }
}

fn chords(piece: &Piece, longest: f64) -> Vec<[P; 2]> {
    piece.points(CHORD_MM, longest).windows(2).map(|pair| [pair[0], pair[1]]).collect()
}
