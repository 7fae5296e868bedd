use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::{Point3, UnitVector3, Vector3};
use proptest::prelude::*;

use super::*;
use crate::machine::named::{by_name, named};
use crate::machine::{Kind, RotaryAxis};

/// A pose whose axis is tilted by `tilt` from Z toward the direction `about` in the plane XY, both in
/// radians.
fn leaning(tip: [f64; 3], tilt: f64, about: f64) -> Pose {
    let (sin, cos) = about.sin_cos();
    let axis = Vector3::new(tilt.sin() * cos, tilt.sin() * sin, tilt.cos());
    Pose { tip: Point3::from(tip), axis: UnitVector3::new_normalize(axis) }
}

/// Poses on a circle whose axes lean outward by `tilt`, over the given range of angles.
fn cone(tilt: f64, [from, to]: [f64; 2], count: usize) -> Vec<Pose> {
    let at = |k: usize| from + (to - from) * k as f64 / (count - 1) as f64;
    (0..count).map(|k| leaning([40.0 * at(k).cos(), 40.0 * at(k).sin(), 5.0], tilt, at(k))).collect()
}

/// Poses along X whose axes lean from -`tilt` to `tilt` toward the direction `about`.
fn over_the_pole(tilt: f64, about: f64, count: usize) -> Vec<Pose> {
    let at = |k: usize| 2.0 * k as f64 / (count - 1) as f64 - 1.0;
    (0..count).map(|k| leaning([50.0 * at(k), 0.0, 0.0], tilt * at(k), about)).collect()
}

/// A machine with other travels of its rotary axes, in degrees.
fn with_travel(machine: &Machine, travel_deg: [Option<[f64; 2]>; 2]) -> Machine {
    let mut rotary = *machine.rotary();
    for (axis, travel) in rotary.iter_mut().zip(travel_deg) {
        let travel = travel.map(|ends| ends.map(f64::to_radians));
        *axis = RotaryAxis { travel, is_wrapped: false, ..*axis };
    }
    Machine::new("", machine.kind(), rotary, machine.travel_mm(), machine.pivot_mm()).unwrap()
}

/// Checks what `follow` promises of every motion, and returns its largest step.
fn check(machine: &Machine, poses: &[Pose], joints: &[AxisPositions]) -> f64 {
    assert_eq!(poses.len(), joints.len());
    let mut largest = 0.0f64;
    for (k, (pose, joints)) in poses.iter().zip(joints).enumerate() {
        let made = machine.forward(joints);
        let miss = (made.tip - pose.tip).norm().max((made.axis.into_inner() - pose.axis.into_inner()).norm());
        assert!(miss < 1e-10, "pose {k} is missed by {miss}");
        assert_eq!(machine.linear_out_of_travel(&joints.linear_mm), None, "pose {k}");
        for (axis, &angle) in machine.rotary().iter().zip(&joints.rotary) {
            assert!(is_within(axis.travel, angle), "pose {k}: {} at {angle}", axis.name);
        }
    }
    for pair in joints.windows(2) {
        let step = (0..2).map(|k| (pair[1].rotary[k] - pair[0].rotary[k]).abs()).fold(0.0, f64::max);
        assert!(step <= PI + 1e-6);
        largest = largest.max(step);
    }
    largest
}

fn followed(machine: &Machine, poses: &[Pose]) -> (Vec<AxisPositions>, f64) {
    let joints = machine.follow(poses, [0.0; 2]).unwrap();
    let largest = check(machine, poses, &joints);
    (joints, largest)
}

#[test]
fn a_cone_turns_c_evenly_and_holds_the_tilt() {
    for machine in named() {
        let poses = cone(0.3, [0.2, 0.2 + 1.5 * PI], 271);
        let (joints, largest) = followed(&machine, &poses);
        let c = machine.free_axis();
        assert!((largest - 1f64.to_radians()).abs() < 1e-9, "{} {largest}", machine.name());
        assert!(joints.iter().all(|at| (at.rotary[1 - c] - joints[0].rotary[1 - c]).abs() < 1e-9));
        let turned = (joints[270].rotary[c] - joints[0].rotary[c]).abs();
        assert!((turned - 1.5 * PI).abs() < 1e-9);
    }
}

