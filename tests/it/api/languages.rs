//! One toolpath written for every dialect is the same when it is read again.

use serde_json::{Value, json};

use super::support::{app, post};

/// What the decimals of a program may change in a length of some metres, mm.
const LENGTH_MM: f64 = 0.05;

/// What the decimals of a program may change in a place, mm.
const PLACE_MM: f64 = 0.002;

/// The measures of the body of a program, written in a dialect and read again.
async fn measures(mut body: Value, dialect: &str) -> Value {
    let app = app(&["--workers", "1"]);
    body["program"]["dialect"] = json!(dialect);
    // Not every dialect has mist.
    if body["cutting"]["coolant"] == "mist" {
        body["cutting"]["coolant"] = json!("flood");
    }
    let written = post(&app, "/v1/programs/write?format=json", body.to_string(), &[]).await;
    assert_eq!(written.status, 200, "{dialect}: {}", written.text());
    let written: Value = serde_json::from_str(&written.text()).expect("JSON");
    let nc = &written["nc"];
    let read = json!({ "nc": nc, "dialect": dialect, "start": [0, 0, 100] }).to_string();
    let answer = post(&app, "/v1/programs/read?toolpath=false", read, &[]).await;
    assert_eq!(answer.status, 200, "{dialect}: {}\n{}", answer.text(), nc.as_str().unwrap_or_default());
    let answer: Value = serde_json::from_str(&answer.text()).expect("JSON");
    answer["measures"].clone()
}

/// A body from the examples.
fn example(name: &str) -> Value {
    let path = format!("{}/openapi/examples/programs-write/{name}.json", env!("CARGO_MANIFEST_DIR"));
    serde_json::from_str(&std::fs::read_to_string(path).expect("an example")).expect("JSON")
}

async fn agree(name: &str, dialects: &[&str]) {
    let expected = measures(example(name), "linuxcnc").await;
    for dialect in dialects {
        let found = measures(example(name), dialect).await;
        let value = |of: &Value, path: &str| of.pointer(path).and_then(Value::as_f64).expect("a number");
        for (path, allowed) in [
            ("/cutting_length_mm", LENGTH_MM),
            ("/bounds/min/0", PLACE_MM),
            ("/bounds/min/1", PLACE_MM),
            ("/bounds/min/2", PLACE_MM),
            ("/bounds/max/0", PLACE_MM),
            ("/bounds/max/1", PLACE_MM),
        ] {
            let (a, b) = (value(&expected, path), value(&found, path));
            assert!((a - b).abs() <= allowed, "{name}, {dialect}, {path}: {a} {b}");
        }
    }
}

#[tokio::test]
async fn a_contour_is_the_same_in_every_language() {
    agree("contour", &["fanuc", "haas", "mazak", "okuma", "iso", "mach4", "grbl", "siemens", "heidenhain"])
        .await;
}

#[tokio::test]
async fn an_arc_of_a_crown_is_the_same_in_every_language() {
    agree("inch-fanuc", &["fanuc", "siemens", "heidenhain"]).await;
}

#[tokio::test]
async fn several_tools_and_cycles_are_the_same_in_every_language() {
    agree("three-operations", &["fanuc", "haas", "siemens", "heidenhain"]).await;
}
