//! Repeats the experiment of the paper's Table 1: the number of arcs for several step lengths and tolerances,
//! on one section of the offset of a free-form surface of 5 by 5 points.
//!
//! The paper fits points of the section at a fixed step, and says that the step hardly matters. This is true
//! if there are about eight points or more for each arc. With fewer points, the arcs follow the points, but
//! not the curve between them. In the extreme case every arc passes through three points, whatever the
//! tolerance is. At a step of 1.0 and a tolerance of 1e-5 the arcs leave the curve by thousands of
//! tolerances.
//!
//! For this reason the operation of this project compares the arcs with the curve. The step length is an
//! upper limit, and the points are as close together as the tolerance needs.
//!
//! # Reference
//! S. Y. Ju, "CL-Cartesian Machining along Approximated Circular Arcs", section 5, Table 1.

use std::f64::consts::{PI, TAU};

use nalgebra::{Point3, Vector2};
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::arc_fit::{Fit, Joints, Method};
use toolpathd_core::geometry::curve::{Curve, Direction};
use toolpathd_core::geometry::surface::any_surface::AnySurface;
use toolpathd_core::geometry::surface::point_grid::{Ends, PointGrid, Twist};
use toolpathd_core::geometry::surface::source::Source;
use toolpathd_core::machining::offset_section::{PlaneAt, Sections, Spacing};
use toolpathd_core::machining::regularity;
use toolpathd_core::operations::surface_milling::{Job, plan};
use toolpathd_core::toolpath::tool::Tool;
use toolpathd_core::toolpath::units::{FeedRate, Tolerance};
use toolpathd_core::toolpath::{Move, Role, Toolpath};

use super::way::Way;
use super::{fitted, judge, ways};

const STEPS: [f64; 7] = [1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01];
const TOLERANCES: [f64; 4] = [1e-2, 1e-3, 1e-4, 1e-5];

/// The paper's table by steps: the number of points, the arcs at each tolerance, and the arcs of biarcs.
const PAPER: [(usize, [usize; 4], usize); 7] = [
    (14, [6, 6, 6, 6], 26),
    (26, [7, 12, 12, 12], 50),
    (62, [7, 14, 26, 29], 122),
    (123, [7, 14, 32, 56], 244),
    (244, [7, 14, 29, 71], 486),
    (607, [7, 14, 29, 67], 1212),
    (1213, [7, 14, 29, 68], 2424),
];

const RADIUS_MM: f64 = 0.5;

/// Distance of the points that stand for the curve, mm. The curve leaves their chords by some 1e-7 mm.
const DENSE_MM: f64 = 1e-3;

/// The plane y = const of the section in the first experiment, mm.
const PLANE_MM: f64 = 4.3;

fn freeform() -> PointGrid {
    let height = |x: f64, y: f64| {
        0.8 * (PI * x / 4.5).sin() * (1.0 + 0.3 * (PI * y / 9.0).cos())
            + 0.2 * (PI * x / 12.0).cos() * y / 12.0
    };
    let nodes = [0.0, 3.0, 6.0, 9.0, 12.0];
    let points = nodes.map(|x| nodes.map(|y| Point3::new(x, y, height(x, y))).to_vec()).to_vec();
    PointGrid { points, twist: Twist::Spline, ends: Ends::NotAKnot }
}

/// Dense points of the tip's curve in the plane at `y`, as (z, x), in the direction of rising x.
fn curve_at(y: f64) -> Vec<Vector2<f64>> {
    let budget = Budget::unlimited();
    let Ok(AnySurface::Bicubic(surface)) = Source::PointGrid(freeform()).surface() else { panic!() };
    let regularity = regularity::prove(&surface, RADIUS_MM, 1, &budget).unwrap();
    let sections = Sections::new(&surface, RADIUS_MM, 1, &regularity, &budget).unwrap();
    let spacing = Spacing { chord_height_mm: f64::INFINITY, step_length_mm: DENSE_MM };
    let [chain] = &sections.chains(PlaneAt::new(y), spacing, &budget).unwrap()[..] else { panic!() };
    let mut points: Vec<_> = chain.points.iter().map(|p| Vector2::new(p.z - RADIUS_MM, p.x)).collect();
    if points[0].y > points[points.len() - 1].y {
        points.reverse();
    }
    points
}

