//! Checks that the gouge proof refuses bad paths. Moves of good paths over blocks, steps, trays and ribs are
//! corrupted. Then the result of the proof is compared with the depths of dense points inside the cutter.
//!
//! Every part is a profile of straight lines, extruded along y, and the passes are planes of constant y. At
//! no other y does the cutter reach deeper into such a part than in the plane through its axis. So it is
//! enough to measure depths in that plane.

use nalgebra::{Point3, Vector3};
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::curve::{Arc, Curve, Direction, Line};
use toolpathd_core::geometry::surface::BezierSurface;
use toolpathd_core::geometry::surface::any_surface::AnySurface;
use toolpathd_core::geometry::surface::nurbs::Nurbs;
use toolpathd_core::geometry::surface::point_grid::Ends;
use toolpathd_core::geometry::surface::source::Source;
use toolpathd_core::machining::gouge::{GougeProof, Penetration};
use toolpathd_core::operations::surface_milling::{Job, plan};
use toolpathd_core::toolpath::Move;
use toolpathd_core::toolpath::tool::{Shape, Tool};

use super::contact::depth;
use super::jobs::{heights, job};
use crate::arc_fitting::inputs::Random;

/// Random parts, each cut by three cutters. The exploration on fresh seeds tries more.
const PARTS: usize = 24;

/// Every third move of a path is corrupted.
const MOVES_APART: usize = 3;

pub const RADIUS_MM: f64 = 4.0;
const STEPOVER_MM: f64 = 8.0;
const TOLERANCES_MM: [f64; 3] = [0.005, 0.02, 0.05];

/// Gap of the proof, as a share of the tolerance.
const GAP_SHARE: f64 = 0.02;

/// Half the length of the extruded parts, mm.
pub const HALF_LENGTH_MM: f64 = 12.0;

/// Distance of the dense points along a profile, mm.
const POINTS_MM: f64 = 0.04;

/// Distance of the checked places along a move, mm.
const PLACES_MM: f64 = 0.15;

/// Most places of one move; a long move has places farther apart.
const MOST_PLACES: f64 = 300.0;

/// The proof must accept a move whose sampled depth is below this share of the tolerance.
///
/// The share is below 1 because the proof may find a larger depth than the samples. Below a slope, the sharp
/// rim of a flat cutter can be deeper than any point of the slope is inside the cutter, by a factor of up to
/// the root of 2. Samples also miss the deepest point by up to their distance.
const SURELY_FINE: f64 = 0.6;

/// A random profile of ledges and of walls with 0 to 10 degrees of draft. With `is_round`, coordinates are
/// whole.
fn profile(random: &mut Random, is_round: bool) -> Vec<[f64; 2]> {
    let rounded = |value: f64| if is_round { value.round() } else { value };
    let mut points = vec![[0.0, 0.0]];
    for _ in 0..4 {
        let [x, z] = points[points.len() - 1];
        let ledge = x + rounded(random.between(5.0, 14.0));
        let step =
            rounded(random.between(3.0, 15.0)) * if z > 4.0 || random.unit() < 0.3 { -1.0 } else { 1.0 };
        let draft = if is_round { 0.0 } else { random.between(0.0, 10f64.to_radians()).tan() };
        points.extend([[ledge, z], [ledge + draft * step.abs(), z + step]]);
    }
    let [x, z] = points[points.len() - 1];
    points.push([x + 9.0, z]);
    points
}

pub fn extruded(profile: &[[f64; 2]]) -> Source {
    let last = profile.len() - 1;
    let row = |[x, z]: [f64; 2]| [-HALF_LENGTH_MM, HALF_LENGTH_MM].map(|y| Point3::new(x, y, z)).to_vec();
    let inner = (0..=last).map(|k| k as f64);
    let knots = std::iter::once(0.0).chain(inner).chain([last as f64]).collect();
    Source::Nurbs(Nurbs {
        degree: [1, 1],
        knots: [knots, vec![0.0, 0.0, 1.0, 1.0]],
        control_points: profile.iter().copied().map(row).collect(),
        weights: None,
    })
}

/// Dense points along a profile.
fn dense(profile: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut points = Vec::new();
    for pair in profile.windows(2) {
        let way = [0, 1].map(|k| pair[1][k] - pair[0][k]);
        let n = (way[0].hypot(way[1]) / POINTS_MM).ceil();
        points.extend((0..=n as usize).map(|k| [0, 1].map(|c| pair[0][c] + way[c] * (k as f64 / n))));
    }
    points
}

/// The depth of the deepest dense point inside the cutter along a move, mm; negative if all are outside.
fn sampled(points: &[[f64; 2]], tool: &Tool, way: &Curve) -> f64 {
    let n = (way.length() / PLACES_MM).ceil().clamp(1.0, MOST_PLACES);
    let mut deepest = f64::NEG_INFINITY;
    for k in 0..=n as usize {
        let tip = way.point_at(k as f64 / n);
        let beyond = (tip.y.abs() - HALF_LENGTH_MM).max(0.0);
        // x never falls along the profile, so that the points are sorted by x.
        let [from, to] =
            [-1.0, 1.0].map(|side| points.partition_point(|p| p[0] < tip.x + side * tool.radius_mm));
        for [x, z] in &points[from..to] {
            if *z > tip.z {
                deepest = depth(tool, (x - tip.x).hypot(beyond), z - tip.z).max(deepest);
            }
        }
    }
    deepest
}

