//! The grid of a height map: squares of the plane in rows along x.

use nalgebra::{Point2, Vector2};

/// Equal rectangles that fill a rectangle of the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// The corner with the least x and y, mm.
    pub low: Point2<f64>,
    /// The size of a cell along x and y, mm.
    pub cell: Vector2<f64>,
    /// Numbers of cells along x and y.
    pub n: [usize; 2],
}

impl Grid {
    /// Cells of at most `cell_mm` along x and y that fill the rectangle between two corners.
    pub fn over(low: Point2<f64>, high: Point2<f64>, cell_mm: f64) -> Self {
        let size = high - low;
        let n = [size.x, size.y].map(|size| ((size / cell_mm) * (1.0 - 1e-12)).ceil().max(1.0) as usize);
        Self { low, cell: Vector2::new(size.x / n[0] as f64, size.y / n[1] as f64), n }
    }

    /// The number of cells; it may exceed what there is memory for.
    pub fn cells(&self) -> f64 {
        self.n[0] as f64 * self.n[1] as f64
    }

    /// The corner of cells with the indices i along x and j along y.
    pub fn corner(&self, i: usize, j: usize) -> Point2<f64> {
        Point2::new(self.low.x + self.cell.x * i as f64, self.low.y + self.cell.y * j as f64)
    }

    /// Half of the diagonal of a cell, mm.
    pub fn half_diagonal(&self) -> f64 {
        0.5 * self.cell.norm()
    }

    /// The columns of the cells that meet a range of x, without the last.
    pub(super) fn columns(&self, [low, high]: [f64; 2]) -> [usize; 2] {
        range(low - self.low.x, high - self.low.x, self.cell.x, self.n[0])
    }

    /// The rows of the cells that meet a range of y, without the last.
    pub(super) fn rows(&self, [low, high]: [f64; 2]) -> [usize; 2] {
        range(low - self.low.y, high - self.low.y, self.cell.y, self.n[1])
    }
}

/// The cells that meet the range, widened by a rounding.
fn range(low: f64, high: f64, cell: f64, n: usize) -> [usize; 2] {
    let from = (low / cell - 1e-9).floor().max(0.0) as usize;
    let to = (high / cell + 1e-9).ceil().clamp(0.0, n as f64) as usize;
    [from.min(n), to.max(from.min(n))]
}
