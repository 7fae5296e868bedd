//! Times of fitting a surface to noisy points, over growing numbers of points and of control points.
//!
//! `cargo bench --bench point_fit`

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use nalgebra::Point3;
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::surface::point_fit::{Error, OutlierChoice, PointFit};

/// `n` random points of a wave over a square of 100 mm, with noise of up to 3 um, the same in every run.
fn points(n: usize, wave_mm: f64) -> Vec<Point3<f64>> {
    let mut state = 88_172_645_463_325_252_u64;
    let mut random = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut point = || {
        let (x, y, noise) = (100.0 * random(), 100.0 * random(), 0.006 * random() - 0.003);
        let turn = std::f64::consts::TAU / wave_mm;
        Point3::new(x, y, 2.0 * (turn * x).sin() * (turn * y).cos() + noise)
    };
    (0..n).map(|_| point()).collect()
}

fn run(c: &mut Criterion, group: &str, cases: impl IntoIterator<Item = (String, PointFit)>) {
    let mut group = c.benchmark_group(group);
    group.sample_size(10);
    for (name, fit) in cases {
        group.throughput(Throughput::Elements(fit.points.len() as u64));
        group.bench_function(BenchmarkId::from_parameter(name), |b| {
            b.iter(|| black_box(fit.fitted(&Budget::unlimited())));
        });
    }
    group.finish();
}

/// The same wave with more and more points: the search for outliers counts, and grows with their number.
fn by_points(c: &mut Criterion) {
    for (name, outliers) in [("with outliers", OutlierChoice::Refuse), ("fit alone", OutlierChoice::Keep)] {
        let case = |n: usize| {
            let fit = PointFit { points: points(n, 60.0), error: Error::Max(0.02), outliers };
            (format!("{n} points"), fit)
        };
        run(c, name, [1_000, 10_000, 100_000].map(case));
    }
}

/// Shorter and shorter waves: the number of control points counts.
fn by_waves(c: &mut Criterion) {
    let case = |wave_mm: f64| {
        let outliers = OutlierChoice::Keep;
        let fit = PointFit { points: points(50_000, wave_mm), error: Error::Max(0.02), outliers };
        (format!("waves of {wave_mm} mm"), fit)
    };
    run(c, "waves", [60.0, 30.0, 15.0, 8.0].map(case));
}

criterion_group!(benches, by_points, by_waves);
criterion_main!(benches);
