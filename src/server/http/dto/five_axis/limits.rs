//! The limits of the axes of a machine and of the tip, in requests.

use serde::Deserialize;
use utoipa::ToSchema;

use crate::http::decode::object;
use crate::http::dto::check::{Range, Violations};
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;
use toolpathd_core::machine::Machine;
use toolpathd_core::operations::five_axis::MotionLimits;
use toolpathd_core::operations::five_axis::schedule::{Limits, TipLimits};

/// Legal limits of speed, acceleration and jerk. A larger one is none.
const LIMIT: Range = Range { min: 1e-3, max: 1e9 };

/// The limits of the axes of a machine, and of the tip of the tool. An axis without limits is as fast as it
/// has to be. Without a machine, X, Y and Z are the coordinates of the tip.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = MotionLimits)]
pub struct SentLimits {
    /// Limits of X. Default: none.
    #[serde(rename = "X", default, deserialize_with = "object::optional")]
    x: Option<SentAxisLimits>,
    /// Limits of Y. Default: none.
    #[serde(rename = "Y", default, deserialize_with = "object::optional")]
    y: Option<SentAxisLimits>,
    /// Limits of Z. Default: none.
    #[serde(rename = "Z", default, deserialize_with = "object::optional")]
    z: Option<SentAxisLimits>,
    /// Limits of the rotary axis A. Default: none.
    #[serde(rename = "A", default, deserialize_with = "object::optional")]
    a: Option<SentAxisLimits>,
    /// Limits of the rotary axis B. Default: none.
    #[serde(rename = "B", default, deserialize_with = "object::optional")]
    b: Option<SentAxisLimits>,
    /// Limits of the rotary axis C. Default: none.
    #[serde(rename = "C", default, deserialize_with = "object::optional")]
    c: Option<SentAxisLimits>,
    /// Limits of the tip in the frame of the workpiece. Its speed is `feed_mm_per_min`. Default: none.
    #[serde(default, deserialize_with = "object::optional")]
    tip: Option<SentTipLimits>,
}

/// The limits of one axis. Each may be absent.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = AxisLimits)]
pub struct SentAxisLimits {
    /// Largest speed, in mm/s, or in degrees by s for a rotary axis. Default: none.
    #[schema(minimum = 0.001, maximum = 1_000_000_000)]
    speed: Option<f64>,
    /// Largest acceleration, in mm/s2, or in degrees by s2 for a rotary axis. Default: none.
    #[schema(minimum = 0.001, maximum = 1_000_000_000)]
    acceleration: Option<f64>,
    /// Largest jerk, in mm/s3, or in degrees by s3 for a rotary axis. Default: none.
    #[schema(minimum = 0.001, maximum = 1_000_000_000)]
    jerk: Option<f64>,
}

/// The limits of the tip. Each may be absent.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = TipMotionLimits)]
pub struct SentTipLimits {
    /// Largest acceleration, in mm/s2. Default: none.
    #[schema(minimum = 0.001, maximum = 1_000_000_000)]
    acceleration: Option<f64>,
    /// Largest jerk, in mm/s3. Default: none.
    #[schema(minimum = 0.001, maximum = 1_000_000_000)]
    jerk: Option<f64>,
}

fn checked(value: Option<f64>, at: &Pointer, violations: &mut Violations) -> f64 {
    violations.optional(at, value, LIMIT, "");
    value.unwrap_or(f64::INFINITY)
}

impl SentLimits {
    /// The limits in the core's terms. Adds violations to `violations`.
    pub fn convert(
        self,
        at: &Pointer,
        machine: Option<&Machine>,
        violations: &mut Violations,
    ) -> MotionLimits {
        let Self { x, y, z, a, b, c, tip } = self;
        let mut axes = Vec::new();
        for (name, sent) in [('X', x), ('Y', y), ('Z', z), ('A', a), ('B', b), ('C', c)] {
            let Some(SentAxisLimits { speed, acceleration, jerk }) = sent else { continue };
            let at = at.field(&name.to_string());
            let is_rotary = name < 'X';
            if is_rotary && !machine.is_some_and(|machine| machine.axis_names().contains(&name)) {
                let detail = format!(
                    "the machine has no axis {name}; send a `machine` with this axis, or leave the limits out"
                );
                violations.add(&at, FieldCode::Conflict, detail);
            }
            let unit = if is_rotary { 1.0_f64.to_radians() } else { 1.0 };
            let [speed, acceleration, jerk] =
                [("speed", speed), ("acceleration", acceleration), ("jerk", jerk)]
                    .map(|(field, value)| checked(value, &at.field(field), violations) * unit);
            axes.push((name, Limits { speed, acceleration, jerk }));
        }
        let tip = tip.map(|SentTipLimits { acceleration, jerk }| {
            let at = at.field("tip");
            TipLimits {
                acceleration: checked(acceleration, &at.field("acceleration"), violations),
                jerk: checked(jerk, &at.field("jerk"), violations),
            }
        });
        MotionLimits { axes, tip }
    }
}
