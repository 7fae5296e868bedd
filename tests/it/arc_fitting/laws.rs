//! Laws that hold for every fit, for example:
//!
//! * Points that are reversed, mirrored, turned, shifted or scaled take as many elements.
//! * A fit takes as many elements in every coordinate plane.
//! * A fit to a polyline and the lines of the polyline are within the tolerance of each other.
//! * Degenerate points have one defined result.

use std::cell::Cell;
use std::f64::consts::TAU;

use nalgebra::{Point3, Vector2};
use proptest::prelude::*;
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::arc_fit::{
    Continuity, Fit, FitError, FittedCurve, Joints, LARGEST_RADIUS_MM, Measure, Method, Shape, Shapes,
    fit_in_space,
};
use toolpathd_core::geometry::curve::Curve;
use toolpathd_core::geometry::following::{from_lines, from_points};
use toolpathd_core::geometry::segment::Segment;

use super::inputs::{KINDS, Random, few, polar, walk};
use super::way::Way;
use super::{fitted, judge, ways};

const TOLERANCE_MM: f64 = 0.0213;

fn on_points() -> Fit {
    Fit { joints: Joints::OnPoints, ..Fit::within(TOLERANCE_MM) }
}

/// The number of elements of a fit. Fails if the fit is not right.
fn count(points: &[Vector2<f64>], request: &Fit) -> usize {
    judge(points, &fitted(points, request), request.tolerance_mm).unwrap()
}

fn in_space(points: &[Point3<f64>], request: &Fit) -> Vec<FittedCurve> {
    fit_in_space(points, None, request, &Budget::unlimited()).unwrap().curves
}

/// Fails unless the curves form one chain from the first point to the last and pass all points in order
/// within the tolerance. The distances are those of the library.
fn judge_in_space(points: &[Point3<f64>], pieces: &[FittedCurve], tolerance: f64) {
    let (mut at, mut first) = (points[0], 0);
    for piece in pieces {
        assert_eq!(piece.curve.start(), at, "the chain has a gap");
        let part = &points[first..=piece.end];
        assert!(
            part.iter().all(|p| piece.curve.distance_to(p) <= tolerance + 1e-9),
            "{piece:?} is too far from a point of {part:?}"
        );
        assert!(
            from_points(&piece.curve, part) <= tolerance + 1e-9,
            "{piece:?} does not pass {part:?} in order"
        );
        (at, first) = (piece.curve.end(), piece.end);
    }
    assert_eq!((at, first), (points[points.len() - 1], points.len() - 1));
}

/// Few points of every kind, and longer walks.
fn any_points() -> impl Strategy<Value = Vec<Vector2<f64>>> {
    let short =
        (0..KINDS.len(), any::<u64>()).prop_map(|(kind, seed)| few(KINDS[kind], 0.02, &mut Random(seed)));
    let long = (any::<u64>(), 0.01..0.5f64, 20..80usize)
        .prop_map(|(seed, turn, n)| walk(n, 0.3, turn, &mut Random(seed)));
    prop_oneof![short, long]
}

fn cases(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, ..ProptestConfig::default() }
}

