use std::f64::consts::PI;

use nalgebra::{Point, Point2, Point3};
use proptest::prelude::*;

use super::*;
use crate::geometry::plane_curve::PlaneCurve;

fn plane(text: &str) -> Chain<2> {
    match SectionCurve::parse(text) {
        Ok(SectionCurve::Plane(chain)) => chain,
        other => panic!("{other:?}"),
    }
}

fn space(text: &str) -> Chain<3> {
    match SectionCurve::parse(text) {
        Ok(SectionCurve::Space(chain)) => chain,
        other => panic!("{other:?}"),
    }
}

fn error(text: &str) -> (usize, Fault) {
    let error = SectionCurve::parse(text).unwrap_err();
    (error.at, error.fault)
}

#[test]
fn a_text_that_breaks_the_grammar_is_refused_with_its_place() {
    let item = "an item: l(...), r(...) or b(...)";
    let (open, next) = ("an opening parenthesis", "a comma or a closing parenthesis");
    for (text, at, expected) in [
        ("", 0, item),
        ("  ", 2, item),
        ("x(1,2)", 0, item),
        ("L(1,2)", 0, item),
        ("é", 0, item),
        ("l(0,0) é(1,2)", 7, item),
        ("l", 1, open),
        ("l 1,2)", 2, open),
        ("line(1,2)", 1, open),
        ("l(1,2", 5, next),
        ("l(1;2)", 3, next),
        ("l(1 2)", 4, next),
        ("l(1,2))", 6, "white space before the next item"),
        ("l(1,2)l(3,4)", 6, "white space before the next item"),
        ("l(0,0),l(3,4)", 6, "white space before the next item"),
        ("l()", 2, "a number"),
        ("l(1,)", 4, "a number"),
        ("l(1,NaN)", 4, "a number"),
        ("l(1,inf)", 4, "a number"),
        ("l(1,-)", 5, "a number"),
        ("l(1,.)", 5, "a number"),
        ("l(1,0x1)", 5, next),
        ("l(1,2e)", 5, next),
        ("l(1,--2)", 5, "a number"),
        ("l(1,\u{661})", 4, "a number"),
        ("b()", 2, open),
        ("b(x,2)", 2, open),
        ("b(1,2),", 7, open),
        ("b(1,2),3", 7, open),
        ("b(1,2),(3,4", 11, next),
        ("b(1,2),(3,4))", 12, "white space before the next item"),
        ("b(1,2) (3,4)", 7, item),
        ("b(1,(2))", 4, "a number"),
        ("b((1,2),3,4)", 8, open),
        ("b((1,2),(3,4)", 13, next),
        ("b((1,2) (3,4))", 8, next),
        ("b(((1,2)))", 3, "a number"),
    ] {
        assert_eq!(error(text), (at, Fault::Syntax { expected }), "{text}");
    }
}

#[test]
fn an_impossible_item_is_refused_with_its_place() {
    for (text, at, fault) in [
        ("l(0,0)", 0, Fault::OnePoint),
        (" l(0,0,0) ", 1, Fault::OnePoint),
        ("b((0,0))", 0, Fault::OneSmoothPoint),
        ("b(0,0)", 0, Fault::OneSmoothPoint),
        ("b(0,0), (1,1,1)", 8, Fault::Dimension { expected: 2, found: 3 }),
        ("b(0,0), (1,1), (1,1)", 15, Fault::Coincident),
        ("r(0,0,1) l(1,1)", 0, Fault::CornerAtEnd),
        ("l(0,0) r(1,1,1)", 7, Fault::CornerAtEnd),
        ("l(0,0) l(1,1,1)", 8, Fault::Dimension { expected: 2, found: 3 }),
        ("l(0,0,0) l(1,1)", 10, Fault::Dimension { expected: 3, found: 2 }),
        ("l(0,0,0) r(5,1,1) l(9,9,9)", 10, Fault::Dimension { expected: 3, found: 2 }),
        ("l(0,0) b((1,1),(1,2,3))", 15, Fault::Dimension { expected: 2, found: 3 }),
        ("l(0) l(1,1)", 1, Fault::NumberCount { found: 1 }),
        ("l(0,0,0,0) l(1,1)", 1, Fault::NumberCount { found: 4 }),
        ("l(0,0) r(1,1) l(2,0)", 8, Fault::NumberCount { found: 2 }),
        ("l(0,0) r(1,2,3,4,5) l(2,0)", 17, Fault::NumberCount { found: 5 }),
        ("l(0,0) l(1,1e999)", 11, Fault::NumberTooLarge),
        ("l(0,0) l(1,-1000001)", 11, Fault::NumberTooLarge),
        ("l(0,0) r(5,0,-1) l(5,5)", 7, Fault::NegativeRadius { radius_mm: -1.0 }),
        ("l(0,0) l(0,0)", 7, Fault::Coincident),
        ("l(0,0) b((0,0),(1,1))", 7, Fault::Coincident),
        ("b((0,0),(1,1),(1,1))", 14, Fault::Coincident),
        ("b((0,0),(1,1)) r(1,1,2) l(5,5)", 15, Fault::Coincident),
        ("l(0,0) r(9,0,1) l(4,0)", 7, Fault::Reversal { radius_mm: 1.0 }),
        ("l(0.1,0.7) r(9.3,3.1,1) l(0.1,0.7)", 11, Fault::Reversal { radius_mm: 1.0 }),
    ] {
        assert_eq!(error(text), (at, fault), "{text}");
    }
    let message = SectionCurve::parse("l(0,0) l(0,0)").unwrap_err().to_string();
    assert_eq!(message, "the point coincides with the point before it; leave one of them out (at byte 7)");
}

