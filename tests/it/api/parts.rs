//! Files beside a job: how they are sent, how a job refers to them, and what is told of them.

use axum::http::StatusCode;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Value, json};

use crate::api::support::{Answer, MILL, ONE_PASS, app, post};

const INSPECT: &str = "/v1/parts/inspect";

/// A bowl in rows to and fro, with decimal commas.
fn bowl() -> String {
    let mut text = String::from("x [mm];y [mm];z [mm]\r\n");
    for j in 0..9 {
        for i in 0..12 {
            let i = if j % 2 == 0 { i } else { 11 - i };
            let (x, y) = (f64::from(i) * 5.0, f64::from(j) * 5.0);
            let z = ((x - 27.5).powi(2) + (y - 20.0).powi(2)) / 200.0;
            text += &format!("{x};{y};{z}\r\n").replace('.', ",");
        }
    }
    text
}

/// The same points as `point_grid`.
fn bowl_grid() -> Value {
    let z = |x: f64, y: f64| ((x - 27.5).powi(2) + (y - 20.0).powi(2)) / 200.0;
    let row = |i: i32| -> Vec<[f64; 3]> {
        (0..9).map(|j| (f64::from(i) * 5.0, f64::from(j) * 5.0)).map(|(x, y)| [x, y, z(x, y)]).collect()
    };
    json!({ "kind": "point_grid", "points": (0..12).map(row).collect::<Vec<_>>() })
}

/// A body of `multipart/form-data` with a job and files.
fn form(job: Option<&Value>, files: &[(&str, &str, &str)]) -> String {
    let mut body = String::new();
    if let Some(job) = job {
        body += &format!("--X\r\nContent-Disposition: form-data; name=\"job\"\r\n\r\n{job}\r\n");
    }
    for (part, name, text) in files {
        body += &format!(
            "--X\r\nContent-Disposition: form-data; name=\"{part}\"; filename=\"{name}\"\r\n\r\n{text}\r\n"
        );
    }
    body + "--X--\r\n"
}

async fn send(path: &str, job: Option<&Value>, files: &[(&str, &str, &str)]) -> Answer {
    let headers = [("content-type", "multipart/form-data; boundary=X")];
    post(&app(&[]), path, form(job, files), &headers).await
}

fn mill(surface: Value) -> Value {
    let mut job: Value = serde_json::from_str(ONE_PASS).expect("JSON");
    job["surface"] = surface;
    job
}

/// The answer without its warnings.
fn without_warnings(answer: &Answer) -> Value {
    assert_eq!(answer.status, StatusCode::OK, "{}", answer.text());
    let mut answer = answer.json();
    answer["warnings"] = Value::Null;
    answer
}

#[tokio::test]
async fn points_in_a_file_give_the_plan_of_the_same_points_in_json() {
    let twin = post(&app(&[]), MILL, mill(bowl_grid()).to_string(), &[]).await;
    let by_name = mill(json!({ "kind": "file", "name": "bowl.csv" }));
    let sent = send(MILL, Some(&by_name), &[("part", "bowl.csv", &bowl())]).await;
    assert_eq!(without_warnings(&sent), without_warnings(&twin));
    let told = sent.json()["warnings"].to_string();
    assert!(told.contains("108 points in 9 rows and 12 columns"), "{told}");

    let text = BASE64_STANDARD.encode(bowl());
    let in_json = mill(json!({ "kind": "file", "name": "bowl.csv", "base64": text }));
    let sent = post(&app(&[]), MILL, in_json.to_string(), &[]).await;
    assert_eq!(without_warnings(&sent), without_warnings(&twin));
}

#[tokio::test]
async fn a_file_is_found_by_its_own_name_or_by_that_of_its_part() {
    for name in ["bowl.csv", "part"] {
        let job = json!({ "surface": { "kind": "file", "name": name } });
        let sent = send("/v1/surfaces/model", Some(&job), &[("part", "bowl.csv", &bowl())]).await;
        assert_eq!(sent.status, StatusCode::OK, "{}", sent.text());
    }
}

