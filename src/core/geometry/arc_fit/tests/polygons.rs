//! Points that are corners of polygons, fitted with the lines between them as the exact shape. The distances
//! are judged by samples of the chain and of the lines, with code of this file alone.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use proptest::prelude::*;

use super::*;

/// Samples on each line and each element.
const SAMPLES: usize = 64;

/// The corners of a chain of arcs that continue each other in direction, each a radius, mm, a turn, radians,
/// and a number of lines. A radius of infinity is one line as long as the turn, mm.
fn corners(arcs: &[(f64, f64, usize)], turned: f64) -> Vec<Vector2<f64>> {
    let along = |angle: f64| Vector2::new(angle.cos(), angle.sin());
    let (mut at, mut angle) = (Vector2::new(3.0, -7.0), turned);
    let mut points = vec![at];
    for &(radius, turn, n) in arcs {
        if radius.is_infinite() {
            at += along(angle) * turn;
            points.push(at);
            continue;
        }
        let center = at + along(angle + FRAC_PI_2 * turn.signum()) * radius;
        let from_center = at - center;
        for k in 1..=n {
            let (sin, cos) = (turn * k as f64 / n as f64).sin_cos();
            let [x, y] = from_center.into();
            points.push(center + Vector2::new(x * cos - y * sin, x * sin + y * cos));
        }
        at = *points.last().unwrap();
        angle += turn;
    }
    points
}

/// How far the corners of `n` equal lines over a turn lie from the lines' middles, mm.
fn sagitta(radius: f64, turn: f64, n: usize) -> f64 {
    radius * (1.0 - (0.5 * turn / n as f64).cos())
}

fn on_line([a, b]: [Vector2<f64>; 2]) -> impl Iterator<Item = Vector2<f64>> {
    (0..=SAMPLES).map(move |k| a + (b - a) * (k as f64 / SAMPLES as f64))
}

/// The centre, the start and the turn, radians, of an arc; `None` for a line.
fn as_arc(element: &Element) -> Option<(Vector2<f64>, Vector2<f64>, f64)> {
    match element.shape {
        Shape::Segment(Segment::Line { .. }) => None,
        Shape::Segment(Segment::Arc(own)) => Some((own.center().coords, own.start().coords, own.turn())),
        Shape::FullCircle { at, center, is_ccw } => {
            Some((center.coords, at.coords, if is_ccw { TAU } else { -TAU }))
        }
    }
}

/// The element as lines between samples.
fn samples(element: &Element, from: Vector2<f64>) -> Vec<Vector2<f64>> {
    let Some((center, start, turn)) = as_arc(element) else {
        return on_line([from, element.to().coords]).collect();
    };
    let [x, y] = (start - center).into();
    (0..=16 * SAMPLES)
        .map(|k| {
            let (sin, cos) = (turn * k as f64 / (16 * SAMPLES) as f64).sin_cos();
            center + Vector2::new(x * cos - y * sin, x * sin + y * cos)
        })
        .collect()
}

/// The distance of a point from an element that starts at `from`, mm.
fn from_element(p: Vector2<f64>, element: &Element, from: Vector2<f64>) -> f64 {
    let to = element.to().coords;
    let Some((center, start, turn)) = as_arc(element) else { return from_lines(p, &[from, to]) };
    let (a, b) = (start - center, p - center);
    let angle = (a.perp(&b).atan2(a.dot(&b)) * turn.signum()).rem_euclid(TAU);
    if angle <= turn.abs() { (b.norm() - a.norm()).abs() } else { (p - from).norm().min((p - to).norm()) }
}

