//! Illegal request bodies: the status, the code and the pointer to the fault of each.

use serde_json::{Value, json};

use super::support::{Answer, MILL, ONE_PASS, app, get, post};

/// The smallest legal request, with the value at `pointer` replaced or added.
fn with(pointer: &str, value: Value) -> String {
    let mut body: Value = serde_json::from_str(ONE_PASS).expect("JSON");
    let (parent, name) = pointer.rsplit_once('/').expect("a pointer");
    let parent = body.pointer_mut(parent).expect("a parent");
    match parent {
        Value::Array(elements) => elements[name.parse::<usize>().expect("an index")] = value,
        parent => parent[name] = value,
    }
    body.to_string()
}

async fn mill(body: impl Into<axum::body::Body>) -> Answer {
    post(&app(&["--workers", "1"]), MILL, body, &[]).await
}

#[tokio::test]
async fn a_body_that_is_not_json_is_400() {
    let truncated = &ONE_PASS[..ONE_PASS.len() / 2];
    let deep = format!("{{\"surface\":{}", "[".repeat(100_000));
    let deep_and_closed = format!("{}{}", "[".repeat(100_000), "]".repeat(100_000));
    let nan = ONE_PASS.replace("0.01", "NaN");
    let infinite = ONE_PASS.replace("0.01", "1e999");
    let twice = ONE_PASS.replace("\"tolerance_mm\"", "\"tolerance_mm\": 1, \"tolerance_mm\"");
    let trailing = format!("{ONE_PASS} x");
    for body in ["", " \n", truncated, &deep, &deep_and_closed, &nan, &infinite, &twice, &trailing] {
        let answer = mill(body.to_owned()).await;
        assert_eq!(answer.status, 400, "{}", &body[..body.len().min(60)]);
        assert_eq!(answer.code(), "malformed_json");
    }
    assert_eq!(mill(vec![b'"', 0xff, b'"']).await.code(), "malformed_json");
}

