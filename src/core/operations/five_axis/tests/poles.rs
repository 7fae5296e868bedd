//! Paths through poles, beside them and around them.

use nalgebra::Rotation3;
use proptest::prelude::*;

use super::*;
use crate::machine::Straying;
use crate::machine::named::{by_name, named};
use crate::operations::five_axis::{AtPole, path};
use crate::toolpath::path::Move;
use crate::toolpath::tool_axes::angle_between;

/// The tolerance of the axis in these tests, degrees.
const TOLERANCE_DEG: f64 = 0.2;

/// A turn of 50 degrees over 80 mm, whose axis passes `off` degrees beside +Z.
fn across(off: f64, n: usize) -> Vec<Pose> {
    let along = Vector3::new(0.4_f64.cos(), 0.4_f64.sin(), 0.0);
    let middle = Rotation3::new(along * off.to_radians()) * Vector3::z();
    let about = Unit::new_normalize(middle.cross(&along));
    let pose = |k: usize| {
        let part = k as f64 / n as f64;
        let turn = Rotation3::from_axis_angle(&about, (50.0 * part - 25.0).to_radians());
        Pose { tip: Point3::new(80.0 * part, 0.0, 0.0), axis: Unit::new_normalize(turn * middle) }
    };
    (0..=n).map(pose).collect()
}

fn on(machine: &crate::machine::Machine, poses: Vec<Pose>) -> Job {
    Job {
        machine: Some(machine.clone()),
        limits: Some(limits()),
        tolerance_axis: TOLERANCE_DEG.to_radians(),
        tolerance_mm: 0.01,
        period_s: 0.001,
        ..job(poses, Method::Interpolating)
    }
}

/// The time of half a turn of a rotary axis from rest to rest within the limits, s.
fn half_turn_s() -> f64 {
    let [speed, acceleration, jerk] = limits_of('C');
    180.0 / speed + speed / acceleration + acceleration / jerk
}

#[test]
fn two_poses_across_a_pole_take_little_longer_than_away_from_it_on_every_machine() {
    for machine in named() {
        let away = plan(&on(&machine, across(30.0, 1)), &Budget::unlimited()).unwrap().report.cycle_time_s;
        for off in [0.0, 1e-8, 1e-6, 1e-5, 1e-4, 1e-3, 0.01, 0.05, 0.0999, 0.11, 0.2, 0.5, 2.0, 5.0] {
            let name = format!("{} {off}", machine.name());
            let plan = assert_driven(&name, &on(&machine, across(off, 1)));
            let Report { cycle_time_s, limits_proved, within_tolerance, .. } = plan.report;
            assert!(cycle_time_s <= 1.5 * away + half_turn_s(), "{name}: {cycle_time_s} s, away {away} s");
            assert_eq!((limits_proved, within_tolerance), (Some(true), true), "{name}");
        }
    }
}

#[test]
fn the_axis_is_within_its_tolerance_of_the_given_path_beside_poles() {
    let machine = by_name("table_table_ac").unwrap();
    for n in [1, 7, 40] {
        for off in [0.0, 1e-6, 1e-3, 0.05, 0.0999] {
            let job = on(&machine, across(off, n));
            let plan = assert_driven(&format!("{n} {off}"), &job);
            for sample in &plan.samples {
                let given = across(off, 4000);
                let nearest = &given[(sample.pose.tip.x / 80.0 * 4000.0).round() as usize];
                let angle = angle(&nearest.axis, &sample.pose.axis).to_degrees();
                assert!(angle <= plan.report.deviation_max_deg + 0.02, "{n} {off}: {angle}");
            }
            assert!(plan.report.deviation_max_deg <= TOLERANCE_DEG);
        }
    }
}

#[test]
fn an_upright_path_with_noise_rests_on_the_pole() {
    let machine = by_name("head_table_bc").unwrap();
    let upright = |noise: f64| {
        let pose = |k: usize| {
            let [x, y] = [7.3, 11.9].map(|rate| noise * (rate * (k * k) as f64).sin());
            Pose {
                tip: Point3::new(2.0 * k as f64, 0.0, 0.0),
                axis: Unit::new_normalize(Vector3::new(x, y, 1.0)),
            }
        };
        (0..=40).map(pose).collect::<Vec<_>>()
    };
    let clean = assert_driven("clean", &on(&machine, upright(0.0)));
    for noise in [1e-9, 1e-6, 1e-4, 1e-3] {
        let plan = assert_driven(&noise.to_string(), &on(&machine, upright(noise)));
        assert!(plan.report.cycle_time_s <= 1.05 * clean.report.cycle_time_s, "{noise}: {:?}", plan.report);
    }
}

