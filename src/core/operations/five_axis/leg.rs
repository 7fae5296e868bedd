//! The straight motion from one pose to the next.

use nalgebra::Vector3;

use super::rail::{Point6, join, tip, top};
use crate::toolpath::pose::{SAME_AXIS, SAME_TIP_MM};
use crate::toolpath::tool_axes::angle_between;

/// The straight motion from one pose to the next: the tip on a line, the axis on a great circle in step
/// with the tip.
#[derive(Debug, Clone, Copy)]
pub struct Leg {
    pub start: Point6,
    pub end: Point6,
    /// The length of the tip's line, mm, and the angle of the axes, radians.
    pub length: f64,
    pub angle: f64,
}

impl Leg {
    pub fn new(start: Point6, end: Point6) -> Self {
        let length = (tip(&end) - tip(&start)).norm();
        Self { start, end, length, angle: angle_between(&top(&start), &top(&end)) }
    }

    /// Whether the tip rests while the axis turns.
    pub fn is_rotation(&self) -> bool {
        self.length <= SAME_TIP_MM
    }

    /// Whether the axis turns.
    pub fn turns(&self) -> bool {
        self.angle > SAME_AXIS
    }

    pub fn direction(&self) -> Vector3<f64> {
        (tip(&self.end) - tip(&self.start)) / self.length
    }

    /// The place at a part of the leg, from 0 to 1.
    pub fn at(&self, part: f64) -> Point6 {
        let tip = tip(&self.start).lerp(&tip(&self.end), part);
        join(tip, self.top_at(part))
    }

    /// The same motion from one part of the leg to another.
    pub fn between(&self, [from, to]: [f64; 2]) -> Self {
        Self::new(self.at(from), self.at(to))
    }

    /// The vector to the top at a part of the leg, on the great circle.
    pub fn top_at(&self, part: f64) -> Vector3<f64> {
        let (a, b) = (top(&self.start), top(&self.end));
        if self.angle <= SAME_AXIS {
            return a.lerp(&b, part);
        }
        let sine = self.angle.sin();
        a * (((1.0 - part) * self.angle).sin() / sine) + b * ((part * self.angle).sin() / sine)
    }
}
