//! Whether the service lives and whether it wants work.

use std::sync::Arc;

use axum::extract::State;

use super::App;
use super::error::{ApiError, Code};

/// Whether the process answers at all.
#[utoipa::path(get, path = "/livez", operation_id = "livez", tag = "operation",
    responses((status = 200, description = "It does.", body = String, content_type = "text/plain")))]
pub async fn livez() -> &'static str {
    "ok\n"
}

/// Whether new work should be sent here; not while the service is shutting down.
#[utoipa::path(get, path = "/readyz", operation_id = "readyz", tag = "operation",
    responses((status = 200, description = "It should.", body = String, content_type = "text/plain")))]
pub async fn readyz(State(app): State<Arc<App>>) -> Result<&'static str, ApiError> {
    if app.is_draining() {
        return Err(ApiError::new(Code::Overloaded, "the service is shutting down"));
    }
    Ok("ok\n")
}
