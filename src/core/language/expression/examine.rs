//! Proves that an expression is defined over a domain, and encloses its values there.
//!
//! An operation *offends* if it is not defined for its operand, such as sqrt for a negative number, or if its
//! result is too large for a floating-point number.
//!
//! # Method
//! 1. The expression is computed at some points of the domain.
//! 2. A cell is a part of the domain; the first cell is the whole domain. For each cell, the expression is
//!    computed at the middle, and over the whole cell with intervals.
//! 3. If an operation certainly offends, at a point or over a whole cell, the search ends with an error.
//! 4. If the intervals leave open whether an operation offends in a cell, the cell is halved into two new
//!    cells.
//! 5. If no operation offends in a cell, the intervals bound the values there. If these bounds go far beyond
//!    the values computed at points, the cell is halved, too. After [`MOST_CELLS_FOR_BOUNDS`] cells, no cell
//!    is halved for this reason.
//!
//! # Guarantees
//! If there is no error, every operation is defined, continuous and finite over the domain, and the values
//! are within the returned bounds. Rounding requires one exception: a negative operand of sqrt counts as zero
//! in two cases. In the first case its size is at most 1e-12 times that of the terms that were added to
//! obtain it. In the second case it is negative only in a part of a cell that is too narrow to be halved. The
//! same exception is made at the ends of the domains of asin, acos and powers.
//!
//! # Degenerate input
//! * A domain is an error unless it is two finite numbers, the first less than the second.
//! * An expression that has only a limit and no value at some place, such as sin(x)/x at zero, is an error.
//! * A search that needs more than [`MOST_CELLS`] cells ends with an error.
//!
//! # Cost
//! O(n) for each cell, where n is the number of operations.

use super::enclose::{self, Middle};
use super::offence::{Certainty, Finding, Offence};
use super::tape::Tape;
use crate::budget::{Budget, Stopped};
use crate::geometry::interval::Interval;

/// Most cells of the search: a second or two for an expression of common length. Only an expression that
/// comes very close to an offence at thousands of places needs as many.
const MOST_CELLS: usize = 200_000;

/// Most halvings of a cell. After these, a cell is as narrow as the rounding of the domain.
const DEEPEST: u32 = 52;

/// Parts of the domain between the points that are computed first.
const FIRST_PARTS: u32 = 32;

/// Cells after which legal cells are no longer halved for tighter bounds.
const MOST_CELLS_FOR_BOUNDS: usize = 10_000;

/// How far the bounds may exceed the values at points, as a part of the largest value.
const LOOSENESS: f64 = 1e-4;

/// How far the bounds may exceed the values at points in addition, mm. It matters where all values are near
/// zero.
const LEAST_LOOSENESS: f64 = 1e-9;

/// Steps of tapes between two checks of the budget: some milliseconds.
const STEPS_UNWATCHED: usize = 50_000;

/// Why an expression cannot be used over a domain. `at` is the byte of the text of the offending operation.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Undefined {
    #[error("the domain must be two finite numbers, the first less than the second")]
    NoDomain,
    #[error("{offence} at x = {x} (byte {at})")]
    At { offence: Offence, x: f64, at: usize },
    /// The offence is in a cell around `x` that is as narrow as the rounding of the domain.
    #[error("{offence} near x = {x} (byte {at})")]
    Near { offence: Offence, x: f64, at: usize },
    /// The search ran out of cells.
    #[error("{offence} cannot be ruled out near x = {x} (byte {at})")]
    NotRuledOut { offence: Offence, x: f64, at: usize },
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

/// A part of the domain.
struct Cell {
    from: f64,
    to: f64,
    halvings: u32,
}

