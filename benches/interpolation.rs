//! Times of interpolating curves over growing sizes; all on one thread.
//!
//! `cargo bench --bench interpolation`

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use nalgebra::Point2;
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::deviation::{Band, Measure};
use toolpathd_core::geometry::plane_curve::nurbs::Nurbs;
use toolpathd_core::operations::interpolation::{Job, Joints, Method, Source, Subdivision, plan};

/// A wavy cubic with `n` control points.
fn nurbs(n: usize) -> Source {
    let height = |x: f64| 5.0 * (0.7 * x).sin() + 3.0 * (0.13 * x).cos();
    let mut knots = vec![0.0; 4];
    knots.extend((1..n - 3).map(|k| k as f64));
    knots.extend([(n - 3) as f64; 4]);
    let control_points = (0..n).map(|k| Point2::new(k as f64, height(k as f64))).collect();
    Source::Nurbs(Nurbs { degree: 3, knots, control_points, weights: None })
}

fn graph() -> Source {
    Source::Graph { expression: "20*sin(x/20)*exp(-x/100)".into(), domain: [0.0, 130.0] }
}

fn job(curve: Source, method: Method, subdivision: Subdivision, mm: f64) -> Job {
    Job::new(curve, method, subdivision, Band { below_mm: mm, above_mm: mm, measure: Measure::Normal })
}

const LEAST: Subdivision = Subdivision::Least(Joints::OnCurve);

fn run(c: &mut Criterion, group: &str, jobs: impl Iterator<Item = (String, Job)>) {
    let mut group = c.benchmark_group(group);
    group.sample_size(10);
    for (name, job) in jobs {
        let elements = plan(&job, &Budget::unlimited()).unwrap().report.elements.len();
        group.throughput(Throughput::Elements(elements as u64));
        group.bench_with_input(BenchmarkId::from_parameter(format!("{name}: {elements}")), &job, |b, job| {
            b.iter(|| plan(black_box(job), &Budget::unlimited()).unwrap());
        });
    }
    group.finish();
}

/// Lines by bisection: the last has 10,000 control points and more than 100,000 elements.
fn bisection(c: &mut Criterion) {
    let sizes = [100, 1_000, 10_000].into_iter();
    run(
        c,
        "bisection",
        sizes.map(|n| (format!("{n} points"), job(nurbs(n), Method::Linear, Subdivision::Bisection, 1.5e-3))),
    );
}

fn least(c: &mut Criterion) {
    let sizes = [100, 1_000, 10_000].into_iter();
    run(c, "least", sizes.map(|n| (format!("{n} points"), job(nurbs(n), Method::Linear, LEAST, 1e-2))));
}

/// The same curve, an expression, by each method.
fn methods(c: &mut Criterion) {
    let methods = [Method::Linear, Method::Parabolic, Method::Mixed, Method::Arc].into_iter();
    let jobs = methods.flat_map(|method| {
        [Subdivision::Bisection, LEAST].map(|subdivision| {
            (format!("{method:?} {subdivision:?}"), job(graph(), method, subdivision, 1e-3))
        })
    });
    let in_band = job(graph(), Method::Linear, Subdivision::Least(Joints::InBand), 1e-3);
    run(c, "methods", jobs.chain([("Linear in band".into(), in_band)]));
}

criterion_group!(benches, bisection, least, methods);
criterion_main!(benches);
