//! Smooths a path of five axes: tips and tool axes on rails, within tolerances (Ahn, Jee).
//!
//! # Method
//! 1. The path is cleaned: poses that are one within a small part of the tolerance become one, and so do
//!    turns about one tip (`cleaning`). Where its axis comes within the tolerance of a pole of the machine,
//!    it is led through the pole or around it (`poles`).
//! 2. The method makes rails: polynomials of one parameter for the tip and the top of the tool
//!    (`smooth`, `tube`, `paper`, `linear`; `blend` around corners, `rotation` where the tip rests).
//! 3. Each span is proved against the legs that it replaces (`deviation`).
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
//! * The first and the last tip are hit exactly, and so are their axes, unless they are within the tolerance
//!   of a pole of the machine.
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

mod banded_matrix;
mod blend;
mod cleaning;
mod deviation;
mod drive;
pub mod history;
mod job;
mod leg;
mod linear;
mod motion;
mod moves;
mod paper;
mod passage;
mod path;
mod poles;
mod rail;
mod report;
mod rotation;
mod roughness;
pub mod schedule;
mod smooth;
mod stations;
#[cfg(test)]
mod tests;
mod tube;

use nalgebra::{Point3, Vector3};

use crate::budget::{Budget, Progress, Stopped};
use crate::machine::{AxisPositions, FollowError};
use crate::toolpath::pose::{Pace, Pose};
use crate::toolpath::{PathError, Toolpath};
use deviation::Deviation;
pub use drive::MotionLimits;
use drive::{Drive, DrivenSample};
pub use job::{AtPole, DEFAULT_PERIOD_S, DEFAULT_RETRACT_MM, DEFAULT_TOP_MM, Job, Method};
pub use motion::Peaks;
use motion::{ConstantFeed, Sample, peaks};
pub use moves::CHORDS;
use moves::CHORDS_AT_CORNERS;
use path::Path;
use rail::{Rail, Source};
pub use report::{AxisPeaks, Continuity, Report, Warning};
use schedule::ScheduleError;
use stations::{Followed, pose};

/// The tool at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimedPose {
    pub t_s: f64,
    pub pose: Pose,
    /// The positions of the axes, if there is a machine.
    pub joints: Option<AxisPositions>,
}

#[derive(Debug, Clone)]
pub struct Plan {
    pub report: Report,
    /// All `period_s` apart; the last step may be shorter.
    pub samples: Vec<TimedPose>,
    pub period_s: f64,
    /// Straight moves along the smooth path.
    pub toolpath: Toolpath,
    /// For each move of the toolpath the time of the motion at its end, s. The ways in and out take no time
    /// of the motion.
    pub move_ends_s: Vec<f64>,
    pub warnings: Vec<Warning>,
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
    continuity: Continuity,
}

/// Smooths the path.
///
/// # Errors
/// One of [`FiveAxisError`].
///
/// # Example
/// The tip runs 100 mm straight on at 3,000 mm/min while the axis leans to 30 degrees.
///
/// ```
/// use nalgebra::{Point3, UnitVector3, Vector3};
/// use toolpathd_core::budget::Budget;
/// use toolpathd_core::operations::five_axis::{Job, plan};
/// use toolpathd_core::toolpath::pose::{Pace, Pose, Waypoint};
/// use toolpathd_core::toolpath::units::FeedRate;
///
/// let pace = Pace::Feed(FeedRate::from_mm_per_min(3000.0).unwrap());
/// let pose = |part: f64| {
///     let lean = part * 30_f64.to_radians();
///     let axis = UnitVector3::new_normalize(Vector3::new(lean.sin(), 0.0, lean.cos()));
///     Pose { tip: Point3::new(100.0 * part, 0.0, 0.0), axis }
/// };
/// let path = (0..=10).map(|k| Waypoint::new(pose(f64::from(k) / 10.0), pace)).collect();
/// let plan = plan(&Job::new(path, 0.01, 0.1_f64.to_radians()), &Budget::unlimited()).unwrap();
/// assert!(plan.report.within_tolerance);
/// assert!((plan.report.length_mm - 100.0).abs() < 0.01 && (plan.report.cycle_time_s - 2.0).abs() < 0.01);
/// assert!((plan.samples.last().unwrap().pose.tip - pose(1.0).tip).norm() < 1e-9);
/// ```
pub fn plan(job: &Job, budget: &Budget) -> Result<Plan, FiveAxisError> {
    match plan_past_poles(job, job.at_pole != AtPole::Around, "smoothing", budget) {
        // Where the travel of an axis ends at the pole, the path goes around it.
        Err(error @ (FiveAxisError::OnPole { .. } | FiveAxisError::NotFollowed { .. }))
            if job.at_pole == AtPole::Quickest =>
        {
            plan_past_poles(job, false, "around poles", budget).map_err(|_| error)
        }
        found => found,
    }
}

