//! The HTTP service: decodes requests into jobs, runs the jobs on a fixed number of threads, and encodes the
//! answers.
//!
//! Only these modules know status codes, media types and JSON.

mod admission;
mod answer;
mod compression;
pub mod compute;
mod decode;
mod dnc;
mod docs;
mod dto;
mod envelope;
mod error;
mod events;
mod extract;
mod failure;
mod health;
mod linger;
mod metrics;
mod negotiation;
mod observe;
mod openapi;
mod output;
mod place;
mod pointer;
mod program_stream;
mod refusal;
mod request_id;
mod sent_part;
pub mod serve;
mod timing;
mod trace;
mod v1;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use axum::Router;
use axum::http::{HeaderName, HeaderValue, Method, header};
use axum::middleware::{from_fn, from_fn_with_state};
use tokio::sync::Semaphore;
use tower::util::option_layer;
use tower_http::catch_panic::CatchPanicLayer;
use tower_http::cors::CorsLayer;

use crate::config::{Limits, Settings};
use admission::BodyMemory;
use compute::Compute;
use dnc::Controls;
use metrics::Metrics;
pub use openapi::contract;
use program_stream::Streams;
use serve::Connections;

/// The version of the service. The same request to the same version gives the same bytes.
pub const ENGINE_VERSION: &str = env!("CARGO_PKG_VERSION");

/// The state that all handlers share.
pub struct App {
    pub compute: Compute,
    /// Permits for decoding large bodies: one for each worker.
    decoders: Arc<Semaphore>,
    metrics: Metrics,
    body_memory: Arc<BodyMemory>,
    connections: Connections,
    streams: Streams,
    controls: Controls,
    cors_origins: Vec<HeaderValue>,
    limits: Limits,
    queue: usize,
    workers: usize,
    deadline: Duration,
    body_timeout: Duration,
    draining: AtomicBool,
}

impl App {
    /// # Errors
    /// When the threads of the pool cannot be started.
    pub fn new(settings: &Settings) -> Result<Arc<Self>, rayon::ThreadPoolBuildError> {
        let (workers, queue) = (settings.workers(), usize::from(settings.queue));
        Ok(Arc::new(Self {
            compute: Compute::new(workers, queue, settings.deadline_s)?,
            decoders: Arc::new(Semaphore::new(workers)),
            metrics: Metrics::default(),
            body_memory: BodyMemory::new(settings.body_memory),
            connections: Connections::new(settings),
            streams: Streams::new(settings),
            controls: Controls::new(&settings.dnc_target),
            cors_origins: settings.cors_origin.clone(),
            limits: settings.limits(),
            queue,
            workers,
            deadline: settings.deadline_s,
            body_timeout: settings.body_timeout_s,
            draining: AtomicBool::new(false),
        }))
    }

    /// Begins the shutdown: `/readyz` answers 503, so that load balancers send new work elsewhere, and
    /// programs that are being sent to controls are ended.
    pub fn drain(&self) {
        self.draining.store(true, Ordering::Relaxed);
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
        .layer(from_fn(envelope::wrap))
        .layer(option_layer(cors(&app.cors_origins)))
        .layer(from_fn_with_state(Arc::clone(app), observe::observe))
}

/// Lets pages of these origins call the service and read the headers of its answers. `None` without origins.
fn cors(origins: &[HeaderValue]) -> Option<CorsLayer> {
    const EXPOSED: [HeaderName; 6] = [
        request_id::HEADER,
        envelope::ENGINE_VERSION_HEADER,
        trace::HEADER,
        header::CONTENT_DISPOSITION,
        header::RETRY_AFTER,
        output::WARNINGS,
    ];
    let layer = CorsLayer::new()
        .allow_origin(origins.to_vec())
        .allow_methods([Method::GET, Method::POST, Method::PUT])
        .allow_headers([header::ACCEPT, header::CONTENT_TYPE, request_id::HEADER, trace::HEADER])
        .expose_headers(EXPOSED);
    (!origins.is_empty()).then_some(layer)
}