#[test]
fn corners_that_do_not_fit_are_refused_with_their_place() {
    for (text, at, radius_mm) in [
        ("l(0,0) r(10,0,10.001) l(10,50)", 7, 10.001),
        ("l(0,0) r(50,0,10.001) l(50,10)", 7, 10.001),
        // Two corners on a line of 10 mm: each fits alone, or only one of them does.
        ("l(0,0) r(50,0,6) r(50,10,4.5) l(90,10)", 17, 4.5),
        ("l(0,0) r(50,0,11) r(50,10,1) l(90,10)", 7, 11.0),
        ("l(0,0) r(50,0,1) r(50,10,11) l(90,10)", 17, 11.0),
        // The neighbour of the corner is the end of a `b`.
        ("b((0,0),(40,0)) r(50,0,11) l(50,90)", 16, 11.0),
    ] {
        let (place, fault) = error(text);
        assert!(matches!(fault, Fault::CornerDoesNotFit { radius_mm: r, .. } if r == radius_mm), "{fault}");
        assert_eq!(place, at, "{text}");
    }
    // Tangents that meet exactly leave no line between the arcs.
    for text in
        ["l(0,0) r(10,0,10) l(10,10)", "l(0,0) r(50,0,5) r(50,10,5) l(90,10)", "l(0,0) r(3,1,1.05) l(0,2)"]
    {
        assert!(SectionCurve::parse(text).is_ok(), "{text}");
    }
    assert_eq!(plane("l(0,0) r(10,0,10) l(10,10)").pieces().len(), 1);
    assert_eq!(plane("l(0,0) r(50,0,5) r(50,10,5) l(90,10)").pieces().len(), 4);
}

#[test]
fn hostile_texts_are_refused_quickly() {
    for text in [
        "(".repeat(TEXT_LIMIT),
        format!("b{}", "(".repeat(TEXT_LIMIT - 1)),
        format!("l({})", "9".repeat(TEXT_LIMIT - 3)),
        format!("l(0.{})", "3".repeat(TEXT_LIMIT - 5)),
        format!("l(0,1e{})", "9".repeat(TEXT_LIMIT - 7)),
        format!("l(0,{}1)", "-".repeat(TEXT_LIMIT - 7)),
        "l(0,0)\n".repeat(POINT_LIMIT),
        " ".repeat(TEXT_LIMIT),
        "\u{1f980}".repeat(TEXT_LIMIT / 4),
    ] {
        assert!(SectionCurve::parse(&text).is_err());
    }
    assert_eq!(error(&" ".repeat(TEXT_LIMIT + 1)), (TEXT_LIMIT, Fault::TextTooLong));
    assert_eq!(error(&"l(0,0) ".repeat(POINT_LIMIT + 1)), (7 * POINT_LIMIT, Fault::TooManyPoints));
    let many = format!("b({}(0,0))", "(0,0),".repeat(POINT_LIMIT));
    assert_eq!(error(&many), (0, Fault::TooManyPoints));
    let most: String = (0..POINT_LIMIT).map(|k| format!("l({k},{}) ", k % 2)).collect();
    assert_eq!(plane(&most).curve().unwrap().breaks().len(), POINT_LIMIT - 2);
}

#[test]
fn white_space_and_numbers_are_read_as_written() {
    let chain = plane("\n l ( +1. , .5 )\tr( 1E1,-0.5e+1 , 0 ) \r\n b( (20,0) , ( 30 , 4 ) ) ");
    assert_eq!(chain.places(), [2, 17, 41]);
    let p = |x: f64, y: f64| Point2::new(x, y);
    let items = [
        Item::Point(p(1.0, 0.5)),
        Item::Point(p(10.0, -5.0)),
        Item::Smooth(vec![p(20.0, 0.0), p(30.0, 4.0)]),
    ];
    assert_eq!(chain.items(), items);
}

