use nalgebra::{Unit, Vector3};
use proptest::prelude::*;

use super::*;
use crate::machine::named;
use crate::operations::five_axis::path::Path as Given;
use crate::operations::five_axis::tests::{job, limits};
use crate::operations::five_axis::{Method, rails};
use crate::toolpath::pose::Pose;

/// Rails through poses.
fn rail(poses: &[Pose]) -> Rail {
    let job = job(poses.to_vec(), Method::Interpolating);
    let path = Given::new(&job.path, job.top_mm, job.tolerance()).unwrap();
    rails(&job, &path, &Budget::unlimited()).unwrap().rail
}

/// A wave whose axis swings, from numbers between -1 and 1.
fn wave([a, b, c, d]: [f64; 4]) -> Vec<Pose> {
    (0..40)
        .map(|k| {
            let t = f64::from(k) * 0.7;
            let axis = Vector3::new(0.4 * a + 0.3 * (t / 5.0).sin(), 0.5 * b + 0.2 * (t / 7.0).cos(), 1.0);
            let tip = Point3::new(t, 8.0 * c * (t / 6.0).sin(), 5.0 * d * (t / 9.0).cos());
            Pose { tip, axis: Unit::new_normalize(axis) }
        })
        .collect()
}

/// What the limits need at single places, by the derivatives there.
fn sampled(path: &Path, schedule: &Schedule, axes: &Axes, parts: usize) -> f64 {
    let mut factor = 0.0_f64;
    for (n, pair) in path.stations.windows(2).enumerate() {
        for part in 0..parts {
            let u = pair[0].0 + (pair[1].0 - pair[0].0) * (part as f64 + 0.5) / parts as f64;
            let motion = schedule.at(schedule.time_at(u));
            let span = path.piece.index_at(u);
            let jet = path.piece.spans[span].jet(u);
            let near = path.stations[n].1.unwrap();
            let joints = path.machine.map(|machine| machine.nearest(&pose(&jet[0]), near.rotary));
            let (v, a, j) = (motion.speed, motion.acceleration, motion.jerk);
            factor = factor.max(v / path.speed_cap(span, &jet));
            for ([first, second, third], limits) in
                path.derivatives(span, u, joints, axes).unwrap().iter().zip(&axes.limits)
            {
                let acceleration = second * v * v + first * a;
                let jerk = third * v * v * v + 3.0 * second * v * a + first * j;
                factor = factor.max((first * v).abs() / limits.speed);
                factor = factor.max((acceleration.abs() / limits.acceleration).sqrt());
                factor = factor.max((jerk.abs() / limits.jerk).cbrt());
            }
        }
    }
    factor
}

proptest! {
    #[test]
    fn limits_are_proved_on_every_machine_and_a_faster_motion_is_found_out(
        parts in [-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64],
        machine in 0..named::named().len(),
        faster in 0.9..0.999f64,
    ) {
        let machine = named::named().swap_remove(machine);
        let rail = rail(&wave(parts));
        let Ok(drive) = Drive::new(&rail, Some((&machine, [0.0; 2])), &limits(), &Budget::unlimited()) else {
            return Err(TestCaseError::reject("beyond the travel of the machine"));
        };
        let axes = Axes::new(Some(&machine), &limits());
        prop_assert!(!drive.pieces.is_empty());
        for driven in drive.pieces {
            let Driven { piece, stations, schedule, .. } = driven;
            let passages = passages(&piece.spans, Some(&machine));
            let path = Path { piece, passages, stations, machine: Some(&machine), rests: piece.rests() };
            let used = sampled(&path, &schedule, &axes, 7);
            let proof = path.proof(&schedule, &axes, &Budget::unlimited()).unwrap();
            // Bounds are halved until they are at most 1.001 times what is used.
            prop_assert!(used <= 1.0 && proof.slowdown >= used - 1e-9, "{used} {proof:?}");
            prop_assert!(proof.slowdown <= 1.001, "{used} {proof:?}");
            prop_assert!(proof.slowdown > 0.99, "{proof:?}");
            let fast = path.proof(&schedule.slowed(faster), &axes, &Budget::unlimited()).unwrap();
            prop_assert!(fast.slowdown * faster >= used - 1e-9 && fast.slowdown > 1.0, "{fast:?}");
        }
    }
}

#[test]
fn a_path_through_the_pole_has_a_gap_in_the_proof_there() {
    let poses: Vec<Pose> = (0..40)
        .map(|k| {
            let t = f64::from(k) - 19.5;
            Pose {
                tip: Point3::new(t, 0.0, 0.0),
                axis: Unit::new_normalize(Vector3::new(0.02 * t, 0.0, 1.0)),
            }
        })
        .collect();
    let rail = rail(&poses);
    let machine = named::by_name("table_table_ac").unwrap();
    let drive = Drive::new(&rail, Some((&machine, [0.0; 2])), &limits(), &Budget::unlimited()).unwrap();
    let gap = drive.gap().unwrap();
    assert!(gap.x.abs() < 0.1, "{gap}");
}
