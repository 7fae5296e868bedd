//! Refused requests: the answer points to the place of the fault, and comes in bounded time.

use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::ask;

fn graph(expression: &str, domain: [f64; 2]) -> Value {
    json!({
        "curve": { "kind": "graph", "expression": expression, "domain": domain },
        "method": "linear", "band": { "below_mm": 0.1, "above_mm": 0.1 },
    })
}

/// The single error of a body. Fails unless the service refuses the body with 422 and this error within 10 s.
async fn blamed(body: &Value) -> Value {
    let begun = Instant::now();
    let answer = ask(body).await;
    assert_eq!(answer.status, 422, "{:.200}", answer.text());
    assert!(begun.elapsed() < Duration::from_secs(10), "the refusal took {:?}", begun.elapsed());
    let problem = answer.problem();
    let errors = problem["errors"].as_array().expect("errors");
    assert_eq!(errors.len(), 1, "{problem}");
    errors[0].clone()
}

#[tokio::test]
async fn illegal_and_hostile_expressions_are_refused_with_the_offset_of_the_fault() {
    let nested = format!("{}x{}", "(".repeat(4_000), ")".repeat(4_000));
    let deep = format!("{}x{}", "(".repeat(10_000), ")".repeat(10_000));
    let signs = format!("{}x", "-".repeat(5_000));
    let powers = vec!["x"; 4_000].join("^");
    let megabyte = "x+".repeat(500_000);
    for (expression, offset) in [
        ("", Some(0)),
        ("1+", Some(2)),
        ("2x", Some(1)),
        ("sin(x", Some(3)),
        ("sin x", Some(4)),
        ("foo(x)", Some(0)),
        ("x + y", Some(4)),
        ("x $ 2", Some(2)),
        ("x)", Some(1)),
        ("1e999", Some(0)),
        ("x\u{0}", Some(1)),
        ("x + ü", Some(4)),
        (nested.as_str(), Some(200)),
        (deep.as_str(), None),
        (signs.as_str(), Some(200)),
        (powers.as_str(), None),
        (megabyte.as_str(), None),
    ] {
        let error = blamed(&graph(expression, [0.5, 2.0])).await;
        assert_eq!(error["pointer"], "#/curve/expression");
        let shown: String = expression.chars().take(40).collect();
        match offset {
            Some(offset) => {
                assert_eq!(error["code"], "syntax", "{shown}: {error}");
                // The offset at which nesting is too deep may be off by two bytes.
                let told = error["offset"].as_u64().expect("an offset");
                assert!(told.abs_diff(offset) <= if offset == 200 { 2 } else { 0 }, "{shown}: {error}");
            }
            None => {
                assert!(["too_long", "syntax"].contains(&error["code"].as_str().expect("a code")), "{error}")
            }
        }
    }
}

#[tokio::test]
async fn undefined_values_are_refused_with_their_x_and_the_offset_of_the_operation() {
    for (expression, domain, words, offset) in [
        ("1/0", [0.0, 1.0], "division by zero", 1),
        ("log(-1)", [0.0, 1.0], "log", 0),
        ("1/x", [-1.0, 1.0], "division by zero", 1),
        ("2 + 1/(x-0.1234567)", [0.0, 1.0], "division by zero", 5),
        ("tan(x)", [0.0, 2.0], "tan", 0),
        ("sqrt(x-1)", [0.0, 2.0], "sqrt", 0),
        ("x^0.5", [-1.0, 1.0], "power", 1),
        ("ln(x)", [0.0, 1.0], "log", 0),
        ("asin(x)", [0.0, 1.5], "asin", 0),
        ("sin(x)/x", [-1.0, 1.0], "division by zero", 6),
        ("x^x^x^x", [-1.0, 2.0], "power", 1),
    ] {
        let error = blamed(&graph(expression, domain)).await;
        assert_eq!(
            (&error["pointer"], &error["code"]),
            (&json!("#/curve/expression"), &json!("undefined")),
            "{error}"
        );
        let detail = error["detail"].as_str().expect("a detail");
        assert!(detail.contains(words) && detail.contains("x = "), "{expression}: {detail}");
        let told = error["offset"].as_u64().expect("an offset");
        assert!(told.abs_diff(offset) <= 4 && told < expression.len() as u64, "{expression}: {error}");
    }
    let error = blamed(&graph("1e7*x", [0.0, 1.0])).await;
    assert_eq!(error["code"], "too_large");
}

