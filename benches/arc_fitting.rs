//! Times of fitting arcs to points over growing sizes, and of rewriting programs; all on one thread.
//!
//! `cargo bench --bench arc_fitting`

use std::fmt::Write;
use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use nalgebra::Vector2;
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::arc_fit::{Continuity, Fit, Method, Points, fit};
use toolpathd_post::dialect;
use toolpathd_post::rewrite::{RewriteJob, Rewriter};

/// `n` points along the curve `at`, whose parameter runs from 0 to 1.
fn points(n: usize, at: impl Fn(f64) -> Vector2<f64>) -> Vec<Vector2<f64>> {
    (0..n).map(|i| at(i as f64 / (n - 1) as f64)).collect()
}

fn sine(n: usize) -> Vec<Vector2<f64>> {
    points(n, |t| Vector2::new(10.0 * t, (10.0 * t).sin()))
}

fn spiral(n: usize) -> Vec<Vector2<f64>> {
    points(n, |t| Vector2::new((12.0 * t).cos(), (12.0 * t).sin()) * (2.0 + 8.0 * t))
}

/// A circle of radius 10 whose points are off by up to `noise` mm, by the same amounts in every run.
fn noisy_circle(n: usize, noise: f64) -> Vec<Vector2<f64>> {
    let mut state = 88_172_645_463_325_252_u64;
    let mut random = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut radius = || 10.0 + noise * (2.0 * random() - 1.0);
    let radii: Vec<f64> = (0..n).map(|_| radius()).collect();
    let angle = |i: usize| std::f64::consts::TAU * i as f64 / (n - 1) as f64;
    (0..n).map(|i| Vector2::new(angle(i).cos(), angle(i).sin()) * radii[i]).collect()
}

fn run(c: &mut Criterion, group: &str, cases: impl IntoIterator<Item = (String, Vec<Vector2<f64>>, Fit)>) {
    let mut group = c.benchmark_group(group);
    group.sample_size(10);
    for (name, flat, request) in cases {
        let fitted = || fit(Points { flat: &flat, heights: &[] }, &request, &Budget::unlimited()).unwrap();
        let name = format!("{name}, {} points: {}", flat.len(), fitted().elements.len());
        group.throughput(Throughput::Elements(flat.len() as u64));
        group.bench_function(BenchmarkId::from_parameter(name), |b| b.iter(|| black_box(fitted())));
    }
    group.finish();
}

/// The fewest elements for more and more points of the same curve, and at finer and finer tolerances.
fn optimal(c: &mut Criterion) {
    let sizes = [1_000, 2_500, 5_000, 10_000].map(|n| ("sine 1e-4".to_owned(), sine(n), Fit::within(1e-4)));
    let exponents = [-2, -3, -4, -5];
    let tolerances = exponents.map(|k| {
        let tolerance = 10f64.powi(k);
        [
            (format!("sine 1e{k}"), sine(10_000), Fit::within(tolerance)),
            (format!("spiral 1e{k}"), spiral(10_000), Fit::within(tolerance)),
            (format!("noise 1e{k}"), noisy_circle(10_000, 0.8 * tolerance), Fit::within(tolerance)),
        ]
    });
    run(c, "optimal", sizes.into_iter().chain(tolerances.into_iter().flatten()));
}

fn others(c: &mut Criterion) {
    let greedy = Fit { method: Method::Greedy, ..Fit::within(1e-4) };
    let tangent = Fit { continuity: Continuity::Tangent, ..Fit::within(1e-4) };
    let cases = [("greedy", greedy), ("tangent", tangent)];
    run(c, "others", cases.map(|(name, request)| (name.to_owned(), sine(10_000), request)));
}

/// A program that is one long run of G1 blocks.
fn program(bytes: usize) -> String {
    let mut text = String::from("G17 G21 G90 G94\nG0 X0 Y0 Z0\nG1 F1000\n");
    let mut t = 0.0f64;
    while text.len() < bytes {
        t += 0.002;
        let (x, y) = (50.0 * t.cos() + 3.0 * (7.1 * t).sin(), 50.0 * t.sin() + 2.0 * (13.0 * t).cos());
        let _ = writeln!(text, "X{x:.3} Y{y:.3} Z-5.000");
    }
    text
}

fn programs(c: &mut Criterion) {
    let mut group = c.benchmark_group("programs");
    group.sample_size(10);
    let text = program(2_000_000);
    for (name, method) in [("greedy", Method::Greedy), ("optimal", Method::Optimal)] {
        let fit = Fit { method, ..Fit::within(0.01) };
        group.throughput(Throughput::Bytes(text.len() as u64));
        group.bench_function(name, |b| {
            b.iter(|| {
                let dialect = dialect("linuxcnc").unwrap();
                let (mut rewriter, mut out) = (Rewriter::new(RewriteJob { dialect, fit }), Vec::new());
                for bytes in text.as_bytes().chunks(1 << 16) {
                    rewriter.push(bytes, &mut out, &Budget::unlimited()).unwrap();
                }
                rewriter.finish(&mut out, &Budget::unlimited()).unwrap();
                black_box(out.len())
            });
        });
    }
    group.finish();
}

criterion_group!(benches, optimal, others, programs);
criterion_main!(benches);
