//! Metrics of this process, in the text form that Prometheus reads.
//!
//! The values of all labels are taken from fixed lists: route templates, known methods, statuses, error codes
//! and stages. So the number of time series stays the same, whatever callers send.

use std::sync::Arc;
use std::time::Duration;

use axum::extract::State;
use axum::http::{HeaderValue, Method, StatusCode, header};
use axum::response::{IntoResponse, Response};
use prometheus_client::encoding::EncodeLabelSet;
use prometheus_client::encoding::text::encode;
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::metrics::histogram::{Histogram, exponential_buckets};
use prometheus_client::registry::{Registry, Unit};

use crate::http::answer::timing::Timing;
use crate::http::error::{ApiError, Code};

const OPENMETRICS: HeaderValue =
    HeaderValue::from_static("application/openmetrics-text; version=1.0.0; charset=utf-8");

/// Tell the figures of this process.
///
/// Counters and histograms of requests, computations and memory, as OpenMetrics text.
#[utoipa::path(get, path = "/metrics", operation_id = "getMetrics", tag = "operation",
    responses((status = 200, description = "OpenMetrics text.", body = String,
        content_type = "application/openmetrics-text")))]
pub async fn get_metrics(State(figures): State<Figures>) -> Result<Response, ApiError> {
    let Figures { metrics, load } = figures;
    let text = metrics
        .text(load)
        .map_err(|error| ApiError::new(Code::InternalError, format!("writing metrics: {error}")))?;
    Ok(([(header::CONTENT_TYPE, OPENMETRICS)], text).into_response())
}

/// What `/metrics` tells: the counters, and the load of this moment.
#[derive(Clone)]
pub struct Figures {
    pub metrics: Arc<Metrics>,
    pub load: Load,
}

/// The load of this moment.
#[derive(Debug, Clone, Copy)]
pub struct Load {
    pub running: usize,
    pub waiting: usize,
    pub connections: usize,
    pub body_bytes: usize,
    pub answer_bytes: usize,
}

/// A request that was answered to the end.
pub struct Answered<'a> {
    pub route: &'a str,
    pub method: &'a Method,
    pub status: StatusCode,
    /// The code of the problem; `None` for a success.
    pub code: Option<Code>,
    pub timing: Option<Timing>,
    pub duration: Duration,
    pub received_bytes: u64,
    pub sent_bytes: u64,
}

#[derive(Debug, Clone, PartialEq, Eq, Hash, EncodeLabelSet)]
struct Endpoint {
    route: String,
}

#[derive(Debug, Clone, PartialEq, Eq, Hash, EncodeLabelSet)]
struct Outcome {
    route: String,
    method: &'static str,
    status: u16,
}

#[derive(Debug, Clone, PartialEq, Eq, Hash, EncodeLabelSet)]
struct Problem {
    code: String,
}

#[derive(Debug, Clone, PartialEq, Eq, Hash, EncodeLabelSet)]
struct Stage {
    stage: &'static str,
}

/// The counters of one service.
pub struct Metrics {
    registry: Registry,
    requests: Family<Outcome, Counter>,
    durations: Family<Endpoint, Histogram>,
    stages: Family<Stage, Histogram>,
    problems: Family<Problem, Counter>,
    cancellations: Family<Endpoint, Counter>,
    received: Family<Endpoint, Counter>,
    sent: Family<Endpoint, Counter>,
    connections_refused: Counter,
    running: Gauge,
    waiting: Gauge,
    connections: Gauge,
    body_bytes: Gauge,
    answer_bytes: Gauge,
}

impl Default for Metrics {
    fn default() -> Self {
        let mut metrics = Self {
            registry: Registry::with_prefix("toolpathd"),
            requests: Family::default(),
            durations: Family::new_with_constructor(histogram),
            stages: Family::new_with_constructor(histogram),
            problems: Family::default(),
            cancellations: Family::default(),
            received: Family::default(),
            sent: Family::default(),
            connections_refused: Counter::default(),
            running: Gauge::default(),
            waiting: Gauge::default(),
            connections: Gauge::default(),
            body_bytes: Gauge::default(),
            answer_bytes: Gauge::default(),
        };
        metrics.register();
        // These counters exist from the start, so that an alarm can watch them before the first failure.
        for code in [Code::Overloaded, Code::DeadlinePassed, Code::InternalError] {
            let _ = metrics.problems.get_or_create(&Problem { code: code.to_string() });
        }
        metrics
    }
}