#[tokio::test]
async fn every_violation_in_a_milling_request_has_its_code_and_its_pointer() {
    let row = |n: usize| json!((0..n).map(|j| json!([10, j, 0])).collect::<Vec<_>>());
    for (pointer, value, code, blamed) in [
        ("/tolerence_mm", json!(0.01), "unknown_field", "#/tolerence_mm"),
        ("/tool/diametre", json!(1), "unknown_field", "#/tool/diametre"),
        ("/surface/pionts", json!([]), "unknown_field", "#/surface/pionts"),
        ("/strategy/trimm", json!(1), "unknown_field", "#/strategy/trimm"),
        ("/surface/points/1/1/2", json!("x"), "wrong_type", "#/surface/points/1/1/2"),
        ("/surface/points/1/1/2", json!(null), "wrong_type", "#/surface/points/1/1/2"),
        ("/surface/points/1/1", json!([1, 2]), "wrong_length", "#/surface/points/1/1"),
        ("/surface/points/1/1", json!([1, 2, 3, 4]), "wrong_length", "#/surface/points/1/1"),
        ("/surface/points/1/1/0", json!(1e308), "too_large", "#/surface/points/1/1/0"),
        ("/surface/points/1/1/0", json!(-1_000_001), "too_large", "#/surface/points/1/1/0"),
        ("/surface/points/1", row(3), "ragged_grid", "#/surface/points/1"),
        ("/surface/points", json!([row(1), row(1), row(1)]), "too_few_points", "#/surface/points/0"),
        ("/surface/points", json!([row(3)]), "too_few_points", "#/surface/points"),
        ("/surface/points", json!([]), "too_few_points", "#/surface/points"),
        ("/surface", json!({}), "missing_field", "#/surface/kind"),
        ("/surface", json!(7), "wrong_type", "#/surface"),
        ("/surface", json!({ "kind": "point_grid" }), "missing_field", "#/surface/points"),
        ("/surface/kind", json!("ball"), "unknown_value", "#/surface/kind"),
        ("/surface/kind", json!(3), "wrong_type", "#/surface/kind"),
        ("/surface/ends", json!("clamped"), "missing_field", "#/surface/end_tangents"),
        ("/surface/twist", json!("left"), "unknown_value", "#/surface/twist"),
        ("/tool", json!({ "shape": "ball" }), "missing_field", "#/tool/diameter_mm"),
        ("/tool", json!(["ball", 6]), "wrong_type", "#/tool"),
        ("/surface", json!(["point_grid"]), "wrong_type", "#/surface"),
        ("/program", json!([]), "wrong_type", "#/program"),
        ("/surface/end_tangents", json!([[], [], [], []]), "wrong_type", "#/surface/end_tangents"),
        ("/tool/shape", json!("bull_nose"), "missing_field", "#/tool/corner_radius_mm"),
        ("/tool/corner_radius_mm", json!(1), "unknown_field", "#/tool/corner_radius_mm"),
        ("/tool/shape", json!("round"), "unknown_value", "#/tool/shape"),
        ("/tool/diameter_mm", json!(-6), "out_of_range", "#/tool/diameter_mm"),
        ("/tool/diameter_mm", json!(0), "out_of_range", "#/tool/diameter_mm"),
        ("/tool/number", json!(0), "out_of_range", "#/tool/number"),
        ("/tool/number", json!(1.5), "wrong_type", "#/tool/number"),
        ("/tolerance_mm", json!(0), "out_of_range", "#/tolerance_mm"),
        ("/tolerance_mm", json!(11), "out_of_range", "#/tolerance_mm"),
        ("/strategy", json!({ "kind": "wire_union" }), "missing_field", "#/strategy/pitch_mm"),
        ("/strategy", json!({ "kind": "wire_union", "pitch_mm": 0 }), "out_of_range", "#/strategy/pitch_mm"),
        ("/strategy", json!({ "kind": "wire_union", "pitch_mm": "5" }), "wrong_type", "#/strategy/pitch_mm"),
        (
            "/strategy",
            json!({ "kind": "wire_union", "stepover_mm": 5 }),
            "unknown_field",
            "#/strategy/stepover_mm",
        ),
        ("/strategy/scallop_height_mm", json!(1), "conflict", "#/strategy/scallop_height_mm"),
        ("/strategy/trim", json!(false), "unsupported", "#/strategy/trim"),
        ("/strategy/stepover_mm", json!(0), "out_of_range", "#/strategy/stepover_mm"),
        ("/engine", json!("guess"), "unknown_value", "#/engine"),
        ("/boundary", json!("across"), "unknown_value", "#/boundary"),
        ("/cutting", json!({}), "missing_field", "#/cutting/feed_mm_per_min"),
        ("/cutting/feed_mm_per_min", json!(-1), "out_of_range", "#/cutting/feed_mm_per_min"),
        ("/cutting/coolant", json!("air"), "unknown_value", "#/cutting/coolant"),
        ("/cutting/retract_z_mm", json!(1e7), "too_large", "#/cutting/retract_z_mm"),
        ("/program", json!({ "dialect": "klingon" }), "unknown_dialect", "#/program/dialect"),
        ("/program", json!({ "decimals": 7 }), "out_of_range", "#/program/decimals"),
        ("/program", json!({ "units": "foot" }), "unknown_value", "#/program/units"),
        ("/program", json!({ "work_offset": "G60" }), "unknown_value", "#/program/work_offset"),
        ("/program", json!({ "name": "x".repeat(1001) }), "too_long", "#/program/name"),
        ("/tool/tool", json!(1), "unknown_field", "#/tool/tool"),
        ("/cutting/cutting", json!(1), "unknown_field", "#/cutting/cutting"),
        ("/cutting", json!({ "x".repeat(1000): 1 }), "unknown_field", "#/cutting"),
        ("/meta", json!({ "x".repeat(1000): "1" }), "too_long", "#/meta"),
        ("/meta", json!({ "a/b": 1 }), "wrong_type", "#/meta/a~1b"),
        ("/meta", json!({ "part": "x".repeat(1001) }), "too_long", "#/meta/part"),
    ] {
        let answer = mill(with(pointer, value.clone())).await;
        assert_eq!(answer.status, 422, "{pointer} {value}");
        let found = answer.violations();
        assert_eq!(found.first(), Some(&(code.to_owned(), blamed.to_owned())), "{pointer} {value}");
        let expected = if code == "unsupported" { "unsupported" } else { "invalid_request" };
        assert_eq!(answer.code(), expected);
    }
    for body in ["[]", "7", "null", "\"x\""] {
        let answer = mill(body).await;
        assert_eq!(answer.violations(), [("wrong_type".to_owned(), "#".to_owned())], "{body}");
    }
}