/// The length along the points from the first to each.
fn lengths(points: &[Vector2<f64>]) -> Vec<f64> {
    let mut length = 0.0;
    let steps = points.windows(2).map(|pair| {
        length += (pair[1] - pair[0]).norm();
        length
    });
    [0.0].into_iter().chain(steps.collect::<Vec<_>>()).collect()
}

/// Dense points that are about `step` (mm) apart along the curve, and the last dense point.
fn at_steps(dense: &[Vector2<f64>], step: f64) -> Vec<Vector2<f64>> {
    let lengths = lengths(dense);
    let end = lengths[lengths.len() - 1];
    let count = (end / step).ceil() as usize;
    let nearest = |k: usize| lengths.partition_point(|length| *length < k as f64 * step).min(dense.len() - 1);
    (0..count).map(|k| dense[nearest(k)]).chain([dense[dense.len() - 1]]).collect()
}

/// The number of arcs that the growth law expects: the integral of (|k'| / (72 sqrt 3 tolerance))^(1/3) over
/// the length. k' is the rate of change of the curvature along the curve.
fn law(dense: &[Vector2<f64>], tolerance: f64) -> f64 {
    let points = at_steps(dense, 0.03);
    let curvature = |k: usize| {
        let [a, b] = [points[k] - points[k - 1], points[k + 1] - points[k]];
        2.0 * a.perp(&b) / (a.norm() * b.norm() * (a + b).norm())
    };
    let each = (2..points.len() - 2).map(|k| {
        let step = (points[k + 1] - points[k]).norm();
        let rate = (curvature(k + 1) - curvature(k - 1)).abs() / (2.0 * step);
        (rate / (72.0 * 3f64.sqrt() * tolerance)).cbrt() * step
    });
    each.sum()
}

/// The largest distance of dense points from a chain of ways, mm. The points and the chain run the same way.
fn off(dense: &[Vector2<f64>], chain: &[Way]) -> f64 {
    let (mut at, mut worst) = (0, 0.0f64);
    for p in dense {
        while at + 1 < chain.len() && chain[at + 1].distance(*p) <= chain[at].distance(*p) {
            at += 1;
        }
        worst = worst.max(chain[at].distance(*p));
    }
    worst
}

#[test]
fn arc_counts_depend_on_the_tolerance_and_a_fit_to_coarse_points_leaves_the_curve() {
    let dense = curve_at(PLANE_MM);
    let finest = at_steps(&dense, STEPS[6]);
    let fewest = TOLERANCES.map(|tolerance| {
        let request = Fit { joints: Joints::OnPoints, ..Fit::within(tolerance) };
        fitted(&finest, &request).elements.len()
    });
    println!("growth law: {:.1?}", TOLERANCES.map(|tolerance| law(&dense, tolerance)));
    let mut coarse_error = f64::INFINITY;
    for (step, paper) in STEPS.into_iter().zip(PAPER) {
        let points = at_steps(&dense, step);
        let spans = points.len() - 1;
        let biarc = fitted(&points, &Fit { method: Method::Biarc, ..Fit::within(1e-5) }).elements.len();
        let cells = TOLERANCES.map(|tolerance| {
            let request = Fit { joints: Joints::OnPoints, ..Fit::within(tolerance) };
            let found = fitted(&points, &request);
            let greedy = fitted(&points, &Fit { method: Method::Greedy, ..request });
            let [count, greedy] = [&found, &greedy].map(|found| judge(&points, found, tolerance).unwrap());
            let chain: Vec<_> = ways(&found).into_iter().map(|(way, _)| way).collect();
            (count, greedy, off(&dense, &chain) / tolerance)
        });
        println!(
            "step {step}: {} points, biarcs {biarc}; (optimal, greedy, true error in tolerances) {cells:.1?}; paper {paper:?}",
            spans + 1
        );
        assert_eq!(biarc, 2 * spans);
        for ((count, greedy, error), fewest) in cells.into_iter().zip(fewest) {
            assert!(
                count <= greedy && greedy <= count + 2,
                "step {step}: {count} arcs, {greedy} by the greedy method"
            );
            assert!(2 * count <= spans + 2, "step {step}: {count} arcs are too many for {spans} spans");
            if spans >= 8 * fewest {
                assert!(
                    count.abs_diff(fewest) <= 1 + fewest / 10,
                    "step {step}: {count} arcs, {fewest} at the finest step"
                );
                assert!(error <= 1.5, "step {step}: the arcs leave the curve by {error} tolerances");
            }
        }
        let (finest_count, _, error) = cells[3];
        if step == 1.0 {
            // Each arc has three points.
            assert!(2 * finest_count >= spans - 1, "{finest_count} arcs are too few for {spans} spans");
            coarse_error = error;
        }
    }
    assert!(
        coarse_error > 500.0 && coarse_error.is_finite(),
        "the coarsest fit leaves the curve by {coarse_error} tolerances only"
    );
}