#[tokio::test]
async fn what_is_wrong_with_files_is_told_at_the_member() {
    let file = |name: &str| json!({ "surface": { "kind": "file", "name": name } });
    let both = json!({ "surface": { "kind": "file", "name": "bowl.csv", "base64": "MQ==" } });
    let bad = json!({ "surface": { "kind": "file", "name": "other.csv", "base64": "%" } });
    let bowl = bowl();
    let no_unit = bowl.replace(" [mm]", "");
    let one_less = bowl.replace("0;0;", "# ");
    for (job, files, code, pointer) in [
        (file("bowl.csv"), vec![], "unknown_file", "#/surface/name"),
        (file("bowl.csv"), vec![("part", "other.csv", bowl.as_str())], "unknown_file", "#"),
        (both, vec![("part", "bowl.csv", bowl.as_str())], "conflict", "#/surface/base64"),
        (bad, vec![], "syntax", "#/surface/base64"),
        (file("bowl.csv"), vec![("part", "bowl.csv", no_unit.as_str())], "unit_missing", "#/surface/name"),
        (
            file("bowl.csv"),
            vec![("part", "bowl.csv", one_less.as_str())],
            "unreadable_file",
            "#/surface/name",
        ),
        (file("bowl.csv"), vec![("part", "bowl.csv", "x y\n1 2\n")], "unreadable_file", "#/surface/name"),
        (file("a.stl"), vec![("part", "a.stl", "solid a")], "unsupported", "#/surface/name"),
    ] {
        let sent = send("/v1/surfaces/model", Some(&job), &files).await;
        assert_eq!(sent.status, StatusCode::UNPROCESSABLE_ENTITY, "{}", sent.text());
        let violations = sent.violations();
        assert!(violations.contains(&(code.to_owned(), pointer.to_owned())), "{code}: {violations:?}");
    }
}

#[tokio::test]
async fn the_unit_of_the_request_holds_and_a_difference_is_told() {
    let job = |units: &str| json!({ "surface": { "kind": "file", "name": "bowl.csv", "units": units } });
    for (units, width, is_told) in [("mm", 55.0, false), ("inch", 55.0 * 25.4, true)] {
        let sent = send("/v1/surfaces/model", Some(&job(units)), &[("part", "bowl.csv", &bowl())]).await;
        let answer = sent.json();
        let bounds = &answer["report"]["bounds"];
        let size =
            bounds["max"][0].as_f64().unwrap_or_default() - bounds["min"][0].as_f64().unwrap_or_default();
        assert!((size - width).abs() < 1e-5, "{answer}");
        assert_eq!(answer["warnings"].to_string().contains("units_overridden"), is_told);
    }
}

#[tokio::test]
async fn a_body_of_parts_that_is_broken_is_refused() {
    let headers = [("content-type", "multipart/form-data; boundary=X")];
    for body in ["", "--X", "--X--\r\n", "--X\r\n\r\n\r\n--X--\r\n", "{}"] {
        let sent = post(&app(&[]), MILL, body, &headers).await;
        assert_eq!((sent.status, sent.code()), (StatusCode::BAD_REQUEST, "bad_request".into()), "{body}");
    }
    let sent = post(&app(&[]), MILL, "", &[("content-type", "multipart/form-data")]).await;
    assert_eq!(sent.status, StatusCode::BAD_REQUEST, "{}", sent.text());
}

#[tokio::test]
async fn a_text_of_points_is_inspected() {
    let sent = send(INSPECT, None, &[("part", "bowl.csv", &bowl())]).await;
    assert_eq!(sent.status, StatusCode::OK, "{}", sent.text());
    let report = &sent.json()["report"];
    assert_eq!(report["format"], "points");
    assert_eq!(report["units"], "mm");
    assert_eq!(report["points"]["separator"], "semicolons");
    assert_eq!(report["points"]["decimal_comma"], true);
    assert_eq!(report["points"]["grid"]["n_rows"], 9);
    assert_eq!(report["points"]["grid"]["n_columns"], 12);
    assert_eq!(report["bounds"]["max"][0], 55.0);

    let scattered =
        send(INSPECT, None, &[("part", "a.xyz", "0 0 0\n1 0.1 0\n2 0.7 0\n0.4 3 1\n5 5 5\n")]).await;
    let answer = scattered.json();
    assert!(answer["report"]["points"]["no_grid"].is_string(), "{answer}");
    assert_eq!(answer["warnings"][0]["code"], "file_unit_missing");
    assert!(answer["report"]["units"].is_null());
}

#[tokio::test]
async fn an_inspection_without_one_file_is_refused() {
    let two = [("a", "a.xyz", "1 2 3\n"), ("b", "b.xyz", "1 2 3\n")];
    for sent in [
        post(&app(&[]), INSPECT, "{}", &[]).await,
        send(INSPECT, Some(&json!({})), &[]).await,
        send(INSPECT, None, &two).await,
        send(INSPECT, None, &[("a", "a.pdf", "%PDF-1.4")]).await,
        send(INSPECT, None, &[("a", "a.csv", "no numbers")]).await,
    ] {
        assert_eq!(sent.status, StatusCode::UNPROCESSABLE_ENTITY, "{}", sent.text());
    }
}

