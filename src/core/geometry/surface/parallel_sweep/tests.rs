use nalgebra::Point3;

use super::*;
use crate::geometry::profile::Shape;
use crate::geometry::profile::drawn::{chain, polyline, quarter, smooth};
use crate::geometry::surface::{Patch, Surface};

fn swept(basic: &Profile<3>, drive: &Profile<3>) -> AnySurface {
    ParallelSweep { basic: basic.clone(), drive: drive.clone() }.surface().unwrap()
}

/// A quarter circle of radius 20 about the y axis, from its top.
fn crown() -> Profile<3> {
    chain([quarter([[0.0, 0.0, 20.0], [20.0, 0.0, 20.0], [20.0, 0.0, 0.0]])])
}

#[test]
fn an_arc_along_a_line_is_a_cylinder() {
    // The place of the drive curve does not affect the surface.
    let surface = swept(&crown(), &polyline([[7.0, 8.0, 9.0], [7.0, 38.0, 9.0]]));
    assert!(matches!(surface, AnySurface::Rational(_)));
    assert_eq!(surface.spans(), [1, 1]);
    for k in 0..=400 {
        let (u, v) = (f64::from(k % 21) / 20.0, f64::from(k / 21) / 19.0);
        let Point3 { coords: p } = surface.jet(u, v).point;
        assert!((p.x.hypot(p.z) - 20.0).abs() < 1e-13, "{p}");
        assert!((p.y - 30.0 * v).abs() < 1e-13);
    }
}

#[test]
fn lines_along_a_line_are_planes_with_an_edge() {
    let basic = polyline([[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [20.0, 0.0, 5.0]]);
    let drive = polyline([[0.0, 0.0, 0.0], [0.0, 30.0, 0.0]]);
    let sweep = ParallelSweep { basic, drive };
    let surface = sweep.surface().unwrap();
    assert!(matches!(surface, AnySurface::Bicubic(_)));
    assert_eq!((surface.spans(), sweep.loose_joints()), ([2, 1], [vec![1], vec![]]));
    assert!((surface.jet(1.5, 0.5).point - Point3::new(15.0, 15.0, 2.5)).norm() < 1e-14);
}

#[test]
fn a_point_of_the_sweep_is_the_sum_of_points_of_both_curves() {
    let basic = smooth(&[[1.0, 2.0, 3.0], [10.0, 0.0, 5.0], [25.0, 1.0, 0.0]]);
    let drive = chain([
        Shape::Line([Point3::new(0.0, -5.0, 1.0), Point3::new(0.0, 0.0, 1.0)]),
        quarter([[0.0, 0.0, 1.0], [0.0, 4.0, 1.0], [0.0, 4.0, 5.0]]),
    ]);
    let surface = swept(&basic, &drive);
    assert_eq!(surface.spans(), [2, 2]);
    for k in 0..100 {
        let (u, v) = (f64::from(k % 10) / 9.0, f64::from(k / 10) / 9.0);
        for (i, along) in basic.pieces().iter().enumerate() {
            for (j, across) in drive.pieces().iter().enumerate() {
                let expected = along.shape.point(u) + (across.shape.point(v) - drive.start().unwrap());
                let patch = match &surface {
                    AnySurface::Rational(surface) => surface.patch(i, j),
                    other => panic!("{other:?}"),
                };
                let found = patch.jet(u, v).point;
                assert!((found - expected).norm() < 1e-13, "{i} {j} {u} {v}");
            }
        }
    }
}

#[test]
fn empty_curves_and_too_many_pairs_are_refused() {
    let drive = polyline([[0.0, 0.0, 0.0], [0.0, 30.0, 0.0]]);
    let empty = ParallelSweep { basic: Profile::default(), drive: drive.clone() };
    assert_eq!(empty.surface(), Err(ParallelSweepError::Empty));
    let points = |axis: usize| -> Vec<[f64; 3]> {
        let point = |k: i32| std::array::from_fn(|c| if c == axis { f64::from(k) } else { 0.0 });
        (0..=400).map(point).collect()
    };
    let many = ParallelSweep { basic: polyline(points(0)), drive: polyline(points(1)) };
    assert_eq!(many.surface(), Err(ParallelSweepError::TooManyPatches { patches: 160_000 }));
}
