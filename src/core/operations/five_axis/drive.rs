//! The motion along rails within the limits of the axes of a machine.
//!
//! # Method
//! 1. Stations are placed along each piece of the rails, more where spans are few.
//! 2. The machine follows the poses of all stations ([`Machine::follow`]): the branch is chosen over the
//!    whole path. Without a machine the axes are X, Y and Z of the workpiece.
//! 3. The derivatives of all axes are computed at each station. Each piece gets the fastest motion from rest
//!    to rest within all limits and the feed (`schedule`).
//! 4. The use of the limits is bounded everywhere (`proof`). Where it is far above one, stations are added
//!    and step 3 is repeated. What is left is removed: the piece is slowed.
//!
//! # Cost
//! O(n) for n stations; `benches/five_axis` measures it.

mod least_time;
mod proof;
mod s_curve;
#[cfg(test)]
mod tests;

use nalgebra::Point3;

use super::FiveAxisError;
use super::passage::{Passage, passages};
use super::rail::{Jet, Piece, Point6, Rail, Span, tip, top};
use super::schedule::{Derivatives, Limits, Schedule, ScheduleError, Station, TipLimits, schedule};
use super::stations::{self, pose, positions, resolved, unfollowed};
use crate::budget::Budget;
use crate::machine::{AxisPositions, Inverse, Machine};
use proof::Proof;

/// How far beside the pole derivatives are taken, as a part of the span there.
const BESIDE: f64 = 1e-4;

/// How often stations are added where the motion would have to be slowed, and how many to an interval.
const MOST_REFINEMENTS: usize = 2;
const MORE_STATIONS: usize = 3;

/// Where the axis turns by less by the parameter, it does not turn, radians by mm.
const STILL: f64 = 1e-12;

/// Samples between two checks of the budget.
const BETWEEN_CHECKS: usize = 1024;

/// The limits of a motion.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MotionLimits {
    /// Of axes by their names: mm or radians, by s, s2 and s3.
    pub axes: Vec<(char, Limits)>,
    /// Of the tip, mm by s2 and s3.
    pub tip: Option<TipLimits>,
}

impl MotionLimits {
    /// The largest speeds of the axes of a machine, in the order of its names; infinite without a limit.
    pub fn speeds(&self, machine: &Machine) -> [f64; 5] {
        machine.axis_names().map(|name| {
            let own = self.axes.iter().find(|(axis, _)| *axis == name);
            own.map_or(f64::INFINITY, |(_, limits)| limits.speed)
        })
    }
}

/// The motion along one piece.
struct Driven<'a> {
    piece: &'a Piece,
    /// The positions of the axes at the stations, with their parameters.
    stations: Vec<(f64, Option<AxisPositions>)>,
    schedule: Schedule,
    begins_s: f64,
}

/// The motion along all pieces.
pub struct Drive<'a> {
    pieces: Vec<Driven<'a>>,
    machine: Option<&'a Machine>,
    duration_s: f64,
    least_time_s: f64,
    gap: Option<Point3<f64>>,
}

/// A place on the rails, with the positions of the axes.
pub struct DrivenSample {
    pub t_s: f64,
    pub at: Point6,
    pub joints: Option<AxisPositions>,
}

