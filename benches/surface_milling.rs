//! Times of the steps of surface milling over growing sizes. Milling and dropping cutters use all threads of
//! the machine.
//!
//! `cargo bench --bench surface_milling`

use std::f64::consts::PI;
use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use nalgebra::{Point2, Point3};
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::curve::Curve;
use toolpathd_core::geometry::surface::point_grid::{Ends, PointGrid, Twist};
use toolpathd_core::geometry::surface::source::Source;
use toolpathd_core::machining::cutter::Cutter;
use toolpathd_core::machining::drop_cutter::{Contacts, TipSections};
use toolpathd_core::machining::gouge::{GougeProof, Penetration};
use toolpathd_core::machining::offset_section::{Chain, PlaneAt, SectionError, Sections, Spacing};
use toolpathd_core::machining::regularity::prove;
use toolpathd_core::operations::cutter_location;
use toolpathd_core::operations::surface_milling::{Job, plan};
use toolpathd_core::toolpath::Move;
use toolpathd_core::toolpath::tool::{Shape, Tool};
use toolpathd_core::toolpath::units::{FeedRate, Tolerance};

/// n x n points of z = 10 sin(pi x/40) cos(pi y/40) at 5 mm.
fn grid(n: usize) -> PointGrid {
    grid_at(5.0, n)
}

fn grid_at(pitch: f64, n: usize) -> PointGrid {
    let height = |x: f64, y: f64| 10.0 * (PI * x / 40.0).sin() * (PI * y / 40.0).cos();
    let at = |i: usize| pitch * i as f64;
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

/// The number of points of all sections.
fn count(planes: &[PlaneAt], chains: impl Fn(PlaneAt) -> Result<Vec<Chain>, SectionError>) -> usize {
    planes.iter().flat_map(|plane| chains(*plane).unwrap()).map(|chain| chain.points.len()).sum()
}

/// Twenty sections, spread over the grid, without fitting arcs.
fn sections(c: &mut Criterion) {
    let (radius, axis, budget) = (5.0, 1, Budget::unlimited());
    let spacing = Spacing { chord_height_mm: 3e-4, step_length_mm: f64::INFINITY };
    let mut group = c.benchmark_group("sections");
    group.sample_size(10);
    for n in [15, 30, 60] {
        let surface = grid(n).surface().unwrap();
        let planes: Vec<PlaneAt> =
            (0..20).map(|k| PlaneAt::new(5.0 * (n - 1) as f64 * (f64::from(k) + 0.4) / 20.0)).collect();
        let regularity = prove(&surface, radius, axis, &budget).unwrap();
        let of_offset = Sections::new(&surface, radius, axis, &regularity, &budget).unwrap();
        group.bench_function(BenchmarkId::new("of the offset", n), |b| {
            b.iter(|| count(&planes, |plane| of_offset.chains(plane, spacing, &budget)));
        });
        let contacts = Contacts::new(&surface, Cutter::ball(radius), &budget).unwrap();
        let of_tips = TipSections::new(&contacts, axis, &budget).unwrap();
        group.bench_function(BenchmarkId::new("by contact", n), |b| {
            b.iter(|| count(&planes, |plane| of_tips.chains(plane, spacing, &budget)));
        });
    }
    group.finish();
}

/// The task that `benches/peers/opencascade` gives to Open CASCADE: 100 sections of the offset through 9 x 9
/// points at 10 mm, with every step from the points on.
fn sections_of_peer(c: &mut Criterion) {
    let (radius, axis, budget) = (5.0, 1, Budget::unlimited());
    let planes: Vec<PlaneAt> =
        (0..100).map(|k| PlaneAt::new(0.5607 + (79.4393 - 0.5607) * f64::from(k) / 99.0)).collect();
    let mut group = c.benchmark_group("100 sections through 9 x 9 points");
    for chord_height_mm in [3e-4, 1e-5] {
        let spacing = Spacing { chord_height_mm, step_length_mm: f64::INFINITY };
        group.bench_function(BenchmarkId::from_parameter(chord_height_mm), |b| {
            b.iter(|| {
                let surface = grid_at(10.0, 9).surface().unwrap();
                let regularity = prove(&surface, radius, axis, &budget).unwrap();
                let sections = Sections::new(&surface, radius, axis, &regularity, &budget).unwrap();
                count(&planes, |plane| sections.chains(plane, spacing, &budget))
            });
        });
    }
    group.finish();
}

/// Cutters dropped all over a grid of 30 x 30 points.
fn drop(c: &mut Criterion) {
    let mut group = c.benchmark_group("drop");
    group.sample_size(10);
    for (name, shape) in [
        ("ball", Shape::Ball),
        ("bull nose", Shape::BullNose { corner_radius_mm: 1.0 }),
        ("flat", Shape::Flat),
    ] {
        for count in [1_000u32, 4_000, 16_000] {
            let at = |k: u32, step: f64| 145.0 * (f64::from(k) * step).fract();
            let points =
                (0..count).map(|k| Point2::new(at(k, 0.754_877_666), at(k, 0.569_840_291))).collect();
            let tool = Tool { shape, ..Tool::ball(5.0) };
            let job = cutter_location::Job { surface: Source::PointGrid(grid(30)), tool, points };
            group.throughput(Throughput::Elements(count.into()));
            group.bench_function(BenchmarkId::new(name, count), |b| {
                b.iter(|| cutter_location::locate(&job, &Budget::unlimited()).unwrap());
            });
        }
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
            let proof = GougeProof::new(&surface, &job.tool.cutter(), 0.0);
            b.iter(|| {
                let mut deepest = Penetration::NONE;
                for curve in part {
                    proof.penetrate(curve, 0.0, 1e-4, &mut deepest, &Budget::unlimited()).unwrap();
                }
                deepest
            });
        });
    }
    group.finish();
}

criterion_group!(benches, fit, mill, sections, sections_of_peer, drop, certify);
criterion_main!(benches);
