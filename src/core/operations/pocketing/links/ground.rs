//! The floor of a level as square cells.

use nalgebra::{Point2, Vector2};

use crate::budget::{Budget, Stopped};
use crate::geometry::region::Region;
use crate::geometry::segment::Segment;

/// Cells in a radius of the cutter, and the fewest with which narrow ways still show.
const CELLS_IN_RADIUS: f64 = 8.0;
const FEWEST_IN_RADIUS: f64 = 3.0;

/// The most cells of a level.
const MOST_CELLS: f64 = 1_000_000.0;

/// The discs that count material about a cell, as their radius less that of the cutter, in cells. With the
/// first, the cutter is clear at nearly all places of a cell. With the second, at some.
const RIMS: [f64; 2] = [1.0, -0.75];

/// An arc is swept as chords that stay this near, in cells.
const CHORD_HEIGHT: f64 = 0.1;

/// Chords are swept in pieces of this length, in radii of the cutter: a slanting piece has a large box.
const PIECE: f64 = 2.0;

/// How much room a way needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Room {
    /// The cutter is clear of material all about it.
    Wide,
    /// The cutter is nearly clear of material.
    Narrow,
    /// The way may run through material.
    Material,
}

/// A cell, by its column and row.
pub type Cell = [usize; 2];

/// The cells.
pub struct Ground {
    low: Point2<f64>,
    cell_mm: f64,
    radius_mm: f64,
    size: [usize; 2],
    /// Whether the cutter's centre may be in the middle of each cell.
    is_inside: Vec<bool>,
    is_cleared: Vec<bool>,
    /// The number of cells with material in each of the discs about a cell.
    material: [Vec<u16>; 2],
    /// The rows of each disc, with half their width in cells.
    discs: [Vec<[isize; 2]>; 2],
}

impl Ground {
    /// The ground of a region of centres; `None` if its cells would be too many or too coarse.
    pub fn new(centers: &Region, radius_mm: f64, budget: &Budget) -> Result<Option<Self>, Stopped> {
        let Some([low, high]) = centers.bounding_box() else { return Ok(None) };
        // The widest disc about a centre has room.
        let beside = Vector2::new(1.0, 1.0) * radius_mm * (1.0 + 3.0 / FEWEST_IN_RADIUS);
        let (low, high) = (low - beside, high + beside);
        let extent = high - low;
        let cell_mm = (radius_mm / CELLS_IN_RADIUS).max((extent.x * extent.y / MOST_CELLS).sqrt());
        if cell_mm * FEWEST_IN_RADIUS > radius_mm {
            return Ok(None);
        }
        let size = [extent.x, extent.y].map(|length| (length / cell_mm).ceil() as usize + 1);
        let discs = RIMS.map(|rim| disc(radius_mm / cell_mm + rim));
        let full = |disc: &Vec<[isize; 2]>| disc.iter().map(|[_, half]| 2 * *half as u16 + 1).sum::<u16>();
        let count = size[0] * size[1];
        let material = [vec![full(&discs[0]); count], vec![full(&discs[1]); count]];
        let mut is_inside = vec![false; count];
        for row in 0..size[1] {
            budget.check()?;
            let y = low.y + (row as f64 + 0.5) * cell_mm;
            let [start, end] = [low.x, high.x].map(|x| Point2::new(x, y));
            for [from, to] in centers.ranges_inside(&Segment::Line { start, end }, 0.0) {
                let column = |t: f64| t * extent.x / cell_mm - 0.5;
                let first = column(from).ceil().max(0.0) as usize;
                let last = column(to).floor().min(size[0] as f64 - 1.0);
                if last >= first as f64 {
                    is_inside[row * size[0] + first..=row * size[0] + last as usize].fill(true);
                }
            }
        }
        let is_cleared = vec![false; count];
        Ok(Some(Self { low, cell_mm, radius_mm, size, is_inside, is_cleared, material, discs }))
    }

    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    pub fn cell_mm(&self) -> f64 {
        self.cell_mm
    }

    pub fn index(&self, [column, row]: Cell) -> usize {
        row * self.size[0] + column
    }