fn from_lines(p: Vector2<f64>, corners: &[Vector2<f64>]) -> f64 {
    let distance = |pair: &[Vector2<f64>]| {
        let along = pair[1] - pair[0];
        let place = ((p - pair[0]).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
        (p - pair[0] - along * place).norm()
    };
    corners.windows(2).map(distance).fold(f64::INFINITY, f64::min)
}

/// The largest distance of the elements from the lines between their points, and of these lines from them.
fn deviation(points: &[Vector2<f64>], fitted: &Fitted) -> f64 {
    let (mut worst, mut first, mut from) = (0.0f64, 0, fitted.start);
    for element in &fitted.elements {
        let own = &points[first..=element.end];
        for p in samples(element, from) {
            worst = worst.max(from_lines(p, own));
        }
        for p in own.windows(2).flat_map(|pair| on_line([pair[0], pair[1]])) {
            worst = worst.max(from_element(p, element, from));
        }
        (first, from) = (element.end, element.to().coords);
    }
    assert_eq!(first, points.len() - 1);
    worst
}

fn polyline(tolerance: f64) -> Fit {
    Fit { measure: Measure::Polyline, ..Fit::within(tolerance) }
}

/// The count of the fewest elements, after the deviation has been judged, and no more than the count of a
/// smooth chain.
fn judged(points: &[Vector2<f64>], request: &Fit) -> usize {
    let fewest = fitted(points, request);
    let smooth = fitted(points, &Fit { continuity: Continuity::Tangent, ..*request });
    let allowed = request.tolerance_mm * (1.0 + 1e-6);
    for chain in [&fewest, &smooth] {
        let off = deviation(points, chain);
        assert!(off <= allowed, "{off} mm at {} mm: {chain:?} of {points:?}", request.tolerance_mm);
    }
    assert!(fewest.elements.len() <= smooth.elements.len(), "{fewest:?} {smooth:?} {points:?}");
    fewest.elements.len()
}

#[test]
fn a_quarter_of_a_polygon_is_one_arc_of_the_mean_radius() {
    let rounded = |p: &Vector2<f64>| p.map(|c| (c * 1e4).round() / 1e4);
    let quarter: Vec<_> = corners(&[(40.0, FRAC_PI_2, 16)], 0.0).iter().map(rounded).collect();
    for backwards in [false, true] {
        let points: Vec<_> =
            if backwards { quarter.iter().rev().copied().collect() } else { quarter.clone() };
        let fewest = fitted(&points, &polyline(0.0265));
        let [Element { shape: Shape::Segment(Segment::Arc(arc)), .. }] = fewest.elements[..] else {
            panic!("{fewest:?}")
        };
        assert!((arc.radius() - 39.976).abs() < 5e-4, "{}", arc.radius());
        assert!(deviation(&points, &fewest) < 0.0242);
        assert_eq!(judged(&points, &polyline(0.0265)), 1);
    }
}

#[test]
fn a_closed_polygon_is_one_circle_where_half_its_sagitta_is_allowed() {
    for n in [4, 5, 8, 12, 16, 40, 100] {
        for share in [0.505, 0.7, 0.99, 1.2] {
            let mut points = corners(&[(20.0, TAU, n)], 0.3);
            points[n] = points[0];
            let tolerance = share * sagitta(20.0, TAU, n);
            let request = Fit { is_closed: true, ..polyline(tolerance) };
            assert_eq!(judged(&points, &request), 1, "{n} {share}");
            let less = Fit { tolerance_mm: 0.49 * sagitta(20.0, TAU, n), ..request };
            assert!(judged(&points, &less) > 1);
        }
    }
}

#[test]
fn a_slot_of_polygons_is_two_lines_and_its_arcs() {
    let straight = (f64::INFINITY, 30.0, 1);
    for n in [8, 12, 20] {
        let slot = [straight, (6.0, PI, n), straight, (6.0, PI, n)];
        let points = corners(&slot, 0.4);
        for share in [0.55, 0.8] {
            let tolerance = share * sagitta(6.0, PI, n);
            assert!(judged(&points, &polyline(tolerance)) <= 4, "{n} {share}");
            let mut ring = points.clone();
            *ring.last_mut().unwrap() = ring[0];
            let closed = Fit { is_closed: true, ..polyline(tolerance) };
            assert!(judged(&ring, &closed) <= 4, "{n} {share}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 200, ..ProptestConfig::default() })]

    /// Chains of up to three polygonal arcs at a tolerance between half the largest sagitta and this sagitta:
    /// no more elements than arcs. Where the sense changes, the arcs run on different sides of the corner,
    /// and one line more may join them.
    #[test]
    fn a_chain_of_polygons_is_as_many_arcs(
        arcs in prop::collection::vec((2.0f64..60.0, 0.6f64..3.0, prop::bool::ANY, 5usize..20), 1..4),
        turned in 0.0f64..6.0,
        share in 0.53f64..0.98,
        backwards: bool,
    ) {
        let sagitta_of = |(radius, turn, _, n): &(f64, f64, bool, usize)| sagitta(*radius, *turn, *n);
        let largest = arcs.iter().map(sagitta_of).fold(0.0, f64::max);
        let made: Vec<_> =
            arcs.iter().map(|(r, turn, is_left, n)| (*r, if *is_left { *turn } else { -turn }, *n)).collect();
        let mut points = corners(&made, turned);
        if backwards {
            points.reverse();
        }
        prop_assume!(points.len() <= free_joints::FEW_POINTS);
        let count = judged(&points, &polyline(share * largest));
        let changes = arcs.windows(2).filter(|pair| pair[0].2 != pair[1].2).count();
        prop_assert!(count <= arcs.len() + changes, "{count} of {} {changes}", arcs.len());
    }

    /// Random chains of lines: whatever is found keeps the tolerance.
    #[test]
    fn the_lines_of_random_chains_keep_the_tolerance(
        steps in prop::collection::vec((-1.0f64..1.0, 0.2f64..1.0), 4..60),
        tolerance in 0.01f64..0.2,
        is_closed: bool,
    ) {
        let (mut at, mut angle) = (Vector2::zeros(), 0.0f64);
        let mut points = vec![at];
        for (turn, length) in steps {
            angle += 0.4 * turn;
            at += Vector2::new(angle.cos(), angle.sin()) * length;
            points.push(at);
        }
        if is_closed {
            points.push(points[0]);
        }
        judged(&points, &Fit { is_closed, ..polyline(tolerance) });
    }
}