/// Corrupted versions of a move: lowered, shifted, extended, straightened, or with another arc.
fn corruptions(step: &Move, tolerance_mm: f64, random: &mut Random) -> Vec<Curve> {
    let line = |start: Point3<f64>, end: Point3<f64>| Curve::Line(Line { start, end });
    let down = Vector3::z() * (-2.0 * tolerance_mm);
    let along = match step {
        Move::Rapid { line: rapid } => {
            let lowered = Vector3::z() * -random.between(0.1, 20.0);
            return vec![
                line(rapid.start + lowered, rapid.end + lowered),
                line(rapid.start, rapid.end + lowered),
            ];
        }
        Move::Feed { along, .. } => *along,
        Move::Turn { .. } | Move::Dwell { .. } => return Vec::new(),
    };
    let (start, end) = (along.start(), along.end());
    let way = (end - start).try_normalize(0.0).unwrap_or_default();
    let aside =
        Vector3::new(random.between(-1.0, 1.0), 0.0, random.between(-1.0, 1.0)) * (4.0 * tolerance_mm);
    let shifted = Vector3::new(random.between(-3.0, 3.0), 0.0, 0.0);
    let mut spoiled = vec![
        line(start, end),
        line(start, end + down),
        line(start + down, end),
        line(start, end + way * random.between(0.0, 3.0)),
        line(start - way * (3.0 * tolerance_mm), end),
        line(start + aside, end + aside),
        line(start + shifted, end + shifted),
    ];
    if let Curve::Arc(arc) = along {
        let turned = if arc.direction() == Direction::Ccw { Direction::Cw } else { Direction::Ccw };
        let half = nalgebra::center(&start, &end) - arc.center();
        let mirrored = arc.center() + half * 2.0;
        let across = (end - start).cross(&Vector3::y()).try_normalize(0.0).unwrap_or_default();
        let moved = arc.center() + across * random.between(-0.2, 0.2);
        let arcs = [(turned, arc.center()), (turned, mirrored), (arc.direction(), moved)];
        let arcs = arcs
            .into_iter()
            .filter_map(|(direction, center)| Arc::new(arc.plane(), direction, start, end, center).ok());
        spoiled.extend(arcs.map(Curve::Arc));
    }
    spoiled
}

/// Numbers of corrupted moves: all, those that gouge deeper than the tolerance, and those that the proof must
/// accept.
#[derive(Default, Debug)]
struct Tally {
    all: usize,
    gouging: usize,
    fine: usize,
}

fn corrupt(surface: &BezierSurface, points: &[[f64; 2]], job: &Job, random: &mut Random) -> Tally {
    let Ok(plan) = plan(job, &Budget::unlimited()) else { return Tally::default() };
    let tolerance_mm = job.tolerance.mm();
    let proof = GougeProof::new(surface, &job.tool.cutter(), 0.0);
    let gap = GAP_SHARE * tolerance_mm;
    let mut tally = Tally::default();
    for step in plan.toolpath.moves().step_by(MOVES_APART) {
        for spoiled in corruptions(step, tolerance_mm, random) {
            let mut found = Penetration::NONE;
            proof.penetrate(&spoiled, 0.0, gap, &mut found, &Budget::unlimited()).unwrap();
            let sampled = sampled(points, &job.tool, &spoiled);
            let (is_refused, tool) = (found.bound_mm > tolerance_mm, &job.tool);
            assert!(
                sampled <= found.bound_mm + 1e-9,
                "{tool:?} {spoiled:?}: {sampled} mm deep, more than the bound: {found:?}"
            );
            assert!(is_refused || sampled <= tolerance_mm, "{tool:?} {spoiled:?}: a gouge was accepted");
            if sampled + POINTS_MM.min(0.2 * tolerance_mm) < SURELY_FINE * tolerance_mm
                && found.found_mm < sampled + gap
            {
                assert!(!is_refused, "{tool:?} {spoiled:?}: refused at {sampled} mm: {found:?}");
                tally.fine += 1;
            }
            tally.all += 1;
            tally.gouging += usize::from(sampled > tolerance_mm);
        }
    }
    tally
}

#[test]
fn the_gouge_proof_refuses_corrupted_moves_that_gouge_and_accepts_harmless_moves() {
    let mut random = Random::stream(2026);
    let mut tally = Tally::default();
    for k in 0..PARTS {
        let profile = profile(&mut random, k % 2 == 0);
        let points = dense(&profile);
        let source = extruded(&profile);
        for shape in [Shape::Ball, Shape::Flat, Shape::BullNose { corner_radius_mm: 1.0 }] {
            let tool = Tool { shape, ..Tool::ball(RADIUS_MM) };
            let grid = heights(3, [0.0, 1.0], Ends::Natural, |_, _| 0.0);
            let tolerance_mm = TOLERANCES_MM[k % TOLERANCES_MM.len()];
            let job = Job {
                tool,
                surface: source.clone(),
                ..job(grid, 2.0 * RADIUS_MM, STEPOVER_MM, tolerance_mm, 4)
            };
            let of_path = match source.surface().unwrap() {
                AnySurface::Bicubic(surface) => corrupt(&surface.upward(), &points, &job, &mut random),
                _ => panic!("a profile of lines is polynomial"),
            };
            tally.all += of_path.all;
            tally.gouging += of_path.gouging;
            tally.fine += of_path.fine;
        }
    }
    println!("{tally:?}");
    assert!(
        tally.all > 6_500 && tally.gouging > 1_600 && tally.fine > 300,
        "too few moves were compared: {tally:?}"
    );
}
