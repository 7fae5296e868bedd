//! Compares paths over cylinders, spheres and roofs, given as NURBS, with closed forms.

use nalgebra::Point3;
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::surface::nurbs::Nurbs;
use toolpathd_core::geometry::surface::source::Source;
use toolpathd_core::operations::surface_milling::{
    Boundary, Engine, Error, Job, SectionPlane, Spacing, plan,
};
use toolpathd_core::toolpath::tool::Tool;
use toolpathd_core::toolpath::units::{FeedRate, Tolerance};

use super::motion::{Kind, Motion, planned};

const RADIUS: f64 = 40.0;
const BALL: f64 = 5.0;

fn job(surface: Source, plane: SectionPlane, stepover_mm: f64) -> Job {
    let tolerance = Tolerance::from_mm(0.01).unwrap();
    let feed = FeedRate::from_mm_per_min(1000.0).unwrap();
    Job { plane, ..Job::new(surface, Tool::ball(BALL), stepover_mm, tolerance, feed) }
}

/// Control points and weights of the unit circle's arcs from angle to angle (rad). Each arc is a quarter or
/// less. `n` arcs have 2 n + 1 control points.
fn arcs(angles: &[f64]) -> Vec<[f64; 3]> {
    let mut points = vec![[angles[0].cos(), angles[0].sin(), 1.0]];
    for pair in angles.windows(2) {
        let (half, middle) = (0.5 * (pair[1] - pair[0]), 0.5 * (pair[0] + pair[1]));
        let reach = 1.0 / half.cos();
        points.push([reach * middle.cos(), reach * middle.sin(), half.cos()]);
        points.push([pair[1].cos(), pair[1].sin(), 1.0]);
    }
    points
}

fn arc_knots(arcs: usize) -> Vec<f64> {
    let inner = (1..arcs).flat_map(|k| [k as f64; 2]);
    let ends = [arcs as f64; 3];
    [0.0; 3].into_iter().chain(inner).chain(ends).collect()
}

/// A part of a cylinder about the y axis, 30 mm long, in two pieces. It reaches from 60 degrees left of the
/// top to 50 degrees right of it.
fn cylinder() -> Source {
    let at = |degrees: f64| (90.0 - degrees).to_radians();
    let profile = arcs(&[at(-60.0), at(10.0), at(50.0)]);
    let row = |[x, z, _]: [f64; 3]| [0.0, 30.0].map(|y| Point3::new(RADIUS * x, y, RADIUS * z)).to_vec();
    Source::Nurbs(Nurbs {
        degree: [2, 1],
        knots: [arc_knots(2), vec![0.0, 0.0, 1.0, 1.0]],
        weights: Some(profile.iter().map(|p| vec![p[2]; 2]).collect()),
        control_points: profile.into_iter().map(row).collect(),
    })
}

/// A surface of revolution about z: a profile turned through angles (rad).
fn turned(profile: &[[f64; 3]], angles: &[f64]) -> Source {
    let around = arcs(angles);
    let row = |p: &[f64; 3]| around.iter().map(|a| Point3::new(a[0] * p[0], a[1] * p[0], p[1])).collect();
    let weights = |p: &[f64; 3]| around.iter().map(|a| a[2] * p[2]).collect();
    Source::Nurbs(Nurbs {
        degree: [2, 2],
        knots: [arc_knots(profile.len() / 2), arc_knots(angles.len() - 1)],
        control_points: profile.iter().map(row).collect(),
        weights: Some(profile.iter().map(weights).collect()),
    })
}

/// A zone of a sphere about the origin, between two angles above the horizon.
fn sphere(from_degrees: f64, to_degrees: f64) -> Source {
    let profile = arcs(&[from_degrees.to_radians(), to_degrees.to_radians()]);
    let profile: Vec<_> = profile.into_iter().map(|[x, z, w]| [RADIUS * x, RADIUS * z, w]).collect();
    turned(&profile, &[0.0, 60f64.to_radians(), 90f64.to_radians()])
}

