//! Checks of grids of points, vectors and numbers.

use crate::config::Limits;
use crate::http::dto::check::Violations;
use crate::http::dto::point::Point;
use crate::http::dto::schema::{array_of, reference, schema_of};
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;

schema_of!(
    PointRows of Point,
    "Rows of points or vectors `[x, y, z]`, in mm. Every row is as long as the first row.",
    {
        let most = Limits::DEFAULT.surface_points / 2;
        array_of(array_of(reference::<Point>(), 2, most), 2, most)
    }
);

/// Checks the grid of points that gives a surface its size. Returns the numbers of rows and columns. `None`
/// where there are too many points to check each of them.
pub fn check_points(
    at: &Pointer,
    points: &[Vec<Point>],
    limits: &Limits,
    violations: &mut Violations,
) -> Option<[usize; 2]> {
    // An empty row counts as one point, so that the limit also bounds the number of violations by empty rows.
    let total: usize = points.iter().map(|row| row.len().max(1)).sum();
    if total > limits.surface_points {
        let detail = format!("the surface has {total} points; send at most {}", limits.surface_points);
        violations.add(at, FieldCode::LimitExceeded, detail);
        return None;
    }
    if points.len() < 2 {
        let detail = format!("there are {} rows; send at least 2", points.len());
        violations.add(at, FieldCode::TooFewPoints, detail);
    }
    let columns = points.first().map_or(0, Vec::len);
    for (i, row) in points.iter().enumerate() {
        let at_row = at.index(i);
        if row.len() < 2 {
            let detail = format!("the row has {} points; send at least 2", row.len());
            violations.add(&at_row, FieldCode::TooFewPoints, detail);
        } else if row.len() != columns {
            let detail = format!(
                "the row has {} points and row 0 has {columns}; make all rows equally long",
                row.len()
            );
            violations.add(&at_row, FieldCode::RaggedGrid, detail);
        }
        check_row(&at_row, row, violations);
    }
    Some([points.len(), columns])
}

/// Checks a grid of vectors or numbers that belongs to a grid of points with `size` rows and columns.
pub fn check_like<T>(
    at: &Pointer,
    grid: &[Vec<T>],
    [rows, columns]: [usize; 2],
    violations: &mut Violations,
    check_row: impl Fn(&Pointer, &[T], &mut Violations),
) {
    if grid.len() != rows {
        let detail = format!("there are {} rows for {rows} rows of points; send equally many", grid.len());
        violations.add(at, FieldCode::WrongLength, detail);
        return;
    }
    for (i, row) in grid.iter().enumerate() {
        let at_row = at.index(i);
        if row.len() != columns {
            let detail = format!("the row has {} entries for {columns} points; send equally many", row.len());
            violations.add(&at_row, FieldCode::WrongLength, detail);
        }
        check_row(&at_row, row, violations);
    }
}

/// Checks every coordinate of a row of points or vectors.
pub fn check_row(at: &Pointer, row: &[Point], violations: &mut Violations) {
    for (j, point) in row.iter().enumerate() {
        point.check_in(at, j, violations);
    }
}

/// Rows in the core's terms.
pub fn converted<T: From<Point>>(grid: Vec<Vec<Point>>) -> Vec<Vec<T>> {
    grid.into_iter().map(|row| row.into_iter().map(T::from).collect()).collect()
}
