//! The layer that repeats the caller's key of a request in its answer.

use axum::extract::Request;
use axum::middleware::Next;
use axum::response::Response;

use super::envelope;
use crate::http::request::request_id::RequestId;
use crate::http::request::retry::{IDEMPOTENCY_KEY, check};

/// Repeats the key in every answer, problems included. A request with a bad key is refused.
pub async fn repeat_key(id: RequestId, request: Request, next: Next) -> Response {
    let Some(key) = request.headers().get(IDEMPOTENCY_KEY).cloned() else { return next.run(request).await };
    if let Err(refused) = check(&key) {
        return envelope::answer_of(refused, &id);
    }
    let mut response = next.run(request).await;
    response.headers_mut().insert(IDEMPOTENCY_KEY, key);
    response
}
