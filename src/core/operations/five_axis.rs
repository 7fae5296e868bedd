//! Smooths a path of five axes: tips and tool axes on rails, within tolerances (Ahn, Jee).
//!
//! # Method
//! 1. Poses that repeat the one before are left out (`path`).
//! 2. The method makes rails: polynomials of one parameter for the tip and the top of the tool
//!    (`smooth`, `tube`, `paper`, `linear`; `blend` around corners, `rotation` where the tip rests).
//! 3. Each span is proved against the blocks that it replaces (`deviation`).
//! 4. The motion along the rails, at the feed or within limits (`drive`), is sampled (`motion`).
//! 5. Chords of the rails are the moves of the toolpath (`moves`).
//!
//! A path with rapids is smoothed between them. Each rapid is a straight line from stop to stop.
//!
//! # Guarantees
//! * The tip of the default method is within the tolerance of the given path everywhere, and the given path
//!   within the tolerance of the tip. The axis is within its tolerance of the great circle between the given
//!   axes, at the nearest place of the given path. The report states proved bounds.
//! * With a tool, its cut is within the tolerance of the cut of the given path. What the axis moves counts.
//! * The first and the last pose are hit exactly.
//!
//! # Degenerate input
//! A path of one pose is refused, and so are neighbouring axes that are opposite. Where the path turns back,
//! and where the axis turns about a resting tip, the motion stops.
//!
//! # Differences from the paper
//! The paper's own method is `paper`, with its differences. The default interpolates the stations with shared
//! parameters that grow by the chord length, and splits the path at corners, at which the paper's clamp does
//! not hold the tolerance.
//!
//! # Reference
//! K. Ahn, S. Jee, *Five-Axis Tool Path Smoothing based on Cubic B-Spline Curves*, 2020.

mod band;
mod blend;
mod deviation;
mod drive;
pub mod history;
mod linear;
mod motion;
mod moves;
mod paper;
mod path;
mod rail;
mod rotation;
pub mod schedule;
mod smooth;
mod stations;
#[cfg(test)]
mod tests;
mod tube;

use nalgebra::{Point3, Vector3};

use crate::budget::{Budget, Stopped};
use crate::machine::{FollowError, Joints, Machine};
use crate::toolpath::pose::{Pace, Pose, Waypoint};
use crate::toolpath::units::{FeedRate, rounded_up};
use crate::toolpath::{PathError, Toolpath};
use deviation::Deviation;
pub use drive::MotionLimits;
use drive::{Drive, DrivenSample};
pub use motion::Peak;
use motion::{ConstantFeed, peaks};
pub use moves::CHORDS;
use moves::CHORDS_AT_CORNERS;
use path::Path;
use rail::{Rail, Source};
use schedule::ScheduleError;
use stations::{follow, pose};

/// The part of the tolerance of the cut that turns of the axis may use.
const SHARE_OF_AXIS: f64 = 0.25;

/// How rails are made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Method {
    /// Rails through all poses, with blends at corners.
    #[default]
    Interpolating,
    /// Rails of few spans and least jerk inside the tolerance, with blends at corners.
    Tube,
    /// The method of the paper, as printed but for its misprints.
    Paper,
    /// The blocks as they are.
    Linear,
}

#[derive(Debug, Clone)]
pub struct Job {
    pub path: Vec<Waypoint>,
    /// The pace of rapids.
    pub rapid_feed: FeedRate,
    pub tolerance_mm: f64,
    /// Radians.
    pub tolerance_axis: f64,
    /// How far a turn of the tool about its tip moves the cut surface, mm per radian. With 0, `tolerance_mm`
    /// holds for the tip alone.
    pub swing_mm: f64,
    /// The distance from the tip to the top, mm: the second rail.
    pub top_mm: f64,
    pub method: Method,
    /// The machine whose axes are to move; none for the tool alone.
    pub machine: Option<Machine>,
    /// The limits of the axes. Without limits the feed is constant, and nothing accelerates.
    pub limits: Option<MotionLimits>,
    pub period_s: f64,
    /// The most samples.
    pub sample_limit: usize,
    /// The most moves.
    pub move_limit: usize,
    /// The way along the tool axis to the first pose, and away from the last pose, mm. There is none where
    /// the first pose is reached by a rapid, and where the path ends with a rapid.
    pub retract_mm: f64,
    /// What writing a program moves the tip, mm: rounding, and straying between blocks. Blends at corners
    /// leave it room.
    pub rounding_mm: f64,
}

