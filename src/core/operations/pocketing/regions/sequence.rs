//! The sequence of areas with short ways between them.
//!
//! # Method
//! 1. From several areas, each step goes to the nearest area that is left. The given order is one more
//!    sequence.
//! 2. The sequences are made shorter, the shortest of them first. While a change makes a sequence shorter,
//!    the best change for a place is made: up to three areas in a row move elsewhere (Or-opt), or a part of
//!    the sequence is turned around (2-opt). The way into an area ends elsewhere than the way out of it
//!    begins. So the ways within a part that is turned around change too; sums over both directions tell by
//!    how much.
//! 3. The shortest sequence is taken.
//!
//! # Guarantees
//! The sequence is no longer than the given one, and depends on nothing but the ends.
//!
//! # Cost
//! About `MOST_STEPS` distances for step 1, and `MOST_TRIALS` changes for step 2.
//!
//! # Reference
//! I. Or, *Traveling salesman-type combinatorial problems and their relation to the logistics of regional
//! blood banking*, 1976; G. A. Croes, *A method for solving traveling-salesman problems*, Operations Research
//! 6, 1958.

use nalgebra::Point2;

use crate::budget::{Budget, Stopped};

/// The most distances for the nearest neighbours from all starts: some hundredths of a second.
const MOST_STEPS: usize = 20_000_000;

/// The most changes that are tried: less than a second. A thousand areas need some four million to look at
/// each change once.
const MOST_TRIALS: usize = 10_000_000;

/// The most areas in a row that are moved together.
const MOST_MOVED: usize = 3;

/// A change that saves no more is rounding, mm.
const LEAST_MM: f64 = 1e-9;

/// The ways between areas that count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tour {
    /// Each area is visited once, and the first and the last may be anywhere.
    Once,
    /// The areas are visited again and again: the way from the last to the first counts.
    Rounds,
}

/// A short sequence of areas, each with the place where it is begun and the place where it is left.
///
/// # Errors
/// The budget's stop.
pub fn shortest(ends: &[[Point2<f64>; 2]], tour: Tour, budget: &Budget) -> Result<Vec<usize>, Stopped> {
    let n = ends.len();
    let n_starts = (MOST_STEPS / (n * n).max(1)).min(n);
    let mut searches = vec![Search::new(ends, tour, (0..n).collect())];
    for k in 0..n_starts {
        budget.check()?;
        searches.push(Search::new(ends, tour, nearest_first(ends, k * n / n_starts)));
    }
    // The sort is stable: of equally long sequences the first comes first.
    searches.sort_by(|a, b| a.length_mm().total_cmp(&b.length_mm()));
    let mut trials = MOST_TRIALS;
    for search in &mut searches {
        search.improve(&mut trials, budget)?;
    }
    let least = searches.into_iter().min_by(|a, b| a.length_mm().total_cmp(&b.length_mm()));
    Ok(least.map(|search| search.order).unwrap_or_default())
}

/// The sequence from `start` on in which each area is the nearest of those that are left.
fn nearest_first(ends: &[[Point2<f64>; 2]], start: usize) -> Vec<usize> {
    let mut left: Vec<usize> = (0..ends.len()).filter(|k| *k != start).collect();
    let mut order = vec![start];
    let mut at = ends[start][1];
    while !left.is_empty() {
        let mut best = (f64::INFINITY, 0);
        for (k, area) in left.iter().enumerate() {
            let square = (ends[*area][0] - at).norm_squared();
            if square < best.0 {
                best = (square, k);
            }
        }
        // The rest stays in order, so that the first of equally near areas is taken.
        let next = left.remove(best.1);
        at = ends[next][1];
        order.push(next);
    }
    order
}

/// A sequence that is made shorter.
struct Search<'a> {
    ends: &'a [[Point2<f64>; 2]],
    tour: Tour,
    order: Vec<usize>,
    /// The length of the ways from the first area to each, and of the same ways turned around, mm.
    onward: Vec<f64>,
    backward: Vec<f64>,
}

/// A change of a sequence: what happens to the areas from one place of the sequence to another.
#[derive(Debug, Clone, Copy)]
enum Change {
    Turn {
        of: [usize; 2],
    },
    /// The areas come behind the place `behind`, or come first.
    Move {
        of: [usize; 2],
        behind: Option<usize>,
    },
}

