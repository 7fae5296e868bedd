//! Laws of any path: random paths with corners, rotations, tiny and long legs.

use proptest::prelude::*;

use super::*;

/// A path by its steps: the length, the direction, and how the axis turns.
fn path() -> impl Strategy<Value = Vec<Pose>> {
    let step = (-4.0..1.5_f64, prop::array::uniform3(-1.0..1.0_f64), -4.0..-0.3_f64, 0.0..6.3_f64, 0..6);
    proptest::collection::vec(step, 1..40).prop_map(|steps| {
        let (mut at, mut axis) = (Point3::origin(), Vector3::new(0.1, 0.2, 1.0));
        let mut along = Vector3::x();
        let mut poses = vec![Pose { tip: at, axis: Unit::new_normalize(axis) }];
        for (length, turn, tilt, about, kind) in steps {
            // Mostly smooth, with corners, rotations and stops of the axis among them.
            let bend = if kind == 0 { 2.0 } else { 0.05 };
            along = (along + Vector3::from(turn) * bend).normalize();
            if kind != 1 {
                at += along * 10.0_f64.powf(length);
            }
            if kind != 2 {
                let tilt = 10.0_f64.powf(tilt);
                axis = axis.normalize() + Vector3::new(about.cos(), about.sin(), 0.0) * tilt;
            }
            poses.push(Pose { tip: at, axis: Unit::new_normalize(axis) });
        }
        poses
    })
}

fn any_job() -> impl Strategy<Value = Job> {
    let method = prop_oneof![Just(Method::Interpolating), Just(Method::Tube)];
    (path(), -3.0..-0.5_f64, -2.0..0.5_f64, method).prop_map(|(poses, tolerance, degrees, method)| Job {
        tolerance_mm: 10.0_f64.powf(tolerance),
        tolerance_axis: 10.0_f64.powf(degrees).to_radians(),
        swing_mm: 0.0,
        period_s: 0.002,
        ..job(poses, method)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn any_path_is_smoothed_within_its_tolerances(job in any_job()) {
        match plan(&job, &Budget::unlimited()) {
            Err(FiveAxisError::NoMotion) => return Err(TestCaseError::reject("no motion")),
            Err(error) => panic!("{error}"),
            Ok(_) => { assert_within("any", &job); }
        }
    }

    #[test]
    fn any_path_is_driven_within_the_limits(job in any_job()) {
        let job = Job {
            machine: crate::machine::named::by_name("table_table_bc"),
            limits: Some(limits()),
            ..job
        };
        match plan(&job, &Budget::unlimited()) {
            Err(FiveAxisError::NoMotion | FiveAxisError::NotFollowed { .. }) => {
                return Err(TestCaseError::reject("no motion, or beyond the travel of the machine"));
            }
            Err(error) => panic!("{error}"),
            Ok(plan) => {
                prop_assert!(!plan.samples.is_empty());
                prop_assert_eq!(plan.report.axis_peaks.len(), 5);
                let bound = plan.report.cycle_time_lower_bound_s.unwrap();
                prop_assert!(plan.report.cycle_time_s >= bound);
                for sample in &plan.samples {
                    assert!(sample.t_s.is_finite() && sample.pose.tip.iter().all(|x| x.is_finite()));
                    let found = job.machine.as_ref().unwrap().forward(&sample.joints.unwrap());
                    assert!((found.tip - sample.pose.tip).norm() < 1e-8, "{sample:?}");
                }
                for peaks in &plan.report.axis_peaks {
                    // Differences over 2 ms see little of the jerk.
                    let [speed, acceleration, _] = limits_of(peaks.axis);
                    assert!(peaks.speed <= 1.01 * speed, "{peaks:?}");
                    assert!(peaks.acceleration <= 1.01 * acceleration, "{peaks:?}");
                }
            }
        }
    }
}
