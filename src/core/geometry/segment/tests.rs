use std::f64::consts::{FRAC_PI_2, PI};

use proptest::prelude::*;

use super::*;

/// A line, a quarter to the left, and three quarters to the right.
fn segments() -> [Segment; 3] {
    let (start, end) = (Point2::new(4.0, 2.0), Point2::new(1.0, 5.0));
    [
        Segment::Line { start, end },
        Segment::about(Point2::new(1.0, 2.0), 3.0, [start, end], FRAC_PI_2),
        Segment::about(Point2::new(1.0, 2.0), 3.0, [start, end], -1.5 * PI),
    ]
}

#[track_caller]
fn assert_at(found: Point2<f64>, x: f64, y: f64) {
    assert!((found - Point2::new(x, y)).norm() < 1e-14, "{found} instead of {x}, {y}");
}

#[test]
fn one_bulge_one_turn_and_one_centre_give_the_same_arc() {
    for segment in &segments()[1..] {
        let (start, end, turn) = (segment.start(), segment.end(), segment.turn());
        for again in [Segment::turning(start, end, turn), Segment::bulging(start, end, -(turn / 4.0).tan())] {
            let (Segment::Arc(one), Segment::Arc(other)) = (segment, again) else { panic!("{again:?}") };
            assert!(
                (one.center() - other.center()).norm() < 1e-14 && (one.turn() - other.turn()).abs() < 1e-14
            );
            assert!((one.radius() - other.radius()).abs() < 1e-14, "{other:?}");
        }
    }
}

#[test]
fn no_bulge_no_turn_no_radius_and_no_chord_give_a_line() {
    let [a, b] = [Point2::new(4.0, 2.0), Point2::new(1.0, 5.0)];
    let line = Segment::Line { start: a, end: b };
    assert_eq!(
        [Segment::bulging(a, b, 0.0), Segment::bulging(a, b, -0.0), Segment::turning(a, b, 0.0)],
        [line; 3]
    );
    assert_eq!(Segment::about(Point2::new(1.0, 2.0), 3.0, [a, b], 0.0), line);
    let point = Segment::Line { start: a, end: a };
    assert_eq!([Segment::bulging(a, a, 0.5), Segment::about(a, 0.0, [a, a], PI)], [point; 2]);
    let Segment::Arc(arc) = segments()[1] else { panic!("no arc") };
    assert_eq!(arc.between([a, a], 0.0), point);
}

#[test]
fn lengths_places_and_tangents_are_those_of_lines_and_circles() {
    let [line, quarter, rest] = segments();
    let root = 0.5_f64.sqrt();
    for (segment, length, curvature) in
        [(line, 18f64.sqrt(), 0.0), (quarter, 1.5 * PI, 1.0 / 3.0), (rest, 4.5 * PI, -1.0 / 3.0)]
    {
        assert!((segment.length() - length).abs() < 1e-14);
        assert_eq!(segment.curvature(), curvature);
        assert_eq!([segment.at(0.0), segment.at(1.0)], [segment.start(), segment.end()]);
        let directions = [segment.direction(0.0), segment.direction(1.0)];
        for (one, other) in segment.tangents().into_iter().zip(directions) {
            assert!((one - other).norm() < 1e-14, "{segment:?}");
        }
    }
    assert_at(line.at(0.5), 2.5, 3.5);
    assert_at(quarter.at(0.5), 1.0 + 3.0 * root, 2.0 + 3.0 * root);
    assert_at(rest.at(0.5), 1.0 - 3.0 * root, 2.0 - 3.0 * root);
    assert_at(Point2::from(line.direction(0.3)), -root, root);
    assert_at(Point2::from(quarter.direction(0.0)), 0.0, 1.0);
    assert_at(Point2::from(rest.direction(0.0)), 0.0, -1.0);
}

#[test]
fn a_segment_run_back_or_mirrored_or_turned_passes_the_same_places() {
    let rotation = Rotation2::new(0.7);
    for segment in segments() {
        for t in [0.0, 0.25, 0.6, 1.0] {
            let p = segment.at(t);
            assert!((segment.reversed().at(1.0 - t) - p).norm() < 1e-14);
            assert!((segment.mirrored().at(t) - Point2::new(-p.x, p.y)).norm() < 1e-14);
            assert!((segment.rotated(&rotation).at(t) - rotation * p).norm() < 1e-14);
            assert!((segment.part(0.2, 0.9).at(t) - segment.at(0.2 + 0.7 * t)).norm() < 1e-14);
        }
        let (middle, reach) = segment.disc();
        assert!((0..=20).all(|k| (segment.at(f64::from(k) / 20.0) - middle).norm() <= reach + 1e-14));
    }
}

