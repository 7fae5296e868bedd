//! Reads a written text back, and compares each of its motions and dwells with the block it was written from,
//! and what it asks of the machine there with what the job asks for ([`asked`]).

mod asked;
mod hole;

use std::ops::Range;

use nalgebra::Point3;

use super::block::{AxisWords, Block, BlockFeed};
use super::custom;
use super::lower::Lowered;
use super::posed::VECTOR_DECIMALS;
use super::rails::{FineGrid, RailWords};
use super::read::{Placed, Posed, PosedFeed, ROTARY, RailStep, Reader, Step, TipMode};
use super::sequence::Part;
use super::words::FeedWord;
use super::write::program_number;
use super::{BLOCKS_BETWEEN_CHECKS, ProgramJob, WriteError, blank, helix, smoothing};
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::curve::Curve;
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::program::{Resolution, Smoothing, SmoothingMode};
use toolpathd_core::toolpath::quantize::Grid;
use toolpathd_core::toolpath::units::FeedRate;

/// Largest difference of the two radii of an arc block, in units of the last decimal. Rounding an arc makes
/// at most 1; some controls refuse arcs of a larger difference.
const MISMATCH_LIMIT_STEPS: f64 = 1.5;

/// Largest difference of a written and a read number, in units of the last decimal. The text holds whole
/// units, so a larger difference is a fault. A smaller limit would take the rounding of a product for a
/// fault.
const AGREEMENT_STEPS: f64 = 0.01;

/// How far a helix may end beside its point, in units of the last decimal: the difference of the radii of its
/// ends, and what the rounding of its angle and its start add. Its angle, centre and start are compared
/// exactly.
const HELIX_END_STEPS: f64 = 2.5;

/// Largest difference of a written and a read feed, as a part of it. Both are the same decimal number, times
/// the same unit: they differ by the rounding of a product.
const FEED_AGREEMENT: f64 = 1e-12;

/// Largest difference of a written and a read dwell, ms. The text holds whole milliseconds.
const DWELL_AGREEMENT_MS: f64 = 1e-3;

/// Largest difference from 60 of a block's seconds times its inverse time: the rounding of a quotient and of
/// a product is 1e-14.
const INVERSE_TIME_AGREEMENT: f64 = 1e-9;

/// Largest difference of a written and a read tolerance, mm or degrees: the rounding of a product.
const SMOOTHING_AGREEMENT: f64 = 1e-9;

/// Where the tool is, as far as it is known.
#[derive(Default)]
struct KnownPosition {
    at: [Option<i64>; 3],
    /// Where the last helix was read to end, beside its point by a rounding, as long as no block has stated X
    /// and Y.
    helix_end: Option<[f64; 2]>,
    /// The tool has been changed or the work offset: until all coordinates are stated, a control counts from
    /// what it knows, and that is not compared.
    is_lost: bool,
}

