//! Tests of writing programs: every example in every form and dialect, and the refusal of illegal requests.

use std::time::{Duration, Instant};

use proptest::prelude::*;
use serde_json::{Value, json};
use toolpathd_post::DIALECTS;
use toolpathd_post::read::{Reader, Step};

use super::support::{Answer, MILL, app, for_dialect, get, post};

const WRITE: &str = "/v1/programs/write";

const EXAMPLES: [(&str, &str); 4] = [
    ("contour", include_str!("../../../openapi/examples/programs-write/contour.json")),
    ("inch-fanuc", include_str!("../../../openapi/examples/programs-write/inch-fanuc.json")),
    ("one-line", include_str!("../../../openapi/examples/programs-write/one-line.json")),
    ("parabolas", include_str!("../../../openapi/examples/programs-write/parabolas.json")),
];

const DIE: &str = include_str!("../../../openapi/examples/surfaces-mill/die.json");

fn example(name: &str) -> Value {
    let (_, text) = EXAMPLES.iter().find(|(known, _)| *known == name).expect("an example");
    serde_json::from_str(text).expect("JSON")
}

async fn write(body: &Value) -> Answer {
    post(&app(&["--workers", "1"]), WRITE, body.to_string(), &[]).await
}

/// The example `name` with one member replaced or added.
fn with(name: &str, pointer: &str, value: Value) -> Value {
    let mut body = example(name);
    let (parent, member) = pointer.rsplit_once('/').expect("a pointer");
    if body.pointer(parent).is_none() {
        body[parent.trim_start_matches('/')] = json!({});
    }
    let parent = body.pointer_mut(parent).expect("a member");
    match parent {
        Value::Array(elements) => elements[member.parse::<usize>().expect("an index")] = value,
        parent => parent[member] = value,
    }
    body
}

#[tokio::test]
async fn every_example_of_writing_is_answered_in_every_form_and_dialect() {
    let app = app(&["--workers", "1"]);
    for (name, _) in EXAMPLES {
        for dialect in DIALECTS {
            let body = for_dialect(example(name), dialect).to_string();
            let nc = post(&app, WRITE, body.clone(), &[]).await;
            assert_eq!(nc.status, 200, "{name} {}: refused", dialect.name);
            assert_eq!(nc.header("content-type"), "text/x-gcode; charset=us-ascii");
            let ending = format!(".{}\"", dialect.file_extension);
            assert!(
                nc.header("content-disposition").ends_with(&ending),
                "{name} {}: another file extension",
                dialect.name
            );
            for (format, content_type) in
                [("json", "application/json"), ("svg", "image/svg+xml"), ("html", "text/html")]
            {
                let answer = post(&app, &format!("{WRITE}?format={format}"), body.clone(), &[]).await;
                assert_eq!(answer.status, 200, "{name} {format}: refused");
                assert!(
                    answer.header("content-type").starts_with(content_type),
                    "{name} {format}: another media type"
                );
            }
            let json = post(&app, WRITE, body, &[("accept", "application/json")]).await.json();
            assert_eq!(
                json["nc"].as_str().map(str::as_bytes),
                Some(nc.body.as_slice()),
                "{name}: another program in the JSON answer"
            );
            certificate_holds(&json, dialect);
        }
    }
}

/// Fails unless the figures of a report agree with the program beside it.
fn certificate_holds(answer: &Value, dialect: &toolpathd_post::Dialect) {
    let (report, nc) = (&answer["report"], answer["nc"].as_str().expect("a text"));
    let unit = if report["units"] == "inch" { 25.4 } else { 1.0 };
    let decimals = i32::try_from(report["decimals"].as_i64().expect("a number")).expect("a small number");
    let limit_mm = 1.5 * unit / 10f64.powi(decimals);
    let steps: Vec<Step> =
        Reader::new(nc, dialect, limit_mm).map(|placed| placed.expect("a legal text").step).collect();
    assert_eq!(report["n_blocks"], steps.len());
    assert_eq!(report["n_bytes"], nc.len());
    assert_eq!(report["dialect"], dialect.name);
    let largest = steps.iter().fold(0f64, |largest, step| match step {
        Step::Feed { radius_mismatch_mm, .. } => largest.max(*radius_mismatch_mm),
        Step::Rapid { .. } | Step::Posed(_) | Step::Rail(_) | Step::Hole(_) | Step::Dwell { .. } => largest,
    });
    let figure = |name: &str| report[name].as_f64().expect("a figure");
    assert!((figure("radius_mismatch_max_mm") - largest).abs() < 1e-9, "the mismatch is {largest}");
    assert!(figure("deviation_max_mm") <= limit_mm + figure("arc_adjustment_max_mm"));
    assert!(figure("arc_adjustment_max_mm") <= limit_mm);
    let measures = &answer["measures"];
    let times = ["total_time_s", "time_with_acceleration_s"].map(|name| measures[name].as_f64().expect(name));
    assert!(
        times[1] > times[0] && times[1] < 2.0 * times[0],
        "the time with acceleration is not plausible: {times:?}"
    );
}

