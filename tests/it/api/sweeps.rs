//! Tests of surfaces that are swept from section curves: models, milling, and the refusal of illegal curves.

use serde_json::{Value, json};

use super::support::{MILL, app, post};

const MODEL: &str = "/v1/surfaces/model";
const PARALLEL: &str = include_str!("../../../openapi/examples/surfaces-model/parallel-sweep.json");
const NORMAL: &str = include_str!("../../../openapi/examples/surfaces-model/normal-sweep.json");
const RULED: &str = include_str!("../../../openapi/examples/surfaces-model/ruled.json");
const BEZIER_PATCHES: &str = include_str!("../../../openapi/examples/surfaces-mill/bezier-patches.json");

fn parsed(text: &str) -> Value {
    serde_json::from_str(text).expect("JSON")
}

/// A request for the model of a surface, without wires.
fn of(surface: Value) -> String {
    json!({ "surface": surface }).to_string()
}

fn parallel(basic: &str, drive: &str) -> Value {
    json!({ "kind": "parallel_sweep", "basic": basic, "drive": drive })
}

fn normal(basic: &str, drive: &str) -> Value {
    json!({ "kind": "normal_sweep", "basic": basic, "drive": drive })
}

fn ruled(first: &str, second: &str) -> Value {
    json!({ "kind": "ruled", "first": first, "second": second })
}

fn numbers(point: &Value) -> [f64; 3] {
    [0, 1, 2].map(|c| point[c].as_f64().expect("a number"))
}

#[tokio::test]
async fn the_sweep_of_an_arc_along_a_line_is_a_cylinder() {
    let app = app(&["--workers", "1"]);
    // A half cylinder of radius 20 mm in two quarters. The walls below it are 5 mm high.
    let mut body =
        json!({ "surface": parallel("l(-20,-5) r(-20,20,20) r(20,20,20) l(20,-5)", "l(0,0) l(30,0)") });
    body["wires"] = json!({ "pitch_mm": 5, "direction": "u" });
    let json = post(&app, MODEL, body.to_string(), &[]).await.json();
    assert_eq!(json["warnings"], json!([]));
    let report = &json["report"];
    assert_eq!(report["n_patches"], 4);
    let bounds = ["min", "max"].map(|end| numbers(&report["bounds"][end]));
    for (found, expected) in bounds.iter().flatten().zip([-20.0, 0.0, -5.0, 20.0, 30.0, 20.0]) {
        assert!((found - expected).abs() < 1e-5, "other bounds: {bounds:?}");
    }
    assert_eq!(report["fit_deviation_max_mm"], Value::Null);
    let wires = report["wires"].as_array().expect("wires");
    assert_eq!(wires.len(), 7);
    assert!(wires.iter().all(|wire| wire.as_array().is_some_and(|points| points.len() >= 2)));
    for [x, _, z] in wires.iter().flat_map(|wire| wire.as_array().expect("a wire")).map(numbers) {
        let off = if z > 0.0 { x.hypot(z) } else { x.abs() } - 20.0;
        assert!(off.abs() < 1e-12, "a wire is off the surface at x = {x}, z = {z}");
    }
}

#[tokio::test]
async fn swept_surfaces_have_the_bounds_that_follow_from_the_contract() {
    let app = app(&["--workers", "1"]);
    for (surface, low, high) in [
        (parallel("l(0,0) l(9,4)", "l(1,1) l(8,0)"), [0.0, 0.0, -1.0], [9.0, 7.0, 4.0]),
        (parallel("l(0,0,0) l(9,0,4)", "l(5,5,5) l(5,12,5)"), [0.0, 0.0, 0.0], [9.0, 7.0, 4.0]),
        (normal("l(0,0) l(9,0)", "l(2,1) l(5,3)"), [0.0, 2.0, 1.0], [9.0, 5.0, 3.0]),
        (ruled("l(0,0) l(9,0)", "l(0,5,2) l(9,5,3)"), [0.0, 0.0, 0.0], [9.0, 5.0, 3.0]),
    ] {
        let report = post(&app, MODEL, of(surface), &[]).await.json()["report"].clone();
        assert_eq!(report["bounds"], json!({ "min": low, "max": high }));
        assert_eq!(report["n_patches"], 1);
    }
}

#[tokio::test]
async fn every_sweep_example_has_wires_in_every_direction() {
    let app = app(&["--workers", "1"]);
    for example in [PARALLEL, NORMAL, RULED] {
        for direction in ["u", "v", "x", "y"] {
            let mut body = parsed(example);
            body["wires"]["direction"] = json!(direction);
            let answer = post(&app, MODEL, body.to_string(), &[]).await;
            assert_eq!(answer.status, 200, "{direction} {}", answer.text());
            assert!(answer.json()["report"]["wires"].as_array().is_some_and(|wires| wires.len() > 3));
        }
    }
}

