//! Tests of what requests tell of a tool beside its cutting edge: what is too deep or too fast for it, which
//! shapes each endpoint takes, and what programs say of it.

use serde_json::{Value, json};

use super::support::{Answer, MILL, app, post};

const PLAN: &str = "/v1/pockets/plan";
const VERIFY: &str = "/v1/programs/verify";

/// The depth of the pocket, mm.
const DEPTH_MM: f64 = 30.0;

/// A pocket of 60 x 40 mm with a cutter of 10 mm, and some members of its tool.
fn pocket(tool: &Value) -> Value {
    let mut body = json!({
        "region": { "boundary": [[0, 0], [60, 0], [60, 40], [0, 40]] },
        "floor_z_mm": -DEPTH_MM, "stepdown_max_mm": 10, "stepover_mm": 4,
        "tool": { "shape": "flat", "diameter_mm": 10 },
        "patterns": ["zigzag_stock_offset"],
        "cutting": { "feed_mm_per_min": 800, "spindle_rpm": 8000 },
    });
    add(&mut body["tool"], tool);
    body
}

/// A bowl of 33 x 33 mm that is 16 mm deep in the middle.
fn bowl(tool: &Value) -> Value {
    let z = |i: i32, j: i32| f64::from((2 * i - 3).pow(2) + (2 * j - 3).pow(2));
    let row = |i: i32| -> Value { (0..4).map(|j| json!([11 * i, 11 * j, z(i, j)])).collect() };
    let mut body = json!({
        "surface": { "kind": "point_grid", "points": (0..4).map(row).collect::<Value>() },
        "strategy": { "kind": "cl_cartesian", "stepover_mm": 3 }, "tolerance_mm": 0.01,
        "tool": { "shape": "ball", "diameter_mm": 6 },
        "cutting": { "feed_mm_per_min": 800, "spindle_rpm": 8000 },
    });
    add(&mut body["tool"], tool);
    body
}

fn add(object: &mut Value, members: &Value) {
    object.as_object_mut().expect("an object").extend(members.as_object().expect("members").clone());
}

async fn sent(path: &str, body: &Value) -> Answer {
    post(&app(&["--workers", "1"]), path, body.to_string(), &[]).await
}

/// The codes and the pointers of the warnings with a pointer.
async fn doubts(path: &str, body: &Value) -> Vec<(String, String)> {
    let answer = sent(&format!("{path}?format=json"), body).await;
    assert_eq!(answer.status, 200, "{}", answer.text());
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let answer = answer.json();
    let warnings = answer["warnings"].as_array().expect("warnings").iter();
    let of = warnings.map(|warning| (text(&warning["code"]), text(&warning["pointer"])));
    of.filter(|(_, pointer)| !pointer.is_empty()).collect()
}

async fn refusals(path: &str, body: &Value) -> Vec<(String, String)> {
    let answer = sent(path, body).await;
    assert_eq!(answer.status, 422, "{}", answer.text());
    answer.violations()
}

fn pairs(expected: &[(&str, &str)]) -> Vec<(String, String)> {
    expected.iter().map(|(code, at)| ((*code).to_owned(), (*at).to_owned())).collect()
}

#[tokio::test]
async fn a_level_deeper_than_the_flutes_is_refused_and_a_deeper_pocket_warns() {
    let flutes = |mm: f64| pocket(&json!({ "flute_length_mm": mm }));
    assert_eq!(refusals(PLAN, &flutes(9.5)).await, pairs(&[("out_of_range", "#/stepdown_max_mm")]));
    let warned = pairs(&[("shank_beside_wall", "#/tool/flute_length_mm")]);
    assert_eq!(doubts(PLAN, &flutes(10.0)).await, warned);
    assert_eq!(doubts(PLAN, &flutes(29.9)).await, warned);
    assert_eq!(doubts(PLAN, &flutes(DEPTH_MM)).await, []);
}

