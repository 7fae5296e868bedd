//! A grid of points over a pocket, and the points that the cutter's disc passes over.

use super::plane::P;

/// Points `cell` mm apart.
#[derive(Debug, Clone, Copy)]
pub struct Grid {
    origin: P,
    pub cell: f64,
    pub columns: usize,
    pub rows: usize,
}

impl Grid {
    pub fn new([low, high]: [P; 2], cell: f64) -> Self {
        // The offset keeps the points off the round coordinates of the cases.
        let origin = [low[0] - 1.0 + 0.00371, low[1] - 1.0 + 0.00613];
        let count = |k: usize| ((high[k] - low[k] + 2.0) / cell).ceil() as usize + 1;
        Self { origin, cell, columns: count(0), rows: count(1) }
    }

    pub fn len(&self) -> usize {
        self.columns * self.rows
    }

    pub fn area(&self, count: usize) -> f64 {
        count as f64 * self.cell * self.cell
    }

    pub fn y(&self, row: usize) -> f64 {
        self.origin[1] + row as f64 * self.cell
    }

    pub fn point(&self, index: usize) -> P {
        [self.origin[0] + (index % self.columns) as f64 * self.cell, self.y(index / self.columns)]
    }

    /// The number of points of a row left of `x`.
    pub fn column(&self, x: f64) -> usize {
        (((x - self.origin[0]) / self.cell).ceil().max(0.0) as usize).min(self.columns)
    }

    /// Calls `visit` with the range of indices of each row whose points are nearer than `radius` to the line
    /// from `a` to `b`.
    pub fn near(&self, a: P, b: P, radius: f64, mut visit: impl FnMut(std::ops::Range<usize>)) {
        let place = |y: f64| ((y - self.origin[1]) / self.cell).ceil().max(0.0) as usize;
        let first = place(a[1].min(b[1]) - radius);
        let last = place(a[1].max(b[1]) + radius).min(self.rows);
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let length = dx.hypot(dy);
        let [nx, ny] = if length > 0.0 { [-dy / length * radius, dx / length * radius] } else { [0.0; 2] };
        for row in first..last {
            let y = self.y(row);
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for [cx, cy] in [a, b] {
                let rise = radius * radius - (y - cy) * (y - cy);
                if rise > 0.0 {
                    let half = rise.sqrt();
                    (low, high) = (low.min(cx - half), high.max(cx + half));
                }
            }
            // The area is convex: its ends in a row are on the discs or on the two sides between them.
            for sign in [1.0, -1.0] {
                let (sx, sy) = (a[0] + sign * nx, a[1] + sign * ny);
                let t = (y - sy) / dy;
                if (0.0..=1.0).contains(&t) {
                    (low, high) = (low.min(sx + t * dx), high.max(sx + t * dx));
                }
            }
            let (from, to) = (self.column(low), self.column(high));
            if low < high && from < to {
                visit(row * self.columns + from..row * self.columns + to);
            }
        }
    }
}