/// Reads `text` and returns the largest radius mismatch in it, mm. A shop's own lines stand at `custom`.
///
/// # Errors
/// When the text cannot be read, or its steps differ from the blocks of the operations.
pub fn read_back(
    text: &str,
    custom: &[Range<usize>],
    parts: &[Part],
    budget: &Budget,
) -> Result<f64, WriteError> {
    let Some(job) = parts.first().map(|part| &part.operation.job) else { return Ok(0.0) };
    if !custom::stand_at(text, custom, &job.program.custom) {
        return Err(WriteError::Differs { line: 0, what: "line of your own" });
    }
    let grid = Grid::new(job.program.resolution);
    let mut steps = Reader::new(text, job.dialect, MISMATCH_LIMIT_STEPS * grid.step_mm()).passing(custom);
    steps = steps.assuming_nothing();
    let mut place = KnownPosition::default();
    let mut largest_mismatch: f64 = 0.0;
    let mut homes = 0;
    for (k, part) in parts.iter().enumerate() {
        if part.change.leaves() {
            homes += asked::homes(job);
            place = KnownPosition { is_lost: k > 0, ..KnownPosition::default() };
        }
        let mismatch = read_operation(&mut steps, part, (&mut place, homes), &grid, budget)?;
        largest_mismatch = largest_mismatch.max(mismatch);
    }
    let corners = blank::corners(job)?.map(|corners| corners.map(|corner| grid.point(corner)));
    let is_near = |[a, b]: [Point3<f64>; 2]| (a - b).norm() <= AGREEMENT_STEPS * grid.step_mm();
    let is_same = match (steps.blank(), corners) {
        (Some([low, high]), Some([own_low, own_high])) => {
            is_near([low, own_low]) && is_near([high, own_high])
        }
        (read, own) => read.is_none() && own.is_none(),
    };
    if !is_same {
        return Err(WriteError::Differs { line: 0, what: "raw part" });
    }
    match steps.next() {
        None => {}
        Some(Err(error)) => return Err(error.into()),
        Some(Ok(extra)) => return Err(WriteError::Differs { line: extra.line, what: "end" }),
    }
    if steps.program() != program_number(job)? {
        return Err(WriteError::Differs { line: 0, what: "program number" });
    }
    match asked::difference_at_end(&steps.state(), homes + asked::homes(job)) {
        Some(what) => Err(WriteError::Differs { line: 0, what }),
        None => Ok(largest_mismatch),
    }
}

/// Reads the steps of one operation, and returns the largest radius mismatch in them, mm. Before them the
/// tool has moved `homes` times to the machine's end of Z.
fn read_operation(
    steps: &mut Reader,
    part: &Part,
    (place, homes): (&mut KnownPosition, u32),
    grid: &Grid,
    budget: &Budget,
) -> Result<f64, WriteError> {
    let (job, lowered) = (&part.operation.job, &part.lowered);
    let mut largest_mismatch: f64 = 0.0;
    for (k, block) in lowered.blocks.iter().filter(|block| block.acts()).enumerate() {
        if k.is_multiple_of(BLOCKS_BETWEEN_CHECKS) {
            budget.check()?;
        }
        let Some(placed) = steps.next() else {
            return Err(WriteError::Differs { line: steps.line(), what: "end" });
        };
        let placed = placed?;
        let line = placed.line;
        if let Some(what) = difference(block, lowered, place, &placed, job, grid) {
            return Err(WriteError::Differs { line, what });
        }
        if let Some(what) = asked::difference(steps, block, job, homes)? {
            return Err(WriteError::Differs { line, what });
        }
        if is_cut(&placed.step) && !smooths(steps.smoothing(), job) {
            return Err(WriteError::Differs { line, what: "smoothing" });
        }
        if let Step::Feed { radius_mismatch_mm, .. } = placed.step {
            largest_mismatch = largest_mismatch.max(radius_mismatch_mm);
        }
    }
    Ok(largest_mismatch)
}