#[tokio::test]
async fn a_holder_that_would_go_below_the_top_is_refused_with_its_section() {
    let holder =
        |length_mm: f64, sections: Value| pocket(&json!({ "length_mm": length_mm, "holder": sections }));
    let wide = json!({ "length_mm": 40, "diameter_mm": 30 });
    let slim = json!({ "length_mm": 10, "diameter_mm": 8 });
    let cone = json!({ "length_mm": 10, "diameter_mm": 8, "top_diameter_mm": 12 });
    for (tool, blamed) in [
        (pocket(&json!({ "length_mm": 29.9 })), "#/tool/length_mm"),
        (holder(29.9, json!([wide])), "#/tool/holder/0"),
        (holder(19.9, json!([slim, wide])), "#/tool/holder/1"),
        (holder(19.9, json!([slim])), "#/tool/length_mm"),
        // The cone is as wide as the cutter in its middle.
        (holder(24.9, json!([cone, wide])), "#/tool/holder/0"),
    ] {
        assert_eq!(refusals(PLAN, &tool).await, pairs(&[("out_of_range", blamed)]), "{}", tool["tool"]);
    }
    for tool in [
        pocket(&json!({ "length_mm": 30 })),
        holder(30.0, json!([wide])),
        holder(20.0, json!([slim, wide])),
        holder(25.0, json!([cone, wide])),
    ] {
        assert_eq!(doubts(PLAN, &tool).await, [], "{}", tool["tool"]);
    }
}

/// The verification of programs follows the holder over each move, and knows nothing of the rule.
#[tokio::test]
async fn the_verification_finds_the_holders_that_are_refused_and_no_others() {
    let planned = sent(&format!("{PLAN}?format=gcode"), &pocket(&json!({}))).await;
    assert_eq!(planned.status, 200, "{}", planned.text());
    for (stickout_mm, is_refused) in [(25.0, true), (29.9, true), (30.1, false), (45.0, false)] {
        let sections = json!([{ "length_mm": 60, "diameter_mm": 30 }]);
        let tool = json!({ "length_mm": stickout_mm, "holder": sections });
        assert_eq!(sent(PLAN, &pocket(&tool)).await.status == 422, is_refused, "{stickout_mm}");
        let body = json!({
            "nc": planned.text(), "start": [0, 0, 100], "tolerance_mm": 0.01, "floor_z_mm": -DEPTH_MM,
            "region": { "boundary": [[0, 0], [60, 0], [60, 40], [0, 40]] },
            "tool": { "shape": "flat", "diameter_mm": 10, "stickout_mm": stickout_mm, "holder": sections },
            "stock": { "kind": "box", "min": [-20, -20, -40], "max": [80, 60, 0] },
        });
        let answer = sent(VERIFY, &body).await;
        assert_eq!(answer.status, 200, "{}", answer.text());
        let findings = answer.json()["report"]["findings"].clone();
        let hits = findings.as_array().expect("findings").iter();
        let n_hits =
            hits.filter(|hit| hit["kind"].as_str().is_some_and(|kind| kind.contains("holder"))).count();
        assert_eq!(n_hits > 0, is_refused, "{stickout_mm}: {findings}");
    }
}

#[tokio::test]
async fn milling_knows_flutes_and_holder_too() {
    // The ball goes from 18 mm down to some 2 mm.
    assert_eq!(doubts(MILL, &bowl(&json!({ "flute_length_mm": 18, "length_mm": 18 }))).await, []);
    let short = bowl(&json!({ "flute_length_mm": 10 }));
    assert_eq!(doubts(MILL, &short).await, pairs(&[("shank_beside_wall", "#/tool/flute_length_mm")]));
    let mut block = short;
    block["stock"] = json!({ "kind": "block", "top_z_mm": 19 });
    assert_eq!(refusals(MILL, &block).await, pairs(&[("out_of_range", "#/stock")]));
    let holder = json!([{ "length_mm": 30, "diameter_mm": 30 }]);
    let short = bowl(&json!({ "length_mm": 10, "holder": holder }));
    assert_eq!(refusals(MILL, &short).await, pairs(&[("out_of_range", "#/tool/holder/0")]));
}