proptest! {
    #![proptest_config(cases(400))]

    #[test]
    fn reversed_mirrored_turned_shifted_and_scaled_points_take_as_many_elements(points in any_points()) {
        let moved = |to: fn(Vector2<f64>) -> Vector2<f64>| points.iter().map(|p| to(*p)).collect::<Vec<_>>();
        let (request, reversed) = (on_points(), points.iter().rev().copied().collect::<Vec<_>>());
        let expected = count(&points, &request);
        prop_assert_eq!(count(&reversed, &request), expected, "reversed");
        prop_assert_eq!(count(&moved(|p| Vector2::new(p.x, -p.y)), &request), expected, "mirrored");
        prop_assert_eq!(count(&moved(|p| Vector2::new(-p.y, p.x)), &request), expected, "turned");
        prop_assert_eq!(count(&moved(|p| p + Vector2::new(64.0, -32.0)), &request), expected, "translated");
        let doubled = Fit { tolerance_mm: 2.0 * TOLERANCE_MM, ..request };
        prop_assert_eq!(count(&moved(|p| 2.0 * p), &doubled), expected, "doubled");
    }

    /// Free joints and a larger tolerance never need more elements. The greedy method and lines alone never
    /// need fewer.
    #[test]
    fn more_freedom_takes_no_more_elements_and_less_freedom_no_fewer(points in any_points()) {
        let request = on_points();
        let best = count(&points, &request);
        let free = count(&points, &Fit { joints: Joints::Free, ..request });
        let greedy = count(&points, &Fit { method: Method::Greedy, ..request });
        let lines = count(&points, &Fit { shapes: Shapes::LinesOnly, ..request });
        let coarse = count(&points, &Fit { tolerance_mm: 2.0 * TOLERANCE_MM, ..request });
        prop_assert!(
            free <= best && coarse <= best,
            "{} elements, but {} with free joints and {} within twice the tolerance", best, free, coarse
        );
        prop_assert!(
            greedy >= best && lines >= best,
            "{} elements, but {} by the greedy method and {} by lines alone", best, greedy, lines
        );
    }

    #[test]
    fn a_fit_takes_as_many_elements_in_every_coordinate_plane(points in any_points(), level in -5.0..5.0f64) {
        let expected = count(&points, &on_points());
        for place in [|x, y, z| Point3::new(x, y, z), |x, y, z| Point3::new(x, z, y), |x, y, z| Point3::new(z, x, y)] {
            let lifted: Vec<_> = points.iter().map(|p| place(p.x, p.y, level)).collect();
            let pieces = in_space(&lifted, &on_points());
            prop_assert_eq!(pieces.len(), expected);
            judge_in_space(&lifted, &pieces, TOLERANCE_MM);
        }
    }

    /// Dense samples of the elements and of the polyline are compared.
    #[test]
    fn a_fit_to_a_polyline_and_the_polyline_are_within_the_tolerance_of_each_other(
        points in any_points(), joints in prop_oneof![Just(Joints::OnPoints), Just(Joints::Free)], part in 1.0..20.0f64,
    ) {
        let tolerance = part * TOLERANCE_MM;
        let found = fitted(&points, &Fit { joints, measure: Measure::Polyline, ..Fit::within(tolerance) });
        prop_assert!(judge(&points, &found, tolerance).is_ok());
        for (way, [first, last]) in ways(&found) {
            let off = apart(&way, &points[first..=last]);
            prop_assert!(off <= tolerance + 1e-6, "{:?} is {} mm off the lines through {:?}", way, off, &points[first..=last]);
        }
    }

    #[test]
    fn repeated_points_do_not_change_a_fit(points in any_points(), every in 1..4usize) {
        let lifted: Vec<_> = points.iter().map(|p| Point3::new(p.x, p.y, 1.0)).collect();
        let repeated: Vec<_> = (0..2 * lifted.len())
            .filter(|k| k % 2 == 0 || (k / 2).is_multiple_of(every))
            .map(|k| lifted[k / 2])
            .collect();
        let [pieces, again] = [&lifted, &repeated].map(|points| in_space(points, &on_points()));
        let curves = |pieces: &[FittedCurve]| pieces.iter().map(|piece| piece.curve).collect::<Vec<_>>();
        prop_assert_eq!(curves(&pieces), curves(&again));
        judge_in_space(&repeated, &again, TOLERANCE_MM);
    }
}

/// The least turn of a polyline at a corner, radians. Where the points turn by less, a smooth chain has no
/// kink.
const LEAST_CORNER: f64 = 0.034;

/// The largest angle at a joint that counts as none, radians: above the rounding of directions of short arcs.
const SMOOTH: f64 = 1e-6;

/// The angle between two directions, radians.
fn turn(a: Vector2<f64>, b: Vector2<f64>) -> f64 {
    a.perp(&b).atan2(a.dot(&b)).abs()
}

