use super::*;
use crate::geometry::surface::BezierSurface;
use crate::geometry::surface::point_grid::{Ends, PointGrid, Twist};
use crate::machining::regularity;

fn grid(n: usize, side: f64, height: impl Fn(f64, f64) -> f64) -> BezierSurface {
    let at = |i: usize| side * (i as f64 / (n - 1) as f64 - 0.5);
    let points =
        (0..n).map(|i| (0..n).map(|j| Point3::new(at(i), at(j), height(at(i), at(j)))).collect()).collect();
    PointGrid { points, twist: Twist::Spline, ends: Ends::NotAKnot }.surface().unwrap()
}

const SPACING: Spacing = Spacing { chord_height_mm: 1e-3, step_length_mm: 5.0 };

fn prove(surface: &BezierSurface, radius: f64, axis: usize) -> Regularity {
    regularity::prove(surface, radius, axis, &Budget::unlimited()).unwrap()
}

fn sections<'a>(
    surface: &'a BezierSurface,
    radius: f64,
    axis: usize,
    regularity: &'a Regularity,
) -> Sections<'a> {
    Sections::new(surface, radius, axis, regularity, &Budget::unlimited()).unwrap()
}

#[test]
fn sections_of_a_sphere_are_circles() {
    let cap = grid(41, 30.0, |x, y| (1600.0 - x * x - y * y).sqrt());
    for axis in [0, 1] {
        let regularity = prove(&cap, 5.0, axis);
        let sections = sections(&cap, 5.0, axis, &regularity);
        let [low, high] = sections.extent();
        for k in 1..10 {
            let at = low + (high - low) * k as f64 / 10.0;
            let chains = sections.chains(PlaneAt::new(at), SPACING, &Budget::unlimited()).unwrap();
            assert_eq!(chains.len(), 1);
            let radius = (45.0f64 * 45.0 - at * at).sqrt();
            for p in &chains[0].points {
                assert!((p[axis] - at).abs() < 1e-9);
                assert!((p[1 - axis].hypot(p.z) - radius).abs() < 1e-4, "{p}");
            }
            assert!(chains[0].chord_height_mm <= 1.01e-3);
        }
    }
}

#[test]
fn a_plane_along_an_edge_follows_it() {
    let plate = grid(5, 40.0, |x, _| 0.3 * x);
    let regularity = prove(&plate, 4.0, 1);
    let sections = sections(&plate, 4.0, 1, &regularity);
    let [low, high] = sections.extent();
    assert!((low + 20.0).abs() < 1e-12 && (high - 20.0).abs() < 1e-12);
    for at in [low + INSET_MM, high - INSET_MM] {
        let chains = sections.chains(PlaneAt::new(at), SPACING, &Budget::unlimited()).unwrap();
        assert_eq!(chains.len(), 1);
        let points = &chains[0].points;
        let length = (points[points.len() - 1] - points[0]).norm();
        assert!((length - 40.0 * 1.09f64.sqrt()).abs() < 1e-5, "{length}");
    }
}

#[test]
fn a_plane_may_hold_several_sections() {
    // The boundary at y = 20 waves in plan, so that a plane near it cuts the crests only.
    let n = 33;
    let points = (0..n)
        .map(|i| {
            let x = i as f64 * 60.0 / (n - 1) as f64;
            let wave = 2.0 * (x * std::f64::consts::TAU / 20.0).sin();
            (0..5).map(|j| Point3::new(x, (20.0 + wave) * j as f64 / 4.0, 0.0)).collect()
        })
        .collect();
    let grid = PointGrid { points, twist: Twist::Spline, ends: Ends::NotAKnot };
    let surface = grid.surface().unwrap();
    let regularity = prove(&surface, 3.0, 1);
    let sections = sections(&surface, 3.0, 1, &regularity);
    let chains = sections.chains(PlaneAt::new(21.0), SPACING, &Budget::unlimited()).unwrap();
    assert_eq!(chains.len(), 3);
    assert_eq!(sections.chains(PlaneAt::new(10.0), SPACING, &Budget::unlimited()).unwrap().len(), 1);
}

#[test]
fn chord_height_is_that_of_the_circle() {
    let (r, half) = (10.0f64, 0.3f64);
    let chord = 2.0 * r * half.sin();
    assert!((chord_height(chord, 1.0 / r) - r * (1.0 - half.cos())).abs() < 1e-12);
    assert_eq!(chord_height(21.0, 0.1), f64::INFINITY);
}

#[test]
fn sections_go_on_across_a_seam_and_lie_in_it() {
    // A cone closed around its axis, whose seam is the line y = 0, x > 0 turned by `turned`.
    for turned in [0.0, 0.6, std::f64::consts::FRAC_PI_2] {
        let row = |k: usize| {
            let (sin, cos) = (turned + std::f64::consts::TAU * (k % 48) as f64 / 48.0).sin_cos();
            [30.0, 24.0, 18.0, 12.0].map(|r| Point3::new(r * cos, r * sin, 0.5 * (30.0 - r))).to_vec()
        };
        let points = (0..=48).map(row).collect();
        let grid = PointGrid { points, twist: Twist::Spline, ends: Ends::NotAKnot };
        let surface = grid.surface().unwrap().upward();
        let regularity = prove(&surface, 0.0, 1);
        let sections = sections(&surface, 0.0, 1, &regularity);
        for at in [0.0, 1e-7, 4.0, -11.0, 20.0] {
            let chains = sections.chains(PlaneAt::new(at), SPACING, &Budget::unlimited()).unwrap();
            let half = |r: f64| (r * r - at * at).max(0.0).sqrt();
            let n = if f64::abs(at) < 12.0 { 2 } else { 1 };
            assert_eq!(chains.len(), n, "seam at {turned}, plane at {at}");
            for chain in chains {
                let ends = [&chain.points[0], &chain.points[chain.points.len() - 1]].map(|p| p.x.abs());
                let expected = if n == 2 { half(12.0) } else { half(30.0) };
                assert!((ends[0].max(ends[1]) - half(30.0)).abs() < 0.02, "{turned} {at}: {ends:?}");
                assert!((ends[0].min(ends[1]) - expected).abs() < 0.02, "{turned} {at}: {ends:?}");
                assert!(chain.points.iter().all(|p| (p.y - at).abs() < 1e-8));
            }
        }
    }
}