#[tokio::test]
async fn milling_and_writing_make_the_same_program_of_a_toolpath() {
    let app = app(&["--workers", "1"]);
    let milled = post(&app, MILL, DIE, &[]).await.json();
    let job: Value = serde_json::from_str(DIE).expect("JSON");
    let body = json!({
        "toolpath": milled["toolpath"], "tool": job["tool"], "cutting": job["cutting"],
        "program": job["program"], "meta": job["meta"],
    });
    let blocks = |answer: Answer| -> Vec<String> {
        let text = String::from_utf8(answer.body).expect("ASCII");
        text.lines().filter(|line| !line.starts_with('(')).map(str::to_owned).collect()
    };
    let own = blocks(post(&app, &format!("{MILL}?format=gcode"), DIE, &[]).await);
    assert!(own.len() > 100, "only {} blocks", own.len());
    assert_eq!(blocks(post(&app, WRITE, body.to_string(), &[]).await), own);
    let report = post(&app, &format!("{WRITE}?format=json"), body.to_string(), &[]).await.json();
    assert_eq!(report["report"]["arc_adjustment_max_mm"], 0.0);
}

fn parabola(to: [i32; 3], control: Value) -> Value {
    json!({ "kind": "parabola", "to": to, "control": control })
}

#[tokio::test]
async fn every_violation_in_a_move_has_its_code_and_its_pointer() {
    let moves = "/toolpath/passes/0/moves";
    for (place, value, code, blamed) in [
        ("/3/to/1", json!("9"), "wrong_type", "/3/to/1"),
        ("/3/to", json!([1, 2]), "wrong_length", "/3/to"),
        ("/3/to/1", json!(2e6), "too_large", "/3/to/1"),
        ("/3/kind", json!("parabola"), "missing_field", "/3/control"),
        ("/3/kind", json!("spline"), "unsupported", "/3/kind"),
        ("/3/kind", json!("curve"), "unknown_value", "/3/kind"),
        ("/3/axis", json!([0, 0, 0]), "out_of_range", "/3/axis"),
        ("/3", json!({ "kind": "turn", "axis": [0, 1, 0] }), "feed_required", "/3/seconds"),
        ("/3/role", json!("cutting"), "unknown_value", "/3/role"),
        ("/3/feed_mm_per_min", json!(0), "out_of_range", "/3/feed_mm_per_min"),
        ("/0/feed_mm_per_min", json!(9), "unknown_field", "/0/feed_mm_per_min"),
        ("/3", json!({ "kind": "dwell", "seconds": -1 }), "out_of_range", "/3/seconds"),
        ("/3", json!({ "kind": "dwell", "seconds": 1e5 }), "out_of_range", "/3/seconds"),
        ("/3", json!({ "to": [0, 0, 0] }), "missing_field", "/3/kind"),
        ("/3", json!({ "kind": "line" }), "missing_field", "/3/to"),
        ("/3", json!(7), "wrong_type", "/3"),
        ("/3", parabola([0, 0, -3], json!([1e7, 0, 0])), "too_large", "/3/control/0"),
        ("/3", parabola([0, 0, -3], json!([0, 0])), "wrong_length", "/3/control"),
        ("/4/plane", json!("xz"), "unknown_value", "/4/plane"),
        ("/4/center/0", json!(20.1), "no_arc", "/4"),
        ("/4/center/2", json!(-2), "no_arc", "/4"),
        ("/4/center", json!([20, -20, -3]), "no_arc", "/4"),
        ("/4/center/0", json!(-1e7), "too_large", "/4/center/0"),
    ] {
        let answer = write(&with("contour", &format!("{moves}{place}"), value.clone())).await;
        assert_eq!(answer.status, 422, "{place} {value}");
        let found = answer.violations();
        let wanted = (code.to_owned(), format!("#{moves}{blamed}"));
        assert_eq!(found.first(), Some(&wanted), "{place} {value}");
    }
    let answer = write(&with("contour", &format!("{moves}/4/center/0"), json!(20.1))).await;
    let detail = answer.problem()["errors"][0]["detail"].as_str().expect("a detail").to_owned();
    assert!(
        detail.contains("10.0004") && detail.contains("9.89"),
        "the detail does not tell both radii: {detail}"
    );
}

