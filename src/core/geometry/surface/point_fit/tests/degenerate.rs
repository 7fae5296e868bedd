//! Points that give no surface, and unusual points that do.

use nalgebra::{Point2, Point3, Vector3};

use super::data::{fit_of, fitted, grid, scattered, wave};
use super::{errors, most};
use crate::budget::{Budget, Stopped};
use crate::geometry::surface::point_fit::{Error, Fitted, OutlierChoice, PointFit, PointFitError};

fn fit(points: &[[f64; 3]]) -> Result<Fitted, PointFitError> {
    let points: Vec<Point3<f64>> = points.iter().map(|p| Point3::from(*p)).collect();
    fit_of(&points, Error::Max(0.01)).fitted(&Budget::unlimited())
}

#[test]
fn points_that_span_no_area_are_refused() {
    assert_eq!(fit(&[]), Err(PointFitError::TooFew { found: 0 }));
    assert_eq!(fit(&[[0.0; 3], [1.0; 3]]), Err(PointFitError::TooFew { found: 2 }));
    assert_eq!(fit(&[[1.0, 2.0, 3.0]; 9]), Err(PointFitError::OnALine { width_mm: 0.0 }));
    let line: Vec<[f64; 3]> = (0..20).map(|k| [f64::from(k), 0.3 * f64::from(k), 0.0]).collect();
    assert!(matches!(fit(&line), Err(PointFitError::OnALine { .. })));
    let mut broken = vec![[0.0; 3]; 4];
    broken[2][1] = f64::NAN;
    assert_eq!(fit(&broken), Err(PointFitError::NotFinite { index: 2 }));
    for bound in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let fit = fit_of(&scattered(20, wave), Error::Rms(bound));
        assert_eq!(fit.fitted(&Budget::unlimited()), Err(PointFitError::Bound));
    }
}

#[test]
fn three_points_give_their_plane_and_doubles_change_nothing() {
    let corners = [[0.0, 0.0, 1.0], [10.0, 1.0, 2.0], [3.0, 8.0, -1.0]];
    let plane = fit(&corners).unwrap();
    assert!(plane.max_mm < 1e-12 && plane.n_points == 3);
    let doubled: Vec<[f64; 3]> = corners.iter().cycle().take(30).copied().collect();
    let same = fit(&doubled).unwrap();
    assert!(same.max_mm < 1e-12);
    let points = corners.map(Point3::from);
    assert!(most(&errors(&same, &points)) < 1e-12);
}

#[test]
fn points_one_above_the_other_are_refused() {
    let mut points = scattered(500, wave);
    let mut top = points.clone();
    top.iter_mut().for_each(|p| p.z += 8.0);
    points.extend(top);
    let refused = fit_of(&points, Error::Max(0.01)).fitted(&Budget::unlimited());
    let Err(PointFitError::Stacked { pair: [low, high], rise_mm }) = refused else { panic!("{refused:?}") };
    assert_eq!(high, low + 500);
    assert!((rise_mm - 8.0).abs() < 1e-9);
    // Measured twice, within the noise.
    let mut twice = scattered(500, wave);
    let again: Vec<Point3<f64>> = twice.iter().map(|p| p + Vector3::z() * 0.004).collect();
    twice.extend(again);
    assert!(fitted(&twice, Error::Max(0.01)).max_mm <= 0.01);
}

#[test]
fn a_bound_that_no_surface_meets_is_refused_with_the_best() {
    // A wall that a spline without knots of its own cannot follow.
    let points = grid([60, 60], 0.0, |x, _| if x < 47.0 { 0.0 } else { 5.0 });
    let fit = PointFit { outliers: OutlierChoice::Keep, ..fit_of(&points, Error::Max(1e-9)) };
    let refused = fit.fitted(&Budget::unlimited());
    let Err(PointFitError::TooFar { best_mm, index, at, .. }) = refused else { panic!("{refused:?}") };
    assert!(best_mm > 1e-9 && best_mm < 1.0, "{best_mm}");
    assert_eq!(at, points[index].xy());
    assert!((at.x - 47.0).abs() < 8.0, "{at}");
}

#[test]
fn tiny_parts_and_distant_places_are_fitted() {
    let far = |p: &Point3<f64>| p + Vector3::new(1e6, -1e6, 1e6);
    let points: Vec<Point3<f64>> = scattered(600, wave).iter().map(far).collect();
    let result = fitted(&points, Error::Max(0.01));
    assert!(result.max_mm <= 0.01 && result.max_mm > 0.009, "{}", result.max_mm);
    let tiny: Vec<Point3<f64>> = scattered(600, wave).iter().map(|p| p * 1e-5).collect();
    let result = fitted(&tiny, Error::Max(1e-7));
    assert!(result.max_mm <= 1e-7);
    // A narrow strip.
    let strip: Vec<Point3<f64>> =
        scattered(600, wave).iter().map(|p| Point3::new(p.x, 0.01 * p.y, p.z)).collect();
    let strip: Vec<Point3<f64>> = strip.iter().map(|p| Point3::new(p.x, p.y, (p.x / 10.0).sin())).collect();
    assert!(fitted(&strip, Error::Max(0.001)).max_mm <= 0.001);
}

#[test]
fn a_stopped_budget_stops_the_fit() {
    let budget = Budget::unlimited();
    budget.cancel();
    let fit = fit_of(&scattered(600, wave), Error::Max(0.01));
    assert_eq!(fit.fitted(&budget), Err(PointFitError::Stopped(Stopped::Cancelled)));
}

#[test]
fn an_error_names_points_and_places() {
    let error = PointFitError::Stacked { pair: [4, 9], rise_mm: 2.0 };
    assert!(error.to_string().starts_with("points 4 and 9 are one above the other, 2.0000 mm apart"));
    let at = Point2::new(1.0, 2.0);
    let error = PointFitError::TooFar { best_mm: 0.5, index: 1, at, limit: 10 };
    assert!(error.to_string().contains("the best has 0.500000 mm"), "{error}");
}
