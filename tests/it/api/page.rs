//! The page at `/` with its files, and the models that it draws.

use std::io::Read;

use axum::body::Body;
use axum::http::Request;
use flate2::read::GzDecoder;
use serde_json::{Value, json};

use super::support::{Answer, app, get, post, send};

const PLAN: &str = "/v1/pockets/plan";
const ISLAND: &str = include_str!("../../../openapi/examples/pockets-plan/island.json");
const OPEN_SLOT: &str = include_str!("../../../openapi/examples/pockets-plan/open-slot.json");
const DIE: &str = include_str!("../../../openapi/examples/surfaces-mill/die.json");
const VERIFIED: &str = include_str!("../../../openapi/examples/programs-verify/pocket.json");
const THREE: &str = include_str!("../../../openapi/examples/programs-write/three-operations.json");
const PROFILE: &str = include_str!("../../../openapi/examples/curves-interpolate/sine.json");
const CONTOUR: &str = include_str!("../../../openapi/examples/arcs-fit/contour.json");
const WIRE_UNION: &str = include_str!("../../../openapi/examples/surfaces-mill/wire-union.json");
const BLADE: &str = include_str!("../../../openapi/examples/five-axis-smooth/blade.json");
const CORNER: &str = include_str!("../../../openapi/examples/five-axis-smooth/corner.json");
const DROP: &str = include_str!("../../../openapi/examples/surfaces-drop/bowl.json");
const CYLINDER: &str = include_str!("../../../openapi/examples/surfaces-model/cylinder.json");

async fn with(path: &str, header: (&str, &str)) -> Answer {
    let app = app(&["--workers", "1"]);
    send(&app, Request::get(path).header(header.0, header.1).body(Body::empty()).expect("a request")).await
}

#[tokio::test]
async fn the_page_and_all_files_that_it_names_are_there_and_nothing_of_other_origins() {
    let app = app(&["--workers", "1"]);
    let page = get(&app, "/").await;
    assert_eq!((page.status.as_u16(), page.header("content-type")), (200, "text/html; charset=utf-8"));
    let policy = page.header("content-security-policy");
    assert!(
        policy.starts_with("default-src 'none'; script-src 'self'") && !policy.contains("unsafe"),
        "{policy}"
    );
    let text = page.text();
    assert!(!text.contains("//cdn") && !text.contains("http:") && !text.contains("https:"));
    let named: Vec<&str> = text.split('"').filter(|name| name.starts_with("page/")).collect();
    assert!(named.len() >= 3, "{named:?}");
    for name in named {
        assert_eq!(get(&app, &format!("/{name}")).await.status, 200, "{name}");
    }
    let script = get(&app, "/page/main.js").await;
    assert_eq!(script.header("content-type"), "text/javascript; charset=utf-8");
    for missing in
        ["/page/none.js", "/page/tests/view.test.mjs", "/page/../http/page.rs", "/page/examples/none/none"]
    {
        let answer = get(&app, missing).await;
        assert_eq!((answer.status.as_u16(), answer.code().as_str()), (404, "not_found"), "{missing}");
    }
}

#[tokio::test]
async fn a_file_that_a_browser_knows_is_not_sent_again_and_is_sent_in_gzip() {
    let plain = with("/page/main.js", ("accept-encoding", "identity")).await;
    let tag = plain.header("etag").to_owned();
    let strong = tag.strip_prefix("W/").expect("a weak tag").to_owned();
    assert!(strong.starts_with('"') && plain.header("cache-control") == "no-cache");
    for known in [tag.clone(), strong.clone(), format!("\"other\", {tag}"), "*".to_owned()] {
        let answer = with("/page/main.js", ("if-none-match", &known)).await;
        assert_eq!(
            (answer.status.as_u16(), answer.body.len(), answer.header("etag")),
            (304, 0, &*tag),
            "{known}"
        );
    }
    assert_eq!(with("/page/main.js", ("if-none-match", "\"other\"")).await.body, plain.body);
    let coded = with("/page/main.js", ("accept-encoding", "gzip")).await;
    assert_eq!(coded.header("content-encoding"), "gzip");
    let mut text = Vec::new();
    GzDecoder::new(coded.body.as_slice()).read_to_end(&mut text).expect("gzip");
    assert_eq!(text, plain.body);
}

#[tokio::test]
async fn the_contract_of_the_page_names_examples_that_are_those_of_the_contract() {
    let app = app(&["--workers", "1"]);
    let contract = get(&app, "/page/contract.json").await.json();
    let whole = get(&app, "/openapi.json").await.json();
    let mut count = 0;
    for (path, item) in contract["paths"].as_object().expect("paths") {
        let examples = &item["post"]["requestBody"]["content"]["application/json"]["examples"];
        for (name, example) in examples.as_object().into_iter().flatten() {
            let at = format!("/{}", example["externalValue"].as_str().expect("a path"));
            let own = &whole["paths"][path]["post"]["requestBody"]["content"]["application/json"]["examples"];
            assert_eq!(get(&app, &at).await.json(), own[name]["value"], "{at}");
            count += 1;
        }
    }
    assert!(count > 50, "{count} examples");
}

