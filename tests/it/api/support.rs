//! Helpers for requests to the service, with and without a socket.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::body::{Body, to_bytes};
use axum::http::{HeaderMap, Request, StatusCode};
use clap::Parser;
use serde_json::{Value, json};
use tokio::sync::oneshot;
use tokio::task::JoinHandle;
use toolpathd_core::toolpath::cutting::Coolant;
use toolpathd_core::toolpath::program::SafeHome;
use toolpathd_post::Dialect;
use toolpathd_server::config::{Cli, Settings};
use toolpathd_server::http::{App, router, serve};
use tower::ServiceExt;

pub const ONE_PASS: &str = include_str!("../../../openapi/examples/surfaces-mill/one-pass.json");
pub const MILL: &str = "/v1/surfaces/mill";

/// The settings that these flags of the command line give.
pub fn settings(flags: &[&str]) -> Settings {
    Cli::parse_from(["toolpathd"].iter().chain(flags)).settings
}

pub fn app(flags: &[&str]) -> Arc<App> {
    App::new(&settings(flags))
}

/// An answer whose whole body was read.
#[derive(Debug)]
pub struct Answer {
    pub status: StatusCode,
    pub headers: HeaderMap,
    pub body: Vec<u8>,
}

impl Answer {
    pub fn header(&self, name: &str) -> &str {
        self.headers.get(name).and_then(|value| value.to_str().ok()).unwrap_or_default()
    }

    pub fn text(&self) -> String {
        String::from_utf8(self.body.clone()).expect("UTF-8")
    }

    pub fn json(&self) -> Value {
        serde_json::from_slice(&self.body).expect("JSON")
    }

    /// The body as a problem. Fails if a member or a header that every problem has is missing.
    pub fn problem(&self) -> Value {
        assert_eq!(self.header("content-type"), "application/problem+json");
        let problem = self.json();
        assert_eq!(problem["status"], self.status.as_u16());
        assert_eq!(problem["type"], "about:blank");
        assert_eq!(problem["request_id"], self.header("x-request-id"));
        for name in ["title", "detail", "code", "request_id"] {
            assert!(
                problem[name].as_str().is_some_and(|text| !text.is_empty()),
                "the problem lacks {name}: {problem}"
            );
        }
        assert!(problem["errors"].is_array(), "the problem lacks errors: {problem}");
        assert_eq!(self.header("x-engine-version"), env!("CARGO_PKG_VERSION"));
        problem
    }

    pub fn code(&self) -> String {
        self.problem()["code"].as_str().unwrap_or_default().to_owned()
    }

    /// The code and the pointer of every violation.
    pub fn violations(&self) -> Vec<(String, String)> {
        let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
        let problem = self.problem();
        let errors = problem["errors"].as_array().into_iter().flatten();
        errors.map(|error| (text(&error["code"]), text(&error["pointer"]))).collect()
    }
}

pub async fn send(app: &Arc<App>, request: Request<Body>) -> Answer {
    let response = router(app).oneshot(request).await.expect("the router does not fail");
    let (parts, body) = response.into_parts();
    let body = to_bytes(body, usize::MAX).await.expect("a body").to_vec();
    Answer { status: parts.status, headers: parts.headers, body }
}

pub async fn post(app: &Arc<App>, path: &str, body: impl Into<Body>, headers: &[(&str, &str)]) -> Answer {
    let has_type = headers.iter().any(|(name, _)| *name == "content-type");
    let json = [("content-type", "application/json")];
    let all = json.iter().filter(|_| !has_type).chain(headers);
    let builder = all.fold(Request::post(path), |builder, (name, value)| builder.header(*name, *value));
    send(app, builder.body(body.into()).expect("a request")).await
}

pub async fn get(app: &Arc<App>, path: &str) -> Answer {
    send(app, Request::get(path).body(Body::empty()).expect("a request")).await
}

/// A service on a free port of this machine.
pub struct Server {
    pub address: SocketAddr,
    stop: oneshot::Sender<()>,
    task: JoinHandle<std::io::Result<()>>,
}

impl Server {
    pub async fn start(app: &Arc<App>) -> Self {
        Self::with_router(app, router(app)).await
    }