#[test]
fn a_straight_path_through_the_pole_tilts_through_and_does_not_turn() {
    for machine in named() {
        let is_nutating = machine.name().contains("nutating");
        let machine = with_travel(&machine, [Some([-170.0, 170.0]); 2]);
        let c = machine.free_axis();
        // With and without a pose at the pole itself.
        for count in [41, 40] {
            let (joints, largest) = followed(&machine, &over_the_pole(0.4, 1.0, count));
            let step = 0.8 / (count - 1) as f64;
            assert!(joints[0].rotary[1 - c] * joints[count - 1].rotary[1 - c] < 0.0);
            if is_nutating {
                // B turns by more than the tilt, and C makes up for the sideways part.
                assert!(largest < 1.5 * step);
                continue;
            }
            assert!((largest - step).abs() < 1e-9);
            assert!(joints.iter().all(|at| (at.rotary[c] - joints[0].rotary[c]).abs() < 1e-9));
        }
    }
}

#[test]
fn the_travel_of_a_forces_half_a_turn_of_c_at_the_pole() {
    let machine =
        with_travel(&by_name("table_table_ac").unwrap(), [Some([-5.0, 110.0]), Some([-360.0, 360.0])]);
    for count in [41, 40] {
        let (joints, largest) = followed(&machine, &over_the_pole(0.4, 1.0, count));
        assert!(joints.iter().all(|at| at.rotary[0] > -1e-9));
        assert!(((joints[count - 1].rotary[1] - joints[0].rotary[1]).abs() - PI).abs() < 1e-9);
        // The pose at the pole halves the turn: half before it and half behind it.
        let expected = if count == 41 { FRAC_PI_2 } else { PI };
        assert!((largest - expected).abs() < 1e-9, "{largest}");
    }
}

#[test]
fn the_branch_is_chosen_by_the_travel_of_a() {
    for (travel, sign) in [([-5.0, 110.0], 1.0), ([-110.0, 5.0], -1.0)] {
        let machine = with_travel(&by_name("table_table_ac").unwrap(), [Some(travel), Some([-360.0, 360.0])]);
        let (joints, _) = followed(&machine, &cone(1.0, [0.0, PI], 100));
        assert!(joints.iter().all(|at| (at.rotary[0] - sign).abs() < 1e-9));
    }
}

#[test]
fn the_end_of_the_path_decides_the_branch_of_its_start() {
    // Both branches are possible at first; later the tilt fits in one of them only.
    let machine = with_travel(&by_name("table_table_ac").unwrap(), [Some([-20.0, 110.0]), None]);
    let tilt = |k: usize| (10.0 + k as f64).to_radians();
    let poses: Vec<Pose> = (0..60).map(|k| leaning([0.0; 3], tilt(k), -FRAC_PI_2)).collect();
    let (joints, _) = followed(&machine, &poses);
    assert!(joints[0].rotary[0] > 0.0);
    assert!((joints[0].rotary[1].abs() - PI).abs() < 1e-9);
    // The part that fits in both takes the branch without a turn.
    let (joints, _) = followed(&machine, &poses[..5]);
    assert!(joints[0].rotary[0] < 0.0 && joints[0].rotary[1].abs() < 1e-9);
}

