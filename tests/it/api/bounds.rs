//! Tests of small requests that ask for very much: they are refused, and no answer grows beyond its limits.

use serde_json::{Value, json};

use super::support::{MILL, app, get, post};

const MODEL: &str = "/v1/surfaces/model";
const INTERPOLATE: &str = "/v1/curves/interpolate";
const POCKET: &str = "/v1/pockets/plan";
const SMOOTH: &str = "/v1/five-axis/smooth";
const CYLINDER: &str = include_str!("../../../openapi/examples/surfaces-model/cylinder.json");
const CORNER: &str = include_str!("../../../openapi/examples/five-axis-smooth/corner.json");

fn feed() -> Value {
    json!({ "feed_mm_per_min": 1000 })
}

/// Four by four points of a bowl, 100 mm wide.
fn bowl() -> Value {
    let z = |i: i32, j: i32| f64::from((2 * i - 3).pow(2) + (2 * j - 3).pow(2));
    let row = |i: i32| -> Value { (0..4).map(|j| json!([33 * i, 33 * j, z(i, j)])).collect() };
    json!({ "kind": "point_grid", "points": (0..4).map(row).collect::<Value>() })
}

fn milled(tool: &str, strategy: Value, more: Value) -> Value {
    let mut body = json!({
        "surface": bowl(), "tool": { "shape": tool, "diameter_mm": 10 }, "strategy": strategy,
        "tolerance_mm": 0.01, "cutting": feed(),
    });
    body.as_object_mut().expect("an object").extend(more.as_object().expect("an object").clone());
    body
}

fn rows(stepover_mm: f64) -> Value {
    json!({ "kind": "cl_cartesian", "stepover_mm": stepover_mm })
}

/// A pocket whose only way down is a helix of a thousandth of a millimetre.
fn helix() -> Value {
    json!({
        "region": { "boundary": [[0, 0], [50, 0], [50, 40], [0, 40]] },
        "floor_z_mm": -1_000_000, "stepdown_max_mm": 1_000_000, "stepover_mm": 4,
        "tool": { "shape": "flat", "diameter_mm": 10 }, "cutting": feed(),
        "entry": { "ramp_angle_deg": 0.1, "max_diameter_mm": 0.001, "min_diameter_mm": 0.001 },
    })
}

/// A rectangle.
fn pocket(stepover_mm: f64, patterns: &[&str]) -> Value {
    json!({
        "region": { "boundary": [[0, 0], [50, 0], [50, 40], [0, 40]] },
        "floor_z_mm": -1, "stepdown_max_mm": 1, "stepover_mm": stepover_mm, "patterns": patterns,
        "tool": { "shape": "flat", "diameter_mm": 10 }, "cutting": feed(),
    })
}

/// A parabola by parabolas, in a band with one side: each element coincides with the curve, which takes long
/// to prove.
fn parabola(width: f64) -> Value {
    json!({
        "curve": { "kind": "graph", "expression": "x^2", "domain": [-width, width] },
        "method": "parabolic", "subdivision": "least", "band": { "below_mm": 0, "above_mm": 1e-6 },
    })
}

/// A ruled surface of almost a square kilometre, with two wires.
fn wires() -> Value {
    json!({
        "surface": {
            "kind": "ruled", "first": "l(0,0,0) l(900000,0,0)",
            "second": "b((0,900000,0),(400000,900000,900000),(460000,900000,18))",
        },
        "wires": { "pitch_mm": 1_000_000, "chord_height_mm": 1e-6 },
    })
}

#[tokio::test]
async fn small_requests_for_very_much_are_refused_with_the_place_to_change() {
    let app = app(&["--workers", "1", "--deadline-s", "600"]);
    let steps = json!({ "step_length_mm": 0.001 });
    let union = |pitch_mm: f64| json!({ "kind": "wire_union", "pitch_mm": pitch_mm });
    for (path, body, place) in [
        (MODEL, wires(), "#/wires"),
        (
            MILL,
            milled("ball", rows(1.0), json!({ "allowance_mm": 999, "step_length_mm": 0.001 })),
            "#/allowance_mm",
        ),
        (MILL, milled("flat", rows(1.0), steps.clone()), "#/step_length_mm"),
        (MILL, milled("ball", rows(0.01), steps.clone()), "#/step_length_mm"),
        (MILL, milled("ball", union(1.0), steps), "#/strategy"),
        (MILL, milled("ball", union(0.01), json!({})), "#/strategy"),
        (MILL, milled("flat", rows(0.006), json!({})), "#/strategy"),
        (POCKET, helix(), "#/entry"),
        (POCKET, pocket(0.01, &["island_offset", "engagement"]), "#/stepover_mm"),
    ] {
        let body = body.to_string();
        assert!(body.len() < 1000);
        let refused = post(&app, path, body.clone(), &[]).await;
        assert_eq!(refused.status, 422, "{body}");
        let expected = ("limit_exceeded".to_owned(), place.to_owned());
        assert!(refused.violations().contains(&expected), "{body}: {}", refused.text());
    }
}

