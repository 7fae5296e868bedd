use super::*;
use crate::geometry::surface::net_grid::NetGrid;
use crate::geometry::surface::point_grid::{Ends, PointGrid, Twist};
use crate::geometry::surface::source::Source;
use crate::operations::surface_milling::{Spacing, plan};
use crate::toolpath::Move;
use crate::toolpath::tool::{Shape, Tool};
use crate::toolpath::units::{FeedRate, Tolerance};

const RADIUS: f64 = 5.0;
const PITCH: f64 = 5.0;
const TOLERANCE: f64 = 0.01;

/// A plate from -20 to 20 mm each way.
fn plate(height: impl Fn(f64, f64) -> f64) -> Source {
    let at = |k: usize| 5.0 * k as f64 - 20.0;
    let row = |i: usize| (0..9).map(|j| Point3::new(at(i), at(j), height(at(i), at(j)))).collect();
    Source::PointGrid(PointGrid {
        points: (0..9).map(row).collect(),
        twist: Twist::Spline,
        ends: Ends::NotAKnot,
    })
}

fn job(surface: Source) -> Job {
    let (feed, tolerance) =
        (FeedRate::from_mm_per_min(800.0).unwrap(), Tolerance::from_mm(TOLERANCE).unwrap());
    let job = Job::new(surface, Tool::ball(RADIUS), PITCH, tolerance, feed);
    Job { spacing: Spacing::WirePitch(PITCH), ..job }
}

fn with_shape(job: Job, shape: Shape) -> Job {
    Job { tool: Tool { shape, ..job.tool }, ..job }
}

fn planned(job: &Job) -> Plan {
    plan(job, &Budget::unlimited()).unwrap()
}

fn shapes() -> [Shape; 3] {
    [Shape::Ball, Shape::Flat, Shape::BullNose { corner_radius_mm: 1.5 }]
}

/// Both ends of every cutting move. Fails if there are none.
fn tips(plan: &Plan) -> Vec<Point3<f64>> {
    let cuts = plan.toolpath.moves().filter_map(|step| match step {
        Move::Feed { along, role: Role::Cut, .. } => Some(along),
        _ => None,
    });
    let tips: Vec<_> = cuts.flat_map(|curve| [curve.start(), curve.end()]).collect();
    assert!(!tips.is_empty(), "no cuts");
    tips
}

fn is_warned(plan: &Plan) -> bool {
    plan.warnings.iter().any(|warning| matches!(warning, Warning::RoughingPathGouges { .. }))
}

#[test]
fn on_a_level_plate_the_tip_follows_the_wires() {
    for shape in shapes() {
        let plan = planned(&with_shape(job(plate(|_, _| 2.0)), shape));
        let report = &plan.report;
        assert_eq!((report.n_passes, report.n_lines, report.n_arcs, report.n_cl_points), (9, 9, 0, 18));
        assert_eq!(report.gouge_max_mm, 0.0);
        assert_eq!(report.scallop_max_mm, None);
        assert!((report.stepover_mm - PITCH).abs() < 1e-6 && report.deviation_max_mm <= TOLERANCE);
        assert!(!is_warned(&plan));
        assert!(
            tips(&plan).iter().all(|tip| (tip.z - 2.0).abs() < 1e-12 && (tip.x.abs() - 20.0).abs() < 1e-6)
        );
    }
}

#[test]
fn on_a_slope_along_the_wires_the_path_gouges_as_the_closed_form_says() {
    for slope in [0.2f64, 1.0] {
        for shape in shapes() {
            let plan = planned(&with_shape(job(plate(|x, _| slope * x)), shape));
            // The depth along the axis, times the cosine between axis and normal.
            let cos = 1.0 / slope.hypot(1.0);
            let depth = match shape {
                Shape::Ball => RADIUS * (1.0 / cos - 1.0),
                Shape::Flat => RADIUS * slope,
                Shape::BullNose { corner_radius_mm: c } => (RADIUS - c) * slope + c * (1.0 / cos - 1.0),
                _ => unreachable!("mills are balls, flat ends and bull noses"),
            } * cos;
            let found = plan.report.gouge_max_mm;
            assert!(found >= depth - 1e-9 && found <= depth + TOLERANCE, "{shape:?} {found} {depth}");
            assert!(is_warned(&plan) && plan.report.gouge_at.is_some());
            assert!(tips(&plan).iter().all(|tip| (tip.z - slope * tip.x).abs() < 1e-6));
        }
    }
    // 10 mm, 45 degrees: (sqrt 2 - 1) 5 / sqrt 2.
    let plan = planned(&job(plate(|x, _| x)));
    assert!((plan.report.gouge_max_mm - 1.4645).abs() < 1e-3, "{}", plan.report.gouge_max_mm);
}

#[test]
fn on_a_slope_across_the_wires_the_neighbour_lifts_the_path() {
    for shape in shapes() {
        let plan = planned(&with_shape(job(plate(|_, y| y)), shape));
        for tip in tips(&plan) {
            assert!((tip.z - (tip.y + PITCH).min(20.0)).abs() < 1e-5, "{tip}");
        }
        assert!(plan.report.gouge_max_mm <= 0.05 * TOLERANCE, "{shape:?} {}", plan.report.gouge_max_mm);
    }
}

