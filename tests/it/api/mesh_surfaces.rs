//! Meshes in files as surfaces of jobs: drops, milling, verification, and what does not take them.

use axum::http::StatusCode;
use serde_json::{Value, json};

use crate::api::parts::{BLOCK, send};
use crate::api::support::{Answer, MILL};

/// A block of 40 x 30 mm with its top at 10 mm, and a step to 6 mm from x = 20 on, as a closed mesh in a text
/// of STL.
fn step_stl() -> String {
    let mut text = String::from("solid step\n");
    // Triangles of a convex polygon, all with its first corner.
    let mut polygon = |corners: &[[f64; 3]]| {
        for pair in corners[1..].windows(2) {
            text += "facet normal 0 0 0\nouter loop\n";
            for [x, y, z] in [corners[0], pair[0], pair[1]] {
                text += &format!("vertex {x} {y} {z}\n");
            }
            text += "endloop\nendfacet\n";
        }
    };
    for (x0, x1, z) in [(0.0, 20.0, 10.0), (20.0, 40.0, 6.0)] {
        polygon(&[[x0, 0.0, z], [x1, 0.0, z], [x1, 30.0, z], [x0, 30.0, z]]);
        polygon(&[[x0, 0.0, 0.0], [x0, 30.0, 0.0], [x1, 30.0, 0.0], [x1, 0.0, 0.0]]);
    }
    polygon(&[[20.0, 0.0, 6.0], [20.0, 30.0, 6.0], [20.0, 30.0, 10.0], [20.0, 0.0, 10.0]]);
    polygon(&[[0.0, 0.0, 0.0], [0.0, 0.0, 10.0], [0.0, 30.0, 10.0], [0.0, 30.0, 0.0]]);
    polygon(&[[40.0, 0.0, 0.0], [40.0, 30.0, 0.0], [40.0, 30.0, 6.0], [40.0, 0.0, 6.0]]);
    // The front and the back have a corner more, where the step begins.
    for y in [0.0, 30.0] {
        let sides = [
            vec![[0.0, y, 0.0], [20.0, y, 0.0], [20.0, y, 6.0], [20.0, y, 10.0], [0.0, y, 10.0]],
            vec![[20.0, y, 0.0], [40.0, y, 0.0], [40.0, y, 6.0], [20.0, y, 6.0]],
        ];
        for mut side in sides {
            if y > 0.0 {
                side[1..].reverse();
            }
            polygon(&side);
        }
    }
    text + "endsolid step\n"
}

fn surface() -> Value {
    json!({ "kind": "file", "name": "step.stl", "units": "mm" })
}

fn mill(tool: Value) -> Value {
    json!({
        "surface": surface(), "tool": tool, "tolerance_mm": 0.01,
        "strategy": { "kind": "cl_cartesian", "stepover_mm": 1 }, "cutting": { "feed_mm_per_min": 1000 }
    })
}

async fn sent(path: &str, job: &Value) -> Answer {
    send(path, Some(job), &[("part", "step.stl", &step_stl())]).await
}

async fn report(path: &str, job: &Value) -> Value {
    let answer = sent(path, job).await;
    assert_eq!(answer.status, StatusCode::OK, "{}", answer.text());
    answer.json()
}

#[tokio::test]
async fn a_cutter_comes_down_onto_a_mesh() {
    let points = json!([[10, 15], [30, 15], [21, 15], [18, 15], [-4, 15], [-6, 15]]);
    let tool = json!({ "shape": "ball", "diameter_mm": 10 });
    let job = json!({ "surface": surface(), "tool": tool, "points": points });
    let tips = report("/v1/surfaces/drop", &job).await["report"]["tips"].clone();
    // Beside the step the ball touches its upper edge: 1 mm beside it, the ball is lower by the height of its
    // lower side there.
    let beside = |d: f64| 10.0 - (5.0 - (25.0 - d * d).sqrt());
    let expected = [Some(10.0), Some(6.0), Some(beside(1.0)), Some(10.0), Some(beside(4.0)), None];
    for (tip, expected) in tips.as_array().expect("tips").iter().zip(expected) {
        match expected {
            Some(z) => assert!((tip[2].as_f64().expect("a height") - z).abs() < 1e-9, "{tip} {z}"),
            None => assert!(tip.is_null()),
        }
    }
}

/// The least height of the tip of a cutter over the step, in closed form: over both levels, and over the upper
/// edge of the step.
fn least_tip(x: f64, radius: f64, corner: f64) -> f64 {
    let height = |d: f64| {
        let out = d - (radius - corner);
        if out <= 0.0 { 0.0 } else { corner - (corner * corner - out * out).max(0.0).sqrt() }
    };
    let beyond = x - 20.0;
    if beyond <= 0.0 {
        10.0
    } else if beyond < radius {
        (10.0 - height(beyond)).max(6.0)
    } else {
        6.0
    }
}

