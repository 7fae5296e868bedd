use std::f64::consts::FRAC_1_SQRT_2;

use proptest::prelude::*;

use super::*;
use crate::geometry::bspline::End;
use crate::geometry::plane_curve::PlaneCurve;

/// A B-spline basis function by its definition (Cox and de Boor), on half-open spans.
fn basis(knots: &[f64], k: usize, degree: usize, t: f64) -> f64 {
    if degree == 0 {
        return if knots[k] <= t && t < knots[k + 1] { 1.0 } else { 0.0 };
    }
    let part = |above: f64, below: f64, value: f64| if below > 0.0 { above / below * value } else { 0.0 };
    part(t - knots[k], knots[k + degree] - knots[k], basis(knots, k, degree - 1, t))
        + part(
            knots[k + degree + 1] - t,
            knots[k + degree + 1] - knots[k + 1],
            basis(knots, k + 1, degree - 1, t),
        )
}

fn by_definition(nurbs: &Nurbs, t: f64) -> Point2<f64> {
    let mut sum = Vector3::zeros();
    for (i, p) in nurbs.control_points.iter().enumerate() {
        let weight = nurbs.weights.as_ref().map_or(1.0, |weights| weights[i]);
        sum += (p.coords * weight).push(weight) * basis(&nurbs.knots, i, nurbs.degree, t);
    }
    Point2::from(sum.xy() / sum.z)
}

fn any_nurbs() -> impl Strategy<Value = Nurbs> {
    let entries = prop::collection::vec((-1.0f64..1.0, -1.0f64..1.0, 0.2f64..4.0), 7..30);
    let steps = prop::collection::vec(0u8..4, 38);
    (1usize..=7, steps, entries, any::<bool>()).prop_map(|(degree, steps, entries, is_rational)| {
        let n = entries.len().max(degree + 1);
        let entries: Vec<_> = entries.into_iter().cycle().take(n).collect();
        // A step of zero repeats a knot, up to the degree. The first and the last span have a length, so that
        // every control point has an effect.
        let (mut knot, mut run) = (-1.0, 0);
        let knots = steps.iter().enumerate().take(n + degree + 1).map(|(k, step)| {
            let is_inside = k != degree + 1 && k != n;
            run = if is_inside && *step == 0 && run + 1 < degree { run + 1 } else { 0 };
            knot += if run > 0 { 0.0 } else { f64::from((*step).max(1)) };
            knot
        });
        Nurbs {
            degree,
            knots: knots.collect(),
            control_points: entries.iter().map(|(x, y, _)| Point2::new(*x, *y)).collect(),
            weights: is_rational.then(|| entries.iter().map(|(_, _, w)| *w).collect()),
        }
    })
}

proptest! {
    #[test]
    fn pieces_agree_with_the_definition(nurbs in any_nurbs(), share in 0.0f64..0.999) {
        let curve = match nurbs.curve() {
            Ok(curve) => curve,
            Err(other) => return Err(TestCaseError::fail(other.to_string())),
        };
        let [start, end] = curve.domain();
        prop_assert_eq!([start, end], [nurbs.knots[nurbs.degree], nurbs.knots[nurbs.control_points.len()]]);
        let t = start + share * (end - start);
        let distance = (curve.point(t) - by_definition(&nurbs, t)).norm();
        prop_assert!(distance < 1e-12, "{distance}");
        let enclosure = curve.enclose(t, t).point;
        prop_assert!(enclosure[0].contains(curve.point(t).x) && enclosure[1].contains(curve.point(t).y));
    }
}

/// The circle of radius 40 about (100, -3), in four quadratic pieces.
fn circle() -> Nurbs {
    let corners = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)];
    Nurbs {
        degree: 2,
        knots: vec![0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 4.0, 4.0, 4.0],
        control_points: corners
            .map(|(x, y)| Point2::new(100.0 + 40.0 * f64::from(x), -3.0 + 40.0 * f64::from(y)))
            .to_vec(),
        weights: Some((0..9).map(|k| if k % 2 == 0 { 1.0 } else { FRAC_1_SQRT_2 }).collect()),
    }
}