impl Job {
    /// The tolerances of tip and axis. What a turn moves the cut is taken from the tolerance of the tip.
    fn tolerance(&self) -> Deviation {
        let turns = self.path.windows(2).any(|pair| pair[0].pose.axis != pair[1].pose.axis);
        let swing_mm = if turns { self.swing_mm } else { 0.0 };
        let axis = self.tolerance_axis.min(SHARE_OF_AXIS * self.tolerance_mm / swing_mm);
        Deviation { tip_mm: self.tolerance_mm - swing_mm * axis, axis }
    }
}

/// The tool at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimedPose {
    pub t_s: f64,
    pub pose: Pose,
    /// The positions of the axes, if there is a machine.
    pub joints: Option<Joints>,
}

#[derive(Debug, Clone)]
pub struct Plan {
    pub report: Report,
    pub samples: Vec<TimedPose>,
    /// Straight moves along the smooth path.
    pub toolpath: Toolpath,
    pub warnings: Vec<Warning>,
}

/// Something to know before the motion runs, which does not stop the job.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Warning {
    #[error("the method leaves the tolerances: up to {:.4} mm and {:.4} degrees from the given path", rounded_up(*deviation_mm), rounded_up(deviation_axis.to_degrees()))]
    ToleranceExceeded { deviation_mm: f64, deviation_axis: f64 },
    #[error(
        "near {at} mm the tool axis passes a pole of the machine, where the limits of the axes are checked but not proved; lean the axis a little there"
    )]
    LimitsNotProved { at: Point3<f64> },
    #[error("the program may be up to {:.4} mm from the given path, beyond the tolerance", rounded_up(*deviation_mm))]
    RoundingExceedsTolerance { deviation_mm: f64 },
}

#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Poses without those that repeat the one before.
    pub n_poses: usize,
    pub n_spans: usize,
    /// Corners that are blended.
    pub n_blends: usize,
    /// Places inside the path where the motion stops.
    pub n_stops: usize,
    /// Bounds of the deviation of tip and axis; whether both are within their tolerances.
    pub deviation_mm: f64,
    pub deviation_axis: f64,
    pub is_within_tolerance: bool,
    /// Bounds of the deviation of the moves of the toolpath.
    pub moves_deviation_mm: f64,
    pub moves_deviation_axis: f64,
    /// Bound of how far the cut is moved, where `Job::swing_mm` is given.
    pub cut_deviation_mm: Option<f64>,
    /// The number of continuous derivatives between stops.
    pub continuity: usize,
    pub length_mm: f64,
    pub cycle_time_s: f64,
    /// None without limits.
    pub limits_proof: Option<LimitsProof>,
    /// Of the tip, by differences of the samples: mm/s, mm/s2 and mm/s3.
    pub speed: Peak,
    pub acceleration: Peak,
    pub jerk: Peak,
    /// The largest speed, acceleration and jerk of each axis of the machine, by differences of the samples:
    /// mm or radians by s, s2 and s3.
    pub axis_peaks: Vec<(char, [f64; 3])>,
}

impl Report {
    fn warnings(&self) -> Vec<Warning> {
        let &Self { deviation_mm, deviation_axis, .. } = self;
        let exceeded = Warning::ToleranceExceeded { deviation_mm, deviation_axis };
        let gap = match self.limits_proof {
            Some(LimitsProof::GapAt(at)) => Some(Warning::LimitsNotProved { at }),
            _ => None,
        };
        (!self.is_within_tolerance).then_some(exceeded).into_iter().chain(gap).collect()
    }

