//! Tests of models of surfaces, and of the refusal of illegal surfaces.

use serde_json::{Value, json};

use super::support::{MILL, app, post};

const MODEL: &str = "/v1/surfaces/model";
const CYLINDER: &str = include_str!("../../../openapi/examples/surfaces-model/cylinder.json");
const FERGUSON: &str = include_str!("../../../openapi/examples/surfaces-model/ferguson.json");
const BEZIER_PATCHES: &str = include_str!("../../../openapi/examples/surfaces-mill/bezier-patches.json");

fn parsed(text: &str) -> Value {
    serde_json::from_str(text).expect("JSON")
}

/// `body` with the value at `pointer` replaced, or added to its parent.
fn with(body: &str, pointer: &str, value: Value) -> String {
    let mut body = parsed(body);
    let (parent, name) = pointer.rsplit_once('/').expect("a pointer");
    let parent = body.pointer_mut(parent).expect("a parent");
    match parent {
        Value::Object(members) => {
            members.insert(name.to_owned(), value);
        }
        parent => parent[name.parse::<usize>().expect("an index")] = value,
    }
    body.to_string()
}

#[tokio::test]
async fn the_model_of_a_cylinder_equals_closed_forms() {
    let app = app(&["--workers", "1"]);
    let answer = post(&app, MODEL, CYLINDER, &[]).await;
    assert_eq!(answer.status, 200);
    let json = answer.json();
    assert_eq!(json["meta"]["part_id"], "crown-40");
    assert!(json.get("toolpath").is_none() && json.get("measures").is_none());
    let report = &json["report"];
    let bounds: Vec<f64> = ["min", "max"]
        .iter()
        .flat_map(|end| report["bounds"][end].as_array().expect("a point"))
        .map(|x| x.as_f64().expect("a number"))
        .collect();
    let half = 40.0 * 0.75f64.sqrt();
    for (found, expected) in bounds.iter().zip([-half, 0.0, 20.0, half, 30.0, 40.0]) {
        assert!((found - expected).abs() < 1e-5, "other bounds: {bounds:?}");
    }
    assert_eq!(report["n_patches"], 2);
    let patch = &report["patches"][1][0];
    assert_eq!(patch["degree"], json!([2, 1]));
    assert_eq!(patch["net"].as_array().map(Vec::len), Some(3));
    assert!((patch["weights"][1][0].as_f64().expect("a weight") - 0.75f64.sqrt()).abs() < 1e-12);
    // The cylinder is convex across and straight along, so that its concave curvature is nearly 0.
    let curvature = report["curvature_max_concave_per_mm"].as_f64().expect("a curvature");
    assert!((0.0..1e-3).contains(&curvature), "the largest concave curvature is {curvature}");
    assert_eq!(report["fit_deviation_max_mm"], Value::Null);
    let wires = report["wires"].as_array().expect("wires");
    assert_eq!(wires.len(), 7);
    assert!(wires.iter().all(|wire| wire.as_array().is_some_and(|points| points.len() >= 2)));
    for point in wires.iter().flat_map(|wire| wire.as_array().expect("a wire")) {
        let [x, z] = [0, 2].map(|c| point[c].as_f64().expect("a number"));
        assert!((x.hypot(z) - 40.0).abs() < 1e-9, "{point} of a wire is not on the cylinder");
    }
}

#[tokio::test]
async fn ferguson_patches_pass_through_their_data_points() {
    let app = app(&["--workers", "1"]);
    let report = post(&app, MODEL, FERGUSON, &[]).await.json()["report"].clone();
    assert!(report["fit_deviation_max_mm"].as_f64().is_some_and(|mm| mm < 1e-12));
    let numbers = |point: &Value| -> Vec<_> {
        point.as_array().into_iter().flatten().map(|x| x.as_f64().expect("a number")).collect()
    };
    let point = numbers(&parsed(FERGUSON)["surface"]["points"][1][2]);
    assert_eq!(numbers(&report["patches"][1][2][0][0]), point);
    let bare = post(&app, MODEL, with(FERGUSON, "/patches", json!(false)), &[]).await.json();
    assert!(bare["report"].get("patches").is_none());
    assert_eq!(bare["report"]["bounds"], report["bounds"]);
}

#[tokio::test]
async fn the_model_of_a_surface_is_answered_as_a_picture_but_not_as_a_program() {
    let app = app(&["--workers", "1"]);
    let svg = post(&app, &format!("{MODEL}?format=svg"), CYLINDER, &[]).await;
    assert_eq!((svg.status.as_u16(), svg.header("content-type")), (200, "image/svg+xml; charset=utf-8"));
    let html = post(&app, MODEL, CYLINDER, &[("accept", "text/html")]).await;
    assert!(String::from_utf8_lossy(&html.body).contains("<svg"));
    let gcode = post(&app, MODEL, CYLINDER, &[("accept", "text/x-gcode")]).await;
    assert_eq!((gcode.status.as_u16(), gcode.code().as_str()), (406, "not_acceptable"));
}

