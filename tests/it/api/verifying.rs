//! Tests of `/v1/programs/verify` through the interface.

use std::fs;

use serde_json::{Value, json};

use super::support::{Answer, app, post};

const PATH: &str = "/v1/programs/verify";

async fn verify(body: &Value) -> Answer {
    post(&app(&["--workers", "1"]), PATH, body.to_string(), &[]).await
}

async fn report(body: &Value) -> Value {
    let answer = verify(body).await;
    assert_eq!(answer.status, 200, "{}", answer.text());
    answer.json()["report"].clone()
}

/// The pointers and codes of a refusal.
async fn refusal(body: &Value) -> Vec<(String, String)> {
    let answer = verify(body).await;
    assert_eq!(answer.status, 422, "{}", answer.text());
    let text = |error: &Value, name: &str| error[name].as_str().unwrap_or_default().to_owned();
    let json = answer.json();
    let errors = json["errors"].as_array().expect("errors").iter();
    errors.map(|error| (text(error, "pointer"), text(error, "code"))).collect()
}

fn example(name: &str) -> Value {
    let path = format!("{}/openapi/examples/programs-verify/{name}.json", env!("CARGO_MANIFEST_DIR"));
    serde_json::from_str(&fs::read_to_string(path).expect("an example")).expect("JSON")
}

/// A pocket of 60 x 40 mm, 4 mm deep, with a cutter of 10 mm that stands over its middle.
fn pocket(nc: &str) -> Value {
    json!({
        "nc": nc, "start": [30, 20, 20], "tool": { "shape": "flat", "diameter_mm": 10 },
        "region": { "boundary": [[0, 0], [60, 0], [60, 40], [0, 40]] }, "floor_z_mm": -4, "tolerance_mm": 0.005
    })
}

fn kinds(report: &Value) -> Vec<(String, u64)> {
    let of = |finding: &Value| {
        (finding["kind"].as_str().unwrap_or_default().to_owned(), finding["line"].as_u64().unwrap_or(0))
    };
    report["findings"].as_array().expect("findings").iter().map(of).collect()
}

#[tokio::test]
async fn the_examples_have_their_verdicts() {
    for (name, verdict) in [("pocket", "pass"), ("clamp", "pass"), ("faults", "fail")] {
        assert_eq!(report(&example(name)).await["verdict"], verdict, "{name}");
    }
    let told = kinds(&report(&example("faults")).await);
    let expected = [
        ("gouge", 7),
        ("rapid_through_part", 8),
        ("rapid_through_stock", 8),
        ("rapid_through_part", 9),
        ("outside_travel", 10),
    ];
    assert_eq!(told, expected.map(|(kind, line)| (kind.to_owned(), line)));
}

/// Every kind of move, once right and once a hundredth of a millimetre too deep or too wide.
#[tokio::test]
async fn a_hundredth_too_much_is_found_on_its_line() {
    let good = "G21 G90 G94\nG0 X30 Y20 Z2\nG1 Z-1 F200\nG17 G2 I-3 Z-4\nG1 X55 F600\nY30\nG3 X50 Y35 I-5\n\
                G1 X30 Y20\nG18 G2 X24 I-3 K0\nG19 G3 Y14 J-3 K0\nG17 G81 X20 Y20 Z-4 R1 F100\nG80\nG0 Z20\nM2\n";
    let verdict = report(&pocket(good)).await;
    assert_eq!(verdict["verdict"], "pass", "{verdict}");
    let changes = [
        ("G1 Z-1 F200", "G1 Z-4.01 F200", 3),
        ("G2 I-3 Z-4", "G2 I-3 Z-4.01", 4),
        ("X55 F600", "X55.01 F600", 5),
        ("G3 X50 Y35 I-5", "G3 X50 Y35.01 I-5.01", 7),
        ("Z-4 R1 F100", "Z-4.01 R1 F100", 11),
    ];
    for (from, to, line) in changes {
        assert!(good.contains(from), "{from}");
        let found = report(&pocket(&good.replacen(from, to, 1))).await;
        assert_eq!(found["verdict"], "fail", "{to}");
        assert!(kinds(&found).contains(&("gouge".to_owned(), line)), "{to}: {found}");
    }
    // Arcs of the two upright planes dive below the floor when they turn the other way.
    for (from, to, line) in [("G18 G2 X24", "G18 G3 X24", 9), ("G19 G3 Y14", "G19 G2 Y14", 10)] {
        let found = report(&pocket(&good.replacen(from, to, 1))).await;
        assert!(kinds(&found).contains(&("gouge".to_owned(), line)), "{to}: {found}");
        assert!((found["gouge_max_mm"]["bound"].as_f64().unwrap() - 3.0).abs() < 1e-3, "{found}");
    }
    // An inch program with three decimals is off by up to a hundredth.
    let inch = "G20 G90\nG0 X1. Y.8 Z.1\nG1 Z-.157 F20\nX2.166\nG0 Z1.\nM2\n";
    let found = report(&pocket(inch)).await;
    assert_eq!(kinds(&found)[0], ("gouge".to_owned(), 4), "{found}");
}

