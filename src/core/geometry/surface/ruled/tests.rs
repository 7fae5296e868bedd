use nalgebra::Point3;

use super::*;
use crate::budget::Budget;
use crate::geometry::profile::Shape;
use crate::geometry::profile::drawn::{chain, polyline, quarter, smooth};
use crate::geometry::surface::{Surface, joints};

fn ruled(first: &Profile<3>, second: &Profile<3>) -> Ruled {
    Ruled { first: first.clone(), second: second.clone() }
}

/// A quarter circle of this radius about the z axis, at the height z.
fn ring(radius: f64, z: f64) -> Profile<3> {
    chain([quarter([[radius, 0.0, z], [radius, radius, z], [0.0, radius, z]])])
}

/// The largest distance from `exact(fraction)` along the curve of constant v of a surface whose patches cover
/// equal lengths.
fn deviation(surface: &AnySurface, v: f64, exact: impl Fn(f64) -> Point3<f64>) -> f64 {
    let n = surface.spans()[0];
    let places = (0..=20 * n).map(|k| k as f64 / 20.0);
    places.map(|u| (surface.jet(u, v).point - exact(u / n as f64)).norm()).fold(0.0, f64::max)
}

/// The largest edge and the largest gap between neighbouring patches.
fn joints(surface: &AnySurface) -> joints::Joints {
    let all = [(1..surface.spans()[0]).collect(), vec![]];
    match surface {
        AnySurface::Bicubic(surface) => joints::examine(surface, &all, &Budget::unlimited()),
        AnySurface::Rational(surface) => joints::examine(surface, &all, &Budget::unlimited()),
        AnySurface::HighDegree(surface) => joints::examine(surface, &all, &Budget::unlimited()),
    }
    .unwrap()
}

#[test]
fn rings_make_a_cone() {
    let surface = ruled(&ring(20.0, 0.0), &ring(10.0, 15.0)).surface().unwrap();
    assert_eq!(surface.spans(), [1, 1]);
    for k in 0..=440 {
        let (u, v) = (f64::from(k % 21) / 20.0, f64::from(k / 21) / 20.0);
        let p = surface.jet(u, v).point;
        assert!((p.x.hypot(p.y) - (20.0 - 10.0 * v)).abs() < 1e-13 && (p.z - 15.0 * v).abs() < 1e-13);
        // Rulings run straight to the apex: they keep their direction in the plan.
        let foot = surface.jet(u, 0.0).point;
        assert!((p.x * foot.y - p.y * foot.x).abs() < 1e-11);
    }
}

