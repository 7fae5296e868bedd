use std::f64::consts::PI;

use super::*;
use crate::budget::Budget;
use crate::geometry::bernstein::derived;
use crate::geometry::profile::drawn::{chain, polyline, quarter, smooth};
use crate::geometry::surface::{Jet, Surface, joints};

/// Tests of basic curves that leave the plane.
mod in_space;

fn sweep(basic: &Profile<2>, drive: &Profile<2>) -> NormalSweep {
    NormalSweep { basic: basic.mapped(|p| Point3::new(p.x, p.y, 0.0)), drive: drive.clone() }
}

fn swept(basic: &Profile<2>, drive: &Profile<2>) -> AnySurface {
    sweep(basic, drive).surface().unwrap()
}

/// Jets at places all over the surface.
fn jets(surface: &AnySurface) -> Vec<Jet> {
    let [nu, nv] = surface.spans().map(|n| n as f64);
    (0..=400).map(|k| surface.jet(nu * f64::from(k % 21) / 20.0, nv * f64::from(k / 21) / 19.0)).collect()
}

/// A line, a quarter circle of radius 10 to the left about (0, 10), and a line.
fn bend() -> Profile<2> {
    let line = |from: [f64; 2], to: [f64; 2]| Shape::Line([from.into(), to.into()]);
    chain([
        line([-30.0, 0.0], [0.0, 0.0]),
        quarter([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0]]),
        line([10.0, 10.0], [10.0, 30.0]),
    ])
}

/// A line that rises 5 mm and goes `left` mm to the left.
fn rib(left: f64) -> Profile<2> {
    polyline([[0.0, 0.0], [left, 5.0]])
}

#[test]
fn an_arc_along_an_arc_is_a_torus_and_along_a_line_a_cylinder() {
    // A quarter circle of radius 3 about (-4, 2), which is 14 mm from the centre of the bend.
    let drive = chain([quarter([[-4.0, 5.0], [-1.0, 5.0], [-1.0, 2.0]])]);
    let sweep = sweep(&bend(), &drive);
    let surface = sweep.surface().unwrap();
    assert_eq!((surface.spans(), sweep.loose_joints()), ([3, 1], [vec![], vec![]]));
    for k in 0..=440 {
        let (u, v) = (f64::from(k % 21) / 20.0, f64::from(k / 21) / 20.0);
        let p = surface.jet(1.0 + u, v).point;
        let ring = p.x.hypot(p.y - 10.0) - 14.0;
        assert!((ring.hypot(p.z - 2.0) - 3.0).abs() < 1e-13, "{p}");
        let p = surface.jet(u, v).point;
        assert!(((p.y + 4.0).hypot(p.z - 2.0) - 3.0).abs() < 1e-13 && p.x <= 0.0, "{p}");
    }
    // The surface is smooth where the arc touches its lines.
    let AnySurface::Rational(surface) = &surface else { panic!("{surface:?}") };
    let joints = joints::examine(surface, &[vec![1, 2], vec![]], &Budget::unlimited()).unwrap();
    assert!(joints.gap_mm < 1e-13 && joints.kink < 1e-13, "{joints:?}");
}