#[tokio::test]
async fn a_toolpath_is_verified_as_its_program_is() {
    let nc = "G21 G90\nG0 X30 Y20 Z2\nG1 Z-4 F200\nX50\nG0 Z20\nM2\n";
    let of_text = report(&pocket(nc)).await;
    let mut body = pocket(nc);
    for name in ["nc", "start"] {
        body.as_object_mut().unwrap().remove(name);
    }
    body["toolpath"] = json!({ "start": [30, 20, 20], "passes": [{ "moves": [
        { "kind": "rapid", "to": [30, 20, 2] },
        { "kind": "line", "to": [30, 20, -4], "feed_mm_per_min": 200 },
        { "kind": "line", "to": [50, 20, -4], "feed_mm_per_min": 200 },
        { "kind": "rapid", "to": [50, 20, 20] }
    ] }] });
    let of_moves = report(&body).await;
    for name in ["verdict", "left_volume_mm3", "air_length_mm", "uncut_area_mm2"] {
        assert_eq!(of_text[name], of_moves[name], "{name}");
    }
    assert_eq!(of_text["depth_max_mm"]["line"], 3);
    assert_eq!(of_moves["depth_max_mm"].get("line"), None);
    let shown = post(&app(&["--workers", "1"]), &format!("{PATH}?format=svg"), body.to_string(), &[]).await;
    assert!(shown.text().contains("verdict: pass, no findings"));
}

#[tokio::test]
async fn a_fanuc_rapid_may_be_a_dog_leg() {
    let mut body = json!({
        "nc": "G21 G90\nG0 X80. Y0. Z20.\nG1 X90. F100.\nM30\n", "start": [0, 0, 60], "dialect": "fanuc",
        "tool": { "shape": "flat", "diameter_mm": 6 },
        "fixtures": [{ "kind": "box", "min": [30, -5, 0], "max": [40, 5, 30] }], "tolerance_mm": 0.01
    });
    assert_eq!(kinds(&report(&body).await), [("fixture_near".to_owned(), 2)]);
    body["rapids"] = json!("straight");
    assert_eq!(report(&body).await["verdict"], "pass");
    body.as_object_mut().unwrap().remove("rapids");
    body["dialect"] = json!("linuxcnc");
    assert_eq!(report(&body).await["verdict"], "pass");
}

#[tokio::test]
async fn each_tool_of_a_program_is_verified_with_its_own_size() {
    let nc = "G21 G90\nT1 M6\nG0 X30 Y20 Z2\nG1 Z-4 F200\nX54\nG0 Z20\nT2 M6\nG0 X30 Y20 Z2\nG1 Z-4\nX56\nG0 Z20\nM2\n";
    let tools = |small: f64| json!([{ "shape": "flat", "diameter_mm": 12, "number": 1 }, { "shape": "flat", "diameter_mm": small, "number": 2 }]);
    let mut body = pocket(nc);
    body.as_object_mut().unwrap().remove("tool");
    body["tools"] = tools(8.0);
    assert_eq!(report(&body).await["verdict"], "pass");
    body["tools"] = tools(8.1);
    let found = report(&body).await;
    assert!(kinds(&found).contains(&("gouge".to_owned(), 10)), "{found}");
    body["tools"] = json!([{ "shape": "flat", "diameter_mm": 12, "number": 1 }]);
    assert_eq!(refusal(&body).await, [("#/tools".to_owned(), "missing_field".to_owned())]);
    let mut one = pocket(nc);
    one["tool"]["number"] = json!(1);
    assert_eq!(refusal(&one).await, [("#/tool".to_owned(), "missing_field".to_owned())]);
}

