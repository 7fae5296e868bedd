//! Compares the spline in the tolerance tube with copp's fit of waypoints: spans, and the jerk of the tip at
//! a constant feed.

use copp::path::{Path, SmoothingConfig, SmoothingTolerance};
use nalgebra::{DMatrix, Point3, Unit, Vector3};
use toolpathd_core::budget::Budget;
use toolpathd_core::operations::five_axis::{Job, Method, plan};
use toolpathd_core::toolpath::pose::{Pace, Pose, Waypoint};
use toolpathd_core::toolpath::units::FeedRate;

const FEED_MM_PER_MIN: f64 = 3000.0;
const TOP_MM: f64 = 50.0;
const TOLERANCE_DEG: f64 = 0.2;

/// Noise between -1 and 1 that is the same in every run.
fn noise(k: usize, salt: u64) -> f64 {
    let mut x = (k as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ salt.wrapping_mul(0xD1B5_4A32_D192_ED03);
    x ^= x >> 29;
    x = x.wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x ^= x >> 32;
    (x % 2_000_001) as f64 / 1e6 - 1.0
}

/// A wave: `n` poses that are `step` mm apart along x, with noise of the tip in mm and of the axis.
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

pub fn compare() {
    println!("path                    | spans here, copp | jerk rms here, copp | jerk max here, copp | ms here, copp");
    for (name, poses, tolerance_mm) in [
        ("noise 1.5 um", wave(400, 0.2, 0.0015, 5e-4), 0.005),
        ("noise 1 um, 2000 poses", wave(2000, 0.1, 0.001, 2e-4), 0.005),
        ("noise 5 um, tol. 20 um", wave(400, 0.3, 0.005, 1e-3), 0.02),
        ("clean", wave(200, 0.5, 0.0, 0.0), 0.005),
        ("sparse", wave(40, 3.0, 0.0, 0.0), 0.15),
    ] {
        let begin = std::time::Instant::now();
        let here = plan(&job(&poses, tolerance_mm), &Budget::unlimited()).expect("a path").report;
        let own_ms = begin.elapsed().as_secs_f64() * 1e3;
        let begin = std::time::Instant::now();
        let (spans, [rms, max]) = match copp(&poses, tolerance_mm) {
            Ok(found) => found,
            Err(error) => {
                println!("{name:23} | {} | {:.0} | {error}", here.n_spans, here.jerk.rms);
                continue;
            }
        };
        println!(
            "{name:23} | {:4} {spans:4} | {:9.0} {rms:9.0} | {:9.0} {max:9.0} | {own_ms:6.1} {:6.1}",
            here.n_spans,
            here.jerk.rms,
            here.jerk.max,
            begin.elapsed().as_secs_f64() * 1e3,
        );
    }
}

fn job(poses: &[Pose], tolerance_mm: f64) -> Job {
    let pace = Pace::Feed(FeedRate::from_mm_per_min(FEED_MM_PER_MIN).expect("a feed"));
    let path = poses.iter().map(|pose| Waypoint::new(*pose, pace)).collect();
    let job = Job::new(path, tolerance_mm, TOLERANCE_DEG.to_radians());
    Job { top_mm: TOP_MM, method: Method::Tube, retract_mm: 0.0, ..job }
}

/// Spans and jerk (root of the mean square, largest; mm/s3) of copp's fit. Each coordinate of the tip may be
/// off by the tolerance, so that copp has a box where the tube here is the ball inside it.
fn copp(poses: &[Pose], tolerance_mm: f64) -> Result<(usize, [f64; 2]), String> {
    let row = |k: usize, n: usize| {
        let Pose { tip, axis } = poses[n];
        if k < 3 { tip[k] } else { TOP_MM * axis[k - 3] }
    };
    let waypoints = DMatrix::from_fn(6, poses.len(), row);
    let mut length = 0.0;
    let mut parameters = vec![0.0];
    for pair in poses.windows(2) {
        length += (pair[1].tip - pair[0].tip).norm();
        parameters.push(length);
    }
    let top = TOP_MM * TOLERANCE_DEG.to_radians();
    let tolerances = vec![tolerance_mm, tolerance_mm, tolerance_mm, top, top, top];
    let config = SmoothingConfig {
        tolerance: SmoothingTolerance::PerAxis(tolerances),
        parameters: Some(parameters),
        ..SmoothingConfig::default()
    };
    let path = Path::from_waypoints_fitting(&waypoints, config).map_err(|error| error.to_string())?;
    let spans = path.smoothing_report().map_or(0, |report| report.segments);
    let count = 20_000;
    let places: Vec<f64> = (0..=count).map(|k| length * k as f64 / count as f64).collect();
    let found = path.evaluate_up_to_3rd(&places).map_err(|error| error.to_string())?;
    let [dq, ddq, dddq] = [&found.dq, &found.ddq, &found.dddq].map(|rows| rows.as_ref().expect("derivatives"));
    let column = |rows: &DMatrix<f64>, n: usize| Vector3::new(rows[(0, n)], rows[(1, n)], rows[(2, n)]);
    let (mut sum, mut way, mut max) = (0.0, 0.0, 0.0_f64);
    for n in 0..=count {
        let (one, two, three) = (column(dq, n), column(ddq, n), column(dddq, n));
        let (a, b) = (one.norm(), one.dot(&two));
        // The third derivative by the length.
        let curved = two * (a * a) - one * b;
        let change = three * (a * a) + two * b - one * (two.norm_squared() + one.dot(&three));
        let third = (change / a.powi(4) - curved * (4.0 * b / a.powi(6))) / a;
        let jerk = third.norm() * (FEED_MM_PER_MIN / 60.0).powi(3);
        sum += jerk * jerk * a;
        way += a;
        max = max.max(jerk);
    }
    Ok((spans, [(sum / way).sqrt(), max]))
}