/// The steps of a plan that are told: rails, limits, samples and moves.
const STEPS: usize = 4;

/// The plan whose path goes through poles, or around them. `stage` names it in progress.
fn plan_past_poles(
    job: &Job,
    may_cross: bool,
    stage: &'static str,
    budget: &Budget,
) -> Result<Plan, FiveAxisError> {
    let progress = Progress::new(stage, STEPS);
    let path = path(job, may_cross)?;
    let rails = rails(job, &path, budget)?;
    progress.tell_one(budget);
    let motion = ConstantFeed::new(&rails.rail);
    // No motion within limits is faster.
    job.period_s(motion.duration_s())?;
    let machine = job.machine.as_ref();
    let drive = job
        .limits
        .as_ref()
        .map(|limits| Drive::new(&rails.rail, machine.map(|own| (own, job.start())), limits, budget));
    let drive = drive.transpose()?;
    progress.tell_one(budget);
    let followed = machine
        .filter(|_| drive.is_none())
        .map(|machine| Followed::new(&rails.rail, machine, job.start(), budget))
        .transpose()?;
    let period_s = job.period_s(drive.as_ref().map_or(motion.duration_s(), Drive::duration_s))?;
    let samples = match &drive {
        Some(drive) => driven(drive, period_s, budget)?,
        None => at_feed(followed.as_ref(), &motion, period_s, budget)?,
    };
    progress.tell_one(budget);
    let moves = moves::moves(
        job,
        &path,
        &rails,
        moves::Along { feeding: &motion, drive: drive.as_ref(), followed: followed.as_ref() },
        budget,
    )?;
    progress.tell_one(budget);
    let cycle_time_s = samples[samples.len() - 1].t_s;
    // The last step may be shorter.
    let even = &samples[..samples.len() - 1];
    let tips: Vec<Vector3<f64>> = even.iter().map(|sample| sample.pose.tip.coords).collect();
    let [speed, acceleration, jerk] = peaks(&tips, period_s);
    let deviation = rails.deviation.plus(path.moved);
    let report = Report {
        n_poses: path.n_poses,
        n_spans: rails.rail.spans().count(),
        n_blends: rails.n_blends,
        n_stops: rails.rail.pieces.len() - 1,
        n_through_poles: path.passed.through,
        n_around_poles: path.passed.around,
        deviation_max_mm: deviation.tip_mm,
        deviation_max_deg: deviation.axis.to_degrees(),
        within_tolerance: deviation.of(job.tolerance()) <= 1.0,
        toolpath_deviation_max_mm: moves.deviation.tip_mm,
        toolpath_deviation_max_deg: moves.deviation.axis.to_degrees(),
        cut_deviation_max_mm: (job.swing_mm > 0.0)
            .then_some(moves.deviation.tip_mm + job.swing_mm * moves.deviation.axis),
        continuity: rails.continuity,
        length_mm: motion.length_mm(),
        cycle_time_s,
        cycle_time_lower_bound_s: drive.as_ref().map(Drive::least_time_s),
        limits_proved: drive.as_ref().map(|drive| drive.gap().is_none()),
        speed,
        acceleration,
        jerk,
        axis_peaks: axis_peaks(job, even, period_s),
    };
    let limits_unproved_at = drive.as_ref().and_then(Drive::gap);
    let warnings = report.warnings(limits_unproved_at);
    Ok(Plan { warnings, report, samples, period_s, toolpath: moves.toolpath, move_ends_s: moves.ends_s })
}

