//! What HTTP costs: the time of a small job in the core, and of the same job as a request over a connection
//! of this machine that stays open. The difference is the cost of HTTP: decoding, the queue, encoding, digest
//! and log.
//!
//! `cargo bench --bench http`

use std::hint::black_box;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::sync::mpsc::sync_channel;

use clap::Parser;
use criterion::{Criterion, criterion_group, criterion_main};
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::deviation::{Band, Measure};
use toolpathd_core::operations::interpolation::{Job, Method, Source, Subdivision, plan};
use toolpathd_server::config::Cli;
use toolpathd_server::http::{App, router, serve};

const BODY: &str = r#"{"curve":{"kind":"graph","expression":"sin(x)","domain":[0,6.5]},"method":"linear",
    "subdivision":"bisection","band":{"below_mm":0.01,"above_mm":0.01,"measure":"vertical"}}"#;

/// The job of [`BODY`].
fn job() -> Job {
    let curve = Source::Graph { expression: "sin(x)".into(), domain: [0.0, 6.5] };
    let band = Band { below_mm: 0.01, above_mm: 0.01, measure: Measure::Vertical };
    Job::new(curve, Method::Linear, Subdivision::Bisection, band)
}

/// Starts the service on a thread of its own, and returns its address.
fn service() -> SocketAddr {
    let (tell, told) = sync_channel(1);
    std::thread::spawn(move || {
        let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build().expect("a runtime");
        runtime.block_on(async {
            let app = App::new(&Cli::parse_from(["toolpathd"]).settings);
            let listener = tokio::net::TcpListener::bind("127.0.0.1:0").await.expect("a port");
            tell.send(listener.local_addr().expect("an address")).expect("the bench waits");
            serve(listener, router(&app), &app, std::future::pending()).await.expect("served");
        });
    });
    told.recv().expect("an address")
}

/// Sends one request and reads its answer.
fn ask(stream: &mut BufReader<TcpStream>, request: &str) -> Vec<u8> {
    stream.get_mut().write_all(request.as_bytes()).expect("sent");
    let (mut length, mut line) = (0, String::new());
    loop {
        line.clear();
        stream.read_line(&mut line).expect("a line");
        if let Some(text) = line.strip_prefix("content-length: ") {
            length = text.trim().parse().expect("a number");
        }
        if line == "\r\n" {
            break;
        }
    }
    let mut body = vec![0; length];
    stream.read_exact(&mut body).expect("a body");
    body
}

fn cost_of_http(c: &mut Criterion) {
    let mut group = c.benchmark_group("http");
    let job = job();
    group.bench_function("core", |b| b.iter(|| plan(black_box(&job), &Budget::unlimited()).unwrap()));
    let stream = TcpStream::connect(service()).expect("a connection");
    stream.set_nodelay(true).expect("set");
    let mut stream = BufReader::new(stream);
    let request = format!(
        "POST /v1/curves/interpolate HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n\
         Content-Length: {}\r\n\r\n{BODY}",
        BODY.len()
    );
    assert!(ask(&mut stream, &request).starts_with(b"{\"engine_version\""));
    group.bench_function("service", |b| b.iter(|| ask(&mut stream, black_box(&request))));
    group.finish();
}

criterion_group!(benches, cost_of_http);
criterion_main!(benches);
