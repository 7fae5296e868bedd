//! Times to plan one level of a pocket over growing sizes, each pattern alone; all on one thread.
//!
//! `cargo bench --bench pockets`

use std::f64::consts::TAU;
use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use nalgebra::Point2;
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::height_field::HeightGrid;
use toolpathd_core::geometry::segment::Segment;
use toolpathd_core::operations::pocketing::{Job, Outlines, Pattern, Relief, plan};
use toolpathd_core::toolpath::tool::{Shape, Tool};
use toolpathd_core::toolpath::units::FeedRate;

fn outline(corners: &[[f64; 2]]) -> Vec<Segment> {
    let at = |k: usize| Point2::from(corners[k % corners.len()]);
    (0..corners.len()).map(|k| Segment::Line { start: at(k), end: at(k + 1) }).collect()
}

fn rectangle(x: f64, y: f64, width: f64, height: f64) -> Vec<Segment> {
    outline(&[[x, y], [x + width, y], [x + width, y + height], [x, y + height]])
}

/// A job for a cutter of 10 mm with a stepover of 3 mm.
fn job(area: Outlines, pattern: Pattern) -> Job {
    let feed = FeedRate::from_mm_per_min(800.0).unwrap();
    let tool = Tool { shape: Shape::Flat, ..Tool::ball(5.0) };
    Job { patterns: vec![pattern], ..Job::new(area, -5.0, tool, 3.0, feed) }
}

fn run(c: &mut Criterion, group: &str, sizes: &[usize], area: impl Fn(usize) -> Outlines) {
    let mut group = c.benchmark_group(group);
    group.sample_size(10);
    for pattern in Pattern::ALL {
        for size in sizes {
            let job = job(area(*size), pattern);
            group.bench_with_input(BenchmarkId::new(format!("{pattern:?}"), size), &job, |b, job| {
                b.iter(|| plan(black_box(job), &Budget::unlimited()).unwrap().report.total_time_s);
            });
        }
    }
    group.finish();
}

/// Squares of growing side, mm.
fn squares(c: &mut Criterion) {
    run(c, "square", &[50, 100, 200], |side| Outlines {
        boundary: rectangle(0.0, 0.0, side as f64, side as f64),
        islands: Vec::new(),
    });
}

/// A wavy outline of some 100 mm with a growing number of vertices.
fn vertices(c: &mut Criterion) {
    run(c, "vertices", &[10, 100, 1_000], |n| {
        let corner = |k: usize| {
            let angle = TAU * k as f64 / n as f64;
            let radius = 50.0 * (1.0 + 0.1 * (5.0 * angle).sin());
            [radius * angle.cos(), radius * angle.sin()]
        };
        Outlines { boundary: outline(&(0..n).map(corner).collect::<Vec<_>>()), islands: Vec::new() }
    });
}

/// Plates with a growing number of square islands 20 mm apart.
fn islands(c: &mut Criterion) {
    run(c, "islands", &[1, 4, 16], |n| {
        let side = (n as f64).sqrt().ceil() as usize;
        let place = |k: usize| 20.0 + 30.0 * k as f64;
        let extent = 20.0 + 30.0 * side as f64;
        Outlines {
            boundary: rectangle(0.0, 0.0, extent, extent),
            islands: (0..n).map(|k| rectangle(place(k % side), place(k / side), 10.0, 10.0)).collect(),
        }
    });
}

/// Two levels of a wavy relief of 100 by 100 mm with a growing number of heights in a row.
fn heights(c: &mut Criterion) {
    let mut group = c.benchmark_group("heights");
    group.sample_size(10);
    for n in [25, 50, 100] {
        let spacing_mm = 100.0 / n as f64;
        let height = |k: usize, step: f64| (k as f64 * spacing_mm * step).sin();
        let row = |j: usize| (0..=n).map(|i| -6.0 + 5.0 * height(i, 0.1) * height(j, 0.13)).collect();
        let grid = HeightGrid { origin: Point2::origin(), spacing_mm, rows: (0..=n).map(row).collect() };
        let flat = Outlines { boundary: Vec::new(), islands: Vec::new() };
        let job = Job {
            area: None,
            relief: Some(Relief::Grid(grid)),
            floor_z_mm: -10.0,
            ..job(flat, Pattern::ZigzagStockOffset)
        };
        group.bench_with_input(BenchmarkId::from_parameter(n), &job, |b, job| {
            b.iter(|| plan(black_box(job), &Budget::unlimited()).unwrap().report.total_time_s);
        });
    }
    group.finish();
}

criterion_group!(benches, squares, vertices, islands, heights);
criterion_main!(benches);
