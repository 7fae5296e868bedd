//! What every answer has: the request's id, the engine's version, a log line, and the shape of problems.

use std::any::Any;
use std::time::Instant;

use axum::body::Body;
use axum::extract::Request;
use axum::http::{HeaderName, HeaderValue, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use tracing::Instrument;

use super::ENGINE_VERSION;
use super::error::{ApiError, Code};
use super::request_id::{self, RequestId};

const ENGINE_VERSION_HEADER: HeaderName = HeaderName::from_static("x-engine-version");

/// The outermost layer.
pub async fn wrap(mut request: Request, next: Next) -> Response {
    let id = RequestId::of(request.headers());
    // Paths and ids only: bodies and queries are the caller's business.
    let span = tracing::info_span!(
        "request",
        id = id.as_str(),
        method = %request.method(),
        path = request.uri().path()
    );
    request.extensions_mut().insert(id.clone());
    let started = Instant::now();
    let mut answered = Answered { span: span.clone(), started, done: false };
    let mut response = next.run(request).instrument(span).await;

    if response.status().is_client_error() || response.status().is_server_error() {
        response = into_problem(response, &id);
    }
    let headers = response.headers_mut();
    headers.insert(request_id::HEADER, id.header_value());
    headers.insert(ENGINE_VERSION_HEADER, HeaderValue::from_static(ENGINE_VERSION));
    // Of any answer: what is a problem today may be an answer of some type tomorrow.
    headers.insert(header::VARY, HeaderValue::from_static("Accept, Accept-Encoding"));
    answered.with(response.status());
    response
}

/// The answer to a request whose handler panicked.
pub fn panicked(_: Box<dyn Any + Send>) -> Response<Body> {
    ApiError::new(Code::InternalError, "the request met a fault of the server").into_response()
}

/// Gives a failure the body it only announces, and a failure of the framework the same shape.
fn into_problem(response: Response, id: &RequestId) -> Response {
    let (mut parts, _) = response.into_parts();
    let error = parts.extensions.remove::<ApiError>().unwrap_or_else(|| ApiError::from_status(parts.status));
    let mut problem = error.into_response_to(id.as_str());
    for name in [header::ALLOW, header::CONNECTION] {
        if let Some(value) = parts.headers.remove(&name) {
            problem.headers_mut().insert(name, value);
        }
    }
    problem
}

/// Logs the end of a request, also when the caller went away before it was answered.
struct Answered {
    span: tracing::Span,
    started: Instant,
    done: bool,
}

impl Answered {
    fn with(&mut self, status: StatusCode) {
        self.done = true;
        let milliseconds = self.started.elapsed().as_secs_f64() * 1e3;
        self.span.in_scope(|| tracing::info!(status = status.as_u16(), milliseconds, "answered"));
    }
}

impl Drop for Answered {
    fn drop(&mut self) {
        if !self.done {
            let milliseconds = self.started.elapsed().as_secs_f64() * 1e3;
            self.span.in_scope(|| tracing::info!(milliseconds, "the caller went away"));
        }
    }
}
