//! Connections that are slow, silent or closed.

use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::Router;
use axum::routing::post;
use toolpathd_core::budget::Budget;
use toolpathd_server::http::compute::memory::Memory;
use toolpathd_server::http::compute::{Capacity, Compute, Failure, Size};

use toolpathd_server::http::App;

use super::support::{
    MILL, ONE_PASS, Server, app, aside, connect, post as post_to, post_head, read_answer, write,
};

const DIE: &str = include_str!("../../../openapi/examples/surfaces-mill/die.json");

/// Most tries of what must be quick. A busy machine delays some of them, and what is slow of itself is slow
/// in all.
const TRIES: usize = 30;

/// Longer than any wait on a busy machine.
const NEVER: Duration = Duration::from_secs(30);

/// A computation that ends only when its budget ends.
fn spin(budget: &Budget) {
    while budget.check().is_ok() {
        std::thread::sleep(Duration::from_millis(1));
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_closed_connection_stops_its_computation_within_a_tenth_of_a_second() {
    let app = app(&["--workers", "1"]);
    let limit = 2 * NEVER;
    let capacity = Capacity { workers: 1, queue: 0, wait: limit, deadline: limit };
    let compute = Arc::new(Compute::new(capacity, Memory::of(None)));
    let pool = Arc::clone(&compute);
    let (tell_end, mut ends) = tokio::sync::mpsc::unbounded_channel();
    let begun = Arc::new(tokio::sync::Notify::new());
    let started = Arc::clone(&begun);
    let handler = move |_body: String| {
        let (compute, tell_end, started) = (Arc::clone(&compute), tell_end.clone(), Arc::clone(&started));
        async move {
            let job = move |budget: &Budget| {
                started.notify_one();
                spin(budget);
                tell_end.send(Instant::now()).expect("the test waits");
            };
            let ticket = compute.admit().expect("room");
            let run = move |budget: &Budget| {
                job(budget);
                Ok::<_, ()>(())
            };
            let _ = compute.run(ticket, Size::Large, None, run).await;
        }
    };
    let server = Server::with_router(&app, Router::new().route("/spin", post(handler))).await;
    let address = server.address;
    let mut quick = 0;
    for _ in 0..TRIES {
        let stream = aside(move || {
            let mut stream = connect(address);
            write(&mut stream, &format!("{}body", post_head("/spin", 4)));
            stream
        })
        .await;
        begun.notified().await;
        tokio::time::sleep(Duration::from_millis(100)).await;
        assert!(ends.is_empty(), "the computation ended while its caller was there");
        let closed = Instant::now();
        drop(stream);
        let ended = tokio::time::timeout(NEVER, ends.recv()).await.expect("the computation stops");
        quick += usize::from(ended.expect("an end") - closed < Duration::from_millis(100));
        if quick == 3 {
            break;
        }
        until(|| !pool.is_full()).await;
    }
    assert_eq!(quick, 3, "of {TRIES} computations so many stopped within a tenth of a second");
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_full_queue_and_a_long_wait_are_503_and_a_passed_deadline_504() {
    let patient = app(&["--workers", "1", "--queue", "1", "--deadline-s", "300", "--queue-wait-s", "300"]);
    let (end_first, first_ended) = std::sync::mpsc::channel::<()>();
    let running = spawn_on(&patient, move |_| {
        let _ = first_ended.recv();
    });
    until(|| patient.compute.running() == 1).await;
    let queued = spawn_on(&patient, |_| {});
    until(|| patient.compute.waiting() == 1).await;
    let refused = post_to(&patient, MILL, ONE_PASS, &[]).await;
    assert_eq!((refused.status.as_u16(), refused.code().as_str()), (503, "overloaded"));
    assert!(refused.header("retry-after").parse::<u32>().is_ok());
    drop(end_first);
    assert_eq!(running.await.expect("no panic"), Ok(Ok(())));
    assert_eq!(queued.await.expect("no panic"), Ok(Ok(())));

    let app = app(&["--workers", "1", "--queue", "1", "--deadline-s", "1", "--queue-wait-s", "0.2"]);
    // It does not look at its budget, and goes on after its deadline.
    let (end_deaf, deaf_ended) = std::sync::mpsc::channel::<()>();
    let deaf = spawn_on(&app, move |_| {
        let _ = deaf_ended.recv();
    });
    until(|| app.compute.running() == 1).await;
    // A small job would not wait for the large one.
    let mut long: serde_json::Value = serde_json::from_str(DIE).expect("JSON");
    long["strategy"]["stepover_mm"] = 0.01.into();
    let waited = post_to(&app, MILL, long.to_string(), &[]).await;
    assert_eq!((waited.status.as_u16(), waited.code().as_str()), (503, "overloaded"));
    assert!(waited.header("retry-after").parse::<u32>().is_ok());
    let small = post_to(&app, MILL, ONE_PASS, &[]).await;
    assert_eq!(small.status.as_u16(), 200);
    assert_eq!(deaf.await.expect("no panic"), Err(Failure::DeadlinePassed));

    assert_eq!(app.compute.running(), 1);
    drop(end_deaf);
    until(|| app.compute.running() == 0).await;
    let late = post_to(&app, MILL, long.to_string(), &[]).await;
    assert_eq!((late.status.as_u16(), late.code().as_str()), (504, "deadline_passed"));
}

/// Waits until something is so.
async fn until(is_so: impl Fn() -> bool) {
    let wait = async {
        while !is_so() {
            tokio::time::sleep(Duration::from_millis(1)).await;
        }
    };
    tokio::time::timeout(NEVER, wait).await.expect("it becomes so");
}

/// Starts a job on the threads of the service.
fn spawn_on(
    app: &Arc<App>,
    job: impl FnOnce(&Budget) + Send + 'static,
) -> tokio::task::JoinHandle<Result<Result<(), ()>, Failure>> {
    let app = Arc::clone(app);
    tokio::spawn(async move {
        let ticket = app.compute.admit()?;
        let job = move |budget: &Budget| {
            job(budget);
            Ok(())
        };
        app.compute.run(ticket, Size::Large, None, job).await
    })
}

#[tokio::test(flavor = "multi_thread")]
async fn the_body_of_a_request_must_arrive_within_its_deadline() {
    let app = app(&["--workers", "1", "--body-deadline-s", "0.5"]);
    let server = Server::start(&app).await;
    let address = server.address;
    aside(move || {
        let mut steady = connect(address);
        write(&mut steady, &post_head(MILL, 20));
        let started = Instant::now();
        while started.elapsed() < Duration::from_millis(450) {
            std::thread::sleep(Duration::from_millis(100));
            write(&mut steady, " ");
        }
        let answer = read_answer(&mut steady).expect("an answer");
        assert!(answer.starts_with("HTTP/1.1 408") && answer.contains("within 0.5 s"), "{answer}");
    })
    .await;
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_caller_that_ends_its_own_direction_gets_its_answer() {
    let app = app(&["--workers", "1"]);
    let server = Server::start(&app).await;
    let address = server.address;
    aside(move || {
        for request in
            ["GET /livez HTTP/1.1\r\nHost: here\r\n\r\n".to_owned(), format!("{}{{}}", post_head(MILL, 2))]
        {
            let mut stream = connect(address);
            write(&mut stream, &request);
            stream.shutdown(std::net::Shutdown::Write).expect("ended");
            let answer = read_answer(&mut stream).expect("an answer");
            assert!(answer.starts_with("HTTP/1.1 200") || answer.starts_with("HTTP/1.1 422"), "{answer}");
        }
    })
    .await;
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_foreign_host_name_is_refused_and_a_request_names_one_host() {
    let app = app(&["--workers", "1", "--host", "cam.example.com"]);
    let server = Server::start(&app).await;
    let address = server.address;
    aside(move || {
        for (hosts, status) in [
            ("Host: localhost\r\n", 200),
            ("Host: cam.example.com:80\r\n", 200),
            ("Host: attacker.example\r\n", 421),
            ("", 400),
            ("Host: here\r\nHost: here\r\n", 400),
        ] {
            let mut stream = connect(address);
            write(&mut stream, &format!("GET /livez HTTP/1.1\r\n{hosts}\r\n"));
            let answer = read_answer(&mut stream).expect("an answer");
            assert!(answer.starts_with(&format!("HTTP/1.1 {status} ")), "{hosts}: {answer}");
        }
    })
    .await;
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_request_that_stops_arriving_times_out() {
    let app = app(&["--workers", "1", "--header-timeout-s", "0.4", "--body-timeout-s", "0.4"]);
    let server = Server::start(&app).await;
    let address = server.address;
    aside(move || {
        for beginning in ["", "P", "POST /v1", "POST /v1/surfaces/mill HTTP/1.1\r\nHost:"] {
            let started = Instant::now();
            let mut stream = connect(address);
            write(&mut stream, beginning);
            assert!(read_answer(&mut stream).is_none_or(|answer| answer.starts_with("HTTP/1.1 4")));
            let waited = started.elapsed();
            // The timeout that nobody has set is 10 s.
            assert!(waited < Duration::from_secs(8), "{beginning:?} was kept for {waited:?}");
        }

        let mut slow = connect(address);
        write(&mut slow, &format!("{}{{", post_head(MILL, 100)));
        let answer = read_answer(&mut slow).expect("an answer");
        assert!(answer.starts_with("HTTP/1.1 408"), "the slow body did not time out: {answer}");
        assert!(answer.contains("\"code\":\"request_timeout\""));
    })
    .await;
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_request_that_arrives_slowly_delays_no_other_request() {
    let app = app(&["--workers", "1", "--body-timeout-s", "300", "--body-deadline-s", "300"]);
    let server = Server::start(&app).await;
    let address = server.address;
    aside(move || {
        let mut slow = connect(address);
        write(&mut slow, &format!("{}{{", post_head(MILL, 2)));
        let mut quick = connect(address);
        write(&mut quick, &format!("{}{{}}", post_head(MILL, 2)));
        assert!(read_answer(&mut quick).expect("an answer").starts_with("HTTP/1.1 422"));
        // The slow request is still under way.
        write(&mut slow, "}");
        assert!(read_answer(&mut slow).expect("an answer").starts_with("HTTP/1.1 422"));
    })
    .await;
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn every_byte_of_a_body_that_arrives_starts_its_timeout_again() {
    let timeout = Duration::from_secs(2);
    let app = app(&["--workers", "1", "--body-timeout-s", "2"]);
    let server = Server::start(&app).await;
    let address = server.address;
    aside(move || {
        let mut steady = connect(address);
        let started = Instant::now();
        write(&mut steady, &post_head(MILL, 4));
        for byte in ["{", " ", " ", "}"] {
            std::thread::sleep(timeout * 3 / 10);
            write(&mut steady, byte);
        }
        assert!(started.elapsed() > timeout);
        assert!(read_answer(&mut steady).expect("an answer").starts_with("HTTP/1.1 422"));
    })
    .await;
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_caller_that_expects_100_continue_gets_413_for_too_large_a_body() {
    let app = app(&["--workers", "1", "--body-limit", "1000"]);
    let server = Server::start(&app).await;
    let address = server.address;
    aside(move || {
        let mut stream = connect(address);
        let head = post_head(MILL, 20_000_000).replace("Host", "Expect: 100-continue\r\nHost");
        write(&mut stream, &head);
        assert!(read_answer(&mut stream).expect("an answer").starts_with("HTTP/1.1 413"));
    })
    .await;
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_caller_that_sends_its_whole_body_before_it_reads_gets_413_for_too_large_a_body() {
    let app = app(&["--workers", "1", "--body-limit", "1000"]);
    let server = Server::start(&app).await;
    let address = server.address;
    aside(move || {
        let size = 20_000_000;
        let mut stream = connect(address);
        write(&mut stream, &post_head(MILL, size));
        write(&mut stream, &" ".repeat(size));
        assert!(read_answer(&mut stream).expect("an answer").starts_with("HTTP/1.1 413"));
        // The connection can be used again.
        write(&mut stream, &format!("{}{{}}", post_head(MILL, 2)));
        assert!(read_answer(&mut stream).expect("an answer").starts_with("HTTP/1.1 422"));
    })
    .await;
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn requests_that_are_no_valid_http_are_answered_with_a_problem() {
    let app = app(&["--workers", "1"]);
    let server = Server::start(&app).await;
    let address = server.address;
    aside(move || {
        let long = "x".repeat(70_000);
        let many: String = (0..200).map(|k| format!("X-{k}: 1\r\n")).collect();
        let huge = format!("X: {}\r\n", "x".repeat(600_000));
        for (head, status, code) in [
            (format!("GET /{long} HTTP/1.1\r\nHost: here\r\n\r\n"), 414, "uri_too_long"),
            (format!("GET /livez HTTP/1.1\r\n{many}\r\n"), 431, "headers_too_large"),
            (format!("GET /livez HTTP/1.1\r\n{huge}\r\n"), 431, "headers_too_large"),
            ("GET /livez HTTP/1.1\r\nContent-Length: many\r\n\r\n".to_owned(), 400, "bad_request"),
            ("GET /livez HTTP/1.1\r\nno header\r\n\r\n".to_owned(), 400, "bad_request"),
        ] {
            let mut stream = connect(address);
            // The service need not read a refused request to its end, so that writing may fail.
            let _ = std::io::Write::write_all(&mut stream, head.as_bytes());
            let answer = read_answer(&mut stream).expect("an answer");
            let (head, body) = answer.split_once("\r\n\r\n").expect("a head");
            assert!(head.starts_with(&format!("HTTP/1.1 {status} ")), "{head}");
            assert!(head.contains("content-type: application/problem+json"), "{head}");
            let problem: serde_json::Value = serde_json::from_str(body).expect("JSON");
            assert_eq!((&problem["status"], &problem["code"]), (&status.into(), &code.into()));
            let id = problem["request_id"].as_str().expect("an id");
            assert!(head.contains(&format!("x-request-id: {id}")), "{head}");
        }
        // An answer of a handler stays unchanged on such a server.
        let mut stream = connect(address);
        write(&mut stream, "GET /livez HTTP/1.1\r\nHost: here\r\n\r\n");
        assert!(read_answer(&mut stream).expect("an answer").ends_with("\r\n\r\nok\n"));
    })
    .await;
    server.stop().await;
}