/// The name of what differs between a block and the step that was read for it; `None` if they agree. `place`
/// is where the block starts, and afterwards where the block ends.
fn difference(
    block: &Block,
    lowered: &Lowered,
    place: &mut KnownPosition,
    placed: &Placed,
    job: &ProgramJob,
    grid: &Grid,
) -> Option<&'static str> {
    let (Lowered { rails, cycles, .. }, KnownPosition { at, helix_end, is_lost }) = (lowered, place);
    let was_lost = *is_lost;
    // Coordinates before tip control are those of another point.
    let start = if matches!(block, Block::BeginTipControl { .. }) { [None; 3] } else { *at };
    match *block {
        Block::Rapid { to } | Block::Park { to } => *at = [0, 1, 2].map(|axis| to[axis].or(at[axis])),
        Block::BeginTipControl { to, .. } => *at = to,
        Block::Line { to, .. }
        | Block::Arc { to, .. }
        | Block::Helix { to, .. }
        | Block::Posed { to, .. } => *at = to.map(Some),
        Block::Parabola { to: [x, y], .. } => *at = [Some(x), Some(y), at[2]],
        Block::Hole { to: [x, y], index } => {
            *at = [Some(x), Some(y), Some(cycles[index as usize].returns)];
        }
        Block::Rail { index } => *at = rails[index as usize].to.map(Some),
        Block::Dwell { .. }
        | Block::Rotate { .. }
        | Block::BeginRails { .. }
        | Block::BeginCycle { .. }
        | Block::EndCycle
        | Block::EndRails
        | Block::EndPosed => {}
    }
    *is_lost &= at.contains(&None);
    let is_near = |mm: f64, units: i64| (mm - grid.mm(units)).abs() <= AGREEMENT_STEPS * grid.step_mm();
    let left = *helix_end;
    let are_near = |read: [Option<f64>; 3], units: [Option<i64>; 3]| {
        read.into_iter().zip(units).enumerate().all(|(axis, pair)| match pair {
            (Some(read), Some(units)) => {
                is_near(read, units) || left.is_some_and(|left| left.get(axis) == Some(&read))
            }
            (None, None) => true,
            (Some(_), None) => was_lost,
            (None, Some(_)) => false,
        })
    };
    *helix_end = match (*block, placed.step) {
        (Block::Helix { .. }, Step::Feed { along, .. }) => Some([along.end().x, along.end().y]),
        (
            Block::Rapid { to: [None, None, _] } | Block::Park { to: [None, None, _] } | Block::Dwell { .. },
            _,
        ) => left,
        _ => None,
    };
    let joins = |curve: &Curve| {
        let [from, to] = [curve.start(), curve.end()].map(|p| [Some(p.x), Some(p.y), Some(p.z)]);
        are_near(from, start) && are_near(to, *at)
    };
    let are_offsets = |p: Point3<f64>, axes: [usize; 2], offsets: [i64; 2]| {
        axes.into_iter()
            .zip(offsets)
            .all(|(axis, offset)| start[axis].is_some_and(|start| is_near(p[axis] - grid.mm(start), offset)))
    };
    let is_feed = |rate: FeedRate, feed: FeedWord| {
        let wanted = feed.value() * grid.unit_mm();
        (rate.mm_per_min() - wanted).abs() <= FEED_AGREEMENT * wanted
    };
    let is_axis = |axis: AxisWords, posed: &Posed| is_axis(axis, posed, job);
    let place = |posed: &Posed| are_near(posed.from, start) && are_near(posed.to, *at);
    match (*block, placed.step) {
        (Block::Rotate { angles }, Step::Posed(posed)) => first_false(&[
            (is_axis(AxisWords::Angles(angles), &posed), "axis"),
            ((posed.mode, posed.feed) == (TipMode::Off, PosedFeed::Rapid), "mode"),
        ]),
        (Block::BeginTipControl { to, axis }, Step::Posed(posed)) => first_false(&[
            (place(&posed), "place"),
            // The way across may leave the vector to the way down.
            (is_axis(axis, &posed) || to[2].is_none() && posed.vector.is_none(), "axis"),
            (posed.mode != TipMode::Off && posed.feed == PosedFeed::Rapid, "mode"),
        ]),
        (Block::Posed { axis, feed, .. }, Step::Posed(posed)) => first_false(&[
            (place(&posed), "place"),
            (is_axis(axis, &posed), "axis"),
            (
                match (feed, posed.feed) {
                    (BlockFeed::Rapid, PosedFeed::Rapid) => true,
                    (BlockFeed::PerMinute(feed), PosedFeed::Feed(rate)) => is_feed(rate, feed),
                    (BlockFeed::InverseTime(feed), PosedFeed::Seconds(seconds)) => {
                        (seconds * feed.value() - 60.0).abs() <= INVERSE_TIME_AGREEMENT
                    }
                    (BlockFeed::DegreesPerMinute(feed), PosedFeed::DegreesPerMinute(rate)) => {
                        (rate - feed.value()).abs() <= FEED_AGREEMENT * feed.value()
                    }
                    _ => false,
                },
                "feed",
            ),
        ]),
        (Block::Rapid { .. } | Block::Park { .. }, Step::Posed(posed)) => {
            first_false(&[(place(&posed), "place"), (posed.feed == PosedFeed::Rapid, "mode")])
        }
        (Block::Rapid { .. } | Block::Park { .. }, Step::Rapid { from, to }) => {
            first_false(&[(are_near(from, start) && are_near(to, *at), "place")])
        }
        (Block::Line { feed, .. }, Step::Feed { along: along @ Curve::Line(_), rate, .. }) => {
            first_false(&[(joins(&along), "place"), (is_feed(rate, feed), "feed")])
        }
        (
            Block::Arc { plane, direction, center, feed, .. },
            Step::Feed { along: along @ Curve::Arc(arc), rate, center: Some(written), .. },
        ) => {
            let [a, b, _] = plane.axes();
            first_false(&[
                (joins(&along), "place"),
                ((arc.plane(), arc.direction()) == (plane, direction), "sense"),
                (are_offsets(written, [a, b], center), "centre"),
                (is_feed(rate, feed), "feed"),
            ])
        }
        (
            Block::Helix { direction, to, center, angle, feed },
            Step::Feed { along: along @ Curve::Arc(arc), rate, center: Some(written), .. },
        ) => {
            let from = along.start();
            let beside_mm = (along.end() - grid.point(to)).xy().norm();
            let turned = arc.sweep().to_degrees() * helix::PER_DEGREE;
            first_false(&[
                (are_near([Some(from.x), Some(from.y), Some(from.z)], start), "place"),
                (beside_mm <= HELIX_END_STEPS * grid.step_mm() && is_near(along.end().z, to[2]), "place"),
                ((arc.plane(), arc.direction()) == (Plane::Xy, direction), "sense"),
                (are_offsets(written, [0, 1], center), "centre"),
                ((turned - angle as f64).abs() <= AGREEMENT_STEPS, "angle"),
                (is_feed(rate, feed), "feed"),
            ])
        }
        (
            Block::Parabola { control, feed, .. },
            Step::Feed { along: along @ Curve::Parabola(parabola), rate, .. },
        ) => first_false(&[
            (joins(&along), "place"),
            (are_offsets(parabola.control(), [0, 1], control), "control"),
            (is_feed(rate, feed), "feed"),
        ]),
        (Block::BeginRails { second, feed }, Step::Rail(rail)) => {
            let words =
                RailWords { to: at.map(Option::unwrap_or_default), second, powers: [[[0; 3]; 4]; 2], feed };
            rail_difference(&words, &rail, start, grid)
        }
        (Block::Rail { index }, Step::Rail(rail)) => {
            rail_difference(&rails[index as usize], &rail, start, grid)
        }
        (Block::Hole { to: [x, y], index }, Step::Hole(hole)) => {
            let words = &cycles[index as usize];
            let ends =
                are_near(hole.from.map(Some), start) && is_near(hole.to[0], x) && is_near(hole.to[1], y);
            let is_rate = is_feed(hole.cycle.rate, words.feed);
            first_false(&[(ends, "place"), (is_rate, "feed")])
                .or_else(|| hole::difference(words, &hole, is_near))
        }
        (Block::Dwell { milliseconds }, Step::Dwell { seconds }) => {
            first_false(&[((seconds * 1000.0 - milliseconds as f64).abs() <= DWELL_AGREEMENT_MS, "dwell")])
        }
        _ => Some("kind"),
    }
}

