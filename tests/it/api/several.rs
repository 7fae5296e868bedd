//! Tests of writing several operations as one program: the program, its report and its sheet, and the refusal
//! of illegal requests.

use serde_json::{Value, json};

use super::support::{Answer, app, post};

const WRITE: &str = "/v1/programs/write";
const THREE: &str = include_str!("../../../openapi/examples/programs-write/three-operations.json");

/// The example with members replaced, each by its pointer.
fn with(changes: &[(&str, Value)]) -> Value {
    let mut body: Value = serde_json::from_str(THREE).expect("JSON");
    for (pointer, value) in changes {
        let (parent, member) = pointer.rsplit_once('/').expect("a pointer");
        body.pointer_mut(parent).expect("a member")[member] = value.clone();
    }
    body
}

async fn write(body: &Value, format: &str) -> Answer {
    post(&app(&["--workers", "1"]), &format!("{WRITE}?format={format}"), body.to_string(), &[]).await
}

/// The lines of a program in words, without comments.
fn code(text: &str) -> Vec<&str> {
    text.lines().filter(|line| !line.starts_with('(')).collect()
}

#[tokio::test]
async fn two_tools_and_two_offsets_are_one_program() {
    let answer = write(&with(&[("/program/dialect", json!("linuxcnc"))]), "gcode").await;
    assert_eq!(answer.status, 200, "{}", answer.text());
    let text = answer.text();
    let code = code(&text);
    let expected =
        ["G54", "G53 G0 Z0.000", "T1 M6", "G43 H1", "S4500 M3", "M8", "G0 X0.000 Y0.000", "Z25.000"];
    assert!(code.windows(expected.len()).any(|lines| lines == expected), "{text}");
    let change = ["G53 G0 Z0.000", "M5", "M9", "T2 M6", "G17 G21 G90 G40 G49 G80 G94"];
    assert!(code.windows(change.len()).any(|lines| lines == change), "{text}");
    let start = ["G54", "G43 H2", "S8000 M3", "M8", "G0 X0.000 Y0.000", "Z25.000"];
    assert!(code.windows(start.len()).any(|lines| lines == start), "{text}");
    // The second part is cut with the same tool, whose spindle goes on.
    let offset = ["G53 G0 Z0.000", "G55", "G43 H2", "G0 X0.000 Y0.000", "Z25.000"];
    assert!(code.windows(offset.len()).any(|lines| lines == offset), "{text}");
    assert_eq!((text.matches(" M6").count(), text.matches("M30").count()), (2, 1));
    for comment in [
        "(TOOL: T1 H1 FLAT DIAMETER 10.000 MM)",
        "(TOOL: T2 H2 BALL DIAMETER 6.000 MM)",
        "(OPERATION: 1 OF 3 - WORK OFFSET G54)",
        "(OPERATION: 2 OF 3 - WORK OFFSET G54 - FINISH THE GROOVE)",
        "(OPERATION: 3 OF 3 - WORK OFFSET G55 - THE SAME ON THE SECOND PART)",
        "NO TOOL CHANGES COUNTED)",
    ] {
        assert!(text.contains(comment), "{comment}\n{text}");
    }
}

#[tokio::test]
async fn the_report_and_the_sheet_hold_all_operations() {
    let answer = write(&with(&[]), "json").await.json();
    let mut alone = with(&[]);
    alone.as_object_mut().expect("an object").remove("further_operations");
    let plain = write(&alone, "json").await.json();
    let length = |answer: &Value| answer["measures"]["cutting_length_mm"].as_f64().expect("a length");
    // Two plunges of 6.2 mm and two cuts of 50 mm more.
    assert!((length(&answer) - length(&plain) - 112.4).abs() < 1e-9, "{answer}");
    let blocks = |answer: &Value| answer["report"]["n_blocks"].as_u64().expect("a number");
    assert!(blocks(&answer) > blocks(&plain) + 8);
    let sheet = write(&with(&[]), "svg").await.text();
    for line in ["2 of 3: T2 ball 6 mm, G54", "3 of 3: T2 ball 6 mm, G55", "tool T1 H1: flat, diameter 10 mm"]
    {
        assert!(sheet.contains(line), "{line}\n{sheet}");
    }
    // No list, an empty list and null are the same.
    for further in [json!([]), Value::Null] {
        let body = with(&[("/further_operations", further)]);
        assert_eq!(write(&body, "gcode").await.text(), plain["nc"]);
    }
}

#[tokio::test]
async fn what_cannot_be_one_program_is_refused_at_its_place() {
    let second = "/further_operations/0";
    let at = |member: &str| format!("{second}/{member}");
    let leaning = json!({ "start": [0, 0, 5], "passes": [{ "axis": [0, 0.1, 1], "moves": [
        { "kind": "line", "to": [0, 0, 1], "role": "cut" }
    ] }] });
    let many: Vec<Value> = (0..51).map(|_| with(&[])["further_operations"][1].clone()).collect();
    for (changes, pointer) in [
        (vec![("/program/safe_home".to_owned(), json!("none"))], "#/program/safe_home"),
        (vec![("/program/dialect".to_owned(), json!("grbl"))], "#/further_operations"),
        (vec![(at("tool/number"), json!(1))], "#/further_operations"),
        (vec![(at("cutting/spindle_rpm"), json!(1e7))], "#/further_operations/0/cutting/spindle_rpm"),
        (vec![(at("tool/number"), json!(-1))], "#/further_operations/0/tool/number"),
        (vec![(at("tool/diameter_mm"), json!(0))], "#/further_operations/0/tool/diameter_mm"),
        // The last operation has its own conditions here, because it would take these.
        (
            vec![
                (at("cutting/clearance_z_mm"), json!(-3)),
                ("/further_operations/1/cutting".to_owned(), json!({ "feed_mm_per_min": 500 })),
            ],
            "#/further_operations/0/cutting/clearance_z_mm",
        ),
        (vec![(at("toolpath"), leaning)], "#/further_operations/0/toolpath"),
        (
            vec![(at("toolpath/passes/0/moves/1/to"), json!([1e9, 0, 0]))],
            "#/further_operations/0/toolpath/passes/0/moves/1/to/0",
        ),
        (vec![("/further_operations".to_owned(), Value::Array(many))], "#/further_operations"),
        (
            vec![
                ("/program/dialect".to_owned(), json!("siemens")),
                ("/further_operations/1/work_offset".to_owned(), json!("G58")),
            ],
            "#/further_operations/1/work_offset",
        ),
        (
            vec![("/program/custom".to_owned(), json!({ "tool_change": ["M6"] }))],
            "#/program/custom/tool_change",
        ),
    ] {
        let changes: Vec<(&str, Value)> =
            changes.iter().map(|(pointer, value)| (pointer.as_str(), value.clone())).collect();
        let answer = write(&with(&changes), "gcode").await;
        let violations: Vec<String> = answer.violations().into_iter().map(|(_, at)| at).collect();
        assert_eq!(
            (answer.status.as_u16(), violations),
            (422, vec![pointer.to_owned()]),
            "{}",
            answer.text()
        );
    }
}