#[test]
fn the_free_angle_is_interpolated_by_the_way_of_the_tip() {
    let machine = by_name("table_table_ac").unwrap();
    // The tool leans toward +Y, stands upright at 1, 2 and 5 mm, and leans at a right angle to before.
    let mut poses = vec![leaning([0.0; 3], 0.1, FRAC_PI_2)];
    poses.extend([1.0, 2.0, 5.0].map(|x| leaning([x, 0.0, 0.0], 0.0, 0.0)));
    poses.push(leaning([8.0, 0.0, 0.0], 0.1, 0.0));
    let (joints, _) = followed(&machine, &poses);
    let (from, to) = (joints[0].rotary[1], joints[4].rotary[1]);
    assert!(((to - from).abs() - FRAC_PI_2).abs() < 1e-9);
    for (at, part) in joints.iter().zip([0.0, 1.0, 2.0, 5.0, 8.0].map(|x| x / 8.0)) {
        assert!((at.rotary[1] - (from + part * (to - from))).abs() < 1e-9);
    }
    // A tip that stands still interpolates by the count.
    let still: Vec<Pose> = poses.iter().map(|pose| Pose { tip: Point3::origin(), ..*pose }).collect();
    let (joints, _) = followed(&machine, &still);
    assert!((joints[1].rotary[1] - (0.75 * from + 0.25 * to)).abs() < 1e-9);
}

#[test]
fn the_free_angle_is_constant_at_both_ends_of_the_path() {
    for machine in named() {
        let upright = |x| leaning([x, 0.0, 0.0], 0.0, 0.0);
        let mut poses = vec![upright(-2.0), upright(-1.0)];
        poses.extend((0..10).map(|k| leaning([f64::from(k), 0.0, 0.0], 0.2, 1.0 + 0.1 * f64::from(k))));
        poses.extend([upright(11.0), upright(12.0)]);
        let (joints, _) = followed(&machine, &poses);
        let c = machine.free_axis();
        for (at, like) in [(0, 2), (1, 2), (12, 11), (13, 11)] {
            assert_eq!(joints[at].rotary[c], joints[like].rotary[c]);
        }
    }
}

#[test]
fn a_path_at_the_pole_all_along_keeps_the_angle_of_the_start() {
    for machine in named() {
        let poses: Vec<Pose> = (0..20).map(|k| leaning([f64::from(k), 3.0, 0.0], 0.0, 0.0)).collect();
        let mut start = [0.0; 2];
        start[machine.free_axis()] = 0.7;
        let joints = machine.follow(&poses, start).unwrap();
        assert_eq!(check(&machine, &poses, &joints), 0.0);
        assert!(joints.iter().all(|at| at.rotary[machine.free_axis()] == 0.7));
    }
}

#[test]
fn at_the_pole_the_table_turns_where_the_linear_travel_needs_it() {
    let machine = by_name("table_table_ac").unwrap();
    // Y ends at 400 mm and X at 500 mm.
    let poses = [leaning([0.0, 450.0, 0.0], 0.0, 0.0)];
    let (joints, _) = followed(&machine, &poses);
    assert!(joints[0].linear_mm[0].abs() > 200.0);
    let far = [poses[0], leaning([0.0, 900.0, 0.0], 0.0, 0.0)];
    assert!(matches!(machine.follow(&far, [0.0; 2]), Err(FollowError::OutOfTravel { index: 1, .. })));
}

#[test]
fn winding_beyond_the_travel_names_the_latest_place() {
    // Five turns; C has two turns of travel, and starts at either end.
    let machine = by_name("table_table_ac").unwrap();
    let poses = cone(0.3, [0.0, 5.0 * TAU], 5 * 360 + 1);
    let error = machine.follow(&poses, [0.0; 2]).unwrap_err();
    let FollowError::Unwinds { index, axis: 'C' } = error else { panic!("{error}") };
    // The first pose is 90 degrees from the end of travel: 1.75 turns, or 1.25, whichever branch is longer.
    assert_eq!(index, 630 + 1);
    assert!(machine.follow(&poses[..index], [0.0; 2]).is_ok());
    let rest = machine.follow(&poses[index..index + 540], [0.0; 2]).unwrap();
    check(&machine, &poses[index..index + 540], &rest);
}

#[test]
fn a_wrapped_axis_turns_on_without_end_and_is_shown_within_one_turn() {
    let machine = by_name("table_table_bc").unwrap();
    let poses = cone(0.3, [0.0, 20.0 * TAU], 20 * 90 + 1);
    let (joints, largest) = followed(&machine, &poses);
    assert!((largest - TAU / 90.0).abs() < 1e-9);
    assert!(((joints[1800].rotary[1] - joints[0].rotary[1]).abs() - 20.0 * TAU).abs() < 1e-9);
    let c = machine.rotary()[1];
    assert!(joints.iter().all(|at| (0.0..TAU).contains(&c.shown(at.rotary[1]))));
}