#[tokio::test]
async fn powers_are_evaluated_from_right_to_left() {
    let answer = ask(&graph("x^x^x^x", [0.1, 1.8])).await;
    assert_eq!(answer.status, 200, "{}", answer.text());
    let answer = answer.json();
    let moves = answer["toolpath"]["passes"][0]["moves"].as_array().expect("moves");
    // The curve bends, so that a band of 0.1 mm needs several chords.
    assert!(moves.len() > 2, "{moves:?}");
    for step in moves {
        let (x, y) = (step["to"][0].as_f64().expect("a number"), step["to"][1].as_f64().expect("a number"));
        // The expression means x^(x^(x^x)).
        assert!((y - x.powf(x.powf(x.powf(x)))).abs() < 1e-9 * y, "the path is at y = {y} for x = {x}");
    }
}

#[tokio::test]
async fn faults_of_section_curves_are_refused_with_their_byte_offset() {
    for (text, offset) in [
        ("", 0),
        ("l(0,0)", 0),
        ("l(0,0) q(1,1)", 7),
        ("l(0,0) r(5,0,1)", 7),
        ("l(0,0) r(50,0,100) l(50,40)", 7),
        ("l(0,0) l(0,0)", 7),
        ("l(0,0) l(1,nan)", 11),
    ] {
        let body = json!({
            "curve": { "kind": "section_curve", "text": text },
            "method": "arc", "band": { "below_mm": 0.1, "above_mm": 0.1 },
        });
        let error = blamed(&body).await;
        assert_eq!(
            (&error["pointer"], &error["code"]),
            (&json!("#/curve/text"), &json!("syntax")),
            "{text}: {error}"
        );
        let told = error["offset"].as_u64().expect("an offset");
        assert!(told.abs_diff(offset) <= 2, "{text}: {error}");
    }
}

#[tokio::test]
async fn conflicting_missing_and_illegal_fields_are_refused_with_their_pointer_and_code() {
    let spline = json!({ "kind": "points", "points": [[0, 0], [1, 1], [2, 0]] });
    let body = |changes: Value| {
        let mut body = graph("sin(x)", [0.0, 6.5]);
        for (name, value) in changes.as_object().expect("an object") {
            body[name] = value.clone();
        }
        body
    };
    for (changes, pointer, code) in [
        (
            json!({ "curve": spline, "band": { "below_mm": 1, "above_mm": 1, "measure": "vertical" } }),
            "#/band/measure",
            "conflict",
        ),
        (json!({ "joints": "in_band" }), "#/joints", "conflict"),
        (json!({ "joints": "in_band", "subdivision": "least", "method": "arc" }), "#/joints", "unsupported"),
        (json!({ "compensation": "left" }), "#/tool", "missing_field"),
        (
            json!({ "compensation": "left", "method": "mixed", "tool": { "shape": "flat", "diameter_mm": 1 } }),
            "#/compensation",
            "unsupported",
        ),
        (json!({ "band": { "below_mm": 0, "above_mm": 0 } }), "#/band", "out_of_range"),
        (json!({ "band": { "below_mm": -1, "above_mm": 1 } }), "#/band/below_mm", "out_of_range"),
        (json!({ "initial_elements": 0 }), "#/initial_elements", "out_of_range"),
        (
            json!({ "curve": { "kind": "graph", "expression": "x", "domain": [1, 1] } }),
            "#/curve/domain",
            "out_of_range",
        ),
        (
            json!({ "curve": { "kind": "points", "points": [[0, 0], [0, 0], [1, 1]] } }),
            "#/curve/points/1",
            "coincident",
        ),
        (json!({ "curve": { "kind": "circle" } }), "#/curve/kind", "unknown_value"),
        (json!({ "method": "cubic" }), "#/method", "unknown_value"),
        // Every chord of a convex curve lies above the curve, so that a band without room above is
        // impossible.
        (
            json!({ "curve": { "kind": "graph", "expression": "x^2", "domain": [0, 5] }, "band": { "below_mm": 0.1, "above_mm": 0 } }),
            "#/band",
            "out_of_range",
        ),
    ] {
        let error = blamed(&body(changes.clone())).await;
        assert_eq!(
            (&error["pointer"], &error["code"]),
            (&json!(pointer), &json!(code)),
            "{changes}: {error}"
        );
    }
}

