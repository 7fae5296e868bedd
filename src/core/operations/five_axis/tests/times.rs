//! Times of motions within limits: beside their lower bounds, and never longer with more room.

use proptest::prelude::*;

use super::*;
use crate::machine::named::by_name;
use crate::toolpath::path::{Move, Role};

/// A larger room may cost this much: other rails and other nodes.
const MORE: f64 = 1.02;

fn driven(poses: &[Pose], mm_per_min: f64) -> Job {
    Job {
        path: at_feed(poses, mm_per_min),
        machine: by_name("table_table_ac"),
        limits: Some(limits()),
        tolerance_mm: 0.01,
        tolerance_axis: 0.2_f64.to_radians(),
        period_s: 0.001,
        ..job(poses.to_vec(), Method::Interpolating)
    }
}

fn report(job: &Job) -> Report {
    let report = plan(job, &Budget::unlimited()).unwrap().report;
    let bound = report.cycle_time_lower_bound_s.unwrap();
    assert!(report.cycle_time_s >= bound && bound > 0.0, "{} {bound}", report.cycle_time_s);
    report
}

/// The time as a multiple of its lower bound.
fn ratio(job: &Job) -> f64 {
    let report = report(job);
    report.cycle_time_s / report.cycle_time_lower_bound_s.unwrap()
}

fn leaning(x: f64, y: f64, [i, j]: [f64; 2]) -> Pose {
    Pose { tip: Point3::new(x, y, 0.0), axis: Unit::new_normalize(Vector3::new(i, j, 1.0)) }
}

#[test]
fn nodes_beside_each_other_do_not_hold_the_motion_down() {
    // The middle of the path is a tenth of a micrometre beside its second pose.
    let poses = [[0.0, 0.0], [10.0, 0.001], [20.0, 0.004]].map(|[x, y]| leaning(x, y, [0.0, 0.3]));
    for feed in [500.0, 1000.0, 2000.0, 3000.0, 6000.0, 20_000.0] {
        let found = ratio(&driven(&poses, feed));
        assert!(found <= 1.01, "{feed}: {found}");
    }
}

#[test]
fn four_hundred_blocks_of_a_micrometre_take_as_long_as_four() {
    let curve = |count: usize| -> Vec<Pose> {
        let at = |k: usize| 0.4 * k as f64 / count as f64;
        (0..=count).map(at).map(|t| leaning(t, 0.1 * t * t, [0.17 - 0.17 * t, 0.26])).collect()
    };
    let [few, many] = [4, 400].map(|count| report(&driven(&curve(count), 3000.0)));
    assert_eq!((few.n_stops, many.n_stops), (0, 0));
    assert!(many.cycle_time_s <= MORE * few.cycle_time_s, "{many:?} {few:?}");
}

#[test]
fn steps_far_below_the_tolerance_are_no_stops() {
    let poses: Vec<Pose> = (0..20)
        .map(f64::from)
        .map(|k| leaning(3e-4 * k, 0.0, [0.17 * (0.3 * k).cos(), 0.26 + 0.05 * (0.4 * k).sin()]))
        .collect();
    assert_eq!(report(&driven(&poses, 3000.0)).n_stops, 0);
}

#[test]
fn on_the_pole_the_tool_moves_as_one_with_three_axes() {
    let curve = |count: i32| -> Vec<Pose> {
        (0..=count)
            .map(|k| 40.0 * f64::from(k) / f64::from(count))
            .map(|t| leaning(t, 0.01 * t * t, [0.0; 2]))
            .collect()
    };
    for method in [Method::Interpolating, Method::Tube, Method::Paper] {
        for count in [3, 40] {
            let job = Job { method, ..driven(&curve(count), 3000.0) };
            let three_axes = Job { machine: None, ..job.clone() };
            let [five, three] = [&job, &three_axes].map(report);
            assert_eq!(five.n_stops, 0, "{method:?} {count}");
            assert_eq!(five.limits_proved, Some(true));
            assert!(five.cycle_time_s <= 1.001 * three.cycle_time_s, "{method:?} {count}");
            assert!(five.axis_peaks.iter().all(|own| own.axis >= 'X' || own.speed == 0.0));
        }
    }
}

#[test]
fn kinks_of_the_axis_are_run_through() {
    for kink_deg in [0.01, 0.1, 0.19, 1.0, 5.0, 20.0] {
        let slope = (kink_deg / 40.0_f64).to_radians();
        let poses: Vec<Pose> = (0..=4)
            .map(f64::from)
            .map(|k| leaning(20.0 * k, 0.0, [0.2, 0.3 + 20.0 * slope * (k - 2.0).max(0.0)]))
            .collect();
        assert_eq!(report(&driven(&poses, 3000.0)).n_stops, 0, "{kink_deg}");
    }
}

