//! Tests of fitting arcs to polylines in JSON, and to NC programs that are sent as streams.

use std::io::{ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::sync::Arc;
use std::time::Duration;

use axum::body::{Body, to_bytes};
use axum::http::Request;
use axum::response::Response;
use flate2::Compression;
use flate2::read::GzDecoder;
use flate2::write::GzEncoder;
use futures_util::stream::{iter, unfold};
use nalgebra::Point3;
use serde_json::{Value, json};
use tokio::sync::mpsc;
use toolpathd_server::http::{App, router};
use tower::ServiceExt;

use super::support::{Answer, Server, app, aside, connect, post, send, write};

const FIT: &str = "/v1/arcs/fit";
const SINE: &str = include_str!("../../../openapi/examples/arcs-fit/sine.json");
const PROBED_CIRCLE: &str = include_str!("../../../openapi/examples/arcs-fit/probed-circle.json");

const EXAMPLES: [(&str, &str); 5] = [
    ("contour", include_str!("../../../openapi/examples/arcs-fit/contour.json")),
    ("helix", include_str!("../../../openapi/examples/arcs-fit/helix.json")),
    ("probed-circle", PROBED_CIRCLE),
    ("section", include_str!("../../../openapi/examples/arcs-fit/section.json")),
    ("sine", SINE),
];

/// The example with these members added or replaced.
fn with(example: &str, members: Value) -> String {
    let mut body: Value = serde_json::from_str(example).expect("JSON");
    for (name, value) in members.as_object().expect("an object") {
        body[name.as_str()] = value.clone();
    }
    body.to_string()
}

fn point(value: &Value) -> Point3<f64> {
    let coordinate = |k: usize| value[k].as_f64().unwrap_or_default();
    Point3::new(coordinate(0), coordinate(1), coordinate(2))
}

/// The cutting moves, each with the place where it starts.
fn cuts(answer: &Value) -> Vec<(Point3<f64>, &Value)> {
    let mut at = point(&answer["toolpath"]["start"]);
    let passes = answer["toolpath"]["passes"].as_array().expect("passes");
    let mut cuts = Vec::new();
    for step in passes.iter().flat_map(|pass| pass["moves"].as_array().expect("moves")) {
        if step["role"] == "cut" {
            cuts.push((at, step));
        }
        at = point(&step["to"]);
    }
    cuts
}

#[track_caller]
fn assert_refused(answer: &Answer, status: u16, code: &str) {
    assert_eq!((answer.status.as_u16(), answer.code().as_str()), (status, code));
}

#[tokio::test]
async fn every_example_becomes_one_chain_of_arcs_and_lines_within_its_tolerance() {
    let app = app(&["--workers", "1"]);
    for (name, text) in EXAMPLES {
        let body: Value = serde_json::from_str(text).expect("JSON");
        let answer = post(&app, FIT, text, &[]).await.json();
        let (report, cuts) = (&answer["report"], cuts(&answer));
        let has_gap = cuts.windows(2).any(|pair| point(&pair[0].1["to"]) != pair[1].0);
        assert!(!has_gap, "{name}: the chain has a gap");
        for kind in ["arc", "line"] {
            let count = cuts.iter().filter(|(_, step)| step["kind"] == kind).count();
            assert_eq!(report[format!("n_{kind}s")], count, "{name}: the number of moves of kind {kind}");
        }
        assert!(
            cuts.iter().all(|(_, step)| step["kind"] == "arc" || step["kind"] == "line"),
            "{name}: a cut is neither arc nor line"
        );
        let tolerance = body["tolerance_mm"].as_f64().expect("a tolerance");
        assert!(
            report["deviation_max_mm"].as_f64().is_some_and(|mm| mm <= tolerance),
            "{name}: outside the tolerance: {report}"
        );
        let polyline = body["polyline"].as_array().expect("points");
        assert_eq!(report["n_points"], polyline.len(), "{name}: the number of points");
        let last = if body["closed"] == true { 0 } else { polyline.len() - 1 };
        let ends = [cuts[0].0, point(&cuts[cuts.len() - 1].1["to"])];
        for (reached, wanted) in ends.iter().zip([&polyline[0], &polyline[last]]) {
            assert!(
                (reached - point(wanted)).norm() <= tolerance + 1e-9,
                "{name}: the chain is at {reached} instead of {wanted}"
            );
        }
    }
}

#[tokio::test]
async fn closed_points_on_a_circle_become_one_full_circle_and_open_points_do_not() {
    let app = app(&["--workers", "1"]);
    let closed = post(&app, FIT, PROBED_CIRCLE, &[]).await.json();
    let closed = cuts(&closed);
    let [(start, turn)] = closed.as_slice() else { panic!("not one move: {closed:?}") };
    assert_eq!((&turn["kind"], point(&turn["to"])), (&json!("arc"), *start));
    // The points are within 0.0022 mm of the circle of radius 20 about the origin.
    let center = point(&turn["center"]);
    assert!(
        center.coords.norm() < 0.003 && ((start - center).norm() - 20.0).abs() < 0.003,
        "another circle: {turn}"
    );
    let open = post(&app, FIT, with(PROBED_CIRCLE, json!({ "closed": false })), &[]).await.json();
    assert!(cuts(&open).len() > 1, "open points became one move: {open}");
}

#[tokio::test]
async fn a_fit_without_options_equals_the_fit_with_the_documented_defaults() {
    let app = app(&["--workers", "1"]);
    let answer =
        async |members: Value| post(&app, FIT, with(SINE, members), &[("x-request-id", "one")]).await.json();
    let plain = answer(json!({})).await;
    let defaults = json!({
        "method": "optimal", "continuity": "position", "measure": "points", "joints": "free", "closed": false,
        "plane": null,
    });
    assert_eq!(answer(defaults).await, plain);
    for (name, other) in [("method", "biarc"), ("continuity", "tangent"), ("measure", "polyline")] {
        assert_ne!(answer(json!({ name: other })).await, plain, "{name} has no effect");
    }
    assert_eq!(answer(json!({ "continuity": "tangent" })).await["report"]["n_kinks"], 0);
    let unfed = answer(json!({ "cutting": null })).await;
    assert_eq!(unfed["report"].get("cutting_time_s"), None);
    assert_eq!(unfed["toolpath"]["passes"][0]["moves"][0]["role"], "cut");
}

#[tokio::test]
async fn every_violation_in_a_fit_has_its_code_and_points_to_its_place() {
    let app = app(&["--workers", "1", "--max-curve-points", "200"]);
    let many: Vec<_> = (0..201).map(|k| [k, k % 3]).collect();
    for (members, code, pointer) in [
        (json!({ "polyline": [[1, 2]] }), "too_few_points", "#/polyline"),
        (json!({ "polyline": [[1, 2], [1, 2], [1, 2]] }), "coincident", "#/polyline"),
        (json!({ "polyline": [[0, 0], [1, 1], [2, 2, 2], [3, 3]] }), "wrong_length", "#/polyline/2"),
        (json!({ "polyline": [[0], [1, 1]] }), "wrong_length", "#/polyline/0"),
        (json!({ "polyline": [[0, 0], [1, 2e6]] }), "too_large", "#/polyline/1/1"),
        (json!({ "polyline": [[0, 0], [1, 1]], "closed": true }), "too_few_points", "#/polyline"),
        (json!({ "polyline": many }), "limit_exceeded", "#/polyline"),
        (json!({ "plane": "zx" }), "conflict", "#/plane"),
        (json!({ "tolerance_mm": 0 }), "out_of_range", "#/tolerance_mm"),
        (json!({ "tolerance_mm": 1e-7 }), "out_of_range", "#/tolerance_mm"),
        (json!({ "tolerance_mm": 11 }), "out_of_range", "#/tolerance_mm"),
        (json!({ "method": "fastest" }), "unknown_value", "#/method"),
        (json!({ "tolerance": 1 }), "unknown_field", "#/tolerance"),
    ] {
        let answer = post(&app, FIT, with(SINE, members), &[]).await;
        assert_refused(&answer, 422, "invalid_request");
        assert_eq!(answer.violations(), [(code.to_owned(), pointer.to_owned())]);
    }
    let unfed = with(SINE, json!({ "cutting": null }));
    let answer = post(&app, &format!("{FIT}?format=gcode"), unfed, &[]).await;
    assert_refused(&answer, 422, "feed_required");
    assert_eq!(answer.violations(), [("feed_required".to_owned(), "#/cutting".to_owned())]);
}

#[tokio::test]
async fn likely_mistakes_in_a_fit_cause_warnings() {
    let app = app(&["--workers", "1"]);
    let angle = |k: u32| (15.0 * f64::from(k)).to_radians();
    let coarse: Vec<_> = (0..7).map(|k| [10.0 * angle(k).cos(), 10.0 * angle(k).sin()]).collect();
    let quarter = |method: &str, measure: &str| {
        json!({ "polyline": coarse, "tolerance_mm": 0.001, "measure": measure, "method": method }).to_string()
    };
    for (body, expected) in [
        (SINE.to_owned(), &[][..]),
        (with(SINE, json!({ "tolerance_mm": 1e-5 })), &["rounding_exceeds_tolerance", "coarse_samples"]),
        (with(SINE, json!({ "tolerance_mm": 1e-5, "program": { "decimals": 6 } })), &["coarse_samples"]),
        (quarter("optimal", "points"), &["coarse_samples"]),
        (quarter("optimal", "polyline"), &[]),
        (quarter("biarc", "polyline"), &["tolerance_exceeded"]),
    ] {
        let warnings = post(&app, FIT, body.clone(), &[]).await.json()["warnings"].clone();
        let codes =
            warnings.as_array().expect("warnings").iter().map(|w| w["code"].as_str().expect("a code"));
        // These warnings are about the program, not about the fit.
        let codes: Vec<_> =
            codes.filter(|code| !["no_tool_number", "no_work_offset"].contains(code)).collect();
        assert_eq!(codes, expected, "{body}");
    }
}

const QUERY: &str = "tolerance_mm=0.005";
const CODED: (&str, &str) = ("content-encoding", "gzip");
const FIGURES: (&str, &str) = ("accept", "application/json");

/// The blocks before a run of lines, which begins at X20 Y0. One byte is not ASCII.
const BEFORE: &[u8] =
    b"%\n(PART 7, \xe9)\r\nG17 G21 G90 G94\nT1 M6\nG0 X20. Y0. Z5.\nM3 S8000\nG1 Z0 F300 (MSG, down)\n";

/// The blocks after the run.
const BEHIND: &[u8] = b"G0 Z50. (up)\n\n/M8\n  G28 Z0\nM30\n%";

/// The blocks before a run in programs that are sent in pieces.
const HEAD: &str = "G17 G21 G90 G94\nG0 X20 Y0 Z5\nG1 Z0 F300 (MSG, down)\n";

/// More comments than the service searches for jumps before it answers.
fn lead() -> String {
    "(A COMMENT OF FORTY CHARACTERS, ALL IN ALL)\n".repeat(7000)
}

/// A run of 400 blocks on a circle of 20 mm radius about the origin, through 4 radians.
fn run() -> String {
    let block = |k: u32| {
        let (sin, cos) = (0.01 * f64::from(k)).sin_cos();
        format!("N{} X{:.3} Y{:.3}\n", 10 * k, 20.0 * cos, 20.0 * sin)
    };
    (1..=400).map(block).collect()
}

/// The arc that replaces the run. It ends at 20 cos 4, 20 sin 4 and has the number of the first block.
const ARC: &str = "N10 G3 X-13.073 Y-15.136 I-20.000 J0.000\n";

fn program() -> Vec<u8> {
    [BEFORE, run().as_bytes(), BEHIND].concat()
}

fn fitted() -> Vec<u8> {
    [BEFORE, ARC.as_bytes(), BEHIND].concat()
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes).expect("memory");
    encoder.finish().expect("memory")
}

