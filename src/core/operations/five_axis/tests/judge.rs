//! How far poses are from a path, by code of its own.

use super::*;
use crate::toolpath::path::{Move, Role};

/// How often a leg is shortened by a third in the search for its place nearest to a pose.
const THIRDS: usize = 60;

/// The distance of a pose from a place of a leg, and the angle to the axis there.
fn apart(leg: &[Pose], t: f64, pose: &Pose) -> [f64; 2] {
    let tip = leg[0].tip + (leg[1].tip - leg[0].tip) * t;
    let (a, b) = (leg[0].axis.into_inner(), leg[1].axis.into_inner());
    let axis = if angle(&a, &b) > 1e-12 { leg[0].axis.slerp(&leg[1].axis, t).into_inner() } else { a };
    [(pose.tip - tip).norm(), angle(&axis, &pose.axis)]
}

/// How far a pose is from a path: the distance to a tip of the path, and the angle to the axis there. If the
/// path has a place where distance and angle are both allowed, the function answers those of such a place.
/// Else it divides both by what is allowed, and answers those of the place where the larger quotient is
/// least. It looks only at the legs near the pose with the index `near`.
fn off(poses: &[Pose], sample: &Pose, near: usize, allowed: [f64; 2]) -> [f64; 2] {
    let quotient = |[tip, angle]: [f64; 2]| (tip / allowed[0]).max(angle / allowed[1]);
    let legs = || poses[near.saturating_sub(40)..(near + 40).min(poses.len())].windows(2);
    let beside = |leg: &[Pose]| {
        let along = leg[1].tip - leg[0].tip;
        let t = (sample.tip - leg[0].tip).dot(&along) / along.norm_squared().max(1e-18);
        apart(leg, t.clamp(0.0, 1.0), sample)
    };
    if let Some(within) = legs().map(beside).find(|apart| quotient(*apart) <= 1.0) {
        return within;
    }
    let least = |leg: &[Pose]| {
        // Distance and angle each fall and then rise along the leg, and so does the larger quotient.
        let at = |t: f64| apart(leg, t, sample);
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..THIRDS {
            let [first, second] = [(2.0 * low + high) / 3.0, (low + 2.0 * high) / 3.0];
            if quotient(at(first)) <= quotient(at(second)) { high = second } else { low = first }
        }
        [0.0, low, 1.0].map(at).into_iter().min_by(|a, b| quotient(*a).total_cmp(&quotient(*b))).unwrap()
    };
    legs().map(least).min_by(|a, b| quotient(*a).total_cmp(&quotient(*b))).unwrap()
}

/// The largest distance and the largest angle of all poses from a path. The poses follow the path in order.
pub fn farthest(given: &[Pose], poses: &[Pose], allowed: [f64; 2]) -> (f64, f64) {
    let allowed = allowed.map(|most| most.max(1e-12));
    let (mut tip, mut angle) = (0.0_f64, 0.0_f64);
    let mut near = 0;
    for pose in poses {
        let range = near..(near + 60).min(given.len());
        let distance = |k: &usize| (given[*k].tip - pose.tip).norm();
        near = range.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap().max(near);
        let [distance, turned] = off(given, pose, near, allowed);
        tip = tip.max(distance);
        angle = angle.max(turned);
    }
    (tip, angle)
}

/// Poses along the cutting moves of a toolpath.
pub fn along_moves(toolpath: &Toolpath) -> Vec<Pose> {
    let mut poses = Vec::new();
    for pass in toolpath.passes() {
        let mut before = pass.axes().start();
        for (k, step) in pass.moves().iter().enumerate() {
            let after = pass.axes().after(k);
            let ends = match step {
                Move::Feed { along, role: Role::Cut, .. } => Some([along.start(), along.end()]),
                Move::Turn { at, .. } => Some([*at; 2]),
                _ => None,
            };
            if let Some([from, to]) = ends {
                let (from, to) = (Pose { tip: from, axis: before }, Pose { tip: to, axis: after });
                poses.extend((0..=4).map(|n| from.between(&to, f64::from(n) / 4.0)));
            }
            before = after;
        }
    }
    poses
}
