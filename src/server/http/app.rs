//! The state that all layers and handlers share. Most of them take only the part that they need.

use std::sync::Arc;
use std::time::Instant;

use axum::extract::FromRef;
use axum::http::HeaderValue;

use super::answer::Computing;
use super::answer::program_stream::Streams;
use super::answer::sending::Controls;
use super::byte_limit::ByteLimit;
use super::compute::memory::{self, Memory};
use super::compute::{Capacity, Compute};
use super::connection::Connections;
use super::request::body::BodyLimits;
use super::service::admission::Admission;
use super::service::guard::Hosts;
use super::service::health::Draining;
use super::service::metrics::{Figures, Load, Metrics};
use crate::config::Settings;
use crate::receipt::SigningKey;

/// Most bytes of the heads of all requests under way.
const HEAD_MEMORY_BYTES: usize = 32 * 1024 * 1024;

/// The state of the service.
pub struct App {
    pub compute: Arc<Compute>,
    pub(super) capacity: Capacity,
    pub(super) computing: Computing,
    pub(super) body_limits: BodyLimits,
    pub(super) streams: Streams,
    pub(super) controls: Controls,
    pub(super) admission: Admission,
    /// The memory for answers that wait for their callers.
    pub(super) answer_memory: Arc<ByteLimit>,
    pub(super) hosts: Arc<Hosts>,
    pub(super) cors_origins: Arc<[HeaderValue]>,
    pub(super) metrics: Arc<Metrics>,
    pub(super) connections: Connections,
    pub(super) draining: Draining,
    /// Signs receipts.
    pub(super) receipt_key: Option<SigningKey>,
}

impl App {
    pub fn new(settings: &Settings) -> Arc<Self> {
        let memory = settings.memory.or_else(memory::granted);
        let (body_bytes, answer_bytes) = settings.held_bytes(memory);
        let capacity = Capacity {
            workers: settings.workers(),
            queue: usize::from(settings.queue),
            wait: settings.queue_wait_s,
            deadline: settings.deadline_s,
        };
        let compute = Arc::new(Compute::new(capacity, Memory::of(memory)));
        let heads = ByteLimit::new(HEAD_MEMORY_BYTES, "heads of requests");
        let bodies = ByteLimit::new(body_bytes, "request bodies");
        let answer_memory = ByteLimit::new(answer_bytes, "answers");
        let body_limits = BodyLimits::new(settings);
        let metrics = Arc::new(Metrics::default());
        Arc::new(Self {
            capacity,
            computing: Computing {
                compute: Arc::clone(&compute),
                limits: settings.limits(),
                memory: Arc::clone(&answer_memory),
            },
            body_limits,
            streams: Streams::new(settings, body_limits, Arc::clone(&compute)),
            controls: Controls::new(&settings.dnc_target),
            admission: Admission { compute: Arc::clone(&compute), heads, bodies },
            answer_memory,
            hosts: Arc::new(Hosts::new(&settings.host)),
            cors_origins: settings.cors_origin.clone().into(),
            connections: Connections::new(settings, Arc::clone(&metrics)),
            metrics,
            draining: Draining::default(),
            receipt_key: settings.receipt_key.clone(),
            compute,
        })
    }

    /// Begins the shutdown. `/readyz` answers 503, so that load balancers send new work elsewhere, programs
    /// that are being sent to controls stop, and no computation goes on after `end`.
    pub fn drain(&self, end: Instant) {
        self.draining.begin();
        self.compute.end_by(end);
        self.controls.close();
    }

    /// The load of this moment, for the metrics.
    pub(super) fn load(&self) -> Load {
        Load {
            running: self.compute.running(),
            waiting: self.compute.waiting(),
            connections: self.connections.open(),
            body_bytes: self.admission.bodies.held(),
            answer_bytes: self.answer_memory.held(),
        }
    }
}

impl FromRef<Arc<App>> for Computing {
    fn from_ref(app: &Arc<App>) -> Self {
        app.computing.clone()
    }
}

impl FromRef<Arc<App>> for BodyLimits {
    fn from_ref(app: &Arc<App>) -> Self {
        app.body_limits
    }
}

impl FromRef<Arc<App>> for Draining {
    fn from_ref(app: &Arc<App>) -> Self {
        app.draining.clone()
    }
}

impl FromRef<Arc<App>> for Figures {
    fn from_ref(app: &Arc<App>) -> Self {
        Self { metrics: Arc::clone(&app.metrics), load: app.load() }
    }
}
