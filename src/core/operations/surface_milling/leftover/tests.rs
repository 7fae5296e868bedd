use std::f64::consts::PI;

use super::*;
use crate::geometry::surface::nurbs::Nurbs;
use crate::geometry::surface::point_grid::{Ends, PointGrid, Twist};
use crate::geometry::surface::source::Source;
use crate::machining::cutter::Cutter;
use crate::machining::uncut::distance_from;
use crate::operations::surface_milling::{Boundary, Plan, Report, SectionPlane, plan};
use crate::toolpath::tool::{Shape, Tool};
use crate::toolpath::units::{FeedRate, Tolerance};
use crate::toolpath::{Move, Role};

/// The polygon with the corners (x, z), swept along y over `width` mm.
fn swept(corners: &[[f64; 2]], width: f64) -> Source {
    let n = corners.len();
    let mut knots: Vec<f64> = (0..n).map(|k| k as f64).collect();
    knots.insert(0, 0.0);
    knots.push((n - 1) as f64);
    let row = |[x, z]: &[f64; 2]| [0.0, width].map(|y| Point3::new(*x, y, *z)).to_vec();
    Source::Nurbs(Nurbs {
        degree: [1, 1],
        knots: [knots, vec![0.0, 0.0, 1.0, 1.0]],
        control_points: corners.iter().map(row).collect(),
        weights: None,
    })
}

/// The graph of `height` over `n` by `n` points of a square of `size` mm.
fn graph(n: usize, size: f64, height: impl Fn(f64, f64) -> f64) -> Source {
    let at = |k: usize| size * k as f64 / (n - 1) as f64;
    let row = |i: usize| (0..n).map(|j| Point3::new(at(i), at(j), height(at(i), at(j)))).collect();
    let points = (0..n).map(row).collect();
    Source::PointGrid(PointGrid { points, twist: Twist::Spline, ends: Ends::NotAKnot })
}

fn job(surface: Source, tool: Tool, stepover_mm: f64) -> Job {
    let feed = FeedRate::from_mm_per_min(1000.0).unwrap();
    Job::new(surface, tool, stepover_mm, Tolerance::from_mm(0.01).unwrap(), feed)
}

fn tool(shape: Shape, radius_mm: f64) -> Tool {
    Tool { shape, ..Tool::ball(radius_mm) }
}

fn planned(job: &Job) -> Plan {
    plan(job, &Budget::unlimited()).unwrap()
}

fn report(job: &Job) -> Report {
    planned(job).report
}

/// The largest distance of the points of a graph from the cutter over all passes of a plan, by dense points
/// of both.
fn measured(plan: &Plan, cutter: &Cutter, size: f64, surface: &Source) -> f64 {
    let crate::geometry::surface::any_surface::AnySurface::Bicubic(surface) = surface.surface().unwrap()
    else {
        panic!("no bicubic patches");
    };
    let cuts = plan.toolpath.moves().filter_map(|step| match step {
        Move::Feed { along, role: Role::Cut, .. } => Some(*along),
        _ => None,
    });
    let tips: Vec<Point3<f64>> = cuts
        .flat_map(|curve| {
            let n = (curve.length() / 0.02).ceil().max(1.0);
            (0..=n as usize).map(move |k| curve.point_at(k as f64 / n))
        })
        .collect();
    let reach = cutter.radius() + 1.0;
    let mut most = 0.0f64;
    for patch in surface.patches() {
        for k in 0..25 * 25 {
            let p = patch.jet((k / 25) as f64 / 24.0, (k % 25) as f64 / 24.0).point;
            let near = tips.iter().filter(|tip| (**tip - p).xy().amax() < reach);
            let least = near.map(|tip| distance_from(cutter, tip, &p)).fold(size, f64::min);
            most = most.max(least);
        }
    }
    most
}

#[test]
fn what_is_left_in_a_groove_is_the_distance_of_its_bottom_from_the_ball() {
    for angle in [30.0f64, 45.0, 60.0, 90.0, 120.0] {
        let half = 0.5 * angle.to_radians();
        let (deep, wide) = (20.0 * half.cos(), 20.0 * half.sin());
        let groove = swept(&[[-wide, deep], [0.0, 0.0], [wide, deep]], 12.0);
        // Between passes the bottom keeps a little more than under them.
        let mut job = job(groove, Tool::ball(3.0), 0.5);
        job.boundary = Boundary::On;
        let plan = planned(&job);
        let (rest, left) = (plan.report.rest_max_mm.unwrap(), 3.0 / half.sin() - 3.0);
        assert!(rest >= left && rest <= 1.05 * left, "{angle}: {rest} {left}");
        let at = plan.report.rest_at.unwrap();
        assert!(at.z < 0.1 * deep, "{angle}: {at}");
        assert!(plan.warnings.iter().any(|warning| matches!(warning, Warning::RestLeft { .. })));
    }
}