#[tokio::test]
async fn all_values_out_of_range_are_reported_in_one_answer_with_value_and_limit() {
    let mut body: Value = serde_json::from_str(ONE_PASS).expect("JSON");
    body["surface"]["points"][0][0][0] = json!(1e308);
    body["surface"]["points"][1][1][2] = json!(-2e6);
    body["tool"]["diameter_mm"] = json!(-6);
    body["tolerance_mm"] = json!(0);
    body["cutting"]["feed_mm_per_min"] = json!(0);
    body["program"] = json!({ "dialect": "klingon", "decimals": 0 });
    let answer = mill(body.to_string()).await;
    let pointers: Vec<_> = answer.violations().into_iter().map(|(_, pointer)| pointer).collect();
    assert_eq!(
        pointers,
        [
            "#/surface/points/0/0/0",
            "#/surface/points/1/1/2",
            "#/tool/diameter_mm",
            "#/tolerance_mm",
            "#/cutting/feed_mm_per_min",
            "#/program/dialect",
            "#/program/decimals",
        ]
    );
    let problem = answer.problem();
    let detail = problem["errors"][2]["detail"].as_str().unwrap_or_default();
    assert!(detail.contains("-6") && detail.contains("0.001"), "{detail}");
}

#[tokio::test]
async fn an_exceeded_limit_is_reported_with_its_value_and_its_maximum() {
    let app = app(&["--workers", "1", "--max-surface-points", "3", "--max-sections", "100"]);
    let answer = post(&app, MILL, ONE_PASS, &[]).await;
    assert_eq!(answer.violations(), [("limit_exceeded".to_owned(), "#/surface/points".to_owned())]);
    let problem = answer.problem();
    let detail = problem["errors"][0]["detail"].as_str().unwrap_or_default();
    assert_eq!(detail, "the surface has 4 points; send at most 3");
    let fine = with("/strategy", json!({ "kind": "cl_cartesian", "plane": "yz", "stepover_mm": 0.01 }));
    let app = super::support::app(&["--workers", "1", "--max-sections", "100"]);
    let answer = post(&app, MILL, fine, &[]).await;
    assert_eq!(answer.violations(), [("limit_exceeded".to_owned(), "#/strategy/stepover_mm".to_owned())]);
}

#[tokio::test]
async fn a_body_over_the_limit_is_413_with_and_without_a_content_length() {
    let app = app(&["--workers", "1", "--body-limit", "1000"]);
    let large = " ".repeat(1001);
    let announced = post(&app, MILL, large.clone(), &[]).await;
    assert_eq!((announced.status.as_u16(), announced.code().as_str()), (413, "payload_too_large"));
    let stream = axum::body::Body::new(http_body_of_parts(large.into_bytes()));
    let streamed = post(&app, MILL, stream, &[]).await;
    assert_eq!((streamed.status.as_u16(), streamed.code().as_str()), (413, "payload_too_large"));
    assert_ne!(post(&app, MILL, ONE_PASS, &[]).await.status, 413);
}

/// A body that comes in parts, without a content length.
fn http_body_of_parts(bytes: Vec<u8>) -> Parts {
    Parts(bytes.chunks(100).map(|part| part.to_vec().into()).collect())
}

struct Parts(std::collections::VecDeque<axum::body::Bytes>);

impl axum::body::HttpBody for Parts {
    type Data = axum::body::Bytes;
    type Error = std::convert::Infallible;

    fn poll_frame(
        mut self: std::pin::Pin<&mut Self>,
        _: &mut std::task::Context<'_>,
    ) -> std::task::Poll<Option<Result<hyper::body::Frame<Self::Data>, Self::Error>>> {
        std::task::Poll::Ready(self.0.pop_front().map(|part| Ok(hyper::body::Frame::data(part))))
    }
}

