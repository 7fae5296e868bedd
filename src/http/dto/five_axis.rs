//! The request to smooth a path of five axes, and the report and the samples of the motion.

mod machine;

use nalgebra::{Point3, Unit, UnitVector3, Vector3};
use serde::{Deserialize, Serialize};
use utoipa::openapi::Ref;
use utoipa::{IntoParams, ToSchema};

use super::check::{Range, Violations};
use super::meta::{self, Meta, MetaTexts};
use super::names::into_core;
use super::point::{Coordinates, Point};
use super::schema::{array_of, number, schema_of};
use crate::config::Limits;
use crate::http::decode::{IntoJob, object};
use crate::http::error::{ApiError, FieldCode};
use crate::http::pointer::Pointer;
use crate::machine::{Joints, Machine};
use crate::operations::five_axis as core;
use crate::toolpath::pose::Pose;
use crate::toolpath::units::FeedRate;
pub use machine::{Machines, SentRotary};
use machine::{SentLimits, SentMachine};

/// Default of `top_distance_mm`: the axis of a tool of usual length, mm.
const DEFAULT_TOP_MM: f64 = 50.0;
/// Default of `sample_period_ms`: the period of many controls, ms.
const DEFAULT_PERIOD_MS: f64 = 1.0;
/// Most samples of one motion: five minutes at the default period.
const MAX_SAMPLES: usize = 300_000;

/// Legal values of `tolerance_mm`, of `tolerance_deg` and of `sample_period_ms`.
const TOLERANCE_MM: Range = Range { min: 1e-5, max: 10.0 };
const TOLERANCE_DEG: Range = Range { min: 1e-4, max: 10.0 };
const PERIOD_MS: Range = Range { min: 0.01, max: 1000.0 };
/// The components of a direction.
const COMPONENT: Range = Range { min: -1e6, max: 1e6 };
/// A direction that is shorter is none: nothing is left of it but rounding.
const SHORTEST_DIRECTION: f64 = 1e-6;
/// The fault of such a direction.
const NO_DIRECTION: &str = "a direction of no length; send for example [0, 0, 1]";

/// A path of tool poses to be smoothed.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct SmoothRequest {
    /// The poses of the tool. Between two poses the tip moves on a line, and the axis turns on the great
    /// circle in step with the tip.
    #[schema(value_type = PoseList)]
    path: Vec<SentPose>,
    /// Speed of the tip, in mm/min. Where the tip rests and the axis turns, the top of the tool moves at this
    /// speed.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    feed_mm_per_min: f64,
    /// Largest distance between the smooth path of the tip and the given path, in mm.
    #[schema(minimum = 0.000_01, maximum = 10)]
    tolerance_mm: f64,
    /// Largest angle between the axis and the axis of the given path at the nearest place, in degrees.
    #[schema(minimum = 0.000_1, maximum = 10)]
    tolerance_deg: f64,
    /// Distance from the tip of the tool to its top, in mm. The service smooths the path of the tip and the
    /// path of the top.
    #[schema(minimum = 0.001, maximum = 1_000_000, default = 50)]
    top_distance_mm: Option<f64>,
    /// How the path is smoothed.
    #[serde(default)]
    #[schema(default = "interpolating")]
    method: SmoothMethod,
    /// The machine whose axes move. Samples then hold the positions of the axes. Default: none.
    #[serde(default, deserialize_with = "object::optional")]
    machine: Option<SentMachine>,
    /// Limits of the axes. The motion then starts and ends at rest, stops where it has to, and is as fast as
    /// the limits and the feed allow. Default: none; the feed is constant, without ramps.
    #[serde(default, deserialize_with = "object::optional")]
    limits: Option<SentLimits>,
    /// Time between two samples of the motion, in milliseconds.
    #[schema(minimum = 0.01, maximum = 1000, default = 1)]
    sample_period_ms: Option<f64>,
    /// Up to 32 names with texts of your choice, for example part id, operation and work order. The answer
    /// and the sheet repeat the texts.
    #[schema(value_type = Option<MetaTexts>)]
    meta: Option<Meta>,
}

