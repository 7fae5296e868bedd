//! How far poses are from a path, by code of its own.

use super::*;
use crate::toolpath::path::{Move, Role};

/// The distance from the nearest block, and the angle to the axis there.
fn off(poses: &[Pose], sample: &Pose, near: usize) -> (f64, f64) {
    let first = near.saturating_sub(40);
    let mut best = (f64::INFINITY, f64::INFINITY);
    for pair in poses[first..(near + 40).min(poses.len())].windows(2) {
        let along = pair[1].tip - pair[0].tip;
        let from = sample.tip - pair[0].tip;
        let t =
            if along.norm() > 1e-9 { (from.dot(&along) / along.norm_squared()).clamp(0.0, 1.0) } else { 0.0 };
        let distance = (from - along * t).norm();
        let (a, b) = (pair[0].axis.into_inner(), pair[1].axis.into_inner());
        let slerped =
            if angle(&a, &b) > 1e-12 { pair[0].axis.slerp(&pair[1].axis, t).into_inner() } else { a };
        let mut turned = angle(&slerped, &sample.axis);
        if along.norm() <= 1e-9 {
            // Any axis on the way does.
            let normal = a.cross(&b).normalize();
            let is_between =
                a.cross(&sample.axis).dot(&normal) >= -1e-9 && sample.axis.cross(&b).dot(&normal) >= -1e-9;
            turned = if is_between { normal.dot(&sample.axis).abs().asin() } else { turned };
        }
        if distance < best.0 - 1e-9 || distance < best.0 + 1e-9 && turned < best.1 {
            best = (distance, turned);
        }
    }
    best
}

/// The largest distance and angle of poses from a path, which they follow in order.
pub fn farthest(given: &[Pose], poses: &[Pose]) -> (f64, f64) {
    let (mut tip, mut angle) = (0.0_f64, 0.0_f64);
    let mut near = 0;
    for pose in poses {
        let range = near..(near + 60).min(given.len());
        let distance = |k: &usize| (given[*k].tip - pose.tip).norm();
        near = range.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap().max(near);
        let (distance, turned) = off(given, pose, near);
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