#[test]
fn corners_of_a_closed_polyline_are_mitred() {
    let square = polyline([[0.0, 0.0], [20.0, 0.0], [20.0, 20.0], [0.0, 20.0], [0.0, 0.0]]);
    let sweep_of = |left: f64| sweep(&square, &rib(left));
    assert_eq!(sweep_of(4.0).loose_joints(), [vec![1, 2, 3], vec![]]);
    let frustum = sweep_of(4.0).surface().unwrap();
    let corners = [[4.0, 4.0], [16.0, 4.0], [16.0, 16.0], [4.0, 16.0], [4.0, 4.0]];
    for (i, [x, y]) in corners.into_iter().enumerate() {
        let found = frustum.jet(i as f64, 1.0).point;
        assert!((found - Point3::new(x, y, 5.0)).norm() < 1e-14, "{found}");
    }
    // Each side is a plane that rises 5 mm over 4 mm.
    let p = frustum.jet(0.3, 0.7).point;
    assert!((p.y - 0.8 * p.z).abs() < 1e-14);
    // Corners on the outside are sharp, too.
    assert!((swept(&square, &rib(-4.0)).jet(1.0, 1.0).point - Point3::new(24.0, -4.0, 5.0)).norm() < 1e-14);
    // A reach of 10 mm lets the sides meet in one point; a longer reach is refused.
    let apex = sweep_of(10.0).surface().unwrap().jet(2.5, 1.0).point;
    assert!((apex - Point3::new(10.0, 10.0, 5.0)).norm() < 1e-13);
    let error = sweep_of(10.1).surface().unwrap_err();
    let NormalSweepError::Mitre { side: Side::Left, room_mm, .. } = error else { panic!("{error}") };
    assert!((room_mm - 10.0).abs() < 1e-12);
}

#[test]
fn a_drive_curve_that_reaches_beyond_a_centre_is_refused() {
    assert!(sweep(&bend(), &rib(10.0)).surface().is_ok());
    assert!(sweep(&bend(), &rib(-500.0)).surface().is_ok());
    let error = sweep(&bend(), &rib(10.001)).surface().unwrap_err();
    let NormalSweepError::Fold { place: 1, side: Side::Left, reach_mm, radius_mm } = error else {
        panic!("{error}")
    };
    assert!(reach_mm == 10.001 && (radius_mm - 10.0).abs() < 1e-12, "{error}");
    let right = bend().mapped(|p| Point2::new(p.x, -p.y));
    let error = sweep(&right, &rib(-12.0)).surface().unwrap_err();
    assert!(matches!(error, NormalSweepError::Fold { place: 1, side: Side::Right, .. }), "{error}");
    // Points of the arc count, not its control points: the first arc reaches 11 mm to the left, the next 10.
    let drive = chain([quarter([[4.0, 9.0], [11.0, 9.0], [11.0, 2.0]])]);
    assert!(sweep(&bend(), &drive).surface().is_err());
    let h = 10.0 * 0.5f64.sqrt();
    let drive = chain([quarter([[h, -h], [2.0 * h, 0.0], [h, h]])]);
    assert!(sweep(&bend(), &drive).surface().is_ok());
}

#[test]
fn corners_that_cannot_be_mitred_are_refused() {
    let line = |from: [f64; 2], to: [f64; 2]| Shape::Line([from.into(), to.into()]);
    let beside = chain([line([-30.0, 5.0], [0.0, 0.0]), quarter([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0]])]);
    let error = sweep(&beside, &rib(1.0)).surface().unwrap_err();
    let NormalSweepError::Corner { place: 0, turn_deg } = error else { panic!("{error}") };
    assert!((turn_deg - (1.0f64 / 6.0).atan().to_degrees()).abs() < 1e-12);
    // A vertical wall reaches to no side, so its corner needs no mitre.
    assert!(sweep(&beside, &rib(0.0)).surface().is_ok());
    let back = polyline([[0.0, 0.0], [20.0, 0.0], [0.0, 0.1]]);
    let error = sweep(&back, &rib(1.0)).surface().unwrap_err();
    assert!(matches!(error, NormalSweepError::Reversal { place: 0, .. }), "{error}");
    assert_eq!(sweep(&Profile::default(), &rib(1.0)).surface(), Err(NormalSweepError::Empty));
    assert_eq!(sweep(&bend(), &Profile::default()).surface(), Err(NormalSweepError::Empty));
}