#[test]
fn wires_within_the_radius_count_and_always_one_on_each_side() {
    for (radius, lift) in [(2.0, PITCH), (5.0, PITCH), (9.0, PITCH), (10.0, 2.0 * PITCH), (14.0, 2.0 * PITCH)]
    {
        let mut job = job(plate(|_, y| 0.5 * y));
        job.tool.radius_mm = radius;
        for tip in tips(&planned(&job)) {
            let expected = 0.5 * (tip.y + lift).min(20.0);
            assert!((tip.z - expected).abs() < 1e-5, "{radius} {tip}");
        }
    }
}

#[test]
fn stock_lifts_the_path_and_widens_the_union() {
    let stocked = Job { allowance_mm: 0.5, ..job(plate(|_, _| 1.0)) };
    assert!(tips(&planned(&stocked)).iter().all(|tip| (tip.z - 1.5).abs() < 1e-9));
    let mut wide = Job { allowance_mm: 5.0, ..job(plate(|_, y| y)) };
    wide.tool.radius_mm = 5.0;
    for tip in tips(&planned(&wide)) {
        assert!((tip.z - 5.0 - (tip.y + 10.0).min(20.0)).abs() < 1e-5, "{tip}");
    }
}

#[test]
fn a_curved_union_is_followed_within_the_tolerance() {
    let hill = |x: f64, y: f64| 0.02 * (x * x + y * y) - 0.001 * x * x * x;
    for (tolerance, step) in [(0.01, None), (0.1, Some(3.0))] {
        let mut job = job(plate(hill));
        job.tolerance = Tolerance::from_mm(tolerance).unwrap();
        job.step_length_mm = step;
        let plan = planned(&job);
        assert!(plan.report.deviation_max_mm <= tolerance);
        for pass in plan.toolpath.passes() {
            for step in pass.moves() {
                let Move::Feed { along, role: Role::Cut, .. } = step else { continue };
                assert!(job.step_length_mm.is_none_or(|longest| along.length() <= longest + 1e-9));
                for share in [0.0, 0.3, 0.5, 0.8] {
                    let tip = along.start() + (along.end() - along.start()) * share;
                    let beside = [-PITCH, 0.0, PITCH].map(|by| tip.y + by).into_iter();
                    let beside = beside.filter(|y| y.abs() <= 20.0 + 1e-6);
                    let union = beside.map(|y| hill(tip.x, y)).fold(f64::NEG_INFINITY, f64::max);
                    // Slopes stay below 2.
                    assert!((tip.z - union).abs() <= 2.3 * tolerance, "{tip} {union}");
                }
            }
        }
    }
}

#[test]
fn every_pass_is_cut_one_way_from_the_clearance_plane() {
    let plan = planned(&job(plate(|x, y| 0.1 * x + 0.2 * y)));
    let (clearance, retract) = (plan.cutting.clearance_z_mm, plan.cutting.retract_z_mm);
    assert_eq!(plan.toolpath.start().z, clearance);
    for (k, pass) in plan.toolpath.passes().iter().enumerate() {
        let mut heights = Vec::new();
        for step in pass.moves() {
            match step {
                Move::Rapid { line } => {
                    assert!(line.start.z >= retract || line.start.xy() == line.end.xy());
                    heights.push(line.end.z);
                }
                Move::Feed { along, role: Role::Plunge, .. } => assert_eq!(along.start().z, retract),
                Move::Feed { along, role: Role::Cut, .. } => assert!(along.end().x > along.start().x),
                other => panic!("{other:?}"),
            }
        }
        let way = if k == 0 { vec![retract] } else { vec![clearance, clearance, retract] };
        let last = k + 1 == plan.report.n_passes;
        let expected = [way, if last { vec![clearance] } else { vec![] }].concat();
        assert_eq!(heights, expected);
    }
}

#[test]
fn overhangs_and_steps_are_no_errors() {
    // A sheet that turns back over itself: x goes to 20 and back to 10 while z climbs to 12.
    let net = |a: usize, b: usize| {
        Point3::new([0.0, 30.0, 30.0, 5.0][a], 10.0 * b as f64, [0.0, 0.0, 12.0, 12.0][a])
    };
    let net = std::array::from_fn(|a| std::array::from_fn(|b| net(a, b)));
    let overhang = Source::NetGrid(NetGrid { nets: vec![vec![net]] });
    for shape in shapes() {
        let plan = planned(&with_shape(job(overhang.clone()), shape));
        assert!(plan.report.deviation_max_mm <= TOLERANCE);
        assert!(is_warned(&plan));
        // Seen from above the upper sheet hides the lower beyond its own edge at x = 5.
        assert!(tips(&plan).iter().any(|tip| (tip.x - 5.0).abs() < 1e-3 && (tip.z - 12.0).abs() < 0.02));
        assert!(tips(&plan).iter().all(|tip| tip.x < 5.0 + 1e-3 || tip.z > 6.0 - TOLERANCE));
    }
}
