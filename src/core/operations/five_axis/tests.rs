//! Smoothing, seen from outside: paths of many kinds, judged at dense samples by code of its own.

mod judge;
mod laws;
mod poles;
mod times;

use nalgebra::{Point3, Unit, Vector3};

use super::*;
use crate::toolpath::pose::Waypoint;
use crate::toolpath::units::FeedRate;
use judge::{along_moves, farthest};

/// A path like the paper's: 134 legs along a wave with chords of 5 micrometres. The axis swings sideways.
fn paper_like() -> (impl Fn(f64) -> Pose, Vec<Pose>) {
    // The height of a chord is curvature times length squared by eight.
    let curve = |t: f64| Point3::new(t, 12.0 * (t / 18.0).sin(), 4.0 * (t / 25.0).cos());
    let axis = |t: f64| {
        let swing = 0.35 * (t / 9.0).sin();
        Unit::new_normalize(Vector3::new(0.1, swing.sin(), swing.cos()))
    };
    let pose = move |t: f64| Pose { tip: curve(t), axis: axis(t) };
    let mut poses = vec![pose(0.0)];
    let mut t = 0.0;
    while poses.len() < 135 {
        // The longest step whose chord is 5 micrometres high.
        let (mut low, mut high) = (t, t + 5.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            let chord = (curve(t), curve(middle));
            let height = (1..20)
                .map(|k| {
                    let p = curve(t + (middle - t) * f64::from(k) / 20.0);
                    let along = chord.1 - chord.0;
                    let from = p - chord.0;
                    (from - along * (from.dot(&along) / along.norm_squared())).norm()
                })
                .fold(0.0, f64::max);
            if height > 0.005 { high = middle } else { low = middle }
        }
        t = low;
        poses.push(pose(t));
    }
    (pose, poses)
}

fn at_feed(poses: &[Pose], mm_per_min: f64) -> Vec<Waypoint> {
    let pace = Pace::Feed(FeedRate::from_mm_per_min(mm_per_min).unwrap());
    poses.iter().map(|pose| Waypoint::new(*pose, pace)).collect()
}

fn given(job: &Job) -> Vec<Pose> {
    job.path.iter().map(|waypoint| waypoint.pose).collect()
}

/// The feed of a job with one feed, mm/s.
fn feed_of(job: &Job) -> f64 {
    let Pace::Feed(feed) = job.path[1].pace else { panic!("a rapid") };
    feed.mm_per_s()
}

pub(super) fn job(poses: Vec<Pose>, method: Method) -> Job {
    let period_s = 0.00025;
    Job { method, period_s, ..Job::new(at_feed(&poses, 3000.0), 0.005, 0.5_f64.to_radians()) }
}

fn upright(points: &[[f64; 3]]) -> Vec<Pose> {
    points.iter().map(|p| Pose { tip: Point3::from(*p), axis: Vector3::z_axis() }).collect()
}

fn tilted(x: f64, y: f64, tilt: f64) -> Pose {
    let axis = Unit::new_normalize(Vector3::new(0.0, tilt.sin(), tilt.cos()));
    Pose { tip: Point3::new(x, y, 0.0), axis }
}

/// The angle between two vectors, accurate near zero.
fn angle(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    a.cross(b).norm().atan2(a.dot(b))
}

pub(super) fn limits() -> MotionLimits {
    let of = |speed, acceleration, jerk| schedule::Limits { speed, acceleration, jerk };
    let degree = 1.0_f64.to_radians();
    let linear = of(500.0, 5000.0, 1e5);
    let rotary = of(180.0 * degree, 1500.0 * degree, 5e4 * degree);
    let axes = "XYZ".chars().map(|name| (name, linear)).chain("ABC".chars().map(|name| (name, rotary)));
    MotionLimits { axes: axes.collect(), tip: None }
}

/// The limits of speed, acceleration and jerk of an axis: mm or degrees by s, s2 and s3.
pub(super) fn limits_of(axis: char) -> [f64; 3] {
    let own = limits().axes.into_iter().find(|(name, _)| *name == axis).unwrap().1;
    let unit = if axis < 'X' { 1.0_f64.to_degrees() } else { 1.0 };
    [own.speed, own.acceleration, own.jerk].map(|limit| limit * unit)
}