#[tokio::test]
async fn edges_and_poles_cause_warnings_and_offset_section_refuses_edges_and_gaps() {
    let app = app(&["--workers", "1"]);
    let row = |i: usize, z: f64| json!([[10 * i, 0, z], [10 * i, 20, z]]);
    let roof = json!({
        "kind": "nurbs", "degree_u": 1, "degree_v": 1, "knots_u": [0, 0, 1, 2, 2], "knots_v": [0, 0, 1, 1],
        "control_points": [row(0, 0.0), row(1, 4.0), row(2, 0.0)],
    });
    let model = post(&app, MODEL, with(CYLINDER, "/surface", roof.clone()), &[]).await.json();
    assert_eq!(model["warnings"][0]["code"], "not_smooth");
    let mut body = parsed(BEZIER_PATCHES);
    body["engine"] = json!("offset_section");
    let body = body.to_string();
    let milled = post(&app, MILL, with(BEZIER_PATCHES, "/surface", roof.clone()), &[]).await;
    assert_eq!(milled.status, 200, "{}", milled.text());
    let refused = post(&app, MILL, with(&body, "/surface", roof), &[]).await;
    assert_eq!((refused.status.as_u16(), refused.code().as_str()), (422, "not_smooth"));
    assert_eq!(refused.problem()["place"][0], 10.0);
    let apart = with(&body, "/surface/patches/1/0/0/2/1", json!(20.5));
    let refused = post(&app, MILL, apart, &[]).await;
    assert_eq!(refused.violations(), [("patches_apart".to_owned(), "#/surface/patches/1/0".to_owned())]);
    let mut pole = parsed(CYLINDER);
    pole["wires"]["direction"] = json!("u");
    for b in 0..2 {
        pole["surface"]["control_points"][0][b] = json!([-34.6, 0, 20]);
    }
    let warnings = post(&app, MODEL, pole.to_string(), &[]).await.json()["warnings"].clone();
    assert!(
        warnings.as_array().is_some_and(|all| all.iter().any(|w| w["code"] == "no_normal")),
        "no warning of the pole: {warnings}"
    );
}

#[tokio::test]
async fn every_violation_in_a_surface_has_its_code_and_its_pointer() {
    let app = app(&["--workers", "1"]);
    // The last row of control points has no effect.
    let idle = json!({
        "kind": "nurbs", "degree_u": 2, "degree_v": 1, "knots_u": [0, 0, 0, 1, 1, 1, 1], "knots_v": [0, 0, 1, 1],
        "control_points": (0..4).map(|i| [[10 * i, 0, 0], [10 * i, 20, 0]]).collect::<Vec<_>>(),
    });
    let thousand_wires = with(CYLINDER, "/wires/pitch_mm", json!(0.001));
    for (body, code, pointer) in [
        (with(CYLINDER, "/surface/degree_u", json!(8)), "out_of_range", "#/surface/degree_u"),
        (with(CYLINDER, "/surface/knots_u/3", json!(5)), "out_of_range", "#/surface/knots_u/4"),
        (with(CYLINDER, "/surface/knots_v", json!([0, 1])), "wrong_length", "#/surface/knots_v"),
        (with(CYLINDER, "/surface/knots_v", json!([0, 0, 0, 0])), "out_of_range", "#/surface/knots_v"),
        (with(CYLINDER, "/surface", idle), "out_of_range", "#/surface/knots_u/4"),
        (with(CYLINDER, "/surface/weights/1/0", json!(0)), "out_of_range", "#/surface/weights/1/0"),
        (with(CYLINDER, "/surface/weights/1", json!([1])), "wrong_length", "#/surface/weights/1"),
        (
            with(CYLINDER, "/surface/control_points/2/1/0", json!(1e7)),
            "too_large",
            "#/surface/control_points/2/1/0",
        ),
        (
            with(CYLINDER, "/surface/control_points/2", json!([])),
            "too_few_points",
            "#/surface/control_points/2",
        ),
        (with(CYLINDER, "/surface/degree_w", json!(1)), "unknown_field", "#/surface/degree_w"),
        (with(CYLINDER, "/surface/kind", json!("mesh")), "unknown_value", "#/surface/kind"),
        (with(CYLINDER, "/wires/pitch_mm", json!(0)), "out_of_range", "#/wires/pitch_mm"),
        (with(CYLINDER, "/wires/direction", json!("z")), "unknown_value", "#/wires/direction"),
        (thousand_wires, "limit_exceeded", "#/wires/pitch_mm"),
        (with(FERGUSON, "/surface/tangents_u/4", json!([])), "wrong_length", "#/surface/tangents_u/4"),
        (with(FERGUSON, "/surface/twists", json!([])), "wrong_length", "#/surface/twists"),
    ] {
        let answer = post(&app, MODEL, body, &[]).await;
        assert_eq!(answer.status, 422, "{pointer}");
        assert_eq!(answer.violations(), [(code.to_owned(), pointer.to_owned())]);
    }
    for (body, code, pointer) in [
        (
            with(BEZIER_PATCHES, "/surface/patches/0/0/2", json!([])),
            "wrong_length",
            "#/surface/patches/0/0/2",
        ),
        (with(BEZIER_PATCHES, "/surface/patches", json!([])), "too_few_points", "#/surface/patches"),
        (with(BEZIER_PATCHES, "/allowance_mm", json!(-1)), "out_of_range", "#/allowance_mm"),
        (with(BEZIER_PATCHES, "/boundary", json!("beyond")), "unknown_value", "#/boundary"),
        (
            with(BEZIER_PATCHES, "/strategy/scallop_height_mm", json!(0.1)),
            "conflict",
            "#/strategy/scallop_height_mm",
        ),
        (
            with(BEZIER_PATCHES, "/strategy", json!({ "kind": "cl_cartesian" })),
            "missing_field",
            "#/strategy/stepover_mm",
        ),
    ] {
        let answer = post(&app, MILL, body, &[]).await;
        assert_eq!(answer.status, 422, "{pointer}");
        assert_eq!(answer.violations(), [(code.to_owned(), pointer.to_owned())]);
    }
}
