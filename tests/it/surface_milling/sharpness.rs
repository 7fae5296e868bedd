//! Compares the stated deviation and gouge with dense samples of the path, for every cutter. The stated
//! figures must be no smaller than the sampled figures, and not much larger. This holds for the computed path
//! and for the path of the NC text.
//!
//! At each sample, a cutter is dropped onto the surface, and its tip is compared with the path.

use std::f64::consts::PI;

use nalgebra::Point3;
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::surface::Surface;
use toolpathd_core::geometry::surface::point_grid::{Ends, PointGrid};
use toolpathd_core::machining::cutter::Cutter;
use toolpathd_core::machining::drop_cutter::Contacts;
use toolpathd_core::operations::surface_milling::{Interpolation, Job, plan};
use toolpathd_core::toolpath::tool::{Shape, Tool};

use super::jobs::{heights, job};
use super::motion::{Kind, Motion, planned, written};

/// Distance of the samples along a path, mm.
const APART_MM: f64 = 0.02;

/// Allowance for rounding in the search for tips, mm.
const ROUNDING_MM: f64 = 1e-7;

/// Sampled figures of a path: its largest distance from the dropped tips, perpendicular to the path, and its
/// largest depth perpendicular to the surface at the contact.
#[derive(Debug, Default, Clone, Copy)]
struct Found {
    deviation_mm: f64,
    depth_mm: f64,
}

fn cutter_of(tool: &Tool) -> Cutter {
    match tool.shape {
        Shape::Ball => Cutter::ball(tool.radius_mm),
        Shape::Flat => Cutter::bull_nose(tool.radius_mm, 0.0),
        Shape::BullNose { corner_radius_mm } => Cutter::bull_nose(tool.radius_mm, corner_radius_mm),
        _ => unreachable!("mills are balls, flat ends and bull noses"),
    }
}

fn found(job: &Job, grid: &PointGrid, motions: impl Iterator<Item = (Kind, Motion)>) -> Found {
    let surface = grid.surface().unwrap().upward();
    let budget = Budget::unlimited();
    let contacts = Contacts::new(&surface, cutter_of(&job.tool), &budget).unwrap();
    let mut found = Found::default();
    for (kind, motion) in motions.filter(|(kind, _)| matches!(kind, Kind::Cut | Kind::Link)) {
        let steps = (motion.length() / APART_MM).ceil().max(1.0);
        let tips: Vec<Point3<f64>> = (0..=steps as usize).map(|k| motion.at(k as f64 / steps)).collect();
        for pair in tips.windows(2) {
            let way = pair[1] - pair[0];
            let share = if way.norm() > 0.0 { way.xy().norm() / way.norm() } else { 0.0 };
            let Some(contact) = contacts.drop(pair[0].xy().coords, None, &budget).unwrap() else { continue };
            let below = (contact.tip.z - pair[0].z) * share;
            // A contact on a sharp rim has slope zero. There the slope of the surface turns the height into a
            // depth.
            let slope = surface.jet(contact.place[0], contact.place[1]).gradient().norm().max(contact.slope);
            let depth = (contact.tip.z - pair[0].z) / 1f64.hypot(slope);
            if kind == Kind::Cut {
                found.deviation_mm = found.deviation_mm.max(below.abs());
            }
            found.depth_mm = found.depth_mm.max(depth);
        }
    }
    found
}

fn hold(job: &Job, grid: &PointGrid) {
    let plan = plan(job, &Budget::unlimited()).unwrap();
    let report = &plan.report;
    let computed = found(job, grid, planned(&plan).into_iter().flatten());
    let written = written(job, &plan);
    let written =
        written.iter().flat_map(|(kind, motion)| motion.extremes().into_iter().map(|motion| (*kind, motion)));
    let written = found(job, grid, written);
    let step = job.resolution.step_mm();
    let most = |a: f64, b: f64| a.max(b);
    for (stated, found, what) in [
        (report.deviation_max_mm, most(computed.deviation_mm, written.deviation_mm), "deviation"),
        (report.gouge_max_mm, most(computed.depth_mm, written.depth_mm), "gouge"),
    ] {
        let name = format!("{what} of {:?}, {:?}, {}", job.tool.shape, job.interpolation, job.tolerance.mm());
        assert!(found <= stated + ROUNDING_MM, "{name} is stated too small: {found} found, {stated} stated");
        assert!(
            stated <= 2.0 * found + 1.5 * step,
            "{name} is stated far too large: {found} found, {stated} stated"
        );
    }
}

#[test]
fn stated_deviation_and_gouge_are_at_least_and_at_most_twice_the_sampled_figures() {
    let plane = |x: f64, y: f64| 0.3 * x - 0.2 * y;
    let wave = |x: f64, y: f64| (PI * x / 6.0).sin() * (PI * y / 8.0).cos();
    let trough = |x: f64, _: f64| 0.05 * x * x;
    let hill = |x: f64, y: f64| -0.02 * (x * x + y * y);
    let shapes: [&dyn Fn(f64, f64) -> f64; 4] = [&plane, &wave, &trough, &hill];
    for height in shapes {
        let grid = heights(7, [-6.0, 6.0], Ends::NotAKnot, height);
        for shape in [Shape::Ball, Shape::Flat, Shape::BullNose { corner_radius_mm: 0.5 }] {
            for tolerance_mm in [0.003, 0.05] {
                for interpolation in [Interpolation::Arcs, Interpolation::Lines] {
                    let base = job(grid.clone(), 3.0, 3.7, tolerance_mm, 3);
                    let tool = Tool { shape, ..base.tool };
                    hold(&Job { tool, interpolation, ..base }, &grid);
                }
            }
        }
    }
}