/// Asserts that the samples keep the limits by differences, that the motion begins and ends at rest, and
/// that the positions of the axes give the poses.
fn assert_driven(name: &str, job: &Job) -> Plan {
    let plan = plan(job, &Budget::unlimited()).unwrap_or_else(|error| panic!("{name}: {error}"));
    let machine = job.machine.as_ref().unwrap();
    assert_eq!(plan.report.axis_peaks.len(), 5, "{name}");
    for peaks in &plan.report.axis_peaks {
        let limits = limits_of(peaks.axis);
        for (peak, limit) in [peaks.speed, peaks.acceleration, peaks.jerk].into_iter().zip(limits) {
            assert!(peak <= 1.01 * limit, "{name}: {peaks:?} {limits:?}");
        }
    }
    let feed = feed_of(job);
    assert!(plan.report.speed.max <= 1.001 * feed, "{name}: {:?}", plan.report.speed);
    for sample in &plan.samples {
        let found = machine.forward(&sample.joints.unwrap());
        assert!((found.tip - sample.pose.tip).norm() < 1e-9, "{name}: {sample:?}");
        assert!((found.axis.into_inner() - sample.pose.axis.into_inner()).norm() < 1e-9, "{name}");
    }
    let n = plan.samples.len();
    for pair in [[0, 1], [n - 2, n - 1]] {
        let step = (plan.samples[pair[1]].pose.tip - plan.samples[pair[0]].pose.tip).norm();
        assert!(step < 1e-3 * feed * job.period_s, "{name}: does not rest at its end: {step}");
    }
    plan
}

#[test]
fn on_every_machine_the_limits_of_all_axes_are_kept_between_rests() {
    let (_, poses) = paper_like();
    for machine in crate::machine::named::named() {
        let job = Job {
            machine: Some(machine.clone()),
            limits: Some(limits()),
            ..job(poses.clone(), Method::Interpolating)
        };
        let driven = assert_driven(machine.name(), &job);
        let constant = plan(&Job { limits: None, ..job }, &Budget::unlimited()).unwrap();
        assert!(driven.report.cycle_time_s > constant.report.cycle_time_s);
    }
}

#[test]
fn an_upright_tool_moves_its_linear_axes_alone() {
    let points = [[0.0; 3], [10.0, 0.0, 0.0], [20.0, 5.0, 1.0], [20.0, 15.0, 1.0]];
    let machine = crate::machine::named::by_name("table_table_ac");
    let job = Job { machine, limits: Some(limits()), ..job(upright(&points), Method::Interpolating) };
    let plan = assert_driven("upright", &job);
    let at_rest = AxisPeaks { axis: 'A', speed: 0.0, acceleration: 0.0, jerk: 0.0 };
    assert_eq!(plan.report.axis_peaks[3], at_rest);
}

#[test]
fn a_straight_swing_through_the_pole_is_driven() {
    let poses: Vec<Pose> = (0..41).map(|k| tilted(f64::from(k), 0.0, (f64::from(k) - 20.0) * 0.01)).collect();
    let machine = crate::machine::named::by_name("table_table_ac");
    let job = Job { machine, limits: Some(limits()), ..job(poses, Method::Interpolating) };
    assert_driven("pole", &job);
}

#[test]
fn a_line_takes_the_time_of_the_closed_form() {
    let poses = upright(&[[0.0; 3], [100.0, 0.0, 0.0]]);
    let path = at_feed(&poses, 6000.0);
    let job = Job { path, limits: Some(limits()), ..job(poses, Method::Interpolating) };
    let plan = plan(&job, &Budget::unlimited()).unwrap();
    // To 100 mm/s within a jerk of 100,000 mm/s3 in 2 sqrt(100 / 100,000) s, at half the speed on average.
    let expected = 1.0 + 2.0 * (100.0_f64 / 1e5).sqrt();
    let found = plan.report.cycle_time_s;
    assert!((found / expected - 1.0).abs() < 2e-3, "{found} {expected}");
    let bound = plan.report.cycle_time_lower_bound_s.unwrap();
    assert!(bound <= expected && bound > 0.9999 * expected, "{bound} {expected}");
}

