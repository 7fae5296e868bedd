//! Bands with room on one side only: the cutter may leave material, but not remove it. Few elements are
//! needed, and each stays on its side of the curve.

use serde_json::{Value, json};

use super::answer;
use super::evaluator::{Curve, domain, moves};

struct Case {
    expression: &'static str,
    value: fn(f64) -> f64,
    domain: [f64; 2],
    /// Width of the band below and above the curve, mm.
    sides: [f64; 2],
    method: &'static str,
    /// Most elements: those of the best chain whose joints lie on a fine grid.
    most: usize,
}

fn sine(x: f64) -> f64 {
    x.sin()
}

fn cubic(x: f64) -> f64 {
    0.1 * x.powi(3) - x
}

fn square(x: f64) -> f64 {
    x * x
}

const SINE: (&str, fn(f64) -> f64) = ("sin(x)", sine);
const CUBIC: (&str, fn(f64) -> f64) = ("0.1*x^3-x", cubic);
const SQUARE: (&str, fn(f64) -> f64) = ("x^2", square);

const CASES: [Case; 10] = [
    case(SINE, [0.0, 1.5], [0.0, 0.001], "arc", 5),
    case(SINE, [0.0, 1.5], [0.001, 0.0], "arc", 5),
    case(SINE, [0.0, 6.5], [0.01, 0.0], "arc", 9),
    case(CUBIC, [0.0, 1.0], [0.01, 0.0], "arc", 2),
    case(SQUARE, [0.0, 1.0], [0.01, 0.0], "arc", 3),
    case(SQUARE, [0.0, 1.0], [0.0, 0.01], "arc", 2),
    case(SQUARE, [0.0, 5.0], [0.001, 0.0], "parabolic", 1),
    case(SINE, [0.0, 1.5], [0.0, 0.001], "parabolic", 4),
    case(SINE, [0.0, 6.5], [0.001, 0.0], "mixed", 15),
    case(SINE, [0.0, 3.1], [0.0016, 0.0], "linear", 20),
];

const fn case(
    (expression, value): (&'static str, fn(f64) -> f64),
    domain: [f64; 2],
    sides: [f64; 2],
    method: &'static str,
    most: usize,
) -> Case {
    Case { expression, value, domain, sides, method, most }
}

/// The number of elements. Fails if a stated deviation is too small or outside the band, or if an element is
/// on the wrong side of the curve.
fn verified(answer: &Value, case: &Case) -> usize {
    let curve = Curve { point: &|x| [x, (case.value)(x)], domain: case.domain };
    let elements = answer["report"]["elements"].as_array().expect("elements");
    let moves = moves(answer);
    assert_eq!(moves.len(), elements.len());
    for (path, element) in moves.iter().zip(elements) {
        let found = curve.deviation(path, domain(element));
        let stated = element["deviation_mm"].as_f64().expect("a deviation");
        assert!(
            found <= stated + 1e-10 && stated <= case.sides[0].max(case.sides[1]) + 1e-9,
            "{found} found, {stated} stated: {element}"
        );
        for [x, y] in path {
            let above = y - (case.value)(*x);
            assert!(case.sides[1] > 0.0 || above < 1e-9, "{above} mm above the curve at x = {x}");
            assert!(case.sides[0] > 0.0 || above > -1e-9, "{} mm below the curve at x = {x}", -above);
        }
    }
    elements.len()
}

#[tokio::test]
async fn a_one_sided_band_takes_no_more_elements_than_the_best_chain_over_a_grid_of_joints() {
    for case in &CASES {
        let body = |subdivision: &str| {
            json!({
                "curve": { "kind": "graph", "expression": case.expression, "domain": case.domain },
                "method": case.method, "subdivision": subdivision,
                "band": { "below_mm": case.sides[0], "above_mm": case.sides[1] },
            })
        };
        let least = verified(&answer(&body("least")).await, case);
        assert!(
            least <= case.most,
            "{} {}: {least} elements, not {} at most",
            case.method,
            case.expression,
            case.most
        );
        let halved = verified(&answer(&body("bisection")).await, case);
        assert!(
            halved <= 3 * case.most,
            "{} {}: {halved} elements by bisection, not {} at most",
            case.method,
            case.expression,
            3 * case.most
        );
    }
}

/// This spline once needed thousands of arcs, and most of the time that a request may take.
#[tokio::test]
async fn a_spline_in_a_one_sided_band_takes_at_most_31_arcs_or_parabolas() {
    for method in ["arc", "parabolic"] {
        let answer = answer(&json!({
            "curve": { "kind": "points",
                "points": [[0, 0], [12, 8], [25, 9], [40, -2], [55, -6], [70, 3], [80, 15]] },
            "method": method, "band": { "below_mm": 0, "above_mm": 0.005 },
        }))
        .await;
        let count = answer["report"]["elements"].as_array().expect("elements").len();
        assert!(count <= 31, "{method}: {count} elements, not 31 at most");
        assert!(answer["report"]["deviation_max_mm"].as_f64().expect("a deviation") <= 0.005 + 1e-9);
    }
}