/// The description of the model of a request.
async fn model(path: &str, body: &str) -> Value {
    let answer = post(&app(&["--workers", "1"]), &format!("{path}?format=glb"), body.to_owned(), &[]).await;
    assert_eq!(answer.status, 200, "{}", String::from_utf8_lossy(&answer.body));
    let length = u32::from_le_bytes(answer.body[12..16].try_into().expect("four bytes")) as usize;
    serde_json::from_slice(&answer.body[20..20 + length]).expect("JSON")
}

/// The box of a node, mm; none without the node.
fn bounds(model: &Value, name: &str) -> Option<[Vec<f64>; 2]> {
    let node = model["nodes"].as_array()?.iter().find(|node| node["name"] == name)?;
    let mesh = &model["meshes"][node["mesh"].as_u64()? as usize]["primitives"][0];
    let place = &model["accessors"][mesh["attributes"]["POSITION"].as_u64()? as usize];
    let end = |name: &str| {
        let metres = place[name].as_array().into_iter().flatten().filter_map(Value::as_f64);
        metres.map(|x| (x * 1e6).round() / 1e3).collect()
    };
    Some([end("min"), end("max")])
}

fn about(model: &Value) -> &Value {
    let root = model["scenes"][0]["nodes"][0].as_u64().unwrap_or_default() as usize;
    &model["nodes"][root]["extras"]
}

#[tokio::test]
async fn a_pocket_has_a_part_as_deep_as_its_floor_and_a_stock_that_is_assumed_or_told() {
    let mut request: Value = serde_json::from_str(ISLAND).expect("JSON");
    let (depth, tops) = (request["floor_z_mm"].as_f64().expect("a floor"), 0.0);
    let assumed = model(PLAN, ISLAND).await;
    let [low, high] = bounds(&assumed, "part").expect("a part");
    assert_eq!(about(&assumed)["stock_is_assumed"], true);
    assert_eq!(bounds(&assumed, "stock"), Some([low.clone(), high.clone()]));
    assert!((high[2] - tops).abs() < 1e-9 && low[2] < depth, "{low:?} {high:?}");
    request["stock"] = json!({ "kind": "box", "min": [-30, -30, -40], "max": [200, 170, 0] });
    let told = model(PLAN, &request.to_string()).await;
    assert_eq!(about(&told)["stock_is_assumed"], false);
    let [low, high] = bounds(&told, "part").expect("a part");
    assert_eq!((low, high), (vec![-30.0, -30.0, -40.0], vec![200.0, 170.0, 0.0]));
}

#[tokio::test]
async fn in_front_of_open_edges_no_block_is_assumed() {
    let open = model(PLAN, OPEN_SLOT).await;
    assert_eq!((about(&open)["stock_is_assumed"].clone(), bounds(&open, "part")), (json!(false), None));
    assert!(bounds(&open, "stock").is_some());
}

#[tokio::test]
async fn a_milled_surface_has_its_block() {
    let die = model("/v1/surfaces/mill", DIE).await;
    let ([part_low, part_high], [low, high]) =
        (bounds(&die, "part").expect("a part"), bounds(&die, "stock").expect("a stock"));
    for axis in 0..3 {
        assert!(low[axis] <= part_low[axis] + 1e-3 && high[axis] >= part_high[axis] - 1e-3, "{axis}");
    }
}

#[tokio::test]
async fn a_path_as_points_starts_and_ends_with_the_moves_and_is_as_long() {
    let app = app(&["--workers", "1"]);
    let query = format!("{PLAN}?points=true&toolpath=true");
    let answer = post(&app, &query, ISLAND.to_owned(), &[]).await.json();
    assert_eq!(answer["polyline_chord_mm"], 0.001);
    let points = answer["polyline"].as_array().expect("points");
    assert_eq!(points[0], answer["toolpath"]["start"]);
    let passes = answer["toolpath"]["passes"].as_array().expect("passes");
    let last = passes.iter().rev().find_map(|pass| pass["moves"].as_array()?.last()).expect("a move");
    assert_eq!(points[points.len() - 1], last["to"]);
    let place = |point: &Value| [0, 1, 2].map(|axis| point[axis].as_f64().expect("a number"));
    let distance = |pair: &[Value]| {
        let [p, q] = [&pair[0], &pair[1]].map(place);
        (0..3).map(|axis| (p[axis] - q[axis]).powi(2)).sum::<f64>().sqrt()
    };
    let length: f64 = points.windows(2).map(distance).sum();
    let measures = &answer["measures"];
    let of = |name: &str| measures[name].as_f64().expect("a length");
    let whole = of("cutting_length_mm") + of("rapid_length_mm");
    assert!(length <= whole + 1e-6 && length > whole * (1.0 - 1e-3), "{length} of {whole}");
    let without = post(&app, PLAN, ISLAND.to_owned(), &[]).await.json();
    assert!(without.get("polyline").is_none() && without.get("polyline_chord_mm").is_none());
    let refused = post(&app, "/v1/surfaces/model?points=true", CYLINDER.to_owned(), &[]).await;
    assert_eq!((refused.status.as_u16(), refused.code().as_str()), (422, "invalid_request"));
}