pub(super) fn assert_within(name: &str, job: &Job) -> Plan {
    let plan = plan(job, &Budget::unlimited()).unwrap();
    assert!(plan.report.within_tolerance, "{name}: {:?}", plan.report);
    let samples: Vec<Pose> = plan.samples.iter().map(|sample| sample.pose).collect();
    let given = given(job);
    let report = &plan.report;
    let allowed = [report.deviation_max_mm, report.deviation_max_deg.to_radians()];
    let (tip, angle) = farthest(&given, &samples, allowed);
    assert!(tip <= allowed[0] + 1e-9, "{name}: seen {tip}, stated {}", allowed[0]);
    assert!(angle <= allowed[1] + 1e-8, "{name}: seen {angle}, stated {}", allowed[1]);
    let allowed = [report.toolpath_deviation_max_mm, report.toolpath_deviation_max_deg.to_radians()];
    let (tip, angle) = farthest(&given, &along_moves(&plan.toolpath), allowed);
    assert!(tip <= allowed[0] + 1e-9, "{name}: moves {tip}, {}", allowed[0]);
    assert!(angle <= allowed[1] + 1e-7, "{name}: moves {angle} {report:?}");
    let (first, last) = (plan.samples[0].pose, plan.samples[plan.samples.len() - 1].pose);
    let ends = (given[0], given[given.len() - 1]);
    assert!((first.tip - ends.0.tip).norm() < 1e-12 && (last.tip - ends.1.tip).norm() < 1e-12, "{name}");
    assert!(first.axis.angle(&ends.0.axis) < 1e-7 && last.axis.angle(&ends.1.axis) < 1e-7, "{name}");
    plan
}

#[test]
fn a_path_like_that_of_the_paper_has_the_figures_of_the_notes() {
    let (true_path, poses) = paper_like();
    let row = |method: Method| {
        let mut job = job(poses.clone(), method);
        job.period_s = 0.001;
        let plan = plan(&job, &Budget::unlimited()).unwrap();
        // The distance from the true curve, near the parameter of the sample.
        let error = |pose: &Pose| {
            let (mut low, mut high) = (pose.tip.x - 0.2, pose.tip.x + 0.2);
            let distance = |t: f64| (true_path(t).tip - pose.tip).norm();
            for _ in 0..80 {
                let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
                if distance(a) < distance(b) { high = b } else { low = a }
            }
            distance(0.5 * (low + high))
        };
        let errors: Vec<f64> = plan.samples.iter().map(|sample| 1000.0 * error(&sample.pose)).collect();
        let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
        let max = errors.iter().copied().fold(0.0, f64::max);
        let jerk = plan.report.jerk;
        (rms, max, jerk.rms * 1e-6, jerk.max * 1e-6)
    };
    let linear = row(Method::Linear);
    let paper = row(Method::Paper);
    let own = row(Method::Interpolating);
    assert!(linear.0 > 3.0 && linear.1 < 5.1);
    assert!(paper.0 < 1.0 && paper.1 < 3.5 && paper.3 < 0.15, "{paper:?}");
    assert!(own.0 <= 0.05 && own.1 <= 0.3 && own.2 <= 0.005 && own.3 <= 0.05, "{own:?}");
}

#[test]
fn a_straight_path_stays_straight() {
    let poses = upright(&[[0.0; 3], [10.0, 0.0, 0.0], [11.0, 0.0, 0.0], [50.0, 0.0, 0.0]]);
    let plan = assert_within("straight", &job(poses, Method::Interpolating));
    assert!(plan.report.deviation_max_mm < 1e-9);
    assert!((plan.report.cycle_time_s - 1.0).abs() < 1e-9);
    assert_eq!((plan.report.n_blends, plan.report.n_stops), (0, 0));
}

#[test]
fn a_right_angle_is_blended_within_the_tolerance() {
    let poses =
        upright(&[[0.0; 3], [10.0, 0.0, 0.0], [20.0, 0.0, 0.0], [20.0, 10.0, 0.0], [20.0, 20.0, 0.0]]);
    let plan = assert_within("right angle", &job(poses, Method::Interpolating));
    assert_eq!((plan.report.n_blends, plan.report.n_stops), (1, 0));
    assert!(plan.report.deviation_max_mm > 0.004, "the blend uses the tolerance");
}

