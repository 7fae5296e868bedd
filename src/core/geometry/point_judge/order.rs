//! The order of rows, of columns, and of the points in them.
//!
//! # Method
//! Only directions are compared, so the spacing does not matter, and the grid may be turned in plan.
//!
//! 1. A row runs the other way than the row before if more than half of its steps point against the steps of
//!    that row, and the row taken in reverse runs alike and lies nearer. Such rows are reversed.
//! 2. Rows turn back where more than half of the steps to the next row point against the steps from the row
//!    before, in plan and in space. A surface that overhangs turns back in plan alone. Rows that turn back
//!    are sorted along the direction in which they lie; the result counts if it nowhere turns back and bends
//!    less.
//! 3. A row whose own points turn back is sorted in the same way. The result counts if the points then lie
//!    beside the points of the neighbouring rows.
//! 4. The same is done with columns. All steps are repeated until nothing changes.
//!
//! # Degenerate input
//! Steps that are vertical, or zero, tell nothing of the order. A surface that folds back once is left as it
//! is.

use nalgebra::{Point3, Vector2, Vector3};

use super::sheet::Sheet;
use super::{Change, Fault};

/// Cosines beyond which two steps run alike, or against each other, in neighbouring rows: 60 degrees. Rows of
/// a fan turn by less from row to row.
const ALIKE: f64 = 0.5;

/// A row around a ring is reversed if its points in reverse lie nearer than this part of their distances.
const MUCH_NEARER: f64 = 0.7;

/// The cosine below which a step turns back: an angle of more than 134 degrees. A ring of three points turns
/// by 120 degrees.
const TURNS_BACK: f64 = -0.7;

/// A step in plan tells a direction if it is at least this part of the step in space. On steeper walls, the
/// plan holds little but noise.
const LEAST_PLAN_PART: f64 = 0.01;

/// A sorted order counts if its bends are at most this part of those before. Sorting the two sides of a fold
/// into each other makes more bends, not fewer.
const FEWER_BENDS: f64 = 0.9;

/// Largest distance, in steps, of a point of a sorted row from the points of the neighbouring rows. Farther
/// points show that sorting is wrong.
const BESIDE: f64 = 0.5;

/// Most rounds of all steps. Two suffice for a grid whose rows and columns both are out of order.
const MOST_ROUNDS: usize = 3;

/// What was found about the order of a grid.
pub struct Ordered {
    /// The grid in order; `None` if nothing had to be changed.
    pub sheet: Option<Sheet>,
    pub changes: Vec<Change>,
    pub faults: Vec<Fault>,
}

/// Puts a grid into order where only one order is possible. Otherwise names the rows that are out of order.
pub fn ordered(rows: &[Vec<Point3<f64>>], work: &mut usize) -> Ordered {
    let mut sheet = Sheet::new(rows);
    let mut changes = Vec::new();
    let points = rows.len() * rows[0].len();
    for _ in 0..MOST_ROUNDS {
        let before = changes.len();
        for is_columns in [false, true] {
            let mut turned = if is_columns { sheet.transposed() } else { sheet.clone() };
            *work += 8 * points;
            let changed = put_right(&mut turned, is_columns);
            if !changed.is_empty() {
                sheet = if is_columns { turned.transposed() } else { turned };
                changes.extend(changed);
            }
        }
        if changes.len() == before {
            break;
        }
    }
    let mut faults = Vec::new();
    *work += 8 * points;
    for is_columns in [false, true] {
        let turned = if is_columns { sheet.transposed() } else { sheet.clone() };
        faults.extend(disorder(&turned, is_columns));
    }
    let sheet = (!changes.is_empty()).then_some(sheet);
    Ordered { sheet, changes, faults }
}

/// Puts rows into order, and points within rows.
fn put_right(sheet: &mut Sheet, is_columns: bool) -> Vec<Change> {
    let mut changes = Vec::new();
    let reversed = reversed_rows(&sheet.points);
    if !reversed.is_empty() {
        reversed.iter().for_each(|i| sheet.reverse(*i));
        changes.push(Change::Reversed { is_columns, numbers: reversed });
    }
    if !turns(&sheet.points).is_empty()
        && let Some(order) = sorted_rows(&sheet.points)
    {
        let moved = order.iter().enumerate().filter(|(k, i)| k != *i).map(|(_, i)| *i).collect();
        *sheet = sheet.with_rows(&order);
        changes.push(Change::Sorted { is_columns, numbers: moved });
    }
    let within = sort_within(sheet);
    if !within.is_empty() {
        changes.push(Change::PointsSorted { is_columns, numbers: within });
    }
    changes
}