/// One point is moved onto another, so that the points return to an earlier place. Where no smooth chain is
/// found, the fit is the chain that may have kinks.
#[test]
fn smooth_chains_keep_the_tolerance_and_have_kinks_only_at_corners() {
    const CASES: u32 = 100;
    let n_smooth_joints = Cell::new(0);
    proptest!(cases(CASES), |(
        points in any_points(),
        from in any::<prop::sample::Index>(),
        to in any::<prop::sample::Index>(),
        part in 1.0..20.0f64,
    )| {
        let mut points = points;
        let n = points.len();
        points[to.index(n)] = points[from.index(n)];
        points.dedup();
        prop_assume!(points.len() > 1);
        let request = Fit { continuity: Continuity::Tangent, ..Fit::within(part * TOLERANCE_MM) };
        let found = fitted(&points, &request);
        let kept = judge(&points, &found, request.tolerance_mm);
        prop_assert!(kept.is_ok(), "{:?} {:?}", kept, points);
        if found == fitted(&points, &Fit { continuity: Continuity::Position, ..request }) {
            return Ok(());
        }
        for pair in ways(&found).windows(2) {
            let [(before, [_, joint]), (after, _)] = [pair[0], pair[1]];
            let kink = turn(before.direction(before.length()), after.direction(0.0));
            let corner = turn(points[joint] - points[joint - 1], points[joint + 1] - points[joint]);
            prop_assert!(kink < SMOOTH || corner > LEAST_CORNER, "a kink of {} at {} of {:?}", kink, joint, points);
            n_smooth_joints.set(n_smooth_joints.get() + usize::from(kink < SMOOTH));
        }
    });
    assert!(n_smooth_joints.get() > 0, "no joint was smooth");
}

/// A smooth chain with free joints once went round the fold at the end of these points, by an arc of 327
/// degrees.
#[test]
fn a_fold_at_the_end_of_the_points_does_not_become_a_loop() {
    let points = [[0.957, 0.088], [0.945, 0.002], [1.702, -0.018], [2.384, -0.029], [1.702, -0.018]];
    let points = points.map(|[x, y]| Vector2::new(x, y));
    for method in [Method::Greedy, Method::Optimal] {
        for continuity in [Continuity::Position, Continuity::Tangent] {
            let found = fitted(&points, &Fit { method, continuity, ..Fit::within(0.1) });
            assert!(judge(&points, &found, 0.1).is_ok(), "{found:?}");
        }
    }
}

/// At a free joint the lines that meet there are as near to the elements as all other lines.
#[test]
fn a_polyline_is_within_the_tolerance_of_a_fit_with_free_joints() {
    let (mut worst, mut saved) = (0.0f64, 0);
    for seed in 0..20 {
        let (mut random, n) = (Random::stream(seed), 300);
        let mut at = |k: usize| {
            polar(20.0 + random.between(-0.05, 0.05), 6.0 * TAU * k as f64 / n as f64)
                * (1.0 + 0.002 * k as f64)
        };
        let points: Vec<_> = (0..n).map(&mut at).collect();
        let tolerance = 0.11;
        let request = Fit { measure: Measure::Polyline, ..Fit::within(tolerance) };
        let [found, on_points] =
            [Joints::Free, Joints::OnPoints].map(|joints| fitted(&points, &Fit { joints, ..request }));
        saved += on_points.elements.len() - found.elements.len();
        for (way, [first, last]) in ways(&found) {
            worst = worst.max(apart(&way, &points[first..=last]) / tolerance);
        }
    }
    assert!(
        saved > 0 && worst <= 1.0 + 1e-6,
        "free joints saved {saved} elements; the largest deviation is {worst} tolerances"
    );
}

/// Samples of each element and of each line.
const SAMPLES: usize = 200;