#[tokio::test]
async fn a_surface_is_answered_as_triangles_in_an_stl_file() {
    let app = app(&["--workers", "1"]);
    let answer = post(&app, "/v1/surfaces/model?format=stl", CYLINDER.to_owned(), &[]).await;
    assert_eq!((answer.status.as_u16(), answer.header("content-type")), (200, "model/stl"));
    let count = u32::from_le_bytes(answer.body[80..84].try_into().expect("four bytes")) as usize;
    assert!(count > 100 && answer.body.len() == 84 + 50 * count, "{count}");
    // The cylinder about x = z = 0 has a radius of 40 mm; the chords of its triangles stay inside.
    let number = |at: usize| f64::from(f32::from_le_bytes(answer.body[at..at + 4].try_into().expect("four")));
    for first in (84..answer.body.len()).step_by(50) {
        for corner in [12, 24, 36] {
            let [x, z] = [0, 8].map(|axis| number(first + corner + axis));
            assert!((x.hypot(z) - 40.0).abs() < 1e-4, "{x} {z}");
        }
    }
}

#[tokio::test]
async fn a_program_that_is_read_has_the_lines_of_its_blocks_and_a_verified_one_its_stock() {
    let app = app(&["--workers", "1"]);
    let program = "G21 G90 G94\nG0 X0 Y0 Z5\n\nG1 Z0 F100\nX10\nM30\n";
    let body = json!({ "nc": program, "dialect": "linuxcnc" }).to_string();
    let answer = post(&app, "/v1/programs/read?format=glb", body, &[]).await;
    assert_eq!(answer.status, 200, "{}", String::from_utf8_lossy(&answer.body));
    let lines = numbers(&answer.body, "_BLOCK");
    assert_eq!(lines.last(), Some(&5.0));
    assert!(lines.contains(&4.0) && !lines.contains(&3.0), "{lines:?}");
    let verified = model("/v1/programs/verify", VERIFIED).await;
    assert!(bounds(&verified, "stock").is_some() && about(&verified)["stock_is_assumed"] == false);
}

#[tokio::test]
async fn every_operation_of_a_program_has_the_lines_of_its_own_blocks() {
    let app = app(&["--workers", "1"]);
    let text = post(&app, "/v1/programs/write?format=gcode", THREE.to_owned(), &[]).await.text();
    let file = post(&app, "/v1/programs/write?format=glb", THREE.to_owned(), &[]).await.body;
    let ends_with = |end: &str| -> Vec<f32> {
        (1u16..).zip(text.lines()).filter(|(_, line)| line.ends_with(end)).map(|(k, _)| k.into()).collect()
    };
    // The operations are passes 1, 3 and 5; between them are the ways to the next one, which the program of
    // two tools and two work offsets does not have.
    let plunges = [ends_with("Z-1.000 F200."), ends_with("Z-1.200 F150.")].concat();
    assert_eq!(plunges.len(), 3, "{text}");
    for (pass, plunge) in [1, 3, 5].into_iter().zip(plunges) {
        let strip = format!("pass {pass}");
        let (lines, kinds) = (numbers_of(&file, &strip, "_BLOCK"), numbers_of(&file, &strip, "_KIND"));
        let own = lines.iter().zip(&kinds).skip(1).find(|(_, kind)| **kind == 2.0).map(|(line, _)| *line);
        assert_eq!(own, Some(plunge), "{strip}: {lines:?}\n{text}");
        assert!(lines[1..].is_sorted() && lines[lines.len() - 1] > plunge, "{strip}: {lines:?}");
    }
    for strip in ["pass 2", "pass 4"] {
        assert!(numbers_of(&file, strip, "_BLOCK")[1..].iter().all(|line| *line == 0.0), "{strip}");
    }
}

/// The numbers of an attribute of the first strip of a model.
fn numbers(file: &[u8], name: &str) -> Vec<f32> {
    numbers_of(file, "pass 1", name)
}

