//! Two bounds for each point: how far one element from the point can reach at most, and how many elements a
//! chain from the point to the last point needs at least. The bounds shorten the search of `optimal`. They
//! hold for chains whose elements meet on points.
//!
//! # Method
//! A check is a test of one point against one element.
//! 1. Take two points P and Q. If some element replaces both, then some arc from P to Q misses no point
//!    between P and Q by more than a known multiple of the tolerance. So if there is no such arc, no element
//!    replaces both P and Q.
//! 2. For each point P, step 1 gives a point that no element from P reaches. The points between P and this
//!    point are tried one by one as the end of an element from P, the farthest first. The first one at which
//!    an element fits is the bound of P. After a given number of checks in all, the remaining points get the
//!    bounds of step 1 instead.
//! 3. The least number of elements is computed from the last point back to the first. For a point P it is one
//!    more than the smallest such number of the points that come after P, up to the bound of P.
//!
//! # Cost
//! O(n m) checks for n points and elements that replace m points each.

use super::Shapes;
use super::candidate::{PointRange, Points, Rule, Witnesses};
use super::chord::LARGEST_BULGE;
use crate::budget::{Budget, Stopped};

/// Factors of the tolerance, each with the largest bulge to which it applies: that of half a turn, of 270
/// degrees, and of the largest arc. `LINES` is for lines.
///
/// Each factor is 1 plus the following. The part of an arc between its places near two points ends within e
/// of these points. A similarity moves both ends onto the points. It moves every place of the part by at most
/// e (|w| + |1 - w|), where w is the place as a complex number, with the ends at 0 and 1. That is at most
/// sqrt(2) e up to half a turn, 2 sqrt(2) e up to 270 degrees, 22.93 e up to 350 degrees, and e on a line.
const ARCS: &[(f64, f64)] = &[(2.4143, 1.0), (3.8285, 2.4143), (23.95, LARGEST_BULGE)];
const LINES: &[(f64, f64)] = &[(2.0, 0.0)];

/// The bound for the reach is computed again after one part in `RENEWAL` of the reach.
const RENEWAL: usize = 32;

/// Limits of every element.
#[derive(Debug)]
pub struct Bounds {
    /// For each point the index of a point that no element from it reaches.
    pub beyond: Vec<usize>,
    /// For each point the least number of elements from it to the last point.
    pub left: Vec<usize>,
}

impl Bounds {
    /// Bounds for elements that meet on the points. After `most` evaluations the bounds are looser, but still
    /// valid.
    pub fn on_points(points: Points, rule: &Rule, most: usize, budget: &Budget) -> Result<Self, Stopped> {
        let n = points.flat.len();
        let (mut beyond, mut left) = (vec![n; n], vec![0; n]);
        let mut longest = Longest::of(points, rule);
        let mut witnesses = Witnesses::default();
        // The points with fewer elements left than any point between them and `i`, the farthest first.
        let mut fewest = vec![n - 1];
        for i in (0..n.saturating_sub(1)).rev() {
            budget.check()?;
            let bound = longest.bound(i);
            let reaches = |end: &usize| {
                witnesses.looks >= most
                    || PointRange::of(points, i, *end).find(rule, &mut witnesses).is_some()
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

    /// Bounds for elements that meet anywhere: none but that every point before the last needs one element
    /// more.
    pub fn unknown(n: usize) -> Self {
        Self { beyond: vec![n; n], left: (0..n).map(|k| usize::from(k + 1 < n)).collect() }
    }
}

/// Bounds for the reach, asked for from the last point to the first.
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

    /// The index of a point that no element from `first`, or from a point before it, reaches.
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
        let span = PointRange::of(self.points, first, last);
        let tolerance = self.tolerance;
        span.from != span.to
            && self.tiers.iter().zip(&mut self.witnesses).all(|((factor, largest), witnesses)| {
                span.near(factor * tolerance, *largest, witnesses).is_none()
            })
    }
}