#[test]
fn a_turn_over_a_pole_about_a_resting_tip_runs() {
    let machine = by_name("table_table_ac").unwrap();
    let pose = |x: f64, axis: [f64; 3]| Pose {
        tip: Point3::new(x, 0.0, 0.0),
        axis: Unit::new_normalize(Vector3::from(axis)),
    };
    let (before, after) = ([0.5, 0.0, 0.866], [0.0, 0.5, 0.866]);
    let path = [(0.0, before), (10.0, before), (10.0, [0.0, 0.0, 1.0]), (10.0, after), (20.0, after)];
    let plan = assert_driven("rest", &on(&machine, path.map(|(x, axis)| pose(x, axis)).to_vec()));
    assert!(plan.report.cycle_time_s < 6.0, "{:?}", plan.report);
}

#[test]
fn repeated_and_nearly_repeated_poses_cost_no_time() {
    let machine = by_name("table_table_bc").unwrap();
    let (pose, _) = paper_like();
    let clean: Vec<Pose> = (0..100).map(|k| pose(f64::from(k))).collect();
    let doubled: Vec<Pose> = clean
        .iter()
        .flat_map(|pose| [*pose, Pose { tip: pose.tip + Vector3::new(2e-6, 0.0, 0.0), ..*pose }])
        .collect();
    let [once, twice] = [clean, doubled].map(|poses| assert_driven("repeated", &on(&machine, poses)).report);
    assert!(twice.cycle_time_s <= 1.01 * once.cycle_time_s, "{twice:?} {once:?}");
}

#[test]
fn rounded_and_noisy_poses_cost_little_time() {
    let machine = by_name("table_table_bc").unwrap();
    let (pose, _) = paper_like();
    let path = |step: f64, noise: f64, digits: f64| -> Vec<Pose> {
        let rounded = |x: f64| (x * digits).round() / digits;
        let count = (60.0 / step) as usize;
        let one = |k: usize| {
            let Pose { tip, axis } = pose(step * k as f64);
            let off = |rate: f64| noise * (rate * (k * k) as f64).sin();
            let tip = tip + Vector3::new(off(7.3), off(11.9), off(3.1));
            Pose { tip: tip.map(rounded), axis }
        };
        (0..=count).map(one).collect()
    };
    for step in [0.05, 0.2, 1.0] {
        let clean = assert_driven("clean", &on(&machine, path(step, 0.0, 1e9))).report.cycle_time_s;
        for (noise, digits) in [(0.0, 1e3), (0.0, 1e4), (2e-3, 1e9)] {
            let name = format!("{step} {noise} {digits}");
            let noisy = assert_driven(&name, &on(&machine, path(step, noise, digits))).report.cycle_time_s;
            assert!(noisy <= 1.05 * clean, "{name}: {noisy} s for {clean} s");
        }
    }
}

/// What the tip does while the axis passes a pole.
#[derive(Debug, Clone, Copy)]
enum Tip {
    Straight,
    Corner,
    Rests,
}

/// A path across a pole, at `off` degrees beside it: once, or to and fro.
fn beside(off: f64, n: usize, tip: Tip, is_repeated: bool) -> Vec<Pose> {
    let one = across(off, n);
    let back = one.iter().rev().skip(1).filter(|_| is_repeated);
    let axes: Vec<Pose> = one.iter().chain(back).copied().collect();
    let last = (axes.len() - 1) as f64;
    let at = |k: usize, pose: &Pose| {
        let x = 60.0 * (k as f64 / last - 0.5);
        let tip = match tip {
            Tip::Straight => [x, 0.0, 0.0],
            Tip::Corner => [x, x.abs(), 0.0],
            Tip::Rests => [x.min(0.0) + (x - 15.0).max(0.0), 0.0, 0.0],
        };
        Pose { tip: tip.into(), ..*pose }
    };
    axes.iter().enumerate().map(|(k, pose)| at(k, pose)).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn any_path_beside_a_pole_runs_within_limits_and_tolerance(
        off in -8.0..0.7f64, n in 1usize..25, machine in 0..named().len(), is_repeated in any::<bool>(),
        tip in prop_oneof![Just(Tip::Straight), Just(Tip::Corner), Just(Tip::Rests)],
        has_limits in any::<bool>(),
    ) {
        let machine = named().swap_remove(machine);
        let job = on(&machine, beside(10f64.powf(off), n, tip, is_repeated));
        if has_limits {
            let report = assert_driven("beside", &job).report;
            prop_assert_eq!((report.limits_proved, report.within_tolerance), (Some(true), true));
        } else {
            let plan = plan(&Job { limits: None, ..job }, &Budget::unlimited()).unwrap();
            prop_assert!(plan.report.within_tolerance);
            for sample in &plan.samples {
                let found = machine.forward(&sample.joints.unwrap());
                prop_assert!(found.axis.angle(&sample.pose.axis) < 1e-7);
            }
        }
    }
}