impl<'a> Search<'a> {
    fn new(ends: &'a [[Point2<f64>; 2]], tour: Tour, order: Vec<usize>) -> Self {
        let mut search = Self { ends, tour, order, onward: Vec::new(), backward: Vec::new() };
        search.add_up();
        search
    }

    /// Adds up the ways along the sequence.
    fn add_up(&mut self) {
        let (mut onward, mut backward) = (0.0, 0.0);
        (self.onward, self.backward) = (vec![0.0], vec![0.0]);
        for k in 1..self.order.len() {
            onward += self.way(k - 1, k);
            backward += self.way(k, k - 1);
            self.onward.push(onward);
            self.backward.push(backward);
        }
    }

    /// The way from the area at one place of the sequence to the area at another, mm.
    fn way(&self, from: usize, to: usize) -> f64 {
        (self.ends[self.order[to]][0] - self.ends[self.order[from]][1]).norm()
    }

    /// The same. A way from nowhere or to nowhere costs nothing.
    fn link(&self, from: Option<usize>, to: Option<usize>) -> f64 {
        from.zip(to).map_or(0.0, |(from, to)| self.way(from, to))
    }

    /// The place after a place.
    fn after(&self, k: usize) -> Option<usize> {
        match self.tour {
            _ if k + 1 < self.order.len() => Some(k + 1),
            Tour::Once => None,
            Tour::Rounds => Some(0),
        }
    }

    fn length_mm(&self) -> f64 {
        let Some(last) = self.order.len().checked_sub(1) else { return 0.0 };
        self.onward[last] + self.link(Some(last), self.after(last))
    }

    /// The first place that changes. That of rounds may stay as it is: rounds have no beginning.
    fn first(&self) -> usize {
        if self.tour == Tour::Rounds { 1 } else { 0 }
    }

    /// Makes changes until none makes the sequence shorter, or no trials are left.
    fn improve(&mut self, trials: &mut usize, budget: &Budget) -> Result<(), Stopped> {
        let mut is_shorter = true;
        while std::mem::take(&mut is_shorter) {
            for k in self.first()..self.order.len() {
                budget.check()?;
                if *trials == 0 {
                    return Ok(());
                }
                if let Some(change) = self.best_change(k, trials) {
                    self.make(change);
                    is_shorter = true;
                }
            }
        }
        Ok(())
    }

    /// The change that saves most among those of areas from the place `k` on.
    fn best_change(&self, k: usize, trials: &mut usize) -> Option<Change> {
        let n = self.order.len();
        let mut best: Option<(f64, Change)> = None;
        let mut consider = |saved_mm: f64, change: Change| {
            *trials = trials.saturating_sub(1);
            if saved_mm > best.map_or(LEAST_MM, |(most, _)| most) {
                best = Some((saved_mm, change));
            }
        };
        for last in k + 1..n {
            consider(self.saved_by_turning([k, last]), Change::Turn { of: [k, last] });
        }
        for last in k..(k + MOST_MOVED).min(n) {
            let of = [k, last];
            let freed = self.freed(of);
            if k > 0 && self.tour == Tour::Once {
                consider(freed - self.way(last, 0), Change::Move { of, behind: None });
            }
            for behind in (0..n).filter(|behind| *behind + 1 < k || *behind > last) {
                let next = self.after(behind);
                let added = self.way(behind, k) + self.link(Some(last), next) - self.link(Some(behind), next);
                consider(freed - added, Change::Move { of, behind: Some(behind) });
            }
        }
        best.map(|(_, change)| change)
    }

    /// How much shorter the sequence is if a part of it is turned around, mm.
    fn saved_by_turning(&self, [first, last]: [usize; 2]) -> f64 {
        let (before, after) = (first.checked_sub(1), self.after(last));
        let old = self.link(before, Some(first)) + self.onward[last] - self.onward[first];
        let new = self.link(before, Some(last)) + self.backward[last] - self.backward[first];
        old + self.link(Some(last), after) - new - self.link(Some(first), after)
    }

    /// How much shorter the sequence is without a part of it, mm.
    fn freed(&self, [first, last]: [usize; 2]) -> f64 {
        let (before, after) = (first.checked_sub(1), self.after(last));
        self.link(before, Some(first)) + self.link(Some(last), after) - self.link(before, after)
    }