    /// The warning that rounding, and straying between blocks, may take the program of `job` out of the
    /// tolerance.
    pub fn warning_of_program(&self, job: &Job) -> Option<Warning> {
        let deviation_mm = self.cut_deviation_mm.unwrap_or(self.moves_deviation_mm) + job.rounding_mm;
        let is_beyond = self.is_within_tolerance && deviation_mm > job.tolerance_mm;
        is_beyond.then_some(Warning::RoundingExceedsTolerance { deviation_mm })
    }
}

/// Whether the motion keeps its limits at every time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LimitsProof {
    Complete,
    /// At a pole of the machine rotary axes turn without bound. Around the first such place limits are
    /// checked at single times only.
    GapAt(Point3<f64>),
}

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FiveAxisError {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    #[error("all poses are the same")]
    NoMotion,
    #[error("the axis of pose {index} points against that of the pose before it")]
    OppositeAxes { index: usize },
    #[error("the motion takes {duration_s:.3} s, which is more than {limit} samples")]
    TooManySamples { duration_s: f64, limit: usize },
    #[error("near {at} the path keeps no tolerance as small as this")]
    ToleranceNotReached { at: Point3<f64> },
    #[error("near {at} {}", error.told())]
    NotFollowed { error: FollowError, at: Point3<f64> },
    #[error(
        "near {at} the tool axis passes through the pole of the machine, where a rotary axis would have to turn at once; lean the axis there, or turn the part"
    )]
    OnPole { at: Point3<f64> },
    #[error("the piece that begins at {at} has no schedule: {error}")]
    NotScheduled { error: ScheduleError, at: Point3<f64> },
    #[error("a move of the toolpath failed: {0}")]
    Moves(#[from] PathError),
}

/// What a method makes.
struct Rails {
    rail: Rail,
    deviation: Deviation,
    n_blends: usize,
    continuity: usize,
}

/// Smooths the path.
///
/// # Errors
/// One of [`FiveAxisError`].
pub fn plan(job: &Job, budget: &Budget) -> Result<Plan, FiveAxisError> {
    let path = Path::new(&job.path, job.top_mm)?;
    let rails = rails(job, &path, budget)?;
    let motion = ConstantFeed::new(&rails.rail);
    // No motion within limits is faster.
    checked(job, motion.duration_s())?;
    let machine = job.machine.as_ref();
    let drive = job.limits.as_ref().map(|limits| Drive::new(&rails.rail, machine, limits, budget));
    let drive = drive.transpose()?;
    let samples = match &drive {
        Some(drive) => driven(job, drive, budget)?,
        None => at_feed(job, &motion, budget)?,
    };
    let moves = moves::moves(job, &path, &rails, drive.as_ref(), budget)?;
    let cycle_time_s = samples[samples.len() - 1].t_s;
    // The last step may be shorter.
    let even = &samples[..samples.len() - 1];
    let tips: Vec<Vector3<f64>> = even.iter().map(|sample| sample.pose.tip.coords).collect();
    let [speed, acceleration, jerk] = peaks(&tips, job.period_s);
    let report = Report {
        n_poses: path.stations.len(),
        n_spans: rails.rail.spans().count(),
        n_blends: rails.n_blends,
        n_stops: rails.rail.pieces.len() - 1,
        deviation_mm: rails.deviation.tip_mm,
        deviation_axis: rails.deviation.axis,
        is_within_tolerance: rails.deviation.of(job.tolerance()) <= 1.0,
        moves_deviation_mm: moves.deviation.tip_mm,
        moves_deviation_axis: moves.deviation.axis,
        cut_deviation_mm: (job.swing_mm > 0.0)
            .then_some(moves.deviation.tip_mm + job.swing_mm * moves.deviation.axis),
        continuity: rails.continuity,
        length_mm: motion.length_mm(),
        cycle_time_s,
        limits_proof: drive
            .as_ref()
            .map(|drive| drive.gap().map_or(LimitsProof::Complete, LimitsProof::GapAt)),
        speed,
        acceleration,
        jerk,
        axis_peaks: axis_peaks(job, even),
    };
    Ok(Plan { warnings: report.warnings(), report, samples, toolpath: moves.toolpath })
}