#[tokio::test]
async fn members_that_do_not_belong_together_are_refused() {
    let nc = "G21 G90\nG0 X30 Y20 Z2\nM2\n";
    let with = |name: &str, value: Value| {
        let mut body = pocket(nc);
        body[name] = value;
        body
    };
    let square = json!({ "boundary": [[0, 0], [1, 0], [1, 1]] });
    let plane = json!({ "kind": "point_grid", "points": [[[0, 0, 0], [0, 1, 0]], [[1, 0, 0], [1, 1, 0]]] });
    let cases = [
        (with("toolpath", json!({ "start": [0, 0, 0], "passes": [] })), "#/nc", "conflict"),
        (with("tools", json!([{ "shape": "ball", "diameter_mm": 1 }])), "#/tools", "conflict"),
        (with("surface", plane), "#/region", "conflict"),
        (with("allowance_mm", json!(1)), "#/allowance_mm", "conflict"),
        (with("floor_z_mm", json!(0)), "#/floor_z_mm", "out_of_range"),
        (with("tolerance_mm", json!(0)), "#/tolerance_mm", "out_of_range"),
        (
            with("stock", json!({ "kind": "box", "min": [0, 0, 0], "max": [1, 0, 1] })),
            "#/stock/max/1",
            "out_of_range",
        ),
        (with("travel", json!({ "min": [0, 0, 0], "max": [1, 1, -1] })), "#/travel/max/2", "out_of_range"),
        (with("cell_mm", json!(0.001)), "#/cell_mm", "limit_exceeded"),
        (
            with("tool", json!({ "shape": "flat", "diameter_mm": 10, "stickout_mm": 20 })),
            "#/tool/stickout_mm",
            "conflict",
        ),
        (
            with(
                "fixtures",
                json!([{ "kind": "outline", "boundary": [[0, 0], [9, 9], [9, 0], [0, 9]], "bottom_z_mm": 0, "top_z_mm": 9 }]),
            ),
            "#/fixtures/0",
            "out_of_range",
        ),
        (with("region", square.clone()), "", ""),
    ];
    for (body, pointer, code) in cases {
        if pointer.is_empty() {
            assert_eq!(verify(&body).await.status, 200);
        } else {
            assert_eq!(refusal(&body).await, [(pointer.to_owned(), code.to_owned())]);
        }
    }
    let leaning = json!({
        "toolpath": { "start": [0, 0, 0], "passes": [{ "axis": [1, 0, 1], "moves": [{ "kind": "rapid", "to": [1, 0, 0] }] }] },
        "tool": { "shape": "ball", "diameter_mm": 1 }, "tolerance_mm": 0.01
    });
    assert_eq!(refusal(&leaning).await, [("#/toolpath".to_owned(), "unsupported".to_owned())]);
}

#[tokio::test]
async fn figures_without_their_premises_are_null_and_named() {
    let body = json!({
        "nc": "G21 G90\nG1 X5 F100\nM2\n", "start": [0, 0, 0],
        "tool": { "shape": "ball", "diameter_mm": 1 }, "tolerance_mm": 0.01
    });
    let report = report(&body).await;
    assert_eq!(report["verdict"], "pass");
    let names = ["part", "stock", "holder", "fixtures", "travel", "flutes"];
    assert_eq!(report["not_checked"], json!(names));
    for name in ["gouge_max_mm", "excess_max_mm", "air_length_mm", "holder_clearance_min_mm"] {
        assert_eq!(report[name], Value::Null, "{name}");
    }
}

/// A toolpath of rapids and feeds that begins at `start`.
fn moves(start: [f64; 3], moves: &[(&str, [f64; 3])]) -> Value {
    let step = |(kind, to): &(&str, [f64; 3])| match *kind {
        "rapid" => json!({ "kind": "rapid", "to": to }),
        _ => json!({ "kind": "line", "to": to, "feed_mm_per_min": 500 }),
    };
    json!({ "start": start, "passes": [{ "moves": moves.iter().map(step).collect::<Vec<_>>() }] })
}

/// The verdict with the kinds and certainties of the findings.
async fn told(body: &Value) -> (String, Vec<(String, String)>) {
    let report = report(body).await;
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let findings = report["findings"].as_array().expect("findings").iter();
    (text(&report["verdict"]), findings.map(|own| (text(&own["kind"]), text(&own["certainty"]))).collect())
}

fn of(verdict: &str, findings: &[(&str, &str)]) -> (String, Vec<(String, String)>) {
    let own = |(kind, certainty): &(&str, &str)| ((*kind).to_owned(), (*certainty).to_owned());
    (verdict.to_owned(), findings.iter().map(own).collect())
}

