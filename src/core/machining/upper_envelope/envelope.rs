//! The upper envelope of straight stretches: for every x, the largest height of a stretch.

use nalgebra::Vector2;

use super::Stretch;
use crate::budget::{Budget, Stopped};

/// Places at which stretches begin or end, between two checks of the budget.
const EVENTS_BETWEEN_CHECKS: usize = 1024;

/// Distance along x, mm, up to which ends of stretches count as one place. So rounding leaves no slits
/// between neighbours, and no walls where several stretches end.
const SAME_MM: f64 = 1e-7;

/// A connected skyline: points (x, z), mm, with x that never falls; two at the same x are a wall.
pub type UpperEnvelope = Vec<Vector2<f64>>;

/// The skylines of all stretches together, from left to right. Gaps of at most `gap_mm` are bridged.
///
/// # Errors
/// Only the budget's stop.
pub fn union(stretches: &[Stretch], gap_mm: f64, budget: &Budget) -> Result<Vec<UpperEnvelope>, Stopped> {
    let mut waiting: Vec<Stretch> =
        stretches.iter().copied().filter(|s| s.to.x > s.from.x + SAME_MM).collect();
    // The next stretch to begin is the last element.
    waiting.sort_by(|a, b| b.from.x.total_cmp(&a.from.x));
    let mut places: Vec<f64> = waiting.iter().flat_map(|s| [s.from.x, s.to.x]).collect();
    places.sort_by(f64::total_cmp);
    places.dedup_by(|next, kept| *next - *kept <= SAME_MM);
    let mut open: Vec<Stretch> = Vec::new();
    let mut skylines: Vec<UpperEnvelope> = Vec::new();
    for (k, pair) in places.windows(2).enumerate() {
        if k.is_multiple_of(EVENTS_BETWEEN_CHECKS) {
            budget.check()?;
        }
        let [from, to] = [pair[0], pair[1]];
        open.retain(|stretch| stretch.to.x > from + SAME_MM);
        while let Some(next) = waiting.pop_if(|next| next.from.x <= from + SAME_MM) {
            open.push(next);
        }
        if open.is_empty() {
            continue;
        }
        let is_joined =
            skylines.last().and_then(|skyline| skyline.last()).is_some_and(|last| from - last.x <= gap_mm);
        if !is_joined {
            skylines.push(UpperEnvelope::new());
        }
        if let Some(skyline) = skylines.last_mut() {
            follow(&open, [from, to], skyline);
        }
    }
    Ok(skylines)
}

/// Appends the highest of the `open` stretches, all of which run from one place to another.
fn follow(open: &[Stretch], [from, to]: [f64; 2], skyline: &mut UpperEnvelope) {
    let heights: Vec<[f64; 2]> = open.iter().map(|s| [s.height(from), s.height(to)]).collect();
    let higher = |a: &&[f64; 2], b: &&[f64; 2]| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]));
    let Some(mut top) = heights.iter().max_by(higher).copied() else { return };
    append(skyline, Vector2::new(from, top[0]));
    let mut here = 0.0;
    // Each crossing leads to a stretch that is higher at the end.
    for _ in 0..heights.len() {
        let crossings = heights.iter().filter(|other| other[1] > top[1]).map(|other| {
            let (lead, lag) = (top[0] - other[0], other[1] - top[1]);
            ((lead / (lead + lag)).clamp(here, 1.0), other)
        });
        let first = crossings.min_by(|a, b| a.0.total_cmp(&b.0).then(b.1[1].total_cmp(&a.1[1])));
        let Some((share, other)) = first else { break };
        append(skyline, Vector2::new(from + share * (to - from), top[0] + share * (top[1] - top[0])));
        (here, top) = (share, *other);
    }
    append(skyline, Vector2::new(to, top[1]));
}

fn append(skyline: &mut UpperEnvelope, point: Vector2<f64>) {
    if skyline.last() != Some(&point) {
        skyline.push(point);
    }
}
