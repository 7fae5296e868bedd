//! Basic curves that leave the xy plane.

use nalgebra::{Point2, Point3};

use super::super::{NormalSweep, NormalSweepError, Side, TOLERANCE_MM};
use super::{jets, rib};
use crate::geometry::profile::drawn::{chain, polyline, quarter, smooth};
use crate::geometry::profile::{Profile, Shape};
use crate::geometry::surface::Surface;
use crate::geometry::surface::any_surface::AnySurface;
use crate::geometry::surface::parallel_sweep::ParallelSweep;

fn swept(basic: &Profile<3>, drive: &Profile<2>) -> Result<AnySurface, NormalSweepError> {
    NormalSweep { basic: basic.clone(), drive: drive.clone() }.surface()
}

/// A round drive curve that rises to the left.
fn round() -> Profile<2> {
    chain([quarter([[2.0, 0.0], [2.0, 3.0], [-1.0, 3.0]])])
}

#[test]
fn along_a_curve_in_an_upright_plane_it_is_a_parallel_sweep() {
    let s = 0.5f64.sqrt();
    // Up at 45 degrees, over an arc of radius 5, and down.
    let top = quarter([[20.0 - 5.0 * s, 0.0, 0.0], [20.0, 0.0, 5.0 * s], [20.0 + 5.0 * s, 0.0, 0.0]]);
    let ramp = Shape::Line([Point3::new(0.0, 0.0, 5.0 * s - 20.0), top.start()]);
    let wave = smooth(&[[0.0, 0.0, 0.0], [10.0, 0.0, 4.0], [20.0, 0.0, -1.0], [30.0, 0.0, 0.0]]);
    for basic in [polyline([[0.0, 0.0, 1.0], [30.0, 0.0, 11.0]]), chain([ramp, top]), wave] {
        for drive in [rib(4.0), round()] {
            let surface = swept(&basic, &drive).unwrap();
            let start = drive.start().unwrap();
            let lifted = basic.mapped(|p| Point3::new(p.x, p.y + start.x, p.z + start.y));
            let drive = drive.mapped(|p| Point3::new(0.0, p.x, p.y));
            let parallel = ParallelSweep { basic: lifted, drive }.surface().unwrap();
            assert_eq!(surface.spans(), parallel.spans());
            for (found, expected) in jets(&surface).iter().zip(jets(&parallel)) {
                assert!((found.point - expected.point).norm() < 1e-13, "{} {}", found.point, expected.point);
            }
        }
    }
}

#[test]
fn along_a_helix_it_is_a_helicoid() {
    // A half turn to the left on a radius of 10 mm that rises 3 mm a radian, as cubics in the angle.
    let (radius, rise, n) = (10.0, 3.0, 160);
    let step = std::f64::consts::PI / f64::from(n);
    let at = |a: f64| Point3::new(radius * a.cos(), radius * a.sin(), rise * a);
    let way = |a: f64| nalgebra::Vector3::new(-radius * a.sin(), radius * a.cos(), rise) * (step / 3.0);
    let helix = chain((0..n).map(|k| {
        let [a, b] = [f64::from(k) * step, f64::from(k + 1) * step];
        Shape::Cubic([at(a), at(a) + way(a), at(b) - way(b), at(b)])
    }));
    for left in [-6.0, 4.0] {
        let surface = swept(&helix, &rib(left)).unwrap();
        let [nu, _] = surface.spans();
        for k in 0..=400 {
            for v in [0.0, 0.3, 1.0] {
                let p = surface.jet(nu as f64 * f64::from(k) / 400.0, v).point;
                let r = p.x.hypot(p.y);
                assert!((r - (radius - left * v)).abs() < 2e-6, "{p}");
                let angle = p.y.atan2(p.x).rem_euclid(2.0 * std::f64::consts::PI - 1e-9);
                assert!((p.z - (rise * angle + 5.0 * v)).abs() < 2e-6, "{p}");
            }
        }
    }
}

#[test]
fn along_a_tilted_arc_the_normals_are_those_of_the_projection() {
    // A quarter circle of radius 10 about the origin, tilted by 30 degrees about the x axis.
    let (cos, sin) = (30f64.to_radians().cos(), 0.5);
    let tilted = |x: f64, y: f64| [x, y * cos, y * sin];
    let basic = chain([quarter([tilted(10.0, 0.0), tilted(10.0, 10.0), tilted(0.0, 10.0)])]);
    for left in [3.0, -8.0] {
        let surface = swept(&basic, &rib(left)).unwrap();
        let [nu, _] = surface.spans();
        assert!(nu < 200, "{nu}");
        for k in 0..=300 {
            let u = nu as f64 * f64::from(k) / 300.0;
            let [foot, top] = [0.0, 1.0].map(|v| surface.jet(u, v).point);
            // The foot lies on the circle. In plan that is an ellipse with the half axes 10 and 10 cos.
            assert!(
                (foot.coords.norm() - 10.0).abs() < TOLERANCE_MM
                    && (foot.z - foot.y * sin / cos).abs() < 1e-9
            );
            let inward = -nalgebra::Vector2::new(foot.x, foot.y / (cos * cos)).normalize();
            let expected = Point2::from(foot.xy().coords + inward * left);
            assert!((top.xy() - expected).norm() < 2.0 * TOLERANCE_MM, "{top} {expected}");
            assert!((top.z - foot.z - 5.0).abs() < 1e-12);
        }
    }
}

#[test]
fn corners_are_mitred_at_the_height_of_the_curve() {
    // Up 6 mm along x, then 2 mm down along y.
    let basic = polyline([[0.0, 0.0, 0.0], [20.0, 0.0, 6.0], [20.0, 30.0, 4.0]]);
    let surface = swept(&basic, &rib(4.0)).unwrap();
    for (u, corner) in [(0.0, [0.0, 4.0, 5.0]), (1.0, [16.0, 4.0, 11.0]), (2.0, [16.0, 30.0, 9.0])] {
        let found = surface.jet(u, 1.0).point;
        assert!((found - Point3::from(corner)).norm() < 1e-13, "{found}");
    }
    let error = swept(&basic, &rib(20.5)).unwrap_err();
    assert!(matches!(error, NormalSweepError::Mitre { side: Side::Left, .. }), "{error}");
}

#[test]
fn a_curve_that_runs_upright_is_refused() {
    let up = polyline([[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [10.0, 0.0, 5.0], [20.0, 0.0, 5.0]]);
    assert_eq!(swept(&up, &rib(1.0)), Err(NormalSweepError::Upright { place: 1 }));
    // Forth and back in plan.
    let back = smooth(&[[0.0, 0.0, 0.0], [10.0, 0.0, 4.0], [0.0, 0.0, 8.0]]);
    let error = swept(&back, &rib(1.0)).unwrap_err();
    assert!(matches!(error, NormalSweepError::Reversal { .. } | NormalSweepError::Upright { .. }), "{error}");
}
