//! How far elements can reach at most, and how few can be left at least: what the search need not look at.
//!
//! # Method
//! 1. Let an arc pass within e of the points i to j, and i <= i' < j' <= j. Its part between the places near
//!    i' and j' ends within e of these two; a similarity moves these ends onto them, and every point of the
//!    part by at most e (|w| + |1 - w|), where w is its place with the ends at 0 and 1. That is at most
//!    sqrt(2) e up to half a turn, 2 sqrt(2) e up to 270 degrees and 23 e up to 350 (e on a line). So if no
//!    arc over the chord from i' to j' passes within the tolerance enlarged accordingly, none within the
//!    tolerance passes any longer stretch.
//! 2. From there backwards, ends are tried one by one, as long as that is worth it.
//! 3. The counts follow from the last point. On clean data the first of them is the number of elements that
//!    grew as far as they could, which is thereby proved to be the least.
//!
//! # Cost
//! O(n m) for elements of m points; the second step ends after so many looks at points.

use super::Shapes;
use super::candidate::{Points, Rule, Span, Witnesses};
use super::chord::LARGEST_BULGE;
use crate::budget::{Budget, Stopped};

/// The factors of the tolerance up to the bulges of half a turn, of 270 degrees and the largest; and for
/// lines.
const ARCS: &[(f64, f64)] = &[(2.4143, 1.0), (3.8285, 2.4143), (23.95, LARGEST_BULGE)];
const LINES: &[(f64, f64)] = &[(2.0, 0.0)];

/// The part of a reach after which it is bounded again.
const RENEWAL: usize = 32;

/// What no element can do.
#[derive(Debug)]
pub struct Bounds {
    /// For each point, one that no element from it reaches.
    pub beyond: Vec<usize>,
    /// From each point to the last there are at least so many elements.
    pub left: Vec<usize>,
}

impl Bounds {
    /// For elements that meet on the points, after at most so many looks at points where these are worth more
    /// than a proof in their place.
    pub fn on_points(points: Points, rule: &Rule, most: usize, budget: &Budget) -> Result<Self, Stopped> {
        let n = points.flat.len();
        let (mut beyond, mut left) = (vec![n; n], vec![0; n]);
        let mut longest = Longest::of(points, rule);
        let mut witnesses = Witnesses::default();
        // The points with fewer left than any between them and `i`, the farthest first.
        let mut fewest = vec![n - 1];
        for i in (0..n.saturating_sub(1)).rev() {
            budget.check()?;
            let bound = longest.bound(i);
            let reaches = |end: &usize| {
                witnesses.looks >= most || Span::of(points, i, *end).find(rule, &mut witnesses).is_some()
            };
            beyond[i] = (i + 1..bound).rev().find(reaches).map_or(i + 1, |end| end + 1);
            let farthest = fewest.partition_point(|&k| k >= beyond[i]);
            left[i] = 1 + fewest.get(farthest).map_or(0, |&k| left[k]);
            while fewest.last().is_some_and(|&k| left[k] >= left[i]) {
                fewest.pop();
            }
            fewest.push(i);
        }
        Ok(Self { beyond, left })
    }

    /// For elements that meet anywhere: nothing is known.
    pub fn unknown(n: usize) -> Self {
        Self { beyond: vec![n; n], left: (0..n).map(|k| usize::from(k + 1 < n)).collect() }
    }
}

/// Bounds for ever earlier points.
struct Longest<'a> {
    points: Points<'a>,
    tolerance: f64,
    tiers: &'static [(f64, f64)],
    witnesses: [Witnesses; ARCS.len()],
    bound: usize,
    renewed_at: usize,
}

impl<'a> Longest<'a> {
    fn of(points: Points<'a>, rule: &Rule) -> Self {
        let n = points.flat.len();
        Self {
            points,
            tolerance: rule.tolerance_mm,
            tiers: if rule.shapes == Shapes::LinesOnly { LINES } else { ARCS },
            witnesses: Default::default(),
            bound: n,
            renewed_at: n,
        }
    }

    /// A point that no element from `first`, or one before it, reaches.
    fn bound(&mut self, first: usize) -> usize {
        if self.renewed_at - first > (self.bound - first) / RENEWAL {
            self.renewed_at = first;
            // Two points always make a line.
            while self.bound > first + 2 && self.fails(first, self.bound - 1) {
                self.bound -= 1;
            }
        }
        self.bound
    }

    fn fails(&mut self, first: usize, last: usize) -> bool {
        let span = Span::of(self.points, first, last);
        let tolerance = self.tolerance;
        span.from != span.to
            && self.tiers.iter().zip(&mut self.witnesses).all(|((factor, largest), witnesses)| {
                span.near(factor * tolerance, *largest, witnesses).is_none()
            })
    }
}
