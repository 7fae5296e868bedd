//! Refuses a request for which the service has no room. If the queue of computations is full, the request is
//! refused at once. If the bodies of all requests together fill the memory for bodies, a request is refused
//! while its body arrives.

use std::sync::Arc;
use std::time::Duration;

use axum::extract::{Request, State};
use axum::http::Method;
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use tokio::time::sleep;

use crate::http::byte_limit::ByteLimit;
use crate::http::compute::Compute;
use crate::http::error::ApiError;

/// How long a refusal is held back. Without the pause, callers that try again at once would take processor
/// time from the running computations.
const REFUSAL_PAUSE: Duration = Duration::from_millis(10);

/// What tells whether there is room for a request.
#[derive(Clone)]
pub struct Admission {
    pub compute: Arc<Compute>,
    /// The memory for heads of requests.
    pub heads: Arc<ByteLimit>,
    /// The memory for bodies of requests.
    pub bodies: Arc<ByteLimit>,
}

/// Middleware that refuses a `POST` while the queue is full, before its body is read. Every other request
/// gets a [`HeldBytes`](crate::http::byte_limit::HeldBytes) of the memory for bodies, and its head counts
/// until the head of the answer is ready.
pub async fn admit(State(admission): State<Admission>, mut request: Request, next: Next) -> Response {
    if request.method() == Method::POST && admission.compute.is_full() {
        sleep(REFUSAL_PAUSE).await;
        return ApiError::from(admission.compute.overloaded()).into_response();
    }
    let (head, body) = (admission.heads.hold(), admission.bodies.hold());
    if let Err(refused) = head.take(bytes_of_head(&request)) {
        return refused.into_response();
    }
    request.extensions_mut().insert(body.clone());
    let response = next.run(request).await;
    drop((head, body));
    response
}

/// Estimates the bytes of a request's head: path, query and headers.
fn bytes_of_head(request: &Request) -> usize {
    let path = request.uri().path_and_query().map_or(0, |path| path.as_str().len());
    path + request.headers().iter().map(|(name, value)| name.as_str().len() + value.len()).sum::<usize>()
}