fn is_cut(step: &Step) -> bool {
    match step {
        Step::Feed { .. } | Step::Rail(_) | Step::Hole(_) => true,
        Step::Posed(posed) => posed.feed != PosedFeed::Rapid,
        Step::Rapid { .. } | Step::Dwell { .. } => false,
    }
}

/// Whether the smoothing that is read is the smoothing that the job asks for. A tolerance may be smaller by
/// less than a unit of the control's last decimal.
fn smooths(read: Option<Smoothing>, job: &ProgramJob) -> bool {
    let is_tolerance = |read: Option<f64>, asked: Option<f64>, step: f64| match (read, asked) {
        (Some(read), Some(asked)) => (-SMOOTHING_AGREEMENT..step).contains(&(asked - read)),
        (None, None) => true,
        _ => false,
    };
    let resolution = job.program.resolution;
    let step_mm = Resolution { decimals: job.dialect.max_decimals, ..resolution }.step_mm();
    let step_deg = 10f64.powi(-i32::from(job.dialect.five_axes.angle_decimals));
    match (read, smoothing::in_force(job)) {
        (Some(read), Some(asked)) => {
            // Cycle 32 states a mode with a tolerance of angles: finishing.
            let states_mode = asked.tolerance_deg.is_some() && asked.mode.is_none();
            let mode = asked.mode.or(states_mode.then_some(SmoothingMode::Finishing));
            is_tolerance(read.tolerance_mm, asked.tolerance_mm, step_mm)
                && is_tolerance(read.tolerance_deg, asked.tolerance_deg, step_deg)
                && read.mode == mode
        }
        (None, None) => true,
        _ => false,
    }
}

