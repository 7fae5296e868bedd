//! Times of offsets and unions of regions over growing sizes; all on one thread.
//!
//! `cargo bench --bench regions`

use std::f64::consts::TAU;
use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use nalgebra::Point2;
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::region::{Outline, Region};
use toolpathd_core::geometry::segment::Segment;

const SIZES: [usize; 4] = [10, 100, 1_000, 10_000];

/// A wavy ring of lines and arcs in turn, of about 1 mm each.
fn elements(n: usize, shift: f64) -> Vec<Segment> {
    let at = |k: usize| {
        let angle = TAU * (k % n) as f64 / n as f64;
        let radius = n as f64 / TAU * (1.0 + 0.1 * (5.0 * angle).sin());
        Point2::new(shift + radius * angle.cos(), radius * angle.sin())
    };
    let element = |k: usize| {
        let (start, end) = (at(k), at(k + 1));
        let bulge = if k.is_multiple_of(2) { 0.1 } else { 0.0 };
        Segment::bulging(start, end, bulge)
    };
    (0..n).map(element).collect()
}

fn ring(n: usize, shift: f64) -> Region {
    let outline = Outline::new(&elements(n, shift), &Budget::unlimited()).unwrap();
    Region::new(&[outline], &[], &Budget::unlimited()).unwrap()
}

/// A square plate with `n` round islands in rows, 10 mm from each other.
fn plate(n: usize) -> Region {
    let side = (n as f64).sqrt().ceil() as usize;
    let island = |k: usize| {
        let [x, y] = [k % side, k / side].map(|k| 10.0 * (k + 1) as f64);
        let ends = [Point2::new(x + 2.0, y), Point2::new(x - 2.0, y)];
        let half = |[start, end]: [Point2<f64>; 2]| Segment::bulging(start, end, -1.0);
        Outline::new(&[half(ends), half([ends[1], ends[0]])], &Budget::unlimited()).unwrap()
    };
    let far = 10.0 * (side + 1) as f64;
    let corners = [[0.0, 0.0], [far, 0.0], [far, far], [0.0, far]].map(|[x, y]| Point2::new(x, y));
    let wall: Vec<Segment> =
        (0..4).map(|k| Segment::Line { start: corners[k], end: corners[(k + 1) % 4] }).collect();
    let wall = Outline::new(&wall, &Budget::unlimited()).unwrap();
    let islands: Vec<Outline> = (0..n).map(island).collect();
    Region::new(&[wall], &islands, &Budget::unlimited()).unwrap()
}

fn run<T>(
    c: &mut Criterion,
    group: &str,
    inputs: impl Iterator<Item = (usize, T)>,
    what: impl Fn(&T) -> Region,
) {
    let mut group = c.benchmark_group(group);
    group.sample_size(10);
    for (n, input) in inputs {
        group.throughput(Throughput::Elements(n as u64));
        group.bench_with_input(BenchmarkId::from_parameter(n), &input, |b, input| {
            b.iter(|| what(black_box(input)));
        });
    }
    group.finish();
}

fn offsets(c: &mut Criterion) {
    let inward = |region: &Region| region.offset_inward(2.0, &Budget::unlimited()).unwrap();
    run(c, "offset of a ring of n elements", SIZES.iter().map(|n| (*n, ring(*n, 0.0))), inward);
    run(c, "offset of a plate with n islands", SIZES.iter().map(|n| (*n, plate(*n))), inward);
}

fn unions(c: &mut Criterion) {
    let pair = |n: usize| (n, [ring(n, 0.0), ring(n, n as f64 / 20.0)]);
    run(c, "union of two rings of n elements", SIZES.iter().map(|n| pair(*n)), |[a, b]| {
        Region::union(&[a, b], &Budget::unlimited()).unwrap()
    });
}

criterion_group!(benches, offsets, unions);
criterion_main!(benches);