#[test]
fn along_a_smooth_curve_the_surface_is_within_the_tolerance() {
    let basic = smooth(&[[0.0, 0.0], [20.0, 8.0], [40.0, -5.0], [70.0, 3.0]]);
    for left in [0.0, 2.0, -7.0] {
        let drive = rib(left);
        let parts = |piece: &Piece<2>| match piece.shape {
            Shape::Cubic(points) => {
                unit_normal::parts(points.map(|p| Point3::new(p.x, p.y, 0.0)), drive.range(0), 1000).unwrap()
            }
            ref other => panic!("{other:?}"),
        };
        let parts: Vec<_> = basic.pieces().iter().flat_map(parts).collect();
        assert!(parts.len() < 300, "{}", parts.len());
        let mut worst: f64 = 0.0;
        for part in &parts {
            let d = derived(&part.points.map(|p| p.coords.xy()));
            let normal = Shape::Cubic(part.normals.map(Point2::from));
            for k in 0..=50 {
                let t = f64::from(k) / 50.0;
                let s = 1.0 - t;
                let along = d[0] * (s * s) + d[1] * (2.0 * s * t) + d[2] * (t * t);
                let exact = Vector2::new(-along.y, along.x).normalize();
                worst = worst.max((normal.point(t).coords - exact).norm() * left.abs());
            }
        }
        assert!(worst <= TOLERANCE_MM, "{left}: {worst:e}");
    }
    let sweep = sweep(&basic, &chain([quarter([[2.0, 0.0], [2.0, 3.0], [-1.0, 3.0]])]));
    let surface = sweep.surface().unwrap();
    assert_eq!(sweep.loose_joints(), [const { Vec::<usize>::new() }; 2]);
    let AnySurface::Rational(surface) = &surface else { panic!("{surface:?}") };
    let all = (1..surface.spans()[0]).collect();
    let joints = joints::examine(surface, &[all, vec![]], &Budget::unlimited()).unwrap();
    assert!(joints.gap_mm < 1e-12 && joints.kink < 1e-12, "{joints:?}");
}

#[test]
fn a_smooth_curve_folds_at_its_centres_and_has_no_normal_at_a_cusp() {
    let basic = smooth(&[[0.0, 0.0], [10.0, 10.0], [20.0, 0.0]]);
    // The tightest place is the top. The curvature there is y'' / x'^2, and the curve turns right.
    let Shape::Cubic(p) = basic.pieces()[0].shape else { panic!("a cubic") };
    let (speed, bend) = (3.0 * (p[3] - p[2]), 6.0 * ((p[3] - p[2]) - (p[2] - p[1])));
    let radius = speed.norm_squared() / bend.norm();
    assert!(sweep(&basic, &rib(-0.999 * radius)).surface().is_ok());
    assert!(sweep(&basic, &rib(40.0)).surface().is_ok());
    let error = sweep(&basic, &rib(-1.001 * radius)).surface().unwrap_err();
    let NormalSweepError::Fold { side: Side::Right, radius_mm, .. } = error else { panic!("{error}") };
    assert!((radius_mm / radius - 1.0).abs() < 1e-3);
    let cusp = chain([Shape::Cubic([[0.0, 0.0], [9.0, 9.0], [0.0, 9.0], [9.0, 0.0]].map(Point2::from))]);
    assert_eq!(sweep(&cusp, &rib(0.0)).surface(), Err(NormalSweepError::Cusp { place: 0 }));
}

#[test]
fn the_drive_curve_points_left_and_up() {
    let surface = swept(&bend(), &rib(2.0));
    assert!(jets(&surface).iter().all(|jet| jet.point.z >= 0.0));
    // At its end the bend runs along y, so left is -x.
    assert!((surface.jet(3.0, 1.0).point - Point3::new(8.0, 30.0, 5.0)).norm() < 1e-14);
    // The arc beside the curve has a radius of 10 - 2 = 8 mm.
    let arc: f64 = (0..1000)
        .map(|k| {
            let at = |k: i32| surface.jet(1.0 + f64::from(k) / 1000.0, 1.0).point;
            (at(k + 1) - at(k)).norm()
        })
        .sum();
    assert!((arc - 0.5 * PI * 8.0).abs() < 1e-5);
}
