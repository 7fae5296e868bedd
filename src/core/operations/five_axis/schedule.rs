//! Finds the fastest motion along a smooth path, from rest to rest, with limits of speed, acceleration and
//! jerk.
//!
//! # Method
//! The path is a function of a parameter u. The unknown is b(u), the square of du/dt. The speed of a
//! coordinate q is q' sqrt(b), its acceleration q'' b + q' b'/2, its jerk
//! sqrt(b) (q''' b + 3/2 q'' b' + 1/2 q' b''). The time is the integral of 1 / sqrt(b).
//!
//! 1. Take the stations as nodes. Add nodes toward the ends and where the path bends sharply (`grid`,
//!    `resolution`).
//! 2. Let b be a parabola between nodes, with b' continuous. In the first and last interval let u have a
//!    constant jerk (`rows`).
//! 3. Start with a slow motion within the limits at the nodes (`start`).
//! 4. Minimise the time by an interior-point method (`interior`).
//! 5. Where the motion exceeds a limit between nodes, lower the limit at the nodes beside it and repeat
//!    step 4 (`between`).
//! 6. The parabolas give u as a function of time in closed form (`profile`).
//!
//! # Guarantees
//! * At the stations, no limit is exceeded. Between nodes the excess is estimated: below 1 % if the stations
//!   resolve the path. [`Schedule::slowdown_for`] bounds it and [`Schedule::slowed`] removes it.
//! * The square of the speed stays below the straight line between the squares of the caps of two stations.
//! * Speed and acceleration are continuous, and 0 at both ends.
//! * The problem is not convex. The result is a local optimum. It took at most 1.004 times the time of the
//!   peer in `benches/peers/copp` on smooth paths with 1000 stations.
//! * The same input gives the same result.
//!
//! # Degenerate input
//! A single station gives a duration of 0. Limits and caps may be infinite; crossing the path then takes at
//! least a microsecond. A station without a cap at which no coordinate moves is refused.
//!
//! # Cost
//! O(n) for n stations: 5 to 15 microseconds each with 5 coordinates. Up to 100 nodes are added at the ends,
//! and up to three to each interval that does not resolve the path.
//!
//! # Reference
//! D. Verscheure et al., "Time-Optimal Path Tracking for Robots: A Convex Optimization Approach", IEEE
//! Transactions on Automatic Control 54, 2009, for b as the unknown. Y. Wang et al., "Online time-optimal
//! trajectory planning along parametric toolpaths with strict constraint satisfaction and certifiable
//! feasibility guarantee", International Journal of Machine Tools and Manufacture 215, 2026, for b as
//! parabolas and a constant jerk from rest. S. Boyd and L. Vandenberghe, "Convex Optimization", 2004, section
//! 11.7, for the interior-point method.

mod between;
mod bounds;
mod grid;
mod interior;
mod least_squares;
mod newton;
mod profile;
mod resolution;
mod rows;
mod start;
mod station;

pub use bounds::{Course, Expansion, Slowdown};
pub use profile::{Motion, Schedule};
pub use station::{Derivatives, Limits, ScheduleError, Station, TipLimits};

use crate::budget::Budget;
use rows::Rows;

/// The most repetitions with lowered limits. The first leaves an excess below 1 % on resolved paths; each
/// costs half as much as the first search.
const REPETITIONS: usize = 2;

/// The part of the lowered limits that a repetition starts with. A smaller part is farther from the result; a
/// larger part starts too close to the limits.
const ROOM: f64 = 0.9;

/// The part of the time that a search may gain from its start: first, and after limits are lowered. A larger
/// part takes more steps; a smaller part keeps the search near the limits, where its steps are short.
const GAIN: [f64; 2] = [1.0, 0.1];

/// The schedule of the fastest motion along the path through `stations`, which may differ from the optimum by
/// some tenths of a percent. There is one entry of `limits` for each coordinate.
///
/// # Errors
/// * A fault of the input, with its station.
/// * `OutOfRange` for numbers that are too large or too small.
/// * `Stopped` by the budget.
pub fn schedule(
    stations: &[Station],
    limits: &[Limits],
    tip: Option<&TipLimits>,
    budget: &Budget,
) -> Result<Schedule, ScheduleError> {
    station::check(stations, limits, tip)?;
    if stations.len() < 2 {
        return Ok(Schedule::new(stations.iter().map(|s| s.u).collect(), vec![[0.0; 2]; stations.len()]));
    }
    let nodes = grid::nodes(stations, limits, tip);
    if nodes.len() < 4 {
        return Err(ScheduleError::OutOfRange);
    }
    budget.check()?;
    let mut rows = Rows::new(&nodes, limits, tip);
    let mut m = interior::fastest(&rows, start::slow(&rows), GAIN[0], budget)?;
    let mut states = Vec::new();
    rows.states(&m, &mut states);
    for _ in 0..REPETITIONS {
        let Some(excess) = between::tighten(&mut rows, &nodes, &states, limits, tip) else { break };
        m.iter_mut().for_each(|m| *m *= ROOM / excess);
        m = interior::fastest(&rows, m, GAIN[1], budget)?;
        rows.states(&m, &mut states);
    }
    let inner = &states[1..states.len() - 1];
    if !inner.iter().all(|[b, slope]| *b > 0.0 && b.is_finite() && slope.is_finite()) {
        return Err(ScheduleError::OutOfRange);
    }
    let schedule = Schedule::new(nodes.iter().map(|node| node.u).collect(), states);
    let seconds = schedule.duration_s();
    if seconds > 0.0 && seconds.is_finite() { Ok(schedule) } else { Err(ScheduleError::OutOfRange) }
}

#[cfg(test)]
mod tests;
