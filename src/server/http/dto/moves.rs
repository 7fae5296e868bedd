//! The moves of a toolpath: the same JSON objects in requests and in answers.

use nalgebra::UnitVector3;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::axis::{AxisDirection, components};
use super::point::{Coordinates, Point};
use crate::http::decode::tagged::{Kind, by_kind};
use toolpathd_core::geometry::curve::{Curve, Direction};
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::units::FeedRate;
use toolpathd_core::toolpath::{self as core, Role};

by_kind! {
    /// One move of the tool's tip; `kind` says which. The move starts where the move before ended.
    #[derive(Debug, Clone, Copy, PartialEq, Serialize)]
    #[serde(tag = "kind", rename_all = "snake_case")]
    Move {
        "rapid" => Rapid(RapidMove),
        "line" => Line(LineMove),
        "arc" => Arc(ArcMove),
        "parabola" => Parabola(ParabolaMove),
        "turn" => Turn(TurnMove),
        "dwell" => Dwell(DwellMove),
    }
}

/// A straight move at the machine's traverse rate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct RapidMove {
    #[serde(rename = "kind", skip_serializing)]
    #[schema(ignore)]
    _kind: Kind,
    /// Where the tip of the tool ends, in mm.
    pub to: Point,
    /// The tool axis at the end of the move: three plain numbers without a unit. During the move the axis
    /// turns on the great circle, in step with the length of the way. Default: the axis before the move.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<AxisDirection>)]
    pub axis: Option<Coordinates<3>>,
}

/// A straight move at feed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct LineMove {
    #[serde(rename = "kind", skip_serializing)]
    #[schema(ignore)]
    _kind: Kind,
    /// Where the tip of the tool ends, in mm.
    pub to: Point,
    /// Feed, in mm/min. In an answer every feed move has its feed if the request gave feeds. Default in a
    /// request: the feed of `cutting` for the role of the move.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    pub feed_mm_per_min: Option<f64>,
    /// What the move is for. The role chooses the feed from `cutting`.
    #[serde(default)]
    #[schema(default = "cut")]
    pub role: Role,
    /// The tool axis at the end of the move: three plain numbers without a unit. During the move the axis
    /// turns on the great circle, in step with the length of the way. Default: the axis before the move.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<AxisDirection>)]
    pub axis: Option<Coordinates<3>>,
}

/// An arc or a helix at feed, as G2 and G3 in G17, G18 and G19. Where `to` equals the start in the plane of
/// the arc, the arc makes one full turn. Where `to` differs from the start along the axis at right angles to
/// the plane, the move is a helix.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ArcMove {
    #[serde(rename = "kind", skip_serializing)]
    #[schema(ignore)]
    _kind: Kind,
    /// Where the tip of the tool ends, in mm.
    pub to: Point,
    /// The centre, in absolute coordinates, in mm. Along the axis at right angles to the plane the centre has
    /// the coordinate of the start. In a request the radii at the start and at the end may differ by 1.5
    /// units of the last written decimal.
    pub center: Point,
    /// The plane of the arc: `xy` (G17), `zx` (G18) or `yz` (G19).
    pub plane: Plane,
    /// The direction, seen from the positive end of the axis at right angles to the plane. `cw`: clockwise
    /// (G2). `ccw`: counterclockwise (G3).
    pub direction: Direction,
    /// Feed, in mm/min. In an answer every feed move has its feed if the request gave feeds. Default in a
    /// request: the feed of `cutting` for the role of the move.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    pub feed_mm_per_min: Option<f64>,
    /// What the move is for. The role chooses the feed from `cutting`.
    #[serde(default)]
    #[schema(default = "cut")]
    pub role: Role,
    /// The tool axis at the end of the move: three plain numbers without a unit. During the move the axis
    /// turns on the great circle, in step with the length of the way. Default: the axis before the move.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<AxisDirection>)]
    pub axis: Option<Coordinates<3>>,
}

/// A part of a parabola at feed: a quadratic Bezier curve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ParabolaMove {
    #[serde(rename = "kind", skip_serializing)]
    #[schema(ignore)]
    _kind: Kind,
    /// Where the tip of the tool ends, in mm.
    pub to: Point,
    /// The control point, in mm: the point where the tangents at the start and at the end meet.
    pub control: Point,
    /// Feed, in mm/min. In an answer every feed move has its feed if the request gave feeds. Default in a
    /// request: the feed of `cutting` for the role of the move.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    pub feed_mm_per_min: Option<f64>,
    /// What the move is for. The role chooses the feed from `cutting`.
    #[serde(default)]
    #[schema(default = "cut")]
    pub role: Role,
    /// The tool axis at the end of the move: three plain numbers without a unit. During the move the axis
    /// turns on the great circle, in step with the length of the way. Default: the axis before the move.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<AxisDirection>)]
    pub axis: Option<Coordinates<3>>,
}

/// A turn of the tool about its resting tip.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct TurnMove {
    #[serde(rename = "kind", skip_serializing)]
    #[schema(ignore)]
    _kind: Kind,
    /// The tool axis after the turn: three plain numbers without a unit.
    #[schema(value_type = AxisDirection)]
    pub axis: Coordinates<3>,
    /// Duration of the turn, in s; at most a day.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 0, maximum = 86_400)]
    pub seconds: Option<f64>,
    /// What the turn is for.
    #[serde(default)]
    #[schema(default = "cut")]
    pub role: Role,
}

/// A pause.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct DwellMove {
    #[serde(rename = "kind", skip_serializing)]
    #[schema(ignore)]
    _kind: Kind,
    /// Length of the pause, in s; at most a day.
    #[schema(minimum = 0, maximum = 86_400)]
    pub seconds: f64,
}

impl Move {
    /// A move of the core with the tool axis at its end, which is written where it is given.
    pub fn new(step: &core::Move, axis: Option<UnitVector3<f64>>) -> Self {
        let axis = axis.map(|axis| components(&axis));
        let (_kind, feed) = (Kind, |rate: Option<FeedRate>| rate.map(FeedRate::mm_per_min));
        match *step {
            core::Move::Rapid { line } => Self::Rapid(RapidMove { _kind, to: line.end.into(), axis }),
            core::Move::Feed { along: Curve::Line(line), rate, role } => {
                Self::Line(LineMove { _kind, to: line.end.into(), feed_mm_per_min: feed(rate), role, axis })
            }
            core::Move::Feed { along: Curve::Arc(arc), rate, role } => Self::Arc(ArcMove {
                _kind,
                to: arc.end().into(),
                center: arc.center().into(),
                plane: arc.plane(),
                direction: arc.direction(),
                feed_mm_per_min: feed(rate),
                role,
                axis,
            }),
            core::Move::Feed { along: Curve::Parabola(parabola), rate, role } => {
                Self::Parabola(ParabolaMove {
                    _kind,
                    to: parabola.end().into(),
                    control: parabola.control().into(),
                    feed_mm_per_min: feed(rate),
                    role,
                    axis,
                })
            }
            core::Move::Turn { seconds, role, .. } => {
                let axis = axis.unwrap_or(Coordinates([0.0, 0.0, 1.0]));
                Self::Turn(TurnMove { _kind, axis, seconds, role })
            }
            core::Move::Dwell { seconds } => Self::Dwell(DwellMove { _kind, seconds }),
        }
    }
}
