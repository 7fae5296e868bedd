use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{Isometry3, Rotation3, Translation3, Unit};
use proptest::prelude::*;

use super::named::{by_name, named};
use super::*;

mod derivatives;

/// What the inverse promises: mm, and distance of unit vectors.
const PROMISED: f64 = 1e-10;

fn pose(tip: [f64; 3], axis: [f64; 3]) -> Pose {
    Pose { tip: Point3::from(tip), axis: UnitVector3::new_normalize(Vector3::from(axis)) }
}

/// The distance of two poses: of their tips in mm, of their axes as unit vectors.
fn distance(a: &Pose, b: &Pose) -> f64 {
    (a.tip - b.tip).norm().max((a.axis.into_inner() - b.axis.into_inner()).norm())
}

/// The difference of two angles, within half a turn.
fn turned(a: f64, b: f64) -> f64 {
    ((a - b + PI).rem_euclid(TAU) - PI).abs()
}

fn solutions(machine: &Machine, pose: &Pose) -> Vec<AxisPositions> {
    match machine.inverse(pose) {
        Inverse::Two(both) => both.to_vec(),
        Inverse::Pole { fixed } => [-3.0, 0.0, 1.0]
            .map(|angle| {
                let rotary = if machine.free_axis() == 0 { [angle, fixed] } else { [fixed, angle] };
                machine.at(&pose.tip, rotary)
            })
            .to_vec(),
        Inverse::Unreachable => Vec::new(),
    }
}

fn axis(name: char, direction: [f64; 3], point: [f64; 3], is_mirrored: bool) -> RotaryAxis {
    RotaryAxis {
        name,
        direction: UnitVector3::new_normalize(Vector3::from(direction)),
        point_mm: Point3::from(point),
        travel: None,
        is_wrapped: false,
        is_mirrored,
    }
}

fn vector(size: f64) -> impl Strategy<Value = [f64; 3]> {
    prop::array::uniform3(-size..size)
}

fn direction() -> impl Strategy<Value = [f64; 3]> {
    vector(1.0).prop_filter("long enough", |v| (0.1..1.0).contains(&Vector3::from(*v).norm()))
}

fn kind() -> impl Strategy<Value = Kind> {
    prop::sample::select(vec![Kind::TableTable, Kind::HeadTable, Kind::HeadHead])
}

/// Named machines and machines with random axes, offsets and signs.
fn machine() -> impl Strategy<Value = Machine> {
    let any_axis = || (direction(), vector(200.0), any::<bool>());
    let random =
        (kind(), any_axis(), any_axis(), 0.0..300.0).prop_filter_map("parallel", |(kind, a, b, pivot)| {
            let rotary = [axis_of('A', a), axis_of('C', b)];
            let pivot = if kind == Kind::TableTable { 0.0 } else { pivot };
            Machine::new("random", kind, rotary, [None; 3], pivot).ok()
        });
    // Axes at little more than the least angle to each other and to the tool.
    let narrow = (kind(), 0.0..TAU, 0.0..TAU, 0.1002..0.3, 0.1002..0.3).prop_filter_map(
        "parallel",
        |(kind, about, around, tilt, apart): (Kind, f64, f64, f64, f64)| {
            let to_tool = Vector3::new(tilt * about.cos(), tilt * about.sin(), 1.0);
            let to_work = to_tool + apart * Vector3::new(around.cos(), around.sin(), 0.0);
            let pair =
                [axis('A', to_tool.into(), [0.0; 3], false), axis('C', to_work.into(), [0.0; 3], false)];
            let rotary = if kind == Kind::HeadHead { [pair[1], pair[0]] } else { pair };
            Machine::new("narrow", kind, rotary, [None; 3], 0.0).ok()
        },
    );
    prop_oneof![2 => prop::sample::select(named()), 2 => random, 1 => narrow]
}

fn axis_of(name: char, (direction, point, is_mirrored): ([f64; 3], [f64; 3], bool)) -> RotaryAxis {
    axis(name, direction, point, is_mirrored)
}

/// A tool axis for which the two solutions coincide: before the turn of the axis next to the workpiece, it
/// lies in the plane of both rotary axes.
fn end_of_reach(machine: &Machine, turn: f64, is_opposite: bool) -> Vector3<f64> {
    let free = machine.free_axis();
    let [p, q] = [1 - free, free].map(|k| machine.rotary()[k].direction.into_inner());
    let side = (q - p * p.dot(&q)).normalize() * if is_opposite { -1.0 } else { 1.0 };
    let in_plane = p * p.z + side * p.xy().norm();
    Rotation3::from_axis_angle(&Unit::new_normalize(q), turn) * in_plane
}

