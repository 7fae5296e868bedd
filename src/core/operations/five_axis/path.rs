//! The path that is smoothed: poses without duplicates, and the legs between them.

use nalgebra::Point3;

use super::FiveAxisError;
use super::cleaning::{Cleaned, clean};
use super::deviation::Deviation;
use super::leg::{Leg, SAME_AXIS, SAME_TIP_MM};
use super::rail::{Point6, join, top};
use crate::toolpath::pose::{Pace, Waypoint};
use crate::toolpath::tool_axes::{OPPOSITE, angle_between};

/// The part of each tolerance within which poses count as one.
const SAME_SHARE: f64 = 0.05;

/// How often a path is led through poles and around them, and where first.
#[derive(Debug, Clone, Copy, Default)]
pub struct Passed {
    pub through: usize,
    pub around: usize,
    pub at: Option<Point3<f64>>,
}

/// Different poses, with the pace of each leg between them.
#[derive(Debug, Clone)]
pub struct Path {
    /// How many of the given poses differ.
    pub n_poses: usize,
    pub stations: Vec<Point6>,
    pub paces: Vec<Pace>,
    /// Whether the path is led through a pole at a station: the rails have to hit it.
    pub on_pole: Vec<bool>,
    /// How far the axis of the rails may be from each leg because of a pole beside it, radians.
    pub rooms: Vec<f64>,
    /// The poles that the path passes.
    pub passed: Passed,
    /// How far the path is from the given one, at most.
    pub moved: Deviation,
}

impl Path {
    /// The path whose tops are `top_mm` away from the tips, cleaned within a small part of the tolerance.
    ///
    /// # Errors
    /// With fewer than two different poses, and where two neighbouring axes are opposite.
    pub fn new(waypoints: &[Waypoint], top_mm: f64, tolerance: Deviation) -> Result<Self, FiveAxisError> {
        let poses: Vec<Point6> = waypoints
            .iter()
            .map(|Waypoint { pose, .. }| join(pose.tip.coords, pose.axis.into_inner() * top_mm))
            .collect();
        let allowed = Deviation {
            tip_mm: (SAME_SHARE * tolerance.tip_mm).max(SAME_TIP_MM),
            axis: (SAME_SHARE * tolerance.axis).max(SAME_AXIS),
        };
        let Cleaned { kept, moved } = clean(&poses, allowed);
        for pair in kept.windows(2) {
            let [(_, from), (index, to)] = [pair[0], pair[1]];
            if angle_between(&top(&from), &top(&to)) >= OPPOSITE {
                return Err(FiveAxisError::OppositeAxes { index });
            }
        }
        if kept.len() < 2 {
            return Err(FiveAxisError::NoMotion);
        }
        let paces: Vec<Pace> = kept[1..].iter().map(|(index, _)| waypoints[*index].pace).collect();
        let stations: Vec<Point6> = kept.into_iter().map(|(_, at)| at).collect();
        let rooms = vec![f64::INFINITY; paces.len()];
        Ok(Self {
            n_poses: stations.len(),
            on_pole: vec![false; stations.len()],
            rooms,
            passed: Passed::default(),
            stations,
            paces,
            moved,
        })
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
