//! Dynamic programming over the branches and full turns along a path.

use std::f64::consts::TAU;

use super::nearest::{nearest, starts};
use super::{Blocked, Path, keep_latest};
use crate::machine::AxisPositions;
use crate::machine::rotary_axis::is_within;

/// The most states of a pose that are kept. Only travels of many turns have more; then the states of largest
/// cost are left out. Time and memory are proportional to it.
const MOST_STATES: usize = 128;

/// By how much (radians) a step may exceed the least largest step in the second run: rounding must not
/// exclude the motion that the first run found.
const SAME_STEP: f64 = 1e-9;

/// By how much (as a distance of unit vectors) the tool may swing out at a change of branch between two equal
/// tool axes. It covers the rounding of solutions that almost coincide; 1e-6 is a fifth of an arc second.
const SWING: f64 = 1e-6;

/// What a motion costs.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Cost {
    /// The larger angle of the largest step.
    LargestStep,
    /// The sum of all angles of both axes, of steps that are not larger than this.
    Total { step_max: f64 },
}

impl Cost {
    /// The cost with one more step. `None` if the step is too large.
    fn with(self, cost: f64, from: [f64; 2], to: [f64; 2]) -> Option<f64> {
        let [a, b] = [0, 1].map(|k| (to[k] - from[k]).abs());
        match self {
            Cost::LargestStep => Some(cost.max(a).max(b)),
            Cost::Total { step_max } => (a.max(b) <= step_max).then_some(cost + a + b),
        }
    }
}

/// A branch and a number of turns at a station.
#[derive(Debug, Clone, Copy)]
struct State {
    rotary: [f64; 2],
    cost: f64,
    /// The state before, at the station before.
    before: u32,
    branch: u8,
}

/// The angles at every station with the least largest step, and of those motions the one with the least
/// total.
pub fn least_motion(path: &Path) -> Result<Vec<[f64; 2]>, Blocked> {
    let step = least(&run(path, Cost::LargestStep)?).map_or(0.0, |(_, state)| state.cost);
    let layers = run(path, Cost::Total { step_max: step + SAME_STEP })?;
    let mut rotary = Vec::with_capacity(layers.len());
    let mut at = least(&layers).map_or(0, |(at, _)| at);
    for state in layers.iter().rev().filter_map(|layer| {
        let state = layer.get(at)?;
        at = state.before as usize;
        Some(state)
    }) {
        rotary.push(state.rotary);
    }
    rotary.reverse();
    Ok(rotary)
}

/// The state of least cost at the last station.
fn least(layers: &[Vec<State>]) -> Option<(usize, &State)> {
    layers.last()?.iter().enumerate().min_by(|(_, a), (_, b)| a.cost.total_cmp(&b.cost))
}

/// The states of every station, with the least cost to reach each. None of the lists is empty.
fn run(path: &Path, cost: Cost) -> Result<Vec<Vec<State>>, Blocked> {
    let mut latest = None;
    let mut layers: Vec<Vec<State>> = Vec::with_capacity(path.stations.len());
    for to in 0..path.stations.len() {
        let mut layer = match layers.last() {
            None => first_states(path, cost, &mut latest),
            Some(before) => next_states(path, cost, before, to, &mut latest),
        };
        if to + 1 == path.stations.len() {
            layer = finished(path, cost, &layer, &mut latest);
        }
        if layer.is_empty() {
            let nowhere = Blocked { index: path.stations[to].index, axis: 3 + path.machine.free_axis() };
            return Err(latest.unwrap_or(nowhere));
        }
        layers.push(layer);
    }
    Ok(layers)
}

/// The states of the first station. Poses at the pole before it must be possible with them.
fn first_states(path: &Path, cost: Cost, latest: &mut Option<Blocked>) -> Vec<State> {
    let free = path.machine.free_axis();
    let mut states = Vec::new();
    for (branch, angles) in path.stations[0].branches.iter().enumerate() {
        let Ok(base) = angles else { continue };
        let [first, second] = [0, 1].map(|k| starts(path.machine.rotary[k].travel, base[k], path.start[k]));
        for rotary in first.iter().flat_map(|&a| second.iter().map(move |&b| [a, b])) {
            let mut steps = Steps { cost: Some(0.0), last: rotary, measure: cost };
            let run = path.run_before(0).rev();
            let walked = path.walk(run, rotary[1 - free], |_| rotary[free], |_, joints| steps.add(joints));
            match (walked, steps.cost) {
                (Ok(_), Some(run_cost)) => {
                    let approach: f64 = rotary.iter().zip(path.start).map(|(a, b)| (a - b).abs()).sum();
                    let approach = if cost == Cost::LargestStep { 0.0 } else { approach };
                    states.push(State { rotary, cost: run_cost + approach, before: 0, branch: branch as u8 });
                }
                (Ok(_), None) => {}
                (Err(blocked), _) => keep_latest(latest, blocked),
            }
        }
    }
    states
}

/// The states of the last station from which the poses at the pole behind it are possible.
fn finished(path: &Path, cost: Cost, layer: &[State], latest: &mut Option<Blocked>) -> Vec<State> {
    let free = path.machine.free_axis();
    let run = path.run_before(path.stations.len());
    let mut kept = Vec::with_capacity(layer.len());
    for state in layer {
        let rotary = state.rotary;
        let mut steps = Steps { cost: Some(state.cost), last: rotary, measure: cost };
        let visit = |_, joints| steps.add(joints);
        match path.walk(run.clone(), rotary[1 - free], |_| rotary[free], visit) {
            Ok(_) => kept.extend(steps.cost.map(|cost| State { cost, ..*state })),
            Err(blocked) => keep_latest(latest, blocked),
        }
    }
    kept
}

