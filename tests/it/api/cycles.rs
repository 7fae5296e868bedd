//! Tests of canned cycles in toolpaths that are sent: programs with the cycle and with its moves, and the
//! refusal of illegal cycles.

use serde_json::{Value, json};

use super::support::{Answer, app, get, post};

const WRITE: &str = "/v1/programs/write";
const HOLES: &str = include_str!("../../../openapi/examples/programs-write/holes.json");

async fn write(body: &Value, format: &str) -> Answer {
    post(&app(&["--workers", "1"]), &format!("{WRITE}?format={format}"), body.to_string(), &[]).await
}

fn drill() -> Value {
    json!({ "kind": "cycle", "cycle": "peck", "places": [[10, 10], [30, 10]], "top_z_mm": 0,
        "retract_z_mm": 2, "bottom_z_mm": -12, "peck_mm": 5, "feed_mm_per_min": 200 })
}

/// One tool that drills from 20 mm above.
fn request(cycle: &Value, dialect: &str) -> Value {
    json!({ "toolpath": { "start": [0, 0, 20], "passes": [{ "moves": [cycle] }] },
        "tool": { "shape": "flat", "diameter_mm": 8 }, "program": { "dialect": dialect } })
}

/// The cycle with some members replaced.
fn with(changes: &[(&str, Value)]) -> Value {
    let mut cycle = drill();
    for (member, value) in changes {
        cycle[member] = value.clone();
    }
    cycle
}

#[tokio::test]
async fn each_dialect_writes_the_cycles_that_it_lists_and_the_moves_of_all_others() {
    let dialects = get(&app(&[]), "/v1/dialects").await.json();
    let mut listed = 0;
    for dialect in dialects["dialects"].as_array().expect("a list") {
        let name = dialect["name"].as_str().expect("a name");
        let has = dialect["cycles"].as_array().expect("a list").contains(&json!("peck"));
        listed += usize::from(has);
        let answer = write(&request(&drill(), name), "gcode").await;
        assert_eq!(answer.status, 200, "{name}: {}", answer.text());
        let text = answer.text();
        let is_cycle = ["G83 ", "CYCLE83(", "CYCL DEF 200"].iter().any(|word| text.contains(word));
        assert_eq!(is_cycle, has, "{name}\n{text}");
        // Three pecks in each of two holes.
        if !has {
            let cuts = text.lines().filter(|line| line.contains("-12") || line.contains("- 12")).count();
            assert!(cuts >= 2, "{name}\n{text}");
        }
    }
    assert_eq!(listed, 8);
}

#[tokio::test]
async fn six_tools_two_offsets_and_four_cycles_are_one_program() {
    let body: Value = serde_json::from_str(HOLES).expect("JSON");
    let text = write(&body, "gcode").await.text();
    for word in ["T6 M6", "G55", "G99 G82", "G98 G83", "G99 G73", "G99 G85", "G4 P0.500"] {
        assert!(text.contains(word), "{word}\n{text}");
    }
    // The report counts holes and moves, and no words that end a cycle.
    let report = write(&body, "json").await.json();
    let words = ["X", "Y", "Z", "G4 P"];
    let is_block = |line: &&str| {
        let codes = ["G0 ", "G1 ", "G98 G83 ", "G99 G82 ", "G99 G73 ", "G99 G85 "];
        let text = codes.iter().find_map(|code| line.strip_prefix(code)).unwrap_or(line);
        words.iter().any(|word| text.starts_with(word)) && !line.contains("G53")
    };
    assert_eq!(report["report"]["n_blocks"], text.lines().filter(is_block).count());
}

#[tokio::test]
async fn illegal_cycles_are_refused_with_every_fault_at_once() {
    let pointer = |member: &str| format!("#/toolpath/passes/0/moves/0/{member}");
    let cases: [(Value, Vec<(&str, &str)>); 11] = [
        (with(&[("places", json!([]))]), vec![("places", "too_few_points")]),
        (with(&[("bottom_z_mm", json!(1))]), vec![("bottom_z_mm", "out_of_range")]),
        (with(&[("retract_z_mm", json!(-1))]), vec![("retract_z_mm", "height_below_top")]),
        (with(&[("retract_z_mm", json!(0))]), vec![("retract_z_mm", "height_below_top")]),
        (with(&[("retract_z_mm", json!(1e300))]), vec![("retract_z_mm", "too_large")]),
        (with(&[("retract_z_mm", json!(21))]), vec![("retract_z_mm", "conflict")]),
        (with(&[("peck_mm", Value::Null)]), vec![("peck_mm", "missing_field")]),
        (with(&[("peck_mm", json!(0))]), vec![("peck_mm", "out_of_range")]),
        (with(&[("dwell_s", json!(1))]), vec![("dwell_s", "conflict")]),
        (with(&[("cycle", json!("ream"))]), vec![("peck_mm", "conflict")]),
        (
            with(&[
                ("cycle", json!("drill")),
                ("bottom_z_mm", json!(0)),
                ("feed_mm_per_min", json!(-1)),
                ("places", json!([[1e9, 0]])),
            ]),
            vec![
                ("places/0/0", "too_large"),
                ("bottom_z_mm", "out_of_range"),
                ("peck_mm", "conflict"),
                ("feed_mm_per_min", "out_of_range"),
            ],
        ),
    ];
    for (cycle, expected) in cases {
        let answer = write(&request(&cycle, "linuxcnc"), "gcode").await;
        assert_eq!(answer.status, 422, "{cycle}: {}", answer.text());
        let found = answer.violations();
        let expected: Vec<(String, String)> =
            expected.iter().map(|(member, code)| ((*code).to_owned(), pointer(member))).collect();
        assert_eq!(found, expected);
    }
}

#[tokio::test]
async fn a_cycle_of_very_many_moves_and_one_of_a_leaning_tool_are_refused() {
    let tiny = with(&[("peck_mm", json!(0.001)), ("bottom_z_mm", json!(-900_000))]);
    let answer = write(&request(&tiny, "linuxcnc"), "gcode").await.json();
    assert_eq!(answer["errors"][0]["code"], "limit_exceeded", "{answer}");
    let mut leaning = request(&drill(), "fanuc");
    leaning["toolpath"]["passes"][0]["axis"] = json!([0, 0.6, 0.8]);
    let answer = write(&leaning, "gcode").await;
    assert_eq!(answer.status, 422);
    assert!(answer.text().contains("straight up"), "{}", answer.text());
}

#[tokio::test]
async fn decimals_that_join_the_heights_of_a_cycle_are_refused() {
    let mut body = request(&with(&[("retract_z_mm", json!(0.04))]), "grbl");
    body["program"]["decimals"] = json!(1);
    let violations = write(&body, "gcode").await.violations();
    assert_eq!(violations, [("out_of_range".to_owned(), "#/program/decimals".to_owned())]);
}

#[tokio::test]
async fn an_illegal_cycle_blames_no_move_behind_it() {
    let mut body = request(&with(&[("peck_mm", Value::Null), ("return_to", json!("start"))]), "fanuc");
    let higher = with(&[("top_z_mm", json!(5)), ("retract_z_mm", json!(7))]);
    body["toolpath"]["passes"][0]["moves"].as_array_mut().expect("a list").push(higher);
    let violations = write(&body, "gcode").await.violations();
    assert_eq!(violations, [("missing_field".to_owned(), "#/toolpath/passes/0/moves/0/peck_mm".to_owned())]);
}
