//! Tests of `/v1/programs/read` through the interface.

use axum::body::Body;
use axum::http::Request;
use serde_json::{Value, json};

use super::support::{Answer, app, post, send};

const PATH: &str = "/v1/programs/read";

async fn read(query: &str, text: &str) -> Answer {
    let path = format!("{PATH}?{query}");
    let request = Request::post(path).header("content-type", "text/x-gcode");
    send(&app(&["--workers", "1"]), request.body(Body::from(text.to_owned())).expect("a request")).await
}

fn parsed(answer: &Answer) -> Value {
    serde_json::from_str(&answer.text()).expect("JSON")
}

fn close(value: &Value, expected: f64) {
    let value = value.as_f64().expect("a number");
    assert!((value - expected).abs() <= 1e-9 * (1.0 + expected.abs()), "{value} {expected}");
}

#[tokio::test]
async fn text_and_json_give_the_same_figures() {
    let text = "G21 G90 G17 G94\nG0 X0 Y0 Z5\nG1 Z-1 F100\nG3 I-4.5\nG4 P2\nG0 Z5\nM2\n";
    let answer = read("dialect=linuxcnc&rapid_feed_mm_per_min=6000", text).await;
    assert_eq!(answer.status, 200, "{}", answer.text());
    let of_text = parsed(&answer);
    let measures = &of_text["measures"];
    let cut = 6.0 + 9.0 * std::f64::consts::PI;
    close(&measures["cutting_length_mm"], cut);
    close(&measures["rapid_time_s"], 0.06);
    close(&measures["total_time_s"], cut / 100.0 * 60.0 + 2.0 + 0.06);
    close(&measures["bounds"]["min"][0], -9.0);
    assert_eq!(of_text["toolpath"]["passes"][0]["moves"][1]["kind"], "arc");
    let body = json!({ "nc": text, "rapid_feed_mm_per_min": 6000 }).to_string();
    let of_json = post(&app(&["--workers", "1"]), PATH, body, &[]).await;
    assert_eq!(parsed(&of_json), of_text);
    let bare = read("toolpath=false", text).await;
    assert_eq!(parsed(&bare).get("toolpath"), None);
    assert!(read("format=svg", text).await.text().starts_with("<svg"));
}

#[tokio::test]
async fn refusals_are_told_together_with_line_column_and_word() {
    let answer = read("", "G21 G90\nG0 X0 Y0 Z0\nG1 X5\nG999\nM2\n").await;
    assert_eq!(answer.status, 422);
    let errors = &parsed(&answer)["errors"];
    let told = |k: usize| ["code", "line", "column", "word"].map(|name| errors[k][name].clone());
    assert_eq!(told(0), [json!("feed_required"), json!(3), json!(1), json!("G1 X5")]);
    assert_eq!(told(1), [json!("refused_word"), json!(4), json!(1), json!("G999")]);
    let alone = read("", "G21 G0 X1\nM2\n").await;
    assert_eq!(alone.status, 422);
    assert_eq!(parsed(&alone)["code"], "no_motion");
    assert_eq!(read("dialect=deckel", "G0 X1\n").await.status, 400);
    let offsets = json!({ "nc": "M2", "offsets": [{ "name": "G53", "zero": [0, 0, 0] }] }).to_string();
    let answer = post(&app(&["--workers", "1"]), PATH, offsets, &[]).await;
    assert_eq!(answer.violations(), [("unknown_value".to_owned(), "#/offsets/0/name".to_owned())]);
}

#[tokio::test]
async fn a_pass_behind_an_unknown_way_has_its_own_start() {
    let text = "G21 G90\nG0 X0 Y0 Z5\nG0 X1\nG28\nG0 X9 Y9 Z9\nG0 X8\nG4 P3000\nM30\n";
    let answer = parsed(&read("dialect=grbl", text).await);
    assert_eq!(answer["toolpath"]["passes"][1]["start"], json!([9.0, 9.0, 9.0]));
    close(&answer["measures"]["rapid_length_mm"], 2.0);
    assert_eq!(answer["warnings"][0]["code"], "long_dwell");
}

#[tokio::test]
async fn the_state_behind_each_block_is_told() {
    let text = "G21 G90 G17\nT3 M6\nG0 X0 Y0 Z5\nG1 X10 F100 S900 M3\nG2 X20 I5\nM2\n";
    let answer = parsed(&read("trace=true&toolpath=false", text).await);
    let trace = answer["report"]["trace"].as_array().expect("a trace").clone();
    let of = |k: usize, name: &str| trace[k][name].clone();
    assert_eq!((trace.len(), of(3, "line"), of(3, "motion")), (6, json!(4), json!("line")));
    assert_eq!((of(3, "feed"), of(3, "spindle_rpm"), of(3, "tool")), (json!(100.0), json!(900.0), json!(3)));
    assert_eq!((of(4, "motion"), of(4, "at")), (json!("arc_clockwise"), json!([20.0, 0.0, 5.0])));
    assert_eq!((of(0, "motion"), of(0, "at")), (json!(null), json!([null, null, null])));
    let plain = parsed(&read("toolpath=false", text).await);
    assert_eq!(plain["report"].get("trace"), None);
}

#[tokio::test]
async fn cutter_compensation_is_computed_for_a_radius() {
    let text = "G21 G90 G17\nG0 X0 Y0 Z0\nG41 G1 X10 Y0 F100\nX30\nG40 X50\nM2\n";
    let refused = read("", text).await;
    assert_eq!(refused.violations()[0].0, "unsupported");
    let answer = read("compensation=compute&cutter_radius_mm=2", text).await;
    let bounds = parsed(&answer)["measures"]["bounds"].clone();
    assert_eq!((&bounds["max"][1], &bounds["max"][0]), (&json!(2.0), &json!(50.0)), "{}", answer.text());
    let none = read("compensation=compute", text).await;
    assert!(none.text().contains("cutter_radius_mm"), "{}", none.text());
    assert_eq!(read("compensation=compute&cutter_radius_mm=0", text).await.status, 400);
}

#[tokio::test]
async fn tools_are_told_by_name() {
    let text = "G71 G90 G17\nT=\"MILL_10\"\nM6\nG0 X0 Y0 Z5\nG1 X10 F100 S900 M3\nM30\n";
    let answer = read("dialect=siemens", text).await;
    let tool = parsed(&answer)["report"]["tools"][0].clone();
    assert_eq!((&tool["name"], &tool["number"]), (&json!("MILL_10"), &json!(null)), "{}", answer.text());
}