/// A plate with a layer `POCKETS`: a rounded pocket with a round island, and a block of a slot, twice.
const PLATE: &str = include_str!("../../../openapi/files/plate.dxf");

fn pocket(regions: Value) -> Value {
    json!({
        "regions": regions, "floor_z_mm": -6, "stepdown_max_mm": 3, "stepover_mm": 4,
        "tool": { "shape": "flat", "diameter_mm": 8 }, "cutting": { "feed_mm_per_min": 900 },
    })
}

#[tokio::test]
async fn a_drawing_gives_the_plan_of_its_twin_in_json_byte_for_byte() {
    let file = json!([{ "kind": "file", "name": "plate.dxf", "layer": "pockets" }]);
    let sent = send("/v1/pockets/plan", Some(&pocket(file)), &[("part", "plate.dxf", PLATE)]).await;

    // The loops as the inspection tells them make the twin.
    let job = json!({ "layer": "POCKETS" });
    let inspected = send(INSPECT, Some(&job), &[("part", "plate.dxf", PLATE)]).await.json();
    let loops = inspected["report"]["drawing"]["loops"].as_array().cloned().unwrap_or_default();
    let kinds: Vec<&str> = loops.iter().filter_map(|own| own["kind"].as_str()).collect();
    assert_eq!(kinds.iter().filter(|kind| **kind == "wall").count(), 3, "{kinds:?}");
    let region = |(k, wall): (usize, &Value)| {
        let islands: Vec<&Value> =
            loops.iter().filter(|own| own["parent"] == k).map(|own| &own["vertices"]).collect();
        let mut region = json!({ "boundary": wall["vertices"] });
        if !islands.is_empty() {
            region["islands"] = json!(islands);
        }
        region
    };
    let walls = loops.iter().enumerate().filter(|(_, own)| own["kind"] == "wall");
    let twin = pocket(walls.map(region).collect());
    let twin = post(&app(&[]), "/v1/pockets/plan", twin.to_string(), &[]).await;
    assert_eq!(without_warnings(&sent), without_warnings(&twin));

    let areas: Vec<f64> = loops.iter().filter_map(|own| own["area_mm2"].as_f64()).collect();
    let slot = 12.0 * 12.0 + std::f64::consts::PI * 36.0;
    let rounded = 70.0 * 60.0 - (4.0 - std::f64::consts::PI) * 36.0;
    for expected in [slot, rounded, std::f64::consts::PI * 81.0] {
        assert!(areas.iter().any(|area| (area - expected).abs() < 1e-9 * expected), "{expected}: {areas:?}");
    }
}

#[tokio::test]
async fn a_region_takes_one_wall_of_a_drawing() {
    let region = |mut file: Value| {
        file["kind"] = "file".into();
        file["name"] = "plate.dxf".into();
        let mut job = pocket(Value::Null);
        job["region"] = file;
        job
    };
    let plate = [("part", "plate.dxf", PLATE)];
    let several = send("/v1/pockets/plan", Some(&region(json!({ "layer": "POCKETS" }))), &plate).await;
    assert_eq!(several.violations(), [("conflict".into(), "#/region/name".into())], "{}", several.text());
    let one = send("/v1/pockets/plan", Some(&region(json!({ "layer": "POCKETS", "wall": 0 }))), &plate).await;
    assert_eq!(one.status, StatusCode::OK, "{}", one.text());
    let beyond = send("/v1/pockets/plan", Some(&region(json!({ "wall": 99 }))), &plate).await;
    assert_eq!(beyond.violations(), [("out_of_range".into(), "#/region/wall".into())]);
    for (file, code) in [
        (json!({ "layer": "NONE" }), "unreadable_file"),
        (json!({ "layer": "POCKETS", "gap_mm": -1 }), "out_of_range"),
        (json!({ "kind": "files" }), "conflict"),
    ] {
        let sent = send("/v1/pockets/plan", Some(&region(file)), &plate).await;
        assert_eq!(sent.status, StatusCode::UNPROCESSABLE_ENTITY);
        assert!(sent.violations().iter().any(|(own, _)| own == code), "{code}: {}", sent.text());
    }
    let mut wrong = region(json!({}));
    wrong["region"]["kind"] = "drawing".into();
    let sent = send("/v1/pockets/plan", Some(&wrong), &plate).await;
    assert_eq!(sent.violations()[0], ("unknown_value".into(), "#/region/kind".into()), "{}", sent.text());
}