/// Rapids into whole material are found however large the cells are, and wherever the tool comes from.
#[tokio::test]
async fn a_rapid_into_whole_material_is_found_between_corners_of_cells() {
    let block = json!({ "kind": "box", "min": [0, 0, -20], "max": [500, 500, 0] });
    let hit = of("fail", &[("rapid_through_stock", "certain")]);
    let dip =
        moves([250.5, 250.5, 50.0], &[("rapid", [250.5, 250.5, -0.05]), ("rapid", [250.5, 250.5, 50.0])]);
    let ball = json!({ "shape": "ball", "diameter_mm": 8 });
    let mut body = json!({ "toolpath": dip, "tool": ball, "stock": block, "tolerance_mm": 0.005 });
    assert_eq!(told(&body).await, hit);
    body["cell_mm"] = json!(100);
    assert_eq!(told(&body).await, hit);
    // A tool that stands in the material before the first move is not in its own shadow.
    body["toolpath"] = moves([50.0, 50.0, -10.0], &[("rapid", [50.0, 50.0, 50.0])]);
    assert_eq!(told(&body).await.0, "fail");
    // The way of `G0 Z-10` is not known, but its end is.
    let nc = "G21 G90\nT1 M6\nS1000 M3\nG0 X50 Y50\nG0 Z-10\nG1 X60 F500\nG0 Z50\nM2\n";
    let unseen = json!({ "nc": nc, "tool": ball, "stock": block, "tolerance_mm": 0.005 });
    assert_eq!(told(&unseen).await, hit);
    assert!(report(&unseen).await["not_checked"].as_array().unwrap().contains(&json!("rapids")));
    let apart = json!({ "start": [50, 50, -3], "moves": [{ "kind": "rapid", "to": [50, 50, 60] }] });
    let toolpath = json!({ "start": [0, 0, 50], "passes": [{ "moves": [{ "kind": "rapid", "to": [5, 5, 50] }] }, apart] });
    let body = json!({ "toolpath": toolpath, "tool": ball, "stock": block, "tolerance_mm": 0.005 });
    assert_eq!(told(&body).await.0, "fail");
}

#[tokio::test]
async fn a_second_hit_is_as_certain_as_the_first_and_moves_between_them_are_free() {
    let way = [
        ("rapid", [0.0, 0.0, 5.0]),
        ("rapid", [100.0, 0.0, 5.0]),
        ("rapid", [100.0, 0.0, 50.0]),
        ("rapid", [200.0, 0.0, 60.0]),
        ("rapid", [100.0, 0.0, 5.0]),
        ("rapid", [0.0, 0.0, 5.0]),
    ];
    let clamp = json!([{ "kind": "box", "min": [45, -5, -20], "max": [55, 5, 10] }]);
    let mut body = json!({
        "toolpath": moves([0.0, 0.0, 50.0], &way), "tool": { "shape": "flat", "diameter_mm": 10 },
        "fixtures": clamp, "tolerance_mm": 0.005
    });
    assert_eq!(told(&body).await, of("fail", &[("fixture_near", "certain"); 2]));
    // As near as is asked for is near enough.
    body["toolpath"] = moves([0.0, 0.0, 11.0], &[("line", [100.0, 0.0, 11.0])]);
    body["clearance_mm"] = json!(1);
    assert_eq!(told(&body).await.0, "pass");
    body["clearance_mm"] = json!(1.001);
    assert_eq!(told(&body).await.0, "fail");
}

#[tokio::test]
async fn what_only_one_way_of_a_rapid_meets_is_possible() {
    let body = json!({
        "nc": "G21 G90\nG0 X0. Y0.\nG43 H1 Z5.\nX100. Y50.\nG1 Z4. F100.\nM30\n", "start": [0, 0, 50],
        "dialect": "fanuc", "tool": { "shape": "flat", "diameter_mm": 4 },
        "stock": { "kind": "box", "min": [45, 40, 0], "max": [55, 60, 20] }, "tolerance_mm": 0.005
    });
    let report = report(&body).await;
    assert_eq!(report["verdict"], "undecided", "{report}");
    // No material is certain to be gone.
    assert_eq!(report["left_volume_mm3"]["most"], report["stock_volume_mm3"]["most"]);
    assert!(report["left_volume_mm3"]["least"].as_f64() < report["stock_volume_mm3"]["least"].as_f64());
}

#[tokio::test]
async fn a_cutter_may_come_back_to_its_own_hole() {
    let body = json!({
        "nc": "G21 G90\nG0 X10 Y10 Z20\nG98 G83 X10 Y10 Z-8 R2 Q2 F100\nG80\nG0 Z50\nM2\n", "start": [0, 0, 50],
        "tool": { "shape": "flat", "diameter_mm": 5 }, "control_tolerance_mm": 0.05,
        "stock": { "kind": "box", "min": [0, 0, -20], "max": [40, 20, 0] }, "tolerance_mm": 0.005
    });
    assert_eq!(told(&body).await, of("pass", &[]));
}

