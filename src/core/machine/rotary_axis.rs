//! Rotary axes: what they carry, where they lie, and how far they turn.

use std::f64::consts::TAU;

use nalgebra::{Point3, UnitVector3, Vector3};

use super::scalar::{Scalar, add, constant, rotate, subtract};

/// Which of the two rotary axes carry the workpiece, and which the tool.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize, utoipa::ToSchema))]
#[cfg_attr(feature = "wire", serde(rename_all = "snake_case"), schema(as = MachineKind))]
pub enum Kind {
    /// Both carry the workpiece. The first one carries the second one.
    TableTable,
    /// The first one carries the tool, the second one the workpiece.
    HeadTable,
    /// Both carry the tool. The first one carries the second one.
    HeadHead,
}

impl Kind {
    /// Whether each rotary axis belongs to the head.
    pub(super) fn heads(self) -> [bool; 2] {
        match self {
            Kind::TableTable => [false, false],
            Kind::HeadTable => [true, false],
            Kind::HeadHead => [true, true],
        }
    }
}

/// A rotary axis, at the zero position of all axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RotaryAxis {
    /// The letter in programs.
    pub name: char,
    pub direction: UnitVector3<f64>,
    /// A point on the axis, mm. For a table it is given from the origin of the workpiece frame, for a head
    /// from the rotary centre, which is the pivot length above the tool tip.
    pub point_mm: Point3<f64>,
    /// Least and largest angle, radians; `None` if the axis has no end.
    pub travel: Option<[f64; 2]>,
    /// The axis turns without end, and its angle is shown within one turn.
    pub is_wrapped: bool,
    /// Positive angles turn left-handed about `direction`.
    pub is_mirrored: bool,
}

impl RotaryAxis {
    /// An angle as the control shows it: from 0 up to, but not including, a full turn for a wrapped axis.
    /// Other angles stay as they are.
    pub fn shown(&self, angle: f64) -> f64 {
        let within = angle.rem_euclid(TAU);
        match self.is_wrapped {
            // The remainder of a tiny negative angle rounds up to a full turn.
            true if within >= TAU => 0.0,
            true => within,
            false => angle,
        }
    }
}

/// Distance in mm, or angle in radians, by which a position may be beyond its travel: the rounding of an
/// angle at the end of travel, far below what an axis resolves.
pub(super) const SLACK: f64 = 1e-9;

/// A rotary axis as a directed line; positive angles turn right-handed about its direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Line {
    pub(super) point: Vector3<f64>,
    pub(super) direction: Vector3<f64>,
}

impl Line {
    pub(super) fn turn<S: Scalar>(&self, angle: S, point: [S; 3]) -> [S; 3] {
        let center = constant(&self.point);
        add(center, rotate(&self.direction, angle, subtract(point, center)))
    }
}

/// Whether a position is within its travel.
pub(super) fn is_within(travel: Option<[f64; 2]>, position: f64) -> bool {
    travel.is_none_or(|[low, high]| position >= low - SLACK && position <= high + SLACK)
}