/// The pose by products of rigid motions of nalgebra, written without the code under test.
fn forward_by_products(machine: &Machine, joints: &AxisPositions) -> Pose {
    let motion = |k: usize| {
        let axis = &machine.rotary()[k];
        let is_head = match machine.kind() {
            Kind::TableTable => false,
            Kind::HeadTable => k == 0,
            Kind::HeadHead => true,
        };
        let pivot = if is_head { machine.pivot_mm() } else { 0.0 };
        let there = Translation3::from(axis.point_mm.coords + Vector3::new(0.0, 0.0, pivot));
        let sign = if axis.is_mirrored { -1.0 } else { 1.0 };
        let rotation =
            Rotation3::from_axis_angle(&Unit::new_normalize(*axis.direction), sign * joints.rotary[k]);
        there * Isometry3::from_parts(Translation3::identity(), rotation.into()) * there.inverse()
    };
    let slides = Isometry3::from(Translation3::from(Vector3::from(joints.linear_mm)));
    let (table, head) = match machine.kind() {
        Kind::TableTable => (motion(0) * motion(1), Isometry3::identity()),
        Kind::HeadTable => (motion(1), motion(0)),
        Kind::HeadHead => (Isometry3::identity(), motion(0) * motion(1)),
    };
    let tool = table.inverse() * slides * head;
    Pose { tip: tool * Point3::origin(), axis: UnitVector3::new_normalize(tool * Vector3::z()) }
}

