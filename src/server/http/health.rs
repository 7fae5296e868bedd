//! Health checks: whether the process answers, and whether it takes new work.

use std::sync::Arc;

use axum::extract::State;

use super::App;
use super::error::{ApiError, Code};

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
pub async fn readyz(State(app): State<Arc<App>>) -> Result<&'static str, ApiError> {
    if app.is_draining() {
        return Err(ApiError::new(Code::Overloaded, "the service is shutting down"));
    }
    Ok("ok\n")
}