/// The numbers of an attribute of a strip of a model.
fn numbers_of(file: &[u8], strip: &str, name: &str) -> Vec<f32> {
    let strips = strips(file, name);
    let found = strips.iter().find(|(own, _)| own == strip);
    found.map(|(_, numbers)| numbers.clone()).unwrap_or_else(|| panic!("{strip}: {strips:?}"))
}

/// The numbers of an attribute of all strips of a model that have it, with their names.
fn strips(file: &[u8], name: &str) -> Vec<(String, Vec<f32>)> {
    let length = u32::from_le_bytes(file[12..16].try_into().expect("four bytes")) as usize;
    let json: Value = serde_json::from_slice(&file[20..20 + length]).expect("JSON");
    let index = |value: &Value| value.as_u64().expect("an index") as usize;
    let number = |at: usize| f32::from_le_bytes(file[at..at + 4].try_into().expect("four bytes"));
    let numbers = |accessor: usize| -> Vec<f32> {
        let accessor = &json["accessors"][accessor];
        let view = &json["bufferViews"][index(&accessor["bufferView"])];
        let offset = accessor.get("byteOffset").map_or(0, index) + view.get("byteOffset").map_or(0, index);
        let from = 20 + length + 8 + offset;
        (0..index(&accessor["count"])).map(|k| number(from + 4 * k)).collect()
    };
    let meshes = json["meshes"].as_array().expect("meshes").iter();
    let found = meshes.filter_map(|mesh| {
        let accessor = mesh["primitives"][0]["attributes"].get(name)?;
        Some((mesh["name"].as_str()?.to_owned(), numbers(index(accessor))))
    });
    found.collect()
}

#[tokio::test]
async fn the_largest_deviation_on_a_path_is_that_of_the_report() {
    let app = app(&["--workers", "1"]);
    for (path, body) in [
        ("/v1/curves/interpolate", PROFILE),
        ("/v1/arcs/fit", CONTOUR),
        ("/v1/surfaces/mill", DIE),
        ("/v1/surfaces/mill", WIRE_UNION),
    ] {
        let answer = post(&app, &format!("{path}?toolpath=false"), body.to_owned(), &[]).await.json();
        let told_mm = answer["report"]["deviation_max_mm"].as_f64().expect("a deviation");
        let file = post(&app, &format!("{path}?format=glb"), body.to_owned(), &[]).await.body;
        let found = strips(&file, "_DEVIATION");
        let all = || found.iter().flat_map(|(_, numbers)| numbers);
        let largest_mm = f64::from(all().copied().fold(f32::MIN, f32::max));
        assert!((largest_mm - told_mm).abs() < 1e-6 * told_mm, "{path}: {largest_mm} {told_mm}");
        assert!(all().all(|mm| *mm == -1.0 || *mm >= 0.0), "{path}");
        // Each cutting move has one, and no other move.
        let kinds = strips(&file, "_KIND");
        for ((_, deviations), (name, kinds)) in found.iter().zip(&kinds) {
            let mut pairs = deviations.iter().zip(kinds).skip(1);
            assert!(pairs.all(|(mm, kind)| (*mm >= 0.0) == (*kind == 1.0)), "{path}: {name}");
        }
    }
}

#[tokio::test]
async fn diagrams_of_five_axes_tell_their_clock_on_the_path() {
    for body in [BLADE, CORNER] {
        let app = app(&["--workers", "1"]);
        let path = "/v1/five-axis/smooth";
        let report =
            post(&app, &format!("{path}?toolpath=false"), body.to_owned(), &[]).await.json()["report"]
                .clone();
        let model = model(path, body).await;
        let clock: Vec<[f64; 2]> =
            serde_json::from_value(about(&model)["clock"].clone()).expect("pairs of seconds");
        let [first, .., last] = clock[..] else { panic!("{clock:?}") };
        for diagram in about(&model)["diagrams"].as_array().expect("diagrams") {
            assert_eq!(diagram["starts_at_s"].as_f64(), Some(first[1]));
        }
        let cycle_time_s = report["cycle_time_s"].as_f64().expect("a time");
        assert!(first[0] == 0.0 && (last[0] - cycle_time_s).abs() < 1e-9, "{first:?} {last:?}");
        assert!(clock.is_sorted_by(|a, b| a[0] <= b[0] && a[1] <= b[1]));
    }
}

#[tokio::test]
async fn a_surface_states_how_far_its_triangles_are() {
    for (path, body) in
        [("/v1/surfaces/mill", DIE), ("/v1/surfaces/model", CYLINDER), ("/v1/surfaces/drop", DROP)]
    {
        let model = model(path, body).await;
        let chord_mm = about(&model)["part_chord_mm"].as_f64().expect("a distance");
        assert!(chord_mm <= 0.01 && bounds(&model, "part").is_some(), "{path}: {chord_mm}");
    }
}
