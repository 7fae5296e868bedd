//! Compares values, derivatives and enclosures of random expressions with values that trees compute (`trees`)
//! and with differences of values. Tests identities.

use proptest::prelude::*;

use super::parsed;
use super::trees::tree;
use crate::budget::Budget;
use crate::geometry::interval::Interval;
use crate::geometry::plane_curve::PlaneCurve;
use crate::language::expression::Expression;
use crate::language::graph::Graph;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn the_text_of_a_tree_has_the_value_of_the_tree(tree in tree(), x in -3.0..3.0f64) {
        let (text, value) = (tree.text(), tree.value(x));
        let computed = parsed(&text).value(x);
        let same = computed == value || (computed.is_nan() && value.is_nan());
        prop_assert!(same, "{text} at {x}: {computed}, not {value}");
    }

    #[test]
    fn enclosures_contain_values_and_slopes(tree in tree(), lo in -3.0..3.0f64, width in 0.0..1.0f64, narrow in 0..20i32) {
        let range = Interval::between(lo, lo + width * 0.5f64.powi(narrow));
        let text = tree.text();
        // Outside the domain, values may be anything.
        let domain = [range.lo(), range.hi().max(range.lo().next_up())];
        let graph = Graph::new(parsed(&text), domain, &Budget::unlimited());
        prop_assume!(graph.is_ok());
        let graph = graph.unwrap();
        let expression = graph.expression();
        let [value, first, _] = expression.enclose(range);
        let bounds = graph.bounds();
        for k in 0..=20 {
            let x = (range.lo() + f64::from(k) / 20.0 * (range.hi() - range.lo())).min(range.hi());
            let y = graph.point(x).y;
            let slack = rounding(expression, x);
            prop_assert!(meets(value, y, slack[0]), "{text} at {x}: {y} not in {value:?}");
            prop_assert!(meets(bounds, y, slack[0]), "{text} at {x}: {y} not in {bounds:?}");
            let [_, slope] = expression.value_and_derivative(x);
            if slope.is_finite() {
                prop_assert!(meets(first, slope, slack[1]), "{text} at {x}: slope {slope} not in {first:?}");
            }
        }
    }

    #[test]
    fn derivatives_agree_with_differences(tree in tree(), x in -3.0..3.0f64) {
        let text = tree.text();
        let expression = parsed(&text);
        let h = 1e-4;
        let around = Interval::between(x - h, x + h);
        prop_assume!(expression.examine([x - h, x + h], &Budget::unlimited()).is_ok());
        let [value, first, second] = expression.enclose(around);
        prop_assume!(second.is_bounded() && value.mag() < 1e4);
        // The mean value theorem: the slope of a chord is the derivative at some place between.
        let rounding = 1e-9 * (1.0 + value.mag()) / h + 1e-9;
        let chord = (expression.value(x + h) - expression.value(x - h)) / (2.0 * h);
        prop_assert!(meets(first, chord, rounding), "{text} at {x}: {chord} not in {first:?}");
        let [_, after] = expression.value_and_derivative(x + h);
        let [_, before] = expression.value_and_derivative(x - h);
        let bend = (after - before) / (2.0 * h);
        let rounding = 1e-9 * (1.0 + first.mag()) / h;
        prop_assert!(meets(second, bend, rounding), "{text} at {x}: {bend} not in {second:?}");
        let [_, slope] = expression.value_and_derivative(x);
        prop_assert!((slope - chord).abs() <= second.width() * h + 1e-9 * (1.0 + value.mag()) / h + second.mag() * h);
    }

    #[test]
    fn a_half_meets_the_enclosure_of_its_range(tree in tree(), lo in -3.0..3.0f64, width in 0.0..1.0f64) {
        let expression = parsed(&tree.text());
        let (whole, half) = (Interval::between(lo, lo + width), Interval::between(lo, lo + 0.5 * width));
        prop_assume!(expression.examine([lo, lo + width.max(1e-9)], &Budget::unlimited()).is_ok());
        let ([outer, ..], [inner, ..]) = (expression.enclose(whole), expression.enclose(half));
        // The values over the half are inside both enclosures. So the two enclosures meet, even if the first
        // one is not inside the second.
        prop_assert!(inner.lo() <= outer.hi() && outer.lo() <= inner.hi());
    }
}

/// How far computed values may be from exact values: the width of enclosures at points.
fn rounding(expression: &Expression, x: f64) -> [f64; 2] {
    let [value, first, _] = expression.enclose(Interval::point(x));
    let wide = |of: Interval| if of.is_bounded() { of.width() } else { 0.0 };
    [wide(value), wide(first)]
}

fn meets(range: Interval, y: f64, slack: f64) -> bool {
    range.lo() - slack <= y && y <= range.hi() + slack
}

