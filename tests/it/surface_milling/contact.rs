//! Compares the paths of the engine `Contact` with dense points of the surfaces. Every cutter mills surfaces
//! that the engine `OffsetSection` refuses.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use nalgebra::Point3;
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::surface::nurbs::Nurbs;
use toolpathd_core::geometry::surface::point_grid::Ends;
use toolpathd_core::geometry::surface::source::Source;
use toolpathd_core::operations::surface_milling::{
    Boundary, Engine, Error, Job, Plan, SectionPlane, Spacing, plan,
};
use toolpathd_core::toolpath::tool::{Shape, Tool};

use super::jobs::{PLANES, die, freeform, grid_of, heights, job};
use super::motion::{Kind, Motion, planned, written};
use super::spline::Spline;

/// Distance of the dense points of a surface, mm.
const POINTS_MM: f64 = 0.05;

/// Distance of the checked places along a path, mm.
const PATH_MM: f64 = 0.1;

/// A ball, a flat and a bull nose cutter of one radius.
fn cutters(radius_mm: f64) -> [Tool; 3] {
    let corner_radius_mm = 0.3 * radius_mm;
    [Shape::Ball, Shape::Flat, Shape::BullNose { corner_radius_mm }]
        .map(|shape| Tool { shape, ..Tool::ball(radius_mm) })
}

/// How deep a point lies inside a cutter with its shank, mm; negative outside. The point is given by its
/// distance `r` from the axis and its height `z` above the tip.
pub fn depth(tool: &Tool, r: f64, z: f64) -> f64 {
    let corner = match tool.shape {
        Shape::Ball => tool.radius_mm,
        Shape::Flat => 0.0,
        Shape::BullNose { corner_radius_mm } => corner_radius_mm,
        _ => unreachable!("mills are balls, flat ends and bull noses"),
    };
    let flat = tool.radius_mm - corner;
    let side = tool.radius_mm - r;
    if z >= corner {
        if r <= flat { side.min(z) } else { side }
    } else if r <= flat {
        z
    } else {
        corner - (r - flat).hypot(corner - z)
    }
}

/// Points of a surface in a binary tree of parts, with a ball about the points of each part.
struct Dense {
    points: Vec<Point3<f64>>,
    /// Part 0 is the whole. The halves of part k are the parts 2 k + 1 and 2 k + 2.
    parts: Vec<Part>,
}

#[derive(Clone, Copy)]
struct Part {
    from: usize,
    to: usize,
    center: Point3<f64>,
    radius: f64,
}

/// Least number of points in a part that is not halved.
const FEW_POINTS: usize = 8;

impl Dense {
    /// Dense points of a graph over a square.
    fn of([from, to]: [f64; 2], height: impl Fn(f64, f64) -> f64) -> Self {
        let n = ((to - from) / POINTS_MM).ceil() as usize;
        let node = |k: usize| from + (to - from) * k as f64 / n as f64;
        let point = |i: usize, j: usize| Point3::new(node(i), node(j), height(node(i), node(j)));
        Self::of_points(
            (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j))).map(|(i, j)| point(i, j)).collect(),
        )
    }

    fn of_points(points: Vec<Point3<f64>>) -> Self {
        let depth = (points.len() / FEW_POINTS).max(1).ilog2();
        let none = Part { from: 0, to: 0, center: Point3::origin(), radius: 0.0 };
        let mut dense = Self { parts: vec![none; (2 << depth) - 1], points };
        dense.divide(0, [0, dense.points.len()]);
        dense
    }

    fn divide(&mut self, part: usize, [from, to]: [usize; 2]) {
        let points = &mut self.points[from..to];
        let bound = |k: usize, pick: fn(f64, f64) -> f64| points.iter().map(|p| p[k]).reduce(pick).unwrap();
        let [low, high] = [f64::min as fn(f64, f64) -> f64, f64::max]
            .map(|pick| Point3::from([0, 1, 2].map(|k| bound(k, pick))));
        let center = nalgebra::center(&low, &high);
        let radius = points.iter().map(|p| (p - center).norm()).fold(0.0, f64::max);
        self.parts[part] = Part { from, to, center, radius };
        if 2 * part + 2 < self.parts.len() {
            let axis = (high - low).imax();
            let half = points.len() / 2;
            points.select_nth_unstable_by(half, |p, q| p[axis].total_cmp(&q[axis]));
            self.divide(2 * part + 1, [from, from + half]);
            self.divide(2 * part + 2, [from + half, to]);
        }
    }

    /// The depth of the deepest point inside a cutter whose tip is at `tip`, mm; negative if all are outside.
    fn deepest(&self, tool: &Tool, tip: Point3<f64>) -> f64 {
        let depth_of = |p: &Point3<f64>| depth(tool, (p - tip).xy().norm(), p.z - tip.z);
        // Two points differ in depth by at most their distance. So no point of a part is deeper than the
        // centre of its ball plus the radius.
        let bound = |part: usize| (depth_of(&self.parts[part].center) + self.parts[part].radius, part);
        let (mut deepest, mut open) = (f64::NEG_INFINITY, vec![bound(0)]);
        while let Some((most, part)) = open.pop() {
            if most <= deepest {
                continue;
            }
            if 2 * part + 2 < self.parts.len() {
                let [a, b] = [bound(2 * part + 1), bound(2 * part + 2)];
                open.extend(if a.0 < b.0 { [a, b] } else { [b, a] });
            } else {
                let Part { from, to, .. } = self.parts[part];
                deepest = self.points[from..to].iter().map(depth_of).fold(deepest, f64::max);
            }
        }
        deepest
    }
}

