//! The samples of the motion along a smooth path, and the query that asks for them.

use serde::{Deserialize, Serialize};
use utoipa::openapi::RefOr;
use utoipa::openapi::schema::Schema;
use utoipa::{IntoParams, PartialSchema, ToSchema};

use crate::http::decode::query::{FromQuery, Parameters};
use crate::http::dto::answer::{PathMembers, joined};
use crate::http::dto::axis::{AxisDirection, components};
use crate::http::dto::point::{Coordinates, Point};
use toolpathd_core::machine::{AxisPositions, Machine};
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
    joints: Option<NamedAxisPositions>,
}

/// The positions of the axes of a machine. An axis that the machine does not have is absent.
#[derive(Debug, Clone, Copy, Default, Serialize, ToSchema)]
#[schema(as = AxisPositions)]
pub struct NamedAxisPositions {
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

impl NamedAxisPositions {
    fn new(machine: &Machine, joints: &AxisPositions) -> Self {
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
            joints: machine
                .zip(joints.as_ref())
                .map(|(machine, joints)| NamedAxisPositions::new(machine, joints)),
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