impl Metrics {
    fn register(&mut self) {
        let (seconds, bytes) = (|| Unit::Seconds, || Unit::Bytes);
        let registry = &mut self.registry;
        registry.register("requests", "Requests answered to the end", self.requests.clone());
        registry.register_with_unit(
            "request_duration",
            "From the head of a request to the last byte of its answer",
            seconds(),
            self.durations.clone(),
        );
        registry.register_with_unit(
            "stage",
            "Stages of the answers that were computed",
            seconds(),
            self.stages.clone(),
        );
        registry.register("problems", "Answers of 400 and above by their code", self.problems.clone());
        registry.register(
            "cancellations",
            "Requests whose caller went away before the end of the answer",
            self.cancellations.clone(),
        );
        registry.register_with_unit("received", "Bodies of requests", bytes(), self.received.clone());
        registry.register_with_unit("sent", "Bodies of answers", bytes(), self.sent.clone());
        registry.register(
            "connections_refused",
            "New connections that got only health checks and metrics because too many others were open",
            self.connections_refused.clone(),
        );
        registry.register("running_jobs", "Computations now", self.running.clone());
        registry.register("queue_length", "Requests now waiting for a worker", self.waiting.clone());
        registry.register("open_connections", "Connections now", self.connections.clone());
        registry.register_with_unit(
            "held_bodies",
            "Bodies of the requests under way",
            bytes(),
            self.body_bytes.clone(),
        );
        registry.register_with_unit(
            "held_answers",
            "Answers that wait for their callers",
            Unit::Bytes,
            self.answer_bytes.clone(),
        );
    }

    pub fn answered(&self, answered: Answered<'_>) {
        let Answered { route, method, status, code, timing, duration, received_bytes, sent_bytes } = answered;
        let outcome = Outcome { route: route.to_owned(), method: known(method), status: status.as_u16() };
        self.requests.get_or_create(&outcome).inc();
        let route = Endpoint { route: outcome.route };
        self.durations.get_or_create(&route).observe(duration.as_secs_f64());
        self.received.get_or_create(&route).inc_by(received_bytes);
        self.sent.get_or_create(&route).inc_by(sent_bytes);
        if let Some(code) = code {
            self.problems.get_or_create(&Problem { code: code.to_string() }).inc();
        }
        for (stage, duration) in timing.iter().flat_map(Timing::steps) {
            self.stages.get_or_create(&Stage { stage }).observe(duration.as_secs_f64());
        }
    }

    pub fn cancelled(&self, route: &str) {
        self.cancellations.get_or_create(&Endpoint { route: route.to_owned() }).inc();
    }

    pub fn connection_refused(&self) {
        self.connections_refused.inc();
    }

    fn text(&self, load: Load) -> Result<String, std::fmt::Error> {
        let Load { running, waiting, connections, body_bytes, answer_bytes } = load;
        self.running.set(running as i64);
        self.waiting.set(waiting as i64);
        self.connections.set(connections as i64);
        self.body_bytes.set(body_bytes as i64);
        self.answer_bytes.set(answer_bytes as i64);
        let mut text = String::new();
        encode(&mut text, &self.registry)?;
        Ok(text)
    }
}

/// Buckets from 1 ms to 33 s, which is above the default deadline of 25 s.
fn histogram() -> Histogram {
    Histogram::new(exponential_buckets(0.001, 2.0, 16))
}

/// The label of a method. Other methods share one label, because a caller may invent any number of methods.
fn known(method: &Method) -> &'static str {
    match *method {
        Method::GET => "GET",
        Method::HEAD => "HEAD",
        Method::POST => "POST",
        Method::PUT => "PUT",
        Method::OPTIONS => "OPTIONS",
        _ => "other",
    }
}