    pub async fn with_router(app: &Arc<App>, router: Router) -> Self {
        let listener = tokio::net::TcpListener::bind("127.0.0.1:0").await.expect("a port");
        let address = listener.local_addr().expect("an address");
        let (stop, stopped) = oneshot::channel();
        let app = Arc::clone(app);
        let task = tokio::spawn(async move {
            let stopped = async move {
                let _ = stopped.await;
            };
            serve(listener, router, &app, stopped).await
        });
        Self { address, stop, task }
    }

    pub async fn stop(self) {
        let _ = self.stop.send(());
        self.task.await.expect("the server did not panic").expect("the server did not fail");
    }
}

/// Runs blocking work on sockets in a thread of its own, so that the service can run.
pub async fn aside<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> T {
    tokio::task::spawn_blocking(work).await.expect("the thread did not panic")
}

pub fn connect(address: SocketAddr) -> TcpStream {
    let stream = TcpStream::connect(address).expect("a connection");
    stream.set_read_timeout(Some(Duration::from_secs(20))).expect("a timeout");
    stream
}

/// Reads one answer. `None` if the connection ends before the answer does, or no data comes for 20 s.
pub fn read_answer(stream: &mut TcpStream) -> Option<String> {
    let mut text = Vec::new();
    let mut byte = [0];
    while !text.ends_with(b"\r\n\r\n") {
        match stream.read(&mut byte) {
            Ok(1) => text.push(byte[0]),
            _ => return None,
        }
    }
    let head = String::from_utf8_lossy(&text).to_ascii_lowercase();
    let length = head.split("content-length: ").nth(1).and_then(|rest| rest.split("\r\n").next());
    let mut body = vec![0; length.and_then(|length| length.parse().ok()).unwrap_or(0)];
    stream.read_exact(&mut body).ok()?;
    text.extend(body);
    Some(String::from_utf8_lossy(&text).into_owned())
}

pub fn write(stream: &mut TcpStream, text: &str) {
    stream.write_all(text.as_bytes()).expect("the request can be written");
}

/// The head of a POST with a body of `length` bytes.
pub fn post_head(path: &str, length: usize) -> String {
    format!("POST {path} HTTP/1.1\r\nHost: here\r\nContent-Length: {length}\r\n\r\n")
}

/// The body with the dialect, and without what the dialect has no words for.
pub fn for_dialect(mut body: Value, dialect: &Dialect) -> Value {
    let can = dialect.abilities;
    if body["program"].is_null() {
        body["program"] = json!({});
    }
    let drop = |body: &mut Value, member: &str, field: &str, is_kept: &dyn Fn(&str) -> bool| {
        let Some(object) = body.get_mut(member).and_then(Value::as_object_mut) else { return };
        if object.get(field).is_some_and(|value| !is_kept(value.as_str().unwrap_or_default())) {
            object.remove(field);
        }
    };
    let offsets: Vec<String> = can.work_offsets.iter().map(|number| format!("G{number}")).collect();
    drop(&mut body, "program", "work_offset", &|offset| offsets.iter().any(|known| known == offset));
    drop(&mut body, "program", "units", &|units| units == "mm" || can.units.len() > 1);
    drop(&mut body, "program", "safe_home", &|home| {
        let asked = if home == "g28" { SafeHome::G28 } else { SafeHome::G53 };
        home == "none" || can.safe_homes.contains(&asked)
    });
    drop(&mut body, "cutting", "coolant", &|coolant| {
        let asked = if coolant == "mist" { Coolant::Mist } else { Coolant::Flood };
        coolant == "off" || can.coolants.contains(&asked)
    });
    drop(&mut body, "tool", "length_offset", &|_| can.length_offsets.is_some());
    if let Some(passes) = body.pointer_mut("/toolpath/passes").and_then(Value::as_array_mut) {
        for pass in passes {
            if let Some(moves) = pass["moves"].as_array_mut() {
                moves.retain(|step| can.has_dwells || step["kind"] != "dwell");
            }
        }
    }
    if can.needs_tool && body["tool"].is_null() {
        body["tool"] = json!({ "shape": "ball", "diameter_mm": 6 });
    }
    body["program"]["dialect"] = json!(dialect.name);
    body
}