/// An arc or a line in a plane y = const, as a way over (z, x).
fn way(curve: &Curve) -> Way {
    let flat = |p: Point3<f64>| Vector2::new(p.z, p.x);
    let [from, to] = [curve.start(), curve.end()].map(flat);
    let Curve::Arc(arc) = curve else { return Way::line(from, to) };
    let center = flat(arc.center());
    let [start, end] = [from, to].map(|p| (p.y - center.y).atan2(p.x - center.x));
    let ccw = (end - start).rem_euclid(TAU);
    let sweep = if arc.direction() == Direction::Ccw { ccw } else { ccw - TAU };
    Way::Arc { center, radius: (from - center).norm(), start, sweep, ends: [from, to] }
}

/// The cutting moves of a path, grouped by the y of their plane.
fn cuts(path: &Toolpath) -> Vec<(f64, Vec<Way>)> {
    let mut passes: Vec<(f64, Vec<Way>)> = Vec::new();
    for step in path.moves() {
        let Move::Feed { along, role: Role::Cut, .. } = step else { continue };
        let y = along.start().y;
        match passes.last_mut() {
            Some((plane, ways)) if *plane == y => ways.push(way(along)),
            _ => passes.push((y, vec![way(along)])),
        }
    }
    passes
}

/// Step lengths for the operation, mm.
const OPERATION_STEPS: [f64; 3] = [1.0, 0.5, 0.05];

#[test]
fn milling_keeps_every_tolerance_at_every_step_length() {
    let feed = FeedRate::from_mm_per_min(1000.0).unwrap();
    let mut curves: Vec<(f64, Vec<Vector2<f64>>)> = Vec::new();
    for tolerance in TOLERANCES {
        for step in OPERATION_STEPS {
            let (source, ball) = (Source::PointGrid(freeform()), Tool::ball(RADIUS_MM));
            let mut job = Job::new(source, ball, 5.0, Tolerance::from_mm(tolerance).unwrap(), feed);
            (job.resolution.decimals, job.step_length_mm) = (6, Some(step));
            let plan = plan(&job, &Budget::unlimited()).unwrap();
            let report = &plan.report;
            assert!(
                report.deviation_max_mm <= tolerance,
                "step {step}: the stated deviation exceeds the tolerance {tolerance}: {report:?}"
            );
            let mut counts = Vec::new();
            // The outermost passes lie along edges of the surface and are left out.
            let passes = cuts(&plan.toolpath);
            for (y, chain) in &passes[1..passes.len() - 1] {
                if !curves.iter().any(|(plane, _)| plane == y) {
                    curves.push((*y, curve_at(*y)));
                }
                let dense = &curves.iter().find(|(plane, _)| plane == y).unwrap().1;
                let is_backward = chain[0].distance(dense[0]) > chain[0].distance(dense[dense.len() - 1]);
                let backward: Vec<_> = dense.iter().rev().copied().collect();
                let error = off(if is_backward { &backward } else { dense }, chain) / tolerance;
                assert!(
                    error <= 1.0,
                    "step {step}, tolerance {tolerance}: the pass at y = {y} leaves the curve by {error} tolerances"
                );
                let expected = law(dense, tolerance);
                let count = chain.len() as f64;
                assert!(
                    (0.8 * expected - 2.0..=1.6 * expected + 3.0).contains(&count),
                    "step {step}, tolerance {tolerance}: the pass at y = {y} has {count} arcs, the growth law expects {expected}",
                );
                counts.push((chain.len(), expected, error));
            }
            println!(
                "{tolerance} {step}: {} points, (arcs, law, true error) {counts:.1?}",
                report.n_cl_points
            );
        }
    }
}
