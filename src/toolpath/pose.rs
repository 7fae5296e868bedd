//! The pose of a tool: the place of its tip and the direction of its axis, in the frame of the workpiece.

use nalgebra::{Point3, UnitVector3};

/// Where a tool is and how it leans.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// The tool tip, mm.
    pub tip: Point3<f64>,
    /// The tool axis. It points from the tip to the spindle.
    pub axis: UnitVector3<f64>,
}
