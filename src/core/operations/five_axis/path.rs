//! The path that is smoothed: poses without duplicates, and the legs between them.

use nalgebra::Point3;

use super::FiveAxisError;
use super::cleaning::{Cleaned, clean};
use super::deviation::Deviation;
use super::leg::Leg;
use super::rail::{Point6, join, top};
use super::stations::pose;
use crate::toolpath::pose::{Pace, SAME_AXIS, SAME_TIP_MM, Waypoint};
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
        let paces: Vec<Pace> =
            kept.windows(2).map(|ends| pace(waypoints, top_mm, [&ends[0], &ends[1]])).collect();
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

/// The pace of the leg between two poses that are kept. The leg replaces the given motions between the two
/// poses, and takes the pace of the longest of them: a short rapid behind a cut does not turn the cut into a
/// rapid. Where one of the motions states its time (G93), the leg takes the sum of their times, because
/// motions shorter than the tolerance vanish from the length of the leg.
fn pace(waypoints: &[Waypoint], top_mm: f64, [from, to]: [&(usize, Point6); 2]) -> Pace {
    let replaced = from.0 + 1..=to.0;
    let way_mm = |k: usize| waypoints[k - 1].pose.way_mm(&waypoints[k].pose, top_mm);
    let longest = replaced.clone().max_by(|a, b| way_mm(*a).total_cmp(&way_mm(*b))).unwrap_or(to.0);
    let pace = waypoints[longest].pace;
    if pace == Pace::Rapid || replaced.clone().all(|k| waypoints[k].seconds.is_none()) {
        return pace;
    }
    let seconds: f64 = replaced
        .map(|k| match (waypoints[k].seconds, waypoints[k].pace) {
            (Some(seconds), _) => seconds,
            (None, Pace::Feed(feed)) => way_mm(k) / feed.mm_per_s(),
            (None, Pace::Rapid) => 0.0,
        })
        .sum();
    let mm_per_min = 60.0 * pose(&from.1).way_mm(&pose(&to.1), top_mm) / seconds;
    FeedRate::from_mm_per_min(mm_per_min).map_or(pace, Pace::Feed)
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
                Pace::Feed(feed) => {
                    pose(&built.stations[k]).way_mm(&pose(&built.stations[k + 1]), 50.0) / feed.mm_per_s()
                }
                Pace::Rapid => 0.0,
            })
            .sum();
        assert!((seconds - 2.2).abs() < 1e-6, "{seconds}");
    }
}
