//! Tests of smoothing through the interface: figures, samples and refusals.

use serde_json::{Value, json};
use toolpathd_core::machine::Straying;
use toolpathd_core::machine::named;
use toolpathd_core::toolpath::pose::{Pace, Waypoint};
use toolpathd_post::path_text::{self, ReadSettings};

use super::support::{app, post};

const SMOOTH: &str = "/v1/five-axis/smooth";

fn corner() -> Value {
    json!({
        "path": [
            { "tip": [0, 0, 0], "axis": [0, 0, 1] },
            { "tip": [20, 0, 0], "axis": [0, 0, 2] },
            { "tip": [20, 20, 0], "axis": [0, 0, 1] },
        ],
        "feed_mm_per_min": 1200, "tolerance_mm": 0.01, "tolerance_deg": 0.5, "sample_period_ms": 0.25,
    })
}

fn with(body: &Value, field: &str, value: Value) -> Value {
    let mut body = body.clone();
    body[field] = value;
    body
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(|x| x.as_f64().expect("a number")).collect()
}

#[tokio::test]
async fn samples_are_evenly_spaced_in_time_and_stay_within_the_tolerance() {
    let app = app(&["--workers", "1"]);
    let answer = post(&app, &format!("{SMOOTH}?samples=true"), corner().to_string(), &[]).await;
    assert_eq!(answer.status, 200, "{}", answer.text());
    let answer = answer.json();
    let report = &answer["report"];
    assert_eq!((&report["n_blends"], &report["n_stops"]), (&json!(1), &json!(0)));
    assert_eq!((&report["continuity"], &report["within_tolerance"]), (&json!("C2"), &json!(true)));
    let samples = answer["samples"].as_array().expect("samples");
    for (k, sample) in samples.iter().enumerate() {
        let t = sample["t_s"].as_f64().expect("a time");
        assert!(k + 1 == samples.len() || (t - k as f64 * 0.00025).abs() < 1e-12);
        let tip = numbers(&sample["tip"]);
        let distance = f64::min(tip[1].abs(), (tip[0] - 20.0).abs());
        assert!(distance <= 0.01, "{sample}");
        assert_eq!(sample["axis"], json!([0.0, 0.0, 1.0]));
    }
    let last = &samples[samples.len() - 1];
    assert_eq!(last["tip"], json!([20.0, 20.0, 0.0]));
    assert_eq!(last["t_s"], report["cycle_time_s"]);
}

#[tokio::test]
async fn without_the_query_an_answer_has_no_samples() {
    let answer = post(&app(&[]), SMOOTH, corner().to_string(), &[]).await.json();
    assert_eq!(answer.get("samples"), None);
}

#[tokio::test]
async fn the_method_of_the_paper_warns_where_it_leaves_the_tolerance() {
    let app = app(&[]);
    let paper = with(&corner(), "method", json!("paper"));
    let answer = post(&app, SMOOTH, paper.to_string(), &[]).await.json();
    assert_eq!(answer["warnings"][0]["code"], "tolerance_exceeded");
    assert_eq!(answer["report"]["within_tolerance"], false);
    assert!(answer["report"]["deviation_max_mm"].as_f64() > Some(1.0));
    let linear = with(&corner(), "method", json!("linear"));
    let answer = post(&app, SMOOTH, linear.to_string(), &[]).await.json();
    assert_eq!(answer["report"]["continuity"], "C0");
}

#[tokio::test]
async fn what_makes_no_sense_is_refused_with_its_place() {
    let app = app(&[]);
    let axis = |axis: Value| {
        let mut body = corner();
        body["path"][1]["axis"] = axis;
        body
    };
    let same = json!({ "tip": [1, 2, 3], "axis": [0, 0, 1] });
    for (body, pointer) in [
        (axis(json!([0, 0, 0])), "#/path/1/axis"),
        (axis(json!([0, 0, -1])), "#/path/1/axis"),
        (with(&corner(), "path", json!([same, same])), "#/path"),
        (with(&corner(), "path", json!([same])), "#/path"),
        (with(&corner(), "tolerance_mm", json!(0)), "#/tolerance_mm"),
        (with(&corner(), "tolerance_deg", json!(-1)), "#/tolerance_deg"),
        (with(&corner(), "top_distance_mm", json!(0)), "#/top_distance_mm"),
    ] {
        let answer = post(&app, SMOOTH, body.to_string(), &[]).await;
        assert_eq!(answer.status, 422, "{body}");
        assert_eq!(answer.json()["errors"][0]["pointer"], pointer, "{body}");
    }
}

