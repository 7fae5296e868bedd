//! Ju's method: each element takes in one point after another, as long as some line or arc can replace all of
//! them. The next element starts at the last of these points.
//!
//! Two changes make long elements faster to find:
//! * With [`Measure::Polyline`], an element takes in [`STRIDE`] points at a time. When that fails, it goes on
//!   with single points.
//! * When an element has a given number of points ([`ONE_BY_ONE`], or [`FAST`]), this number is doubled again
//!   and again, until the points are too many for one element. Bisection between the last two numbers then
//!   finds the end of the element.
//!
//! Some elements fit although a shorter element from the same start does not. Because of the two changes, an
//! element may therefore be longer than Ju's element from the same start. It is never shorter.
//!
//! # Differences from the paper
//! The printed algorithm drops the last two points if no element has taken them in; here they become a line.
//! Eq. 4 measures the distance of a point from the whole circle; here it is measured from the arc.

use nalgebra::Vector2;

use super::Measure;
use super::candidate::{PointRange, Points, Rule, Witnesses};
use crate::budget::{Budget, Stopped};

/// Points that an element of Ju's method takes in one by one before the lengths double. Longer elements would
/// make growth one by one too slow.
pub const ONE_BY_ONE: usize = 512;

/// The same limit where the greedy chain only guides the search for a shorter chain.
pub const FAST: usize = 16;

const STRIDE: usize = 4;

/// The indices of the points at which elements meet, from the first point to the last. The first element
/// starts at `from`. Each element takes in `one_by_one` points before the lengths double.
pub fn joints(
    points: Points,
    from: Vector2<f64>,
    rule: &Rule,
    one_by_one: usize,
    budget: &Budget,
) -> Result<Vec<usize>, Stopped> {
    let last = points.flat.len() - 1;
    let mut joints = vec![0];
    let mut start = 0;
    while start < last {
        budget.check()?;
        let from = if start == 0 { from } else { points.flat[start] };
        start = longest(points, start, from, rule, one_by_one, budget)?;
        joints.push(start);
    }
    Ok(joints)
}

/// The index of the point at which the longest element from `from` ends; `from` stands for the point `start`.
fn longest(
    points: Points,
    start: usize,
    from: Vector2<f64>,
    rule: &Rule,
    one_by_one: usize,
    budget: &Budget,
) -> Result<usize, Stopped> {
    let last = points.flat.len() - 1;
    let mut witnesses = Witnesses::default();
    let mut fits = |end: usize| {
        PointRange { from, ..PointRange::of(points, start, end) }.find(rule, &mut witnesses).is_some()
    };
    let mut good = start + 1;
    let stride = if rule.measure == Measure::Polyline { STRIDE } else { 1 };
    while good + stride < last && good - start < one_by_one && stride > 1 && fits(good + stride) {
        good += stride;
    }
    while good < last && good - start < one_by_one {
        if !fits(good + 1) {
            return Ok(good);
        }
        good += 1;
    }
    let mut stride = good - start;
    let mut bad = loop {
        budget.check()?;
        if good == last {
            return Ok(last);
        }
        let trial = (good + stride).min(last);
        if !fits(trial) {
            break trial;
        }
        good = trial;
        stride *= 2;
    };
    while bad - good > 1 {
        let trial = good + (bad - good) / 2;
        if fits(trial) {
            good = trial;
        } else {
            bad = trial;
        }
    }
    Ok(good)
}