/// The tool at one place of the path.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = ToolPose)]
pub struct SentPose {
    /// The tip of the tool, in mm.
    #[schema(value_type = Point)]
    tip: Point,
    /// The direction from the tip to the spindle, of any length: three plain numbers without a unit.
    #[schema(value_type = AxisDirection)]
    axis: Coordinates<3>,
}

schema_of!(PoseList, "Poses of a tool.", {
    array_of(Ref::from_schema_name("ToolPose"), 2, Limits::DEFAULT.curve_points)
});

schema_of!(AxisDirection, "A direction `[i, j, k]`: three plain numbers without a unit.", {
    array_of(number(COMPONENT), 3, 3)
});

/// A way to smooth a path.
#[derive(Debug, Clone, Copy, Default, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum SmoothMethod {
    /// Splines through all poses with two continuous derivatives, and blends at corners.
    #[default]
    Interpolating,
    /// The method of Ahn and Jee. It may leave the tolerances; the report says by how much.
    Paper,
    /// The given path, with a stop at every pose.
    Linear,
}

into_core!(SmoothMethod => core::Method, [Interpolating, Paper, Linear]);

/// A request in the core's terms.
#[derive(Debug)]
pub struct SmoothJob {
    pub job: core::Job,
    pub meta: Option<Meta>,
}

impl IntoJob for SmoothRequest {
    type Job = SmoothJob;

    fn into_job(self, limits: &Limits) -> Result<SmoothJob, ApiError> {
        let Self {
            path,
            feed_mm_per_min,
            tolerance_mm,
            tolerance_deg,
            top_distance_mm,
            method,
            machine,
            limits: sent_limits,
            sample_period_ms,
            meta,
        } = self;
        let root = Pointer::root();
        let mut violations = Violations::default();
        let poses = poses(&path, &root.field("path"), limits, &mut violations);
        violations.number(&root.field("feed_mm_per_min"), feed_mm_per_min, Range::POSITIVE, "mm/min");
        violations.number(&root.field("tolerance_mm"), tolerance_mm, TOLERANCE_MM, "mm");
        violations.number(&root.field("tolerance_deg"), tolerance_deg, TOLERANCE_DEG, "degrees");
        violations.optional(&root.field("top_distance_mm"), top_distance_mm, Range::POSITIVE, "mm");
        violations.optional(&root.field("sample_period_ms"), sample_period_ms, PERIOD_MS, "ms");
        let machine = machine.and_then(|sent| sent.convert(&root.field("machine"), &mut violations));
        let motion =
            sent_limits.map(|sent| sent.convert(&root.field("limits"), machine.as_ref(), &mut violations));
        meta::check(meta.as_ref(), &mut violations);
        let Some(feed) = FeedRate::from_mm_per_min(feed_mm_per_min) else {
            return Err(violations.into_error());
        };
        violations.result()?;
        let job = core::Job {
            poses,
            feed,
            tolerance_mm,
            tolerance_axis: tolerance_deg.to_radians(),
            top_mm: top_distance_mm.unwrap_or(DEFAULT_TOP_MM),
            method: method.into(),
            period_s: sample_period_ms.unwrap_or(DEFAULT_PERIOD_MS) * 1e-3,
            machine,
            limits: motion,
            sample_limit: MAX_SAMPLES,
        };
        Ok(SmoothJob { job, meta })
    }
}

/// The poses in the core's terms. Adds violations to `violations`.
fn poses(path: &[SentPose], at: &Pointer, limits: &Limits, violations: &mut Violations) -> Vec<Pose> {
    if !violations.count_of_points(at, path.len(), 2, limits.curve_points) {
        return Vec::new();
    }
    let mut poses = Vec::with_capacity(path.len());
    for (k, SentPose { tip, axis }) in path.iter().enumerate() {
        if !tip.is_legal() {
            tip.check(&at.index(k).field("tip"), violations);
        }
        if let Some(axis) = unit(*axis, &at.index(k).field("axis"), violations) {
            poses.push(Pose { tip: Point3::from(*tip), axis });
        }
    }
    poses
}

