//! The shortest way over open cells.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};

use super::ground::{Cell, Ground, Room};
use crate::budget::{Budget, Stopped};

/// The most cells that a search visits.
const MOST_VISITED: usize = 100_000;

/// The lengths of a straight and of a slanting step, in tenths of a cell.
const STRAIGHT: u32 = 10;
const SLANTING: u32 = 14;

/// Lengths are counted in this part of a cell.
const TENTHS: f64 = 10.0;

/// Places that are looked at along a cell of a straight way.
const LOOKS_IN_CELL: f64 = 2.0;

/// Cells between two checks of the budget.
const CELLS_BETWEEN_CHECKS: usize = 1024;

/// The cells of a shortest way, if one is no longer than `most_mm`.
pub fn shortest(
    ground: &Ground,
    [from, to]: [Cell; 2],
    room: Room,
    most_mm: f64,
    budget: &Budget,
) -> Result<Option<Vec<Cell>>, Stopped> {
    let most = (most_mm / ground.cell_mm() * TENTHS).min(f64::from(u32::MAX)) as u32;
    let ahead = |cell: Cell| {
        let [x, y] = [0, 1].map(|k| cell[k].abs_diff(to[k]) as u32);
        STRAIGHT * x.max(y) + (SLANTING - STRAIGHT) * x.min(y)
    };
    // The length up to each cell, and the cell before it.
    let mut reached: HashMap<Cell, (u32, Cell)> = HashMap::from([(from, (0, from))]);
    let mut open = BinaryHeap::from([Reverse((ahead(from), 0, from))]);
    let mut visited = 0;
    while let Some(Reverse((bound, length, cell))) = open.pop() {
        if cell == to {
            return Ok(Some(back_from(to, from, &reached)));
        }
        visited += 1;
        if bound > most || visited > MOST_VISITED {
            break;
        }
        if visited.is_multiple_of(CELLS_BETWEEN_CHECKS) {
            budget.check()?;
        }
        if reached.get(&cell).is_some_and(|(least, _)| *least < length) {
            continue;
        }
        for (next, step) in neighbours(ground, cell) {
            let length = length + step;
            if ground.is_open(next, room) && reached.get(&next).is_none_or(|(least, _)| length < *least) {
                reached.insert(next, (length, cell));
                open.push(Reverse((length + ahead(next), length, next)));
            }
        }
    }
    Ok(None)
}

fn back_from(to: Cell, from: Cell, reached: &HashMap<Cell, (u32, Cell)>) -> Vec<Cell> {
    let mut cells = vec![to];
    let mut at = to;
    while at != from
        && let Some((_, before)) = reached.get(&at)
    {
        at = *before;
        cells.push(at);
    }
    cells.reverse();
    cells
}

/// The cells about a cell, with the lengths of the steps to them.
fn neighbours(ground: &Ground, [column, row]: Cell) -> impl Iterator<Item = (Cell, u32)> {
    let [width, height] = ground.size();
    let beside = |k: usize, size: usize| k.saturating_sub(1)..=(k + 1).min(size - 1);
    let rows = beside(row, height);
    beside(column, width).flat_map(move |x| rows.clone().map(move |y| [x, y])).filter_map(move |next| {
        let step = match (next[0] != column, next[1] != row) {
            (false, false) => return None,
            (true, true) => SLANTING,
            _ => STRAIGHT,
        };
        Some((next, step))
    })
}

/// The cells of a way between which it is straight.
pub fn pulled_tight(ground: &Ground, cells: &[Cell], room: Room) -> Vec<Cell> {
    let mut corners: Vec<Cell> = cells.first().copied().into_iter().collect();
    let mut anchor = 0;
    for k in 2..cells.len() {
        if !is_seen(ground, [cells[anchor], cells[k]], room) {
            anchor = k - 1;
            corners.push(cells[anchor]);
        }
    }
    if cells.len() > 1 {
        corners.extend(cells.last());
    }
    corners
}

/// Whether the line between the middles of two cells runs over open cells only.
fn is_seen(ground: &Ground, ends: [Cell; 2], room: Room) -> bool {
    let [a, b] = ends.map(|cell| ground.middle(cell));
    let count = ((b - a).norm() / ground.cell_mm() * LOOKS_IN_CELL).ceil().max(1.0);
    (0..=count as usize).all(|k| ground.is_open(ground.cell(a + (b - a) * (k as f64 / count)), room))
}