#[tokio::test]
async fn a_receipt_takes_files_in_base64_alone() {
    let job = json!({ "tolerance_mm": 0.01 });
    let sent = send("/v1/programs/verify?receipt=true", Some(&job), &[]).await;
    assert_eq!((sent.status, sent.code()), (StatusCode::BAD_REQUEST, "invalid_query".into()));
}

/// A block of 140 x 80 x 30 mm: a freeform face on its left, two pockets and four holes, one of them blind.
const BLOCK: &str = include_str!("../../../openapi/files/block.step");

/// What is in the block.
async fn block() -> Value {
    let sent = send(INSPECT, None, &[("part", "block.step", BLOCK)]).await;
    assert_eq!(sent.status, StatusCode::OK, "{}", sent.text());
    sent.json()["report"].clone()
}

#[tokio::test]
async fn a_solid_is_inspected() {
    let report = block().await;
    assert_eq!((&report["format"], &report["units"]), (&json!("step"), &json!("mm")));
    assert_eq!(report["left_out"], json!([]));
    let model = &report["model"];
    let list = |name: &str| model[name].as_array().cloned().unwrap_or_default();
    assert_eq!((list("bodies").len(), list("holes").len()), (1, 4));
    assert_eq!(model["bodies"][0]["is_solid"], true);
    let through = list("holes").iter().filter(|hole| hole["is_through"] == true).count();
    assert_eq!(through, 3, "{}", model["holes"]);
    for hole in list("holes") {
        assert!((hole["diameter_mm"].as_f64().unwrap_or_default() - 6.0).abs() < 1e-9, "{hole}");
        assert_eq!(hole["axis"].to_string().replace("-0.0", "0.0"), "[0.0,0.0,-1.0]", "{hole}");
    }
    // The floors of the pockets are rectangles with rounded corners.
    let floor = |z: f64| {
        let level = list("levels").into_iter().find(|level| level["z_mm"] == z && level["is_up"] == true);
        level.and_then(|level| level["area_mm2"].as_f64()).unwrap_or_default()
    };
    for (z, sides, radius) in [(20.0, 30.0 * 56.0, 6.0), (14.0, 26.0 * 32.0, 5.0)] {
        let expected = sides - (4.0 - std::f64::consts::PI) * radius * radius;
        assert!((floor(z) - expected).abs() < 1e-6 * expected, "{z}: {} {expected}", floor(z));
    }
    let splines: Vec<Value> = list("faces").into_iter().filter(|face| face["kind"] == "spline").collect();
    assert_eq!((splines.len(), &splines[0]["is_untrimmed"]), (1, &json!(true)));
}

#[tokio::test]
async fn a_face_of_a_solid_is_milled() {
    let faces = block().await["model"]["faces"].as_array().cloned().unwrap_or_default();
    let number = faces.iter().position(|face| face["kind"] == "spline").expect("a freeform face");
    let surface = |faces: Value| json!({ "kind": "file", "name": "block.step", "faces": faces });
    let files = [("part", "block.step", BLOCK)];
    let model = json!({ "surface": surface(json!([number])) });
    let sent = send("/v1/surfaces/model", Some(&model), &files).await.json();
    let bounds = &sent["report"]["bounds"];
    let near = |value: &Value, expected: f64| (value.as_f64().unwrap_or(f64::NAN) - expected).abs() < 1e-4;
    assert!(near(&bounds["min"][0], 0.0) && near(&bounds["max"][0], 50.0), "{sent}");
    assert!(near(&bounds["min"][1], 0.0) && near(&bounds["max"][1], 80.0), "{sent}");
    let milled = send(MILL, Some(&mill(surface(json!([number])))), &files).await;
    assert_eq!(milled.status, StatusCode::OK, "{}", milled.text());
    let inch = json!({ "kind": "file", "name": "block.step", "faces": [number], "units": "inch" });
    let sent = send("/v1/surfaces/model", Some(&json!({ "surface": inch })), &files).await.json();
    assert!(near(&sent["report"]["bounds"]["max"][0], 50.0 * 25.4), "{sent}");

    let trimmed = faces.iter().position(|face| face["is_untrimmed"] == false).expect("a trimmed face");
    for (faces, code, pointer) in [
        (Value::Null, "missing_field", "#/surface/faces"),
        (json!([trimmed]), "unsupported", "#/surface/faces/0"),
        (json!([999]), "out_of_range", "#/surface/faces/0"),
        (json!([]), "wrong_length", "#/surface/faces"),
        (json!([0, 1]), "wrong_length", "#/surface/faces"),
    ] {
        let sent = send("/v1/surfaces/model", Some(&json!({ "surface": surface(faces) })), &files).await;
        assert_eq!(sent.violations(), [(code.to_owned(), pointer.to_owned())], "{}", sent.text());
    }
}

