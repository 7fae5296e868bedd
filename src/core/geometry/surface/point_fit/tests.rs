//! What fitted surfaces promise: known surfaces, bounds, noise and invariances.

mod data;
mod degenerate;
mod mistakes;

use nalgebra::Vector3;
use proptest::prelude::*;

use super::*;
use data::{fit_of, fitted, grid, noise, scattered, wave};

/// The height of a surface over a place in plan, by Newton's method on its patches.
fn height(nurbs: &Nurbs, at: Point2<f64>) -> f64 {
    let surface = nurbs.surface().unwrap();
    let spans = surface.spans().map(|n| n as f64);
    let (mut u, mut v) = (0.5 * spans[0], 0.5 * spans[1]);
    for _ in 0..50 {
        let jet = surface.jet(u, v);
        let off = at - jet.point.xy();
        let det = jet.du.xy().perp(&jet.dv.xy());
        u = (u + off.perp(&jet.dv.xy()) / det).clamp(0.0, spans[0]);
        v = (v + jet.du.xy().perp(&off) / det).clamp(0.0, spans[1]);
    }
    surface.jet(u, v).point.z
}

/// The errors of a surface at points, found without its parameters.
fn errors(fitted: &Fitted, points: &[Point3<f64>]) -> Vec<f64> {
    points.iter().map(|p| height(&fitted.nurbs, p.xy()) - p.z).collect()
}