/// Plans a job and checks its path against dense points of the surface. Fails if a move is deeper than the
/// stated gouge, or if a cut leaves the surface.
fn follow(job: &Job, dense: &Dense) -> Plan {
    let plan = plan(job, &Budget::unlimited()).unwrap();
    let report = &plan.report;
    assert!(report.deviation_max_mm <= job.tolerance.mm() && report.gouge_max_mm <= job.tolerance.mm());
    let computed = planned(&plan).into_iter().flatten();
    let written = written(job, &plan);
    let written =
        written.iter().flat_map(|(kind, motion)| motion.extremes().into_iter().map(|motion| (*kind, motion)));
    for (kind, motion) in computed.chain(written) {
        let steps = (motion.length() / PATH_MM).ceil().max(1.0);
        for k in 0..=steps as usize {
            let tip = motion.at(k as f64 / steps);
            let deepest = dense.deepest(&job.tool, tip);
            assert!(
                deepest <= report.gouge_max_mm + 1e-6,
                "{:?}: the {kind:?} is {deepest} mm deep at {tip}",
                job.tool
            );
            let touches = kind != Kind::Cut || deepest >= -(report.deviation_max_mm + POINTS_MM);
            assert!(
                touches,
                "{:?}: the cut at {tip} does not touch the surface, its depth is {deepest} mm",
                job.tool
            );
        }
    }
    plan
}

#[test]
fn contact_cuts_a_trough_too_tight_for_the_cutter_without_a_gouge() {
    let trough = |x: f64, _: f64| 0.4 * x * x;
    let surface = heights(9, [-4.0, 4.0], Ends::NotAKnot, trough);
    let dense = Dense::of([-4.0, 4.0], trough);
    for plane in PLANES {
        for tool in cutters(2.5) {
            let job = Job { plane, tool, ..job(surface.clone(), 5.0, 1.0, 0.01, 3) };
            let refused = plan(&Job { engine: Engine::OffsetSection, ..job.clone() }, &Budget::unlimited());
            match tool.shape {
                Shape::Ball => assert!(
                    matches!(refused, Err(Error::OffsetFolds { .. })),
                    "not refused as folded: {refused:?}"
                ),
                _ => assert_eq!(refused, Err(Error::NoBall)),
            }
            let plan = follow(&job, &dense);
            // In the middle of the trough the cutter rests on both sides: the tip of a ball is at 0.625 and
            // that of a flat cutter at 2.5. Planes of constant x need not go through the middle.
            let lowest = planned(&plan)
                .into_iter()
                .flatten()
                .filter(|(kind, _)| *kind == Kind::Cut && plane == SectionPlane::Zx)
                .flat_map(|(_, motion)| (0..=100).map(move |k| motion.at(f64::from(k) / 100.0)))
                .filter(|tip| tip.y.abs() < 3.5)
                .map(|tip| tip.z)
                .reduce(f64::min);
            let rest = plan.report.rest_max_mm.unwrap();
            let (lowest_range, rest_range) = match tool.shape {
                Shape::Ball => (0.614..0.636, 0.5..1.0),
                Shape::Flat => (2.489..2.511, 2.0..3.7),
                Shape::BullNose { .. } => (0.7..2.489, 0.5..3.0),
                _ => unreachable!("mills are balls, flat ends and bull noses"),
            };
            assert!(rest_range.contains(&rest), "{tool:?}: {rest} mm are left");
            assert!(
                lowest.is_none_or(|lowest| lowest_range.contains(&lowest)),
                "{tool:?}: the lowest tip is at {lowest:?}"
            );
        }
    }
}

