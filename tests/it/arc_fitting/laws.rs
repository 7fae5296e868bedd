//! What holds of every fit: moved points take as many elements, planes are alike, lines between points are
//! near where they are the shape, and what is degenerate has one answer.

use std::f64::consts::TAU;

use nalgebra::{Point3, Vector2};
use proptest::prelude::*;
use toolpathd::budget::Budget;
use toolpathd::geometry::arc_fit::{
    Continuity, Fit, FitError, FittedCurve, Joints, LARGEST_RADIUS_MM, Measure, Method, Shape, Shapes,
    fit_in_space,
};
use toolpathd::geometry::curve::Curve;
use toolpathd::geometry::following::{from_lines, from_points};

use super::inputs::{KINDS, Random, few, polar, walk};
use super::way::Way;
use super::{fitted, judge, ways};

const TOLERANCE_MM: f64 = 0.0213;

fn on_points() -> Fit {
    Fit { joints: Joints::OnPoints, ..Fit::within(TOLERANCE_MM) }
}

/// The number of elements of a fit that keeps its promises.
fn count(points: &[Vector2<f64>], request: &Fit) -> usize {
    judge(points, &fitted(points, request), request.tolerance_mm).unwrap()
}

fn in_space(points: &[Point3<f64>], request: &Fit) -> Vec<FittedCurve> {
    fit_in_space(points, None, request, &Budget::unlimited()).unwrap()
}

/// Fails unless the curves are one chain from the first point to the last, near every point and in order by
/// the fitting's own measure.
fn judge_in_space(points: &[Point3<f64>], pieces: &[FittedCurve], tolerance: f64) {
    let (mut at, mut first) = (points[0], 0);
    for piece in pieces {
        assert_eq!(piece.curve.start(), at);
        let part = &points[first..=piece.end];
        assert!(part.iter().all(|p| piece.curve.distance_to(p) <= tolerance + 1e-9), "{piece:?} {part:?}");
        assert!(from_points(&piece.curve, part) <= tolerance + 1e-9, "{piece:?} {part:?}");
        (at, first) = (piece.curve.end(), piece.end);
    }
    assert_eq!((at, first), (points[points.len() - 1], points.len() - 1));
}

