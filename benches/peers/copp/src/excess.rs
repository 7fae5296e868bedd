//! The largest use of the limits, by differences of the coordinates at equal times.

use toolpathd_core::operations::five_axis::schedule::Schedule;

use crate::paths::Case;

/// Seconds between samples.
const PERIOD: f64 = 0.25e-3;

/// The largest speed, acceleration and jerk, each as a part of its limit.
pub fn by_differences(case: &Case, schedule: &Schedule) -> [f64; 3] {
    let count = (schedule.duration_s() / PERIOD).ceil() as usize + 4;
    let mut q: Vec<Vec<f64>> = (0..count)
        .map(|k| case.coordinates(schedule.at((k as f64 - 2.0) * PERIOD).u).iter().map(|x| x.0[0]).collect())
        .collect();
    // An angle that jumps by a whole turn goes on instead.
    for axis in [6, 7] {
        for k in 1..count {
            let turns = ((q[k][axis] - q[k - 1][axis]) / 360.0).round();
            q[k][axis] -= 360.0 * turns;
        }
    }
    let mut most = [0.0f64; 3];
    for w in q.windows(4) {
        for (axis, l) in case.limits.iter().enumerate() {
            let [a, b, c, d] = [w[0][axis], w[1][axis], w[2][axis], w[3][axis]];
            most[0] = most[0].max(((b - a) / PERIOD).abs() / l.speed);
            most[1] = most[1].max(((c - 2.0 * b + a) / PERIOD.powi(2)).abs() / l.acceleration);
            most[2] = most[2].max(((d - 3.0 * c + 3.0 * b - a) / PERIOD.powi(3)).abs() / l.jerk);
        }
    }
    most
}