#[test]
fn contact_cuts_a_roof_across_its_sharp_edge_without_a_gouge() {
    let row = |x: f64, z: f64| [0.0, 12.0].map(|y| Point3::new(x, y, z)).to_vec();
    let roof = Source::Nurbs(Nurbs {
        degree: [1, 1],
        knots: [vec![0.0, 0.0, 1.0, 2.0, 2.0], vec![0.0, 0.0, 1.0, 1.0]],
        control_points: vec![row(0.0, 0.0), row(6.0, 4.0), row(12.0, 0.0)],
        weights: None,
    });
    let dense = Dense::of([0.0, 12.0], |x, _| 4.0 - 4.0 * (x - 6.0).abs() / 6.0);
    for plane in PLANES {
        for tool in cutters(1.5) {
            let grid = heights(3, [0.0, 12.0], Ends::Natural, |_, _| 0.0);
            let job = Job { plane, tool, surface: roof.clone(), ..job(grid, 3.0, 1.1, 0.01, 3) };
            follow(&job, &dense);
        }
    }
}

/// The lowest and the highest z of the tip over all cuts, mm.
fn heights_of_cuts(plan: &Plan) -> [f64; 2] {
    let cuts = planned(plan).into_iter().flatten().filter(|(kind, _)| *kind == Kind::Cut);
    let tips = cuts.flat_map(|(_, motion)| (0..=100).map(move |k| motion.at(f64::from(k) / 100.0).z));
    tips.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], z| [low.min(z), high.max(z)])
}

#[test]
fn contact_cuts_the_uppermost_sheet_of_walls_and_overhangs() {
    let wall = [[0.0, 0.0], [4.0, 0.0], [4.0, 5.0], [9.0, 5.0]];
    let overhang = [[0.0, 0.0], [7.0, 0.0], [4.0, 5.0], [9.0, 5.0]];
    for profile in [wall, overhang] {
        let sheet = Source::Nurbs(Nurbs {
            degree: [1, 1],
            knots: [vec![0.0, 0.0, 1.0, 2.0, 3.0, 3.0], vec![0.0, 0.0, 1.0, 1.0]],
            control_points: profile.map(|[x, z]| [0.0, 9.0].map(|y| Point3::new(x, y, z)).to_vec()).to_vec(),
            weights: None,
        });
        let steps = (9.0 / POINTS_MM) as usize;
        let along = |k: usize| k as f64 / steps as f64;
        let places = (0..3).flat_map(|piece| (0..=steps).map(move |k| (piece, k)));
        let places = places.map(|(piece, k)| {
            let ([x, z], [to_x, to_z]) = (profile[piece], profile[piece + 1]);
            (x + (to_x - x) * along(k), z + (to_z - z) * along(k))
        });
        let points = places.flat_map(|(x, z)| (0..=steps).map(move |j| Point3::new(x, 9.0 * along(j), z)));
        let dense = Dense::of_points(points.collect());
        for plane in PLANES {
            for tool in cutters(1.5) {
                let grid = heights(3, [0.0, 9.0], Ends::Natural, |_, _| 0.0);
                let job = Job { plane, tool, surface: sheet.clone(), ..job(grid, 3.0, 1.1, 0.01, 3) };
                let [low, high] = heights_of_cuts(&follow(&job, &dense));
                assert!(
                    low.abs() < 0.011 && (high - 5.0).abs() < 0.011,
                    "{tool:?}: the tips are from {low} to {high}"
                );
            }
        }
    }
}