/// The largest distance between a way and the lines through points, mm: of the samples of each from the
/// other.
fn apart(way: &Way, points: &[Vector2<f64>]) -> f64 {
    let lines: Vec<Way> = points.windows(2).map(|pair| Way::line(pair[0], pair[1])).collect();
    let places = |way: &Way| -> Vec<Vector2<f64>> {
        (0..=SAMPLES).map(|k| way.at(way.length() * k as f64 / SAMPLES as f64)).collect()
    };
    let there = lines.iter().flat_map(places).map(|p| way.distance(p)).fold(0.0, f64::max);
    let to_lines = |p: Vector2<f64>| lines.iter().map(|line| line.distance(p)).fold(f64::INFINITY, f64::min);
    places(way).into_iter().map(to_lines).fold(there, f64::max)
}

#[test]
fn a_coarse_polygon_becomes_an_arc_only_if_its_lines_are_within_the_tolerance() {
    for corners in [5, 8, 12] {
        let angle = TAU / f64::from(corners);
        let points: Vec<_> = (0..corners).map(|k| polar(10.0, angle * f64::from(k))).collect();
        let sagitta = 10.0 * (1.0 - (0.5 * angle).cos());
        let polyline = |part: f64| Fit { measure: Measure::Polyline, ..Fit::within(part * sagitta) };
        // An arc may pass as far inside the corners as outside of the lines, except at its ends. So no arc
        // fits within less than half a sagitta.
        let lines = fitted(&points, &polyline(0.49));
        assert!(
            lines
                .elements
                .iter()
                .all(|element| matches!(element.shape, Shape::Segment(Segment::Line { .. }))),
            "{lines:?}"
        );
        assert_eq!(lines.elements.len(), points.len() - 1);
        assert_eq!(count(&points, &polyline(1.05)), 1);
        assert_eq!(count(&points, &Fit::within(1e-6)), 1);
        // The arc through all points is one sagitta away from the lines.
        let lifted: Vec<_> = points.iter().map(|p| Point3::new(p.x, p.y, 0.0)).collect();
        let [FittedCurve { curve, .. }] = in_space(&lifted, &Fit::within(1e-6))[..] else { panic!() };
        assert!((from_lines(&curve, &lifted) - sagitta).abs() < 1e-6);
    }
}

#[test]
fn points_on_a_helix_become_one_helical_arc() {
    for (turned, rise) in [(1.0, 2.0), (-1.0, 0.3), (1.0, -5.0)] {
        let at = |k: i32| polar(7.0, turned * 0.02 * f64::from(k));
        let points: Vec<_> =
            (0..=300).map(|k| Point3::new(at(k).x, at(k).y, rise * 0.02 * f64::from(k))).collect();
        let pieces = in_space(&points, &Fit::within(1e-4));
        judge_in_space(&points, &pieces, 1e-4);
        let [FittedCurve { curve: Curve::Arc(arc), .. }] = pieces[..] else { panic!("{pieces:?}") };
        assert!((arc.sweep() - 6.0).abs() < 1e-3 && (arc.rise() - 6.0 * rise).abs() < 1e-9, "{arc:?}");
    }
    // Points on the same circle whose heights do not rise evenly are on no helix.
    let bent: Vec<_> = (0..=300)
        .map(|k| 0.02 * f64::from(k))
        .map(|t| Point3::new(7.0 * t.cos(), 7.0 * t.sin(), t * t))
        .collect();
    let pieces = in_space(&bent, &Fit::within(1e-3));
    judge_in_space(&bent, &pieces, 1e-3);
    assert!(pieces.len() > 3);
}

#[test]
fn nearly_straight_points_become_lines_or_arcs_within_the_largest_radius() {
    let at = |k: i32| polar(5e6, 2e-7 * f64::from(k)) - Vector2::new(5e6, 0.0);
    let points: Vec<_> = (-50..=50).map(at).collect();
    // The sagitta of the points is 2.5e-4 mm.
    assert_eq!(count(&points, &Fit::within(1e-3)), 1);
    for tolerance in [1e-4, 1e-5, 1e-6] {
        let found = fitted(&points, &Fit::within(tolerance));
        let count = judge(&points, &found, tolerance).unwrap();
        assert!(count > 1);
        for (way, _) in ways(&found) {
            assert!(
                !matches!(way, Way::Arc { radius, .. } if radius > LARGEST_RADIUS_MM * (1.0 + 1e-9)),
                "{way:?}"
            );
        }
    }
}