#[test]
fn a_turn_about_a_tip_that_trembles_is_one_turn() {
    let turn = |tremble: f64| -> Vec<Pose> {
        let wander = |k: i32| tremble * f64::from((k * 7 % 5) - 2) / 2.0;
        let turn =
            (0..20).map(|k| leaning(20.0 + wander(k), wander(k + 3), [0.1 + 0.02 * f64::from(k), 0.2]));
        [leaning(0.0, 0.0, [0.1, 0.2])]
            .into_iter()
            .chain(turn)
            .chain([leaning(40.0, 0.0, [0.48, 0.2])])
            .collect()
    };
    let [still, trembling] = [0.0, 1e-3].map(|tremble| report(&driven(&turn(tremble), 3000.0)));
    assert_eq!(trembling.n_stops, still.n_stops);
    assert!(trembling.cycle_time_s <= MORE * still.cycle_time_s, "{trembling:?} {still:?}");
}

/// A gently curved path: its length, how it bends, how its axis leans and turns, and the number of poses.
fn gentle() -> impl Strategy<Value = Vec<Pose>> {
    let lengths = prop_oneof![0.2..2.0_f64, 5.0..150.0];
    let counts = prop_oneof![2..6_usize, 6..200_usize];
    (lengths, -0.02..0.02_f64, [-0.4..0.4_f64, -0.4..0.4], -0.3..0.3_f64, counts).prop_map(
        |(length, bend, [i, j], turn, count)| {
            let at = |k: usize| k as f64 / (count - 1) as f64;
            let pose = |t: f64| leaning(length * t, bend * length * t * t, [i + turn * (2.0 * t).sin(), j]);
            (0..count).map(at).map(pose).collect()
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn more_room_never_takes_longer(
        poses in gentle(), feed in 200.0..20_000.0_f64, factor in 1.0..4.0_f64, tube in any::<bool>()
    ) {
        let method = if tube { Method::Tube } else { Method::Interpolating };
        let job = Job { method, ..driven(&poses, feed) };
        let seconds = report(&job).cycle_time_s;
        let mut limits = limits();
        for (_, own) in &mut limits.axes {
            let schedule::Limits { speed, acceleration, jerk } = own;
            [speed, acceleration, jerk].into_iter().for_each(|limit| *limit *= factor);
        }
        let faster = Job { path: at_feed(&poses, feed * factor), ..job.clone() };
        let stronger = Job { limits: Some(limits), ..job.clone() };
        for (name, roomier) in [("feed", faster), ("limits", stronger)] {
            let found = report(&roomier).cycle_time_s;
            prop_assert!(found <= MORE * seconds, "{}: {} s, before {} s", name, found, seconds);
        }
    }

    #[test]
    fn gentle_paths_take_little_more_than_their_lower_bound(poses in gentle()) {
        let report = report(&driven(&poses, 3000.0));
        let bound = report.cycle_time_lower_bound_s.unwrap();
        prop_assert!(report.cycle_time_s <= 1.5 * bound, "{} s, bound {} s", report.cycle_time_s, bound);
    }
}

#[test]
fn every_move_ends_where_the_motion_is_at_its_time() {
    let mut poses: Vec<Pose> =
        (0..=20).map(f64::from).map(|t| leaning(2.0 * t, 0.05 * t * t, [0.17 - 0.01 * t, 0.26])).collect();
    // The tip rests while the axis turns.
    poses.push(leaning(40.0, 20.0, [0.3, 0.1]));
    poses.push(leaning(50.0, 20.0, [0.3, 0.1]));
    for limits in [None, Some(limits())] {
        let mut job = Job { limits, period_s: 1e-4, ..driven(&poses, 3000.0) };
        job.path[10].pace = Pace::Rapid;
        let Plan { toolpath, move_ends_s, samples, report, .. } = plan(&job, &Budget::unlimited()).unwrap();
        assert!(move_ends_s.is_sorted() && move_ends_s.len() == toolpath.moves().count());
        assert!((move_ends_s[move_ends_s.len() - 1] - report.cycle_time_s).abs() < 1e-9);
        let (mut at, mut n_kinds) = (toolpath.start(), [0; 3]);
        for (step, t_s) in toolpath.moves().zip(&move_ends_s) {
            match step {
                Move::Feed { role: Role::LeadIn | Role::LeadOut, along, .. } => {
                    at = along.end();
                    continue;
                }
                Move::Rapid { line } => (at, n_kinds[0]) = (line.end, n_kinds[0] + 1),
                Move::Feed { along, .. } => (at, n_kinds[1]) = (along.end(), n_kinds[1] + 1),
                Move::Turn { .. } | Move::Dwell { .. } => n_kinds[2] += 1,
            }
            let k = samples.partition_point(|sample| sample.t_s < *t_s).clamp(1, samples.len() - 1);
            let [before, after] = [&samples[k - 1], &samples[k]];
            let part = (t_s - before.t_s) / (after.t_s - before.t_s);
            let tip = before.pose.tip + (after.pose.tip - before.pose.tip) * part;
            assert!((tip - at).norm() < 1e-2, "{t_s}: {tip} {at}");
        }
        assert!(n_kinds.iter().all(|count| *count > 0), "{n_kinds:?}");
    }
}