#[tokio::test]
async fn all_violations_of_a_program_are_reported_in_one_answer() {
    let mut body = example("contour");
    let moves = "/toolpath/passes/0/moves";
    body["toolpath"]["start"][2] = json!(-2e6);
    *body.pointer_mut(&format!("{moves}/3/to/0")).expect("a member") = json!(3e6);
    *body.pointer_mut(&format!("{moves}/6/center/0")).expect("a member") = json!(20.5);
    body["tool"] = json!({ "shape": "bull_nose", "diameter_mm": 8, "corner_radius_mm": 5 });
    body["cutting"]["link_feed_mm_per_min"] = json!(-3);
    body["cutting"]["acceleration_mm_per_s2"] = json!(0);
    body["program"] = json!({ "dialect": "fanuc", "number": 10_000 });
    let found: Vec<String> = write(&body).await.violations().into_iter().map(|(_, at)| at).collect();
    for wanted in [
        "#/program/number",
        "#/cutting/link_feed_mm_per_min",
        "#/cutting/acceleration_mm_per_s2",
        "#/tool/corner_radius_mm",
        "#/toolpath/start/2",
        "#/toolpath/passes/0/moves/3/to/0",
        "#/toolpath/passes/0/moves/6",
    ] {
        assert!(found.iter().any(|at| at == wanted), "{wanted} is not among {found:?}");
    }
}

#[tokio::test]
async fn every_violation_in_tool_program_meta_and_heights_has_its_code_and_its_pointer() {
    let long = "x".repeat(1001);
    for (place, value, code, blamed) in [
        (
            "/tool",
            json!({ "shape": "bull_nose", "diameter_mm": 8 }),
            "missing_field",
            "/tool/corner_radius_mm",
        ),
        ("/tool/corner_radius_mm", json!(1), "unknown_field", "/tool/corner_radius_mm"),
        ("/program/dialect", json!("klingon"), "unknown_dialect", "/program/dialect"),
        ("/program/name", json!(long), "too_long", "/program/name"),
        ("/meta/part_id", json!(long), "too_long", "/meta/part_id"),
        ("/cutting/clearance_z_mm", json!(-30), "height_below_top", "/cutting/clearance_z_mm"),
        ("/cutting/retract_z_mm", json!(-30), "height_below_top", "/cutting/retract_z_mm"),
    ] {
        let answer = write(&with("contour", place, value.clone())).await;
        let wanted = (code.to_owned(), format!("#{blamed}"));
        assert_eq!(answer.violations(), [wanted], "{place} {value}");
    }
    // A toolpath may start below the clearance plane, because the program approaches it from that plane.
    assert_eq!(write(&with("contour", "/toolpath/start/2", json!(-3))).await.status, 200);
}

#[tokio::test]
async fn the_feed_of_a_move_is_its_own_or_that_of_its_role_and_is_required_otherwise() {
    let mut body = example("contour");
    let text = String::from_utf8(write(&body).await.body).expect("ASCII");
    assert!(text.contains("CUT 800 RAMP 250 LEAD-OUT 800 MM PER MIN"), "{text}");
    body["toolpath"]["passes"][0]["moves"][3]["feed_mm_per_min"] = json!(123);
    let text = String::from_utf8(write(&body).await.body).expect("ASCII");
    assert!(text.contains("G1 X20.000 F123\n"), "{text}");
    body.as_object_mut().expect("an object").remove("cutting");
    let answer = write(&body).await;
    assert_eq!((answer.status.as_u16(), answer.code().as_str()), (422, "feed_required"));
    let found = answer.violations();
    assert_eq!(found.len(), 10);
    let at = "#/toolpath/passes/0/moves/1/feed_mm_per_min".to_owned();
    assert_eq!(found[0], ("feed_required".to_owned(), at));
}