#[test]
fn a_nurbs_circle_keeps_its_radius() {
    let curve = circle().curve().unwrap();
    assert_eq!(curve.breaks(), [1.0, 2.0, 3.0]);
    let center = Point2::new(100.0, -3.0);
    for k in 0..=4000 {
        let p = curve.point(f64::from(k) / 1000.0);
        assert!(((p - center).norm() - 40.0).abs() < 1e-13, "{k}");
    }
    let quarter = curve.enclose(1.0, 2.0).point;
    assert!((quarter[0].lo() - 60.0).abs() < 1e-10 && (quarter[0].hi() - 100.0).abs() < 1e-10);
}

#[test]
fn unclamped_knots_give_the_inner_spans() {
    let points = (0..5).map(|k| Point2::new(f64::from(k), 0.0)).collect();
    let knots = (0..9).map(f64::from).collect();
    let curve = Nurbs { degree: 3, knots, control_points: points, weights: None }.curve().unwrap();
    assert_eq!(curve.domain(), [3.0, 5.0]);
    assert_eq!(curve.breaks(), [4.0]);
    assert!((curve.point(3.0).x - 1.0).abs() < 1e-15);
    assert!((curve.point(5.0).x - 3.0).abs() < 1e-15);
}

#[test]
fn control_points_at_clamped_knots_are_passed_exactly() {
    let points: Vec<_> = (0..7).map(|k| Point2::new(0.1 * f64::from(k), 1.0 / f64::from(k + 3))).collect();
    let knots = vec![0.0, 0.0, 0.0, 0.0, 0.3, 0.3, 0.3, 1.0, 1.0, 1.0, 1.0];
    let nurbs = Nurbs { degree: 3, knots, control_points: points.clone(), weights: None };
    let curve = nurbs.curve().unwrap();
    assert_eq!([0.0, 0.3, 1.0].map(|t| curve.point(t)), [0, 3, 6].map(|k| points[k]));
}

#[test]
fn a_torn_curve_is_refused_unless_both_ends_coincide() {
    let mut nurbs = Nurbs {
        degree: 1,
        knots: vec![0.0, 0.0, 0.5, 0.5, 1.0, 1.0],
        control_points: [0.0, 1.0, 1.25, 2.0].map(|x| Point2::new(x, 0.0)).to_vec(),
        weights: None,
    };
    assert_eq!(nurbs.curve().unwrap_err(), NurbsError::Gap { parameter: 0.5, gap_mm: 0.25 });
    nurbs.control_points[2].x = 1.0;
    assert_eq!(nurbs.curve().unwrap().breaks(), [0.5]);
    nurbs.control_points.push(Point2::origin());
    nurbs.knots = vec![0.0, 0.0, 0.5, 0.5, 0.5, 1.0, 1.0];
    let torn = KnotError::Multiplicity { index: 2, multiplicity: 3, most: 2 };
    assert_eq!(nurbs.curve().unwrap_err(), NurbsError::Knots(torn));
}