fn along_x(places: &[f64]) -> Vec<Vector2<f64>> {
    places.iter().map(|x| Vector2::new(*x, 0.5 * x)).collect()
}

#[test]
fn points_on_a_line_become_one_line() {
    for points in [along_x(&[0.0, 3.0]), along_x(&[0.0, 1.0, 1.5, 7.0, 7.001, 30.0])] {
        for method in [Method::Greedy, Method::Optimal, Method::Biarc] {
            let found = fitted(&points, &Fit { method, ..on_points() });
            assert!(
                found
                    .elements
                    .iter()
                    .all(|element| matches!(element.shape, Shape::Segment(Segment::Line { .. }))),
                "{found:?}"
            );
            judge(&points, &found, TOLERANCE_MM).unwrap();
        }
        assert_eq!(count(&points, &on_points()), 1);
    }
}

#[test]
fn a_reversal_that_exceeds_the_tolerance_is_kept() {
    let there_and_back = along_x(&[0.0, 10.0, 5.0, 15.0]);
    for measure in [Measure::Points, Measure::Polyline] {
        for method in [Method::Greedy, Method::Optimal] {
            let found = fitted(&there_and_back, &Fit { method, measure, ..on_points() });
            assert!(
                found
                    .elements
                    .iter()
                    .all(|element| matches!(element.shape, Shape::Segment(Segment::Line { .. }))),
                "{found:?}"
            );
            assert_eq!(judge(&there_and_back, &found, TOLERANCE_MM), Ok(3));
        }
    }
    // A reversal within the tolerance disappears in one line.
    assert_eq!(count(&along_x(&[0.0, 10.0, 9.97, 15.0]), &on_points()), 1);
}

#[test]
fn a_spike_that_exceeds_the_tolerance_is_kept() {
    let mut points: Vec<_> = (0..=100).map(|k| Vector2::new(0.1 * f64::from(k), 0.0)).collect();
    points[50].y = 2.0;
    for measure in [Measure::Points, Measure::Polyline] {
        let found = fitted(&points, &Fit { measure, ..on_points() });
        // One arc passes the three points of the spike, but leaves the lines between them.
        let expected = if measure == Measure::Points { 3 } else { 4 };
        assert_eq!(judge(&points, &found, TOLERANCE_MM), Ok(expected));
    }
}

#[test]
fn points_that_all_coincide_are_refused() {
    for n in [1, 2, 5] {
        let refused =
            fit_in_space(&vec![Point3::new(1.0, 2.0, 3.0); n], None, &on_points(), &Budget::unlimited());
        assert_eq!(refused, Err(FitError::OnePlace));
    }
}

/// If the noise exceeds the tolerance, points in the gap of a nearly full circle are near its ends and in
/// order. Such an arc must not be taken, because it does not follow the points.
#[test]
fn noise_that_exceeds_the_tolerance_makes_no_loops() {
    for tolerance in [0.03, 0.05] {
        for seed in 0..10 {
            let mut random = Random::stream(seed);
            let points: Vec<_> =
                (0..600).map(|k| polar(20.0, 1e-3 * f64::from(k)) + random.jitter(0.05)).collect();
            let found = fitted(&points, &Fit { joints: Joints::OnPoints, ..Fit::within(tolerance) });
            for (way, [first, last]) in ways(&found) {
                let off = apart(&way, &points[first..=last]);
                assert!(
                    off <= 4.0 * tolerance,
                    "{way:?} is {off} mm off the lines through {:?}",
                    &points[first..=last]
                );
            }
        }
    }
}