#[test]
fn what_is_left_in_a_slot_is_the_distance_of_its_corners_from_the_ball() {
    let (wide, deep, radius) = (4.0, 5.0, 3.0f64);
    let slot =
        [[0.0, 0.0], [10.0, 0.0], [10.0, -deep], [10.0 + wide, -deep], [10.0 + wide, 0.0], [24.0, 0.0]];
    let report = report(&job(swept(&slot, 10.0), Tool::ball(radius), 1.0));
    let above = (radius * radius - 0.25 * wide * wide).sqrt();
    let left = f64::hypot(0.5 * wide, deep + above) - radius;
    let rest = report.rest_max_mm.unwrap();
    assert!(rest >= left && rest <= 1.05 * left, "{rest} {left}");
}

/// What passes along a V groove leave at points of a flank, as [distance from the path, distance from the
/// ball where it comes nearest at all]. The flanks have the slope `slope`, and the centres of the ball over
/// the passes are `centers`, in (x, z).
fn beside_the_bottom(slope: f64, radius: f64, centers: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let lowest = |x: f64| slope * f64::abs(x) + radius * f64::hypot(1.0, slope);
    let everywhere: Vec<[f64; 2]> =
        (0..4000).map(|k| f64::from(k - 2000) * 0.005).map(|x| [x, lowest(x)]).collect();
    let distance = |x: f64, centers: &[[f64; 2]]| {
        let each = centers.iter().map(|c| f64::hypot(x - c[0], slope * x - c[1]) - radius);
        each.fold(f64::INFINITY, f64::min).max(0.0)
    };
    (0..800).map(|k| f64::from(k) * 0.005).map(|x| [distance(x, centers), distance(x, &everywhere)]).collect()
}

#[test]
fn scallops_end_where_the_rest_begins() {
    let slope = 0.63;
    let groove = swept(&[[-9.8, 9.8 * slope], [0.0, 0.0], [9.8, 9.8 * slope]], 20.0);
    for stepover in [0.45, 0.8, 1.3, 1.687, 1.9] {
        let mut job = job(groove.clone(), Tool::ball(3.0), stepover);
        (job.boundary, job.plane) = (Boundary::On, SectionPlane::Yz);
        let plan = planned(&job);
        let mut centers: Vec<[f64; 2]> = Vec::new();
        for step in plan.toolpath.moves() {
            if let Move::Feed { along, role: Role::Cut, .. } = step {
                centers.push([along.start().x, along.start().z + 3.0]);
            }
        }
        let left = beside_the_bottom(slope, 3.0, &centers);
        let most = |is: &dyn Fn(&[f64; 2]) -> bool| {
            left.iter().filter(|l| is(l)).map(|[left, _]| *left).fold(0.0, f64::max)
        };
        let [certain, perhaps] = [most(&|l| l[1] <= 1e-6), most(&|l| l[1] <= 0.12 * l[0] + 1e-4)];
        let stated = plan.report.scallop_max_mm.unwrap();
        assert!(
            stated >= 0.99 * certain && stated <= 1.1 * perhaps + 1e-3,
            "{stepover}: {stated} {certain} {perhaps}"
        );
        let rest = plan.report.rest_max_mm.unwrap();
        assert!(rest.max(stated) >= most(&|_| true), "{stepover}: {rest}");
    }
}

#[test]
fn a_flat_end_leaves_nothing_on_a_plane_that_it_touches_everywhere() {
    for slope in [[0.0, 0.0], [0.0, 0.5], [0.3, 0.6]] {
        let plane = graph(3, 30.0, |x, y| slope[0] * x + slope[1] * y);
        for plane_of in [SectionPlane::Zx, SectionPlane::Yz] {
            let mut job = job(plane.clone(), tool(Shape::Flat, 6.0), 0.9);
            job.plane = plane_of;
            let report = report(&job);
            assert_eq!(report.rest_max_mm, Some(0.0), "{slope:?} {plane_of:?} {report:?}");
        }
    }
}