/// The states of the station `to` that can be reached from the states of the station before.
fn next_states(
    path: &Path,
    cost: Cost,
    before: &[State],
    to: usize,
    latest: &mut Option<Blocked>,
) -> Vec<State> {
    let mut states: Vec<State> = Vec::with_capacity(before.len());
    for (k, state) in before.iter().enumerate() {
        for branch in 0..2 {
            let is_same = usize::from(state.branch) == branch;
            match reached(path, cost, state, to, branch) {
                Ok(found) => {
                    for (rotary, cost) in found.into_iter().flatten() {
                        let next = State { rotary, cost, before: k as u32, branch: branch as u8 };
                        keep_cheapest(path, &mut states, next);
                    }
                }
                // The other branch may be out of reach: only the end of a branch ends the motion.
                Err(blocked) if is_same => keep_latest(latest, blocked),
                Err(_) => {}
            }
        }
    }
    if states.len() > MOST_STATES {
        states.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        states.truncate(MOST_STATES);
    }
    states
}

/// Adds a state, unless one with the same branch and turns is cheaper. Turns of an axis without a travel do
/// not matter for what follows, so states that differ in them only are the same.
fn keep_cheapest(path: &Path, states: &mut Vec<State>, next: State) {
    let is_same = |other: &State| {
        other.branch == next.branch
            && (0..2).all(|k| {
                path.machine.rotary[k].travel.is_none()
                    || (other.rotary[k] - next.rotary[k]).abs() < 0.5 * TAU
            })
    };
    match states.iter_mut().find(|other| is_same(other)) {
        Some(other) if next.cost < other.cost => *other = next,
        Some(_) => {}
        None => states.push(next),
    }
}

/// At most two directions of each axis lead to a state.
type Reached = [Option<([f64; 2], f64)>; 4];

/// The angles of a branch of the station `to` that are reached from a state, with their costs.
fn reached(path: &Path, cost: Cost, state: &State, to: usize, branch: usize) -> Result<Reached, Blocked> {
    let machine = path.machine;
    let free = machine.free_axis();
    let index = path.stations[to].index;
    let base = path.stations[to].branches[branch].map_err(|axis| Blocked { index, axis })?;
    let run = path.run_before(to);
    let mut found = [None; 4];
    let mut count = 0;
    let mut blocked = None;
    let is_free = |angle: &f64| is_within(machine.rotary[free].travel, *angle);
    for target in nearest(base[free], state.rotary[free]).filter(is_free) {
        let mut steps = Steps { cost: Some(state.cost), last: state.rotary, measure: cost };
        let between = |k| state.rotary[free] + (target - state.rotary[free]) * path.part(&run, k);
        let walked = path.walk(run.clone(), state.rotary[1 - free], between, |_, joints| steps.add(joints));
        let fixed = match walked {
            Ok(fixed) => fixed,
            Err(at) => {
                keep_latest(&mut blocked, at);
                continue;
            }
        };
        let mut is_blocked = true;
        for angle in nearest(base[1 - free], fixed).filter(|&a| is_within(machine.rotary[1 - free].travel, a))
        {
            is_blocked = false;
            let rotary = if free == 0 { [target, angle] } else { [angle, target] };
            let changes = usize::from(state.branch) != branch && run.is_empty();
            if changes && (swings(path, to, state.rotary, rotary) || crosses(path, to)) {
                continue;
            }
            let total = steps.cost.and_then(|so_far| cost.with(so_far, steps.last, rotary));
            if let (Some(total), Some(place)) = (total, found.get_mut(count)) {
                *place = Some((rotary, total));
                count += 1;
            }
        }
        if is_blocked {
            keep_latest(&mut blocked, Blocked { index, axis: 3 + 1 - free });
        }
    }
    match blocked {
        Some(at) if count == 0 => Err(at),
        None if nearest(base[free], state.rotary[free]).all(|angle| !is_free(&angle)) => {
            Err(Blocked { index, axis: 3 + free })
        }
        _ => Ok(found),
    }
}

/// Whether the tool axis swings out on the way to the station `to`: seen from its place halfway, its two ends
/// are less than a right angle apart.
fn swings(path: &Path, to: usize, from_rotary: [f64; 2], to_rotary: [f64; 2]) -> bool {
    let middle = path.machine.tool_axis([0, 1].map(|k| 0.5 * (from_rotary[k] + to_rotary[k])));
    let [from, to] = [to - 1, to].map(|k| path.poses[path.stations[k].index].axis.into_inner() - *middle);
    from.dot(&to) > SWING * SWING
}

/// Whether a change of branch on the way to the station `to` would be one at a pole, on a path that is known
/// not to go through it. The branches meet at poles, where their free angles are half a turn apart, and at
/// the end of reach, where they are equal.
fn crosses(path: &Path, to: usize) -> bool {
    let free = path.machine.free_axis();
    let apart = [to - 1, to].map(|k| match path.stations[k].branches {
        [Ok(first), Ok(second)] => (first[free] - second[free]).cos(),
        _ => 1.0,
    });
    !path.may_cross && apart[0].min(apart[1]) < 0.0
}

/// The cost of a walk over poses at the pole.
struct Steps {
    /// `None` after a step that is too large.
    cost: Option<f64>,
    last: [f64; 2],
    measure: Cost,
}

impl Steps {
    fn add(&mut self, joints: AxisPositions) {
        self.cost = self.cost.and_then(|cost| self.measure.with(cost, self.last, joints.rotary));
        self.last = joints.rotary;
    }
}