#[tokio::test]
async fn likely_mistakes_in_a_program_cause_warnings() {
    let app = app(&["--workers", "1"]);
    let mut body = example("one-line");
    body["tool"] = json!({ "shape": "ball", "diameter_mm": 6, "number": 2, "length_offset": 3 });
    let answer = post(&app, &format!("{WRITE}?format=json"), body.to_string(), &[]).await.json();
    let codes: Vec<_> = answer["warnings"].as_array().expect("warnings").iter().map(|w| &w["code"]).collect();
    assert_eq!(codes, ["clearance_chosen", "no_spindle_speed", "length_offset_differs", "no_work_offset"]);
    let text = answer["nc"].as_str().expect("a text");
    for code in ["CLEARANCE_CHOSEN", "NO_SPINDLE_SPEED", "LENGTH_OFFSET_DIFFERS", "NO_WORK_OFFSET"] {
        assert!(text.contains(&format!("(WARNING: {code} - ")), "{code} is not in the program: {text}");
    }
}

#[tokio::test]
async fn the_number_of_moves_is_limited_and_many_moves_are_written_quickly() {
    let path = |n: usize| {
        // Half circles of 2 mm diameter, each followed by a line back, side by side.
        let moves: Vec<Value> = (0..n)
            .map(|k| {
                let y = 0.001 * (k / 2) as f64;
                if k % 2 == 0 {
                    let (to, center) = (json!([2, y, 0]), json!([1, y, 0]));
                    json!({ "kind": "arc", "to": to, "center": center, "plane": "xy", "direction": "cw",
                            "feed_mm_per_min": 500 })
                } else {
                    json!({ "kind": "line", "to": [0, y + 0.001, 0], "feed_mm_per_min": 500 })
                }
            })
            .collect();
        json!({ "toolpath": { "start": [0, 0, 0], "passes": [{ "moves": moves }] } })
    };
    let small = app(&["--workers", "1", "--max-moves", "10"]);
    let refused = post(&small, WRITE, path(11).to_string(), &[]).await;
    assert_eq!(refused.violations(), [("limit_exceeded".to_owned(), "#/toolpath/passes".to_owned())]);
    assert_eq!(post(&small, WRITE, path(10).to_string(), &[]).await.status, 200);
    assert_eq!(get(&small, "/v1/limits").await.json()["moves"], 10);
    let body = path(120_000).to_string();
    let begun = Instant::now();
    assert_eq!(post(&app(&["--workers", "1"]), WRITE, body, &[]).await.status, 200);
    assert!(begun.elapsed() < Duration::from_secs(20), "writing took {:?}", begun.elapsed());
}

#[tokio::test]
async fn a_program_that_huge_arcs_would_make_too_long_is_refused() {
    // Each circle of nearly a kilometre radius would become some hundred thousand chords.
    let circle = json!({ "kind": "arc", "to": [0, 0, 0], "center": [900_000, 0, 0], "plane": "xy", "direction": "cw",
                         "feed_mm_per_min": 500 });
    let body = json!({ "toolpath": { "start": [0, 0, 0], "passes": [{ "moves": vec![circle; 100] }] } });
    let answer = write(&body).await;
    assert_eq!((answer.status.as_u16(), answer.code().as_str()), (422, "limit_exceeded"));
}

