//! Times of drawing over growing numbers of moves; all on one thread.
//!
//! `cargo bench --bench plot`

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use nalgebra::Point3;
use toolpathd_core::geometry::curve::Direction;
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::units::FeedRate;
use toolpathd_core::toolpath::{Role, Toolpath};
use toolpathd_plot::{Drawing, Scene, svg};

fn feed() -> FeedRate {
    FeedRate::from_mm_per_min(1000.0).unwrap()
}

/// Rows with `n` short lines in all, on a wave over 160 x 120 mm.
fn lines(n: usize) -> Toolpath {
    let side = (n as f64).sqrt() as usize;
    let mut builder = Toolpath::builder(Point3::origin());
    for k in 0..n {
        let (row, i) = (k / side, k % side);
        let column = if row % 2 == 0 { i } else { side - 1 - i };
        let (x, y) = (160.0 * column as f64 / side as f64, 120.0 * row as f64 / side as f64);
        builder.line(Point3::new(x, y, 8.0 * (x / 9.0).sin()), feed(), Role::Cut).unwrap();
    }
    builder.finish().unwrap()
}

/// `n` half circles of 1 mm in the zx plane, row by row.
fn arcs(n: usize) -> Toolpath {
    let mut builder = Toolpath::builder(Point3::origin());
    for k in 0..n {
        let (row, column) = (k / 100, k % 100);
        let y = 120.0 * row as f64 / (n / 100) as f64;
        if column == 0 {
            builder.rapid(Point3::new(0.0, y, 0.0)).unwrap();
        }
        let x = 2.0 * column as f64;
        let about = (Plane::Zx, Direction::Ccw);
        builder
            .arc(Point3::new(x + 2.0, y, 0.0), Point3::new(x + 1.0, y, 0.0), about, feed(), Role::Cut)
            .unwrap();
    }
    builder.finish().unwrap()
}

fn draw(c: &mut Criterion) {
    let mut group = c.benchmark_group("plot");
    group.sample_size(10);
    for (name, path) in [("lines", lines as fn(usize) -> Toolpath), ("arcs", arcs)] {
        for n in [1_000, 10_000, 100_000, 1_000_000] {
            let toolpath = path(n);
            group.throughput(Throughput::Elements(n as u64));
            group.bench_with_input(BenchmarkId::new(name, n), &toolpath, |b, toolpath| {
                b.iter(|| {
                    svg(black_box(&Scene {
                        title: "Part",
                        notes: &[],
                        warnings: &[],
                        toolpath: Some(toolpath),
                        drawing: &Drawing::default(),
                    }))
                });
            });
        }
    }
    group.finish();
}

criterion_group!(benches, draw);
criterion_main!(benches);
