//! The highest cells of squares of many cells, for searches that leave out whole squares.

/// Cells along one side of a block.
pub(super) const SIDE: usize = 8;

/// The highest cell of each block of a band.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Blocks {
    /// Numbers of cells along x and y.
    cells: [usize; 2],
    most: Vec<f64>,
    /// Blocks with a cell that has become lower.
    is_stale: Vec<bool>,
}

impl Blocks {
    pub(super) fn new(cells: [usize; 2]) -> Self {
        let n = cells[0].div_ceil(SIDE) * cells[1].div_ceil(SIDE);
        Self { cells, most: vec![f64::NEG_INFINITY; n], is_stale: vec![true; n] }
    }

    fn columns(&self) -> usize {
        self.cells[0].div_ceil(SIDE)
    }

    /// The cell (i, j) has become lower.
    pub(super) fn touch(&mut self, i: usize, j: usize) {
        let k = j / SIDE * self.columns() + i / SIDE;
        self.is_stale[k] = true;
    }

    /// The height of the highest cell of the block (a, b).
    pub(super) fn most(&mut self, a: usize, b: usize, heights: &[f64]) -> f64 {
        let k = b * self.columns() + a;
        if self.is_stale[k] {
            let [rows, columns] = [(b, self.cells[1]), (a, self.cells[0])]
                .map(|(block, n)| block * SIDE..((block + 1) * SIDE).min(n));
            let row = |j: usize| &heights[j * self.cells[0]..][columns.clone()];
            self.most[k] = rows.flat_map(row).copied().fold(f64::NEG_INFINITY, f64::max);
            self.is_stale[k] = false;
        }
        self.most[k]
    }
}
