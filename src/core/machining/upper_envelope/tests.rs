use nalgebra::{Vector3, Vector4};

use super::*;
use crate::geometry::surface::{BicubicPatch, RationalPatch, Surface};

const ACCURACY: Accuracy = Accuracy { height_mm: 1e-3, width_mm: 1e-4 };

fn stretches(surface: &BezierSurface<impl Patch>, y: f64) -> Vec<Stretch> {
    Profiles::new(surface).stretches(y, ACCURACY, &Budget::unlimited()).unwrap()
}

fn envelopes(stretches: &[Stretch]) -> Vec<UpperEnvelope> {
    union(stretches, ACCURACY.width_mm, &Budget::unlimited()).unwrap()
}

fn height(envelope: &UpperEnvelope, x: f64) -> f64 {
    let heights = envelope.windows(2).filter(|pair| pair[0].x <= x && x <= pair[1].x);
    let heights = heights.filter(|pair| pair[0].x < pair[1].x);
    heights.map(|p| Stretch { from: p[0], to: p[1] }.height(x)).fold(f64::NEG_INFINITY, f64::max)
}

/// A cylinder of `radius` mm about y with its arc from `from` to `from + sweep` radians over -x, 30 mm long;
/// u along the arc.
fn cylinder(radius: f64, from: f64, sweep: f64) -> BezierSurface<RationalPatch<4>> {
    let w = (0.5 * sweep).cos();
    let at = |angle: f64, reach: f64| (-reach * angle.cos(), reach * angle.sin());
    let corners = [(from, 1.0), (from + 0.5 * sweep, w), (from + sweep, 1.0)];
    BezierSurface::from_fn([1, 1], |_, _| {
        RationalPatch::from_fn([2, 1], |a, b| {
            let (angle, weight) = corners[a];
            let (x, z) = at(angle, radius / weight);
            Vector4::new(x * weight, 30.0 * b as f64 * weight, z * weight, weight)
        })
    })
}

fn bumps() -> BezierSurface {
    BezierSurface::from_fn([1, 1], |_, _| BicubicPatch {
        net: std::array::from_fn(|a| {
            std::array::from_fn(|b| {
                Vector3::new(
                    10.0 * a as f64 + 2.0 * b as f64,
                    10.0 * b as f64,
                    ((a * 7 + b * 5) % 4) as f64 * 9.0,
                )
            })
        }),
    })
}

#[test]
fn a_cylinder_has_the_circle_as_its_upper_envelope() {
    use std::f64::consts::PI;
    for y in [0.0, 11.0, 15.0, 30.0] {
        let envelopes = envelopes(&stretches(&cylinder(20.0, 0.1 * PI, 0.8 * PI), y));
        let [envelope] = &envelopes[..] else { panic!("{} envelopes", envelopes.len()) };
        let reach = 20.0 * (0.1 * PI).cos();
        assert!(
            (envelope[0].x + reach).abs() < 1e-8 && (envelope[envelope.len() - 1].x - reach).abs() < 1e-8
        );
        for k in 0..=1000 {
            let x = reach * (f64::from(k) / 500.0 - 1.0);
            let z = (400.0 - x * x).sqrt();
            assert!((height(envelope, x) - z).abs() <= ACCURACY.height_mm, "{y} {x}");
        }
    }
}

#[test]
fn the_highest_sheet_of_an_overhang_counts() {
    use std::f64::consts::PI;
    // Three quarters of a turn, from low on the left under the right; upright on both sides.
    let turn = cylinder(10.0, -0.25 * PI, 0.75 * PI).patch(0, 0).to_owned();
    let rest = cylinder(10.0, 0.5 * PI, 0.75 * PI).patch(0, 0).to_owned();
    let surface = BezierSurface::from_fn([2, 1], |i, _| if i == 0 { turn } else { rest });
    let envelopes = envelopes(&stretches(&surface, 7.0));
    let [envelope] = &envelopes[..] else { panic!("{} envelopes", envelopes.len()) };
    assert!((envelope[0].x + 10.0).abs() <= ACCURACY.width_mm, "{}", envelope[0]);
    for k in 1..1000 {
        let x = 10.0 * (f64::from(k) / 500.0 - 1.0);
        let near = |x: f64| (100.0 - x.clamp(-10.0, 10.0).powi(2)).sqrt();
        let least = near(x.abs() + ACCURACY.width_mm) - ACCURACY.height_mm;
        let most = near((x.abs() - ACCURACY.width_mm).max(0.0)) + ACCURACY.height_mm;
        let z = height(envelope, x);
        assert!(least <= z && z <= most, "{x} {z} {least} {most}");
    }
}

#[test]
fn skew_patches_have_the_heights_of_dense_points() {
    let surface = bumps();
    for y in [0.0, 3.0, 14.9, 29.0] {
        let stretches = stretches(&surface, y);
        let envelopes = envelopes(&stretches);
        let [envelope] = &envelopes[..] else { panic!("{} envelopes", envelopes.len()) };
        // y is linear in v, and x in u and v.
        let v = y / 30.0;
        for k in 1..500 {
            let point = surface.jet(f64::from(k) / 500.0, v).point;
            assert!((point.y - y).abs() < 1e-9);
            assert!((height(envelope, point.x) - point.z).abs() <= ACCURACY.height_mm, "{point}");
        }
    }
}

#[test]
fn a_union_changes_over_at_crossings_and_keeps_gaps() {
    let stretch = |a: [f64; 2], b: [f64; 2]| Stretch { from: Vector2::from(a), to: Vector2::from(b) };
    let found = envelopes(&[
        stretch([0.0, 0.0], [4.0, 4.0]),
        stretch([0.0, 3.0], [4.0, 1.0]),
        stretch([1.0, 5.0], [1.5, 5.0]),
        stretch([5.0, 0.0], [6.0, 0.0]),
    ]);
    let expected = vec![
        vec![[0.0, 3.0], [1.0, 2.5], [1.0, 5.0], [1.5, 5.0], [1.5, 2.25], [2.0, 2.0], [4.0, 4.0]],
        vec![[5.0, 0.0], [6.0, 0.0]],
    ];
    let found: Vec<Vec<[f64; 2]>> =
        found.into_iter().map(|envelope| envelope.into_iter().map(|p| [p.x, p.y]).collect()).collect();
    assert_eq!(found, expected);
}