#[tokio::test]
async fn the_box_of_a_drawing_holds_its_arcs() {
    // A slot: its ends are half circles that bulge outward.
    let sent = send(INSPECT, None, &[("part", "plate.dxf", &arcs())]).await.json();
    let bounds = &sent["report"]["bounds"];
    let near = |value: &Value, expected: f64| (value.as_f64().unwrap_or(f64::NAN) - expected).abs() < 1e-9;
    assert!(near(&bounds["min"][0], -5.0) && near(&bounds["max"][0], 25.0), "{bounds}");
    assert!(near(&bounds["min"][1], 0.0) && near(&bounds["max"][1], 10.0), "{bounds}");
}

/// A slot of 30 x 10 mm as one polyline.
fn arcs() -> String {
    let vertices = [[0.0, 0.0, 0.0], [20.0, 0.0, 1.0], [20.0, 10.0, 0.0], [0.0, 10.0, 1.0]];
    let vertices = vertices.map(|[x, y, bulge]| format!("10\n{x}\n20\n{y}\n42\n{bulge}\n"));
    format!(
        "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n0\nLWPOLYLINE\n8\n0\n90\n4\n70\n1\n{}0\nENDSEC\n0\nEOF\n",
        vertices.concat()
    )
}

#[tokio::test]
async fn faults_behind_a_file_of_several_regions_stand_where_they_were_sent() {
    let file = json!({ "kind": "file", "name": "plate.dxf", "layer": "POCKETS" });
    let crossed = json!({ "boundary": [[0, 0], [1e9, 0], [0, 5]] });
    let job = pocket(json!([file, crossed]));
    let sent = send("/v1/pockets/plan", Some(&job), &[("part", "plate.dxf", PLATE)]).await;
    assert_eq!(
        sent.violations(),
        [("too_large".into(), "#/regions/1/boundary/1/0".into())],
        "{}",
        sent.text()
    );
}

#[tokio::test]
async fn a_fault_of_what_a_file_holds_stands_at_its_name() {
    // A point far off the surface of its neighbours.
    let spoilt = bowl().replace("25;20;0,03125", "25;20;90");
    let job = json!({ "surface": { "kind": "file", "name": "bowl.csv" } });
    let sent = send("/v1/surfaces/model", Some(&job), &[("part", "bowl.csv", &spoilt)]).await;
    assert_eq!(sent.status, StatusCode::UNPROCESSABLE_ENTITY, "{}", sent.text());
    assert!(sent.violations().iter().all(|(_, pointer)| pointer == "#/surface/name"), "{}", sent.text());
    assert!(sent.json()["errors"][0]["detail"].as_str().is_some_and(|detail| detail.contains("bowl.csv")));
}

#[tokio::test]
async fn a_request_refers_to_files_a_limited_number_of_times() {
    let file = json!({ "kind": "file", "name": "plate.dxf", "layer": "POCKETS", "wall": 0 });
    let job = pocket(json!(vec![file; 65]));
    let sent = send("/v1/pockets/plan", Some(&job), &[("part", "plate.dxf", PLATE)]).await;
    assert_eq!(sent.violations(), [("limit_exceeded".into(), "#/regions/64".into())], "{}", sent.text());
}

#[tokio::test]
async fn an_island_that_is_not_closed_is_refused_unless_the_request_ignores_it() {
    let island = "0\nLWPOLYLINE\n8\nPOCKETS\n90\n3\n70\n0\n10\n20\n20\n30\n10\n30\n20\n30\n10\n30\n20\n45\n";
    let plate = PLATE.replace("  0\nENDSEC\n  0\nEOF", &format!("{island}0\nENDSEC\n0\nEOF"));
    assert_ne!(plate, PLATE);
    let job = |more: Value| {
        let mut file = json!({ "kind": "file", "name": "plate.dxf", "layer": "POCKETS" });
        for (name, value) in more.as_object().into_iter().flatten() {
            file[name] = value.clone();
        }
        pocket(json!([file]))
    };
    let files = [("part", "plate.dxf", plate.as_str())];
    let refused = send("/v1/pockets/plan", Some(&job(json!({}))), &files).await;
    assert_eq!(refused.violations(), [("conflict".into(), "#/regions/0/name".into())], "{}", refused.text());
    let ignored = send("/v1/pockets/plan", Some(&job(json!({ "open_curves": "ignore" }))), &files).await;
    assert_eq!(ignored.status, StatusCode::OK, "{}", ignored.text());
    assert!(ignored.json()["warnings"].to_string().contains("open_curves"));
}