#[tokio::test]
async fn a_holder_is_measured_where_it_is() {
    // The cutter takes the post away before the holder comes down to it.
    let holder = json!([{ "length_mm": 40, "diameter_mm": 30 }]);
    let way = [("rapid", [0.0, 0.0, 41.0]), ("line", [0.0, 0.0, 0.0]), ("line", [0.0, 0.0, 60.0])];
    let body = json!({
        "toolpath": moves([0.0, 0.0, 60.0], &way),
        "tool": { "shape": "flat", "diameter_mm": 10, "stickout_mm": 30, "holder": holder },
        "stock": { "kind": "cylinder", "center": [0, 0], "diameter_mm": 8, "bottom_z_mm": -10, "top_z_mm": 40 },
        "cell_mm": 0.2, "tolerance_mm": 0.005
    });
    let clearance = report(&body).await["holder_clearance_min_mm"]["bound"].as_f64().unwrap();
    assert!(clearance > 29.5 && clearance <= 30.0, "{clearance}");
    // A cone in a pocket is as near as its own side, and a wide disc over a slope as its rim.
    let cone = json!([{ "length_mm": 20, "diameter_mm": 12, "top_diameter_mm": 40 }]);
    let body = json!({
        "toolpath": moves([20.0, 20.0, 10.0], &[("rapid", [20.0, 20.0, -12.0])]),
        "tool": { "shape": "flat", "diameter_mm": 10, "stickout_mm": 10, "holder": cone },
        "region": { "boundary": [[0, 0], [40, 0], [40, 40], [0, 40]] }, "floor_z_mm": -15,
        "stock": { "kind": "box", "min": [100, 100, -5], "max": [110, 110, 0] }, "tolerance_mm": 0.005
    });
    let clearance = report(&body).await["holder_clearance_min_mm"]["bound"].as_f64().unwrap();
    // The corner of the wall is 20 mm from the axis and 2 mm above the lower end of the cone.
    let exact = (20.0 - 6.0 - 2.0 * 0.7) / f64::hypot(1.0, 0.7);
    assert!((clearance - exact).abs() < 0.01, "{clearance} {exact}");
    let grid: Vec<Vec<[f64; 3]>> =
        [0.0, 10.0, 20.0].map(|x| [0.0, 10.0, 20.0].map(|y| [x, y, 0.1 * x]).to_vec()).to_vec();
    let body = json!({
        "toolpath": moves([10.0, 10.0, 3.0], &[("line", [10.5, 10.0, 3.0])]),
        "tool": {
            "shape": "ball", "diameter_mm": 4, "stickout_mm": 5, "holder": [{ "length_mm": 20, "diameter_mm": 150 }]
        },
        "surface": { "kind": "point_grid", "points": grid }, "clearance_mm": 1, "tolerance_mm": 0.005
    });
    let clearance = report(&body).await["holder_clearance_min_mm"]["bound"].as_f64().unwrap();
    assert!(clearance > 5.98 && clearance <= 6.0, "{clearance}");
}

#[tokio::test]
async fn an_arc_leaves_the_travel_at_its_own_place() {
    let circle = json!({
        "nc": "G21 G90\nG2 X0 Y0 I10 J0 F100\nM2\n", "start": [0, 0, 0],
        "tool": { "shape": "flat", "diameter_mm": 4 }, "tolerance_mm": 0.005,
        "travel": { "min": [-50, -5, -5], "max": [50, 50, 5] }
    });
    let at = report(&circle).await["findings"][0]["at"].clone();
    assert!((at[0].as_f64().unwrap() - 10.0).abs() + (at[1].as_f64().unwrap() + 10.0).abs() < 1e-9, "{at}");
}

#[tokio::test]
async fn what_the_control_may_leave_the_path_counts_for_the_travel() {
    let mut body = json!({
        "toolpath": moves([0.0, 0.0, 0.0], &[("line", [50.0, 0.0, 0.0])]),
        "tool": { "shape": "flat", "diameter_mm": 2 }, "tolerance_mm": 0.005,
        "travel": { "min": [0, -10, -10], "max": [50, 10, 10] }
    });
    assert_eq!(told(&body).await.0, "pass");
    body["control_tolerance_mm"] = json!(0.01);
    assert_eq!(told(&body).await, of("undecided", &[("outside_travel", "possible"); 2]));
}