#[test]
fn cleaning_and_leading_together_move_axes_by_at_most_half_of_the_tolerance() {
    let machine = by_name("table_table_ac").unwrap();
    let about = Unit::new_normalize(Vector3::new(1.0, 2.0, 0.0));
    let doubled: Vec<Pose> = across(0.097, 6)
        .into_iter()
        .flat_map(|pose| {
            let turned = Rotation3::from_axis_angle(&about, 0.0095_f64.to_radians()) * pose.axis;
            [pose, Pose { axis: turned, ..pose }]
        })
        .collect();
    let job = on(&machine, doubled);
    let path = path(&job, true).unwrap();
    assert!(path.moved.axis > 0.0 && path.moved.axis <= 0.5 * job.tolerance_axis, "{:?}", path.moved);
    assert!(plan(&job, &Budget::unlimited()).unwrap().report.within_tolerance);
}

#[test]
fn a_job_chooses_what_its_path_does_at_poles() {
    let machine = by_name("table_table_ac").unwrap();
    let run = |at_pole: AtPole| {
        plan(&Job { at_pole, ..on(&machine, across(0.01, 3)) }, &Budget::unlimited())
            .map(|plan| [plan.report.n_through_poles, plan.report.n_around_poles])
    };
    assert_eq!(run(AtPole::Quickest), Ok([1, 0]));
    assert_eq!(run(AtPole::Through), Ok([1, 0]));
    assert_eq!(run(AtPole::Around), Ok([0, 1]));
    assert!(matches!(run(AtPole::Refuse), Err(FiveAxisError::OnPole { .. })));
    let away = Job { at_pole: AtPole::Refuse, ..on(&machine, across(1.0, 3)) };
    assert_eq!(plan(&away, &Budget::unlimited()).unwrap().report.n_through_poles, 0);
}

#[test]
fn the_moves_for_a_program_hold_the_positions_of_the_motion_and_stray_by_no_more_than_allowed() {
    for machine in named() {
        for (off, limits) in [(0.0, true), (0.02, true), (0.5, true), (0.02, false), (30.0, true)] {
            let allowed = Straying { tip_mm: 0.002, axis: 2e-4 };
            let mut job = Job { in_step: Some(allowed), ..on(&machine, across(off, 1)) };
            job.limits = job.limits.filter(|_| limits);
            let plan = plan(&job, &Budget::unlimited()).unwrap();
            let name = format!("{} {off} {limits}", machine.name());
            let mut from = plan.toolpath.start();
            for pass in plan.toolpath.passes() {
                let rotary = pass.rotary().unwrap();
                assert_eq!(rotary.ends.len(), pass.moves().len(), "{name}");
                let mut before = machine.at(&from, rotary.start);
                for (k, step) in pass.moves().iter().enumerate() {
                    if let Move::Feed { along, .. } = step {
                        from = along.end();
                    }
                    let joints = machine.at(&from, rotary.ends[k]);
                    let axis = machine.forward(&joints).axis;
                    assert!(angle_between(&axis, &pass.axes().after(k)) < 1e-9, "{name}: move {k}");
                    let straying = machine.straying(&before, &joints);
                    assert!(
                        straying.axis <= allowed.axis && straying.tip_mm <= allowed.tip_mm,
                        "{name}: {k}"
                    );
                    before = joints;
                }
            }
            // The same branch and turns as in the samples.
            let last = plan.samples.last().and_then(|sample| sample.joints).unwrap().rotary;
            let end = plan.toolpath.passes().last().and_then(|pass| pass.rotary()?.ends.last().copied());
            assert!((0..2).all(|k| (end.unwrap()[k] - last[k]).abs() < 1e-9), "{name}");
        }
    }
}