#[tokio::test]
async fn sharp_corners_of_swept_curves_cause_warnings_and_offset_section_refuses_them() {
    let app = app(&["--workers", "1"]);
    for (surface, place) in [
        (parallel("l(0,0) l(20,0) l(40,9)", "l(0,0) l(30,0)"), [20.0, 0.0, 0.0]),
        (parallel("l(0,0) l(20,0)", "l(0,0) r(9,0,0) l(30,4)"), [0.0, 9.0, 0.0]),
        (normal("l(0,0) l(20,0) l(20,20)", "l(0,0) l(4,1)"), [20.0, 0.0, 0.0]),
        (ruled("l(0,0) l(10,0) l(20,5)", "l(0,30,5) l(20,30,5)"), [10.0, 0.0, 0.0]),
    ] {
        for direction in ["u", "x", "y"] {
            let body = json!({ "surface": surface, "wires": { "pitch_mm": 3, "direction": direction } });
            let answer = post(&app, MODEL, body.to_string(), &[]).await;
            assert!(answer.status == 200 || answer.status == 422, "{}", answer.text());
        }
        let model = post(&app, MODEL, of(surface.clone()), &[]).await.json();
        assert_eq!(model["warnings"][0]["code"], "not_smooth", "{surface}");
        let mut body = parsed(BEZIER_PATCHES);
        body["surface"] = surface;
        body["boundary"] = json!("on");
        let milled = post(&app, MILL, body.to_string(), &[]).await;
        assert_eq!(milled.status, 200, "{}", milled.text());
        body["engine"] = json!("offset_section");
        let refused = post(&app, MILL, body.to_string(), &[]).await;
        assert_eq!((refused.status.as_u16(), refused.code().as_str()), (422, "not_smooth"));
        let found = numbers(&refused.problem()["place"]);
        assert!(
            found.iter().zip(place).all(|(a, b)| (a - b).abs() < 0.5),
            "the corner is reported at {found:?}, not {place:?}"
        );
    }
}

#[tokio::test]
async fn swept_surfaces_are_milled_within_the_tolerance() {
    let app = app(&["--workers", "1"]);
    for example in [PARALLEL, NORMAL, RULED] {
        let mut body = parsed(BEZIER_PATCHES);
        body["surface"] = parsed(example)["surface"].clone();
        body["tool"]["diameter_mm"] = json!(4);
        body["strategy"]["stepover_mm"] = json!(15);
        let answer = post(&app, &format!("{MILL}?toolpath=false"), body.to_string(), &[]).await;
        assert_eq!(answer.status, 200, "{}", answer.text());
        let report = answer.json()["report"].clone();
        for name in ["deviation_max_mm", "gouge_max_mm"] {
            assert!(
                report[name].as_f64().is_some_and(|mm| mm <= 0.01),
                "{name} exceeds the tolerance: {report}"
            );
        }
    }
}

#[tokio::test]
async fn every_violation_in_a_section_curve_has_its_code_pointer_and_offset() {
    let app = app(&["--workers", "1"]);
    let line = "l(0,0) l(9,0)";
    for (surface, code, name, offset) in [
        (parallel("l(0,0", line), "syntax", "basic", 5),
        (parallel(line, "l(0,0) l(0,0)"), "coincident", "drive", 7),
        (parallel("l(0,0) r(9,0,99) l(9,9)", line), "syntax", "basic", 7),
        (ruled(line, "l(0,0,0) l(1,1)"), "syntax", "second", 10),
        // The rounding of 10 mm is too small, because the drive curve reaches 11 mm to the left.
        (normal("l(0,0) r(40,0,10) l(40,40)", "l(0,0) l(11,3)"), "out_of_range", "basic", 7),
        // A corner beside a smooth curve cannot be mitred, and neither can a corner that turns back.
        (normal("l(0,0) b((20,0),(30,9),(50,0))", "l(0,0) l(4,3)"), "out_of_range", "basic", 7),
        (normal("l(0,0) l(20,0) l(0,0.01)", "l(0,0) l(4,3)"), "out_of_range", "basic", 7),
    ] {
        let answer = post(&app, MODEL, of(surface.clone()), &[]).await;
        assert_eq!(answer.status, 422, "{surface}");
        let pointer = format!("#/surface/{name}");
        assert_eq!(answer.violations(), [(code.to_owned(), pointer)], "{surface}");
        assert_eq!(answer.problem()["errors"][0]["offset"], offset, "{surface}");
    }
    let both = post(&app, MODEL, of(normal("", "l(0,0,0) l(1,1,1)")), &[]).await;
    let expected = [("syntax", "#/surface/basic"), ("wrong_length", "#/surface/drive")];
    assert_eq!(both.violations(), expected.map(|(code, at)| (code.to_owned(), at.to_owned())));
    for (surface, code, pointer) in [
        (json!({ "kind": "ruled", "first": line }), "missing_field", "#/surface/second"),
        (json!({ "kind": "ruled", "first": line, "second": 3 }), "wrong_type", "#/surface/second"),
        (json!({ "kind": "normal_sweep", "first": line }), "unknown_field", "#/surface/first"),
    ] {
        let answer = post(&app, MODEL, of(surface), &[]).await;
        assert_eq!(answer.violations()[0], (code.to_owned(), pointer.to_owned()));
    }
}

