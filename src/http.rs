//! The HTTP service: decodes requests into jobs, runs them on a bounded pool and represents what comes out.
//!
//! Everything about status codes, media types and JSON is in this layer and nowhere below it.

mod answer;
mod coding;
pub mod compute;
mod decode;
mod dto;
mod envelope;
mod error;
mod events;
mod extract;
mod health;
mod linger;
mod openapi;
mod output;
mod pointer;
mod refusal;
mod request_id;
pub mod serve;
mod timing;
mod v1;
mod wanted;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use axum::Router;
use axum::middleware::from_fn;
use tokio::sync::Semaphore;
use tower_http::catch_panic::CatchPanicLayer;

use crate::config::{Limits, Settings};
use compute::Compute;
pub use openapi::contract;

/// The version of the engine: the same request gives the same bytes as long as it stands.
pub const ENGINE_VERSION: &str = env!("CARGO_PKG_VERSION");

/// What the handlers share.
pub struct App {
    pub compute: Compute,
    /// Turns of decoding large bodies.
    decoders: Arc<Semaphore>,
    limits: Limits,
    queue: usize,
    workers: usize,
    deadline: Duration,
    header_timeout: Duration,
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
            limits: settings.limits(),
            queue,
            workers,
            deadline: settings.deadline_s,
            header_timeout: settings.header_timeout_s,
            body_timeout: settings.body_timeout_s,
            draining: AtomicBool::new(false),
        }))
    }

    /// From now on the service only finishes what it has.
    pub fn drain(&self) {
        self.draining.store(true, Ordering::Relaxed);
    }

    pub fn is_draining(&self) -> bool {
        self.draining.load(Ordering::Relaxed)
    }
}

/// Every route, in the layers that give each answer its shape.
pub fn router(app: &Arc<App>) -> Router {
    let (routes, _) = openapi::routes().split_for_parts();
    routes
        .with_state(Arc::clone(app))
        .layer(coding::layer())
        .layer(CatchPanicLayer::custom(envelope::panicked))
        .layer(from_fn(envelope::wrap))
}