#[tokio::test]
async fn speeds_above_those_of_tool_and_machine_are_refused() {
    for (path, body) in [(PLAN, pocket(&json!({}))), (MILL, bowl(&json!({})))] {
        let with = |tool_rpm: f64, machine_rpm: f64| {
            let mut body = body.clone();
            body["tool"]["max_rpm"] = json!(tool_rpm);
            body["machine"] = json!({ "max_rpm": machine_rpm });
            body
        };
        let at = ("out_of_range", "#/cutting/spindle_rpm");
        assert_eq!(refusals(path, &with(7999.0, 8000.0)).await, pairs(&[at]), "{path}");
        assert_eq!(refusals(path, &with(8000.0, 7999.0)).await, pairs(&[at]), "{path}");
        assert_eq!(refusals(path, &with(6000.0, 7000.0)).await, pairs(&[at, at]), "{path}");
        assert_eq!(doubts(path, &with(8000.0, 8000.0)).await, [], "{path}");
        assert_eq!(refusals(path, &with(0.0, 0.0)).await.len(), 4, "{path}: two values and two speeds");
    }
}

#[tokio::test]
async fn a_feed_of_an_edge_far_from_usual_warns_only_where_edges_and_speed_are_told() {
    let warned = pairs(&[("feed_per_tooth", "#/cutting/feed_mm_per_min")]);
    for (feed, edges, expected) in [
        (800.0, 4, Vec::new()),
        (31.0, 4, warned.clone()),
        (33.0, 4, Vec::new()),
        (8100.0, 1, warned),
        (8100.0, 2, Vec::new()),
    ] {
        let mut body = pocket(&json!({ "n_flutes": edges }));
        body["cutting"]["feed_mm_per_min"] = json!(feed);
        assert_eq!(doubts(PLAN, &body).await, expected, "{feed} {edges}");
    }
    let mut body = pocket(&json!({ "n_flutes": 4 }));
    body["cutting"] = json!({ "feed_mm_per_min": 1 });
    assert!(!doubts(PLAN, &body).await.iter().any(|(code, _)| code == "feed_per_tooth"));
}

#[tokio::test]
async fn a_helix_that_leaves_a_core_is_refused() {
    let mut body = pocket(&json!({}));
    body["entry"] = json!({ "max_diameter_mm": 10.001 });
    assert_eq!(refusals(PLAN, &body).await, pairs(&[("out_of_range", "#/entry/max_diameter_mm")]));
    body["entry"] = json!({ "max_diameter_mm": 10 });
    assert_eq!(doubts(PLAN, &body).await, []);
}

