//! Compares a written text, read back, with the blocks it was written from.

use nalgebra::Point3;

use super::dialect::Dialect;
use super::lower::Block;
use super::read::{Placed, Reader, Step};
use super::words::FeedWord;
use super::{BLOCKS_BETWEEN_CHECKS, WriteError};
use crate::budget::Budget;
use crate::geometry::curve::Curve;
use crate::toolpath::quantize::Grid;
use crate::toolpath::units::FeedRate;

/// The largest difference of an arc block's radii that is let out, in units of the last decimal.
const MISMATCH_LIMIT_STEPS: f64 = 1.5;

/// Numbers that were written and read agree within this part of a unit of the last decimal: the text holds
/// whole units, so any difference that is not the rounding of a product is a fault.
const AGREEMENT_STEPS: f64 = 0.01;

/// Reads `text` and returns the largest radius mismatch in it, mm.
///
/// # Errors
/// When the text cannot be read, or says anything else than `blocks`.
pub fn read_back(
    text: &str,
    blocks: &[Block],
    dialect: &Dialect,
    grid: &Grid,
    budget: &Budget,
) -> Result<f64, WriteError> {
    let mut steps = Reader::new(text, dialect, MISMATCH_LIMIT_STEPS * grid.step_mm());
    let mut at: [Option<i64>; 3] = [None; 3];
    let mut largest_mismatch: f64 = 0.0;
    let mut line = 0;
    for (k, block) in blocks.iter().enumerate() {
        if k.is_multiple_of(BLOCKS_BETWEEN_CHECKS) {
            budget.check()?;
        }
        let Some(placed) = steps.next() else { return Err(WriteError::Differs { line, what: "end" }) };
        let placed = placed?;
        line = placed.line;
        if let Some(what) = difference(block, &mut at, &placed, grid) {
            return Err(WriteError::Differs { line, what });
        }
        if let Step::Feed { radius_mismatch_mm, .. } = placed.step {
            largest_mismatch = largest_mismatch.max(radius_mismatch_mm);
        }
    }
    match steps.next() {
        None => Ok(largest_mismatch),
        Some(Err(error)) => Err(error.into()),
        Some(Ok(extra)) => Err(WriteError::Differs { line: extra.line, what: "end" }),
    }
}

/// What a step has that its block has not. `at` is where the block starts, and then where it ends.
fn difference(
    block: &Block,
    at: &mut [Option<i64>; 3],
    placed: &Placed,
    grid: &Grid,
) -> Option<&'static str> {
    let start = *at;
    match *block {
        Block::Rapid { to } => {
            for (axis, to) in to.into_iter().enumerate() {
                at[axis] = to.or(at[axis]);
            }
        }
        Block::Line { to, .. } | Block::Arc { to, .. } => *at = to.map(Some),
        Block::Parabola { to, .. } => *at = [Some(to[0]), Some(to[1]), at[2]],
        Block::Dwell { .. } => {}
    }
    let is_near = |a: f64, b: f64| (a - b).abs() <= AGREEMENT_STEPS * grid.step_mm();
    let are_near = |read: [Option<f64>; 3], units: [Option<i64>; 3]| {
        read.into_iter().zip(units).all(|pair| match pair {
            (Some(read), Some(units)) => is_near(read, grid.mm(units)),
            (None, None) => true,
            _ => false,
        })
    };
    let is_at = |p: Point3<f64>, units| are_near([Some(p.x), Some(p.y), Some(p.z)], units);
    let is_feed = |rate: FeedRate, feed: FeedWord| {
        let wanted = feed.value() * grid.unit_mm();
        (rate.mm_per_min() - wanted).abs() <= 1e-12 * wanted
    };
    match (*block, placed.step) {
        (Block::Rapid { .. }, Step::Rapid { from, to }) => {
            (!(are_near(from, start) && are_near(to, *at))).then_some("place")
        }
        (Block::Line { feed, .. }, Step::Feed { along: Curve::Line(line), rate, .. }) => {
            if !(is_at(line.start, start) && is_at(line.end, *at)) {
                return Some("place");
            }
            (!is_feed(rate, feed)).then_some("feed")
        }
        (
            Block::Arc { plane, direction, center, feed, .. },
            Step::Feed { along: Curve::Arc(arc), rate, center: Some(written), .. },
        ) => {
            if !(is_at(arc.start(), start) && is_at(arc.end(), *at)) {
                return Some("place");
            }
            if (arc.plane(), arc.direction()) != (plane, direction) {
                return Some("sense");
            }
            let [a, b, _] = plane.axes();
            let offsets = [written[a] - arc.start()[a], written[b] - arc.start()[b]];
            if !(is_near(offsets[0], grid.mm(center[0])) && is_near(offsets[1], grid.mm(center[1]))) {
                return Some("centre");
            }
            (!is_feed(rate, feed)).then_some("feed")
        }
        (
            Block::Parabola { control, feed, .. },
            Step::Feed { along: Curve::Parabola(parabola), rate, .. },
        ) => {
            if !(is_at(parabola.start(), start) && is_at(parabola.end(), *at)) {
                return Some("place");
            }
            let offset = parabola.control() - parabola.start();
            if !(is_near(offset.x, grid.mm(control[0])) && is_near(offset.y, grid.mm(control[1]))) {
                return Some("control");
            }
            (!is_feed(rate, feed)).then_some("feed")
        }
        (Block::Dwell { milliseconds }, Step::Dwell { seconds }) => {
            ((seconds * 1000.0 - milliseconds as f64).abs() > 1e-3).then_some("dwell")
        }
        _ => Some("kind"),
    }
}