    fn make(&mut self, change: Change) {
        match change {
            Change::Turn { of: [first, last] } => self.order[first..=last].reverse(),
            Change::Move { of: [first, last], behind: Some(behind) } if behind > last => {
                self.order[first..=behind].rotate_left(last + 1 - first);
            }
            Change::Move { of: [first, last], behind } => {
                let to = behind.map_or(0, |behind| behind + 1);
                self.order[to..=last].rotate_right(last + 1 - first);
            }
        }
        self.add_up();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Areas that are begun on the left of a place and left on its right.
    fn ends(places: &[[f64; 2]]) -> Vec<[Point2<f64>; 2]> {
        places.iter().map(|[x, y]| [Point2::new(x - 1.0, *y), Point2::new(x + 1.0, *y)]).collect()
    }

    /// Places from 0 to 100 without any order.
    fn scattered(n: usize) -> Vec<[f64; 2]> {
        let mut state = 7_u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 / 167_772.16
        };
        (0..n).map(|_| [next(), next()]).collect()
    }

    fn length(ends: &[[Point2<f64>; 2]], tour: Tour, order: &[usize]) -> f64 {
        let mut whole: f64 = order.windows(2).map(|pair| (ends[pair[1]][0] - ends[pair[0]][1]).norm()).sum();
        if tour == Tour::Rounds {
            whole += (ends[order[0]][0] - ends[order[order.len() - 1]][1]).norm();
        }
        whole
    }

    /// The length of the shortest of all sequences that begin with `order`.
    fn least(ends: &[[Point2<f64>; 2]], tour: Tour, order: &mut Vec<usize>) -> f64 {
        if order.len() == ends.len() {
            return length(ends, tour, order);
        }
        let mut best = f64::INFINITY;
        for k in 0..ends.len() {
            if !order.contains(&k) {
                order.push(k);
                best = best.min(least(ends, tour, order));
                order.pop();
            }
        }
        best
    }

    #[test]
    fn seven_areas_get_nearly_the_shortest_of_all_sequences() {
        for tour in [Tour::Once, Tour::Rounds] {
            let ends = ends(&scattered(7));
            let order = shortest(&ends, tour, &Budget::unlimited()).unwrap();
            let (found, best) = (length(&ends, tour, &order), least(&ends, tour, &mut Vec::new()));
            assert!(found <= 1.02 * best, "{tour:?}: {found} and {best}");
        }
    }

    #[test]
    fn a_sequence_has_each_area_once_is_no_longer_than_as_given_and_always_the_same() {
        for n in [0, 1, 2, 3, 40, 200] {
            for tour in [Tour::Once, Tour::Rounds] {
                let ends = ends(&scattered(n));
                let order = shortest(&ends, tour, &Budget::unlimited()).unwrap();
                let given: Vec<usize> = (0..n).collect();
                let mut sorted = order.clone();
                sorted.sort_unstable();
                assert_eq!(sorted, given);
                assert_eq!(shortest(&ends, tour, &Budget::unlimited()).unwrap(), order);
                if n > 0 {
                    assert!(length(&ends, tour, &order) <= length(&ends, tour, &given) + 1e-9);
                }
            }
        }
    }

    #[test]
    fn areas_in_a_row_are_visited_along_the_row() {
        let shuffled = [3.0, 0.0, 4.0, 1.0, 2.0].map(|k| [10.0 * k, 0.0]);
        let order = shortest(&ends(&shuffled), Tour::Once, &Budget::unlimited()).unwrap();
        assert_eq!(order, [1, 3, 4, 0, 2]);
    }

    #[test]
    fn every_change_saves_what_its_formula_promises() {
        let ends = ends(&scattered(9));
        for tour in [Tour::Once, Tour::Rounds] {
            let begin = || Search::new(&ends, tour, (0..9).collect());
            let before = length(&ends, tour, &begin().order);
            let check = |saved: f64, change: Change| {
                let mut search = begin();
                search.make(change);
                let now = length(&ends, tour, &search.order);
                assert!(
                    (before - saved - now).abs() < 1e-9,
                    "{tour:?}, {change:?}: {saved}, {before}, {now}"
                );
                assert!((search.length_mm() - now).abs() < 1e-9);
            };
            for first in begin().first()..9 {
                for last in first..9 {
                    let of = [first, last];
                    if last > first {
                        check(begin().saved_by_turning(of), Change::Turn { of });
                    }
                }
                if let Some(change) = begin().best_change(first, &mut 1000) {
                    let mut search = begin();
                    search.make(change);
                    assert!(search.length_mm() < before, "{tour:?}: {change:?}");
                }
            }
        }
    }
}
