//! Health checks: whether the process answers, and whether it takes new work.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use axum::extract::State;

use crate::http::error::{ApiError, Code};

/// Whether the service is shutting down. Clones tell the same.
#[derive(Debug, Clone, Default)]
pub struct Draining(Arc<AtomicBool>);

impl Draining {
    pub fn begin(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    fn has_begun(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Tell that the process answers.
///
/// A supervisor restarts a process that does not answer.
#[utoipa::path(get, path = "/livez", operation_id = "livez", tag = "operation",
    responses((status = 200, description = "The process answers.", body = String, content_type = "text/plain")))]
pub async fn livez() -> &'static str {
    "ok\n"
}

/// Tell whether new work should be sent here.
///
/// A service that is shutting down answers status 503, and a load balancer sends new work elsewhere.
#[utoipa::path(get, path = "/readyz", operation_id = "readyz", tag = "operation",
    responses((status = 200, description = "The service takes new work.", body = String, content_type = "text/plain")))]
pub async fn readyz(State(draining): State<Draining>) -> Result<&'static str, ApiError> {
    if draining.has_begun() {
        return Err(ApiError::new(Code::Overloaded, "the service is shutting down"));
    }
    Ok("ok\n")
}
