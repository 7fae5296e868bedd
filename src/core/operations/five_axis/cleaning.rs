//! Cleans a path within a small tolerance before anything passes through its poses.
//!
//! # Method
//! 1. Neighbouring poses whose tips are within the tolerance of the first of them share one tip: the tool
//!    rests there.
//! 2. Of the axes of such poses, those within the tolerance of the great circle between two others are left
//!    out.
//!
//! Rounded and repeated poses would otherwise become motions of their own: a turn between two tips that are a
//! nanometre apart takes no time at the feed.
//!
//! # Guarantees
//! * The cleaned path and the given one are within the stated deviation of each other.
//! * The first and the last pose stay as they are.
//!
//! # Cost
//! O(n log n) for n poses, mostly; O(n^2) for turns that every pose bends further.

use nalgebra::Vector3;

use super::deviation::Deviation;
use super::rail::{Point6, join, tip, top};
use crate::toolpath::tool_axes::angle_between;

/// The path that is left: the index of each pose that is kept, and the pose.
#[derive(Debug, Clone)]
pub struct Cleaned {
    pub kept: Vec<(usize, Point6)>,
    /// How far the path has moved, at most.
    pub moved: Deviation,
}

/// Cleans a path of poses. Tips and axes move by at most `allowed`.
pub fn clean(poses: &[Point6], allowed: Deviation) -> Cleaned {
    let mut cleaned = Cleaned { kept: Vec::with_capacity(poses.len()), moved: Deviation::NONE };
    let mut first = 0;
    while first < poses.len() {
        let start = tip(&poses[first]);
        let rest = poses[first..].iter().take_while(|pose| (tip(pose) - start).norm() <= allowed.tip_mm);
        let end = first + rest.count().max(1);
        // The last pose keeps its tip, even if all tips are within the tolerance of the first.
        let is_whole = first == 0 && end == poses.len() && tip(&poses[end - 1]) != start;
        let end = if is_whole { end - 1 } else { end };
        cleaned.rest(poses, [first, end - 1], allowed.axis);
        first = end;
    }
    cleaned
}

impl Cleaned {
    /// Adds the poses from `first` to `last`, with one tip.
    fn rest(&mut self, poses: &[Point6], [first, last]: [usize; 2], allowed: f64) {
        let is_end = first > 0 && last + 1 == poses.len();
        let at = tip(&poses[if is_end { last } else { first }]);
        for pose in &poses[first..=last] {
            self.moved.tip_mm = self.moved.tip_mm.max((tip(pose) - at).norm());
        }
        let turns = angle_between(&top(&poses[first]), &top(&poses[last])) > allowed;
        let mut kept = if turns { vec![first] } else { Vec::new() };
        self.turn(poses, [first, last], allowed, &mut kept);
        match kept.last() {
            // The axis hardly turns: one pose stands for all.
            None => kept.push(if is_end { last } else { first }),
            Some(_) if turns => kept.push(last),
            // The axis turns away and comes back.
            Some(_) => {
                kept.insert(0, first);
                kept.push(last);
            }
        }
        if let [only] = kept[..] {
            let apart = poses[first..=last].iter().map(|pose| angle_between(&top(pose), &top(&poses[only])));
            self.moved.axis = apart.fold(self.moved.axis, f64::max);
        }
        self.kept.extend(kept.into_iter().map(|k| (k, join(at, top(&poses[k])))));
    }

    /// Adds the poses between `first` and `last` whose axes are farther than allowed from the great circle
    /// between the axes beside them.
    fn turn(&mut self, poses: &[Point6], ends: [usize; 2], allowed: f64, kept: &mut Vec<usize>) {
        let mut open = vec![ends];
        while let Some([first, last]) = open.pop() {
            let between = [first, last].map(|k| top(&poses[k]));
            let off = |k: usize| angle_to_circle(&top(&poses[k]), &between);
            let farthest = (first + 1..last).map(|k| (off(k), k)).max_by(|a, b| a.0.total_cmp(&b.0));
            match farthest {
                Some((angle, k)) if angle > allowed => {
                    kept.push(k);
                    open.extend([[first, k], [k, last]]);
                }
                Some((angle, _)) => self.moved.axis = self.moved.axis.max(angle),
                None => {}
            }
        }
        kept.sort_unstable();
    }
}