#[test]
fn passes_across_a_cylinder_are_arcs_and_passes_along_it_are_lines() {
    let across = plan(&job(cylinder(), SectionPlane::Zx, 4.0), &Budget::unlimited()).unwrap();
    let passes = planned(&across);
    assert_eq!(passes.len(), 9);
    for pass in passes {
        let cuts: Vec<_> = pass.into_iter().filter(|m| m.0 == Kind::Cut).map(|m| m.1).collect();
        let [Motion::Turn(turn)] = cuts[..] else { panic!("not one arc: {cuts:?}") };
        assert!((turn.radii[0] - RADIUS - BALL).abs() < 1e-9, "{turn:?}");
        assert!(turn.center.x.abs() < 1e-9 && (turn.center.z + BALL).abs() < 1e-9, "{turn:?}");
    }
    assert!(
        across.report.deviation_max_mm < 0.002 && across.report.gouge_max_mm < 0.002,
        "{:?}",
        across.report
    );

    // The contact engine finds the ends of a section by bisection, and is less exact there.
    for (engine, straight_mm, end_mm) in [(Engine::OffsetSection, 1e-9, 1e-9), (Engine::Contact, 1e-8, 1e-6)]
    {
        let job = Job { engine, ..job(cylinder(), SectionPlane::Yz, 4.0) };
        let along = plan(&job, &Budget::unlimited()).unwrap();
        assert_eq!((along.report.n_arcs, along.report.n_lines), (0, along.report.n_passes));
        assert!(along.report.n_passes > 10);
        for (kind, motion) in planned(&along).into_iter().flatten() {
            if let (Kind::Cut, Motion::Straight { from, to }) = (kind, motion) {
                for p in [from, to] {
                    assert!(
                        (p.x.hypot(p.z + BALL) - RADIUS - BALL).abs() < 1e-9,
                        "{p} is not on the offset cylinder"
                    );
                }
                let way = to - from;
                assert!(
                    way.xz().norm() < straight_mm && (way.y.abs() - 30.0).abs() < end_mm,
                    "not straight or not from end to end: {from} to {to}"
                );
            }
        }
    }
}

#[test]
fn the_centre_of_the_ball_stays_on_the_offset_of_a_sphere() {
    for plane in [SectionPlane::Zx, SectionPlane::Yz] {
        let plan = plan(&job(sphere(30.0, 75.0), plane, 2.0), &Budget::unlimited()).unwrap();
        let mut cuts = 0;
        for (_, motion) in planned(&plan).into_iter().flatten().filter(|(kind, _)| *kind == Kind::Cut) {
            for k in 0..=8 {
                let p = motion.at(f64::from(k) / 8.0);
                let off = (p + nalgebra::Vector3::new(0.0, 0.0, BALL)).coords.norm() - RADIUS - BALL;
                assert!(
                    off.abs() <= plan.report.deviation_max_mm,
                    "the ball at {p} is {off} mm off the offset sphere"
                );
            }
            cuts += 1;
        }
        assert!(cuts >= 15, "only {cuts} cuts");
        assert!(plan.report.gouge_max_mm <= 0.01);
    }
}

#[test]
fn offset_section_refuses_a_sphere_up_to_its_pole_or_down_to_its_horizon() {
    for octant in [sphere(0.0, 90.0), sphere(30.0, 90.0), sphere(0.0, 60.0)] {
        for boundary in [Boundary::On, Boundary::Past] {
            let engine = Engine::OffsetSection;
            let job = Job { boundary, engine, ..job(octant.clone(), SectionPlane::Zx, 2.0) };
            let error = plan(&job, &Budget::unlimited()).unwrap_err();
            assert!(
                matches!(error, Error::Overhang { .. } | Error::NoWayPast),
                "refused for another reason: {error}"
            );
        }
    }
}

#[test]
fn cuts_leave_the_allowance_on_the_surface() {
    let job = Job { allowance_mm: 0.3, ..job(cylinder(), SectionPlane::Zx, 4.0) };
    let plan = plan(&job, &Budget::unlimited()).unwrap();
    assert_eq!((plan.report.gouge_max_mm, plan.report.n_arcs), (0.0, 9));
    for (_, motion) in planned(&plan).into_iter().flatten().filter(|(kind, _)| *kind == Kind::Cut) {
        let Motion::Turn(turn) = motion else { panic!("{motion:?}") };
        assert!((turn.radii[0] - RADIUS - BALL - 0.3).abs() < 1e-9, "{turn:?}");
        assert!((turn.center.z + BALL).abs() < 1e-9, "{turn:?}");
    }
}

