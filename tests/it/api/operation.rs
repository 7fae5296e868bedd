//! Metrics, traces, cross-origin requests, documentation pages, and the limits on connections and memory.

use std::io::Read;
use std::time::{Duration, Instant};

use axum::Router;
use axum::body::Body;
use axum::http::Request;
use axum::routing::get as route_get;

use super::support::{
    Answer, MILL, ONE_PASS, Server, app, aside, connect, get, post, post_head, read_answer, send, write,
};

/// Longest time until something is so, on a busy machine too. Less than the timeouts that nobody has set.
const PATIENCE: Duration = Duration::from_secs(15);

/// The value of the metric with this name and these labels. `None` if there is no such metric.
async fn figure(app: &std::sync::Arc<toolpathd_server::http::App>, name: &str) -> Option<f64> {
    let text = get(app, "/metrics").await.text();
    let line = text.lines().find_map(|line| line.strip_prefix(&format!("{name} ")).map(str::to_owned));
    line.map(|value| value.parse().expect("a number"))
}

/// Waits until the metric with this name is as `is_so` says.
async fn until_figure(
    app: &std::sync::Arc<toolpathd_server::http::App>,
    name: &str,
    is_so: impl Fn(f64) -> bool,
) {
    let wait = async {
        while !figure(app, name).await.is_some_and(&is_so) {
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
    };
    assert!(tokio::time::timeout(PATIENCE, wait).await.is_ok(), "{name} stays {:?}", figure(app, name).await);
}

#[tokio::test]
async fn metrics_count_requests_by_route_and_never_by_path() {
    let (app, other) = (app(&["--workers", "1"]), app(&["--workers", "1"]));
    assert_eq!(post(&app, MILL, ONE_PASS, &[]).await.status, 200);
    assert_eq!(post(&app, MILL, "{", &[]).await.status, 400);
    assert_eq!(get(&app, "/no/such/path").await.status, 404);
    for (name, expected) in [
        ("requests_total{route=\"/v1/surfaces/mill\",method=\"POST\",status=\"200\"}", 1.0),
        ("requests_total{route=\"/v1/surfaces/mill\",method=\"POST\",status=\"400\"}", 1.0),
        ("requests_total{route=\"none\",method=\"GET\",status=\"404\"}", 1.0),
        ("problems_total{code=\"malformed_json\"}", 1.0),
        ("problems_total{code=\"overloaded\"}", 0.0),
        ("stage_seconds_count{stage=\"queue\"}", 1.0),
        ("stage_seconds_count{stage=\"compute\"}", 1.0),
        ("request_duration_seconds_count{route=\"/v1/surfaces/mill\"}", 2.0),
        ("received_bytes_total{route=\"/v1/surfaces/mill\"}", ONE_PASS.len() as f64 + 1.0),
        ("running_jobs", 0.0),
        ("queue_length", 0.0),
        ("held_bodies_bytes", 0.0),
    ] {
        assert_eq!(figure(&app, &format!("toolpathd_{name}")).await, Some(expected), "{name}");
    }
    let text = get(&app, "/metrics").await.text();
    assert!(
        text.ends_with("# EOF\n") && !text.contains("no/such"),
        "a path is in the metrics, or they do not end: {text}"
    );
    let untouched = get(&other, "/metrics").await.text();
    assert!(!untouched.contains(MILL), "the metrics hold requests to another service: {untouched}");
}

#[tokio::test]
async fn a_caller_that_disconnects_is_counted_as_a_cancellation() {
    let app = app(&["--workers", "1"]);
    let body = Body::from_stream(futures_util::stream::pending::<Result<Vec<u8>, std::io::Error>>());
    let waiting = post(&app, MILL, body, &[]);
    assert!(tokio::time::timeout(Duration::from_millis(50), waiting).await.is_err());
    let name = "toolpathd_cancellations_total{route=\"/v1/surfaces/mill\"}";
    assert_eq!(figure(&app, name).await, Some(1.0));
}

#[tokio::test]
async fn a_trace_of_the_caller_is_continued_and_no_new_trace_is_begun() {
    let app = app(&["--workers", "1"]);
    let sent = "00-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01";
    let answer = post(&app, MILL, ONE_PASS, &[("traceparent", sent)]).await;
    let continued = answer.header("traceparent");
    assert!(
        continued.starts_with(&sent[..36]) && continued.ends_with("-01"),
        "not the trace of the caller: {continued}"
    );
    assert_ne!(continued, sent);
    assert_eq!(get(&app, "/livez").await.header("traceparent"), "");
}

#[tokio::test]
async fn only_pages_of_configured_origins_may_call() {
    async fn allowed(flags: &[&str], origin: &str) -> Answer {
        let preflight = Request::options(MILL)
            .header("origin", origin)
            .header("access-control-request-method", "POST")
            .header("access-control-request-headers", "content-type");
        send(&app(flags), preflight.body(Body::empty()).expect("a request")).await
    }
    const ALLOW_ORIGIN: &str = "access-control-allow-origin";
    let (mes, set) = ("https://mes.example", ["--workers", "1", "--cors-origin", "https://mes.example"]);
    assert_eq!(allowed(&set, mes).await.header(ALLOW_ORIGIN), mes);
    for name in ["content-type", "authorization"] {
        assert!(allowed(&set, mes).await.header("access-control-allow-headers").contains(name));
    }
    for (flags, origin) in [(&set[..], "https://mes.example.evil"), (&["--workers", "1"], mes)] {
        let refused = allowed(flags, origin).await;
        assert_eq!((refused.header(ALLOW_ORIGIN), refused.code().as_str()), ("", "origin_refused"));
        assert!(refused.text().contains(&format!("--cors-origin {origin}")), "{}", refused.text());
    }
    let from_disk = allowed(&set, "null").await.text();
    assert!(from_disk.contains("put the page on a server"), "{from_disk}");
    let problem = post(&app(&set), MILL, "{", &[("origin", mes)]).await;
    assert_eq!((problem.header(ALLOW_ORIGIN), problem.code().as_str()), (mes, "malformed_json"));
}

#[tokio::test]
async fn the_documentation_pages_load_nothing_from_other_servers() {
    let app = app(&["--workers", "1"]);
    let redirect = get(&app, "/docs").await;
    assert_eq!((redirect.status.as_u16(), redirect.header("location")), (303, "/docs/"));
    let page = get(&app, "/docs/").await;
    let policy = page.header("content-security-policy");
    assert!(
        policy.starts_with("default-src 'none';") && !policy.contains("http"),
        "the policy allows other servers: {policy}"
    );
    let text = page.text();
    assert!(
        !text.contains("//cdn") && !text.contains("src=\"http") && !text.contains("href=\"http"),
        "the page names another server: {text}"
    );
    let loaded: Vec<_> =
        text.split(['"']).filter(|name| name.ends_with(".js") || name.ends_with(".css")).collect();
    assert_eq!(loaded.len(), 5, "other files are loaded: {loaded:?}");
    for name in loaded {
        assert_eq!(
            get(&app, &format!("/docs/{}", name.trim_start_matches("./"))).await.status,
            200,
            "{name} cannot be loaded"
        );
    }
    let start = get(&app, "/docs/swagger-initializer.js").await.text();
    assert!(start.contains("\"../openapi.json\"") && start.contains("\"validatorUrl\": \"none\""), "{start}");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_connection_above_the_limit_gets_health_checks_alone_until_another_one_ends() {
    let app = app(&["--workers", "1", "--connections", "1"]);
    let server = Server::start(&app).await;
    let address = server.address;
    let ask = "GET /livez HTTP/1.1\r\nHost: here\r\n\r\n";
    aside(move || {
        let mut first = connect(address);
        write(&mut first, ask);
        assert!(read_answer(&mut first).is_some());
        for (path, status) in [("/livez", 200), ("/v1/limits", 503)] {
            let mut spare = connect(address);
            write(&mut spare, &ask.replace("/livez", path));
            let answer = read_answer(&mut spare).expect("an answer");
            assert!(answer.starts_with(&format!("HTTP/1.1 {status} ")), "{answer}");
            assert!(matches!(spare.read(&mut [0]), Ok(0) | Err(_)));
        }
        drop(first);
    })
    .await;
    until_figure(&app, "toolpathd_open_connections", |open| open < 0.5).await;
    aside(move || {
        let mut second = connect(address);
        write(&mut second, ask);
        assert!(read_answer(&mut second).is_some());
    })
    .await;
    assert_eq!(figure(&app, "toolpathd_connections_refused_total").await, Some(2.0));
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_body_beyond_the_memory_for_all_bodies_is_503() {
    let app = app(&["--workers", "1", "--body-limit", "1000", "--body-memory", "1000"]);
    let server = Server::start(&app).await;
    let address = server.address;
    let most = " ".repeat(600);
    let begun = format!("{}{most}", post_head(MILL, 602));
    let mut first = aside(move || {
        let mut first = connect(address);
        write(&mut first, &begun);
        first
    })
    .await;
    until_figure(&app, "toolpathd_held_bodies_bytes", |held| held > 599.5).await;
    aside(move || {
        let mut second = connect(address);
        write(&mut second, &format!("{}{most}{{}}", post_head(MILL, 602)));
        let answer = read_answer(&mut second).expect("an answer").to_ascii_lowercase();
        assert!(
            answer.starts_with("http/1.1 503") && answer.contains("retry-after: 1"),
            "the second body was not refused: {answer}"
        );
        write(&mut first, "{}");
        assert!(read_answer(&mut first).expect("an answer").starts_with("HTTP/1.1 422"));
        write(&mut second, &format!("{}{most}{{}}", post_head(MILL, 602)));
        assert!(read_answer(&mut second).expect("an answer").starts_with("HTTP/1.1 422"));
    })
    .await;
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_caller_that_does_not_read_is_disconnected() {
    let timeout = Duration::from_secs(1);
    let app = app(&["--workers", "1", "--write-timeout-s", "1"]);
    let router = Router::new().route("/large", route_get(|| async { vec![0_u8; 64 << 20] }));
    let server = Server::with_router(&app, router).await;
    let address = server.address;
    let asked = Instant::now();
    let _deaf = aside(move || {
        let mut stream = connect(address);
        write(&mut stream, "GET /large HTTP/1.1\r\nHost: here\r\n\r\n");
        stream
    })
    .await;
    until_figure(&app, "toolpathd_open_connections", |open| open > 0.5).await;
    // The caller is disconnected.
    until_figure(&app, "toolpathd_open_connections", |open| open < 0.5).await;
    assert!(asked.elapsed() >= timeout, "it was disconnected after {:?}", asked.elapsed());
    server.stop().await;
}

#[tokio::test]
async fn every_answer_repeats_the_key_of_the_caller() {
    let app = app(&["--workers", "1"]);
    for (body, key, status) in
        [(ONE_PASS, "WO 4711", 200), ("{}", "WO 4711", 422), (ONE_PASS, "a\tb", 400), (ONE_PASS, "", 400)]
    {
        let answer = post(&app, MILL, body, &[("idempotency-key", key)]).await;
        assert_eq!(answer.status, status, "{key:?}");
        let repeated = if status == 400 { "" } else { key };
        assert_eq!(answer.header("idempotency-key"), repeated);
        assert!(answer.status.is_success() || answer.header("content-type") == "application/problem+json");
    }
}