/// Sends a program and returns its answer unread. The content type is that of NC text, unless a header is
/// given.
async fn begin(app: &Arc<App>, query: &str, body: impl Into<Body>, headers: &[(&str, &str)]) -> Response {
    let builder = Request::post(format!("{FIT}?{query}"));
    let headers = headers.iter().chain(&[("content-type", "text/x-gcode")]);
    let builder = headers.fold(builder, |builder, (name, value)| builder.header(*name, *value));
    let request = builder.body(body.into()).expect("a request");
    router(app).oneshot(request).await.expect("infallible")
}

async fn rewrite(app: &Arc<App>, query: &str, body: impl Into<Body>, headers: &[(&str, &str)]) -> Answer {
    let (parts, body) = begin(app, query, body, headers).await.into_parts();
    let body = to_bytes(body, usize::MAX).await.expect("a whole body").to_vec();
    Answer { status: parts.status, headers: parts.headers, body }
}

#[tokio::test]
async fn rewriting_a_program_changes_no_byte_outside_a_run_of_lines() {
    let app = app(&["--workers", "1"]);
    for content_type in ["text/x-gcode", "Text/Plain; charset=utf-8", "application/x-gcode"] {
        for (query, file_name) in [
            (QUERY, "arcs.ngc"),
            ("tolerance_mm=0.005&dialect=linuxcnc&method=greedy", "arcs.ngc"),
            ("tolerance_mm=0.005&dialect=fanuc&continuity=tangent", "arcs.nc"),
        ] {
            let answer = rewrite(&app, query, program(), &[("content-type", content_type)]).await;
            assert_eq!(answer.header("content-type"), "text/x-gcode; charset=us-ascii");
            let disposition = format!("attachment; filename=\"{file_name}\"");
            assert_eq!(answer.header("content-disposition"), disposition);
            assert!(
                answer.body == fitted(),
                "{content_type} {query}: the program was not rewritten as expected"
            );
        }
    }
    let plain = rewrite(&app, QUERY, program(), &[("accept", "text/plain")]).await;
    assert_eq!(plain.header("content-type"), "text/plain; charset=us-ascii");
    let coded = rewrite(&app, QUERY, program(), &[("accept-encoding", "gzip")]).await;
    assert_eq!(coded.header("content-encoding"), "gzip");
    let mut decoded = Vec::new();
    GzDecoder::new(coded.body.as_slice()).read_to_end(&mut decoded).expect("gzip");
    assert!(plain.body == fitted() && decoded == fitted(), "another format changes the program");
}

