//! The grid of a height map: squares of the plane in rows along x.

use nalgebra::{Point2, Vector2};

use crate::geometry::region::Containment;

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

    /// Divides the cells of a rectangle of the grid into rectangles on one side of a boundary and single
    /// cells across it, and tells each with its place. `place` tells where the disc of a radius about a point
    /// lies.
    pub fn divide(
        &self,
        [columns, rows]: [[usize; 2]; 2],
        place: &impl Fn(Point2<f64>, f64) -> Containment,
        tell: &mut impl FnMut([[usize; 2]; 2], Containment),
    ) {
        let [width, height] = [columns, rows].map(|[from, to]| to - from);
        if width == 0 || height == 0 {
            return;
        }
        let [low, high] = [self.corner(columns[0], rows[0]), self.corner(columns[1], rows[1])];
        let own = place(nalgebra::center(&low, &high), 0.5 * (high - low).norm());
        if own != Containment::OnBoundary || (width == 1 && height == 1) {
            tell([columns, rows], own);
        } else if width >= height {
            let middle = columns[0] + width / 2;
            self.divide([[columns[0], middle], rows], place, tell);
            self.divide([[middle, columns[1]], rows], place, tell);
        } else {
            let middle = rows[0] + height / 2;
            self.divide([columns, [rows[0], middle]], place, tell);
            self.divide([columns, [middle, rows[1]]], place, tell);
        }
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
