//! Tests of answers as streams of events, through a socket.

use std::io::Read;
use std::net::{SocketAddr, TcpStream};
use std::time::{Duration, Instant};

use serde_json::Value;
use toolpathd_server::http::compute::Failure;

use super::support::{MILL, ONE_PASS, Server, app, connect, post, write};

const DIE: &str = include_str!("../../../openapi/examples/surfaces-mill/die.json");

const ISLAND: &str = include_str!("../../../openapi/examples/pockets-plan/island.json");
const REGIONS: &str = include_str!("../../../openapi/examples/pockets-plan/regions.json");

/// Most tries of what must be quick. A busy machine delays some of them, and what is slow of itself is slow
/// in all.
const TRIES: usize = 5;

/// Longer than any wait on a busy machine.
const NEVER: Duration = Duration::from_secs(20);

/// The example of the die with this stepover.
fn die_at(stepover_mm: f64) -> String {
    let mut body: Value = serde_json::from_str(DIE).expect("JSON");
    body["strategy"]["stepover_mm"] = stepover_mm.into();
    body.to_string()
}

/// Sends a milling request with the id `one` and asks for events.
fn ask(address: SocketAddr, body: &str) -> TcpStream {
    ask_at(address, MILL, body)
}

/// Sends a request with the id `one` and asks for events.
fn ask_at(address: SocketAddr, path: &str, body: &str) -> TcpStream {
    let mut stream = connect(address);
    let head = format!(
        "POST {path} HTTP/1.1\r\nHost: here\r\nX-Request-Id: one\r\nAccept: text/event-stream\r\n\
         Accept-Encoding: gzip\r\nContent-Length: {}\r\n\r\n",
        body.len()
    );
    write(&mut stream, &head);
    write(&mut stream, body);
    stream
}

/// Reads until the text ends with `end`.
fn read_until(stream: &mut TcpStream, end: &str) -> String {
    let mut text = Vec::new();
    let mut buffer = [0; 4096];
    while !text.ends_with(end.as_bytes()) {
        let count = stream.read(&mut buffer).expect("data arrives before the timeout");
        assert!(count > 0, "the connection ended after {}", String::from_utf8_lossy(&text));
        text.extend_from_slice(&buffer[..count]);
    }
    String::from_utf8(text).expect("UTF-8")
}

/// Reads a whole answer: its head, and the name and the data of every event.
fn events(stream: &mut TcpStream) -> (String, Vec<(String, Value)>) {
    let text = read_until(stream, "\r\n0\r\n\r\n");
    let (head, chunks) = text.split_once("\r\n\r\n").expect("a head");
    let mut body = String::new();
    let mut rest = chunks;
    while let Some((size, data)) = rest.split_once("\r\n") {
        let size = usize::from_str_radix(size, 16).expect("a size");
        body.push_str(&data[..size]);
        rest = &data[size + 2..];
    }
    let events = body.split_terminator("\n\n").filter(|block| !block.starts_with(':')).map(|block| {
        let (name, data) = block.split_once('\n').expect("a name and data");
        let data = data.strip_prefix("data: ").expect("data");
        let data = serde_json::from_str(data).expect("JSON on one line");
        (name.strip_prefix("event: ").expect("a name").to_owned(), data)
    });
    (head.to_ascii_lowercase(), events.collect())
}

/// Runs blocking work on sockets in a thread of its own, so that the service can run.
async fn aside<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> T {
    tokio::task::spawn_blocking(work).await.expect("the thread did not panic")
}

#[tokio::test(flavor = "multi_thread")]
async fn progress_events_come_stage_by_stage_and_the_result_comes_last() {
    let app = app(&["--workers", "1"]);
    let server = Server::start(&app).await;
    let address = server.address;
    let body = die_at(0.5);
    let asked = body.clone();
    let (head, events) = aside(move || events(&mut ask(address, &asked))).await;
    assert!(head.starts_with("http/1.1 200 ok\r\n"), "{head}");
    assert!(head.contains("content-type: text/event-stream") && head.contains("x-request-id: one"), "{head}");
    assert!(!head.contains("repr-digest") && !head.contains("content-encoding"), "{head}");

    let (last, progress) = events.split_last().expect("events");
    assert_eq!(last.0, "result");
    let plain = post(&app, MILL, body, &[("x-request-id", "one")]).await.json();
    assert!(last.1 == plain, "the result is not the JSON answer");
    assert_eq!(stages(progress), ["sections", "material left", "certificate"]);
    server.stop().await;
}