#[tokio::test]
async fn accepting_json_gives_the_report_of_a_program_without_its_text() {
    let app = app(&["--workers", "1"]);
    let answer = rewrite(&app, QUERY, program(), &[FIGURES]).await.json();
    let mut report = answer["report"].clone();
    // The middle of each line is 0.00025 mm inside the circle.
    let deviation = report["deviation_max_mm"].take().as_f64().expect("a figure");
    assert!((0.000_25..=0.005).contains(&deviation), "the deviation is {deviation}");
    let expected = json!({
        "n_runs": 1, "n_points": 400, "n_arcs": 1, "n_lines": 0, "deviation_max_mm": null,
        "n_motions": 404, "n_other_motions": 3, "left_alone": {
            "macros": 0, "other_axes": 0, "modes": 0, "labels": 0, "others": 1, "short_runs": 0,
        },
        "bytes_in": program().len(), "bytes_out": fitted().len(),
    });
    assert_eq!(report, expected);
    assert!(
        answer.get("toolpath").is_none() && answer.get("measures").is_none(),
        "the answer holds a toolpath or measures: {answer}"
    );
    let by_query = rewrite(&app, &format!("{QUERY}&format=json"), program(), &[]).await.json();
    assert_eq!((&by_query["report"], &by_query["warnings"]), (&answer["report"], &json!([])));
}