fn first_false(checks: &[(bool, &'static str)]) -> Option<&'static str> {
    checks.iter().find(|(holds, _)| !holds).map(|(_, what)| *what)
}

/// What differs between a rail and what was read for it.
fn rail_difference(
    words: &RailWords,
    read: &RailStep,
    start: [Option<i64>; 3],
    grid: &Grid,
) -> Option<&'static str> {
    let fine = FineGrid::new(grid);
    let is_near = |read: f64, wanted: f64, step: f64| (read - wanted).abs() <= AGREEMENT_STEPS * step;
    let unit = fine.mm(1);
    let are_fine =
        |read: [f64; 3], units: [i64; 3]| (0..3).all(|k| is_near(read[k], fine.mm(units[k]), unit));
    let begins =
        (0..3).all(|k| start[k].is_some_and(|at| is_near(read.from[k], grid.mm(at), grid.step_mm())));
    let ends = (0..3).all(|k| is_near(read.to[k], grid.mm(words.to[k]), grid.step_mm()));
    let powers = (0..2).all(|p| (0..4).all(|k| are_fine(read.powers[p][k], words.powers[p][k])));
    let wanted = words.feed.value() * grid.unit_mm();
    first_false(&[
        (begins && ends, "place"),
        (are_fine(read.second, words.second), "axis"),
        (powers, "polynomial"),
        ((read.rate.mm_per_min() - wanted).abs() <= FEED_AGREEMENT * wanted, "feed"),
    ])
}

/// Whether a step has the tool axis of a block, in the mode in which it was written.
fn is_axis(axis: AxisWords, posed: &Posed, job: &ProgramJob) -> bool {
    match axis {
        AxisWords::Vector(parts) => {
            posed.mode == TipMode::Vectors
                && posed.vector.is_some_and(|vector| {
                    let scale = 10f64.powi(i32::from(VECTOR_DECIMALS));
                    vector
                        .iter()
                        .zip(parts)
                        .all(|(read, units)| (read * scale - units as f64).abs() <= AGREEMENT_STEPS)
                })
        }
        AxisWords::Angles(angles) => {
            let scale = 10f64.powi(i32::from(job.dialect.five_axes.angle_decimals));
            posed.mode != TipMode::Vectors
                && job.rotary_names().iter().zip(angles).all(|(name, units)| {
                    let k = ROTARY.iter().position(|letter| letter == name);
                    let read = k.and_then(|k| posed.angles[k]);
                    read.is_some_and(|read| (read * scale - units as f64).abs() <= AGREEMENT_STEPS)
                })
        }
    }
}