/// The jets of both sides of an identity enclose the same numbers. At points they are narrow, so the test is
/// sharp.
#[test]
fn identities_hold_in_value_and_both_derivatives() {
    let identities = [
        ("sin(x)^2 + cos(x)^2", "1"),
        ("sin(x)/cos(x)", "tan(x)"),
        ("exp(x)*exp(x)", "exp(2*x)"),
        ("cosh(x)^2 - sinh(x)^2", "1"),
        ("(exp(x) - exp(-x))/(exp(x) + exp(-x))", "tanh(x)"),
        ("ln(x)/ln(10)", "log10(x)"),
        ("ln(x)/ln(2)", "log2(x)"),
        ("cbrt(x)^3", "x"),
        ("sqrt(x)", "x^0.5"),
        ("x^1.5", "x*sqrt(x)"),
        ("x^2.25", "exp(2.25*ln(x))"),
        ("x^x", "exp(x*ln(x))"),
        ("2^x", "exp(x*ln(2))"),
        ("x^3", "x*x*x"),
        ("x^-3", "1/x/x/x"),
        ("x^0", "1"),
        ("x^1", "x"),
        ("asin(x) + acos(x)", "pi/2"),
        ("atan(x)", "asin(x/sqrt(1 + x^2))"),
        ("hypot(x, 2)", "sqrt(x^2 + 4)"),
        ("abs(x - 3)", "3 - x"),
        ("min(x, 1/x)", "x"),
        ("max(x, 1/x)", "x^-1"),
    ];
    for x in [0.1, 0.25, 0.5, 0.9] {
        for (one, other) in identities {
            let (a, b) = (parsed(one).enclose(Interval::point(x)), parsed(other).enclose(Interval::point(x)));
            for (order, (a, b)) in a.into_iter().zip(b).enumerate() {
                let slack = 1e-11 * (1.0 + a.mag());
                assert!(a.width() <= slack && b.width() <= slack, "{one}, {other} at {x}: {a:?}, {b:?}");
                assert!((a.mid() - b.mid()).abs() <= slack, "{one}, {other}, {order}: {a:?}, {b:?}");
            }
            let ([v, s], [w, t]) =
                (parsed(one).value_and_derivative(x), parsed(other).value_and_derivative(x));
            assert!((v - w).abs() <= 1e-13 * (1.0 + v.abs()), "{one}, {other}: {v} {w}");
            assert!((s - t).abs() <= 1e-12 * (1.0 + s.abs()), "{one}, {other}: {s} {t}");
        }
    }
}

#[test]
fn values_stay_tight_where_derivatives_do_not_exist() {
    let around_zero = Interval::between(-1e-6, 1e-6);
    let [value, first, second] = parsed("abs(x)").enclose(around_zero);
    assert_eq!([value, first, second], [around_zero.abs(), Interval::between(-1.0, 1.0), Interval::ENTIRE]);
    for (text, largest) in [("cbrt(x)", 1e-2), ("sqrt(x)", 1e-3), ("hypot(x, 2*x)", 1e-5), ("x^0.5", 1e-3)] {
        let [value, _, second] = parsed(text).enclose(around_zero);
        assert!(value.mag() <= 1.001 * largest, "{text}: {value:?}");
        assert_eq!(second, Interval::ENTIRE, "{text}");
    }
    for text in ["sqrt(x)", "cbrt(x)", "x^0.5", "x^(1/3)"] {
        let [value, first, second] = parsed(text).enclose(Interval::point(0.0));
        assert!(value.mag() < 1e-100, "{text}: {value:?}");
        assert_eq!([first, second], [Interval::ENTIRE; 2], "{text}");
    }
    assert_eq!(parsed("abs(-x)").value_and_derivative(0.0), [0.0, 1.0]);
    assert_eq!(parsed("min(x, -x)").value_and_derivative(0.0), [0.0, -1.0]);
}

/// The excess of an enclosure over the width of the values falls with the square of the width of the range.
#[test]
fn enclosures_are_tight_over_short_ranges() {
    for text in ["x - x^2", "x*sin(x)/(1 + x^2)", "exp(x)*exp(-x)", "x^3 - 3*x + 1"] {
        let expression = parsed(text);
        let excess = |h: f64| {
            let (lo, hi) = (1.3, 1.3 + h);
            let [value, ..] = expression.enclose(Interval::between(lo, hi));
            let samples: Vec<f64> =
                (0..=100).map(|k| expression.value(lo + f64::from(k) / 100.0 * h)).collect();
            let most = samples.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let least = samples.iter().copied().fold(f64::INFINITY, f64::min);
            value.width() - (most - least)
        };
        assert!(excess(1e-3) <= 10.0 * 1e-6, "{text}: {}", excess(1e-3));
        assert!(excess(1e-5) <= 10.0 * 1e-10, "{text}: {}", excess(1e-5));
    }
}