#[tokio::test]
async fn a_program_that_cannot_be_rewritten_is_refused_with_the_code_of_its_fault() {
    let small = ["--workers", "1", "--stream-bytes", "1000"];
    let (app, small) = (app(&["--workers", "1"]), app(&small));
    let svg = rewrite(&app, QUERY, program(), &[("accept", "image/svg+xml")]).await;
    assert_refused(&svg, 406, "not_acceptable");
    let svg = rewrite(&app, &format!("{QUERY}&format=svg"), program(), &[]).await;
    assert_refused(&svg, 406, "not_acceptable");
    let wrong = "dialect=linuxcnc|tolerance_mm=0|tolerance_mm=nan|tolerance_mm=1&dialect=unheard|\
        tolerance_mm=1&method=biarc|tolerance_mm=1&toolpath=false";
    for query in wrong.split('|') {
        assert_refused(&rewrite(&app, query, program(), &[]).await, 400, "invalid_query");
    }
    let long = format!("({})\n{HEAD}", "x".repeat(100_000));
    for plain in [&[][..], &[FIGURES]] {
        let coded = [plain, &[CODED]].concat();
        assert_refused(&rewrite(&app, QUERY, "", plain).await, 400, "bad_request");
        assert_refused(&rewrite(&app, QUERY, gzip(b""), &coded).await, 400, "bad_request");
        // Nothing can be decoded from the first 12 bytes.
        assert_refused(
            &rewrite(&app, QUERY, gzip(&program())[..12].to_vec(), &coded).await,
            400,
            "bad_request",
        );
        assert_refused(&rewrite(&app, QUERY, long.clone(), plain).await, 422, "limit_exceeded");
        assert_refused(&rewrite(&small, QUERY, program(), plain).await, 413, "payload_too_large");
        assert_refused(&rewrite(&small, QUERY, gzip(&program()), &coded).await, 413, "payload_too_large");
    }
}

