//! Moves on the wire: the same objects in requests and in answers.

use serde::{Deserialize, Deserializer, Serialize};
use serde_json::value::RawValue;
use utoipa::ToSchema;

use super::point::Point;
use super::tagged;
use crate::geometry::curve::{self, Curve};
use crate::geometry::plane;
use crate::toolpath as core;
use crate::toolpath::units::FeedRate;

/// One move, told apart by `kind`. It starts where the last one ended.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, ToSchema)]
#[serde(untagged)]
pub enum Move {
    Rapid(RapidMove),
    Line(LineMove),
    Arc(ArcMove),
    Parabola(ParabolaMove),
    Dwell(DwellMove),
}

/// Moves that can be read, and those of the contract that this version cannot.
const KINDS: [&str; 5] = ["rapid", "line", "arc", "parabola", "dwell"];
const LATER: [&str; 1] = ["spline"];

impl<'de> Deserialize<'de> for Move {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let object = <&RawValue>::deserialize(deserializer)?;
        match tagged::kind_of::<D::Error>(object)?.as_str() {
            "rapid" => tagged::decode(object).map(Self::Rapid),
            "line" => tagged::decode(object).map(Self::Line),
            "arc" => tagged::decode(object).map(Self::Arc),
            "parabola" => tagged::decode(object).map(Self::Parabola),
            "dwell" => tagged::decode(object).map(Self::Dwell),
            other => Err(tagged::unknown(other, &LATER, &KINDS)),
        }
    }
}

/// At the machine's traverse rate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct RapidMove {
    #[schema(inline)]
    kind: RapidKind,
    pub to: Point,
}

/// Straight, at feed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct LineMove {
    #[schema(inline)]
    kind: LineKind,
    pub to: Point,
    /// In every answer to a request with feeds. Default in a request: that of `cutting` for the role.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    pub feed_mm_per_min: Option<f64>,
    #[serde(default)]
    #[schema(default = "cut")]
    pub role: Role,
}

/// As G2 and G3 in G17, G18 and G19: `cw` is seen from the positive end of the plane's normal. `to` equal to the start in
/// the plane is one full turn; `to` may differ along the normal (a helix).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ArcMove {
    #[schema(inline)]
    kind: ArcKind,
    pub to: Point,
    /// Absolute, with the start's coordinate along the normal. The radii at both ends may differ by 1.5 units of the last
    /// decimal that is written.
    pub center: Point,
    pub plane: Plane,
    pub direction: Direction,
    /// In every answer to a request with feeds. Default in a request: that of `cutting` for the role.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    pub feed_mm_per_min: Option<f64>,
    #[serde(default)]
    #[schema(default = "cut")]
    pub role: Role,
}

/// A part of a parabola: the quadratic Bezier curve with the control point `control`, where the tangents at its ends meet.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ParabolaMove {
    #[schema(inline)]
    kind: ParabolaKind,
    pub to: Point,
    pub control: Point,
    /// In every answer to a request with feeds. Default in a request: that of `cutting` for the role.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    pub feed_mm_per_min: Option<f64>,
    #[serde(default)]
    #[schema(default = "cut")]
    pub role: Role,
}

/// A pause.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct DwellMove {
    #[schema(inline)]
    kind: DwellKind,
    /// At most a day.
    #[schema(minimum = 0, maximum = 86_400)]
    pub seconds: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum RapidKind {
    Rapid,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum LineKind {
    Line,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ArcKind {
    Arc,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ParabolaKind {
    Parabola,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum DwellKind {
    Dwell,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    #[default]
    Cut,
    Plunge,
    Ramp,
    LeadIn,
    Link,
    LeadOut,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = ArcPlane)]
pub enum Plane {
    Xy,
    Zx,
    Yz,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = ArcDirection)]
pub enum Direction {
    Cw,
    Ccw,
}

impl From<&core::Move> for Move {
    fn from(step: &core::Move) -> Self {
        match *step {
            core::Move::Rapid { line } => {
                Move::Rapid(RapidMove { kind: RapidKind::Rapid, to: line.end.into() })
            }
            core::Move::Feed { along: Curve::Line(line), rate, role } => Move::Line(LineMove {
                kind: LineKind::Line,
                to: line.end.into(),
                feed_mm_per_min: rate.map(FeedRate::mm_per_min),
                role: role.into(),
            }),
            core::Move::Feed { along: Curve::Arc(arc), rate, role } => Move::Arc(ArcMove {
                kind: ArcKind::Arc,
                to: arc.end().into(),
                center: arc.center().into(),
                plane: arc.plane().into(),
                direction: arc.direction().into(),
                feed_mm_per_min: rate.map(FeedRate::mm_per_min),
                role: role.into(),
            }),
            core::Move::Feed { along: Curve::Parabola(parabola), rate, role } => {
                Move::Parabola(ParabolaMove {
                    kind: ParabolaKind::Parabola,
                    to: parabola.end().into(),
                    control: parabola.control().into(),
                    feed_mm_per_min: rate.map(FeedRate::mm_per_min),
                    role: role.into(),
                })
            }
            core::Move::Dwell { seconds } => Move::Dwell(DwellMove { kind: DwellKind::Dwell, seconds }),
        }
    }
}

/// Both ways between a wire enum and the core's, variant by variant.
macro_rules! same {
    ($wire:ty, $core:ty, [$($variant:ident),+]) => {
        impl From<$core> for $wire {
            fn from(value: $core) -> Self {
                match value { $(<$core>::$variant => Self::$variant),+ }
            }
        }

        impl From<$wire> for $core {
            fn from(value: $wire) -> Self {
                match value { $(<$wire>::$variant => Self::$variant),+ }
            }
        }
    };
}

same!(Role, core::Role, [Cut, Plunge, Ramp, LeadIn, Link, LeadOut]);
same!(Plane, plane::Plane, [Xy, Zx, Yz]);
same!(Direction, curve::Direction, [Cw, Ccw]);