fn rms(errors: &[f64]) -> f64 {
    (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt()
}

fn most(errors: &[f64]) -> f64 {
    errors.iter().fold(0.0, |most, e| e.abs().max(most))
}

#[test]
fn a_plane_is_reproduced_to_rounding() {
    let plane = |x: f64, y: f64| 3.0 + 0.4 * x - 0.25 * y;
    for points in [scattered(300, plane), grid([12, 9], 0.4, plane), scattered(3, plane)] {
        let fitted = fitted(&points, Error::Max(1e-6));
        assert!(most(&errors(&fitted, &points)) < 1e-9);
        assert!(fitted.max_mm < 1e-9 && fitted.left_out.is_empty());
        assert_eq!(fitted.nurbs.control_points.len(), 4);
    }
}

#[test]
fn a_bicubic_is_followed_as_closely_as_is_asked() {
    let cubic = |x: f64, y: f64| {
        let (x, y) = (x / 50.0 - 1.0, y / 50.0 - 1.0);
        4.0 * x * x * x - 3.0 * x * y * y + 2.0 * x * x * y * y * y + y
    };
    let points = grid([40, 40], 0.0, cubic);
    for bound in [1e-2, 1e-4, 1e-6] {
        let fitted = fitted(&points, Error::Max(bound));
        let off = most(&errors(&fitted, &points));
        assert!(off <= bound && off > 0.5 * bound, "{off} for {bound}");
        // Between the points, too.
        let between = scattered(200, cubic);
        assert!(most(&errors(&fitted, &between)) < 2.0 * bound);
    }
}

#[test]
fn the_stated_figures_are_those_of_the_patches_and_within_the_bound() {
    let points = noise(scattered(2500, wave), 0.002);
    for error in [Error::Max(0.02), Error::Max(0.008), Error::Rms(0.003), Error::Rms(0.002)] {
        let fitted = fitted(&points, error);
        let errors = errors(&fitted, &points);
        assert!((rms(&errors) - fitted.rms_mm).abs() < 1e-9, "{error:?}");
        assert!((most(&errors) - fitted.max_mm).abs() < 1e-9, "{error:?}");
        let reached = if let Error::Max(_) = error { fitted.max_mm } else { fitted.rms_mm };
        assert!(reached <= error.bound() * (1.0 + 1e-9), "{error:?} {reached}");
        assert!(reached >= 0.95 * error.bound(), "{error:?} {reached}");
        assert_eq!(fitted.n_points, 2500);
    }
}

#[test]
fn a_wave_is_recovered_better_than_its_noise() {
    let points = noise(scattered(10_000, wave), 0.002);
    let fitted = fitted(&points, Error::Rms(0.002));
    let truth = scattered(1000, |x, y| wave(0.98 * x + 1.0, 0.98 * y + 1.0));
    let truth: Vec<Point3<f64>> =
        truth.iter().map(|p| Point3::new(0.98 * p.x + 1.0, 0.98 * p.y + 1.0, p.z)).collect();
    let off = rms(&errors(&fitted, &truth));
    assert!(off < 0.000_7, "{off}");
}

#[test]
fn a_larger_error_makes_a_smoother_surface_of_no_more_control_points() {
    let points = noise(scattered(2500, wave), 0.002);
    let n = |error: f64| {
        let fitted = fitted(&points, Error::Max(error));
        fitted.nurbs.control_points.len() * fitted.nurbs.control_points[0].len()
    };
    assert!(n(0.5) <= n(0.05) && n(0.05) <= n(0.009), "{} {} {}", n(0.5), n(0.05), n(0.009));
}

/// Two surfaces with equally many control points differ by the largest distance of two of these.
fn apart(a: &Nurbs, b: &Nurbs, image: impl Fn(&Point3<f64>) -> Point3<f64>) -> f64 {
    let [a, b] = [a, b].map(|nurbs| nurbs.control_points.iter().flatten().copied().collect::<Vec<_>>());
    assert_eq!(a.len(), b.len());
    a.iter().zip(&b).map(|(p, q)| (image(p) - q).norm()).fold(0.0, f64::max)
}

#[test]
fn moved_and_scaled_points_make_the_moved_and_scaled_surface() {
    let points = noise(scattered(900, wave), 0.002);
    let plain = fitted(&points, Error::Max(0.01));
    for scale in [1e-4, 1.0, 37.5] {
        for shift in [Vector3::zeros(), Vector3::new(-400.0, 1000.0, 250.0)] {
            let image = |p: &Point3<f64>| Point3::from((p.coords + shift) * scale);
            let moved: Vec<Point3<f64>> = points.iter().map(image).collect();
            let fitted = fitted(&moved, Error::Max(0.01 * scale));
            let off = apart(&plain.nurbs, &fitted.nurbs, image);
            assert!(off < 1e-8 * scale, "{off} for {scale}");
        }
    }
}

#[test]
fn a_change_far_below_the_bound_changes_the_surface_as_little() {
    let points = noise(scattered(900, wave), 0.002);
    let plain = fitted(&points, Error::Rms(0.003));
    for k in [0, 17, 450, 899] {
        let mut changed = points.clone();
        changed[k].z += 1e-6;
        let fitted = fitted(&changed, Error::Rms(0.003));
        let [before, after] = [&plain, &fitted].map(|fitted| fitted.nurbs.surface().unwrap());
        assert_eq!(before.spans(), after.spans());
        let places = (0..=200).flat_map(|i| (0..=200).map(move |j| [i, j]));
        let spans = before.spans().map(|n| n as f64 / 200.0);
        let change = places.map(|[i, j]| {
            let [u, v] = [spans[0] * f64::from(i), spans[1] * f64::from(j)];
            (before.jet(u, v).point - after.jet(u, v).point).norm()
        });
        let change = change.fold(0.0, f64::max);
        assert!(change < 3e-6, "{change} for point {k}");
    }
}

#[test]
fn the_number_of_threads_does_not_change_the_surface() {
    let points = noise(scattered(3000, wave), 0.002);
    let fit = fit_of(&points, Error::Max(0.01));
    let budget = Budget::unlimited();
    // The two fits take all helpers of a machine with two processors, and have none left for themselves.
    let both = budget.in_order(2, |_| Ok::<_, ()>(fit.fitted(&budget))).unwrap();
    let with_helpers = fit.fitted(&Budget::unlimited());
    assert!(both.iter().all(|alone| *alone == with_helpers));
}

#[test]
fn a_turned_grid_makes_a_surface_along_its_rows() {
    let points = grid([30, 20], 0.5, wave);
    let fitted = fitted(&points, Error::Max(1e-3));
    assert_eq!(fitted.extrapolated, None);
    let control = &fitted.nurbs.control_points;
    let along = (control[1][0] - control[0][0]).xy();
    assert!((along.y.atan2(along.x) - 0.5).abs() < 1e-9);
    let surface = fitted.nurbs.surface().unwrap();
    assert!(surface.jet(0.3, 0.4).normal().z > 0.0);
}

#[test]
fn places_without_points_are_told() {
    let all = scattered(4000, wave);
    let hole = |p: &&Point3<f64>| (p.x - 60.0).hypot(p.y - 40.0) > 25.0;
    let points: Vec<Point3<f64>> = all.iter().filter(hole).copied().collect();
    let part = fitted(&points, Error::Max(0.01)).extrapolated.unwrap();
    assert!(Vector3::new(part.at[0] - 60.0, part.at[1] - 40.0, 0.0).norm() < 2.0, "{part:?}");
    assert!((part.distance_mm - 25.0).abs() < 2.0, "{part:?}");
    // The circle less a rim of four spacings: 100 mm over the root of 3200 points, each.
    let inner: f64 = 25.0 - 4.0 * 1.58;
    assert!((part.share - std::f64::consts::PI * inner * inner / 1e4).abs() < 0.02, "{part:?}");
    assert_eq!(fitted(&all, Error::Max(0.01)).extrapolated, None);
    let corner = |p: &&Point3<f64>| p.x < 10.0 || p.y < 10.0 || p.x > 90.0 && p.y > 90.0;
    let points: Vec<Point3<f64>> = all.iter().filter(corner).copied().collect();
    let refused = fit_of(&points, Error::Max(0.01)).fitted(&Budget::unlimited());
    assert!(matches!(refused, Err(PointFitError::MostlyExtrapolated { .. })));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn any_points_make_a_surface_within_the_bound_or_an_error(
        points in prop::collection::vec((-5i32..5, -5i32..5, -3i32..3), 1..60),
        exponent in -6i32..3,
        is_max in any::<bool>(),
    ) {
        let points: Vec<Point3<f64>> =
            points.iter().map(|(x, y, z)| Point3::new(f64::from(*x), f64::from(*y), f64::from(*z))).collect();
        let bound = 10f64.powi(exponent);
        let error = if is_max { Error::Max(bound) } else { Error::Rms(bound) };
        let fit = PointFit { points, error, outliers: OutlierChoice::LeaveOut };
        if let Ok(fitted) = fit.fitted(&Budget::unlimited()) {
            let reached = if is_max { fitted.max_mm } else { fitted.rms_mm };
            prop_assert!(reached <= bound * (1.0 + 1e-6));
            prop_assert!(fitted.nurbs.control_points.iter().flatten().all(|p| p.z.is_finite()));
        }
    }
}
