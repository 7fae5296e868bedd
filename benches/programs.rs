//! Times of writing programs over growing sizes, and of estimating their time; all on one thread.
//!
//! `cargo bench --bench programs`

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use nalgebra::Point3;
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::curve::Direction;
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::cutting::CuttingRequest;
use toolpathd_core::toolpath::motion_time::motion_time;
use toolpathd_core::toolpath::program::{Program, Resolution, Units};
use toolpathd_core::toolpath::tool::Tool;
use toolpathd_core::toolpath::units::FeedRate;
use toolpathd_core::toolpath::{Role, Toolpath};
use toolpathd_post::{DIALECTS, ProgramJob};

/// `n` moves in a spiral: an arc in zx, then a line in y, again and again.
fn spiral(n: usize) -> Toolpath {
    let feed = FeedRate::from_mm_per_min(1000.0).unwrap();
    let mut path = Toolpath::builder(Point3::origin());
    for k in 0..n {
        let at = path.at();
        if k % 2 == 0 {
            let width = if k % 4 == 0 { 7.3 } else { -7.3 };
            let (to, center) =
                (at + nalgebra::Vector3::x() * width, at + nalgebra::Vector3::x() * (width / 2.0));
            path.arc(to, center, (Plane::Zx, Direction::Ccw), feed, Role::Cut).unwrap();
        } else {
            path.line(at + nalgebra::Vector3::y() * 0.0137, feed, Role::Link).unwrap();
        }
    }
    path.finish().unwrap()
}

fn write(c: &mut Criterion) {
    let plain = Program::plain(Resolution { units: Units::Mm, decimals: 3 });
    let program = Program { block_numbers: true, ..plain };
    let tool = Tool::ball(3.0);
    let cutting = CuttingRequest::at_feed(FeedRate::from_mm_per_min(1000.0).unwrap()).at_heights(20.0, 20.0);
    let mut group = c.benchmark_group("write");
    group.sample_size(10);
    for n in [2_000, 20_000, 200_000] {
        let path = spiral(n);
        group.throughput(Throughput::Elements(n as u64));
        for dialect in DIALECTS {
            let job = ProgramJob { tool: Some(&tool), ..ProgramJob::plain(&program, &cutting, dialect) };
            group.bench_with_input(BenchmarkId::new(dialect.name, n), &path, |b, path| {
                b.iter(|| toolpathd_post::write(black_box(path), &job, &Budget::unlimited()).unwrap());
            });
        }
    }
    group.finish();
}

fn estimate(c: &mut Criterion) {
    let cutting = CuttingRequest::at_feed(FeedRate::from_mm_per_min(1000.0).unwrap()).at_heights(20.0, 20.0);
    let mut group = c.benchmark_group("motion_time");
    for n in [2_000, 20_000, 200_000] {
        let path = spiral(n);
        group.throughput(Throughput::Elements(n as u64));
        group.bench_with_input(BenchmarkId::from_parameter(n), &path, |b, path| {
            b.iter(|| motion_time(black_box(path), cutting.rapid_feed, cutting.acceleration));
        });
    }
    group.finish();
}

criterion_group!(benches, write, estimate);
criterion_main!(benches);
