//! The spline in the tube: against closed forms, its own proof, and the method of the paper on noisy data.

use nalgebra::{Point3, Unit, Vector3};

use crate::budget::Budget;
use crate::operations::five_axis::tests::{assert_within, job};
use crate::operations::five_axis::{Method, plan};
use crate::toolpath::pose::Pose;

/// Noise between -1 and 1 that is the same in every run.
fn noise(k: usize, salt: u64) -> f64 {
    let mut x = (k as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ salt.wrapping_mul(0xD1B5_4A32_D192_ED03);
    x ^= x >> 29;
    x = x.wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x ^= x >> 32;
    (x % 2_000_001) as f64 / 1e6 - 1.0
}

/// A wave, with noise of the tip in mm and of the axis in radians.
fn wave(n: usize, step: f64, tip_noise: f64, axis_noise: f64) -> Vec<Pose> {
    let pose = |k: usize| {
        let t = k as f64 * step;
        let off = [1, 2, 3].map(|salt| tip_noise * noise(k, salt));
        let tilt = [4, 5].map(|salt| axis_noise * noise(k, salt));
        let axis = Vector3::new(0.2 * (t / 12.0).sin() + tilt[0], 0.3 * (t / 9.0).cos() + tilt[1], 1.0);
        let tip = Point3::new(t + off[0], 8.0 * (t / 10.0).sin() + off[1], 2.0 * (t / 14.0).cos() + off[2]);
        Pose { tip, axis: Unit::new_normalize(axis) }
    };
    (0..n).map(pose).collect()
}

#[test]
fn noisy_data_get_few_smooth_spans_within_the_tolerance() {
    let poses = wave(400, 0.2, 0.0015, 5e-4);
    let tube = assert_within("tube", &job(poses.clone(), Method::Tube));
    let through = plan(&job(poses.clone(), Method::Paper), &Budget::unlimited()).unwrap().report;
    assert!(tube.report.n_spans <= 25, "{:?}", tube.report);
    assert_eq!(tube.report.n_stops, 0);
    let gain = through.jerk.rms / tube.report.jerk.rms;
    assert!(gain > 100.0, "{gain} {:?} {:?}", tube.report, through);
    let by_default = plan(&job(poses, Method::Interpolating), &Budget::unlimited()).unwrap().report;
    assert_eq!(by_default, tube.report);
}

#[test]
fn a_line_is_one_span() {
    let poses: Vec<Pose> = (0..50)
        .map(|k| Pose {
            tip: Point3::new(f64::from(k) * 0.5, 0.001 * noise(k as usize, 9), 0.0),
            axis: Vector3::z_axis(),
        })
        .collect();
    let plan = assert_within("line", &job(poses, Method::Tube));
    assert_eq!(plan.report.n_spans, 1);
}

#[test]
fn sparse_data_and_corners_stay_within_the_tolerance() {
    assert_within("sparse", &job(wave(30, 3.0, 0.0, 0.0), Method::Tube));
    let mut corner = wave(60, 0.2, 0.002, 0.0);
    let last = corner[59];
    corner
        .extend((1..60).map(|k| Pose { tip: last.tip + Vector3::new(0.0, 0.0, 0.2 * f64::from(k)), ..last }));
    let plan = assert_within("corner", &job(corner, Method::Tube));
    assert_eq!((plan.report.n_blends, plan.report.n_stops), (1, 0), "{:?}", plan.report);
}