#[tokio::test]
async fn all_violations_are_reported_in_one_answer_without_rust_words() {
    let mut body: Value = serde_json::from_str(ONE_PASS).expect("JSON");
    body["tool"] = json!({ "shape": "ball", "diameter_mm": "six", "colour": "red" });
    body["tolerance_mm"] = json!(-1);
    body["cutting"] = json!({ "coolant": "flood" });
    body["strategy"]["stepover_mm"] = json!(true);
    let answer = mill(body.to_string()).await;
    assert_eq!(answer.status, 422);
    let mut found = answer.violations();
    found.sort();
    let expected = [
        ("missing_field", "#/cutting/feed_mm_per_min"),
        ("out_of_range", "#/tolerance_mm"),
        ("unknown_field", "#/tool/colour"),
        ("wrong_type", "#/strategy/stepover_mm"),
        ("wrong_type", "#/tool/diameter_mm"),
    ];
    assert_eq!(found, expected.map(|(code, at)| (code.to_owned(), at.to_owned())));
    // The identifier of the request is random digits, which may read "f64" by chance.
    let mut problem = answer.json();
    problem.as_object_mut().expect("an object").remove("request_id");
    let text = problem.to_string();
    for word in ["f64", "u32", "struct", "enum", "variant", "line 1"] {
        assert!(!text.contains(word), "the answer holds the word {word}: {text}");
    }
}

#[tokio::test]
async fn a_field_that_cannot_be_decoded_causes_exactly_one_violation() {
    for (pointer, value) in [
        ("/surface/kind", json!("hill")),
        ("/surface", json!("hill")),
        ("/tool/shape", json!("round")),
        ("/strategy/kind", json!(7)),
        ("/program", json!({ "decimals": 1.5 })),
    ] {
        let answer = mill(with(pointer, value)).await;
        let found = answer.violations();
        assert_eq!(found.len(), 1, "{pointer}: not one violation: {found:?}");
    }
}

#[tokio::test]
async fn a_whole_number_may_be_written_with_a_decimal_point() {
    for number in [7.0, 12.0] {
        let mut body: Value = serde_json::from_str(ONE_PASS).expect("JSON");
        body["program"] = json!({ "number": 3, "decimals": 3 });
        body["tool"]["number"] = json!(number);
        let text = body.to_string();
        assert!(text.contains(&format!("{number:.1}")), "{text}");
        assert_eq!(mill(text).await.status, 200);
    }
    assert_eq!(mill(with("/tool/number", json!(7.5))).await.status, 422);
}

#[tokio::test]
async fn a_member_that_is_null_counts_as_absent_everywhere() {
    for (pointer, missing) in [
        ("/program", None),
        ("/program/units", None),
        ("/engine", None),
        ("/stock", None),
        ("/meta", None),
        ("/surface/twist", None),
        ("/surface/end_tangents", None),
        ("/strategy/trim", None),
        ("/tool/number", None),
        ("/cutting/coolant", None),
        ("/tool", Some("#/tool")),
        ("/tolerance_mm", Some("#/tolerance_mm")),
        ("/surface/kind", Some("#/surface/kind")),
        ("/strategy/stepover_mm", Some("#/strategy/stepover_mm")),
    ] {
        let mut body: Value = serde_json::from_str(ONE_PASS).expect("JSON");
        body["program"] = json!({});
        let (parent, name) = pointer.rsplit_once('/').expect("a pointer");
        body.pointer_mut(parent).expect("a parent")[name] = Value::Null;
        let answer = mill(body.to_string()).await;
        match missing {
            None => assert_eq!(answer.status, 200, "{pointer}: {}", answer.text()),
            Some(at) => assert_eq!(answer.violations(), [("missing_field".to_owned(), at.to_owned())]),
        }
    }
    let unknown = mill(with("/tolerence_mm", Value::Null)).await;
    assert_eq!(unknown.violations(), [("unknown_field".to_owned(), "#/tolerence_mm".to_owned())]);
}

#[tokio::test]
async fn thousands_of_wrong_values_are_counted_and_a_hundred_listed() {
    let row = vec![json!(["x", "y", "z"]); 100];
    let answer = mill(with("/surface/points", json!(vec![row; 100]))).await;
    assert_eq!(answer.violations().len(), 100);
    let detail = answer.problem()["detail"].as_str().unwrap_or_default().to_owned();
    assert_eq!(detail, "30000 violations; the first at #/surface/points/0/0/0");
}

