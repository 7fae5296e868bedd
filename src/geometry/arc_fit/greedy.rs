//! Elements that each grow as far as they can: Ju's method.
//!
//! An element takes in one point after another until the first that it cannot (along lines, [`STRIDE`] at a
//! time, then one by one: these are programs, of which there is much); from some number of points on, growth
//! is tried at doubling lengths, then by halving, which may end later than the first failure, never earlier.

use nalgebra::Vector2;

use super::Measure;
use super::candidate::{Points, Rule, Span, Witnesses};
use crate::budget::{Budget, Stopped};

/// Points that Ju's method takes in one by one, for lengths at which it is usable.
pub const ONE_BY_ONE: usize = 512;

/// The same where growing is but a way to few elements.
pub const FAST: usize = 16;

const STRIDE: usize = 4;

/// The points at which elements meet, from the first to the last; the first element starts at `from`, and
/// each takes in `one_by_one` points before it grows faster.
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

/// The end of the longest element from `from`, for the point `start`.
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