fn shapes() -> [(&'static str, Value); 6] {
    [
        ("ball", json!({})),
        ("flat", json!({})),
        ("bull_nose", json!({ "corner_radius_mm": 1 })),
        ("v", json!({ "tip_angle_deg": 60 })),
        ("cone", json!({ "taper_angle_deg": 3, "tip_diameter_mm": 2 })),
        ("drill", json!({})),
    ]
}

fn shaped(body: &Value, shape: &str, members: &Value) -> Value {
    let mut body = body.clone();
    body["tool"] = json!({ "shape": shape, "diameter_mm": 10 });
    add(&mut body["tool"], members);
    body
}

#[tokio::test]
async fn each_endpoint_refuses_the_shapes_that_it_cannot_use() {
    let line = json!({ "toolpath": { "start": [0, 0, 5], "passes": [{ "moves": [
        { "kind": "line", "to": [0, 0, -1], "feed_mm_per_min": 100 }] }] } });
    let curve = json!({ "curve": { "kind": "graph", "expression": "sin(x)", "domain": [0, 6.5] },
        "method": "linear", "band": { "below_mm": 0.1, "above_mm": 0.1 }, "cutting": { "feed_mm_per_min": 500 } });
    let mut beside = curve.clone();
    beside["compensation"] = json!("left");
    let smooth = json!({ "path": [{ "tip": [0, 0, 0], "axis": [0, 0, 1] }, { "tip": [10, 0, 0], "axis": [0, 0, 1] }],
        "feed_mm_per_min": 800, "tolerance_mm": 0.01, "tolerance_deg": 0.5 });
    let drop = json!({ "surface": bowl(&json!({}))["surface"], "points": [[5, 5]] });
    let verify = json!({ "nc": "G21 G90\nG1 X10 F500\nM2\n", "start": [0, 0, 0], "tolerance_mm": 0.01,
        "stock": { "kind": "box", "min": [0, -5, -9], "max": [10, 5, 1] } });
    let fit = json!({ "polyline": [[0, 0], [10, 0], [20, 0]], "tolerance_mm": 0.01 });
    let (all, mills) =
        (&["ball", "flat", "bull_nose", "v", "cone", "drill"][..], &["ball", "flat", "bull_nose"][..]);
    for (path, body, taken) in [
        (PLAN, &pocket(&json!({})), &["flat"][..]),
        (MILL, &bowl(&json!({})), mills),
        ("/v1/surfaces/drop", &drop, mills),
        ("/v1/five-axis/smooth", &smooth, mills),
        (VERIFY, &verify, mills),
        ("/v1/curves/interpolate", &curve, all),
        ("/v1/programs/write", &line, all),
        ("/v1/arcs/fit", &fit, all),
    ] {
        for (shape, members) in shapes() {
            // The verification has no members for other shapes.
            let members = if path == VERIFY && !mills.contains(&shape) { json!({}) } else { members };
            let answer = sent(path, &shaped(body, shape, &members)).await;
            if taken.contains(&shape) {
                assert_eq!(answer.status, 200, "{path} {shape}: {}", answer.text());
            } else {
                let expected = pairs(&[("unsupported", "#/tool/shape")]);
                assert_eq!(answer.violations(), expected, "{path} {shape}");
                let detail = answer.problem()["errors"][0]["detail"].as_str().expect("a detail").to_owned();
                assert!(
                    taken.iter().all(|name| detail.contains(&format!("`{name}`")) || detail.contains(name)),
                    "{detail}"
                );
            }
        }
    }
    // A radius is compensated, and that of a pointed tool depends on its depth.
    for (shape, members) in shapes().into_iter().skip(3) {
        let answer = sent("/v1/curves/interpolate", &shaped(&beside, shape, &members)).await;
        assert_eq!(answer.violations(), pairs(&[("unsupported", "#/tool/shape")]), "{shape}");
    }
}

#[tokio::test]
async fn members_of_a_shape_are_needed_by_it_and_refused_for_others() {
    let line = json!({ "toolpath": { "start": [0, 0, 5], "passes": [{ "moves": [
        { "kind": "line", "to": [0, 0, -1], "feed_mm_per_min": 100 }] }] } });
    for (shape, members, code, at) in [
        ("v", json!({}), "missing_field", "tip_angle_deg"),
        ("v", json!({ "tip_angle_deg": 180 }), "out_of_range", "tip_angle_deg"),
        ("v", json!({ "tip_angle_deg": 90, "tip_diameter_mm": 10.5 }), "out_of_range", "tip_diameter_mm"),
        ("cone", json!({ "tip_diameter_mm": 2 }), "missing_field", "taper_angle_deg"),
        ("cone", json!({ "taper_angle_deg": 2 }), "missing_field", "tip_diameter_mm"),
        ("drill", json!({ "point_angle_deg": 0 }), "out_of_range", "point_angle_deg"),
        ("drill", json!({ "tip_diameter_mm": 1 }), "unknown_field", "tip_diameter_mm"),
        ("flat", json!({ "point_angle_deg": 118 }), "unknown_field", "point_angle_deg"),
        ("flat", json!({ "holder": [{ "length_mm": 9, "diameter_mm": 9 }] }), "missing_field", "length_mm"),
        ("flat", json!({ "n_flutes": 0 }), "out_of_range", "n_flutes"),
    ] {
        let found = refusals("/v1/programs/write", &shaped(&line, shape, &members)).await;
        assert_eq!(found, pairs(&[(code, &format!("#/tool/{at}"))]), "{shape} {members}");
    }
}

#[tokio::test]
async fn programs_and_sheets_name_the_tool_and_its_body() {
    let line = json!({ "toolpath": { "start": [0, 0, 5], "passes": [{ "moves": [
        { "kind": "line", "to": [0, 0, -1], "feed_mm_per_min": 100 }] }] } });
    for (shape, members, words) in [
        ("v", json!({ "tip_angle_deg": 60.5 }), "V OF 60.5 DEG DIAMETER 10.000 TIP DIAMETER 0.000 MM"),
        (
            "cone",
            json!({ "taper_angle_deg": 3, "tip_diameter_mm": 2 }),
            "CONE OF 3 DEG DIAMETER 10.000 TIP DIAMETER 2.000 MM",
        ),
        ("drill", json!({ "point_angle_deg": 118 }), "DRILL OF 118 DEG DIAMETER 10.000 MM"),
    ] {
        let answer = sent("/v1/programs/write?format=gcode", &shaped(&line, shape, &members)).await;
        assert!(answer.text().contains(words), "{}", answer.text());
        let sheet = sent("/v1/programs/write?format=svg", &shaped(&line, shape, &members)).await;
        assert!(sheet.text().contains(&format!(": {shape}, diameter 10 mm")), "{shape}: {}", sheet.text());
    }
    let body = pocket(&json!({ "flute_length_mm": 30, "length_mm": 42, "n_flutes": 3, "max_rpm": 12000 }));
    let note = "TOOL STICKS OUT 42 MM - FLUTES 30 MM - CUTTING EDGES 3 - AT MOST 12000 RPM";
    // A sheet breaks long lines.
    for (format, words) in [("gcode", note), ("svg", "TOOL STICKS OUT 42 MM")] {
        let answer = sent(&format!("{PLAN}?format={format}"), &body).await;
        assert!(answer.text().contains(words), "{}", answer.text());
    }
    let without = sent(&format!("{PLAN}?format=gcode"), &pocket(&json!({}))).await.text();
    let with = sent(&format!("{PLAN}?format=gcode"), &body).await.text();
    let lines: Vec<&str> = with.lines().filter(|line| !line.contains(note)).collect();
    assert_eq!(lines, without.lines().collect::<Vec<_>>(), "the members change nothing else");
}

#[tokio::test]
async fn each_operation_of_a_program_is_checked_with_its_own_tool() {
    let toolpath = json!({ "start": [0, 0, 5], "passes": [{ "moves": [
        { "kind": "line", "to": [0, 0, -1], "feed_mm_per_min": 100 }] }] });
    let operation = |rpm: f64, most: f64, feed: f64| {
        json!({ "toolpath": toolpath,
            "tool": { "shape": "flat", "diameter_mm": 6, "number": 2, "max_rpm": most, "n_flutes": 2 },
            "cutting": { "feed_mm_per_min": feed, "spindle_rpm": rpm } })
    };
    let body = |second: Value| {
        let mut body = operation(5000.0, 6000.0, 500.0);
        body["tool"]["number"] = json!(1);
        body["program"] = json!({ "safe_home": "g53" });
        body["further_operations"] = json!([second]);
        body
    };
    let found = refusals("/v1/programs/write", &body(operation(9000.0, 8000.0, 500.0))).await;
    assert_eq!(found, pairs(&[("out_of_range", "#/further_operations/0/cutting/spindle_rpm")]));
    let told = doubts("/v1/programs/write", &body(operation(5000.0, 8000.0, 5.0))).await;
    assert_eq!(told, pairs(&[("feed_per_tooth", "#/further_operations/0/cutting/feed_mm_per_min")]));
    let told = doubts("/v1/programs/write", &body(operation(5000.0, 8000.0, 500.0))).await;
    assert_eq!(told, []);
}