#[tokio::test]
async fn samples_are_limited_only_where_they_are_asked_for() {
    let app = app(&[]);
    let body = with(&corner(), "feed_mm_per_min", json!(0.001)).to_string();
    let answer = post(&app, &format!("{SMOOTH}?samples=true"), body.clone(), &[]).await;
    assert_eq!(answer.status, 422);
    assert_eq!(answer.json()["errors"][0]["pointer"], "#/sample_period_ms");
    for uri in [SMOOTH.to_owned(), format!("{SMOOTH}?format=gcode"), format!("{SMOOTH}?format=html")] {
        assert_eq!(post(&app, &uri, body.clone(), &[]).await.status, 200, "{uri}");
    }
}

#[tokio::test]
async fn what_a_path_does_at_a_pole_is_chosen_and_told() {
    let app = app(&[]);
    let poses = [[0.3, 0.0, 1.0], [-0.3, 1e-5, 1.0]];
    let path: Vec<Value> =
        poses.iter().enumerate().map(|(k, axis)| json!({ "tip": [40 * k, 0, 0], "axis": axis })).collect();
    let body = with(&with(&driven(), "path", json!(path)), "at_pole", json!("quickest"));
    let found = |at_pole: &str| {
        let body = with(&body, "at_pole", json!(at_pole)).to_string();
        let app = &app;
        async move { post(app, SMOOTH, body, &[]).await }
    };
    for (at_pole, counts) in [("quickest", [1, 0]), ("through", [1, 0]), ("around", [0, 1])] {
        let report = &found(at_pole).await.json()["report"];
        assert_eq!([&report["n_through_poles"], &report["n_around_poles"]], counts, "{report}");
        assert_eq!(report["limits_proved"], true);
    }
    let refused = found("refuse").await;
    assert_eq!((refused.status.as_u16(), &refused.json()["code"]), (422, &json!("axis_on_pole")));
}

fn driven() -> Value {
    let mut body = corner();
    body["machine"] = json!({ "name": "table_table_ac" });
    let axis = json!({ "speed": 500, "acceleration": 3000, "jerk": 50_000 });
    body["limits"] = json!({ "X": axis, "Y": axis, "Z": axis, "A": axis, "C": axis });
    body
}

#[tokio::test]
async fn with_a_machine_samples_hold_the_positions_of_its_axes() {
    let app = app(&[]);
    let answer = post(&app, &format!("{SMOOTH}?samples=true"), driven().to_string(), &[]).await;
    assert_eq!(answer.status, 200, "{}", answer.text());
    let answer = answer.json();
    // The tool is upright: the linear axes follow the tip.
    let samples = answer["samples"].as_array().expect("samples");
    assert!(samples.len() > 10, "{} samples", samples.len());
    for sample in samples {
        let joints = &sample["joints"];
        assert_eq!((&joints["A"], &joints["C"]), (&json!(0.0), &json!(0.0)));
        assert_eq!(joints.get("B"), None);
        for (k, axis) in ["X", "Y", "Z"].into_iter().enumerate() {
            let off = numbers(&sample["tip"])[k] - joints[axis].as_f64().expect("a position");
            assert!(off.abs() < 1e-9, "{sample}");
        }
    }
    let peaks = answer["report"]["axis_peaks"].as_array().expect("peaks");
    assert_eq!(peaks.len(), 5);
    for peaks in peaks {
        assert!(peaks["acceleration"].as_f64() <= Some(3030.0), "{peaks}");
        assert!(peaks["jerk"].as_f64() <= Some(50_500.0), "{peaks}");
    }
}