#[tokio::test]
async fn a_mesh_is_milled_within_the_tolerance_by_every_cutter() {
    for (tool, radius, corner) in [
        (json!({ "shape": "ball", "diameter_mm": 6 }), 3.0, 3.0),
        (json!({ "shape": "flat", "diameter_mm": 6 }), 3.0, 0.0),
        (json!({ "shape": "bull_nose", "diameter_mm": 6, "corner_radius_mm": 1 }), 3.0, 1.0),
    ] {
        let mut job = mill(tool.clone());
        for plane in ["zx", "yz"] {
            job["strategy"]["plane"] = json!(plane);
            let answer = report("/v1/surfaces/mill?points=true", &job).await;
            let report = &answer["report"];
            for name in ["gouge_max_mm", "deviation_max_mm"] {
                assert!(report[name].as_f64().expect("a figure") <= 0.01, "{tool} {plane} {report}");
            }
            assert!(answer["warnings"].to_string().contains("closed mesh of 24 triangles"), "{answer}");
            let chord = answer["polyline_chord_mm"].as_f64().expect("a chord");
            let mut n_checked = 0;
            for place in answer["polyline"].as_array().expect("places").iter().filter_map(Value::as_array) {
                let [x, y, z] = [0, 1, 2].map(|k| place[k].as_f64().expect("a coordinate"));
                if (-0.001..=40.001).contains(&x) && (-0.001..=30.001).contains(&y) {
                    assert!(z >= least_tip(x, radius, corner) - 0.011 - chord, "{tool} {plane} {place:?}");
                    n_checked += 1;
                }
            }
            assert!(n_checked > 50, "{n_checked}");
        }
    }
}

#[tokio::test]
async fn passes_on_a_mesh_end_at_its_outline_and_are_made_by_contact() {
    let ball = json!({ "shape": "ball", "diameter_mm": 6 });
    let mut past = mill(ball.clone());
    past["boundary"] = json!("past");
    let mut offset = mill(ball.clone());
    offset["engine"] = json!("offset_section");
    let mut union = mill(ball);
    union["strategy"] = json!({ "kind": "wire_union", "pitch_mm": 3 });
    for (job, pointer) in [(past, "#/boundary"), (offset, "#/engine"), (union, "#/strategy")] {
        let answer = sent(MILL, &job).await;
        assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY);
        assert!(
            answer.violations().contains(&("conflict".to_owned(), pointer.to_owned())),
            "{}",
            answer.text()
        );
    }
    let model = sent("/v1/surfaces/model", &json!({ "surface": surface() })).await;
    assert_eq!(model.violations(), [("unsupported".to_owned(), "#/surface".to_owned())]);
}

#[tokio::test]
async fn a_program_is_verified_against_a_mesh() {
    let tool = json!({ "shape": "ball", "diameter_mm": 6 });
    for (z, verdict) in [("10", "pass"), ("9.8", "fail")] {
        let nc = format!("G21 G90 G0 X5 Y5 Z20\nG1 Z{z} F500\nG1 X15\nG0 Z20\nM2\n");
        let job = json!({
            "nc": nc, "start": [5, 5, 20], "tool": tool, "surface": surface(), "tolerance_mm": 0.005
        });
        let answer = report("/v1/programs/verify", &job).await;
        assert_eq!(answer["report"]["verdict"], verdict, "{answer}");
    }
}

#[tokio::test]
async fn faces_within_edges_of_their_own_are_milled_as_triangles() {
    let surface = json!({ "kind": "file", "name": "block.step", "triangles_within_mm": 0.002 });
    let mut job = mill(json!({ "shape": "bull_nose", "diameter_mm": 4, "corner_radius_mm": 0.5 }));
    (job["surface"], job["strategy"]["stepover_mm"]) = (surface, json!(3));
    let answer = send(MILL, Some(&job), &[("part", "block.step", BLOCK)]).await;
    assert_eq!(answer.status, StatusCode::OK, "{}", answer.text());
    let answer = answer.json();
    assert!(answer["report"]["gouge_max_mm"].as_f64().expect("a figure") <= 0.01, "{answer}");
    let told = answer["warnings"].to_string();
    assert!(told.contains("(a closed mesh) within 0.00"), "{told}");
}

#[tokio::test]
async fn what_is_wrong_with_a_mesh_is_told_at_its_members() {
    let tool = json!({ "shape": "ball", "diameter_mm": 6 });
    let job = |surface: Value| json!({ "surface": surface, "tool": tool, "points": [[1, 1]] });
    let named = |members: Value| {
        let mut surface = surface();
        surface.as_object_mut().expect("an object").extend(members.as_object().expect("an object").clone());
        job(surface)
    };
    for (job, text, code, pointer) in [
        (job(json!({ "kind": "file", "name": "step.stl" })), step_stl(), "unit_missing", "#/surface/name"),
        (named(json!({ "name": "n".repeat(201) })), step_stl(), "limit_exceeded", "#/surface/name"),
        (named(json!({ "faces": [1] })), step_stl(), "conflict", "#/surface/faces"),
        (named(json!({ "grid_within_mm": 1 })), step_stl(), "conflict", "#/surface/grid_within_mm"),
        (named(json!({})), "solid a\n".to_owned(), "unreadable_file", "#/surface/name"),
        (named(json!({})), step_stl().replacen("20", "nan", 1), "unreadable_file", "#/surface/name"),
    ] {
        let answer = send("/v1/surfaces/drop", Some(&job), &[("part", "step.stl", &text)]).await;
        assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY, "{}", answer.text());
        let violations = answer.violations();
        assert!(violations.contains(&(code.to_owned(), pointer.to_owned())), "{code}: {violations:?}");
    }
}
