use std::f64::consts::TAU;

use proptest::prelude::*;

use super::*;
use crate::geometry::arc_fit::{Continuity, Joints};

/// Points on a circle, a line or a wave, with errors up to `noise` tolerances.
fn points() -> impl Strategy<Value = Vec<Point3<f64>>> {
    let errors = prop::collection::vec((-1.0..1.0f64, -1.0..1.0f64), 3..60);
    let sizes = (0.05..400.0f64, 0.01..6.0f64, 0.0..3.0f64, 0..3u8);
    (errors, sizes).prop_map(|(errors, (radius, turn, noise, kind))| {
        let n = errors.len() as f64 - 1.0;
        let at = |(k, (ex, ey)): (usize, &(f64, f64))| {
            let part = k as f64 / n;
            let [x, y] = match kind {
                0 => [radius * (turn * part).cos(), radius * (turn * part).sin()],
                1 => [radius * turn * part, 0.3 * radius * part],
                _ => [radius * part, 0.05 * radius * (TAU * part).sin()],
            };
            Point3::new(x + 1e-3 * noise * ex, y + 1e-3 * noise * ey, 0.0)
        };
        errors.iter().enumerate().map(at).collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_deviation_exceeds_the_tolerance(
        points in points(), tolerance in prop_oneof![Just(1e-3), 1e-6..1e-2f64],
        is_greedy: bool, is_polyline: bool, is_tangent: bool, is_free: bool,
    ) {
        let mut job = Job::new(points, tolerance);
        job.fit = Fit {
            method: if is_greedy { Method::Greedy } else { Method::Optimal },
            measure: if is_polyline { Measure::Polyline } else { Measure::Points },
            continuity: if is_tangent { Continuity::Tangent } else { Continuity::Position },
            joints: if is_free { Joints::Free } else { Joints::OnPoints },
            effort: 2_000,
            ..job.fit
        };
        let report = plan(&job, &Budget::unlimited()).unwrap().report;
        prop_assert!(report.deviation_max_mm <= tolerance, "{} {tolerance}", report.deviation_max_mm);
    }
}

/// The tolerance is exactly the height of the arc over its chord, or a rounding less or more.
#[test]
fn a_tolerance_that_only_just_suffices_is_kept() {
    for k in 0..200 {
        let radius = 7.0 + 0.37 * f64::from(k);
        let at = |part: f64| Point3::new(radius * (0.6 * part).sin(), radius * (0.6 * part).cos(), 0.0);
        let points: Vec<_> = [-1.0, 0.0, 1.0].map(at).to_vec();
        let height = radius * (1.0 - 0.6f64.cos());
        for tolerance in [height.next_down(), height, height * (1.0 + 1e-12)] {
            for measure in [Measure::Points, Measure::Polyline] {
                let mut job = Job::new(points.clone(), tolerance);
                job.fit.measure = measure;
                let report = plan(&job, &Budget::unlimited()).unwrap().report;
                assert!(report.deviation_max_mm <= tolerance, "{} {tolerance}", report.deviation_max_mm);
            }
        }
    }
}
