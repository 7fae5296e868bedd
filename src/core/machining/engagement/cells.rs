//! A grid of square cells that finds the chords near a place. Chords may be added between searches.

use std::collections::HashMap;

use nalgebra::Point2;

use crate::geometry::segment::Segment;

/// The cells that list chords, each with the indices of its chords.
#[derive(Debug, Clone)]
pub(super) struct Cells {
    size_mm: f64,
    cells: HashMap<[i64; 2], Vec<u32>>,
}

impl Cells {
    pub(super) fn new(size_mm: f64) -> Self {
        Self { size_mm, cells: HashMap::new() }
    }

    /// Adds a chord. The chord is divided into pieces that are at most as long as a cell. The cell with the
    /// middle of a piece lists the chord.
    pub(super) fn add(&mut self, start: Point2<f64>, end: Point2<f64>, index: u32) {
        let count = ((end - start).norm() / self.size_mm).ceil().max(1.0) as usize;
        let mut before = None;
        for k in 0..count {
            let [a, b] = [k, k + 1].map(|k| start + (end - start) * (k as f64 / count as f64));
            let cell = self.cell(a + (b - a) * 0.5);
            if before != Some(cell) {
                self.cells.entry(cell).or_default().push(index);
                before = Some(cell);
            }
        }
    }

    /// Finds the chords that may be nearer to an element than `within` mm, each once, in ascending order.
    pub(super) fn near(&self, element: &Segment, within: f64, found: &mut Vec<u32>) {
        let (middle, reach) = element.disc();
        self.about(middle, reach + within, found);
        found.sort_unstable();
        found.dedup();
    }

    /// Finds the chords that may be nearer to a place than `within` mm. A chord may be found more than
    /// once.
    pub(super) fn about(&self, middle: Point2<f64>, within: f64, found: &mut Vec<u32>) {
        found.clear();
        // Every point of a piece is at most half a cell away from the middle of the piece.
        let reach = within + 0.5 * self.size_mm;
        let corner = |side: f64| self.cell(middle + nalgebra::Vector2::new(side, side) * reach);
        let ([x0, y0], [x1, y1]) = (corner(-1.0), corner(1.0));
        for x in x0..=x1 {
            for y in y0..=y1 {
                found.extend(self.cells.get(&[x, y]).into_iter().flatten());
            }
        }
    }

    fn cell(&self, p: Point2<f64>) -> [i64; 2] {
        [p.x, p.y].map(|x| (x / self.size_mm).floor() as i64)
    }
}
