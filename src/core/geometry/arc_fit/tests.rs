mod polygons;

use nalgebra::Point3;
use proptest::prelude::*;

use super::*;
use crate::geometry::curve::{Arc, Curve, Direction, Line};
use crate::geometry::following::from_points;
use crate::geometry::plane::Plane;

fn circle(radius: f64, from: f64, to: f64, n: usize) -> Vec<Vector2<f64>> {
    (0..n)
        .map(|i| {
            let a = from + (to - from) * i as f64 / (n - 1) as f64;
            Vector2::new(3.0 + radius * a.cos(), -7.0 + radius * a.sin())
        })
        .collect()
}

fn sine(n: usize) -> Vec<Vector2<f64>> {
    let x = |i: usize| 10.0 * i as f64 / (n - 1) as f64;
    (0..n).map(|i| Vector2::new(x(i), x(i).sin())).collect()
}

/// An ellipse with half axes of 20 and 8 mm.
fn ellipse(n: usize) -> Vec<Vector2<f64>> {
    let angle = |i: usize| std::f64::consts::TAU * i as f64 / (n - 1) as f64;
    (0..n).map(|i| Vector2::new(20.0 * angle(i).cos(), 8.0 * angle(i).sin())).collect()
}

fn fitted(flat: &[Vector2<f64>], request: &Fit) -> Fitted {
    fit(Points { flat, heights: &[] }, request, &Budget::unlimited()).unwrap()
}

