//! Tests of the derivatives: against central differences of the inverse, and by putting them into the forward
//! kinematics.

use std::f64::consts::FRAC_1_SQRT_2;

use super::*;
use crate::machine::series::Series;

/// A curve of poses with its first three derivatives: sums of sines.
fn curve(t: f64, amplitudes: &[[f64; 3]; 2], middle: Vector3<f64>) -> [Vector3<f64>; 4] {
    let [a, b] = amplitudes.map(Vector3::from);
    let ((s, c), (s2, c2)) = (t.sin_cos(), (2.0 * t).sin_cos());
    [middle + a * s + b * c2, a * c - b * 2.0 * s2, -a * s - b * 4.0 * c2, -a * c + b * 8.0 * s2]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn derivatives_agree_with_central_differences(
        machine in machine(), tips in prop::array::uniform2(vector(100.0)), axes in prop::array::uniform2(vector(0.3)),
        t in -3.0..3.0, branch in 0usize..2, rotary in prop::array::uniform2(-PI..PI), turns in -2i32..=2,
    ) {
        // The middle of the curve of axes is within reach, and is not of unit length.
        let middle = 2.0 * machine.forward(&AxisPositions { linear_mm: [0.0; 3], rotary }).axis.into_inner();
        let at = |t: f64| (curve(t, &tips, Vector3::zeros()), curve(t, &axes, middle));
        let (tip, axis) = at(t);
        let Inverse::Two(both) = machine.inverse(&pose(tip[0].into(), axis[0].into())) else {
            return Err(TestCaseError::reject("out of reach"));
        };
        let apart = turned(both[0].rotary[0], both[1].rotary[0]) + turned(both[0].rotary[1], both[1].rotary[1]);
        // Differences of third order are not usable where the solutions turn fast.
        prop_assume!(apart > 0.8);
        let mut near = both[branch];
        near.rotary[0] += TAU * f64::from(turns);
        let found = machine.derivatives(&tip, &axis, None, &near).unwrap();
        for k in 0..2 {
            prop_assert!((found[3 + k][0] - near.rotary[k]).abs() < 1e-12);
            prop_assert!((0..3).all(|k| (found[k][0] - near.linear_mm[k]).abs() < 1e-9));
        }
        // Each derivative is compared with the difference of the derivative of one order less.
        const STEP: f64 = 1e-4;
        let beside = [-2.0, -1.0, 1.0, 2.0].map(|k| {
            let (tip, axis) = at(t + k * STEP);
            machine.derivatives(&tip, &axis, None, &near)
        });
        let [Some(a), Some(b), Some(c), Some(d)] = beside else {
            return Err(TestCaseError::reject("out of reach"));
        };
        for k in 0..5 {
            let scale = found[k].iter().fold(1.0f64, |most, d| most.max(d.abs()));
            for order in 0..3 {
                let slope = (a[k][order] - 8.0 * b[k][order] + 8.0 * c[k][order] - d[k][order]) / (12.0 * STEP);
                let miss = (slope - found[k][order + 1]).abs();
                prop_assert!(miss < 1e-6 * scale, "axis {} order {}: {} {}", k, order + 1, slope, found[k][order + 1]);
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_derivatives_of_the_axes_make_those_of_the_path(
        machine in machine(), tips in prop::array::uniform2(vector(100.0)), axes in prop::array::uniform2(vector(0.3)),
        t in -3.0..3.0, branch in 0usize..2, rotary in prop::array::uniform2(-PI..PI),
    ) {
        let middle = 2.0 * machine.forward(&AxisPositions { linear_mm: [0.0; 3], rotary }).axis.into_inner();
        let (tip, axis) = (curve(t, &tips, Vector3::zeros()), curve(t, &axes, middle));
        let Inverse::Two(both) = machine.inverse(&pose(tip[0].into(), axis[0].into())) else {
            return Err(TestCaseError::reject("out of reach"));
        };
        let Some(found) = machine.derivatives(&tip, &axis, None, &both[branch]) else {
            return Err(TestCaseError::reject("the two solutions coincide"));
        };
        // The forward kinematics of the five series must be the series of the tip and of the unit axis.
        let [x, y, z, first, second] = found.map(Series::from_derivatives);
        let rotary = [first, second];
        let mut made_tip = add([x, y, z], machine.head_shift(rotary));
        let mut made_axis = constant(&Vector3::z());
        let heads = machine.kind().heads();
        for k in [1, 0].into_iter().filter(|&k| heads[k]) {
            made_axis = rotate(&machine.lines[k].direction, rotary[k], made_axis);
        }
        for k in [0, 1].into_iter().filter(|&k| !heads[k]) {
            made_tip = machine.lines[k].turn(-rotary[k], made_tip);
            made_axis = rotate(&machine.lines[k].direction, -rotary[k], made_axis);
        }
        let given = |of: &[Vector3<f64>; 4], k: usize| Series::from_derivatives(of.map(|v| v[k]));
        let wanted = [0, 1, 2].map(|k| given(&axis, k));
        let length = (wanted[0] * wanted[0] + wanted[1] * wanted[1] + wanted[2] * wanted[2]).sqrt();
        // Rounding grows with the speed of the axes, once for each order.
        let speed = found[3..].iter().map(|d| d[1].abs().max(d[2].abs().sqrt()).max(d[3].abs().cbrt()));
        let speed = speed.fold(1.0, f64::max);
        for k in 0..3 {
            let pairs = [(made_tip[k], given(&tip, k), 1000.0), (made_axis[k], wanted[k] / length, 1.0)];
            for (made, wanted, size) in pairs {
                for order in 0..4 {
                    let miss = (made.derivatives()[order] - wanted.derivatives()[order]).abs();
                    prop_assert!(miss < 1e-11 * size * speed.powi(order as i32), "{} {} {}", order, miss, speed);
                }
            }
        }
    }
}

#[test]
fn there_are_no_derivatives_at_the_pole_and_at_the_end_of_reach() {
    let still = |v: Vector3<f64>| [v, Vector3::x(), Vector3::y(), Vector3::z()];
    let near = AxisPositions { linear_mm: [0.0; 3], rotary: [0.0; 2] };
    for machine in named() {
        assert_eq!(machine.derivatives(&still(Vector3::x()), &still(Vector3::z()), None, &near), None);
        assert_eq!(machine.derivatives(&still(Vector3::x()), &still(Vector3::zeros()), None, &near), None);
        let too_long = still(Vector3::new(1e200, 0.0, 1e200));
        assert_eq!(machine.derivatives(&still(Vector3::x()), &too_long, None, &near), None);
        let nan = still(Vector3::repeat(f64::NAN));
        assert_eq!(machine.derivatives(&nan, &still(Vector3::new(0.1, 0.2, 1.0)), None, &near), None);
    }
    let nutating = by_name("table_table_nutating_bc").unwrap();
    let horizontal = still(Vector3::new(FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0));
    let found = nutating.derivatives(&still(Vector3::x()), &horizontal, None, &near);
    assert!(found.is_none_or(|all| all.iter().flatten().all(|d| d.is_finite())));
}

/// On a path straight through the pole, differences of positions beside it are near the derivatives on it.
#[test]
fn derivatives_on_the_pole_are_those_of_a_path_through_it() {
    for machine in named() {
        let at = |t: f64| {
            let tip = Point3::new(3.0 + t, 2.0 - t * t, 1.0);
            // The part across +Z is t times this.
            let across = Vector3::new(0.8 + 0.1 * t, 0.3 - 0.2 * t, 0.0);
            (tip, across * t + Vector3::z(), across)
        };
        if machine.poles().next().is_none_or(|pole| (pole.z - 1.0).abs() > 1e-12) {
            continue;
        }
        let (tip, axis, across) = at(0.0);
        let tips = [tip.coords, Vector3::x(), -2.0 * Vector3::y(), Vector3::zeros()];
        let axes = [axis, across, 2.0 * Vector3::new(0.1, -0.2, 0.0), Vector3::zeros()];
        let through = Through {
            across: [across, Vector3::new(0.1, -0.2, 0.0), Vector3::zeros(), Vector3::zeros()],
            way: 0.0,
        };
        let step = 1e-3;
        let beside = |t: f64, near: [f64; 2]| {
            let (tip, axis, _) = at(t);
            machine.nearest(&Pose { tip, axis: Unit::new_normalize(axis) }, near)
        };
        let before = beside(-step, [0.0; 2]);
        let found = machine.derivatives(&tips, &axes, Some(&through), &before).unwrap();
        let near = [found[3][0], found[4][0]];
        let of = |t: f64| {
            let found = beside(t, near);
            let [x, y, z] = found.linear_mm;
            [x, y, z, found.rotary[0], found.rotary[1]]
        };
        let (low, high) = (of(-step), of(step));
        for k in 0..5 {
            let value = 0.5 * (low[k] + high[k]);
            assert!((value - found[k][0]).abs() < 1e-4, "{}: axis {k}", machine.name());
            let slope = (high[k] - low[k]) / (2.0 * step);
            assert!((slope - found[k][1]).abs() < 1e-4, "{}: axis {k}: {slope} {found:?}", machine.name());
        }
    }
}