/// The stages of progress, each of which comes once and only rises.
fn stages(progress: &[(String, Value)]) -> Vec<&str> {
    let mut stages: Vec<&str> = Vec::new();
    let mut done = 0;
    for (name, data) in progress {
        assert_eq!(name, "progress");
        let stage = data["stage"].as_str().expect("a stage");
        if stages.last() != Some(&stage) {
            assert!(!stages.contains(&stage), "the stage {stage} comes twice");
            stages.push(stage);
            done = 0;
        }
        let (now, total) =
            (data["done"].as_u64().expect("a count"), data["total"].as_u64().expect("a count"));
        assert!((done..=total).contains(&now), "progress goes back or beyond its total: {data}");
        assert_eq!(data["fraction"], now as f64 / total as f64);
        done = now;
    }
    stages
}

#[tokio::test(flavor = "multi_thread")]
async fn pockets_tell_their_patterns_and_several_pockets_their_regions() {
    let app = app(&["--workers", "2"]);
    let server = Server::start(&app).await;
    let address = server.address;
    for (body, stage) in [(ISLAND, "patterns"), (REGIONS, "regions")] {
        let (_, events) = aside(move || events(&mut ask_at(address, "/v1/pockets/plan", body))).await;
        let (last, progress) = events.split_last().expect("events");
        assert_eq!((last.0.as_str(), stages(progress)), ("result", vec![stage]));
        assert!(progress.last().expect("progress").1["fraction"].as_f64() > Some(0.0));
    }
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_failed_computation_sends_a_problem_event_and_a_refused_request_a_plain_problem() {
    let app = app(&["--workers", "1", "--queue", "0"]);
    let server = Server::start(&app).await;
    let address = server.address;
    let mut folding: Value = serde_json::from_str(DIE).expect("JSON");
    folding["tool"]["diameter_mm"] = 500.into();
    folding["engine"] = "offset_section".into();
    let folding = folding.to_string();
    let (_, events) = aside(move || events(&mut ask(address, &folding))).await;
    let [(name, problem)] = events.as_slice() else { panic!("not one event: {events:?}") };
    assert_eq!((name.as_str(), &problem["code"]), ("problem", &"offset_folds".into()));
    assert_eq!((&problem["status"], &problem["request_id"]), (&422.into(), &"one".into()));

    let accept = [("accept", "text/event-stream")];
    for (body, code) in [("{", "malformed_json"), ("{}", "invalid_request")] {
        assert_eq!(post(&app, MILL, body, &accept).await.code(), code);
    }
    let negative = ONE_PASS.replace("0.01", "-0.01");
    assert_eq!(post(&app, MILL, negative, &accept).await.violations()[0].0, "out_of_range");
    let busy = app.compute.admit().expect("the queue has room");
    let refused = post(&app, MILL, ONE_PASS, &accept).await;
    assert_eq!((refused.status.as_u16(), refused.code().as_str()), (503, "overloaded"));
    drop(busy);
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_caller_of_events_that_disconnects_stops_its_computation() {
    // No deadline comes first.
    let app = app(&["--workers", "1", "--queue", "0", "--deadline-s", "60"]);
    let server = Server::start(&app).await;
    let address = server.address;
    // Some ten thousand planes take minutes.
    let long = die_at(0.01);
    let mut is_quick = false;
    for _ in 0..TRIES {
        let long = long.clone();
        let stream = aside(move || {
            let mut stream = ask(address, &long);
            let begun = read_until(&mut stream, "\n\n\r\n");
            assert!(begun.contains("event: progress"), "no progress came first: {begun}");
            stream
        })
        .await;
        assert!(matches!(app.compute.admit(), Err(Failure::Overloaded { .. })));
        let closed = Instant::now();
        drop(stream);
        while app.compute.admit().is_err() {
            assert!(closed.elapsed() < NEVER, "the computation goes on after the caller has disconnected");
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
        is_quick = closed.elapsed() < Duration::from_secs(2);
        if is_quick {
            break;
        }
    }
    assert!(is_quick, "each time the computation went on for a while after the caller had disconnected");
    server.stop().await;
}
