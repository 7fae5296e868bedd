//! A judge of points: finds the mistakes in a grid of measured points before anything is computed, and
//! mends each mistake that has only one mend.
//!
//! # Method
//! The steps run in this order; a step that finds faults ends the search, because it explains what later
//! steps would find.
//! 1. `missing`: numbers that stand for a missing value.
//! 2. `coincident`: points, rows and columns that repeat others.
//! 3. `order`: rows and columns that run the other way or are shuffled. They are put into order.
//! 4. `axes`: z exchanged with another axis.
//! 5. `outliers`: points that leave the surface of their neighbours.
//!
//! # Guarantees
//! The verdict is a function of the points alone. A grid that is returned in order is judged again without a
//! change.
//!
//! # Degenerate input
//! A grid with rows of different lengths, fewer than two rows or two columns, or a number that is not finite,
//! is not judged: other checks refuse it.
//!
//! # Cost
//! O(n) for n points: each point is visited a fixed number of times (`Verdict::work`).

mod axes;
mod coincident;
mod missing;
mod order;
mod outliers;
mod sheet;
#[cfg(test)]
mod tests;
mod window;

use nalgebra::Point3;

/// What is wrong with a grid. Places `[i, j]` count in the grid as it was sent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fault {
    /// All points are the same.
    AllSame,
    /// The number stands for a missing value. The axis is 0 for x, 1 for y, 2 for z.
    Missing { place: [usize; 2], axis: usize, value: f64 },
    /// A row or a column repeats the row or column `of`.
    Repeated { is_columns: bool, number: usize, of: usize },
    /// The point repeats the point `of`.
    Doubled { place: [usize; 2], of: [usize; 2] },
    /// z and the axis 0 (x) or 1 (y) are exchanged.
    ExchangedAxes { axis: usize },
    /// The row or column runs the other way than most. [`judge`] reverses it; a caller that must not change
    /// the order reports this fault.
    Backward { is_columns: bool, number: usize },
    /// The row or column does not follow the one before, and no order is certain.
    OutOfOrder { is_columns: bool, number: usize },
    /// The point is `off_mm` off the surface of its neighbours, which lie within `usual_mm` of it.
    Outlier { place: [usize; 2], off_mm: f64, usual_mm: f64 },
}

/// What was put right. The numbers count in the grid as it was sent, or as an earlier change left it.
#[derive(Debug, Clone, PartialEq)]
pub enum Change {
    /// Rows or columns that ran the other way are reversed.
    Reversed { is_columns: bool, numbers: Vec<usize> },
    /// Rows or columns are sorted; the numbers are of those that moved.
    Sorted { is_columns: bool, numbers: Vec<usize> },
    /// The points within rows or columns are sorted.
    PointsSorted { is_columns: bool, numbers: Vec<usize> },
}

/// The verdict about a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// The places of the points in the right order; `None` where the grid is in order.
    pub order: Option<Vec<Vec<[usize; 2]>>>,
    /// What the order changes.
    pub changes: Vec<Change>,
    pub faults: Vec<Fault>,
    /// Visits of points.
    pub work: usize,
}

impl Verdict {
    /// The faults of a grid whose order must not be changed: what the order changes is a fault, too.
    pub fn faults_as_sent(&self) -> Vec<Fault> {
        let of = |change: &Change| match change {
            Change::Reversed { is_columns, numbers } => {
                Some(Fault::Backward { is_columns: *is_columns, number: *numbers.first()? })
            }
            Change::Sorted { is_columns, numbers } | Change::PointsSorted { is_columns, numbers } => {
                Some(Fault::OutOfOrder { is_columns: *is_columns, number: *numbers.first()? })
            }
        };
        self.changes.iter().filter_map(of).chain(self.faults.iter().copied()).collect()
    }
}

/// Judges points `rows[i][j]` in space.
pub fn judge(rows: &[Vec<Point3<f64>>]) -> Verdict {
    let mut verdict = Verdict { order: None, changes: Vec::new(), faults: Vec::new(), work: 0 };
    if !is_grid(rows) {
        return verdict;
    }
    let work = &mut verdict.work;
    verdict.faults = missing::missing(rows, &[0, 1, 2], work);
    if verdict.faults.is_empty() {
        verdict.faults = coincident::coincident(rows, work);
    }
    if !verdict.faults.is_empty() {
        return verdict;
    }
    let order::Ordered { sheet, changes, faults } = order::ordered(rows, work);
    verdict.changes = changes;
    verdict.faults = faults;
    if verdict.faults.is_empty() {
        let (points, places) = match sheet {
            Some(sheet) => (Some(sheet.points), Some(sheet.places)),
            None => (None, None),
        };
        let points = points.as_deref().unwrap_or(rows);
        verdict.faults.extend(axes::exchanged(points, work));
        if verdict.faults.is_empty() {
            verdict.faults = outliers::outliers(points, work);
        }
        if let Some(places) = &places {
            verdict.faults.iter_mut().for_each(|fault| {
                if let Fault::Outlier { place, .. } = fault {
                    *place = places[place[0]][place[1]];
                }
            });
        }
        verdict.order = places;
    }
    verdict
}

/// Judges heights at the places of a grid: only missing values and outliers. A fault names the
/// row and the column of its height.
pub fn judge_heights(spacing_mm: f64, heights: &[Vec<f64>]) -> Verdict {
    let at = |j: usize, (i, z): (usize, &f64)| Point3::new(spacing_mm * i as f64, spacing_mm * j as f64, *z);
    let rows: Vec<Vec<Point3<f64>>> = heights
        .iter()
        .enumerate()
        .map(|(j, row)| row.iter().enumerate().map(|cell| at(j, cell)).collect())
        .collect();
    let mut verdict = Verdict { order: None, changes: Vec::new(), faults: Vec::new(), work: 0 };
    if is_grid(&rows) {
        verdict.faults = missing::missing(&rows, &[2], &mut verdict.work);
        if verdict.faults.is_empty() {
            verdict.faults = outliers::outliers(&rows, &mut verdict.work);
        }
    }
    verdict
}

fn is_grid(rows: &[Vec<Point3<f64>>]) -> bool {
    let columns = rows.first().map_or(0, Vec::len);
    rows.len() >= 2
        && columns >= 2
        && rows.iter().all(|row| row.len() == columns)
        && rows.iter().flatten().flat_map(|p| p.iter()).all(|x| x.is_finite())
}
