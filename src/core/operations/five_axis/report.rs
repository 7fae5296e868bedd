//! What is found about a smooth path, and what to know before its motion runs.

use nalgebra::Point3;

use super::Job;
use super::motion::Peaks;
use crate::toolpath::units::rounded_up;

/// Something to know before the motion runs, which does not stop the job.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Warning {
    #[error("the method leaves the tolerances: up to {:.4} mm and {:.4} degrees from the given path", rounded_up(*deviation_mm), rounded_up(*deviation_deg))]
    ToleranceExceeded { deviation_mm: f64, deviation_deg: f64 },
    #[error(
        "near {at} mm the tool axis passes a pole of the machine, where the limits of the axes are checked but not proved; lean the axis a little there"
    )]
    LimitsNotProved { at: Point3<f64> },
    #[error("the program may be up to {:.4} mm from the given path, beyond the tolerance", rounded_up(*deviation_mm))]
    RoundingExceedsTolerance { deviation_mm: f64 },
    #[error(
        "the motion takes {cycle_time_s:.3} s, {:.2} times the proved lower bound of {lower_bound_s:.3} s: the limits of jerk slow it down inside the path, which the bound leaves out of account, or a faster motion was not found", cycle_time_s / lower_bound_s
    )]
    AboveLowerBound { cycle_time_s: f64, lower_bound_s: f64 },
}

/// A duration above this multiple of its lower bound is a warning.
const ABOVE_BOUND: f64 = 1.05;

/// What was found about the smooth path.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, utoipa::ToSchema), schema(as = SmoothReport))]
pub struct Report {
    /// Number of poses without those that are the pose before within a twentieth of the tolerances.
    pub n_poses: usize,
    /// Number of polynomials that make up the path.
    pub n_spans: usize,
    /// Number of corners that are rounded by a blend.
    pub n_blends: usize,
    /// Number of places inside the path where the motion stops: reversals, rotations about a resting tip, and
    /// corners at which no blend keeps the tolerances.
    pub n_stops: usize,
    /// Number of times that the path is led through a pole of the machine, where a rotary axis has no angle
    /// of its own: the tool axis leans onto the pole, within the tolerance.
    pub n_through_poles: usize,
    /// Number of times that the path is led around a pole of the machine, at a distance from it.
    pub n_around_poles: usize,
    /// Proved bound of the distance between the smooth path of the tip and the given path, in mm. For
    /// `method: paper` from the smooth path to the given path only.
    pub deviation_max_mm: f64,
    /// Proved bound of the angle between the axis of the smooth path and the axis of the given path at the
    /// nearest place, in degrees.
    pub deviation_max_deg: f64,
    /// Whether both bounds are within the tolerances. Always `true` except for `method: paper`.
    pub within_tolerance: bool,
    /// Proved bound of the distance between the moves of `toolpath` and the given path, in mm, before the
    /// program's decimals round them.
    pub toolpath_deviation_max_mm: f64,
    /// Proved bound of the angle between the axis of the moves and the axis of the given path at the nearest
    /// place, in degrees.
    pub toolpath_deviation_max_deg: f64,
    /// Proved bound of the distance between the surface that the tool cuts along `toolpath` and the surface
    /// that it cuts along the given path, in mm. It is `toolpath_deviation_max_mm`, plus the angle
    /// `toolpath_deviation_max_deg` in radians times the distance from the tip to the centre of the tool's
    /// rounded corner. Absent without `tool`.
    #[cfg_attr(feature = "wire", serde(skip_serializing_if = "Option::is_none"))]
    pub cut_deviation_max_mm: Option<f64>,
    /// Which derivatives by the parameter are continuous between stops: `C0` none, `C2` the first and the
    /// second.
    pub continuity: Continuity,
    /// Length of the path of the tip, in mm.
    pub length_mm: f64,
    /// Duration of the motion, in s: the time of the last sample. Without `limits` at the feed everywhere,
    /// without ramps.
    pub cycle_time_s: f64,
    /// Proved lower bound of the duration, in s: no motion along the smooth path within the limits, with the
    /// same stops, is faster. Jerk counts only at the stops: where it slows the motion down elsewhere, the
    /// bound is too low. Absent without `limits`.
    #[cfg_attr(feature = "wire", serde(skip_serializing_if = "Option::is_none"))]
    pub cycle_time_lower_bound_s: Option<f64>,
    /// Whether every limit is proved to be kept at every time of the motion. `false` only where the tool axis
    /// passes a pole of the machine and is not led through it, as with `method: paper`. Absent without
    /// `limits`.
    #[cfg_attr(feature = "wire", serde(skip_serializing_if = "Option::is_none"))]
    pub limits_proved: Option<bool>,
    /// Speed of the tip, in mm/s, by differences of the samples.
    pub speed: Peaks,
    /// Acceleration of the tip, in mm/s2, by second differences of the samples.
    pub acceleration: Peaks,
    /// Jerk of the tip, in mm/s3, by third differences of the samples.
    pub jerk: Peaks,
    /// The largest figures of each axis of the machine, by differences of the samples. Absent without
    /// `machine`.
    #[cfg_attr(feature = "wire", serde(skip_serializing_if = "Vec::is_empty"), schema(required = false))]
    pub axis_peaks: Vec<AxisPeaks>,
}

impl Report {
    pub(super) fn warnings(&self, limits_unproved_at: Option<Point3<f64>>) -> Vec<Warning> {
        let &Self { deviation_max_mm: deviation_mm, deviation_max_deg: deviation_deg, .. } = self;
        let exceeded = Warning::ToleranceExceeded { deviation_mm, deviation_deg };
        let unproved = limits_unproved_at.map(|at| Warning::LimitsNotProved { at });
        let slow = self.cycle_time_lower_bound_s.filter(|bound| self.cycle_time_s > ABOVE_BOUND * bound);
        let cycle_time_s = self.cycle_time_s;
        let slow = slow.map(|lower_bound_s| Warning::AboveLowerBound { cycle_time_s, lower_bound_s });
        (!self.within_tolerance).then_some(exceeded).into_iter().chain(unproved).chain(slow).collect()
    }

    /// The warning that rounding, and straying between legs, may take the program of `job` out of the
    /// tolerance.
    pub fn warning_of_program(&self, job: &Job) -> Option<Warning> {
        let deviation_mm =
            self.cut_deviation_max_mm.unwrap_or(self.toolpath_deviation_max_mm) + job.rounding_mm;
        let is_beyond = self.within_tolerance && deviation_mm > job.tolerance_mm;
        is_beyond.then_some(Warning::RoundingExceedsTolerance { deviation_mm })
    }
}

/// The largest figures of one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, utoipa::ToSchema))]
pub struct AxisPeaks {
    /// The letter of the axis.
    pub axis: char,
    /// Largest speed, in mm/s, or in degrees by s for a rotary axis.
    pub speed: f64,
    /// Largest acceleration, in mm/s2, or in degrees by s2 for a rotary axis.
    pub acceleration: f64,
    /// Largest jerk, in mm/s3, or in degrees by s3 for a rotary axis.
    pub jerk: f64,
}

/// How smooth a path is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, utoipa::ToSchema))]
pub enum Continuity {
    C0,
    C2,
}
