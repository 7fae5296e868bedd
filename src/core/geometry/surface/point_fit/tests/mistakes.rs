//! Outliers are found wherever they are, and features are none.

use nalgebra::Point3;

use super::data::{Numbers, fit_of, fitted, grid, noise, scattered, wave};
use crate::budget::Budget;
use crate::geometry::surface::point_fit::{Error, Fitted, OutlierChoice, PointFit, PointFitError};

const WITHIN: Error = Error::Max(0.02);

/// The outliers that are refused.
fn found(points: &[Point3<f64>]) -> Vec<usize> {
    match fit_of(points, WITHIN).fitted(&Budget::unlimited()) {
        Ok(_) => Vec::new(),
        Err(PointFitError::Outliers { outliers }) => outliers.iter().map(|one| one.index).collect(),
        Err(other) => panic!("{other}"),
    }
}

/// The same points, with those at `places` of the list off by 0.2 mm.
fn off(points: &[Point3<f64>], places: &[usize]) -> Vec<Point3<f64>> {
    let mut wrong = points.to_vec();
    places.iter().for_each(|k| wrong[*k].z += 0.2);
    wrong
}

/// The points nearest to a place.
fn nearest(points: &[Point3<f64>], x: f64, y: f64, n: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    let distance = |k: &usize| (points[*k].x - x).hypot(points[*k].y - y);
    order.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
    order.truncate(n);
    order.sort_unstable();
    order
}

#[test]
fn one_outlier_is_found_in_the_middle_at_edges_and_at_corners() {
    for points in [noise(scattered(2500, wave), 0.002), noise(grid([50, 50], 0.3, wave), 0.002)] {
        let corners: Vec<usize> = [[0.0, 0.0], [95.0, 30.0], [-30.0, 95.0], [66.0, 125.0]]
            .iter()
            .flat_map(|[x, y]| nearest(&points, *x, *y, 1))
            .collect();
        let middle = (0..40).map(|k| (k * 61 + 5) % points.len());
        let edge = nearest(&points, 50.0, 0.0, 3);
        for k in middle.chain(corners).chain(edge) {
            assert_eq!(found(&off(&points, &[k])), vec![k], "{}", points[k]);
        }
    }
}

#[test]
fn outliers_next_to_each_other_are_found_together() {
    let check = |points: &[Point3<f64>], [x, y]: [f64; 2], most: usize| {
        for n in 2..=most {
            let wrong = nearest(points, x, y, n);
            assert_eq!(found(&off(points, &wrong)), wrong, "{n} near {x}, {y}");
        }
    };
    let rows = noise(grid([50, 50], 0.0, wave), 0.002);
    [[50.0, 50.0], [100.0, 43.0]].into_iter().for_each(|at| check(&rows, at, 4));
    let random = noise(scattered(2500, wave), 0.002);
    check(&random, [50.0, 50.0], 4);
    [[100.0, 43.0], [30.0, 0.0]].into_iter().for_each(|at| check(&random, at, 3));
    // Few of the other points are beside a corner.
    [[0.0, 0.0], [100.0, 100.0]].into_iter().for_each(|at| check(&rows, at, 2));
    check(&random, [100.0, 100.0], 2);
}

#[test]
fn noise_alone_makes_no_outliers_on_waves_fillets_creases_and_steps_of_curvature() {
    let fillet = |x: f64, _: f64| {
        // A slope of 45 degrees, rounded with a radius of 8 mm into a plane.
        let (r, end) = (8.0, 50.0 + 8.0 * (0.5f64).sqrt());
        if x < 50.0 {
            0.0
        } else if x < end {
            r - (r * r - (x - 50.0) * (x - 50.0)).sqrt()
        } else {
            r - r * (0.5f64).sqrt() + (x - end)
        }
    };
    let crease = |x: f64, y: f64| 0.3 * (x - 0.4 * y - 31.0).abs();
    let bent = |x: f64, y: f64| if x > 42.0 { (x - 42.0).powi(2) / 40.0 + wave(y, x) } else { wave(y, x) };
    let shapes: [&dyn Fn(f64, f64) -> f64; 4] = [&wave, &fillet, &crease, &bent];
    for (k, shape) in shapes.into_iter().enumerate() {
        for points in [scattered(4900, shape), grid([70, 70], 0.2, shape)] {
            let points = noise(points, 0.002);
            let fit = PointFit { points, error: Error::Max(0.01), outliers: OutlierChoice::LeaveOut };
            assert_eq!(fit.outlier_indices(), Vec::<usize>::new(), "shape {k}");
        }
    }
}

#[test]
fn noise_that_varies_over_the_part_makes_no_outliers_and_hides_none_where_it_is_small() {
    let mut numbers = Numbers::new(5);
    let mut points = scattered(4000, wave);
    for p in &mut points {
        p.z += numbers.normal() * if p.x > 50.0 { 0.02 } else { 0.002 };
    }
    let fit = |points: &[Point3<f64>]| PointFit {
        points: points.to_vec(),
        error: Error::Max(0.01),
        outliers: OutlierChoice::LeaveOut,
    };
    assert_eq!(fit(&points).outlier_indices(), Vec::<usize>::new());
    let quiet = nearest(&points, 20.0, 50.0, 1);
    assert_eq!(fit(&off(&points, &quiet)).outlier_indices(), quiet);
}

#[test]
fn left_out_outliers_are_listed_and_do_not_move_the_surface() {
    let points = noise(scattered(2500, wave), 0.002);
    let wrong = [3, 700, 1801];
    let leave_out = |points: &[Point3<f64>]| -> Fitted {
        let fit = PointFit { outliers: OutlierChoice::LeaveOut, ..fit_of(points, Error::Rms(0.002)) };
        fit.fitted(&Budget::unlimited()).unwrap()
    };
    let fitted_to = leave_out(&off(&points, &wrong));
    assert_eq!(fitted_to.left_out.iter().map(|one| one.index).collect::<Vec<_>>(), wrong);
    for one in &fitted_to.left_out {
        assert!((one.off_mm - 0.2).abs() < 0.02, "{one:?}");
    }
    let rest: Vec<Point3<f64>> = (0..2500).filter(|k| !wrong.contains(k)).map(|k| points[k]).collect();
    assert_eq!(fitted_to.nurbs, fitted(&rest, Error::Rms(0.002)).nurbs);
    // Kept, they are followed, or the bound is not met.
    let keep = PointFit { outliers: OutlierChoice::Keep, ..fit_of(&off(&points, &wrong), WITHIN) };
    if let Ok(kept) = keep.fitted(&Budget::unlimited()) {
        assert!(kept.max_mm <= 0.02 && kept.left_out.is_empty());
    }
}
