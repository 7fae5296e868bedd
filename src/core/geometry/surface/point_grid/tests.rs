use super::*;
use crate::geometry::surface::{Jet, Patch, Surface};
use std::f64::consts::PI;

fn wave(x: f64, y: f64) -> f64 {
    10.0 * (PI * x / 40.0).sin() * (PI * y / 40.0).cos()
}

fn wave_grid(n: usize, twist: Twist, ends: Ends) -> PointGrid {
    let at = |i: usize| 80.0 * i as f64 / (n - 1) as f64;
    let points =
        (0..n).map(|i| (0..n).map(|j| Point3::new(at(i), at(j), wave(at(i), at(j)))).collect()).collect();
    PointGrid { points, twist, ends }
}

fn largest_error(grid: &PointGrid) -> f64 {
    let surface = grid.surface().unwrap();
    let n = surface.spans()[0] as f64;
    let m = 400;
    let mut worst = 0.0f64;
    for a in 0..=m {
        for b in 0..=m {
            let p = surface.jet(n * a as f64 / m as f64, n * b as f64 / m as f64).point;
            worst = worst.max((p.z - wave(p.x, p.y)).abs());
        }
    }
    worst
}

/// Published fit errors of this surface, mm, for each twist and end condition.
#[test]
fn fit_errors_of_the_wave_match_the_published_figures() {
    for (n, twist, ends, known) in [
        (9, Twist::Zero, Ends::Natural, 0.333),
        (9, Twist::Spline, Ends::Natural, 0.328),
        (9, Twist::Spline, Ends::NotAKnot, 0.099),
        (60, Twist::Zero, Ends::Natural, 5.6e-3),
        (60, Twist::Spline, Ends::Natural, 5.6e-3),
        (60, Twist::Spline, Ends::NotAKnot, 3.6e-5),
    ] {
        let error = largest_error(&wave_grid(n, twist, ends.clone()));
        assert!((error / known - 1.0).abs() < 0.03, "{n} {twist:?} {ends:?}: {error}");
    }
}

fn clamped_ends(n: usize) -> Ends {
    let h = 80.0 / (n - 1) as f64;
    let w = PI / 40.0;
    let at = |i: usize| h * i as f64;
    let du = |x: f64, y: f64| Vector3::new(h, 0.0, h * 10.0 * w * (w * x).cos() * (w * y).cos());
    let dv = |x: f64, y: f64| Vector3::new(0.0, h, -h * 10.0 * w * (w * x).sin() * (w * y).sin());
    Ends::Clamped(EndTangents {
        u0: (0..n).map(|j| du(0.0, at(j))).collect(),
        u1: (0..n).map(|j| du(80.0, at(j))).collect(),
        v0: (0..n).map(|i| dv(at(i), 0.0)).collect(),
        v1: (0..n).map(|i| dv(at(i), 80.0)).collect(),
    })
}

#[test]
fn true_end_tangents_beat_every_guess() {
    let error = largest_error(&wave_grid(9, Twist::Spline, clamped_ends(9)));
    assert!(error < 0.03, "{error}");
}

#[test]
fn spline_twist_is_c2_and_zero_twist_c1_across_patches() {
    let jumps = |grid: &PointGrid| {
        let surface = grid.surface().unwrap();
        let [mut first, mut second] = [0.0f64; 2];
        let mut compare = |a: Jet, b: Jet| {
            first = first.max((a.du - b.du).norm()).max((a.dv - b.dv).norm());
            second = second.max((a.duu - b.duu).norm()).max((a.duv - b.duv).norm());
            second = second.max((a.dvv - b.dvv).norm());
        };
        for i in 1..surface.spans()[0] {
            for k in 0..40 {
                let (j, t) = (k / 5, (k % 5) as f64 / 4.0);
                compare(surface.patch(i - 1, j).jet(1.0, t), surface.patch(i, j).jet(0.0, t));
                compare(surface.patch(j, i - 1).jet(t, 1.0), surface.patch(j, i).jet(t, 0.0));
            }
        }
        [first, second]
    };
    for ends in [Ends::Natural, Ends::NotAKnot, Ends::Bessel, clamped_ends(9)] {
        let [first, second] = jumps(&wave_grid(9, Twist::Spline, ends));
        assert!(first < 1e-12 && second < 1e-10, "{first} {second}");
    }
    let [first, second] = jumps(&wave_grid(9, Twist::Zero, Ends::Natural));
    assert!(first < 1e-12 && second > 0.1, "{first} {second}");
}

