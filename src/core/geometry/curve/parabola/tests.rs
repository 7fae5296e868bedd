use proptest::prelude::*;

use super::*;

fn parabola(start: [f64; 3], control: [f64; 3], end: [f64; 3]) -> Parabola {
    Parabola::new(start.into(), control.into(), end.into()).unwrap()
}

/// y = x^2 between two places; the tangents at both meet halfway.
fn square(from: f64, to: f64) -> Parabola {
    parabola([from, from * from, 0.0], [(from + to) / 2.0, from * to, 0.0], [to, to * to, 0.0])
}

/// The integral of sqrt(1 + 4 x^2) from zero.
fn length_of_square(x: f64) -> f64 {
    x * (1.0 + 4.0 * x * x).sqrt() / 2.0 + (2.0 * x).asinh() / 4.0
}

fn close(a: f64, b: f64) {
    assert!((a - b).abs() <= 1e-14 * b.abs().max(1.0), "{a} {b}");
}

#[test]
fn lengths_agree_with_the_integral_for_the_square_of_x() {
    for (from, to) in [(0.0, 1.0), (-1.0, 1.0), (-3.0, 0.5), (2.0, 7.0), (-7.0, -2.0), (0.0, 1e-9)] {
        close(square(from, to).length(), length_of_square(to) - length_of_square(from));
    }
    close(square(0.0, 1.0).length(), 1.478_942_857_544_597_4);
}

#[test]
fn curvature_is_largest_at_the_vertex_or_the_end_nearest_to_it() {
    close(square(-1.0, 3.0).largest_curvature(), 2.0);
    // Away from the vertex, the curvature is largest at the nearer end: 2 / (1 + 4 x^2)^(3/2).
    for x in [0.5f64, 2.0] {
        let wanted = 2.0 / (1.0 + 4.0 * x * x).powf(1.5);
        close(square(x, x + 1.0).largest_curvature(), wanted);
        close(square(-x - 1.0, -x).largest_curvature(), wanted);
    }
    let turning = parabola([0.0; 3], [8.0, 0.0, 0.0], [4.0, 0.0, 0.0]);
    assert_eq!(turning.largest_curvature(), f64::INFINITY);
    for straight in [[2.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0; 3], [4.0, 0.0, 0.0]] {
        assert_eq!(parabola([0.0; 3], straight, [4.0, 0.0, 0.0]).largest_curvature(), 0.0);
    }
}

#[test]
fn the_support_is_at_an_extreme_or_at_an_end() {
    let curve = square(-1.0, 2.0);
    for (direction, wanted) in [
        ([0.0, -1.0, 0.0], 0.0),
        ([0.0, 2.0, 0.0], 8.0),
        ([1.0, 0.0, 0.0], 2.0),
        ([-1.0, 0.0, 5.0], 1.0),
        // x - x^2 is largest at a half.
        ([1.0, -1.0, 0.0], 0.25),
    ] {
        close(curve.support(&direction.into()), wanted);
    }
}

#[test]
fn straight_parabolas_have_the_lengths_and_distances_of_their_motion() {
    // The motion goes to 16/3 and back to 4. It turns where the velocity 2 (8 + t (4 - 16)) is zero.
    let turning = parabola([0.0; 3], [8.0, 0.0, 0.0], [4.0, 0.0, 0.0]);
    close(turning.length(), 16.0 / 3.0 + 4.0 / 3.0);
    close(turning.support(&Vector3::x()), 16.0 / 3.0);
    close(turning.distance_to(&Point3::new(10.0, 0.0, 0.0)), 14.0 / 3.0);
    close(turning.point_at(0.8).x, 16.0 / 3.0);
    let [from, to] = turning.tangents();
    assert!(from.x > 0.0 && to.x < 0.0);
    for control in [2.0, 1.0, 0.0, 4.0] {
        let line = parabola([0.0; 3], [control, 0.0, 0.0], [4.0, 0.0, 0.0]);
        close(line.length(), 4.0);
        close(line.point_at(0.25).x, 1.0);
        close(line.distance_to(&Point3::new(3.0, 0.5, 0.0)), 0.5);
        assert!(line.tangents().iter().all(|tangent| tangent.x > 0.0));
    }
    let back = parabola([0.0; 3], [3.0, 4.0, 0.0], [0.0; 3]);
    close(back.length(), 5.0);
    let point = parabola([1.0; 3], [1.0; 3], [1.0; 3]);
    assert_eq!((point.length(), point.distance_to(&Point3::new(1.0, 4.0, 5.0))), (0.0, 5.0));
    assert_eq!(point.tangents(), [Vector3::zeros(); 2]);
    assert_eq!(point.largest_curvature(), 0.0);
}