#[test]
fn parameters_along_lines_grow_by_the_length() {
    let curve = plane("l(1,1) l(4,5) r(4,15,0) l(-8,10)").curve().unwrap();
    assert_eq!(curve.domain(), [0.0, 28.0]);
    assert_eq!(curve.breaks(), [5.0, 15.0]);
    assert!((curve.point(2.5) - Point2::new(2.5, 3.0)).norm() < 1e-15);
    assert_eq!(curve.point(28.0), Point2::new(-8.0, 10.0));
}

#[test]
fn a_rounded_right_angle_is_a_quarter_circle() {
    let curve = plane("l(0,0) r(50,0,10) l(50,40)").curve().unwrap();
    assert_eq!(curve.breaks()[0], 40.0);
    assert!((curve.breaks()[1] - (40.0 + 5.0 * PI)).abs() < 1e-13);
    assert!((curve.domain()[1] - (70.0 + 5.0 * PI)).abs() < 1e-13);
    for k in 0..=100 {
        let t = 40.0 + 5.0 * PI * f64::from(k) / 100.0;
        assert!(((curve.point(t) - Point2::new(40.0, 10.0)).norm() - 10.0).abs() < 1e-13);
    }
}

#[test]
fn corners_without_a_turn_are_points_of_the_line() {
    for text in ["l(0,0) r(5,0,3) l(9,0)", "l(0,0) r(0.3,0.1,1000) l(0.9,0.3)", "l(0,0) r(1,1e-15,9) l(2,0)"]
    {
        let chain = plane(text);
        assert!(chain.pieces().iter().all(|s| matches!(s.shape, Shape::Line(_))), "{text}");
        assert_eq!(chain.pieces().len(), 2);
    }
}

#[test]
fn a_smooth_curve_passes_through_its_points_with_natural_ends() {
    let curve = plane("l(-10,0) b((0,0),(10,5),(20,0),(35,0)) r(45,0,1) l(45,10)").curve().unwrap();
    let chords = 2.0 * 125.0f64.sqrt() + 15.0;
    let span = chords / 3.0;
    let points = [(0.0, 0.0), (10.0, 5.0), (20.0, 0.0), (35.0, 0.0)];
    for (k, (x, y)) in points.into_iter().enumerate() {
        let t = 10.0 + span * k as f64;
        assert!((curve.point(t) - Point2::new(x, y)).norm() < 1e-13);
        assert!((curve.breaks()[k] - t).abs() < 1e-13);
    }
    let at = |k: usize| curve.breaks()[k];
    let second = |from: f64, to: f64| curve.enclose(from, to).second.map(|x| x.mid());
    for c in 0..2 {
        assert!(second(at(0), at(0).next_up())[c].abs() < 1e-12);
        assert!(second(at(3).next_down(), at(3))[c].abs() < 1e-12);
        for k in [1, 2] {
            let jump = second(at(k).next_down(), at(k))[c] - second(at(k), at(k).next_up())[c];
            assert!(jump.abs() < 1e-12);
        }
    }
    // The line does not arrive along the tangent of the smooth curve.
    let turn = curve.derivative(at(0).next_down()).perp(&curve.derivative(at(0)));
    assert!(turn.abs() > 0.1);
}

#[test]
fn the_printed_form_of_a_smooth_curve_is_read_beside_the_enclosed_form() {
    for (printed, enclosed) in [
        ("b(0,0), (1,2), (3,1)", "b((0,0),(1,2),(3,1))"),
        ("l(-5,0) b ( 0 , 0 ) ,\n(1,2) l(9,9)", "l(-5,0) b((0,0),(1,2)) l(9,9)"),
        ("b(-1,+2),(.5,-3) b(9,0),(8,1)", "b((-1,2),(.5,-3)) b((9,0),(8,1))"),
    ] {
        assert_eq!(plane(printed).pieces(), plane(enclosed).pieces(), "{printed}");
    }
    assert_eq!(space("b(0,0,1),(2,2,2)").pieces(), space("b((0,0,1),(2,2,2))").pieces());
}

#[test]
fn the_curves_of_the_examples_are_read() {
    let basic = space("l(0,0,0) r(50,0,0,10) l(50,40,0)");
    assert_eq!(basic.pieces().len(), 3);
    let drive = space("b((0,0,0),(10,0,5),(20,0,0))");
    assert_eq!(drive.pieces().len(), 2);
    assert_eq!(plane("l(0,0) l(10,5)").pieces().len(), 1);
}