#[tokio::test]
async fn program_numbers_are_accepted_up_to_the_maximum_that_the_dialect_lists() {
    let answer = get(&app(&["--workers", "1"]), "/v1/dialects").await.json();
    let listed = answer["dialects"].as_array().expect("an array");
    assert_eq!(listed.len(), DIALECTS.len());
    for (dialect, listed) in DIALECTS.iter().zip(listed) {
        assert_eq!(listed["name"], dialect.name);
        let Some(max) = dialect.max_program_number else { continue };
        assert_eq!(listed["max_program_number"], max);
        for (value, status) in [(max, 200), (max + 1, 422)] {
            let mut body = with("one-line", "/program", json!({ "number": value }));
            body = for_dialect(body, dialect);
            body["meta"] = json!({});
            assert_eq!(write(&body).await.status, status, "{}: the program number {value}", dialect.name);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    /// Any text in names and meta leaves the blocks of the program unchanged.
    #[test]
    fn names_and_meta_change_only_the_comments_of_a_program(
        name in "(?s)([)%;(\r\n]|.){0,60}", key in "(?s).{0,20}", value in "(?s)[(]?(MSG|LOG|%|;|\u{fc}|\n|.){0,40}",
        long: bool, dialect in prop::sample::select(DIALECTS),
    ) {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime");
        let value = if long { format!("{value}{}", ")".repeat(900)) } else { value };
        let mut plain = for_dialect(with("contour", "/program", json!({})), dialect);
        plain.as_object_mut().expect("an object").remove("meta");
        let mut told = plain.clone();
        told["program"]["name"] = json!(name);
        told["meta"] = json!({ key: value });
        let lines = |body: &Value| -> Vec<String> {
            let answer = runtime.block_on(write(body));
            assert_eq!(answer.status, 200);
            let text = String::from_utf8(answer.body).expect("UTF-8");
            assert!(text.is_ascii());
            text.lines().map(str::to_owned).collect()
        };
        let is_remark = |line: &&String| {
            line.starts_with("; ") || line.starts_with('(') && line.find(')') == Some(line.len() - 1)
        };
        // Remarks have block numbers in Klartext, so that all others move on.
        let unnumbered = |line: String| line.trim_start_matches(|c: char| c.is_ascii_digit()).trim().to_owned();
        let [plain, told] = [&plain, &told].map(|body| lines(body).into_iter().map(unnumbered).collect::<Vec<_>>());
        // The name also follows the program number, on the same line.
        let unnamed = |line: &String| match line.split_once(" (") {
            Some((number, _)) if line.starts_with('O') && line.ends_with(')') => number.to_owned(),
            _ => line.clone(),
        };
        let blocks = |lines: &[String]| -> Vec<String> { lines.iter().filter(|l| !is_remark(l)).map(unnamed).collect() };
        prop_assert_eq!(blocks(&plain), blocks(&told));
        prop_assert!(told.len() - plain.len() <= 2);
        for line in told.iter().filter(is_remark).filter(|_| dialect.abilities.has_comments) {
            let labelled = if dialect.name == "linuxcnc" { ": " } else { " = " };
            prop_assert!(line.contains(labelled), "a comment without a label: {line}");
            for word in ["(LOG", "(DEBUG", "(PROBEOPEN", "(PRINT", "(MSG"] {
                prop_assert!(!line.starts_with(word), "a comment that a control would act on: {line}");
            }
        }
    }
}

#[tokio::test]
async fn a_name_of_ten_thousand_characters_is_refused() {
    let long = "x)%\n".repeat(2500);
    let mut body = with("contour", "/program/name", json!(long));
    body["meta"] = json!({ "part_id": long });
    let pointers: Vec<_> = write(&body).await.violations().into_iter().map(|(_, at)| at).collect();
    assert_eq!(pointers, ["#/program/name", "#/meta/part_id"]);
}

/// Such a program once ended at the height of its cuts.
#[tokio::test]
async fn without_a_clearance_height_a_program_retracts_above_its_own_cuts() {
    let level = |cutting: Value| {
        json!({
            "toolpath": { "start": [0, 0, 0], "passes": [{ "moves": [
                { "kind": "line", "to": [50, 0, 0], "feed_mm_per_min": 600, "role": "cut" } ] }] },
            "cutting": cutting, "tool": { "shape": "flat", "diameter_mm": 6, "number": 5 },
            "program": { "work_offset": "G54" },
        })
    };
    let answer = write(&level(json!({ "feed_mm_per_min": 600, "spindle_rpm": 8000 }))).await;
    let text = answer.text();
    assert!(text.contains("G0 X0.000 Y0.000\nZ20.000\nZ0.000\nG1 X50.000 F600\nG0 Z20.000\nM5"), "{text}");
    assert!(text.contains("(WARNING: CLEARANCE_CHOSEN - "), "{text}");
    assert_eq!(answer.headers["toolpathd-warnings"], "clearance_chosen");
    for clearance in [-1, 0] {
        let given = json!({ "feed_mm_per_min": 600, "clearance_z_mm": clearance });
        let answer = write(&level(given)).await;
        assert_eq!(answer.violations()[0].1, "#/cutting/clearance_z_mm", "{}", answer.text());
    }
    let given = json!({ "feed_mm_per_min": 600, "spindle_rpm": 8000, "clearance_z_mm": 5 });
    let answer = write(&level(given)).await;
    assert!(!answer.headers.contains_key("toolpathd-warnings") && !answer.text().contains("WARNING"));
}

/// One request gives the program, the report and the progress.
#[tokio::test]
async fn the_query_nc_true_puts_the_program_into_the_json_answer_and_the_result_event() {
    let app = app(&["--workers", "1"]);
    let text = post(&app, &format!("{MILL}?format=gcode"), DIE.to_owned(), &[]).await.text();
    let json = post(&app, &format!("{MILL}?nc=true"), DIE.to_owned(), &[]).await.json();
    assert_eq!(json["nc"], json!(text));
    assert!(json["report"]["n_passes"].as_u64() > Some(10));
    let events = [("accept", "text/event-stream")];
    let events = post(&app, &format!("{MILL}?nc=true&toolpath=false"), DIE.to_owned(), &events).await.text();
    let result = events.split("event: result\ndata: ").nth(1).and_then(|rest| rest.lines().next()).unwrap();
    assert_eq!(serde_json::from_str::<Value>(result).unwrap()["nc"], json!(text));
    let without = post(&app, MILL, DIE.to_owned(), &[]).await.json();
    assert!(without.get("nc").is_none_or(Value::is_null), "a program that was not asked for: {without}");
}

#[tokio::test]
async fn safe_home_moves_z_home_by_g28_by_g53_or_not_at_all() {
    for (safe_home, words) in [("g28", "G91 G28 Z0.000"), ("g53", "G53 G0 Z0.000"), ("none", "")] {
        let text = write(&with("one-line", "/program/safe_home", json!(safe_home))).await.text();
        let count = if words.is_empty() { 0 } else { text.matches(words).count() };
        assert_eq!(count, if words.is_empty() { 0 } else { 2 }, "{text}");
        assert_eq!(text.contains("G28") || text.contains("G53"), !words.is_empty(), "{text}");
    }
    let refused = write(&with("one-line", "/program/safe_home", json!("home"))).await;
    assert_eq!(refused.violations()[0].1, "#/program/safe_home");
}

#[tokio::test]
async fn a_name_with_an_umlaut_stays_readable_in_ascii() {
    let mut body = example("one-line");
    body["program"] = json!({ "dialect": "fanuc", "number": 4711, "name": "M\u{fc}ller, 7/8\" #3" });
    let answer = write(&body).await;
    assert!(
        answer.text().starts_with("%\r\nO4711 (MULLER 7/8 #3)")
            || answer.text().starts_with("%\nO4711 (MULLER 7/8 #3)")
    );
    assert!(answer.headers["content-disposition"].to_str().expect("text").contains("Muller"));
}

#[tokio::test]
async fn klartext_states_the_raw_part_where_the_stock_is_known() {
    let app = app(&["--workers", "1"]);
    let mut body: Value =
        serde_json::from_str(include_str!("../../../openapi/examples/surfaces-mill/one-pass.json"))
            .expect("JSON");
    // A strip of 10 by 1 mm at height zero.
    for (stock, corners) in [
        (Value::Null, None),
        (
            json!({ "kind": "block", "top_z_mm": 3 }),
            Some(["X+0.000 Y+0.000 Z-1.000", "X+10.000 Y+1.000 Z+3.000"]),
        ),
        (
            json!({ "kind": "on_surface", "thickness_mm": 0.5 }),
            Some(["X-0.500 Y-0.500 Z-1.000", "X+10.500 Y+1.500 Z+0.500"]),
        ),
    ] {
        for dialect in ["heidenhain", "siemens"] {
            body["program"] = json!({ "dialect": dialect });
            if !stock.is_null() {
                body["stock"] = stock.clone();
            }
            let answer = post(&app, &format!("{MILL}?format=gcode"), body.to_string(), &[]).await;
            assert_eq!(answer.status, 200, "{}", answer.text());
            let text = answer.text();
            let found: Vec<&str> = text.lines().filter(|line| line.contains("BLK FORM")).collect();
            let expected = corners.filter(|_| dialect == "heidenhain").into_iter().flatten();
            let expected: Vec<&str> = expected.collect();
            assert_eq!(found.len(), expected.len(), "{text}");
            assert!(found.iter().zip(&expected).all(|(line, corner)| line.ends_with(corner)), "{text}");
        }
    }
}