#[test]
fn the_foot_and_the_distance_of_a_point_are_where_the_normal_starts() {
    for segment in segments() {
        for (u, beside) in [(0.0, 0.5), (0.3, -0.7), (0.8, 2.0), (1.0, 0.0)] {
            let p = segment.at(u) + left(segment.direction(u)) * beside;
            let foot = segment.foot(p);
            assert!((foot.u - u).abs() < 1e-14 && (foot.distance - beside).abs() < 1e-14, "{foot:?}");
            assert!((foot.tangent - segment.direction(u)).norm() < 1e-14);
            assert!((segment.distance_to(p) - beside.abs()).abs() < 1e-14);
            assert!((segment.distance_to_carrier(p) - beside.abs()).abs() < 1e-14);
            assert!((segment.nearest(p) - segment.at(u)).norm() < 1e-14);
        }
    }
    // Beyond an end, the end is nearest.
    for segment in &segments()[..2] {
        let beyond = segment.end() + segment.direction(1.0) * 0.1;
        assert_eq!(segment.nearest(beyond), segment.end());
        assert!((segment.distance_to(beyond) - 0.1).abs() < 1e-14 && segment.foot(beyond).u > 1.0);
    }
}

#[test]
fn an_arc_covers_the_spokes_that_it_turns_past() {
    let [_, quarter, rest] = segments();
    for (segment, covered) in [(quarter, [0.1, 0.8, 1.5]), (rest, [2.0, 3.5, 6.0])] {
        let Segment::Arc(arc) = segment else { panic!("no arc") };
        for angle in [0.1, 0.8, 1.5, 2.0, 3.5, 6.0_f64] {
            let spoke = Vector2::new(angle.cos(), angle.sin());
            assert_eq!(arc.covers(spoke), covered.contains(&angle), "{angle}");
            assert_eq!(arc.covers(spoke), arc.angle_to(spoke) <= arc.turn().abs(), "{angle}");
        }
    }
}

#[test]
fn lines_and_circles_meet_where_they_are_equally_far_from_both_centres() {
    let place = |p: Option<Point2<f64>>| p.unwrap();
    let [a, b, c, d] = [[0.0, 0.0], [2.0, 2.0], [4.0, 0.0], [0.0, 4.0]].map(Point2::from);
    assert_at(place(lines_meet([a, b], [c, d])), 2.0, 2.0);
    assert_eq!(lines_meet([a, b], [b, a]), None);
    let [first, last] = circle_meets(5.0, Vector2::new(9.0, 3.0), Vector2::x()).unwrap();
    assert_eq!([first, last], [Vector2::new(-4.0, 3.0), Vector2::new(4.0, 3.0)]);
    assert_eq!(circle_meets(5.0, Vector2::new(9.0, 5.1), Vector2::x()), None);
    for (radius, other) in [(5.0, 4.0), (4.0, 5.0)] {
        let apart = Vector2::new(3.0, 1.0);
        for spoke in circles_meet(radius, apart, other).unwrap() {
            assert!((spoke.norm() - radius).abs() < 1e-14 && ((spoke - apart).norm() - other).abs() < 1e-14);
        }
    }
    assert_eq!(circles_meet(1.0, Vector2::new(3.0, 1.0), 1.0), None);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// The closed form is no larger than the distance of any two sampled places, and no smaller than allowed
    /// by the steps between the samples.
    #[test]
    fn the_distance_of_two_segments_is_the_least_over_all_their_places(
        ends in prop::array::uniform8(-5.0..5.0_f64),
        bulges in prop::array::uniform2(prop_oneof![Just(0.0), -3.0..3.0_f64]),
    ) {
        let at = |k: usize| Point2::new(ends[2 * k], ends[2 * k + 1]);
        let [one, other] = [0, 1].map(|k| Segment::bulging(at(2 * k), at(2 * k + 1), bulges[k]));
        let (least, place) = one.distance_between(&other);
        prop_assert!(one.distance_to(place) < 1e-9 || other.distance_to(place) < 1e-9);
        let sampled = (0..=200)
            .map(|k| other.distance_to(one.at(f64::from(k) / 200.0)))
            .fold(f64::INFINITY, f64::min);
        prop_assert!(least <= sampled + 1e-9, "{} {}", least, sampled);
        prop_assert!(sampled <= least + one.length() / 400.0 + 1e-9, "{} {}", least, sampled);
        prop_assert!((other.distance_between(&one).0 - least).abs() < 1e-9);
    }
}