#[tokio::test]
async fn a_computed_toolpath_has_no_more_moves_than_a_sent_one() {
    let app = app(&["--workers", "1", "--max-moves", "20"]);
    let mut flat = helix();
    flat["floor_z_mm"] = json!(-1);
    flat["stepdown_max_mm"] = json!(1);
    let mut corner: Value = serde_json::from_str(CORNER).expect("JSON");
    corner["tolerance_mm"] = json!(1e-5);
    corner["tolerance_deg"] = json!(1e-4);
    corner.as_object_mut().expect("an object").remove("tool");
    for (path, body, place) in [
        (MILL, milled("ball", rows(10.0), json!({})), "#/strategy"),
        (MILL, milled("ball", json!({ "kind": "wire_union", "pitch_mm": 10 }), json!({})), "#/strategy"),
        (POCKET, flat, "#/stepover_mm"),
        (SMOOTH, corner, "#/tolerance_mm"),
    ] {
        let refused = post(&app, path, body.to_string(), &[]).await;
        assert_eq!(refused.status, 422, "{path}");
        let expected = ("limit_exceeded".to_owned(), place.to_owned());
        assert!(refused.violations().contains(&expected), "{path}: {}", refused.text());
    }
}

#[tokio::test]
async fn a_pattern_that_needs_too_much_work_leaves_the_pocket_to_the_others() {
    let patterns = ["zigzag_offset", "engagement"];
    let candidates = async |limit: &str| {
        let app = app(&["--workers", "1", "--max-cut-comparisons", limit]);
        assert_eq!(get(&app, "/v1/limits").await.json()["cut_comparisons"].to_string(), limit);
        let answer = post(&app, POCKET, pocket(2.0, &patterns).to_string(), &[]).await;
        (answer.status, answer)
    };
    let why = |answer: &Value, k: usize| {
        answer["report"]["levels"][0]["candidates"][k]["invalid_because"].as_str().map(str::to_owned)
    };
    let (_, all) = candidates("400000000").await;
    assert_eq!([why(&all.json(), 0), why(&all.json(), 1)], [None, None], "{}", all.text());
    // The one limit is above the estimate for `engagement` and below what it counts, the other below both.
    for limit in ["200000", "60000"] {
        let (_, some) = candidates(limit).await;
        assert_eq!(why(&some.json(), 0), None, "{}", some.text());
        assert!(why(&some.json(), 1).is_some_and(|why| why.contains("comparisons")), "{}", some.text());
    }
    let (status, none) = candidates("100").await;
    assert_eq!(status, 422);
    assert_eq!(none.violations(), [("limit_exceeded".to_owned(), "#/stepover_mm".to_owned())]);
}

#[tokio::test]
async fn the_points_of_all_wires_are_limited_together() {
    let many = app(&["--workers", "1"]);
    assert_eq!(get(&many, "/v1/limits").await.json()["wire_points"], 250_000);
    let answer = post(&many, MODEL, CYLINDER, &[]).await;
    let points = |answer: &Value| -> usize {
        let wires = answer["report"]["wires"].as_array().expect("wires");
        wires.iter().map(|wire| wire.as_array().map_or(0, Vec::len)).sum()
    };
    let n = points(&answer.json());
    let exactly = app(&["--workers", "1", "--max-wire-points", &n.to_string()]);
    assert_eq!(post(&exactly, MODEL, CYLINDER, &[]).await.status, 200);
    let fewer = app(&["--workers", "1", "--max-wire-points", &(n - 1).to_string()]);
    let refused = post(&fewer, MODEL, CYLINDER, &[]).await;
    assert_eq!(refused.violations(), [("limit_exceeded".to_owned(), "#/wires".to_owned())]);
}

#[tokio::test]
async fn a_search_ends_by_counted_steps_with_what_it_has() {
    let body = parabola(1.0).to_string();
    let few = app(&["--workers", "1", "--max-curve-steps", "20000000"]);
    let [first, second] =
        [post(&few, INTERPOLATE, body.clone(), &[]).await, post(&few, INTERPOLATE, body.clone(), &[]).await];
    assert_eq!(first.status, 200, "{}", first.text());
    assert_eq!(first.json()["report"], second.json()["report"]);
    let report = &first.json()["report"];
    let count = |name: &str| report[name].as_u64().expect("a count");
    assert!(count("n_elements_lower_bound") <= count("n_elements"), "{report}");
    assert!(report["deviation_max_mm"].as_f64().is_some_and(|mm| mm <= 1.001e-6), "{report}");
    let fewer = app(&["--workers", "1", "--max-curve-steps", "20000"]);
    let refused = post(&fewer, INTERPOLATE, body, &[]).await;
    assert_eq!(refused.violations(), [("limit_exceeded".to_owned(), "#/band".to_owned())]);
}