/// The given path, cleaned and led past poles within parts of the tolerance. The method of the paper takes it
/// as it is.
fn path(job: &Job, may_cross: bool) -> Result<Path, FiveAxisError> {
    if job.method == Method::Paper {
        return Path::new(&job.path, job.top_mm, Deviation::NONE);
    }
    let tolerance = job.tolerance();
    let mut path = Path::new(&job.path, job.top_mm, tolerance)?;
    if let Some(machine) = &job.machine {
        let poles: Vec<_> = machine.poles().collect();
        let way = poles::Way { may_cross, has_limits: job.limits.is_some() };
        poles::lead(&mut path, &poles, tolerance.axis, way);
        path.rooms = poles::rooms(&path, &poles);
        if job.at_pole == AtPole::Refuse
            && let Some(at) = path.passed.at
        {
            return Err(FiveAxisError::OnPole { at });
        }
    }
    Ok(path)
}

/// The rails of all sections one after the other. A rapid is a line of its own.
fn rails(job: &Job, path: &Path, budget: &Budget) -> Result<Rails, FiveAxisError> {
    let tolerance = job.tolerance().without(path.moved);
    let part = |chords: f64| Deviation {
        tip_mm: job.rounding_mm + chords * tolerance.tip_mm,
        axis: chords * tolerance.axis,
    };
    let in_tube = part(CHORDS);
    let at_corners = if job.method == Method::Tube { in_tube } else { part(CHORDS_AT_CORNERS) };
    let room = smooth::Room { at_corners, in_tube };
    let mut all =
        Rails { rail: Rail::default(), deviation: Deviation::NONE, n_blends: 0, continuity: Continuity::C2 };
    for section in path.sections() {
        let stations = &path.stations[section.start..=section.end];
        let stretch = smooth::Stretch {
            stations,
            on_pole: &path.on_pole[section.start..=section.end],
            rooms: &path.rooms[section.clone()],
        };
        let is_rapid = path.paces[section.start] == Pace::Rapid;
        let own = match job.method {
            _ if is_rapid => linear::rails(stations),
            Method::Interpolating => smooth::smooth(&stretch, tolerance, room, false, budget)?,
            Method::Tube => smooth::smooth(&stretch, tolerance, room, true, budget)?,
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
            let feed = |leg: usize| match path.paces[leg] {
                Pace::Rapid => job.rapid_feed.mm_per_s(),
                Pace::Feed(feed) => feed.mm_per_s(),
            };
            let slowest = |source: &Source| {
                let [first, last] = source.legs();
                (first..=last).map(feed).fold(f64::INFINITY, f64::min)
            };
            piece.feeds = piece.sources.iter().map(slowest).collect();
            all.rail.pieces.push(piece);
        }
    }
    all.rail.number();
    Ok(all)
}

/// The motion within limits at times that are a period apart, and its end.
fn driven(drive: &Drive, period_s: f64, budget: &Budget) -> Result<Vec<TimedPose>, FiveAxisError> {
    let timed = |DrivenSample { t_s, at, joints }: DrivenSample| TimedPose { t_s, pose: pose(&at), joints };
    Ok(drive.samples(period_s, budget)?.into_iter().map(timed).collect())
}

/// The motion at the feed at times that are a period apart, and its end.
fn at_feed(
    followed: Option<&Followed>,
    motion: &ConstantFeed,
    period_s: f64,
    budget: &Budget,
) -> Result<Vec<TimedPose>, FiveAxisError> {
    let timed = |Sample { t_s, piece, u, at }: &Sample| TimedPose {
        t_s: *t_s,
        pose: pose(at),
        joints: followed.map(|followed| followed.at(*piece, *u)),
    };
    Ok(motion.samples(period_s, budget)?.iter().map(timed).collect())
}

fn axis_peaks(job: &Job, even: &[TimedPose], period_s: f64) -> Vec<AxisPeaks> {
    let Some(machine) = &job.machine else { return Vec::new() };
    let position =
        |joints: AxisPositions, k: usize| if k < 3 { joints.linear_mm[k] } else { joints.rotary[k - 3] };
    let of = |(k, axis): (usize, char)| {
        let unit = if k < 3 { 1.0 } else { 1.0_f64.to_degrees() };
        let along = even.iter().filter_map(|sample| sample.joints);
        let row: Vec<Vector3<f64>> = along.map(|joints| Vector3::x() * position(joints, k)).collect();
        let [speed, acceleration, jerk] = peaks(&row, period_s).map(|peaks| peaks.max * unit);
        AxisPeaks { axis, speed, acceleration, jerk }
    };
    machine.axis_names().into_iter().enumerate().map(of).collect()
}