#[tokio::test]
async fn a_control_point_without_effect_is_refused_by_pointer() {
    let body = |degree: usize, knots: &[f64], weights: Option<Vec<f64>>| {
        let points: Vec<_> = (0..knots.len() - degree - 1).map(|k| json!([k, -4 + (k as i32) % 2])).collect();
        json!({
            "curve": {
                "kind": "nurbs", "degree": degree, "knots": knots, "control_points": points, "weights": weights,
            },
            "method": "linear", "band": { "below_mm": 0.01, "above_mm": 0.01 },
        })
    };
    for (degree, knots, weights, pointer) in [
        (2, vec![0., 0., 0., 0., 1., 1., 1., 1.], None, "#/curve/knots/3"),
        (2, vec![0., 0., 0., 1., 1., 1., 1.], None, "#/curve/knots/4"),
        (1, vec![0., 0., 0., 1., 2., 2.], None, "#/curve/knots/2"),
        (2, vec![-2., -1., 0., 0., 1., 2., 3.], None, "#/curve/knots/3"),
        (4, vec![-1e5, -1e5, -1e5, -1e5, 0., 1., 2., 3., 4., 5.], None, "#/curve/control_points/0"),
        (2, vec![0., 0., 0., 1., 1., 1., 1., 2., 2., 2.], None, "#/curve/knots/3"),
        (2, vec![0., 0., 0., 1., 1., 1.], Some(vec![1.0, 0.0, 1.0]), "#/curve/weights/1"),
        (2, vec![0., 0., 0., 1., 1., 1.], Some(vec![1.0, 1e-6, 10.0]), "#/curve/weights/1"),
        (
            3,
            vec![-1e4, -1e4, -1e4, 0., 1., 2., 3., 4.],
            Some(vec![1e-6, 1.0, 1.0, 1.0]),
            "#/curve/control_points/0",
        ),
    ] {
        let error = blamed(&body(degree, &knots, weights)).await;
        assert_eq!((&error["pointer"], &error["code"]), (&json!(pointer), &json!("out_of_range")), "{error}");
    }
    for (degree, knots) in [
        (2, vec![0., 0., 0., 1., 1., 1.]),
        (2, vec![0., 0., 0., 1., 1., 2., 2., 2.]),
        (2, vec![0., 1., 2., 3., 4., 5., 6.]),
        (3, vec![0., 0., 0., 0., 1., 2., 3., 4.]),
    ] {
        assert_eq!(ask(&body(degree, &knots, None)).await.status, 200, "{knots:?}");
    }
}

#[tokio::test]
async fn a_program_needs_a_feed_and_a_toolpath_does_not() {
    let body = graph("sin(x)", [0.0, 6.5]);
    let json = ask(&body).await.json();
    assert!(
        json["report"].get("cutting_time_s").is_none() && json["measures"].get("cutting_time_s").is_none()
    );
    assert!(json["toolpath"]["passes"][0]["moves"][0].get("feed_mm_per_min").is_none());
    let app = crate::api::support::app(&["--workers", "1"]);
    let query = format!("{}?format=gcode", super::PATH);
    let answer = crate::api::support::post(&app, &query, body.to_string(), &[]).await;
    let problem = answer.problem();
    assert_eq!(
        (&problem["code"], &problem["errors"][0]["pointer"]),
        (&json!("feed_required"), &json!("#/cutting"))
    );
}