/// The angle between an axis and the nearest place of the great circle between two others, radians.
fn angle_to_circle(axis: &Vector3<f64>, [start, end]: &[Vector3<f64>; 2]) -> f64 {
    let to_ends = angle_between(axis, start).min(angle_between(axis, end));
    let normal = start.cross(end);
    let is_between = normal.cross(start).dot(axis) > 0.0 && end.cross(&normal).dot(axis) > 0.0;
    if !is_between {
        return to_ends;
    }
    let across = normal.dot(axis) / (normal.norm() * axis.norm());
    across.abs().clamp(0.0, 1.0).asin().min(to_ends)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALLOWED: Deviation = Deviation { tip_mm: 1e-3, axis: 1e-3 };

    fn pose(x: f64, lean: f64) -> Point6 {
        join(Vector3::x() * x, Vector3::new(lean.sin(), 0.0, lean.cos()) * 50.0)
    }

    fn kept(poses: &[Point6]) -> Vec<usize> {
        clean(poses, ALLOWED).kept.iter().map(|(k, _)| *k).collect()
    }

    #[test]
    fn poses_apart_stay_as_they_are() {
        let poses: Vec<Point6> = (0..5).map(|k| pose(f64::from(k), 0.1 * f64::from(k))).collect();
        let cleaned = clean(&poses, ALLOWED);
        assert_eq!(cleaned.kept, poses.iter().copied().enumerate().collect::<Vec<_>>());
        assert_eq!(cleaned.moved, Deviation::NONE);
    }

    #[test]
    fn near_poses_are_one_and_the_ends_stay() {
        let poses = [pose(0.0, 0.0), pose(5e-4, 5e-4), pose(1.0, 0.0), pose(2.0, 0.1), pose(2.0 + 5e-4, 0.1)];
        let cleaned = clean(&poses, ALLOWED);
        assert_eq!(kept(&poses), [0, 2, 4]);
        assert_eq!((cleaned.kept[0].1, cleaned.kept[2].1), (poses[0], poses[4]));
        assert!((cleaned.moved.tip_mm - 5e-4).abs() < 1e-12 && (cleaned.moved.axis - 5e-4).abs() < 1e-9);
    }

    #[test]
    fn a_turn_in_many_poses_is_one_turn_about_one_tip() {
        let turn: Vec<Point6> =
            (0..30).map(|k| pose(2.0 + 3e-5 * f64::from(k), 0.02 * f64::from(k))).collect();
        let poses: Vec<Point6> = [pose(0.0, 0.0)].into_iter().chain(turn).chain([pose(4.0, 0.58)]).collect();
        let cleaned = clean(&poses, ALLOWED);
        assert_eq!(kept(&poses), [0, 1, 30, 31]);
        assert_eq!(tip(&cleaned.kept[1].1), tip(&cleaned.kept[2].1));
    }

    #[test]
    fn a_turn_away_and_back_keeps_its_turning_point() {
        let leans = [0.0, 0.1, 0.2, 0.1, 0.0];
        let turn: Vec<Point6> = leans.iter().map(|lean| pose(0.0, *lean)).chain([pose(1.0, 0.0)]).collect();
        assert_eq!(kept(&turn), [0, 2, 4, 5]);
        let corner = [pose(0.0, 0.0), join(Vector3::zeros(), Vector3::new(0.0, 5.0, 49.0)), pose(0.0, 0.3)];
        assert_eq!(kept(&corner), [0, 1, 2]);
    }
}