/// The rows that run the other way than most rows; of equally many, those that run the other way than the
/// first row.
fn reversed_rows(rows: &[Vec<Point3<f64>>]) -> Vec<usize> {
    let mut is_reversed = vec![false; rows.len()];
    for i in 1..rows.len() {
        is_reversed[i] = is_reversed[i - 1] != runs_against(&rows[i - 1], &rows[i]);
    }
    let count = is_reversed.iter().filter(|is| **is).count();
    let other = 2 * count > rows.len();
    (0..rows.len()).filter(|i| is_reversed[*i] != other).collect()
}

fn runs_against(before: &[Point3<f64>], row: &[Point3<f64>]) -> bool {
    let steps = before.len() - 1;
    let is_against = |cosine: &dyn Fn(Vector3<f64>, Vector3<f64>) -> Option<f64>| {
        let (mut against, mut alike, mut along) = (0, 0, 0);
        for j in 0..steps {
            let step = before[j + 1] - before[j];
            against += usize::from(cosine(step, row[j + 1] - row[j]).is_some_and(|c| c < -ALIKE));
            along += usize::from(cosine(step, row[j + 1] - row[j]).is_some_and(|c| c > ALIKE));
            let back = row[steps - j - 1] - row[steps - j];
            alike += usize::from(cosine(step, back).is_some_and(|c| c > ALIKE));
        }
        if 2 * against > steps && 2 * alike > steps {
            return Against::Surely;
        }
        // A row around a ring runs alike at places even in reverse.
        if 10 * alike > 9 * steps && 2 * along < steps { Against::Perhaps } else { Against::No }
    };
    // On slopes, steps in space point up and down; so the plan decides where it tells anything.
    let told = (0..steps).filter(|j| {
        let [a, b] = [before, row].map(|row| row[j + 1] - row[*j]);
        plan_cosine(a, b).is_some()
    });
    let is_plan = 2 * told.count() > steps;
    let against = if is_plan { is_against(&plan_cosine) } else { is_against(&cosine) };
    let straight: f64 = before.iter().zip(row).map(|(a, b)| (a - b).norm()).sum();
    let reversed: f64 = before.iter().zip(row.iter().rev()).map(|(a, b)| (a - b).norm()).sum();
    match against {
        Against::Surely => reversed < straight,
        Against::Perhaps => reversed < MUCH_NEARER * straight,
        Against::No => false,
    }
}

/// Whether a row runs against the one before, by its directions.
enum Against {
    Surely,
    Perhaps,
    No,
}

/// The numbers of the rows at which more than half of the columns turn back.
fn turns(rows: &[Vec<Point3<f64>>]) -> Vec<usize> {
    let columns = rows[0].len();
    let is_turn = |i: &usize| {
        let count = (0..columns).filter(|j| turns_back([&rows[i - 1][*j], &rows[*i][*j], &rows[i + 1][*j]]));
        2 * count.count() > columns
    };
    (1..rows.len().saturating_sub(1)).filter(is_turn).collect()
}

fn turns_back([a, b, c]: [&Point3<f64>; 3]) -> bool {
    let (first, second) = (b - a, c - b);
    let is_back = |cosine: Option<f64>| cosine.is_some_and(|cosine| cosine < TURNS_BACK);
    is_back(plan_cosine(first, second)) && is_back(cosine(first, second))
}

fn cosine(a: Vector3<f64>, b: Vector3<f64>) -> Option<f64> {
    let lengths = a.norm() * b.norm();
    (lengths > 0.0).then(|| a.dot(&b) / lengths)
}

fn plan_cosine(a: Vector3<f64>, b: Vector3<f64>) -> Option<f64> {
    let tells = |step: &Vector3<f64>| step.xy().norm() > LEAST_PLAN_PART * step.norm();
    if !tells(&a) || !tells(&b) {
        return None;
    }
    Some(a.xy().dot(&b.xy()) / (a.xy().norm() * b.xy().norm()))
}

/// The rows sorted along the direction in which they lie; `None` where the sorted rows turn back, coincide,
/// or do not bend less.
fn sorted_rows(rows: &[Vec<Point3<f64>>]) -> Option<Vec<usize>> {
    let middles: Vec<Vector2<f64>> = rows.iter().map(|row| middle(row)).collect();
    let direction = principal(&middles)?;
    let mut keys: Vec<(usize, f64)> = middles.iter().map(|m| m.dot(&direction)).enumerate().collect();
    // Most steps of the order as it was sent go up.
    let up = keys.windows(2).filter(|pair| pair[1].1 > pair[0].1).count();
    let sign = if 2 * up < keys.len() - 1 { -1.0 } else { 1.0 };
    keys.sort_by(|a, b| (sign * a.1).total_cmp(&(sign * b.1)));
    if keys.windows(2).any(|pair| pair[0].1 == pair[1].1) {
        return None;
    }
    let order: Vec<usize> = keys.into_iter().map(|(i, _)| i).collect();
    let sorted: Vec<Vec<Point3<f64>>> = order.iter().map(|i| rows[*i].clone()).collect();
    (turns(&sorted).is_empty() && bends(&sorted) < FEWER_BENDS * bends(rows)).then_some(order)
}

