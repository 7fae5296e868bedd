use super::*;
use crate::geometry::surface::point_grid::{Ends, Twist};
use crate::toolpath::program::Units;
use std::f64::consts::PI;

fn grid(nodes: &[f64], ends: Ends, height: impl Fn(f64, f64) -> f64) -> PointGrid {
    let points =
        nodes.iter().map(|&x| nodes.iter().map(|&y| Point3::new(x, y, height(x, y))).collect()).collect();
    PointGrid { points, twist: Twist::Spline, ends }
}

fn nodes(n: usize, from: f64, to: f64) -> Vec<f64> {
    (0..n).map(|i| from + (to - from) * i as f64 / (n - 1) as f64).collect()
}

fn job(surface: PointGrid, diameter: f64, stepover_mm: f64, tolerance: f64) -> Job {
    let feed = |f| FeedRate::from_mm_per_min(f).unwrap();
    Job {
        surface,
        tool: Tool { radius_mm: 0.5 * diameter, number: 1, length_offset: 1 },
        plane: SectionPlane::Zx,
        stepover_mm,
        direction: CutDirection::Zigzag,
        tolerance: Tolerance::from_mm(tolerance).unwrap(),
        interpolation: Interpolation::Arcs,
        step_length_mm: None,
        cutting: CuttingRequest {
            feed: feed(1000.0),
            plunge_feed: None,
            rapid_feed: feed(10_000.0),
            spindle_rpm: None,
            coolant: Coolant::Off,
            clearance_z_mm: None,
            retract_z_mm: None,
        },
        resolution: Resolution { units: Units::Mm, decimals: 4 },
    }
}

fn wave(x: f64, y: f64) -> f64 {
    10.0 * (PI * x / 40.0).sin() * (PI * y / 40.0).cos()
}

fn die() -> Job {
    let surface = grid(&nodes(9, 0.0, 80.0), Ends::NotAKnot, wave);
    let mut job = job(surface, 10.0, 2.0, 0.01);
    job.resolution.decimals = 3;
    job
}

#[test]
fn the_die_is_cut_within_its_tolerance_and_mostly_by_arcs() {
    for plane in [SectionPlane::Zx, SectionPlane::Yz] {
        let mut job = die();
        job.plane = plane;
        let plan = plan(&job, &Budget::unlimited()).unwrap();
        let report = &plan.report;
        assert!(report.deviation_max_mm <= 0.01 && report.gouge_max_mm <= 0.01);
        assert!(report.n_arcs * 10 >= (report.n_arcs + report.n_lines) * 6);
        assert!((plan.cutting.retract_z_mm - 12.0).abs() < 0.2);
    }
}

#[test]
fn sections_of_a_spherical_cap_are_single_arcs() {
    // Slopes to 60 degrees: the cap reaches 40 sin 60 = 34.6 mm from its axis; a square of half that diagonal.
    let half = 40.0 * (60f64.to_radians()).sin() / 2f64.sqrt();
    let surface = grid(&nodes(61, -half, half), Ends::NotAKnot, |x, y| (1600.0 - x * x - y * y).sqrt());
    for plane in [SectionPlane::Zx, SectionPlane::Yz] {
        let mut job = job(surface.clone(), 10.0, 2.0, 1e-3);
        job.plane = plane;
        let plan = plan(&job, &Budget::unlimited()).unwrap();
        let mut cuts = 0;
        for pass in plan.toolpath.passes() {
            let arcs: Vec<_> = pass
                .moves()
                .iter()
                .filter_map(|step| match step {
                    Move::Feed { along, role: crate::toolpath::Role::Cut, .. } => Some(*along),
                    _ => None,
                })
                .collect();
            let [Curve::Arc(arc)] = arcs[..] else { panic!("{} elements: {arcs:?}", arcs.len()) };
            let offset = arc.center()[plane.normal_axis()];
            let radius = (45.0f64 * 45.0 - offset * offset).sqrt();
            assert!((arc.radius() - radius).abs() < 1e-4, "{} {radius}", arc.radius());
            cuts += 1;
        }
        assert_eq!(cuts, plan.report.n_passes);
    }
}

#[test]
fn a_trough_tighter_than_the_cutter_is_refused_in_both_planes() {
    for plane in [SectionPlane::Zx, SectionPlane::Yz] {
        let surface = grid(&nodes(9, -4.0, 4.0), Ends::NotAKnot, |x, _| 0.4 * x * x);
        let mut job = job(surface, 5.0, 1.0, 0.01);
        job.plane = plane;
        match plan(&job, &Budget::unlimited()) {
            Err(Error::OffsetFolds { at }) => assert!(at.x.abs() < 1.0, "{at}"),
            other => panic!("{other:?}"),
        }
    }
}
