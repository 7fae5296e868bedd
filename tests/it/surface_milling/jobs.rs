//! The jobs that the tests plan and judge.

use std::f64::consts::PI;

use nalgebra::Point3;
use toolpathd_core::geometry::surface::point_grid::{Ends, PointGrid, Twist};
use toolpathd_core::geometry::surface::source::Source;
use toolpathd_core::operations::surface_milling::{CutDirection, Job, SectionPlane};
use toolpathd_core::toolpath::tool::Tool;
use toolpathd_core::toolpath::units::{FeedRate, Tolerance};

pub const PLANES: [SectionPlane; 2] = [SectionPlane::Zx, SectionPlane::Yz];

/// A square grid of `n` by `n` points of a graph. The first index runs along x, the second along y.
pub fn heights(n: usize, [from, to]: [f64; 2], ends: Ends, height: impl Fn(f64, f64) -> f64) -> PointGrid {
    let node = |k: usize| from + (to - from) * k as f64 / (n - 1) as f64;
    let row = |i: usize| {
        (0..n).map(|j| Point3::new(node(i), node(j), height(node(i), node(j)))).collect::<Vec<_>>()
    };
    PointGrid { points: (0..n).map(row).collect(), twist: Twist::Spline, ends }
}

pub fn job(surface: PointGrid, diameter_mm: f64, stepover_mm: f64, tolerance_mm: f64, decimals: u8) -> Job {
    let tolerance = Tolerance::from_mm(tolerance_mm).unwrap();
    let feed = FeedRate::from_mm_per_min(1000.0).unwrap();
    let mut job =
        Job::new(Source::PointGrid(surface), Tool::ball(0.5 * diameter_mm), stepover_mm, tolerance, feed);
    job.resolution.decimals = decimals;
    job
}

/// The points of a job's grid.
pub fn points(job: &mut Job) -> impl Iterator<Item = &mut Point3<f64>> {
    match &mut job.surface {
        Source::PointGrid(grid) => grid.points.iter_mut().flatten(),
        other => panic!("{other:?} is no grid"),
    }
}

/// The grid of a job.
pub fn grid_of(job: &Job) -> &PointGrid {
    match &job.surface {
        Source::PointGrid(grid) => grid,
        other => panic!("{other:?} is no grid"),
    }
}

/// The die: two hills and two hollows.
pub fn die(plane: SectionPlane, direction: CutDirection) -> Job {
    let wave = |x: f64, y: f64| 10.0 * (PI * x / 40.0).sin() * (PI * y / 40.0).cos();
    let surface = heights(9, [0.0, 80.0], Ends::NotAKnot, wave);
    Job { plane, direction, ..job(surface, 10.0, 2.0, 0.01, 3) }
}

/// A small freeform of gentle bumps.
pub fn freeform(plane: SectionPlane, direction: CutDirection) -> Job {
    let bumps = |x: f64, y: f64| {
        0.3 + 1.2 * (PI * x / 12.0).sin() * (PI * y / 12.0).sin() + 0.15 * (PI * x / 6.0).sin()
    };
    let surface = heights(5, [0.0, 12.0], Ends::Natural, bumps);
    Job { plane, direction, ..job(surface, 2.0, 0.5, 0.01, 3) }
}
