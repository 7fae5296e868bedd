//! Times of removing stock along moves, over growing numbers of moves; all on one thread but the last.
//!
//! `cargo bench --bench stock`

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use nalgebra::Point3;
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::curve::{Curve, Line};
use toolpathd_core::machining::assembly::Assembly;
use toolpathd_core::machining::cutter::Cutter;
use toolpathd_core::machining::stock::{Shape, Step, Stock};

/// A block of 100 x 80 mm in cells of 0.25 mm.
fn block() -> Stock {
    let shape = Shape::Block { low: Point3::new(0.0, 0.0, -30.0), high: Point3::new(100.0, 80.0, 0.0) };
    Stock::new(&shape, 0.25, 1_000_000, &Budget::unlimited()).expect("a block")
}

/// Rows to and fro over a wavy surface, as `n` short lines.
fn rows(n: usize) -> Vec<Line> {
    let rows = 80;
    let of_row = n / rows;
    let at = |row: usize, k: usize| {
        let t = k as f64 / of_row as f64;
        let x = 100.0 * if row.is_multiple_of(2) { t } else { 1.0 - t };
        let y = row as f64;
        Point3::new(x, y, -6.0 + 3.0 * (0.1 * x).sin() * (0.08 * y).cos())
    };
    let points: Vec<Point3<f64>> = (0..rows).flat_map(|row| (0..=of_row).map(move |k| at(row, k))).collect();
    points.windows(2).map(|ends| Line { start: ends[0], end: ends[1] }).collect()
}

fn removal(c: &mut Criterion) {
    let mut group = c.benchmark_group("stock");
    group.sample_size(10);
    let stock = block();
    for (name, cutter) in [
        ("ball", Cutter::ball(5.0)),
        ("flat", Cutter::bull_nose(5.0, 0.0)),
        ("bull nose", Cutter::bull_nose(5.0, 1.0)),
    ] {
        let tool = Assembly::bare(cutter);
        for n in [4_000, 20_000, 100_000] {
            let lines = rows(n);
            let steps: Vec<Step<'_>> = lines
                .iter()
                .map(|line| Step {
                    tip: Curve::Line(*line),
                    slack_mm: 0.0,
                    tool: &tool,
                    is_rapid: false,
                    is_sure: true,
                })
                .collect();
            group.throughput(Throughput::Elements(n as u64));
            group.bench_function(BenchmarkId::new(name, n), |b| {
                b.iter(|| stock.after(black_box(&steps), 0.0, &Budget::unlimited()));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, removal);
criterion_main!(benches);