#[tokio::test]
async fn a_machine_that_cannot_follow_is_told_with_the_place() {
    let app = app(&[]);
    let tilted = |tilt: f64| {
        let mut body = driven();
        body["path"][2]["axis"] = json!([0, tilt, 1]);
        body["machine"] = json!({ "kind": "table_table", "axes": "AC", "rotary": [
            { "travel_deg": [-5, 5] }, { "travel_deg": [-5, 5] },
        ]});
        body
    };
    let answer = post(&app, SMOOTH, tilted(1.0).to_string(), &[]).await;
    assert_eq!((answer.status.as_u16(), answer.code().as_str()), (422, "out_of_travel"));
    assert!(answer.json()["place"].is_array(), "{}", answer.text());
}

#[tokio::test]
async fn a_machine_that_is_refused_is_the_only_fault() {
    let mut body = driven();
    body["machine"] = json!({ "name": "mill" });
    body["limits"]["A"] = json!({ "speed": 100 });
    body.as_object_mut().expect("an object").remove("path");
    body["nc"] = json!("G90 F100\nG0 X0 Y0 Z0 A0\nG1 X5 A10\n");
    let answer = post(&app(&[]), SMOOTH, body.to_string(), &[]).await.json();
    let errors = answer["errors"].as_array().expect("errors");
    assert_eq!((errors.len(), &errors[0]["pointer"]), (1, &json!("#/machine/name")), "{answer}");
}

#[tokio::test]
async fn faults_of_machines_and_limits_are_told_with_their_place() {
    let app = app(&[]);
    let machine = |machine: Value| with(&driven(), "machine", machine);
    for (body, pointer) in [
        (machine(json!({ "name": "mill" })), "#/machine/name"),
        (machine(json!({ "name": "table_table_ac", "axes": "AC" })), "#/machine"),
        (machine(json!({ "kind": "table_table" })), "#/machine"),
        (machine(json!({ "kind": "table_table", "axes": "AX" })), "#/machine/axes"),
        (machine(json!({ "kind": "table_table", "axes": "CC" })), "#/machine"),
        (machine(json!({ "kind": "table_table", "axes": "AC", "rotary": [{}] })), "#/machine/rotary"),
        (machine(json!({ "kind": "table_table", "axes": "BC" })), "#/limits/A"),
        (with(&driven(), "limits", json!({ "X": { "jerk": 0 } })), "#/limits/X/jerk"),
        (with(&corner(), "limits", json!({ "C": { "jerk": 1000 } })), "#/limits/C"),
    ] {
        let answer = post(&app, SMOOTH, body.to_string(), &[]).await;
        assert_eq!(answer.status, 422, "{body}");
        assert_eq!(answer.json()["errors"][0]["pointer"], pointer, "{}", answer.text());
    }
}

fn blade() -> Value {
    serde_json::from_str(include_str!("../../../openapi/examples/five-axis-smooth/blade.json")).expect("JSON")
}

/// The program of a request, read back as another system would read it, beside the given poses.
async fn written(body: &Value) -> (Vec<Waypoint>, Vec<Waypoint>) {
    let answer = post(&app(&[]), &format!("{SMOOTH}?format=gcode"), body.to_string(), &[]).await;
    assert_eq!(answer.status, 200, "{}", answer.text());
    let machine = named::by_name("table_table_ac");
    let chords = Straying { tip_mm: 0.001, axis: 1e-4 };
    let reading = ReadSettings { feed: None, limit: 100_000, chords };
    let read = path_text::nc::read(&answer.text(), machine.as_ref(), 50.0, reading).expect("a program");
    let given = path_text::cl::read(body["cl"].as_str().expect("a text"), reading).expect("CL data");
    (read.path, given.path)
}