#[test]
fn an_orientation_jump_keeps_both_tolerances() {
    let mut poses: Vec<Pose> = (0..10).map(|k| tilted(f64::from(k), 0.0, 0.0)).collect();
    poses.extend((10..20).map(|k| tilted(f64::from(k), 0.0, 0.3)));
    assert_within("orientation jump", &job(poses, Method::Interpolating));
}

#[test]
fn a_rotation_about_a_resting_tip_stops_before_and_after() {
    let poses =
        vec![tilted(0.0, 0.0, 0.0), tilted(10.0, 0.0, 0.0), tilted(10.0, 0.0, 0.8), tilted(20.0, 0.0, 0.8)];
    let plan = assert_within("rotation", &job(poses, Method::Interpolating));
    assert_eq!(plan.report.n_stops, 2);
    // The top moves at the feed.
    assert!((plan.report.cycle_time_s - (20.0 + 0.8 * 50.0) / 50.0).abs() < 1e-6);
}

#[test]
fn a_reversal_stops() {
    let poses = upright(&[[0.0; 3], [10.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 5.0, 0.0]]);
    let plan = assert_within("reversal", &job(poses, Method::Interpolating));
    assert_eq!((plan.report.n_blends, plan.report.n_stops), (1, 1));
}

#[test]
fn near_duplicates_do_no_harm() {
    let mut poses = Vec::new();
    for k in 0..40 {
        let t = f64::from(k) * 0.05;
        let at = |t: f64| Pose {
            tip: Point3::new(20.0 * t.cos(), 20.0 * t.sin(), 0.0),
            axis: Unit::new_normalize(Vector3::new(0.2 * t.cos(), 0.2 * t.sin(), 1.0)),
        };
        poses.push(at(t));
        poses.push(at(t));
        poses.push(at(t + 2e-7));
    }
    let mut job = job(poses, Method::Interpolating);
    job.tolerance_mm = 0.01;
    assert_within("near duplicates", &job);
}

#[test]
fn fine_legs_after_a_long_line_keep_the_line_straight() {
    let mut points = vec![[-40.0, -20.0, 0.0]];
    points.extend((0..60).map(|k| {
        let t = f64::from(k) * 0.02;
        [20.0 * t.sin(), -20.0 * t.cos(), 0.0]
    }));
    let plan = assert_within("line and arc", &job(upright(&points), Method::Interpolating));
    assert_eq!(plan.report.n_stops, 0);
    assert!(plan.report.n_blends < 4, "{:?}", plan.report);
}

#[test]
fn noise_and_zigzags_are_kept_within_the_tolerance() {
    let mut seed = 1_u64;
    let mut random = move || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as f64 / f64::from(1_u32 << 31) * 2.0 - 1.0
    };
    let noisy: Vec<Pose> = (0..500)
        .map(|k| {
            let t = f64::from(k) * 0.1;
            let tip =
                Point3::new(t + 0.003 * random(), 5.0 * (t / 8.0).sin() + 0.003 * random(), 0.003 * random());
            let axis = Vector3::new(0.3 * (t / 5.0).sin() + 0.002 * random(), 0.002 * random(), 1.0);
            Pose { tip, axis: Unit::new_normalize(axis) }
        })
        .collect();
    assert_within("noisy", &job(noisy, Method::Interpolating));
    let zigzag: Vec<Pose> = (0..200)
        .map(|k| tilted(f64::from(k), if k % 2 == 0 { 0.0 } else { 3.0 * random() }, 0.5 * random()))
        .collect();
    assert_within("zigzag", &job(zigzag, Method::Interpolating));
}

/// The largest distance of the centre of a ball from where it is on the given path.
fn farthest_center(given: &[Pose], poses: &[Pose], radius: f64) -> f64 {
    let center = |pose: &Pose| pose.tip + pose.axis.into_inner() * radius;
    let path: Vec<Point3<f64>> = given
        .windows(2)
        .flat_map(|pair| (0..200).map(|k| center(&pair[0].between(&pair[1], f64::from(k) / 200.0))))
        .collect();
    let distance = |pose: &Pose| {
        path.iter().map(|p| (p - center(pose)).norm_squared()).fold(f64::INFINITY, f64::min).sqrt()
    };
    poses.iter().map(distance).fold(0.0, f64::max)
}

