//! Cleans a path within a small tolerance before anything passes through its poses.
//!
//! # Method
//! 1. Neighbouring poses whose tips are within the tolerance of the first of them share one tip: the tool
//!    rests there. Small steps of a path that goes on straight stay if the axis turns along them. Poses that
//!    wander about one place share one tip even if they wander farther.
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

/// The tool rests where poses wander by up to this multiple of the tolerance about one tip, far from others.
const WANDER: f64 = 5.0;

/// The least number of poses that wander, and how many times as long as their extent their way is.
const WANDERING_POSES: usize = 3;
const WANDERING_WAY: f64 = 2.0;

/// The next poses are far from those that wander, in multiples of how far these wander.
const FAR: f64 = 4.0;

/// The axis turns as fast as beside, by the way of the tip, at up to this multiple.
const ALIKE: f64 = 4.0;

/// Cleans a path of poses. Axes move by at most `allowed`, and so do tips, or by [`WANDER`] times as much
/// where they wander.
pub fn clean(poses: &[Point6], allowed: Deviation) -> Cleaned {
    let mut cleaned = Cleaned { kept: Vec::with_capacity(poses.len()), moved: Deviation::NONE };
    let mut first = 0;
    while first < poses.len() {
        let start = tip(&poses[first]);
        let within = |radius: f64| {
            let rest = poses[first..].iter().take_while(|pose| (tip(pose) - start).norm() <= radius);
            first + rest.count().max(1)
        };
        let (near, wide) = (within(allowed.tip_mm), within(WANDER * allowed.tip_mm));
        let end = if wanders(poses, [first, wide], WANDER * allowed.tip_mm) {
            wide
        } else if turns(poses, [first, near], allowed.axis) && goes_on(poses, [first, near], allowed.tip_mm) {
            first + 1
        } else {
            near
        };
        // The last pose keeps its tip, even if all tips are within the tolerance of the first.
        let is_whole = first == 0 && end == poses.len() && tip(&poses[end - 1]) != start;
        let end = if is_whole && end > 1 { end - 1 } else { end };
        cleaned.rest(poses, [first, end - 1], allowed.axis);
        first = end;
    }
    cleaned
}

/// Whether an axis of the poses from `first` to before `end` is farther than allowed from the first of them.
fn turns(poses: &[Point6], [first, end]: [usize; 2], allowed: f64) -> bool {
    poses[first..end].iter().any(|pose| angle_between(&top(pose), &top(&poses[first])) > allowed)
}

fn step(poses: &[Point6], k: usize) -> Vector3<f64> {
    tip(&poses[k + 1]) - tip(&poses[k])
}

/// Whether the tips of the poses from `first` to before `end` go to and fro within a radius, far from the
/// others.
fn wanders(poses: &[Point6], [first, end]: [usize; 2], radius: f64) -> bool {
    let is_far = |k: usize| step(poses, k).norm() > FAR * radius;
    let is_alone = (first == 0 || is_far(first - 1)) && (end == poses.len() || is_far(end - 1));
    let extent =
        poses[first..end].iter().map(|pose| (tip(pose) - tip(&poses[first])).norm()).fold(0.0, f64::max);
    let way: f64 = (first..end - 1).map(|k| step(poses, k).norm()).sum();
    is_alone && end - first >= WANDERING_POSES && way > WANDERING_WAY * extent
}

/// Whether the poses from `first` to before `end` are steps of a path that goes on straight, in steps as
/// small or with an axis that turns as fast.
fn goes_on(poses: &[Point6], [first, end]: [usize; 2], allowed: f64) -> bool {
    let beside = [first.checked_sub(1), (end < poses.len()).then_some(end - 1)];
    let rate = |k: usize| angle_between(&top(&poses[k]), &top(&poses[k + 1])) / step(poses, k).norm();
    let fastest = |steps: &mut dyn Iterator<Item = usize>| steps.map(rate).fold(0.0, f64::max);
    let small = beside.map(|k| k.filter(|k| step(poses, *k).norm() <= allowed));
    let alike = || fastest(&mut (first..end - 1)) <= ALIKE * fastest(&mut beside.into_iter().flatten());
    let [before, after] = match small {
        [None, None] if alike() => beside,
        [None, None] => return false,
        small => small,
    };
    let is_straight = |k: usize| {
        let [a, b] = [step(poses, k), step(poses, k + 1)];
        a.dot(&b) > 0.5 * a.norm() * b.norm()
    };
    (before.unwrap_or(first)..after.unwrap_or(end.saturating_sub(2))).all(is_straight)
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
    fn small_steps_of_a_path_that_goes_on_stay() {
        let poses: Vec<Point6> = (0..40).map(|k| pose(3e-4 * f64::from(k), 0.01 * f64::from(k))).collect();
        let cleaned = clean(&poses, ALLOWED);
        assert_eq!(cleaned.kept, poses.iter().copied().enumerate().collect::<Vec<_>>());
        let doubled: Vec<Point6> = poses.iter().flat_map(|pose| [*pose; 2]).collect();
        assert!(clean(&doubled, ALLOWED).kept.len() < 40);
    }

    #[test]
    fn poses_that_wander_about_one_place_share_its_tip() {
        let wandering = (0..20).map(|k| pose(2.0 + 2e-3 * f64::from(k % 2), 0.02 * f64::from(k)));
        let poses: Vec<Point6> =
            [pose(0.0, 0.0)].into_iter().chain(wandering).chain([pose(4.0, 0.4)]).collect();
        let cleaned = clean(&poses, ALLOWED);
        assert_eq!(kept(&poses), [0, 1, 20, 21]);
        assert_eq!(tip(&cleaned.kept[1].1), tip(&cleaned.kept[2].1));
        assert!((cleaned.moved.tip_mm - 2e-3).abs() < 1e-9);
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
