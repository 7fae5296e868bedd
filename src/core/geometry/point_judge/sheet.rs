//! A grid of points on its way into order, with the place that each point was sent at.

use nalgebra::Point3;

/// Points with the places that they were sent at. All rows are equally long.
#[derive(Clone)]
pub struct Sheet {
    pub points: Vec<Vec<Point3<f64>>>,
    pub places: Vec<Vec<[usize; 2]>>,
}

impl Sheet {
    pub fn new(rows: &[Vec<Point3<f64>>]) -> Self {
        let place = |i: usize| (0..rows[i].len()).map(|j| [i, j]).collect();
        Self { points: rows.to_vec(), places: (0..rows.len()).map(place).collect() }
    }

    /// The numbers of rows and columns.
    pub fn size(&self) -> [usize; 2] {
        [self.points.len(), self.points[0].len()]
    }

    /// Rows become columns.
    pub fn transposed(&self) -> Self {
        Self { points: transposed(&self.points), places: transposed(&self.places) }
    }

    /// Reverses the points of row `i`.
    pub fn reverse(&mut self, i: usize) {
        self.points[i].reverse();
        self.places[i].reverse();
    }

    /// The same rows in another order.
    pub fn with_rows(&self, order: &[usize]) -> Self {
        let points = order.iter().map(|i| self.points[*i].clone()).collect();
        Self { points, places: order.iter().map(|i| self.places[*i].clone()).collect() }
    }

    /// Puts the points of row `i` into another order.
    pub fn arrange(&mut self, i: usize, order: &[usize]) {
        self.points[i] = order.iter().map(|j| self.points[i][*j]).collect();
        self.places[i] = order.iter().map(|j| self.places[i][*j]).collect();
    }
}

pub fn transposed<T: Copy>(rows: &[Vec<T>]) -> Vec<Vec<T>> {
    (0..rows[0].len()).map(|j| rows.iter().map(|row| row[j]).collect()).collect()
}