/// The unit vector along a sent direction. Adds violations to `violations`.
fn unit(
    Coordinates(sent): Coordinates<3>,
    at: &Pointer,
    violations: &mut Violations,
) -> Option<UnitVector3<f64>> {
    let before = violations.total();
    for (k, component) in sent.into_iter().enumerate() {
        violations.number(&at.index(k), component, COMPONENT, "");
    }
    let unit = Unit::try_new(Vector3::from(sent), SHORTEST_DIRECTION);
    if unit.is_none() {
        violations.add(at, FieldCode::OutOfRange, NO_DIRECTION);
    }
    unit.filter(|_| violations.total() == before)
}

/// What the answer holds besides the report.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct SmoothQuery {
    /// Whether the JSON answer holds the samples of the motion in `samples`. Default: `false`.
    samples: Option<bool>,
}

impl SmoothQuery {
    /// The names of the parameters.
    pub const NAMES: [&'static str; 1] = ["samples"];

    pub fn with_samples(&self) -> bool {
        self.samples.unwrap_or(false)
    }
}

/// What was found about the smooth path.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct SmoothReport {
    /// Number of poses without those that repeat the pose before.
    n_poses: usize,
    /// Number of polynomials that make up the path.
    n_spans: usize,
    /// Number of corners that are rounded by a blend.
    n_blends: usize,
    /// Number of places inside the path where the motion stops: reversals, rotations about a resting tip, and
    /// corners at which no blend keeps the tolerances.
    n_stops: usize,
    /// Proved bound of the distance between the smooth path of the tip and the given path, in mm. For
    /// `method: paper` from the smooth path to the given path only.
    deviation_max_mm: f64,
    /// Proved bound of the angle between the axis of the smooth path and the axis of the given path at the
    /// nearest place, in degrees.
    deviation_max_deg: f64,
    /// Whether both bounds are within the tolerances. Always `true` except for `method: paper`.
    within_tolerance: bool,
    /// Which derivatives by the parameter are continuous between stops: `C0` none, `C2` the first and the
    /// second.
    continuity: Continuity,
    /// Length of the path of the tip, in mm.
    length_mm: f64,
    /// Duration of the motion, in s: the time of the last sample. Without `limits` at the feed everywhere,
    /// without ramps.
    cycle_time_s: f64,
    /// Speed of the tip, in mm/s, by differences of the samples.
    speed: Peaks,
    /// Acceleration of the tip, in mm/s2, by second differences of the samples.
    acceleration: Peaks,
    /// Jerk of the tip, in mm/s3, by third differences of the samples.
    jerk: Peaks,
    /// The largest figures of each axis of the machine, by differences of the samples. Absent without
    /// `machine`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schema(required = false)]
    axis_peaks: Vec<AxisPeaks>,
}

/// The largest figures of one axis.
#[derive(Debug, Clone, Copy, Serialize, ToSchema)]
pub struct AxisPeaks {
    /// The letter of the axis.
    axis: char,
    /// Largest speed, in mm/s, or in degrees by s for a rotary axis.
    speed: f64,
    /// Largest acceleration, in mm/s2, or in degrees by s2 for a rotary axis.
    acceleration: f64,
    /// Largest jerk, in mm/s3, or in degrees by s3 for a rotary axis.
    jerk: f64,
}

impl From<&(char, [f64; 3])> for AxisPeaks {
    fn from((axis, peaks): &(char, [f64; 3])) -> Self {
        let unit = if *axis < 'X' { 1.0_f64.to_degrees() } else { 1.0 };
        let [speed, acceleration, jerk] = peaks.map(|peak| peak * unit);
        Self { axis: *axis, speed, acceleration, jerk }
    }
}

/// How smooth a path is.
#[derive(Debug, Clone, Copy, Serialize, ToSchema)]
pub enum Continuity {
    C0,
    C2,
}

/// A figure of the tip over the whole motion.
#[derive(Debug, Clone, Copy, Serialize, ToSchema)]
pub struct Peaks {
    /// Root of the mean square, in mm/s, mm/s2 or mm/s3.
    rms: f64,
    /// Largest value, in mm/s, mm/s2 or mm/s3.
    max: f64,
}