#[test]
fn contact_cuts_a_half_sphere_down_to_its_vertical_rim() {
    let radius = 3.2;
    let circle = [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [-1.0, 1.0], [-1.0, 0.0]];
    let circle = [circle, circle.map(|p| p.map(|x| -x))].concat();
    let circle: Vec<[f64; 2]> =
        circle.into_iter().enumerate().filter(|(k, _)| *k != 5).map(|(_, p)| p).collect();
    let rise = [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let weight = |k: usize| if k % 2 == 1 { FRAC_1_SQRT_2 } else { 1.0 };
    let point = |[x, y]: [f64; 2], [out, up]: [f64; 2]| Point3::new(x * out, y * out, up) * radius;
    let dome = Source::Nurbs(Nurbs {
        degree: [2, 2],
        knots: [
            vec![0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 4.0, 4.0, 4.0],
            vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0],
        ],
        control_points: circle.iter().map(|p| rise.map(|q| point(*p, q)).to_vec()).collect(),
        weights: Some((0..9).map(|i| (0..3).map(|j| weight(i) * weight(j)).collect()).collect()),
    });
    let steps = (PI * radius / POINTS_MM) as usize;
    let angle = |k: usize| PI * k as f64 / steps as f64;
    let points = (0..=steps).flat_map(|i| {
        (0..=2 * steps).map(move |j| {
            let (out, up) = ((0.5 * angle(i)).cos(), (0.5 * angle(i)).sin());
            point([angle(j).cos(), angle(j).sin()], [out, up])
        })
    });
    let dense = Dense::of_points(points.collect());
    for radius_mm in [1.5, 12.5] {
        for tool in cutters(radius_mm) {
            let grid = heights(3, [0.0, 9.0], Ends::Natural, |_, _| 0.0);
            let job = Job { tool, surface: dome.clone(), ..job(grid, 3.0, 2.3, 0.01, 3) };
            let plan = follow(&job, &dense);
            let [low, high] = heights_of_cuts(&plan);
            // A small cutter cuts each plane in one pass.
            assert!(
                radius_mm > radius || plan.report.n_passes == 6,
                "{tool:?}: {} passes, not 6",
                plan.report.n_passes
            );
            let lowest = match tool.shape {
                Shape::Ball => -radius_mm,
                Shape::Flat => 0.0,
                Shape::BullNose { corner_radius_mm } => -corner_radius_mm,
                _ => unreachable!("mills are balls, flat ends and bull noses"),
            };
            assert!(
                (lowest - 0.011..lowest + 0.2).contains(&low) && high < radius + 0.011,
                "{tool:?}: the tips are from {low} to {high}"
            );
        }
    }
}

#[test]
fn contact_cuts_bumps_and_the_die_with_every_cutter_without_a_gouge() {
    for plane in PLANES {
        let bumps = freeform(plane, Default::default());
        let spline = Spline::through(grid_of(&bumps));
        // The grid is even, so that the parameters are proportional to x and y.
        let dense = Dense::of([0.0, 12.0], |x, y| spline.jet([x / 3.0, y / 3.0]).point.z);
        for boundary in [Boundary::Inside, Boundary::On] {
            for tool in cutters(1.0) {
                follow(&Job { tool, boundary, ..bumps.clone() }, &dense);
            }
        }
    }
    let die = die(PLANES[0], Default::default());
    let spline = Spline::through(grid_of(&die));
    let dense = Dense::of([0.0, 80.0], |x, y| spline.jet([x / 10.0, y / 10.0]).point.z);
    for tool in &cutters(5.0)[1..] {
        let spacing = Spacing::Stepover(16.0);
        follow(&Job { tool: *tool, spacing, ..die.clone() }, &dense);
    }
}

#[test]
fn a_cutter_larger_than_the_part_rests_on_the_top_of_the_part() {
    let hill = |x: f64, y: f64| -0.05 * (x * x + y * y);
    let surface = heights(5, [-4.0, 4.0], Ends::NotAKnot, hill);
    let dense = Dense::of([-4.0, 4.0], hill);
    for tool in cutters(40.0) {
        let plan = follow(&Job { tool, ..job(surface.clone(), 80.0, 9.0, 0.01, 3) }, &dense);
        let highest = planned(&plan).into_iter().flatten().filter(|(kind, _)| *kind == Kind::Cut);
        let highest =
            highest.map(|(_, motion): (_, Motion)| motion.at(0.5).z).fold(f64::NEG_INFINITY, f64::max);
        assert!(highest <= 0.011, "the tip rises to {highest} above the top of the part");
    }
}