#[test]
fn broken_data_are_refused_with_the_place_of_the_fault() {
    let good = circle();
    let fault = |change: &dyn Fn(&mut Nurbs)| {
        let mut nurbs = good.clone();
        change(&mut nurbs);
        nurbs.curve().unwrap_err()
    };
    assert_eq!(fault(&|n| n.degree = 0), NurbsError::Degree { degree: 0 });
    assert_eq!(fault(&|n| n.degree = 8), NurbsError::Degree { degree: 8 });
    assert_eq!(fault(&|n| n.control_points.truncate(2)), NurbsError::TooFewPoints { points: 2, degree: 2 });
    assert_eq!(fault(&|n| n.control_points[3].y = f64::NAN), NurbsError::Point { index: 3 });
    let count = KnotError::Count { found: 11, points: 9, degree: 2 };
    assert_eq!(fault(&|n| n.knots.truncate(11)), NurbsError::Knots(count));
    assert_eq!(fault(&|n| n.knots[4] = 0.5), NurbsError::Knots(KnotError::Decrease { index: 4 }));
    assert_eq!(fault(&|n| n.knots[4] = f64::NAN), NurbsError::Knots(KnotError::Decrease { index: 4 }));
    assert_eq!(fault(&|n| n.knots.fill(1.0)), NurbsError::Knots(KnotError::EmptyDomain));
    let short = KnotError::SpanTooShort { index: 4, shortest: SHORTEST_SPAN };
    assert_eq!(fault(&|n| n.knots[4] = 1.0 + 1e-12), NurbsError::Knots(short));
    let weights = |change: &dyn Fn(&mut Vec<f64>)| fault(&|n| change(n.weights.as_mut().unwrap()));
    let count = WeightError::Count { found: 3, expected: 9 };
    assert_eq!(weights(&|w| w.truncate(3)), NurbsError::Weights(count));
    let range = WeightError::Range { index: 2, weight: 0.0 };
    assert_eq!(weights(&|w| w[2] = 0.0), NurbsError::Weights(range));
    let ratio = WeightError::Ratio { index: 2, weight: 1e-7, largest: 1.0 };
    assert_eq!(weights(&|w| w[2] = 1e-7), NurbsError::Weights(ratio));
    let far = fault(&|n| n.knots.iter_mut().for_each(|t| *t *= 1e70));
    assert_eq!(far, NurbsError::Chain(PiecewiseError::Parameter { index: 1 }));
}

#[test]
fn a_control_point_without_effect_is_refused_by_its_place() {
    let points: Vec<_> = (0..5).map(|k| Point2::new(f64::from(k), f64::from(k % 2))).collect();
    let curve = |degree: usize, knots: &[f64], weights: Option<Vec<f64>>| {
        let control_points = points[..knots.len() - degree - 1].to_vec();
        Nurbs { degree, knots: knots.to_vec(), control_points, weights }.curve().map(|_| ())
    };
    let idle = |index, end, first, points| {
        Err(NurbsError::Knots(KnotError::NoEffect { index, end, first, points, most: 3 }))
    };
    let both = [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
    assert_eq!(curve(2, &both, None), idle(3, End::Start, 0, 1));
    // Outside the domain, without a repeated knot of the end.
    assert_eq!(curve(2, &[-2.0, -1.0, 0.0, 0.0, 1.0, 2.0, 3.0], None), idle(3, End::Start, 0, 1));
    assert_eq!(curve(2, &[0.0, 1.0, 2.0, 3.0, 3.0, 4.0, 5.0], None), idle(4, End::Finish, 3, 1));
    // The share of the first control point is (1e-5)^3.
    let far = [-1e5, -1e5, -1e5, -1e5, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
    assert_eq!(curve(4, &far, None), Err(NurbsError::NoEffect { index: 0 }));
    // Knots and weights together: 1e-8 by the knots, 1e-6 by the weights.
    let far = [-1e4, -1e4, -1e4, 0.0, 1.0, 2.0, 3.0, 4.0];
    assert_eq!(curve(3, &far, None), Ok(()));
    assert_eq!(curve(3, &far, Some(vec![1e-6, 1.0, 1.0, 1.0])), Err(NurbsError::NoEffect { index: 0 }));
    assert_eq!(curve(3, &far, Some(vec![1e-6; 4])), Ok(()));
    // The largest quotient of weights leaves each control point of a Bezier curve its effect.
    let bezier = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    assert_eq!(curve(2, &bezier, Some(vec![1.0, 1e-6, 1.0])), Ok(()));
    assert_eq!(curve(2, &bezier, Some(vec![1e6, 1.0, 1e6])), Ok(()));
}

#[test]
fn uniform_knots_of_every_degree_are_accepted() {
    for degree in 1..=7 {
        let n = degree + 3;
        let points: Vec<_> = (0..n).map(|k| Point2::new(k as f64, 0.0)).collect();
        let weights = (0..n).map(|k| if k == 0 { 1e-6 } else { 1.0 }).collect();
        let knots = (0..n + degree + 1).map(|k| k as f64).collect();
        let curve = Nurbs { degree, knots, control_points: points, weights: Some(weights) };
        assert!(curve.curve().is_ok(), "{degree}");
    }
}