/// A torus whose tube is measured at 25 points, and the largest angle between normals across its seams.
fn kink(ends: Ends) -> f64 {
    let angle = |k: usize, n: usize| 2.0 * PI * (k % n) as f64 / n as f64;
    let at = |i: usize, j: usize| {
        let (u, v) = (angle(i, 24), angle(j, 24));
        let r = 30.0 + 8.0 * u.cos();
        Point3::new(r * v.cos(), r * v.sin(), 8.0 * u.sin())
    };
    let points = (0..25).map(|i| (0..25).map(|j| at(i, j)).collect()).collect();
    let surface = PointGrid { points, twist: Twist::Spline, ends }.surface().unwrap();
    let mut worst = 0.0f64;
    for k in 0..24 {
        for t in [0.0, 0.3, 0.7, 1.0] {
            let pairs = [
                [surface.patch(0, k).jet(0.0, t), surface.patch(23, k).jet(1.0, t)],
                [surface.patch(k, 0).jet(t, 0.0), surface.patch(k, 23).jet(t, 1.0)],
            ];
            for [a, b] in pairs {
                let [a, b] = [a, b].map(|jet| jet.du.cross(&jet.dv));
                worst = worst.max(a.angle(&b).to_degrees());
            }
        }
    }
    worst
}

#[test]
fn a_closed_grid_has_no_kink_at_its_seams() {
    assert!(kink(Ends::NotAKnot) > 0.01);
    for ends in [Ends::Periodic, Ends::Usual] {
        let angle = kink(ends.clone());
        // The cosine of the angle is rounded.
        assert!(angle < 1e-5, "{ends:?}: {angle}");
    }
}

#[test]
fn a_seam_on_a_sharp_edge_stays_sharp_unless_periodic_ends_are_asked_for() {
    // A drop with its tip at the seam.
    let at = |j: usize| {
        let t = 2.0 * PI * (j % 20) as f64 / 20.0;
        [20.0 * (1.0 - t.cos()), 8.0 * t.sin() * (0.5 * t).sin().powi(2)]
    };
    let row = |x: f64| (0..21).map(|j| Point3::new(x, at(j)[0], at(j)[1])).collect::<Vec<_>>();
    let mut grid = PointGrid {
        points: (0..4).map(|i| row(5.0 * i as f64)).collect(),
        twist: Twist::Spline,
        ends: Ends::Usual,
    };
    assert_eq!((grid.closed(), grid.periodic()), ([false, true], [false, false]));
    grid.ends = Ends::Periodic;
    assert_eq!(grid.periodic(), [false, true]);
    grid.points.iter_mut().for_each(|row| row[20].z += 1e-3);
    assert_eq!(grid.surface(), Err(GridError::NotClosed));
}

#[test]
fn the_surface_passes_through_its_points() {
    let grid = wave_grid(7, Twist::Spline, Ends::Bessel);
    let surface = grid.surface().unwrap();
    for (i, row) in grid.points.iter().enumerate() {
        for (j, p) in row.iter().enumerate() {
            assert!((surface.jet(i as f64, j as f64).point - p).norm() < 1e-12);
        }
    }
}

#[test]
fn a_broken_grid_is_refused_with_the_place_of_its_fault() {
    let p = Point3::origin();
    let grid =
        |points: Vec<Vec<Point3<f64>>>| PointGrid { points, twist: Twist::Spline, ends: Ends::Natural };
    assert_eq!(grid(vec![vec![p, p]]).surface(), Err(GridError::TooFewRows { rows: 1 }));
    assert_eq!(grid(vec![vec![p], vec![p]]).surface(), Err(GridError::TooFewPoints { row: 0, points: 1 }));
    assert_eq!(
        grid(vec![vec![p, p], vec![p, p, p]]).surface(),
        Err(GridError::Ragged { row: 1, points: 3, expected: 2 })
    );
    let bad = Point3::new(0.0, f64::NAN, 0.0);
    assert_eq!(grid(vec![vec![p, p], vec![p, bad]]).surface(), Err(GridError::NotFinite { i: 1, j: 1 }));
    let tangents = EndTangents { u0: vec![], u1: vec![], v0: vec![], v1: vec![] };
    let mut clamped = grid(vec![vec![p, p], vec![p, p]]);
    clamped.ends = Ends::Clamped(tangents);
    assert_eq!(clamped.surface(), Err(GridError::EndTangents { edge: Edge::U0, given: 0, expected: 2 }));
}