#[test]
fn a_branch_does_not_change_away_from_the_pole() {
    // A must go from positive to negative while the tool leans by 20 degrees: only a swing would do it.
    let machine =
        with_travel(&by_name("table_table_ac").unwrap(), [Some([-110.0, 110.0]), Some([-100.0, 100.0])]);
    let tilt = 20f64.to_radians();
    let poses = cone(tilt, [0.0, TAU], 361);
    let error = machine.follow(&poses, [0.0; 2]).unwrap_err();
    assert!(matches!(error, FollowError::Unwinds { axis: 'C', .. }), "{error}");
}

#[test]
fn places_out_of_reach_and_out_of_travel_are_named() {
    let nutating = by_name("table_table_nutating_bc").unwrap();
    let poses = [leaning([0.0; 3], 0.5, 0.0), leaning([0.0; 3], 1.6, 0.0)];
    assert_eq!(nutating.follow(&poses, [0.0; 2]), Err(FollowError::Unreachable { index: 1 }));
    let machine = by_name("table_table_ac").unwrap();
    let far = [leaning([0.0; 3], 0.5, 0.0), leaning([0.0, 0.0, 900.0], 0.2, 0.0)];
    assert_eq!(machine.follow(&far, [0.0; 2]), Err(FollowError::OutOfTravel { index: 1, axis: 'Z' }));
    let steep = [leaning([0.0; 3], 2.5, 0.0)];
    assert_eq!(machine.follow(&steep, [0.0; 2]), Err(FollowError::OutOfTravel { index: 0, axis: 'A' }));
    assert_eq!(machine.follow(&[], [0.0; 2]), Ok(vec![]));
    for start in [f64::NAN, f64::INFINITY, -1e6] {
        assert_eq!(machine.follow(&far, [0.0, start]), Err(FollowError::UnusableStart { axis: 'C' }));
    }
}

#[test]
fn a_travel_of_many_turns_is_followed_to_both_ends() {
    let machine =
        with_travel(&by_name("table_table_ac").unwrap(), [Some([-120.0, 30.0]), Some([-36e4, 36e4])]);
    for turns in [-1500.0, 1500.0] {
        let (joints, _) = followed(&machine, &cone(0.3, [0.0, turns * TAU], 15_001));
        assert!((joints[15_000].rotary[1] - joints[0].rotary[1]).abs() > 1499.0 * TAU);
    }
}

/// Branch and angles at each pose, the largest step and the total.
type Way = (Vec<(usize, [f64; 2])>, f64, f64);