/// The angles at which elements meet, radians, each with the index of its point.
fn kinks(fitted: &Fitted) -> Vec<(usize, f64)> {
    let mut directions = Vec::new();
    for element in &fitted.elements {
        let Shape::Segment(segment) = element.shape else { panic!("a full circle") };
        let chord = segment.end() - segment.start();
        let along = chord.y.atan2(chord.x);
        let half_turn = 0.5 * segment.turn();
        directions.push((element.end, along - half_turn, along + half_turn));
    }
    let turn = |a: f64| (a + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
    directions.windows(2).map(|pair| (pair[0].0, turn(pair[1].1 - pair[0].2).abs())).collect()
}

#[test]
fn points_of_a_circle_are_one_arc_of_its_radius() {
    for (from, to) in [(0.3, 2.9), (2.9, 0.3), (1.0, 1.4), (0.0, 6.0), (6.0, 0.0)] {
        let points = circle(40.0, from, to, 200);
        let Fitted { start, elements, .. } = fitted(&points, &Fit::within(1e-3));
        assert_eq!((start, elements.len()), (points[0], 1));
        let Shape::Segment(Segment::Arc(arc)) = elements[0].shape else { panic!("a line instead of an arc") };
        assert!((arc.center() - Point2::new(3.0, -7.0)).norm() < 1e-9, "{arc:?}");
    }
}

#[test]
fn a_closed_circle_is_one_turn_and_an_open_one_is_not() {
    for (from, to, is_ccw) in
        [(0.3, 0.3 + std::f64::consts::TAU, true), (7.0, 7.0 - std::f64::consts::TAU, false)]
    {
        let mut points = circle(10.0, from, to, 61);
        points[60] = points[0];
        let closed = fitted(&points, &Fit { is_closed: true, ..Fit::within(1e-3) });
        let Shape::FullCircle { center, is_ccw: turns_ccw, .. } = closed.elements[0].shape else {
            panic!("not a full circle")
        };
        assert_eq!((closed.elements.len(), turns_ccw), (1, is_ccw));
        assert!((center - Point2::new(3.0, -7.0)).norm() < 1e-9);
        assert_eq!(fitted(&points, &Fit::within(1e-3)).elements.len(), 2);
    }
    // Half a circle there and back is not a full turn.
    let there_and_back: Vec<_> =
        circle(10.0, 0.0, 3.0, 31).into_iter().chain(circle(10.0, 2.9, 0.0, 30)).collect();
    let closed = fitted(&there_and_back, &Fit { is_closed: true, ..Fit::within(1e-3) });
    assert_eq!(closed.elements.len(), 2);
    // Eight corners are a polygon.
    let mut octagon = circle(10.0, 0.0, std::f64::consts::TAU, 9);
    octagon[8] = octagon[0];
    let closed = fitted(&octagon, &Fit { is_closed: true, ..Fit::within(1e-3) });
    assert!(closed.elements.iter().all(|element| !matches!(element.shape, Shape::FullCircle { .. })));
}

#[test]
fn the_last_point_is_reached_by_a_line() {
    let mut points = circle(10.0, 0.0, 1.0, 20);
    points.push(points[19] + Vector2::new(5.0, 5.0));
    for method in [Method::Greedy, Method::Optimal] {
        let elements = fitted(&points, &Fit { method, ..Fit::within(1e-4) }).elements;
        assert_eq!(elements.last(), Some(&Element::line(20, points[19], points[20])));
    }
}

#[test]
fn straight_points_are_one_line() {
    let points: Vec<_> = (0..50).map(|i| Vector2::new(i as f64, 2.0 * i as f64)).collect();
    for shapes in [Shapes::LinesOnly, Shapes::ArcsAndLines] {
        for method in [Method::Greedy, Method::Optimal] {
            let elements = fitted(&points, &Fit { shapes, method, ..Fit::within(1e-3) }).elements;
            assert_eq!(elements, [Element::line(49, points[0], points[49])]);
        }
    }
}

#[test]
fn the_number_of_elements_follows_the_growth_law() {
    // One period of a sine: the integral of (|k'| / (72 sqrt 3 tol))^(1/3) ds, by the midpoint rule.
    let n = 4000;
    let x = |i: usize| std::f64::consts::TAU * i as f64 / n as f64;
    let points: Vec<_> = (0..=n).map(|i| Vector2::new(x(i), x(i).sin())).collect();
    let curvature = |x: f64| -x.sin() / (1.0 + x.cos().powi(2)).powf(1.5);
    for tolerance in [1e-4, 1e-6] {
        let law: f64 = (0..n)
            .map(|i| {
                let speed = (1.0 + x(i).cos().powi(2)).sqrt();
                let change = (curvature(x(i + 1)) - curvature(x(i))).abs() / (x(1) * speed);
                (change / (72.0 * 3f64.sqrt() * tolerance)).cbrt() * speed * x(1)
            })
            .sum();
        let count = fitted(&points, &Fit::within(tolerance)).elements.len() as f64;
        assert!(count >= law.floor() && count < 1.15 * law + 2.0, "{count} {law}");
    }
}

#[test]
fn smooth_chains_have_no_kink_and_few_extra_elements() {
    for (points, tolerance) in
        [(sine(300), 1e-2), (sine(1000), 1e-3), (ellipse(400), 1e-3), (ellipse(600), 1e-4)]
    {
        let request = Fit::within(tolerance);
        let count = fitted(&points, &request).elements.len();
        let smooth = fitted(&points, &Fit { continuity: Continuity::Tangent, ..request });
        let worst = kinks(&smooth).into_iter().map(|(_, kink)| kink).fold(0.0, f64::max);
        assert!(worst < 1e-9, "{worst}");
        // The goal is one extra element. Elements are shorter where the curvature stops growing and starts to
        // fall.
        assert!(smooth.elements.len() <= count + 1 + count / 10, "{} {count}", smooth.elements.len());
    }
}

#[test]
fn real_corners_stay_corners() {
    // A line along x, a line upward, a quarter turn of radius 3, and a line back.
    let mut points: Vec<_> = (0..100).map(|i| Vector2::new(0.1 * f64::from(i), 0.0)).collect();
    points.extend((0..100).map(|i| Vector2::new(10.0, 0.1 * f64::from(i))));
    points.extend((0..60).map(|i| {
        let angle = std::f64::consts::FRAC_PI_2 * f64::from(i) / 60.0;
        Vector2::new(7.0 + 3.0 * angle.cos(), 10.0 + 3.0 * angle.sin())
    }));
    points.extend((0..100).map(|i| Vector2::new(7.0 - 0.1 * f64::from(i), 13.0)));
    let smooth = fitted(&points, &Fit { continuity: Continuity::Tangent, ..Fit::within(0.01) });
    let kinked: Vec<_> = kinks(&smooth).into_iter().filter(|(_, kink)| *kink > 1e-9).collect();
    assert_eq!(kinked.iter().map(|(index, _)| *index).collect::<Vec<_>>(), [100]);
    assert!((kinked[0].1 - std::f64::consts::FRAC_PI_2).abs() < 0.1);
    assert_eq!(smooth.elements.len(), 4);
}

#[test]
fn biarcs_pass_through_every_point_without_kinks() {
    let points = ellipse(80);
    let biarcs = fitted(&points, &Fit { method: Method::Biarc, ..Fit::within(1e-3) });
    assert_eq!(biarcs.elements.len(), 2 * 79);
    for (k, pair) in biarcs.elements.chunks(2).enumerate() {
        assert_eq!((pair[0].end, pair[1].end, pair[1].to().coords), (k, k + 1, points[k + 1]));
    }
    let worst = kinks(&biarcs).into_iter().map(|(_, kink)| kink).fold(0.0, f64::max);
    assert!(worst < 1e-9, "{worst}");
}

#[test]
fn arcs_in_different_planes_meet_on_points() {
    // A quarter turn in each plane, one after the other, and then a helix.
    let angle = |i: u32| std::f64::consts::FRAC_PI_2 * f64::from(i) / 20.0;
    let mut points: Vec<_> =
        (0..=20).map(|i| Point3::new(5.0 * angle(i).cos(), 5.0 * angle(i).sin(), 0.0)).collect();
    points.extend((1..=20).map(|i| Point3::new(0.0, 5.0 * angle(i).cos(), 5.0 * angle(i).sin())));
    points.extend((1..=20).map(|i| Point3::new(5.0 * angle(i).sin(), 0.0, 5.0 * angle(i).cos())));
    points.extend(
        (1..=20).map(|i| Point3::new(5.0 * angle(i).cos(), 5.0 * angle(i).sin(), f64::from(i) * 0.05)),
    );
    let pieces = fit_in_space(&points, None, &Fit::within(1e-3), &Budget::unlimited()).unwrap().curves;
    let planes: Vec<_> = pieces
        .iter()
        .map(|piece| match piece.curve {
            Curve::Arc(arc) => (arc.plane(), piece.end),
            Curve::Line(_) | Curve::Parabola(_) => panic!("not an arc"),
        })
        .collect();
    assert_eq!(planes, [(Plane::Xy, 20), (Plane::Yz, 40), (Plane::Zx, 60), (Plane::Xy, 80)]);
    for (k, piece) in pieces.iter().enumerate() {
        let start = if k == 0 { 0 } else { pieces[k - 1].end };
        assert_eq!((piece.curve.start(), piece.curve.end()), (points[start], points[piece.end]));
        let off = from_points(&piece.curve, &points[start..=piece.end]);
        assert!(off < 1e-9, "{off}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_point_is_within_the_tolerance(
        steps in prop::collection::vec((-1.0f64..1.0, -1.0f64..1.0), 2..60),
        exponent in -4i32..0,
        is_smooth: bool,
        is_greedy: bool,
    ) {
        let tolerance = 10f64.powi(exponent);
        let mut at = Vector2::zeros();
        let points: Vec<_> = steps.iter().map(|(a, b)| { at += Vector2::new(*a, 0.1 * b); at }).collect();
        let request = Fit {
            method: if is_greedy { Method::Greedy } else { Method::Optimal },
            continuity: if is_smooth { Continuity::Tangent } else { Continuity::Position },
            ..Fit::within(tolerance)
        };
        let elements = fitted(&points, &request).elements;
        let on = |p: Point2<f64>| Point3::new(p.x, p.y, 0.0);
        let in_space: Vec<_> = points.iter().map(|p| on(Point2::from(*p))).collect();
        let mut start = 0;
        for element in elements {
            let curve = match element.shape {
                Shape::Segment(Segment::Line { start, end }) => {
                    Curve::Line(Line { start: on(start), end: on(end) })
                }
                Shape::Segment(Segment::Arc(arc)) => {
                    let direction = if arc.turn() < 0.0 { Direction::Cw } else { Direction::Ccw };
                    let [start, end, center] = [arc.start(), arc.end(), arc.center()].map(on);
                    Curve::Arc(Arc::new(Plane::Xy, direction, start, end, center).unwrap())
                }
                Shape::FullCircle { .. } => unreachable!(),
            };
            let off = from_points(&curve, &in_space[start..=element.end]);
            prop_assert!(off <= tolerance * (1.0 + 1e-6) + 1e-9, "{off}");
            start = element.end;
        }
        prop_assert_eq!(start, points.len() - 1);
    }
}

/// Points within a tolerance or two of each other, about the centre of a small arc.
#[test]
fn an_arc_turns_by_at_most_half_a_turn_between_two_points() {
    let points = [
        [5.238942902159894, 0.010391403046915125],
        [5.210864226100756, 0.01079836940125084],
        [5.205696589525563, 0.014361714383258815],
        [5.206666877074161, 0.008287992642614414],
        [5.232803740229477, -0.0018391257167210164],
        [5.216097345732758, 0.029433022024428147],
        [5.242009978483482, 0.00664743987411346],
    ];
    let points = points.map(|[x, y]| Point3::new(x, y, 1.0));
    let request = Fit { joints: Joints::OnPoints, ..Fit::within(0.0213) };
    let mut first = 0;
    for piece in fit_in_space(&points, None, &request, &Budget::unlimited()).unwrap().curves {
        assert!(from_points(&piece.curve, &points[first..=piece.end]) <= 0.0213 + 1e-9, "{piece:?}");
        first = piece.end;
    }
}
