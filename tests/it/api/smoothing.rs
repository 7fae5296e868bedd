//! Tests of `program.smoothing` through the interface.

use serde_json::{Value, json};
use toolpathd_post::DIALECTS;

use super::support::{Answer, app, for_dialect, post};

const ONE_LINE: &str = include_str!("../../../openapi/examples/programs-write/one-line.json");

async fn write(dialect: &str, program: Value) -> Answer {
    let dialect = toolpathd_post::dialect(dialect).expect("a dialect");
    let mut body = for_dialect(serde_json::from_str(ONE_LINE).expect("JSON"), dialect);
    for (name, value) in program.as_object().expect("an object") {
        body["program"][name] = value.clone();
    }
    post(&app(&["--workers", "1"]), "/v1/programs/write?format=gcode", body.to_string(), &[]).await
}

#[tokio::test]
async fn each_control_gets_its_own_word_for_smoothing() {
    for (dialect, smoothing, line) in [
        ("linuxcnc", json!({ "tolerance_mm": 0.02 }), "G64 P0.020 Q0"),
        ("siemens", json!({ "tolerance_mm": 0.02, "mode": "roughing" }), "CYCLE832(0.020,_ROUGH,1)"),
        ("fanuc", json!({ "mode": "finishing" }), "G5.1 Q1 R10"),
        ("haas", json!({ "tolerance_mm": 0.02, "mode": "semi_finishing" }), "G187 P2 E0.020"),
        ("heidenhain", json!({ "tolerance_mm": 0.02 }), "CYCL DEF 32.1 T0.020"),
    ] {
        let answer = write(dialect, json!({ "smoothing": smoothing })).await;
        assert_eq!(answer.status, 200, "{dialect}: {}", answer.text());
        assert!(answer.text().contains(line), "{dialect}: {}", answer.text());
    }
}

#[tokio::test]
async fn what_a_control_has_no_word_for_is_refused_at_its_place() {
    for dialect in DIALECTS.iter().filter(|dialect| dialect.smoothing.is_none()) {
        let answer = write(dialect.name, json!({ "smoothing": {} })).await;
        let expected = vec![("unsupported".to_owned(), "#/program/smoothing".to_owned())];
        assert_eq!(answer.violations(), expected, "{}", dialect.name);
    }
    for (dialect, smoothing, at) in [
        ("linuxcnc", json!({}), "#/program/smoothing"),
        ("linuxcnc", json!({ "tolerance_mm": 0.01, "mode": "finishing" }), "#/program/smoothing/mode"),
        ("fanuc", json!({ "tolerance_mm": 0.01 }), "#/program/smoothing/tolerance_mm"),
        ("haas", json!({ "tolerance_deg": 0.1 }), "#/program/smoothing/tolerance_deg"),
        ("heidenhain", json!({ "tolerance_mm": 0.01, "mode": "semi_finishing" }), "#/program/smoothing/mode"),
    ] {
        let answer = write(dialect, json!({ "smoothing": smoothing })).await;
        assert_eq!(
            answer.violations(),
            vec![("unsupported".to_owned(), at.to_owned())],
            "{dialect} {smoothing}"
        );
    }
    let answer = write("linuxcnc", json!({ "smoothing": { "tolerance_mm": 0.0 } })).await;
    let expected = vec![("out_of_range".to_owned(), "#/program/smoothing/tolerance_mm".to_owned())];
    assert_eq!(answer.violations(), expected);
}

#[tokio::test]
async fn a_line_of_the_shop_that_smooths_stands_alone_or_both_places_are_named() {
    for (dialect, line, smoothing) in [
        ("linuxcnc", "G64 P0.05", json!({ "tolerance_mm": 0.02 })),
        ("siemens", "CYCLE832(0.05,_ROUGH,1)", json!({ "tolerance_mm": 0.02 })),
        ("fanuc", "G5.1 Q1 R1", json!({})),
        ("haas", "G187 P1", json!({})),
        ("heidenhain", "CYCL DEF 32.1 T0.05", json!({ "tolerance_mm": 0.02 })),
    ] {
        let custom = json!({ "header": ["M1", line] });
        let alone = write(dialect, json!({ "custom": custom })).await;
        assert_eq!(alone.status, 200, "{dialect}: {}", alone.text());
        let words = ["G64 P", "G641", "CYCLE832", "G5.1", "G187", "CYCL DEF 32."];
        let text = alone.text();
        let found = text.lines().filter(|line| words.iter().any(|word| line.contains(word))).count();
        assert_eq!(found, 1, "{dialect}: {text}");
        let both = write(dialect, json!({ "custom": custom, "smoothing": smoothing })).await;
        let expected = vec![("unsupported".to_owned(), "#/program/smoothing".to_owned())];
        assert_eq!(both.violations(), expected, "{dialect}");
        assert!(both.text().contains("/program/custom/header/1"), "{}", both.text());
    }
}