#[tokio::test]
async fn sweeps_that_need_too_many_patches_or_points_are_refused() {
    let app = app(&["--workers", "1"]);
    let zigzag = |n: usize| (0..n).map(|k| format!("l({k},{}) ", k % 2)).collect::<String>();
    let many = post(&app, MODEL, of(parallel(&zigzag(2000), &zigzag(2000))), &[]).await;
    assert_eq!(many.violations(), [("limit_exceeded".to_owned(), "#/surface".to_owned())]);
    // A smooth curve of great length would need more and more patches beside a line.
    let wild: String = (0..20_000).map(|k| format!("({},{}),", k % 2 * 900_000, k)).collect();
    let wild = format!("b({}(0,50000))", wild);
    for surface in [ruled(&wild, "l(0,0,9) l(5,0,9)"), normal(&wild, "l(0,0) l(1000000,1)")] {
        let refused = post(&app, MODEL, of(surface), &[]).await;
        assert_eq!(refused.status, 422, "{}", refused.text());
    }
    let few = super::support::app(&["--workers", "1", "--max-curve-points", "3"]);
    let refused = post(&few, MODEL, of(ruled(&zigzag(5), &zigzag(4))), &[]).await;
    assert_eq!(refused.violations(), [("limit_exceeded".to_owned(), "#/surface/first".to_owned())]);
}

#[tokio::test]
async fn a_normal_sweep_follows_a_curve_in_space_and_refuses_one_that_stands_upright() {
    let app = app(&["--workers", "1"]);
    let rising = of(normal("l(0,0,0) l(20,0,6) l(20,30,4)", "l(0,0) l(4,5)"));
    let report = post(&app, MODEL, rising, &[]).await.json()["report"].clone();
    assert_eq!(report["bounds"], json!({ "min": [0.0, 0.0, 0.0], "max": [20.0, 30.0, 11.0] }));
    let level = |basic: &str| of(normal(basic, "b((-2,0),(0,3),(2,0))"));
    let [plane, space] = ["l(0,0) r(20,0,5) l(20,20)", "l(0,0,0) r(20,0,0,5) l(20,20,0)"].map(level);
    let [plane, space] = [post(&app, MODEL, plane, &[]).await, post(&app, MODEL, space, &[]).await];
    assert_eq!(plane.text(), space.text());
    let upright = of(normal("l(0,0,0) l(20,0,0) l(20,0,9)", "l(0,0) l(4,5)"));
    let refused = post(&app, MODEL, upright, &[]).await;
    assert_eq!(refused.violations(), [("out_of_range".to_owned(), "#/surface/basic".to_owned())]);
}

#[tokio::test]
async fn smooth_parts_are_read_as_the_paper_prints_them() {
    let app = app(&["--workers", "1"]);
    let of_drive = |drive: &str| of(parallel("l(0,0) l(30,0)", drive));
    let [enclosed, printed] =
        ["l(-5,0) b((0,0),(9,4),(20,0))", "l(-5,0) b(0,0), (9,4), (20,0)"].map(of_drive);
    let [enclosed, printed] = [post(&app, MODEL, enclosed, &[]).await, post(&app, MODEL, printed, &[]).await];
    assert_eq!((enclosed.status.as_u16(), enclosed.text()), (200, printed.text()));
}

#[tokio::test]
async fn a_picture_is_axonometric_where_the_query_asks_for_it() {
    let app = app(&["--workers", "1"]);
    let milled = with_stepover(BEZIER_PATCHES);
    for (path, body) in [(MODEL, NORMAL.to_owned()), (MILL, milled)] {
        let picture =
            async |query: &str| post(&app, &format!("{path}?format=svg{query}"), body.clone(), &[]).await;
        let [plain, plan] = [picture("").await, picture("&view=plan").await];
        assert_eq!(plain.text(), plan.text());
        let axonometric = picture("&view=axonometric").await;
        assert_eq!(axonometric.status, 200);
        assert!(
            axonometric.text().contains("id=\"axonometric\"") && !plain.text().contains("id=\"axonometric\"")
        );
        let refused = picture("&view=side").await;
        assert_eq!((refused.status.as_u16(), refused.code().as_str()), (400, "invalid_query"));
    }
}

fn with_stepover(body: &str) -> String {
    let mut body = parsed(body);
    body["strategy"]["stepover_mm"] = json!(15);
    body.to_string()
}
