//! Ju's method: each element takes in one point after another until the next point does not fit.
//!
//! Two things make long elements faster:
//! * With [`Measure::Polyline`] an element takes in [`STRIDE`] points at a time, and single points at its
//!   end.
//! * After a given number of points ([`ONE_BY_ONE`], or [`FAST`]) its number of points doubles, until they
//!   are too many for one element. Bisection then finds an end between the last two numbers.
//!
//! An element may fit although a shorter one fails. So these elements may be longer than Ju's, but never
//! shorter.
//!
//! # Differences from the paper
//! The printed algorithm drops the last two points if they are left over; here they become a line. Eq. 4
//! measures the distance from the whole circle; here the distance is measured from the arc.

use nalgebra::Vector2;

use super::Measure;
use super::candidate::{Points, Rule, Span, Witnesses};
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
    let mut fits =
        |end: usize| Span { from, ..Span::of(points, start, end) }.find(rule, &mut witnesses).is_some();
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