/// All angles that bring the tool axis to `wanted`, by Gauss-Newton from every node of a grid of 10 degrees.
fn angles_by_scan(machine: &Machine, wanted: &UnitVector3<f64>) -> Vec<[f64; 2]> {
    let miss = |rotary| {
        let joints = AxisPositions { linear_mm: [0.0; 3], rotary };
        forward_by_products(machine, &joints).axis.into_inner() - wanted.into_inner()
    };
    let mut found: Vec<[f64; 2]> = Vec::new();
    for node in 0..36 * 36 {
        let mut at = [f64::from(node % 36), f64::from(node / 36)].map(|k| (k * 10.0).to_radians());
        for _ in 0..30 {
            const STEP: f64 = 1e-6;
            let value = miss(at);
            let slope = [[STEP, 0.0], [0.0, STEP]].map(|d| {
                (miss([at[0] + d[0], at[1] + d[1]]) - miss([at[0] - d[0], at[1] - d[1]])) / (2.0 * STEP)
            });
            let (aa, ab, bb) = (slope[0].dot(&slope[0]), slope[0].dot(&slope[1]), slope[1].dot(&slope[1]));
            let determinant = aa * bb - ab * ab;
            if value.norm() < 1e-13 || determinant < 1e-9 {
                break;
            }
            let (a, b) = (slope[0].dot(&value), slope[1].dot(&value));
            at[0] -= (bb * a - ab * b) / determinant;
            at[1] -= (aa * b - ab * a) / determinant;
        }
        let is_known = |other: &[f64; 2]| turned(other[0], at[0]).max(turned(other[1], at[1])) < 1e-5;
        if miss(at).norm() < 1e-10 && !found.iter().any(is_known) {
            found.push(at);
        }
    }
    found
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn inverse_followed_by_forward_returns_the_pose(
        machine in machine(), tip in vector(1000.0 / 3f64.sqrt()), axis in direction(),
    ) {
        let wanted = pose(tip, axis);
        for joints in solutions(&machine, &wanted) {
            prop_assert!(distance(&machine.forward(&joints), &wanted) < PROMISED);
        }
    }

    #[test]
    fn inverse_followed_by_forward_returns_the_pose_near_the_pole(
        machine in machine(), tip in vector(1000.0 / 3f64.sqrt()), exponent in -17.0..0.0, about in 0.0..TAU,
        rotary in prop::array::uniform2(-PI..PI), is_opposite: bool,
    ) {
        // Near the second axis as it stands, and near an axis that is surely within reach.
        let size = 10f64.powf(exponent);
        let tilt = size * Vector3::new(about.cos(), about.sin(), 0.5);
        let pole = machine.rotary()[machine.free_axis()].direction.into_inner();
        let pole = if is_opposite { -pole } else { pole };
        let reached = machine.forward(&AxisPositions { linear_mm: tip, rotary });
        let near = [pole, Vector3::z(), end_of_reach(&machine, about, is_opposite)];
        for axis in near.map(|axis| axis + tilt).into_iter().chain([reached.axis.into_inner()]) {
            let wanted = pose(tip, axis.into());
            for joints in solutions(&machine, &wanted) {
                prop_assert!(distance(&machine.forward(&joints), &wanted) < PROMISED);
            }
        }
    }

    #[test]
    fn one_of_the_two_solutions_has_the_angles_that_made_the_pose(
        machine in machine(), linear_mm in vector(500.0), rotary in prop::array::uniform2(-PI..PI),
    ) {
        let joints = AxisPositions { linear_mm, rotary };
        let made = machine.forward(&joints);
        prop_assert!(distance(&made, &forward_by_products(&machine, &joints)) < PROMISED);
        let Inverse::Two(both) = machine.inverse(&made) else {
            return Err(TestCaseError::fail("a pose that was reached has two solutions"));
        };
        // Where the two solutions are close, the angles are only good to the root of rounding.
        let apart = turned(both[0].rotary[0], both[1].rotary[0]).max(turned(both[0].rotary[1], both[1].rotary[1]));
        let miss = |found: &AxisPositions| turned(found.rotary[0], rotary[0]).max(turned(found.rotary[1], rotary[1]));
        prop_assert!(miss(&both[0]).min(miss(&both[1])) < 1e-11 / apart.clamp(1e-5, 1e-2));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_scan_of_all_angles_finds_the_same_two_solutions(machine in machine(), axis in direction()) {
        let wanted = pose([0.0; 3], axis);
        let scanned = angles_by_scan(&machine, &wanted.axis);
        match machine.inverse(&wanted) {
            Inverse::Two(both) => {
                let [a, b] = both.map(|joints| joints.rotary);
                // Gauss-Newton does not converge to 1e-10 at solutions that almost coincide.
                prop_assume!(turned(a[0], b[0]).max(turned(a[1], b[1])) > 1e-2);
                prop_assert_eq!(scanned.len(), 2);
                for found in [a, b] {
                    let is_found = |s: &[f64; 2]| turned(s[0], found[0]).max(turned(s[1], found[1])) < 1e-7;
                    prop_assert!(scanned.iter().any(is_found));
                }
            }
            Inverse::Pole { .. } => prop_assert!(false, "random axes are not at the pole"),
            Inverse::Unreachable => prop_assert!(scanned.is_empty()),
        }
    }
}

#[test]
fn an_a_c_table_has_the_textbook_angles() {
    let machine = by_name("table_table_ac").unwrap();
    let (sin, cos) = 0.4f64.sin_cos();
    let Inverse::Two(both) = machine.inverse(&pose([10.0, 20.0, 30.0], [0.0, sin, cos])) else { panic!() };
    let upright = both.iter().find(|joints| joints.rotary[0] > 0.0).unwrap();
    let turned_round = both.iter().find(|joints| joints.rotary[0] < 0.0).unwrap();
    assert!((upright.rotary[0] - 0.4).abs() < 1e-15 && upright.rotary[1].abs() < 1e-15);
    assert!((turned_round.rotary[0] + 0.4).abs() < 1e-15 && turned(turned_round.rotary[1], PI) < 1e-15);
    let expected = [10.0, 20.0 * cos - 30.0 * sin, 20.0 * sin + 30.0 * cos];
    for (got, want) in upright.linear_mm.iter().zip(expected) {
        assert!((got - want).abs() < 1e-13);
    }
}

#[test]
fn a_head_tilts_about_its_centre_at_the_pivot_length_above_the_tip() {
    let machine = by_name("head_head_ca").unwrap();
    // The tool leans to -Y by a quarter of a turn; its tip is then 150 mm from the centre, along +Y.
    let tilted = machine.forward(&AxisPositions { linear_mm: [0.0; 3], rotary: [0.0, FRAC_PI_2] });
    assert!(distance(&tilted, &pose([0.0, 150.0, 150.0], [0.0, -1.0, 0.0])) < 1e-13);
}

#[test]
fn a_mirrored_axis_turns_the_other_way() {
    let turn = |is_mirrored| {
        let rotary =
            [axis('A', [1.0, 0.0, 0.0], [0.0; 3], is_mirrored), axis('C', [0.0, 0.0, 1.0], [0.0; 3], false)];
        let machine = Machine::new("", Kind::TableTable, rotary, [None; 3], 0.0).unwrap();
        machine.forward(&AxisPositions { linear_mm: [0.0; 3], rotary: [0.3, 0.0] }).axis
    };
    assert!((turn(false).y - 0.3f64.sin()).abs() < 1e-15 && (turn(true).y + 0.3f64.sin()).abs() < 1e-15);
}

#[test]
fn at_the_pole_the_angle_of_the_axis_next_to_the_workpiece_is_free() {
    for machine in named() {
        let up = pose([30.0, -20.0, 10.0], [0.0, 0.0, 1.0]);
        let Inverse::Pole { fixed } = machine.inverse(&up) else { panic!("{}", machine.name()) };
        assert!(fixed.abs() < 1e-12 && machine.rotary()[machine.free_axis()].name == 'C');
        assert_eq!(solutions(&machine, &up).len(), 3);
    }
}

#[test]
fn a_nutating_table_reaches_horizontal_tools_and_none_below() {
    let machine = by_name("table_table_nutating_bc").unwrap();
    for k in 0..360 {
        let (sin, cos) = f64::from(k).to_radians().sin_cos();
        let horizontal = pose([1.0, 2.0, 3.0], [cos, sin, 0.0]);
        let Inverse::Two(both) = machine.inverse(&horizontal) else { panic!("{k}") };
        for joints in both {
            assert!(turned(joints.rotary[0], PI) < 1e-7);
            assert!(distance(&machine.forward(&joints), &horizontal) < PROMISED);
        }
        assert_eq!(machine.inverse(&pose([0.0; 3], [cos, sin, -1e-9])), Inverse::Unreachable);
        assert_eq!(solutions(&machine, &pose([0.0; 3], [cos, sin, 1e-9])).len(), 2);
    }
}

#[test]
fn poses_that_are_not_finite_are_unreachable() {
    for machine in named() {
        assert_eq!(machine.inverse(&pose([f64::NAN, 0.0, 0.0], [0.0, 0.0, 1.0])), Inverse::Unreachable);
        for bad in [f64::NAN, f64::INFINITY, 0.0] {
            let axis = UnitVector3::new_unchecked(Vector3::repeat(bad));
            assert_eq!(machine.inverse(&Pose { tip: Point3::origin(), axis }), Inverse::Unreachable);
        }
    }
}

#[test]
fn machines_that_cannot_tilt_the_tool_in_two_ways_are_refused() {
    let [x, z] = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    let new = |kind, first: [f64; 3], second: [f64; 3]| {
        let rotary = [axis('A', first, [0.0; 3], false), axis('C', second, [0.0; 3], false)];
        Machine::new("", kind, rotary, [None; 3], 0.0).map(|_| ())
    };
    let parallel = Err(MachineError::ParallelAxes { first: 'A', second: 'C' });
    assert_eq!(new(Kind::TableTable, x, [-1.0, 1e-5, 0.0]), parallel);
    assert_eq!(new(Kind::TableTable, z, x), Err(MachineError::ParallelToTool { axis: 'A' }));
    assert_eq!(new(Kind::HeadTable, z, x), Err(MachineError::ParallelToTool { axis: 'A' }));
    assert_eq!(new(Kind::HeadHead, x, z), Err(MachineError::ParallelToTool { axis: 'C' }));
    assert_eq!(new(Kind::HeadHead, z, x), Ok(()));
}

#[test]
fn unusable_numbers_and_names_are_refused() {
    let a = axis('A', [1.0, 0.0, 0.0], [0.0; 3], false);
    let c = axis('C', [0.0, 0.0, 1.0], [0.0; 3], false);
    let new = |rotary, travel_mm, pivot_mm| {
        Machine::new("", Kind::TableTable, rotary, travel_mm, pivot_mm).map(|_| ()).unwrap_err()
    };
    let free = [None; 3];
    assert_eq!(new([a, c], free, 1.0), MachineError::PivotWithoutHead);
    assert_eq!(new([a, c], free, f64::NAN), MachineError::NotFinite);
    let empty = [None, Some([1.0, 0.0]), None];
    assert_eq!(new([a, c], empty, 0.0), MachineError::EmptyTravel { axis: 'Y' });
    assert_eq!(new([a, RotaryAxis { name: 'A', ..c }], free, 0.0), MachineError::SameName { axis: 'A' });
    assert_eq!(new([a, RotaryAxis { name: 'Z', ..c }], free, 0.0), MachineError::SameName { axis: 'Z' });
    let endless = RotaryAxis { travel: Some([0.0, 1.0]), is_wrapped: true, ..c };
    assert_eq!(new([a, endless], free, 0.0), MachineError::WrappedWithTravel { axis: 'C' });
    let nowhere = RotaryAxis { direction: UnitVector3::new_unchecked(Vector3::zeros()), ..c };
    assert_eq!(new([a, nowhere], free, 0.0), MachineError::NotFinite);
    let long = RotaryAxis { travel: Some([0.0, 1e6]), ..c };
    assert_eq!(new([a, long], free, 0.0), MachineError::LongTravel { axis: 'C' });
    let far = RotaryAxis { point_mm: Point3::new(0.0, f64::INFINITY, 0.0), ..c };
    assert_eq!(new([a, far], free, 0.0), MachineError::NotFinite);
}

#[test]
fn a_wrapped_axis_is_shown_within_one_turn() {
    let c = RotaryAxis { is_wrapped: true, ..axis('C', [0.0, 0.0, 1.0], [0.0; 3], false) };
    assert_eq!((c.shown(TAU), c.shown(-1e-30), c.shown(-FRAC_PI_2)), (0.0, 0.0, 1.5 * PI));
    assert_eq!(RotaryAxis { is_wrapped: false, ..c }.shown(-7.0), -7.0);
}