impl<'a> Drive<'a> {
    /// The fastest motion on a machine, if there is one, with the angles of its rotary axes before the path.
    ///
    /// # Errors
    /// Where the machine cannot follow the rails.
    pub fn new(
        rail: &'a Rail,
        machine: Option<(&'a Machine, [f64; 2])>,
        limits: &MotionLimits,
        budget: &Budget,
    ) -> Result<Self, FiveAxisError> {
        let some = |(u, joints): stations::Station| (u, Some(joints));
        let stations: Vec<Vec<(f64, Option<AxisPositions>)>> = match machine {
            Some((machine, start)) => {
                let followed = resolved(rail, machine, start, false, budget)?;
                followed.into_iter().map(|own| own.into_iter().map(some).collect()).collect()
            }
            None => {
                let places = unfollowed(rail).into_iter();
                places.map(|own| own.into_iter().map(|u| (u, None)).collect()).collect()
            }
        };
        let machine = machine.map(|(machine, _)| machine);
        let limits = Axes::new(machine, limits);
        let mut drive = Self { pieces: Vec::new(), machine, duration_s: 0.0, least_time_s: 0.0, gap: None };
        for (piece, stations) in rail.pieces.iter().zip(stations) {
            let passages = passages(&piece.spans, machine);
            let path = Path { piece, passages, stations, machine, rests: piece.rests() };
            let Timed { path, rows, schedule, gap } = path.scheduled(&limits, budget)?;
            drive.least_time_s += path.least_time_s(&rows, &limits, budget)?;
            drive.gap = drive.gap.or(gap);
            let begins_s = drive.duration_s;
            drive.duration_s += schedule.duration_s();
            drive.pieces.push(Driven { piece, stations: path.stations, schedule, begins_s });
        }
        Ok(drive)
    }

    pub fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// No motion along the rails within the limits that rests between pieces takes less, s.
    pub fn least_time_s(&self) -> f64 {
        self.least_time_s
    }

    /// The first place around which the limits are not proved: there the axis passes the pole.
    pub fn gap(&self) -> Option<Point3<f64>> {
        self.gap
    }

    /// Places at times that are `period_s` apart, and the end. The last step may be shorter.
    ///
    /// # Errors
    /// When the budget ends.
    pub fn samples(&self, period_s: f64, budget: &Budget) -> Result<Vec<DrivenSample>, FiveAxisError> {
        let count = (self.duration_s / period_s * (1.0 - 1e-12)).floor() as usize;
        let mut samples = Vec::with_capacity(count + 2);
        let mut k = 0;
        for n in 0..=count + 1 {
            if n.is_multiple_of(BETWEEN_CHECKS) {
                budget.check()?;
            }
            let t_s = if n > count { self.duration_s } else { n as f64 * period_s };
            while k + 1 < self.pieces.len() && self.pieces[k + 1].begins_s <= t_s {
                k += 1;
            }
            samples.push(self.pieces[k].at(t_s, self.machine));
        }
        Ok(samples)
    }
}

impl Drive<'_> {
    /// The time of the motion at a parameter of a piece, s.
    pub fn time_at(&self, piece: usize, u: f64) -> f64 {
        let Driven { begins_s, schedule, .. } = &self.pieces[piece];
        begins_s + schedule.time_at(u)
    }

    /// How long the motion takes from one parameter of a piece to another, s.
    pub fn seconds(&self, piece: usize, ends: [f64; 2]) -> f64 {
        let [from, to] = ends.map(|u| self.pieces[piece].schedule.time_at(u));
        to - from
    }

    /// The positions of the axes at a parameter of a piece.
    pub fn joints(&self, piece: usize, u: f64) -> Option<AxisPositions> {
        self.pieces[piece].joints(u, self.machine?)
    }

    /// The largest speed of the tip between two parameters of a piece, as seen at three places, mm/s.
    pub fn largest_speed(&self, piece: usize, [from, to]: [f64; 2]) -> f64 {
        let Driven { piece, schedule, .. } = &self.pieces[piece];
        let speed = |u: f64| {
            let rate = schedule.at(schedule.time_at(u)).speed;
            rate * tip(&piece.spans[piece.index_at(u)].jet(u)[1]).norm()
        };
        [from, 0.5 * (from + to), to].map(speed).into_iter().fold(0.0, f64::max)
    }
}

impl Driven<'_> {
    fn at(&self, t_s: f64, machine: Option<&Machine>) -> DrivenSample {
        let own = t_s - self.begins_s;
        let is_end = own >= self.schedule.duration_s();
        let ends = [self.stations[0].0, self.stations[self.stations.len() - 1].0];
        let u = if is_end { ends[1] } else { self.schedule.at(own).u.clamp(ends[0], ends[1]) };
        let joints = machine.and_then(|machine| self.joints(u, machine));
        DrivenSample { t_s, at: self.span(u).jet(u)[0], joints }
    }

    fn span(&self, u: f64) -> &Span {
        &self.piece.spans[self.piece.index_at(u)]
    }

    fn joints(&self, u: f64, machine: &Machine) -> Option<AxisPositions> {
        let k = self.stations.partition_point(|(at, _)| *at <= u).clamp(1, self.stations.len() - 1);
        let [(u0, before), (u1, after)] = [self.stations[k - 1], self.stations[k]];
        Some(positions(machine, &[(u0, before?), (u1, after?)], self.span(u), u))
    }
}

