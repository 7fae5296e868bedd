use proptest::prelude::*;

use super::*;

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

/// The control points whose basis functions vanish at many places of each span of the domain.
fn idle(knots: &[f64], degree: usize, points: usize) -> Vec<usize> {
    let spans = (degree..points).filter(|k| knots[k + 1] > knots[*k]);
    let places = spans.flat_map(|k| (0..9).map(move |n| (k, f64::from(n) / 9.0)));
    let places: Vec<f64> = places.map(|(k, part)| knots[k] + part * (knots[k + 1] - knots[k])).collect();
    let is_idle = |point: &usize| places.iter().all(|t| basis(knots, *point, degree, *t) == 0.0);
    (0..points).filter(is_idle).collect()
}

proptest! {
    /// Knots of all multiplicities, also at the ends.
    #[test]
    fn knots_are_refused_exactly_where_a_control_point_has_no_effect(
        degree in 1usize..=4, steps in prop::collection::vec(0u8..3, 8..18),
    ) {
        let knots: Vec<f64> = steps.iter().scan(0.0, |knot, step| { *knot += f64::from(*step); Some(*knot) }).collect();
        prop_assume!(knots.len() > 2 * degree + 1);
        let points = knots.len() - degree - 1;
        let rules = KnotRules { multiplicity: degree + 1, shortest_span: 1e-9 };
        match check_knots(&knots, degree, points, rules) {
            Ok(()) => prop_assert_eq!(idle(&knots, degree, points), Vec::<usize>::new()),
            Err(KnotError::NoEffect { first, points: count, end, .. }) => {
                let idle = idle(&knots, degree, points);
                match end {
                    End::Start => prop_assert_eq!(&idle[..count], &(0..count).collect::<Vec<_>>()),
                    End::Finish => prop_assert_eq!(idle, (first..points).collect::<Vec<_>>()),
                }
                // What the message advises leaves the rest as it was.
                let kept = match end {
                    End::Start => &knots[count..],
                    End::Finish => &knots[..knots.len() - count],
                };
                prop_assert!(kept.len() == points - count + degree + 1);
                let again = check_knots(kept, degree, points - count, rules);
                let is_same_end =
                    |error: KnotError| matches!(error, KnotError::NoEffect { end: still, .. } if still == end);
                prop_assert!(!again.is_err_and(is_same_end));
            }
            Err(KnotError::Multiplicity { .. } | KnotError::EmptyDomain) => {}
            Err(other) => prop_assert!(false, "{other}"),
        }
    }
}

#[test]
fn ordinary_knots_are_accepted() {
    for (degree, knots) in [
        // Clamped, with inner knots up to the multiplicity of the degree.
        (2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 2.0]),
        (3, vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0]),
        (1, vec![0.0, 0.0, 1.0, 2.0, 2.0]),
        // Uniform, and clamped at one end only.
        (3, vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]),
        (2, vec![0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0]),
        // One control point at each end of degree + 1 knots that lie apart from the domain.
        (2, vec![-5.0, -1.0, 0.0, 1.0, 9.0, 9.0]),
        // A knot of the ends repeated as often as the degree.
        (2, vec![-1.0, 0.0, 0.0, 1.0, 1.0, 2.0]),
    ] {
        let points = knots.len() - degree - 1;
        let rules = KnotRules { multiplicity: degree, shortest_span: 1e-9 };
        assert_eq!(check_knots(&knots, degree, points, rules), Ok(()), "{knots:?}");
    }
}

#[test]
fn the_message_of_an_idle_control_point_says_what_to_leave_out() {
    let rules = KnotRules { multiplicity: 3, shortest_span: 1e-9 };
    let knots = [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
    let fault = check_knots(&knots, 2, 5, rules).unwrap_err();
    assert_eq!(fault.index(), Some(3));
    assert_eq!(
        fault.to_string(),
        "knot 3 repeats an end of the domain too often: control point 0 along these knots has no effect; leave it and the first knot out, so that an end knot occurs at most degree + 1 times, here 3"
    );
    let knots = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0];
    let fault = check_knots(&knots, 2, 5, rules).unwrap_err();
    assert_eq!(fault.index(), Some(5));
    assert_eq!(
        fault.to_string(),
        "knot 5 repeats an end of the domain too often: control points 3 to 4 along these knots have no effect; leave them and the last 2 knots out, so that an end knot occurs at most degree + 1 times, here 3"
    );
}