/// All kinds of few points, and longer walks.
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
    fn moved_points_take_as_many_elements(points in any_points()) {
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

    /// Joints beside the points can only save elements, arcs can only save lines, and greed can only cost.
    #[test]
    fn more_freedom_takes_no_more_elements(points in any_points()) {
        let request = on_points();
        let best = count(&points, &request);
        let free = count(&points, &Fit { joints: Joints::Free, ..request });
        let greedy = count(&points, &Fit { method: Method::Greedy, ..request });
        let lines = count(&points, &Fit { shapes: Shapes::LinesOnly, ..request });
        let coarse = count(&points, &Fit { tolerance_mm: 2.0 * TOLERANCE_MM, ..request });
        prop_assert!(free <= best && coarse <= best, "{} {} {}", best, free, coarse);
        prop_assert!(greedy >= best && lines >= best, "{} {} {}", best, greedy, lines);
    }

    #[test]
    fn coordinate_planes_are_alike(points in any_points(), level in -5.0..5.0f64) {
        let expected = count(&points, &on_points());
        for place in [|x, y, z| Point3::new(x, y, z), |x, y, z| Point3::new(x, z, y), |x, y, z| Point3::new(z, x, y)] {
            let lifted: Vec<_> = points.iter().map(|p| place(p.x, p.y, level)).collect();
            let pieces = in_space(&lifted, &on_points());
            prop_assert_eq!(pieces.len(), expected);
            judge_in_space(&lifted, &pieces, TOLERANCE_MM);
        }
    }

    /// By dense samples of both.
    #[test]
    fn lines_between_coarse_points_are_near(points in any_points(), joints in prop_oneof![Just(Joints::OnPoints), Just(Joints::Free)], part in 1.0..20.0f64) {
        let tolerance = part * TOLERANCE_MM;
        let found = fitted(&points, &Fit { joints, measure: Measure::Polyline, ..Fit::within(tolerance) });
        prop_assert!(judge(&points, &found, tolerance).is_ok());
        for (way, [first, last]) in ways(&found) {
            let off = apart(&way, &points[first..=last]);
            prop_assert!(off <= tolerance + 1e-6, "{:?} is {} off {:?}", way, off, &points[first..=last]);
        }
    }

    #[test]
    fn repetitions_of_points_change_nothing(points in any_points(), every in 1..4usize) {
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

proptest! {
    #![proptest_config(cases(60))]

    /// Also where the points go back to where they came from.
    #[test]
    fn smooth_chains_keep_the_tolerance(
        points in any_points(),
        from in any::<prop::sample::Index>(),
        to in any::<prop::sample::Index>(),
        part in 1.0..20.0f64,
    ) {
        let mut points = points;
        let n = points.len();
        points[to.index(n)] = points[from.index(n)];
        points.dedup();
        prop_assume!(points.len() > 1);
        let request = Fit { continuity: Continuity::Tangent, ..Fit::within(part * TOLERANCE_MM) };
        let kept = judge(&points, &fitted(&points, &request), request.tolerance_mm);
        prop_assert!(kept.is_ok(), "{:?} {:?}", kept, points);
    }
}

/// A smooth chain whose joints lie beside the points once went round the fold at the end, by an arc of 327
/// degrees.
#[test]
fn a_fold_is_no_loop() {
    let points = [[0.957, 0.088], [0.945, 0.002], [1.702, -0.018], [2.384, -0.029], [1.702, -0.018]];
    let points = points.map(|[x, y]| Vector2::new(x, y));
    for method in [Method::Greedy, Method::Optimal] {
        for continuity in [Continuity::Position, Continuity::Tangent] {
            let found = fitted(&points, &Fit { method, continuity, ..Fit::within(0.1) });
            assert!(judge(&points, &found, 0.1).is_ok(), "{found:?}");
        }
    }
}

/// Joints beside the points leave the lines that meet there as near as all others.
#[test]
fn lines_at_free_joints_are_near() {
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
    assert!(saved > 0 && worst <= 1.0 + 1e-6, "{saved} {worst}");
}

/// Samples of a way or a line.
const SAMPLES: usize = 200;

/// The distance both ways between a way and the lines through points, by dense samples, mm.
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
fn coarse_polygons_become_arcs_only_within_the_tolerance() {
    for corners in [5, 8, 12] {
        let angle = TAU / f64::from(corners);
        let points: Vec<_> = (0..corners).map(|k| polar(10.0, angle * f64::from(k))).collect();
        let sagitta = 10.0 * (1.0 - (0.5 * angle).cos());
        let polyline = |part: f64| Fit { measure: Measure::Polyline, ..Fit::within(part * sagitta) };
        // Arcs may pass as far inside the corners as outside of the lines, but for their ends.
        let lines = fitted(&points, &polyline(0.49));
        assert!(lines.elements.iter().all(|element| element.shape == Shape::Line), "{lines:?}");
        assert_eq!(lines.elements.len(), points.len() - 1);
        assert_eq!(count(&points, &polyline(1.05)), 1);
        assert_eq!(count(&points, &Fit::within(1e-6)), 1);
        // By the curve: the arc is as far from the lines as they are high.
        let lifted: Vec<_> = points.iter().map(|p| Point3::new(p.x, p.y, 0.0)).collect();
        let [FittedCurve { curve, .. }] = in_space(&lifted, &Fit::within(1e-6))[..] else { panic!() };
        assert!((from_lines(&curve, &lifted) - sagitta).abs() < 1e-6);
    }
}

#[test]
fn a_helix_is_one_arc() {
    for (turned, rise) in [(1.0, 2.0), (-1.0, 0.3), (1.0, -5.0)] {
        let at = |k: i32| polar(7.0, turned * 0.02 * f64::from(k));
        let points: Vec<_> =
            (0..=300).map(|k| Point3::new(at(k).x, at(k).y, rise * 0.02 * f64::from(k))).collect();
        let pieces = in_space(&points, &Fit::within(1e-4));
        judge_in_space(&points, &pieces, 1e-4);
        let [FittedCurve { curve: Curve::Arc(arc), .. }] = pieces[..] else { panic!("{pieces:?}") };
        assert!((arc.sweep() - 6.0).abs() < 1e-3 && (arc.rise() - 6.0 * rise).abs() < 1e-9, "{arc:?}");
    }
    // The same way round at uneven heights is none.
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
    // They rise over their chord by 2.5e-4 mm.
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
fn points_on_a_line_are_one_line() {
    for points in [along_x(&[0.0, 3.0]), along_x(&[0.0, 1.0, 1.5, 7.0, 7.001, 30.0])] {
        for method in [Method::Greedy, Method::Optimal, Method::Biarc] {
            let found = fitted(&points, &Fit { method, ..on_points() });
            assert!(found.elements.iter().all(|element| element.shape == Shape::Line), "{found:?}");
            judge(&points, &found, TOLERANCE_MM).unwrap();
        }
        assert_eq!(count(&points, &on_points()), 1);
    }
}

#[test]
fn a_reversal_is_not_swallowed() {
    let there_and_back = along_x(&[0.0, 10.0, 5.0, 15.0]);
    for measure in [Measure::Points, Measure::Polyline] {
        for method in [Method::Greedy, Method::Optimal] {
            let found = fitted(&there_and_back, &Fit { method, measure, ..on_points() });
            assert!(found.elements.iter().all(|element| element.shape == Shape::Line), "{found:?}");
            assert_eq!(judge(&there_and_back, &found, TOLERANCE_MM), Ok(3));
        }
    }
    // Within the tolerance it is.
    assert_eq!(count(&along_x(&[0.0, 10.0, 9.97, 15.0]), &on_points()), 1);
}

#[test]
fn a_spike_is_kept() {
    let mut points: Vec<_> = (0..=100).map(|k| Vector2::new(0.1 * f64::from(k), 0.0)).collect();
    points[50].y = 2.0;
    for measure in [Measure::Points, Measure::Polyline] {
        let found = fitted(&points, &Fit { measure, ..on_points() });
        // An arc past the three points stands for a spike of points, not for one of lines.
        let expected = if measure == Measure::Points { 3 } else { 4 };
        assert_eq!(judge(&points, &found, TOLERANCE_MM), Ok(expected));
    }
}

#[test]
fn points_in_one_place_are_refused() {
    for n in [1, 2, 5] {
        let refused =
            fit_in_space(&vec![Point3::new(1.0, 2.0, 3.0); n], None, &on_points(), &Budget::unlimited());
        assert_eq!(refused, Err(FitError::OnePlace));
    }
}

/// With more noise than tolerance, points that lie in the gap of an arc are near its ends, in order; the arc
/// is not theirs.
#[test]
fn noise_makes_no_loops() {
    for tolerance in [0.03, 0.05] {
        for seed in 0..10 {
            let mut random = Random::stream(seed);
            let points: Vec<_> =
                (0..600).map(|k| polar(20.0, 1e-3 * f64::from(k)) + random.jitter(0.05)).collect();
            let found = fitted(&points, &Fit { joints: Joints::OnPoints, ..Fit::within(tolerance) });
            for (way, [first, last]) in ways(&found) {
                let off = apart(&way, &points[first..=last]);
                assert!(off <= 4.0 * tolerance, "{way:?} is {off} off {:?}", &points[first..=last]);
            }
        }
    }
}
