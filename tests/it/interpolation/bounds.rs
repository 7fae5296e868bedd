//! Compares stated deviations with brute force, on random expressions and splines. No stated deviation is too
//! small, and none is more than twice too large.

use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use serde_json::{Value, json};

use super::answer;
use super::evaluator::{Curve, domain, moves};

/// A term of a random expression. It can be written as text and computed as a function.
#[derive(Debug, Clone, Copy)]
struct Term {
    kind: u8,
    size: f64,
    rate: f64,
    shift: f64,
}

impl Term {
    fn text(&self) -> String {
        let Self { kind, size, rate, shift } = self;
        match kind % 6 {
            0 => format!("{size}*sin({rate}*x+{shift})"),
            1 => format!("{size}*cos({rate}*x-{shift})^2"),
            2 => format!("{size}*exp(-({rate}*x-{shift})^2)"),
            3 => format!("{size}*x^2/(1+{rate}*x^2)"),
            4 => format!("{size}*atan({rate}*x-{shift})"),
            _ => format!("{size}*sqrt(1+({rate}*x-{shift})^2)"),
        }
    }

    fn value(&self, x: f64) -> f64 {
        let Self { kind, size, rate, shift } = *self;
        let u = rate * x - shift;
        size * match kind % 6 {
            0 => (rate * x + shift).sin(),
            1 => u.cos().powi(2),
            2 => (-u * u).exp(),
            3 => x * x / (1.0 + rate * x * x),
            4 => u.atan(),
            _ => (1.0 + u * u).sqrt(),
        }
    }
}

fn terms() -> impl Strategy<Value = Vec<Term>> {
    let term = (0u8..6, 0.1..4.0f64, 0.1..2.0f64, 0.0..3.0f64).prop_map(|(kind, size, rate, shift)| Term {
        kind,
        size,
        rate,
        shift,
    });
    prop::collection::vec(term, 1..4)
}

fn choices() -> impl Strategy<Value = (usize, bool, bool, f64, f64)> {
    (0usize..4, any::<bool>(), any::<bool>(), -4.0..-0.3f64, 0.2..1.0f64)
}

/// Random cases of each test. The exploration on fresh seeds tries more.
const CASES: u32 = 24;

const METHODS: [&str; 4] = ["linear", "parabolic", "mixed", "arc"];

/// Fails if the stated deviation of an element is too small, more than twice too large, or outside the band.
fn judged(answer: &Value, curve: &Curve, measure: &str, sides: [f64; 2]) {
    let elements = answer["report"]["elements"].as_array().expect("elements");
    let paths = moves(answer);
    assert_eq!(paths.len(), elements.len());
    let widest = sides[0].max(sides[1]);
    for (path, element) in paths.iter().zip(elements) {
        let found = match measure {
            "vertical" => curve.vertical_deviation(path),
            _ => curve.deviation(path, domain(element)),
        };
        let stated = element["deviation_mm"].as_f64().expect("a deviation");
        assert!(found <= stated + 1e-10, "{found} found, only {stated} stated: {element}");
        assert!(stated <= 2.0 * found + 1e-6, "{stated} stated, only {found} found: {element}");
        assert!(stated <= widest + 2e-9, "{stated} stated in a band of {widest}");
    }
    let n = elements.len() as u64;
    assert!(
        answer["report"]["n_elements_lower_bound"].as_u64().is_none_or(|bound| bound <= n),
        "the lower bound exceeds {n}"
    );
}

fn run<S: Strategy>(cases: u32, strategy: S, test: impl Fn(S::Value)) {
    let config = ProptestConfig { cases, ..ProptestConfig::default() };
    let result = TestRunner::new(config).run(&strategy, |value| {
        test(value);
        Ok(())
    });
    result.expect("every random case passes");
}

fn runtime() -> tokio::runtime::Runtime {
    tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build().expect("a runtime")
}

#[test]
fn stated_deviations_from_expressions_are_true_and_at_most_twice_too_large() {
    let runtime = runtime();
    run(CASES, (terms(), choices()), |(terms, (method, least, vertical, size, ratio))| {
        let text = terms.iter().map(Term::text).collect::<Vec<_>>().join(" + ");
        let value = |x: f64| terms.iter().map(|term| term.value(x)).sum::<f64>();
        let sides = [10f64.powf(size), ratio * 10f64.powf(size)];
        let measure = if vertical { "vertical" } else { "normal" };
        let body = json!({
            "curve": { "kind": "graph", "expression": text, "domain": [-3, 5] },
            "method": METHODS[method], "subdivision": if least { "least" } else { "bisection" },
            "band": { "below_mm": sides[0], "above_mm": sides[1], "measure": measure },
        });
        let answer = runtime.block_on(answer(&body));
        judged(&answer, &Curve { point: &|x| [x, value(x)], domain: [-3.0, 5.0] }, measure, sides);
    });
}

/// The point of a uniform cubic B-spline at `t`, by its basis functions.
fn spline(points: &[[f64; 2]], t: f64) -> [f64; 2] {
    let k = (t.floor() as usize).min(points.len() - 4);
    let u = t - k as f64;
    let basis = [
        (1.0 - u).powi(3) / 6.0,
        (3.0 * u.powi(3) - 6.0 * u * u + 4.0) / 6.0,
        (-3.0 * u.powi(3) + 3.0 * u * u + 3.0 * u + 1.0) / 6.0,
        u.powi(3) / 6.0,
    ];
    [0, 1].map(|axis| basis.iter().zip(&points[k..]).map(|(b, p)| b * p[axis]).sum())
}

#[test]
fn stated_deviations_from_splines_are_true_and_at_most_twice_too_large() {
    let runtime = runtime();
    let points = prop::collection::vec((0.5..3.0f64, -2.5..2.5f64), 5..12);
    run(CASES, (points, choices()), |(steps, (method, least, _, size, ratio))| {
        let mut x = 0.0;
        let points: Vec<[f64; 2]> = steps
            .iter()
            .map(|(step, y)| {
                x += step;
                [x, *y]
            })
            .collect();
        let knots: Vec<f64> = (0..points.len() + 4).map(|k| k as f64 - 3.0).collect();
        let sides = [10f64.powf(size), ratio * 10f64.powf(size)];
        let body = json!({
            "curve": { "kind": "nurbs", "degree": 3, "knots": knots, "control_points": points },
            "method": METHODS[method], "subdivision": if least { "least" } else { "bisection" },
            "band": { "below_mm": sides[0], "above_mm": sides[1] },
        });
        let answer = runtime.block_on(answer(&body));
        let domain = [0.0, points.len() as f64 - 3.0];
        judged(&answer, &Curve { point: &|t| spline(&points, t), domain }, "normal", sides);
    });
}
