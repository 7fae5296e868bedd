use nalgebra::Point2;
use proptest::prelude::*;

use super::*;

fn elements() -> Vec<Element> {
    let (start, end) = (Point2::new(1.0, 2.0), Point2::new(4.0, 3.0));
    vec![
        Segment::Line { start, end }.into(),
        Segment::bulging(start, end, 0.4).into(),
        Segment::bulging(start, end, -1.7).into(),
        Element::Parabola { start, control: Point2::new(2.0, 4.5), end },
        Element::Parabola { start, control: Point2::new(3.5, 1.0), end },
    ]
}

/// A point of the element or of its continuation, by its definition.
fn point(element: &Element, u: f64) -> Point2<f64> {
    match element {
        Element::Segment(Segment::Line { start, end }) => start + (end - start) * u,
        Element::Segment(Segment::Arc(arc)) => {
            let turn = nalgebra::Rotation2::new(arc.turn() * u);
            arc.center() + turn * (arc.start() - arc.center())
        }
        Element::Parabola { start, control, end } => {
            let (a, b) = (start + (control - start) * u, control + (end - control) * u);
            a + (b - a) * u
        }
    }
}

#[test]
fn a_point_beside_the_element_has_its_foot_where_the_normal_starts() {
    for element in elements() {
        for k in 0..=20 {
            let u = f64::from(k) / 20.0;
            let (p, q) = (point(&element, u - 1e-6), point(&element, u + 1e-6));
            let tangent = (q - p).normalize();
            let left = Vector2::new(-tangent.y, tangent.x);
            for distance in [-0.2, -1e-3, 0.0, 1e-3, 0.2] {
                let beside = point(&element, u) + left * distance;
                let (foot, slip) = element.foot(beside, (u + 0.1).min(1.0));
                assert!((foot.u - u).abs() < 1e-6, "{element:?} {u} {foot:?}");
                assert!((foot.distance - distance).abs() < 1e-8, "{element:?} {u} {distance} {foot:?}");
                assert!((foot.tangent - tangent).norm() < 1e-6 && slip < 1e-12);
            }
        }
    }
}

#[test]
fn the_feet_of_the_ends_are_at_zero_and_one() {
    for element in elements() {
        let [start, end] = [(element.start(), 0.0), (element.end(), 1.0)].map(|(p, u)| element.foot(p, u).0);
        assert!(start.u.abs() < 1e-14 && (end.u - 1.0).abs() < 1e-14, "{element:?}");
        assert!(start.distance.abs() < 1e-14 && end.distance.abs() < 1e-14, "{element:?}");
    }
}

#[test]
fn the_way_between_two_feet_is_no_longer_than_the_speed_allows() {
    let (start, end) = (Point2::origin(), Point2::new(1.0, 0.0));
    let hairpin = Element::Parabola { start, control: Point2::new(0.5, 40.0), end };
    for element in elements().into_iter().chain([hairpin]) {
        for [from, to] in [[0.0, 1.0], [-0.4, 1.4], [0.9, 6.0], [-30.0, -2.0], [-3.0, 12.0]] {
            let at = |k: u32| point(&element, from + (to - from) * f64::from(k) / 1000.0);
            let way: f64 = (0..1000).map(|k| (at(k + 1) - at(k)).norm()).sum();
            let most = element.speed([from, to]).hi() * (to - from);
            assert!(way <= most * (1.0 + 1e-12), "{element:?} from {from} to {to}: {way} > {most}");
        }
    }
}

#[test]
fn a_parabola_goes_through_its_three_points() {
    let points = [Point2::new(0.0, 0.0), Point2::new(1.0, 2.0), Point2::new(3.0, -1.0)];
    let element = Element::parabola_through(points);
    for (p, u) in points.into_iter().zip([0.0, 0.5, 1.0]) {
        assert!((point(&element, u) - p).norm() < 1e-15);
    }
}

#[test]
fn graphs_have_the_heights_and_second_derivatives_of_their_functions() {
    let (start, end) = (Point2::new(0.0, 0.0), Point2::new(2.0, 4.0));
    let square = Element::Parabola { start, control: Point2::new(1.0, 0.0), end };
    assert!((square.graph_at(1.5).unwrap() - 2.25).abs() < 1e-14);
    assert!(square.graph_bend(0.0, 2.0).contains(2.0));
    let arc = Segment::bulging(Point2::new(-3.0, 4.0), Point2::new(3.0, 4.0), 0.333_333_333_333_333_3);
    let arc = Element::from(arc);
    assert!((arc.graph_at(0.0).unwrap() - 5.0).abs() < 1e-12);
    let bend = arc.graph_bend(0.0, 1.0);
    assert!(bend.contains(-0.2) && bend.contains(-25.0 / 24f64.powf(1.5)), "{bend:?}");
    assert_eq!(Element::from(Segment::bulging(start, end, 1.0)).graph_at(1.0), None);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_enclosure_contains_the_sampled_curvature(u in 0.0..1.0f64, v in 0.0..1.0f64, w in 0.0..1.0f64) {
        for element in elements() {
            let (low, high) = (u.min(v), u.max(v));
            let range = element.curvature(low, high);
            let t = low + (high - low) * w;
            const H: f64 = 1e-4;
            let [p, q, r] = [t - H, t, t + H].map(|t| point(&element, t));
            let (a, b) = (q - p, r - q);
            let curvature = 2.0 * a.perp(&b) / (a.norm() * b.norm() * (r - p).norm());
            prop_assert!(range.lo() - 1e-4 <= curvature && curvature <= range.hi() + 1e-4);
        }
    }
}