#[tokio::test]
async fn the_program_of_cl_data_runs_along_them_on_every_control() {
    for (dialect, method) in [("fanuc", "interpolating"), ("linuxcnc", "interpolating"), ("fanuc", "tube")] {
        let mut body = with(&blade(), "method", json!(method));
        body["program"]["dialect"] = json!(dialect);
        let (read, given) = written(&body).await;
        // Each given pose is near to a line of the program, with the axis there. Rounding and straying come
        // on top of the tolerances of 0.01 mm and 0.2 degrees.
        for (k, Waypoint { pose, .. }) in given.iter().enumerate() {
            let off = |pair: &[Waypoint]| {
                let [from, to] = [pair[0].pose, pair[1].pose];
                let along = to.tip - from.tip;
                let part =
                    (along.dot(&(pose.tip - from.tip)) / along.norm_squared().max(1e-12)).clamp(0.0, 1.0);
                let at = from.between(&to, part);
                ((at.tip - pose.tip).norm(), at.axis.angle(&pose.axis).to_degrees())
            };
            let near = read.windows(2).map(off).min_by(|a, b| a.0.total_cmp(&b.0)).expect("a program");
            assert!(near.0 < 0.0135 && near.1 < 0.22, "{dialect} {method}: pose {k} is off by {near:?}");
        }
        let feeds: Vec<f64> = read
            .iter()
            .filter_map(|at| match at.pace {
                Pace::Feed(feed) => Some(feed.mm_per_min()),
                Pace::Rapid => None,
            })
            .collect();
        // 5000 mm/min is the feed of the last way.
        let fastest = feeds.iter().copied().fold(0.0, f64::max);
        assert!((4900.0..5010.0).contains(&fastest), "{fastest}");
    }
}

#[tokio::test]
async fn faults_of_texts_and_outputs_are_told_with_their_place() {
    let app = app(&[]);
    let bare = json!({ "tolerance_mm": 0.01, "tolerance_deg": 0.5 });
    let set = |fields: Value| {
        let mut body = bare.clone();
        for (name, value) in fields.as_object().expect("fields") {
            body[name] = value.clone();
        }
        body
    };
    let goto = "GOTO/0,0,0\nGOTO/1,0,0,0,1,1\n";
    for (body, pointer, code) in [
        (set(json!({})), "#/path", "missing_field"),
        (set(json!({ "path": null })), "#/path", "missing_field"),
        (set(json!({ "cl": goto, "nc": "G0" })), "#", "conflict"),
        (set(json!({ "cl": goto })), "#/cl", "out_of_range"),
        (set(json!({ "cl": "PARTNO/1\n" })), "#/cl", "out_of_range"),
        (set(json!({ "nc": "G43.4 H1\nG0 X0 Y0 Z0 A5.\n" })), "#/nc", "out_of_range"),
        (set(json!({ "path": corner()["path"] })), "#/feed_mm_per_min", "feed_required"),
        (
            set(json!({ "cl": goto, "feed_mm_per_min": 9, "axis_output": "vectors" })),
            "#/axis_output",
            "unsupported",
        ),
        (
            set(json!({ "cl": goto, "feed_mm_per_min": 9, "axis_output": "angles" })),
            "#/machine",
            "missing_field",
        ),
        (
            set(json!({ "cl": goto, "feed_mm_per_min": 9, "axis_output": "machine" })),
            "#/machine",
            "missing_field",
        ),
        (set(json!({ "cl": goto, "feed_mm_per_min": 9, "retract_mm": -1 })), "#/retract_mm", "out_of_range"),
    ] {
        let answer = post(&app, SMOOTH, body.to_string(), &[]).await;
        assert_eq!(answer.status, 422, "{body}");
        assert_eq!(answer.violations().first(), Some(&(code.to_owned(), pointer.to_owned())), "{body}");
    }
    // Without a machine, a leaning tool has no program for LinuxCNC; the figures need none.
    let body = set(json!({ "cl": goto, "feed_mm_per_min": 9 })).to_string();
    assert_eq!(post(&app, SMOOTH, body.clone(), &[]).await.status, 200);
    let answer = post(&app, &format!("{SMOOTH}?format=gcode"), body, &[]).await;
    assert_eq!(answer.violations(), [("missing_field".to_owned(), "#/machine".to_owned())]);
}

