//! A raster of cells over the sheet, which records where a pen has drawn.
//!
//! A stroke can be omitted if the pen has drawn in all cells of the stroke before. So every stroke that is
//! drawn adds at least one cell, and there are no more strokes than cells.

use nalgebra::Point2;

use super::SHEET_MM;

/// A raster with a bit for each cell of the sheet.
#[derive(Debug)]
pub struct Ink {
    cell_mm: f64,
    columns: usize,
    bits: Vec<u64>,
}

impl Ink {
    pub fn new(cell_mm: f64) -> Self {
        let [columns, rows] = SHEET_MM.map(|mm| (f64::from(mm) / cell_mm) as usize + 1);
        Self { cell_mm, columns, bits: vec![0; (columns * rows).div_ceil(64)] }
    }

    /// Inks a stroke of `length_mm`, where `point` gives its points at fractions from 0 to 1. `true` if all
    /// of its cells were inked before.
    pub fn covers(&mut self, length_mm: f64, point: impl Fn(f64) -> Point2<f64>) -> bool {
        let samples = (length_mm / self.cell_mm).ceil().max(1.0);
        let mut covered = true;
        for k in 0..=samples as usize {
            let at = point(k as f64 / samples);
            let cell = (at.y / self.cell_mm) as usize * self.columns + (at.x / self.cell_mm) as usize;
            // Points beside the sheet have no cell.
            if let Some(bits) = self.bits.get_mut(cell / 64) {
                covered &= *bits >> (cell % 64) & 1 == 1;
                *bits |= 1 << (cell % 64);
            }
        }
        covered
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stroke_is_covered_by_strokes_that_share_its_cells() {
        let mut ink = Ink::new(1.0);
        let line = |from: [f64; 2], to: [f64; 2]| {
            move |t: f64| Point2::from(from) + (Point2::from(to) - Point2::from(from)) * t
        };
        assert!(!ink.covers(10.0, line([10.5, 10.5], [20.5, 10.5])));
        assert!(ink.covers(10.0, line([20.4, 10.6], [10.4, 10.6])));
        assert!(ink.covers(3.0, line([12.0, 10.1], [15.0, 10.9])));
        assert!(!ink.covers(12.0, line([10.5, 10.5], [22.5, 10.5])));
        assert!(!ink.covers(0.0, line([10.5, 12.5], [10.5, 12.5])));
        assert!(ink.covers(0.0, line([10.6, 12.6], [10.6, 12.6])));
    }
}
