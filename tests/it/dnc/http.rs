//! Sending over HTTP to controls that the configuration names.

use std::io::Read;
use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::body::Body;
use axum::http::Request;
use serde_json::{Value, json};
use toolpathd_server::http::App;

use super::mock::{Control, Habits, program, tape};
use crate::api::support::{self, Answer, Server, aside, connect, get, read_answer, send, write};

/// A service that sends to `control` under the name `lathe`.
fn app(control: &Control, list: &str) -> Arc<App> {
    let target = format!("lathe=serial:{},{list}", control.path);
    support::app(&["--workers", "1", "--dnc-target", &target])
}

async fn post(app: &Arc<App>, path: &str, body: impl Into<Body>, headers: &[(&str, &str)]) -> Answer {
    let builder =
        headers.iter().fold(Request::post(path), |builder, (name, value)| builder.header(*name, *value));
    send(app, builder.body(body.into()).expect("a request")).await
}

const NC: [(&str, &str); 1] = [("content-type", "text/x-gcode")];
const EVENTS: [(&str, &str); 2] = [("content-type", "text/plain"), ("accept", "text/event-stream")];

/// Waits until the control named `lathe` is busy, or free.
async fn until_busy_is(app: &Arc<App>, is_busy: bool) {
    let limit = Instant::now() + Duration::from_secs(10);
    while get(app, "/v1/dnc").await.json()["targets"][0]["is_busy"] != is_busy {
        assert!(Instant::now() < limit, "is_busy does not become {is_busy}");
        tokio::time::sleep(Duration::from_millis(5)).await;
    }
}

/// Checks that `received` is whole blocks of `program` between the marks, and returns their number.
fn n_whole_blocks(received: &[u8], program: &[u8]) -> usize {
    let lines: Vec<&[u8]> = received.split_inclusive(|byte| *byte == b'\n').collect();
    let [b"%\n", blocks @ .., b"%\n"] = lines.as_slice() else { panic!("the marks are missing") };
    assert!(program.starts_with(&blocks.concat()), "half a block was sent");
    blocks.len()
}

#[tokio::test(flavor = "multi_thread")]
async fn a_program_is_sent_and_the_report_comes_as_json_or_as_the_last_event() {
    let control = Control::start(Habits { rate: 1200.0, ..Habits::STEADY });
    let app = app(&control, "baud=19200,format=7e2,leader=0");
    let program = program(40);
    let answer = post(&app, "/v1/dnc/lathe", program.clone(), &NC).await;
    let report = answer.json();
    let n_characters = tape(0, &program).len();
    assert_eq!((answer.status.as_u16(), &report["target"]), (200, &json!("lathe")));
    assert_eq!((&report["n_lines"], &report["n_characters"]), (&json!(40), &json!(n_characters)));
    assert_eq!(report["arrival"], "transmitted");

    let answer = post(&app, "/v1/dnc/lathe", program.clone(), &EVENTS).await;
    assert_eq!(answer.header("content-type"), "text/event-stream");
    let text = answer.text();
    let events: Vec<(&str, Value)> = text
        .split_terminator("\n\n")
        .filter_map(|event| event.strip_prefix("event: ")?.split_once("\ndata: "))
        .map(|(name, data)| (name, serde_json::from_str(data).expect("JSON")))
        .collect();
    let (last, progress) = events.split_last().expect("events");
    assert_eq!((last.0, &last.1["n_lines"]), ("result", &json!(40)));
    assert!(progress.len() > 3 && progress.iter().all(|(name, _)| *name == "progress"), "{text}");
    assert!(progress.iter().any(|(_, data)| data["stage"] == "waiting"), "{text}");
    assert_eq!((&progress[0].1["stage"], &progress[0].1["total"]), (&json!("sending"), &json!(n_characters)));
    assert_eq!(control.end().received, tape(0, &program).repeat(2));
}