pub fn examine(tape: &Tape, [from, to]: [f64; 2], budget: &Budget) -> Result<Interval, Undefined> {
    if !(from.is_finite() && to.is_finite() && from < to && (to - from).is_finite()) {
        return Err(Undefined::NoDomain);
    }
    budget.check()?;
    let mut seen = values_at_points(tape, from, to)?;
    let mut bounds = seen;
    let mut cells = vec![Cell { from, to, halvings: 0 }];
    let (mut count, mut unwatched) = (0, 0);
    // The leftmost cell comes first, so the leftmost fault is reported.
    while let Some(cell) = cells.pop() {
        count += 1;
        unwatched += tape.steps().len();
        if unwatched > STEPS_UNWATCHED {
            budget.check()?;
            unwatched = 0;
        }
        let range = Interval::between(cell.from, cell.to);
        let middle = legal_at(tape, range.mid())?;
        seen = seen.hull(Interval::point(middle.value.mid()));
        let ([values, ..], finding) = enclose::over(tape, range, &middle);
        let done = match finding {
            Some(finding) => is_settled(finding, &cell, count)?,
            None => count > MOST_CELLS_FOR_BOUNDS || cell.halvings == DEEPEST || is_tight(values, seen),
        };
        if done {
            bounds = bounds.hull(values);
        } else {
            let (middle, halvings) = (range.mid(), cell.halvings + 1);
            cells.push(Cell { from: middle, to: cell.to, halvings });
            cells.push(Cell { from: cell.from, to: middle, halvings });
        }
    }
    Ok(bounds)
}

/// The hull of the values at the ends of the domain and at points between.
fn values_at_points(tape: &Tape, from: f64, to: f64) -> Result<Interval, Undefined> {
    let mut seen = legal_at(tape, from)?.value.hull(legal_at(tape, to)?.value);
    for k in 1..FIRST_PARTS {
        let x = from + f64::from(k) / f64::from(FIRST_PARTS) * (to - from);
        seen = seen.hull(legal_at(tape, x)?.value);
    }
    Ok(seen)
}

/// The expression at `x`; an error if it certainly offends there.
fn legal_at(tape: &Tape, x: f64) -> Result<Middle, Undefined> {
    let middle = enclose::at(tape, x);
    match middle.finding {
        Some(Finding { offence, certainty: Certainty::Certain, at }) => Err(Undefined::At { offence, x, at }),
        _ => Ok(middle),
    }
}

/// Whether a cell with a possible offence counts as legal. `false` if the cell has to be halved.
///
/// A cell that has been halved [`DEEPEST`] times counts as legal for sqrt, asin, acos and powers: the operand
/// is legal or undecided at the middle of the cell, and outside the domain of the operation by rounding only.
fn is_settled(finding: Finding, cell: &Cell, count: usize) -> Result<bool, Undefined> {
    let Finding { offence, certainty, at } = finding;
    let (x, middle) = (shortest(cell), Interval::between(cell.from, cell.to).mid());
    if certainty == Certainty::Certain {
        return Err(Undefined::At { offence, x: middle, at });
    }
    if cell.halvings == DEEPEST || middle <= cell.from || middle >= cell.to {
        return if offence.is_past_a_closed_end() {
            Ok(true)
        } else {
            Err(Undefined::Near { offence, x, at })
        };
    }
    if count >= MOST_CELLS {
        return Err(Undefined::NotRuledOut { offence, x, at });
    }
    Ok(false)
}

/// The number in the cell with the fewest digits.
fn shortest(cell: &Cell) -> f64 {
    let range = Interval::between(cell.from, cell.to);
    let rounded = |digits: usize| format!("{:.digits$e}", range.mid()).parse().unwrap_or(f64::NAN);
    let candidates = std::iter::once(0.0).chain((0..17).map(rounded));
    candidates.into_iter().find(|&x| range.contains(x)).unwrap_or(range.mid())
}

fn is_tight(values: Interval, seen: Interval) -> bool {
    let slack = LOOSENESS * seen.mag() + LEAST_LOOSENESS;
    values.lo() >= seen.lo() - slack && values.hi() <= seen.hi() + slack
}
