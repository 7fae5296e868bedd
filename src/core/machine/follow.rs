//! The motion of the five axes along a path of poses: which of the two solutions, and which full turns.
//!
//! # Method
//! 1. Every pose gets its two solutions, or the fixed angle where it is at the pole.
//! 2. A state of a pose is a branch with a number of full turns for each rotary axis, within travel. From a
//!    state, each branch of the next pose is reached by the nearest angles, so by at most half a turn of each
//!    axis (`nearest`). A change of branch needs more: seen from the tool axis halfway between the two
//!    positions, the two tool axes must be at least a right angle apart. Otherwise the tool would swing out.
//! 3. Poses at the pole have no states. Between their neighbours the free angle is interpolated by the way of
//!    the tip. At an end of the path, it stays at the angle of the neighbour.
//! 4. Dynamic programming over the states finds the least largest step, where a step is the larger angle of
//!    the two axes (`search`). A second run over steps that are not larger finds the least total angle. The
//!    way from the start to the first pose counts in the total.
//!
//! # Guarantees
//! * Every pose is kept, and every position is within travel. Neighbouring angles differ by at most half a
//!   turn. The branch changes only where the two branches meet, so where the tool axis passes close by the
//!   pole or the end of reach.
//! * Nothing is turned back silently. Where the path must be interrupted, the error names the place. Among
//!   all ways to begin, this is the place that is reached latest.
//! * The steps and the total are the least of all motions that step 2 allows, with the limits below.
//!
//! # Degenerate input
//! * No poses give no positions. If all poses are at the pole, the free angle is the start's, or else the
//!   nearest one in steps of 30 degrees with which all axes are within travel.
//! * A travel with more full turns than `MOST_STARTS` is not tried from every turn. A path that uses almost
//!   all of such a travel may be refused.
//!
//! # Cost
//! O(n s) time and memory for n poses and s states, usually s <= 4.
//!
//! # Reference
//! R. E. Bellman, *Dynamic Programming*, Princeton University Press, 1957.

mod nearest;
mod search;
#[cfg(test)]
mod tests;

use std::f64::consts::FRAC_PI_6;
use std::ops::Range;

use super::rotary_axis::is_within;
use super::{AxisPositions, Inverse, LARGEST_ANGLE, Machine};
use crate::toolpath::pose::Pose;
use nearest::{nearest, starts};

/// Why the axes cannot follow a path. An index counts poses from zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum FollowError {
    #[error("pose {index}: the machine cannot tilt the tool to this axis, or a number is not finite")]
    Unreachable { index: usize },
    #[error(
        "the start angle of the axis {axis} is not within 100,000 radians; give the angle before the path"
    )]
    UnusableStart { axis: char },
    #[error("pose {index}: the axis {axis} is out of its travel; move or turn the workpiece")]
    OutOfTravel { index: usize, axis: char },
    #[error(
        "the axis {axis} reaches the end of its travel before pose {index}; end the path there, retract, turn the rotary axes back and go on"
    )]
    Unwinds { index: usize, axis: char },
}

impl FollowError {
    /// The error without the index of its pose: people have not numbered the poses.
    pub fn told(&self) -> String {
        match self {
            Self::Unreachable { .. } => {
                "the machine cannot tilt the tool to this axis; turn the part, or lean the axis less"
                    .to_owned()
            }
            Self::OutOfTravel { axis, .. } => {
                format!("the axis {axis} would leave its travel; move or turn the part")
            }
            Self::Unwinds { axis, .. } => format!(
                "the axis {axis} reaches the end of its travel; end the path there, retract, turn the rotary axes back and go on"
            ),
            Self::UnusableStart { .. } => self.to_string(),
        }
    }

    /// The index of the pose; none for the start.
    pub fn index(&self) -> Option<usize> {
        match *self {
            Self::Unreachable { index } | Self::OutOfTravel { index, .. } | Self::Unwinds { index, .. } => {
                Some(index)
            }
            Self::UnusableStart { .. } => None,
        }
    }
}

/// A place where an axis (in the order of [`Machine::axis_names`]) would leave its travel.
#[derive(Debug, Clone, Copy)]
struct Blocked {
    index: usize,
    axis: usize,
}

impl Machine {
    /// The positions for every pose, so that the axes move as little as possible. `start` holds the angles of
    /// the rotary axes before the path, radians: zeros if they are not known. Angles of wrapped axes count on
    /// beyond a turn; [`RotaryAxis::shown`](super::RotaryAxis::shown) brings them within a turn.
    ///
    /// # Errors
    /// The first pose that no position reaches. Otherwise, the place where every way to follow the path ends.
    pub fn follow(&self, poses: &[Pose], start: [f64; 2]) -> Result<Vec<AxisPositions>, FollowError> {
        self.followed(poses, start, true)
    }