/// The centre of the circle that touches the lines of a corner.
fn center<const D: usize>([before, at, after]: [Point<f64, D>; 3], radius: f64) -> Point<f64, D> {
    let (u, v) = ((before - at).normalize(), (after - at).normalize());
    let half = 0.5 * u.dot(&v).clamp(-1.0, 1.0).acos();
    at + (u + v).normalize() * (radius / half.sin())
}

/// The point of an arc at `u` from 0 to 1.
fn on_arc<const D: usize>(p: &[Point<f64, D>; 3], w: f64, u: f64) -> Point<f64, D> {
    let [a, b, c] = [(1.0 - u) * (1.0 - u), 2.0 * u * (1.0 - u) * w, u * u];
    let middle = p[1];
    middle + ((p[0] - middle) * a + (p[2] - middle) * c) / (a + b + c)
}

proptest! {
    #[test]
    fn arcs_are_round_and_touch(
        corner in prop::array::uniform9(-100.0f64..100.0), share in 0.01f64..1.0, u in 0.0f64..1.0,
    ) {
        let p = [0, 3, 6].map(|k| Point3::new(corner[k], corner[k + 1], corner[k + 2]));
        let (u0, u1) = ((p[0] - p[1]).normalize(), (p[2] - p[1]).normalize());
        let half_turn = 0.5 * (PI - u0.dot(&u1).acos());
        // Other turns would make the rounding of the coordinates too large.
        prop_assume!(half_turn > 0.02 && half_turn < 1.5);
        let radius = share * (p[0] - p[1]).norm().min((p[2] - p[1]).norm()) / half_turn.tan();
        prop_assume!(radius < 1e4);
        let triple = |p: Point3<f64>| format!("{:?},{:?},{:?}", p.x, p.y, p.z);
        let text = format!("l({}) r({},{radius:?}) l({})", triple(p[0]), triple(p[1]), triple(p[2]));
        let chain = space(&text);
        let center = center(p, radius);
        let mut turned = 0.0;
        let mut end = p[0];
        for piece in chain.pieces() {
            let length = piece.ends[1] - piece.ends[0];
            let (start, leaving) = match &piece.shape {
                Shape::Line([from, to]) => {
                    prop_assert!(((to - from).norm() - length).abs() < 1e-11);
                    (*from, *to)
                }
                Shape::Arc { points, weight } => {
                    let error = (on_arc(points, *weight, u) - center).norm() / radius - 1.0;
                    prop_assert!(error.abs() < 1e-12 * (1.0 + 200.0 / radius), "{error}");
                    prop_assert!(*weight >= 0.5f64.sqrt() - 1e-12);
                    turned += length / radius;
                    (points[0], points[2])
                }
                Shape::Cubic(_) => return Err(TestCaseError::fail("a cubic")),
            };
            prop_assert_eq!(start, end);
            end = leaving;
        }
        prop_assert_eq!(end, p[2]);
        prop_assert!((turned - 2.0 * half_turn).abs() < 1e-9);
    }

    #[test]
    fn curves_are_continuous_and_smooth_at_roundings(
        points in prop::collection::vec((-100.0f64..100.0, -100.0f64..100.0), 3..8),
    ) {
        // Each radius takes a third of the shorter line at its corner.
        let p: Vec<_> = points.iter().map(|(x, y)| Point2::new(*x, *y)).collect();
        let mut text = format!("l({:?},{:?})", p[0].x, p[0].y);
        for three in p.windows(3) {
            let (u, v) = ((three[1] - three[0]), (three[2] - three[1]));
            let half_turn = 0.5 * u.angle(&v);
            if u.norm() < 0.1 || v.norm() < 0.1 || !(0.01..1.5).contains(&half_turn) {
                return Err(TestCaseError::reject("a line too short or a turn too sharp for an arc"));
            }
            let radius = u.norm().min(v.norm()) / 3.0 / half_turn.tan();
            text += &format!(" r({:?},{:?},{radius:?})", three[1].x, three[1].y);
        }
        text += &format!(" l({:?},{:?})", p[p.len() - 1].x, p[p.len() - 1].y);
        let curve = plane(&text).curve().unwrap();
        // Each arc begins and ends with a break, and an arc of more than a right angle has more of them.
        prop_assert!(curve.breaks().len() >= 2 * (p.len() - 2));
        for t in curve.breaks() {
            let (before, after) = (curve.derivative(t.next_down()), curve.derivative(*t));
            prop_assert!(before.normalize().perp(&after.normalize()).abs() < 1e-11);
            prop_assert!(before.dot(&after) > 0.0);
        }
    }

    #[test]
    fn no_text_panics(text in "[lrb(),. 0-9e+é\n-]{0,60}") {
        if let Ok(SectionCurve::Plane(chain)) = SectionCurve::parse(&text) {
            prop_assert!(chain.curve().is_ok());
        }
    }
}