impl From<core::Peak> for Peaks {
    fn from(core::Peak { rms, max }: core::Peak) -> Self {
        Self { rms, max }
    }
}

impl From<&core::Report> for SmoothReport {
    fn from(report: &core::Report) -> Self {
        let core::Report {
            n_poses,
            n_spans,
            n_blends,
            n_stops,
            deviation_mm,
            deviation_axis,
            is_within_tolerance,
            continuity,
            length_mm,
            cycle_time_s,
            speed,
            acceleration,
            jerk,
            axis_peaks,
        } = report;
        Self {
            n_poses: *n_poses,
            n_spans: *n_spans,
            n_blends: *n_blends,
            n_stops: *n_stops,
            deviation_max_mm: *deviation_mm,
            deviation_max_deg: deviation_axis.to_degrees(),
            within_tolerance: *is_within_tolerance,
            continuity: if *continuity == 0 { Continuity::C0 } else { Continuity::C2 },
            length_mm: *length_mm,
            cycle_time_s: *cycle_time_s,
            speed: (*speed).into(),
            acceleration: (*acceleration).into(),
            jerk: (*jerk).into(),
            axis_peaks: axis_peaks.iter().map(AxisPeaks::from).collect(),
        }
    }
}

/// The tool at one time.
#[derive(Debug, Clone, Copy, Serialize, ToSchema)]
#[schema(as = MotionSample)]
pub struct Sample {
    /// Time since the start, in s.
    t_s: f64,
    /// The tip of the tool, in mm.
    #[schema(value_type = Point)]
    tip: Point,
    /// The direction from the tip to the spindle, of length 1: three plain numbers without a unit.
    #[schema(value_type = AxisDirection)]
    axis: Coordinates<3>,
    /// The positions of the axes of the machine. Absent without `machine`.
    #[serde(skip_serializing_if = "Option::is_none")]
    joints: Option<AxisPositions>,
}

/// The positions of the axes of a machine. An axis that the machine does not have is absent.
#[derive(Debug, Clone, Copy, Default, Serialize, ToSchema)]
pub struct AxisPositions {
    /// Position of X, in mm.
    #[serde(rename = "X")]
    x: f64,
    /// Position of Y, in mm.
    #[serde(rename = "Y")]
    y: f64,
    /// Position of Z, in mm.
    #[serde(rename = "Z")]
    z: f64,
    /// Angle of A, in degrees.
    #[serde(rename = "A", skip_serializing_if = "Option::is_none")]
    a: Option<f64>,
    /// Angle of B, in degrees.
    #[serde(rename = "B", skip_serializing_if = "Option::is_none")]
    b: Option<f64>,
    /// Angle of C, in degrees.
    #[serde(rename = "C", skip_serializing_if = "Option::is_none")]
    c: Option<f64>,
}

impl AxisPositions {
    fn new(machine: &Machine, joints: &Joints) -> Self {
        let [x, y, z] = joints.linear_mm;
        let angle = |letter: char| {
            let k = machine.rotary().iter().position(|axis| axis.name == letter)?;
            Some(machine.rotary()[k].shown(joints.rotary[k]).to_degrees())
        };
        Self { x, y, z, a: angle('A'), b: angle('B'), c: angle('C') }
    }
}

impl Sample {
    pub fn new(sample: &core::TimedPose, machine: Option<&Machine>) -> Self {
        let core::TimedPose { t_s, pose: Pose { tip, axis }, joints } = sample;
        Self {
            t_s: *t_s,
            tip: (*tip).into(),
            axis: Coordinates(axis.into_inner().into()),
            joints: machine.zip(joints.as_ref()).map(|(machine, joints)| AxisPositions::new(machine, joints)),
        }
    }
}

/// The members of the answer beside the report.
#[derive(Default, Serialize, ToSchema)]
pub struct SampleMembers {
    /// The motion at times that are `sample_period_ms` apart; the last step may be shorter. Present with
    /// `?samples=true`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub samples: Option<Vec<Sample>>,
}