#[tokio::test]
async fn a_picture_of_the_motion_shows_feed_and_axes_before_and_after() {
    let app = app(&[]);
    let body = include_str!("../../../openapi/examples/five-axis-smooth/table.json");
    let svg = [("accept", "image/svg+xml")];
    let motion = post(&app, &format!("{SMOOTH}?picture=motion"), body.to_owned(), &svg).await;
    assert_eq!(motion.status, 200, "{}", motion.text());
    let text = motion.text();
    for name in ["feed, mm/min", "acceleration, mm/s2", "jerk, mm/s3", "A, degrees", "C, degrees"] {
        assert!(text.contains(&format!(">{name}<")), "{name}");
    }
    // Five diagrams and the legend.
    assert_eq!((text.matches("class=\"before\"").count(), text.matches("class=\"after\"").count()), (6, 6));
    let path = post(&app, SMOOTH, body.to_owned(), &svg).await.text();
    assert!(path.contains("id=\"plan\"") && !path.contains("class=\"after\""));
    let page = post(&app, SMOOTH, body.to_owned(), &[("accept", "text/html")]).await.text();
    assert_eq!(page.matches("<svg").count(), 2);
    let refused = post(&app, &format!("{SMOOTH}?picture=front"), body.to_owned(), &svg).await;
    assert_eq!(refused.status, 400);
}

#[tokio::test]
async fn limits_are_proved_and_the_tool_counts_in_the_tolerance() {
    let app = app(&[]);
    let body: Value =
        serde_json::from_str(include_str!("../../../openapi/examples/five-axis-smooth/table.json"))
            .expect("JSON");
    let report = post(&app, SMOOTH, body.to_string(), &[]).await.json()["report"].clone();
    assert_eq!(report["limits_proved"], true);
    assert_eq!(report.get("cut_deviation_max_mm"), None);
    let tool = json!({ "shape": "bull_nose", "diameter_mm": 12, "corner_radius_mm": 2 });
    let answer = post(&app, SMOOTH, with(&body, "tool", tool).to_string(), &[]).await.json();
    let report = &answer["report"];
    let figure = |name: &str| report[name].as_f64().expect("a number");
    let swing = f64::hypot(4.0, 2.0);
    let expected =
        figure("toolpath_deviation_max_mm") + swing * figure("toolpath_deviation_max_deg").to_radians();
    assert!((figure("cut_deviation_max_mm") - expected).abs() < 1e-12, "{report}");
    assert!(figure("cut_deviation_max_mm") <= body["tolerance_mm"].as_f64().expect("a number"));
}

fn text_body(member: &str, text: &str) -> Value {
    json!({
        member: text, "tolerance_mm": 0.01, "tolerance_deg": 0.2, "machine": { "name": "table_table_ac" },
        "program": { "dialect": "fanuc", "work_offset": "G54" },
    })
}

/// The detail of the only violation, which is of the text.
async fn refusal(member: &str, text: &str) -> String {
    let answer = post(&app(&[]), SMOOTH, text_body(member, text).to_string(), &[]).await;
    assert_eq!(answer.status, 422, "{text}: {}", answer.text());
    assert_eq!(answer.violations(), [("out_of_range".to_owned(), format!("#/{member}"))]);
    answer.json()["errors"][0]["detail"].as_str().expect("a text").to_owned()
}

#[tokio::test]
async fn words_that_an_answer_cannot_hold_are_refused_with_their_line() {
    let cl = "UNITS/MM\nLOADTL/1\nSPINDL/9000,RPM,CLW\nFEDRAT/500,MMPM\nGOTO/0,0,0,0,0,1\nGOTO/9,0,0,0,.1,1\n\
        LOADTL/2\nSPINDL/2000,RPM,CCLW\nGOTO/20,0,0,0,.1,1\nFINI\n";
    assert!(refusal("cl", cl).await.starts_with("line 8: SPINDL/CCLW is refused"));
    let clockwise = cl.replace("CCLW", "CLW");
    let detail = refusal("cl", &clockwise).await;
    assert_eq!(
        detail,
        "line 7: tool 2 follows tool 1; send the motions of each tool as a request of its own"
    );
    let start = "G21 G90 G94\nG54\nG0 A0 C0\nG43.4 H1 X0. Y0. Z50.\nG1 Z0. F500.\nX10. A5.\n";
    for (line, begins) in [
        ("G81 X15. Y0. Z-5. R2. F100.", "line 7: G81 is refused: write each hole"),
        ("G52 X10.", "line 7: the shift of coordinates is in force under tip control"),
        ("M98 P1000", "line 7: M98 is refused"),
        ("G55", "line 7: the work offset changes"),
        ("FOO", "line 7: \"FOO\" is no known word"),
    ] {
        let detail = refusal("nc", &format!("{start}{line}\nX20. A10.\nM30\n")).await;
        assert!(detail.starts_with(begins), "{detail}");
    }
}

