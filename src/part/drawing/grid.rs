//! Places by square cells, to find those near a place.

use std::collections::HashMap;

/// Numbered places by square cells.
pub struct Grid {
    cells: HashMap<[i64; 2], Vec<usize>>,
    size: f64,
}

impl Grid {
    pub fn new(places: impl Iterator<Item = (usize, [f64; 2])>, size: f64) -> Self {
        let mut grid = Self { cells: HashMap::new(), size };
        for (number, place) in places {
            grid.cells.entry(grid.cell(place)).or_default().push(number);
        }
        grid
    }

    fn cell(&self, place: [f64; 2]) -> [i64; 2] {
        // A number beyond the range of `i64` is the last of the range.
        place.map(|x| (x / self.size).floor() as i64)
    }

    /// The numbers of the places in the cell of a place and the cells around it.
    pub fn near(&self, place: [f64; 2]) -> impl Iterator<Item = usize> + '_ {
        let [column, row] = self.cell(place);
        let around = |at: i64| [at.saturating_sub(1), at, at.saturating_add(1)];
        let cells = around(column).into_iter().flat_map(move |x| around(row).map(|y| [x, y]));
        cells.filter_map(|cell| self.cells.get(&cell)).flatten().copied()
    }
}