#[tokio::test]
async fn the_error_names_utf_16_byte_order_marks_csv_nan_and_infinity() {
    let utf16: Vec<u8> = ONE_PASS.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let with_mark = [&[0xef, 0xbb, 0xbf], ONE_PASS.as_bytes()].concat();
    for (body, word) in [
        (utf16, "UTF-16"),
        (with_mark, "byte order mark"),
        (b"x,y,z\n1,2,3\n4,5,6\n".to_vec(), "comma-separated"),
        (b"1;2;3\n4;5;6\n".to_vec(), "comma-separated"),
        (ONE_PASS.replace("0.01", "NaN").into_bytes(), "NaN"),
        (ONE_PASS.replace("0.01", "-Infinity").into_bytes(), "Infinity"),
    ] {
        let answer = mill(body).await;
        assert_eq!((answer.status.as_u16(), answer.code().as_str()), (400, "malformed_json"));
        assert!(answer.text().contains(word), "the error does not name {word}: {}", answer.text());
    }
}

/// The service refuses such a grid before it computes anything.
#[tokio::test]
async fn a_grid_that_cannot_be_a_part_is_refused_with_a_pointer_to_its_first_fault() {
    let grid = || -> Vec<Vec<Value>> {
        (0..6).map(|i| (0..7).map(|j| json!([10 * i, 8 * j, (i * j) % 5])).collect()).collect()
    };
    let mut row = grid();
    row[3] = row[2].clone();
    let mut column = grid();
    column.iter_mut().for_each(|row| row[4] = row[3].clone());
    let moved = |place: [usize; 2], to: [i32; 3]| {
        let mut points = grid();
        points[place[0]][place[1]] = json!(to);
        points
    };
    let tiny = |scale: f64| -> Vec<Vec<Value>> {
        (0..6).map(|i| (0..7).map(|j| json!([scale * i as f64, scale * j as f64, 0])).collect()).collect()
    };
    for (points, code, pointer) in [
        (moved([2, 3], [20, 24, 300]), "outlier", "#/surface/points/2/3"),
        (moved([2, 3], [20, 24, -3000]), "outlier", "#/surface/points/2/3"),
        (moved([5, 6], [9000, 9000, 0]), "outlier", "#/surface/points/5/6"),
        (moved([0, 2], [-700, 16, 0]), "outlier", "#/surface/points/0/2"),
        (tiny(0.01), "out_of_range", "#/surface"),
        (vec![vec![json!([1, 2, 3]); 4]; 4], "coincident", "#/surface/points"),
        (row, "coincident", "#/surface/points/3"),
        (column, "coincident", "#/surface/points/0/4"),
    ] {
        let answer = mill(with("/surface/points", json!(points))).await;
        assert_eq!(answer.status, 422, "{}", answer.text());
        assert_eq!(answer.violations(), [(code.to_owned(), pointer.to_owned())]);
    }
    assert_eq!(mill(with("/surface/points", json!(grid()))).await.status, 200);
    let mut meant: Value =
        serde_json::from_str(&with("/surface/points", json!(moved([2, 3], [20, 24, 60])))).unwrap();
    assert_eq!(mill(meant.to_string()).await.violations()[0].0, "outlier");
    meant["surface"]["outliers"] = json!("accept");
    assert_eq!(mill(meant.to_string()).await.status, 200);
    let small = mill(with("/surface/points", json!(tiny(0.8)))).await;
    assert!(small.header("toolpathd-warnings").contains("part_smaller_than_cutter"), "{}", small.text());
}

#[tokio::test]
async fn the_answer_to_a_wrong_path_or_method_names_the_right_ones() {
    let app = app(&["--workers", "1"]);
    let nothing = get(&app, "/v1/nothing").await;
    assert_eq!((nothing.status.as_u16(), nothing.code().as_str()), (404, "not_found"));
    assert!(nothing.text().contains("/v1/surfaces/mill"), "{}", nothing.text());
    let wrong = get(&app, MILL).await;
    assert_eq!((wrong.status.as_u16(), wrong.code().as_str()), (405, "method_not_allowed"));
    assert!(wrong.text().contains("does not answer GET, but POST"), "{}", wrong.text());
    let wrong = get(&app, "/v1/arcs/fit").await;
    assert!(wrong.text().contains("POST") && wrong.text().contains("PUT"), "{}", wrong.text());
}