#[test]
fn a_scallop_height_with_an_allowance_is_met_by_the_cutter_itself() {
    let mut job = job(graph(2, 30.0, |_, _| 0.0), Tool::ball(3.0), 1.0);
    job.allowance_mm = 3.0;
    job.spacing = Spacing::ScallopHeight(0.02);
    let report = report(&job);
    assert!(report.stepover_mm <= 0.6917 && report.stepover_mm > 0.62, "{report:?}");
    let left = f64::hypot(3.0, 0.5 * report.stepover_mm) - 3.0;
    let stated = report.scallop_max_mm.unwrap();
    assert!(stated >= left && stated <= 0.02, "{stated} {left}");
}

#[test]
fn a_scallop_height_is_met_on_a_wave_or_refused() {
    let wave = graph(5, 20.0, |x, y| 2.0 * (PI * x / 10.0).sin() * (PI * y / 10.0).cos());
    for height in [0.05, 0.02] {
        let mut job = job(wave.clone(), Tool::ball(2.0), 1.0);
        job.spacing = Spacing::ScallopHeight(height);
        match plan(&job, &Budget::unlimited()) {
            Ok(plan) => {
                assert!(plan.report.scallop_max_mm.unwrap() <= height);
                let dense = measured(&plan, &job.tool.cutter(), 20.0, &job.surface);
                assert!(dense <= height + 1e-3, "{dense} {height}");
            }
            Err(Error::ScallopNotReached { least_mm, .. }) => assert!(least_mm > height),
            Err(error) => panic!("{error}"),
        }
    }
}

#[test]
fn what_is_stated_is_what_a_dense_check_finds_and_little_more() {
    let wave = graph(5, 20.0, |x, y| (PI * x / 20.0).sin() * (PI * y / 20.0).cos());
    for (shape, radius) in
        [(Shape::Ball, 2.0), (Shape::Flat, 1.0), (Shape::BullNose { corner_radius_mm: 0.5 }, 1.5)]
    {
        for plane_of in [SectionPlane::Zx, SectionPlane::Yz] {
            let mut job = job(wave.clone(), tool(shape, radius), 0.7);
            (job.plane, job.boundary) = (plane_of, Boundary::On);
            let plan = planned(&job);
            let dense = measured(&plan, &job.tool.cutter(), 20.0, &job.surface);
            let stated = plan.report.scallop_max_mm.unwrap().max(plan.report.rest_max_mm.unwrap());
            let ratio = stated / dense;
            let most = if shape == Shape::Ball { 1.25 } else { 1.3 };
            assert!(ratio > 0.999 && ratio < most, "{shape:?} {plane_of:?}: {stated} {dense}");
        }
    }
}

#[test]
fn inside_the_outline_rest_stays_along_it() {
    let mut job = job(graph(2, 30.0, |_, _| 0.0), Tool::ball(3.0), 1.0);
    job.boundary = Boundary::Inside;
    let rest = report(&job).rest_max_mm.unwrap();
    // The corner of the outline is farthest from the last centre.
    let left = 27f64.sqrt() - 3.0;
    assert!(rest >= left && rest <= 1.05 * left, "{rest} {left}");
}

#[test]
fn past_the_outline_only_the_part_counts() {
    let mut job = job(graph(2, 30.0, |_, _| 0.0), Tool::ball(3.0), 1.0);
    job.boundary = Boundary::Past;
    let report = report(&job);
    let left = f64::hypot(3.0, 0.5 * report.stepover_mm) - 3.0;
    assert_eq!(report.rest_max_mm, Some(0.0));
    let stated = report.scallop_max_mm.unwrap();
    assert!(stated >= left && stated <= 1.15 * left, "{stated} {left}");
}

fn left(bound_mm: f64) -> Leftover {
    Leftover { bound_mm, at: None, found_mm: bound_mm, found_at: None }
}

fn trials() -> Stepovers {
    Stepovers { asked: Some(0.01), next: 1.0, tried: Vec::new() }
}

#[test]
fn the_stepover_narrows_until_the_height_is_met() {
    // What is left grows with the power 1.2 of the stepover.
    let mut trials = trials();
    for _ in 0..TRIALS {
        let stepover = trials.next();
        if trials.is_met(stepover, &left(0.04 * stepover.powf(1.2))).unwrap() {
            assert!(stepover > 0.25, "{stepover}");
            return;
        }
    }
    panic!("not met after {:?}", trials.tried);
}

#[test]
fn a_height_that_no_stepover_changes_is_refused_with_the_least() {
    let mut trials = trials();
    assert_eq!(trials.is_met(1.0, &left(0.19)), Ok(false));
    let refused = trials.is_met(trials.next(), &left(0.18));
    assert_eq!(refused, Err(Error::ScallopNotReached { asked_mm: 0.01, least_mm: 0.18, at: None }));
}
