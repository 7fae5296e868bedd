//! Meshes of triangles in files: what is told and shown of them.

use axum::http::StatusCode;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use flate2::Crc;
use serde_json::{Value, json};

use crate::api::support::{Answer, app, post};

const INSPECT: &str = "/v1/parts/inspect";

/// The corners of a box of 10 x 4 x 3, and its sides counterclockwise as seen from outside.
const CORNERS: [[i32; 3]; 8] =
    [[0, 0, 0], [10, 0, 0], [0, 4, 0], [10, 4, 0], [0, 0, 3], [10, 0, 3], [0, 4, 3], [10, 4, 3]];
const SIDES: [[usize; 4]; 6] =
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

fn triangles() -> impl Iterator<Item = [usize; 3]> {
    SIDES.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]])
}

fn stl() -> String {
    let vertex = |corner: usize| {
        let [x, y, z] = CORNERS[corner];
        format!("vertex {x} {y} {z}\n")
    };
    let facet = |own: [usize; 3]| {
        let vertices: String = own.map(vertex).concat();
        format!("facet normal 0 0 0\nouter loop\n{vertices}endloop\nendfacet\n")
    };
    format!("solid box\n{}endsolid box\n", triangles().map(facet).collect::<String>())
}

fn obj() -> String {
    let vertices = CORNERS.map(|[x, y, z]| format!("v {x} {y} {z}\n")).concat();
    let faces = SIDES.map(|own| format!("f {}\n", own.map(|k| (k + 1).to_string()).join(" "))).concat();
    vertices + &faces
}

fn ply() -> String {
    let vertices = CORNERS.map(|[x, y, z]| format!("{x} {y} {z}\n")).concat();
    let faces = SIDES.map(|own| format!("4 {}\n", own.map(|k| k.to_string()).join(" "))).concat();
    format!(
        "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n\
         element face 6\nproperty list uchar int vertex_indices\nend_header\n{vertices}{faces}"
    )
}

/// A 3MF file with a model in this unit, which the archive stores as it is.
fn three_mf(unit: &str) -> Vec<u8> {
    let vertices = CORNERS.map(|[x, y, z]| format!("<vertex x=\"{x}\" y=\"{y}\" z=\"{z}\"/>")).concat();
    let faces = triangles().map(|[a, b, c]| format!("<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\"/>"));
    let model = format!(
        "<model unit=\"{unit}\" xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"><resources>\
         <object id=\"1\"><mesh><vertices>{vertices}</vertices><triangles>{}</triangles></mesh></object>\
         </resources><build><item objectid=\"1\"/></build></model>",
        faces.collect::<String>()
    );
    let name = "3D/3dmodel.model";
    let mut sum = Crc::new();
    sum.update(model.as_bytes());
    let mut record = vec![20, 0, 0, 0, 0, 0, 0, 0, 0, 0];
    record.extend(sum.sum().to_le_bytes());
    record.extend((model.len() as u32).to_le_bytes());
    record.extend((model.len() as u32).to_le_bytes());
    record.extend([name.len() as u8, 0, 0, 0]);
    let file = [b"PK\x03\x04", &record[..], name.as_bytes(), model.as_bytes()].concat();
    let entry = [b"PK\x01\x02\x14\0", &record[..], &[0; 14], name.as_bytes()].concat();
    let mut end = b"PK\x05\x06\0\0\0\0\x01\0\x01\0".to_vec();
    end.extend((entry.len() as u32).to_le_bytes());
    end.extend((file.len() as u32).to_le_bytes());
    end.extend([0; 2]);
    [file, entry, end].concat()
}

/// The same box in all formats.
fn files() -> [(&'static str, &'static str, Vec<u8>); 4] {
    [
        ("stl", "box.stl", stl().into_bytes()),
        ("obj", "box.obj", obj().into_bytes()),
        ("ply", "box.ply", ply().into_bytes()),
        ("3mf", "box.3mf", three_mf("millimeter")),
    ]
}

async fn inspect(query: &str, name: &str, bytes: &[u8], units: Option<&str>) -> Answer {
    inspect_with(&[], query, name, bytes, units).await
}

async fn inspect_with(flags: &[&str], query: &str, name: &str, bytes: &[u8], units: Option<&str>) -> Answer {
    let mut body = json!({ "file": { "name": name, "base64": BASE64_STANDARD.encode(bytes) } });
    if let Some(units) = units {
        body["units"] = units.into();
    }
    post(&app(flags), &format!("{INSPECT}{query}"), body.to_string(), &[]).await
}

fn codes(answer: &Value) -> Vec<&str> {
    answer["warnings"].as_array().unwrap().iter().map(|own| own["code"].as_str().unwrap()).collect()
}

#[tokio::test]
async fn a_box_in_each_format_has_the_figures_of_the_box() {
    for (format, name, bytes) in files() {
        let answer = inspect("", name, &bytes, None).await;
        assert_eq!(answer.status, StatusCode::OK, "{format}: {}", answer.text());
        let answer = answer.json();
        let report = &answer["report"];
        assert_eq!(report["format"], format);
        assert_eq!(report["bounds"], json!({ "min": [0.0, 0.0, 0.0], "max": [10.0, 4.0, 3.0] }), "{format}");
        let n_polygons = if ["obj", "ply"].contains(&format) { 6 } else { 0 };
        let expected = json!({
            "n_triangles": 12, "n_vertices": 8, "n_degenerate": 0, "n_polygons": n_polygons,
            "off_plane_max_mm": 0.0, "n_bodies": 1, "area_mm2": 164.0, "is_closed": true, "n_open_edges": 0,
            "n_crowded_edges": 0, "n_turned_edges": 0, "volume_mm3": 120.0, "n_inward_bodies": 0,
            "is_outward": true,
        });
        assert_eq!(report["mesh"], expected, "{format}");
        assert_eq!(report["left_out"], json!([]), "{format}");
        let (units, warnings) =
            if format == "3mf" { (json!("mm"), vec![]) } else { (Value::Null, vec!["file_unit_missing"]) };
        assert_eq!((&report["units"], codes(&answer)), (&units, warnings), "{format}");
    }
}