#[tokio::test]
async fn tool_spindle_coolant_name_and_comments_of_a_text_are_carried_over() {
    let text = "PARTNO/BLADE 9\nPPRINT/FIRST SIDE\nLOADTL/7\nSPINDL/9000,RPM,CLW\nCOOLNT/MIST\nFEDRAT/500,MMPM\n\
        GOTO/0,0,0,0,0,1\nGOTO/9,0,0,0,.1,1\nDELAY/2\nOPSTOP\nDELAY/2\nGOTO/20,0,0,0,.1,1\nFINI\n";
    let app = app(&[]);
    let answer = post(&app, SMOOTH, text_body("cl", text).to_string(), &[]).await.json();
    let of = |code: &str| {
        let warnings = answer["warnings"].as_array().expect("warnings").iter();
        warnings.filter(|own| own["code"] == code).map(|own| own["detail"].clone()).collect::<Vec<_>>()
    };
    let told =
        "words of `cl` change nothing of the answer: DELAY 2 times, first in line 9, OPSTOP in line 10";
    assert_eq!(of("words_left_alone"), [told]);
    assert_eq!(of("no_tool_number").len() + of("no_spindle_speed").len(), 0);
    let program =
        post(&app, &format!("{SMOOTH}?format=gcode"), text_body("cl", text).to_string(), &[]).await.text();
    for part in ["T7 M6", "S9000 M3", "M7", "G43.4 H7", "BLADE 9", "FIRST SIDE"] {
        assert!(program.contains(part), "{part} is missing:\n{program}");
    }
    // What the request says counts before the text, and the text's own values are told.
    let mut body = text_body("cl", text);
    body["tool"] = json!({ "shape": "ball", "diameter_mm": 6, "number": 3 });
    body["cutting"] = json!({ "feed_mm_per_min": 500, "spindle_rpm": 800, "coolant": "flood" });
    let answer = post(&app, SMOOTH, body.to_string(), &[]).await.json();
    let detail = answer["warnings"][0]["detail"].as_str().expect("a text");
    assert!(
        detail.ends_with("the tool number in line 3, the spindle speed in line 4, the coolant in line 5"),
        "{detail}"
    );
}

#[tokio::test]
async fn arcs_of_texts_become_poses_within_an_eighth_of_the_tolerance() {
    let cl = "FEDRAT/500,MMPM\nGOTO/0,0,0,0,0,1\nINDIRV/ 0.0, 1.0, 0.0\n\
        TLON,GOFWD/ (CIRCLE/ 10.0, 0.0, 0.0, 10.0),ON,(LINE/ 10.0, 0.0, 0.0, 20.0, 0.0, 0.0)\nGOTO/30,0,0\n";
    let answer = post(&app(&[]), SMOOTH, text_body("cl", cl).to_string(), &[]).await.json();
    // Chords of half a circle of 10 mm with a height of 0.00125 mm: 100 of them.
    let poses = answer["report"]["n_poses"].as_u64().expect("a count");
    assert!((100..120).contains(&poses), "{answer}");
    let length = answer["report"]["length_mm"].as_f64().expect("a length");
    assert!((length - (10.0 * std::f64::consts::PI + 10.0)).abs() < 0.1, "{length}");
}