    /// The positions for every pose of a path that is known between its poses, too: the branch changes only
    /// at poses on the pole, and at the end of reach. A path that passes beside the pole turns the axis next
    /// to the workpiece by half a turn there.
    ///
    /// # Errors
    /// The errors of [`Self::follow`].
    pub fn follow_exactly(&self, poses: &[Pose], start: [f64; 2]) -> Result<Vec<AxisPositions>, FollowError> {
        self.followed(poses, start, false)
    }

    fn followed(
        &self,
        poses: &[Pose],
        start: [f64; 2],
        may_cross: bool,
    ) -> Result<Vec<AxisPositions>, FollowError> {
        let path = Path { may_cross, ..Path::new(self, poses, start)? };
        if path.stations.is_empty() {
            return path.rest_on_pole().map_err(|at| path.error(at));
        }
        let rotary = search::least_motion(&path).map_err(|at| path.error(at))?;
        path.positions(&rotary).map_err(|at| path.error(at))
    }
}

/// A pose away from the pole.
struct Station {
    index: usize,
    /// The angles of both branches, or the linear axis that is out of travel.
    branches: [Result<[f64; 2], usize>; 2],
}

/// A path whose poses can each be reached within travel.
struct Path<'a> {
    machine: &'a Machine,
    poses: &'a [Pose],
    start: [f64; 2],
    /// Whether the branch may change between two poses on both sides of a pole.
    may_cross: bool,
    stations: Vec<Station>,
    /// The fixed angle of each pose at the pole; zero for the others.
    fixed: Vec<f64>,
    /// Length of the polygon of tips from the first one, mm.
    way_mm: Vec<f64>,
}

impl<'a> Path<'a> {
    fn new(machine: &'a Machine, poses: &'a [Pose], start: [f64; 2]) -> Result<Self, FollowError> {
        let is_unusable = |k: &usize| start[*k].is_nan() || start[*k].abs() > LARGEST_ANGLE;
        if let Some(k) = (0..2).find(is_unusable) {
            return Err(FollowError::UnusableStart { axis: machine.rotary[k].name });
        }
        let mut path =
            Self { machine, poses, start, may_cross: true, stations: vec![], fixed: vec![], way_mm: vec![] };
        let mut way_mm = 0.0;
        for (index, pose) in poses.iter().enumerate() {
            let mut fixed = 0.0;
            match machine.inverse(pose) {
                Inverse::Unreachable => return Err(FollowError::Unreachable { index }),
                Inverse::Pole { fixed: angle } => {
                    fixed = angle;
                    let axis = 1 - machine.free_axis();
                    if starts(machine.rotary[axis].travel, angle, angle).is_empty() {
                        return Err(path.out_of_travel(index, 3 + axis));
                    }
                }
                Inverse::Two(both) => {
                    path.check_alone(index, &both)?;
                    let branches = both.map(|joints| {
                        machine.linear_out_of_travel(&joints.linear_mm).map_or(Ok(joints.rotary), Err)
                    });
                    path.stations.push(Station { index, branches });
                }
            }
            if let Some(before) = index.checked_sub(1) {
                way_mm += (pose.tip - poses[before].tip).norm();
            }
            path.fixed.push(fixed);
            path.way_mm.push(way_mm);
        }
        Ok(path)
    }

    /// Refuses a pose for which neither branch is within travel with any number of turns.
    fn check_alone(&self, index: usize, both: &[AxisPositions; 2]) -> Result<(), FollowError> {
        let out_of_travel = |joints: &AxisPositions| {
            let rotary = (0..2).find(|&k| {
                starts(self.machine.rotary[k].travel, joints.rotary[k], joints.rotary[k]).is_empty()
            });
            rotary.map(|k| 3 + k).or_else(|| self.machine.linear_out_of_travel(&joints.linear_mm))
        };
        match (out_of_travel(&both[0]), out_of_travel(&both[1])) {
            // A linear axis is named first: it ends the branch that the rotary axes can reach.
            (Some(first), Some(second)) => Err(self.out_of_travel(index, first.min(second))),
            _ => Ok(()),
        }
    }

    fn out_of_travel(&self, index: usize, axis: usize) -> FollowError {
        FollowError::OutOfTravel { index, axis: self.machine.axis_names()[axis] }
    }

    fn error(&self, Blocked { index, axis }: Blocked) -> FollowError {
        match axis {
            0..3 => self.out_of_travel(index, axis),
            _ => FollowError::Unwinds { index, axis: self.machine.axis_names()[axis] },
        }
    }