#[test]
fn the_planes_are_as_far_apart_as_the_scallop_height_allows() {
    // Planes of constant x cut the cylinder obliquely. It slopes by up to 60 degrees, where they must be half
    // as far apart.
    for (plane, share) in [(SectionPlane::Zx, 1.0), (SectionPlane::Yz, 0.5)] {
        let height = 0.01;
        let job = Job { spacing: Spacing::ScallopHeight(height), ..job(cylinder(), plane, 1.0) };
        let report = plan(&job, &Budget::unlimited()).unwrap().report;
        let left = report.scallop_max_mm.unwrap();
        assert!(left <= height && left > 0.8 * height, "a scallop of {left} mm for {height} mm: {report:?}");
        // Passes this far apart leave scallops of this height on a plane.
        let apart = 2.0 * (2.0 * BALL * height - height * height).sqrt() * share;
        assert!(
            report.stepover_mm <= apart && report.stepover_mm > 0.85 * apart,
            "the stepover should be about {apart} mm: {report:?}"
        );
    }
}

#[test]
fn cuts_end_at_the_edge_inside_it_or_past_it_as_the_boundary_says() {
    let extent = |boundary: Boundary, plane: SectionPlane| {
        let job = Job { boundary, ..job(cylinder(), plane, 4.0) };
        let plan = plan(&job, &Budget::unlimited()).unwrap();
        let cuts = planned(&plan).into_iter().flatten().filter(|(kind, _)| *kind == Kind::Cut);
        let ends: Vec<_> = cuts.flat_map(|(_, motion)| [motion.at(0.0), motion.at(1.0)]).collect();
        let range = |c: usize| {
            let values = || ends.iter().map(|p| p[c]);
            [values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max)]
        };
        [range(0), range(1)]
    };
    let (left, right) = (-RADIUS * 60f64.to_radians().sin(), RADIUS * 50f64.to_radians().sin());
    for plane in [SectionPlane::Zx, SectionPlane::Yz] {
        let [x, y] = extent(Boundary::On, plane);
        let offset = (RADIUS + BALL) / RADIUS;
        assert!((x[0] - left * offset).abs() < 1e-2 && (x[1] - right * offset).abs() < 1e-2, "{x:?}");
        assert!(y[0].abs() < 1e-2 && (y[1] - 30.0).abs() < 1e-2, "{y:?}");
        let [x, y] = extent(Boundary::Inside, plane);
        assert!((x[0] - left - BALL).abs() < 2e-2 && (x[1] - right + BALL).abs() < 2e-2, "{x:?}");
        assert!((y[0] - BALL).abs() < 2e-2 && (y[1] - 30.0 + BALL).abs() < 2e-2, "{y:?}");
        let [x, y] = extent(Boundary::Past, plane);
        // The path goes straight on along the tangents at 60 and 50 degrees.
        let (past_left, past_right) =
            (left * offset - 0.5 * BALL, right * offset + 50f64.to_radians().cos() * BALL);
        assert!(
            x[0] <= past_left && x[0] > past_left - BALL,
            "the path does not end past {past_left}: {x:?}"
        );
        assert!(
            x[1] >= past_right && x[1] < past_right + BALL,
            "the path does not end past {past_right}: {x:?}"
        );
        assert!(y[0] <= -BALL && y[1] >= 30.0 + BALL && y[1] < 30.0 + 2.0 * BALL, "{y:?}");
    }
}

#[test]
fn offset_section_refuses_a_sharp_edge_and_names_its_place() {
    let mut roof = vec![vec![]; 3];
    for (i, row) in roof.iter_mut().enumerate() {
        *row = [0.0, 20.0].map(|y| Point3::new(10.0 * i as f64, y, if i == 1 { 4.0 } else { 0.0 })).to_vec();
    }
    let roof = Source::Nurbs(Nurbs {
        degree: [1, 1],
        knots: [vec![0.0, 0.0, 1.0, 2.0, 2.0], vec![0.0, 0.0, 1.0, 1.0]],
        control_points: roof,
        weights: None,
    });
    let job = Job { engine: Engine::OffsetSection, ..job(roof, SectionPlane::Zx, 2.0) };
    let error = plan(&job, &Budget::unlimited()).unwrap_err();
    assert!(
        matches!(error, Error::NotSmooth(_)) && error.to_string().contains("10"),
        "the edge at x = 10 is not named: {error}"
    );
}
