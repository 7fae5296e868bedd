//! The path that is smoothed: poses without duplicates, and the legs between them.

use nalgebra::Point3;

use super::FiveAxisError;
use super::cleaning::{Cleaned, clean};
use super::deviation::Deviation;
use super::leg::{Leg, SAME_AXIS, SAME_TIP_MM};
use super::rail::{Point6, join, tip, top};
use crate::toolpath::pose::{Pace, Waypoint};
use crate::toolpath::tool_axes::{OPPOSITE, angle_between};
use crate::toolpath::units::FeedRate;

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
        let paces =
            kept.windows(2).map(|ends| pace(waypoints, &poses, [&ends[0], &ends[1]])).collect::<Vec<_>>();
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

/// The pace of the leg between two poses that are kept: that of the longest of the ways that it stands for,
/// so that no cut becomes a rapid with a short rapid behind it. Where one of them has a time of its own, the
/// leg takes the time of all of them: poses that became one have no way of their own.
fn pace(waypoints: &[Waypoint], poses: &[Point6], [from, to]: [&(usize, Point6); 2]) -> Pace {
    let own = from.0 + 1..=to.0;
    let way = |k: &usize| way_mm(&poses[k - 1], &poses[*k]);
    let longest = own.clone().max_by(|a, b| way(a).total_cmp(&way(b))).unwrap_or(to.0);
    let pace = waypoints[longest].pace;
    if pace == Pace::Rapid || own.clone().all(|k| waypoints[k].seconds.is_none()) {
        return pace;
    }
    let seconds: f64 = own
        .map(|k| match (waypoints[k].seconds, waypoints[k].pace) {
            (Some(seconds), _) => seconds,
            (None, Pace::Feed(feed)) => way(&k) / feed.mm_per_s(),
            (None, Pace::Rapid) => 0.0,
        })
        .sum();
    let mm_per_min = 60.0 * way_mm(&from.1, &to.1) / seconds;
    FeedRate::from_mm_per_min(mm_per_min).map_or(pace, Pace::Feed)
}

/// The way that a feed counts: that of the tip, and of the top where the tip rests, mm.
fn way_mm(from: &Point6, to: &Point6) -> f64 {
    let length = (tip(to) - tip(from)).norm();
    if length > SAME_TIP_MM { length } else { angle_between(&top(from), &top(to)) * top(from).norm() }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::toolpath::pose::Pose;

    fn to(x: f64, z: f64, lean: f64, pace: Pace, seconds: Option<f64>) -> Waypoint {
        let axis = nalgebra::Unit::new_normalize(Vector3::new(0.0, lean.sin(), lean.cos()));
        Waypoint { seconds, ..Waypoint::new(Pose { tip: Point3::new(x, 0.0, z), axis }, pace) }
    }

    fn paces(waypoints: &[Waypoint]) -> Vec<Pace> {
        Path::new(waypoints, 50.0, Deviation { tip_mm: 0.05, axis: 1e-3 }).unwrap().paces
    }

    fn feed(mm_per_min: f64) -> Pace {
        Pace::Feed(FeedRate::from_mm_per_min(mm_per_min).unwrap())
    }

    #[test]
    fn a_short_rapid_behind_a_cut_makes_no_rapid_of_it() {
        let cut = feed(500.0);
        let path = [
            to(0.0, 0.0, 0.0, Pace::Rapid, None),
            to(40.0, 0.0, 0.0, cut, None),
            to(40.0, 1e-3, 0.0, Pace::Rapid, None),
        ];
        assert_eq!(paces(&path), [cut]);
        let path = [
            to(0.0, 0.0, 0.0, cut, None),
            to(1e-3, 0.0, 0.0, cut, None),
            to(40.0, 0.0, 0.0, Pace::Rapid, None),
        ];
        assert_eq!(paces(&path), [Pace::Rapid]);
    }

    #[test]
    fn a_turn_about_a_tip_that_trembles_takes_the_time_that_its_program_states() {
        // The feed of the tip alone would be 0.6 mm/min.
        let tremble = |k: usize| if k % 2 == 1 { 2e-4 } else { 0.0 };
        let mut path = vec![to(0.0, 0.0, 0.0, Pace::Rapid, None)];
        path.extend((1..=10).map(|k| to(tremble(k), 0.0, 0.05 * k as f64, feed(0.6), Some(0.02))));
        path.push(to(20.0, 0.0, 0.5, feed(600.0), Some(2.0)));
        let built = Path::new(&path, 50.0, Deviation { tip_mm: 0.05, axis: 1e-3 }).unwrap();
        let seconds: f64 = (0..built.paces.len())
            .map(|k| match built.paces[k] {
                Pace::Feed(feed) => way_mm(&built.stations[k], &built.stations[k + 1]) / feed.mm_per_s(),
                Pace::Rapid => 0.0,
            })
            .sum();
        assert!((seconds - 2.2).abs() < 1e-6, "{seconds}");
    }
}