#[tokio::test]
async fn figures_are_in_mm_in_the_unit_that_is_sent() {
    for (format, name, bytes) in files() {
        let answer = inspect("", name, &bytes, Some("inch")).await.json();
        let report = &answer["report"];
        assert_eq!(report["bounds"]["max"][0], 254.0, "{format}");
        let volume = report["mesh"]["volume_mm3"].as_f64().unwrap();
        assert!((volume / (120.0 * 25.4 * 25.4 * 25.4) - 1.0).abs() < 1e-12, "{format}: {volume}");
        let warnings = if format == "3mf" { vec!["units_overridden"] } else { vec![] };
        assert_eq!(codes(&answer), warnings, "{format}");
    }
    let stated = inspect("", "box.3mf", &three_mf("inch"), None).await.json();
    assert_eq!((&stated["report"]["units"], codes(&stated)), (&json!("inch"), vec![]));
    assert_eq!(stated["report"]["bounds"]["max"][0], 254.0);
}

#[tokio::test]
async fn a_mesh_that_is_open_has_no_volume() {
    let open = obj().replacen("f 1 3 4 2\n", "l 1 3 4 2\n", 1);
    let answer = inspect("", "box.obj", open.as_bytes(), Some("mm")).await.json();
    let report = &answer["report"];
    assert_eq!((&report["mesh"]["n_open_edges"], &report["mesh"]["is_closed"]), (&json!(4), &json!(false)));
    for member in ["volume_mm3", "n_inward_bodies", "is_outward"] {
        assert!(report["mesh"].get(member).is_none(), "{member}");
    }
    let expected = json!([{ "kind": "l", "reason": "lines and points have no area", "count": 1, "line": 9 }]);
    assert_eq!(report["left_out"], expected);
}

#[tokio::test]
async fn the_picture_shows_the_edges_of_the_mesh() {
    for (format, name, bytes) in files() {
        let answer = inspect("?format=svg", name, &bytes, Some("mm")).await;
        assert_eq!(answer.status, StatusCode::OK, "{format}");
        assert!(answer.text().contains("body-edge"), "{format}");
    }
}

/// The JSON of a binary glTF file.
fn gltf(bytes: &[u8]) -> Value {
    assert_eq!(&bytes[..4], b"glTF");
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    serde_json::from_slice(&bytes[20..20 + length]).unwrap()
}

#[tokio::test]
async fn the_model_shows_the_mesh_as_the_part() {
    for (format, name, bytes) in files() {
        let answer = inspect("?format=glb", name, &bytes, Some("mm")).await;
        assert_eq!(answer.status, StatusCode::OK, "{format}");
        let gltf = gltf(&answer.body);
        let accessors = gltf["accessors"].as_array().unwrap();
        let has =
            |kind: &str, count: u64| accessors.iter().any(|own| own["type"] == kind && own["count"] == count);
        // The edges of a box are sharp: each corner has three normals.
        assert!(has("VEC3", 24) && has("SCALAR", 36), "{format}: {accessors:?}");
    }
}

#[tokio::test]
async fn a_mesh_with_too_many_triangles_is_refused() {
    let flags = ["--max-mesh-triangles", "11"];
    for (format, name, bytes) in files() {
        let answer = inspect_with(&flags, "", name, &bytes, None).await;
        assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY, "{format}");
        assert_eq!(answer.violations()[0].1, "#/file", "{format}");
        assert!(answer.text().contains("triangles"), "{format}: {}", answer.text());
    }
}

#[tokio::test]
async fn a_damaged_mesh_is_refused_with_its_place() {
    let mut count = vec![0; 84];
    count[80..].fill(255);
    let nan = stl().replacen("vertex 10 4 3", "vertex 10 nan 3", 1).into_bytes();
    let cut = three_mf("millimeter")[..500].to_vec();
    for (name, bytes, detail) in [
        ("box.stl", count, "`box.stl`: byte 84: 4294967295 triangles were to follow byte 84; the file has 0"),
        ("box.stl", nan, "`box.stl`: line 20: NaN is no coordinate"),
        (
            "box.obj",
            b"v 0 0 0\nf 1 2 3\n".to_vec(),
            "`box.obj`: line 2: there is no vertex 2; the file has 1",
        ),
        (
            "box.ply",
            b"ply\nformat ascii 1.0\n".to_vec(),
            "`box.ply`: line 3: the file ends within its header",
        ),
        ("box.3mf", cut, "`box.3mf`: the file: the end of the ZIP archive is missing"),
    ] {
        let answer = inspect("", name, &bytes, None).await;
        assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY, "{name}");
        let errors = &answer.problem()["errors"];
        assert_eq!(errors[0]["code"], "unreadable_file", "{name}");
        assert_eq!(errors[0]["detail"], detail);
    }
}