#[tokio::test]
async fn blocks_of_inverse_time_take_their_time() {
    // Ten seconds for a turn without tip control, five for a line, two for a turn about a resting tip.
    let lines = "G21 G90 G93\nG0 X10 Y0 Z0 A-30 C0\nG1 C40 F6\nX20 F12\n";
    let turn = "G21 G90 G93\nG43.4 H1\nG0 X10 Y0 Z0 A-30 C0\nG1 X20 F12\nA0 F30\n";
    for (text, seconds) in [(lines, 15.0), (turn, 7.0)] {
        let body = json!({
            "nc": text, "tolerance_mm": 0.01, "tolerance_deg": 0.2, "machine": { "name": "table_table_ac" },
        });
        let answer = post(&app(&[]), SMOOTH, body.to_string(), &[]).await;
        assert_eq!(answer.status, 200, "{}", answer.text());
        let took = answer.json()["report"]["cycle_time_s"].as_f64().expect("a time");
        // The rails round the corner between both blocks.
        assert!((took / seconds - 1.0).abs() < 0.005, "{took} s of {seconds} s");
    }
}

/// Two or three poses beside the pole of an A-C table, over 80 mm.
fn beside_the_pole(off: f64, n: usize) -> Value {
    let lean = |k: usize| -0.4 + 0.8 * k as f64 / (n - 1) as f64;
    let pose =
        |k: usize| json!({ "tip": [80.0 * k as f64 / (n - 1) as f64, 0, 0], "axis": [lean(k), off, 0.9] });
    let axis = |speed: f64| json!({ "speed": speed, "acceleration": 6.0 * speed, "jerk": 100.0 * speed });
    json!({
        "path": (0..n).map(pose).collect::<Vec<_>>(), "feed_mm_per_min": 3000,
        "tolerance_mm": 0.01, "tolerance_deg": 0.2, "machine": { "name": "table_table_ac" },
        "limits": { "X": axis(500.0), "Y": axis(500.0), "Z": axis(500.0), "A": axis(180.0), "C": axis(360.0) },
    })
}

#[tokio::test]
async fn programs_beside_poles_keep_the_limits_and_the_turns_of_the_samples() {
    let app = app(&[]);
    for body in [beside_the_pole(0.0075, 2), beside_the_pole(0.0025, 3)] {
        let samples = post(&app, SMOOTH, body.to_string(), &[]).await.json();
        let cycle_time_s = samples["report"]["cycle_time_s"].as_f64().expect("a time");
        let machine = with(&body, "axis_output", json!("machine"));
        let text = post(&app, &format!("{SMOOTH}?format=gcode"), machine.to_string(), &[]).await.text();
        let (mut at, mut is_time, mut total_s) = ([f64::NAN; 5], false, 0.0);
        for line in text.lines().filter(|line| !line.starts_with('(')) {
            let (mut to, mut feed) = (at, None);
            for word in line.split_whitespace() {
                let Ok(value) = word[1..].parse::<f64>() else { continue };
                match word.as_bytes()[0] {
                    b'F' => feed = Some(value),
                    b'G' => is_time |= value == 93.0,
                    letter => {
                        if let Some(k) = b"XYZAC".iter().position(|own| *own == letter) {
                            to[k] = value;
                        }
                    }
                }
            }
            if let Some(seconds) = feed.filter(|_| is_time).map(|feed| 60.0 / feed) {
                total_s += seconds;
                for (k, speed) in [500.0, 500.0, 500.0, 180.0, 360.0].into_iter().enumerate() {
                    assert!((to[k] - at[k]).abs() <= 1.02 * speed * seconds, "{line}");
                    assert!(k < 3 || (to[k] - at[k]).abs() < 5.0, "{line}");
                }
            }
            at = to;
        }
        // The ways to the path and from it, 20 mm each at 3,000 mm/min, come on top of the motion.
        assert!((0.95..1.05).contains(&((total_s - 0.8) / cycle_time_s)), "{total_s} {cycle_time_s}");
        for (dialect, output) in [("fanuc", "angles"), ("heidenhain", "angles"), ("siemens", "vectors")] {
            let mut body = with(&body, "axis_output", json!(output));
            body["program"] = json!({ "dialect": dialect });
            let answer = post(&app, &format!("{SMOOTH}?nc=true"), body.to_string(), &[]).await;
            assert_eq!(answer.status, 200, "{dialect}: {}", answer.text());
            let codes = answer.json()["warnings"].to_string();
            assert_eq!(codes.contains("positions_of_control"), output == "vectors", "{codes}");
        }
    }
}
