//! The pose of a tool: the place of its tip and the direction of its axis, in the frame of the workpiece.

use nalgebra::{Point3, UnitVector3};

use super::tool_axes::{self, angle_between};
use super::units::FeedRate;

/// Two tips that are nearer to each other are the same, mm: far below what a program can say.
pub const SAME_TIP_MM: f64 = 1e-7;

/// Two axes at a smaller angle are the same, radians: at 100 mm from the tip this is a tenth of a nanometre.
pub const SAME_AXIS: f64 = 1e-9;

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

    /// The length of the straight way to another pose for a feed, mm: that of the tip. Where the tip rests,
    /// the length is that of the point of the tool axis `top_mm` above the tip.
    pub fn way_mm(&self, to: &Self, top_mm: f64) -> f64 {
        let length = (to.tip - self.tip).norm();
        let angle = angle_between(&self.axis, &to.axis);
        match (length > SAME_TIP_MM, angle > SAME_AXIS) {
            (true, _) => length,
            (false, true) => angle * top_mm,
            (false, false) => 0.0,
        }
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
    /// The time of the way from the pose before, s, where a program states times (G93). `pace` then holds
    /// the feed that takes this time from the pose before as given.
    pub seconds: Option<f64>,
}

impl Waypoint {
    /// A waypoint whose rotary axes may stand anywhere.
    pub const fn new(pose: Pose, pace: Pace) -> Self {
        Self { pose, pace, rotary: None, seconds: None }
    }
}
