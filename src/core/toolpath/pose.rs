//! The pose of a tool: the place of its tip and the direction of its axis, in the frame of the workpiece.

use nalgebra::{Point3, UnitVector3};

use super::tool_axes;
use super::units::FeedRate;

/// Where a tool is and how it leans.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// The tool tip, mm.
    pub tip: Point3<f64>,
    /// The tool axis. It points from the tip to the spindle.
    pub axis: UnitVector3<f64>,
}

impl Pose {
    /// The pose at a part of the straight way to another pose, from 0 to 1: the axis turns on the great
    /// circle in step with the tip.
    #[must_use]
    pub fn between(&self, to: &Self, part: f64) -> Self {
        let tip = self.tip + (to.tip - self.tip) * part;
        Self { tip, axis: tool_axes::between(&self.axis, &to.axis, part) }
    }
}

/// How fast the tool goes to a pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pace {
    Rapid,
    Feed(FeedRate),
}

/// A pose and the pace of the straight way to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Waypoint {
    pub pose: Pose,
    pub pace: Pace,
    /// The positions of the two rotary axes of the machine, radians, where a program states both. They may
    /// count turns.
    pub rotary: Option<[f64; 2]>,
    /// How long the way to the pose takes, s, where a program states that. The pace is then that of the way
    /// by the given poses.
    pub seconds: Option<f64>,
}

impl Waypoint {
    /// A waypoint whose rotary axes may stand anywhere.
    pub const fn new(pose: Pose, pace: Pace) -> Self {
        Self { pose, pace, rotary: None, seconds: None }
    }
}