#[tokio::test(flavor = "multi_thread")]
async fn a_control_takes_one_program_at_a_time() {
    let control = Control::start(Habits { rate: 1e6, ..Habits::STEADY });
    let app = app(&control, "baud=4800,leader=0");
    let program = program(40);
    let first = tokio::spawn({
        let (app, program) = (Arc::clone(&app), program.clone());
        async move { post(&app, "/v1/dnc/lathe", program, &NC).await }
    });
    until_busy_is(&app, true).await;
    let second = post(&app, "/v1/dnc/lathe", "M30\n", &NC).await;
    assert_eq!((second.status.as_u16(), second.code().as_str()), (409, "target_busy"));
    assert_eq!(first.await.expect("no panic").status, 200);
    assert_eq!(post(&app, "/v1/dnc/lathe", "M30\n", &NC).await.status, 200);
    assert_eq!(control.end().received, [tape(0, &program), tape(0, b"M30\n")].concat());
}

#[tokio::test]
async fn what_cannot_be_sent_is_refused_before_the_line_is_opened() {
    let none = support::app(&["--workers", "1"]);
    assert_eq!(get(&none, "/v1/dnc").await.json(), json!({ "targets": [] }));
    let answer = post(&none, "/v1/dnc/lathe", "M30\n", &NC).await;
    let detail = answer.problem()["detail"].as_str().expect("a detail").to_owned();
    assert!(answer.code() == "not_found" && detail.contains("--dnc-target"), "{detail}");

    let target = "lathe=serial:/dev/no-such-port,baud=4800,format=7e1,trailer=3,patience=5;mill=tcp:127.0.0.1:9,flow=grbl";
    let app = support::app(&["--workers", "1", "--body-limit", "1000", "--dnc-target", target]);
    let listed = get(&app, "/v1/dnc").await;
    assert!(
        !listed.text().contains("no-such-port") && !listed.text().contains("127.0.0.1"),
        "addresses are told"
    );
    let targets = &listed.json()["targets"];
    for (member, value) in [
        ("line", json!("serial")),
        ("baud", json!(4800)),
        ("format", json!("7e1")),
        ("flow", json!("xon_xoff")),
        ("leader", json!(50)),
        ("trailer", json!(3)),
        ("patience_s", json!(5.0)),
        ("is_paced", json!(true)),
    ] {
        assert_eq!(targets[0][member], value, "{member}");
    }
    assert_eq!((&targets[1]["line"], &targets[1]["is_paced"]), (&json!("tcp"), &json!(false)));

    let long = "X".repeat(1001);
    for (path, body, status, code) in [
        ("/v1/dnc/drill", "M30\n", 404, "not_found"),
        ("/v1/dnc/lathe", "G0\n(\u{fc})\n", 422, "not_sendable"),
        ("/v1/dnc/lathe", " ", 422, "not_sendable"),
        ("/v1/dnc/mill", "G0 X1 ! Y1\n", 422, "not_sendable"),
        ("/v1/dnc/lathe", &long, 413, "payload_too_large"),
        ("/v1/dnc/lathe?speed=1", "M30\n", 400, "invalid_query"),
        ("/v1/dnc/lathe", "M30\n", 502, "target_unreachable"),
    ] {
        let answer = post(&app, path, body.to_owned(), &NC).await;
        assert_eq!((answer.status.as_u16(), answer.code().as_str()), (status, code), "{path} {body}");
    }
    let umlaut = post(&app, "/v1/dnc/lathe", "G0\n(\u{fc})\n", &EVENTS).await;
    assert!(umlaut.problem()["detail"].as_str().is_some_and(|detail| detail.contains("line 2")));
    let json = post(&app, "/v1/dnc/lathe", "{}", &[("content-type", "application/json")]).await;
    assert_eq!(json.code(), "unsupported_media_type");
    assert_eq!(get(&app, "/v1/dnc/lathe").await.status, 405);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_control_that_goes_away_is_a_problem_that_tells_what_was_sent() {
    let control = Control::start(Habits { vanish: Some(300), ..Habits::STEADY });
    let app = app(&control, "baud=9600,leader=0");
    let answer = post(&app, "/v1/dnc/lathe", program(60), &NC).await;
    let problem = answer.problem();
    assert_eq!((answer.status.as_u16(), &problem["code"]), (502, &json!("sending_stopped")));
    assert_eq!(problem["sent"]["control"], "half_block");
    let n_lines = problem["sent"]["n_lines"].as_u64().expect("a number");
    assert!((5..20).contains(&n_lines), "{problem}");
    assert!(
        problem["detail"].as_str().is_some_and(|detail| detail.contains(&format!("line {}", n_lines + 1)))
    );
}

#[tokio::test]
async fn a_page_of_another_origin_may_not_send() {
    let target = "lathe=serial:/dev/no-such-port";
    let flags = ["--workers", "1", "--dnc-target", target, "--cors-origin", "https://mes.example"];
    let app = support::app(&flags);
    for (origin, code) in [
        ("https://elsewhere.example", "origin_refused"),
        ("null", "origin_refused"),
        ("http://127.0.0.1:9", "origin_refused"),
        ("http://127.0.0.1:8080", "target_unreachable"),
        ("https://mes.example", "target_unreachable"),
    ] {
        let headers = [("content-type", "text/plain"), ("host", "127.0.0.1:8080"), ("origin", origin)];
        assert_eq!(post(&app, "/v1/dnc/lathe", "M30\n", &headers).await.code(), code, "{origin}");
    }
}

/// Begins to send over a socket, and reads until the first progress event if `accept` asks for events.
fn begin(address: std::net::SocketAddr, program: &[u8], accept: &str) -> std::net::TcpStream {
    let mut stream = connect(address);
    let length = program.len();
    let head = format!(
        "POST /v1/dnc/lathe HTTP/1.1\r\nHost: here\r\nAccept: {accept}\r\nContent-Type: text/x-gcode\r\n\
         Content-Length: {length}\r\n\r\n"
    );
    write(&mut stream, &head);
    write(&mut stream, std::str::from_utf8(program).expect("ASCII"));
    if accept == "text/event-stream" {
        let mut text = String::new();
        while !text.contains("event: progress") {
            let mut part = [0; 1024];
            let count = stream.read(&mut part).expect("events");
            text.push_str(std::str::from_utf8(&part[..count]).expect("ASCII"));
        }
    }
    stream
}

#[tokio::test(flavor = "multi_thread")]
async fn a_caller_that_goes_away_stops_the_sending_at_the_end_of_a_block() {
    for accept in ["text/event-stream", "application/json"] {
        let control = Control::start(Habits { rate: 1e6, ..Habits::STEADY });
        let app = app(&control, "baud=4800,leader=0");
        let server = Server::start(&app).await;
        let (address, program) = (server.address, program(500));
        let sent = program.clone();
        let stream = aside(move || begin(address, &sent, accept)).await;
        until_busy_is(&app, true).await;
        tokio::task::block_in_place(|| control.until_received(100));
        drop(stream);
        until_busy_is(&app, false).await;
        let received = control.end().received;
        let n_blocks = n_whole_blocks(&received, &program);
        assert!((1..60).contains(&n_blocks), "{n_blocks} blocks were sent for {accept}");
        server.stop().await;
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_shutdown_stops_the_sending_at_the_end_of_a_block_and_tells_the_caller() {
    let control = Control::start(Habits { rate: 1e6, ..Habits::STEADY });
    let app = app(&control, "baud=4800,leader=0");
    let server = Server::start(&app).await;
    let (address, program) = (server.address, program(500));
    let sent = program.clone();
    let mut stream = aside(move || begin(address, &sent, "application/json")).await;
    until_busy_is(&app, true).await;
    tokio::task::block_in_place(|| control.until_received(100));
    let begun = Instant::now();
    server.stop().await;
    // The rest of the program takes longer, and so does the wait for those who do not end.
    assert!(begun.elapsed() < Duration::from_secs(15), "the shutdown took {:?}", begun.elapsed());
    let answer = aside(move || read_answer(&mut stream)).await.expect("an answer");
    let n_blocks = n_whole_blocks(&control.end().received, &program);
    assert!(
        answer.starts_with("HTTP/1.1 502") && answer.contains("\"code\":\"sending_stopped\""),
        "{answer}"
    );
    let sent = format!("\"n_lines\":{n_blocks},");
    assert!(answer.contains("\"control\":\"blocks_and_end_mark\"") && answer.contains(&sent), "{answer}");
}