    pub fn middle(&self, [column, row]: Cell) -> Point2<f64> {
        self.low + Vector2::new(column as f64 + 0.5, row as f64 + 0.5) * self.cell_mm
    }

    /// The cell of a place; that at the edge for a place outside.
    pub fn cell(&self, p: Point2<f64>) -> Cell {
        let from = (p - self.low) / self.cell_mm;
        let clamped = |x: f64, size: usize| (x.floor().max(0.0) as usize).min(size - 1);
        [clamped(from.x, self.size[0]), clamped(from.y, self.size[1])]
    }

    pub fn is_open(&self, cell: Cell, room: Room) -> bool {
        let k = self.index(cell);
        self.is_inside[k]
            && match room {
                Room::Wide => self.material[0][k] == 0,
                Room::Narrow => self.material[1][k] == 0,
                Room::Material => true,
            }
    }

    /// The open cell that is nearest to a place, no farther than `within_mm`.
    pub fn open_near(&self, p: Point2<f64>, within_mm: f64, room: Room) -> Option<Cell> {
        let reach = Vector2::new(1.0, 1.0) * within_mm;
        let (first, last) = (self.cell(p - reach), self.cell(p + reach));
        let mut best: Option<(f64, Cell)> = None;
        for row in first[1]..=last[1] {
            for column in first[0]..=last[0] {
                let distance = (self.middle([column, row]) - p).norm();
                if distance <= within_mm
                    && best.is_none_or(|(least, _)| distance < least)
                    && self.is_open([column, row], room)
                {
                    best = Some((distance, [column, row]));
                }
            }
        }
        best.map(|(_, cell)| cell)
    }

    /// Clears what the cutter sweeps along an element.
    pub fn sweep(&mut self, element: &Segment) {
        let by_height = match element {
            Segment::Line { .. } => 1.0,
            Segment::Arc(arc) => {
                let height = (CHORD_HEIGHT * self.cell_mm / arc.radius()).min(1.0);
                arc.turn().abs() / (2.0 * (1.0 - height).acos())
            }
        };
        let count = by_height.max(element.length() / (PIECE * self.radius_mm)).ceil().max(1.0);
        for k in 0..count as usize {
            let [a, b] = [k, k + 1].map(|k| element.at(k as f64 / count));
            self.sweep_chord(a, b);
        }
    }

    fn sweep_chord(&mut self, a: Point2<f64>, b: Point2<f64>) {
        let reach = Vector2::new(1.0, 1.0) * self.radius_mm;
        let (first, last) = (self.cell(a.inf(&b) - reach), self.cell(a.sup(&b) + reach));
        let chord = b - a;
        let square = chord.norm_squared();
        let within = self.radius_mm * self.radius_mm;
        for row in first[1]..=last[1] {
            for column in first[0]..=last[0] {
                if self.is_cleared[self.index([column, row])] {
                    continue;
                }
                let from = self.middle([column, row]) - a;
                let u = if square > 0.0 { (from.dot(&chord) / square).clamp(0.0, 1.0) } else { 0.0 };
                if (from - chord * u).norm_squared() <= within {
                    self.clear([column, row]);
                }
            }
        }
    }

    fn clear(&mut self, cell: Cell) {
        let index = self.index(cell);
        self.is_cleared[index] = true;
        let [width, height] = self.size.map(|size| size as isize);
        let [column, row] = cell.map(|k| k as isize);
        for (disc, material) in self.discs.iter().zip(&mut self.material) {
            for [down, half] in disc {
                let own = row + down;
                if !(0..height).contains(&own) {
                    continue;
                }
                let from = (own * width + (column - half).max(0)) as usize;
                let to = (own * width + (column + half).min(width - 1)) as usize;
                material[from..=to].iter_mut().for_each(|count| *count -= 1);
            }
        }
    }
}

/// The rows of a disc about the middle of a cell, with half their width; the radius is in cells.
fn disc(radius: f64) -> Vec<[isize; 2]> {
    let most = radius.floor() as isize;
    (-most..=most)
        .map(|row| [row, (radius * radius - (row * row) as f64).max(0.0).sqrt().floor() as isize])
        .collect()
}