#[test]
fn the_centre_of_a_ball_keeps_the_tolerance_while_the_axis_is_smoothed() {
    let swing = [0.4, -0.9, 0.7, -0.2, 1.0, -0.6, 0.1, -1.0];
    let poses: Vec<Pose> = (0..60)
        .map(|k| {
            let noise = 0.004 * swing[k % swing.len()] * if k % 3 == 0 { -1.0 } else { 1.0 };
            let t = k as f64 * 0.5;
            let axis = Vector3::new(noise, 0.3 + 0.01 * t, 1.0);
            Pose { tip: Point3::new(t, 4.0 * (t / 9.0).sin(), 0.0), axis: Unit::new_normalize(axis) }
        })
        .collect();
    let mut job = job(poses.clone(), Method::Tube);
    (job.tolerance_axis, job.period_s) = (1.0_f64.to_radians(), 0.005);
    let radius = 6.0;
    let farthest = |job: &Job| {
        let plan = plan(job, &Budget::unlimited()).unwrap();
        let samples: Vec<Pose> = plan.samples.iter().map(|sample| sample.pose).collect();
        (farthest_center(&poses, &samples, radius), plan.report)
    };
    assert!(farthest(&job).0 > 2.0 * job.tolerance_mm, "the axis moves the ball far");
    job.swing_mm = radius;
    let (found, report) = farthest(&job);
    let bound = report.cut_deviation_max_mm.unwrap();
    // The centres of the given path are known to a hundredth of a micrometre.
    assert!(found <= bound + 1e-5 && bound <= job.tolerance_mm, "{found} {report:?}");
}

#[test]
fn two_poses_are_a_line_on_the_great_circle() {
    let poses = vec![tilted(0.0, 0.0, -0.7), tilted(10.0, 0.0, 0.7)];
    let plan = assert_within("two poses", &job(poses, Method::Interpolating));
    assert!(plan.report.deviation_max_deg.to_radians() < 1e-3);
}

#[test]
fn a_pole_on_the_way_is_nothing_special_for_rails() {
    let poses: Vec<Pose> = (0..40).map(|k| tilted(f64::from(k), 0.0, (f64::from(k) - 20.0) * 0.02)).collect();
    let plan = assert_within("pole", &job(poses, Method::Interpolating));
    assert_eq!(plan.report.n_blends, 0);
}

#[test]
fn a_blade_edge_is_kept() {
    // Around an edge of 0.3 mm between two long sides, the axis turning with it.
    let mut poses: Vec<Pose> = (0..30).map(|k| tilted(f64::from(k), 0.3, 0.2)).collect();
    poses.extend((1..30).map(|k| {
        let t = f64::from(k) / 30.0 * std::f64::consts::PI;
        tilted(29.0 + 0.3 * t.sin(), 0.3 * t.cos(), 0.2 * t.cos())
    }));
    poses.extend((0..30).map(|k| tilted(f64::from(29 - k), -0.3, -0.2)));
    assert_within("blade", &job(poses, Method::Interpolating));
}

#[test]
fn impossible_paths_are_refused() {
    let same = vec![tilted(0.0, 0.0, 0.0); 3];
    assert_eq!(
        plan(&job(same, Method::Interpolating), &Budget::unlimited()).unwrap_err(),
        FiveAxisError::NoMotion
    );
    let opposite = vec![tilted(0.0, 0.0, 0.0), tilted(1.0, 0.0, std::f64::consts::PI)];
    let error = plan(&job(opposite, Method::Interpolating), &Budget::unlimited()).unwrap_err();
    assert_eq!(error, FiveAxisError::OppositeAxes { index: 1 });
}

#[test]
fn five_thousand_legs_take_little_time() {
    let poses: Vec<Pose> = (0..5001)
        .map(|k| {
            let t = f64::from(k) * 0.2;
            let axis = Unit::new_normalize(Vector3::new(0.2 * (t / 30.0).sin(), 0.2 * (t / 40.0).cos(), 1.0));
            Pose { tip: Point3::new(t, 20.0 * (t / 30.0).sin(), 5.0 * (t / 50.0).cos()), axis }
        })
        .collect();
    let mut job = job(poses, Method::Interpolating);
    job.period_s = 0.01;
    let plan = plan(&job, &Budget::unlimited()).unwrap();
    assert!(plan.report.within_tolerance && plan.report.n_blends == 0, "{:?}", plan.report);
}
