//! Fits of points with errors: a noisy circle and a rounded sine. For these points the greedy method, which
//! makes each element as long as it can, does not find the fewest elements.

use std::f64::consts::TAU;

use nalgebra::Vector2;
use toolpathd_core::geometry::arc_fit::{Element, Fit, Joints, Method, Shape};

use super::inputs::{Random, polar};
use super::{fitted, judge};

const SEEDS: [u64; 5] = [1, 2, 3, 4, 5];

/// Points on one turn of radius 20 mm with radial errors of up to 2e-3 mm. The last point has the angle of
/// the first.
fn circle(seed: u64) -> Vec<Vector2<f64>> {
    let mut random = Random(seed);
    (0..400).map(|k| polar(20.0 + random.between(-2e-3, 2e-3), TAU * f64::from(k) / 399.0)).collect()
}

/// The numbers of elements with free joints, with joints on points, and by the greedy method with free
/// joints.
fn counts(points: &[Vector2<f64>], tolerance: f64) -> [usize; 3] {
    let free = Fit::within(tolerance);
    let on_points = Fit { joints: Joints::OnPoints, ..free };
    [free, on_points, Fit { method: Method::Greedy, ..free }]
        .map(|request| judge(points, &fitted(points, &request), tolerance).unwrap())
}

#[test]
fn a_noisy_circle_takes_two_or_three_elements_and_many_more_by_the_greedy_method() {
    for seed in SEEDS {
        let [free, on_points, greedy] = counts(&circle(seed), 3e-3);
        println!("circle {seed} within 3e-3: {free} free, {on_points} on points, {greedy} greedy");
        assert!(
            (2..=3).contains(&free) && (2..=3).contains(&on_points),
            "seed {seed}: {free} elements with free joints, {on_points} on points, not 2 or 3"
        );
        assert!((12..=20).contains(&greedy), "seed {seed}: {greedy} greedy elements, not 12 to 20");
    }
}

#[test]
fn a_noisy_circle_takes_at_most_three_elements_with_free_joints_just_above_the_noise() {
    for seed in SEEDS {
        let [free, on_points, greedy] = counts(&circle(seed), 2.2e-3);
        println!("circle {seed} within 2.2e-3: {free} free, {on_points} on points, {greedy} greedy");
        assert!(
            free <= 3 && free <= on_points,
            "seed {seed}: {free} elements with free joints, {on_points} on points"
        );
        assert!((32..=50).contains(&greedy), "seed {seed}: {greedy} greedy elements, not 32 to 50");
    }
}

#[test]
fn a_closed_noisy_circle_becomes_one_full_circle() {
    for seed in SEEDS {
        for turned in [1.0, -1.0] {
            let mut points: Vec<_> =
                circle(seed)[..399].iter().map(|p| Vector2::new(p.x, turned * p.y)).collect();
            points.push(points[0]);
            for tolerance in [2.2e-3, 3e-3] {
                let found = fitted(&points, &Fit { is_closed: true, ..Fit::within(tolerance) });
                let [Element { shape: Shape::FullCircle { center, is_ccw, .. }, .. }] = found.elements[..]
                else {
                    panic!("seed {seed}: not one full circle: {found:?}")
                };
                assert_eq!(judge(&points, &found, tolerance), Ok(1));
                assert_eq!(is_ccw, turned > 0.0);
                assert!(center.coords.norm() < 1e-3, "the centre {center} is not at the origin");
            }
        }
    }
}

#[test]
fn a_rounded_sine_takes_at_most_two_thirds_of_the_greedy_elements() {
    let points: Vec<_> = (0..400)
        .map(|k| TAU * f64::from(k) / 399.0)
        .map(|x| Vector2::new(x, x.sin()).map(|c| (c * 1e3).round() / 1e3))
        .collect();
    let [free, on_points, greedy] = counts(&points, 6e-4);
    println!("rounded sine within 6e-4: {free} free, {on_points} on points, {greedy} greedy");
    assert_eq!([on_points, greedy], [22, 36]);
    assert!(
        free <= on_points && on_points as f64 <= 0.65 * greedy as f64,
        "{free} elements with free joints, {on_points} on points, {greedy} greedy"
    );
}