/// The names of the axes with their limits.
struct Axes {
    limits: Vec<Limits>,
    tip: Option<TipLimits>,
}

impl Axes {
    fn new(machine: Option<&Machine>, limits: &MotionLimits) -> Self {
        const UNLIMITED: Limits =
            Limits { speed: f64::INFINITY, acceleration: f64::INFINITY, jerk: f64::INFINITY };
        let names = machine.map_or(vec!['X', 'Y', 'Z'], |machine| machine.axis_names().to_vec());
        let of =
            |name: &char| limits.axes.iter().find(|(own, _)| own == name).map_or(UNLIMITED, |(_, own)| *own);
        let mut all: Vec<Limits> = names.iter().map(of).collect();
        // The first three coordinates of a schedule are those of the tip where the tip has limits.
        if machine.is_some() && limits.tip.is_some() {
            all.splice(0..0, [UNLIMITED; 3]);
        }
        Self { limits: all, tip: limits.tip }
    }
}

/// One piece with its stations.
struct Path<'a> {
    piece: &'a Piece,
    /// How each span passes a pole.
    passages: Vec<Option<Passage>>,
    /// The parameters of the stations, and the positions of the axes there.
    stations: Vec<(f64, Option<AxisPositions>)>,
    machine: Option<&'a Machine>,
    /// Whether the tip rests.
    rests: bool,
}

/// The motion along one piece, within the limits.
struct Timed<'a> {
    path: Path<'a>,
    /// The derivatives at the stations.
    rows: Vec<Station>,
    schedule: Schedule,
    /// The first place around which the limits are not proved.
    gap: Option<Point3<f64>>,
}

