//! Finds mistakes in a grid of points before anything is computed: repeated and reversed rows, repeated
//! columns, and outliers.

use nalgebra::Point3;

use crate::http::dto::check::Violations;
use crate::http::dto::point::Point;
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;

/// Largest distance of two points that count as the same point, mm.
const SAME_MM: f64 = 1e-9;

/// A row counts as reversed when its points, taken in reverse, lie much nearer to the points of the row
/// before. The sum of their distances is then less than this fraction of the sum in the given order.
const REVERSED_PART: f64 = 0.5;

/// A point is an outlier when the distance to its nearest neighbour is more than this many times the largest
/// distance of its neighbours from their other neighbours.
const OUTLIER_FACTOR: f64 = 5.0;

/// Fewest rows, and fewest columns, of a grid that is searched for outliers. In a smaller grid the corner of
/// a part looks like an outlier.
const LEAST_ROWS: usize = 3;

/// Reports a grid whose points are all the same. Otherwise reports the first row and the first column that
/// repeat the one before, the first reversed row, and, where outliers are refused and no row is reversed, the
/// first outlier. A grid whose rows differ in length is not checked here.
pub fn check(at: &Pointer, points: &[Vec<Point>], refuses_outliers: bool, violations: &mut Violations) {
    let rows: Vec<Vec<Point3<f64>>> =
        points.iter().map(|row| row.iter().copied().map(Point3::from).collect()).collect();
    let columns = rows.first().map_or(0, Vec::len);
    if columns == 0 || rows.iter().any(|row| row.len() != columns) {
        return;
    }
    let is_same = |a: &Point3<f64>, b: &Point3<f64>| (a - b).norm() <= SAME_MM;
    let first = rows[0][0];
    if rows.iter().flatten().all(|p| is_same(p, &first)) {
        violations.add(at, FieldCode::Coincident, "all points are the same: send points of a surface");
        return;
    }
    let repeats = |pair: &[Vec<Point3<f64>>]| pair[0].iter().zip(&pair[1]).all(|(a, b)| is_same(a, b));
    if let Some(i) = rows.windows(2).position(repeats) {
        let detail = format!("row {} repeats row {i}: leave one of them out", i + 1);
        violations.add(&at.index(i + 1), FieldCode::Coincident, detail);
    }
    let repeats = |j: &usize| rows.iter().all(|row| is_same(&row[*j], &row[j - 1]));
    if let Some(j) = (1..columns).find(repeats) {
        let detail = format!("column {j} repeats column {} in every row: leave one of them out", j - 1);
        violations.add(&at.index(0).index(j), FieldCode::Coincident, detail);
    }
    if let Some(i) = rows.windows(2).position(|pair| is_reversed(&pair[0], &pair[1])) {
        let detail = format!(
            "row {} runs the other way than row {i}: reverse the row, so that all rows run alike",
            i + 1
        );
        violations.add(&at.index(i + 1), FieldCode::ReversedRow, detail);
    } else if refuses_outliers
        && let Some(Outlier { place: [i, j], from_neighbours, between }) = outlier(&rows)
    {
        let detail = format!(
            "the point is {from_neighbours:.4} mm from its nearest neighbour, and the neighbours are at most {between:.4} mm from each \
             other: correct the point, or send `outliers: accept`"
        );
        violations.add(&at.index(i).index(j), FieldCode::Outlier, detail);
    }
}

/// A point that is far away from all of its neighbours.
struct Outlier {
    place: [usize; 2],
    /// The distance to the nearest neighbour, mm.
    from_neighbours: f64,
    /// The largest distance of a neighbour from the neighbour's other neighbours, mm.
    between: f64,
}

/// The first outlier of the grid. `None` where there is none, or the grid is too small.
fn outlier(rows: &[Vec<Point3<f64>>]) -> Option<Outlier> {
    let size = [rows.len(), rows[0].len()];
    if size.iter().any(|n| *n < LEAST_ROWS) {
        return None;
    }
    let neighbours = |[i, j]: [usize; 2]| {
        let rows = [i.checked_sub(1), Some(i + 1)].into_iter().flatten().filter(move |i| *i < size[0]);
        let columns = [j.checked_sub(1), Some(j + 1)].into_iter().flatten().filter(move |j| *j < size[1]);
        rows.map(move |row| [row, j]).chain(columns.map(move |column| [i, column]))
    };
    let apart = |[a, b]: [usize; 2], [c, d]: [usize; 2]| (rows[a][b] - rows[c][d]).norm();
    let places = (0..size[0]).flat_map(|i| (0..size[1]).map(move |j| [i, j]));
    for place in places {
        let from_neighbours =
            neighbours(place).map(|other| apart(place, other)).fold(f64::INFINITY, f64::min);
        let others = neighbours(place).flat_map(|other| {
            neighbours(other).filter(move |next| *next != place).map(move |next| apart(other, next))
        });
        let between = others.fold(0.0, f64::max);
        if from_neighbours > OUTLIER_FACTOR * between {
            return Some(Outlier { place, from_neighbours, between });
        }
    }
    None
}

/// Whether `row` runs the other way than the row before.
fn is_reversed(before: &[Point3<f64>], row: &[Point3<f64>]) -> bool {
    let straight: f64 = before.iter().zip(row).map(|(a, b)| (a - b).norm()).sum();
    let reversed: f64 = before.iter().zip(row.iter().rev()).map(|(a, b)| (a - b).norm()).sum();
    reversed < REVERSED_PART * straight
}
