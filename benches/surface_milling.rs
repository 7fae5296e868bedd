//! Times of the steps of surface milling over growing sizes; all on one thread.
//!
//! `cargo bench --bench surface_milling`

use std::f64::consts::PI;
use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use nalgebra::Point3;
use toolpathd::budget::Budget;
use toolpathd::geometry::clearance::{Clearance, Penetration};
use toolpathd::geometry::curve::Curve;
use toolpathd::geometry::surface::point_grid::{Ends, PointGrid, Twist};
use toolpathd::geometry::surface::source::Source;
use toolpathd::operations::surface_milling::{Job, plan};
use toolpathd::toolpath::Move;
use toolpathd::toolpath::tool::Tool;
use toolpathd::toolpath::units::{FeedRate, Tolerance};

/// n x n points of z = 10 sin(pi x/40) cos(pi y/40) at 5 mm.
fn grid(n: usize) -> PointGrid {
    let height = |x: f64, y: f64| 10.0 * (PI * x / 40.0).sin() * (PI * y / 40.0).cos();
    let at = |i: usize| 5.0 * i as f64;
    let points =
        (0..n).map(|i| (0..n).map(|j| Point3::new(at(i), at(j), height(at(i), at(j)))).collect()).collect();
    PointGrid { points, twist: Twist::Spline, ends: Ends::NotAKnot }
}

/// A job of `sections` sections over the whole grid.
fn job(n: usize, sections: usize) -> Job {
    // The offset is a little wider than the grid.
    let stepover_mm = (5.0 * (n - 1) as f64 + 1.0) / (sections - 1) as f64;
    let tolerance = Tolerance::from_mm(0.01).unwrap();
    Job::new(
        Source::PointGrid(grid(n)),
        Tool::ball(5.0),
        stepover_mm,
        tolerance,
        FeedRate::from_mm_per_min(1000.0).unwrap(),
    )
}

fn fit(c: &mut Criterion) {
    let mut group = c.benchmark_group("point_grid_fit");
    for n in [15, 30, 60, 120] {
        let grid = grid(n);
        group.bench_with_input(BenchmarkId::from_parameter(n), &grid, |b, grid| {
            b.iter(|| black_box(grid).surface().unwrap());
        });
    }
    group.finish();
}

fn mill(c: &mut Criterion) {
    let mut group = c.benchmark_group("mill");
    group.sample_size(10);
    for (n, sections) in [(15, 25), (30, 50), (60, 100)] {
        let job = job(n, sections);
        let name = format!("{n}x{n}, {sections} sections");
        group.bench_with_input(BenchmarkId::from_parameter(name), &job, |b, job| {
            b.iter(|| plan(black_box(job), &Budget::unlimited()).unwrap());
        });
    }
    group.finish();
}

fn certify(c: &mut Criterion) {
    let mut group = c.benchmark_group("certificate");
    group.sample_size(10);
    let job = job(60, 100);
    let surface = grid(60).surface().unwrap();
    let toolpath = plan(&job, &Budget::unlimited()).unwrap().toolpath;
    let curves: Vec<Curve> = toolpath
        .moves()
        .filter_map(|step| match step {
            Move::Feed { along, .. } => Some(*along),
            _ => None,
        })
        .collect();
    for share in [4, 2, 1] {
        let part = &curves[..curves.len() / share];
        group.bench_with_input(BenchmarkId::from_parameter(part.len()), part, |b, part| {
            let clearance = Clearance::new(&surface, job.tool.radius_mm, job.tool.radius_mm);
            b.iter(|| {
                let mut deepest = Penetration::NONE;
                for curve in part {
                    clearance.penetrate(curve, 0.0, 1e-4, &mut deepest, &Budget::unlimited()).unwrap();
                }
                deepest
            });
        });
    }
    group.finish();
}

criterion_group!(benches, fit, mill, certify);
criterion_main!(benches);
