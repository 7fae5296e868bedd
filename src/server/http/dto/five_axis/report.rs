//! The report and the samples of the motion along a smooth path.

use serde::{Deserialize, Serialize};
use utoipa::openapi::RefOr;
use utoipa::openapi::schema::Schema;
use utoipa::{IntoParams, PartialSchema, ToSchema};

use crate::http::decode::query::{FromQuery, Parameters};
use crate::http::dto::answer::{PathMembers, joined};
use crate::http::dto::axis::{AxisDirection, components};
use crate::http::dto::point::{Coordinates, Point};
use toolpathd_core::machine::{Joints, Machine};
use toolpathd_core::operations::five_axis as core;
use toolpathd_core::toolpath::pose::Pose;

/// What the answer holds besides the report.
#[derive(Debug, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct SmoothQuery {
    /// Whether the JSON answer holds the samples of the motion in `samples`. Default: `false`.
    samples: Option<bool>,
    /// What an answer of `image/svg+xml` shows: the path, or the motion over time. `text/html` shows both.
    /// Default: `path`.
    #[param(inline, required = false)]
    picture: Option<SmoothPicture>,
}

/// A picture of a smooth path.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum SmoothPicture {
    /// The smooth path and the given path in three views.
    Path,
    /// Feed, acceleration and jerk of the tip and the angles of the axes over time, before and after.
    Motion,
}

impl FromQuery for SmoothQuery {
    const NAMES: &'static [&'static str] = &["samples", "picture"];

    fn read(sent: &Parameters) -> Result<Self, String> {
        Ok(Self { samples: sent.flag("samples")?, picture: sent.name("picture")? })
    }
}

impl SmoothQuery {
    pub fn with_samples(&self) -> bool {
        self.samples.unwrap_or(false)
    }

    pub fn shows_motion(&self) -> bool {
        self.picture == Some(SmoothPicture::Motion)
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
    /// Proved bound of the distance between the moves of `toolpath` and the given path, in mm, before the
    /// program's decimals round them.
    toolpath_deviation_max_mm: f64,
    /// Proved bound of the angle between the axis of the moves and the axis of the given path at the nearest
    /// place, in degrees.
    toolpath_deviation_max_deg: f64,
    /// Proved bound of the distance between the surface that the tool cuts along `toolpath` and the surface
    /// that it cuts along the given path, in mm. It is `toolpath_deviation_max_mm`, plus the angle
    /// `toolpath_deviation_max_deg` in radians times the distance from the tip to the centre of the tool's
    /// rounded corner. Absent without `tool`.
    #[serde(skip_serializing_if = "Option::is_none")]
    cut_deviation_max_mm: Option<f64>,
    /// Which derivatives by the parameter are continuous between stops: `C0` none, `C2` the first and the
    /// second.
    continuity: Continuity,
    /// Length of the path of the tip, in mm.
    length_mm: f64,
    /// Duration of the motion, in s: the time of the last sample. Without `limits` at the feed everywhere,
    /// without ramps.
    cycle_time_s: f64,
    /// Whether every limit is proved to be kept at every time of the motion. `false` only where the tool axis
    /// passes a pole of the machine. Absent without `limits`.
    #[serde(skip_serializing_if = "Option::is_none")]
    limits_proved: Option<bool>,
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
            moves_deviation_mm,
            moves_deviation_axis,
            cut_deviation_mm,
            continuity,
            length_mm,
            cycle_time_s,
            limits_proof,
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
            toolpath_deviation_max_mm: *moves_deviation_mm,
            toolpath_deviation_max_deg: moves_deviation_axis.to_degrees(),
            cut_deviation_max_mm: *cut_deviation_mm,
            continuity: if *continuity == 0 { Continuity::C0 } else { Continuity::C2 },
            length_mm: *length_mm,
            cycle_time_s: *cycle_time_s,
            limits_proved: limits_proof.map(|proof| proof == core::LimitsProof::Complete),
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
            axis: components(axis),
            joints: machine.zip(joints.as_ref()).map(|(machine, joints)| AxisPositions::new(machine, joints)),
        }
    }
}

/// The members of the answer without the report: the members of every answer with a toolpath, and `samples`.
#[derive(Serialize)]
pub struct SmoothMembers {
    #[serde(flatten)]
    pub path: PathMembers,
    #[serde(flatten)]
    pub motion: SampleMembers,
}

/// The samples of the motion.
#[derive(Serialize, ToSchema)]
pub struct SampleMembers {
    /// The motion at times that are `sample_period_ms` apart; the last step may be shorter. Present with
    /// `?samples=true`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub samples: Option<Vec<Sample>>,
}

impl PartialSchema for SmoothMembers {
    fn schema() -> RefOr<Schema> {
        joined([PathMembers::schema(), SampleMembers::schema()])
    }
}

impl ToSchema for SmoothMembers {
    fn schemas(schemas: &mut Vec<(String, RefOr<Schema>)>) {
        PathMembers::schemas(schemas);
        SampleMembers::schemas(schemas);
    }
}