/// The rails of all sections one after the other. A rapid is a line of its own.
fn rails(job: &Job, path: &Path, budget: &Budget) -> Result<Rails, FiveAxisError> {
    let tolerance = job.tolerance();
    let room = |chords: f64| Deviation {
        tip_mm: job.rounding_mm + chords * tolerance.tip_mm,
        axis: chords * tolerance.axis,
    };
    let mut all = Rails { rail: Rail::default(), deviation: Deviation::NONE, n_blends: 0, continuity: 2 };
    for section in path.sections() {
        let stations = &path.stations[section.start..=section.end];
        let is_rapid = path.paces[section.start] == Pace::Rapid;
        let own = match job.method {
            _ if is_rapid => linear::rails(stations),
            Method::Interpolating => {
                smooth::smooth(stations, tolerance, room(CHORDS_AT_CORNERS), false, budget)?
            }
            Method::Tube => smooth::smooth(stations, tolerance, room(CHORDS), true, budget)?,
            Method::Paper => paper::rails(stations, tolerance, budget)?,
            Method::Linear => linear::rails(stations),
        };
        all.deviation = all.deviation.max(own.deviation);
        all.n_blends += own.n_blends;
        all.continuity = if is_rapid { all.continuity } else { all.continuity.min(own.continuity) };
        for mut piece in own.rail.pieces {
            piece.is_rapid = is_rapid;
            for source in &mut piece.sources {
                *source = source.after(section.start);
            }
            let feed = |block: usize| match path.paces[block] {
                Pace::Rapid => job.rapid_feed.mm_per_s(),
                Pace::Feed(feed) => feed.mm_per_s(),
            };
            let slowest = |source: &Source| {
                let [first, last] = source.blocks();
                (first..=last).map(feed).fold(f64::INFINITY, f64::min)
            };
            piece.feeds = piece.sources.iter().map(slowest).collect();
            all.rail.pieces.push(piece);
        }
    }
    all.rail.number();
    Ok(all)
}

fn checked(job: &Job, duration_s: f64) -> Result<(), FiveAxisError> {
    if duration_s / job.period_s > job.sample_limit as f64 {
        return Err(FiveAxisError::TooManySamples { duration_s, limit: job.sample_limit });
    }
    Ok(())
}

/// The motion within limits at times that are a period apart, and its end.
fn driven(job: &Job, drive: &Drive, budget: &Budget) -> Result<Vec<TimedPose>, FiveAxisError> {
    checked(job, drive.duration_s())?;
    let timed = |DrivenSample { sample, joints }: DrivenSample| TimedPose {
        t_s: sample.t_s,
        pose: pose(&sample.at),
        joints,
    };
    Ok(drive.samples(job.period_s, budget)?.into_iter().map(timed).collect())
}

/// The motion at the feed at times that are a period apart, and its end.
fn at_feed(job: &Job, motion: &ConstantFeed, budget: &Budget) -> Result<Vec<TimedPose>, FiveAxisError> {
    let samples = motion.samples(job.period_s, budget)?;
    let poses: Vec<Pose> = samples.iter().map(|sample| pose(&sample.at)).collect();
    let joints = job.machine.as_ref().map(|machine| follow(machine, &poses)).transpose()?;
    let timed = |k: usize| TimedPose {
        t_s: samples[k].t_s,
        pose: poses[k],
        joints: joints.as_ref().map(|joints| joints[k]),
    };
    Ok((0..samples.len()).map(timed).collect())
}

fn axis_peaks(job: &Job, even: &[TimedPose]) -> Vec<(char, [f64; 3])> {
    let Some(machine) = &job.machine else { return Vec::new() };
    let position = |joints: Joints, k: usize| if k < 3 { joints.linear_mm[k] } else { joints.rotary[k - 3] };
    let of = |(k, name): (usize, char)| {
        let along = even.iter().filter_map(|sample| sample.joints);
        let row: Vec<Vector3<f64>> = along.map(|joints| Vector3::x() * position(joints, k)).collect();
        (name, peaks(&row, job.period_s).map(|peak| peak.max))
    };
    machine.axis_names().into_iter().enumerate().map(of).collect()
}