#[test]
fn lines_are_joined_at_equal_fractions() {
    // The first curve has its corner at 1/4 of its length, the second at 1/2.
    let first = polyline([[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [10.0, 30.0, 0.0]]);
    let second = polyline([[0.0, 0.0, 9.0], [6.0, 0.0, 9.0], [6.0, 6.0, 9.0]]);
    let ruled = ruled(&first, &second);
    let surface = ruled.surface().unwrap();
    assert!(matches!(surface, AnySurface::Bicubic(_)));
    assert_eq!((surface.spans(), ruled.loose_joints()), ([3, 1], [vec![1, 2], vec![]]));
    for (u, v, p) in [(1.0, 0.0, [10.0, 0.0, 0.0]), (1.0, 1.0, [3.0, 0.0, 9.0]), (2.0, 0.5, [8.0, 5.0, 4.5])]
    {
        assert!((surface.jet(u, v).point - Point3::from(p)).norm() < 1e-14, "{u} {v}");
    }
    // A joint at the same fraction of both curves becomes a single joint.
    let same = Ruled { second: first.mapped(|p| Point3::new(p.x, p.y, 5.0)), first };
    assert_eq!((same.surface().unwrap().spans(), same.loose_joints()), ([2, 1], [vec![1], vec![]]));
}

#[test]
fn an_arc_and_a_line_are_joined_within_the_tolerance() {
    let line = polyline([[20.0, 0.0, 10.0], [0.0, 20.0, 10.0]]);
    let surface = ruled(&ring(20.0, 0.0), &line).surface().unwrap();
    let on_ring = |f: f64| {
        let (sin, cos) = (f * std::f64::consts::FRAC_PI_2).sin_cos();
        Point3::new(20.0 * cos, 20.0 * sin, 0.0)
    };
    let worst = deviation(&surface, 0.0, on_ring);
    assert!(worst <= TOLERANCE_MM && worst > 0.01 * TOLERANCE_MM, "{worst:e}");
    assert!(deviation(&surface, 1.0, |f| Point3::new(20.0 - 20.0 * f, 20.0 * f, 10.0)) < 1e-12);
    assert_eq!(surface.spans(), [32, 1]);
    let joints = joints(&surface);
    assert!(joints.gap_mm < 1e-12 && joints.kink < 1e-12, "{joints:?}");
}

#[test]
fn a_smooth_curve_is_divided_by_its_length() {
    let first = smooth(&[[0.0, 0.0, 0.0], [10.0, 12.0, 3.0]]);
    assert_eq!(
        ruled(&first, &polyline([[0.0, 0.0, 9.0], [9.0, 0.0, 9.0]])).loose_joints(),
        [const { Vec::<usize>::new() }; 2]
    );
    // A cubic of uneven speed, compared with a table of its lengths.
    let points = [[0.0, 0.0, 0.0], [5.0, 15.0, 0.0], [25.0, -8.0, 4.0], [40.0, 10.0, 6.0]].map(Point3::from);
    let cubic = Shape::Cubic(points);
    let n = 200_000;
    let mut table = vec![0.0];
    for k in 0..n {
        let at = |k: usize| cubic.point(k as f64 / n as f64);
        table.push(table[k] + (at(k + 1) - at(k)).norm());
    }
    let at_fraction = |f: f64| {
        let wanted = f * table[n];
        let k = table.partition_point(|length| *length < wanted).clamp(1, n);
        let share = (wanted - table[k - 1]) / (table[k] - table[k - 1]);
        cubic.point((k as f64 - 1.0 + share) / n as f64)
    };
    let surface = ruled(&chain([cubic]), &polyline([[0.0, 0.0, 20.0], [40.0, 0.0, 20.0]])).surface().unwrap();
    let n = surface.spans()[0];
    assert!(n < 600, "{n}");
    // The other curve is a line, so its points tell the fraction at u.
    let mut worst: f64 = 0.0;
    for k in 0..=10 * n {
        let u = k as f64 / 10.0;
        let fraction = surface.jet(u, 1.0).point.x / 40.0;
        worst = worst.max((surface.jet(u, 0.0).point - at_fraction(fraction)).norm());
    }
    assert!(worst <= TOLERANCE_MM + 1e-8, "{worst:e}");
    let joints = joints(&surface);
    assert!(joints.gap_mm < 1e-12 && joints.kink < 1e-10, "{joints:?}");
}

#[test]
fn rounded_outlines_of_different_size_are_joined() {
    let outline = |size: f64, radius: f64, z: f64| {
        let line = |from: [f64; 3], to: [f64; 3]| Shape::Line([from.into(), to.into()]);
        let end = size - radius;
        chain([
            line([0.0, 0.0, z], [end, 0.0, z]),
            quarter([[end, 0.0, z], [size, 0.0, z], [size, radius, z]]),
            line([size, radius, z], [size, size, z]),
        ])
    };
    let ruled = ruled(&outline(50.0, 10.0, 0.0), &outline(40.0, 12.0, 25.0));
    let surface = ruled.surface().unwrap();
    assert_eq!(ruled.loose_joints(), [const { Vec::<usize>::new() }; 2]);
    let joints = joints(&surface);
    assert!(joints.gap_mm < 1e-12 && joints.kink < 1e-10, "{joints:?}");
}

#[test]
fn empty_curves_and_cusps_are_refused() {
    let line = polyline([[0.0, 0.0, 0.0], [10.0, 0.0, 0.0]]);
    assert_eq!(ruled(&Profile::default(), &line).surface(), Err(RuledError::Empty));
    assert_eq!(ruled(&line, &Profile::default()).surface(), Err(RuledError::Empty));
    let points = [[0.0, 0.0, 0.0], [9.0, 9.0, 0.0], [0.0, 9.0, 0.0], [9.0, 0.0, 0.0]];
    let cusp = chain([Shape::Cubic(points.map(Point3::from))]);
    assert_eq!(ruled(&line, &cusp).surface(), Err(RuledError::Cusp { curve: 1, place: 0 }));
    // A curve joined with itself is accepted; its surface has no normal.
    assert!(ruled(&line, &line).surface().is_ok());
}