fn in_pieces(bytes: &[u8], size: usize) -> Body {
    let pieces = bytes.chunks(size).map(|piece| Ok::<_, std::io::Error>(piece.to_vec()));
    Body::from_stream(iter(pieces.collect::<Vec<_>>()))
}

#[tokio::test]
async fn compression_and_chunks_do_not_change_a_rewritten_program() {
    let app = app(&["--workers", "1"]);
    let coded = gzip(&program());
    for size in [7, 1000, usize::MAX] {
        assert!(rewrite(&app, QUERY, in_pieces(&program(), size), &[]).await.body == fitted(), "{size}");
        assert!(rewrite(&app, QUERY, in_pieces(&coded, size), &[CODED]).await.body == fitted(), "{size}");
    }
    // A truncated body is refused if the answer has not begun. Otherwise the answer breaks off.
    for end in [coded.len() / 2, coded.len() - 1] {
        for headers in [[CODED, FIGURES].as_slice(), &[CODED]] {
            let answer = rewrite(&app, QUERY, coded[..end].to_vec(), headers).await;
            assert_refused(&answer, 400, "bad_request");
        }
    }
    let long = gzip(&[lead().as_bytes(), &program()].concat());
    let begun = begin(&app, QUERY, long[..long.len() - 1].to_vec(), &[CODED]).await;
    assert_eq!(begun.status(), 200);
    assert!(to_bytes(begun.into_body(), usize::MAX).await.is_err(), "the answer does not break off");
}