/// The least largest step and the least total after it, over all sequences of states, by trying them all.
fn by_trying_all(machine: &Machine, poses: &[Pose]) -> Option<(f64, f64)> {
    let mut ways: Vec<Way> = vec![(Vec::new(), 0.0, 0.0)];
    for pose in poses {
        let Inverse::Two(both) = machine.inverse(pose) else { return None };
        let mut longer = Vec::new();
        for (way, largest, total) in &ways {
            for (branch, joints) in both.iter().enumerate() {
                for node in 0..49 {
                    let turns = [node / 7 - 3, node % 7 - 3].map(f64::from);
                    let rotary = [0, 1].map(|k| joints.rotary[k] + TAU * turns[k]);
                    let fits = (0..2).all(|k| is_within(machine.rotary[k].travel, rotary[k]));
                    let before = way.last().map_or([0.0; 2], |last| last.1);
                    let [a, b] = [0, 1].map(|k| (rotary[k] - before[k]).abs());
                    let step = a.max(b);
                    let changes = way.last().is_some_and(|last| last.0 != branch);
                    if !fits || changes || (!way.is_empty() && step > PI) {
                        continue;
                    }
                    let mut next = way.clone();
                    next.push((branch, rotary));
                    longer.push((next, if way.is_empty() { 0.0 } else { largest.max(step) }, total + a + b));
                }
            }
        }
        ways = longer;
    }
    let least = ways.iter().map(|way| way.1).fold(f64::INFINITY, f64::min);
    let total = ways.iter().filter(|way| way.1 < least + 1e-9).map(|way| way.2).fold(f64::INFINITY, f64::min);
    least.is_finite().then_some((least, total))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_other_motion_of_the_same_branches_is_better(
        which in 0usize..6, lean in prop::collection::vec((0.8f64..0.9, -0.2f64..0.8), 1..12), first in -PI..PI,
        low in -3.0 * PI..-0.5 * PI, high in 0.5 * PI..3.0 * PI,
    ) {
        let machine = &named()[which];
        let mut travel = [Some([-190.0, 190.0]); 2];
        travel[machine.free_axis()] = Some([low.to_degrees(), high.to_degrees()]);
        let machine = with_travel(machine, travel);
        let mut about = first;
        let poses: Vec<Pose> = lean.iter().map(|&(tilt, turn)| {
            about += turn;
            leaning([0.0; 3], tilt, about)
        }).collect();
        let joints = machine.follow(&poses, [0.0; 2]);
        match by_trying_all(&machine, &poses) {
            None => prop_assert!(joints.is_err()),
            Some((least, total)) => {
                let joints = joints.unwrap();
                prop_assert!(check(&machine, &poses, &joints) < least + 2e-9);
                let mut before = [0.0; 2];
                let mut sum = 0.0;
                for at in &joints {
                    sum += (0..2).map(|k| (at.rotary[k] - before[k]).abs()).sum::<f64>();
                    before = at.rotary;
                }
                prop_assert!(sum < total + 1e-6, "{} {}", sum, total);
            }
        }
    }

    #[test]
    fn every_motion_keeps_its_poses_and_travels(
        which in 0usize..6, corners in prop::collection::vec((-0.6..0.6, -0.6..0.6), 2..8), start in -7.0..7.0,
    ) {
        // Axes along a polygon around the pole, through it where corners are opposite.
        let machine = &named()[which];
        let mut poses = Vec::new();
        for pair in corners.windows(2) {
            for k in 0..20 {
                let part = f64::from(k) / 20.0;
                let x: f64 = pair[0].0 + part * (pair[1].0 - pair[0].0);
                let y: f64 = pair[0].1 + part * (pair[1].1 - pair[0].1);
                let axis = UnitVector3::new_normalize(Vector3::new(x, y, 1.0));
                poses.push(Pose { tip: Point3::new(50.0 * x, 50.0 * y, 0.0), axis });
            }
        }
        match machine.follow(&poses, [start; 2]) {
            Ok(joints) => { check(machine, &poses, &joints); }
            Err(FollowError::Unwinds { index, .. }) => {
                // The part before the named place can be followed.
                prop_assert!(index > 0);
                let part = &poses[..index];
                check(machine, part, &machine.follow(part, [start; 2]).unwrap());
            }
            Err(error) => prop_assert!(false, "{}", error),
        }
    }
}

#[test]
fn a_head_and_a_table_follow_the_same_path_by_opposite_angles() {
    // A tool on a C-B head and a workpiece on a B-C table, through the same points.
    let tilts = |kind, rotary: [char; 2]| {
        let axis = |name| RotaryAxis {
            name,
            direction: if name == 'C' { Vector3::z_axis() } else { Vector3::y_axis() },
            point_mm: Point3::origin(),
            travel: None,
            is_wrapped: false,
            is_mirrored: false,
        };
        let machine = Machine::new("", kind, rotary.map(axis), [None; 3], 0.0).unwrap();
        followed(&machine, &cone(0.5, [0.3, 2.0], 50)).0
    };
    let (head, table) = (tilts(Kind::HeadHead, ['C', 'B']), tilts(Kind::TableTable, ['B', 'C']));
    for (head, table) in head.iter().zip(&table) {
        assert!((head.rotary[0] + table.rotary[1]).abs() < 1e-12);
        assert!((head.rotary[1] + table.rotary[0]).abs() < 1e-12);
    }
}