fn middle(points: &[Point3<f64>]) -> Vector2<f64> {
    points.iter().map(|p| p.coords.xy()).sum::<Vector2<f64>>() / points.len() as f64
}

/// The sum of all second differences from row to row, mm.
fn bends(rows: &[Vec<Point3<f64>>]) -> f64 {
    let bend = |three: &[Vec<Point3<f64>>]| -> f64 {
        let [a, b, c] = [&three[0], &three[1], &three[2]];
        (0..a.len()).map(|j| (a[j].coords - b[j].coords * 2.0 + c[j].coords).norm()).sum()
    };
    rows.windows(3).map(bend).sum()
}

/// The direction along which places in the plan are spread most.
fn principal(places: &[Vector2<f64>]) -> Option<Vector2<f64>> {
    let mean = places.iter().sum::<Vector2<f64>>() / places.len() as f64;
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for p in places.iter().map(|p| p - mean) {
        xx += p.x * p.x;
        xy += p.x * p.y;
        yy += p.y * p.y;
    }
    if xx + yy <= 0.0 {
        return None;
    }
    let angle = 0.5 * (2.0 * xy).atan2(xx - yy);
    Some(Vector2::new(angle.cos(), angle.sin()))
}

/// Sorts the rows whose points turn back. Returns the numbers of the rows.
fn sort_within(sheet: &mut Sheet) -> Vec<usize> {
    let [n, columns] = sheet.size();
    let is_folded = |row: &Vec<Point3<f64>>| row.windows(3).any(|w| turns_back([&w[0], &w[1], &w[2]]));
    let folded: Vec<usize> = (0..n).filter(|i| is_folded(&sheet.points[*i])).collect();
    // With two rows, the other row alone cannot tell.
    if folded.is_empty() || n < 3 {
        return Vec::new();
    }
    let straight = || (0..n).filter(|i| folded.binary_search(i).is_err());
    let from_middle = |i: usize| {
        let middle = middle(&sheet.points[i]);
        sheet.points[i].iter().map(move |p| p.coords.xy() - middle).collect::<Vec<_>>()
    };
    let of: Vec<usize> = if straight().next().is_some() { straight().collect() } else { (0..n).collect() };
    let spread: Vec<Vector2<f64>> = of.iter().flat_map(|i| from_middle(*i)).collect();
    let Some(mut direction) = principal(&spread) else { return Vec::new() };
    // The sorted rows run the way of the others.
    let runs: f64 =
        of.iter().map(|i| (sheet.points[*i][columns - 1] - sheet.points[*i][0]).xy().dot(&direction)).sum();
    if runs < 0.0 {
        direction = -direction;
    }
    let mut sorted = sheet.clone();
    for i in &folded {
        let key = |j: usize| sheet.points[*i][j].coords.xy().dot(&direction);
        let mut order: Vec<usize> = (0..columns).collect();
        order.sort_by(|a, b| key(*a).total_cmp(&key(*b)));
        sorted.arrange(*i, &order);
    }
    let key = |i: usize, j: usize| sorted.points[i][j].coords.xy().dot(&direction);
    let lies_beside = |i: usize| {
        let others: Vec<usize> =
            [i.checked_sub(1), Some(i + 1)].into_iter().flatten().filter(|k| *k < n).collect();
        (0..columns).all(|j| {
            let step = |a: usize, b: usize| key(i, b) - key(i, a);
            let before = if j > 0 { step(j - 1, j) } else { f64::INFINITY };
            let after = if j + 1 < columns { step(j, j + 1) } else { f64::INFINITY };
            let step = before.min(after);
            step > 0.0 && others.iter().all(|k| (key(*k, j) - key(i, j)).abs() <= BESIDE * step)
        })
    };
    let right: Vec<usize> = folded.into_iter().filter(|i| lies_beside(*i)).collect();
    for i in &right {
        sheet.points[*i].clone_from(&sorted.points[*i]);
        sheet.places[*i].clone_from(&sorted.places[*i]);
    }
    right
}

/// The first row that turns back in a grid that turns back more than once.
fn disorder(sheet: &Sheet, is_columns: bool) -> Option<Fault> {
    let turns = turns(&sheet.points);
    if turns.len() < 2 {
        return None;
    }
    let place = sheet.places[turns[0] + 1][0];
    Some(Fault::OutOfOrder { is_columns, number: place[usize::from(is_columns)] })
}