#[tokio::test]
async fn streams_above_the_limit_are_refused_until_a_stream_ends() {
    let app = app(&["--workers", "1", "--streams", "1"]);
    let (sender, receiver) = mpsc::channel::<Vec<u8>>(1);
    let pieces = unfold(receiver, async |mut receiver: mpsc::Receiver<Vec<u8>>| {
        let piece = receiver.recv().await?;
        Some((Ok::<_, std::io::Error>(piece), receiver))
    });
    let head = lead() + HEAD;
    sender.send(head.clone().into()).await.expect("the channel has room");
    let first = begin(&app, QUERY, Body::from_stream(pieces), &[]).await;
    let second = rewrite(&app, QUERY, HEAD, &[]).await;
    assert_refused(&second, 503, "overloaded");
    assert!(second.header("retry-after").parse::<u32>().is_ok());
    assert_eq!(post(&app, FIT, SINE, &[]).await.status, 200);
    drop(sender);
    assert_eq!(to_bytes(first.into_body(), usize::MAX).await.expect("a whole body"), head);
    let third = async {
        while rewrite(&app, QUERY, HEAD, &[]).await.status != 200 {
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
    };
    assert!(
        tokio::time::timeout(Duration::from_secs(30), third).await.is_ok(),
        "the third stream is refused"
    );
}

/// Connects and sends the head of a request whose body will come in chunks.
fn upload(address: SocketAddr) -> TcpStream {
    let mut stream = connect(address);
    let head = "Host: here\r\nContent-Type: text/x-gcode\r\nTransfer-Encoding: chunked";
    write(&mut stream, &format!("POST {FIT}?{QUERY} HTTP/1.1\r\n{head}\r\n\r\n"));
    stream
}

fn chunk(text: &str) -> String {
    format!("{:x}\r\n{text}\r\n", text.len())
}

const LAST_CHUNK: &str = "\r\n0\r\n\r\n";

/// Reads until `mark` has come. Returns `false` if the connection ends first.
fn read_to(mark: &str, stream: &mut TcpStream, text: &mut String) -> bool {
    let mut buffer = [0; 4096];
    while !text.contains(mark) {
        match stream.read(&mut buffer) {
            Ok(0) => return false,
            Ok(count) => text.push_str(&String::from_utf8_lossy(&buffer[..count])),
            Err(error) => {
                assert!(
                    ![ErrorKind::WouldBlock, ErrorKind::TimedOut].contains(&error.kind()),
                    "{mark:?} did not come in time: {text}"
                );
                return false;
            }
        }
    }
    true
}

#[tokio::test(flavor = "multi_thread")]
async fn finished_blocks_are_sent_back_during_the_upload_and_a_fault_breaks_the_answer_off() {
    let app = app(&["--workers", "1"]);
    let server = Server::start(&app).await;
    let address = server.address;
    let [first, second] = [format!("{}{HEAD}{}G0 Z5\n", lead(), run()), format!("{HEAD}{}M30\n", run())];
    let whole = rewrite(&app, QUERY, format!("{first}{second}"), &[]).await.text();
    let answer = aside(move || {
        let (mut stream, mut text) = (upload(address), String::new());
        write(&mut stream, &chunk(&first));
        assert!(read_to(ARC, &mut stream, &mut text), "the arc did not come: {text}");
        write(&mut stream, &format!("{}0\r\n\r\n", chunk(&second)));
        assert!(read_to(LAST_CHUNK, &mut stream, &mut text), "the answer does not end: {text}");
        text
    })
    .await;
    let (head, mut rest) = answer.split_once("\r\n\r\n").expect("a head");
    assert!(head.starts_with("HTTP/1.1 200 OK"), "{head}");
    let mut body = String::new();
    while let Some((size, data)) = rest.split_once("\r\n") {
        let (piece, behind) = data.split_at(usize::from_str_radix(size, 16).expect("a size"));
        body.push_str(piece);
        rest = &behind[2..];
    }
    assert_eq!(body, whole);
    aside(move || {
        let (mut stream, mut text) = (upload(address), String::new());
        write(&mut stream, &chunk(&(lead() + HEAD)));
        assert!(read_to("(MSG, down)\n", &mut stream, &mut text), "{text}");
        // The service need not read a refused program to its end, so that writing may fail.
        let _ = stream.write_all(format!("{}0\r\n\r\n", chunk(&"x".repeat(100_000))).as_bytes());
        assert!(!read_to(LAST_CHUNK, &mut stream, &mut text), "the answer does not break off: {text}");
        assert!(text.starts_with("HTTP/1.1 200 OK"), "{text}");
    })
    .await;
    server.stop().await;
}

/// A control takes the radius of such arcs for zero. They were once written as arcs.
#[tokio::test]
async fn tiny_arcs_are_written_as_lines() {
    let points: Vec<_> =
        (0..=12).map(|k| 0.5 * f64::from(k)).map(|a| [1e-3 * a.cos(), 1e-3 * a.sin()]).collect();
    let body = json!({
        "polyline": points, "tolerance_mm": 1e-5, "program": { "decimals": 5 }, "cutting": { "feed_mm_per_min": 100 },
    });
    let answer = post(&app(&["--workers", "1"]), &format!("{FIT}?format=gcode"), body.to_string(), &[]).await;
    assert_eq!(answer.status, 200, "{}", answer.text());
    let blocks = answer.text().lines().filter(|line| !line.starts_with('(')).collect::<Vec<_>>().join("\n");
    assert!(
        !blocks.contains("G2 ") && !blocks.contains("G3 ") && blocks.contains("G1 "),
        "not only lines: {blocks}"
    );
}

#[tokio::test]
async fn a_program_is_recognised_by_its_first_bytes_and_may_be_sent_by_put() {
    let app = app(&["--workers", "1"]);
    let path = format!("{FIT}?{QUERY}");
    for program in ["%\nO1\nG21 G90\nG1 X1 F100\n", "(part)\nG0 X0\n", "N10 G0 X5\n", "g1 x5 f100\n"] {
        let form = [("content-type", "application/x-www-form-urlencoded")];
        let answer = rewrite(&app, QUERY, program, &form).await;
        assert_eq!((answer.status.as_u16(), answer.text().as_str()), (200, program));
        let put = Request::put(&path).body(Body::from(program)).expect("a request");
        assert_eq!(send(&app, put).await.text(), program);
    }
    for text in ["%\n(nothing)\n%\n", "; only words\n", "M3 S100\nM30\n"] {
        let answer = rewrite(&app, QUERY, text, &[]).await;
        assert_eq!((answer.status.as_u16(), answer.code().as_str()), (422, "no_motion"), "{text}");
    }
    let text = "G21 G90 G17\nG1 X1 F100\nX2 A3\nX#1\nG41 D1\nG1 X3\nG1 X4\nG40\n";
    let report = rewrite(&app, QUERY, text, &[FIGURES]).await.json()["report"].clone();
    let left_alone =
        json!({ "macros": 1, "other_axes": 1, "modes": 2, "labels": 0, "others": 1, "short_runs": 0 });
    assert_eq!(report["left_alone"], left_alone, "{report}");
}

/// A spline through points near the limit of a kilometre goes beyond the limit.
#[tokio::test]
async fn curves_that_leave_the_range_of_coordinates_are_refused() {
    let body = json!({
        "curve": { "kind": "points", "points": [[-999_999, 0], [0, 500_000], [999_999, 0], [999_000, -9_000], [0, 0]] },
        "method": "arc", "band": { "below_mm": 5, "above_mm": 5 },
    });
    let answer = post(&app(&["--workers", "1"]), "/v1/curves/interpolate", body.to_string(), &[]).await;
    assert_eq!(
        (answer.status.as_u16(), answer.code().as_str()),
        (422, "limit_exceeded"),
        "{}",
        answer.text()
    );
}