    /// The poses at the pole before the station `to`; after the last station, those that end the path.
    fn run_before(&self, to: usize) -> Range<usize> {
        let begin = to.checked_sub(1).map_or(0, |before| self.stations[before].index + 1);
        begin..self.stations.get(to).map_or(self.poses.len(), |station| station.index)
    }

    /// The part of the way between the two stations beside `run` at which a pose of the run lies.
    fn part(&self, run: &Range<usize>, index: usize) -> f64 {
        let (from, to) = (run.start - 1, run.end);
        let whole = self.way_mm[to] - self.way_mm[from];
        if whole > 0.0 {
            (self.way_mm[index] - self.way_mm[from]) / whole
        } else {
            (index - from) as f64 / (to - from) as f64
        }
    }

    /// Walks over poses at the pole, from the angle `fixed`, with a chosen free angle at each. `visit` gets
    /// the positions. Returns the last fixed angle.
    fn walk(
        &self,
        poses: impl Iterator<Item = usize>,
        mut fixed: f64,
        free: impl Fn(usize) -> f64,
        mut visit: impl FnMut(usize, AxisPositions),
    ) -> Result<f64, Blocked> {
        let axis = 1 - self.machine.free_axis();
        let travel = self.machine.rotary[axis].travel;
        for index in poses {
            let next = nearest(self.fixed[index], fixed).find(|&angle| is_within(travel, angle));
            fixed = next.ok_or(Blocked { index, axis: 3 + axis })?;
            let rotary = if axis == 0 { [fixed, free(index)] } else { [free(index), fixed] };
            let joints = self.machine.at(&self.poses[index].tip, rotary);
            if let Some(axis) = self.machine.linear_out_of_travel(&joints.linear_mm) {
                return Err(Blocked { index, axis });
            }
            visit(index, joints);
        }
        Ok(fixed)
    }

    /// The positions of all poses, given the angles at the stations.
    fn positions(&self, rotary: &[[f64; 2]]) -> Result<Vec<AxisPositions>, Blocked> {
        let mut all = vec![AxisPositions { linear_mm: [0.0; 3], rotary: [0.0; 2] }; self.poses.len()];
        let free = self.machine.free_axis();
        for (station, &angles) in self.stations.iter().zip(rotary) {
            all[station.index] = self.machine.at(&self.poses[station.index].tip, angles);
        }
        for to in 0..=rotary.len() {
            let run = self.run_before(to);
            let (before, after) = (to.checked_sub(1).map(|k| rotary[k]), rotary.get(to).copied());
            let visit = |index: usize, joints| all[index] = joints;
            match (before, after) {
                (Some(from), Some(to)) => {
                    let at = |k| from[free] + (to[free] - from[free]) * self.part(&run, k);
                    self.walk(run.clone(), from[1 - free], at, visit)?;
                }
                (Some(from), None) => {
                    self.walk(run, from[1 - free], |_| from[free], visit)?;
                }
                (None, Some(to)) => {
                    self.walk(run.rev(), to[1 - free], |_| to[free], visit)?;
                }
                (None, None) => {}
            }
        }
        Ok(all)
    }

    /// The positions when all poses are at the pole.
    fn rest_on_pole(&self) -> Result<Vec<AxisPositions>, Blocked> {
        let free = self.machine.free_axis();
        let travel = self.machine.rotary[free].travel;
        let start = travel.map_or(self.start[free], |[low, high]| self.start[free].clamp(low, high));
        let turns =
            (0..=6).flat_map(|k| [start + f64::from(k) * FRAC_PI_6, start - f64::from(k) * FRAC_PI_6]);
        let fixed_travel = self.machine.rotary[1 - free].travel;
        let first = self.fixed.first().copied().unwrap_or(0.0);
        let mut fixed = starts(fixed_travel, first, self.start[1 - free]);
        let from_start = |angle: &f64| (angle - self.start[1 - free]).abs();
        fixed.sort_by(|a, b| from_start(a).total_cmp(&from_start(b)));
        let mut latest = None;
        for angle in turns.filter(|&angle| is_within(travel, angle)) {
            for &from in &fixed {
                let mut all = Vec::with_capacity(self.poses.len());
                match self.walk(0..self.poses.len(), from, |_| angle, |_, joints| all.push(joints)) {
                    Ok(_) => return Ok(all),
                    Err(blocked) => keep_latest(&mut latest, blocked),
                }
            }
        }
        Err(latest.unwrap_or(Blocked { index: 0, axis: 3 + free }))
    }
}

/// Keeps the place that lies farther along the path.
fn keep_latest(latest: &mut Option<Blocked>, blocked: Blocked) {
    if latest.is_none_or(|before| blocked.index > before.index) {
        *latest = Some(blocked);
    }
}