/// Nearly straight parabolas have the length that the formula for their sagitta gives. Parabolas that turn
/// sharply have the length of the way to the turn and back.
#[test]
fn lengths_are_stable_for_nearly_straight_and_sharply_turning_parabolas() {
    for k in 0..16 {
        let height = 10f64.powi(-k);
        let flat = parabola([-0.5, 0.0, 0.0], [0.0, 2.0 * height, 0.0], [0.5, 0.0, 0.0]);
        let x = 4.0 * height;
        close(flat.length(), (1.0 + x * x).sqrt() / 2.0 + if x > 0.0 { x.asinh() / x / 2.0 } else { 0.5 });
        let sharp = parabola([0.0; 3], [8.0, height, 0.0], [4.0, 0.0, 0.0]).length();
        assert!(sharp >= 20.0 / 3.0 - 1e-14 && sharp <= 20.0 / 3.0 + 2.0 * height, "{height} {sharp}");
    }
    for size in [1e-6, 1.0, 1e6] {
        for lean in [-1e3, -1.0, 0.0, 1e-12, 1e3] {
            let curve = parabola([0.0; 3], [size, lean, 0.3], [2.0 * size + 1e-9, 2.0 * lean, 0.6]);
            let [half, rest] = [curve.part(0.0, 0.5), curve.part(0.5, 1.0)];
            let whole = curve.length();
            assert!((half.length() + rest.length() - whole).abs() <= 1e-14 * whole, "{size} {lean}");
        }
    }
}

#[test]
fn coordinates_that_are_not_finite_are_refused() {
    let at = |x: f64| Point3::new(x, 0.0, 0.0);
    for bad in [f64::NAN, f64::INFINITY, 1e200] {
        for place in 0..3 {
            let [s, c, e] = [0, 1, 2].map(|k| at(if k == place { bad } else { k as f64 }));
            assert_eq!(Parabola::new(s, c, e), Err(ParabolaError::NotFinite));
        }
    }
}

fn points() -> impl Strategy<Value = [[f64; 3]; 3]> {
    let coordinate = || prop_oneof![3 => -10.0..10.0f64, 1 => Just(0.0), 1 => -1e-6..1e-6f64];
    let point = move || prop::array::uniform3(coordinate());
    prop::array::uniform3(point())
}

/// Control points on one line, with the turn inside or outside.
fn straight() -> impl Strategy<Value = [[f64; 3]; 3]> {
    let direction = prop::array::uniform3(-1.0..1.0f64);
    (direction, prop::array::uniform3(-5.0..5.0f64)).prop_map(|(d, along)| along.map(|t| d.map(|x| x * t)))
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn length_distance_and_support_agree_with_samples(
        [s, c, e] in prop_oneof![3 => points(), 1 => straight()],
        p in prop::array::uniform3(-15.0..15.0f64), d in prop::array::uniform3(-1.0..1.0f64),
    ) {
        let curve = parabola(s, c, e);
        let (p, d) = (Point3::from(p), Vector3::from(d));
        let n = 4000;
        let samples: Vec<_> = (0..=n).map(|k| curve.at(f64::from(k) / f64::from(n))).collect();
        let length: f64 = samples.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
        prop_assert!((curve.length() - length).abs() <= 1e-6 * length + 1e-9, "{} {length}", curve.length());
        let nearest = samples.iter().map(|q| (p - q).norm()).fold(f64::INFINITY, f64::min);
        let distance = curve.distance_to(&p);
        // No sample is nearer than the nearest point, and some sample is within half a chord of it.
        prop_assert!(distance <= nearest * (1.0 + 1e-12) + 1e-14, "{distance} {nearest}");
        prop_assert!(distance >= nearest - 4.0 * length / f64::from(n) - 1e-12);
        let highest = samples.iter().map(|q| q.coords.dot(&d)).fold(f64::NEG_INFINITY, f64::max);
        let support = curve.support(&d);
        prop_assert!(support >= highest - 1e-13 && support <= highest + 1e-5, "{support} {highest}");
    }

    #[test]
    fn points_of_the_curve_have_no_distance_from_it([s, c, e] in points(), t in 0.0..1.0f64) {
        let curve = parabola(s, c, e);
        prop_assert!(curve.distance_to(&curve.at(t)) <= 1e-14 * 40.0);
    }

    #[test]
    fn a_fraction_is_a_fraction_of_the_length(
        [s, c, e] in prop_oneof![3 => points(), 1 => straight()], t in 0.0..1.0f64,
    ) {
        let curve = parabola(s, c, e);
        let before = curve.part(0.0, curve.parameter_at(t)).length();
        prop_assert!((before - t * curve.length()).abs() <= 1e-12 * curve.length() + 1e-14, "{before}");
        prop_assert_eq!((curve.point_at(0.0), curve.point_at(1.0)), (curve.start(), curve.end()));
    }

    #[test]
    fn a_part_has_the_points_of_the_whole_curve(
        [s, c, e] in points(), from in 0.0..0.5f64, to in 0.5..1.0f64, t in 0.0..1.0f64
    ) {
        let curve = parabola(s, c, e);
        let part = curve.part(from, to);
        prop_assert!((part.at(t) - curve.at(from + (to - from) * t)).norm() <= 1e-13);
        prop_assert!(part.largest_curvature() <= curve.largest_curvature() * (1.0 + 1e-6) + 1e-6);
        prop_assert_eq!((curve.part(0.0, 1.0), part.start()), (curve, curve.at(from)));
    }

    /// Compares the turn of the tangent over a short part with its length.
    #[test]
    fn no_part_is_curved_more_than_the_largest_curvature([s, c, e] in points(), t in 0.0..0.999f64) {
        let curve = parabola(s, c, e);
        let part = curve.part(t, t + 1e-3);
        let [from, to] = part.tangents();
        let turn = from.cross(&to).norm().atan2(from.dot(&to));
        let most = curve.largest_curvature();
        prop_assert!(turn <= most * part.length() * (1.0 + 1e-6) + 1e-9, "{turn} {most}");
    }
}
