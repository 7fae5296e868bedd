//! The path that is smoothed: poses without duplicates, and the legs between them.

use nalgebra::Vector3;

use super::FiveAxisError;
use super::rail::{Point6, join, tip, top};
use crate::toolpath::pose::{Pace, Waypoint};
use crate::toolpath::tool_axes::{OPPOSITE, angle_between};

/// Two tips that are nearer to each other are the same, mm: far below what a program can say.
const SAME_TIP_MM: f64 = 1e-7;

/// Two axes at a smaller angle are the same, radians: at 100 mm from the tip this is a tenth of a nanometre.
const SAME_AXIS: f64 = 1e-9;

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

    pub fn direction(&self) -> Vector3<f64> {
        (tip(&self.end) - tip(&self.start)) / self.length
    }

    /// The place at a part of the leg, from 0 to 1.
    pub fn at(&self, part: f64) -> Point6 {
        let tip = tip(&self.start).lerp(&tip(&self.end), part);
        join(tip, self.top_at(part))
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

/// Different poses, with the pace of each leg between them.
#[derive(Debug, Clone)]
pub struct Path {
    pub stations: Vec<Point6>,
    pub paces: Vec<Pace>,
}

impl Path {
    /// The path whose tops are `top_mm` away from the tips. Poses that repeat the one before are left out.
    ///
    /// # Errors
    /// With fewer than two different poses, and where two neighbouring axes are opposite.
    pub fn new(waypoints: &[Waypoint], top_mm: f64) -> Result<Self, FiveAxisError> {
        let mut stations: Vec<Point6> = Vec::with_capacity(waypoints.len());
        let mut paces = Vec::with_capacity(waypoints.len());
        for (index, Waypoint { pose, pace }) in waypoints.iter().enumerate() {
            let at = join(pose.tip.coords, pose.axis.into_inner() * top_mm);
            if let Some(last) = stations.last() {
                let leg = Leg::new(*last, at);
                if leg.length <= SAME_TIP_MM && leg.angle <= SAME_AXIS {
                    continue;
                }
                if leg.angle >= OPPOSITE {
                    return Err(FiveAxisError::OppositeAxes { index });
                }
                paces.push(*pace);
            }
            stations.push(at);
        }
        if stations.len() < 2 { Err(FiveAxisError::NoMotion) } else { Ok(Self { stations, paces }) }
    }

    pub fn leg(&self, k: usize) -> Leg {
        Leg::new(self.stations[k], self.stations[k + 1])
    }

    /// The ranges of legs that are cut without a rapid between them, and each rapid alone.
    pub fn sections(&self) -> Vec<std::ops::Range<usize>> {
        let mut sections: Vec<std::ops::Range<usize>> = Vec::new();
        for k in 0..self.paces.len() {
            let goes_on = k > 0 && self.paces[k] != Pace::Rapid && self.paces[k - 1] != Pace::Rapid;
            match sections.last_mut() {
                Some(last) if goes_on => last.end = k + 1,
                _ => sections.push(k..k + 1),
            }
        }
        sections
    }
}
