//! The smoothing job: path, tolerances, method, and the machine with its limits.

use super::FiveAxisError;
use super::deviation::Deviation;
use super::drive::MotionLimits;
use crate::machine::{Machine, Straying};
use crate::toolpath::pose::Waypoint;
use crate::toolpath::units::FeedRate;

/// The distance from the tip to the top where none is given, mm: the axis of a tool of usual length.
pub const DEFAULT_TOP_MM: f64 = 50.0;

/// The way along the tool axis before and after the path where none is given, mm.
pub const DEFAULT_RETRACT_MM: f64 = 20.0;

/// The time between samples where none is given, s: the period of many controls.
pub const DEFAULT_PERIOD_S: f64 = 1e-3;

/// The most samples and the most moves of a job whose caller sets no limits.
const DEFAULT_SAMPLE_LIMIT: usize = 1_000_000;
const DEFAULT_MOVE_LIMIT: usize = 500_000;

/// Samples that nobody asks for, at most. More would not change the figures that are made of them.
const ENOUGH_SAMPLES: usize = 100_000;

/// The part of the tolerance of the cut that turns of the axis may use.
const SHARE_OF_AXIS: f64 = 0.25;

/// A way to smooth a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "wire", derive(serde::Deserialize, utoipa::ToSchema), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "wire", schema(as = SmoothMethod))]
pub enum Method {
    /// Splines through all poses with two continuous derivatives, and blends at corners.
    #[default]
    Interpolating,
    /// Splines of few pieces and of the least jerk within the tolerances, with four continuous derivatives,
    /// and blends at corners. For data with noise, and for rounded data.
    Tube,
    /// The method of Ahn and Jee, as printed but for its misprints. It may leave the tolerances.
    Paper,
    /// The given path, with a stop at every pose.
    Linear,
}

/// What a path does where its axis comes within the tolerance of a pole of the machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "wire", derive(serde::Deserialize, utoipa::ToSchema), serde(rename_all = "snake_case"))]
pub enum AtPole {
    /// Goes through the pole, and around it where the machine cannot go through.
    #[default]
    Quickest,
    /// Goes through the pole: the axis leans onto it, and no rotary axis turns far.
    Through,
    /// Goes around the pole, by up to half a turn of a rotary axis.
    Around,
    /// Is refused.
    Refuse,
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
    /// What the path does at poles of the machine.
    pub at_pole: AtPole,
    /// The limits of the axes. Without limits the feed is constant, and nothing accelerates.
    pub limits: Option<MotionLimits>,
    pub period_s: f64,
    /// The most samples.
    pub sample_limit: usize,
    /// Whether the samples themselves are asked for. Otherwise, they are only what figures and pictures are
    /// made of, and are farther apart where there would be too many.
    pub wants_samples: bool,
    /// The most moves.
    pub move_limit: usize,
    /// The way along the tool axis to the first pose, and away from the last pose, mm. There is none where
    /// the first pose is reached by a rapid, and where the path ends with a rapid.
    pub retract_mm: f64,
    /// How far the tool may stray from the moves of the toolpath while the axes of the machine move in step
    /// from end to end. The toolpath then holds the positions of the rotary axes, and none for `None`.
    pub in_step: Option<Straying>,
    /// What writing a program moves the tip, mm: rounding, and straying between legs. Blends at corners
    /// leave it room.
    pub rounding_mm: f64,
}

impl Job {
    /// The job with the default of everything that has one: the rails alone, without tool and machine, and
    /// not rounded to the decimals of a program. `tolerance_axis` is in radians.
    pub fn new(path: Vec<Waypoint>, tolerance_mm: f64, tolerance_axis: f64) -> Self {
        Self {
            path,
            rapid_feed: FeedRate::DEFAULT_RAPID,
            tolerance_mm,
            tolerance_axis,
            swing_mm: 0.0,
            top_mm: DEFAULT_TOP_MM,
            method: Method::default(),
            machine: None,
            at_pole: AtPole::default(),
            limits: None,
            period_s: DEFAULT_PERIOD_S,
            sample_limit: DEFAULT_SAMPLE_LIMIT,
            wants_samples: true,
            move_limit: DEFAULT_MOVE_LIMIT,
            retract_mm: DEFAULT_RETRACT_MM,
            in_step: None,
            rounding_mm: 0.0,
        }
    }

    /// The angles of the rotary axes at the first pose, radians: zeros if they are not stated.
    pub(super) fn start(&self) -> [f64; 2] {
        self.path.first().and_then(|first| first.rotary).unwrap_or_default()
    }

    /// The time between two samples of a motion.
    ///
    /// # Errors
    /// If the samples are asked for and there are too many.
    pub(super) fn period_s(&self, duration_s: f64) -> Result<f64, FiveAxisError> {
        let limit = self.sample_limit;
        if !self.wants_samples {
            return Ok(self.period_s.max(duration_s / limit.min(ENOUGH_SAMPLES) as f64));
        }
        if duration_s / self.period_s > limit as f64 {
            return Err(FiveAxisError::TooManySamples { duration_s, limit });
        }
        Ok(self.period_s)
    }

    /// The tolerances of tip and axis. What a turn moves the cut is taken from the tolerance of the tip.
    pub(super) fn tolerance(&self) -> Deviation {
        let turns = self.path.windows(2).any(|pair| pair[0].pose.axis != pair[1].pose.axis);
        let swing_mm = if turns { self.swing_mm } else { 0.0 };
        let axis = self.tolerance_axis.min(SHARE_OF_AXIS * self.tolerance_mm / swing_mm);
        Deviation { tip_mm: self.tolerance_mm - swing_mm * axis, axis }
    }
}
