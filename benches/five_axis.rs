//! Times of smoothing over growing numbers of blocks: rails and proof, samples at 10 ms, and the motion
//! within the limits of a machine.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use nalgebra::{Point3, Unit, Vector3};
use toolpathd_core::budget::Budget;
use toolpathd_core::machine::named;
use toolpathd_core::operations::five_axis::schedule::Limits;
use toolpathd_core::operations::five_axis::{Job, MotionLimits, plan};
use toolpathd_core::toolpath::pose::{Pace, Pose, Waypoint};
use toolpathd_core::toolpath::units::FeedRate;

/// A path of blocks of about 0.2 mm whose axis swings.
fn job(blocks: usize) -> Job {
    let pose = |k: usize| {
        let t = k as f64 * 0.2;
        let axis = Vector3::new(0.2 * (t / 30.0).sin(), 0.3 + 0.2 * (t / 40.0).cos(), 1.0);
        let tip = Point3::new(0.3 * t - 150.0, 20.0 * (t / 30.0).sin(), 5.0 * (t / 50.0).cos());
        Pose { tip, axis: Unit::new_normalize(axis) }
    };
    let pace = Pace::Feed(FeedRate::from_mm_per_min(3000.0).expect("a feed"));
    let path = (0..=blocks).map(pose).map(|pose| Waypoint::new(pose, pace)).collect();
    Job { rounding_mm: 0.0009, period_s: 0.01, ..Job::new(path, 0.005, 0.5_f64.to_radians()) }
}

fn limits() -> MotionLimits {
    let linear = Limits { speed: 500.0, acceleration: 5000.0, jerk: 1e5 };
    let rotary = Limits { speed: 3.0, acceleration: 25.0, jerk: 800.0 };
    let axes = "XYZ".chars().map(|name| (name, linear)).chain("AC".chars().map(|name| (name, rotary)));
    MotionLimits { axes: axes.collect(), tip: None }
}

fn smoothing(c: &mut Criterion) {
    for (name, with_limits) in [("rails", false), ("limits", true)] {
        let mut group = c.benchmark_group(name);
        group.sample_size(10);
        for blocks in [500, 1000, 2000, 5000] {
            let mut job = job(blocks);
            if with_limits {
                job.machine = named::by_name("table_table_ac");
                job.limits = Some(limits());
            }
            group.bench_with_input(BenchmarkId::from_parameter(blocks), &job, |b, job| {
                b.iter(|| plan(black_box(job), &Budget::unlimited()).unwrap().report.cycle_time_s);
            });
        }
        group.finish();
    }
}

criterion_group!(benches, smoothing);
criterion_main!(benches);
