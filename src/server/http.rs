//! The HTTP service: decodes requests into jobs, runs the jobs on a fixed number of threads, and encodes the
//! answers.
//!
//! Only these modules know status codes, media types and JSON.

mod admission;
mod answer;
mod compression;
pub mod compute;
mod connection;
mod decode;
mod dnc;
mod docs;
mod dto;
mod envelope;
mod error;
mod events;
mod extract;
mod failure;
mod guard;
mod health;
mod held;
mod linger;
mod marks;
mod metrics;
mod negotiation;
mod observe;
mod openapi;
mod output;
mod pace;
mod places;
mod pointer;
mod program_stream;
mod refusal;
mod repeated_key;
mod request_id;
mod retry;
mod sent_part;
pub mod serve;
mod socket;
mod timing;
mod trace;
mod v1;
mod watched;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use axum::Router;
use axum::http::{HeaderName, HeaderValue, Method, header};
use axum::middleware::{from_fn, from_fn_with_state};
use tower::util::option_layer;
use tower_http::catch_panic::CatchPanicLayer;
use tower_http::cors::CorsLayer;

use crate::config::{Limits, Settings};
use admission::Pot;
use compute::memory::{self, Memory};
use compute::{Capacity, Compute};
use connection::Patience;
use dnc::Controls;
use guard::Hosts;
use metrics::Metrics;
pub use openapi::contract;
use places::Places;
use program_stream::Streams;

/// The version of the service. The same request to the same version gives the same bytes.
pub const ENGINE_VERSION: &str = env!("CARGO_PKG_VERSION");

/// How long a browser may remember what pages of another origin may do.
const PREFLIGHT_AGE: Duration = Duration::from_secs(3600);

/// Most bytes of the heads of all requests under way.
const HEAD_MEMORY_BYTES: usize = 32 * 1024 * 1024;

/// The state that all handlers share.
pub struct App {
    pub compute: Compute,
    metrics: Metrics,
    /// The memory for heads of requests, for bodies of requests, and for answers that wait for their callers.
    head_memory: Arc<Pot>,
    body_memory: Arc<Pot>,
    answer_memory: Arc<Pot>,
    connections: Places,
    patience: Patience,
    hosts: Hosts,
    streams: Streams,
    controls: Controls,
    cors_origins: Vec<HeaderValue>,
    limits: Limits,
    queue: usize,
    workers: usize,
    deadline: Duration,
    queue_wait: Duration,
    body_timeout: Duration,
    body_deadline: Duration,
    draining: AtomicBool,
}

impl App {
    pub fn new(settings: &Settings) -> Arc<Self> {
        let (workers, queue) = (settings.workers(), usize::from(settings.queue));
        let memory = settings.memory.or_else(memory::granted);
        let (bodies, answers) = settings.held_bytes(memory);
        let capacity =
            Capacity { workers, queue, wait: settings.queue_wait_s, deadline: settings.deadline_s };
        Arc::new(Self {
            compute: Compute::new(capacity, Memory::of(memory)),
            metrics: Metrics::default(),
            head_memory: Pot::new(HEAD_MEMORY_BYTES, "heads of requests"),
            body_memory: Pot::new(bodies, "request bodies"),
            answer_memory: Pot::new(answers, "answers"),
            connections: Places::new(settings),
            patience: Patience::new(settings),
            hosts: Hosts::new(&settings.host),
            streams: Streams::new(settings),
            controls: Controls::new(&settings.dnc_target),
            cors_origins: settings.cors_origin.clone(),
            limits: settings.limits(),
            queue,
            workers,
            deadline: settings.deadline_s,
            queue_wait: settings.queue_wait_s,
            body_timeout: settings.body_timeout_s,
            body_deadline: settings.body_deadline_s,
            draining: AtomicBool::new(false),
        })
    }

    /// Begins the shutdown, which must be over at `end`: `/readyz` answers 503, so that load balancers send
    /// new work elsewhere, and programs that are being sent to controls are ended.
    pub fn drain(&self, end: Instant) {
        self.draining.store(true, Ordering::Relaxed);
        self.compute.end_by(end);
        self.controls.close();
    }

    pub fn is_draining(&self) -> bool {
        self.draining.load(Ordering::Relaxed)
    }
}

/// All routes, inside the layers that every request passes. The outermost layer stands last.
pub fn router(app: &Arc<App>) -> Router {
    let (routes, _) = openapi::routes().split_for_parts();
    routes
        .merge(docs::routes())
        .route_layer(from_fn_with_state(Arc::clone(app), admission::admit))
        .with_state(Arc::clone(app))
        .layer(compression::layer())
        .layer(CatchPanicLayer::custom(envelope::panicked))
        .layer(from_fn_with_state(Arc::clone(app), guard::check_host))
        .layer(from_fn(envelope::wrap))
        .layer(from_fn_with_state(Arc::clone(app), held::hold))
        .layer(from_fn(repeated_key::repeat_key))
        .layer(option_layer(cors(&app.cors_origins)))
        .layer(from_fn_with_state(Arc::clone(app), observe::observe))
}

/// Lets pages of these origins call the service and read the headers of its answers. `None` without origins.
///
/// [`PREFLIGHT_AGE`] spares a browser the question before each request.
fn cors(origins: &[HeaderValue]) -> Option<CorsLayer> {
    const EXPOSED: [HeaderName; 11] = [
        request_id::HEADER,
        envelope::ENGINE_VERSION_HEADER,
        trace::HEADER,
        header::CONTENT_DISPOSITION,
        header::CONTENT_ENCODING,
        header::RETRY_AFTER,
        output::WARNINGS,
        compression::REPR_DIGEST,
        timing::SERVER_TIMING,
        retry::IDEMPOTENCY_KEY,
        retry::JOB_ORDER_ID,
    ];
    const ALLOWED: [HeaderName; 6] = [
        header::ACCEPT,
        header::CONTENT_TYPE,
        header::CONTENT_ENCODING,
        request_id::HEADER,
        trace::HEADER,
        retry::IDEMPOTENCY_KEY,
    ];
    let layer = CorsLayer::new()
        .allow_origin(origins.to_vec())
        .allow_methods([Method::GET, Method::POST, Method::PUT])
        .allow_headers(ALLOWED)
        .expose_headers(EXPOSED)
        .max_age(PREFLIGHT_AGE);
    (!origins.is_empty()).then_some(layer)
}
