//! Compares bounds with distances in closed form and with distances of dense samples. Also checks that a
//! curve that does not belong to the points gets a large bound.

use nalgebra::Point3;
use proptest::prelude::*;

use super::*;
use crate::geometry::curve::Line;
use crate::geometry::plane::Plane;

fn arc(center: [f64; 2], radius: f64, from: f64, turn: f64, rise: f64) -> Curve {
    let at = |angle: f64, z: f64| {
        Point3::new(center[0] + radius * angle.cos(), center[1] + radius * angle.sin(), z)
    };
    let direction = if turn > 0.0 { Direction::Ccw } else { Direction::Cw };
    let [start, end] = [at(from, 1.0), at(from + turn, 1.0 + rise)];
    Curve::Arc(Arc::new(Plane::Xy, direction, start, end, Point3::new(center[0], center[1], 1.0)).unwrap())
}

/// The Frechet distance of two sequences: many points of the lines, and many points of the curve.
fn dense(curve: &Curve, points: &[Point3<f64>], on_line: usize, on_curve: usize) -> f64 {
    let mut way = vec![points[0]];
    for pair in points.windows(2) {
        way.extend((1..=on_line).map(|k| pair[0] + (pair[1] - pair[0]) * (k as f64 / on_line as f64)));
    }
    let curve: Vec<_> = (0..=on_curve).map(|k| curve.point_at(k as f64 / on_curve as f64)).collect();
    let mut row: Vec<f64> = Vec::new();
    for p in &way {
        let mut next: Vec<f64> = Vec::with_capacity(curve.len());
        for (j, q) in curve.iter().enumerate() {
            let before = [
                row.get(j).copied(),
                j.checked_sub(1).and_then(|j| row.get(j)).copied(),
                j.checked_sub(1).map(|j| next[j]),
            ];
            let best = before.into_iter().flatten().fold(f64::INFINITY, f64::min);
            let best = if best.is_finite() { best } else { 0.0 };
            next.push(best.max((p - q).norm()));
        }
        row = next;
    }
    row[row.len() - 1]
}

#[test]
fn a_chord_is_as_far_from_its_arc_as_the_arc_is_high() {
    for rise in [0.0, 2.0] {
        for turn in [-3.0, -1.0, 0.01, 0.5, 3.1] {
            let curve = arc([3.0, -2.0], 10.0, 0.3, turn, rise);
            let ends = [curve.start(), curve.end()];
            let height = 10.0 * (1.0 - (0.5 * turn).cos());
            let found = from_lines(&curve, &ends);
            assert!((found - height).abs() < 1e-6 * height + 1e-9, "{turn} {found} {height}");
            assert!(from_points(&curve, &ends) < 1e-12);
        }
    }
}

#[test]
fn points_that_go_back_are_far_by_half_of_the_way_back() {
    let line = Curve::Line(Line { start: Point3::origin(), end: Point3::new(10.0, 0.0, 0.0) });
    let points = [0.0, 6.0, 4.0, 10.0].map(|x| Point3::new(x, 0.0, 0.0));
    assert!((from_points(&line, &points) - 1.0).abs() < 1e-6);
    assert!((from_lines(&line, &points) - 1.0).abs() < 1e-6);
}

#[test]
fn an_arc_the_wrong_way_round_is_far() {
    let good = arc([0.0, 0.0], 5.0, 0.0, 1.5, 0.0);
    let points: Vec<_> = (0..=10).map(|k| good.point_at(f64::from(k) / 10.0)).collect();
    let wrong = arc([0.0, 0.0], 5.0, 0.0, 1.5 - TAU, 0.0);
    assert!(from_points(&good, &points) < 1e-12 && from_points(&wrong, &points) > 1.0);
    assert!(from_lines(&wrong, &points) > 5.0);
    // Two points do not justify more than half a turn.
    assert_eq!(from_points(&wrong, &[wrong.start(), wrong.end()]), f64::INFINITY);
}

#[test]
fn a_full_turn_is_followed() {
    let curve = arc([1.0, 1.0], 4.0, 0.7, TAU, 0.0);
    let mut points: Vec<_> = (0..=24).map(|k| curve.point_at(f64::from(k) / 24.0)).collect();
    points[24] = points[0];
    assert!(from_points(&curve, &points) < 1e-9);
    let height = 4.0 * (1.0 - (TAU / 48.0).cos());
    assert!((from_lines(&curve, &points) - height).abs() < 1e-6);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    /// A bound is never below the sampled distance and little above it. It is large for moved and for
    /// reversed points.
    #[test]
    fn bounds_hold_and_detect_wrong_curves(
        radius in 0.5..20.0f64, from in 0.0..6.0f64, turn in 0.1..5.5f64, left in any::<bool>(),
        rise in prop_oneof![Just(0.0), -4.0..4.0f64], noise in 0.0..0.3f64,
        offsets in prop::collection::vec((-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64), 2..9),
    ) {
        let turn = if left { turn } else { -turn };
        let curve = arc([2.0, 1.0], radius, from, turn, rise);
        let n = offsets.len() - 1;
        let points: Vec<_> = offsets
            .iter()
            .enumerate()
            .map(|(k, (x, y, z))| {
                let z = if rise == 0.0 { 0.0 } else { *z };
                curve.point_at(k as f64 / n as f64) + Vector3::new(*x, *y, z) * noise
            })
            .collect();
        let step = curve.length() / 400.0;
        let found = dense(&curve, &points, 60, 400);
        let bound = from_lines(&curve, &points);
        prop_assert!(bound >= found - step, "{bound} {found}");
        // Places that are best for the points need not be best for the lines.
        prop_assert!(bound <= 1.5 * found + step, "{bound} {found}");
        let near = from_points(&curve, &points);
        prop_assert!(near <= bound + 1e-9 || near.is_infinite() && turn.abs() > PI);
        let moved = points.iter().map(|p| p + Vector3::new(0.0, 0.0, 5.0)).collect::<Vec<_>>();
        prop_assert!(from_points(&curve, &moved) >= 5.0 - 4.0 - noise || rise != 0.0);
        let mut back = points.clone();
        back.reverse();
        prop_assert!(from_lines(&curve, &back) >= dense(&curve, &back, 60, 400) - step);
    }
}