impl<'a> Path<'a> {
    /// The fastest motion. Where it would have to be slowed for places between stations, it is sought anew
    /// with more stations there.
    fn scheduled(self, axes: &Axes, budget: &Budget) -> Result<Timed<'a>, FiveAxisError> {
        let (mut best, mut tight) = self.fastest(axes, budget)?;
        for _ in 0..MOST_REFINEMENTS {
            if tight.is_empty() {
                break;
            }
            let (refined, still_tight) = best.path.with_stations(&tight).fastest(axes, budget)?;
            if refined.schedule.duration_s() >= best.schedule.duration_s() {
                break;
            }
            (best, tight) = (refined, still_tight);
        }
        Ok(best)
    }

    /// The motion with the given stations, and the intervals between stations for which it was slowed.
    fn fastest(self, axes: &Axes, budget: &Budget) -> Result<(Timed<'a>, Vec<usize>), FiveAxisError> {
        let rows = self.rows(axes)?;
        let found =
            schedule(&rows, &axes.limits, axes.tip.as_ref(), budget).map_err(|error| match error {
                ScheduleError::Stopped(stopped) => FiveAxisError::Stopped(stopped),
                error => FiveAxisError::NotScheduled { error, at: tip(&self.piece.spans[0].start()).into() },
            })?;
        let Proof { slowdown, tight, gap } = self.proof(&found, axes, budget)?;
        let schedule = if slowdown > 1.0 { found.slowed(slowdown) } else { found };
        Ok((Timed { path: self, rows, schedule, gap }, tight))
    }

    /// The derivatives at the stations.
    fn rows(&self, axes: &Axes) -> Result<Vec<Station>, FiveAxisError> {
        let mut stations = Vec::with_capacity(self.stations.len());
        let mut k = 0;
        for (u, joints) in &self.stations {
            let spans = &self.piece.spans;
            while spans[k].to < *u && k + 1 < spans.len() {
                k += 1;
            }
            let next = if spans[k].to == *u && k + 1 < spans.len() { k + 1 } else { k };
            stations.push(self.station(*u, [k, next], *joints, axes)?);
        }
        Ok(stations)
    }

    /// The same piece with stations inside the intervals `tight`.
    fn with_stations(&self, tight: &[usize]) -> Self {
        let mut stations = Vec::with_capacity(self.stations.len() + tight.len() * MORE_STATIONS);
        let mut tight = tight.iter().peekable();
        for (k, (u, joints)) in self.stations.iter().enumerate() {
            stations.push((*u, *joints));
            if tight.next_if_eq(&&k).is_none() {
                continue;
            }
            let length = self.stations[k + 1].0 - u;
            for n in 1..=MORE_STATIONS {
                let at = u + length * n as f64 / (MORE_STATIONS + 1) as f64;
                let pose = pose(&self.piece.spans[self.piece.index_at(at)].jet(at)[0]);
                let joints = self.machine.zip(*joints);
                stations.push((at, joints.map(|(machine, near)| machine.nearest(&pose, near.rotary))));
            }
        }
        Self {
            piece: self.piece,
            passages: self.passages.clone(),
            stations,
            machine: self.machine,
            rests: self.rests,
        }
    }

    /// The derivatives at a station, by the spans before and after it. On the pole they are those beside it:
    /// a path straight through the pole is smooth there, and any other path asks for very fast turns beside
    /// it.
    fn station(
        &self,
        u: f64,
        around: [usize; 2],
        joints: Option<AxisPositions>,
        axes: &Axes,
    ) -> Result<Station, FiveAxisError> {
        let rows = |k: usize| {
            let span = &self.piece.spans[k];
            self.derivatives(k, u, joints, axes).or_else(|error| match error {
                FiveAxisError::OnPole { .. } => {
                    let beside = BESIDE * span.length();
                    let inside = if u + beside < span.to { u + beside } else { u - beside };
                    self.derivatives(k, inside, joints, axes)
                }
                error => Err(error),
            })
        };
        let [before, after] = [rows(around[0])?, rows(around[1])?];
        let coordinates = before.iter().zip(&after).map(|(before, after)| Derivatives {
            first: before[0],
            second: before[1],
            third: [before[2], after[2]],
        });
        let cap = |k: usize| self.speed_cap(k, &self.piece.spans[k].jet(u));
        let speed_cap = cap(around[0]).min(cap(around[1]));
        Ok(Station { u, speed_cap, coordinates: coordinates.collect() })
    }

    /// The most du/dt on a span: the tip moves at the feed, or the top where the tip rests.
    fn speed_cap(&self, span: usize, jet: &Jet) -> f64 {
        self.piece.feeds[span] / if self.rests { top(&jet[1]).norm() } else { tip(&jet[1]).norm() }
    }

    /// The first three derivatives of each coordinate at a parameter of a span.
    fn derivatives(
        &self,
        span: usize,
        u: f64,
        joints: Option<AxisPositions>,
        axes: &Axes,
    ) -> Result<Vec<[f64; 3]>, FiveAxisError> {
        let jet = self.piece.spans[span].jet(u);
        let tips = jet.map(|p| tip(&p));
        let tip_row = |k: usize| [tips[1][k], tips[2][k], tips[3][k]];
        let (Some(machine), Some(joints)) = (self.machine, joints) else {
            return Ok((0..3).map(tip_row).collect());
        };
        let mut rows: Vec<[f64; 3]> =
            if axes.limits.len() > 5 { (0..3).map(tip_row).collect() } else { Vec::new() };
        let tops = jet.map(|p| top(&p));
        let turn = tops[0].cross(&tops[1]).norm() / tops[0].norm_squared();
        if turn <= STILL && matches!(machine.inverse(&pose(&jet[0])), Inverse::Pole { .. }) {
            // The axis rests on the pole: the linear axes are an affine function of the tip.
            let at = |p| machine.at(&Point3::from(p), joints.rotary).linear_mm;
            let origin = at(tips[0]);
            let moved = [1, 2, 3].map(|order| at(tips[0] + tips[order]));
            rows.extend((0..3).map(|k| moved.map(|linear| linear[k] - origin[k])));
            rows.extend([[0.0; 3]; 2]);
            return Ok(rows);
        }
        let through = self.passages[span].as_ref().map(|passage| passage.jet(u));
        let found = machine.derivatives(&tips, &tops, through.as_ref(), &joints);
        let all = found.ok_or(FiveAxisError::OnPole { at: Point3::from(tips[0]) })?;
        rows.extend(all.map(|[_, first, second, third]| [first, second, third]));
        Ok(rows)
    }
}
